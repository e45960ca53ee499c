"""Values that are kept while the object lives from which they are computed."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

Function = TypeVar("Function", bound=Callable[..., Any])


def kept(function: Function) -> Function:
    """Let a function keep its values while its first argument lives, such as a result of which several outcomes ask.

    The other arguments are given by position, and are hashable.
    """
    known: WeakKeyDictionary[Any, dict[tuple[Any, ...], Any]] = WeakKeyDictionary()

    @wraps(function)
    def value(first: Any, *others: Any) -> Any:
        values = known.setdefault(first, {})
        if others not in values:
            values[others] = function(first, *others)
        return values[others]

    return value  # type: ignore[return-value]

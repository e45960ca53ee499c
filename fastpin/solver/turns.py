"""Turns of threads: an object whose methods one thread at a time may call."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any, TypeVar, cast

from fastpin.errors import InputError

Method = TypeVar("Method", bound=Callable[..., Any])


class InTurns:
    """Base of classes with methods that are :func:`in_turn`. Copies and pickles have a turn of their own."""

    def __init__(self) -> None:
        self._turn = threading.RLock()


def in_turn(method: Method) -> Method:
    """Refuse the calls of a method while another thread is in such a method of the same object.

    Waiting would mix the loads of two threads in an order that nobody chose. So the call raises :class:`InputError`.
    """

    @functools.wraps(method)
    def called(self: InTurns, *arguments: Any, **keywords: Any) -> Any:
        turn = self._turn
        if not turn.acquire(blocking=False):
            name = type(self).__name__.lower()
            raise InputError(name, "is being used by another thread; one thread at a time may use it, or each a copy")
        try:
            return method(self, *arguments, **keywords)
        finally:
            turn.release()

    return cast("Method", called)

"""Public names that have moved to another folder. Their old folder still has them, with a warning."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection
from typing import Any


def with_moved(face: Callable[[str], Any], home: Callable[[], Any], names: Collection[str]) -> Callable[[str], Any]:
    """Return `face`, the ``__getattr__`` of a folder, which also gives some names of the folder ``home()``."""

    def value(name: str) -> Any:
        if name not in names:
            return face(name)
        warnings.warn(f"this is {home().__name__}.{name} now", DeprecationWarning, stacklevel=2)
        return getattr(home(), name)

    return value

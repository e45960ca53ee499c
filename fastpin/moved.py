"""Public names that belong to another folder. A name that has moved there still works, with a warning."""

from __future__ import annotations

import importlib
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


def with_homes(face: Callable[[str], Any], folders: Collection[str]) -> Callable[[str], Any]:
    """Return `face`, the ``__getattr__`` of the package, whose error says which of some folders has a name."""

    def value(name: str) -> Any:
        try:
            return face(name)
        except AttributeError as error:
            if name.startswith("_"):
                raise
            homes = [f"fastpin.{folder}" for folder in folders]
            found = [home for home in homes if name in getattr(importlib.import_module(home), "__all__", ())]
            if not found:
                raise
            words = " or ".join(f"{home}.{name}" for home in found)
            raise AttributeError(f"{error}; there is {words}") from None

    return value

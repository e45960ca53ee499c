"""Records that can't be changed: frozen dataclasses whose arrays and dicts are read-only too."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

import numpy as np

Key = TypeVar("Key")
Value = TypeVar("Value")


class ReadOnlyDict(dict[Key, Value]):
    """A dict that can't be changed. It compares, copies and pickles as a dict, and JSON encoders take it for one.

    ``dict(...)`` and ``copy()`` make a dict that can be changed.
    """

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("a read-only dict can't be changed; dict(...) makes a copy that can")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[ReadOnlyDict[Key, Value]], tuple[dict[Key, Value]]]:
        return type(self), (dict(self),)


class ReadOnly:
    """Base of frozen dataclasses whose arrays and dicts are read-only, also in copies and after pickling.

    An array that can be written to is replaced by a read-only view: its owner can still write to it.
    """

    def __post_init__(self) -> None:
        content = self.__dict__
        for name, value in content.items():
            kind = type(value)
            if kind is float or kind is int:  # most fields: two comparisons less for each
                continue
            if kind is np.ndarray:
                if value.flags.writeable:
                    content[name] = view = value[...]
                    view.setflags(write=False)
            elif kind is dict:
                content[name] = ReadOnlyDict(value)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        ReadOnly.__post_init__(self)

"""The source of compiled code: a function, the files of its text, and the settings of the compiler."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from hashlib import blake2b
from pathlib import Path
from typing import Any

CACHED = os.environ.get("FASTPIN_CACHE", "1") != "0"
"""Whether compiled code is stored on disk."""

SETTINGS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
"""Settings of every kernel: no fastmath and no parallel sums.

Division by zero gives inf or nan. C calls no kernel, so the wrapper for C is left out, which saves compiling.
"""

SHARED = ("kernels/arrays.py", "kernels/status.py")
"""Files of constants and of records of arrays that kernels take from other files. Code depends on them, too."""


def stamp(file: str) -> tuple[int, int] | None:
    """Time and size of a file, which change with its text. None if there is no such file."""
    try:
        found = os.stat(file)  # noqa: PTH116  every process does it for each kernel, and paths take three times as long
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


@functools.cache
def digest(file: str, imported: tuple[int, int] | None) -> bytes:
    """The digest of an imported text. :class:`OSError` if its file is gone, or was replaced since the import."""
    content = Path(file).read_bytes()
    if stamp(file) != imported:
        raise OSError(f"{file} was replaced after its import")
    return blake2b(content).digest()


_shared = tuple((file, stamp(file)) for file in (str(Path(__file__).parents[1] / name) for name in SHARED))


class KernelSource:
    """A function that is to be compiled.

    Attributes
    ----------
    py_func : callable
        The function as plain Python.
    texts : tuple
        The files of its text, and their stamps at its import: its own file first, then those of the kernels of other
        files that its file imports. An upgrade may replace the files in a running process.
    """

    texts: tuple[tuple[str, tuple[int, int] | None], ...]

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        file = function.__code__.co_filename
        texts: dict[str, tuple[int, int] | None] = {file: stamp(file)}
        for each in function.__globals__.values():
            if isinstance(each, KernelSource):
                texts.update((other, kept) for other, kept in each.texts if other != file)
        self.texts = tuple({**texts, **dict(_shared)}.items())

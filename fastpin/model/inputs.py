"""The files that a command has read: none of its outputs may replace one of them.

Every function that opens a file of the user notes it here. The command line remembers the notes while a command runs.
Python programs may read a file and write it again: without :func:`remembered_inputs` nothing is remembered.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from os import stat_result
from pathlib import Path

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""The first bytes of an HDF5 file."""

SQLITE_SIGNATURE = b"SQLite format 3\0"
"""The first bytes of an SQLite file."""

_READ: ContextVar[set[tuple[int, int]] | None] = ContextVar("_READ", default=None)


@contextmanager
def remembered_inputs() -> Iterator[None]:
    """Remember the files that are read during the block."""
    token = _READ.set(set())
    try:
        yield
    finally:
        _READ.reset(token)


def note_input(path: Path) -> None:
    """Remember a file as read, under all its names. Do nothing outside of :func:`remembered_inputs`."""
    read = _READ.get()
    if read is not None:
        with contextlib.suppress(OSError, ValueError):  # the reader says why a file can't be opened
            read.add(_identity(path.stat()))


def is_input(path: Path) -> bool:
    """Whether a file was read, under this name or another one."""
    read = _READ.get()
    try:
        return bool(read) and _identity(path.stat()) in (read or ())
    except OSError:
        return False


def _identity(found: stat_result) -> tuple[int, int]:
    return found.st_dev, found.st_ino

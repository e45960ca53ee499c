"""The files that a command reads: ordinary files only, and none of its outputs may replace one of them.

Every function that opens a file of the user notes it here. The command line remembers the notes while a command runs.
Python programs may read a file and write it again: without :func:`remembered_inputs` nothing is remembered.
"""

from __future__ import annotations

import contextlib
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from io import BufferedReader
from os import stat_result
from pathlib import Path

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""The first bytes of an HDF5 file."""

SQLITE_SIGNATURE = b"SQLite format 3\0"
"""The first bytes of an SQLite file."""

_READ: ContextVar[set[tuple[int, int]] | None] = ContextVar("_READ", default=None)


class SpecialFileError(OSError):
    """A file that is neither an ordinary file nor a directory."""


@contextmanager
def remembered_inputs() -> Iterator[None]:
    """Remember the files that are read during the block."""
    token = _READ.set(set())
    try:
        yield
    finally:
        _READ.reset(token)


def open_input(path: Path) -> BufferedReader:
    """Open a file of the user to read its bytes, and note it as read.

    Its name may stand in a file of a stranger. Nothing may ever be written to a pipe, and a device may have no end.

    Raises
    ------
    SpecialFileError
        If the file is a pipe, a device or a socket, and not handed over to this process.
    OSError
        If the file can't be opened.
    """
    mode = path.stat().st_mode
    # The shell hands over open files: `fastpin run <(sed ...)`.
    is_handed_over = path == Path("/dev/stdin") or path.parent == Path("/dev/fd")
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode) or is_handed_over):
        raise SpecialFileError
    file = path.open("rb")
    note_input(path)
    return file


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


def _identity(status: stat_result) -> tuple[int, int]:
    return status.st_dev, status.st_ino

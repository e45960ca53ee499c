"""Safe writing of output files: a file is either whole or absent, and an output replaces only files of its own kind.

A path is checked before the work begins, and again before the old file is replaced. The new file is written under
another name and then renamed. All outputs of all commands and functions are written by :func:`replacing`. Only the
results of runs grow in place (journal.py).
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from fastpin.errors import InputError, OutputError
from fastpin.model.inputs import HDF5_SIGNATURE, SQLITE_SIGNATURE, is_input

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # This system has no such locks: no second process may write to the file.
    fcntl = None

BESIDE_RESULT = (".journal", ".checkpoint")
"""Endings of the files that a run keeps beside its result."""

INDEX = "index.sqlite"
"""Name of the index in the directory of a sweep."""

NO_LINK = getattr(os, "O_NOFOLLOW", 0)
"""Flag of :func:`os.open`: follow no link."""


def check_writable(path: str | Path, result: bool = False) -> None:
    """Check that an output can be written. Call this before an hour of computing, not after.

    Parameters
    ----------
    path : path
    result : bool
        Whether the output is a result.

    Raises
    ------
    InputError
        If the file can't be written, or must not be replaced, see :func:`check_replaceable`.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(str(path), "is a directory, a file name is needed")
    folder = path.parent
    if not folder.is_dir():
        raise InputError(str(path), f"the directory {folder} does not exist")
    if _is_special(path):
        return
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(str(path), f"the directory {folder} is not writable")
    check_replaceable(path, result)


def check_replaceable(path: Path, result: bool = False) -> None:
    """Check that an output may replace the file at `path`, if there is one.

    No output replaces an input of the same command, a database, or a file that another process is writing. A result
    replaces results and empty files only. No other output replaces a result, or a file that a run or a sweep needs.

    Raises
    ------
    InputError
        If the output must not replace the file.
    """
    if not path.exists():
        return
    if is_input(path):
        raise InputError(str(path), "is an input of this command; choose another name for the output")
    try:
        with path.open("rb") as file:
            start = file.read(len(SQLITE_SIGNATURE))
    except OSError as error:
        raise InputError(str(path), f"can't be read to judge whether it may be replaced: {error.strerror}") from None
    if start == SQLITE_SIGNATURE:
        raise InputError(str(path), "is a database, such as the index of a sweep, which no output replaces")
    if start.startswith(HDF5_SIGNATURE) and not result:
        raise InputError(str(path), "is a stored result, which only a result replaces; choose another name")
    if result and start and not start.startswith(HDF5_SIGNATURE):
        raise InputError(str(path), "is no result, and a result replaces results only; choose another name")
    if not result and _is_needed(path):
        raise InputError(str(path), "belongs to a run or a sweep; choose another name")
    check_free(path)


def _is_needed(path: Path) -> bool:
    """Whether a run or a sweep keeps the file beside its result or index."""
    path = Path(os.path.realpath(path))
    if path.suffix in BESIDE_RESULT:
        return path.with_suffix("").exists()
    return path.name in ("lock", f"{INDEX}-journal") and path.with_name(INDEX).exists()


def no_figure(field: str, path: Path) -> InputError:
    """Return the error of a figure's file whose name ends in no format of figures."""
    return InputError(field, f'must be the name of a figure, which ends in .png, .pdf or .svg, not "{path.name}"')


def check_exists(path: Path) -> None:
    """Raise :class:`InputError` if `path` is not a regular file."""
    if (path / INDEX).is_file():
        words = (
            "is the directory of a sweep: fastpin report writes its page, fastpin sweep with its plan prints tables, "
        )
        raise InputError(str(path), f"{words}and fastpin show {path / 'results' / 'ID.h5'} a run")
    if not path.is_file():
        raise InputError(str(path), "is a directory, a file is needed" if path.is_dir() else "there is no such file")


def check_free(path: Path) -> None:
    """Raise :class:`InputError` if another process is writing to a file."""
    if is_locked(path):
        raise InputError(str(path), "another run is writing to it")


def is_locked(path: Path) -> bool:
    """Whether another process is writing to a file, as far as its lock tells."""
    if fcntl is None or not path.is_file():
        return False
    with path.open("rb") as file:
        return not try_lock(file.fileno(), exclusive=False)


def try_lock(file: int, exclusive: bool = True) -> bool:
    """Take the writer's lock of an open file. Return False if another process has it.

    Who only asks whether there is a writer takes a shared lock, so that others may ask at the same time.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, (fcntl.LOCK_EX if exclusive else fcntl.LOCK_SH) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # The file system has no locks.
        return True
    return True


@contextmanager
def replacing(path: str | Path, result: bool = False) -> Iterator[Path]:
    """Yield a new empty file beside `path`, and rename it to `path` when the block ends without an error.

    An interrupted or failed write leaves the old file unchanged. A symbolic link as `path` is followed. A special file,
    such as ``/dev/stdout`` or a named pipe, can't be replaced: it is written directly. The new file has a random name,
    which no other process can have prepared.

    Parameters
    ----------
    path : path
    result : bool
        Whether the output is a result.

    Raises
    ------
    InputError
        If the old file must not be replaced, see :func:`check_replaceable`.
    OutputError
        If the file can't be written.
    """
    try:
        if _is_special(Path(path)):
            yield Path(path)
            return
        target = Path(os.path.realpath(path))
        check_replaceable(target, result)
        # The suffix stays: writers choose their format by it.
        temporary = target.with_name(f".{target.stem}.{os.urandom(8).hex()}{target.suffix}")
        file = os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL | NO_LINK, 0o666)
        try:
            yield temporary
            if not os.path.samestat(os.fstat(file), temporary.lstat()):
                raise OutputError(str(path), "can't be written: another process has exchanged its temporary file")
            os.fsync(file)
            check_replaceable(target, result)
            temporary.replace(target)
        finally:
            os.close(file)
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(str(path), f"can't be written: {error.strerror or error}") from None


def forget_temporaries(folder: Path, names: Collection[str]) -> None:
    """Remove the partly written files that killed processes have left of the outputs `names` in a folder."""
    for found in folder.glob(".*"):
        parts = re.fullmatch(r"\.(.+?)\.[0-9a-f]+(\.[^.]*)?", found.name)
        if parts and parts[1] + (parts[2] or "") in names and stat.S_ISREG(found.lstat().st_mode):
            found.unlink(missing_ok=True)


def _is_special(path: Path) -> bool:
    return path.exists() and not path.is_file() and not path.is_dir()

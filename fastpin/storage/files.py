"""Output files that are either whole or not there: checked before the work, written aside and renamed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fastpin.errors import InputError


def check_writable(path: str | Path) -> None:
    """Raise :class:`InputError` if `path` can't be written: better before an hour of computing than after."""
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


def check_exists(path: Path) -> None:
    """Raise :class:`InputError` if `path` is no file."""
    if not path.is_file():
        raise InputError(str(path), "is a directory, a file is needed" if path.is_dir() else "there is no such file")


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`; it takes the name `path` when the block ends without an error.

    An interrupted or failed write leaves what was there before. Symbolic links are followed; what is no
    regular file (``/dev/stdout``, a named pipe) can't be replaced and is written directly.
    """
    if _is_special(Path(path)):
        yield Path(path)
        return
    target = Path(os.path.realpath(path))
    # The suffix stays, because writers choose their format by it; the process id keeps two runs apart.
    temporary = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        yield temporary
        with temporary.open("rb") as written:
            os.fsync(written.fileno())
        temporary.replace(target)
    except OSError as error:
        raise InputError(str(path), f"can't be written: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def _is_special(path: Path) -> bool:
    return path.exists() and not path.is_file() and not path.is_dir()

"""Safe writing of output files: a file is either whole or absent.

A path is checked before the work begins. The new file is written under another name and then renamed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fastpin.errors import InputError


def check_writable(path: str | Path) -> None:
    """Raise :class:`InputError` if `path` can't be written. Call this before an hour of computing, not after."""
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


def no_figure(field: str, path: Path) -> InputError:
    """Return the error of a figure's file whose name ends in no format of figures."""
    return InputError(field, f'must be the name of a figure, which ends in .png, .pdf or .svg, not "{path.name}"')


def check_exists(path: Path) -> None:
    """Raise :class:`InputError` if `path` is not a regular file."""
    if not path.is_file():
        raise InputError(str(path), "is a directory, a file is needed" if path.is_dir() else "there is no such file")


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside `path`, and rename it to `path` when the block ends without an error.

    An interrupted or failed write leaves the old file unchanged. Symbolic links are followed. A special file, such as
    ``/dev/stdout`` or a named pipe, can't be replaced: it is written directly.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    if _is_special(Path(path)):
        yield Path(path)
        return
    target = Path(os.path.realpath(path))
    # The suffix stays: writers choose their format by it. The process id separates two runs.
    temporary = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        yield temporary
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(target)
    except OSError as error:
        raise InputError(str(path), f"can't be written: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def _is_special(path: Path) -> bool:
    return path.exists() and not path.is_file() and not path.is_dir()

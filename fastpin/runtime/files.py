"""Files of machine code: read where nobody else can write, and written whole or not at all.

Machine code is run. So a file and its folder belong to the user, to root, or to the owner of the package, and others
can't write them. A group may write if it is the private one of the owner, or can write the package, too: whoever can
write there can change the program itself. In a sticky folder others can't replace a file of the user.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import stat
from pathlib import Path

with contextlib.suppress(ImportError):  # Windows has neither
    import grp
    import pwd

logger = logging.getLogger("fastpin.compiler")


def read(file: Path, package: Path) -> bytes:
    """The content of a file. `package` is the folder of the program's own files.

    :class:`OSError` if there is none, if it is no ordinary file, or if others can write it or its folder.
    """
    _check(os.stat(file.parent), file.parent, package)  # noqa: PTH116  every process does it for each kernel
    # A pipe does not block, and is refused when it is open.
    descriptor = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        found = os.fstat(descriptor)
        _check(found, file.parent, package)
        if not stat.S_ISREG(found.st_mode):
            raise OSError(f"{file} is no ordinary file")
        return os.read(descriptor, found.st_size)
    finally:
        os.close(descriptor)


def write(file: Path, content: bytes, package: Path) -> None:
    """Write a file under a new random name, and give it its own name when it is whole.

    Threads, and processes with equal numbers in several containers, never write to the same file. No link is followed.
    :class:`OSError` if it can't be written, or if others can write its folder.
    """
    file.parent.mkdir(mode=0o755, parents=True, exist_ok=True)
    _check(file.parent.stat(), file.parent, package)
    part = file.with_name(f"{file.name}.{os.urandom(8).hex()}.part")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(part, flags, 0o644)
    try:
        with os.fdopen(descriptor, "wb") as target:
            target.write(content)
        part.replace(file)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def _check(found: os.stat_result, folder: Path, package: Path) -> None:
    """Refuse what others can write: a folder, or a file in it."""
    if hasattr(os, "geteuid") and not _is_trusted(found, os.stat(package)):  # noqa: PTH116  as above
        _warn(folder)
        raise PermissionError(f"other users can write in {folder}")


def _is_trusted(found: os.stat_result, package: os.stat_result) -> bool:
    if found.st_uid not in (0, os.geteuid(), package.st_uid):
        return False
    mode = found.st_mode
    if stat.S_ISDIR(mode) and mode & stat.S_ISVTX:
        return True
    if not mode & stat.S_IWGRP or (package.st_mode & stat.S_IWGRP and package.st_gid == found.st_gid):
        return not mode & stat.S_IWOTH
    return not mode & stat.S_IWOTH and _is_private(found.st_gid, found.st_uid)


@functools.cache
def _is_private(group: int, user: int) -> bool:
    """Whether a group has the name of the user: many systems make one for each user alone."""
    with contextlib.suppress(KeyError):
        return grp.getgrgid(group).gr_name == pwd.getpwuid(user).pw_name
    return False


@functools.cache
def _warn(folder: Path) -> None:
    """Say once why machine code is compiled again."""
    logger.warning(
        "machine code in %s is not used, because other users can write it; take this right from them (chmod -R go-w), "
        "delete the folder, or set NUMBA_CACHE_DIR to a folder of your own",
        folder,
    )

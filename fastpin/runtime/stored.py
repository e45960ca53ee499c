"""Machine code of kernels on disk: beside the package, else in the user's cache directory, else nowhere.

A file holds one kernel for one combination of types. It holds all that the code depends on, too: the text of the
kernel's file, the types, the settings, and the versions of Python, NumPy, Numba, LLVM and the processor. A file that
does not agree is not used. The folder may be moved or copied. ``NUMBA_CACHE_DIR`` chooses another directory.
"""

from __future__ import annotations

import contextlib
import functools
import marshal
import os
import sys
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.runtime import compiler, machine
from fastpin.runtime.extensions import folder
from fastpin.runtime.source import SETTINGS, KernelSource

SUFFIX = ".machine"


class StoredCode:
    """The files of a kernel for arguments of some types."""

    def __init__(self, kernel: KernelSource, signature: str) -> None:
        self.kernel, function = kernel, kernel.py_func
        self.source = function.__code__.co_filename
        texts = tuple(Path(file).read_bytes() for file, _ in kernel.texts)
        if not kernel.is_current():
            raise OSError("the text of the kernel was replaced after its import")
        rest = (signature, repr(SETTINGS), *_environment())
        self.key = (texts, rest)
        self.name, self.module = function.__qualname__, function.__module__
        self.stem = f"{Path(self.source).stem}.{self.name}-{zlib.crc32(repr(rest).encode()):08x}-"
        self.file = f"{self.stem}{zlib.crc32(b''.join(texts)):08x}{SUFFIX}"

    def load(self) -> Callable[..., Any] | None:
        """The function from the first file that agrees; None if there is none.

        Where code can't be stored, the function comes from the cache of Numba.
        """
        for directory in self._directories():
            try:
                content = (directory / self.file).read_bytes()
            except OSError:
                continue
            body = content[4:]
            if zlib.crc32(body).to_bytes(4, "little") != content[:4]:
                continue
            key, code = marshal.loads(body)
            if key == self.key:
                if not code:
                    return compiler.dispatcher(self.kernel, kept=True)
                with contextlib.suppress(Exception):  # parts of Numba that it needs may change
                    return machine.load(machine.Code(*code), self.name, self.module)
        return None

    def save(self, code: machine.Code | None) -> None:
        """Write the machine code, or that there is none, to the first directory that can be written.

        The file is written whole or not at all. Any number of processes and threads may do it at once.
        """
        body = marshal.dumps((self.key, tuple(code or ())))
        content = zlib.crc32(body).to_bytes(4, "little") + body
        for directory in self._directories():
            try:
                directory.mkdir(parents=True, exist_ok=True)
                _replace(directory / self.file, content)
            except OSError:
                continue
            if directory == self._beside():
                self._forget_older(directory)
            return

    def _forget_older(self, directory: Path) -> None:
        """Delete the code of earlier texts of the file, where that is possible."""
        for path in directory.glob(f"{self.stem}*{SUFFIX}"):
            if path.name != self.file:
                with contextlib.suppress(OSError):  # another process has deleted it, or keeps it open
                    path.unlink()

    def _beside(self) -> Path:
        return Path(self.source).parent / "__pycache__"

    def _directories(self) -> Iterator[Path]:
        chosen = os.environ.get("NUMBA_CACHE_DIR")
        if chosen:
            yield Path(chosen)
            return
        yield self._beside()
        with contextlib.suppress(RuntimeError):  # the user has no home
            yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fastpin"


def _replace(file: Path, content: bytes) -> None:
    """Write a file under a new random name, and give it its own name when it is whole.

    Threads, and processes with equal numbers in several containers, never write to the same file. No link is followed.
    """
    part = file.with_name(f"{file.name}.{os.urandom(8).hex()}.part")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(part, flags, 0o666)
    try:
        with os.fdopen(descriptor, "wb") as target:
            target.write(content)
        part.replace(file)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def place_of(kernel: KernelSource, signature: str) -> StoredCode | None:
    """The place of a kernel's code; None if code can't be loaded, or its text is not in a file any more."""
    if not machine.CAN_LOAD:
        return None
    try:
        return StoredCode(kernel, signature)
    except (OSError, ImportError, RuntimeError):  # RuntimeError: LLVM does not know the processor
        return None


@functools.cache
def _environment() -> tuple[str, ...]:
    """Versions, the processor, and settings of Numba on which machine code depends."""
    settings = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith("NUMBA_"))
    unrelated = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")  # all others may change the code
    chosen = [text for text in settings if text.partition("=")[0] not in unrelated]
    compilers = [(folder(name) / "_version.py").read_text(encoding="utf-8") for name in ("numba", "llvmlite")]
    return (sys.version, np.__version__, *compilers, *machine.target(), *chosen)

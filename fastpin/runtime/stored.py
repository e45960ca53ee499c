"""Machine code of kernels on disk: beside the package, else in the user's cache directory, else nowhere.

A file holds one kernel for one combination of types. It holds all that the code depends on, too: the text of the
kernel's file, the types, the settings, and the versions of Python, NumPy, Numba, LLVM and the processor. A file that
does not agree is not used. The folder may be moved or copied. ``NUMBA_CACHE_DIR`` chooses another directory.

A platform wheel brings such files, in :data:`SHIPPED`. They are for all processors of a level, and are read when the
directories hold none. They depend on the binary interface of Python and on the version of Numba. The code calls no
other library: Numba's own helpers read NumPy's arrays, and any LLVM loads an object file.
"""

from __future__ import annotations

import contextlib
import functools
import marshal
import os
import sys
import zlib
from collections.abc import Callable, Iterator
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.runtime import compiler, machine
from fastpin.runtime.extensions import folder
from fastpin.runtime.source import SETTINGS, KernelSource

SUFFIX = ".machine"

SHIPPED = Path(__file__).parent / "shipped"
"""The folder of machine code in a platform wheel. Other installations have none."""

LEVELS = {
    "x86-64-v3": {"sse4.2", "ssse3", "popcnt", "cx16", "sahf", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"},
    "x86-64-v2": {"sse4.2", "ssse3", "popcnt", "cx16", "sahf"},
}
"""Levels of processors, the best first, and the features that make them, as LLVM names both."""


class StoredCode:
    """The files of a kernel for arguments of some types, for this environment or another one."""

    def __init__(self, kernel: KernelSource, signature: str, environment: tuple[str, ...] = ()) -> None:
        self.kernel, function = kernel, kernel.py_func
        self.source = function.__code__.co_filename
        texts = tuple(Path(file).read_bytes() for file, _ in kernel.texts)
        if not kernel.is_current():
            raise OSError("the text of the kernel was replaced after its import")
        rest = (signature, repr(SETTINGS), *(environment or own_environment()))
        self.key = (texts, rest)
        self.name, self.module = function.__qualname__, function.__module__
        self.stem = f"{Path(self.source).stem}.{self.name}-{zlib.crc32(repr(rest).encode()):08x}-"
        self.file = f"{self.stem}{zlib.crc32(b''.join(texts)):08x}{SUFFIX}"

    def load(self, *directories: Path) -> Callable[..., Any] | None:
        """The function from the first file that agrees, of these or the user's directories; None if there is none.

        Where code can't be stored, the function comes from the cache of Numba.
        """
        for directory in directories or self._directories():
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


def load_shipped(kernel: KernelSource, signature: str) -> Callable[..., Any] | None:
    """The function from the machine code of a platform wheel; None if none agrees."""
    for level in _levels():
        with contextlib.suppress(OSError):  # the text of the kernel was replaced after its import
            entry = StoredCode(kernel, signature, environment_of(level)).load(SHIPPED)
            if entry is not None:
                return entry
    return None


def environment_of(level: str) -> tuple[str, ...]:
    """What shipped code depends on: a level of processors, the binary interface of Python, and the version of Numba."""
    return (level, EXTENSION_SUFFIXES[0], _version("numba"))


@functools.cache
def own_environment() -> tuple[str, ...]:
    """Versions, the processor, and settings of Numba, on which machine code of this machine depends."""
    return (sys.version, np.__version__, _version("numba"), _version("llvmlite"), *machine.target(), *_settings())


@functools.cache
def _levels() -> list[str]:
    """Levels of shipped code that this processor runs. None if Numba is to compile with settings of its own."""
    if _settings() or not SHIPPED.is_dir():
        return []
    features = {name.removeprefix("+") for name in machine.target()[-1].split(",")}
    return [level for level, needed in LEVELS.items() if needed <= features]


def _settings() -> list[str]:
    """Settings of Numba by variables, of those that may change the code."""
    settings = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith("NUMBA_"))
    unrelated = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")
    return [text for text in settings if text.partition("=")[0] not in unrelated]


def _version(package: str) -> str:
    return (folder(package) / "_version.py").read_text(encoding="utf-8")

"""Machine code of kernels on disk: beside the package, else in the user's cache directory, else nowhere.

A file holds one kernel for one combination of types. It begins with a digest of its content and of all that the code
depends on: the texts of the kernel, the types, the settings, and the versions of Python, NumPy, Numba, LLVM and the
processor. A file whose digest does not agree, or that others can write (:mod:`fastpin.runtime.files`), is not used. The
folder may be moved or copied. ``NUMBA_CACHE_DIR`` chooses another directory.

A file has one of two forms, with a suffix each: machine code that is loaded without Numba, or a result of Numba. Only
functions for calls from Python are stored. What a kernel calls is in its own code.

A platform wheel brings such files, in :data:`SHIPPED`. They are for all processors of a level, and are read when the
directories hold none. They depend on the binary interface of Python and on the version of Numba. The code calls no
other library: Numba's own helpers read NumPy's arrays, and any LLVM loads an object file.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
from collections.abc import Callable, Iterator
from hashlib import blake2b
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.runtime import files, machine
from fastpin.runtime.extensions import folder, metadata
from fastpin.runtime.machine import SETTINGS, KernelSource, digest

MACHINE, NUMBA = ".machine", ".numba"
"""Suffixes of machine code that is loaded without Numba, and of results of Numba."""

SIZE = 16
"""Bytes of a digest."""

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
        function = kernel.py_func
        self.name, self.module = function.__qualname__, function.__module__
        self.home = Path(function.__code__.co_filename).parent
        texts = b"".join(digest(file, imported) for file, imported in kernel.texts)
        rest = repr((signature, SETTINGS, *(environment or own_environment()))).encode()
        self.key = blake2b(texts + rest).digest()
        words = (blake2b(one, digest_size=8).hexdigest() for one in (rest, texts))
        self.stem, self.text = f"{Path(function.__code__.co_filename).stem}.{self.name}-{next(words)}-", next(words)

    def load(self, *directories: Path) -> Callable[..., Any] | None:
        """The function from the first file that agrees, of these or the user's directories; None if there is none."""
        loaders: dict[str, Callable[[bytes], Callable[..., Any]]] = {}
        if machine.CAN_LOAD:
            loaders[MACHINE] = lambda body: machine.load(machine.Code.from_bytes(body), self.name, self.module)
        for directory in directories or self._directories():
            for suffix, loader in {**loaders, NUMBA: machine.unpack}.items():
                # Damaged files and folders, and parts of Numba that have changed: the kernel is compiled anew.
                with contextlib.suppress(Exception):
                    content = files.read(directory / (self.stem + self.text + suffix), self.home)
                    if content[:SIZE] == self._digest(content[SIZE:]):
                        return loader(content[SIZE:])
        return None

    def _digest(self, body: bytes) -> bytes:
        return blake2b(body, key=self.key, digest_size=SIZE).digest()

    def save(self, code: machine.Code | bytes) -> None:
        """Write machine code, or a result of Numba, to the first directory that can be written.

        Any number of processes and threads may do it at once.
        """
        body, suffix = (code, NUMBA) if isinstance(code, bytes) else (code.to_bytes(), MACHINE)
        for directory in self._directories():
            try:
                files.write(directory / (self.stem + self.text + suffix), self._digest(body) + body, self.home)
            except OSError:
                continue
            if directory == self._beside():  # delete the code of earlier texts of the file
                for path in directory.glob(f"{self.stem}*"):
                    if path.suffix in (MACHINE, NUMBA) and path.stem != self.stem + self.text:
                        with contextlib.suppress(OSError):  # another process has deleted it, or keeps it open
                            path.unlink()
            return

    def _beside(self) -> Path:
        return self.home / "__pycache__"

    def _directories(self) -> Iterator[Path]:
        chosen = os.environ.get("NUMBA_CACHE_DIR")
        if chosen:
            yield Path(chosen)
            return
        yield self._beside()
        with contextlib.suppress(RuntimeError):  # the user has no home
            yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fastpin"


def place_of(kernel: KernelSource, signature: str) -> StoredCode | None:
    """The place of a kernel's code; None if its text is not in a file any more, or a version is unknown."""
    try:
        return StoredCode(kernel, signature)
    except (OSError, ImportError, RuntimeError):  # RuntimeError: LLVM does not know the processor
        return None


def load_shipped(kernel: KernelSource, signature: str) -> Callable[..., Any] | None:
    """The function from the machine code of a platform wheel; None if none agrees."""
    for level in _shipped_levels():
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


def levels() -> list[str]:
    """Levels of which this processor is, the best first."""
    features = {name.removeprefix("+") for name in machine.target()[-1].split(",")}
    return [level for level, needed in LEVELS.items() if needed <= features]


@functools.cache
def _shipped_levels() -> list[str]:
    """Levels of shipped code that this processor runs. None if Numba is to compile with settings of its own."""
    return [] if _settings() or not SHIPPED.is_dir() else levels()


def _settings() -> list[str]:
    """Environment variables of Numba that may change the code, with their values."""
    settings = sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith("NUMBA_"))
    unrelated = ("NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")
    return [text for text in settings if text.partition("=")[0] not in unrelated]


def _version(package: str) -> str:
    try:
        return (folder(package) / "_version.py").read_text(encoding="utf-8")
    except OSError:
        return metadata.version(package)

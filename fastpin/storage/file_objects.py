"""Files for h5py that keep the errors of the disk.

The HDF5 library does not survive an error of a write: h5py prints a traceback for each open part of the file. Therefore
a file object takes every write. After the first error it keeps the bytes in memory, so that the library reads what it
has written. The error is raised when the library has closed the file. A file that is not large is
made in memory, and written at once.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

_PAGE = 4096


class Overlay:
    """A file with other bytes at some places, in memory.

    Attributes
    ----------
    size : int
        Size of the whole, in bytes.
    """

    def __init__(self, file: int) -> None:
        self._file = file
        self._pages: dict[int, bytearray] = {}
        self.size = os.fstat(file).st_size

    def read(self, size: int, offset: int) -> bytes:
        """Return `size` bytes from `offset` on, or the bytes up to the end."""
        size = max(min(size, self.size - offset), 0)
        data = bytearray(os.pread(self._file, size, offset))
        data.extend(bytes(size - len(data)))
        for number in self._pages.keys() & set(_pages(offset, size)):
            _copy(self._pages[number], number * _PAGE, data, offset)
        return bytes(data)

    def put(self, data: bytes, offset: int) -> None:
        """Put other bytes at `offset`."""
        for number in _pages(offset, len(data)):
            if number not in self._pages:
                page = os.pread(self._file, _PAGE, number * _PAGE)
                self._pages[number] = bytearray(page.ljust(_PAGE, b"\0"))
            _copy(data, offset, self._pages[number], number * _PAGE)


class FileObject:
    """The methods of a file that h5py calls. Derived classes read, write and know the size."""

    def __init__(self) -> None:
        self._place = 0

    def size(self) -> int:
        """Return the size of the file, in bytes."""
        raise NotImplementedError

    def read_at(self, size: int, offset: int) -> bytes:
        """Return `size` bytes from `offset` on, or the bytes up to the end."""
        raise NotImplementedError

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move the place of the next read or write, and return it, in bytes."""
        if whence == io.SEEK_END:
            offset += self.size()
        elif whence == io.SEEK_CUR:
            offset += self._place
        self._place = offset
        return self._place

    def tell(self) -> int:
        """Return the place of the next read or write, in bytes."""
        return self._place

    def readinto(self, buffer: memoryview) -> int:
        """Read into a buffer, and return the number of bytes."""
        data = self.read(len(buffer))
        buffer[: len(data)] = data
        return len(data)

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes, or the rest of the file if `size` is negative."""
        data = self.read_at(size if size >= 0 else self.size() - self._place, self._place)
        self._place += len(data)
        return data

    def flush(self) -> None:
        """Do nothing: the file has no buffer."""


class RestoredFile(FileObject):
    """A file without its unfinished transaction. It can only be read."""

    def __init__(self, content: Overlay) -> None:
        super().__init__()
        self._content = content

    def size(self) -> int:
        """Return the size of the file, in bytes."""
        return self._content.size

    def read_at(self, size: int, offset: int) -> bytes:
        """Return `size` bytes from `offset` on, or the bytes up to the end."""
        return self._content.read(size, offset)


class WrittenFile(FileObject):
    """A file that is written.

    Parameters
    ----------
    file : int
        An open file of the system, to be read and written.

    Attributes
    ----------
    error : OSError or None
        The first error. The file does not change after it.
    """

    def __init__(self, file: int) -> None:
        super().__init__()
        self._file = file
        self._unwritten: Overlay | None = None
        self.error: OSError | None = None

    def size(self) -> int:
        """Return the size of the file, in bytes."""
        return os.fstat(self._file).st_size if self._unwritten is None else self._unwritten.size

    def read_at(self, size: int, offset: int) -> bytes:
        """Return `size` bytes from `offset` on, or the bytes up to the end."""
        return os.pread(self._file, size, offset) if self._unwritten is None else self._unwritten.read(size, offset)

    def write(self, data: memoryview) -> int:
        """Write `data`, and return the number of bytes."""
        if self._unwritten is None:
            try:
                self.write_at(data, self._place)
            except OSError as error:
                self.error = error
                self.keep_in_memory()
        if self._unwritten is not None:
            self._unwritten.size = max(self._unwritten.size, self._place + len(data))
            self._unwritten.put(bytes(data), self._place)
        self._place += len(data)
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        """Set the size of the file, in bytes, and return it."""
        size = self._place if size is None else size
        if self._unwritten is None:
            try:
                self.resize(size)
            except OSError as error:
                self.error = error
                self.keep_in_memory()
        if self._unwritten is not None:
            self._unwritten.size = size
        return size

    def keep_in_memory(self) -> None:
        """Keep all later writes in memory. The file does not change any more."""
        if self._unwritten is None:
            self._unwritten = Overlay(self._file)

    def write_at(self, data: memoryview, offset: int) -> None:
        """Write `data` at `offset`. :class:`OSError` is raised if the disk refuses them."""
        write_all(self._file, data, offset)

    def resize(self, size: int) -> None:
        """Set the size of the file, in bytes. :class:`OSError` is raised if the disk refuses it."""
        os.ftruncate(self._file, size)


@contextmanager
def written_h5(path: Path, large: bool = False) -> Iterator[h5py.File]:
    """Write the HDF5 file `path` anew. The file must exist.

    Parameters
    ----------
    path : Path
    large : bool
        Don't keep the whole file in memory. Each write of the library then calls Python, which takes 10 % more time.

    Raises
    ------
    OSError
        If some bytes could not be written. It is raised when the block has ended.
    """
    file = os.open(path, os.O_RDWR | os.O_TRUNC)
    try:
        if not large:
            with h5py.File(path, "w", driver="core", backing_store=False) as h5:
                yield h5
                h5.flush()
                content = h5.id.get_file_image()
            write_all(file, content, 0)
            return
        written = WrittenFile(file)
        with h5py.File(written, "w") as h5:
            yield h5
        if written.error is not None:
            raise written.error
    finally:
        os.close(file)


def write_all(file: int, data: bytes | memoryview, offset: int) -> None:
    """Write all of `data` into an open file, at `offset`. :class:`OSError` is raised if the disk refuses some."""
    view = memoryview(data)
    while view:
        done = os.pwrite(file, view, offset)
        view, offset = view[done:], offset + done


def _pages(offset: int, size: int) -> range:
    """The numbers of the pages that hold `size` bytes from `offset` on."""
    return range(offset // _PAGE, -(-(offset + size) // _PAGE)) if size else range(0)


def _copy(source: bytes | bytearray, begin: int, target: bytearray, offset: int) -> None:
    """Copy the bytes of `source`, which begins at `begin`, into the part of `target`, at `offset`, that they share."""
    first, last = max(begin, offset), min(begin + len(source), offset + len(target))
    if first < last:
        target[first - offset : last - offset] = source[first - begin : last - begin]

"""A file that changes in transactions. A killed process leaves the file as its last transaction left it.

HDF5 changes its indices in place. A process killed during such a change leaves an unreadable file, and every earlier
state in it is lost. Therefore the old bytes go to a journal beside the file before a part of the file is overwritten.
The next process that opens the file puts the old bytes back. A transaction ends when the journal is emptied. That
happens at once or not at all.
"""

from __future__ import annotations

import contextlib
import io
import os
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import h5py

from fastpin.errors import InputError
from fastpin.model.checks import HDF5_SIGNATURE

fcntl: ModuleType | None
try:
    import fcntl
except ImportError:  # This system has no such locks: no second process may write to the file.
    fcntl = None


# Head of a journal record: place in the file, length of the old bytes, checksums of the old and of the new bytes.
_RECORD = struct.Struct("<QIII")


def journal_of(path: Path) -> Path:
    """Return the path of a file's journal. It stands beside the file itself, also if `path` is a link."""
    real = Path(os.path.realpath(path))
    return real.with_name(real.name + ".journal")


class JournaledFile:
    """A file for h5py. Changes without a commit are undone.

    Parameters
    ----------
    path : Path
    new : bool
        Begin with an empty file. An existing file is emptied.

    Raises
    ------
    InputError
        If another process is writing to the file, or it can't be written.
    """

    def __init__(self, path: Path, new: bool) -> None:
        self._path = path
        self._place = 0
        self._open_transaction = False
        self._abandoned = False
        self._error: OSError | None = None
        try:
            self._file = os.open(path, os.O_RDWR | (os.O_CREAT if new else 0), 0o666)
        except OSError as error:
            raise InputError(str(path), f"can't be written: {error.strerror}") from None
        if not _try_lock(self._file):
            os.close(self._file)
            raise InputError(str(path), "another run is writing to it")
        try:
            self._journal = os.open(journal_of(path), os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            os.close(self._file)
            raise InputError(str(journal_of(path)), f"can't be written: {error.strerror}") from None
        _wait_for(self._journal, exclusive=True)
        if new:
            os.ftruncate(self._journal, 0)
            os.ftruncate(self._file, 0)
        else:
            _roll_back(self._file, self._journal)
        _wait_for(self._journal, exclusive=None)
        self._size = os.fstat(self._file).st_size
        self._written = 0  # bytes of the journal

    def begin(self) -> None:
        """Begin a transaction. Readers wait until it ends."""
        if self._open_transaction:
            return
        _wait_for(self._journal, exclusive=True)
        self._written = 0
        self._note(self._size, b"", b"")
        self._open_transaction = True

    def commit(self) -> None:
        """End the transaction. Everything written since its beginning is now part of the file.

        Raises
        ------
        OSError
            If some bytes could not be written. The transaction is undone, and the file can only be closed.
        """
        if self._error is not None:
            self.abandon()
            raise self._error
        if self._abandoned:
            return
        os.ftruncate(self._journal, 0)
        self._size = os.fstat(self._file).st_size
        self._open_transaction = False
        _wait_for(self._journal, exclusive=None)

    def abandon(self) -> None:
        """Undo the transaction, and ignore all later writes."""
        self._abandoned = True
        with contextlib.suppress(OSError):  # After an error the next process that opens the file does it.
            _roll_back(self._file, self._journal)

    def release(self) -> None:
        """Close the file and give up its locks. Remove the journal if it is empty: nothing must be undone."""
        if not os.fstat(self._journal).st_size:
            journal_of(self._path).unlink(missing_ok=True)
        os.close(self._journal)
        os.close(self._file)

    def _note(self, place: int, old: bytes, new: bytes) -> None:
        record = _RECORD.pack(place, len(old), _checksum(old, place), zlib.crc32(new)) + old
        _write_all(self._journal, record, self._written)
        self._written += len(record)

    # h5py calls the methods below. Its library does not survive an exception in them, so errors wait for the end of
    # the transaction.

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move the place of the next read or write, and return it, in bytes."""
        base = {io.SEEK_SET: 0, io.SEEK_CUR: self._place, io.SEEK_END: os.fstat(self._file).st_size}[whence]
        self._place = base + offset
        return self._place

    def tell(self) -> int:
        """Return the place of the next read or write, in bytes."""
        return self._place

    def readinto(self, buffer: memoryview) -> int:
        """Read into a buffer, and return the number of bytes."""
        data = os.pread(self._file, len(buffer), self._place)
        buffer[: len(data)] = data
        self._place += len(data)
        return len(data)

    def read(self, size: int = -1) -> bytes:
        """Read `size` bytes, or the rest of the file if `size` is negative."""
        data = os.pread(self._file, size if size >= 0 else os.fstat(self._file).st_size - self._place, self._place)
        self._place += len(data)
        return data

    def write(self, data: memoryview) -> int:
        """Write `data`, and return the number of bytes. The overwritten bytes go to the journal first."""
        size = len(data)
        if not self._abandoned and self._error is None:
            try:
                self.begin()
                old = min(size, self._size - self._place)
                if old > 0:
                    self._note(self._place, os.pread(self._file, old, self._place), bytes(data[:old]))
                _write_all(self._file, bytes(data), self._place)
            except OSError as error:
                self._error = error
        self._place += size
        return size

    def truncate(self, size: int | None = None) -> int:
        """Set the size of the file, in bytes, and return it. A removed end goes to the journal first."""
        size = self._place if size is None else size
        if not self._abandoned and self._error is None:
            try:
                self.begin()
                if size < self._size:
                    self._note(size, os.pread(self._file, self._size - size, size), b"")
                os.ftruncate(self._file, size)
            except OSError as error:
                self._error = error
        return size

    def flush(self) -> None:
        """Do nothing: the file has no buffer."""


@contextmanager
def consistent_view(path: Path) -> Iterator[None]:
    """Keep a file as its last transaction left it during the block, for a reader.

    A run that is writing to the file waits until the block ends. An unfinished transaction of a killed process is
    undone first.

    Raises
    ------
    InputError
        If a process was killed during a transaction, and the transaction can't be undone because the file can't be
        written.
    """
    journal = journal_of(path)
    if not journal.is_file():
        yield
        return
    with journal.open("rb") as locked:
        _wait_for(locked.fileno(), exclusive=False)
        if os.fstat(locked.fileno()).st_size:  # No process is writing, and one was killed during a transaction.
            _wait_for(locked.fileno(), exclusive=True)
            try:
                with path.open("r+b") as file, journal.open("r+b") as writable:
                    _roll_back(file.fileno(), writable.fileno())
            except OSError as error:
                message = f"was being written when its run was killed, and can't be put right: {error.strerror}"
                raise InputError(str(path), message) from None
            _wait_for(locked.fileno(), exclusive=False)
        yield


def open_h5(path: Path) -> h5py.File:
    """Open an HDF5 file for reading, also while a run is writing to it; see :func:`consistent_view`.

    Raises
    ------
    InputError
        If it is no whole HDF5 file.
    """
    try:
        return h5py.File(path, "r", locking=False)
    except OSError:
        pass
    try:
        return h5py.File(path, "r")  # This process has the file open already, with locks.
    except OSError:
        raise not_readable(path) from None


def not_readable(path: Path) -> InputError:
    """Return the error of a file that can't be opened as an HDF5 file."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        start = file.read(len(HDF5_SIGNATURE))
        if not start:
            return InputError(str(path), "is empty, and no result")
        if start == HDF5_SIGNATURE:
            return InputError(str(path), "is damaged or cut short")
        if path.suffix == ".toml":
            return InputError(str(path), f"is no result; of a case file, fastpin run {path} -o FILE makes one")
        return InputError(str(path), "is no HDF5 file, and no result")
    return InputError(str(path), "can't be read")


def check_free(path: Path) -> None:
    """Raise :class:`InputError` if another process is writing to a file."""
    if is_being_written(path):
        raise InputError(str(path), "another run is writing to it")


def is_being_written(path: Path) -> bool:
    """Return whether another process is writing to a file, as far as its lock tells."""
    if fcntl is None or not path.is_file():
        return False
    with path.open("rb") as file:
        return not _try_lock(file.fileno())


def _wait_for(journal: int, exclusive: bool | None) -> None:
    """Wait for the lock of a journal: exclusive to write the file, shared to read it. None gives the lock back."""
    if fcntl is not None:
        kind = {True: fcntl.LOCK_EX, False: fcntl.LOCK_SH, None: fcntl.LOCK_UN}[exclusive]
        with contextlib.suppress(OSError):  # The file system may have no locks.
            fcntl.flock(journal, kind)


def _roll_back(file: int, journal: int) -> None:
    """Put back the bytes that an unfinished transaction has overwritten, the latest first.

    The journal may come from an older file of the same name. Then a part of the file has neither the old nor the new
    bytes of its record, and the file stays unchanged. Either way the journal is emptied.
    """
    records = list(_records(os.pread(journal, os.fstat(journal).st_size, 0)))
    restored: list[tuple[int, bytes]] = []
    ours = bool(records) and os.fstat(file).st_size >= records[0][0]
    for number, (place, old, new) in reversed(list(enumerate(records[1:], start=1))):
        now = _as_restored(os.pread(file, len(old), place), place, restored)
        latest = number == len(records) - 1  # Its new bytes may have been written in part.
        ours &= latest or now == old or zlib.crc32(now) == new
        restored.append((place, old))
    if ours:
        for place, old in restored:
            _write_all(file, old, place)
        os.ftruncate(file, records[0][0])
    os.ftruncate(journal, 0)


def _as_restored(now: bytes, place: int, restored: list[tuple[int, bytes]]) -> bytes:
    """Return the bytes `now` of a part of a file, as they are after other parts were restored in order."""
    part = bytearray(now)
    for begin, old in restored:
        first, last = max(begin, place), min(begin + len(old), place + len(now))
        if first < last:
            part[first - place : last - place] = old[first - begin : last - begin]
    return bytes(part)


def _records(data: bytes) -> Iterator[tuple[int, bytes, int]]:
    """Yield place, old bytes and checksum of the new bytes of each whole record of a journal.

    The last record may be cut short. Then its part of the file was not overwritten yet.
    """
    at = 0
    while at + _RECORD.size <= len(data):
        place, length, checksum, new = _RECORD.unpack_from(data, at)
        old = data[at + _RECORD.size : at + _RECORD.size + length]
        if len(old) < length or _checksum(old, place) != checksum:
            return
        yield place, old, new
        at += _RECORD.size + length


def _checksum(old: bytes, place: int) -> int:
    return zlib.crc32(old, place & 0xFFFFFFFF)


def _write_all(file: int, data: bytes, place: int) -> None:
    view = memoryview(data)
    while view:
        done = os.pwrite(file, view, place)
        view, place = view[done:], place + done


def _try_lock(file: int) -> bool:
    """Take the writer's lock. Return False if another process has it."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # The file system has no locks.
        return True
    return True

"""A file that changes in transactions. A killed process leaves the file as its last transaction left it.

HDF5 changes its indices in place. A process killed during such a change leaves an unreadable file, and every earlier
state in it is lost. Therefore the old bytes go to a journal beside the file before a part of the file is overwritten.
The next process that writes to the file puts the old bytes back. A reader only takes them in place of the new ones: it
writes nothing. A transaction ends when the journal is emptied. That happens at once or not at all.
"""

from __future__ import annotations

import contextlib
import os
import stat
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from fastpin.errors import InputError, OutputError
from fastpin.model.checks import file_path
from fastpin.model.inputs import HDF5_SIGNATURE
from fastpin.storage.file_objects import Overlay, RestoredFile, WrittenFile, write_all
from fastpin.storage.files import NO_LINK, fcntl, is_locked, try_lock

# Head of a journal record: place in the file, length of the old bytes, checksums of the old and of the new bytes.
_RECORD = struct.Struct("<QIII")

MOST_BYTES = 1 << 30
"""Most bytes of a journal. A transaction overwrites at most a restart: some 90 MB with 20,000 nodes."""

MOST_NOTES = 1_000_000
"""Most records of a journal that are undone. A transaction writes a few thousand times."""


def journal_of(path: Path) -> Path:
    """Return the path of a file's journal. It stands beside the file itself, also if `path` is a link."""
    real = Path(os.path.realpath(path))
    return real.with_name(real.name + ".journal")


class JournaledFile(WrittenFile):
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
        self._open_transaction = False
        self._abandoned = False
        try:
            file = os.open(path, os.O_RDWR | (os.O_CREAT if new else 0), 0o666)
        except OSError as error:
            raise InputError(str(path), f"can't be written: {error.strerror}") from None
        super().__init__(file)
        if not try_lock(file):
            os.close(file)
            raise InputError(str(path), "another run is writing to it")
        try:
            self._journal = _open_journal(path, os.O_RDWR | os.O_CREAT)
        except InputError:
            os.close(self._file)
            raise
        _wait_for(self._journal, exclusive=True)
        try:
            self._begin(new)
        except InputError:
            os.close(self._journal)
            os.close(self._file)
            raise
        _wait_for(self._journal, exclusive=None)
        self._size = os.fstat(self._file).st_size
        self._written = 0  # bytes of the journal

    def _begin(self, new: bool) -> None:
        """Empty the file if it is `new`, else undo an unfinished transaction."""
        if new:
            os.ftruncate(self._journal, 0)
            os.ftruncate(self._file, 0)
        else:
            _roll_back(self._file, self._journal, journal_of(self._path))

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
        OutputError
            If some bytes could not be written. The transaction is undone, and the file can only be closed.
        """
        if self.error is not None:
            self.abandon()
            raise OutputError(str(self._path), f"can't be written: {self.error.strerror}")
        if self._abandoned:
            return
        os.ftruncate(self._journal, 0)
        self._size = os.fstat(self._file).st_size
        self._open_transaction = False
        _wait_for(self._journal, exclusive=None)

    def abandon(self) -> None:
        """Keep all later writes in memory. :meth:`release` undoes the transaction: h5py has closed the file by then."""
        self._abandoned = True
        self.keep_in_memory()

    def release(self) -> None:
        """Close the file and give up its locks. Undo a transaction that was abandoned.

        Remove the journal if it is empty: nothing must be undone.
        """
        if self._abandoned:
            # After an error the next process that writes to the file does it.
            with contextlib.suppress(OSError, InputError):
                _roll_back(self._file, self._journal, journal_of(self._path))
        if not os.fstat(self._journal).st_size:
            journal_of(self._path).unlink(missing_ok=True)
        os.close(self._journal)
        os.close(self._file)

    def _note(self, offset: int, old: bytes, new: bytes) -> None:
        record = _RECORD.pack(offset, len(old), _checksum(old, offset), zlib.crc32(new)) + old
        write_all(self._journal, record, self._written)
        self._written += len(record)

    def write_at(self, data: memoryview, offset: int) -> None:
        """Write `data` at `offset`. The overwritten bytes go to the journal first."""
        self.begin()
        old = min(len(data), self._size - offset)
        if old > 0:
            self._note(offset, os.pread(self._file, old, offset), bytes(data[:old]))
        super().write_at(data, offset)

    def resize(self, size: int) -> None:
        """Set the size of the file, in bytes. A removed end goes to the journal first."""
        self.begin()
        if size < self._size:
            self._note(size, os.pread(self._file, self._size - size, size), b"")
        super().resize(size)


@contextmanager
def open_h5(path: Path) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading, as its last transaction left it. Nothing is written.

    A run that is writing to the file waits until the block ends. The unfinished transaction of a killed process is
    undone in memory. The next writer undoes it in the file.

    Raises
    ------
    InputError
        If it is no whole HDF5 file, or its journal is no ordinary file.
    """
    with contextlib.ExitStack() as stack:
        restored = _restored(path, stack)
        with _opened(path, restored) as file:
            yield file


def _restored(path: Path, stack: contextlib.ExitStack) -> RestoredFile | None:
    """Lock the journal of a file, if there is one. Return the file without its unfinished transaction, if it has one.

    `stack` gives back the lock, and closes the files.
    """
    try:
        journal = _open_journal(path, os.O_RDONLY)
    except FileNotFoundError:
        return None
    stack.callback(os.close, journal)
    _wait_for(journal, exclusive=False)
    if not os.fstat(journal).st_size:
        return None
    try:
        file = os.open(path, os.O_RDONLY)
    except OSError as error:
        raise InputError(str(path), f"can't be read: {error.strerror}") from None
    stack.callback(os.close, file)
    undone = _undone(file, _notes(journal, journal_of(path)))
    return None if undone is None else RestoredFile(undone)


def _opened(path: Path, restored: RestoredFile | None) -> h5py.File:
    """Open an HDF5 file for reading, or the file `restored` in its place."""
    if restored is not None:
        try:
            return h5py.File(restored, "r")
        except OSError:
            restored.seek(0)
            raise _not_readable(path, restored.read(len(HDF5_SIGNATURE))) from None
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
    try:
        with path.open("rb") as file:
            return _not_readable(path, file.read(len(HDF5_SIGNATURE)))
    except OSError:
        return InputError(str(path), "can't be read")


def _not_readable(path: Path, start: bytes) -> InputError:
    """Return the error of a file with these first bytes that can't be opened as an HDF5 file."""
    if not start:
        return InputError(str(path), "is empty, and no result; if its run was killed, start it again")
    if start == HDF5_SIGNATURE:
        return InputError(str(path), "is damaged or cut short")
    if path.suffix == ".toml":
        return InputError(str(path), f"is no result; fastpin run, or joint, {path} -o FILE makes one")
    return InputError(str(path), "is no HDF5 file, and no result")


def is_empty(path: Path) -> bool:
    """Whether a file has no bytes, or had none before the unfinished transaction of a killed process.

    Raises
    ------
    InputError
        If its journal is no ordinary file.
    """
    with contextlib.ExitStack() as stack:
        restored = _restored(path, stack)
        return not (path.stat().st_size if restored is None else restored.size())


def is_being_written(path: Path) -> bool:
    """Return whether another process is writing to a file, as far as its lock tells."""
    return is_locked(file_path("path", path))


def _wait_for(journal: int, exclusive: bool | None) -> None:
    """Wait for the lock of a journal: exclusive to write the file, shared to read it. None gives the lock back."""
    if fcntl is not None:
        kind = {True: fcntl.LOCK_EX, False: fcntl.LOCK_SH, None: fcntl.LOCK_UN}[exclusive]
        with contextlib.suppress(OSError):  # The file system may have no locks.
            fcntl.flock(journal, kind)


def _open_journal(path: Path, flags: int) -> int:
    """Open the journal of the file `path`, with the flags of :func:`os.open`.

    A journal may come with the file of a stranger. Therefore no link is followed, and a journal that is written must
    have no other name.

    Raises
    ------
    InputError
        If the journal is no ordinary file, or can't be opened.
    FileNotFoundError
        If there is no journal, and the flags don't make one.
    """
    journal = journal_of(path)
    kind = "read" if flags == os.O_RDONLY else "written"
    try:
        check_beside(journal)
        # A link is not followed, and a pipe not waited for, where the system knows these flags.
        file = os.open(journal, flags | NO_LINK | getattr(os, "O_NONBLOCK", 0), 0o666)
    except OSError as error:
        if isinstance(error, FileNotFoundError) and kind == "read":
            raise
        raise InputError(str(journal), f"can't be {kind}: {error.strerror}") from None
    found = os.fstat(file)
    if stat.S_ISREG(found.st_mode) and (kind == "read" or found.st_nlink <= 1):
        return file
    os.close(file)
    raise InputError(str(journal), "must be an ordinary file with one name")


def check_beside(path: Path) -> None:
    """Raise :class:`InputError` if a file that a run keeps beside its result exists, and is no ordinary file."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISREG(mode):
        raise InputError(str(path), "must be an ordinary file; please remove it")


Note = tuple[int, bytes, int]
"""Place, old bytes, and checksum of the new bytes of a record of a journal."""


def _roll_back(file: int, journal: int, path: Path) -> None:
    """Put back the bytes that an unfinished transaction has overwritten, the latest first. Empty the journal.

    `path` is the path of the journal.
    """
    notes = _notes(journal, path)
    if _undone(file, notes) is not None:
        for place, old, _ in reversed(notes[1:]):
            write_all(file, old, place)
        os.ftruncate(file, notes[0][0])
    os.ftruncate(journal, 0)


def _undone(file: int, notes: list[Note]) -> Overlay | None:
    """Return the content of a file without the transaction of its journal. None if the journal is not the file's own.

    The journal may come from an older file of the same name. Then a part of the file has neither the old nor the new
    bytes of its record.
    """
    content = Overlay(file)
    if not notes or content.size < notes[0][0]:
        return None
    for number, (place, old, new) in reversed(list(enumerate(notes[1:], start=1))):
        now = content.read(len(old), place)
        latest = number == len(notes) - 1  # Its new bytes may have been written in part.
        if not (latest or now == old or zlib.crc32(now) == new):
            return None
        content.put(old, place)
    content.size = notes[0][0]
    return content


def _notes(journal: int, path: Path) -> list[Note]:
    """Return all whole records of a journal. The first one holds the size of the file.

    The last record may be cut short. Then its part of the file was not overwritten yet. `path` is the path of the
    journal.

    Raises
    ------
    InputError
        If the journal is larger than that of any transaction.
    """
    size = os.fstat(journal).st_size
    if size > MOST_BYTES:
        raise InputError(
            str(path), f"has {size} bytes, and no transaction needs more than {MOST_BYTES}; please remove it"
        )
    data = os.pread(journal, size, 0)
    notes: list[Note] = []
    at = 0
    while at + _RECORD.size <= len(data):
        place, length, checksum, new = _RECORD.unpack_from(data, at)
        old = data[at + _RECORD.size : at + _RECORD.size + length]
        within = bool(length) and place + length <= notes[0][0] if notes else not length
        if not within or len(old) < length or _checksum(old, place) != checksum:
            break
        if len(notes) > MOST_NOTES:
            raise InputError(str(path), f"has more than {MOST_NOTES} records, as no transaction has; please remove it")
        notes.append((place, old, new))
        at += _RECORD.size + length
    return notes


def _checksum(old: bytes, offset: int) -> int:
    return zlib.crc32(old, offset & 0xFFFFFFFF)

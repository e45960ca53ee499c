"""The journal of a file: wherever a process dies, the file is as it was after its last transaction."""

from __future__ import annotations

import errno
import os
import struct
import zlib
from pathlib import Path

import h5py
import pytest

from fastpin.errors import InputError, OutputError
from fastpin.storage import journal
from fastpin.storage.files import check_free
from fastpin.storage.journal import JournaledFile, journal_of
from tests.support.processes import python, started
from tests.support.rows import ARRAYS, ROWS, SIZE, rows_in

Torn = tuple[Path, bytes, bytes, bytes]
"""The path of a file whose process has died in a transaction, what it was, what it is, and its journal."""


class Machine:
    """Sees every change of the file and its journal, and can make the disk as it was after any of them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.changes: list[tuple[str, int, int, bytes]] = []  # what, whose, place, data
        self.transactions: list[int] = []  # changes until the end of each
        self._names: dict[int, int] = {}
        self._pwrite, self._truncate = os.pwrite, os.ftruncate
        monkeypatch.setattr(journal.os, "pwrite", self.pwrite)
        monkeypatch.setattr(journal.os, "ftruncate", self.ftruncate)

    def pwrite(self, file: int, data: bytes, place: int) -> int:
        data = bytes(data)[:4096]  # not all at once
        self.changes.append(("write", self._whose(file), place, data))
        return self._pwrite(file, data, place)

    def ftruncate(self, file: int, size: int) -> None:
        self.changes.append(("cut", self._whose(file), size, b""))
        self._truncate(file, size)

    def _whose(self, file: int) -> int:
        return int(Path(f"/proc/self/fd/{file}").readlink().suffix == ".journal")

    def disks(self) -> list[tuple[bytes, bytes]]:
        """File and journal after every change."""
        now = [bytearray(), bytearray()]
        disks = []
        for what, whose, place, data in self.changes:
            content = now[whose]
            end = place + len(data)
            if what == "cut":
                del content[end:]
            content.extend(bytes(max(end - len(content), 0)))
            content[place:end] = data
            disks.append((bytes(now[0]), bytes(now[1])))
        return disks


def written(path: Path, transactions: int, machine: Machine | None = None) -> None:
    """A file that grows by a row in every transaction."""
    file = JournaledFile(path, new=True)
    h5 = h5py.File(file, "w")
    how = {"maxshape": (None, SIZE), "chunks": (1, SIZE), "dtype": float, "compression": "gzip", "shuffle": True}
    arrays = [h5.create_dataset(f"array{k}", (0, SIZE), **how) for k in range(ARRAYS)]
    for count in range(transactions + 1):
        for array in arrays if count else ():
            array.resize(count, axis=0)
            array[count - 1] = ROWS[count - 1]
        h5.attrs["rows"] = count
        h5.flush()
        file.commit()
        if machine is not None:
            machine.transactions.append(len(machine.changes))
    h5.close()
    file.commit()
    file.release()


@pytest.mark.survey
def test_a_process_may_die_after_any_change(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every single moment: 75 transactions are enough for the index of the rows to split."""
    machine = Machine(monkeypatch)
    written(path, 75, machine)
    monkeypatch.undo()
    unreadable = torn = 0
    for place, (content, kept) in enumerate(machine.disks(), start=1):
        if place % 3 and place < 0.8 * len(machine.changes):  # all where the index splits
            continue
        done = sum(end <= place for end in machine.transactions)
        if done == 0:
            continue
        path.write_bytes(content)
        unreadable += not readable(path)
        torn += bool(kept)
        journal_of(path).write_bytes(kept)
        assert rows_in(path) in (done - 1, done)
    assert torn > 500
    assert unreadable > 50  # without the journal all that had been written would have been lost


def readable(path: Path) -> bool:
    try:
        with h5py.File(path, "r") as h5:
            return all(len(h5[f"array{k}"][()]) >= 0 for k in range(ARRAYS))
    except (OSError, RuntimeError):
        return False


@pytest.mark.parametrize("cut", [1, 10, 15, 16, 17, 500])
def test_what_a_dead_process_has_half_noted_counts_for_nothing(torn: Torn, cut: int) -> None:
    path, before, changed, kept = torn
    path.write_bytes(before)  # the last change had been noted in part, and not been made
    journal_of(path).write_bytes(kept[:-cut])
    assert rows_in(path) == 5
    path.write_bytes(changed)
    journal_of(path).write_bytes(kept + b"more" * 3)
    assert rows_in(path) == 5
    assert path.read_bytes() == changed  # a reader writes nothing
    JournaledFile(path, new=False).release()
    assert path.read_bytes() == before
    assert rows_in(path) == 5


def test_a_transaction_that_only_makes_the_file_longer_is_undone(path: Path) -> None:
    file = JournaledFile(path, new=True)
    file.write(memoryview(b"0123456789"))
    file.commit()
    file.truncate(20)
    assert path.stat().st_size == 20
    file.abandon()
    file.release()
    assert path.read_bytes() == b"0123456789"


def test_a_full_disk_leaves_what_was_there(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(path, 5)
    file = JournaledFile(path, new=False)
    h5 = h5py.File(file, "r+")

    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(journal.os, "pwrite", full)
        h5["array0"].resize(6, axis=0)
        h5["array0"][5] = 1.0
        h5.flush()
        with pytest.raises(OutputError, match=r"a\.h5: can't be written: No space"):
            file.commit()
        h5.close()
    file.release()
    assert rows_in(path) == 5
    assert not journal_of(path).exists()


def test_one_writer_at_a_time(path: Path) -> None:
    written(path, 2)
    file = JournaledFile(path, new=False)
    for new in (False, True):
        with pytest.raises(InputError, match="another run is writing"):
            JournaledFile(path, new)
    assert rows_in(path) == 2
    file.release()
    JournaledFile(path, new=False).release()


READER = """
import fcntl, pathlib, sys
from tests.support.rows import rows_in
flock = fcntl.flock
def told(file, kind):
    if kind & fcntl.LOCK_NB:
        return flock(file, kind)
    try:
        flock(file, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        print("waits", flush=True)
        flock(file, kind)
fcntl.flock = told
print(rows_in(pathlib.Path(sys.argv[1])))
"""
"""Tells before it waits for a lock."""


@pytest.mark.gate
def test_readers_wait_for_the_end_of_a_transaction(path: Path) -> None:
    written(path, 2)
    file = JournaledFile(path, new=False)
    h5 = h5py.File(file, "r+")
    h5.attrs["rows"] = 1
    for k in range(ARRAYS):
        h5[f"array{k}"].resize(1, axis=0)
    h5.flush()  # in the midst of a transaction
    with started(python(READER, path)) as reader:
        assert reader.stdout.readline() == "waits\n"
        file.commit()
        assert reader.communicate() == ("1\n", "")
    h5.close()
    file.commit()
    file.release()


@pytest.fixture
def torn(path: Path) -> Torn:
    written(path, 5)
    before = path.read_bytes()
    file = JournaledFile(path, new=False)
    h5 = h5py.File(file, "r+")
    for k in range(ARRAYS):
        h5[f"array{k}"].resize(6, axis=0)
        h5[f"array{k}"][5] = ROWS[5]
    h5.attrs["rows"] = 6
    h5.flush()
    changed, kept = path.read_bytes(), journal_of(path).read_bytes()
    file.abandon()
    h5.close()
    file.release()
    assert changed != before
    assert path.read_bytes() == before
    path.write_bytes(changed)
    journal_of(path).write_bytes(kept)
    return path, before, changed, kept


@pytest.mark.parametrize("rows", [1, 4, 5, 7, 80])
def test_the_journal_of_another_file_does_no_harm(torn: Torn, rows: int) -> None:
    path, _, _, kept = torn
    other = path.with_name("b.h5")
    written(other, rows)
    content = other.read_bytes()
    path.write_bytes(content)
    assert rows_in(path) == rows
    assert path.read_bytes() == content
    assert journal_of(path).read_bytes() == kept
    JournaledFile(path, new=False).release()
    assert path.read_bytes() == content


def test_links_lead_to_the_journal_of_the_file(torn: Torn, tmp_path: Path) -> None:
    path, before, changed, _ = torn
    (tmp_path / "below").mkdir()
    link = tmp_path / "below" / "link.h5"
    link.symlink_to(path)
    assert journal_of(link) == journal_of(path)
    assert rows_in(link) == 5
    assert path.read_bytes() == changed
    JournaledFile(link, new=False).release()
    assert path.read_bytes() == before


def test_a_file_is_being_written_while_its_writer_has_it(path: Path) -> None:
    assert not journal.is_being_written(path)  # there is none yet
    written(path, 2)
    writer = JournaledFile(path, new=False)
    assert journal.is_being_written(path)
    writer.release()
    assert not journal.is_being_written(path)


def test_file_systems_without_locks(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(journal.fcntl, "flock", refuse)
    written(path, 3)
    assert rows_in(path) == 3
    check_free(path)


def test_a_journal_that_can_not_be_written(path: Path) -> None:
    written(path, 2)
    journal_of(path).mkdir()
    for _ in range(2):  # and the lock is given back
        with pytest.raises(InputError, match=r"a\.h5\.journal: must be an ordinary file; please remove it"):
            JournaledFile(path, new=False)
    journal_of(path).rmdir()
    JournaledFile(path, new=False).release()


def test_missing_and_unwritable_files(tmp_path: Path) -> None:
    for path, new in ((tmp_path / "none" / "a.h5", True), (tmp_path / "a.h5", False), (tmp_path, True)):
        with pytest.raises(InputError, match="can't be written"):
            JournaledFile(path, new)


@pytest.mark.parametrize("kind", ["link", "pipe", "device", "second name"])
def test_a_journal_that_is_no_ordinary_file_is_refused(torn: Torn, kind: str) -> None:
    """A stranger's folder may hold a link to a file of the user beside a result."""
    path, _, changed, kept = torn
    precious = path.with_name("precious.txt")
    precious.write_bytes(kept)
    beside = journal_of(path)
    beside.unlink()
    if kind == "pipe":
        os.mkfifo(beside)
    elif kind == "second name":
        os.link(precious, beside)
    else:
        beside.symlink_to(precious if kind == "link" else "/dev/zero")
    if kind != "second name":  # reading such a file does no harm
        with pytest.raises(InputError, match=r"a\.h5\.journal: must be an ordinary file"):
            rows_in(path)
    for new in (False, True):
        with pytest.raises(InputError, match=r"a\.h5\.journal: must be an ordinary file"):
            JournaledFile(path, new)
    assert precious.read_bytes() == kept
    assert path.read_bytes() == changed


def test_a_reader_needs_no_right_to_write(torn: Torn, monkeypatch) -> None:
    path, _, changed, kept = torn

    def forbidden(*_: object) -> None:
        raise AssertionError("a reader wrote")

    with monkeypatch.context() as patch:
        for name in ("pwrite", "ftruncate", "unlink"):
            patch.setattr(journal.os, name, forbidden)
        assert rows_in(path) == 5
    assert (path.read_bytes(), journal_of(path).read_bytes()) == (changed, kept)


def test_a_file_without_a_transaction_is_empty_again(path: Path) -> None:
    file = JournaledFile(path, new=True)
    file.begin()
    kept = journal_of(path).read_bytes()
    file.abandon()
    file.release()
    path.write_bytes(b"begun")
    journal_of(path).write_bytes(kept)
    with pytest.raises(InputError, match="is empty, and no result"):
        rows_in(path)
    assert journal.is_empty(path)
    assert path.read_bytes() == b"begun"


@pytest.mark.parametrize(
    "records", [[(2**40, b"")], [(0, b"x" * 50)], [(50, b""), (2**62, b"x")], [(50, b""), *[(0, b"")] * 9]]
)
def test_records_beyond_the_file_are_not_undone(path: Path, records: list[tuple[int, bytes]]) -> None:
    written(path, 3)
    before = path.read_bytes()
    content = b""
    for place, old in records:
        content += struct.pack("<QIII", place, len(old), zlib.crc32(old, place & 0xFFFFFFFF), 0) + old
    journal_of(path).write_bytes(content)
    size = records[0][0]
    if len(records) == 1 or size > len(before):
        assert rows_in(path) == 3
    else:
        with pytest.raises(InputError, match="is damaged or cut short"):
            rows_in(path)  # the journal says that the file had 50 bytes
    assert path.read_bytes() == before


@pytest.mark.parametrize("latest", [b"old2", b"new2", b"neX?"])
@pytest.mark.parametrize("first", [b"old1", b"new1", b"neX?"])
def test_bytes_that_are_neither_old_nor_new_belong_to_another_file(path: Path, first: bytes, latest: bytes) -> None:
    """A dead process may have written a part of the last record only. All records before it are whole."""
    path.write_bytes(first + latest)
    content = struct.pack("<QIII", 8, 0, zlib.crc32(b"", 8), 0)
    for place, old, new in ((0, b"old1", b"new1"), (4, b"old2", b"new2")):
        content += struct.pack("<QIII", place, 4, zlib.crc32(old, place), zlib.crc32(new)) + old
    journal_of(path).write_bytes(content)
    JournaledFile(path, new=False).release()
    assert path.read_bytes() == (first + latest if first == b"neX?" else b"old1old2")


@pytest.mark.parametrize(("limit", "reason"), [("MOST_BYTES", "has .* bytes"), ("MOST_NOTES", "has more than 2 rec")])
def test_a_journal_larger_than_any_is_refused(torn, monkeypatch: pytest.MonkeyPatch, limit: str, reason: str) -> None:
    path, _, changed, kept = torn
    monkeypatch.setattr(journal, limit, 2)
    for read in (rows_in, lambda path: JournaledFile(path, new=False)):
        with pytest.raises(InputError, match=rf"a\.h5\.journal: {reason}"):
            read(path)
    assert (path.read_bytes(), journal_of(path).read_bytes()) == (changed, kept)
    monkeypatch.undo()
    assert rows_in(path) == 5

"""Indices of sweeps that come from strangers: reading writes nothing, and no query runs their expressions."""

import os
import shutil
import signal
import sqlite3
import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest

from fastpin.errors import InputError
from fastpin.storage import packed as databases
from fastpin.storage.files import INDEX
from fastpin.storage.packed import open_database
from fastpin.studies import sweep
from fastpin.studies.index import Index
from fastpin.studies.plan import Plan, parse_plan
from tests.support.files import contents
from tests.support.processes import finished, python

PAGE = 16  # place of the page size in the header
RUN = "0123456789abcdef"


@pytest.fixture
def plan() -> Plan:
    return parse_plan('title = "t"\n[grid]\ncontact.friction = [0.2, 0.3]\nsolve.nodes = [41]\n')


@pytest.fixture
def victim(tmp_path: Path) -> Iterator[Path]:
    """A file of the user, which must stay as it is."""
    path = tmp_path / "precious.txt"
    path.write_bytes(b"\xd9keep")
    yield path
    assert path.read_bytes() == b"\xd9keep"


@pytest.fixture
def directory(plan: Plan, tmp_path: Path) -> Path:
    folder = tmp_path / "swept"
    folder.mkdir()
    with Index(folder, write=True) as index:
        index.expect(plan, plan.points)
    return folder


def journal_of(directory: Path) -> Path:
    return directory / f"{INDEX}-journal"


def name_super_journal(directory: Path, victim: Path) -> None:
    """Leave the journal of a killed transaction over several databases, whose super-journal is another file."""
    content = (directory / INDEX).read_bytes()
    page = struct.unpack(">H", content[PAGE : PAGE + 2])[0]
    magic, name = bytes.fromhex("d9d505f920a163d7"), os.fsencode(victim)
    head = (magic + struct.pack(">5I", 0, 1, len(content) // page, 512, page)).ljust(512, b"\0")
    end = struct.pack(">I", 0x40000000 // page + 1) + name + struct.pack(">II", len(name), sum(name)) + magic
    journal_of(directory).write_bytes(head + end)


READERS: dict[str, Callable[[Plan, Path, Path], object]] = {
    "load": lambda plan, directory, other: sweep.load(directory),
    "status": lambda plan, directory, other: sweep.status(plan, directory),
    "rows": lambda plan, directory, other: sweep.rows(plan, directory),
    "merge": lambda plan, directory, other: sweep.merge([directory], other),
}


@pytest.mark.parametrize("reader", READERS)
def test_a_reader_deletes_no_file_that_a_journal_names(reader, plan, directory, victim, tmp_path):
    name_super_journal(directory, victim)
    before = contents(directory)
    with pytest.raises(InputError, match=r"index.sqlite: can't be used: its journal names another file"):
        READERS[reader](plan, directory, tmp_path / "other")
    assert contents(directory) == before


@pytest.mark.parametrize("name", [INDEX, "lock"])
def test_a_writer_deletes_no_file_that_a_journal_names(name: str, plan: Plan, directory: Path, victim: Path) -> None:
    if name == "lock":
        shutil.copyfile(directory / INDEX, directory / "lock")
    name_super_journal(directory, victim)
    journal_of(directory).rename(directory / f"{name}-journal")
    with pytest.raises(InputError, match="its journal names another file that SQLite would delete"):
        sweep.run(plan, directory, workers=1)


@pytest.mark.parametrize("first", [b"", b"\0", b"\xd9"])
def test_a_journal_that_is_a_link_is_refused(first: bytes, plan: Plan, directory: Path, tmp_path: Path) -> None:
    victim = tmp_path / "precious.bin"
    victim.write_bytes(first + b"keep")
    journal_of(directory).symlink_to(victim)
    for use in (lambda: sweep.load(directory), lambda: sweep.run(plan, directory, workers=1)):
        with pytest.raises(InputError, match=r"index.sqlite-journal: must be an ordinary file, not a link"):
            use()
    assert victim.read_bytes() == first + b"keep"


@pytest.mark.parametrize("ending", ["-wal", "-shm"])
@pytest.mark.parametrize("name", [INDEX, "lock"])
def test_a_log_beside_a_database_without_one_is_refused(name, ending, plan, directory, victim):
    """SQLite uses a log although the header of the database has none. As a link it leads out of the directory."""
    (directory / f"{name}{ending}").symlink_to(victim)
    before = contents(directory)
    uses = [lambda: sweep.run(plan, directory, workers=1), lambda: sweep.load(directory)]
    for use in uses if name == INDEX else uses[:1]:
        with pytest.raises(InputError, match=f"{ending}: is a write-ahead log, which fastpin never makes"):
            use()
    assert contents(directory).keys() - before.keys() <= {"lock"}


@pytest.mark.parametrize("name", [INDEX, "lock"])
@pytest.mark.parametrize("there", [False, True])
def test_a_writer_follows_no_link(name: str, there: bool, plan: Plan, directory: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside.sqlite"
    (directory / name).unlink(missing_ok=True)
    (directory / name).symlink_to(outside)
    if there:
        outside.write_bytes(b"")
    with pytest.raises(InputError, match=f"{name}: must be an ordinary file to be written, not a link"):
        sweep.run(plan, directory, workers=1)
    assert (outside.read_bytes() if there else outside.exists()) == (b"" if there else False)


KILLED = """
import os, signal, sqlite3, sys
database = sqlite3.connect(sys.argv[1], isolation_level=None)
database.execute("PRAGMA cache_size = 1")
database.execute("PRAGMA cache_spill = 1")
database.execute("BEGIN IMMEDIATE")
database.execute("UPDATE sweep SET value = 'half done' WHERE name = 'title'")
database.execute("UPDATE runs SET reason = hex(zeroblob(20000))")
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.gate
def test_readers_see_the_last_transaction_after_a_kill_and_write_nothing(plan: Plan, directory: Path) -> None:
    whole = sweep.load(directory)
    ended = finished(python(KILLED, directory / INDEX), check=False)
    assert ended.returncode == -signal.SIGKILL
    assert journal_of(directory).stat().st_size > 0
    assert b"half done" in (directory / INDEX).read_bytes()
    before = contents(directory)
    assert sweep.load(directory) == whole
    with Index(directory) as index:
        assert index.read_note("title") == "t"
    assert contents(directory) == before
    with Index(directory, write=True) as index:
        assert index.read_note("title") == "t"
    assert not journal_of(directory).exists()
    assert sweep.load(directory) == whole


HOSTILE = {
    "view": "ALTER TABLE runs RENAME TO r0; CREATE VIEW runs AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 "
    "FROM n) SELECT r0.* FROM r0, n",
    "trigger": "CREATE TRIGGER t AFTER UPDATE ON runs BEGIN DELETE FROM sweep; END",
    "table": "CREATE TABLE more (id TEXT)",
    "virtual table": "DROP TABLE results; CREATE VIRTUAL TABLE results USING fts5(run, content)",
    "generated column": "ALTER TABLE runs ADD COLUMN big AS (hex(zeroblob(1000000000)))",
    "default": "DROP TABLE sweep; CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT DEFAULT (hex(zeroblob(9))))",
    "check": "DROP TABLE sweep; CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT CHECK (random() > 0))",
    "index": "CREATE INDEX i ON runs (hex(zeroblob(length(id))))",
    "index that is said to be a table": "PRAGMA writable_schema = ON; UPDATE sqlite_master SET type = 'table' "
    "WHERE name = 'sqlite_autoindex_sweep_1'",
}


@pytest.mark.parametrize("write", [False, True])
@pytest.mark.parametrize("kind", HOSTILE)
def test_only_tables_of_plain_columns_are_read(kind: str, write: bool, directory: Path) -> None:
    with closing(sqlite3.connect(directory / INDEX)) as database:
        database.executescript(HOSTILE[kind])
    before = contents(directory)
    with pytest.raises(InputError, match=r"is no index of a sweep: it holds the (view|trigger|table|index) "):
        Index(directory, write)
    assert contents(directory) == before


def test_a_write_ahead_log_is_refused(directory: Path) -> None:
    with closing(sqlite3.connect(directory / INDEX)) as database:
        database.execute("PRAGMA journal_mode = WAL")
    before = contents(directory)
    with pytest.raises(InputError, match="it has a write-ahead log, which fastpin never makes"):
        sweep.load(directory)
    assert contents(directory) == before


@pytest.mark.parametrize("name", ["../../precious", "", "0123456789abcdeg", f"{RUN}\n", f"{RUN}/x"])
def test_the_id_of_a_run_is_no_path(name: str, directory: Path, tmp_path: Path) -> None:
    with closing(sqlite3.connect(directory / INDEX, isolation_level=None)) as database:
        database.execute("UPDATE runs SET id = ? WHERE rowid = 1", [name])
    with pytest.raises(InputError, match=r"index.sqlite: is damaged: id: must be 16 hexadecimal digits"):
        sweep.load(directory)
    with pytest.raises(InputError, match="id: must be 16 hexadecimal digits"):
        sweep.merge([directory], tmp_path / "whole")


def test_more_rows_than_an_index_has_are_refused(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(databases, "MOST_ROWS", 1)
    with pytest.raises(InputError, match="a table has more than 1 rows"):
        sweep.load(directory)


def test_a_schema_without_end_is_refused(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(databases, "MOST_OPERATIONS", 1)
    with pytest.raises(sqlite3.OperationalError, match="interrupted"):
        open_database(directory / INDEX, "ro")

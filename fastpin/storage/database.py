"""The index of a sweep as a database of SQLite, which may come from a stranger.

Reading never writes: SQLite may not even undo the unfinished transaction of a killed sweep, unless in a private copy.
A database holds tables of plain columns only, so no query runs an expression of the stranger.
"""

from __future__ import annotations

import os
import re
import shutil
import sqlite3
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from fastpin.errors import InputError
from fastpin.model.inputs import SQLITE_SIGNATURE, note_input
from fastpin.storage.files import NO_LINK

BUSY_SECONDS = 60.0
"""Longest wait for another process that has locked a database."""

TABLES = ("runs", "sweep", "outcomes", "bars", "results")
"""The tables that an index may have."""

MOST_ROWS = 1_000_000
"""Most rows of a table that are read. Pages that lead to the same pages can feign more rows than a file can hold."""

MOST_OPERATIONS = 1_000_000
"""Most operations of SQLite that read the list of tables. A usual index needs some hundred."""

Mode = Literal["ro", "rw", "rwc"]
"""Modes of opening: to read, to write, or to write a file that may be new."""

# Plain columns: names, types and constraints in capital words. Expressions would need parentheses.
_COLUMN = r'(?>"(?:[^"]|"")*"|PRIMARY KEY \([a-z, ]+\)|[a-z]+)(?> [A-Z]+)*'
_PLAIN = re.compile(rf"CREATE TABLE \"?([a-z]+)\"? \({_COLUMN}(?:, {_COLUMN})*\)")

# The end of a journal that names a super-journal, which SQLite deletes: its length, a checksum, and these bytes.
_MAGIC = bytes.fromhex("d9d505f920a163d7")


def open_database(path: Path, mode: Mode, timeout: float = BUSY_SECONDS) -> sqlite3.Connection:
    """Open a database, and check that its tables are those of an index.

    Parameters
    ----------
    path : Path
    mode : {"ro", "rw", "rwc"}
    timeout : float
        Longest wait for another process, s.

    Raises
    ------
    InputError
        If the file or its journal is not as fastpin writes it.
    sqlite3.Error
        If SQLite can't open the file.
    """
    real = Path(os.path.realpath(path))
    note_input(real)
    if mode != "ro" and path.is_symlink():  # The link of a stranger may lead to any file.
        raise InputError(str(path), "must be an ordinary file to be written, not a link")
    _check_file(real, path)
    _check_log(real)
    _check_journal(real, path)
    try:
        return _opened(real, path, mode, timeout)
    except sqlite3.OperationalError as error:
        if mode != "ro" or error_name(error) != "SQLITE_READONLY_ROLLBACK":
            raise
    return _repaired_copy(real, path)


def error_name(error: sqlite3.Error) -> str:
    """Return SQLite's name of an error. Python's own errors have none, such as that of a text that is not UTF-8."""
    return getattr(error, "sqlite_errorname", "")


def limited(cursor: sqlite3.Cursor) -> Iterator[Any]:
    """Yield the rows of a query.

    Raises
    ------
    sqlite3.DatabaseError
        If there are more than :data:`MOST_ROWS`.
    """
    for number, row in enumerate(cursor):
        if number >= MOST_ROWS:
            raise sqlite3.DatabaseError(f"a table has more than {MOST_ROWS:,} rows")
        yield row


def _opened(real: Path, path: Path, mode: Mode, timeout: float) -> sqlite3.Connection:
    database = sqlite3.connect(f"{real.as_uri()}?mode={mode}", uri=True, timeout=timeout, isolation_level=None)
    try:
        database.set_progress_handler(lambda: 1, MOST_OPERATIONS)
        database.execute("PRAGMA trusted_schema = OFF")
        database.execute("PRAGMA cell_size_check = ON")
        for kind, name, sql in database.execute("SELECT type, name, sql FROM sqlite_master"):
            _check_part(path, kind, name, sql)
        database.set_progress_handler(None, 0)
    except BaseException:
        database.close()
        raise
    return database


def _check_part(path: Path, kind: object, name: object, sql: object) -> None:
    """Raise :class:`InputError` if a part of a database is no table of plain columns, or the index of its keys."""
    if kind == "index" and sql is None:
        return
    found = _PLAIN.fullmatch(sql) if kind == "table" and isinstance(sql, str) else None
    if found is None or found[1] != name or name not in TABLES:
        allowed = ", ".join(TABLES)
        raise InputError(str(path), f"is no index of a sweep: it holds the {kind} {name}, but may hold {allowed} only")


def _check_file(real: Path, path: Path) -> None:
    """Raise :class:`InputError` if the file is no database, or would be opened with a write-ahead log."""
    try:
        if not real.exists():
            return
        if not real.is_file():
            raise InputError(str(path), "must be an ordinary file")
        with real.open("rb") as file:
            head = file.read(20)
    except OSError as error:
        raise InputError(str(path), f"can't be read: {error.strerror}") from None
    if head.startswith(SQLITE_SIGNATURE) and head[18:] != b"\x01\x01":  # the versions of a file without such a log
        raise InputError(str(path), "is no index of a sweep: it has a write-ahead log, which fastpin never makes")


def _check_log(real: Path) -> None:
    """Raise :class:`InputError` if there is a write-ahead log beside a database.

    SQLite uses the log whatever the header says. It writes to the log, also when it reads, and follows links.
    """
    for ending in ("-wal", "-shm"):
        log = real.with_name(f"{real.name}{ending}")
        if os.path.lexists(log):
            raise InputError(str(log), "is a write-ahead log, which fastpin never makes; please remove it")


def _journal_of(real: Path) -> Path:
    """The path at which SQLite keeps the journal of a database."""
    return real.with_name(f"{real.name}-journal")


def _check_journal(real: Path, path: Path) -> None:
    """Raise :class:`InputError` if the journal of a database is a link, or names a super-journal.

    SQLite deletes the file that such a name leads to. It writes the name in transactions over several databases only.
    """
    journal = _journal_of(real)
    try:
        file = os.open(journal, os.O_RDONLY | NO_LINK | getattr(os, "O_NONBLOCK", 0))
    except FileNotFoundError:
        return
    except OSError as error:
        raise InputError(str(journal), f"must be an ordinary file, not a link: {error.strerror}") from None
    try:
        found = os.fstat(file)
        if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
            raise InputError(str(journal), "must be an ordinary file with one name")
        if os.pread(file, len(_MAGIC), max(found.st_size - len(_MAGIC), 0)) == _MAGIC:
            words = "names another file that SQLite would delete; fastpin never writes such a journal"
            raise InputError(str(path), f"can't be used: its journal {words}")
    finally:
        os.close(file)


def _repaired_copy(real: Path, path: Path) -> sqlite3.Connection:
    """Open a private copy of a database to read, in which SQLite undoes the transaction of a killed sweep.

    The copy has no name any more when this function ends. Its bytes go when the database is closed.
    """
    journal = _journal_of(real)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / real.name
        try:
            shutil.copyfile(journal, _journal_of(copy), follow_symlinks=False)
            shutil.copyfile(real, copy)
        except FileNotFoundError:  # Another process has undone the transaction meanwhile.
            return _opened(real, path, "ro", BUSY_SECONDS)
        except OSError as error:
            reason = f"was being written when its sweep was killed, and can't be copied to {folder}: {error.strerror}"
            raise InputError(str(path), reason) from None
        _check_journal(copy, path)
        _opened(copy, path, "rw", BUSY_SECONDS).close()
        return _opened(copy, path, "ro", BUSY_SECONDS)

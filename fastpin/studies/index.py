"""The index of a sweep: an SQLite file with one row for each run, and its result. Only the main process writes it.

A row and the result are committed together as soon as the main process has them. They survive when it is killed. The
journal is SQLite's ordinary journal: it works on the network file systems of clusters, where a write-ahead log does
not. Other processes can read the index during a sweep.
"""

from __future__ import annotations

import json
import math
import re
import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, get_args

from fastpin.errors import InputError, OutputError, printable
from fastpin.model.checks import any_text, as_toml, choice, instance, number, whole_number
from fastpin.storage.files import INDEX
from fastpin.storage.packed import TABLE, Mode, error_name, limited, open_database
from fastpin.studies.identity import ID_LENGTH
from fastpin.studies.outcomes import OutcomeValue
from fastpin.studies.plan import Plan, Point, Spacing
from fastpin.studies.run_end import KEY_FIGURES, RUN_COLUMNS, RunEnd
from fastpin.version import __version__

APPLICATION = 0x6670696E
"""Application id in the header of the file: "fpin"."""

FORMAT_VERSION = 1
"""Version of the tables."""

WAITING, DONE, FAILED = "waiting", "done", "failed"
"""Statuses of a run."""

LONGEST_WORDS = 2_000
"""Most characters of a reason or a name that are read. A reason may repeat a text of any length."""

_END_COLUMNS = ("status", "reason", *KEY_FIGURES, "seconds", "started", "host", "versions")


def has_index(directory: Path) -> bool:
    """Whether a directory has an index. An empty file does not count: another process is creating the index."""
    path = directory / INDEX
    return path.is_file() and path.stat().st_size > 0


class Index:
    """The index in a directory. A ``with`` statement closes it.

    Parameters
    ----------
    directory : path
    write : bool
        Open the index to write, and create it if there is none. Otherwise nothing is written.

    Raises
    ------
    InputError
        If the file can't be read, or is no index. The methods raise it too.
    OutputError
        If the disk is full. The methods raise it too.
    """

    def __init__(self, directory: Path, write: bool = False) -> None:
        self.path = directory / INDEX
        if not write and not has_index(directory):
            raise InputError(str(directory), "holds no sweep: there is no index.sqlite")
        with self._as_input_error():
            mode: Mode = "rwc" if write else "ro"
            self._database = open_database(self.path, mode)
            try:
                self._check(write)
            except BaseException:
                self._database.close()
                raise

    def __enter__(self) -> Index:
        return self

    def __exit__(self, *_: object) -> None:
        self._database.close()

    def _check(self, write: bool) -> None:
        """Check that the file is an index. Create the tables if it is empty."""
        if write and not self._one("SELECT count(*) FROM sqlite_master"):
            columns = ", ".join(f'"{name}" {kind}' for name, kind in RUN_COLUMNS.items())
            with self._transaction():
                self._database.execute(f"PRAGMA application_id = {APPLICATION}")
                self._database.execute(f"PRAGMA user_version = {FORMAT_VERSION}")
                self._database.execute(f"CREATE TABLE runs ({columns})")
                self._database.execute("CREATE TABLE sweep (name TEXT PRIMARY KEY, value TEXT)")
            return
        if self._one("PRAGMA application_id") != APPLICATION:
            raise InputError(str(self.path), "is an SQLite file, but not the index of a sweep")
        if self._one("PRAGMA user_version") != FORMAT_VERSION:
            raise InputError(str(self.path), "is the index of another version of fastpin, which this one can't read")
        for table in ("runs", "sweep", *filter(self._has_table, ("outcomes", "bars"))):
            damage = self._one(f"PRAGMA quick_check({table})")  # Every result has a checksum of its own.
            if damage != "ok":
                raise sqlite3.DatabaseError(damage)

    # -- writing --------------------------------------------------------------------------------------------------

    def expect(self, plan: Plan, points: Iterable[Point]) -> None:
        """Add the new points as waiting runs, and write the values of all points. Runs that ended stay so.

        Values of outcomes with another definition are removed.
        """
        fields = list(plan.fields)
        with self._as_input_error(), self._transaction():
            self._add_columns(fields)
            self._make_tables()
            definitions = [(name, outcome.definition) for name, outcome in plan.outcomes.items()]
            self._database.executemany("DELETE FROM outcomes WHERE name = ? AND definition <> ?", definitions)
            self._write_notes(version=__version__, plan=plan.digest, title=plan.title, text=plan.text)
            self._write_notes(fields=json.dumps(self.fields | plan.fields))
            columns = ["id", "status", "dimensionless", "input", *fields]
            update = "".join(f", {_quoted([name])} = excluded.{_quoted([name])}" for name in fields)
            insert = f"INSERT INTO runs ({_quoted(columns)}) VALUES ({', '.join('?' * len(columns))}) "
            insert += f"ON CONFLICT (id) DO UPDATE SET input = excluded.input{update}"
            for point in points:
                # A list or table becomes JSON; a number or text stays.
                cells = [json.dumps(v) if isinstance(v, list | dict) else v for v in map(point.values.get, fields)]
                own = point.id, WAITING, json.loads(point.input)["dimensionless"], point.input
                self._database.execute(insert, [*own, *cells])

    def record(self, ends: Iterable[RunEnd]) -> None:
        """Write the ends of runs into their rows, with their results and the values of their outcomes, all at once."""
        assignments = ", ".join(f'"{name}" = :{name}' for name in _END_COLUMNS)
        with self._as_input_error(), self._transaction():
            for end in ends:
                same = {name: getattr(end, name) for name in ("id", "reason", "seconds", "started", "host")}
                state = {"status": DONE if end.reason is None else FAILED, "versions": json.dumps(end.versions)}
                cells = {**dict.fromkeys(KEY_FIGURES), **end.figures, **same, **state}
                self._database.execute(f"UPDATE runs SET {assignments} WHERE id = :id", cells)
                self._database.execute("DELETE FROM bars WHERE run = ?", [end.id])
                self._write_bars(end.id, end.bars)
                self._write_outcomes(end.id, end.outcomes)
                self._write_result(end.id, end.content)

    def record_outcomes(self, ends: Iterable[RunEnd]) -> None:
        """Write the values of outcomes of finished runs, all at once."""
        with self._as_input_error(), self._transaction():
            for end in ends:
                self._write_outcomes(end.id, end.outcomes)

    def forget_unread(self) -> None:
        """Remove the outcomes that could not be read."""
        with self._as_input_error():
            self._database.execute("DELETE FROM outcomes WHERE reason IS NOT NULL")

    # -- reading --------------------------------------------------------------------------------------------------

    @property
    def fields(self) -> dict[str, Spacing]:
        """All fields that were ever varied in this directory, with the spacing of their values."""
        with self._as_input_error():
            fields = _table(self.read_note("fields"))
            for name, spacing in fields.items():
                choice(f"spacing of {name}", spacing, get_args(Spacing))
            return fields

    def read_note(self, name: str) -> str | None:
        """Read a note on the whole sweep: "version", "plan" (its digest), "title", "text" or "fields"."""
        value = self._one("SELECT value FROM sweep WHERE name = ?", name)
        with self._as_input_error():
            return None if value is None else any_text(name, value)

    def holds_plan(self) -> bool:
        """Whether a plan or a part has been written to the index. A process may be killed before its first one."""
        return self.read_note("version") is not None

    def statuses(self) -> dict[str, tuple[str, str | None]]:
        """Read status ("waiting", "done", "failed") and reason of a failure, by id."""
        with self._as_input_error():
            cursor = self._database.execute("SELECT id, status, reason FROM runs")
            return {_id(run): (_status(status), _text("reason", reason)) for run, status, reason in limited(cursor)}

    def outcomes(self) -> dict[str, dict[str, OutcomeValue]]:
        """Read the values of all outcomes, by run and name. Only finished runs have some."""
        if not self._has_table("outcomes"):
            return {}
        found: dict[str, dict[str, OutcomeValue]] = {}
        with self._as_input_error():
            cursor = self._database.execute("SELECT run, name, definition, value, reason FROM outcomes")
            for run, name, definition, value, reason in limited(cursor):
                checked = None if value is None else number(name, value)
                found.setdefault(run, {})[name] = OutcomeValue(definition, checked, _text("reason", reason))
        return found

    def bars(self) -> dict[str, dict[str, float]]:
        """Read the error bars of key figures and outcomes, by run and name. Only runs with error bars have some.

        A bar is inf where the coarse grid has no value to compare.
        """
        found: dict[str, dict[str, float]] = {}
        if self._has_table("bars"):
            with self._as_input_error():
                for run, name, bar in limited(self._database.execute("SELECT run, name, bar FROM bars")):
                    found.setdefault(run, {})[name] = math.inf if bar == math.inf else number(name, bar, 0.0)
        return found

    def packed(self) -> set[str]:
        """Return the ids of the runs whose results are in the index."""
        if not self._has_table("results"):
            return set()
        with self._as_input_error():
            return {str(run) for (run,) in limited(self._database.execute("SELECT run FROM results"))}

    def content(self, run: str) -> bytes | None:
        """Read the packed result of a run; None if it is not in the index."""
        if not self._has_table("results"):
            return None
        found = self._one("SELECT content FROM results WHERE run = ?", run)
        with self._as_input_error():
            return None if found is None else bytes(instance("content", found, bytes, "bytes"))

    def rows(self) -> list[dict[str, Any]]:
        """Read all rows, in the order of their insertion. A row is a dict from column to value.

        Lists (loads, the ends of an arc) are lists again. ``versions`` and ``input`` are dicts. Outcomes are left out.
        """
        with self._as_input_error():
            fields = self.fields
            cursor = self._database.execute("SELECT * FROM runs ORDER BY rowid")
            names = [column[0] for column in cursor.description]
            rows = [dict(zip(names, row, strict=True)) for row in limited(cursor)]
            for row in rows:
                _check_row(row)
                for name in fields:
                    cell = row[name]
                    # Other texts of a load are the names of a CSV file or of one of its columns.
                    may_be_list = name.startswith("load.") or name in ("solve.arc", "solve.between")
                    is_list = may_be_list and isinstance(cell, str) and cell.startswith(("[", "{"))
                    row[name] = _shown(json.loads(cell) if is_list else cell)
                for name in ("versions", "input"):
                    row[name] = _shown(_table(row[name]))
            return rows

    def absorb(self, other: Index, ids: Sequence[str]) -> None:
        """Copy the rows, outcomes and results of these ids, and the notes, from another index of the same plan."""
        with self._as_input_error(), self._transaction():
            names = list(other.fields)
            self._add_columns(names)
            notes = ("version", "plan", "title", "text", "fields")
            self._write_notes(**{name: other.read_note(name) for name in notes})
            columns = _quoted([*RUN_COLUMNS, *names])
            placeholders = ", ".join("?" * (len(RUN_COLUMNS) + len(names)))
            for run in ids:
                row = other._database.execute(f"SELECT {columns} FROM runs WHERE id = ?", [run]).fetchone()
                self._database.execute(f"INSERT OR REPLACE INTO runs ({columns}) VALUES ({placeholders})", row)
            self._make_tables()
            outcomes, bars = other.outcomes(), other.bars()
            for run in ids:
                self._write_outcomes(run, outcomes.get(run, {}))
                self._write_bars(run, bars.get(run, {}))
                self._write_result(run, other.content(run))

    # -- the database --------------------------------------------------------------------------------------------

    def _add_columns(self, fields: Iterable[str]) -> None:
        known = {row[1] for row in self._database.execute("PRAGMA table_info(runs)")}
        for name in fields:
            if name not in known:
                self._database.execute(f"ALTER TABLE runs ADD COLUMN {_quoted([name])}")

    def _write_outcomes(self, run: str, values: dict[str, OutcomeValue]) -> None:
        rows = [(run, name, value.definition, value.value, value.reason) for name, value in values.items()]
        self._database.executemany("INSERT OR REPLACE INTO outcomes VALUES (?, ?, ?, ?, ?)", rows)
        self._database.executemany("DELETE FROM bars WHERE run = ? AND name = ?", [(run, name) for name in values])
        self._write_bars(run, {name: value.bar for name, value in values.items() if value.bar is not None})

    def _write_bars(self, run: str, bars: dict[str, float]) -> None:
        rows = [(run, name, bar) for name, bar in bars.items()]
        self._database.executemany("INSERT OR REPLACE INTO bars VALUES (?, ?, ?)", rows)

    def _make_tables(self) -> None:
        """Add the tables that an index of an earlier version lacks."""
        self._database.execute(
            "CREATE TABLE IF NOT EXISTS outcomes (run TEXT NOT NULL, name TEXT NOT NULL, definition TEXT NOT NULL, "
            "value REAL, reason TEXT, PRIMARY KEY (run, name))"
        )
        self._database.execute(
            "CREATE TABLE IF NOT EXISTS bars (run TEXT NOT NULL, name TEXT NOT NULL, bar REAL NOT NULL, "
            "PRIMARY KEY (run, name))"
        )
        self._database.execute(TABLE)

    def _write_result(self, run: str, content: bytes | None) -> None:
        """Write a packed result. Without one, the result has a file of its own, and an older one is removed."""
        if content is None:
            self._database.execute("DELETE FROM results WHERE run = ?", [run])
        else:
            self._database.execute("INSERT OR REPLACE INTO results VALUES (?, ?)", [run, content])

    def _has_table(self, name: str) -> bool:
        """Whether there is a table of this name. An index from before the table was invented has none."""
        return bool(self._one("SELECT count(*) FROM sqlite_master WHERE name = ?", name))

    def _write_notes(self, **values: str | None) -> None:
        self._database.executemany("INSERT OR REPLACE INTO sweep VALUES (?, ?)", values.items())

    def _one(self, query: str, *values: Any) -> Any:
        """Return the single value that a query gives, or None."""
        with self._as_input_error():
            row = self._database.execute(query, values).fetchone()
        return row[0] if row else None

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """Commit the changes of the block after its end, or undo them after an error."""
        self._database.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            if self._database.in_transaction:  # SQLite itself undoes it when the disk is full.
                self._database.execute("ROLLBACK")
            raise
        self._database.execute("COMMIT")

    @contextmanager
    def _as_input_error(self) -> Iterator[None]:
        """Raise :class:`InputError` with one sentence for an error of SQLite, or a damaged value, in the block."""
        try:
            yield
        except InputError as error:
            if error.field == str(self.path):
                raise
            raise InputError(str(self.path), f"is damaged: {error}") from None
        except (sqlite3.OperationalError, sqlite3.InternalError) as error:
            if _is_of_disk(error):
                raise OutputError(str(self.path), f"can't be written: {error}") from None
            raise InputError(str(self.path), f"can't be used: {error}") from None
        except sqlite3.DatabaseError as error:
            raise InputError(str(self.path), f"is no index of a sweep, or a damaged one: {error}") from None
        except (KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
            raise InputError(str(self.path), f"is damaged: {type(error).__name__}: {error}") from None


@contextmanager
def lock_directory(directory: Path) -> Iterator[None]:
    """Keep other sweeps out of a directory during the block. The lock also ends with this process, even by a kill.

    Raises
    ------
    InputError
        If another sweep is running in the directory, or the directory can't be written.
    OutputError
        If the disk is full.
    """
    try:
        lock = open_database(directory / "lock", "rwc", timeout=0.0)
        try:
            lock.execute("BEGIN EXCLUSIVE")
        except BaseException:
            lock.close()
            raise
    except sqlite3.Error as error:
        if _is_of_disk(error):
            raise OutputError(str(directory / "lock"), f"can't be written: {error}") from None
        busy = error_name(error).startswith("SQLITE_BUSY")
        reason = "another sweep is running in this directory" if busy else f"can't be used: {error}"
        raise InputError(str(directory), reason) from None
    try:
        yield
    finally:
        lock.close()


def _is_of_disk(error: sqlite3.Error) -> bool:
    """Whether an error of SQLite says that the disk is full or broken."""
    return error_name(error).startswith(("SQLITE_FULL", "SQLITE_IOERR"))


def _check_row(row: dict[str, Any]) -> None:
    """Check the kinds of values in a row. Its texts can be printed then."""
    _status(row["status"])
    _id(row["id"])
    for name in ("reason", "started", "host"):
        row[name] = _text(name, row[name])
    whole_number("dimensionless", row["dimensionless"], 0, 1)
    for name in (*KEY_FIGURES, "seconds"):
        if row[name] is not None:
            number(name, row[name])


def _id(value: Any) -> str:
    """The id of a run. It is a part of the names of files, so nothing but an id may stand there."""
    if not isinstance(value, str) or not re.fullmatch(rf"[0-9a-f]{{{ID_LENGTH}}}", value):
        raise InputError("id", f"must be {ID_LENGTH} hexadecimal digits, not {as_toml(value)}")
    return value


def _status(value: Any) -> str:
    return choice("status", value, (WAITING, DONE, FAILED))


def _text(name: str, value: Any) -> str | None:
    """Return a text on one line that can be printed: the index may be anybody's, or of an earlier version."""
    cut = value[:LONGEST_WORDS] if isinstance(value, str) else value
    return None if value is None else printable(any_text(name, cut))


def _shown(value: Any) -> Any:
    """Return a value of JSON with texts on one line that can be printed, as :func:`_text`."""
    if isinstance(value, dict):
        return {printable(name): _shown(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_shown(part) for part in value]
    return printable(value) if isinstance(value, str) else value


def _table(text: Any) -> dict[str, Any]:
    """A JSON object as a dict; empty without a text."""
    table = json.loads(text) if text else {}
    return instance("JSON", table, dict, "a table")


def _quoted(names: Iterable[str]) -> str:
    """Return names of columns in SQL. A quote inside a name is doubled: a merged index may come from elsewhere."""
    return ", ".join('"' + name.replace('"', '""') + '"' for name in names)


def ensure_directory(directory: Path) -> Path:
    """Create a directory if there is none, and return it.

    Raises
    ------
    InputError
        If it can't be created.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(str(directory), f"can't be made: {error.strerror or error}") from None
    return directory

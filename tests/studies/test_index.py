"""The index: what is written comes back, also to plain SQL, and what is no index is refused in one sentence."""

import contextlib
import json
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fastpin.errors import InputError, printable
from fastpin.storage.packed import INDEX
from fastpin.studies.index import LONGEST_WORDS, Index, lock_directory
from fastpin.studies.plan import Plan, Point, parse_plan
from fastpin.studies.run_end import KEY_FIGURES, RunEnd

TEXT = """
title = "Loads"
[grid]
load.2.Q = [[1e5, -1e5], 2e5]
pin.rigid = [false]
[[list]]
plate.material = "steel"
[[list]]
contact.friction = 0.25
"""


@pytest.fixture(scope="module")
def plan() -> Plan:
    return parse_plan(TEXT)


@pytest.fixture
def directory(plan: Plan, tmp_path: Path) -> Path:
    """An index with one run that is done, one that failed and two that wait."""
    with Index(tmp_path, write=True) as index:
        index.expect(plan, plan.points)
        first, second = (point.id for point in plan.points[:2])
        figures = dict.fromkeys(KEY_FIGURES) | {"states": 3, "peak_pressure": 0.1 + 0.2, "nodes": 41}
        done = RunEnd(first, None, figures, 0.5, "2026-01-01T00:00:00.000+00:00", "here", {"fastpin": "1"})
        index.record([done, RunEnd(second, "lost; it's gone", {"states": 1, "nodes": 41}, 0.25, "x", "there")])
    return tmp_path


def test_rows_come_back(plan: Plan, directory: Path) -> None:
    with Index(directory) as index:
        rows = index.rows()
        assert index.read_note("title") == "Loads"
        assert index.fields == dict.fromkeys(plan.fields, "list")
    assert [row["id"] for row in rows] == [point.id for point in plan.points]
    assert [row["status"] for row in rows] == ["done", "failed", "waiting", "waiting"]
    assert rows[0]["peak_pressure"] == 0.1 + 0.2
    assert (rows[0]["reason"], rows[1]["reason"]) == (None, "lost; it's gone")
    assert (rows[0]["versions"], rows[2]["versions"]) == ({"fastpin": "1"}, {})
    assert rows[0]["load.2.Q"] == [1e5, -1e5]
    assert rows[1]["load.2.Q"] == 2e5
    assert rows[0]["plate.material"] == "steel"
    assert rows[2]["plate.material"] is None
    assert rows[2]["contact.friction"] == 0.25
    assert rows[0]["input"] == json.loads(plan.points[0].input)
    assert set(KEY_FIGURES) <= set(rows[0])


def test_plain_sql_reads_it(plan: Plan, directory: Path) -> None:
    query = (
        "SELECT id, json_extract(\"load.2.Q\", '$[1]'), json_extract(input, '$.plate.E') FROM runs "
        "WHERE \"plate.material\" = 'steel' AND status = 'done' AND nodes > 40"
    )
    with contextlib.closing(sqlite3.connect(directory / INDEX)) as database:
        found = database.execute(query).fetchall()
    assert found == [(plan.points[0].id, -1e5, 210e9)]


def test_a_plan_that_has_grown_keeps_what_is_known(plan: Plan, directory: Path) -> None:
    grown = parse_plan(TEXT.replace("[grid]", "[grid]\nsolve.nodes = [401, 61]"))
    with Index(directory, write=True) as index:
        index.expect(grown, grown.points)
        rows = {row["id"]: row for row in index.rows()}
    assert len(rows) == 8
    assert rows[plan.points[0].id]["status"] == "done"
    assert rows[plan.points[0].id]["solve.nodes"] == 401
    with Index(directory) as index:
        assert [*index.fields] == [*plan.fields, "solve.nodes"]


def execute(path: Path, statement: str, *values: object) -> None:
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute(statement, values)


def foreign(path: Path) -> None:
    path.unlink()
    execute(path, "CREATE TABLE runs (id TEXT)")


def garbled(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[200:-100] = b"\xff" * (len(content) - 300)
    path.write_bytes(content)


@pytest.mark.parametrize("create", [False, True])
@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (
            lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
            "is no index of a sweep, or a damaged one",
        ),
        (lambda path: path.write_text("run,status\n" * 1000), "is no index of a sweep, or a damaged one"),
        (garbled, "is no index of a sweep, or a damaged one"),
        (foreign, "is an SQLite file, but not the index of a sweep"),
        (lambda path: execute(path, "PRAGMA user_version = 99"), "is the index of another version of fastpin"),
    ],
    ids=["truncated", "text", "garbled", "foreign", "later"],
)
def test_what_is_no_index_is_refused(damage: Callable[[Path], None], words: str, create: bool, directory: Path) -> None:
    damage(directory / INDEX)
    before = (directory / INDEX).read_bytes()
    with pytest.raises(InputError) as caught:
        Index(directory, write=create)
    assert words in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1
    assert (directory / INDEX).read_bytes() == before


@pytest.mark.parametrize("make", [lambda path: None, Path.mkdir, Path.touch], ids=["missing", "directory", "empty"])
def test_a_sweep_that_is_not_there(make: Callable[[Path], None], tmp_path: Path) -> None:
    """SQLite makes an empty file before it writes."""
    make(tmp_path / INDEX)
    with pytest.raises(InputError, match="holds no sweep"):
        Index(tmp_path)


def test_an_index_that_can_not_be_written_is_named(plan: Plan, directory: Path) -> None:
    with Index(directory, write=True) as index:
        index._database.execute("PRAGMA query_only = ON")  # what SQLite says of a file that may only be read
        for write in (
            lambda: index.expect(plan, plan.points),
            lambda: index.record([RunEnd(plan.points[0].id, "lost")]),
        ):
            with pytest.raises(InputError, match=r"index.sqlite: can't be used: attempt to write a readonly database"):
                write()


@pytest.mark.parametrize("make", [lambda path: Index(path, write=True), lambda path: lock_directory(path).__enter__()])
def test_an_index_or_a_lock_that_can_not_be_made_is_named(make: Callable[[Path], object]) -> None:
    with pytest.raises(InputError, match=r"can't be used: unable to open database file"):
        make(Path("/proc/1"))


def test_half_a_transaction_is_none(plan: Plan, tmp_path: Path) -> None:
    class Interrupted(BaseException):
        pass

    def points() -> Iterator[Point]:
        yield plan.points[0]
        raise Interrupted

    with Index(tmp_path, write=True) as index:
        with pytest.raises(Interrupted):
            index.expect(plan, points())
        assert index.rows() == []
        index.expect(plan, plan.points)
        assert len(index.rows()) == 4


def test_an_index_that_is_about_to_be_made_is_written(tmp_path: Path) -> None:
    (tmp_path / INDEX).touch()
    with Index(tmp_path, write=True):
        pass
    with Index(tmp_path):
        pass


@pytest.mark.parametrize(
    ("statement", "reason"),
    [
        ("UPDATE sweep SET value = '{' WHERE name = 'fields'", "is damaged"),
        ("UPDATE sweep SET value = '5' WHERE name = 'fields'", "JSON: must be a table, not 5"),
        ("UPDATE runs SET status = 'fine'", 'status: must be "waiting", "done" or "failed"'),
        ("UPDATE runs SET peak_pressure = 'high'", 'peak_pressure: must be a number, not "high"'),
        ("UPDATE runs SET input = '{'", "is damaged"),
        ("UPDATE runs SET reason = CAST(x'eda080' AS TEXT)", "can't be used: Could not decode to UTF-8"),
        ('ALTER TABLE runs RENAME COLUMN "contact.friction" TO "other"', "is damaged"),
    ],
)
def test_a_damaged_row_is_described(tmp_path, statement, reason):
    plan = parse_plan('[grid]\n"contact.friction" = [0.1, 0.2]\n')
    with Index(tmp_path, write=True) as index:
        index.expect(plan, plan.points)
    execute(tmp_path / INDEX, statement)
    with Index(tmp_path) as index, pytest.raises(InputError, match=reason) as raised:
        index.rows()
    assert "\n" not in str(raised.value)


def test_a_reason_of_millions_of_characters_is_cut(directory: Path) -> None:
    """Characters that are to be made printable, one after the other, would take seconds."""
    execute(directory / INDEX, "UPDATE runs SET reason = ?", "\x1b" * 4_000_000)
    with Index(directory) as index:
        assert {row["reason"] for row in index.rows()} == {printable("\x1b" * LONGEST_WORDS)}

"""Results in few bytes: everything comes back, and every change of a byte is noticed."""

import json
import sqlite3
import zlib
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import MATERIALS, InputError, MaterialPair, Problem, Result, storage
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.states.cycles import CYCLE_KINDS
from fastpin.storage import packed, store
from fastpin.storage.files import INDEX
from fastpin.storage.layout import NODE_FIELDS, NUMBER_FIELDS, SLIP_FIELDS
from tests.support.commands import printed

STEEL = MATERIALS["steel"]
LIMIT = 10**6


@pytest.fixture(scope="module")
def result() -> Result:
    """A cycle between bodies, with slip sums."""
    problem = Problem(
        MaterialPair(STEEL, MATERIALS["aluminium"]), hole_radius=0.01, clearance=2e-5, friction=0.4,
        pin_load="centre", pin_body=Tube(0.003), plate_body=Ring(0.03, "held"),
    )  # fmt: skip
    history = fastpin.LoadHistory([{"P": 1e5}]) + fastpin.LoadHistory([{"Q": 2e4}, {"Q": -2e4}]).repeated(2)
    return fastpin.solve(problem, history, nodes=31, between=1, slip_sums=True)


@pytest.fixture
def path(result: Result, tmp_path: Path) -> Path:
    """The path of a result that is in the index of a sweep."""
    (tmp_path / "results").mkdir()
    with closing(sqlite3.connect(tmp_path / INDEX, isolation_level=None)) as database:
        database.execute(packed.TABLE)
        database.execute("INSERT INTO results VALUES ('abc', ?)", [store.pack(result, "lost", LIMIT)])
    return tmp_path / "results" / "abc.h5"


def assert_same(one: Result, other: Result) -> None:
    assert (one.problem, one.complete, one.method, one.statistics) == (
        other.problem, other.complete, other.method, other.statistics,
    )  # fmt: skip
    assert np.array_equal(one.grid.theta, other.grid.theta)
    assert np.array_equal(one.history.values(), other.history.values(), equal_nan=True)
    assert [[getattr(cycle, name) for name in CYCLE_KINDS] for cycle in one.cycles] == [
        [getattr(cycle, name) for name in CYCLE_KINDS] for cycle in other.cycles
    ]
    for first, second in zip(one, other, strict=True):
        assert (first.load, first.residuals) == (second.load, second.residuals)
        summed = SLIP_FIELDS if first.slip_distance is not None else {}
        for name in (*NODE_FIELDS, *summed, *NUMBER_FIELDS):
            a, b = np.asarray(getattr(first, name)), np.asarray(getattr(second, name))
            assert a.dtype == b.dtype
            assert np.array_equal(a, b, equal_nan=True), name


def test_everything_comes_back(result: Result, tmp_path: Path) -> None:
    """The same as from an HDF5 file."""
    content = store.pack(result, None, LIMIT)
    found = store.unpack(content, Path("a"))[0]
    assert len(found) == len(result) > 5
    assert_same(found, result)
    store.save(result, tmp_path / "a.h5", restart=False)
    assert_same(found, store.load(tmp_path / "a.h5"))
    assert len(content) < 0.5 * (tmp_path / "a.h5").stat().st_size
    with pytest.raises(ValueError, match="read-only"):
        found[0].pressure[0] = 1.0


def test_a_bush_and_constants_of_fatigue_come_back() -> None:
    bush = Bushing(MATERIALS["2024-T3"], 0.0125, 2e-5)
    problem = Problem(MaterialPair(STEEL, MATERIALS["2024-T3"]), hole_radius=0.01, clearance=2e-5, friction=0.4,
                      plate_body=bush)  # fmt: skip
    result = fastpin.solve(problem, [{"P": 1e5}], nodes=21)
    assert_same(store.unpack(store.pack(result, None, LIMIT) or b"", Path("a"))[0], result)


def test_a_result_that_is_too_large_is_not_packed(result: Result) -> None:
    content = store.pack(result, None, LIMIT)
    assert len(store.pack(result, None, len(content))) == len(content)  # the bytes differ in the date of writing
    assert store.pack(result, None, len(content) - 1) is None
    assert store.pack(result, None, 10) is None


def test_every_changed_byte_is_noticed(result: Result) -> None:
    content = store.pack(result, None, LIMIT)
    places = [*range(40), *np.random.default_rng(1).integers(40, len(content), 100)]
    for place in places:
        changed = bytearray(content)
        changed[place] ^= 1
        with pytest.raises(InputError, match=r"^a: is damaged: "):
            store.unpack(bytes(changed), Path("a"))
    for size in (0, 5, 16, 100, len(content) - 1):
        with pytest.raises(InputError, match=r"^a: is damaged: "):
            store.unpack(content[:size], Path("a"))


def test_the_path_of_a_file_reads_the_result_in_an_index(result, path):
    assert_same(store.load(path), result)
    assert len(store.load(path, states=[-1])) == 1
    assert storage.StoredResult(path).points.size == len(result)
    assert storage.StoredResult(path).points[-1] == 5.0
    assert storage.StoredResult(path).error == "lost"
    assert storage.to_xarray(path).sizes["theta"] == 31
    assert "peak N" in printed("show", path)
    with pytest.raises(InputError, match="there is no such file"):
        storage.resume(path)


def test_a_file_stands_before_the_result_in_an_index(result: Result, path: Path) -> None:
    store.save(replaced := store.load(path, states=slice(0, 2)), path)
    assert len(store.load(path)) == len(replaced) == 2


@pytest.mark.parametrize("name", ["abd.h5", "abc.json", "../abc.h5", "../../results/abc.h5"])
def test_other_paths_are_no_results(name: str, path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        store.load(path.parent / name)


@pytest.mark.parametrize("value", ["'text'", "5", "NULL"])
def test_another_value_in_the_place_of_a_result_is_damage(value: str, path: Path) -> None:
    with closing(sqlite3.connect(path.parent.parent / INDEX)) as database:
        database.executescript(
            f"CREATE TABLE other (run TEXT, content BLOB); INSERT INTO other VALUES ('abc', {value});"
            "DROP TABLE results; ALTER TABLE other RENAME TO results"
        )
    with pytest.raises(InputError, match=r"abc.h5: is damaged: it is no packed result"):
        store.load(path)


def test_an_index_that_can_not_be_read_is_named(path: Path) -> None:
    (path.parent.parent / INDEX).write_bytes(b"x" * 1000)
    with pytest.raises(InputError, match=r"index.sqlite: can't be used: file is not a database"):
        store.load(path)
    with closing(sqlite3.connect(path.parent.parent / "other.sqlite")) as database:
        database.execute("CREATE TABLE runs (id TEXT)")
    (path.parent.parent / "other.sqlite").replace(path.parent.parent / INDEX)
    with pytest.raises(InputError, match="there is no such file"):
        store.load(path)


@pytest.mark.parametrize(
    "described",
    [["<f8", [-1, -5], {}], ["O", [0], {}], ["<f8", [10**30, 0], {}], ["<f8", [True], {}], ["|V999999", [0], {}]],
)
def test_an_array_of_a_stranger_is_judged_before_memory_is_taken(described):
    head = json.dumps({"attrs": {}, "arrays": {"a": described}, "groups": {}}).encode()
    content = packed._HEAD.pack(packed._SIGNATURE, zlib.crc32(head), len(head)) + head
    with pytest.raises(InputError, match="is damaged: a has"):
        store.unpack(content, Path("x.h5"))

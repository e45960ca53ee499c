"""Load histories: blocks, cycles, harmonic loads, CSV files."""

import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from fastpin.errors import CaseFileError, InputError
from fastpin.model.history import LoadHistory, cycle_length, cycles_after, same_ahead
from fastpin.model.loads import LOADS, complete_load
from fastpin.model.options import KeepRule
from fastpin.tables import files, reader
from fastpin.tables.reader import MOST_FAULTS
from tests.support.faults import faults_of
from tests.support.refusals import refused
from tests.support.tiers import seeds

NEVER = np.full(len(LOADS), np.nan)


def random_program(seed: int) -> LoadHistory:
    """A history of random blocks, some of them inside others."""
    rng = np.random.default_rng(seed)
    history = LoadHistory([{"P": 1.0}])
    for _ in range(rng.integers(1, 4)):
        values = rng.integers(0, 3, rng.integers(1, 5))
        block = LoadHistory([{"Q" if rng.random() < 0.8 else "P": float(value)} for value in values])
        if rng.random() < 0.7:
            block = block.repeated(int(rng.integers(1, 4)))
        if rng.random() < 0.3:
            block = (block + history).repeated(int(rng.integers(1, 4)))
        history += block
    return history


def test_helpers() -> None:
    assert np.array_equal(LoadHistory.monotonic(4, P=2.0).values()[:, 0], [0.5, 1.0, 1.5, 2.0])
    cycles = LoadHistory.cycles({"P": 1.0}, {"Q": 0.2}, 2)
    assert np.array_equal(cycles.values()[:, 1], [0.0, 0.2, -0.2, 0.2, -0.2, 0.2])
    minus_first = LoadHistory.cycles({"P": 1.0, "Q": 0.1}, {"Q": 0.2}, 1, start=-1, return_to_mean=True)
    assert np.allclose(minus_first.values()[:, 1], [0.1, -0.1, 0.3, -0.1, 0.1])
    block = LoadHistory([{"Q": 0.1}, {"Q": -0.1}])
    whole = LoadHistory([{"P": 1.0}]) + block.repeated(3)
    assert len(whole) == 7
    assert np.array_equal(whole.values()[:, 0], np.ones(7))
    with pytest.raises(InputError, match="without a step"):
        whole[::2]
    with pytest.raises(InputError, match="at least one"):
        whole[7:]


def test_corners_one_by_one_are_the_values() -> None:
    for seed in seeds(40):
        history = random_program(seed)
        load = NEVER
        for index, expected in enumerate(history.values(NEVER)):
            load = complete_load(history.corner(index)[0], load)
            assert np.array_equal(load, expected, equal_nan=True)


def test_parts_are_those_of_the_whole() -> None:
    for seed in seeds(40):
        history = random_program(seed)
        values, size = history.values(NEVER), len(history)
        rng = np.random.default_rng(size)
        for _ in range(10):
            start, stop = sorted(int(k) for k in rng.choice(size + 1, 2, replace=False))
            part = history[start:stop]
            before = values[start - 1] if start else NEVER
            assert len(part) == stop - start
            assert np.array_equal(part.values(before), values[start:stop], equal_nan=True)
            for k in range(len(part)):
                assert bool(part.corner(k)[1]) == bool(history.corner(start + k)[1])


def test_distinct_holds_every_load_and_little_more() -> None:
    for seed in seeds(40):
        history = random_program(seed)
        both = [np.nan_to_num(values, nan=-9.0) for values in (history.values(NEVER), history.distinct(NEVER))]
        given, distinct = (np.unique(values, axis=0) for values in both)
        assert np.array_equal(given, distinct)
    assert len(LoadHistory([{"P": 1.0}]).repeated(1000).distinct()) == 2


def test_what_is_said_to_be_the_same_ahead_is() -> None:
    for seed in seeds(40):
        history = random_program(seed)
        found = 0
        for index in range(len(history)):
            for period in range(1, index + 1):
                for k in range(index, index + same_ahead(history, index, period)):
                    (one, ended), (other, ended_before) = history.corner(k), history.corner(k - period)
                    assert np.array_equal(one, other, equal_nan=True)
                    assert ended == ended_before
                    found += 1
        assert found > 0 or all(block.count == 1 for block in history.blocks)


def test_cycles_begin_and_end_in_turns() -> None:
    """Every cycle that ends has begun as many corners before as it is long, or where the one before ended."""
    for seed in seeds(40):
        history = random_program(seed)
        begun: dict[tuple[int, int], set[int]] = {}
        for index in range(-1, len(history)):
            ended = history.corner(index)[1] if index >= 0 else []
            for key in ended:
                assert index - cycle_length(history, key) in begun[key]
            for key in [*ended, *cycles_after(history, index)]:
                begun.setdefault(key, set()).add(index)


def test_a_million_cycles_take_the_memory_of_one() -> None:
    tracemalloc.start()
    history = LoadHistory.cycles({"P": 1.0}, {"Q": 0.2}, 1_000_000)
    assert len(history) == 2_000_002
    assert history.corner(1_500_001)[0][LOADS.index("Q")] == 0.2
    assert len(history.distinct()) == 6
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()


def test_harmonic_loads() -> None:
    history = LoadHistory.harmonic({"P": 2.0}, {"Q": 0.3, "sxx": 1.0}, {"sxx": 90.0}, count=3, points=4)
    assert len(history) == 13
    values = history.values()
    assert np.array_equal(values[:, LOADS.index("P")], np.full(13, 2.0))
    assert np.array_equal(values[:5, LOADS.index("Q")], [0.3, 0.0, -0.3, 0.0, 0.3])
    assert np.array_equal(values[:5, LOADS.index("sxx")], [0.0, -1.0, 0.0, 1.0, 0.0])  # a quarter ahead
    assert np.array_equal(values[1:5], values[9:])
    assert history.corner(4)[1] == history.corner(8)[1] != []
    in_phase = LoadHistory.harmonic({}, {"P": 1.0, "Q": 0.5}, {"Q": 180.0})
    assert np.array_equal(in_phase.values()[:, :2], [[1.0, -0.5], [-1.0, 0.5], [1.0, -0.5]])
    many = LoadHistory.harmonic({}, {"Q": 1.0, "P": 1.0}, {"Q": 10.0}).values()
    assert len(many) == 25
    assert np.allclose(many[3, :2], [np.cos(np.pi / 4), np.cos(np.pi / 4 + np.radians(10.0))], rtol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (({}, {}), "amplitude"),
        (({}, {"Q": 1.0}, {"P": 2.0}), "phase"),
        (({}, {"Q": np.nan}), "Q of amplitude"),
        (({"X": 1.0}, {"Q": 1.0}), "mean"),
        (({}, {"Q": 1.0}, {}, 0), "count"),
        (({}, {"Q": 1.0}, {}, 1, 1), "points"),
    ],
)
def test_bad_harmonic_loads(arguments: tuple, field: str) -> None:
    assert refused(LoadHistory.harmonic, *arguments).field == field


def test_arrays() -> None:
    history = LoadHistory.from_array(np.array([[1.0, np.nan], [np.nan, 0.2]]), ["P", "Q"])
    assert np.array_equal(history.values()[:, :2], [[1.0, 0.0], [1.0, 0.2]])
    for corners, loads, field in (
        (np.zeros(3), ["P"], "corners"),
        (np.zeros((2, 3)), ["P", "Q"], "corners"),
        (np.full((2, 1), np.inf), ["P"], "corners"),
        (np.zeros((2, 2)), ["P", "P"], "loads"),
        (np.zeros((2, 1)), ["p"], "loads"),
        (np.zeros((0, 1)), ["P"], "history"),
    ):
        assert refused(LoadHistory.from_array, corners, loads).field == field


# -- CSV -----------------------------------------------------------------------------------------------------


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "loads.csv"


def test_csv(path: Path) -> None:
    path.write_text("# a comment\nP, Q\n1.0,\n,0.2\n\n, -0.2\n", encoding="utf-8-sig")
    assert np.array_equal(LoadHistory.from_csv(path).values()[:, :2], [[1.0, 0.0], [1.0, 0.2], [1.0, -0.2]])


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("P,Q\n1,0\n1,nan\n", [(3, "Q: must be a finite number, not nan")]),
        ("P,Q\n1,inf\n", [(2, "Q: must be a finite number, not inf")]),
        (
            "P,Q\n1,0\n1,two\nx,y\n1\n1,0\n",
            [(3, "Q: must be"), (4, "P: must be"), (4, "Q: must be"), (5, "the line has 1 cell, the header has 2")],
        ),
        ("P,q\n1,0\n", [(1, f'column 2: unknown load "q"; the loads are {", ".join(LOADS)}, did you mean "Q"')]),
        ("P,P\n1,0\n", [(1, "a load is named twice")]),
        ("P,Q\n", [(0, "holds no load corners")]),
        ("", [(0, "holds no load corners")]),
    ],
)
def test_all_faults_of_a_csv_file_are_named(path: Path, text: str, faults: list[tuple[int, str]]) -> None:
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseFileError) as caught:
        LoadHistory.from_csv(path)
    assert [line for line, _ in caught.value.problems] == [line for line, _ in faults]
    for (_, said), (_, words) in zip(caught.value.problems, faults, strict=True):
        assert said.startswith(words)
    assert caught.value.field == str(path)


def test_the_faults_of_a_wrong_file_are_not_all_listed(path: Path) -> None:
    path.write_text("P\n" + "a\n" * 1000)
    assert len(faults_of(LoadHistory.from_csv, path)) == MOST_FAULTS + 1


@pytest.mark.parametrize("content", [None, b"P,Q\n\xff,1\n", b'P,Q\n"1\n,2\n'])
def test_files_that_can_not_be_read(path: Path, content: bytes | None) -> None:
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"loads\.csv"):
        LoadHistory.from_csv(path)


@pytest.mark.gate
def test_a_long_csv_file_is_in_memory_once(path: Path) -> None:
    rows = 30_000
    path.write_text("P,Q\n" + "".join(f"1e6,{k}.5\n" for k in range(rows)))
    tracemalloc.start()
    history = LoadHistory.from_csv(path)
    size, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    table = rows * len(LOADS) * 8
    assert len(history) == rows
    assert size < 1.4 * table  # with the places of ends of cycles
    assert peak < 1.6 * table


# -- which states are kept -----------------------------------------------------------------------------------


def test_keep() -> None:
    ends = [False, True, False, True, False]

    def kept(which: str) -> list[int]:
        return [k for k in range(5) if KeepRule.read(which).at_corner(k, 5, ends[k])]

    assert kept("all") == kept("corners") == kept("every 1") == [0, 1, 2, 3, 4]
    assert kept("cycles") == [1, 3, 4]
    assert kept("every 2") == kept("every-2") == kept("every2") == [1, 3, 4]
    assert kept("every 9") == [4]
    assert [which for which in ("all", "corners", "cycles", "every 2") if KeepRule.read(which).inside] == ["all"]
    assert [str(KeepRule.read(which)) for which in ("all", "cycles", "every:7")] == ["all", "cycles", "every 7"]
    for wrong in ("", "some", "every", "every 0", "every -1", "every x", 3, None):
        with pytest.raises(InputError, match='"every N"'):
            KeepRule.read(wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("line", ["\n", "# " + "x" * 1000 + "\n", " " * 5000 + "\n", "#\r"])
def test_a_csv_file_without_corners_is_not_read_to_its_end(line, path, monkeypatch):
    monkeypatch.setattr(reader, "MOST_AROUND", 100_000)
    lines = reader.MOST_AROUND // max(len(line), reader.SHORTEST_LINE) + 10
    path.write_text("P\n1\n" + line * (2 * lines), newline="")
    with pytest.raises(
        CaseFileError, match="the lines up to here are too long or too many for their load corners"
    ) as caught:
        LoadHistory.from_csv(path)
    assert caught.value.problems[0][0] < lines + 10


def test_a_csv_file_has_a_limit_of_corners(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_ROWS", 100)
    path.write_text("P\n" + "1\n" * 100 + "\n# end\n")
    assert len(LoadHistory.from_csv(path)) == 100
    path.write_text("P\n" + "1\n" * 100 + "\n# end\n1\n")
    with pytest.raises(CaseFileError, match="line 104: more than 100 corners can't be read"):
        LoadHistory.from_csv(path)


def test_a_csv_file_of_long_corners_is_read(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "MOST_AROUND", 1000)
    cells = ",".join(f"{-math.pi * 10.0 ** -(100 + k):.17g}" for k in range(len(LOADS)))
    path.write_text(",".join(LOADS) + "\n" + f"{cells}\n# a comment\n" * 1000)
    assert len(LoadHistory.from_csv(path)) == 1000

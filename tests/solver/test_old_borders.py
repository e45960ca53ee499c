"""Old borders between stick and slip: marked at corners, forgotten under later slip, stored, and used by readings."""

import copy
import pickle
from pathlib import Path

import h5py
import numpy as np
import pytest

from fastpin import Material, MaterialPair, Problem, Result, load, save, solve
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.reading.marks import Marks
from fastpin.reading.old_borders import BITS, OldBorder, is_ambiguous, present_borders

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
PROBLEM = Problem.from_load_parameter(LIKE, 2.0, 0.7, "centre", "fixed")
P = {"P": 1.0}
SHAKES = [P, {"Q": 0.1}, {"Q": -0.07}, {"Q": 0.04}]


@pytest.fixture(scope="module")
def result() -> Result:
    return solve(PROBLEM, SHAKES, nodes=161)


def test_marks_of_borders_and_edges() -> None:
    status = np.array([OPEN, SLIP_POSITIVE, STICK, STICK, SLIP_NEGATIVE, OPEN, OPEN, STICK], dtype=np.int8)
    found = present_borders(status, closed=False)
    assert sorted(found) == [(1, 1, 0), (2, 1, -1), (3, -1, 1), (4, -1, 0), (7, 1, 0)]
    assert sorted(present_borders(status, closed=True)) == sorted([*found, (7, -1, 0)])
    assert is_ambiguous(BITS[1, 0] | BITS[-1, 0])
    assert not is_ambiguous(BITS[1, 0] | BITS[1, -1])
    bits = np.zeros(8, dtype=np.int8)
    bits[[1, 2, 3, 7]] = BITS[1, 0], BITS[1, -1], BITS[-1, 1], BITS[1, 0]
    places = np.where(np.arange(8) == 3, 0.2, np.nan)
    marks = Marks.stored(bits, places)
    assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(marks.arrays(8), (bits, places), strict=True))
    slip = np.where(np.arange(8) == 2, 1.0, 0.0)
    assert list(np.flatnonzero(marks.left(status, slip, np.zeros(8)).arrays(8)[0])) == [3, 7]
    assert list(np.flatnonzero(marks.at(np.arange(8) + 4).arrays(12)[0])) == [5, 6, 7, 11]
    found = marks.borders(2, 3, 8)
    assert found == [OldBorder(0, 1, -1), OldBorder(1, -1, 1, 0.2)]
    assert found[0].mirrored(3) == OldBorder(2, -1, -1)
    assert found[0].is_end(3)
    assert marks.borders(0, 3, 8, inwards=-1) == [OldBorder(1, -1, 0)]
    assert marks.borders(7, 3, 8) == [OldBorder(0, 1, 0), OldBorder(2, 1, 0)]
    both = Marks({2: BITS[1, 0] | BITS[1, -1] | BITS[-1, 1]})
    assert both.borders(2, 1, 8) == [OldBorder(0, -1, 1), OldBorder(0, 1, -1)]
    for copied in (pickle.loads(pickle.dumps(marks)), copy.deepcopy(marks)):
        assert np.array_equal(copied.arrays(8)[1], places, equal_nan=True)


def test_places_do_not_depend_on_the_time_of_reading() -> None:
    """Many small shakes: places that follow from many others are read at once. The others wait."""
    shakes = [P, *({"Q": 0.02 * (-1) ** k * (1.0 - 0.02 * k)} for k in range(24))]
    late = solve(PROBLEM, shakes, nodes=161)
    early = solve(PROBLEM, shakes[:1], grid=late.grid)
    for shake in shakes[1:]:
        early = solve(PROBLEM, [shake], start=early)
        early[-1].old_places  # noqa: B018
    assert np.array_equal(early[-1].old_places, late[-1].old_places, equal_nan=True)
    assert early[-1].peak_shear == late[-1].peak_shear


def test_borders_are_remembered_until_slip_passes_over_them(result: Result) -> None:
    """Decreasing shakes leave nested borders. A larger one erases them all."""
    borders = [state.marks.borders(0, 161, 161) for state in result]
    counts = [sum(border.sign != 0 and border.place is not None for border in found) for found in borders]
    assert counts == [0, 2, 3, 5]
    first = next(border for border in borders[1] if border.sign != 0 and border.inwards > 0)
    assert first in borders[3]
    wiped = solve(PROBLEM, [{"Q": 0.2}], start=result)[-1]
    left = wiped.marks.borders(0, 161, 161)
    assert first not in left
    assert sum(border.sign != 0 for border in left) <= 2


def test_a_split_history_has_the_same_borders(result: Result) -> None:
    last = solve(PROBLEM, SHAKES[2:], start=solve(PROBLEM, SHAKES[:2], grid=result.grid))[-1]
    assert np.array_equal(last.old_borders, result[-1].old_borders)
    assert np.array_equal(last.old_places, result[-1].old_places, equal_nan=True)
    assert last.peak_shear == result[-1].peak_shear


def test_a_stored_restart_has_the_borders(result: Result, tmp_path: Path) -> None:
    save(result, tmp_path / "a.h5")
    kept, stored = (each.restart.configuration.marks.arrays(161) for each in (result, load(tmp_path / "a.h5")))
    assert np.count_nonzero(kept[0]) > 2
    assert all(np.array_equal(*pair, equal_nan=True) for pair in zip(stored, kept, strict=True))


def test_a_file_of_an_earlier_version_has_no_borders(result: Result, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    save(result, path)
    assert load(path)[-1].peak_shear == result[-1].peak_shear
    with h5py.File(path, "r+") as file:
        for name in ("old_borders", "old_places"):
            del file[f"states/{name}"]
            del file[f"restart/latest/configurations/{name}"]
    older = load(path)
    assert older[-1].old_borders is None
    assert np.array_equal(older[-1].shear, result[-1].shear)
    further, expected = (solve(PROBLEM, [{"Q": 0.01}], start=start)[-1] for start in (older, result))
    assert np.array_equal(further.shear, expected.shear)
    assert np.count_nonzero(further.old_borders) < np.count_nonzero(expected.old_borders)


def test_peaks_where_old_borders_lie_beside_edges_and_new_borders() -> None:
    """The slip zones have four to six nodes. The references are those of 3,201 nodes (docs/accuracy-tables.md)."""
    for shakes, exact in (((0.02, -0.02, 0.02), 0.224835), ((0.1, -0.07, 0.04, -0.02, 0.0), 0.284967)):
        state = solve(PROBLEM, [{"P": 1.0}, *({"Q": q} for q in shakes)], nodes=401)[-1]
        assert abs(state.peak_shear) == pytest.approx(exact, rel=1e-4)
        nodal = float(np.abs(state.shear).max())
        assert nodal < 0.995 * exact


def test_the_peak_at_an_old_border_of_unlike_bodies() -> None:
    """The reference is that of 1,601 nodes. Without the cusp of N the error is 1.8e-3."""
    pair = MaterialPair(Material(1.0, 0.3), Material(1.5, 0.3))
    problem = Problem.from_load_parameter(pair, 0.5, 0.5, "centre", "fixed")
    state = solve(problem, [P, {"Q": 0.25}, {"Q": -0.15}, {"Q": 0.05}], nodes=201)[-1]
    assert abs(state.peak_shear) == pytest.approx(0.279032, rel=2e-4)

"""Ties between places are decided by a rule, and not by rounding."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin import MATERIALS, MaterialPair, State
from fastpin.model.angles import BOTTOM, angle_at, from_bottom
from fastpin.model.ties import TIE, top, top_angle, top_angles
from fastpin.reading.peaks import peak_slips
from fastpin.states.yielding import von_mises_peak


def test_of_equal_values_the_first_in_time_is_taken() -> None:
    assert top([1.0, 3.0, 3.0 * (1.0 + 1e-12), 2.0]) == 1
    assert top([1.0, 3.0, 3.0 * (1.0 + 2.0 * TIE)]) == 2
    assert top([-2.0, -1.0 - 1e-12, -1.0]) == 1
    assert top([0.0, math.inf, math.inf]) == 1
    assert top([-math.inf, -math.inf]) == 0


@pytest.mark.parametrize("shift", [0.0, 2.0 * math.pi, -4.0 * math.pi])
def test_of_equal_values_the_one_farthest_to_the_right_is_taken(shift: float) -> None:
    rng = np.random.default_rng(1)
    degrees = np.array([-180.0 + 1e-9, -120.0, -30.0, 0.0, 30.0, 120.0])
    for _ in range(30):
        order = rng.permutation(degrees.size)
        theta = angle_at(degrees[order]) + shift
        values = 1.0 + 1e-14 * rng.normal(size=degrees.size)
        assert order[top_angle(values, theta)] == 0  # the top counts as 180 degrees
        values[order == 0] = 0.5
        assert order[top_angle(values, theta)] == 5
        assert order[top_angle(-values, theta)] == 0
        rows = np.where(rng.random((4, degrees.size)) < 0.5, values, 0.2)
        assert top_angles(rows, theta).tolist() == [top_angle(row, theta) for row in rows]


def test_values_at_one_angle_are_taken_in_their_order() -> None:
    assert top_angle(np.array([[1.0, 2.0], [1.0, 2.0]]), np.array([[0.5, 0.1], [0.5, 0.1]])) == 1


# --- a symmetric problem and a mirrored one -------------------------------------------------------------------


@functools.cache
def states(right: float) -> list[State]:
    """States under P alone and with Q; of the mirrored history if `right` is -1."""
    pair = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
    problem = fastpin.Problem.from_load_parameter(pair, 0.4, 0.3, "centre", "fixed")
    history = [{"P": 1.0}, {"P": 1.0, "Q": 0.4 * right}]
    return list(fastpin.solve(problem, history, grid=fastpin.Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 61)))


def places(state: State) -> list[float]:
    """The places that are reported, deg from the bottom."""
    peaks = state.peak_pressure_angle, state.peak_shear_angle, state.peak_slip_angle
    return [
        from_bottom(angle) for angle in (*peaks, state.peak_hoop_stress().angle, von_mises_peak(state, "plate").angle)
    ]


def test_a_symmetric_problem_reports_places_on_the_right_whatever_rounding_does() -> None:
    rng, state = np.random.default_rng(2), states(1.0)[0]
    found = places(state)
    assert found[0] == pytest.approx(0.0, abs=1e-6)
    assert min(found[1:4]) > 1.0
    for _ in range(10):
        arrays = {name: getattr(state, name) for name in ("pressure", "shear", "slip")}
        changed = {name: each * (1.0 + 1e-14 * rng.normal(size=each.size)) for name, each in arrays.items()}
        assert places(replace(state, **changed)) == pytest.approx(found, abs=1e-6)


def test_a_mirrored_problem_reports_the_mirrored_places() -> None:
    one, other = (states(right)[1] for right in (1.0, -1.0))
    assert places(other) == pytest.approx([-each for each in places(one)], abs=1e-6)
    assert other.peak_slip == pytest.approx(-one.peak_slip, rel=1e-9)


def test_the_largest_slip_of_a_symmetric_problem_has_the_sign_of_the_right_side() -> None:
    state = states(1.0)[0]
    assert state.peak_slip == state.slip[np.flatnonzero(state.theta == state.peak_slip_angle)[0]]
    rows = [peak_slips(sign * state.slip[None], state.status[None], state.theta)[0] for sign in (1.0, -1.0)]
    assert rows == [state.peak_slip, -state.peak_slip]

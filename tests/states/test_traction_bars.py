"""Error bars of the tractions, at the nodes and of the curves."""

import math

import numpy as np
import pytest

from fastpin import Grid, InputError, MaterialPair, Problem, State, solve
from fastpin.states.curves import traction_patches, tractions_at
from fastpin.verification import closed_forms

BOTTOM = -0.5 * math.pi
CORNERS: list[dict[str, float]] = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}]


@pytest.fixture(scope="module")
def held(similar: MaterialPair) -> Problem:
    return Problem.from_load_parameter(similar, 0.5, 0.5, "centre")


@pytest.fixture(scope="module")
def states(held: Problem) -> list[State]:
    return list(solve(held, CORNERS, nodes=101, error_bars=True))


def persson(theta: np.ndarray, half: float) -> np.ndarray:
    phi = np.clip(theta - BOTTOM, -half, half)
    return np.where(np.abs(theta - BOTTOM) < half, closed_forms.persson_pressure(phi, half), 0.0)


@pytest.mark.parametrize("parameter", [0.05, 0.3, 1.0])
def test_bars_hold_against_the_closed_form(similar: MaterialPair, parameter: float) -> None:
    problem = Problem.from_load_parameter(similar, parameter, 0.0)
    state = solve(problem, [{"P": 1.0}], nodes=101, error_bars=True)[-1]
    bars, half = state.error_bars, float(closed_forms.persson_half_angle(parameter))
    error = np.abs(state.pressure - persson(state.theta, half))
    assert np.all(error <= bars.pressure + 1e-15)
    assert not bars.shear.any()
    theta = BOTTOM + np.linspace(-1.05, 1.05, 501) * half
    curve = tractions_at(traction_patches(state), np.degrees(theta) + 90.0)[0]
    of_curve = bars.of_curves(theta)[0]
    assert np.all(np.abs(curve - persson(theta, half)) <= of_curve + 1e-15)
    middle = np.abs(theta - BOTTOM) < 0.8 * half
    assert of_curve[middle].max() < 2e-3 * state.peak_pressure  # narrow where the curve is smooth
    assert of_curve.max() < 0.15 * state.peak_pressure  # and no wider than its steep end needs


@pytest.mark.gate
def test_bars_hold_against_a_finer_grid(held: Problem, states: list[State]) -> None:
    grid = states[0].grid
    finer = solve(held, CORNERS, grid=Grid.arc(float(grid.theta[0]), float(grid.theta[-1]), 8 * (grid.size - 1) + 1))
    for state, true in zip(states, finer, strict=True):
        for name in ("pressure", "shear"):
            held_at = np.abs(getattr(state, name) - getattr(true, name)[::8]) <= getattr(state.error_bars, name)
            assert np.mean(held_at) > 0.97


def test_bars_are_read_only_and_have_the_shape_of_what_was_asked(states: list[State]) -> None:
    bars = states[-1].error_bars
    for array in (bars.pressure, bars.shear):
        assert array.shape == states[-1].theta.shape
        assert np.all(array >= 0.0)
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    assert bars.of_curves(BOTTOM)[0].shape == ()
    assert bars.of_curves(np.full((2, 3), BOTTOM))[1].shape == (2, 3)
    with pytest.raises(InputError, match="theta: must be a finite number, not nan"):
        bars.of_curves([math.nan])


def test_bars_at_nodes_reach_from_the_nodes_to_the_curve(states: list[State]) -> None:
    state, bars = states[-1], states[-1].error_bars
    curve = tractions_at(traction_patches(state), np.degrees(state.theta) + 90.0)
    for row, (name, of_curve) in enumerate(zip(("pressure", "shear"), bars.of_curves(state.theta), strict=True)):
        away = np.abs(getattr(state, name) - curve[row])
        assert np.allclose(getattr(bars, name), of_curve + away, rtol=1e-12, atol=0.0)
        assert away.max() > of_curve[away.size // 2]  # the outermost nodes miss the law of the edge


def test_bars_are_largest_at_edges_and_zero_away_from_the_contact(states: list[State]) -> None:
    state, bars = states[0], states[0].error_bars
    ((start, stop),) = state.contact
    spacing = float(np.diff(state.theta)[0])
    assert bars.of_curves(start)[0] > 10.0 * bars.of_curves(0.5 * (start + stop))[0]
    away = [start - 8.0 * spacing, stop + 8.0 * spacing, math.pi / 2.0]
    assert not bars.of_curves(away)[0].any()
    moved = bars["contact_1_start"]  # the curve with its edge moved by its bar lies in the band
    curve = tractions_at(traction_patches(state), np.degrees([start, start + moved]) + 90.0)[0]
    assert bars.of_curves(start)[0] >= curve[1] > curve[0] >= 0.0


def test_bars_do_not_depend_on_the_seam_of_a_circle(held: Problem) -> None:
    bars = [
        solve(held, CORNERS[:1], grid=Grid.circle(240, BOTTOM + turn), error_bars=True)[-1].error_bars
        for turn in (0.0, math.pi)
    ]
    theta = np.linspace(-1.5 * math.pi, 1.5 * math.pi, 301)
    for one, other in zip(bars[0].of_curves(theta), bars[1].of_curves(theta), strict=True):
        assert np.allclose(one, other, rtol=0.0, atol=1e-4)

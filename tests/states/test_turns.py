"""Angles that are read lie at most half a turn from the bottom of the hole, wherever the nodes are."""

import json
import math
from typing import Any

import numpy as np
import pytest

from fastpin import Case, Grid, LoadHistory, MaterialPair, Problem, SolveOptions, State, plot_tractions, solve
from fastpin.casefile import EXAMPLE, parse_case
from fastpin.kernels.status import STICK
from fastpin.model.angles import BOTTOM
from fastpin.reading import zones
from fastpin.report import state_table
from fastpin.report.summary import document
from fastpin.states.quantities import in_degrees, values
from tests.support.checks.integral_equations import residuals_away
from tests.support.checks.sliding import solve_sliding

TOP = 0.5 * math.pi
TURN = 2.0 * math.pi
CORNERS = [{"P": 1.0}, {"Q": 0.3}]
UPWARDS = [{"P": -1.0}, {"Q": 0.1}]


@pytest.fixture(scope="module")
def problem(similar: MaterialPair) -> Problem:
    return Problem.from_load_parameter(similar, 0.3, 0.5, "centre", "fixed")


def check_order(state: State) -> None:
    """The rule of the docstring of State."""
    for found in (state.contact, state.stick, [zone[:2] for zone in state.slip_zones]):
        middles = [0.5 * (start + stop) for start, stop in found]
        assert all(BOTTOM - math.pi < middle <= TOP + 1e-6 for middle in middles)
        assert all(start < stop for start, stop in found)
        assert middles == sorted(middles)
    assert BOTTOM - math.pi < state.peak_pressure_angle <= TOP + 1e-6


def read(state: State) -> np.ndarray:
    ends = [*state.contact, *state.stick, *[zone[:2] for zone in state.slip_zones]]
    return np.r_[np.ravel(ends), state.peak_pressure_angle, state.peak_shear_angle]


@pytest.mark.parametrize("turns", [-3, -1, 1, 2])
@pytest.mark.parametrize(("corners", "middle"), [(CORNERS, BOTTOM), (UPWARDS, TOP)])
def test_an_arc_may_lie_whole_turns_away(turns, corners, middle, problem):
    near = solve(problem, corners, nodes=121, arc=(middle - 1.3, middle + 1.3), error_bars=True)[-1]
    arc = (middle - 1.3 + turns * TURN, middle + 1.3 + turns * TURN)
    away = solve(problem, corners, nodes=121, arc=arc, error_bars=True)[-1]
    check_order(near)
    check_order(away)
    assert away.theta[0] == pytest.approx(arc[0])
    assert read(away) == pytest.approx(read(near), abs=1e-7)
    assert dict(away.error_bars) == pytest.approx(dict(near.error_bars), abs=5e-5, nan_ok=True)


@pytest.mark.parametrize("arc", [(5.0, 8.0), (-9.0, -6.0), (3.3, 6.2)])
def test_every_report_of_an_arc_far_away_is_near_the_bottom(arc: tuple[float, float], problem: Problem) -> None:
    pull = {"P": math.sin(0.5 * (arc[0] + arc[1])) * -1.0, "Q": math.cos(0.5 * (arc[0] + arc[1]))}
    result = solve(problem, [pull], nodes=121, arc=arc)
    (state,) = result
    check_order(state)
    (contact,) = state.contact
    case = Case(problem, LoadHistory([pull]), SolveOptions(nodes=121, arc=arc))
    (summary,) = document(case, result)["states"]
    expected = np.degrees(contact) + 90.0
    assert summary["contact"] == [pytest.approx(expected)]
    assert -180.0 < summary["peak_pressure_angle"] <= 180.0
    assert f"{expected[0]:.2f} to {expected[1]:.2f}" in state_table(problem, [state])
    assert f"contact {expected[0]:.2f} to {expected[1]:.2f}" in repr(state)
    ends = values(state)
    assert [in_degrees(name, ends[name]) for name in ("contact_1_start", "contact_1_stop")] == pytest.approx(expected)
    left, right = plot_tractions(result).axes[0].get_xlim()
    assert left < expected[0] < expected[1] < right
    json.dumps(summary)


@pytest.mark.parametrize("start", [-1.5 * math.pi, -2.0, 0.0, 1.5, 7.0])
@pytest.mark.parametrize("corners", [CORNERS, UPWARDS])
def test_a_circle_may_start_anywhere(start: float, corners: list[dict[str, float]], problem: Problem) -> None:
    theta = start + TURN / 240.0 * np.arange(240)
    start += BOTTOM - theta[np.argmin(np.abs(np.angle(np.exp(1j * (theta - BOTTOM)))))]  # a node at the bottom
    state, plain = (solve(problem, corners, grid=Grid.circle(240, angle))[-1] for angle in (start, BOTTOM))
    check_order(state)
    assert read(state) == pytest.approx(read(plain), abs=1e-6)


@pytest.mark.parametrize("start", [-1.5 * math.pi, 0.0, 2.0])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_a_contact_all_round_is_from_top_to_top(start, friction, titanium_in_aluminium):
    fit = Problem(titanium_in_aluminium, 0.01, -1e-5, friction, "body")
    result = solve(fit, [{"P": 1e5}], grid=Grid.circle(120, start))
    (state,) = result
    assert state.contact == [zones.ALL_ROUND] == [pytest.approx((-1.5 * math.pi, TOP))]
    assert state.stick == ([zones.ALL_ROUND] if friction else [])
    assert state.slip_zones == ([] if friction else [(*zones.ALL_ROUND, 1)])
    left, right = plot_tractions(result).axes[0].get_xlim()
    assert -181.0 < left <= -177.0
    assert 177.0 <= right < 184.0


@pytest.mark.parametrize("start", [-1.5 * math.pi, -2.0, 0.1, 3.0])
def test_slip_zones_round_the_hole_do_not_depend_on_the_first_node(start: float) -> None:
    grid = Grid.circle(360, start)
    angle = zones.ALL_ROUND[0] + np.mod(grid.theta - zones.ALL_ROUND[0], TURN)
    status = np.where((angle > -3.0) & (angle < 0.5), -1, 1).astype(np.int8)
    contact = [zones.whole_turn(grid)]
    found: list[Any] = zones.in_order(zones.complement(grid, contact, [], status))
    assert [sign for *_, sign in found] == [1, -1]
    assert np.array([zone[:2] for zone in found]) == pytest.approx(
        np.array([(0.5 - TURN, -3.0), (-3.0, 0.5)]), abs=TURN / 360.0
    )


def test_zones_across_the_top_and_in_order() -> None:
    mixed = [(5.0, 5.5), (0.7, 2.4), (-9.0, -8.8), (-2.0, -1.0, 1)]
    moved = zones.in_order(mixed)
    expected = [(-9.0 + TURN, -8.8 + TURN), (-2.0, -1.0, 1), (5.0 - TURN, 5.5 - TURN), (0.7, 2.4)]
    assert [len(zone) for zone in moved] == [2, 3, 2, 2]
    for one, other in zip(moved, expected, strict=True):
        assert one == pytest.approx(other)
    assert zones.in_order([(3.0, 3.0 + TURN)]) == [zones.ALL_ROUND]
    assert zones.in_order([]) == []


def test_sliding_contacts_follow_the_rule(problem: Problem) -> None:
    for direction in np.linspace(0.0, TURN, 9):
        found = solve_sliding(problem, {"P": math.sin(direction), "Q": math.cos(direction)})
        assert BOTTOM - math.pi < 0.5 * sum(found.contact) <= TOP + 1e-6
        assert BOTTOM - math.pi < found.peak_pressure_angle <= TOP + 1e-6
        assert abs(math.remainder(found.peak_pressure_angle - 0.5 * sum(found.contact), TURN)) < 0.5


def test_residuals_of_the_integral_equations_of_a_turned_arc(problem: Problem) -> None:
    near, away = (
        solve(problem, CORNERS[:1], nodes=121, arc=(BOTTOM - 1.3 + turn, BOTTOM + 1.3 + turn))[-1]
        for turn in (0.0, TURN)
    )
    assert residuals_away(away, 0.1) == pytest.approx(residuals_away(near, 0.1), rel=1e-3)


def test_sticking_nodes_of_the_example(problem: Problem) -> None:
    """The example's states are near the bottom: the rule leaves their bits as they are."""
    case = parse_case(EXAMPLE)
    for state in solve(case.problem, case.history, nodes=101):
        check_order(state)
        assert np.any(state.status == STICK)
        assert state.contact == state.contact_in_runs
        assert state.stick == state._stick

"""Neat fits: their contact scales with all loads, and vanishes where all of them vanish together."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import LoadHistory, Material, MaterialPair, Problem, SolveError, solve
from fastpin.bodies import Tube
from fastpin.model import LOADS, Laminate
from fastpin.model.loads import P, Q
from fastpin.model.options import ALL_ROUND
from fastpin.solver.step import pieces
from tests.support.tiers import seeds
from tests.survey.histories import generate

STEEL, ALUMINIUM = Material(3.0, 0.3), Material(1.0, 0.33)
LIKE, UNLIKE = MaterialPair(ALUMINIUM, ALUMINIUM, "stress"), MaterialPair(STEEL, ALUMINIUM, "stress")
PLIES = MaterialPair(STEEL, Laminate(compliance=(0.2, -0.06, 1.0, 0.0, 0.0, 1.6)), "stress")

LOADED = {
    "syy": {"syy": 1.0}, "sxx": {"sxx": 1.0}, "sxy": {"sxy": 0.7},
    "all stresses": {"sxx": 0.3, "syy": -0.7, "sxy": 0.4},
    "P and syy": {"P": 0.7, "syy": 0.3}, "P, Q and M": {"P": 0.7, "Q": 0.3, "M": 0.05},
}  # fmt: skip


def _times(factor, loads):
    return {name: factor * value for name, value in loads.items()}


@pytest.mark.parametrize("pair", [LIKE, UNLIKE, PLIES], ids=["like", "unlike", "laminate"])
@pytest.mark.parametrize("name", LOADED)
def test_a_neat_fit_whose_loads_turn_round_begins_anew(name, pair):
    problem, loads = Problem.from_load_parameter(pair, 0.0, 0.15), LOADED[name]
    turned = solve(problem, [loads, _times(0.1, loads), loads, _times(-1.1, loads)], nodes=41, arc=ALL_ROUND)[-1]
    first = solve(problem, [_times(-1.1, loads)], nodes=41, arc=ALL_ROUND)[-1]
    np.testing.assert_array_equal(turned.status, first.status)
    np.testing.assert_allclose(turned.pressure, first.pressure, atol=1e-12)
    np.testing.assert_allclose(turned.shear, first.shear, atol=1e-12)


@pytest.mark.parametrize("clearance", [1e-13, -1e-13, 1e-9, 1e-7])
def test_a_fit_that_is_neat_up_to_rounding_behaves_as_a_neat_one(clearance):
    corners = [{"P": 0.7, "syy": 0.3}, {"P": -0.7, "syy": -0.3}, {"P": 0.0, "syy": 0.0}, {"syy": -0.3}]
    neat, nearly = (solve(Problem.from_load_parameter(UNLIKE, c, 0.15), corners, nodes=41) for c in (0.0, clearance))
    for one, other in zip(neat, nearly, strict=True):
        if one.grid == other.grid:
            np.testing.assert_allclose(one.pressure, other.pressure, atol=10.0 * abs(clearance) + 1e-9)
        assert one.peak_pressure == pytest.approx(other.peak_pressure, abs=0.02)


@pytest.mark.parametrize("size", [0.7923076923076923, 0.8846153846153847, 0.9076923076923077])
def test_a_stop_where_all_loads_vanish_up_to_rounding_is_the_place_of_the_cut(size):
    hollow = Problem.from_load_parameter(UNLIKE, 0.0, 0.9, "centre", "free", pin_body=Tube(0.6))
    result = solve(hollow, [{"sxx": size}, {"sxx": -size / 7.0}], nodes=41, between=7)
    (stop,) = [state for state in result if state.step == 1 and state.fraction == 0.875]
    assert not stop.in_contact
    assert stop.load["sxx"] == 0.0


def test_a_step_is_cut_where_all_that_presses_vanishes():
    before, after = np.zeros((2, len(LOADS)))
    before[P], before[Q], before[4], after[P], after[Q], after[4] = 0.3, 0.1, 0.7, -0.9, -0.3, -2.1
    first, second = pieces(before, after, nearly_neat=True)
    assert not first.after.any()
    assert not second.before.any()
    assert first.end == second.begin == pytest.approx(0.25)
    after[4] = 0.7  # the stress goes on pressing: the force alone vanishes
    first, second = pieces(before, after, nearly_neat=True)
    assert first.after[4] == pytest.approx(0.7)
    assert not first.after[[P, Q]].any()
    before[P], before[Q], after[P], after[Q], after[4] = 0.0, 0.0, 0.0, 0.0, -0.7
    assert len(pieces(before, after, nearly_neat=True)) == 2
    assert len(pieces(before, after, nearly_neat=False)) == 1


@pytest.mark.gate
def test_a_first_contact_in_two_places_under_a_force_and_stress_is_found():
    """The iteration that begins at the lowest place finds none of the proportional contacts here, nor does Lemke's.

    The last one is found by its statuses on fewer nodes.
    """
    for seed in (1062, 1510, 1670, 1165):
        case = generate("neat", seed)
        assert len(solve(case.problem, case.history, **case.options)) == len(case.history), seed


@pytest.mark.parametrize("rotation", ["free", "fixed"])
def test_a_hole_that_stress_opens_lets_a_neat_pin_go_where_its_force_vanishes(rotation):
    problem = replace(Problem.from_load_parameter(UNLIKE, 0.0, 0.2), rotation=rotation)
    states = solve(problem, [{"P": 1.0, "sxx": 0.2, "syy": 0.2}, {"P": 0.0}, {"P": -1.0}, {"P": 1.0}], nodes=41)
    assert not states[1].in_contact
    assert states[3].peak_pressure == pytest.approx(states[2].peak_pressure, rel=1e-2)


@pytest.mark.gate
def test_random_neat_fits():
    """All are solved: no moment is more than friction carries, and every remote stress lets the pin stay."""
    for seed in seeds(20):
        case = generate("neat", seed)
        try:
            solve(case.problem, case.history, **case.options)
        except SolveError as error:
            pytest.fail(f"{seed}: {error}")


def test_the_increments_of_a_neat_fit_cross_no_load():
    problem = Problem.from_load_parameter(UNLIKE, 0.0, 0.2)
    states = solve(problem, LoadHistory([{"syy": 1.0}, {"syy": -1.0}]), nodes=41, method="increment", increments=4)
    assert states[-1].peak_pressure == pytest.approx(solve(problem, [{"syy": -1.0}], nodes=41)[0].peak_pressure)

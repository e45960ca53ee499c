"""Friction that varies along the rim: values of reference, exact relations, and other methods."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, InputError, Problem, Result, State, solve
from fastpin.kernels.status import STICK
from fastpin.model import Profile
from fastpin.model.angles import BOTTOM
from fastpin.model.profile_terms import Harmonic, Zone
from fastpin.verification.finite_elements import LIKE, UNLIKE
from tests.support.checks.sliding import solve_sliding
from tests.support.programs import assert_same_bits
from tests.support.tiers import some_gate
from tests.survey.histories import generate

FRETTED = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"P": 0.5}, {"P": 1.0, "Q": 0.2}]


def wave(mean: float, order: int, cosine: float, sine: float) -> Profile:
    """Friction with a wave that counts from the bottom."""
    return Profile((Harmonic(0, mean), Harmonic.from_bottom(order, cosine, sine)))


PROBLEMS = {
    "M1": Problem.from_load_parameter(UNLIKE, 0.1, wave(0.35, 3, 0.0, 0.2), "centre", "fixed"),
    "M2": Problem.from_load_parameter(LIKE, 0.1, wave(0.3, 4, 0.15, 0.0), "body"),
}

# Value with 960 nodes, of another program; largest difference here with 240 and with 960 nodes.
TABLE = {
    "M1": {
        "peak": (0.62221, 6e-5, 4e-6), "bottom": (0.6146, 8e-4, 6e-5), "sum": (1.12739, 2e-5, 3e-6),
        "shear": (-0.07531, 3e-5, 2e-6), "dx": (0.02979, 6e-6, 4e-6),
    },
    "M2": {
        "peak": (0.60634, 2e-5, 4e-6), "bottom": (0.57944, 4e-5, 2e-6), "sum": (1.08737, 3e-5, 2e-6),
        "dx": (0.04415, 2e-5, 6e-6), "rotation": (-0.02733, 4e-6, 2e-6),
    },
}  # fmt: skip


def reading(state: State, name: str) -> float:
    return float({
        "peak": state.peak_pressure,
        "bottom": np.interp(BOTTOM, state.theta, state.pressure),
        "sum": state.grid.weights @ state.pressure,
        "shear": state.grid.weights @ state.shear,
        "dx": state.dx,
        "rotation": state.rotation,
    }[name])  # fmt: skip


def fretted(name: str, nodes: int) -> Result:
    return solve(PROBLEMS[name], FRETTED, grid=Grid.circle(nodes))


@pytest.mark.parametrize("nodes", some_gate([240, 960], 960, 960))
@pytest.mark.parametrize("name", TABLE)
def test_the_table_of_reference(name: str, nodes: int) -> None:
    state = fretted(name, nodes)[-1]
    for quantity, (value, *most) in TABLE[name].items():
        assert reading(state, quantity) == pytest.approx(value, abs=most[nodes == 960]), quantity


@pytest.mark.parametrize("nodes", [100, 200])
def test_half_planes_slide_where_the_mean_friction_is_reached(nodes: int) -> None:
    """Two zones of equal pressure carry (0.3 + 0.5)/2 P. One node sticks until then."""
    half = 1.2 / math.sqrt(2e5 * math.pi)
    friction = Profile((Harmonic(0, 0.3), Zone(0.2, BOTTOM, BOTTOM + 1.0)))
    problem = Problem.from_load_parameter(LIKE, 2e5, friction, "centre", "fixed")
    arc = (BOTTOM - half, BOTTOM + half)
    below, beyond = (solve(problem, [{"P": 1.0}, {"Q": q}], nodes=nodes, arc=arc)[-1] for q in (0.3999, 0.4001))
    assert 1 <= np.count_nonzero(below.status == STICK) <= 4
    assert not np.any(beyond.status == STICK)
    right = beyond.theta > BOTTOM
    for side, friction_there in ((right, 0.5), (~right, 0.3)):
        limit = friction_there * beyond.pressure[side]
        assert np.abs(beyond.shear[side]) == pytest.approx(limit, abs=1e-12 * limit.max())


@pytest.mark.parametrize("kind", ["general", "fits", "fixed"])
def test_equal_values_along_the_rim_give_the_bits_of_their_number(kind: str) -> None:
    for seed in (2, 3, 4):
        case = generate(kind, seed)
        assert isinstance(case.problem.friction, float)
        equal = Profile.constant(case.problem.friction) + Profile.zone(0.0, 0.0, 1.0)
        varied = replace(case.problem, friction=equal)
        assert isinstance(varied.friction, Profile)
        ones, others = (solve(problem, case.history, **case.options) for problem in (case.problem, varied))
        assert np.array_equal(ones.grid.theta, others.grid.theta)
        assert_same_bits(ones, others)


def test_friction_where_nothing_touches_has_no_effect() -> None:
    plain = solve(Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body"), FRETTED, nodes=61, arc=(-3.1, 0.0))
    beside = Profile((Harmonic(0, 0.4), Zone(0.3, 0.5, 2.0), Zone(-0.4, -3.1, -3.02)))
    found = solve(Problem.from_load_parameter(UNLIKE, 0.1, beside, "body"), FRETTED, grid=plain.grid)
    assert np.ptp(found[-1].friction) > 0.1
    for one, other in zip(plain, found, strict=True):
        assert np.array_equal(one.pressure, other.pressure)
        assert np.array_equal(one.shear, other.shear)


def test_methods_for_one_number_refuse_it() -> None:
    with pytest.raises(InputError, match="friction: must be one number here"):
        solve_sliding(PROBLEMS["M1"], {"P": 1.0, "Q": 1.0})

"""Numbers of extreme size: each is refused with one sentence, or gives finite results."""

import contextlib
import re
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import ConvergenceError, InputError, SolveError
from tests.support.faults import fault_of
from tests.support.refusals import refused


@pytest.mark.parametrize("name", ["P", "Q", "M", "sxx", "syy", "sxy", "rotation"])
@pytest.mark.parametrize("value", [1e308, -1e200, 1e120])
def test_a_load_beyond_all_scales_is_refused(similar, name, value):
    rotation = "fixed" if name == "rotation" else "free"
    for problem in (
        fastpin.Problem.from_load_parameter(similar, 0.1, 0.1, rotation=rotation),
        fastpin.Problem(similar, 0.01, 2e-5, 0.1, rotation=rotation),
    ):
        with pytest.raises(InputError, match=rf"^{name}: must lie between -.* and .*, not {re.escape(f'{value:g}')}$"):
            fastpin.solve(problem, [{"P": 1.0}, {name: value}], nodes=41)


def test_a_load_beyond_all_scales_gets_the_same_sentence_in_a_case_file(similar):
    problem = fastpin.Problem(fastpin.MATERIALS["steel"] and similar, 0.01, 2e-5, 0.3)
    text = "[pin]\nE = 100e9\nnu = 0.3\n[plate]\nE = 100e9\nnu = 0.3\n[contact]\nhole_radius = 0.01\nclearance = 2e-5\n"
    fault = fault_of(fastpin.casefile.parse_case, f"{text}friction = 0.3\n[[load]]\nP = 1e200\n")
    assert fault == (12, str(refused(fastpin.solve, problem, [{"P": 1e200}])))


@pytest.mark.parametrize("force", [5e-324, 1e-320, 1e-60])
def test_a_history_of_tiny_loads_is_refused(similar, force):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.1)
    with pytest.raises(InputError, match="history: the largest load must be at least 1e-50 times"):
        fastpin.solve(problem, [{"P": force}], nodes=41)


@pytest.mark.gate
@pytest.mark.parametrize("load_parameter", [1e12, 1e50, 1e20, 1e30])
def test_a_contact_narrower_than_the_digits_of_an_angle_is_lost(similar, load_parameter):
    problem = fastpin.Problem.from_load_parameter(similar, load_parameter, 0.1)
    with pytest.raises(ConvergenceError, match="narrower than the nodes can resolve"):
        fastpin.solve(problem, [{"P": 1.0}], nodes=41)


def solve_scaled(modulus: float = 100e9, radius: float = 0.01, ratio: float = 1.0) -> fastpin.Result:
    """Solve one case in other units, with loads near their limits."""
    pair = fastpin.MaterialPair(fastpin.Material(modulus, 0.3), fastpin.Material(modulus * ratio, 0.3))
    problem = fastpin.Problem(pair, radius, 2e-3 * radius, 0.4)
    force = radius / pair.beta_star
    return fastpin.solve(problem, [{"P": 1e-3 * force}, {"P": 1e49 * force}, {"sxx": 1e49 / pair.beta_star}], nodes=21)


@pytest.mark.parametrize("modulus", [1e-60, 1e-30, 1.0, 1e60])
@pytest.mark.parametrize("radius", [1e-30, 1.0, 1e30])
def test_every_result_within_the_limits_is_finite(modulus, radius):
    result = None
    try:
        result = solve_scaled(modulus, radius)
    except SolveError as error:
        result = error.result
    assert result
    for state in result:
        arrays = [state.pressure, state.shear, state.gap, state.slip]
        numbers = [state.dx, state.dy, state.rotation, state.dissipation, state.work, state.energy]
        assert all(np.isfinite(each).all() for each in [*arrays, numbers])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: solve_scaled(5e-324), "E: must lie between 1e-60 and 1e+60, not 4.94066e-324"),
        (lambda: solve_scaled(1e-70), "E: must lie between 1e-60 and 1e+60, not 1e-70"),
        (lambda: solve_scaled(1e300), "E: must lie between 1e-60 and 1e+60, not 1e+300"),
        (lambda: solve_scaled(ratio=1e31), "plate: the moduli of pin and plate must not differ by more than a factor"),
        (lambda: solve_scaled(radius=1e-300), "hole_radius: must lie between 1e-30 and 1e+30, not 1e-300"),
        (lambda: solve_scaled(radius=1e300), "hole_radius: must lie between 1e-30 and 1e+30, not 1e+300"),
        (lambda: fastpin.LoadHistory([{"P": 10**400}]), "P of corner 1: must be a finite number, not inf"),
    ],
)
def test_numbers_beyond_all_scales_are_refused(call, message):
    assert str(refused(call)).startswith(message)


def test_a_stiff_body_is_rigid_long_before_the_limit(similar):
    def peak(pin: fastpin.Material, plate: fastpin.Material) -> float:
        problem = fastpin.Problem(fastpin.MaterialPair(pin, plate), 0.01, 2e-5, 0.4)
        return fastpin.solve(problem, [{"P": 1e6}], nodes=61)[0].peak_pressure

    soft, rigid = similar.pin, fastpin.Material.rigid()
    stiff = fastpin.Material(1e29 * soft.E, 0.3)
    assert peak(soft, stiff) == pytest.approx(peak(soft, rigid), rel=1e-12)
    assert peak(stiff, soft) == pytest.approx(peak(rigid, soft), rel=1e-12)


def test_numbers_that_no_result_can_hold_are_refused(similar):
    def problem(**fields: Any) -> fastpin.Problem:
        return fastpin.Problem(**{"pair": similar, "hole_radius": 0.01, "clearance": 0.0, "friction": 0.4} | fields)

    with pytest.raises(InputError, match=r"friction: must lie between 0 and 1e\+06, not 1e\+20"):
        problem(friction=1e20)
    with pytest.raises(InputError, match=r"hub_radius: must lie between 1e-07 and the hole radius 0.01, not 1e-08"):
        problem(rotation="fixed", hub_radius=1e-8)
    with pytest.raises(InputError, match="load_parameter: must lie between"):
        fastpin.Problem.from_load_parameter(similar, -1e300, 0.4)
    with pytest.raises(InputError, match="force: is too small for a load parameter"):
        problem(clearance=1e-5).load_parameter(0.0)
    with pytest.raises(InputError, match="beta_star: must lie between"):
        similar.scaled(0.0)


def test_the_least_hub_turns_as_a_free_pin(similar):
    held = fastpin.Problem(similar, 0.01, 2e-5, 0.4, rotation="fixed", hub_radius=1e-7)
    free = fastpin.Problem(similar, 0.01, 2e-5, 0.4)
    turned = [fastpin.solve(each, [{"P": 1e6}, {"Q": 1e5}], nodes=101)[-1].rotation for each in (held, free)]
    assert turned[0] == pytest.approx(turned[1], rel=1e-7)


def test_an_incompressible_pin_fits_into_no_smaller_rigid_hole():
    rubber, rigid = fastpin.Material(1e6, 0.5), fastpin.Material.rigid()
    with pytest.raises(InputError, match=r"^clearance: a pin with nu = 0.5 in a rigid plate keeps its area"):
        fastpin.Problem(fastpin.MaterialPair(rubber, rigid), 0.01, -1e-6, 0.3)
    for pair in (
        fastpin.MaterialPair(rubber, rigid, "stress"),
        fastpin.MaterialPair(fastpin.Material(1e6, 0.499), rigid),
        fastpin.MaterialPair(rigid, rubber),
    ):
        fastpin.solve(fastpin.Problem(pair, 0.01, -1e-6, 0.3), [{"P": 1.0}], nodes=41)
    with contextlib.suppress(SolveError):
        fastpin.solve(fastpin.Problem(fastpin.MaterialPair(rubber, rigid), 0.01, 0.0, 0.3), [{"P": 1.0}], nodes=41)

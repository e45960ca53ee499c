"""Checks of unlike bodies, of full sliding and of the singular integral equations, by methods of other mathematics."""

from __future__ import annotations

from fastpin import MATERIALS, Material, MaterialPair, Problem
from fastpin.verification.finite_elements import UNLIKE
from fastpin.verification.rows import Checks, Solving, angle_check, difference_check, half_width, relative_check
from tests.support.checks.integral_equations import residuals_away
from tests.support.checks.sliding import solve_sliding

COUPLED = {
    "Ti-6Al-4V in Al": UNLIKE,
    "rigid pin": MaterialPair(Material.rigid(), MATERIALS["aluminium"]),
    "soft pin": MaterialPair(Material(1e9, 0.2), Material(30e9, 0.3)),
}


def coupled(pair: MaterialPair, load_parameter: float, solving: Solving) -> Checks:
    problem = Problem.from_load_parameter(pair, load_parameter, 0.0)
    (state,) = solving(problem, [{"P": 1.0}])
    series = solve_sliding(problem, {"P": 1.0})
    yield relative_check("peak N", state.peak_pressure, series.peak_pressure)
    yield angle_check("half-angle", half_width(state.contact[0]), half_width(series.contact))


def sliding(pair: MaterialPair, solving: Solving) -> Checks:
    problem = Problem.from_load_parameter(pair, 0.5, 0.3, "centre", "fixed")
    state = solving(problem, [{"P": 1.0}, {"Q": 1.0}])[-1]
    series = solve_sliding(problem, {"P": 1.0, "Q": 1.0})
    yield relative_check("peak N", state.peak_pressure, series.peak_pressure)
    yield relative_check("peak T", abs(state.peak_shear), problem.uniform_friction * series.peak_pressure)
    yield relative_check("moment", state.resultants["M"], series.moment)
    for ours, reference in zip(state.contact[0], series.contact, strict=True):
        yield angle_check("end", ours, reference)


def singular_equations(solving: Solving) -> Checks:
    (state,) = solving(Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body"), [{"P": 1.0}])
    first, second = residuals_away(state, 0.085)
    yield difference_check("(46)", first, "F beta*")
    yield difference_check("(47)", second, "F beta*")


def singular_equations_with_stress(solving: Solving) -> Checks:
    problem = Problem.from_load_parameter(UNLIKE, 0.3, 0.5, "centre")
    state = solving(problem, [{"P": 1.0}, {"Q": 0.2, "sxx": 0.3, "syy": -0.1}])[-1]
    yield difference_check("(47)", residuals_away(state, 0.15)[1], "F beta*")

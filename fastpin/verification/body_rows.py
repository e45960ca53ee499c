"""Checks of interference fits in contact all round, hollow pins, rings and bushes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fastpin.kernels.status import STICK
from fastpin.model.materials import MaterialPair
from fastpin.model.problem import Problem
from fastpin.verification import body_cases, interference
from fastpin.verification.comparisons import all_round_difference, event_load
from fastpin.verification.rows import NODES, Checks, Solving, angle_check, difference_check, half_width, relative_check
from fastpin.verification.sliding import solve_sliding


def _stress_of_fit(problem: Problem) -> dict[str, float]:
    """Remote stresses that leave an interference fit closed, and stuck with a friction of 0.3."""
    pressure = interference.uniform_pressure(problem)
    return {"sxx": 0.1 * pressure, "syy": -0.05 * pressure, "sxy": 0.04 * pressure}


FITS: dict[str, tuple[float, Callable[[Problem], dict[str, float]]]] = {
    "P, mu = 0": (0.0, lambda problem: {"P": 0.9 * interference.frictionless_opening_load(problem)}),
    "P, mu = 0.3": (0.3, lambda problem: {"P": 0.9 * interference.first_slip_load(problem)}),
    "stress, mu = 0": (0.0, _stress_of_fit),
    "stress, mu = 0.3": (0.3, _stress_of_fit),
    "M, mu = 0.3": (0.3, lambda problem: {"M": 0.9 * interference.first_slip_moment(problem)}),
}
"""Coefficient of friction, and loads under which the contact stays closed all round and stuck, by the case."""


def all_round(pair: MaterialPair, case: str, solving: Solving) -> Checks:
    """An interference fit that stays closed all round, against its closed form."""
    friction, loads = FITS[case]
    problem = Problem.from_load_parameter(pair, -0.3, friction)
    yield difference_check("tractions", all_round_difference(solving(problem, [loads(problem)])[-1]), "N0")


def first_slip(pair: MaterialPair, solving: Solving) -> Checks:
    """The load at which an interference fit slips first."""
    problem = Problem.from_load_parameter(pair, -0.3, 0.3)
    exact = interference.first_slip_load(problem)
    bounds = 0.9 * exact, 1.1 * exact
    load = event_load(problem, "P", bounds, lambda state: bool(np.any(state.status != STICK)), NODES, solving)
    yield relative_check("slip begins", load, exact)


def finite_bodies(name: str, solving: Solving) -> Checks:
    """A joint with finite bodies against values of 1,601 nodes, finite elements, and without friction Eq. (58)."""
    case = body_cases.CASES[name]
    state = solving(case.problem, case.history)[-1]
    yield relative_check("peak N", state.peak_pressure, case.peak)
    yield relative_check("int N", float(state.grid.weights @ state.pressure), case.total)
    yield angle_check("half-angle", half_width(state.contact[0]), case.half_angle)
    if case.elements is not None:
        yield relative_check("peak N, elements", state.peak_pressure, case.elements)
    if case.problem.frictionless:
        series = solve_sliding(case.problem, {"P": 1.0})
        yield relative_check("peak N, (58)", state.peak_pressure, series.peak_pressure)
        yield angle_check("half-angle, (58)", half_width(state.contact[0]), half_width(series.contact))


def stuck_bodies(solving: Solving) -> Checks:
    """A hollow pin pressed into a bush in a ring, under a force below the first slip at P = 0.67."""
    force = 0.1
    (state,) = solving(body_cases.STUCK, [{"P": force}])
    pressure, shear = interference.stuck_tractions(body_cases.STUCK, state.theta, {"P": force})
    yield difference_check("N, stuck", float(np.abs(state.pressure - pressure).max()) / force, "P/R")
    yield difference_check("T, stuck", float(np.abs(state.shear - shear).max()) / force, "P/R")


def pressed_bodies(solving: Solving) -> Checks:
    """The same fit, loaded a little and unloaded."""
    state = solving(body_cases.STUCK, [{"P": 0.01}, {"P": 0.0}])[-1]
    yield relative_check("peak N", state.peak_pressure, interference.uniform_pressure(body_cases.STUCK))


def ring_by_compliance(solving: Solving) -> Checks:
    """A ring by its closed forms, and by the compliance between Fourier coefficients."""
    ring = body_cases.RING
    by_matrix = replace(ring, plate_body=body_cases.ring_compliance(ring, 32))
    (one,), (two,) = (solving(problem, [{"P": 1.0, "Q": 0.2, "sxx": 0.05}]) for problem in (ring, by_matrix))
    difference = np.abs([one.pressure - two.pressure, one.shear - two.shear]).max()
    yield difference_check("N, T", float(difference) / one.peak_pressure, "peak N")


def cut_layer(solving: Solving) -> Checks:
    """A bush in a ring, and the same bush cut into two layers."""
    for kind in ("free", "held"):
        difference = body_cases.cut_layer_difference(kind)
        yield difference_check("compliance", difference, "the largest", f"cut bush, {kind} rim")

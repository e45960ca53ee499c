"""Checks of interference fits in contact all round, hollow pins, rings and bushes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.verification import interference
from fastpin.verification.joint_rows import STUCK
from fastpin.verification.rows import Checks, Solving, angle_check, difference_check, half_width, relative_check
from tests.support.checks import body_cases
from tests.support.checks.sliding import solve_sliding


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
    (state,) = solving(STUCK, [{"P": force}])
    pressure, shear = interference.stuck_tractions(STUCK, state.theta, {"P": force})
    yield difference_check("N, stuck", float(np.abs(state.pressure - pressure).max()) / force, "P/R")
    yield difference_check("T, stuck", float(np.abs(state.shear - shear).max()) / force, "P/R")


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

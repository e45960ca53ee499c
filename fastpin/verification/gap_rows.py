"""Checks of initial gaps."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.elasticity.system import System
from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.materials import MaterialPair
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile
from fastpin.model.profile_terms import Harmonic
from fastpin.solver.result import Result
from fastpin.verification.body_cases import RING, STUCK
from fastpin.verification.comparisons import all_round_difference
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.rows import Checks, Solving, angle_check, difference_check, relative_check
from fastpin.verification.sliding import solve_sliding

WAVES = InitialGap(Profile((Harmonic(1, 0.01), Harmonic(2, 0.02, 0.01), Harmonic(3, 0.005))))
"""Waves of a fit that stays closed all round."""

CIRCLE = Grid.circle(120)
"""Nodes of the exact relations."""

FRETTED = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2, "P": 0.5}]


def waves(pair: MaterialPair, friction: float, hollow: bool, solving: Solving) -> Checks:
    """An unloaded interference fit that slides freely, or sticks all round."""
    bodies: dict[str, Any] = {"pin_body": STUCK.pin_body, "plate_body": RING.plate_body} if hollow else {}
    problem = Problem.from_load_parameter(pair, -0.3, friction, gap=WAVES, **bodies)
    (state,) = solving(problem, [{"P": 0.0}], nodes=201)
    yield difference_check("tractions", all_round_difference(state), "N0")


def sliding(solving: Solving) -> Checks:
    """A pin that slides over the whole contact in an uneven hole."""
    uneven = InitialGap(Profile((Harmonic(2, 0.03, 0.02),)), Profile((Harmonic(3, 0.01),)))  # leaves one contact
    problem = Problem.from_load_parameter(LIKE, 0.5, 0.3, "centre", "fixed", gap=uneven)
    state = solving(problem, [{"P": 1.0}, {"Q": 1.0}], nodes=201, arc=(BOTTOM - 1.1, BOTTOM + 1.4))[-1]
    series = solve_sliding(problem, {"P": 1.0, "Q": 1.0})
    yield relative_check("peak N", state.peak_pressure, series.peak_pressure)
    yield relative_check("moment", state.resultants["M"], series.moment)
    for ours, reference in zip(state.contact[0], series.contact, strict=True):
        yield angle_check("end", ours, reference)


def round_hole(term: Harmonic, solving: Solving) -> Checks:
    """A gap that is a part of the clearance, or a shift of the pin: the tractions of a round hole."""
    clearance = 0.3 if term.order else 0.3 - term.cosine
    plain = Problem.from_load_parameter(UNLIKE, 0.3, 0.4, "body")
    problem = Problem.from_load_parameter(UNLIKE, clearance, 0.4, "body", gap=InitialGap(Profile((term,))))
    ours, expected = (solving(each, FRETTED, grid=CIRCLE) for each in (problem, plain))
    yield difference_check("N, T", _difference(ours, expected), "peak N")


def oval(solving: Solving) -> Checks:
    """Without friction the half axes R + e and R - e are those of a round hole under a remote stress."""
    plain = Problem.from_load_parameter(UNLIKE, 0.3, 0.0, "centre", "fixed")
    stress = 0.1
    ellipse = InitialGap(Profile.ellipse(2.0 * stress * System.build(plain, CIRCLE, 1.0).plate))
    problem = Problem.from_load_parameter(UNLIKE, 0.3, 0.0, "centre", "fixed", gap=ellipse)
    stretched = [{"sxx": stress, "syy": -stress, **FRETTED[0]}, *FRETTED[1:]]
    ours, expected = solving(problem, FRETTED, grid=CIRCLE), solving(plain, stretched, grid=CIRCLE)
    yield difference_check("N, T", _difference(ours, expected), "peak N")


def _difference(ours: Result, expected: Result) -> float:
    """The largest difference of the tractions of two results, over the peak pressure."""
    pairs = zip(ours, expected, strict=True)
    return max(
        float(np.abs([one.pressure - two.pressure, one.shear - two.shear]).max()) / two.peak_pressure
        for one, two in pairs
    )

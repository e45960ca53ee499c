"""Checks of initial gaps."""

from __future__ import annotations

from typing import Any

from fastpin import MaterialPair, Problem
from fastpin.model import InitialGap, Profile
from fastpin.model.angles import BOTTOM
from fastpin.model.profile_terms import Harmonic
from fastpin.verification.comparisons import all_round_difference
from fastpin.verification.finite_elements import LIKE
from fastpin.verification.joint_rows import STUCK
from fastpin.verification.rows import Checks, Solving, angle_check, difference_check, relative_check
from tests.support.checks.body_cases import RING
from tests.support.checks.sliding import solve_sliding

WAVES = InitialGap(Profile((Harmonic(1, 0.01), Harmonic(2, 0.02, 0.01), Harmonic(3, 0.005))))
"""Waves of a fit that stays closed all round."""


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

"""Checks of friction that varies along the rim, or changes while the loads do."""

from __future__ import annotations

from fastpin import Problem, State
from fastpin.model import Profile
from fastpin.model.profile_terms import Harmonic
from fastpin.verification.finite_elements import FRETTING, UNLIKE
from fastpin.verification.joint_rows import PUSHED
from fastpin.verification.rows import Check, Checks, Solving, difference_check, relative_check
from tests.support.checks.integral_equations import residuals_away

ROUGH = Problem.from_load_parameter(
    UNLIKE, 0.1, Profile((Harmonic(0, 0.35), Harmonic.from_bottom(3, 0.0, 0.2))), "centre", "fixed"
)
"""A pin whose friction varies along the rim."""


def along_the_rim(solving: Solving) -> Checks:
    """The integral equations under a first load, and the work of a history."""
    states = solving(ROUGH, [*FRETTING, {"P": 0.5}])
    for name, difference in zip(("(46)", "(47)"), residuals_away(states[0], 0.12), strict=True):
        yield difference_check(name, difference, "F beta*")
    yield _work(states[-1])


def with_the_loads(solving: Solving) -> Checks:
    """The work of a step along which friction falls."""
    yield _work(solving(ROUGH, [*PUSHED, {"P": 0.8, "Q": -0.1, "friction_change": -0.6}], nodes=41)[-1])


def _work(state: State) -> Check:
    return relative_check("work", state.work, state.energy + state.dissipation)

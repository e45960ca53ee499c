"""Checks of cracks at the edge of the hole, in stresses with closed forms."""

from __future__ import annotations

import math

from fastpin import Problem, State
from fastpin.cracks import Crack, stress_intensity
from fastpin.model.growth import SMOOTH_EDGE
from fastpin.verification.finite_elements import LIKE
from fastpin.verification.rows import Checks, Solving, relative_check
from tests.support.checks.body_cases import RING

LENGTHS = {"0.1 R": (0.1, 2.772722, 2.786499), "1 R": (1.0, 1.306096, 1.472125), "5 R": (5.0, 0.845527, 1.098221)}
"""Lengths, and K over s sqrt(pi a) of one crack and of two across a tension s of an open hole, to 1e-6."""

RING_FACTOR = 1.68339
"""K over p sqrt(pi a) of a crack of 0.1 R in a ring of outer radius 2 R under the pressure p in its hole."""


def open_hole(solving: Solving) -> Checks:
    """A tension across cracks, and a pin that touches nothing."""
    (state,) = solving(Problem.from_load_parameter(LIKE, 0.5, 0.3, "body"), [{"syy": 0.1}])
    both = [Crack(0.0), Crack(math.pi)]
    yield relative_check("K", _factor(state, both[:1], 1e-6) / 0.3, SMOOTH_EDGE, "short")
    for name, (length, one, two) in LENGTHS.items():
        yield relative_check("K", _factor(state, both[:1], length) / 0.1, one, f"one, {name}")
        yield relative_check("K", _factor(state, both, length) / 0.1, two, f"two, {name}")
    yield relative_check("K", _factor(state, both[:1], 1e4) / 0.1, math.sqrt(0.5), "long")


def ring(solving: Solving) -> Checks:
    """A pin that is gripped by a ring."""
    state = _fitted(Problem.from_load_parameter(LIKE, -0.1, 0.3, plate_body=RING.plate_body), solving)
    yield relative_check("K", _factor(state, [Crack(-0.3)], 0.1) / state.peak_pressure, RING_FACTOR)


def _factor(state: State, cracks: list[Crack], length: float) -> float:
    """K_I of the first of some cracks of one length, over sqrt(pi a)."""
    return float(stress_intensity(state, cracks, [length]).K_I[0, 0, 0]) / math.sqrt(math.pi * length)


def _fitted(problem: Problem, solving: Solving) -> State:
    """A fit, loaded a little and unloaded."""
    return solving(problem, [{"P": 0.01}, {"P": 0.0}])[-1]

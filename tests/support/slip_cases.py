"""Problems and histories for tests of slip sums, by name: all kinds of loads, snaps, unloading, the whole circle."""

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np

from fastpin import MATERIALS, Grid, Material, MaterialPair, Problem, Result, State, solve
from fastpin.kernels.status import OPEN
from tests.support.snap_cases import GRIPPED, TURNED
from tests.survey.histories import random_case

LIKE = MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
FRETTING = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.2}]
CIRCLE = {"grid": Grid.circle(160, 0.3)}
DRIVEN = [{"P": 1.0}, {"ux": 0.2}, {"ux": -0.2}, {"ux": 0.1}]


def unitless(pair: MaterialPair, load_parameter: float, friction: float, *kind: str, **more: Any) -> Problem:
    """A problem of the paper's dimensionless form."""
    return Problem.from_load_parameter(pair, load_parameter, friction, *kind, **more)


CASES: dict[str, tuple[Problem, Any, dict[str, Any]]] = {
    "unlike bodies": (unitless(UNLIKE, 0.1, 0.4, "body"), FRETTING, {"nodes": 101}),
    "in SI units": (Problem(UNLIKE, 0.01, 2e-5, 0.4), [{"P": 2e6}, {"Q": 5e5}, {"Q": -5e5}], {"nodes": 81}),
    "normal unloading": (unitless(UNLIKE, 0.1, 0.3), [{"P": 1.0}, {"P": 0.1}, {"P": 0.6}], {"nodes": 101}),
    "separation": (unitless(LIKE, 0.5, 0.5), [{"P": 1.0, "Q": 0.3}, {"P": 0.0, "Q": 0.0}, {"P": -1.0}], CIRCLE),
    "neat fit": (unitless(UNLIKE, 0.0, 0.4), [{"P": 1.0, "Q": 0.2}, {"Q": -0.2}], {"nodes": 101}),
    "interference": (unitless(UNLIKE, -0.01, 0.3), FRETTING, CIRCLE),
    "moment": (unitless(LIKE, 0.2, 0.5), [{"P": 1.0, "M": 0.1}, {"M": -0.1}], {"nodes": 101}),
    "remote stress": (
        unitless(UNLIKE, 0.2, 0.5, "centre", "fixed"),
        [{"P": 1.0}, {"Q": 0.1, "sxx": 0.2, "sxy": -0.1}, {"Q": -0.1, "sxx": -0.2, "sxy": 0.1}],
        CIRCLE,
    ),
    "driven": (unitless(UNLIKE, 0.2, 0.5, "centre", "fixed", drive="ux"), DRIVEN, {"nodes": 101}),
    "snap": (*GRIPPED, {"nodes": 101}),
    "snap under a moment": (*TURNED, {"nodes": 101}),
    "much friction": (unitless(LIKE, 0.3, 2.0, "centre", "fixed"), FRETTING, {"nodes": 101}),
}
METHODS: dict[str, dict[str, Any]] = {"path": {}, "increment": {"method": "increment", "increments": 12}}


@functools.cache
def solved(name: str, between: int = 0, method: str = "path") -> Result:
    """A case with slip sums, solved once. With states inside its steps it is on the grid of the case without them."""
    problem, history, options = CASES[name]
    if between or method != "path":
        options = {"grid": solved(name).grid, **METHODS[method]}
    return solve(problem, history, slip_sums=True, between=between, **options)


WAYS = [(name, method) for name in CASES for method in METHODS if method == "path" or "snap" not in name]
"""Cases and methods; increments end at a snap."""


@functools.cache
def random_states(seed: int) -> Result:
    """A random history with slip sums, and with states inside its steps, solved once."""
    problem, history = random_case(seed)
    return solve(problem, history, nodes=81, slip_sums=True, between=2)


def assert_contains(states: Sequence[State]) -> None:
    """The extremes of each state contain its slip, and the slip at the kept corner before."""
    corner: list[State] = []
    for state in states:
        for one in (*corner, state):
            closed = one.status != OPEN
            assert np.all(state.slip_lowest[closed] <= one.slip[closed])
            assert np.all(one.slip[closed] <= state.slip_highest[closed])
        assert np.array_equal(np.isnan(state.slip_lowest), np.isnan(state.slip_highest))
        corner = [state] if state.fraction == 1.0 else corner

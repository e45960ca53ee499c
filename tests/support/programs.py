"""Load programs that become periodic, and comparisons of results bit by bit."""

import functools
from collections.abc import Iterable

import numpy as np

from fastpin import Grid, LoadHistory, Problem, Result, State, solve

CYCLE = [{"Q": 0.275}, {"Q": -0.275}]
FIELDS = ("pressure", "shear", "gap", "slip", "status")
SLIP = ("slip_distance", "friction_energy")  # None without the option slip_sums, like the next two
EXTREMES = ("slip_lowest", "slip_highest")
MOTION = ("load", "dx", "dy", "rotation", "dissipation", "work", "energy")
NUMBERS = ("step", "fraction", *MOTION, "residuals")


def q(*values: float) -> LoadHistory:
    """Corners with these values of Q; all other loads stay as they are."""
    return LoadHistory.from_array(np.array(values)[:, None], ["Q"])


P = LoadHistory([{"P": 1.0}])
RANDOM = np.random.default_rng(0).uniform(-0.28, 0.28, 16)
PROGRAMS = {
    "cycles": LoadHistory.cycles({"P": 1.0}, {"Q": 0.275}, 16),
    "corners": LoadHistory([{"P": 1.0}, *CYCLE * 16, {"Q": 0.1}]),
    "two levels": P + (q(0.2, -0.2).repeated(5) + q(0.3, -0.3).repeated(3)).repeated(4) + q(0.1),
    "spectrum": P + q(*RANDOM, 0.3).repeated(4),
    "cycles, then corners": P + (q(0.3, -0.3).repeated(4) + q(0.1, 0.2, 0.1)).repeated(4),
    "loads that come back": P + q(0.2, -0.2).repeated(8) + (q(0.3, -0.3) + q(0.1, -0.1).repeated(5)).repeated(4),
    "begins inside a period": P
    + (q(*[0.2, -0.2] * 4) + q(0.2, -0.2, 0.2, -0.2, 0.2, -0.2, 0.3).repeated(2)).repeated(3),
    "begins before a period": P + (q(*[0.2, -0.2] * 3, 0.2) + q(*[-0.2, 0.2] * 3, -0.2, 0.3).repeated(2)).repeated(3),
    "minus zero": P + q(*[0.2, 0.0] * 6, -0.0, 0.2, -0.0),
    "pressed again and again": LoadHistory([{"P": 1.0}, {"Q": 0.2}, {"P": 0.0, "Q": 0.0}]).repeated(8),
}


@functools.cache
def grid_of(problem: Problem, program: str) -> Grid:
    """The grid that the solver chooses for a program with 61 nodes. The choice takes as long as the run."""
    return solve(problem, PROGRAMS[program], nodes=61, keep="every 100").grid


def assert_same(one: Iterable[State], other: Iterable[State]) -> None:
    """Two results have the same states, to the last bit."""
    for first, second in zip(one, other, strict=True):
        for name in (*FIELDS, *SLIP, *EXTREMES):
            mine, others = getattr(first, name), getattr(second, name)
            assert mine is others is None or np.array_equal(mine, others, equal_nan=True), (name, first.step)
        for name in NUMBERS:
            assert getattr(first, name) == getattr(second, name), (name, first.step)


def assert_same_bits(states: Iterable[State], others: Iterable[State]) -> None:
    """States are the same to the last bit. They may count their steps from other beginnings, and have no slip sums."""
    for one, other in zip(states, others, strict=True):
        for name in (*FIELDS, *MOTION):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name


def difference(ones: Iterable[State], others: Iterable[State], *more: str) -> float:
    """Largest difference of the tractions (and other fields) of states on one grid, over the peak pressure."""
    pairs = list(zip(ones, others, strict=True))
    peak = max(one.peak_pressure for one, _ in pairs)
    return max(
        float(np.abs(getattr(one, name) - getattr(other, name)).max()) / peak
        for one, other in pairs
        for name in ("pressure", "shear", *more)
    )


def known(result: Result) -> list[tuple]:
    """Cycles, without whether they were solved; as text, where what is not known is equal to itself."""
    return [tuple(map(repr, cycle[:-1])) for cycle in result.cycles]

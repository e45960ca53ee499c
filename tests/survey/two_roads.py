"""The path solver against load increments, on histories that are hard.

:func:`compare` solves a random case by path, then by increments on the same nodes. The difference of pressure and shear
must fall as the increments shrink. It is in parts of int N, the largest of all corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fastpin.errors import FastpinError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from tests.survey.histories import generate
from tests.survey.random_histories import LONGEST, within_time

CLASSES = ("extreme", "narrow", "rough", "moderate_stress", "fits")
"""Classes whose cases are compared."""

INCREMENTS = (100, 400)
"""Increments of a step, first and then."""

MOST_NODES = 600
"""Cases with more nodes are left out: an increment takes a dense solution."""

AGREE = 0.01
"""Largest difference of two results that agree, in parts of int N."""

FALLS = 0.6
"""Largest ratio of the two differences of a case in which they fall."""


@dataclass
class Comparison:
    """The outcome of one case: the verdict, its message, and the differences with few and many increments."""

    kind: str
    seed: int
    verdict: str
    message: str = ""
    differences: tuple[float, ...] = ()


def distances(one: Result, two: Result) -> np.ndarray:
    """int |dN| + |dT| of each pair of states, in parts of int N, shape (states,)."""
    weights, apart = one.grid.weights, []
    for first, second in zip(one, two, strict=True):
        changes = np.abs(first.pressure - second.pressure) + np.abs(first.shear - second.shear)
        apart.append(float(weights @ changes) / max(float(weights @ first.pressure), 1e-300))
    return np.array(apart)


def compare(kind: str, seed: int) -> Comparison:
    """Solve a case by both roads."""
    case = generate(kind, seed)
    try:
        path = solve(case.problem, case.history, **case.options)
    except FastpinError as error:
        return Comparison(kind, seed, "not by path", str(error))
    if path.grid.size > MOST_NODES:
        return Comparison(kind, seed, "large")
    apart: list[float] = []
    where = 0
    for increments in INCREMENTS:
        try:
            steps = solve(case.problem, case.history, grid=path.grid, method="increment", increments=increments)
        except FastpinError as error:
            return Comparison(kind, seed, "not by increments", f"{type(error).__name__}: {error}", tuple(apart))
        all_apart = distances(path, steps)
        where = int(np.argmax(all_apart))
        apart.append(float(all_apart[where]))
    falls = apart[1] < FALLS * apart[0]
    verdict = "agree" if apart[1] < AGREE else "falling" if falls else "disagree"
    return Comparison(kind, seed, verdict, f"state {where}, {path.statistics['jumps']:.0f} snaps", tuple(apart))


def compare_in_time(kind: str, seed: int) -> Comparison:
    """As :func:`compare`, with the verdict "too long" after a long time."""
    return within_time(compare, kind, seed) or Comparison(kind, seed, "too long", f"{LONGEST} s")

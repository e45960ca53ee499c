"""The path solver against load increments, on histories that are hard.

``python -m scripts.two_roads [--count 60] [--first 0] [--classes extreme,narrow] [--processes 2]`` solves `count`
random cases of each class by path, then by increments on the same nodes. The difference of pressure and shear must fall
as the increments shrink. It is in parts of int N, the largest of all corners.
"""

from __future__ import annotations

import collections
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from scripts.histories import generate
from scripts.random_histories import LONGEST, options_for, run_jobs, within_time

CLASSES = ("extreme", "narrow", "rough", "moderate_stress", "fits")
"""Classes that are run unless others are given."""

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


def main() -> None:
    """Run the command line."""
    options = options_for(__doc__, 60, CLASSES).parse_args()
    tasks = [(k, s) for k in options.classes for s in range(options.first, options.first + options.count)]
    found: list[Comparison] = []
    for one in run_jobs(compare_in_time, tasks, options.processes):
        found.append(one)
        if one.verdict not in ("agree", "large"):
            numbers = " to ".join(f"{value:.2g}" for value in one.differences)
            tqdm.write(f"{one.kind} {one.seed}: {one.verdict} {numbers} ({one.message})")
    for kind in options.classes:
        some = [one for one in found if one.kind == kind]
        both = np.array([one.differences for one in some if len(one.differences) == len(INCREMENTS)]).reshape(-1, 2)
        medians = " to ".join(f"{value:.1e}" for value in np.median(both, axis=0)) if len(both) else "none"
        print(f"{kind:16}{dict(collections.Counter(one.verdict for one in some))}, median difference {medians}")


if __name__ == "__main__":
    main()

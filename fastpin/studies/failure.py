"""The load at which the first ply of a laminate fails round the hole: a load history is solved with several factors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from fastpin import damage, solver
from fastpin.errors import InputError
from fastpin.model.checks import choice
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOAD_KIND, Corner
from fastpin.model.ply import PlyCriterion
from fastpin.model.problem import Problem
from fastpin.model.strength import StrengthAssessment
from fastpin.solver.errors import ConvergenceError
from fastpin.states.state import State

CLOSE = 1e-6
"""Largest difference of the strength ratio from 1 at the load at failure."""

MOST_SOLVED = 40
"""Most histories that are solved to find it. Three or four are usual: stresses nearly grow with the load."""


@dataclass(frozen=True, eq=False)
class FailureLoad:
    """The load at which the first ply fails.

    Attributes
    ----------
    factor : float
        Factor on all loads of the history.
    state : State
        The state in which it fails, of the history times this factor.
    strength : JointStrength
        The strength there; its least ratio is 1.
    solved : int
        Number of histories that were solved.
    """

    factor: float
    state: State
    strength: damage.JointStrength
    solved: int


def failure_load(
    problem: Problem,
    history: LoadHistory | Sequence[Corner],
    criterion: PlyCriterion = "hashin",
    *,
    distance: float | None = None,
    tension: float | None = None,
    compression: float | None = None,
    over: Literal["end", "history"] = "end",
    **options: Any,
) -> FailureLoad:
    """The factor on a load history at which the first ply fails at a distance from the hole.

    With a clearance the stresses are not in proportion to the load. So histories are solved until the strength ratio is
    1. Damage before failure, which spreads the load, is not known to it.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        The loads that the factor multiplies. A change of friction is kept as it is.
    criterion, distance, tension, compression
        See :func:`joint_strength`.
    over : {"end", "history"}
        Where it fails: at the end of the history, or in any state that is kept.
    **options
        Options of :func:`fastpin.solve`, such as ``nodes``.

    Raises
    ------
    InputError
        See :func:`joint_strength`; also if the laminate carries no stress there.
    SolveError
        If a history can't be followed, or no factor is found.
    """
    loads = history if isinstance(history, LoadHistory) else LoadHistory(history)
    how = StrengthAssessment(criterion, distance, tension, compression)
    last = slice(-1 if choice("over", over, ("end", "history")) == "end" else 0, None)
    scaled = [name for name, kind in LOAD_KIND.items() if kind != "ratio"]  # all but the change of friction
    factor, known = 1.0, []
    for solved in range(1, MOST_SOLVED + 1):
        states = solver.solve(problem, loads.scaled(dict.fromkeys(scaled, factor)), **options)[last]
        state, strength = damage.least_strength(states, how)
        ratio = strength.least_ratio
        if not math.isfinite(ratio):
            raise InputError("history", "must stress the laminate: no factor makes a ply fail")
        if abs(ratio - 1.0) <= CLOSE:
            return FailureLoad(factor, state, strength, solved)
        known.append((math.log(factor), math.log(ratio)))
        factor = math.exp(_next_factor(known))
    raise ConvergenceError(f"no load at failure was found after {MOST_SOLVED} histories")


def _next_factor(known: list[tuple[float, float]]) -> float:
    """The logarithm of the next factor to try, from those of the known factors and their strength ratios.

    A ratio above 1 asks for a larger factor. The secant of the logarithms is taken where it stays between the nearest
    factors on both sides, and else the step for stresses in proportion to the load, or the middle.
    """
    low = max((x for x, y in known if y > 0.0), default=-math.inf)
    high = min((x for x, y in known if y < 0.0), default=math.inf)
    x, y = known[-1]
    found = x + y
    if len(known) > 1:
        before, value = known[-2]
        if y != value and low < (secant := x - y * (x - before) / (y - value)) < high:
            found = secant
    return found if low < found < high else 0.5 * (low + high)

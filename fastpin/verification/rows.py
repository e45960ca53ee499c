"""The record of a check of the installation, and the solver that the checks share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.state import State

NODES = 401
"""Number of nodes of all cases, except the cases on the nodes of finite elements."""


@dataclass(frozen=True)
class Check:
    """One check: a quantity of one case against its reference.

    Attributes
    ----------
    topic, case, quantity : str
        Names of the topic, the case and the compared quantity. The quantity is empty if the case ended in an error.
    reference, ours : float or None
        The two values, dimensionless (R = F = beta* = 1, angles in rad). None if whole functions are compared.
    difference, tolerance : float or None
        The difference and the largest one that passes, >= 0, in `unit`. None if the case ended in an error.
    unit : str
        "relative" (to the reference), or the unit of `difference`.
    message : str
        The error in which the case ended, else empty.
    """

    topic: str
    case: str
    quantity: str = ""
    reference: float | None = None
    ours: float | None = None
    difference: float | None = None
    tolerance: float | None = None
    unit: str = ""
    message: str = ""

    @property
    def passed(self) -> bool:
        """Whether the difference is a number within the tolerance."""
        return self.difference is not None and self.tolerance is not None and self.difference <= self.tolerance


class Solving:
    """The solver with a record of its states: their number, and the largest residuals without and with a seat."""

    def __init__(self) -> None:
        self.states = 0
        self.largest = self.largest_with_seat = 0.0

    def __call__(self, problem: Problem, history: Sequence[dict[str, float]], **options: Any) -> Result:
        result = solve(problem, history, **{"nodes": NODES, **options})
        self.note(result)
        return result

    def note(self, states: Sequence[State]) -> None:
        """Note the residuals of states."""
        self.states += len(states)
        for state in states:
            name = "largest" if state.seat is None else "largest_with_seat"
            setattr(self, name, float(np.max([getattr(self, name), *state.residuals.values()])))


Checks = Iterator[Check]
"""The checks of one case, without topic and tolerance. Their case is empty where it is the name of the topic's case."""


def difference_check(quantity: str, difference: float, unit: str, case: str = "") -> Check:
    """Return the check of a difference between whole functions, in `unit`."""
    return Check("", case, quantity, difference=difference, unit=unit)


def relative_check(quantity: str, ours: float, reference: float, case: str = "") -> Check:
    """Return the check of a value, relative to its reference."""
    return Check("", case, quantity, reference, ours, abs(ours / reference - 1.0), unit="relative")


def angle_check(quantity: str, ours: float, reference: float) -> Check:
    """Return the check of an angle, rad."""
    return Check("", "", quantity, reference, ours, abs(ours - reference), unit="rad")


def half_width(interval: tuple[float, float]) -> float:
    """Return half the width of an interval."""
    return 0.5 * (interval[1] - interval[0])

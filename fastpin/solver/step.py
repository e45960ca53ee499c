"""One step of a load history, from corner to corner, cut into straight pieces; and where a run stands inside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fastpin.model.loads import P, Q
from fastpin.solver.configuration import Configuration

Report = Callable[[float], None]
"""Called with the fraction of the step that is done."""


@dataclass(frozen=True)
class Piece:
    """A straight piece of a step, from fraction `begin` to fraction `end` of it.

    Attributes
    ----------
    begin, end : float
    before, after : ndarray, shape (loads,)
        Dimensionless loads at its ends.
    """

    begin: float
    end: float
    before: np.ndarray
    after: np.ndarray

    def load_at(self, fraction: float) -> np.ndarray:
        """The load at a fraction of the step."""
        if fraction == self.end:
            return self.after.copy()
        return self.before + (fraction - self.begin) / (self.end - self.begin) * (self.after - self.before)


def pieces(before: np.ndarray, after: np.ndarray) -> list[Piece]:
    """The pieces of a step. It is cut where the pin's force passes through zero: contact is lost there."""
    first, last = before[[P, Q]], after[[P, Q]]
    if first @ last < 0.0 and abs(first[0] * last[1] - first[1] * last[0]) <= 1e-12 * abs(first @ last):
        cut = float(np.linalg.norm(first) / (np.linalg.norm(first) + np.linalg.norm(last)))
        middle = before + cut * (after - before)
        middle[[P, Q]] = 0.0
        return [Piece(0.0, cut, before, middle), Piece(cut, 1.0, middle, after)]
    return [Piece(0.0, 1.0, before, after)]


def is_pushed(load: np.ndarray) -> bool:
    """Whether a force acts on the pin."""
    return bool(load[P] != 0.0 or load[Q] != 0.0)


def force_of(load: np.ndarray) -> float:
    """Size of the force on the pin."""
    return float(np.hypot(load[P], load[Q]))


@dataclass(eq=False)
class Position:
    """Where a run stands inside a step.

    Attributes
    ----------
    now : Configuration
    touched : ndarray of bool, shape (n,)
        Nodes that have ever been in contact.
    reached : float
        Fraction of the step.
    fresh : float
        Fraction of the way to the next stop at which the contact was just found; 0 otherwise.
    """

    now: Configuration
    touched: np.ndarray
    reached: float = 0.0
    fresh: float = 0.0


class Stepper(Protocol):
    """A solver: it brings a contact from one load to the next. Each solver is one file."""

    def begin_piece(self) -> None:
        """Get ready for another straight piece."""

    def advance(self, position: Position, piece: Piece, stop: float, report: Report) -> None:
        """Bring the contact along a piece, to the fraction `stop` of the step or to where the contact is lost.

        Raises
        ------
        SolveError
            If the load can't be followed; `position` is where it was lost.
        """

    def leave(self, position: Position) -> None:
        """Finish with the present piece: note the nodes it touched, and what it took."""

"""One step of a load history, from one corner to the next.

A step consists of one straight :class:`Piece` or two. A :class:`Position` says how far a run has followed the step. A
:class:`Stepper` is the interface of a solver: it moves the position along a piece.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.status import STICK
from fastpin.model.loads import FRICTION_CHANGE, REMOTE, ROTATION, THERMAL, UX, UY, M, P, Q
from fastpin.model.problem import Problem
from fastpin.reading.zones import runs
from fastpin.solver.configuration import ROUNDED, Configuration
from fastpin.solver.errors import OPENED, NoEquilibriumError, ResolutionError

StepReport = Callable[[float], None]
"""Called with the fraction of the step that is done."""


SCALING = [P, Q, M, *REMOTE, UX, UY, *THERMAL]
"""Loads with which the contact of a neat fit scales. A rotation or a change of friction presses nothing."""

LEAST_CLOSED = 3
"""Nodes of a contact at a corner, at least. With fewer the pressure is anything."""


@dataclass(frozen=True)
class Piece:
    """A straight piece of a step.

    Attributes
    ----------
    begin, end : float
        Fractions of the step at the ends of the piece.
    before, after : ndarray, shape (loads,)
        Dimensionless loads at the ends of the piece.
    """

    begin: float
    end: float
    before: np.ndarray
    after: np.ndarray

    def load_at(self, fraction: float) -> np.ndarray:
        """The dimensionless load at a fraction of the step. A fraction beside an end, up to rounding, is the end."""
        for end, load in ((self.end, self.after), (self.begin, self.before)):
            if abs(fraction - end) <= ROUNDED:
                return load.copy()
        return self.before + (fraction - self.begin) / (self.end - self.begin) * (self.after - self.before)


def pieces(before: np.ndarray, after: np.ndarray, nearly_neat: bool) -> list[Piece]:
    """The pieces of a step between two loads. It is cut where the pin's force passes through zero: contact is lost.

    Remote stress may hold the pin of a nearly neat fit (:attr:`System.is_nearly_neat`) there. Its contact scales with
    all loads, so the step is also cut where all of them pass through zero together, remote stress without a force too.
    """
    together = [P, Q, M]  # a moment that is left at no force by rounding would spin the pin
    for loads in (SCALING, together, [P, Q]) if nearly_neat else (together, [P, Q]):
        if sum([before.item(load) * after.item(load) for load in loads]) >= 0.0:  # most steps are not cut
            continue
        first, last = before[loads], after[loads]
        size = first @ last
        if size < 0.0 and np.abs(np.outer(first, last) - np.outer(last, first)).max() <= ROUNDED * abs(size):
            cut = float(np.linalg.norm(first) / (np.linalg.norm(first) + np.linalg.norm(last)))
            middle = before + cut * (after - before)
            middle[loads] = 0.0
            return [Piece(0.0, cut, before, middle), Piece(cut, 1.0, middle, after)]
    return [Piece(0.0, 1.0, before, after)]


def presses(load: np.ndarray) -> bool:
    """Whether anything presses or moves the pin against the hole under a load, beside a rotation."""
    return bool(np.delete(load, [ROTATION, FRICTION_CHANGE]).any())


def is_pushed(load: np.ndarray) -> bool:
    """Whether a force acts on the pin."""
    return bool(load[P] != 0.0 or load[Q] != 0.0)


def force_of(load: np.ndarray) -> float:
    """Size of the force on the pin, in the units of `load`."""
    return float(np.hypot(load[P], load[Q]))


def force_on_pin(system: System, configuration: Configuration) -> float:
    """Size of the force on the pin, reactions included (dimensionless)."""
    return float(np.hypot(*system.drive.force(configuration.motion, configuration.load)))


def pushes(problem: Problem, values: np.ndarray) -> np.ndarray:
    """The force on the pin along x and y at every corner, N/m, shape (corners, 2); an estimate where it is a reaction.

    `values` are the loads at the corners, SI, shape (corners, loads). The estimate has the direction in which a rigid
    pin touches a round hole with the least clearance. Its size is the force, or else the overlap of pin and hole over
    beta*.
    """
    forces = np.column_stack([values[:, Q], -values[:, P]])
    if problem.drive == "force":
        return forces
    axes = np.array(problem.driven)
    given = np.where(axes, values[:, [UX, UY]], 0.0)
    reach = np.hypot(given[:, 0], given[:, 1])
    play = problem.clearances[0]
    overlap = np.maximum(reach - max(play, 0.0), 0.0) / problem.surfaces.beta_star
    way = np.divide(given, reach[:, None], out=np.zeros_like(given), where=reach[:, None] > 0.0)
    if axes.all():
        return overlap[:, None] * way
    # The force pushes the pin along the hole's wall: at a part of the clearance the normal of the wall has turned.
    size = np.abs(forces).max(axis=1)
    part = np.minimum(reach, play) / play if play > 0.0 else np.zeros(len(values))
    turned = np.sign(forces) * np.sqrt(1.0 - part**2)[:, None] + way * part[:, None]
    return np.where(size[:, None] > 0.0, size[:, None] * turned, overlap[:, None] * way)


@dataclass(eq=False)
class Position:
    """The position of a run inside a step, which a stepper moves. Steppers also work without a run, as on a window.

    Attributes
    ----------
    now : Configuration
        The present configuration.
    touched : ndarray of bool, shape (n,)
        Whether each node was ever in contact.
    reached : float
        Fraction of the step that was followed.
    fresh : float
        Just after a first contact, the fraction of the way to the next stop at which it was found; otherwise 0.
    """

    now: Configuration
    touched: np.ndarray
    reached: float = 0.0
    fresh: float = 0.0


class Stepper(Protocol):
    """The interface of a solver: it brings a contact from one load to the next. Each solver has its own file."""

    def begin_piece(self) -> None:
        """Prepare for the next straight piece."""

    def advance(self, position: Position, piece: Piece, stop: float, report: StepReport) -> None:
        """Follow a piece up to the fraction `stop` of the step, or until the contact is lost; change `position`.

        Raises
        ------
        SolveError
            If the load can't be followed. `position` is then the position at which it was lost.
        """

    def leave(self, position: Position) -> None:
        """End the present piece: note the nodes that it touched, and update the statistics."""


def check_resolution(system: System, now: Configuration) -> None:
    """Check that the contact at a corner has enough nodes. A contact that carries next to nothing is left alone."""
    pin = system.interfaces[0]
    closed = now.closed[pin.nodes]
    if (closed[:-2] & closed[1:-1] & closed[2:]).any() or force_on_pin(system, now) <= 1e-6:
        return
    most = max((patch.size for patch in runs(pin.grid, closed)), default=LEAST_CLOSED)
    if most < LEAST_CLOSED:
        raise ResolutionError(f"the contact is narrower than the nodes can resolve: it has {most}; use more nodes")


def check_turning(system: System, load: np.ndarray) -> None:
    """Raise :class:`NoEquilibriumError` if a moment acts on a pin, or on the bush round it, that nothing holds."""
    if system.problem.rotation != "free" or load[M] == 0.0:
        return
    if system.problem.frictionless:
        raise NoEquilibriumError("without friction nothing holds the pin against a moment: it spins")
    if any(each.problem.frictionless for each in system.interfaces):
        words = "without friction in its seat nothing holds the bush against a moment: it spins with the pin"
        raise NoEquilibriumError(words)


def check_bond(system: System, now: Configuration) -> None:
    """Raise :class:`NoEquilibriumError` if a bonded bush slips or opens in its seat."""
    if (now.status[system.bonded] != STICK).any():
        raise NoEquilibriumError(OPENED)

"""The path solver as a run calls it: a path for each straight piece of a step.

Where a path is lost, a contact that has just opened is released, and a pin that snaps is taken over the snap.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import exchange
from fastpin.model.loads import FRICTION_CHANGE, LOADS, M
from fastpin.solver.configuration import Configuration
from fastpin.solver.driven import can_float
from fastpin.solver.errors import (
    CUT_OFF,
    OPENED,
    UNHELD,
    ArcError,
    ConvergenceError,
    NoEquilibriumError,
    ResolutionError,
    SolveError,
)
from fastpin.solver.path import PathStep, StepLostError, WholeStep, follow_whole
from fastpin.solver.rest import release
from fastpin.solver.snap import find_state_beyond
from fastpin.solver.step import Piece, Position, StepReport, force_of, force_on_pin
from fastpin.solver.tableau import TableauMemory

FEW_CLOSED = 8
"""A contact of at most this many nodes, lost during a complete unloading, has just opened."""


class Path(Protocol):
    """A straight change of the load that is followed: a :class:`PathStep`, or a :class:`fastpin.drift.DriftPath`."""

    now: Configuration
    rebuilds: int
    resettled: int

    @property
    def touched(self) -> np.ndarray: ...
    @property
    def events(self) -> int: ...
    @property
    def exchanges(self) -> int: ...

    def follow(self, stop: float, report: Callable[[float], None] | None = None) -> Configuration:
        """Follow the path up to the fraction `stop` and return the configuration there."""


class PathStepper:
    """The path solver as a stepper: it follows a step from event to event, exactly.

    Parameters
    ----------
    system : System
    statistics : dict of str to float
        Statistics of the run. The stepper counts "events", "exchanges", "rebuilds", "resettled", "jumps" and
        "released" in it.
    strict : bool
        Whether a narrow contact that carries next to nothing is an error. If not, it is let go.
    """

    def __init__(self, system: System, statistics: dict[str, float], strict: bool = False) -> None:
        self._system = system
        self._statistics = statistics
        self._strict = strict
        self._memory = TableauMemory(system)
        self._step: Path | None = None
        self._systems: dict[tuple[float, bytes], System] = {}
        self._begin = 0.0  # fraction of the history's step at which `_step` starts
        self._releases = self._jumps = 0

    def begin_piece(self) -> None:
        """Prepare for the next straight piece."""
        self._releases = self._jumps = 0

    def advance(self, position: Position, piece: Piece, stop: float, report: StepReport) -> None:
        """Follow a piece exactly, up to the fraction `stop` of the step or until the contact is lost.

        A contact that has become too small for the grid, or carries nothing, is released without an error.

        Raises
        ------
        NoEquilibriumError
            If nothing holds the pin any more.
        ConvergenceError
            If the statuses do not settle.
        ResolutionError
            If the contact shrinks to a few nodes and is lost between them.
        ArcError
            If the contact reaches an end of the arc.
        """
        try:
            if self._step is None:
                now, after = position.now, piece.after
                system, later = self._under(now.load), self._under(after)
                is_steady = system is later or np.array_equal(system.friction, later.friction)
                if is_steady and stop == piece.end:
                    whole = follow_whole(system, now, after, self._memory)
                    if whole is not None:
                        position.now = whole.now
                        self._count(position, whole)
                        return
                self._begin = position.reached
                if is_steady:
                    self._step = PathStep(system, now, after, self._memory)
                else:
                    from fastpin.drift import DriftPath

                    self._step = DriftPath(system, now, after, later.friction)
            begin, length = self._begin, piece.end - self._begin
            part = 1.0 if stop == piece.end else (stop - begin) / length
            position.now = self._step.follow(part, lambda done: report(begin + done * length))
            position.now.load = piece.load_at(stop)
        except StepLostError as lost:
            if self._step is not None:
                position.reached = self._begin + lost.fraction * (piece.end - self._begin)
                position.now = self._step.now
            if self._has_just_opened(position.now, piece, lost):
                self.leave(position)
                position.now = release(self._system, position.now, position.now.load)
            elif lost.code != exchange.CYCLING or not self._jump(position, piece, stop):
                raise _solve_error(
                    lost.code, position.now.closed[self._system.interfaces[0].nodes], self._system.problem.held
                ) from None

    def leave(self, position: Position) -> None:
        """End the present path: note the nodes that it touched, count its events, and forget it."""
        if self._step is None:
            return
        self._count(position, self._step)
        self._statistics["rebuilds"] += self._step.rebuilds
        self._statistics["resettled"] += self._step.resettled
        self._step = None

    def _count(self, position: Position, followed: WholeStep | Path) -> None:
        """Note the nodes and the events of a step that was followed."""
        position.touched |= followed.touched
        self._statistics["events"] += followed.events
        self._statistics["exchanges"] += followed.exchanges

    def _under(self, load: np.ndarray) -> System:
        """The system with the friction under a load (loads,), kept for the next question."""
        key = load[FRICTION_CHANGE].item(), load[len(LOADS) :].tobytes()  # the last ones are a DriftingSystem's
        if key not in self._systems:
            if len(self._systems) == 8:  # a history returns to the same few
                self._systems.clear()
            self._systems[key] = self._system.under(load)
        return self._systems[key]

    def _jump(self, position: Position, piece: Piece, stop: float) -> bool:
        """Take the pin over a snap to a state at a finite distance. Returns whether one was found."""
        # The parts grow from snap to snap, so that a pin that snaps all the way comes to the end.
        jump = 1e-6 * 1.3**self._jumps * (piece.end - piece.begin)
        ends = [min(position.reached + min(factor * jump, 2e-2), stop) for factor in (1.0, 1e2, 1e4)]
        for reached in dict.fromkeys(ends):
            load = piece.load_at(reached)
            found = find_state_beyond(self._system.under(load), position.now, load)
            if found is not None:
                self.leave(position)
                position.now, position.reached = found, reached
                position.touched |= found.closed
                self._jumps += 1
                self._statistics["jumps"] += 1
                return True
        return False

    def _has_just_opened(self, now: Configuration, piece: Piece, lost: StepLostError) -> bool:
        """Whether a lost contact had only become too small for the grid, or carried nothing."""
        if lost.code in (exchange.ARC_END, exchange.UNBONDED):
            return False
        unloading = can_float(self._system, piece.after)
        if unloading and lost.fraction > 1.0 - 1e-8:  # all falls to zero together: the order of events is rounding
            return True
        if (
            now.load[M] != 0.0
            or int(now.closed[self._system.interfaces[0].nodes].sum()) > FEW_CLOSED
            or self._releases == 20
        ):
            return False
        self._releases += 1
        driven = self._system.drive.has_displacements  # then a contact is lost as well where the pin is moved away
        if unloading or (self._strict and not driven):
            return unloading
        largest = max(force_of(piece.before), force_of(piece.after), 1.0 if driven else 0.0)
        small = force_on_pin(self._system, now) <= 1e-3 * largest  # a first contact follows
        self._statistics["released"] += small and not driven
        return small


def _solve_error(code: int, closed_nodes: np.ndarray, held: bool) -> SolveError:
    """The error of a lost path. `closed_nodes` (n,) are those of the pin. `held`: the pin can't rotate freely."""
    closed = int(closed_nodes.sum())
    if code == exchange.ARC_END:
        return ArcError(CUT_OFF)
    if code == exchange.UNBONDED:
        return NoEquilibriumError(OPENED)
    if closed < FEW_CLOSED // 2 or (held and closed <= FEW_CLOSED):
        return ResolutionError(f"the contact has shrunk to {closed} nodes and is lost between them; use more nodes")
    if code == exchange.NO_SUPPORT:
        return NoEquilibriumError(UNHELD)
    if code == exchange.CYCLING:
        return NoEquilibriumError("no equilibrium is near: the pin snaps to a distant state, which was not found")
    return ConvergenceError("the stick and slip zones did not settle")

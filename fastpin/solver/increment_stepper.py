"""The increment solver as a run calls it: it follows a step in implicit load increments."""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.solver.configuration import Configuration, work_between
from fastpin.solver.driven import can_float
from fastpin.solver.errors import ConvergenceError
from fastpin.solver.increment import accepted, implicit_step
from fastpin.solver.rest import release
from fastpin.solver.step import Piece, Position, StepReport


class IncrementStepper:
    """The increment solver as a stepper: it follows a step in implicit increments, first order in their size.

    Parameters
    ----------
    system : System
    increments : int
        Increments a step. They have equal size, or grow linearly after the first contact.
    statistics : dict of str to float
        Statistics of the run. The stepper counts "increments" in it.
    """

    def __init__(self, system: System, increments: int, statistics: dict[str, float]) -> None:
        self._system = system
        self._increments = increments
        self._statistics = statistics

    def begin_piece(self) -> None:
        """Do nothing: a piece needs nothing from the piece before."""

    def leave(self, position: Position) -> None:
        """Do nothing: the position already holds everything."""

    def advance(self, position: Position, piece: Piece, stop: float, report: StepReport) -> None:
        """Go to the fraction `stop` of the step in implicit increments.

        Raises
        ------
        ConvergenceError
            If no state that meets the contact conditions was found in an increment halved 12 times.
        ArcError
            If the contact reaches an end of the arc.
        """
        load, before, begin = piece.load_at(stop), position.now.load, position.reached
        for part in self._parts(position, stop):
            target = load if part == 1.0 else before + part * (load - before)
            self._increment(position, position.now, target, halvings=12)
            if self._may_touch_again(position):
                done = np.linalg.norm(position.now.load - before) / np.linalg.norm(load - before)
                position.reached = begin + float(done) * (stop - begin)
                return
            position.reached = begin + float(part) * (stop - begin)
            report(position.reached)

    def _may_touch_again(self, position: Position) -> bool:
        """Whether the pin floats, and a prescribed displacement may bring it into contact before the next stop."""
        return self._system.drive.has_displacements and not position.now.closed.any()

    def _parts(self, position: Position, stop: float) -> np.ndarray:
        """Ends of the increments on the way to the fraction `stop` of the step, in parts of this way."""
        if position.fresh > 0.0:  # increments grow linearly from the first contact
            ends = np.arange(1, self._increments + 1) * np.arange(2, self._increments + 2)
            ends = ends / ends[-1]
            parts = (ends[ends > position.fresh] - position.fresh) / (1.0 - position.fresh)
            position.fresh = 0.0
            return parts
        count = max(1, round(self._increments * (stop - position.reached)))
        return np.arange(1, count + 1) / count

    def _increment(self, position: Position, start: Configuration, load: np.ndarray, halvings: int) -> None:
        """Make one implicit increment from `start` to `load`, or two halves if its iteration cycles.

        A complete unloading that has no solution releases the pin.
        """
        system = self._system.under(load)
        found = accepted(system, start, implicit_step(system, start, load))
        if found is None:
            if can_float(system, load):  # unloaded completely
                position.now = release(system, start, load)
                return
            if halvings == 0:
                raise ConvergenceError(
                    "no state that meets the contact conditions was found; either none carries a larger load, or the "
                    "increments are too large"
                )
            self._increment(position, start, 0.5 * (start.load + load), halvings - 1)
            if not self._may_touch_again(position):
                self._increment(position, position.now, load, halvings - 1)
            return
        found.work = start.work + work_between(system, start, found)
        position.now = found
        position.touched |= found.closed
        self._statistics["increments"] += 1

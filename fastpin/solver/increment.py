"""The increment solver: implicit load increments, the way of the paper.

Each increment is a fixed-point iteration for the statuses of all nodes together. A node is closed where N > 0 is
needed to keep h >= 0. A closed node sticks where |T| <= mu N keeps its slip at the value before the increment (48).
Elsewhere it slips with the sign of its slip increment (49). Each iteration is one dense solve. An iteration that
returns to earlier statuses is cycling. It is tried again from sticking, then with one change of status at a time; then
the stepper halves the increment.

:func:`implicit_step` makes one increment. :class:`IncrementStepper` follows a step of the history in increments.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    Configuration,
    Solution,
    accept_solution,
    dissipation_between,
    reaches_end,
    resting_status,
    slip_tally_between,
    solve_statuses,
    work_between,
    worst_residual,
)
from fastpin.solver.driven import can_float
from fastpin.solver.errors import CUT_OFF, ArcError, ConvergenceError
from fastpin.solver.rest import release
from fastpin.solver.step import Piece, Position, StepReport

MOST_ITERATIONS = 200
"""Iterations of one increment, at most."""

FEW_ITERATIONS = 12
"""Iterations of an increment that is not patient, at most."""

TOLERANCE = 1e-11
"""Part of the largest pressure or displacement below which an overstepped limit changes no status."""

MOST_HALVINGS = 12
"""Times that an increment is halved, at most, while its iteration cycles."""


def implicit_step(system: System, start: Configuration, load: np.ndarray, patient: bool = True) -> Configuration | None:
    """Go from the configuration `start` to `load` in one implicit increment.

    Parameters
    ----------
    system : System
    start : Configuration
        Its slip is the slip before the increment, at all nodes, open nodes too. It is not changed.
    load : ndarray, shape (loads,)
        Dimensionless load at the end of the increment.
    patient : bool
        Whether the iteration goes on for long, and is tried again with one change of status at a time.

    Returns
    -------
    Configuration or None
        The configuration at `load`, with the work and dissipation of `start`. None if the iteration cycles, meets a
        mechanism or does not end.
    """
    attempts = [start.status, np.where(start.closed, resting_status(system), OPEN).astype(np.int8)]
    for one_at_a_time in (False, True) if patient else (False,):
        for first in attempts:
            found = _iterate(system, start, load, first, one_at_a_time, MOST_ITERATIONS if patient else FEW_ITERATIONS)
            if found is not None:
                return found
    return None


def _iterate(
    system: System, start: Configuration, load: np.ndarray, first: np.ndarray, one_at_a_time: bool, iterations: int
) -> Configuration | None:
    status = first.astype(np.int8).copy()
    if not np.any(status != OPEN):
        return None
    seen: set[bytes] = set()
    for _ in range(iterations):
        key = status.tobytes()
        if key in seen:
            return None
        seen.add(key)
        solution = solve_statuses(system, status, start.slip, load, start.rest_gap)
        if solution is None:
            return None
        wanted = _wanted_status(system, start, solution, status)
        changes = np.flatnonzero(wanted != status)
        if changes.size == 0:
            return accept_solution(start, solution, status, load)
        if one_at_a_time:
            status[changes[0]] = wanted[changes[0]]
        else:
            status = wanted
    return None


def _wanted_status(system: System, start: Configuration, solution: Solution, status: np.ndarray) -> np.ndarray:
    """The statuses for the next iteration: the present statuses, changed where the solution breaks a condition."""
    traction_tol = TOLERANCE * max(float(np.abs(solution.pressure).max()), 1e-300)
    slid = solution.slip - start.slip
    length_tol = TOLERANCE * max(float(np.abs(solution.gap - start.rest_gap).max()), float(np.abs(slid).max()), 1e-300)
    wanted = status.copy()
    closing = (status == OPEN) & (solution.gap < -length_tol)
    wanted[closing] = np.where(slid[closing] < 0.0, -1, 1)
    closed = status != OPEN
    slipping = closed & (status != STICK) & (system.friction > 0.0)
    wanted[slipping & (status * slid < -length_tol)] = STICK
    letting_go = (status == STICK) & (np.abs(solution.shear) > system.friction * solution.pressure + traction_tol)
    wanted[letting_go] = np.where(solution.shear[letting_go] > 0.0, -1, 1)
    wanted[closed & (solution.pressure < -traction_tol)] = OPEN
    if system.has_friction and system.problem.rotation == "free" and not np.any(wanted == STICK):
        _hold_one(wanted, status, solution, system.friction, slid)
    return wanted


def _hold_one(
    wanted: np.ndarray, status: np.ndarray, solution: Solution, friction: np.ndarray, slid: np.ndarray
) -> None:
    """Let one closed node stick in `wanted`. All closed nodes slip there, and nothing else would hold the pin.

    If several nodes let go, the node nearest to sticking holds. If the last sticking node lets go, the pin turns until
    the first of the nodes that slip the other way sticks.
    """
    rough = (wanted != OPEN) & (friction > 0.0)
    letting_go = np.flatnonzero(rough & (status == STICK))
    if letting_go.size > 1:
        excess = np.abs(solution.shear) - friction * solution.pressure
        wanted[letting_go[np.argmin(excess[letting_go])]] = STICK
        return
    others = np.flatnonzero(rough & (status != STICK))
    if letting_go.size == 1:
        others = others[wanted[others] == np.sign(solution.shear[letting_go[0]])]
    if others.size:
        wanted[others[np.argmin(np.abs(slid[others]))]] = STICK


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
            If no state that meets the contact conditions was found in an increment halved :data:`MOST_HALVINGS` times.
        ArcError
            If the contact reaches an end of the arc.
        """
        load, before, begin = piece.load_at(stop), position.now.load, position.reached
        for part in self._parts(position, stop):
            target = load if part == 1.0 else before + part * (load - before)
            self._increment(position, position.now, target, MOST_HALVINGS)
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
        found = implicit_step(system, start, load)
        if found is None or worst_residual(system, found) > MAX_RESIDUAL:
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
        if reaches_end(system, found):
            raise ArcError(CUT_OFF)
        found.work = start.work + work_between(system, start, found)
        found.dissipation = start.dissipation + dissipation_between(system, start, found)
        found.slip_tally = slip_tally_between(start, found)
        position.now = found
        position.touched |= found.closed
        self._statistics["increments"] += 1

"""The increment solver: the paper's way. Implicit load increments, each a fixed-point iteration for the slip zones.

Within an increment all statuses are found together: a node is closed where N > 0 is needed to keep h >= 0, it sticks
where |T| <= mu N keeps its slip at the value before the increment (48), and slips with the sign of its slip increment
(49) elsewhere. Each iteration is one dense solve. An iteration that comes back to statuses it has seen is cycling;
the caller then halves the increment.
"""

from __future__ import annotations

import numpy as np

from fastpin.collocation import Configuration, Solution, System
from fastpin.state import OPEN, STICK

MOST_ITERATIONS = 200
TOLERANCE = 1e-11


def implicit_step(system: System, start: Configuration, load: np.ndarray) -> Configuration | None:
    """The configuration at `load` reached from `start` in one implicit increment.

    Parameters
    ----------
    start : Configuration
        Its slip is the slip before the increment, at every node, open ones too.
    load : ndarray, shape (6,)
        Dimensionless load at the end of the increment.

    Returns
    -------
    Configuration or None
        None if the iteration cycles, meets a mechanism or does not end. Work and dissipation are left as they were.
    """
    attempts = [start.status, np.where(start.closed, system.resting_status, OPEN).astype(np.int8)]
    for one_at_a_time in (False, True):
        for first in attempts:
            found = _iterate(system, start, load, first, one_at_a_time)
            if found is not None:
                return found
    return None


def _iterate(
    system: System, start: Configuration, load: np.ndarray, first: np.ndarray, one_at_a_time: bool
) -> Configuration | None:
    status = first.astype(np.int8).copy()
    if not np.any(status != OPEN):
        return None
    seen: set[bytes] = set()
    for _ in range(MOST_ITERATIONS):
        key = status.tobytes()
        if key in seen:
            return None
        seen.add(key)
        solution = system.solve(status, start.slip, load, start.rest_gap)
        if solution is None:
            return None
        wanted = _wanted_status(system, start, solution, status)
        changes = np.flatnonzero(wanted != status)
        if changes.size == 0:
            return _accepted(start, solution, status, load)
        if one_at_a_time:
            status[changes[0]] = wanted[changes[0]]
        else:
            status = wanted
    return None


def _wanted_status(system: System, start: Configuration, solution: Solution, status: np.ndarray) -> np.ndarray:
    """Statuses that the solution of the present ones asks for."""
    traction_tol = TOLERANCE * max(float(np.abs(solution.pressure).max()), 1e-300)
    slid = solution.slip - start.slip
    length_tol = TOLERANCE * max(float(np.abs(solution.gap - start.rest_gap).max()), float(np.abs(slid).max()), 1e-300)
    wanted = status.copy()
    closing = (status == OPEN) & (solution.gap < -length_tol)
    wanted[closing] = np.where(slid[closing] < 0.0, -1, 1)
    closed = status != OPEN
    if system.friction > 0.0:
        slipping = closed & (status != STICK)
        wanted[slipping & (status * slid < -length_tol)] = STICK
        letting_go = (status == STICK) & (np.abs(solution.shear) > system.friction * solution.pressure + traction_tol)
        wanted[letting_go] = np.where(solution.shear[letting_go] > 0.0, -1, 1)
    wanted[closed & (solution.pressure < -traction_tol)] = OPEN
    if system.friction > 0.0 and system.problem.rotation == "free" and not np.any(wanted == STICK):
        _hold_one(wanted, status, solution, system.friction, slid)
    return wanted


def _hold_one(wanted: np.ndarray, status: np.ndarray, solution: Solution, friction: float, slid: np.ndarray) -> None:
    """Let one of the closed nodes stick in `wanted`, where all of them slip and nothing would hold the pin.

    Of several nodes that let go it is the one nearest to sticking; if the last one lets go, the pin turns until the
    first of those stick that slip the other way.
    """
    letting_go = np.flatnonzero((status == STICK) & (wanted != OPEN))
    if letting_go.size > 1:
        excess = np.abs(solution.shear) - friction * solution.pressure
        wanted[letting_go[np.argmin(excess[letting_go])]] = STICK
        return
    others = np.flatnonzero((wanted != OPEN) & (status != STICK))
    if letting_go.size == 1:
        others = others[wanted[others] == np.sign(solution.shear[letting_go[0]])]
    if others.size:
        wanted[others[np.argmin(np.abs(slid[others]))]] = STICK


def _accepted(start: Configuration, solution: Solution, status: np.ndarray, load: np.ndarray) -> Configuration:
    new = start.copy()
    closed = status != OPEN
    new.status = status
    new.pressure = np.where(closed, np.maximum(solution.pressure, 0.0), 0.0)
    new.shear = np.where(closed, solution.shear, 0.0)
    new.gap = np.where(closed, 0.0, np.maximum(solution.gap, 0.0))
    new.slip = np.where(status == STICK, start.slip, solution.slip)
    new.motion = solution.motion
    new.load = load.copy()
    return new

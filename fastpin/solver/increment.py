"""The increment solver: implicit load increments, the way of the paper.

Each increment is a fixed-point iteration for the statuses of all nodes together. A node is closed where N > 0 is
needed to keep h >= 0. A closed node sticks where |T| <= mu N keeps its slip at the value before the increment (48).
Elsewhere it slips with the sign of its slip increment (49). Each iteration is one dense solve. An iteration that
returns to earlier statuses is cycling. It is tried again from sticking, then with one change of status at a time; then
the stepper halves the increment.

:func:`implicit_step` makes one increment. :mod:`fastpin.solver.increment_stepper` follows a step in increments.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import conditions
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    Configuration,
    accept_solution,
    add_dissipation,
    reaches_end,
    resting_status,
    slip_tally_between,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.errors import CUT_OFF, ArcError


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
            found = _iterate(system, start, load, first, one_at_a_time, 200 if patient else 12)
            if found is not None:
                return found
    return None


def accepted(system: System, start: Configuration, after: Configuration | None) -> Configuration | None:
    """A configuration with the dissipation and the slip since `start`; None if it violates the contact conditions."""
    if after is None or not worst_residual(system, after) <= MAX_RESIDUAL:
        return None
    if reaches_end(system, after):
        raise ArcError(CUT_OFF)
    add_dissipation(system, start, after)
    after.slip_tally = slip_tally_between(start, after)
    return after


def _iterate(
    system: System, start: Configuration, load: np.ndarray, first: np.ndarray, one_at_a_time: bool, iterations: int
) -> Configuration | None:
    """Change the statuses, from the `first` ones on, where the solution breaks a condition, until nothing changes."""
    status = first.astype(np.int8)
    if not (status != OPEN).any():
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
        wanted, tolerance = np.empty_like(status), 1e-11  # parts of the largest pressure or displacement
        conditions.wanted_status(system.friction, solution, start.slip, start.rest_gap, tolerance, wanted)
        for nodes in system.turning:
            if not (wanted[nodes] == STICK).any():
                slid = solution.slip[nodes] - start.slip[nodes]
                part = solution._replace(
                    pressure=solution.pressure[nodes], shear=solution.shear[nodes], status=solution.status[nodes]
                )
                _hold_one(wanted[nodes], part, system.friction[nodes], slid)
        changes = wanted != status
        if not changes.any():
            return accept_solution(start, solution, load)
        if one_at_a_time:
            first_change = changes.argmax()
            status[first_change] = wanted[first_change]
        else:
            status = wanted
    return None


def _hold_one(wanted: np.ndarray, solution: ContactValues, friction: np.ndarray, slid: np.ndarray) -> None:
    """Let one closed node stick in `wanted`. All closed nodes slip there, and nothing else would hold the pin.

    If several nodes let go, the node nearest to sticking holds. If the last sticking node lets go, the pin turns until
    the first of the nodes that slip the other way sticks.
    """
    rough = (wanted != OPEN) & (friction > 0.0)
    letting_go = np.flatnonzero(rough & (solution.status == STICK))
    if letting_go.size > 1:
        excess = np.abs(solution.shear) - friction * solution.pressure
        wanted[letting_go[np.argmin(excess[letting_go])]] = STICK
        return
    others = np.flatnonzero(rough & (solution.status != STICK))
    if letting_go.size == 1:
        others = others[wanted[others] == np.sign(solution.shear[letting_go[0]])]
    if others.size:
        wanted[others[np.argmin(np.abs(slid[others]))]] = STICK

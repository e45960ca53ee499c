"""A pin that snaps: no state is near, and at constant load the pin moves to a state at a finite distance.

The pin creeps there, as if a damper held it. Each step of the creep is a finite step of a pin on springs. The springs
are slack where the pin was before this step, so their force is the force of the damper. They become softer from step to
step, and stiffer where a step has no solution. The pin has arrived as soon as the contact carries the load without
springs. Slip and dissipation follow the way of the pin.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.elasticity.system import System
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    SLIGHT,
    Configuration,
    add_dissipation,
    reaches_end,
    slip_tally_between,
    work_between,
    worst_residual,
)
from fastpin.solver.errors import CUT_OFF, UNHELD, ArcError, NoEquilibriumError
from fastpin.solver.increment import implicit_step
from fastpin.solver.settling import FiniteStep

MOST_STEPS = 100
"""Steps of a creep, at most."""

SOFTER, STIFFER = 0.6, 3.0
"""Factors of the stiffness of the springs after a step, and after a step that had no solution."""

STIFFEST = 1e4
"""Largest stiffness of the springs, in parts of the first one."""


def find_state_beyond(system: System, now: Configuration, load: np.ndarray) -> Configuration | None:
    """Find the state at `load` to which the pin snaps from the configuration `now`.

    Parameters
    ----------
    system : System
    now : Configuration
        The last configuration before the snap. It is not changed.
    load : ndarray, shape (loads,)
        Dimensionless load, a little beyond the load of `now`.

    Returns
    -------
    Configuration or None
        The configuration at `load`. None if the pin came to rest nowhere.

    Raises
    ------
    ArcError
        If the contact reaches an end of the arc.
    NoEquilibriumError
        If the pin spins.
    """
    free = ~system.motion_rows.any(axis=1)  # directions in which nothing holds the pin
    first = stiffness = float(system.weights.mean() / np.median(np.abs(system.operator.diagonal())))
    last, beyond, steps = now, _step(system, now, load), 0
    while beyond is None:
        if not free.any() or steps == MOST_STEPS or stiffness > STIFFEST * first:
            return None
        steps += 1
        crept = _step_on_springs(system, last, load, np.where(free, stiffness, 0.0))
        if crept is None:
            stiffness *= STIFFER
            continue
        if _spins(system, last, crept):
            raise NoEquilibriumError(UNHELD)
        last, stiffness = crept, stiffness * SOFTER
        beyond = _step(system, last, load)
        if beyond is None and worst_residual(system, last) <= MAX_RESIDUAL:
            beyond = last
    beyond.work = now.work + work_between(system, now, beyond)
    return beyond


def _spins(system: System, before: Configuration, after: Configuration) -> bool:
    """Whether the pin, or a bush, does nothing but turn from one configuration to the other.

    All its closed nodes then slip one way.
    """
    if not np.array_equal(before.status, after.status):
        return False
    for rim in system.interfaces:
        x, y, turned = np.abs(after.motion - before.motion)[rim.motion : rim.motion + 3]
        closed = before.closed[rim.nodes]
        one_way = np.abs(before.status[rim.nodes][closed].sum()) == np.count_nonzero(closed)
        if one_way and max(x, y) <= SLIGHT * turned:
            return True
    return False


def _step(system: System, start: Configuration, load: np.ndarray) -> Configuration | None:
    """A finite step to `load`, with its dissipation: an increment, or by Lemke's method where that fails."""
    for by_lemke in (False, True):
        after = FiniteStep(system, start).to(load) if by_lemke else implicit_step(system, start, load, patient=False)
        if after is not None and worst_residual(system, after) <= MAX_RESIDUAL:
            if reaches_end(system, after):
                raise ArcError(CUT_OFF)
            add_dissipation(system, start, after)
            after.slip_tally = slip_tally_between(start, after)
            return after
    return None


def _step_on_springs(
    system: System, start: Configuration, load: np.ndarray, stiffness: np.ndarray
) -> Configuration | None:
    """A finite step of the pin on springs of a `stiffness` (3,), which are slack at `start`.

    The motion in the directions of the springs counts from `start` during the step.
    """
    n = system.grid.size
    before = np.where(stiffness > 0.0, start.motion, 0.0)
    moved = system.motion @ before
    shifted = start.changed(
        motion=start.motion - before,
        rest_gap=start.rest_gap + moved[:n],
        slip=start.slip - moved[n:],
        rest_slip=start.rest_slip - moved[n:],
    )
    held = replace(system, motion_rows=system.motion_rows + np.diag(stiffness))
    after = _step(held, shifted, load)
    if after is None:
        return None
    after = after.changed(rest_gap=start.rest_gap, rest_slip=start.rest_slip)
    return after.changed(motion=after.motion + before, slip=after.slip + moved[n:])

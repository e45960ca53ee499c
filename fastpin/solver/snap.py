"""A pin that snaps: no state is near, and at constant load the pin moves to a state at a finite distance.

The pin creeps there, as if a damper held it. Each step of the creep is a finite step of a pin on springs. The springs
are slack where the pin was before this step, so their force is the force of the damper. They become softer from step to
step, and stiffer where a step has no solution. The pin has arrived as soon as the contact carries the load without
springs. Slip and dissipation follow the way of the pin.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fastpin.elasticity.system import System
from fastpin.solver.configuration import MAX_RESIDUAL, SLIGHT, Configuration, work_between, worst_residual
from fastpin.solver.errors import UNHELD, NoEquilibriumError
from fastpin.solver.increment import accepted, implicit_step
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
    beyond = finite_step(system, now, load)
    if beyond is None and not system.motion_rows.any(axis=1).all():
        beyond = creep(system, now, load, _on_springs)
    if beyond is not None:
        beyond.work = now.work + work_between(system, now, beyond)
    return beyond


def creep(
    system: System, start: Configuration, load: np.ndarray, on_springs: Callable[..., Configuration | None]
) -> Configuration | None:
    """Creep from `start` to a state at `load` without springs; None if there is none.

    ``on_springs(system, start, load, stiffness)`` makes one step of the creep.
    """
    first = stiffness = float(system.weights.mean() / np.median(np.abs(system.operator.diagonal())))
    for _ in range(MOST_STEPS):
        if stiffness > STIFFEST * first:
            return None
        after = on_springs(system, start, load, stiffness)
        if after is None:
            stiffness *= STIFFER
            continue
        start, stiffness = after, stiffness * SOFTER
        beyond = finite_step(system, start, load)
        if beyond is None and worst_residual(system, start) <= MAX_RESIDUAL:
            return start
        if beyond is not None:
            return beyond
    return None


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


def finite_step(system: System, start: Configuration, load: np.ndarray, by_lemke: bool = True) -> Configuration | None:
    """A finite step to `load`, with its dissipation: an increment, or by Lemke's method where that fails."""
    after = accepted(system, start, implicit_step(system, start, load, patient=False))
    if after is None and by_lemke:
        after = accepted(system, start, FiniteStep(system, start).to(load))
    return after


def _on_springs(system: System, start: Configuration, load: np.ndarray, stiffness: float) -> Configuration | None:
    """A finite step of the pin on springs that are slack at `start`, in the directions in which nothing holds it.

    The motion in the directions of the springs counts from `start` during the step.
    """
    n, free = system.grid.size, ~system.motion_rows.any(axis=1)
    before = np.where(free, start.motion, 0.0)
    moved = system.motion @ before
    shifted = start.changed(
        motion=start.motion - before,
        rest_gap=start.rest_gap + moved[:n],
        slip=start.slip - moved[n:],
        rest_slip=start.rest_slip - moved[n:],
    )
    held = replace(system, motion_rows=system.motion_rows + np.diag(free * stiffness))
    after = finite_step(held, shifted, load)
    if after is None:
        return None
    after = after.changed(rest_gap=start.rest_gap, rest_slip=start.rest_slip)
    after = after.changed(motion=after.motion + before, slip=after.slip + moved[n:])
    if _spins(system, start, after):
        raise NoEquilibriumError(UNHELD)
    return after

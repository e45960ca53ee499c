"""One finite step of the load from rest, in which a contact begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.elasticity.interfaces import TURN
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.angles import angle_between
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import ROTATION
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import MAX_RESIDUAL, Configuration, resting_status, worst_residual
from fastpin.solver.increment import implicit_step
from fastpin.solver.rest import put_at_rest
from fastpin.solver.settling import FiniteStep

UNPRESSED = 1e-9
"""Largest pressure, in parts of the peak, of a node that counts as open in the first contact. It must not stick."""

COARSER = 0.8
"""Nodes in parts of those on which no first contact was found, with which it is looked for once more."""


def one_step(
    system: System, resting: Configuration, load: np.ndarray, everywhere: bool = False
) -> Configuration | None:
    """The implicit increment from rest; by Lemke's method where its iteration fails, see :class:`FiniteStep`.

    Where all nodes may close, three more beginnings are tried: the nodes that are closed without friction, for either
    method, and the statuses on fewer nodes.
    """

    def is_right(found: Configuration | None) -> bool:
        return found is not None and (not everywhere or worst_residual(system, found) <= MAX_RESIDUAL)

    quick = implicit_step(system, resting, load, patient=False) or FiniteStep(system, resting, everywhere).to(load)
    found = quick or implicit_step(system, resting, load)
    if is_right(found) or not (everywhere and system.has_friction):
        return found
    smooth = shearless_step(system, resting, load)
    if smooth is not None:
        start = replace(resting, status=smooth.status)
        found = implicit_step(system, start, load) or FiniteStep(system, start, everywhere).to(load)
    return found if is_right(found) else _refined(system, resting, load)


def _refined(system: System, resting: Configuration, load: np.ndarray) -> Configuration | None:
    """The implicit increment that begins with the statuses of the same increment on fewer nodes.

    A neat pin that turns freely may slip and stick in many zones. From rest they are found on few nodes only.
    """
    count, theta = int(COARSER * system.grid.size), system.grid.theta
    if count < LEAST_NODES or not system.grid.closed:
        return None
    coarse = System.build(system.problem, Grid.circle(count, float(theta[0])), system.scales.force)
    distances = np.abs(angle_between(theta[:, None], coarse.grid.theta))
    to, back = distances.argmin(axis=0), distances.argmin(axis=1)
    begun = replace(unloaded_configuration(coarse), status=resting.status[to])
    put_at_rest(coarse, begun, resting.load, resting.rest, resting.rest_gap[to])
    found = one_step(coarse, begun, load, everywhere=True)
    if found is None or worst_residual(coarse, found) > MAX_RESIDUAL:
        return None
    return implicit_step(system, replace(resting, status=found.status[back]), load)


def shearless_step(system: System, resting: Configuration, load: np.ndarray) -> Configuration | None:
    """The implicit increment without friction. After it the closed nodes stick where they are."""
    smooth, start, held_load = system.without_friction(), resting.copy(), load.copy()
    start.status[start.closed] = resting_status(smooth)[start.closed]
    if not system.motion_rows[TURN, TURN]:  # the pin turns freely
        held_load[ROTATION] = resting.motion[TURN]
    found = one_step(smooth, start, held_load)
    if found is not None:
        pressed = found.pressure > UNPRESSED * found.pressure.max()
        found.status[:] = np.where(found.closed & pressed, resting_status(system), OPEN)
        found.load = load
    return found

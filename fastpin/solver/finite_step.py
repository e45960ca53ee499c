"""One finite step of the load from rest, in which a contact begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.loads import ROTATION
from fastpin.solver.configuration import MAX_RESIDUAL, Configuration, resting_status, worst_residual
from fastpin.solver.increment import implicit_step
from fastpin.solver.settling import FiniteStep

UNPRESSED = 1e-9
"""Largest pressure, in parts of the peak, of a node that counts as open in the first contact. It must not stick."""


def one_step(
    system: System, resting: Configuration, load: np.ndarray, everywhere: bool = False
) -> Configuration | None:
    """The implicit increment from rest; by Lemke's method where its iteration fails, see :class:`FiniteStep`.

    If neither finds it, and all nodes may close, both begin once more with the nodes that are closed without friction.
    """
    found = implicit_step(system, resting, load) or FiniteStep(system, resting, everywhere).to(load)
    is_right = found is not None and (not everywhere or worst_residual(system, found) <= MAX_RESIDUAL)
    if is_right or not (everywhere and system.has_friction):
        return found
    smooth = shearless_step(system, resting, load)
    if smooth is None:
        return None
    start = replace(resting, status=smooth.status)
    return implicit_step(system, start, load) or FiniteStep(system, start, everywhere).to(load)


def shearless_step(system: System, resting: Configuration, load: np.ndarray) -> Configuration | None:
    """The implicit increment without friction. After it the closed nodes stick where they are."""
    smooth, start, held_load = system.without_friction(), resting.copy(), load.copy()
    start.status[start.closed] = resting_status(smooth)[start.closed]
    if system.problem.rotation == "free":
        held_load[ROTATION] = resting.motion[2]
    found = one_step(smooth, start, held_load)
    if found is not None:
        pressed = found.pressure > UNPRESSED * found.pressure.max()
        found.status[:] = np.where(found.closed & pressed, resting_status(system), OPEN)
        found.load = load
    return found

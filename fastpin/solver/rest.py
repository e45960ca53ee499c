"""The pin between contacts: at rest on the hole, and after contact was lost."""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.loads import ROTATION, SXX, SXY, SYY
from fastpin.solver.configuration import Configuration, elastic_energy


def release(system: System, last: Configuration, load: np.ndarray) -> Configuration:
    """Release the pin after contact was lost: no tractions, no slip history, the pin where it was.

    If the pin still indents the hole at the last nodes, it is moved back towards the concentric position.

    Parameters
    ----------
    system : System
    last : Configuration
        The configuration before. It is not changed.
    load : ndarray, shape (loads,)
        Dimensionless.
    """
    n = system.grid.size
    new = last.copy()
    new.work -= elastic_energy(system, last)  # the elastic energy that is left goes back to the loads
    new.pressure[:], new.shear[:], new.status[:] = 0.0, 0.0, OPEN
    new.load = load.copy()
    translation, given = system.drive.translation[:n], system.drive.prescribed(load)
    position = np.where(system.drive.axes, 0.0, new.rest + new.motion[:2])
    width = np.maximum(hole_gap(system, load, system.grid.theta)[0] + translation @ given, 0.0)
    approach = -translation @ position
    deep = approach > width
    if deep.any():
        position *= float(np.min(width[deep] / approach[deep]))
    position += given
    put_at_rest(system, new, load, position, system.rest_clearance + translation @ position)
    return new


def put_at_rest(
    system: System, configuration: Configuration, load: np.ndarray, rest: np.ndarray, rest_gap: np.ndarray
) -> None:
    """Let motion and slip of `configuration` count from the position `rest`, without contact, under `load`.

    `rest` (2,) is the position of the pin's centre, and `rest_gap` (n,) the gap there. `configuration` is changed.
    """
    n = system.grid.size
    rest_gap = rest_gap - (system.loads - system.drive.columns)[:n] @ load  # prescribed displacements are loads
    configuration.rest, configuration.rest_gap = rest, rest_gap
    held = system.problem.held
    turned = load[ROTATION] if held else configuration.motion[2]
    configuration.motion = np.zeros_like(configuration.motion)
    configuration.motion[2] = turned
    free = system.load_displacement(load)
    configuration.gap = np.maximum(rest_gap + free[:n], 0.0)
    configuration.slip = free[n:] + configuration.motion[2]
    configuration.rest_slip = configuration.slip.copy()


def climb_angle(force: np.ndarray | float, moment: np.ndarray | float) -> np.ndarray:
    """The angle, rad, by which a pin climbs the hole until friction carries the moment on it; 90 degrees at most.

    `moment` is divided by the radius. Both are in the same units. The forces are not 0.
    """
    return np.arcsin(np.clip(-np.asarray(moment) / force, -1.0, 1.0))


def hole_gap(system: System, load: np.ndarray, theta: np.ndarray | float) -> np.ndarray:
    """Gap of the unloaded, concentric pin in the hole deformed by the remote stress (T16), and two derivatives.

    Returns the gap and its first and second derivative at the angles `theta`, rad, dimensionless, shape (3, ...).
    """
    if system.bodies is not None:
        moved = system.bodies.radial(load, theta)
        moved[0] += system.rest_clearance
        return moved
    sxx, syy, sxy = load[[SXX, SYY, SXY]]
    mean, oval, diagonal = system.plate * 0.5 * (sxx + syy), system.plate * (sxx - syy), 2.0 * system.plate * sxy
    cos, sin = np.cos(2.0 * np.asarray(theta)), np.sin(2.0 * np.asarray(theta))
    return np.array(
        [
            system.rest_clearance + mean + oval * cos + diagonal * sin,
            -2.0 * oval * sin + 2.0 * diagonal * cos,
            -4.0 * oval * cos - 4.0 * diagonal * sin,
        ]
    )

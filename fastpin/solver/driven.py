"""The pin whose displacement is prescribed: where it can float, and where it comes to rest on the hole.

Along a driven axis the pin is where the load puts it, in contact or not. Along the other axis a force pushes it.
:mod:`fastpin.elasticity.drive` has the equations.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fastpin.elasticity.drive import FORCES, SIGNS
from fastpin.elasticity.system import System
from fastpin.model.loads import M
from fastpin.runtime.extensions import optimize
from fastpin.solver.errors import NoEquilibriumError
from fastpin.solver.rest import hole_gap
from fastpin.solver.step import is_pushed

FINE = 1440
"""Angles at which the narrowest gap is looked for before it is refined."""


def can_float(system: System, load: np.ndarray) -> bool:
    """Whether the pin can be without contact under a load: nothing pushes it, and it has room where it is."""
    if is_pushed(load) or load[M] != 0.0:
        return False
    return not system.drive.has_displacements or _room(system, load)[0] >= 0.0


def rest_on_hole(
    system: System, before: np.ndarray, after: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float, float] | None:
    """Where and when the floating pin comes to rest on the hole, on the way from load `before` to load `after`.

    Parameters
    ----------
    system : System
        With a prescribed displacement.
    before, after : ndarray, shape (loads,)
        Dimensionless loads at the start and the end of the step.

    Returns
    -------
    (ndarray, ndarray, float, float) or None
        Position of the pin's centre from the concentric position, shape (2,); the gap there without remote stress,
        shape (n,); the angle of the contact, rad; and the fraction of the step at which the contact begins. None if the
        pin does not touch the hole in this step.

    Raises
    ------
    NoEquilibriumError
        If the pin has no room in the hole, or a moment acts on a pin that nothing holds.
    """
    drive = system.drive
    free = np.flatnonzero(~drive.axes)
    begins = 0.0
    if free.size and (side := after[FORCES[free[0]]] * SIGNS[free[0]]) != 0.0:
        position = _pushed_position(system, before, int(free[0]), math.copysign(1.0, side))
    else:
        if system.problem.rotation == "free" and after[M] != 0.0:
            raise NoEquilibriumError("a moment acts on the pin, which is not in contact: it spins")

        def room(fraction: float) -> float:
            return _room(system, before + fraction * (after - before))[0]

        if room(1.0) >= 0.0:
            return None
        begins = _last_crossing(room)
        position = _room(system, before + begins * (after - before))[1]
    angle = _narrowest(system, before + begins * (after - before), position)[1]
    if not system.concentric_gap.any() and not position.any():  # a neat fit touches where the loads push it
        push = drive.force(np.zeros(2), after) + drive.prescribed(after)
        angle = math.atan2(push[1], push[0])
    shift = position - system.rest_clearance * np.array([math.cos(angle), math.sin(angle)])
    n, half = system.grid.size, 0.5 * (system.grid.theta - angle)
    rest_gap = 2.0 * system.rest_clearance * np.sin(half) ** 2 + drive.translation[:n] @ shift + system.initial_gap
    return position, rest_gap, angle, begins


def _last_crossing(room: Callable[[float], float]) -> float:
    """The fraction of a step at which the room of the pin is used up. At the end of the step there is none.

    The room is a concave function of the fraction. At the start there may be none either: the nodes have just opened,
    and the narrowest place lies between them.
    """
    first = 0.0
    if room(0.0) <= 0.0:
        widest = optimize.minimize_scalar(lambda fraction: -room(fraction), bounds=(0.0, 1.0), method="bounded")
        first = float(widest.x)
        if room(first) <= 0.0:
            return 0.0
    return float(optimize.brentq(room, first, 1.0, xtol=1e-15, rtol=1e-14))


def _room(system: System, load: np.ndarray) -> tuple[float, np.ndarray]:
    """The narrowest gap round the pin where the load puts it, and this position (2,). Negative: the pin has no room.

    Along an axis without a drive the pin moves to the place with the widest gap.
    """
    position = system.drive.prescribed(load)
    free = np.flatnonzero(~system.drive.axes)
    is_oval = hole_gap(system, load, 0.0)[1:].any() or hole_gap(system, load, 0.5)[1:].any()
    if free.size and (is_oval or system.problem.gap):
        position[free[0]] = _widest_place(system, load, position, int(free[0]))
    return _narrowest(system, load, position)[0], position


def _widest_place(system: System, load: np.ndarray, position: np.ndarray, axis: int) -> float:
    """The coordinate along `axis` with the widest of the narrowest gaps. The other coordinate is that of `position`."""

    def tightness(coordinate: float) -> float:
        moved = position.copy()
        moved[axis] = coordinate
        return -_narrowest(system, load, moved)[0]

    size = float(np.abs(hole_gap(system, load, np.linspace(0.0, 2.0 * math.pi, 73))[0]).max())
    found = optimize.minimize_scalar(
        tightness, bounds=(-2.0 * size, 2.0 * size), method="bounded", options={"xatol": 1e-12 * max(size, 1e-300)}
    )
    return float(found.x)


def _pushed_position(system: System, load: np.ndarray, axis: int, side: float) -> np.ndarray:
    """Where a pin comes to rest that a force pushes along `axis` in the sense `side`; the load gives the other axis."""
    room, position = _room(system, load)
    if room < 0.0:
        raise NoEquilibriumError("the pin has no room in the hole where the prescribed displacement puts it")
    widest = position[axis]

    def left(way: float) -> float:
        position[axis] = widest + side * way
        return _narrowest(system, load, position)[0]

    longest = 4.0 * float(np.abs(hole_gap(system, load, np.linspace(0.0, 2.0 * math.pi, 73))[0]).max())
    longest += 4.0 * float(np.abs(position).max())
    if room > 0.0 and longest > 0.0:
        position[axis] = widest + side * float(optimize.brentq(left, 0.0, longest, xtol=1e-300, rtol=1e-14))
    else:
        position[axis] = widest
    return position


def _narrowest(system: System, load: np.ndarray, position: np.ndarray) -> tuple[float, float]:
    """The narrowest gap round the pin at `position` (2,), and its angle, rad."""
    x, y = position

    def gap(theta: np.ndarray | float) -> np.ndarray:
        cos, sin = np.cos(theta), np.sin(theta)
        moved = np.array([x * cos + y * sin, -x * sin + y * cos, -x * cos - y * sin])
        found: np.ndarray = hole_gap(system, load, theta) - moved
        return found

    coarse = np.arange(FINE) * (2.0 * math.pi / FINE) - math.pi
    if system.problem.gap:
        coarse = np.r_[coarse, system.problem.gap_angles]
    values = gap(coarse)[0]
    first = angle = float(coarse[np.argmin(values)])
    for _ in range(4):  # Newton's steps
        _, slope, curvature = gap(angle)
        if not curvature > 0.0:
            break
        angle -= float(np.clip(slope / curvature, -2.0 * math.pi / FINE, 2.0 * math.pi / FINE))
    narrowest = float(gap(angle)[0])
    if system.problem.gap and narrowest > values.min():  # a kink misleads the slope
        return float(values.min()), first
    return narrowest, angle

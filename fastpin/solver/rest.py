"""The pin between contacts: at rest on the hole, and after contact was lost."""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, TURN, JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import ACTING, REMOTE, ROTATION, SXX, SXY, SYY, THERMAL
from fastpin.model.problem import LOOKED_AT, Problem
from fastpin.model.profile import widest_place
from fastpin.runtime.extensions import optimize
from fastpin.solver.configuration import SLIGHT, Configuration, review
from fastpin.solver.errors import NoEquilibriumError
from fastpin.solver.interfaces import PinView, part_of, with_part, without_force
from fastpin.solver.path import PathStep, StepLostError

SHAPING = [SXX, SYY, SXY, *THERMAL]
"""Loads that change the shape of the hole."""

REFINEMENTS = 8
"""Newton's steps for a pin that rests on two places."""


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
    if isinstance(system, JointSystem):
        return _release_pin(system, last, load)
    n = system.grid.size
    new = last.copy()
    new.work -= review(system, last).energy  # the elastic energy that is left goes back to the loads
    new.pressure[:], new.shear[:], new.status[:] = 0.0, 0.0, OPEN
    new.load = load.copy()
    translation, given = system.drive.translation[:n], system.drive.prescribed(load)
    middle = place_between(system, load)
    way = np.where(system.drive.axes, 0.0, new.rest + new.motion[:2] - middle)
    width = np.maximum(hole_gap(system, load, system.grid.theta)[0] + translation @ (middle + given), 0.0)
    approach = -translation @ way
    deep = approach > width
    if deep.any():
        way *= float(np.min(width[deep] / approach[deep]))
    position = middle + way + given
    put_at_rest(system, new, load, position, system.concentric_gap + translation @ position)
    return new


def _release_pin(joint: JointSystem, last: Configuration, load: np.ndarray) -> Configuration:
    """Release the pin in a bush. A bush that no press fit holds lets go, too."""
    if joint.is_pressed:
        view = PinView(joint, last)
        return view.whole(release(view.system, view.pin, load))
    last = last.copy()
    for each in joint.interfaces:  # without friction nothing turns: what is left of it is rounding
        if not joint.equilibrium[each.motion + TURN].any() and not joint.load_forces(load)[each.motion + TURN]:
            last.motion[each.motion + TURN] = 0.0
    pin, seat = (release(joint.alone[place], part_of(joint, last, place), load) for place in (PIN, SEAT))
    if joint.problem.held:  # over the lug: the pin turns back in the bush by as much as the bush has turned
        turned = load[ROTATION] - seat.motion[TURN] - pin.motion[TURN]
        motion = pin.motion + np.array([0.0, 0.0, turned])
        pin = pin.changed(motion=motion, slip=pin.slip + turned, rest_slip=pin.rest_slip + turned)
    found = with_part(joint, with_part(joint, last, PIN, pin), SEAT, seat)
    return found.changed(
        dissipation=last.dissipation, seat_dissipation=last.seat_dissipation,
        work=last.work - review(joint, last).energy,
    )  # fmt: skip


def follow_floating(joint: JointSystem, now: Configuration, load: np.ndarray) -> Configuration:
    """Take a floating pin to a `load` (loads,), or to where the bore grips it. The bush alone follows its load.

    Raises
    ------
    NoEquilibriumError
        If nothing holds the bush, or if the lug closes on a loose one.
    """
    own = part_of(joint, now, SEAT)
    start = own.changed(load=without_force(own.load))
    if not joint.is_pressed:
        found, theta = release(joint, now, load), np.linspace(-math.pi, math.pi, LOOKED_AT)
        if widest_place(theta, hole_gap(joint.alone[SEAT], load, theta)[0], (False, False))[0] < 0.0:
            raise NoEquilibriumError("the remote stress closes the hole of the plate on a loose bush")
        return found

    def at(part: float) -> Configuration:
        reached = start.load + part * (load - start.load)
        seat = start
        if not np.array_equal(start.load, load):
            seat = PathStep(joint.alone[SEAT], start, load).follow(part)
        view = PinView(joint, with_part(joint, now, SEAT, seat.changed(load=reached)))
        return view.whole(release(view.system, view.pin, reached))

    try:
        found = at(1.0)
        if _room(joint, found) < 0.0:
            grips = optimize.brentq(lambda part: _room(joint, at(part)), 0.0, 1.0, xtol=SLIGHT)
            return at(max(float(grips) - SLIGHT, 0.0))
    except StepLostError:
        raise NoEquilibriumError("nothing holds the bush in its seat") from None
    found.load = load.copy()
    return found


def _room(joint: JointSystem, floating: Configuration) -> float:
    """The narrowest gap round a floating pin where it has most room; negative where the bore grips it."""
    system, theta = PinView(joint, floating).system, np.linspace(-math.pi, math.pi, LOOKED_AT)
    return widest_place(theta, hole_gap(system, floating.load, theta)[0], (False, False))[0]


def place_between(system: System, load: np.ndarray) -> np.ndarray:
    """A place at which the floating pin does not touch the hole under `load`, shape (2,): concentric if it can be.

    A prescribed displacement comes on top of it: along a driven axis it is 0.
    """
    place, given = np.zeros(2), system.drive.prescribed(load)
    if not system.problem.gap:
        return place
    theta = np.r_[system.problem.gap_angles, system.grid.theta]
    gap = hole_gap(system, load, theta)[0] - given[0] * np.cos(theta) - given[1] * np.sin(theta)
    return place if gap.min() >= 0.0 else widest_place(theta, gap, system.problem.driven)[1]


def put_at_rest(
    system: System, configuration: Configuration, load: np.ndarray, rest: np.ndarray, rest_gap: np.ndarray
) -> None:
    """Let motion and slip of `configuration` count from the position `rest`, without contact, under `load`.

    `rest` (2,) is the position of the pin's centre, and `rest_gap` (n,) the gap there. `configuration` is changed.
    """
    n = system.grid.size
    # Prescribed displacements are loads.
    rest_gap = rest_gap - (system.loads - system.drive.columns)[:n, :ACTING] @ load[:ACTING]
    configuration.rest, configuration.rest_gap = rest, rest_gap
    turned = load[ROTATION] if system.motion_rows[TURN, TURN] else configuration.motion[TURN]  # held, or frictionless
    configuration.motion = np.zeros_like(configuration.motion)
    configuration.motion[TURN] = turned
    free = system.load_displacement(load)
    configuration.gap = np.maximum(rest_gap + free[:n], 0.0)
    configuration.slip = free[n:] + turned
    configuration.rest_slip = configuration.slip.copy()


def rest_position(system: System, load: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """The position of the rigid pin at rest on the hole, pushed so that the contact normal is at `angle`.

    Parameters
    ----------
    system : System
    load : ndarray, shape (loads,)
        Dimensionless. Its remote stress deforms the hole.
    angle : float
        rad.

    Returns
    -------
    (ndarray, ndarray)
        The position of the pin's centre, shape (2,), from the concentric position; and the gap there, shape (n,).
        The gap is without the remote stress. It keeps its digits beside the contact for any clearance.

    Raises
    ------
    NoEquilibriumError
        If the remote stress closes the hole on the pin.
    """
    cos, sin = math.cos(angle), math.sin(angle)
    gap, slope, _ = hole_gap(system, load, angle)
    has_gap = bool(system.problem.gap)
    is_round = system.bodies is None and not has_gap and not load[list(REMOTE)].any()  # the gap is the same everywhere
    fine = np.linspace(-math.pi, math.pi, LOOKED_AT) if not is_round else np.array([-math.pi])
    if has_gap:
        fine = np.unique(np.r_[fine, system.problem.gap_angles])
    values, curvature = hole_gap(system, load, fine)[[0, 2]] if not is_round else (gap, 0.0)
    widened = gap - system.rest_clearance
    shift = np.array([widened * cos - slope * sin, widened * sin + slope * cos])
    position = system.rest_clearance * np.array([cos, sin]) + shift
    touches = np.all(values + curvature >= 0.0)  # the pin touches at one point, with its normal at `angle`
    if has_gap and not touches:
        left = values - position[0] * np.cos(fine) - position[1] * np.sin(fine)
        touches = left.min() >= -SLIGHT * np.abs(values).max()
    if touches:
        half, moved = 0.5 * (system.grid.theta - angle), system.drive.translation[: system.grid.size] @ shift
        rest_gap = 2.0 * system.rest_clearance * np.sin(half) ** 2 + moved
        return position, rest_gap + system.initial_gap
    # The hole is tighter than the pin somewhere: the pin touches at two points.
    touched = _pushed_against(system, load, angle, fine)
    if touched is not None:
        position = _on_two_places(system, load, *touched) if has_gap else touched[1]
    else:  # it may be too narrow between two nodes only, as the spline of a worn gap
        touched = None
        if has_gap:
            theta = system.grid.theta
            beyond = np.linspace(theta[-1], theta[0] + 2.0 * math.pi, LOOKED_AT)[1:-1]
            touched = _pushed_against(system, load, angle, theta if system.grid.closed else np.r_[theta, beyond])
        if touched is None:
            raise NoEquilibriumError("the remote stress closes the hole on the pin before the pin is loaded")
        position = touched[1]
    return position, system.concentric_gap + system.drive.translation[: system.grid.size] @ position


def _pushed_against(
    system: System, load: np.ndarray, angle: float, theta: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """The angles of `theta` (n,), rad, at which a rigid pin that is pushed towards `angle` touches; and its position.

    None if the pin has no room between the angles.
    """
    rows, gap = np.column_stack([np.cos(theta), np.sin(theta)]), hole_gap(system, load, theta)[0]
    optimum = optimize.linprog([-math.cos(angle), -math.sin(angle)], rows, gap, bounds=(None, None))
    return (theta[optimum.ineqlin.marginals < -1e-9], optimum.x) if optimum.success else None


def _on_two_places(system: System, load: np.ndarray, angles: np.ndarray, position: np.ndarray) -> np.ndarray:
    """The position (2,) of a rigid pin on two places, from a `position` nearby that touches near two `angles`, rad.

    A symmetric hole then has a symmetric pin, to the last digits. `position` itself where there are no two places.
    """
    found = position
    for _ in range(REFINEMENTS):
        gap, slope, curvature = hole_gap(system, load, angles)
        across = np.column_stack([np.cos(angles), np.sin(angles)])
        if angles.size != 2 or abs(np.linalg.det(across)) < SLIGHT:
            return position
        found = np.linalg.solve(across, gap)
        slope = slope - np.column_stack([-across[:, 1], across[:, 0]]) @ found
        curvature = curvature + across @ found
        spacing = 2.0 * math.pi / (LOOKED_AT - 1)
        smooth = curvature > 0.0
        angles = angles - np.where(smooth, np.clip(slope / np.where(smooth, curvature, 1.0), -spacing, spacing), 0.0)
    return found


def bend(system: System, load: np.ndarray, angle: float, half: float) -> float:
    """Curvature of the hole against the pin at `angle`, rad; with an initial gap the mean over `half`, rad, beside it.

    A gap may have kinks, and waves that are shorter than a contact.
    """
    gap, _, curvature = hole_gap(system, load, angle)
    if not system.problem.gap:
        return float(gap + curvature)
    width = max(half, 1e-4)  # rounding is 1e-8 of the gap there
    beside = hole_gap(system, load, angle + width * np.array([-1.0, 1.0]))[0]
    return float(beside.sum() - 2.0 * math.cos(width) * gap) / (4.0 * math.sin(0.5 * width) ** 2)


def lowest_angle(system: System, resting: Configuration, angle: float) -> float:
    """The angle, rad, of the narrowest gap round a resting pin, by Newton's method from an `angle` one node away."""
    x, y = resting.rest
    for _ in range(REFINEMENTS):
        _, slope, curvature = hole_gap(system, resting.load, angle)
        cos, sin = math.cos(angle), math.sin(angle)
        slope, curvature = float(slope + x * sin - y * cos), float(curvature + x * cos + y * sin)
        if not curvature > 0.0:
            break
        step = 2.0 * math.pi / system.grid.size
        angle -= min(max(slope / curvature, -step), step)
    return angle


def climb_angle(force: np.ndarray | float, moment: np.ndarray | float) -> np.ndarray:
    """The angle, rad, by which a pin climbs the hole until friction carries the moment on it; 90 degrees at most.

    `moment` is divided by the radius. Both are in the same units. The forces are not 0.
    """
    return np.arcsin(np.clip(-np.asarray(moment) / force, -1.0, 1.0))


def hole_gap(system: System, load: np.ndarray, theta: np.ndarray | float) -> np.ndarray:
    """Gap of the unloaded, concentric pin in the hole under remote stress (T16) and temperature, and two derivatives.

    The initial gap is part of it.

    Returns the gap and its first and second derivative at the angles `theta`, rad, dimensionless, shape (3, ...).
    """
    if system.bodies is None:
        sxx, syy, sxy, *warm = load[SHAPING].tolist()
        warmed = float(system.loads[0, THERMAL] @ warm) if any(warm) else 0.0
        if not (sxx or syy or sxy):
            found = np.zeros((3, *np.shape(theta)))
            found[0] = system.rest_clearance + warmed
            return found + _initial_gap(system, theta)
        mean, oval, diagonal = system.plate * 0.5 * (sxx + syy), system.plate * (sxx - syy), 2.0 * system.plate * sxy
        mean += warmed
    elif system.bodies.anisotropy is not None:
        mean, oval, diagonal = system.bodies.ellipse(load)
    else:
        moved = system.bodies.radial(load, theta)
        moved[0] += system.rest_clearance
        return moved + _initial_gap(system, theta)
    cos, sin = np.cos(2.0 * np.asarray(theta)), np.sin(2.0 * np.asarray(theta))
    widened = np.array(
        [
            system.rest_clearance + mean + oval * cos + diagonal * sin,
            -2.0 * oval * sin + 2.0 * diagonal * cos,
            -4.0 * oval * cos - 4.0 * diagonal * sin,
        ]
    )
    return widened + _initial_gap(system, theta)


def _initial_gap(system: System, theta: np.ndarray | float) -> np.ndarray | float:
    """The initial gap and two derivatives, dimensionless, shape (3, ...); 0 without one."""
    if not system.problem.gap:
        return 0.0
    return system.problem.gap_at(np.asarray(theta)) / system.scales.displacement


class OutsideGap:
    """The gap beyond an arc of nodes, at up to 180 angles: a pin may touch there too.

    Where a bush slips, the tractions in its seat bend its bore.

    Parameters
    ----------
    system : System
        On an arc.

    Attributes
    ----------
    of : object
        The operator of `system`. Systems with this operator have the same gap beyond the arc.
    """

    def __init__(self, system: System) -> None:
        self.of: object = system.operator
        self._joint = system if isinstance(system, JointSystem) else None
        system = self._own(system)
        grid = system.grid
        n, ends = grid.size, (grid.theta[-1], grid.theta[0] + 2.0 * math.pi)
        count = min(math.ceil((ends[1] - ends[0]) / node_spacing(grid)) - 1, 180)
        self._theta = np.linspace(*ends, max(count, LEAST_NODES) + 2)[1:-1]
        around = System.build(system.problem, Grid(np.r_[grid.theta, self._theta], closed=True), system.scales.force)
        rows, nodes = np.arange(n, around.grid.size), np.arange(n)
        self._operator = around.operator.entries(rows, np.r_[nodes, around.grid.size + nodes])
        self._moved, self._loads = around.motion[rows], around.loads[rows].copy()
        self._rest: tuple[np.ndarray, Problem, np.ndarray] | None = None  # the latest gap at rest
        if self._joint is not None:  # the remote stress acts on the lug alone
            self._loads[:, REMOTE] = 0.0
            self._bore = self._joint.bore_at(self._theta)

    @staticmethod
    def _own(system: System) -> System:
        """The system of the pin."""
        return system.alone[PIN] if isinstance(system, JointSystem) else system

    def is_closed(self, system: System, now: Configuration) -> bool:
        """Whether the pin, in contact on the arc, penetrates the hole beyond it by more than rounding."""
        bent: float | np.ndarray = 0.0
        if self._joint is not None:
            bent = self._bore @ now.tractions[self._joint.nodes.rows(SEAT)]
            system, now = self._own(system), part_of(self._joint, now, PIN)
        if not now.closed.any():  # a floating pin is looked after by the first contact
            return False
        elastic = self._operator @ now.tractions + bent
        moved = self._moved @ now.motion + self._loads @ now.load[: self._loads.shape[1]]
        known = self._rest
        if known is None or known[0] is not now.rest_gap or known[1] is not system.problem:
            known = self._rest = now.rest_gap, system.problem, rest_gap_at(system, now, self._theta)
        lowest = float((elastic + moved + known[2]).min())
        return lowest < 0.0 and lowest < -SLIGHT * float(max(np.abs(elastic).max(), np.abs(moved).max()))


def rest_gap_at(system: System, now: Configuration, theta: np.ndarray) -> np.ndarray:
    """The gap of the resting pin, shape (k,), at angles `theta` (k,) beyond the nodes of an arc.

    It differs from the gap at the end of the arc by the first harmonic of the resting position, and by the initial gap.
    The sines keep the digits of small gaps in a large clearance.
    """
    ends = system.grid.theta[[0, -1]]
    nearest = np.argmin(np.abs(theta[:, None] - ends), axis=1)
    end = ends[nearest]
    x, y = np.where(system.drive.axes, 0.0, now.rest)
    middle, half = 0.5 * (theta + end), 0.5 * (theta - end)
    change: np.ndarray = 2.0 * np.sin(half) * (x * np.sin(middle) - y * np.cos(middle))
    if system.problem.gap:
        change += (system.problem.gap_at(theta)[0] - system.problem.gap_at(end)[0]) / system.scales.displacement
    return now.rest_gap[[0, -1]][nearest] + change


def node_spacing(grid: Grid) -> float:
    """Distance of neighbouring nodes of a uniform arc, rad."""
    return float(grid.theta[-1] - grid.theta[0]) / (grid.size - 1)

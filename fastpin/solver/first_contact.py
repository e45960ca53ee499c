"""The beginning of a contact: the pin comes to rest on the hole, then a few nodes touch."""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.angles import angle_between
from fastpin.model.loads import FRICTION_CHANGE, REMOTE, UX, UY, M, P, Q
from fastpin.reading.zones import runs
from fastpin.runtime.extensions import optimize
from fastpin.solver.assembly import one_step, shearless_step
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    ROUNDED,
    SLIGHT,
    Configuration,
    accept_solution,
    dissipation_between,
    reaches_end,
    resting_status,
    review,
    seat_dissipation_between,
    slip_tally_between,
    slip_tally_with,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.driven import rest_on_hole
from fastpin.solver.errors import CUT_OFF, NARROW, ArcError, NoEquilibriumError, ResolutionError
from fastpin.solver.interfaces import PinView, part_of, with_part
from fastpin.solver.path import PathStep, StepLostError, follow_whole
from fastpin.solver.rest import SHAPING, bend, hole_gap, place_between, put_at_rest, release, rest_position
from fastpin.solver.step import is_pushed, presses
from fastpin.solver.tableau import TableauMemory

FIRST_BESIDE = 2
"""Nodes on either side of the nearest node. The iteration for the first contact begins with all these closed."""

GROWN_NODES = 19
"""Nodes of the young contact from which the slip of the first nodes is found."""

BESIDE_END = 3
"""Nodes by which a young contact stays smaller than its distance from the end of an arc allows, twice the distance."""

CONFORMING_PART = 1e-3
"""Part of a step at which the first contact of a pin is tried on which the hole closes all round."""


class Way(NamedTuple):
    """The step that leads to a first contact.

    Attributes
    ----------
    begins : float
        Fraction of the step at which the contact begins.
    before, after : ndarray, shape (loads,)
        Dimensionless loads at the ends of the step.
    has_slip : bool
        Whether the slip of the first nodes is found, too.
    """

    begins: float
    before: np.ndarray
    after: np.ndarray
    has_slip: bool = True


def at_rest(
    system: System, floating: Configuration, before: np.ndarray, after: np.ndarray
) -> tuple[Configuration, float] | None:
    """Put the pin at rest on the hole, about to be pushed, on the way from load `before` to load `after`.

    Parameters
    ----------
    system : System
    floating : Configuration
        The pin without contact. It is not changed.
    before, after : ndarray, shape (loads,)
        Dimensionless loads at the start and the end of the step.

    Returns
    -------
    (Configuration, float) or None
        The pin at rest, with a first guess of the closed nodes; and the fraction of the step at which the contact
        begins. The slip of the contact counts from this configuration. None if no contact begins in this step.

    Raises
    ------
    NoEquilibriumError
        If a moment acts on a pin that nothing holds. If the moment is more than friction at a point can carry. If the
        remote stress closes the hole on the pin before the pin is loaded.
    ArcError
        If the pin touches the hole outside the arc, or is gripped there.
    """
    begins, angle = 0.0, 0.0
    force = np.array([after[Q], -after[P]])
    size = float(np.hypot(*force))
    lowest: np.ndarray | None = None
    if system.drive.has_displacements:
        driven = rest_on_hole(system, before, after)
        if driven is None:
            return None
        rest, rest_gap, angle, begins = driven
    elif size == 0.0:
        if system.problem.rotation == "free" and after[M] != 0.0:
            raise NoEquilibriumError("a moment acts on the pin, which is not in contact: it spins")
        gripped = _grip(system, before, after)
        if gripped is None:
            return None
        begins, rest, lowest = gripped
        rest_gap = system.concentric_gap + system.drive.translation[: system.grid.size] @ rest
    else:
        tangential = -after[M] / (size * system.radius) if system.problem.rotation == "free" else 0.0
        angle = math.atan2(force[1], force[0]) + math.asin(max(-1.0, min(tangential, 1.0)))
        friction = float(system.friction[np.argmin(np.abs(angle_between(system.grid.theta, angle)))])
        limit = friction / math.hypot(1.0, friction)
        if abs(tangential) > limit:
            raise NoEquilibriumError(
                f"the moment is {abs(tangential):.4g} times force times radius, more than friction can carry "
                f"({limit:.4g}): the pin spins"
            )
        rest, rest_gap = rest_position(system, before, angle)
    resting = floating.copy()
    if np.isnan(resting.origin).any():
        resting.origin = rest.copy()
    resting.load = before + begins * (after - before)
    put_at_rest(system, resting, resting.load, rest, rest_gap)
    if np.ptp(resting.gap) <= (_rounding(system) if system.problem.gap else 0.0):  # the load decides in a neat fit
        nearness = system.load_displacement(after - before, slice(system.grid.size))
        if size > 0.0:
            nearness = nearness - np.cos(system.grid.theta - angle)
        lowest = _lowest_places(system, nearness)
    elif lowest is None:
        lowest = _lowest_places(system, resting.gap)
    if not system.grid.closed and not 0 < lowest[0] < system.grid.size - 1:
        raise ArcError("the pin rests on the hole outside the arc; give a wider one, or none")
    offsets = np.arange(-FIRST_BESIDE, FIRST_BESIDE + 1)
    nodes = (lowest[:, None] + offsets).ravel()
    nodes = nodes % system.grid.size if system.grid.closed else nodes.clip(1, system.grid.size - 2)
    resting.status[nodes] = resting_status(system)[nodes]
    return resting, begins


def _rounding(system: System) -> float:
    """The largest difference of the gap round a pin that touches all round."""
    return SLIGHT * float(np.abs(system.concentric_gap).max())


def _lowest_places(system: System, gap: np.ndarray) -> np.ndarray:
    """Nodes where the pin at rest touches the hole, the nearest first: one node, two in an oval hole, or all nodes."""
    n = system.grid.size
    if np.ptp(gap) <= 1e-12 * np.abs(gap).max():  # the pin touches all round at once
        return np.arange(n)
    before, after = np.concatenate([gap[-1:], gap[:-1]]), np.concatenate([gap[1:], gap[:1]])
    if not system.grid.closed:
        before[0], after[-1] = np.inf, np.inf
    lowest = np.flatnonzero((gap <= before) & (gap < after))
    lowest = lowest[np.argsort(gap[lowest], kind="stable")]
    first = lowest[0]
    threshold = np.maximum(gap[(first + FIRST_BESIDE) % n], gap[first - FIRST_BESIDE])  # the gap two nodes away
    return lowest[gap[lowest] <= threshold]


def first_contact(
    system: System,
    floating: Configuration,
    before: np.ndarray,
    after: np.ndarray,
    strict: bool = False,
    has_slip: bool = True,
) -> tuple[Configuration, float]:
    """Find the first contact on the way from load `before` to load `after`: one implicit increment from rest.

    Parameters
    ----------
    system : System
    floating : Configuration
        The pin without contact. It is not changed.
    before, after : ndarray, shape (loads,)
        Dimensionless loads at the start and the end of the step.
    strict : bool
        Whether it is an error if the hole can't keep its shape while the first nodes close.
    has_slip : bool
        Whether the slip of the first nodes is found, too. It takes half of the time. A coarse run that only asks which
        nodes ever touch does not need it.

    Returns
    -------
    (Configuration, float)
        A contact of a few nodes, and the fraction of the step at which it holds; or the pin still without contact,
        and 1.

    Raises
    ------
    NoEquilibriumError
        See :func:`at_rest`.
    ResolutionError
        If the contact is narrower than the nodes.
    ArcError
        If the pin touches the hole outside the arc or at its end.
    """
    if isinstance(system, JointSystem):
        return _first_contact_of_joint(system, floating, before, after, strict, has_slip)
    found = at_rest(system, floating, before, after)
    if found is None:
        return release(system, floating, after), 1.0
    resting, begins = found
    begun = partial(_first_patch, way=Way(begins, before, after, has_slip))
    if system.needs_windows:
        from fastpin.narrow import begun_in_window

        begun = partial(begun_in_window, patch_on=begun)
    most_part = _steady_part(system, resting, (1.0 - begins) * (after - before))
    try:
        return begun(system, resting, most_part=most_part)
    except ResolutionError:
        if strict:
            raise
        return begun(system, resting, most_part=1.0)


def _first_contact_of_joint(
    joint: JointSystem, floating: Configuration, before: np.ndarray, after: np.ndarray, strict: bool, has_slip: bool
) -> tuple[Configuration, float]:
    """The first contact of a pin in a bush: a loose bush comes to rest first, then the pin in the bent bush."""
    floating, begins, beginning = floating.changed(load=before), 0.0, None
    if not floating.closed[joint.interfaces[SEAT].nodes].any():
        beginning, alone = floating, joint.alone[SEAT]
        most = 1.0 if alone.concentric_gap.any() else CONFORMING_PART  # a neat one touches all round
        begun = before + most * (after - before)
        seat, part = first_contact(alone, part_of(joint, floating, SEAT), before, begun, strict, has_slip)
        if not seat.closed.any():
            return release(joint, floating, after), part
        floating, begins = with_part(joint, floating, SEAT, seat), most * part
    view = PinView(joint, floating)
    try:
        pin, part = first_contact(view.system, view.pin, before, after, strict, has_slip)
    except NoEquilibriumError:  # a bush that bends leaves a neat pin no room
        both = None if beginning is None else _both_at_once(joint, beginning, Way(begins, before, after), seat.status)
        if both is None:
            raise
        return both
    if begins > part:  # the wider of two first contacts gives the load of both
        pin, part = pin.changed(load=seat.load), begins
    return view.whole(pin), part


def _both_at_once(
    joint: JointSystem, floating: Configuration, way: Way, seat_status: np.ndarray
) -> tuple[Configuration, float] | None:
    """The first contacts of the pin and of a loose bush in one implicit increment; None where none is found.

    The increment is exact where both fits are neat and there was no load before: all grows in proportion. `way` is the
    part of the step at which the bush alone has its first contact, and the loads at the ends of the step.
    `seat_status` (n,) are the statuses of this contact, with which the iteration begins.
    """
    part, before, after = way[:3]
    resting = floating
    for place in (PIN, SEAT):
        found = at_rest(joint.alone[place], part_of(joint, floating, place), before, after)
        if found is None or found[1] > 0.0:
            return None
        resting = with_part(joint, resting, place, found[0])
    if all(_is_self_similar(alone, resting, way._replace(begins=0.0)) for alone in joint.alone):
        part = 1.0
    resting.status[joint.interfaces[SEAT].nodes] = seat_status
    for _ in range(30):
        load = before + part * (after - before)
        step = one_step(joint, resting, load)
        if step is not None and worst_residual(joint, step) <= MAX_RESIDUAL:
            return _begun(joint, resting, step, None), part
        part *= 0.7
    return None


def _grip(system: System, before: np.ndarray, after: np.ndarray) -> tuple[float, np.ndarray, np.ndarray] | None:
    """Find where the shrinking hole grips a pin without force: a linear programme of the rigid pin on the nodes.

    The pin is free as long as there is a position at which no node penetrates it.

    Returns
    -------
    (float, ndarray, ndarray) or None
        The fraction of the step at which the hole grips the pin, the position of the pin's centre there, shape (2,),
        and the nodes that hold it. None if the pin stays free.

    Raises
    ------
    ArcError
        If the hole grips the pin outside the arc.
    """
    theta = system.grid.theta
    if not system.grid.closed:  # the rest of the hole
        beyond = np.linspace(theta[-1], theta[0] + 2.0 * math.pi, 721)[1:-1]
        theta = np.r_[theta, beyond]
    first, last = hole_gap(system, before, theta)[0], hole_gap(system, after, theta)[0]
    size = max(float(np.abs(first).max()), float(np.abs(last).max()), 1e-300)
    rows = np.column_stack([first - last, np.cos(theta), np.sin(theta)]) / size
    optimum = optimize.linprog([-1.0, 0.0, 0.0], rows, first / size, bounds=[(0.0, 1.0), (None, None), (None, None)])
    if not optimum.success:  # the hole is too narrow already
        place = place_between(system, before)
        gap = first[: system.grid.size] + system.drive.translation[: system.grid.size] @ place
        return 0.0, place, _lowest_places(system, gap)
    if optimum.x[0] >= 1.0:
        return None
    held = np.flatnonzero(optimum.ineqlin.marginals < -1e-9)
    if held.max() >= system.grid.size:
        raise ArcError("the hole grips the pin outside the arc; give a wider one, or none")
    place = optimum.x + np.linalg.lstsq(rows[held], first[held] / size - rows[held] @ optimum.x)[0]  # to all digits
    # Opposite nodes leave the pin free across. Then it stays as near to the middle as it can.
    left = first[held] / size - rows[held, 0] * place[0]
    across = np.r_[place[0], np.linalg.lstsq(rows[held, 1:], left, rcond=SLIGHT)[0]]
    if np.all(rows @ across <= first / size + 1e-12):
        place = across
    return float(np.clip(place[0], 0.0, 1.0)), place[1:], held


def _first_patch(system: System, resting: Configuration, way: Way, most_part: float) -> tuple[Configuration, float]:
    """Make one implicit increment from rest to a load whose contact spans a few nodes.

    Friction in one increment would leave a shear in these nodes that does not follow from the load path. So the nodes
    begin without shear, and stick. Three cases need the friction: a moment; a pin that only the remote stress holds;
    and a neat fit. In a neat fit all grows in proportion to the load, and the increment is exact.

    `most_part` is the largest part of the rest of the step that the increment may take, unless everything grows in
    proportion or the hole closes on the pin all round. Returned are the configuration and the fraction of the step at
    which it holds.
    """
    begins, before, after, has_slip = way
    patches = len(runs(system.grid, resting.closed))
    least, most = 2 * patches, 4 * patches  # closed nodes that the first contact aims at
    wanted = 0.5 * (least + most)
    self_similar = _is_self_similar(system, resting, way)
    left = (1.0 - begins) * (after - before)
    conforming = np.ptp(resting.gap) <= _rounding(system)  # the hole closes on the pin all round
    part = 1.0 if self_similar else CONFORMING_PART if conforming else _hertz_part(system, resting, left)
    most_part = 1.0 if self_similar or conforming else most_part
    driven, best, wide = system.drive.has_displacements, None, min(part, most_part)
    by_hertz = wide < most_part and not (conforming or driven or system.problem.gap or after[list(REMOTE)].any())
    part = max(0.36 * wide, ROUNDED) if by_hertz else wide  # three nodes in place of five: the width squared
    low, high = 0.0, math.inf  # parts with too few nodes, and with too many
    for _ in range(60):
        fraction = begins + part * (1.0 - begins)
        load = before + fraction * (after - before)
        pinched = not driven and not is_pushed(load)
        rough = self_similar or pinched or (system.problem.rotation == "free" and load[M] != 0.0)
        found = one_step(system, resting, load, self_similar) if rough else shearless_step(system, resting, load)
        if by_hertz and (found is None or found.closed.sum() != wanted):  # it is another contact: come from a wider one
            by_hertz, part = False, wide
            continue
        if found is None or worst_residual(system, found) > MAX_RESIDUAL:
            if self_similar:  # smaller loads have the same statuses
                break
            part *= 0.7
            continue
        count = int(found.closed.sum())
        if driven and count == 0 and part < most_part:  # the overlap lies between two nodes
            part = min(4.0 * part, most_part)
            continue
        if best is None or (count < least, abs(count - wanted)) < (best[0] < least, abs(best[0] - wanted)):
            best = (count, found, fraction)
        if self_similar or least <= count <= most or (count < least and part == most_part):
            break
        low, high = (part, high) if count < least else (low, part)
        part *= min(max((wanted / max(count, 1)) ** 2, 0.05), 10.0)
        if not low < part < high:  # in a worn hole many nodes close at once
            part = math.sqrt(low * high)
        part = min(max(part, ROUNDED), most_part)
    if best is None or (driven and best[0] == 0):
        raise ResolutionError(NARROW)
    count, found, fraction = best
    if count < least and most_part < 1.0:
        raise ResolutionError(NARROW)
    if reaches_end(system, found):
        raise ArcError(CUT_OFF)
    begin = None if rough else before + begins * (after - before)
    return _begun(system, resting, found, begin, has_slip), fraction


def _begun(
    system: System, resting: Configuration, found: Configuration, begin: np.ndarray | None, has_slip: bool = True
) -> Configuration:
    """The first patch `found` with its slip tally, dissipation and work since the pin was at rest.

    `begin` is the load (loads,) at which the contact begins, for the slip of a patch without shear; None for others.
    Without `has_slip` nobody asks for energies either.
    """
    if begin is not None and not has_slip:
        return found
    dissipated = dissipation_between(system, resting, found)
    if begin is None:
        begun = slip_tally_with(resting.changed(status=found.status))  # its nodes slip from there on
        found.slip_tally = slip_tally_between(resting.changed(slip_tally=begun), found)
    elif has_slip and system.has_friction:
        found = _with_grown_slip(system, found, begin) or found
    found.dissipation += dissipated
    found.seat_dissipation += seat_dissipation_between(system, resting, found)
    found.work += review(system, found).energy + dissipated
    return found


def _is_self_similar(system: System, resting: Configuration, way: Way) -> bool:
    """Whether everything grows in proportion to the load, as in a neat fit without loads before."""
    begins, before, after, _ = way
    is_neat = system.is_neat
    if system.problem.gap and begins == 0.0:  # it may be neat beside the middle
        is_neat = bool(resting.gap.max() <= _rounding(system))
    return is_neat and not presses(before) and bool(before[FRICTION_CHANGE] == after[FRICTION_CHANGE])


def _with_grown_slip(system: System, patch: Configuration, begin: np.ndarray) -> Configuration | None:
    """The first patch with the slip that its nodes would have if the contact had grown to them from a point.

    A young contact grows in proportion: nodes at a distance x from the first node stick with a slip (c_0 + c_1 x) x^2,
    on either side. The path is followed on trial, in the direction of the load, until the contact has
    :data:`GROWN_NODES` nodes. Those 4 to 6 nodes from the first one then give the two numbers of their side.

    `begin` is the load at which the contact begins. Returns None if those nodes do not all stick.
    """
    nodes = _young_nodes(system, patch)
    young, small = (system, patch) if nodes is None else (system.part(nodes), patch.part(nodes))
    slip = _grown_slip(young, small, begin)
    step = None if slip is None else one_step(young, small.changed(slip=slip), patch.load)
    if step is None or nodes is None:
        return step if step is None or worst_residual(system, step) <= MAX_RESIDUAL else None
    status, held = np.full(system.grid.size, OPEN, dtype=np.int8), patch.slip.copy()
    status[nodes], held[nodes] = step.status, slip
    solution = solve_statuses(system, status, held, patch.load, patch.rest_gap)
    if solution is None:
        return None
    found = accept_solution(patch.changed(slip=held), solution, patch.load)
    return found if worst_residual(system, found) <= MAX_RESIDUAL else None


def _young_nodes(system: System, patch: Configuration) -> np.ndarray | None:
    """The nodes round a young contact, on which the trial is followed; None for all nodes."""
    n, first = system.grid.size, int(np.argmax(patch.pressure))
    nodes = first + np.arange(-GROWN_NODES, GROWN_NODES + 1)
    nodes = nodes % n if system.grid.closed else nodes[(nodes >= 0) & (nodes < n)]
    whole = system.drive.has_displacements or n <= 8 * GROWN_NODES  # below, another table takes longer
    return None if whole or patch.closed[nodes].sum() != patch.closed.sum() else nodes


def _grown_slip(system: System, patch: Configuration, begin: np.ndarray) -> np.ndarray | None:
    """The slip (n,) of :func:`_with_grown_slip`; None if the nodes that tell it do not all stick."""
    n, places = system.grid.size, runs(system.grid, patch.closed)
    firsts = [int(place[np.argmax(patch.pressure[place])]) for place in places]
    sizes = []
    for place, first in zip(places, firsts, strict=True):
        room = GROWN_NODES if system.grid.closed else 2 * min(first, n - 1 - first) - BESIDE_END
        sizes.append((min(GROWN_NODES, room) / place.size) ** 2)
    growth = min(sizes)
    if growth < 1.0:
        return None
    after, memory = begin + growth * (patch.load - begin), TableauMemory(system)
    try:
        found = follow_whole(system, patch, after, memory)
        grown = PathStep(system, patch, after, memory).follow(1.0) if found is None else found.now
    except StepLostError:
        return None
    new = patch.slip.copy()
    for first in firsts:  # places that touch together grow alike, so a mirror image stays one
        if not _set_slip_beside(system, patch, grown, first, new):
            return None
    return new


def _set_slip_beside(system: System, patch: Configuration, grown: Configuration, first: int, new: np.ndarray) -> bool:
    """Set the slip `new` (n,) of the nodes beside the `first` node of a place, from the contact grown on trial.

    Returns whether the nodes that tell it all stick.
    """
    n = system.grid.size
    # Remote stress and prescribed displacements have moved the pin along the hole before.
    rest = patch.rest_slip - patch.rest_slip[first]
    for sense in (-1, 1):
        fitted, inner = first + sense * np.arange(4, 7), first + sense * np.arange(1, 4)
        if system.grid.closed:
            fitted, inner = fitted % n, inner % n
        elif fitted.min() < 0 or fitted.max() >= n:
            return False
        if np.any(grown.status[fitted] != STICK) or grown.status[first] != STICK:
            return False
        away = angle_between(system.grid.theta[fitted], system.grid.theta[first])
        slip = (grown.slip[fitted] - grown.slip[first] - rest[fitted]) / away**2
        beside, mean = away - away.sum() / away.size, slip.sum() / away.size  # the line of least squares
        linear = float(beside @ slip) / float(beside @ beside)
        constant = mean - linear * away.sum() / away.size
        inner = inner[patch.closed[inner]]
        away = angle_between(system.grid.theta[inner], system.grid.theta[first])
        new[inner] = patch.slip[first] + rest[inner] + (constant + linear * away) * away**2
    return True


def _hertz_part(system: System, resting: Configuration, change: np.ndarray) -> float:
    """A first guess: the part of the step's load at which a contact spans about five nodes.

    A force presses a Hertz contact. A hole that shrinks on the pin overlaps the pin by half the curvature times the
    square of the contact's half-width.
    """
    force = float(np.hypot(change[Q], change[P]))
    nearest, n, weights = _nearest(system, resting), system.grid.size, system.grid.weights
    theta = system.grid.theta[nearest]
    gap = hole_gap(system, resting.load, theta)[0]
    if system.grid.uniform:
        spacing = float(np.sort(weights)[n // 2])  # the hats at the ends of an arc are halves
    else:
        beside = np.arange(nearest - FIRST_BESIDE, nearest + FIRST_BESIDE + 1)
        spacing = float(weights[beside % n if system.grid.closed else beside.clip(0, n - 1)].mean())
    half = 2.5 * spacing
    bent = max(bend(system, resting.load, theta, half), 0.0)
    if force == 0.0:
        shrinking = float(gap - hole_gap(system, resting.load + change, theta)[0])
        shrinking += float(change[UX] * math.cos(theta) + change[UY] * math.sin(theta))
        part = 0.5 * bent * half**2 / shrinking if shrinking > 0.0 else ROUNDED
    else:
        part = math.pi * bent * half**2 / force
    return min(max(part, ROUNDED), 1.0)


def _steady_part(system: System, resting: Configuration, change: np.ndarray) -> float:
    """The part of a change of the load that changes the hole's curvature against the pin's by a tenth at most."""
    if system.bodies is None and not change[SHAPING].any():
        return 1.0
    theta = system.grid.theta
    gap, _, curvature = hole_gap(system, resting.load, theta)
    later, _, bent = hole_gap(system, resting.load + change, theta)
    here = max(float((gap + curvature)[_nearest(system, resting)]), 0.0)
    changed = float(np.abs(later + bent - gap - curvature).max())
    most = 0.1 * here
    return 1.0 if changed <= most else max(most / changed, ROUNDED)


def _nearest(system: System, resting: Configuration) -> int:
    """The node at which the resting pin touches the hole. Of several nodes it is the one where the hole bends least.

    A gripped pin touches three nodes. Rounding would choose another one of them in a mirror image.
    """
    touching = np.flatnonzero(resting.gap - resting.gap.min() <= SLIGHT * resting.gap.max())
    gap, _, curvature = hole_gap(system, resting.load, system.grid.theta[touching])
    return int(touching[np.argmin(gap + curvature)])

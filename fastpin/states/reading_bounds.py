"""Bounds of the readings of many states, from their nodal values at once.

A reading lies between its bounds, whatever the fits between the nodes find. Pressure, shear and widths have bounds that
follow from the way in which they are read. The bounds of the hoop stress, :class:`HoopDoubts`, and of the largest
shear of like bodies, :func:`shear_bounds`, were measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.elasticity.tractions import Tractions
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.angles import angle_between, distinct
from fastpin.model.grid import Grid
from fastpin.model.loads import FRICTION_CHANGE, LOADS, STRESSING
from fastpin.model.points import Body
from fastpin.model.problem import Problem
from fastpin.reading.exponents import Coupling
from fastpin.reading.hoop import AROUND, LEAST_NODES
from fastpin.reading.joint import AROUND as AROUND_BUSH
from fastpin.reading.outline import outline_hoop
from fastpin.reading.peaks import DROP_NODES, LARGEST_FALL, STEEPEST_RISE
from fastpin.reading.stress import stress_components
from fastpin.states.stress_map import StressMap, spacings
from fastpin.states.yielding import PREFIX, Places

NUMBERS = ("dx", "dy", "rotation", "dissipation", "work")
"""Quantities that a state holds as numbers."""

ROUNDING = 1e-8
"""Relative size of rounding, and of equal peaks of which one is taken."""

MAPPED = 40
"""Different states from which on the stresses of straight lines are computed by matrices. Fewer are all read."""

Pair = tuple[np.ndarray, np.ndarray]
"""Lower and upper bounds, shape (k,) each."""

Nodal = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Pressure, shear and status of the nodes of an interface, shape (k, n) each."""


class StateBlock(NamedTuple):
    """Nodal values and numbers of some states.

    Attributes
    ----------
    pressure, shear, status : ndarray, shape (k, n)
    loads : ndarray, shape (k, loads)
    marks : tuple of ndarray, shape (k, n)
        The arrays of :class:`fastpin.reading.marks.Marks`; empty if the states have none.
    numbers : dict of str to ndarray, shape (k,)
        Of :data:`NUMBERS`, and "seat_slip" of states with a seat.
    seat : StateBlock or None
        The states of the seat of a bush that slips.
    """

    pressure: np.ndarray
    shear: np.ndarray
    status: np.ndarray
    loads: np.ndarray
    marks: tuple[np.ndarray, ...]
    numbers: dict[str, np.ndarray]
    seat: StateBlock | None = None

    def nodal(self, rows: list[int]) -> Nodal:
        """Pressure, shear and status of the nodes in some of the states."""
        return self.pressure[rows], self.shear[rows], self.status[rows]

    @property
    def read_parts(self) -> list[np.ndarray]:
        """The arrays (k, ...) on which readings depend that are no stored numbers."""
        own = [self.pressure, self.shear, self.status, self.loads, *self.marks]
        own += [self.numbers[name] for name in ("dx", "dy")]
        return own if self.seat is None else own + self.seat.read_parts


class Bounds:
    """Bounds of the readings of different states, which come in blocks.

    Parameters
    ----------
    problem : Problem
    grid : Grid
    names : set of str
        The quantities. Those without bounds are unbounded.
    """

    def __init__(self, problem: Problem, grid: Grid, names: set[str]) -> None:
        self._problem, self._grid, self._names = problem, grid, names - set(NUMBERS)
        self._friction, self._coupled = problem.friction_at(grid.theta), not _coupling(problem, grid).is_smooth
        self._found: dict[str, list[Pair]] = {name: [] for name in self._names}
        # What other pins of a joint do to the hole differs from state to state: its stresses have no bounds.
        self._is_alone = problem.plate_body.without_others is problem.plate_body
        self._stresses = StressBounds(problem, grid, names if self._is_alone else set())
        self._waiting: list[tuple[list[Nodal], np.ndarray]] = []  # until so many states make the matrices worth while
        self._count = 0

    def add(self, block: StateBlock, rows: list[int]) -> None:
        """Take these rows of a block."""
        pressure, shear, status = block.nodal(rows)
        peaks = pressure_bounds(self._grid, pressure, self._coupled)
        factor = 1.0 + block.loads[rows][:, FRICTION_CHANGE]
        most = factor * self._problem.most_friction
        reserve = factor[:, None] * self._friction * pressure - np.abs(shear)
        # Nodes that truly stick, see :func:`fastpin.reading.old_borders.truly_sticking`.
        sticks = (status == STICK) & (reserve > 1e-9 * reserve.max(axis=1, initial=0.0)[:, None])
        known: dict[str, Callable[[], Pair]] = {
            "peak_pressure": lambda: peaks,
            "peak_shear": lambda: shear_bounds(shear, most * peaks[1], self._coupled),
            "contact_width": lambda: width_bounds(self._grid, status != OPEN),
            "stick_width": lambda: width_bounds(self._grid, sticks),
        }
        if self._is_alone:
            known["peak_hoop_outline"] = lambda: outline_bounds(self._problem, self._grid, block, rows)
        for name in self._names - self._stresses.names:
            self._found[name].append(known[name]() if name in known else _unbounded(len(rows)))
        if self._stresses.names:
            interfaces = [each.nodal(rows) for each in (block, block.seat) if each is not None]
            self._waiting.append((interfaces, block.loads[rows][:, list(STRESSING)]))
            self._count += len(rows)
            if self._count > MAPPED:  # the matrices are worth while: compute the bounds of all waiting states
                for interfaces, remote in self._waiting:
                    for name, pair in self._stresses.of(interfaces, remote).items():
                        self._found[name].append(pair)
                self._waiting = []

    def found(self) -> dict[str, Pair]:
        """Return the bounds of all states by quantity."""
        for name in self._stresses.names if self._waiting else ():
            self._found[name].append(_unbounded(self._count))
        self._waiting = []
        return {
            name: (np.concatenate([low for low, _ in pairs]), np.concatenate([high for _, high in pairs]))
            for name, pairs in self._found.items()
        }


def _coupling(problem: Problem, grid: Grid) -> Coupling:
    """How the surfaces couple pressure and shear at the nodes, without changes of the friction."""
    return Coupling.of(problem, problem.friction_at(grid.theta), grid.theta)


def _unbounded(count: int) -> Pair:
    return np.full(count, -math.inf), np.full(count, math.inf)


# -- pressure, shear, widths -------------------------------------------------------------------------------------


def pressure_bounds(grid: Grid, pressure: np.ndarray, coupled: bool) -> Pair:
    """Bounds of the peak pressure, from the parabola through the largest node and its neighbours.

    Parameters
    ----------
    grid : Grid
    pressure : ndarray, shape (k, n)
    coupled : bool
        Whether a peak that is not smooth may be a corner, see :func:`fastpin.reading.peaks.pressure_peak`.
    """
    before, after = spacings(grid)
    top = pressure.max(axis=1, initial=0.0)
    drops = [np.maximum(pressure - np.roll(pressure, side, axis=1), 0.0) for side in (1, -1)]
    slope = drops[0] * (after / before) - drops[1] * (before / after)
    bend = (before + after) * (drops[0] / before + drops[1] / after)
    rise = slope**2 / np.where(bend > 0.0, 4.0 * bend, math.inf)
    highest = pressure >= (1.0 - ROUNDING) * top[:, None]
    if coupled:
        # A corner rises by the larger drop beside it at most: by 0.15 of it in 606 random states of unlike bodies.
        rise = np.maximum(rise, np.maximum(*drops))
    high = (1.0 + ROUNDING) * (top + np.where(highest, rise, 0.0).max(axis=1, initial=0.0))
    return (1.0 - ROUNDING) * top, high


def shear_bounds(shear: np.ndarray, most: np.ndarray, coupled: bool) -> Pair:
    """Bounds of the shear traction of largest magnitude, with its sign.

    A peak lies above its node by no more than the largest drop beside the node, see
    :func:`fastpin.reading.peaks.shear_peak`. Of like bodies the traction is smooth on one side of a cusp, where it
    drops less, and the cusp rises by at most twice that drop. It was up to 1.12 times in 390 random states of like
    bodies, and up to 0.88 in a history with 550 corners.

    Parameters
    ----------
    shear : ndarray, shape (k, n)
    most : ndarray, shape (k,)
        Upper bound of the magnitude by Coulomb's law.
    coupled : bool
        Whether the surfaces couple pressure and shear.
    """
    size = np.abs(shear)
    lowest = size.copy()
    for step in range(1, DROP_NODES + 1):
        for side in (step, -step):
            np.minimum(lowest, np.roll(size, side, axis=1), out=lowest)
    rise = STEEPEST_RISE * (size - lowest)
    if not coupled:
        one, two = (size - np.roll(size, side, axis=1) for side in (-1, 1))
        sides = np.maximum(one, np.roll(one, -1, axis=1)), np.maximum(two, np.roll(two, 1, axis=1))
        rise = np.minimum(rise, 2.0 * np.maximum(np.minimum(*sides), 0.0))
    highest = size + rise
    cap = (1.0 + ROUNDING) * most
    least = (1.0 - LARGEST_FALL - ROUNDING) * size.max(axis=1, initial=0.0)
    positive, negative = (
        np.minimum(np.where(sign * shear > 0.0, highest, 0.0).max(axis=1, initial=0.0), cap) for sign in (1.0, -1.0)
    )
    return np.where(negative >= least, -negative, least), np.where(positive >= least, positive, -least)


def outline_bounds(problem: Problem, grid: Grid, block: StateBlock, rows: list[int]) -> Pair:
    """Bounds of the largest hoop stress along the outline of a plate in some states of a block: the value itself."""
    if problem.seat is not None and block.seat is not None:
        return outline_bounds(problem.seat, seat_grid(problem, grid), block.seat, rows)
    loads = block.loads[rows][:, list(STRESSING)]
    found = outline_hoop(problem, grid, block.pressure[rows], block.shear[rows], loads).hoop
    slack = ROUNDING * np.abs(found).max(axis=1, initial=0.0)
    top = found.max(axis=1, initial=-math.inf)
    return top - slack, top + slack


def width_bounds(grid: Grid, inside: np.ndarray) -> Pair:
    """Bounds of the length of zones, rad. An end lies within a node distance of its outermost node.

    Parameters
    ----------
    grid : Grid
    inside : ndarray of bool, shape (k, n)
        Nodes in the zones.
    """
    before, after = spacings(grid)
    joined = inside & np.roll(inside, -1, axis=1)
    if not grid.closed:
        joined[:, -1] = False
    length = joined @ after
    slack = (inside & ~np.roll(joined, 1, axis=1)) @ np.maximum(before, after)
    slack += (inside & ~joined) @ np.maximum(before, after)
    slack += ROUNDING
    return np.maximum(length - slack, 0.0), length + slack


# -- stresses ------------------------------------------------------------------------------------------------------


class StressBounds:
    """Bounds of the readings of the stress: hoop stresses round hole and seat, von Mises stresses, interface of a bush.

    With a bush that slips, bush and plate depend on the tractions at the pin and in the seat.

    Parameters
    ----------
    problem : Problem
        Its plate is not rigid if a reading of the plate is asked for.
    grid : Grid
    names : set of str
        The readings.
    """

    HOOP, SEAT = "peak_hoop", "peak_hoop_seat"
    BUSH = ("bush_open_margin", "bush_least_friction")

    def __init__(self, problem: Problem, grid: Grid, names: set[str]) -> None:
        seats = [] if problem.seat is None else [seat_grid(problem, grid)]
        self._problem, self._grids = problem, [grid, *seats]
        owners = sorted(name for name in names if name.startswith(PREFIX))
        self._places = {name: Places.of(problem, grid, name.removeprefix(PREFIX)) for name in owners}
        bonded = self.BUSH if problem.seat is None else ()
        self.names = names & {self.HOOP, self.SEAT, *bonded, *owners}

    def of(self, interfaces: list[Nodal], remote: np.ndarray) -> dict[str, Pair]:
        """Return the bounds for tractions and status of the nodes of each interface, and loads of the plate (k, 4)."""
        tractions = [(pressure, shear) for pressure, shear, _ in interfaces]
        self._map.learn(tractions)

        def part(name: str, which: int) -> np.ndarray:
            return self._map.component(which, tractions, remote, self._points[name])

        found = {}
        for name, places in self._places.items():
            stress = np.array([part(name, which) for which in range(3)])
            top = places.von_mises(self._problem, stress).max(axis=1)
            slack = ROUNDING * np.abs(stress).max(axis=(0, 2))
            found[name] = top - slack, top + slack
        if self.HOOP in self.names:
            doubts = [each.of(*nodal) for each, nodal in zip(self._doubts, interfaces, strict=True)]
            found[self.HOOP] = _hoop_bounds(part(self.HOOP, 1), doubts)
        if self.SEAT in self.names and self._problem.seat is not None:
            found[self.SEAT] = _hoop_bounds(part(self.SEAT, 1), [self._seat_doubts.of(*interfaces[1])])
        elif self.SEAT in self.names:
            hoop = part(self.SEAT, 1)  # at equally spaced points
            bends = np.abs(np.roll(hoop, 1, axis=1) - 2.0 * hoop + np.roll(hoop, -1, axis=1)).max(axis=1)
            # Beyond straight lines the stress was up to 0.002 of its range in 138 random states of 23 bushes.
            slack = bends + 0.02 * np.ptp(hoop, axis=1) + ROUNDING * np.abs(hoop).max(axis=1)
            top = hoop.max(axis=1)
            found[self.SEAT] = (top - slack, top + slack) if self._is_thick else _unbounded(len(hoop))
        if self.names & {*self.BUSH}:
            found |= zip(self.BUSH, _interface_bounds(-part("bush", 0), part("bush", 2)), strict=True)
        return {name: found[name] for name in self.names}

    @cached_property
    def _map(self) -> StressMap:
        """The stress at the points of all readings, which :attr:`_points` tells apart. "bush" is a bush's interface."""
        problem, grid = self._problem, self._grids[0]
        sets: dict[str, tuple[Body, np.ndarray, np.ndarray]] = {name: at[:3] for name, at in self._places.items()}
        if self.HOOP in self.names:
            rim, both = _around_hole(grid), zip(problem.interfaces, self._grids, strict=True)
            self._doubts = [HoopDoubts(each, nodes, rim) for each, nodes in both]
            sets[self.HOOP] = "plate", rim, np.zeros(rim.size)
        if self.SEAT in self.names and problem.seat is not None:
            rim = _around_hole(self._grids[1])
            self._seat_doubts = HoopDoubts(problem.seat, self._grids[1], rim)
            sets[self.SEAT] = "seat", rim, np.zeros(rim.size)
        elif self.names & {self.SEAT, *self.BUSH} and problem.plate_body.bush is not None:
            wall = problem.plate_body.bush.outer_radius / problem.hole_radius - 1.0
            self._is_thick = wall > 4.0 * float(grid.weights.max())  # a thinner wall does not smooth the tractions
            # Behind a wall of a tenth of the hole radius the tractions are smooth over four points.
            theta = (2.0 * math.pi * np.arange(AROUND_BUSH) / AROUND_BUSH)[:: 4 if wall > 0.1 else 1]
            if self.names & {*self.BUSH}:
                sets["bush"] = "plate", theta, np.full(theta.size, wall)
            if self.SEAT in self.names:
                sets[self.SEAT] = "seat", theta, np.zeros(theta.size)
        ends = np.cumsum([0, *(theta.size for _, theta, _ in sets.values())]).tolist()
        self._points = {name: slice(*pair) for name, pair in zip(sets, pairwise(ends), strict=True)}

        def stress(tractions: list[Tractions], remote: np.ndarray) -> np.ndarray:
            load, (of_pin, *of_seat) = {LOADS[STRESSING[k]]: float(value) for k, value in enumerate(remote)}, tractions
            return np.concatenate(
                [
                    stress_components(problem, of_pin, load, (theta, depth), body, *of_seat)
                    if of_pin.patches or body != "pin"  # a pin without tractions has no stress
                    else np.zeros((3, theta.size))
                    for body, theta, depth in sets.values()
                ],
                axis=1,
            )

        return StressMap(problem, self._grids, stress)


def _around_hole(grid: Grid) -> np.ndarray:
    """Angles round the hole, the nodes, and the middles between them."""
    around = math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    return distinct(np.remainder(np.r_[around, grid.theta, grid.theta + 0.5 * grid.weights], 2.0 * math.pi))


class HoopDoubts:
    """Bounds of the hoop stress beyond straight lines between the nodes, from the bends of the tractions at the nodes.

    Power laws replace straight lines where the tractions bend, and change the stress there and less beside. So the
    bends at a node, and :attr:`OF_PRESSURE` of those of the pressure, fade with 1/(1 + x/:attr:`FADES`) in the distance
    x in node distances. Their sum counts :attr:`DOUBT`. It counts :attr:`MILD_DOUBT` where exponents differ from 1/2 by
    :attr:`MILD` at most and :data:`LEAST_NODES` nodes or more are closed. Between two points the stress of straight
    lines rises by :attr:`BETWEEN` of their difference at most.

    These bounds were measured. The sum had to count up to 0.43 and 0.23 in 1,100 random states of all classes of
    tests/survey/histories.py with 61 to 201 nodes, and up to 0.19 in a history with 550 corners.

    Parameters
    ----------
    problem : Problem
    grid : Grid
    theta : ndarray, shape (m,)
        Angles, rad.
    """

    DOUBT, MILD_DOUBT, MILD = 0.9, 0.45, 0.15
    FADES, OF_PRESSURE, BETWEEN = 2.0, 0.25, 1.5

    def __init__(self, problem: Problem, grid: Grid, theta: np.ndarray) -> None:
        away = np.abs(angle_between(theta, grid.theta[:, None])) / grid.weights[:, None]
        self._weights = 1.0 / (1.0 + away / self.FADES)
        self._is_mild = bool(np.abs(_coupling(problem, grid).tilt).max() <= self.MILD)

    def of(self, pressure: np.ndarray, shear: np.ndarray, status: np.ndarray) -> np.ndarray:
        """Return the bounds at the angles, shape (k, m), for tractions and status of the nodes (k, n)."""
        is_mild = ((status != OPEN).sum(axis=1) >= LEAST_NODES) & self._is_mild
        doubt = np.where(is_mild, self.MILD_DOUBT, self.DOUBT)[:, None]
        return np.asarray((doubt * (_bends(shear) + self.OF_PRESSURE * _bends(pressure))) @ self._weights)


def _bends(values: np.ndarray) -> np.ndarray:
    """Second differences of nodal values (k, n), over one node distance and over two."""
    one, two = (np.abs(np.roll(values, k, axis=1) - 2.0 * values + np.roll(values, -k, axis=1)) for k in (1, 2))
    return np.asarray(one + 0.5 * two)


def _hoop_bounds(straight: np.ndarray, doubts: list[np.ndarray]) -> Pair:
    """Bounds of the largest hoop stress, from straight lines (k, m), and the doubts of each interface (k, m)."""
    drop = straight - np.minimum(np.roll(straight, 1, axis=1), np.roll(straight, -1, axis=1))
    slack = ROUNDING * np.abs(straight).max(axis=1)[:, None] + sum(doubts)
    return (straight - slack).max(axis=1), (straight + HoopDoubts.BETWEEN * np.maximum(drop, 0.0) + slack).max(axis=1)


def _interface_bounds(normal: np.ndarray, along: np.ndarray) -> tuple[Pair, Pair]:
    """Bounds of the least pressure and the least friction at the interface of a bonded bush.

    `normal` and `along` are pressure and shear at equally spaced points, shape (k, m). Between the points they differ
    by a part of their second differences.
    """
    slack = np.zeros(len(normal))
    for values in (normal, along):
        bends = np.abs(np.roll(values, 1, axis=1) - 2.0 * values + np.roll(values, -1, axis=1)).max(axis=1)
        slack += 0.5 * bends + ROUNDING * np.abs(values).max(axis=1)
    size, least = np.abs(along), normal.min(axis=1)
    open_pair = least - slack, least + slack
    wide = slack[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        high = np.where(least > slack, ((size + wide) / np.maximum(normal - wide, 0.0)).max(axis=1), math.inf)
        ratios = np.maximum(size - wide, 0.0) / np.maximum(normal + wide, 0.0)
    return open_pair, (np.nan_to_num(ratios, nan=0.0).max(axis=1), high)

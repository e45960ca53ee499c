"""Wider arcs of nodes: the present nodes stay where they are, and new nodes continue their spacing.

A contact that was followed on an arc goes on there. :class:`OutsideGap` notices a pin that touches beyond the arc.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem
from fastpin.elasticity.system import System
from fastpin.model.angles import angle_between
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import REMOTE
from fastpin.model.problem import Problem
from fastpin.solver.configuration import Configuration, embedded
from fastpin.solver.interfaces import part_of
from fastpin.solver.repeats import Repeats
from fastpin.solver.result import Restart
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.solver.window import PENETRATION

MOST_TIMES = 4
"""Times the first nodes that a grown grid may have. A step then takes ten to sixty times as long."""

MOST_GROWN = 3000
"""Nodes of a grown grid, at most. Its matrices then take up to a gigabyte, and a step takes seconds."""

GROWTH = 0.25
"""Part of its nodes by which an arc grows at an end that the contact reaches."""

LEAST_GROWTH = 8
"""Nodes by which it grows there, at least."""

NEAR_END = 0.125
"""Part of the nodes of an arc. A contact nearer to an end than this has reached the end."""

MOST_OUTSIDE = 180
"""Angles beyond an arc at which the gap is watched, at most: every two degrees for a short arc."""


def dividing_the_circle(grid: Grid, node_at: float | None) -> Grid:
    """An arc whose spacing divides the circle, so that it can grow to the whole circle. Other grids stay.

    The arc is longer by less than one spacing. The node nearest to the angle `node_at`, rad, stays in its place; the
    first one without an angle.
    """
    if grid.closed or not grid.uniform:
        return grid
    n, spacing = grid.size, _spacing(grid)
    whole = max(math.floor(2.0 * math.pi / spacing), n)
    fixed = 0 if node_at is None else int(np.argmin(np.abs(angle_between(grid.theta, node_at))))
    return Grid(grid.theta[fixed] + (2.0 * math.pi / whole) * (np.arange(n) - fixed))


def _spacing(grid: Grid) -> float:
    return float(grid.theta[-1] - grid.theta[0]) / (grid.size - 1)


def most_nodes(first: int) -> int:
    """Nodes of a grown grid, at most, from a grid of `first` nodes."""
    return min(MOST_TIMES * first, MOST_GROWN)


def wider_grid(grid: Grid, closed: np.ndarray, most: int, all_round: bool = False) -> Grid | None:
    """The next wider grid with the same nodes, and more nodes in the same spacing.

    Parameters
    ----------
    grid : Grid
        An arc.
    closed : ndarray of bool, shape (n,)
        The nodes in contact. The arc grows at the end that they have reached; at both ends if they have reached none.
    most : int
        Nodes of the wider grid, at most.
    all_round : bool
        Whether only the whole circle is wide enough.

    Returns
    -------
    Grid or None
        None if it has more than `most` nodes, or if it is the whole circle and the spacing does not divide that.
    """
    n, theta = grid.size, grid.theta
    if not grid.uniform:
        return None
    spacing, inside = _spacing(grid), np.flatnonzero(closed)
    rooms = np.array([inside[0], n - 1 - inside[-1]]) if inside.size else np.zeros(2)
    reached = rooms <= NEAR_END * n
    more = np.where(reached | ~reached.any(), max(int(GROWTH * n), LEAST_GROWTH), 0)
    whole = round(2.0 * math.pi / spacing)
    is_circle = all_round or n + more.sum() + LEAST_GROWTH >= whole
    if is_circle:
        more = np.array([(whole - n) // 2, whole - n - (whole - n) // 2])
    if n + more.sum() > most:
        return None
    before, after = (spacing * np.arange(1, count + 1) for count in more)
    found = Grid(np.r_[theta[0] - before[::-1], theta, theta[-1] + after], closed=is_circle)
    return found if found.uniform else None


def carried(old: System, new: System, restart: Restart) -> Restart:
    """A restart of the system `old` for the system `new` on a wider grid. The new nodes are open.

    Remembered configurations are left out.
    """
    now, n, total = restart.configuration, old.grid.size, new.grid.size
    nodes = int(np.argmin(np.abs(new.grid.theta - old.grid.theta[0]))) + np.arange(n)
    fresh = np.setdiff1d(np.arange(total), nodes)
    rest_gap, rest_slip = np.zeros((2, total))
    rest_gap[fresh] = rest_gap_at(old, now, new.grid.theta[fresh])
    rest_slip[fresh] = _rest_slip_at(old, now, new.loads[total + fresh])
    wider, _ = embedded(new, now, nodes, rest_gap, rest_slip, SlipTally.empty(total))
    return replace(restart, configuration=wider, repeats=Repeats(), marks={}, slip_tally=NOT_COUNTED)


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


def _rest_slip_at(system: System, now: Configuration, columns: np.ndarray) -> np.ndarray:
    """The slip when the pin came to rest, shape (k,), at new nodes.

    `columns` (k, loads) is the slip of the new nodes per unit of each load.
    The slip at rest is the slip of some load and a rotation. The load is not remembered, but the slip at the other
    nodes tells it.
    """
    slip = now.rest_slip
    if np.ptp(slip) == 0.0:  # without remote stress
        return np.full(len(columns), slip[0])
    known = np.column_stack([system.loads[system.grid.size :], np.ones(slip.size)])
    found: np.ndarray = np.column_stack([columns, np.ones(len(columns))]) @ np.linalg.lstsq(known, slip)[0]
    return found


class OutsideGap:
    """The gap beyond an arc of nodes, at up to :data:`MOST_OUTSIDE` angles: a pin may touch there too.

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
        count = min(math.ceil((ends[1] - ends[0]) / _spacing(grid)) - 1, MOST_OUTSIDE)
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
        return lowest < 0.0 and lowest < -PENETRATION * float(max(np.abs(elastic).max(), np.abs(moved).max()))

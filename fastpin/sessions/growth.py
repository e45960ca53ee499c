"""Wider arcs of nodes: the present nodes stay where they are, and new nodes continue their spacing.

A contact that was followed on an arc goes on there. :class:`LatestState` notices a pin that touches beyond the arc.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fastpin.elasticity.system import System
from fastpin.model.angles import angle_between
from fastpin.model.grid import Grid
from fastpin.model.loads import named_load
from fastpin.solver.configuration import Configuration, embedded
from fastpin.solver.errors import ArcError
from fastpin.solver.repeats import Repeats
from fastpin.solver.rest import OutsideGap, node_spacing, rest_gap_at
from fastpin.solver.result import Restart
from fastpin.solver.run import Run
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.solver.solving import MemoryRecorder
from fastpin.states.state import State

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


def dividing_the_circle(grid: Grid, node_at: float | None) -> Grid:
    """An arc whose spacing divides the circle, so that it can grow to the whole circle. Other grids stay.

    The arc is longer by less than one spacing. The node nearest to the angle `node_at`, rad, stays in its place; the
    first one without an angle.
    """
    if grid.closed or not grid.uniform:
        return grid
    n, spacing = grid.size, node_spacing(grid)
    whole = max(math.floor(2.0 * math.pi / spacing), n)
    fixed = 0 if node_at is None else int(np.argmin(np.abs(angle_between(grid.theta, node_at))))
    return Grid(grid.theta[fixed] + (2.0 * math.pi / whole) * (np.arange(n) - fixed))


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
    spacing, inside = node_spacing(grid), np.flatnonzero(closed)
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


class LatestState(MemoryRecorder):
    """A recorder that keeps the latest state only, and notes whether the pin has touched the hole beyond the arc."""

    def __init__(self) -> None:
        super().__init__()
        self.outside: OutsideGap | None = None
        self.touched_outside = False

    def begin(self, run: Run) -> None:
        """Forget the state. From here on all states come from `run`."""
        super().begin(run)
        self.touched_outside = False
        if run.grid.closed:
            self.outside = None
        elif self.outside is None or self.outside.of is not run.system.operator:
            self.outside = OutsideGap(run.system)

    def add(self, state: State) -> None:
        """Keep a state in place of the one before."""
        self.states = [state]

    def corner_reached(self) -> None:
        """Look beyond the arc."""
        if self.outside is not None and not self.touched_outside:
            assert self.run is not None
            self.touched_outside = self.outside.is_closed(self.run.system, self.run.now)


def touches_outside(run: Run) -> ArcError:
    """The error of a run whose pin touches the hole beyond the arc."""
    message = f"step {run.corner}: the pin touches the hole beyond the arc"
    return ArcError(message, run.corner - 1, 1.0, named_load(run.load))

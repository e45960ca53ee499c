"""Contact edges, stick-slip borders and peaks, read between nodes.

A quantity that falls to zero like the square root of the distance to an edge has a square that is linear there: the
square is extrapolated to zero from the nodes inside. The outermost node came into the zone last and is not used.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fastpin.grid import Grid

if TYPE_CHECKING:
    from fastpin.state import State

Interval = tuple[float, float]


def runs(grid: Grid, mask: np.ndarray) -> list[np.ndarray]:
    """Index arrays of consecutive True nodes; on a circle a run may pass the last node."""
    n = grid.size
    if mask.all():
        return [np.arange(n)]
    inside = np.flatnonzero(mask)
    if inside.size == 0:
        return []
    parts = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
    if grid.closed and len(parts) > 1 and parts[0][0] == 0 and parts[-1][-1] == n - 1:
        parts[-1] = np.r_[parts[-1], parts[0]]
        parts = parts[1:]
    return parts


def intervals(grid: Grid, mask: np.ndarray, quantity: np.ndarray) -> list[Interval]:
    """Intervals of the zones in `mask`, at whose ends `quantity` (>= 0 inside) falls to zero."""
    if mask.all() and grid.closed:
        start = float(grid.theta[0])
        return [(start, start + 2.0 * math.pi)]
    zones = []
    for run in runs(grid, mask):
        theta = _unrolled(grid, run)
        left, right = grid.knots()
        start = _edge(theta, quantity[run], theta[0] - (grid.theta[run[0]] - left[run[0]]))
        stop = _edge(theta[::-1], quantity[run][::-1], theta[-1] + (right[run[-1]] - grid.theta[run[-1]]))
        zones.append((start, stop))
    return zones


def _unrolled(grid: Grid, run: np.ndarray) -> np.ndarray:
    theta = grid.theta[run].copy()
    theta[np.r_[False, np.cumsum(np.diff(run) < 0) > 0]] += 2.0 * math.pi
    return theta


def _edge(theta: np.ndarray, quantity: np.ndarray, outside: float) -> float:
    """Where `quantity` squared reaches zero, between the outermost node theta[0] and the next one `outside`."""
    if theta.size < 4:
        return 0.5 * (float(theta[0]) + outside)
    near, far = quantity[1] ** 2, quantity[2] ** 2
    if far <= near:
        return 0.5 * (float(theta[0]) + outside)
    edge = float(theta[1] - near * (theta[2] - theta[1]) / (far - near))
    low, high = min(outside, theta[0]), max(outside, theta[0])
    return float(min(max(edge, low), high))

"""Contact edges, stick-slip borders and peaks, read between nodes.

A quantity that falls to zero like the square root of the distance to an edge has a square that is linear there: the
square is extrapolated to zero from the nodes inside. The outermost nodes came into the zone last and are not used.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fastpin.grid import Grid

Interval = tuple[float, float]

MISFIT = 0.01
"""Largest deviation from the extrapolated parabola, in parts of its largest value."""


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
    left, right = grid.knots()
    zones = []
    for run in runs(grid, mask):
        theta = _unrolled(grid, run)
        start = _edge(theta, quantity[run], theta[0] - (grid.theta[run[0]] - left[run[0]]))
        stop = _edge(theta[::-1], quantity[run][::-1], theta[-1] + (right[run[-1]] - grid.theta[run[-1]]))
        zones.append((start, stop))
    return zones


def stick_intervals(
    grid: Grid, sticking: np.ndarray, reserve: np.ndarray, closed: np.ndarray, contact: list[Interval]
) -> list[Interval]:
    """Intervals of the stick zones, where `reserve` = mu N - |T| falls to zero or the contact ends.

    `contact` are the intervals of the `closed` nodes. A zone that reaches the outermost closed node ends with the
    contact: a slip zone without a node is none.
    """
    if closed.all() and grid.closed:
        return intervals(grid, sticking, reserve)
    zones = []
    outer = list(zip(runs(grid, closed), contact, strict=True))
    for run, (start, stop) in zip(runs(grid, sticking), intervals(grid, sticking, reserve), strict=True):
        for nodes, (first, last) in outer:
            if run[0] in nodes:
                turn = 2.0 * math.pi * round((0.5 * (first + last) - 0.5 * (start + stop)) / (2.0 * math.pi))
                start = first if run[0] == nodes[0] else max(start + turn, first)
                stop = last if run[-1] == nodes[-1] else min(stop + turn, last)
                break
        zones.append((start, stop))
    return zones


def _unrolled(grid: Grid, run: np.ndarray) -> np.ndarray:
    theta = grid.theta[run].copy()
    theta[np.r_[False, np.cumsum(np.diff(run) < 0) > 0]] += 2.0 * math.pi
    return theta


def _edge(theta: np.ndarray, quantity: np.ndarray, outside: float) -> float:
    """Where `quantity` squared reaches zero, near the outermost node theta[0]; `outside` is the next node.

    Nodal values are off by a part that dies out away from the edge, in a few nodes: the parabola is fitted to a
    window that moves inwards and widens with the square root of the number of nodes. Too small zones end halfway.
    """
    halfway = 0.5 * float(theta[0] + outside)
    root = math.sqrt(0.5 * theta.size)
    first = max(2, round(0.3 * root))
    last = first + max(4, round(root))
    if theta.size < last + 2:
        return halfway
    spacing = float(theta[1] - theta[0])
    x = (theta[first:last] - theta[0]) / spacing
    square = quantity[first:last] ** 2
    parabola = np.polyfit(x, square, 2)
    if np.abs(np.polyval(parabola, x) - square).max() > MISFIT * square.max():
        return halfway  # kinks left by earlier borders: no shape to extrapolate
    places = np.roots(parabola)
    places = places[np.isreal(places)].real
    low = (outside - float(theta[0])) / spacing
    places = places[(places >= 1.25 * low) & (places <= 1.0)]
    return float(theta[0]) + spacing * float(max(places.max(), low)) if places.size else halfway


def complement(
    grid: Grid, contact: list[Interval], stick: list[Interval], status: np.ndarray
) -> list[tuple[float, float, int]]:
    """Parts of the contact intervals outside the stick intervals, with the sign of the slip of their nodes."""
    zones = []
    for start, stop in contact:
        if stop - start >= 2.0 * math.pi - 1e-9 and stick:  # contact all round: begin with a stick zone
            start = stick[0][0]
            stop = start + 2.0 * math.pi
            stick = [
                (a - t, b - t) for a, b in stick for t in [2.0 * math.pi * math.floor((a - start) / (2.0 * math.pi))]
            ]
        inside = sorted((a, b) for a, b in stick if a >= start - 1e-12 and b <= stop + 1e-12)
        ends = [start, *[end for interval in inside for end in interval], stop]
        for a, b in zip(ends[::2], ends[1::2], strict=True):
            if b - a > 1e-9:
                zones += _by_sign(grid, a, b, status)
    return zones


def _by_sign(grid: Grid, start: float, stop: float, status: np.ndarray) -> list[tuple[float, float, int]]:
    """A slip zone, split where the sign of the slip changes between two nodes."""
    turns = np.floor((grid.theta - start) / (2.0 * math.pi))
    theta = grid.theta - 2.0 * math.pi * turns if grid.closed else grid.theta
    order = np.argsort(theta)
    order = order[(theta[order] >= start) & (theta[order] <= stop) & (np.abs(status[order]) == 1)]
    if order.size == 0:
        return []
    signs, angles = status[order], theta[order]
    changes = np.flatnonzero(np.diff(signs))
    borders = [start, *(0.5 * (angles[changes] + angles[changes + 1])), stop]
    first = np.r_[0, changes + 1]
    return [(float(borders[k]), float(borders[k + 1]), int(signs[first[k]])) for k in range(first.size)]


def smooth_peak(grid: Grid, values: np.ndarray) -> tuple[float, float]:
    """Largest value and its place, from the parabola through the largest nodal value and its neighbours."""
    top = int(np.argmax(values))
    return _parabola(grid, values, top)


def _parabola(grid: Grid, values: np.ndarray, top: int) -> tuple[float, float]:
    """Top of the parabola through node `top` and its neighbours; the node itself where the values have a kink."""
    n = grid.size
    at_node = float(values[top]), float(grid.theta[top])
    if not grid.closed and not 2 <= top <= n - 3:
        return at_node
    left, right = grid.knots()
    near = [(top + k) % n for k in (-2, -1, 0, 1, 2)]
    slopes = [(values[j] - values[i]) / (right[i] - grid.theta[i]) for i, j in pairwise(near)]
    bends = [abs(after - before) for before, after in pairwise(slopes)]
    if bends[1] > 3.0 * min(bends[0], bends[2]):
        return at_node
    before, after = left[top] - grid.theta[top], right[top] - grid.theta[top]
    curvature = (slopes[2] - slopes[1]) / (after - before)  # values = values[top] + slope x + curvature x^2
    slope = slopes[2] - curvature * after
    if curvature >= 0.0:
        return at_node
    place = min(max(-0.5 * slope / curvature, before), after)
    return at_node[0] + float(slope * place + curvature * place**2), at_node[1] + float(place)


def shear_peak(
    grid: Grid,
    pressure: np.ndarray,
    shear: np.ndarray,
    sticking: np.ndarray,
    friction: float,
    stick: list[Interval],
) -> tuple[float, float]:
    """Shear traction of largest magnitude, with its sign, and its place.

    The shear peaks either smoothly inside a zone, or in a cusp at a stick-slip border, where it is mu N.
    """
    top = int(np.argmax(np.abs(shear)))
    sign = 1.0 if shear[top] >= 0.0 else -1.0
    best, place = float(np.abs(shear[top])), float(grid.theta[top])
    neighbours = sticking[[top - 1, top, (top + 1) % grid.size]]
    if np.all(neighbours == neighbours[0]):
        best, place = _parabola(grid, np.abs(shear), top)
    for interval in stick:
        for border in interval:
            offset = np.abs(np.remainder(grid.theta - border + math.pi, 2.0 * math.pi) - math.pi)
            node = int(np.argmin(offset))
            if abs(node - top) in (0, 1, grid.size - 1):  # the cusp next to the largest nodal value
                bound = friction * _interpolated(grid, pressure, node, border)
                if bound > best:
                    best, place = bound, border
    return sign * best, place


def _interpolated(grid: Grid, values: np.ndarray, node: int, angle: float) -> float:
    """Quadratic interpolation at `angle` from `node` and its two neighbours."""
    left, right = grid.knots()
    near = [node - 1, node, (node + 1) % grid.size]
    x = np.array([left[node] - grid.theta[node], 0.0, right[node] - grid.theta[node]])
    if not grid.closed and node in (0, grid.size - 1):
        return float(values[node])
    offset = math.remainder(angle - grid.theta[node], 2.0 * math.pi)
    return float(np.polyval(np.polyfit(x, values[near], 2), offset))

"""Contact edges, stick-slip borders and peaks, read between the nodes with the fits of edges.py."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from fastpin import edges
from fastpin.grid import Grid, apart

Interval = tuple[float, float]

NEAR = 12
"""Node distances from a border within which the largest shear of unlike bodies belongs to its cusp."""

RIVAL = 0.8
"""Part of the largest nodal shear that the nodes beside a border need for its cusp to be a candidate."""

CUSP_RISE = 1.2
"""Most by which a cusp may be above the largest node, in parts of the drop to the lower node beside that."""

DROP_NODES = 3
"""Nodes on either side of the largest one, by whose values a peak at a border is judged."""

TIE = 1e-9
"""Relative difference below which two peaks are equal; the one farther to the right is taken."""


def square_root(run: np.ndarray) -> tuple[float, float]:
    """Exponents with which a quantity falls to zero at the ends of the zone of the nodes `run`: like bodies."""
    return 0.5, 0.5


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


def intervals(
    grid: Grid,
    mask: np.ndarray,
    quantity: np.ndarray,
    exponents: Callable[[np.ndarray], tuple[float, float]] = square_root,
    kinds: np.ndarray | None = None,
) -> list[Interval]:
    """Intervals of the zones in `mask`, at whose ends `quantity` (>= 0 inside) falls to zero with these exponents.

    Where `kinds` (n,) changes, inside a zone, the quantity may have a kink.
    """
    kinds = mask if kinds is None else kinds
    if mask.all() and grid.closed:
        start = float(grid.theta[0])
        return [(start, start + 2.0 * math.pi)]
    left, right = grid.knots()
    zones = []
    for run in runs(grid, mask):
        theta = _unrolled(grid, run)
        outside = theta[0] - (grid.theta[run[0]] - left[run[0]]), theta[-1] + (right[run[-1]] - grid.theta[run[-1]])
        at_start, at_stop = exponents(run)
        back = run[::-1]
        start = edges.edge(theta, quantity[run], at_start, outside[0], _alike(kinds[run]))
        stop = edges.edge(theta[::-1], quantity[back], at_stop, outside[1], _alike(kinds[back]))
        zones.append((float(start), float(stop)))
    return zones


def _alike(kinds: np.ndarray) -> int:
    """How many of the first values are the same."""
    other = kinds != kinds[0]
    return int(np.argmax(other)) if other.any() else kinds.size


def stick_intervals(
    grid: Grid,
    sticking: np.ndarray,
    reserve: np.ndarray,
    closed: np.ndarray,
    contact: list[Interval],
    exponents: Callable[[np.ndarray], tuple[float, float]] = square_root,
) -> list[Interval]:
    """Intervals of the stick zones, where `reserve` = mu N - |T| falls to zero or the contact ends.

    `contact` are the intervals of the `closed` nodes. A zone that reaches the outermost closed node ends with the
    contact: a slip zone without a node is none.
    """
    if closed.all() and grid.closed:
        return intervals(grid, sticking, reserve, exponents)
    zones = []
    outer = list(zip(runs(grid, closed), contact, strict=True))
    for run, (start, stop) in zip(runs(grid, sticking), intervals(grid, sticking, reserve, exponents), strict=True):
        for nodes, (first, last) in outer:
            if run[0] in nodes:
                turn = 2.0 * math.pi * round((0.5 * (first + last) - 0.5 * (start + stop)) / (2.0 * math.pi))
                start = first if run[0] == nodes[0] else max(start + turn, first)
                stop = last if run[-1] == nodes[-1] else min(stop + turn, last)
                break
        zones.append((float(start), float(stop)))
    return zones


def _unrolled(grid: Grid, run: np.ndarray) -> np.ndarray:
    theta = grid.theta[run].copy()
    theta[np.r_[False, np.cumsum(np.diff(run) < 0) > 0]] += 2.0 * math.pi
    return theta


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
    if order.size == 0:  # narrower than a node distance
        slipping = np.flatnonzero(np.abs(status) == 1)
        away = np.abs(apart(grid.theta[slipping], 0.5 * (start + stop)))
        near = slipping.size and away.min() <= stop - start + float(grid.weights.max())
        return [(float(start), float(stop), int(status[slipping[np.argmin(away)]]))] if near else []
    signs, angles = status[order], theta[order]
    changes = np.flatnonzero(np.diff(signs))
    borders = [start, *(0.5 * (angles[changes] + angles[changes + 1])), stop]
    first = np.r_[0, changes + 1]
    return [(float(borders[k]), float(borders[k + 1]), int(signs[first[k]])) for k in range(first.size)]


# --- peaks ----------------------------------------------------------------------------------------------------


def pressure_peak(grid: Grid, pressure: np.ndarray, coupled: bool = False) -> tuple[float, float]:
    """Largest pressure and its place.

    Where friction couples pressure and shear (unlike bodies) the pressure has a corner where the pin first touched.
    """
    top = _top(grid, pressure)
    value, place, smooth = _smooth_peak(grid, pressure, top)
    if smooth or not coupled:
        return value, place
    best = None
    for node in range(top - 2, top + 3):
        nodes, x = _around(grid, pressure > 0.0, node % grid.size)
        found = edges.corner(x, pressure[nodes]) if nodes.size else None
        if found is not None and found.value >= value and (best is None or found.error < best[0]):
            best = found.error, found.value, float(grid.theta[node % grid.size])
    return best[1:] if best is not None else (value, place)


def shear_peak(
    grid: Grid,
    pressure: np.ndarray,
    shear: np.ndarray,
    sticking: np.ndarray,
    friction: float,
    stick: list[Interval],
    tilt: float = 0.0,
) -> tuple[float, float]:
    """Shear traction of largest magnitude, with its sign, and its place.

    The shear peaks smoothly inside a zone; in a cusp at a stick-slip border, where it is mu N, or for unlike bodies a
    little beyond it; or in a cusp where such a border once was. `tilt` is arctan(mu beta_D)/pi, see (T26).
    """
    top = _top(grid, np.abs(shear))
    peaks, told, near = _peaks_at_borders(grid, pressure, shear, sticking, friction, stick, tilt, top)
    if not told:
        upright, bent = (shear, tilt) if shear[top] >= 0.0 else (-shear, -tilt)
        peaks.append(_peak_of_nodes(grid, upright, sticking, top, near, bent))
    highest = max(value for value, _, _ in peaks)
    equal = [peak for peak in peaks if peak[0] >= (1.0 - TIE) * highest]
    value, place, node = max(equal, key=lambda peak: _from_bottom(peak[1]))
    return math.copysign(value, float(shear[node])), place


def _peaks_at_borders(
    grid: Grid,
    pressure: np.ndarray,
    shear: np.ndarray,
    sticking: np.ndarray,
    friction: float,
    stick: list[Interval],
    tilt: float,
    top: int,
) -> tuple[list[tuple[float, float, int]], bool, bool]:
    """Values, places and highest nodes of the peaks at stick-slip borders that may be the largest.

    And whether one of them is that of the largest node `top`, fitted on both sides, and whether a border is near that.
    """
    magnitude, slipping = np.abs(shear), (pressure > 0.0) & ~sticking
    peaks, told, near = [], False, False
    for border, outwards in _borders(stick):
        offsets = outwards * apart(grid.theta, border)
        spacing = float(grid.weights[np.argmin(np.abs(offsets))])
        if not slipping[(offsets >= 0.0) & (offsets <= 1.5 * spacing)].any():
            continue  # the end of the contact
        beside = np.flatnonzero((offsets >= -2.0 * spacing) & (offsets <= (NEAR if tilt else 2.0) * spacing))
        highest = int(beside[np.argmax(magnitude[beside])])
        near = near or abs(offsets[top]) <= 2.0 * spacing
        if magnitude[highest] < RIVAL * magnitude[top]:
            continue
        peak = None
        if tilt != 0.0:
            bent = outwards * tilt if shear[highest] >= 0.0 else -outwards * tilt
            peak = _border_peak(grid, friction * pressure, border, outwards, 0.5 + bent, highest)
        if peak is not None and _likely(grid, magnitude, highest, peak[0]):
            told = told or highest == top
            peaks.append((*peak, highest))
            continue
        at_border = friction * _interpolated(grid, pressure, border)
        if _likely(grid, magnitude, highest, at_border):
            peaks.append((at_border, border, highest))
    return peaks, told, near


def _top(grid: Grid, values: np.ndarray) -> int:
    """The node with the largest value; of equals, as symmetric contacts have them, the one farthest to the right."""
    equal = np.flatnonzero(values >= (1.0 - TIE) * values.max())
    return int(equal[np.argmax([_from_bottom(angle) for angle in grid.theta[equal]])])


def _from_bottom(angle: float) -> float:
    """Angle from the bottom of the hole, -pi to pi."""
    return math.remainder(angle + 0.5 * math.pi, 2.0 * math.pi)


def _borders(stick: list[Interval]) -> Iterator[tuple[float, int]]:
    """Ends of stick zones, and to which side of them nodes do not stick; none of a contact that sticks all round."""
    for start, stop in stick:
        if stop - start < 2.0 * math.pi - 1e-9:
            yield from ((start, -1), (stop, 1))


def _peak_of_nodes(
    grid: Grid, shear: np.ndarray, sticking: np.ndarray, top: int, near: bool, tilt: float
) -> tuple[float, float, int]:
    """Value and place of the peak at the node `top`: smooth, or the cusp of an old border if no border is `near`.

    `shear` is the shear traction with the sign that makes it positive at `top`.
    """
    neighbours = sticking[[top - 1, top, (top + 1) % grid.size]]
    if not np.all(neighbours == neighbours[0]):
        return float(shear[top]), float(grid.theta[top]), top
    value, place, smooth = _smooth_peak(grid, shear, top)
    if not smooth and not near:
        value, place = _old_cusp(grid, sticking, shear, top, tilt) or (value, place)
    return value, place, top


def _border_peak(
    grid: Grid, bound: np.ndarray, border: float, outwards: float, exponent: float, node: int
) -> tuple[float, float] | None:
    """Largest mu N on the slip side of a border and its place; None if it is not within three nodes of `node`."""
    nodes, x = _around(grid, bound > 0.0, node)
    spacing = float(grid.weights[node])
    offset = outwards * math.remainder(float(grid.theta[node]) - border, 2.0 * math.pi) / spacing
    order = slice(None) if outwards > 0.0 else slice(None, None, -1)
    found = edges.border_peak(outwards * x[order] + offset, bound[nodes[order]], exponent)
    if found is None or abs(found.place - offset) > 3.0:
        return None
    return found.value, border + outwards * spacing * found.place


def _old_cusp(grid: Grid, sticking: np.ndarray, shear: np.ndarray, top: int, tilt: float) -> tuple[float, float] | None:
    """Height and place of a cusp inside a stick zone; None if the largest nodal value tells it better.

    It does if the fitted one is lower, or higher by more than what the nodes beside it are lower.
    """
    nodes, x = _around(grid, sticking, top)
    if nodes.size < 3:
        return None
    drop = float(shear[top] - min(shear[top - 1], shear[(top + 1) % grid.size]))
    best = None
    for outwards in (1.0, -1.0):
        order = slice(None) if outwards > 0.0 else slice(None, None, -1)
        found = edges.cusp(outwards * x[order], shear[nodes[order]], 0.5 + outwards * tilt)
        if found is None or not 0.0 <= found.value - shear[top] <= CUSP_RISE * drop:
            continue
        if best is None or found.error < best[0]:
            best = found.error, found.value, float(grid.theta[top] + outwards * found.place * grid.weights[top])
    return None if best is None else best[1:]


def _likely(grid: Grid, values: np.ndarray, top: int, peak: float) -> bool:
    """Whether a fitted peak fits the values about the largest one, at `top`.

    It may be higher by what they fall by on the steeper side, and lower by what they do on the other, in a few nodes.
    """
    steps = np.arange(1, DROP_NODES + 1)
    left, right = (values[(top + side * steps) % grid.size] for side in (-1, 1))
    drops = float(values[top] - left.min()), float(values[top] - right.min())
    return -min(drops) <= peak - values[top] <= max(drops)


def _around(grid: Grid, mask: np.ndarray, node: int) -> tuple[np.ndarray, np.ndarray]:
    """The run of `mask` with `node` in it, and how far its nodes are from that one, in node distances, increasing."""
    for run in runs(grid, mask):
        at = np.flatnonzero(run == node)
        if at.size:
            if run.size == grid.size and grid.closed:
                run = np.roll(run, run.size // 2 - at[0])
            theta = _unrolled(grid, run)
            spacing = float(grid.weights[node])
            return run, (theta - theta[np.flatnonzero(run == node)[0]]) / spacing
    return np.zeros(0, dtype=int), np.zeros(0)


def _smooth_peak(grid: Grid, values: np.ndarray, top: int) -> tuple[float, float, bool]:
    """Top of the parabola through node `top` and its neighbours, and whether the values are smooth there.

    Where the values have a kink the node itself.
    """
    n = grid.size
    at_node = float(values[top]), float(grid.theta[top])
    if not grid.closed and not 2 <= top <= n - 3:
        return *at_node, True
    left, right = grid.knots()
    near = [(top + k) % n for k in (-2, -1, 0, 1, 2)]
    slopes = [(values[j] - values[i]) / (right[i] - grid.theta[i]) for i, j in pairwise(near)]
    bends = [before - after for before, after in pairwise(slopes)]
    smooth = 0.0 < max(bends) <= 3.0 * min(bends)
    if abs(bends[1]) > 3.0 * min(abs(bends[0]), abs(bends[2])):
        return *at_node, smooth
    before, after = left[top] - grid.theta[top], right[top] - grid.theta[top]
    curvature = (slopes[2] - slopes[1]) / (after - before)  # values = values[top] + slope x + curvature x^2
    slope = slopes[2] - curvature * after
    if curvature >= 0.0:
        return *at_node, smooth
    place = min(max(-0.5 * slope / curvature, before), after)
    return at_node[0] + float(slope * place + curvature * place**2), at_node[1] + float(place), smooth


def _interpolated(grid: Grid, values: np.ndarray, angle: float) -> float:
    """Interpolation at `angle`: quadratic, from the three nearest nodes; linear where one of them is zero."""
    offsets = apart(grid.theta, angle)
    near = np.argsort(np.abs(offsets))[:3]
    if not np.all(values[near] > 0.0):
        near = np.array([np.flatnonzero(offsets < 0.0)[np.argmax(offsets[offsets < 0.0])],
                         np.flatnonzero(offsets >= 0.0)[np.argmin(offsets[offsets >= 0.0])]])  # fmt: skip
    return float(np.polyval(np.polyfit(offsets[near], values[near], near.size - 1), 0.0))

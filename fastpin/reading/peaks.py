"""Peaks of pressure and shear traction, read between the nodes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from fastpin.kernels.status import OPEN
from fastpin.model.angles import angle_between
from fastpin.model.grid import Grid
from fastpin.model.ties import top_angle, top_angles
from fastpin.reading.cusps import ShearNodes
from fastpin.reading.zones import Interval, by_two_nodes, is_all_round, runs

RIVAL = 0.8
"""Least nodal shear beside a border, in parts of the largest nodal shear.

With less, the cusp at the border is no candidate for the peak.
"""

CUSP_ERROR = 2e-3
"""Largest standard error of a cusp that is read with the solutions of the half line, in parts of it."""

STEEPEST_RISE = 1.25
"""Largest height of a cusp above the largest nodal value.

The unit is the larger of two drops, from the largest node to its neighbour and on to the next node. On the side where
the drop is smaller the traction is smooth. It goes on from there to the cusp at most this many node distances: 1.1 in
the reference cases of docs/accuracy-tables.md.
"""

LARGEST_FALL = 0.01
"""Largest depth of a cusp at a border below the largest nodal value, in parts of this value.

The nodal values beside a border have errors up to this size. A node that is higher by more is no such error.
"""

DROP_NODES = 3
"""Number of nodes on either side of the largest one whose values must be consistent with a peak at a border."""


def pressure_peak(grid: Grid, pressure: np.ndarray) -> tuple[float, float]:
    """Largest contact pressure and its angle (rad), read between the nodes.

    Parameters
    ----------
    grid : Grid
    pressure : ndarray, shape (n,)
        Nodal pressure N >= 0, in any unit; the peak has the same unit.
    """
    return _smooth_peak(grid, pressure, top_angle(pressure, grid.theta))


def shear_peak(contact: ShearNodes, stick: list[Interval]) -> tuple[float, float]:
    """Shear traction of largest magnitude, with its sign, and its angle (rad), read between the nodes.

    The peak has one of three forms. It is smooth inside a zone. Or it is a cusp at a stick-slip border, where |T| is
    mu N; for unlike bodies the largest value lies a little beyond the border. Or it is a cusp at an earlier border.

    Parameters
    ----------
    contact : ShearNodes
    stick : list of (float, float)
        Stick intervals (start, stop), rad.
    """
    grid, pressure, shear, sticking = contact.grid, contact.pressure, contact.shear, contact.sticking
    top = top_angle(np.abs(shear), grid.theta)
    peaks, fitted_here = _peaks_at_borders(contact, stick, top)
    for cusp in contact.old_cusps(RIVAL * float(abs(shear[top]))):
        if cusp.error <= CUSP_ERROR * cusp.value and _likely(grid, np.abs(shear), cusp.node, cusp.value):
            peaks.append((cusp.value, cusp.angle, cusp.node))
            fitted_here = fitted_here or abs((cusp.node - top + 2) % grid.size - 2) <= 2
    if not fitted_here:
        beside, upright = [top - 1, top, (top + 1) % grid.size], shear if shear[top] >= 0.0 else -shear
        value, place = float(upright[top]), float(grid.theta[top])
        if sticking[beside].all() or not sticking[beside].any():
            value, place = _smooth_peak(grid, upright, top)
        if sticking[top]:  # Coulomb's law also holds between the nodes
            value = min(value, float(contact.friction[top]) * float(pressure[beside].max()))
        peaks.append((value, place, top))
    values, places, _ = np.array(peaks).T
    value, place, node = peaks[top_angle(values, places)]
    return math.copysign(value, float(shear[node])), place


def _peaks_at_borders(
    contact: ShearNodes, stick: list[Interval], top: int
) -> tuple[list[tuple[float, float, int]], bool]:
    """Peaks at stick-slip borders, as candidates for the largest one.

    Returns
    -------
    peaks : list of (float, float, int)
        Value, angle and highest node of each.
    fitted_here : bool
        Whether the peak at `top` is among them, and was fitted on both sides of its border.
    """
    grid, pressure, shear, sticking = contact.grid, contact.pressure, contact.shear, contact.sticking
    magnitude, slipping = np.abs(shear), (pressure > 0.0) & ~sticking
    peaks, fitted_here = [], False
    bound = contact.friction * pressure
    borders = []  # ends of stick zones, rad, the way out of the zone, and the nodes of the zone from that end on
    for run, (start, stop) in zip(runs(grid, sticking), stick, strict=True):
        if not is_all_round(stop - start):
            borders += [(start, -1, run), (stop, 1, run[::-1])]
    for border, outwards, nodes in borders:
        offsets = outwards * angle_between(grid.theta, border)
        spacing = float(grid.weights[np.argmin(np.abs(offsets))])
        if not slipping[(offsets >= 0.0) & (offsets <= 1.5 * spacing)].any():
            continue  # no slip beside this end of the stick zone: it is the end of the contact
        reach = 2.0 if contact.coupling.is_smooth else 12.0  # of the cusp at a border, in node distances
        beside = np.flatnonzero((offsets >= -2.0 * spacing) & (offsets <= reach * spacing))
        highest = int(beside[np.argmax(magnitude[beside])])
        if magnitude[highest] < RIVAL * magnitude[top]:
            continue
        sign = 1 if shear[highest] >= 0.0 else -1
        exponent = 0.5 + outwards * sign * float(contact.coupling.tilt[sign, nodes[0]])
        read = contact.border_cusp(nodes, outwards, border)
        fits_nodes = read is not None and _likely(grid, magnitude, highest, read.value)
        if read is not None and fits_nodes and read.error <= CUSP_ERROR * read.value:
            fitted_here = fitted_here or highest == top
            peaks.append((read.value, read.angle, highest))
            continue
        at_border = float(contact.friction[nodes[0]]) * _interpolated(grid, pressure, border)
        if _likely(grid, magnitude, highest, at_border):
            by_line = _bound_by_two_nodes(grid, bound, magnitude, nodes, outwards, exponent)
            if at_border > 1.01 * by_line:  # where the two readings do not agree, the lower one counts
                at_border = min(at_border, max(by_line, float(magnitude[highest])))
            peaks.append((min(at_border, _highest_cusp(grid, magnitude, highest)), border, highest))
    return peaks, fitted_here


def _bound_by_two_nodes(
    grid: Grid, bound: np.ndarray, magnitude: np.ndarray, nodes: np.ndarray, outwards: int, exponent: float
) -> float:
    """The bound mu N at a border whose place is read from the two outermost sticking nodes alone.

    These are the first two of `nodes`. mu N is linear from the first one to the slipping node beside it.
    """
    inner, outer = int(nodes[0]), int(nodes[0] + outwards) % grid.size
    part = 0.5
    if nodes.size > 1:
        before, after = (float(half[inner]) for half in grid.halves)
        low = -after / before if outwards > 0 else -before / after
        first, second = (float(value) for value in (bound - magnitude)[nodes[:2]])
        part = by_two_nodes(first, second, exponent, low) / low
    return float(bound[inner] + part * (bound[outer] - bound[inner]))


def _highest_cusp(grid: Grid, values: np.ndarray, top: int) -> float:
    """Largest height of a cusp beside the node `top` that the values on both sides allow, see STEEPEST_RISE."""
    drops = []
    for side in (-1, 1):
        first, second, third = (float(values[(top + side * step) % grid.size]) for step in (0, 1, 2))
        drops.append(max(first - second, second - third))
    return float(values[top]) + STEEPEST_RISE * min(drops)


def _likely(grid: Grid, values: np.ndarray, top: int, peak: float) -> bool:
    """Whether a fitted peak is consistent with the nodal values about the largest one, at `top`.

    The values fall by some amount within DROP_NODES nodes on either side. The peak may be higher than the largest
    value by the larger drop, or lower by the smaller drop and LARGEST_FALL.
    """
    highest, near = float(values[top]), range(1, DROP_NODES + 1)
    drops = [highest - min(float(values[(top + side * step) % grid.size]) for step in near) for side in (-1, 1)]
    return -min(*drops, LARGEST_FALL * highest) <= peak - highest <= max(drops)


def _smooth_peak(grid: Grid, values: np.ndarray, top: int) -> tuple[float, float]:
    """Value and angle of the top of the parabola through node `top` and its neighbours.

    If the values have a kink at the node, the peak is the node itself.
    """
    n = grid.size
    at_node = float(values[top]), float(grid.theta[top])
    if not grid.closed and not 2 <= top <= n - 3:
        return at_node
    left, right = grid.halves
    nodes = [(top + k) % n for k in (-2, -1, 0, 1, 2)]
    beside, steps = values[nodes].tolist(), right[nodes].tolist()
    slopes = [(beside[k + 1] - beside[k]) / steps[k] for k in range(4)]
    bends = [before - after for before, after in pairwise(slopes)]
    if abs(bends[1]) > 3.0 * min(abs(bends[0]), abs(bends[2])):
        return at_node
    before, after = -float(left[top]), steps[2]
    curvature = (slopes[2] - slopes[1]) / (after - before)  # values = values[top] + slope x + curvature x^2
    slope = slopes[2] - curvature * after
    if curvature >= 0.0:
        return at_node
    place = min(max(-0.5 * slope / curvature, before), after)
    return at_node[0] + (slope * place + curvature * place**2), at_node[1] + place


def _interpolated(grid: Grid, values: np.ndarray, angle: float) -> float:
    """Value at `angle`, interpolated: quadratic from the three nearest nodes, or linear if a value there is zero."""
    offsets = angle_between(grid.theta, angle)
    nearest = np.argsort(np.abs(offsets))[:3]
    if not np.all(values[nearest] > 0.0):
        nearest = np.array([np.flatnonzero(offsets < 0.0)[np.argmax(offsets[offsets < 0.0])],
                            np.flatnonzero(offsets >= 0.0)[np.argmin(offsets[offsets >= 0.0])]])  # fmt: skip
    x, total = offsets[nearest].tolist(), 0.0
    for k, value in enumerate(values[nearest].tolist()):  # Lagrange's polynomials at 0
        total += value * math.prod(x[j] / (x[j] - x[k]) for j in range(len(x)) if j != k)
    return total


def peak_slips(slip: np.ndarray, status: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The :attr:`fastpin.State.peak_slip` of many states, shape (k,), from slip and status of their nodes (k, n)."""
    nodes = slip_nodes(slip, status, theta)
    return np.where((status != OPEN).any(axis=1), np.take_along_axis(slip, nodes[:, None], axis=1)[:, 0], 0.0)


def slip_nodes(slip: np.ndarray, status: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The closed node with the slip of largest magnitude in each of many states, shape (k,)."""
    return top_angles(np.where(status != OPEN, np.abs(slip), -1.0), theta)

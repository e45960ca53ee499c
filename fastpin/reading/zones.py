"""Intervals of contact, stick and slip, and the places of their ends between the nodes.

The place of an end follows from the nodal values beside it and the solutions of the half-line problem.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from fastpin.model.angles import BOTTOM, angle_between, interval_near_bottom
from fastpin.model.grid import Grid
from fastpin.reading.half_line import End, Fit, HalfLine, Tries, Try, half_line
from fastpin.reading.old_borders import OldBorder

Interval = tuple[float, float]
"""Start and stop angle of an interval round the hole, rad, start < stop."""

ALL_ROUND = BOTTOM - math.pi, BOTTOM + math.pi
"""The interval of a zone round the whole hole, from the top to the top, rad."""

Zone = TypeVar("Zone", bound=tuple[Any, ...])


Lines = Callable[[np.ndarray], tuple[HalfLine, HalfLine]]
"""Gives for the node indices of a zone the half lines at its start and stop."""


Cusps = Callable[[np.ndarray], list[OldBorder]]
"""Gives for the node indices of a zone the old borders in it."""


Sides = Callable[[np.ndarray], tuple[bool, bool]]
"""Tells for the node indices of a zone whether its start and its stop are to be read."""


def square_root(run: np.ndarray) -> tuple[HalfLine, HalfLine]:
    """The half lines at both ends of a zone of like bodies: the exponent is 1/2 for any nodes `run`."""
    return half_line(0.5), half_line(0.5)


def is_all_round(length: float) -> bool:
    """Whether a zone of a given length, rad, goes all round the hole."""
    return length >= 2.0 * math.pi - 1e-9


def in_order(zones: Sequence[Zone]) -> list[Zone]:
    """Zones with start and stop moved by whole turns, in the order in which they are reported.

    The middle of each zone lies in (-3 pi/2, pi/2], at most half a turn from the bottom of the hole. A zone across the
    top may so begin before -3 pi/2 or end after pi/2. The angles increase from zone to zone. A zone round the whole
    hole is :data:`ALL_ROUND`.
    """
    moved: list[Any] = [
        (*(ALL_ROUND if is_all_round(stop - start) else interval_near_bottom(start, stop)), *rest)
        for start, stop, *rest in zones
    ]
    return sorted(moved)


def runs(grid: Grid, mask: np.ndarray) -> list[np.ndarray]:
    """Index arrays of the runs of consecutive True nodes. On a circle a run may continue past the last node."""
    return list(_runs(mask.tobytes(), grid.closed))


@functools.lru_cache(maxsize=8)  # the readings of a state ask for the same runs
def _runs(mask: bytes, closed: bool) -> list[np.ndarray]:
    """The runs of a mask, which can't be written to. `closed` tells whether the last node is joined to the first."""
    n, inside = len(mask), np.flatnonzero(np.frombuffer(mask, dtype=bool))
    inside.setflags(write=False)
    if inside.size in (0, n):
        return [inside] * (inside.size > 0)
    stops = np.flatnonzero(inside[1:] - inside[:-1] > 1) + 1
    parts = [inside[start:stop] for start, stop in pairwise([0, *stops.tolist(), inside.size])]
    if closed and len(parts) > 1 and parts[0][0] == 0 and parts[-1][-1] == n - 1:
        parts[-1] = np.concatenate([parts[-1], parts[0]])
        parts[-1].setflags(write=False)
        parts = parts[1:]
    return parts


def intervals(
    grid: Grid,
    mask: np.ndarray,
    quantity: np.ndarray,
    lines: Lines = square_root,
    cusps: Cusps = lambda run: [],
    sides: Sides = lambda run: (True, True),
) -> list[Interval]:
    """Intervals of the zones in `mask`. A quantity falls to zero at their ends.

    Parameters
    ----------
    grid : Grid
    mask : ndarray of bool, shape (n,)
        Nodes inside the zones.
    quantity : ndarray, shape (n,) or (2, n)
        Nodal values, >= 0 inside the zones; the values beside the start and beside the stop of each zone, if these
        differ.
    lines : callable
        Gives for the node indices of a zone the half lines at its start and stop.
    cusps : callable
        Gives for the node indices of a zone the old borders in it, at which the quantity has a cusp. None by default.
    sides : callable
        Tells for the node indices of a zone whether its start and its stop are to be read. Any other end is the angle
        of the outermost node.

    Returns
    -------
    list of (float, float)
        Start and stop, rad. A zone round the whole circle is one interval of length 2 pi.
    """
    if mask.all() and grid.closed:
        start = float(grid.theta[0])
        return [(start, start + 2.0 * math.pi)]
    left, right = grid.halves
    at_starts, at_stops = quantity if quantity.ndim == 2 else (quantity, quantity)
    zones = []
    for run in runs(grid, mask):
        theta = unrolled(grid, run)
        ends, back, inside = [float(theta[0]), float(theta[-1])], run[::-1], cusps(run)
        at_start, at_stop = lines(run)
        is_read = sides(run)
        if is_read[0]:
            outside = float(theta[0] - left[run[0]])
            ends[0] = end_angle(theta, at_starts[run], at_start, outside, inside)
        if is_read[1]:
            outside = float(theta[-1] + right[run[-1]])
            inside = [cusp.mirrored(run.size) for cusp in inside]
            ends[1] = end_angle(theta[::-1], at_stops[back], at_stop, outside, inside)
        zones.append((ends[0], ends[1]))
    return zones


def stick_intervals(
    grid: Grid,
    sticking: np.ndarray,
    reserve: np.ndarray,
    closed: np.ndarray,
    contact: list[Interval],
    lines: Lines = square_root,
    cusps: Cusps = lambda run: [],
) -> list[Interval]:
    """Intervals of the stick zones. A stick zone ends where mu N - |T| falls to zero, or with the contact.

    A stick zone that reaches the outermost closed node ends with the contact: a slip zone has at least one node.

    Parameters
    ----------
    grid : Grid
    sticking, closed : ndarray of bool, shape (n,)
        Nodes that stick, and nodes in contact.
    reserve : ndarray, shape (n,) or (2, n)
        mu N - |T|, or mu N - s T beside the start and beside the stop of each zone, with the sign s of the slip zone
        there.
    contact : list of (float, float)
        Contact intervals of the closed nodes, rad.
    lines : callable
    cusps : callable
        As for :func:`intervals`.

    Returns
    -------
    list of (float, float)
        Start and stop, rad.
    """
    if closed.all() and grid.closed:
        return intervals(grid, sticking, reserve, lines, cusps=cusps)
    zones = []
    outer = list(zip(runs(grid, closed), contact, strict=True))
    starts, stops = ({int(nodes[end]) for nodes, _ in outer} for end in (0, -1))

    def sides(run: np.ndarray) -> tuple[bool, bool]:
        return int(run[0]) not in starts, int(run[-1]) not in stops

    found = intervals(grid, sticking, reserve, lines, cusps=cusps, sides=sides)
    for run, (start, stop) in zip(runs(grid, sticking), found, strict=True):
        for nodes, (first, last) in outer:
            if run[0] in nodes:
                turn = 2.0 * math.pi * round((0.5 * (first + last) - 0.5 * (start + stop)) / (2.0 * math.pi))
                start = first if run[0] == nodes[0] else max(start + turn, first)
                stop = last if run[-1] == nodes[-1] else min(stop + turn, last)
                break
        zones.append((float(start), float(stop)))
    return zones


def unrolled(grid: Grid, run: np.ndarray) -> np.ndarray:
    """Increasing angles of the nodes of a run, rad; a full turn is added past the last node of a circle."""
    theta: np.ndarray = grid.theta[run]
    turn = np.flatnonzero(run[1:] < run[:-1])
    if turn.size:
        theta[turn[0] + 1 :] += 2.0 * math.pi
    return theta


def complement(
    grid: Grid, contact: list[Interval], stick: list[Interval], status: np.ndarray
) -> list[tuple[float, float, int]]:
    """Slip zones: the parts of the contact intervals outside the stick intervals.

    Returns
    -------
    list of (float, float, int)
        Start and stop, rad, and the sign of the slip of the nodes inside (`status`, shape (n,)).
    """
    zones = []
    for start, stop in contact:
        if is_all_round(stop - start):  # begin at a border, so that no zone is cut in two
            start = stick[0][0] if stick else _change_of_sign(grid, status)
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


def _change_of_sign(grid: Grid, status: np.ndarray) -> float:
    """An angle on a circle at which the sign of the slip changes between two nodes, rad; the top if there is none."""
    slipping = np.flatnonzero(np.abs(status) == 1)
    changes = slipping[status[slipping] != np.roll(status[slipping], 1)]
    if changes.size == 0:
        return ALL_ROUND[0]
    before = slipping[slipping < changes[0]]
    last = float(grid.theta[before[-1]]) if before.size else float(grid.theta[slipping[-1]]) - 2.0 * math.pi
    return 0.5 * (last + float(grid.theta[changes[0]]))


def _by_sign(grid: Grid, start: float, stop: float, status: np.ndarray) -> list[tuple[float, float, int]]:
    """Parts of the slip zone from `start` to `stop`, split where the sign of the slip changes between two nodes."""
    turns = np.floor((grid.theta - start) / (2.0 * math.pi))
    theta = grid.theta - 2.0 * math.pi * turns if grid.closed else grid.theta
    order = np.argsort(theta)
    order = order[(theta[order] >= start) & (theta[order] <= stop) & (np.abs(status[order]) == 1)]
    if order.size == 0:  # narrower than a node distance
        slipping = np.flatnonzero(np.abs(status) == 1)
        away = np.abs(angle_between(grid.theta[slipping], 0.5 * (start + stop)))
        in_reach = slipping.size and away.min() <= stop - start + float(grid.weights.max())
        return [(float(start), float(stop), int(status[slipping[np.argmin(away)]]))] if in_reach else []
    signs, angles = status[order], theta[order]
    changes = np.flatnonzero(np.diff(signs))
    borders = [start, *(0.5 * (angles[changes] + angles[changes + 1])), stop]
    first = [0, *(changes + 1)]
    return [(float(borders[k]), float(borders[k + 1]), int(signs[start])) for k, start in enumerate(first)]


# -- the ends of zones ------------------------------------------------------------------------------------------


WINDOWS = ((8, 4), (6, 4), (5, 3), (6, 3), (10, 5), (14, 5), (20, 5))
"""Windows to try: the number of nodes from the end, and the number of terms."""

CROWDED = ((8, 3), (10, 3), (12, 4), (14, 4), (18, 4), (24, 5))
"""Windows to try where old borders lie near the end."""

MOST_VALUES = 2 * max(count for count, _ in (*WINDOWS, *CROWDED))
"""Values of a zone that count: a window takes at most half of them. More values give the same place."""

CUSP_TERMS = 3
"""Terms at an old border."""


def end_place(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder] = ()) -> float:
    """Place at which a quantity falls to zero at the end of a zone: that of :func:`end_fit`.

    It is in node distances inwards from the outermost node; NaN if no fit is good enough.
    """
    return _best(values, line, cusps)[1]


def end_fit(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder] = ()) -> Fit | None:
    """The best fit of a quantity that falls to zero at the end of a zone. This is the end number 0 of the fit.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Values of the quantity from the outermost node inwards.
    line : HalfLine
    cusps : sequence of OldBorder
        Old borders in the zone.

    Returns
    -------
    Fit or None
        None if no fit is good enough.
    """
    best, place = _best(values, line, cusps)
    return None if best is None or math.isnan(place) else Fit(values[: best.nodes], best.ends)


def _best(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder]) -> tuple[Try | None, float]:
    """The best fit at the end of a zone, and the place of the end by it, NaN if it is not plausible."""
    others = [
        End(line, cusp.at, cusp.inwards, CUSP_TERMS, cusp.place)
        for cusp in sorted(cusps)
        if cusp.at < MOST_VALUES // 2 and (cusp.at, cusp.inwards) != (0, 1)
    ]
    most = max(values.size // 2, min(values.size - 1, 10))  # the outer half; of a small zone all nodes but one
    return _best_fit(values[:MOST_VALUES].tobytes(), line, tuple(others), min(most, MOST_VALUES // 2))


@functools.lru_cache(maxsize=64)
def _best_fit(values: bytes, line: HalfLine, others: tuple[End, ...], most: int) -> tuple[Try | None, float]:
    """The best fit of up to `most` of the `values`, with the old borders `others`; and the place of the end by it.

    It is kept, because the same end is read for the zones of a state and for its cusps.
    """
    tries, packed = _tries(line, others, most)
    # Standard errors in node distances. The solutions at a border of unlike bodies leave out contact edges nearby,
    # which the standard error shows in part only.
    best, found, least = None, math.nan, 0.01 if line.coupling else 0.05
    if packed is None:
        return None, math.nan
    is_crowded = _is_crowded(others)
    for each, (place, error) in zip(tries, packed.end_places(np.frombuffer(values)).tolist(), strict=True):
        if error < least:
            best, found, least = each, place, error
        if least <= 1e-4 and not is_crowded:  # the discrete problem itself has errors of this size
            break
    return best, found


def _is_crowded(others: Sequence[End]) -> bool:
    """Whether one of the old borders `others` lies near the end."""
    return any(other.node < CROWDED[0][0] for other in others)


@functools.lru_cache(maxsize=256)
def _tries(line: HalfLine, others: tuple[End, ...], most: int) -> tuple[list[Try], Tries | None]:
    """The fits of up to `most` nodes to try at the end of a zone with the old borders `others`; None if there is none.

    They are the same for all ends of like bodies without old borders.
    """
    tries = []
    for count, terms in CROWDED if _is_crowded(others) else WINDOWS:
        ends = (End(line, 0, 1, terms), *(other for other in others if other.node < count))
        fit = Try(0, count, -1, ends)
        if count <= most and fit.spare >= 1:
            tries.append(fit)
    return tries, Tries(tries) if tries else None


def end_angle(
    theta: np.ndarray, quantity: np.ndarray, line: HalfLine, outside: float, cusps: Sequence[OldBorder] = ()
) -> float:
    """Angle at which a quantity falls to zero at the end of a zone, rad.

    Parameters
    ----------
    theta, quantity : ndarray, shape (n,)
        Angles (rad) of the nodes of the zone, from the outermost node inwards, in either direction; and the values at
        these nodes, >= 0.
    line : HalfLine
    outside : float
        Angle of the next node outwards, where the quantity is zero, rad.
    cusps : sequence of OldBorder
        The old borders in the zone.

    Returns
    -------
    float
        An angle, not beyond `outside`. If no solution of the half line fits, the zero of the line through the two
        outermost nodes. A zone of one node ends halfway to `outside`.
    """
    if theta.size == 1:
        return 0.5 * float(theta[0] + outside)
    spacing = float(theta[1] - theta[0])
    place = end_place(quantity, line, cusps)
    if math.isnan(place):
        low = (outside - float(theta[0])) / spacing
        return float(theta[0]) + spacing * by_two_nodes(float(quantity[0]), float(quantity[1]), line.exponent, low)
    if place < 0.0:
        return float(theta[0] - max(place, -1.0) * (outside - theta[0]))
    return float(theta[0] + place * spacing)


def by_two_nodes(first: float, second: float, exponent: float, low: float) -> float:
    """Zero of the line through two nodes, in node distances from the first one, the outermost node of a zone.

    The line goes through the values to the power 1/`exponent`. If it does not fall outwards, the result is halfway to
    the next node outwards at `low` < 0.
    """
    outer, inner = abs(first) ** (1.0 / exponent), abs(second) ** (1.0 / exponent)
    return max(-outer / (inner - outer), low) if inner > outer else 0.5 * low

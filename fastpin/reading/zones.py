"""Intervals of contact, stick and slip, and the places of their ends between the nodes.

The place of an end follows from the nodal values beside it and the solutions of the half-line problem.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from fastpin.kernels.status import OPEN
from fastpin.model.angles import BOTTOM, angle_between, interval_near_bottom
from fastpin.model.grid import Grid
from fastpin.reading.exponents import Coupling, contact_exponents
from fastpin.reading.half_line import End, Fit, HalfLine, Tries, Try, half_line
from fastpin.reading.old_borders import OldBorder

Interval = tuple[float, float]
"""Start and stop angle of an interval round the hole, rad, start < stop."""

ALL_ROUND = BOTTOM - math.pi, BOTTOM + math.pi
"""The interval of a zone round the whole hole, from the top to the top, rad."""

Zone = TypeVar("Zone", bound=tuple[Any, ...])


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


def whole_turn(grid: Grid) -> Interval:
    """The interval of a zone of all nodes of a circle, rad."""
    start = float(grid.theta[0])
    return start, start + 2.0 * math.pi


def contact_intervals(grid: Grid, status: np.ndarray, pressure: np.ndarray, coupling: Coupling) -> list[Interval]:
    """The contact intervals of the runs of closed nodes, in their order. The pressure falls to zero at their ends.

    Parameters
    ----------
    grid : Grid
    status, pressure : ndarray, shape (n,)
        The statuses tell the signs of the slip at the ends, and so the exponents.
    coupling : Coupling

    Returns
    -------
    list of (float, float)
        Start and stop, rad. A contact round the whole circle is one interval of length 2 pi.
    """
    closed = status != OPEN
    if closed.all() and grid.closed:
        return [whole_turn(grid)]
    found = []
    for run in runs(grid, closed):
        start, stop = map(half_line, contact_exponents(status, coupling.tilt, run))
        found.append(interval_of(grid, run, (pressure, pressure), (start, stop)))
    return found


def interval_of(
    grid: Grid,
    run: np.ndarray,
    values: Sequence[np.ndarray],
    lines: tuple[HalfLine, HalfLine],
    borders: Sequence[OldBorder] = (),
    is_read: tuple[bool, bool] = (True, True),
) -> Interval:
    """The interval of the zone of the nodes `run`, rad. A quantity falls to zero at its ends.

    Parameters
    ----------
    grid : Grid
    run : ndarray of int, shape (k,)
    values : two ndarrays, shape (n,)
        Nodal values of the quantity beside the start and beside the stop, >= 0 inside the zone.
    lines : (HalfLine, HalfLine)
        The half lines at start and stop.
    borders : sequence of OldBorder
        The old borders in the zone, at which the quantity has a cusp.
    is_read : (bool, bool)
        Whether start and stop are read between the nodes. Any other end is the angle of the outermost node.
    """
    theta, (left, right) = unrolled(grid, run), grid.halves
    start, stop = float(theta[0]), float(theta[-1])
    if is_read[0]:
        start = end_angle(theta, values[0][run], lines[0], float(theta[0] - left[run[0]]), borders)
    if is_read[1]:
        mirrored = [border.mirrored(run.size) for border in borders]
        stop = end_angle(theta[::-1], values[1][run[::-1]], lines[1], float(theta[-1] + right[run[-1]]), mirrored)
    return start, stop


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

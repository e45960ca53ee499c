"""Lines and arcs fitted to the points of an outline, such as the edge of a mesh.

The stress on a polyline is not that on a smooth edge, however fine it is: it vanishes at convex vertices, and exceeds
the stress on the arc by about 0.45 of the turn at a vertex (rad) in the middle of a side. So arcs are fitted first.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

import numpy as np

from fastpin.lugs.outline import MOST_TURN, Part, turn_between

LEAST_OF_LINE, LEAST_OF_ARC = 2, 4
"""Fewest sides of a polyline that become one line or one arc. Four points of a symmetric polygon lie on a circle."""

MOST_SWEEP = 5.2
"""Largest turn of a whole arc, rad."""


class FittedArc(NamedTuple):
    """Several sides that became one part.

    Attributes
    ----------
    part : Part
    points : int
        Points of the sides.
    deviation : float
        Largest distance of a point from the part, m.
    """

    part: Part
    points: int
    deviation: float


def fitted(outline: Sequence[Part], tolerance: float) -> tuple[tuple[Part, ...], list[FittedArc]]:
    """Return a closed outline with lines and arcs in place of many short sides, and the arcs that were fitted.

    Neighbouring straight parts of one name become a line or an arc if all their ends lie within the `tolerance`, m,
    from it. The longest stretches come first. With the tolerance 0 nothing is fitted.
    """
    count = len(outline)
    turns = [abs(turn_between(outline[k - 1], outline[k])) for k in range(count)]
    ends = [outline[k - 1].name != outline[k].name or outline[k - 1].through is not None for k in range(count)]
    first = max(range(count), key=lambda k: (ends[k], turns[k]))
    parts = [*outline[first:], *outline[:first]]
    found: list[Part] = []
    arcs: list[FittedArc] = []
    for _, group in groupby(range(count), lambda k: (parts[k].name, -1 if parts[k].through is None else k)):
        sides = [parts[k] for k in group]
        points = np.array([side.start for side in sides] + [sides[-1].end])
        for low, high, through in _stretches(points, tolerance if sides[0].through is None else -1.0):
            part = replace(sides[low], end=sides[high - 1].end, through=through or sides[low].through)
            found.append(part)
            if through is not None:
                arcs.append(FittedArc(part, high - low + 1, _off_arc(points[low : high + 1])[0]))
    return tuple(found), arcs


def is_corner(before: Part, after: Part) -> bool:
    """Whether a new side begins: at a corner, and where an arc or a line follows on the other one."""
    is_other = (before.through is None) != (after.through is None)
    return is_other or abs(turn_between(before, after)) > MOST_TURN


def circle_of(outline: Sequence[Part], tolerance: float) -> tuple[complex, float] | None:
    """Centre and radius, m, of an outline that is a circle within a tolerance; None for others."""
    circles = [part.circle for part in outline if part.circle is not None]
    centre, radius, *_ = max(circles, key=lambda circle: abs(circle[3]), default=(0j, 0.0, 0.0, 0.0))
    points = np.concatenate([part.at(np.linspace(0.0, 1.0, 9)) for part in outline])
    return (centre, radius) if np.abs(np.abs(points - centre) - radius).max() <= tolerance else None


def _stretches(points: np.ndarray, tolerance: float) -> list[tuple[int, int, complex | None]]:
    """First and last point of each stretch in order, and a point within an arc; a side alone is a stretch too."""
    waiting: list[tuple[int, bool, int, int]] = []
    for is_arc in (False, True):
        for low, high in _reaches(points, is_arc, tolerance):
            heapq.heappush(waiting, (low - high, is_arc, low, high))
    taken = np.zeros(len(points) - 1, dtype=bool)
    found: list[tuple[int, int, complex | None]] = []
    while waiting:
        _, is_arc, low, high = heapq.heappop(waiting)
        left = np.flatnonzero(~taken[low:high])
        if left.size == high - low:
            taken[low:high] = True
            found.append((low, high, _off_arc(points[low : high + 1])[1] if is_arc else None))
        elif left.size:  # the free end of a stretch whose other end is taken
            start = low + int(left[0])
            stop = start + int(np.argmin(np.r_[~taken[start:high], False]))
            if stop - start >= (LEAST_OF_ARC if is_arc else LEAST_OF_LINE):
                heapq.heappush(waiting, (start - stop, is_arc, start, stop))
    return sorted(found + [(k, k + 1, None) for k in np.flatnonzero(~taken).tolist()])


def _reaches(points: np.ndarray, is_arc: bool, tolerance: float) -> list[tuple[int, int]]:
    """The stretches that fit and go on at neither end. Parts of a stretch that fits fit."""
    found: list[tuple[int, int]] = []
    least, high = LEAST_OF_ARC if is_arc else LEAST_OF_LINE, 0

    def fits(low: int, high: int) -> bool:
        z = points[low : high + 1]
        if is_arc:
            return _off_arc(z)[0] < tolerance
        place = (z - z[0]) * np.conj(z[-1] - z[0]) / (abs(z[-1] - z[0]) or 1.0)
        return bool((np.diff(place.real) > 0.0).all() and np.abs(place.imag).max() < tolerance)

    for low in range(len(points) - least):
        reach = max(high, low + least)
        if reach == high or fits(low, reach):
            while reach + 1 < len(points) and fits(low, reach + 1):
                reach += 1
            if reach > high:
                found.append((low, reach))
            high = reach
    return found


def _off_arc(z: np.ndarray) -> tuple[float, complex]:
    """Largest distance of points from an arc between their ends, and the point in its middle.

    The distance is infinite if the points do not follow the arc. Circles through both ends have one free number, the
    place k of the centre on the bisector: x^2 + y^2 - 2 k y = c^2. Least squares give it.
    """
    half = 0.5 * abs(z[-1] - z[0])
    along = (z[-1] - z[0]) / (2.0 * half or 1.0)
    place = np.conj(along) * (z - 0.5 * (z[0] + z[-1]))
    across = float((place.imag**2).sum())
    if across == 0.0 or half == 0.0:
        return math.inf, 0j
    k = float((place.imag * (np.abs(place) ** 2 - half**2)).sum()) / (2.0 * across)
    radius = math.hypot(k, half)
    seen = place - 1j * k
    steps = np.angle(seen[1:] * np.conj(seen[:-1]))
    sign = math.copysign(1.0, steps[0])
    follows = (steps * sign > 0.0).all() and np.abs(steps).max() <= MOST_TURN and abs(steps.sum()) <= MOST_SWEEP
    middle = 1j * k + radius * seen[0] / abs(seen[0]) * np.exp(0.5j * steps.sum())
    off = float(np.abs(np.abs(seen) - radius).max())
    return off if follows else math.inf, complex(0.5 * (z[0] + z[-1]) + along * middle)

"""Angles round the hole, and their differences."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np


def angle_between(angles: np.ndarray | float, angle: np.ndarray | float) -> np.ndarray:
    """The differences `angles` - `angle`, the short way round: -pi to pi rad, positive counter-clockwise."""
    return np.remainder(np.asarray(angles) - angle + math.pi, 2.0 * math.pi) - math.pi


def distinct(angles: np.ndarray) -> np.ndarray:
    """The different angles (n,), in increasing order. np.unique would import numpy.ma in every run."""
    ordered = np.sort(angles)
    found: np.ndarray = ordered[np.r_[True, ordered[1:] != ordered[:-1]]] if ordered.size else ordered
    return found


BOTTOM = -0.5 * math.pi
"""Angle of the bottom of the hole, rad."""

AT_TOP = 1e-6
"""An angle this close to the top of the hole, rad, counts as the top. Rounding then does not choose its side."""


def turns_from_bottom(angle: float) -> float:
    """The whole turns from the bottom of the hole to an angle, rad: 0 for angles in (-3 pi/2, pi/2].

    An angle at the top to within :data:`AT_TOP` counts as pi/2.
    """
    return math.ceil((angle - BOTTOM - AT_TOP) / (2.0 * math.pi) - 0.5)


def near_bottom(angle: float) -> float:
    """An angle moved by whole turns into (-3 pi/2, pi/2], rad: at most half a turn from the bottom of the hole."""
    return angle - 2.0 * math.pi * turns_from_bottom(angle) if math.isfinite(angle) else angle


def interval_near_bottom(start: float, stop: float) -> tuple[float, float]:
    """An interval moved by whole turns, rad. Its middle then lies in (-3 pi/2, pi/2].

    An interval across the top may so begin before -3 pi/2 or end after pi/2.
    """
    turn = 2.0 * math.pi * turns_from_bottom(0.5 * (start + stop))
    return start - turn, stop - turn


def degrees_from_bottom(angle: float, turns: float = 0.0) -> float:
    """An angle in rad as degrees from the bottom of the hole, less a number of whole turns."""
    return 180.0 - (180.0 - (math.degrees(angle) + 90.0) + 360.0 * turns)


def from_bottom(angle: float) -> float:
    """An angle in rad as degrees from the bottom of the hole, in (-180, 180]."""
    return degrees_from_bottom(angle, turns_from_bottom(angle))


def interval_from_bottom(start: float, stop: float) -> tuple[float, float]:
    """An interval in rad as degrees from the bottom of the hole. Its middle lies in (-180, 180]."""
    first = degrees_from_bottom(start, turns_from_bottom(0.5 * (start + stop)))
    return first, first + math.degrees(stop - start)


DEGREE = math.pi / 180.0
"""A degree, rad."""


def angle_at(degrees: Any) -> Any:
    """The angle in rad at so many degrees from the bottom of the hole; a number or an array."""
    return (degrees - 90.0) * DEGREE


def degrees_at(angle: float) -> float:
    """The degrees from the bottom of the hole that :func:`angle_at` turns into an angle, rad: the shortest number.

    Where no number does so, it is the nearest one: the angle that comes back may differ in the last digit.
    """
    return _shortest(angle, angle / DEGREE + 90.0, angle_at)


def degrees_of(angle: float) -> float:
    """A difference of angles, rad, in degrees: the shortest number that gives it back. See :func:`degrees_at`."""
    return _shortest(angle, angle / DEGREE, lambda degrees: degrees * DEGREE)


def meant_degrees(degrees: float) -> int:
    """The multiple of 15 degrees that an angle equals if it is in rad by mistake; 0 if it is not.

    1.5708 is meant as 90. Such an angle has three digits after the point, the last one less than one off, and is within
    2e-4 of its size from a multiple of pi/12. Hardly any other angle is so.
    """
    parts = degrees / (15.0 * DEGREE)
    away = abs(parts - round(parts))
    digits = len(repr(degrees).partition(".")[2])
    rounded = away <= min(2e-4 * abs(parts), max(10.0**-digits, 1e-14) / (15.0 * DEGREE))
    return 15 * round(parts) if 1.0 <= abs(round(parts)) <= 24 and digits > 2 and rounded else 0


def _shortest(angle: float, degrees: float, back: Callable[[float], float]) -> float:
    """The number near `degrees` with the fewest decimals that `back` turns into the angle; else `degrees`."""
    rounded = (round(degrees, decimals) for decimals in range(14))
    near = (math.nextafter(degrees, end) for end in (-math.inf, math.inf))
    return next((each for each in (*rounded, degrees, *near) if back(each) == angle), degrees)


def cos_degrees(angle: float) -> float:
    """The cosine of an angle in degrees, exact where it is 0, 1 or -1."""
    quarters = angle / 90.0
    return (1.0, 0.0, -1.0, 0.0)[int(quarters) % 4] if quarters.is_integer() else math.cos(math.radians(angle))

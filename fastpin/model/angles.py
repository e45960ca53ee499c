"""Angles round the hole, and their differences."""

from __future__ import annotations

import math

import numpy as np


def angle_between(angles: np.ndarray | float, angle: np.ndarray | float) -> np.ndarray:
    """The differences `angles` - `angle`, the short way round: -pi to pi rad, positive counter-clockwise."""
    return np.remainder(np.asarray(angles) - angle + math.pi, 2.0 * math.pi) - math.pi


BOTTOM = -0.5 * math.pi
"""Angle of the bottom of the hole, rad."""


def from_bottom(angle: float) -> float:
    """An angle in rad as degrees from the bottom of the hole, in (-180, 180]."""
    degrees = math.degrees(angle) + 90.0
    return 180.0 - (180.0 - degrees) % 360.0


def interval_from_bottom(start: float, stop: float) -> tuple[float, float]:
    """An interval in rad as degrees from the bottom of the hole. Its stop may exceed 180."""
    first = from_bottom(start)
    return first, first + math.degrees(stop - start)

"""Angles round the hole, and their differences."""

from __future__ import annotations

import math

import numpy as np


def angle_between(angles: np.ndarray | float, angle: np.ndarray | float) -> np.ndarray:
    """How far `angles` are from `angle`, rad, the short way round: -pi to pi, positive counter-clockwise."""
    return np.remainder(np.asarray(angles) - angle + math.pi, 2.0 * math.pi) - math.pi


BOTTOM = -0.5 * math.pi


def from_bottom(angle: float) -> float:
    """An angle in rad as degrees from the bottom of the hole, in (-180, 180]."""
    degrees = math.degrees(angle) + 90.0
    return 180.0 - (180.0 - degrees) % 360.0


def interval_from_bottom(start: float, stop: float) -> tuple[float, float]:
    """An interval in rad as degrees from the bottom; the stop may exceed 180."""
    first = from_bottom(start)
    return first, first + math.degrees(stop - start)

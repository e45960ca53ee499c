"""Turning points of a measured record: where it reverses by more than its noise."""

from __future__ import annotations

import math

import numpy as np

NOISES, PART = 8.0, 0.02
"""A reversal counts if it is wider than so many standard deviations of the noise, and than this part of the range.

Eight found all turning points in 12 records with 50 to 500 samples a cycle and noise up to 3 %. The largest gap between
the ranges of all reversals failed in each record without noise.
"""


def noise(values: np.ndarray) -> float:
    """Return the standard deviation of the noise on a smooth record (n,), from its third differences.

    Their median is not moved by the few samples at the turning points. White noise of deviation 1 has third
    differences of deviation sqrt(20).
    """
    return 1.4826 * float(np.median(np.abs(np.diff(values, 3)))) / math.sqrt(20.0) if values.size > 3 else 0.0


def least_reversal(values: np.ndarray) -> float:
    """Return the width of the smallest reversal that is no noise of a record (n,), in its unit."""
    return max(NOISES * noise(values), PART * float(np.ptp(values)))


def turning_points(values: np.ndarray, width: float) -> np.ndarray:
    """Return the places of the turning points of a record (n,): extremes from which it returns by more than `width`.

    The first one lies further than `width` from the first sample. Neither end of the record is one.
    """
    places: list[int] = []
    low = high = direction = 0
    for place, value in enumerate(values.tolist()):
        high = place if value > values[high] else high
        low = place if value < values[low] else low
        if direction >= 0 and value < values[high] - width:
            if direction or values[high] > values[0] + width:
                places.append(high)
            direction, low = -1, place
        elif direction <= 0 and value > values[low] + width:
            if direction or values[low] < values[0] - width:
                places.append(low)
            direction, high = 1, place
    return np.array(places, dtype=int)

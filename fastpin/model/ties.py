"""Ties: a largest value at several places, such as an angle and its mirror image.

Rounding must not decide which place is reported. So values that agree to :data:`TIE` are equal, and a rule takes one of
their places: the first one in time, or the place farthest to the right round the hole.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fastpin.model.angles import AT_TOP

TIE = 1e-9
"""Relative difference up to which two largest values are equal. Mirrored histories agree to 1e-12."""


def top(values: Sequence[float] | np.ndarray) -> int:
    """The place of the largest of `values`, in time: of equal ones the first."""
    return int(np.argmax(is_top(np.ravel(values))))


def top_angle(values: np.ndarray, theta: np.ndarray) -> int:
    """The place of the largest of `values` at angles `theta`, rad, in the flat arrays: of equal ones the rightmost.

    That is the place with the largest angle from the bottom of the hole, in (-180, 180] deg. Of several places at this
    angle it is the first.
    """
    flat = np.ravel(values)
    largest = float(flat.max(initial=-np.inf))
    (equal,) = (
        flat >= min((1.0 - TIE) * largest, (1.0 + TIE) * largest)
    ).nonzero()  # as is_top, at a third of its time
    return int(equal[0] if equal.size == 1 else equal[top_angles(flat[None, equal], np.ravel(theta)[equal])[0]])


def top_angles(values: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The places of :func:`top_angle` in many rows of values, shape (k, n), at the same angles (n,): shape (k,)."""
    order = np.argsort(np.remainder(0.5 * math.pi + AT_TOP - theta, 2.0 * math.pi), kind="stable")
    found: np.ndarray = order[np.argmax(is_top(values[:, order]), axis=-1)]
    return found


def is_top(values: np.ndarray) -> np.ndarray:
    """Whether values (..., n) equal the largest one of their row."""
    equal: np.ndarray = values >= least_equal(values.max(axis=-1, keepdims=True, initial=-np.inf))
    return equal


def least_equal(largest: np.ndarray) -> np.ndarray:
    """The least values that are equal to largest values of the same shape. They may be negative, or infinite."""
    return np.minimum((1.0 - TIE) * largest, (1.0 + TIE) * largest)

"""Curves of the tractions of a state, for figures and the live page.

They follow the power laws at contact edges and stick-slip borders, see :mod:`fastpin.reading.refined`. Their points
gather there. Between the nodes elsewhere they are smooth.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.model.angles import distinct
from fastpin.runtime.extensions import interpolate
from fastpin.states.state import State


def traction_patches(state: State) -> list[np.ndarray]:
    """The curve of each contact zone, shape (k, 3): degrees from the bottom, pressure and shear traction.

    The angles increase, and may lie some whole turns from the bottom. The tractions are in Pa or F/R. A curve all round
    ends where it begins, a whole turn further.
    """
    patches = []
    for patch in state.refined.tractions.patches:
        points = np.column_stack([np.degrees(patch[:, 0]) + 90.0, patch[:, 1:]])
        points = points[np.append(np.diff(points[:, 0]) > 0.0, True)]  # rounding may join neighbours
        points = _smoothed(points)
        # Fits and cubics may pass the bound by some 0.5 % of the peak.
        most = friction_along(state, points[:, 0]) * points[:, 1]
        points[:, 2] = np.clip(points[:, 2], -most, most)
        patches.append(points)
    return patches


def friction_along(state: State, angle: np.ndarray) -> np.ndarray:
    """Coefficient of friction of a state at angles (m,), degrees from the bottom, shape (m,)."""
    return state.friction_at(np.radians(angle - 90.0))


def tractions_at(patches: list[np.ndarray], angle: np.ndarray) -> np.ndarray:
    """Pressure and shear traction of the curves at some angles, shape (2, m); 0 beside the curves.

    Parameters
    ----------
    patches : list of ndarray
        The curves of :func:`traction_patches`.
    angle : ndarray, shape (m,)
        Degrees from the bottom.
    """
    values = np.zeros((2, angle.size))
    for points in patches:
        turned = points[0, 0] + np.mod(angle - points[0, 0], 360.0)
        for row, column in zip(values, points.T[1:], strict=True):
            row += np.interp(turned, points[:, 0], column, right=0.0)
    return values


def _smoothed(points: np.ndarray) -> np.ndarray:
    """A curve with more points where its own are far apart: on monotone cubics, which keep its corners and peaks."""
    steps, finest = np.diff(points[:, 0]), 0.5  # degrees
    wide = np.flatnonzero(steps > finest)
    if len(points) < 3 or not wide.size:
        return points
    shares = [np.arange(1, math.ceil(steps[k] / finest)) / math.ceil(steps[k] / finest) for k in wide]
    between = np.concatenate([points[k, 0] + steps[k] * share for k, share in zip(wide, shares, strict=True)])
    every = distinct(np.r_[points[:, 0], between])
    return np.column_stack([every, interpolate.PchipInterpolator(points[:, 0], points[:, 1:])(every)])


def thinned(points: np.ndarray, error: float) -> np.ndarray:
    """A curve, shape (k, 3), with fewer points. Straight lines between them are wrong by at most `error` a pass."""
    for _ in range(4):  # each pass drops at most every other point
        if len(points) < 3:
            break
        before, middle, after = points[:-2:2], points[1:-1:2], points[2::2]
        share = (middle[:, :1] - before[:, :1]) / (after[:, :1] - before[:, :1])
        needed = np.any(np.abs(before + share * (after - before) - middle)[:, 1:] > error, axis=1)
        keep = np.ones(len(points), dtype=bool)
        keep[1:-1:2] = needed
        points = points[keep]
    return points


def one_turn(patches: list[np.ndarray]) -> np.ndarray:
    """The curves on one turn as a single array, shape (k, 3). Between two curves is a row of NaN.

    The angles increase from -180 to 180 degrees from the bottom. A curve across the top has a part at either end.
    """
    parts = []
    for points in patches:
        first = math.floor((points[0, 0] + 180.0) / 360.0)
        last = math.ceil((points[-1, 0] + 180.0) / 360.0)
        for turn in range(first, last):
            turned = points - [360.0 * turn, 0.0, 0.0]
            low, high = max(turned[0, 0], -180.0), min(turned[-1, 0], 180.0)
            inside = turned[(turned[:, 0] > low) & (turned[:, 0] < high)]
            ends = [np.interp([low, high], turned[:, 0], column) for column in turned.T]
            parts.append(np.insert(np.column_stack(ends), 1, inside, axis=0))
    parts.sort(key=lambda part: part[0, 0])
    joined: list[np.ndarray] = []
    for part in parts:
        if joined and part[0, 0] > joined[-1][-1, 0]:
            joined.append(np.full((1, 3), np.nan))
        joined.append(part)
    return np.concatenate(joined) if joined else np.zeros((0, 3))

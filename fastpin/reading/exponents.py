"""Exponents of the tractions at edges of the contact and at borders of stick zones, (T21), (T26)."""

from __future__ import annotations

import math

import numpy as np


def tilts(friction: np.ndarray, coupling: float) -> np.ndarray:
    """Shift of the exponents of edges and borders away from 1/2, arctan(mu beta_D)/pi, (T26), shape (n,).

    `friction`, shape (n,), is mu at the nodes, and `coupling` is beta_D.
    """
    values, places = np.unique(friction, return_inverse=True)
    return np.array([math.atan(value * coupling) / math.pi for value in values.tolist()])[places]


def contact_exponents(status: np.ndarray, tilt: np.ndarray, run: np.ndarray) -> tuple[float, float]:
    """Exponents of the pressure at both ends of the contact of the nodes `run`, (T21).

    `status` and `tilt`, shape (n,), are those of the state.
    """
    first, last = status[run[[0, -1]]]
    at_first, at_last = tilt[run[[0, -1]]].tolist()
    return 0.5 - at_first * float(first), 0.5 + at_last * float(last)


def stick_exponents(shear: np.ndarray, tilt: np.ndarray, run: np.ndarray) -> tuple[float, float]:
    """Exponents of mu N - |T| at both ends of the stick zone of the nodes `run`, (T26).

    `shear` and `tilt`, shape (n,), are those of the state.
    """
    before, after = signs_beside(shear, run)
    at_first, at_last = tilt[run[[0, -1]]].tolist()
    return 0.5 - at_first * before, 0.5 + at_last * after


def signs_beside(shear: np.ndarray, run: np.ndarray) -> tuple[int, int]:
    """Signs of the shear traction, shape (n,), before and after the stick zone of the nodes `run`.

    They are 0 beside an open node, and for a stick zone all round.
    """
    if run.size == shear.size:
        return 0, 0
    before, after = np.sign(shear[[run[0] - 1, (run[-1] + 1) % shear.size]])
    return int(before), int(after)

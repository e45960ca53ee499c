"""Exponents of the tractions at edges of the contact and at borders of stick zones, (T21), (T26)."""

from __future__ import annotations

import numpy as np


def contact_exponents(status: np.ndarray, tilt: float, run: np.ndarray) -> tuple[float, float]:
    """Exponents of the pressure at both ends of the contact of the nodes `run`, (T21).

    `status`, shape (n,), and `tilt` are those of the state.
    """
    first, last = status[run[[0, -1]]]
    return 0.5 - tilt * float(first), 0.5 + tilt * float(last)


def stick_exponents(shear: np.ndarray, tilt: float, run: np.ndarray) -> tuple[float, float]:
    """Exponents of mu N - |T| at both ends of the stick zone of the nodes `run`, (T26).

    `shear`, shape (n,), and `tilt` are those of the state.
    """
    before, after = signs_beside(shear, run)
    return 0.5 - tilt * before, 0.5 + tilt * after


def signs_beside(shear: np.ndarray, run: np.ndarray) -> tuple[int, int]:
    """Signs of the shear traction, shape (n,), before and after the stick zone of the nodes `run`.

    They are 0 beside an open node, and for a stick zone all round.
    """
    if run.size == shear.size:
        return 0, 0
    before, after = np.sign(shear[[run[0] - 1, (run[-1] + 1) % shear.size]])
    return int(before), int(after)

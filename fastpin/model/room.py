"""The room of a rigid pin in a hole that is not round."""

from __future__ import annotations

import numpy as np

from fastpin.runtime.extensions import optimize


def widest_place(theta: np.ndarray, gap: np.ndarray, fixed: tuple[bool, bool]) -> tuple[float, np.ndarray]:
    """The place at which the narrowest gap round a rigid pin is widest: a linear programme.

    Parameters
    ----------
    theta : ndarray, shape (n,)
        Angles round the hole, rad.
    gap : ndarray, shape (n,)
        Gap there when the pin is concentric. Negative where pin and hole overlap.
    fixed : (bool, bool)
        Whether the pin can't move along x, and along y.

    Returns
    -------
    (float, ndarray)
        The narrowest gap at this place, and the place, shape (2,), in the unit of `gap`. A negative gap says that the
        pin fits nowhere.
    """
    size = max(float(np.abs(gap).max()), 1e-300)
    bounds = [(None, None), *((0.0, 0.0) if held else (None, None) for held in fixed)]
    cos, sin = np.cos(theta), np.sin(theta)
    rows = np.column_stack([np.ones_like(theta), cos, sin])
    place = size * optimize.linprog([-1.0, 0.0, 0.0], rows, gap / size, bounds=bounds).x[1:]
    return float((gap - place[0] * cos - place[1] * sin).min()), place

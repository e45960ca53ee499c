"""Joints of the tests of cracks."""

from collections.abc import Callable
from typing import Any

import numpy as np

import fastpin
from fastpin.cracks import Crack, Growth, Nasgro

M = 1e6
"""Pa sqrt(m) in MPa sqrt(m)."""

NASGRO = Nasgro(6.35e-10, 2.5, 1.0, 1.0, 0.8 * M, 35.16 * M, 2.2, 0.1, 2.0, 0.3, 38.1e-6)

LIKE = fastpin.Material(70e9, 0.33)

DIRECTION = {"bulk": -120.0, "lug": -24.0, "Q": -8.0, "small": -24.0}
"""Angle of the mouth in each case of tests/cracks/conftest.py, deg."""


def problem_of(pin: fastpin.Material, clearance: float, friction: float, **fields) -> fastpin.Problem:
    """A plate of aluminium with a hole of 10 mm under a body-loaded pin."""
    return fastpin.Problem(fastpin.MaterialPair(pin, LIKE), 10e-3, clearance, friction, pin_load="body", **fields)


def made(states: list[fastpin.State], law: Any, K_max: Callable[[np.ndarray], Any], K_min: float = 0.0) -> Growth:
    """A crack from 0.1 to 10 mm with this largest K_I at its 401 lengths, at the second of two states."""
    length = np.geomspace(1e-4, 1e-2, 401)
    top, zeros = np.broadcast_to(K_max(length), 401), np.zeros(401)
    at = np.full(401, 2.0), {2.0: states[1].load}
    return Growth(states[0].problem, Crack(0.3), law, length, top, np.full(401, K_min), zeros, *at)

"""Formulas of the contact under P for a spreadsheet: the largest pressure and the half-angle of the contact.

They are fits to fastpin's own numbers. docs/handbook-formulas.md states their errors, and has spreadsheet lines.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fastpin.model.checks import choice, numbers
from fastpin.model.joint import PinLoad

LEAST = -0.06
"""Smallest load parameter, an interference fit. At -0.0796 the contact closes round the pin."""

FRICTION_TERMS: dict[PinLoad, tuple[float, float, float, float, float]] = {
    "body": (0.601, 0.357, 5.96, 2.92, 9.21),
    "centre": (0.414, 0.342, 7.69, 3.87, 16.1),
}
"""Constants of the part that friction takes off, by the load of the pin."""


def peak_pressure(load_parameter: ArrayLike, friction: float = 0.0, pin_load: PinLoad = "body") -> np.ndarray:
    """Return the largest pressure over F/(D L), from a fit.

    p^2 = 1.438 + 16 L/pi - 1.657 L/(1 + 10.64 L) - [a + b/(1 + c L)] x/sqrt(1 + x^2) with x = mu (d + e L). L is the
    load parameter.

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, at least :data:`LEAST`; with friction at least 0.
    friction : float
        mu, 0 to 0.9.
    pin_load : {"body", "centre"}

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    mu = float(numbers("friction", friction, 0.0, 0.9))
    value = numbers("load_parameter", load_parameter, 0.0 if mu else LEAST)
    choice("pin_load", pin_load, tuple(FRICTION_TERMS))
    a, b, c, d, e = FRICTION_TERMS[pin_load]
    x = mu * (d + e * value)
    lost = (a + b / (1.0 + c * value)) * x / np.sqrt(1.0 + x * x)
    square = 1.438 + 16.0 / math.pi * value - 1.657 * value / (1.0 + 10.64 * value) - lost
    return np.asarray(np.sqrt(square))


def half_angle(load_parameter: ArrayLike) -> np.ndarray:
    """Return half of the contact angle without friction, rad, from a fit: 1/sqrt(0.4563 + pi L + 0.49 L/(1 + 5.85 L)).

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, at least :data:`LEAST`.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    value = numbers("load_parameter", load_parameter, LEAST)
    return np.asarray(1.0 / np.sqrt(0.4563 + math.pi * value + 0.49 * value / (1.0 + 5.85 * value)))

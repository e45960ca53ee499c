"""Formulas of the contact under P for a spreadsheet: the largest pressure and the half-angle of the contact.

They are fits to fastpin's own numbers. docs/handbook-formulas.md states their errors, and has spreadsheet lines.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fastpin.bodies.body import PinLoad
from fastpin.model.checks import choice, instance, number, numbers
from fastpin.model.materials import Material, Plane

LEAST = -0.06
"""Smallest load parameter, an interference fit. At -0.0796 the contact closes round the pin."""

MOST_FRICTION = 0.9
"""Largest coefficient of friction of the fit."""

SPREAD = 0.5 / 2.8
"""The term of a spread load in plane strain, nu = 0.3."""


def load_term(pin: Material, plane: Plane = "strain", pin_load: PinLoad = "body") -> float:
    """Return the term q of the pin's load: w/(kappa + 1) with w = 1/2 for a body force, 1 for a load at the centre.

    In plane strain kappa + 1 = 4 (1 - nu), in plane stress 4/(1 + nu).

    Raises
    ------
    InputError
        If the load or the plane is unknown, or `pin` is no Material.
    """
    instance("pin", pin, Material, "a Material")
    choice("pin_load", pin_load, ("body", "centre"))
    choice("plane", plane, ("strain", "stress"))
    return (0.5 if pin_load == "body" else 1.0) / (pin.kolosov(plane) + 1.0)


def peak_pressure(load_parameter: ArrayLike, friction: float = 0.0, term: float = SPREAD) -> np.ndarray:
    """Return the largest pressure over F/(D L) of like bodies, from a fit.

    p^2 = 1.438 + 16 L/pi - 1.657 L/(1 + 10.64 L) - [0.803 - 1.18 q + 0.369/(1 + 5.95 L)] x/sqrt(1 + x^2) with
    x = mu (1.88 + 5.88 q) (1 + 3.17 L). L is the load parameter, q the term of the pin's load.

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, at least :data:`LEAST`; with friction at least 0.
    friction : float
        mu, 0 to :data:`MOST_FRICTION`.
    term : float
        q, 0.125 to 0.5, see :func:`load_term`.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    mu = number("friction", friction, 0.0, MOST_FRICTION)
    value = numbers("load_parameter", load_parameter, 0.0 if mu else LEAST)
    q = number("term", term, 0.125, 0.5)
    x = mu * (1.88 + 5.88 * q) * (1.0 + 3.17 * value)
    lost = (0.803 - 1.18 * q + 0.369 / (1.0 + 5.95 * value)) * x / np.sqrt(1.0 + x * x)
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

"""Handbook formulas of the largest pressure against fastpin: Hertz, 4 F/(pi D L), F/(D L), and calculators' envelope.

D = 2 R is the diameter and L the length, so F/(D L) is half of P/R. The pin is pushed by a body force. Errors are
formula over fastpin minus 1: negative ones are unsafe.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fastpin.bodies.body import PinLoad
from fastpin.model import MATERIALS, MaterialPair, Problem
from fastpin.model.checks import choice, instance, number, numbers
from fastpin.model.materials import Material, Plane
from fastpin.published.records import Benchmark, Outcome, Report, Row
from fastpin.solver.solving import solve
from fastpin.verification import closed_forms
from fastpin.verification.rows import half_width

PAIRS = {
    "like bodies": MaterialPair(MATERIALS["steel"], MATERIALS["steel"]),
    "steel in aluminium": MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"]),
    "steel in PEEK": MaterialPair(MATERIALS["steel"], MATERIALS["PEEK"]),
}
COSINE = 4.0 / math.pi
"""4 F/(pi D L) over F/(D L): the peak of a pressure like the cosine over half the hole."""
CROSSING = 1.0 / math.pi
"""L_p at which Hertz's pressure is 4 F/(pi D L). The envelope is lowest there against fastpin."""

LEAST = -0.06
"""Smallest load parameter, an interference fit. At -0.0796 the contact closes round the pin."""

MOST_FRICTION = 0.9
"""Largest coefficient of friction of the fit."""

SPREAD = 0.5 / 2.8
"""The term of a spread load in plane strain, nu = 0.3."""


def hertz(load_parameter: np.ndarray) -> np.ndarray:
    """Return Hertz's peak pressure over F/(D L)."""
    return np.asarray(2.0 * closed_forms.hertz_peak_pressure(load_parameter))


def envelope(load_parameter: np.ndarray) -> np.ndarray:
    """Return the envelope of calculators over F/(D L): the larger of Hertz and 4/pi."""
    return np.maximum(hertz(load_parameter), COSINE)


def solved(pair: MaterialPair, load_parameter: float, friction: float) -> tuple[float, float]:
    """Return the largest pressure over F/(D L), and half of the contact angle, rad, under P.

    The error of the pressure is below 1e-3, small against the 5 % of the chart.
    """
    problem = Problem.from_load_parameter(pair, load_parameter, friction, "body")
    state = solve(problem, [{"P": 1.0}], nodes=101)[-1]
    return 2.0 * state.peak_pressure, half_width(state.contact[0])


def compute(progress: Report | None = None) -> Outcome:
    """Solve like bodies without friction, where the calculator makes its claim."""
    peak, angle = solved(PAIRS["like bodies"], CROSSING, 0.0)
    if progress is not None:
        progress(1.0)
    above = peak / float(envelope(np.array(CROSSING))) - 1.0
    unsafe = "differs: the envelope is unsafe by more than its source states"
    return Outcome([
        Row("largest part above the envelope, no friction", "", "0.15", above, unsafe),
        Row("half-angle of contact at this place", "deg", "", math.degrees(angle), "comparison only"),
    ])  # fmt: skip


BENCHMARK = Benchmark(
    "handbook-formulas",
    "Handbook formulas: largest pressure over F/(D L) against load parameter and friction",
    "Pin with clearance in a wide plate, plane strain, pushed by a body force. A calculator takes the larger of Hertz "
    "and 4 F/(pi D L). It calls this a conservative envelope, and states that the true value may be 5 to 15 % above it"
    " between both.",
    ["pin contact calculator, html-tools-efi.pages.dev/pin_contact_tool.html"],
    compute,
)


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

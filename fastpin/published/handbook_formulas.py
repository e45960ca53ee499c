"""Handbook formulas of the largest pressure against fastpin: Hertz, 4 F/(pi D L), F/(D L), and calculators' envelope.

D = 2 R is the diameter and L the length, so F/(D L) is half of P/R. The pin is pushed by a body force. Errors are
formula over fastpin minus 1: negative ones are unsafe.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import COLOURS, Line, line
from fastpin.model import MATERIALS, MaterialPair, Problem
from fastpin.model.checks import choice, instance, number, numbers
from fastpin.model.materials import Material, Plane
from fastpin.published.records import Benchmark, Outcome, Report, Row, head, legend_below, panels, steps
from fastpin.solver.solving import solve
from fastpin.verification import closed_forms
from fastpin.verification.rows import half_width

PAIRS = {
    "like bodies": MaterialPair(MATERIALS["steel"], MATERIALS["steel"]),
    "steel in aluminium": MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"]),
    "steel in PEEK": MaterialPair(MATERIALS["steel"], MATERIALS["PEEK"]),
}
LOAD_PARAMETERS = tuple(10.0 ** (k / 6) for k in range(-15, 7))
FRICTION = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 0.9)
COSINE = 4.0 / math.pi
"""4 F/(pi D L) over F/(D L): the peak of a pressure like the cosine over half the hole."""
CROSSING = 1.0 / math.pi
"""L_p at which Hertz's pressure is 4 F/(pi D L). The envelope is lowest there against fastpin."""
LEVEL = 0.05
"""Error up to which a formula holds."""

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
    """Solve all pairs. The rows are about like bodies without friction, where the calculator makes its claim."""
    cases = [(words, friction) for words in PAIRS for friction in FRICTION]
    load_parameters = np.array(LOAD_PARAMETERS)
    curves = []
    for words, friction in steps(cases, progress):
        numbers = np.array([solved(PAIRS[words], value, friction) for value in LOAD_PARAMETERS])
        peak, angle = numbers.T
        columns = {"L_p": load_parameters, "half_angle_deg": np.degrees(angle), "peak_over_F_DL": peak}
        formulas = {
            "hertz": hertz(load_parameters), "cosine": COSINE, "projected": 1.0, "envelope": envelope(load_parameters),
            "fit": peak_pressure(load_parameters, friction, load_term(PAIRS[words].pin)),
        }  # fmt: skip
        columns |= {f"error_{name}": values / peak - 1.0 for name, values in formulas.items()}
        curves.append(Curve({"pair": words, "friction": friction}, columns))
    peak, angle = solved(PAIRS["like bodies"], CROSSING, 0.0)
    above = peak / float(envelope(np.array(CROSSING))) - 1.0
    unsafe = "differs: the envelope is unsafe by more than its source states"
    rows = [
        Row("largest part above the envelope, no friction", "", "0.15", above, unsafe),
        Row("half-angle of contact at this place", "deg", "", math.degrees(angle), "comparison only"),
    ]
    return Outcome(rows, curves)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the largest pressure, and for each pair the regions in which a formula holds to 5 %."""
    figure, axes = panels(2, 2, height=3.2)
    head(
        figure,
        "Body force F on the pin, plane strain; D: diameter, L: length of the pin",
        f"shaded: a formula holds to {100.0 * LEVEL:g} %; dotted: Hertz's pressure is 4F/(πDL)",
    )
    figure.set_layout_engine("constrained", hspace=0.06)  # the axes of the half-angle need room
    _draw_peaks(axes[0, 0], [curve for curve in curves if curve.parameters["pair"] == "like bodies"])
    for panel, words in zip(axes.flat[1:], PAIRS, strict=True):
        _draw_regions(panel, [curve for curve in curves if curve.parameters["pair"] == words])
        panel.set_title(words, fontsize=9.0, pad=16.0)
    return figure


def _draw_peaks(panel: Axes, curves: Sequence[Curve]) -> None:
    """Draw the largest pressure of like bodies, the fit and the formulas."""
    load_parameters = np.array(LOAD_PARAMETERS)
    entries: list[tuple[str, Line]] = []
    for colour, friction in enumerate((0.0, 0.3, 0.9)):
        (curve,) = (one for one in curves if one.parameters["friction"] == friction)
        style = line(colour, colour)
        panel.plot(load_parameters, curve["peak_over_F_DL"], **style)
        fit: Line = {"color": COLOURS[colour], "linestyle": "none", "marker": "ox+"[colour], "markersize": 3.5}
        panel.plot(load_parameters[::2], peak_pressure(load_parameters[::2], friction), **fit)
        entries += [(f"friction {friction:g}", style), (f"fit, {friction:g}", fit)]
    for height, words in ((COSINE, "4F/(πDL)"), (1.0, "F/(DL)")):
        panel.axhline(height, color="0.2", linewidth=0.9, zorder=1)
        panel.annotate(words, (load_parameters[0], height), (3, 3), textcoords="offset points", fontsize=7.5)
    panel.plot(load_parameters, hertz(load_parameters), color="0.2", linewidth=0.9, zorder=1)
    panel.text(0.15, 0.6, "Hertz", fontsize=7.5)
    panel.set_xscale("log")
    panel.set_ylim(0.5, 3.0)
    panel.set_xlim(load_parameters[0], 3.0)
    panel.set_xlabel("load parameter  $L_p$")
    panel.set_ylabel("largest pressure over F/(DL)")
    panel.set_title("like bodies", fontsize=9.0)
    legend_below(panel, entries, 3)


def _draw_regions(panel: Axes, curves: Sequence[Curve]) -> None:
    """Draw the regions of one pair. Their names stand above them."""
    load_parameters = np.array(LOAD_PARAMETERS)
    names = (("hertz", "Hertz", "center", 4.0), ("cosine", "4F/(πDL)", "left", 0.17),
             ("projected", "F/(DL)", "right", 0.12))  # fmt: skip
    for colour, (name, words, side, at) in enumerate(names):
        error = np.array([curve[f"error_{name}"] for curve in curves])
        look: dict[str, Any] = {"levels": [-LEVEL, LEVEL], "colors": [COLOURS[colour]]}
        panel.contourf(load_parameters, FRICTION, error, **look, alpha=0.3)
        panel.contour(load_parameters, FRICTION, error, **look, linestyles="solid")
        panel.text(at, 1.02 * FRICTION[-1], words, fontsize=7.5, ha=side)
    panel.axvline(CROSSING, color="0.2", linewidth=0.9, linestyle=":")
    panel.set_xscale("log")
    panel.set_xlabel("load parameter  $L_p$")
    panel.set_ylabel("coefficient of friction")
    degrees = panel.secondary_xaxis(-0.28, functions=(_degrees, _load_parameter))
    degrees.set_xlabel("half-angle of contact, no friction (deg)", fontsize=8.0)
    degrees.set_xticks([80.0, 60.0, 45.0, 30.0, 20.0, 10.0], labels=["80", "60", "45", "30", "20", "10"])
    degrees.set_xticks([], minor=True)
    degrees.tick_params(labelsize=8.0)


def _degrees(load_parameter: ArrayLike) -> np.ndarray:
    return np.degrees(half_angle(np.maximum(load_parameter, 0.0)))


def _load_parameter(degrees: ArrayLike) -> np.ndarray:
    """The inverse of :func:`_degrees`, by interpolation."""
    load_parameters = np.logspace(-4.0, 4.0, 401)
    return np.exp(np.interp(-np.asarray(degrees), -_degrees(load_parameters), np.log(load_parameters)))


BENCHMARK = Benchmark(
    "handbook-formulas",
    "Handbook formulas: largest pressure over F/(D L) against load parameter and friction",
    "Pin with clearance in a wide plate, plane strain, pushed by a body force. A calculator takes the larger of Hertz "
    "and 4 F/(pi D L). It calls this a conservative envelope, and states that the true value may be 5 to 15 % above it"
    " between both.",
    ["pin contact calculator, html-tools-efi.pages.dev/pin_contact_tool.html"],
    compute,
    draw,
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

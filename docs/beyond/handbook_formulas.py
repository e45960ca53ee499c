"""Handbook formulas of the largest pressure: the pressure over the load parameter, and where a formula holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fastpin.assess.outputs import Curve
from fastpin.figures.style import COLOURS, Line, line
from fastpin.published.handbook_formulas import (
    COSINE,
    CROSSING,
    PAIRS,
    envelope,
    half_angle,
    hertz,
    load_term,
    peak_pressure,
    solved,
)
from fastpin.published.records import PaperFigure, Report, head, legend_below, panels, steps

LOAD_PARAMETERS = tuple(10.0 ** (k / 6) for k in range(-15, 7))
FRICTION = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 0.9)
LEVEL = 0.05
"""Error up to which a formula holds."""


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Return the pressures of all pairs and the errors of all formulas. They have nodes of their own."""
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
    return curves


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


FIGURES = (
    PaperFigure("handbook-formulas", "Largest pressure, and where a handbook formula holds to 5 %", 5, compute, draw),
)

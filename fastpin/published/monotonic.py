"""Figures 3, 4, 6, 7 and 9: tractions of a pin that is pushed down once.

*Figures 3 and 6.* The captions give L_p = 0.01 (left) and 0.1 (right). The coefficients of friction are our choice.

*Figures 4 and 7.* By the captions, the paper shows the pressure without friction too, and more friction than the
largest shown changes nothing visible. By the text, for L_p = 0.5 and aluminium plates the shear hardly changes beyond
mu = 0.4. The other two load parameters are our choice. In figure 4 their largest friction has the same effect: with
mu = 2.0 instead, the shear changes by less than 2 % of its peak, the pressure by less than 0.1 %. In figure 7 the shear
still changes by up to 5 % of its peak.

*Figures 6 and 7.* The material of both bodies, Ti-6Al-4V, is our choice: for similar materials only Poisson's ratio
matters.

*Figure 9.* The caption gives mu = 0.4. The load parameters are our choice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import Line, line
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.tractions import NAMES, Panel, chosen, pushed, traction_curve, traction_figure, values_of


def body_loads(
    name: str, title: str, pair: str, friction: Mapping[float, Sequence[float]], legend: Sequence[tuple[str, int]]
) -> PaperFigure:
    """Return a figure of the tractions of a body-loaded pin, with a column for each load parameter.

    Parameters
    ----------
    name, title, pair : str
    friction : mapping
        The coefficients of friction of each load parameter.
    legend : sequence of (str, int)
        Words and dashes of the first, second ... coefficient of all columns.
    """
    entries = [(words, line(dashes, dashes)) for words, dashes in legend]
    lines: dict[tuple[float, float], Line] = {}
    for value, coefficients in friction.items():
        lines |= {(value, mu): style for mu, (_, style) in zip(coefficients, entries, strict=True)}

    def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
        cases = steps(list(lines), progress)
        return [traction_curve(pushed(pair, value, mu, nodes), pair=pair, L_p=value, mu=mu) for value, mu in cases]

    def draw(curves: Sequence[Curve]) -> Figure:
        heading = f"{NAMES[pair]}, plane strain; body force F on the pin, downwards"
        return _column_figure(curves, lambda one: lines[one.parameters["L_p"], one.parameters["mu"]], entries, heading)

    return PaperFigure(name, title, 101, compute, draw)


def _column_figure(
    curves: Sequence[Curve], style: Callable[[Curve], Line], legend: Sequence[tuple[str, Line]], heading: str
) -> Figure:
    """Draw pressure above shear, with a column for each load parameter. Without friction there is no shear."""
    columns = {value: chosen(curves, L_p=value) for value in values_of(curves, "L_p")}
    layout = [
        [Panel("N", column, f"load parameter $L_p$ = {value:g}") for value, column in columns.items()],
        [Panel("T", [curve for curve in column if curve.parameters["mu"] != 0.0]) for column in columns.values()],
    ]
    return traction_figure(layout, style, legend, heading=[heading])


def compare_loads(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Return the tractions under a centre load and a body load, for three load parameters."""
    loads: tuple[PinLoad, PinLoad] = ("centre", "body")
    cases = [(load_parameter, pin_load) for load_parameter in (0.01, 0.1, 0.5) for pin_load in loads]
    curves = []
    for value, pin_load in steps(cases, progress):
        state = pushed("Ti/Al", value, 0.4, nodes, pin_load)
        curves.append(traction_curve(state, L_p=value, mu=0.4, pin_load=pin_load))
    return curves


def draw_loads(curves: Sequence[Curve]) -> Figure:
    """Draw pressure above shear, with one column for each load parameter. Centre loads are solid, body loads dashed."""
    lines = {"centre": line(0, 0), "body": line(1, 1)}
    legend = [("force F at the centre of the pin", lines["centre"]), ("body force F on the whole pin", lines["body"])]
    heading = f"{NAMES['Ti/Al']}, plane strain, friction coefficient 0.4; F acts downwards"
    return _column_figure(curves, lambda curve: lines[curve.parameters["pin_load"]], legend, heading)


_CONFORMING = dict.fromkeys((0.01, 0.1), (0.1, 0.3, 0.5, 0.7))
_CONFORMING_LEGEND = [(f"friction coefficient {mu}", k) for k, mu in enumerate((0.1, 0.3, 0.5, 0.7))]
_LOOSE = {0.25: (0.0, 0.1, 0.2, 0.6), 0.5: (0.0, 0.1, 0.2, 0.4), 1.0: (0.0, 0.1, 0.2, 0.3)}
_LOOSE_LEGEND = [
    ("friction coefficient 0 (pressure only)", 1), ("0.1", 2), ("0.2", 3), ("0.6, 0.4, 0.3 (left, middle, right)", 0),
]  # fmt: skip

FIGURES = (
    body_loads(
        "3", "Tractions in body force loading (Ti-6Al-4V on aluminium), L_p = 0.01 and 0.1",
        "Ti/Al", _CONFORMING, _CONFORMING_LEGEND,
    ),
    body_loads(
        "4", "Tractions in body force loading (Ti-6Al-4V on aluminium) at high L_p and different mu",
        "Ti/Al", _LOOSE, _LOOSE_LEGEND,
    ),
    body_loads(
        "6", "Tractions in body force loading of similar materials (Ti-6Al-4V), L_p = 0.01 and 0.1",
        "Ti/Ti", _CONFORMING, _CONFORMING_LEGEND,
    ),
    body_loads(
        "7", "Tractions in body force loading of similar materials (Ti-6Al-4V) at high L_p and different mu",
        "Ti/Ti", _LOOSE, _LOOSE_LEGEND,
    ),
    PaperFigure(
        "9", "Centre loading and body force loading, Ti-6Al-4V/aluminium, mu = 0.4", 101, compare_loads, draw_loads
    ),
)  # fmt: skip

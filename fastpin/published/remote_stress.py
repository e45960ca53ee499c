"""Remote stress beside a body load; Ti-6Al-4V pin in aluminium, mu = 0.40: figure 10.

Remote stresses grow with the load, pressure left, shear right. The caption gives mu and L_p = 0.75; dashed lines are
without remote stress. The text names two pairs of normalised stresses: (0.25, -0.25) gives the largest rise of the peak
pressure, (-0.25, 0.25) the largest contact. The two cases with equal stresses are our choice.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.figures.style import line
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.tractions import NAMES, PAIRS, Panel, pushed, traction_curve, traction_figure

PAIR = "Ti/Al"
LOAD_PARAMETER = 0.75
FRICTION = 0.4
DASHES = {(0.0, 0.0): 1, (0.25, -0.25): 0, (-0.25, 0.25): 2, (0.25, 0.25): 3, (-0.25, -0.25): 5}
"""Normalised stresses (sigma_x, sigma_y) and their dashes."""


def stress_unit(pair: str) -> float:
    """Return the remote stress, in F/R, whose normalised size is one.

    The paper normalises sigma = sxx R kappa' / (2 G F beta*), with kappa' = (kappa + 1)/2 and G of the plate. With
    R = F = beta* = 1, sigma is sxx kappa' / (2 G), so sxx = sigma * 2 G / kappa'.
    """
    scaled = PAIRS[pair].scaled(1.0)
    return 4.0 * scaled.plate.shear_modulus / (scaled.plate_kolosov + 1.0)


def compute_tractions(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at the load P = F, one curve for each pair of remote stresses."""
    unit = stress_unit(PAIR)
    curves = []
    for along, across in steps(list(DASHES), progress):
        state = pushed(PAIR, LOAD_PARAMETER, FRICTION, nodes, sxx=along * unit, syy=across * unit)
        curves.append(traction_curve(state, L_p=LOAD_PARAMETER, mu=FRICTION, sigma_x=along, sigma_y=across))
    return curves


def draw_tractions(curves: Sequence[Curve]) -> Figure:
    """Draw pressure left, shear right, one line for each pair of stresses. The line without stress is dashed."""
    lines = {stresses: line(colour, dashes) for colour, (stresses, dashes) in enumerate(DASHES.items())}
    lines[0.0, 0.0]["color"] = "black"
    unit = stress_unit(PAIR)
    size = max(map(max, DASHES))
    labels = {
        (along, across): f"$s_{{xx}}$ = {along * unit:+.2f}, $s_{{yy}}$ = {across * unit:+.2f}".replace("-", "−")
        for along, across in DASHES
    }
    labels[0.0, 0.0] = "no remote stress"
    return traction_figure(
        [[Panel("N", curves), Panel("T", curves)]],
        lambda curve: lines[curve.parameters["sigma_x"], curve.parameters["sigma_y"]],
        *[[(labels[stresses], lines[stresses]) for stresses in list(DASHES)[k::2]] for k in range(2)],
        heading=[
            f"{NAMES[PAIR]}, plane strain; body force F downwards",
            f"load parameter {LOAD_PARAMETER:g}, friction coefficient {FRICTION:g}; "
            f"remote stresses in F/R ({size * unit:.2f} is σ = {size:g})",
        ],
    )


FIGURES = (
    PaperFigure("10", "Effect of remote stresses in body force loading, Ti-6Al-4V/aluminium, mu = 0.40, L_p = 0.75",
                101, compute_tractions, draw_tractions),
)  # fmt: skip

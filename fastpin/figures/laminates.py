"""Figures of laminates: the stiffness of the plate in all directions, and the strength round the hole."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from fastpin.assess.outputs import Curve
from fastpin.damage.hole_strength import JointStrength, joint_strength, laminate_of
from fastpin.damage.laminates import MODES
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import DrawnStates, Subject, name_states, of_joint, of_states, state_lines
from fastpin.figures.style import ANGLE, angle_axis, line, quantity, short
from fastpin.model import StrengthAssessment, angles, checks
from fastpin.model.laminate import Laminate, in_axes
from fastpin.model.ply import PlyCriterion
from fastpin.model.units import Unit, units
from fastpin.states.choice import StateChoice

LEAST_APART = 10.0
"""Degrees between the names of two branches of a curve of strength."""

MOST_RATIO = 5.0
"""Largest strength ratio that is shown, in parts of the least one: beyond, plies are far from failure."""


def stiffness_plot(subject: Subject) -> Plot:
    """Draw Young's modulus and the shear modulus of a laminate in all directions, and the directions of its plies.

    The bottom of the hole is at the bottom of the figure. An isotropic plate raises :class:`InputError`.
    """
    problem = subject.problem
    plate = laminate_of(problem)
    unit = units(problem)["modulus"]
    curve = stiffness_curve(plate, unit)
    words = "Young's modulus and shear modulus of the laminate by direction"
    return Plot(
        lambda look: _draw_stiffness(look, unit, plate, curve),
        [curve],
        f"Polar charts of {words}.",
        f"{words}. Thin lines show the directions of the plies.",
    )


plot_stiffness = plotter("plot_stiffness", stiffness_plot, of_joint)


def stiffness_curve(plate: Laminate, unit: Unit) -> Curve:
    """Young's modulus and the shear modulus by the direction, deg from the bottom, in this `unit`."""
    degrees = np.linspace(-180.0, 180.0, 361)  # one direction each degree
    turned = in_axes(plate.matrix, np.radians(degrees - 90.0))
    moduli = {name: unit.factor / turned[:, k, k] for name, k in (("E", 0), ("G", 2))}
    return Curve({}, {"direction [deg]": degrees, **{f"{name} [{unit.name}]": each for name, each in moduli.items()}})


def _draw_stiffness(look: Look, unit: Unit, plate: Laminate, curve: Curve) -> Sheet:
    sheet = look.sheet([0.5 * look.width], columns=2, extra=1.1, subplot_kw={"projection": "polar"})
    degrees, *moduli = curve.columns.values()
    along, words = np.radians(degrees), ("Young's modulus E", "shear modulus G")
    directions = plate.axis + np.radians(sorted({angle for _, angle in plate.plies}))
    for place, (values, panel) in enumerate(zip(moduli, sheet.axes[0], strict=True)):
        factor, label = unit.printed.scale([float(values.max())])
        panel.set_theta_zero_location("S")
        panel.plot(along, factor * values, **line(place))
        top = 1.05 * factor * float(values.max())
        panel.set_ylim(0.0, top)
        for direction in directions:
            for turn in (0.5 * math.pi, 1.5 * math.pi):
                panel.plot([direction + turn] * 2, [0.0, top], color="0.6", linewidth=0.8)
        panel.set_thetagrids(range(0, 360, 45), [f"{from_label(angle)}°" for angle in range(0, 360, 45)], fontsize=7.0)
        panel.tick_params(axis="y", labelsize=6.5)
        panel.grid(color="0.88", linewidth=0.6)
        panel.set_xlabel(quantity(words[place], label.replace("beta", "β")))
    if directions.size:
        sheet.legend([Line2D([], [], color="0.6", linewidth=0.8, label="directions of the plies")], 1)
    sheet.head(look.title, caption=f"{plate.label}, {plate.direction_words}")
    return sheet


def from_label(angle: int) -> str:
    """The text of a multiple of 45 deg from 0 to 315 as one from -135 to 180."""
    return f"{angle if angle <= 180 else angle - 360}".replace("-", "−")


def strength_plot(
    subject: Subject, states: StateChoice = None, criterion: PlyCriterion | None = None, depth: float | None = None
) -> Plot:
    """Return the strength ratio round the hole as in the section [strength] of a stored case, see `plot_strength`."""
    return _strength_plot(subject, states, criterion, depth, subject.beside("strength"))


def _strength_plot(
    subject: Subject,
    states: StateChoice = None,
    criterion: PlyCriterion | None = None,
    depth: float | None = None,
    how: StrengthAssessment | None = None,
) -> Plot:
    """Draw the strength ratio of the first ply round the hole.

    A ply fails where the ratio is 1 or less. The points lie as in `how`, by default on the edge. A `depth` below the
    edge, m, and a `criterion` replace those of `how`. See :func:`fastpin.damage.joint_strength` for the criteria, and
    :func:`fastpin.plot_tractions` for the `states`.
    """
    return strength_of(subject.states(states), how, criterion, depth)


plot_strength = plotter("plot_strength", _strength_plot, of_states)


def strength_of(
    drawn: DrawnStates,
    how: StrengthAssessment | None,
    criterion: PlyCriterion | None = None,
    depth: float | None = None,
) -> Plot:
    """Return the strength ratio round the hole of states that are drawn, see :func:`plot_strength`."""
    if how is not None:
        checks.instance("how", how, StrengthAssessment, "a fastpin.model.StrengthAssessment")
    given = how or StrengthAssessment(distance=0.0)
    criterion = given.criterion if criterion is None else criterion
    given = replace(given, criterion=criterion) if depth is None else StrengthAssessment(criterion, depth)
    found = [joint_strength(state, given.criterion, **given.lengths) for state in drawn]
    curves = [_strength_curve(each) for each in found]
    length = units(drawn[0].problem)["length"]
    if given.distance is None:
        across, ahead = (short(given.lengths[name], length) for name in ("tension", "compression"))
        place = f"on the characteristic curve of {across} and {ahead}"
    else:
        place = f"{short(given.distance, length)} from the edge" if given.distance else "at the edge"
    words = f"first ply by {given.criterion}, {place}"
    return Plot(
        lambda look: _draw_strength(look, drawn, found, curves, words),
        curves,
        "Line chart of the strength ratio over the angle round the hole.",
        f"Strength ratio of the {words}.",
        notes=drawn.notes,
    )


def _strength_curve(strength: JointStrength) -> Curve:
    angle = np.array([angles.from_bottom(each) for each in strength.theta.tolist()])
    order, plies = np.argsort(angle), np.array([each for _, each in strength.laminate.plies])
    columns = {"angle [deg]": angle, "strength ratio": strength.ratio, "ply [deg]": plies[strength.ply]}
    return Curve({}, {name: values[order] for name, values in columns.items()})


def _name_branches(panel: Axes, strength: JointStrength) -> None:
    """Write above the lowest point of each branch of the curve which ply fails there, and how."""
    angle, top = np.degrees(strength.theta) + 90.0, panel.get_ylim()[1]
    order = np.argsort(np.remainder(angle + 180.0, 360.0))
    kind = np.stack([np.array([each for _, each in strength.laminate.plies])[strength.ply], strength.mode])[:, order]
    borders = np.flatnonzero(np.any(np.diff(kind, axis=1) != 0.0, axis=0)) + 1
    lowest = [part[np.argmin(strength.ratio[part])] for part in np.split(order, borders) if part.size > 1]
    named: list[float] = []
    for place in sorted(lowest, key=lambda each: strength.ratio[each]):
        at = angles.from_bottom(float(strength.theta[place]))
        if strength.ratio[place] > 0.6 * top or any(abs(at - other) < LEAST_APART for other in named):
            continue
        named.append(at)
        ply = strength.laminate.plies[int(strength.ply[place])][1]
        words = f"{ply:g}° {MODES[int(strength.mode[place])]}".replace("-", "−")
        panel.annotate(
            words, (at, strength.ratio[place]), (0.0, 7.0), textcoords="offset points", rotation=90.0, ha="center",
            va="bottom", fontsize=6.5, color="0.3",
        )  # fmt: skip


def _draw_strength(
    look: Look, states: DrawnStates, strengths: Sequence[JointStrength], curves: Sequence[Curve], words: str
) -> Sheet:
    sheet = look.sheet([0.55 * look.width], extra=1.1)
    (panel,) = sheet.axes[0]
    for curve, style in zip(curves, state_lines(states), strict=True):
        panel.plot(curve["angle [deg]"], curve["strength ratio"], **style)
    least = min(each.least_ratio for each in strengths)
    if math.isfinite(least):
        panel.set_ylim(0.0, MOST_RATIO * max(least, 0.2))
        _name_branches(panel, min(strengths, key=lambda each: each.least_ratio))
    panel.axhline(1.0, color="0.4", linewidth=0.8, linestyle=(0, (4.0, 2.0)))
    angle_axis(panel)
    panel.set_xlabel(ANGLE)
    panel.set_ylabel("strength ratio")
    panel.annotate(
        "a ply fails", (0.01, 1.0), xycoords=("axes fraction", "data"), va="bottom", fontsize=7.0, color="0.3"
    )
    name_states(sheet, states, [look.title, words], [])
    sheet.grid()
    return sheet

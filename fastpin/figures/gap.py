"""Figures of profiles along the rim: the initial gaps of hole and pin, and the friction."""

from __future__ import annotations

import numpy as np
from matplotlib.lines import Line2D

from fastpin.assess.outputs import Curve, write_csv
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import draw_zero, line
from fastpin.figures.subjects import Subject, problem_of
from fastpin.figures.words import caption, quantity
from fastpin.model import Case, Profile
from fastpin.model.angles import from_bottom
from fastpin.model.problem import LOOKED_AT, Problem
from fastpin.model.units import units
from fastpin.solver.result import Result

BESIDE = 1e-6
"""Distance from a jump, rad, at which the values on both sides of it are drawn."""


def gap_plot(subject: Subject) -> Plot:
    """Return the profiles along the rim of the joint of a result."""
    return gap_of(subject.result())


def gap_of(joint: Problem | Case | Result) -> Plot:
    """Draw the initial gaps of hole and pin, and the coefficient of friction, along the rim, as far as they vary.

    A positive gap is missing material. A joint without profiles raises :class:`InputError`.
    """
    problem = problem_of(joint)
    if not problem.profiles:
        raise InputError("gap", "there is no initial gap, and the friction is the same all round")
    curve = profile_curve(problem)
    shown = ["initial gap"] * bool(problem.gap) + ["coefficient of friction"] * isinstance(problem.friction, Profile)
    words = " and ".join(shown)
    return Plot(
        lambda look: _draw(look, problem, curve),
        lambda path: write_csv([curve], path),
        f"Line charts of {words} over the angle round the hole.",
        f"{words[0].upper()}{words[1:]} along the rim."
        + (" A positive gap is missing material; the clearance adds to it." if problem.gap else ""),
    )


plot_gap = plotter("plot_gap", gap_of)


def profile_curve(problem: Problem) -> Curve:
    """The profiles of a problem that are given, in SI units, over the angle from the bottom, deg, increasing."""
    given, radius = problem.profiles, problem.hole_radius
    notes = np.concatenate([profile.angles(0, radius) for profile in given.values()])
    theta = np.r_[np.linspace(-np.pi, np.pi, LOOKED_AT), notes - BESIDE, notes + BESIDE]
    angle = np.array([from_bottom(each) for each in theta.tolist()])
    order = np.argsort(angle)
    length = units(problem)["displacement"].name
    columns = {"angle [deg]": angle[order]}
    for name, profile in problem.gap.given.items():
        columns[f"gap of the {name} [{length}]"] = profile.at(theta[order], radius)
    if isinstance(problem.friction, Profile):
        columns["friction"] = problem.friction_at(theta[order])
    return Curve({}, columns)


def _draw(look: Look, problem: Problem, curve: Curve) -> Sheet:
    angle, *values = curve.columns.values()
    gaps = dict(zip(problem.gap.given, values, strict=False))
    if len(gaps) > 1:
        gaps["both together"] = sum(gaps.values(), np.zeros(angle.shape))
    panels = bool(gaps) + isinstance(problem.friction, Profile)
    sheet = look.sheet([2.1] * panels, extra=1.2, sharex=True)
    sheet.grid()
    if gaps:
        panel = sheet.axes[0, 0]
        factor, name = units(problem)["displacement"].scale(np.concatenate([*gaps.values()]).tolist())
        for place, gap in enumerate(gaps.values()):
            panel.plot(angle, factor * gap, **line(place, place))
        draw_zero(panel)
        panel.set_ylabel(quantity("initial gap", name))
    last = sheet.axes[-1, 0]
    if isinstance(problem.friction, Profile):
        last.plot(angle, values[-1], **line(5, 0))
        last.set_ylim(0.0, 1.08 * problem.most_friction)
        last.set_ylabel("friction coefficient")
    sheet.go_round()
    sheet.head(look.title, caption=caption(problem))
    sheet.legend([Line2D([], [], label=name, **line(k, k)) for k, name in enumerate(gaps)], max(len(gaps), 1))
    return sheet

"""Figures of what is given: the loads of a history, and the profiles along the rim."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from fastpin.assess.outputs import Curve
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import Subject, of_joint
from fastpin.figures.style import MAX_NAMED, Line, caption, draw_zero, line, quantity
from fastpin.model import LoadHistory, Problem, Profile, angles, checks
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.problem import LOOKED_AT
from fastpin.model.units import units

Folded = tuple[np.ndarray, list[int], list[tuple[int, int, int]]]
"""Loads of corners, the numbers of these corners, and the repeated blocks, see :func:`_folded`."""

BESIDE = 1e-6
"""Distance from a jump, rad, at which the values on both sides of it are drawn."""


def history_of(problem: Problem, history: LoadHistory, initial: Sequence[float] | np.ndarray | None = None) -> Plot:
    """Draw the loads of a history over its corners, with a panel for each kind of load.

    A repeated block is drawn once, shaded, with the number of times, and with the loads of the first time through. The
    history starts at corner 0, without load unless `initial` is given. The loads are linear between the corners.

    The `initial` load, shape (loads,), acts at corner 0 of a history that continues another one.
    """
    checks.instance("problem", problem, Problem, "a Problem")
    checks.instance("history", history, LoadHistory, "a LoadHistory")
    first = np.zeros(len(LOADS)) if initial is None else checks.number_array("initial", initial)
    if first.shape != (len(LOADS),):
        raise InputError("initial", f"must have the shape ({len(LOADS)},), not {first.shape}")
    folded = _folded(history, first)
    return Plot(
        lambda look: _draw(look, problem, folded),
        instead=f"Line chart of the loads over the {len(history):,} corners of the history.",
        caption="Load history. A shaded block is run through as many times as stands above it.",
    )


plot_history: Callable[..., Figure] = plotter("plot_history", history_of)


def _draw(look: Look, problem: Problem, folded: Folded) -> Sheet:
    loads, numbers, repeated = folded
    acting = [name for k, name in enumerate(LOADS) if loads[:, k].any()] or [LOADS[0]]
    kinds = list(dict.fromkeys(LOAD_KIND[name] for name in acting))
    sheet = look.sheet([1.7] * len(kinds), extra=1.1)
    axes = sheet.axes
    sheet.grid()
    entries: list[tuple[str, Line]] = []
    for kind, panel in zip(kinds, axes[:, 0], strict=True):
        names = [name for name in acting if LOAD_KIND[name] == kind]
        columns = {name: loads[:, LOADS.index(name)] for name in names}
        factor, label = units(problem)[kind].scale(np.concatenate(list(columns.values())).tolist())
        for name in names:
            style = line(len(entries) % MAX_NAMED, len(entries) % MAX_NAMED)
            dots = {"marker": "o", "markersize": 2.2} if len(loads) <= 60 else {}  # more dots would hide the lines
            panel.plot(np.arange(len(loads)), factor * columns[name], **style, **dots)
            entries.append((name, style))
        panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        other = {"traction": "remote stress", "ratio": "relative", "temperature": "rise of"}
        other |= dict.fromkeys(("rotation", "displacement"), "prescribed")
        panel.set_ylabel(quantity(f"{other.get(kind, kind)} {', '.join(names)}", label))
        panel.set_xlim(0.0, len(loads) - 1.0)
        _shade(panel, repeated, panel is axes[0, 0])
    locator = MaxNLocator(nbins=9, integer=True, min_n_ticks=1)
    ticks = [int(tick) for tick in locator.tick_values(0, len(numbers) - 1) if 0 <= tick < len(numbers)]
    for panel in axes[:, 0]:
        panel.set_xticks(ticks, [f"{numbers[tick]:,}" for tick in ticks])
        panel.tick_params(labelbottom=panel is axes[-1, 0])
    axes[-1, 0].set_xlabel("corner of the load history")
    sheet.figure.align_ylabels(axes)
    if len(entries) > 1:
        sheet.legend([Line2D([], [], label=name, **style) for name, style in entries], len(entries))
    sheet.head(look.title, caption=caption(problem), lift=18.0 if repeated else 5.0)
    return sheet


def _folded(history: LoadHistory, initial: np.ndarray) -> Folded:
    """Return the loads of all corners, the first time through each block, and the numbers of these corners.

    The first row is the start, corner 0. The third list has the first row, the last row and the number of
    times of each repeated block.
    """
    last, begin = initial, 1
    rows, numbers, repeated = [last[None, :]], [0], []
    for block in history.blocks:
        values = LoadHistory.from_array(block.given).values(initial=last)
        if block.count > 1:
            repeated.append((len(numbers) - 1, len(numbers) - 1 + len(values), block.count))
        rows.append(values)
        numbers += range(begin, begin + len(values))
        last, begin = values[-1], begin + block.corners
    return np.concatenate(rows), numbers, repeated


def _shade(panel: Axes, repeated: list[tuple[int, int, int]], named: bool) -> None:
    """Shade the repeated blocks, and name the number of times above the panel."""
    for place, (first, last, count) in enumerate(repeated):
        panel.axvspan(first, last, color="0.93" if place % 2 == 0 else "0.88", linewidth=0, zorder=-1)
        if named and len(repeated) <= 8:  # more names would overlap
            panel.text(
                0.5 * (first + last), 1.02, f"× {count:,}", transform=panel.get_xaxis_transform(), ha="center",
                va="bottom", fontsize=8.0,
            )  # fmt: skip


def gap_plot(subject: Subject) -> Plot:
    """Draw the initial gaps of hole and pin, and the coefficient of friction, along the rim, as far as they vary.

    A positive gap is missing material. A joint without profiles raises :class:`InputError`.
    """
    problem = subject.problem
    if not problem.profiles:
        raise InputError("gap", "there is no initial gap, and the friction is the same all round")
    curve = profile_curve(problem)
    shown = ["initial gap"] * bool(problem.gap) + ["coefficient of friction"] * isinstance(problem.friction, Profile)
    words = " and ".join(shown)
    return Plot(
        lambda look: _draw_gap(look, problem, curve),
        [curve],
        f"Line charts of {words} over the angle round the hole.",
        f"{words[0].upper()}{words[1:]} along the rim."
        + (" A positive gap is missing material; the clearance adds to it." if problem.gap else ""),
    )


plot_gap = plotter("plot_gap", gap_plot, of_joint)


def profile_curve(problem: Problem) -> Curve:
    """The profiles of a problem that are given, over the angle from the bottom, deg, increasing."""
    given, radius = problem.profiles, problem.hole_radius
    notes = np.concatenate([profile.angles(0, radius) for profile in given.values()])
    theta = np.r_[np.linspace(-np.pi, np.pi, LOOKED_AT), notes - BESIDE, notes + BESIDE]
    angle = np.array([angles.from_bottom(each) for each in theta.tolist()])
    order = np.argsort(angle)
    length = units(problem)["displacement"]
    columns = {"angle [deg]": angle[order]}
    for name, profile in problem.gap.given.items():
        columns |= length.column(f"gap of the {name}", profile.at(theta[order], radius))
    if isinstance(problem.friction, Profile):
        columns["friction"] = problem.friction_at(theta[order])
    return Curve({}, columns)


def _draw_gap(look: Look, problem: Problem, curve: Curve) -> Sheet:
    angle, *values = curve.columns.values()
    gaps = dict(zip(problem.gap.given, values, strict=False))
    if len(gaps) > 1:
        gaps["both together"] = sum(gaps.values(), np.zeros(angle.shape))
    panels = bool(gaps) + isinstance(problem.friction, Profile)
    sheet = look.sheet([2.1] * panels, extra=1.2, sharex=True)
    sheet.grid()
    if gaps:
        panel = sheet.axes[0, 0]
        factor, name = units(problem)["displacement"].printed.scale(np.concatenate([*gaps.values()]).tolist())
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

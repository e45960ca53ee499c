"""Figures of fatigue along the edge of hole, pin or seat, and of cracks that grow from there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from fastpin.assess.crack import growth_curve
from fastpin.assess.fatigue import assessment_words, fatigue_curve
from fastpin.cracks import Growth
from fastpin.damage import CRITERIA, NO_CRACK, SPECTRUM_CRITERIA, Fatigue, SpectrumDamage, cycle_states, fatigue
from fastpin.damage.assessed import MOST_REFINED
from fastpin.damage.criteria import Criterion
from fastpin.damage.spectrum import bodies_with_lives
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import Subject, with_cycles
from fastpin.figures.style import COLOURS, MAX_NAMED, caption, draw_grid, line, quantity, short
from fastpin.model import angles, checks
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.crack import mouth_words
from fastpin.model.points import (
    EDGES,
    Body,
    edge_body,
    further_parts,
    isotropic_bodies,
    material_of,
    point_words,
)
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.states.choice import span_of

PLANES = 40
"""Planes that are drawn as short lines, spread over the edge."""

AnyFatigue = Fatigue | SpectrumDamage
"""Fatigue over a cycle, or the damage of a spectrum."""

LEAST = 0.02
"""Least parameter with a plane, in parts of the largest."""


def fatigue_plot(
    subject: Subject, criterion: Criterion | None = None, body: Body | None = None, depth: float | None = None
) -> Plot:
    """Return the fatigue of the last cycle: of one body, or of all edges of holes with constants.

    Without a cycle it is the damage of the whole history. A section [fatigue] of the case replaces both, unless a depth
    or a criterion without lives is given.
    """
    how: FatigueAssessment | None = subject.beside("fatigue")
    if how is not None and depth is None and criterion in (None, *SPECTRUM_CRITERIA):
        return _assessed_plot(subject, how.changed(criterion=criterion or how.criteria[0], bodies=body or how.bodies))
    criterion = criterion or "smith-watson-topper"
    if not subject.cycles:
        return _spectrum_plot(subject, criterion, body, depth)
    result = subject.part(*span_of(with_cycles(subject).cycles[-1]))
    cycle = cycle_states(result, result.cycles[-1])
    bodies = _bodies(cycle[0].problem, criterion) if body is None else [body]
    return fatigue_of([fatigue(cycle, criterion, one, depth=depth) for one in bodies])


def _bodies(problem: Problem, criterion: str) -> list[Body]:
    """The edges of holes that a criterion is drawn for: those with constants; else the pin's hole.

    The parameter of Smith, Watson and Topper needs no constants.
    """
    edges = [body for body in isotropic_bodies(problem) if body in EDGES]
    known = [body for body in edges if criterion == "smith-watson-topper" or material_of(problem, body).fatigue]
    return known or ["plate"]


def _assessed_plot(subject: Subject, how: FatigueAssessment) -> Plot:
    """Return the damage along the whole edges of the bodies as the case asks for it."""
    notes = [f"the figure shows {how.criteria[0]} over {assessment_words(how.changed(method='edge', length=None))}"]
    if how.method != "edge" or how.angles is not None:
        notes.append("the figure shows the whole edge; fastpin show prints the places and the method of [fatigue]")
    edges = how.changed(method="edge", length=None, angles=None)
    return replace(fatigue_of(subject.whole().assessed_fatigue(edges, subject.progress)), notes=notes)


def _spectrum_plot(subject: Subject, criterion: Criterion, body: Body | None, depth: float | None) -> Plot:
    """Return the damage over a whole history without cycles; without constants of a life its parameter, as of a cycle.

    The stresses of many states are those of straight lines between the nodes.
    """
    checks.choice("criterion", criterion, CRITERIA)
    result = subject.whole()
    known = bodies_with_lives(result.problem, criterion)
    bodies = [one for one in known if one in EDGES] if body is None else [one for one in known if one == body]
    if not bodies:
        others = _bodies(result.problem, criterion) if body is None else [body]
        return fatigue_of([fatigue(result.states, criterion, one, depth=depth) for one in others])
    straight = len(result) > MOST_REFINED
    how: dict[str, Any] = {"depth": depth, "straight": straight, "progress": subject.progress}
    found = [result.spectrum_damage(criterion, one, **how) for one in bodies]
    plot = fatigue_of(found)
    words = f"the stresses of {len(result):,} states are those of straight lines between the nodes"
    return replace(plot, notes=[words]) if straight else plot


def fatigue_of(found: AnyFatigue | Sequence[AnyFatigue]) -> Plot:
    """Draw the parameter of a criterion along the edge, with its hot spot, and below it the life if it is known.

    Short lines show the worst planes as they cut the edge: a line along the axis lies along the edge, an upright line
    is a crack that goes straight into the body.

    Of a spectrum the damage takes the place of the parameter. The points lie at one depth. Several bodies, such as a
    bush and the plate round it, share the panels.
    """
    several: list[Any] = list(found) if isinstance(found, (list, tuple)) else [found]
    of_spectrum = bool(several) and isinstance(several[0], SpectrumDamage)
    kind: type[Any] = Fatigue
    wanted = "a fatigue result, such as result.fatigue(...)"
    if of_spectrum:
        kind, wanted = SpectrumDamage, "damage of a spectrum, such as result.spectrum_damage()"
    each: Sequence[AnyFatigue] = checks.instances("found", several, kind, wanted)
    if not each:
        raise InputError("found", f"must be {wanted}, not an empty list")
    if any(one.criterion != each[0].criterion or one.problem != each[0].problem for one in each):
        raise InputError("found", "must be of one problem and one criterion")
    if any(np.ptp(one.depth.ravel()[_on_hole(one)]) > 0.0 for one in each):
        raise InputError("found", "must be of points at one depth")
    edges = " and along the edge of the ".join(edge_body(one.problem, one.body) for one in each)
    title, life = each[0].criterion.title(), " and the life" * any(one.life is not None for one in each)
    drawn, shown = f"{title} parameter", f"Parameter {title}"
    if of_spectrum:
        drawn, shown = f"damage by {title}", f"Damage of one spectrum by {title}"
    return Plot(
        lambda look: _draw(look, each),
        list(map(fatigue_curve, each)),
        f"Line chart of the {drawn} along the edge of the {edges}.",
        f"{shown} along the edge of the {edges}, with its hot spot{life}. Short lines are the worst planes.",
    )


plot_fatigue = plotter("plot_fatigue", fatigue_of)


def _draw(look: Look, found: Sequence[AnyFatigue]) -> Sheet:
    lives = {k: one.life.ravel() for k, one in enumerate(found) if one.life is not None and np.isfinite(one.life).any()}
    sheet = look.sheet([2.2] * (2 if lives else 1), extra=1.2)
    sheet.grid()
    (top, *below), handles = sheet.axes[:, 0], list[Line2D]()
    words, passes, factor, unit = "damage of a spectrum,\n", "spectra", 1.0, ""
    if isinstance(found[0], Fatigue):
        of_parameter = units(found[0].problem)[found[0].kind]
        words, passes = "parameter of\n", "cycles"
        factor, unit = of_parameter.scale([_worst(one) for one in found])
    for place, one in enumerate(found):
        name = edge_body(one.problem, one.body) if len(found) > 1 else ""
        handles += _draw_values(top, one, factor, place, name)
    if any(one.plane is not None and not math.isnan(one.hot_spot.theta) for one in found):
        handles.append(Line2D([], [], label="worst planes", color="0.3", linewidth=1.0))
    values = np.concatenate([factor * _values(one) for one in found])
    lowest, highest = float(values.min()), float(values.max())
    if values.any():
        top.set_ylim(min(1.15 * lowest, 0.0), max(1.15 * highest, 0.0))
    else:
        top.set_yticks([0.0])  # no other value has a meaning
    top.set_ylabel(quantity(f"{words}{found[0].criterion.title()}", unit))
    for k, life in lives.items():
        angle, order = _by_angle(found[k])
        below[0].semilogy(angle, np.where(np.isfinite(life), life, np.nan)[order], **line(2 * k))
    if lives:
        shortest = min(float(np.nanmin(life)) for life in lives.values())
        below[0].set_ylabel(f"life ({passes})")
        below[0].set_ylim(0.5 * shortest, 1e4 * shortest)
    sheet.go_round()
    sheet.legend(handles, min(len(handles), 3))
    parts, length = [], units(found[0].problem)["length"]
    for one in found:
        depth = float(one.depth.ravel()[0])
        where = f"{short(depth, length)} below the edge" if depth else "on the edge"
        parts.append(f"{edge_body(one.problem, one.body)}, {where}")
    sheet.head(look.title, "; ".join(parts), caption=caption(found[0].problem))
    return sheet


def _values(found: AnyFatigue) -> np.ndarray:
    """What is drawn of all points: the damage of a spectrum, or the parameter."""
    return (found.damage if isinstance(found, SpectrumDamage) else found.parameter).ravel()


def _worst(found: AnyFatigue) -> float:
    """The value at the hot spot."""
    return found.hot_spot.damage if isinstance(found, SpectrumDamage) else found.hot_spot.parameter


def _by_angle(found: AnyFatigue) -> tuple[np.ndarray, np.ndarray]:
    """The angles from the bottom of the points of the hole, deg, in increasing order, and the order of these points."""
    own = np.flatnonzero(_on_hole(found))
    angle = np.array([angles.from_bottom(place) for place in found.theta.ravel()[own].tolist()])
    order = np.argsort(angle)
    return angle[order], own[order]


def _on_hole(found: AnyFatigue) -> np.ndarray:
    """Which points do not lie on a further edge of a plate of any outline."""
    parts = further_parts(found.problem, found.body, found.theta, found.depth)
    return np.array([part is None for part in parts])


def _draw_further(panel: Axes, found: AnyFatigue, values: np.ndarray, colour: str) -> list[Line2D]:
    """Draw the points on further edges over their angle from the hole's centre, and return the entry of the legend."""
    beyond = ~_on_hole(found)
    if not beyond.any():
        return []
    angle = [angles.from_bottom(place) for place in found.theta.ravel()[beyond].tolist()]
    style: Any = {"linestyle": "none", "marker": ".", "markersize": 2.0, "color": colour}
    panel.plot(angle, values[beyond], **style)
    return [Line2D([], [], label="other edges, by angle", **style)]


def _draw_values(panel: Axes, found: AnyFatigue, factor: float, place: int, name: str) -> list[Line2D]:
    """Draw one curve with its hot spot, planes and limit, and return the entries of the legend."""
    (angle, order), spot = _by_angle(found), found.hot_spot
    values, colour = factor * _values(found)[order], COLOURS[2 * place + 1]
    panel.plot(angle, values, **line(2 * place))
    before = f"{name}: " if name else ""
    handles = [Line2D([], [], label=name, **line(2 * place))] if name else []
    handles += _draw_further(panel, found, factor * _values(found), COLOURS[2 * place])
    if math.isnan(spot.theta):
        nothing = "no damage" if isinstance(found, SpectrumDamage) else NO_CRACK
        return [*handles, Line2D([], [], linestyle="none", label=f"{before}{nothing}")]
    panel.plot(angles.from_bottom(spot.theta), factor * _worst(found), "o", markersize=4.5, color=colour)
    words = point_words(found.problem, found.body, spot.theta, spot.depth)
    where = f"{before}hot spot {words}"
    if isinstance(found, SpectrumDamage):
        median = f", median life {spot.life * 10.0**found.shift:.3g}" if found.shift else ""
        where = f"{before}{spot.life:.3g} spectra {words}{median}"
    look: Any = {"linestyle": "none", "marker": "o", "markersize": 4.5, "color": colour}
    handles.append(Line2D([], [], label=where.replace("-", "−"), **look))
    if found.plane is not None:
        _draw_planes(panel, angle, values, (found.plane.ravel() - found.theta.ravel())[order])
    limit = None if isinstance(found, SpectrumDamage) or found.limit is None else float(np.ravel(found.limit)[0])
    if limit is not None and limit < 3.0 * _worst(found):  # all points have one material
        panel.axhline(factor * limit, **line(2 * place + 2, 1))
        handles.append(Line2D([], [], label=f"{before}fatigue limit", **line(2 * place + 2, 1)))
    return handles


def _draw_planes(panel: Axes, angle: np.ndarray, parameter: np.ndarray, turned: np.ndarray) -> None:
    """Draw planes as short lines; `turned` is the angle from the edge to the plane, rad."""
    cells = np.floor((angle + 180.0) / 360.0 * PLANES)
    drawn = [int(np.flatnonzero(cells == cell)[np.argmax(parameter[cells == cell])]) for cell in np.unique(cells)]
    drawn = [k for k in drawn if np.isfinite(turned[k]) and parameter[k] >= LEAST * parameter.max()]
    panel.quiver(
        angle[drawn], parameter[drawn], np.cos(turned[drawn]), np.sin(turned[drawn]), color="0.3", pivot="middle",
        units="inches", width=0.014, headwidth=1.0, headlength=0.0, headaxislength=0.0, scale=8.0, scale_units="inches",
    )  # fmt: skip


def crack_growth_of(found: Growth | Sequence[Growth]) -> Plot:
    """Draw the range of the stress intensity with the threshold over the length of a crack, and below it the growth.

    All axes are logarithmic. A dot marks the length at which a crack stops. Several cracks of one problem, or several
    laws, share the panels.
    """
    each = checks.instances(
        "found", [found] if isinstance(found, Growth) else found, Growth, "a Growth, or a list of them"
    )
    if not 1 <= len(each) <= MAX_NAMED:
        raise InputError("found", f"must be a Growth, or a list of 1 to {MAX_NAMED} of them, not of {len(each)}")
    if any(one.problem != each[0].problem for one in each):
        raise InputError("found", "must be of one problem")
    if any(one.per != each[0].per for one in each):
        raise InputError("found", "must be all of cycles, or all of spectra")
    words = "; ".join(f"at {_place(one)}: {one.words}" for one in each)
    return Plot(
        lambda look: _draw_cracks(look, each),
        [growth_curve(one) for one in each],
        f"Line chart of the range of the stress intensity and of the growth over the length of a crack {words}.",
        "Range of the stress intensity over the length of a crack, with the threshold, and the growth in a cycle.",
        doubts=[str(doubt) for one in each for doubt in one.doubts],
    )


plot_crack_growth = plotter("plot_crack_growth", crack_growth_of)


def _place(growth: Growth) -> str:
    return mouth_words(growth.problem, growth.crack, ".1f").replace("-", "−")


def _draw_cracks(look: Look, growths: Sequence[Growth]) -> Sheet:
    sheet, unit = look.sheet([2.4, 1.9], extra=1.4, sharex=True), units(growths[0].problem)
    top, bottom = sheet.axes[:, 0]
    length, length_name = unit["length"].scale([float(one.length[-1]) for one in growths])
    intensity, intensity_name = unit["stress intensity"].scale([float(one.delta_K.max()) for one in growths])
    finite = [one.rate[np.isfinite(one.rate)].max(initial=0.0) for one in growths]
    rate, rate_name = unit["crack growth"].scale([float(value) for value in finite])
    rate_name, handles = rate_name.replace("cycle", growths[0].per), []
    for k, one in enumerate(growths):
        a = length * one.length
        top.plot(a, _shown(intensity * one.delta_K), **line(k))
        top.plot(a, _shown(intensity * one.K_max), **line(k, 2, 1.0))
        top.plot(a, _shown(intensity * one.threshold), **line(k, 1, 1.0))
        bottom.plot(a, _shown(rate * one.rate), **line(k))
        if np.isfinite(one.arrest):
            stopped = np.interp(np.log(one.arrest), np.log(one.length), one.delta_K)
            top.plot(length * one.arrest, intensity * stopped, "o", markersize=4.5, color=COLOURS[k])
        handles.append(Line2D([], [], label=f"{_place(one)}: {one.words}".replace(" um", " µm"), **line(k)))
    for dashes, label in ((2, "largest K_I"), (1, "threshold")):
        handles.append(Line2D([], [], label=label, **line(7, dashes, 1.0)))
    for panel in (top, bottom):
        panel.set_xscale("log")
        if any(np.isfinite(curve.get_ydata()).any() for curve in panel.get_lines()):  # a crack may never grow
            panel.set_yscale("log")
        draw_grid(panel)
    top.set_ylabel(quantity("range of K", intensity_name))
    bottom.set_ylabel(quantity("growth", rate_name))
    bottom.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    bottom.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bottom.xaxis.set_minor_formatter(NullFormatter())
    bottom.set_xlabel(quantity("length of the crack", length_name))
    bottom.set_xlim(
        length * min(float(one.length[0]) for one in growths), length * max(one.length[-1] for one in growths)
    )
    sheet.figure.align_ylabels([top, bottom])
    sheet.legend(handles, 1 if len(growths) > 1 else 3)
    sheet.head(look.title, caption=caption(growths[0].problem))
    return sheet


def _shown(values: np.ndarray) -> np.ndarray:
    """Values on a logarithmic axis: NaN where they are not positive, or infinite."""
    return np.where((values > 0.0) & np.isfinite(values), values, np.nan)

"""Figures of one load cycle: slip and friction energy on the arc, and hysteresis loops."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fastpin.assess.cycle import CONJUGATES, loop_curve, natural_sizes, nodes_curve
from fastpin.assess.outputs import ROUNDING, Curve
from fastpin.errors import InputError
from fastpin.figures import style
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import Frame, Subject, with_cycles
from fastpin.model.checks import as_toml, choice, instance, items, string
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import Unit, units
from fastpin.solver.result import Result
from fastpin.states.choice import chosen_cycles, span_of
from fastpin.states.load_cycle import LoadCycle, NodeBehaviour

STRAIGHT = 3
"""States of a cycle, with both ends, between which a loop is a line. Its area tells nothing then."""


ENERGY_DIGITS = 4
"""Significant digits of areas and energies."""

AREA_ERROR = 0.01
"""Largest part of the dissipation by which the areas of the loops may differ from it without a warning."""

Abscissa = Literal["prescribed", "pin"]
"""The displacement over which a reaction is drawn."""


def _cycle_of(cycle: LoadCycle | Result) -> LoadCycle:
    """The cycle, or the last one of a result."""
    if isinstance(cycle, Result):
        return cycle.cycle()
    return instance("cycle", cycle, LoadCycle, "a result, or a load cycle such as result.cycle()")


def one_or_several(cycle: LoadCycle | Result | Sequence[LoadCycle]) -> list[LoadCycle]:
    """The cycles, or the last one of a result."""
    several = isinstance(cycle, Sequence) and not isinstance(cycle, Result)
    each: Sequence[Any] = cycle if several else [cycle]  # type: ignore[assignment]
    return [_cycle_of(one) for one in each]


def slip_plot(subject: Subject, corners: str | None = None) -> Plot:
    """Return slip and friction energy of the last cycle, or from one corner to another such as "21-101"."""
    if corners is None and subject.span is not None:
        corners = "{}-{}".format(*subject.span)
    if corners is not None:
        return slip_of(_between(subject, corners))
    return slip_of(subject.part(*span_of(with_cycles(subject).cycles[-1])).cycle())


def _between(subject: Subject, corners: str) -> LoadCycle:
    """The part of a history from one corner to another, as a cycle."""
    ends = re.fullmatch(r"\s*(\d+)\s*-\s*(\d+)\s*", string("corners", corners))
    if ends is None:
        raise InputError("corners", f"must be two corners such as 21-101, not {as_toml(corners)}")
    first, last = int(ends[1]), int(ends[2])
    whole = len(subject.result().history)
    if not 1 <= first < last <= whole:
        raise InputError("corners", f"must increase, from 1 to {whole:,}, the last corner; not {corners.strip()}")
    return subject.part(first, last).cycle(first=first, last=last)


def slip_of(cycle: LoadCycle) -> Plot:
    """Draw slip and friction energy of a cycle on the arc of the contact.

    The upper panel shows the slip range, and the slip distance if it is known. The lower panel shows the friction
    energy, or if that is not known the range of the shear traction. Nodes that slip or open at some time are shaded.

    Of a result it is the last cycle.
    """
    return Plot(
        lambda look: _draw_slip(look, cycle),
        [nodes_curve(cycle)],
        f"Line charts of slip and friction energy round the hole, corners {cycle.first:,} to {cycle.last:,}.",
        "Slip of each place over the cycle, and its friction energy or the range of its shear traction.",
    )


plot_slip = plotter("plot_slip", slip_of, _cycle_of)


def _draw_slip(look: Look, cycle: LoadCycle) -> Sheet:
    known = cycle.friction_energy is not None
    sheet = look.sheet([2.0, 2.0])
    axes = sheet.axes
    sheet.grid()
    unit = units(cycle.states[0].problem)
    frame = Frame(cycle.states)
    angle, order = frame.angle, frame.order
    upper, lower = axes[:, 0]
    sizes = natural_sizes(cycle)
    named = {"slip range": cycle.slip_range, **({"slip distance": cycle.slip_distance} if known else {})}
    curves = {name: style.without_rounding(np.asarray(each), sizes["displacement"]) for name, each in named.items()}
    slips = any(each.any() for each in curves.values())
    factor, label = unit["displacement"].scale([float(each.max()) for each in curves.values()])
    for k, each in enumerate(curves.values()):
        upper.plot(angle, factor * each[order], **style.line(k, k))
    upper.set_ylabel(style.quantity("slip", label))
    words, kind, values = "range of shear traction", "traction", cycle.shear_range
    if cycle.friction_energy is not None:
        words, kind, values = "friction energy", "energy density", cycle.friction_energy
    values = style.without_rounding(values, sizes[kind])
    factor, label = unit[kind].scale([float(values.max())])
    lower.plot(angle, factor * values[order], **style.line(2, 2))
    lower.set_ylabel(style.quantity(words, label))
    _shade(lower, cycle, frame, slips)
    shades = _shade(upper, cycle, frame, slips)
    for panel in (upper, lower):
        top = max(float(np.nanmax(drawn.get_ydata())) for drawn in panel.lines)
        panel.set_ylim(0.0, 1.08 * top or 1.0)
        if top == 0.0:
            panel.text(0.5, 0.5, "0: no node slips", ha="center", transform=panel.transAxes)
            panel.set_yticks([0.0])
        frame.scale(panel)
    lower.set_xlabel(style.ANGLE)
    handles: list[Artist] = [Line2D([], [], label=name, **style.line(k, k)) for k, name in enumerate(curves)]
    handles.append(Line2D([], [], label=words, **style.line(2, 2)))
    sheet.figure.align_ylabels(axes)
    sheet.legend([*handles, *shades], len(handles) + len(shades))
    _head(sheet, cycle, look.title)
    return sheet


def _head(sheet: Sheet, cycle: LoadCycle, title: str, more: str = "", lift: float = 5.0) -> None:
    """Write title, corners, loads that are constant, `more`, and the parameters, `lift` points above the panel."""
    common = ",  ".join(style.load_text(cycle.states, 0, name) for name in style.loads_by_change(cycle.states)[0])
    heading = f"cycle from corner {cycle.first:,} to {cycle.last:,}{f',  {common}' if common else ''}"
    heading = f"{heading}:  {more}" if more else heading
    sheet.head(title, heading, caption=style.caption(cycle.states[0].problem, cycle.states), lift=lift)


def _shade(panel: Axes, cycle: LoadCycle, frame: Frame, slips: bool) -> list[Artist]:
    """Shade the nodes that slip or open at some time, and return the entries of the legend.

    If the cycle has no slip beyond rounding (`slips` is False), no node counts as slipping.
    """
    middles = 0.5 * (frame.angle[1:] + frame.angle[:-1])
    ends = np.r_[frame.angle[0], middles, frame.angle[-1]]
    entries: list[Artist] = []
    shades = {NodeBehaviour.SLIPS: ("0.80", "slips at some time"), NodeBehaviour.OPENS: ("0.92", "opens at some time")}
    for behaviour, (shade, label) in shades.items():
        shaded = cycle.behaviour[frame.order] == behaviour
        if not shaded.any() or (behaviour == NodeBehaviour.SLIPS and not slips):
            continue
        # One span for each row of nodes: spans that meet would show hairlines.
        changes = np.flatnonzero(np.diff(np.r_[False, shaded, False]))
        for first, last in changes.reshape(-1, 2):
            panel.axvspan(ends[first], ends[last], color=shade, linewidth=0, zorder=-1)
        entries.append(Patch(color=shade, linewidth=0, label=label))
    return entries


def loops_plot(
    subject: Subject, cycle: str = "last", abscissa: Abscissa | None = None, corners: str | None = None
) -> Plot:
    """Return the hysteresis loops of chosen cycles, at most as many as a figure can show. Cycles count from 1.

    Cycles without a loop are left out, and the notes say so. `corners` such as "21-101" choose another part.
    """
    if corners is not None:
        chosen = _between(subject, corners)
        of_chosen = loops_of([chosen], abscissa)
        return replace(of_chosen, curves=[loop_curve(chosen)], notes=[dissipated_words(chosen)])
    result = with_cycles(subject)
    places, refusal = chosen_cycles(result.cycles, cycle), None
    shown = [places[k] for k in style.spread(len(places), style.MAX_NAMED)]
    found: dict[int, LoadCycle] = {}
    notes, doubts = [], []
    if len(shown) < len(places):
        numbers = ", ".join(f"{place + 1:,}" for place in shown)
        notes.append(f"the figure shows {len(shown)} of {len(places):,} cycles: {numbers}")
    for place in shown:
        part = subject.part(*span_of(result.cycles[place]))
        try:
            found[place + 1] = part.cycle(place)
        except InputError as error:
            refusal = error
            if len(places) > 1:
                doubts.append(f"cycle {place + 1:,} is left out: {error.reason}")
    if refusal is not None and not found:
        raise refusal
    loops = [Curve({"cycle": number}, loop_curve(one).columns) for number, one in found.items()]
    plot = loops_of(list(found.values()), abscissa, [f"cycle {number:,}" for number in found])
    notes += [f"cycle {number:,}: {dissipated_words(one)}" for number, one in found.items()]
    doubts += [doubt for one in found.values() if (doubt := area_doubt(one))]
    return replace(plot, curves=loops, notes=notes, doubts=doubts)


def loops_of(cycles: Sequence[LoadCycle], abscissa: Abscissa | None = None, names: Sequence[str] = ()) -> Plot:
    """Draw the hysteresis loops of a cycle, or of several: each load against the displacement on which it does work.

    Each panel names the area of its loop, which is the work of the load. Over a closed cycle of a settled contact the
    areas sum up to the dissipation. The heading names the dissipation of the exact path beside them. An area needs more
    states than the ends of a line: see `between` of :func:`fastpin.solve`. Loops of several cycles lie over one
    another, and the legend names them. A load whose displacement is always 0 has no panel.

    Parameters
    ----------
    cycle : LoadCycle, Result or sequence of LoadCycle
        From :meth:`fastpin.Result.cycle`; of a result the last cycle. At most
        :data:`~fastpin.figures.style.MAX_NAMED` cycles of one problem.
    abscissa : {"prescribed", "pin"}, optional
        Displacement of a reaction P or Q: "prescribed" is ux or -uy, which holds the elastic deformation of pin and
        plate between the two places too. "pin" is the displacement of the pin over the hole. Both loops of a settled
        contact have the same area. Unless given, it is "prescribed" where a displacement is prescribed.
    names : sequence of str
        Names of several cycles in the legend, before their corners.

    Raises
    ------
    InputError
        If `cycle` is no load cycle, or a result without one, or if no load changes in it.
    """
    check_loops(cycles, abscissa)
    named = [string("names", name) for name in items("names", names, "a list of names")]
    return Plot(
        lambda look: _draw_loops(look, cycles, abscissa, named),
        instead=f"Loops of each load against the displacement on which it does work, corners {cycles[0].first:,} to "
        f"{cycles[0].last:,}.",
        caption="Hysteresis loops. The area of a loop is the work of its load.",
    )


plot_loops = plotter("plot_loops", loops_of, one_or_several)


def check_loops(cycles: Sequence[LoadCycle], abscissa: Abscissa | None = None) -> None:
    """Raise :class:`InputError` if no cycle has a hysteresis loop, there are too many, or the abscissa is unknown."""
    if abscissa is not None:
        choice("abscissa", abscissa, get_args(Abscissa))
    if not 1 <= len(cycles) <= style.MAX_NAMED:
        raise InputError("cycle", f"must be 1 to {style.MAX_NAMED} cycles, not {len(cycles)}")
    if any(cycle.states[0].problem != cycles[0].states[0].problem for cycle in cycles):
        raise InputError("cycle", "must be cycles of one problem")
    if abscissa == "prescribed" and not any(cycles[0].states[0].problem.driven):
        raise InputError("abscissa", "no displacement is prescribed here; the other choice is pin")
    if any(_changing(cycle) for cycle in cycles):
        return
    if all(len(cycle.states) == 2 and cycle.last - cycle.first > 1 for cycle in cycles):
        raise InputError("cycle", 'has no loop: only its ends were kept; keep "corners" or "all" keeps its corners')
    raise InputError("cycle", "has no loop: no load changes in it")


def _changing(cycle: LoadCycle) -> list[str]:
    """Names of the loads that change in a cycle, beyond rounding, and whose displacement is not always 0."""
    loops, problem = cycle.loops, cycle.states[0].problem
    force = max(float(np.abs(loops[name].load).max()) for name in ("P", "Q"))
    sizes = {"moment": force * problem.hole_radius, "force": force}
    strain = problem.surfaces.beta_star * float(cycle.pressure_extremes[1].max())
    moves = {"moment": strain, "force": strain * problem.hole_radius}
    return [
        name
        for name, loop in loops.items()
        if np.ptp(loop.load) > 1e-9 * sizes.get(LOAD_KIND[name], float(np.abs(loop.load).max()))
        and np.abs(loop.displacement).max() > ROUNDING * moves.get(LOAD_KIND[name], 0.0)
    ]


def _draw_loops(look: Look, cycles: Sequence[LoadCycle], abscissa: Abscissa | None, names: Sequence[str]) -> Sheet:
    loads = list(dict.fromkeys(name for cycle in cycles for name in _changing(cycle)))
    across = min(len(loads), 3)
    sheet = look.sheet([2.6] * -(-len(loads) // across), columns=across, extra=0.9 + 0.17 * len(cycles))
    sheet.grid()
    for panel in sheet.axes.flat[len(loads) :]:
        panel.set_visible(False)
    for name, panel in zip(loads, sheet.axes.flat, strict=False):
        _draw_loop(panel, cycles, name, abscissa, across)
    problem, single = cycles[0].states[0].problem, len(cycles) == 1
    if single:
        _head(sheet, cycles[0], look.title, dissipated_words(cycles[0]), lift=18.0)
        return sheet
    sheet.head(
        look.title, caption=style.caption(problem, [state for cycle in cycles for state in cycle.states]), lift=6.0
    )
    handles = []
    for k, cycle in enumerate(cycles):
        name = f"{names[k]}, " if k < len(names) else ""
        label = f"{name}corners {cycle.first:,} to {cycle.last:,}: {dissipated_words(cycle)}"
        handles.append(Line2D([], [], label=label, **style.line(k, k)))
    sheet.legend(handles, 1)
    return sheet


def _draw_loop(panel: Axes, cycles: Sequence[LoadCycle], name: str, abscissa: Abscissa | None, across: int) -> None:
    """Draw the loops of one load in all cycles."""
    problem, kind = cycles[0].states[0].problem, LOAD_KIND[name]
    loops = [cycle.loops[name] for cycle in cycles]
    unit = units(problem)
    load, load_unit = unit[kind].scale(np.concatenate([loop.load for loop in loops]).tolist())
    words, conjugate = CONJUGATES[kind]
    words = "displacement of the pin" if kind == "force" else words
    sign, shift = (1.0, "ux") if name == "Q" else (-1.0, "uy")  # a displacement gets the sign of the load
    moves = [loop.displacement for loop in loops]
    if dict(zip(("Q", "P"), problem.driven, strict=True)).get(name) and abscissa != "pin":
        words = f"prescribed displacement {'ux' if name == 'Q' else '−uy'}"
        moves = [np.array([sign * state.load[shift] for state in cycle.states]) for cycle in cycles]
    moved, moved_unit = _displacement_scale(np.concatenate(moves), unit[conjugate])
    if kind == "traction":  # of a square unit, which has no prefixes
        moved = 1.0 / max(float(np.abs(np.concatenate(moves)).max()), 1e-300)
        moved_unit = "largest is 1"
    for k, (loop, move) in enumerate(zip(loops, moves, strict=True)):
        panel.plot(moved * move, load * loop.load, marker="o", markersize=2.2, **style.line(k, k))
    panel.set_xlabel(f"{words}\n({style.shown_unit(moved_unit)})" if across > 2 else style.quantity(words, moved_unit))
    panel.set_ylabel(style.quantity(name, load_unit))
    if len(cycles) == 1:
        (loop,), area = loops, "area unknown: no states between the corners"
        if len(loop.load) > STRAIGHT:
            is_rounding = abs(loop.work) <= ROUNDING * float(np.abs(loop.load).max() * np.abs(loop.displacement).max())
            area = f"area {'0' if is_rounding else style.short(float(loop.work), unit['energy'])}"
        panel.text(0.0, 1.02, area, fontsize=8.0, ha="left", va="bottom", transform=panel.transAxes)
    panel.xaxis.set_major_locator(MaxNLocator({1: 9, 2: 6, 3: 3}[across], steps=[1, 2, 5, 10]))


def dissipated_words(cycle: LoadCycle) -> str:
    """The areas of all loops of a cycle, and the energy that friction dissipates on its exact path, as text."""
    problem = cycle.states[0].problem
    unit = units(problem)["energy"]
    size = max(abs(state.energy) for state in cycle.states)
    lost = cycle.dissipation if abs(cycle.dissipation) > ROUNDING * size else 0.0
    exact = f"dissipated on the path {style.short(lost, unit, ENERGY_DIGITS)}" if lost else "nothing dissipated"
    if len(cycle.states) <= STRAIGHT:
        return exact
    area = enclosed(cycle)
    area = area if abs(area) > ROUNDING * size else 0.0
    return f"area {style.short(area, unit, ENERGY_DIGITS) if area else '0'}, {exact}"


def enclosed(cycle: LoadCycle) -> float:
    """The areas of all loops of a cycle together, J/m: the work of the loads on polygons through the states."""
    return float(sum(loop.work for loop in cycle.loops.values()))


def area_doubt(cycle: LoadCycle) -> str:
    """A sentence if the areas of the loops differ by more than :data:`AREA_ERROR` from the dissipation; else empty."""
    lost, area = cycle.dissipation, enclosed(cycle)
    size = max(abs(state.energy) for state in cycle.states)
    if len(cycle.states) <= STRAIGHT or max(abs(lost), abs(area)) <= ROUNDING * size:
        return ""
    away = area - lost
    if abs(away) <= AREA_ERROR * abs(lost):
        return ""
    share = f"{abs(away / lost):.2g} times" if abs(away) > 2.0 * abs(lost) else f"{100.0 * abs(away / lost):.2g} %"
    stored = cycle.states[-1].energy - cycle.states[0].energy
    why = "few states draw the loop; between = N adds some"
    if abs(away - stored) < 0.5 * abs(away):
        why = "the contact has not settled, and stores the difference"
    where = f"corners {cycle.first:,} to {cycle.last:,}"
    return f"{where}: the areas differ by {share} from the dissipation of the path: {why}"


def _displacement_scale(values: np.ndarray, unit: Unit) -> tuple[float, str]:
    """As :meth:`fastpin.model.units.Unit.scale`; a unit without prefixes gets a power of ten for small values."""
    factor, label = unit.scale(values.tolist())
    largest = factor * float(np.abs(values).max())
    if not 0.0 < largest < 0.1:  # longer numbers would overlap on the axis
        return factor, label
    power = math.floor(math.log10(largest))
    superscripts = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return factor / 10.0**power, f"10{str(power).translate(superscripts)} {label}"

"""The map of stick and slip: which part of the hole sticks, slips or is open at each load point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from fastpin.assess.outputs import Curve
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import DrawnStates, Frame, Subject, of_states
from fastpin.figures.style import HATCH, caption, fill, line, load_text, loads_by_change, short_load
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK, Status
from fastpin.model.points import owner_of
from fastpin.model.problem import Problem
from fastpin.states.choice import StateChoice, span_of
from fastpin.states.cycles import Cycle, innermost_cycles
from fastpin.states.load_cycle import NO_SLIP
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State

MOST_COLUMNS = 200
"""Most columns of a map. A column is then half a millimetre wide on paper. Columns of more states join some of them."""

ZoneLook = tuple[str, str, str]
"""Colour, hatch and words of a zone."""

BOTH_WAYS = 9
"""Extent of nodes that slip in both directions. The other extents are statuses."""

GAP = 2.0
"""Distance of two load points, in usual distances, from which on nothing is drawn between them."""

LOOKS: dict[int, ZoneLook] = {
    STICK: ("#0B3C5D", "", "sticks"),
    SLIP_POSITIVE: ("#F2A541", "////", "{body} slips counter-clockwise"),
    SLIP_NEGATIVE: ("#A8D8F0", "\\\\\\\\", "{body} slips clockwise"),
}
"""The look of a zone by its status. The body is the pin, or the bush in its seat.

The hatches tell the two directions apart without colour.
"""

FRICTIONLESS = ("#A6A6A6", "", "slips without friction")
"""The look of a contact without friction. Its status tells no direction."""

EXTENTS = {
    STICK: "sticks whenever it touches",
    SLIP_POSITIVE: "{body} slips counter-clockwise at some time",
    SLIP_NEGATIVE: "{body} slips clockwise at some time",
    BOTH_WAYS: "{body} slips both ways",
}
"""Words for the behaviour of a node in a column that joins several states."""

MARKS = {SLIP_POSITIVE: "^", SLIP_NEGATIVE: "v"}
"""Marks of slip zones that are too narrow to be seen; they point along the slip of the pin."""

_MARK: dict[str, Any] = {
    "linestyle": "none", "markersize": 5.5, "markerfacecolor": "white", "markeredgecolor": "black",
    "markeredgewidth": 0.8, "clip_on": False,
}  # fmt: skip
"""Style of the marks: white with a black edge, which is seen on dark and on white."""

MOST_MARKS = 40
"""Most states whose narrow zones get marks. The marks of more columns would hide the map."""


class ZoneBox(NamedTuple):
    """A zone in the map: the sides of its rectangle, load points and degrees from the bottom.

    The kind is the status of a zone of one state, `point`, or an extent of :data:`EXTENTS` in a column of several.
    """

    left: float
    right: float
    start: float
    stop: float
    kind: int
    point: float = math.nan


class MapColumn(NamedTuple):
    """A column of the map.

    Attributes
    ----------
    left, right : float
        Its sides, load points.
    places : ndarray of int
        Places of its states.
    """

    left: float
    right: float
    places: np.ndarray


class ZoneMap(NamedTuple):
    """The zones of a map; of more states than columns can be seen also the columns, and words on what one joins."""

    boxes: list[ZoneBox]
    columns: Sequence[MapColumn] = ()
    words: str = ""


def stick_slip_plot(subject: Subject, states: StateChoice = None) -> Plot:
    """Draw a map of stick and slip: angle round the hole against load point.

    Colours show where the contact sticks and in which direction the pin slips; white is open. A triangle marks a slip
    zone that is too narrow to be seen. Without friction all contact slips. The upper panel shows the loads that change.
    Of more than :data:`MOST_COLUMNS` states, a column joins the states of one cycle or of several. It shows which nodes
    slip, and in which direction, at some time in it. See :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states, most=MOST_COLUMNS, whole=True)
    first, last = (point_name(load_point(drawn[place])) for place in (0, -1))
    some = f"Only {len(drawn):,} of {drawn.total:,} states, load points {first} to {last}: stick"
    part = some if len(drawn) < drawn.total else "Stick"
    notes, frame = drawn.notes, Frame(drawn)
    if len(drawn) <= MOST_COLUMNS:
        zones = ZoneMap(list(zone_boxes(drawn, frame)))
    else:
        columns, words = long_columns(drawn)
        zones = ZoneMap(list(extent_boxes(drawn, columns, frame)), columns, words)
        notes.append(f"the figure shows {len(drawn):,} states in {len(columns)} columns: {words}")
    return Plot(
        lambda look: _draw(look, drawn, zones, frame),
        [Curve({}, _zone_columns(drawn[0].problem, zones))],
        f"Map of the zones that stick and slip, over angle and load point, from load point {first} to {last}.",
        f"{part} and slip over the angle round the hole and the load point. White is open.",
        notes,
    )


plot_stick_slip = plotter("plot_stick_slip", stick_slip_plot, of_states)


def _zone_columns(problem: Problem, zones: ZoneMap) -> dict[str, Any]:
    """Return the zones of a map, column by column of a CSV file."""
    angle = {"start [deg]": np.array([box.start for box in zones.boxes])}
    angle["stop [deg]"] = np.array([box.stop for box in zones.boxes])
    if zones.columns:
        left, right = (np.array([getattr(box, side) for box in zones.boxes]) for side in ("left", "right"))
        words = np.array([extent_look(problem, box.kind)[2] for box in zones.boxes])
        return {"load points after": left, "to": right, **angle, "slip": words}
    points = np.array([box.point for box in zones.boxes])
    names = np.array([Status(box.kind).name.lower().replace("_", " ") for box in zones.boxes])
    return {"load point": points, **angle, "status": names}


def zone_boxes(states: Sequence[State], frame: Frame) -> Iterator[ZoneBox]:
    """Yield the zones of the states, degrees from the bottom. A column reaches halfway to the load points beside it."""
    points = np.array([load_point(state) for state in states])
    ends = column_ends(points)
    for state, point, left, right in zip(states, points.tolist(), ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        zones = [(*zone, STICK) for zone in state.stick] + state.slip_zones
        for start, stop, status in zones:
            for first, length in frame.place(start, stop):
                yield ZoneBox(left, right, first, first + length, int(status), point)


def zone_look(problem: Problem, status: int) -> ZoneLook:
    """Colour, hatch and words of a zone of this status."""
    if problem.frictionless:
        return FRICTIONLESS
    colour, hatch, words = LOOKS[status]
    return colour, hatch, words.format(body=owner_of(problem, "pin"))


def column_ends(points: np.ndarray) -> np.ndarray:
    """The sides of all columns, shape (k + 1,): halfway between the load points, and as far beyond the outer ones."""
    if points.size == 1:
        return np.array([points[0] - 0.5, points[0] + 0.5])
    middles = 0.5 * (points[1:] + points[:-1])
    return np.r_[2.0 * points[0] - middles[0], middles, 2.0 * points[-1] - middles[-1]]


def _draw(look: Look, states: DrawnStates, zones: ZoneMap, frame: Frame) -> Sheet:
    """Draw the map, below the loads that change. More states than columns can be seen are joined in columns."""
    problem, (boxes, columns, words) = states[0].problem, zones
    common, differing = loads_by_change(states)
    sheet = look.sheet([1.0, 2.8] if differing else [2.8], extra=1.2, sharex=True)
    panel, look_of = sheet.axes[-1, 0], extent_look if columns else zone_look
    some = f" of {states.total:,}" if len(states) < states.total else ""
    if columns:
        panel.set_xlim(columns[0].left, columns[-1].right)
        note = f"; {len(states):,}{some} states; {words}"
    else:
        panel.set_xlim(*column_ends(np.array([load_point(state) for state in states]))[[0, -1]])
        note = f"; {len(states)}{some} states drawn" if some else ""
    present = [kind for kind in EXTENTS if any(box.kind == kind for box in boxes)]
    for kind in present:
        corners = [
            [(box.left, box.start), (box.right, box.start), (box.right, box.stop), (box.left, box.stop)]
            for box in boxes
            if box.kind == kind
        ]
        fill(panel, corners, *look_of(problem, kind)[:2])
    if differing:
        _draw_loads(sheet.axes[0, 0], states, differing, columns)
        sheet.axes[0, 0].tick_params(labelbottom=False)
    handles: list[Patch | Line2D] = [zone_patch(look_of(problem, kind)) for kind in present]
    is_open = "open all the time" if columns else "open"
    handles.append(Patch(facecolor="white", edgecolor="0.5", linewidth=0.6, label=is_open))
    if len(states) <= MOST_MARKS and not problem.frictionless and _draw_marks(panel, boxes, frame.limits):
        handles.append(Line2D([], [], label="narrow slip zone", **(_MARK | {"marker": "^"})))
    frame.scale(panel, upright=True)
    panel.set_ylabel("angle from the bottom,\ncounter-clockwise (deg)")
    panel.set_xlabel("load point (1: first corner of the history)")
    panel.xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True, min_n_ticks=1))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    sheet.figure.align_ylabels(list(sheet.axes[:, 0]))
    loads = ",  ".join(load_text(states, 0, name) for name in common)
    sheet.head(look.title, loads, caption=f"{caption(problem, states)}{note}")
    sheet.legend(handles, 3 if columns else len(handles))
    return sheet


def long_columns(states: DrawnStates) -> tuple[list[MapColumn], str]:
    """Return the columns of a map of many states, and words on the states that a column joins."""
    points = np.array([load_point(state) for state in states])
    return columns_of(points, states.cycles, MOST_COLUMNS)


def extent_look(problem: Problem, status: int) -> ZoneLook:
    """Colour, hatch and words of nodes of this extent in a column that joins several states."""
    if problem.frictionless:
        return FRICTIONLESS
    both_ways = ("#6FB58F", "xxxx", "")
    colour, hatch, words = LOOKS.get(status, both_ways)
    return colour, hatch, EXTENTS.get(status, words).format(body=owner_of(problem, "pin"))


def zone_patch(look: ZoneLook) -> Patch:
    """Return the entry of the legend for a look of :func:`zone_look`."""
    colour, hatch, words = look
    return Patch(facecolor=colour, edgecolor=HATCH, linewidth=0.0, hatch=hatch, label=words)


def _draw_marks(panel: Axes, boxes: Sequence[ZoneBox], limits: tuple[float, float]) -> bool:
    """Mark slip zones that are narrower than 1.5 % of the axis, and return whether there are any."""
    least = 0.015 * (limits[1] - limits[0])
    narrow = [box for box in boxes if box.kind in MARKS and box.stop - box.start < least]
    for status, mark in MARKS.items():
        mine = [box for box in narrow if box.kind == status]
        if mine:
            middles = [0.5 * (box.start + box.stop) for box in mine]
            panel.plot([box.point for box in mine], middles, **(_MARK | {"marker": mark}))
    return bool(narrow)


def _draw_loads(panel: Axes, states: DrawnStates, names: Sequence[str], columns: Sequence[MapColumn]) -> None:
    """Draw the loads that change, each over its largest value, or its range in columns. The legend has the values."""
    points = [load_point(state) for state in states]
    ends = np.array([[column.left, column.right] for column in columns]).ravel()
    for k, name in enumerate(names):
        values = np.array([state.load[name] for state in states])
        largest = float(np.abs(values).max())
        label = f"{name}, largest {short_load(states[0].problem, name, largest)}"
        if not columns:
            marker, style = "o" if len(states) <= MOST_MARKS else "", line(k % 8, k % 8, 1.1)
            panel.plot(points, values / largest, marker=marker, markersize=2.4, label=label, **style)
            continue
        style, parts = line(k % 8, k % 8, 0.8), [values[column.places] / largest for column in columns]
        lower, upper = (np.repeat([extreme(part) for part in parts], 2) for extreme in (np.min, np.max))
        panel.fill_between(ends, lower, upper, color=style["color"], alpha=0.25, linewidth=0.0)
        panel.plot(ends, upper, label=label, **style)
        panel.plot(ends, lower, **style)
    panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    panel.set_ylabel("range of load\n/ largest" if columns else "load / largest")
    panel.margins(y=0.12)
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7.0, handlelength=2.4)


def columns_of(points: np.ndarray, cycles: Sequence[Cycle], most: int) -> tuple[list[MapColumn], str]:
    """Return the columns of a map, and words on what a column joins.

    A column joins the states of one load cycle or of several, so that no column shows a part of a cycle. States outside
    of all cycles stand for themselves, or are joined like cycles.

    Parameters
    ----------
    points : ndarray, shape (states,)
        Load points, increasing.
    cycles : sequence of Cycle
    most : int
        Most columns.
    """
    units = np.arange(points.size) + 0.5  # a state is a unit of its own, and so is a cycle
    spans = [span_of(cycle) for cycle in innermost_cycles(cycles)]
    for begin, end in spans:
        first, last = np.searchsorted(points, [begin, end], side="right")
        units[first:last] = float(first)
    _, number = np.unique(units, return_inverse=True)
    joined = -(-int(number[-1] + 1) // most)
    starts = np.flatnonzero(np.diff(number // joined, prepend=-1))
    usual = float(np.median(np.diff(points))) if points.size > 1 else 1.0
    columns, right = [], -np.inf
    for places in np.split(np.arange(points.size), starts[1:]):
        first = float(points[places[0]])
        near = first - right <= GAP * max(usual, 1.0)
        columns.append(MapColumn(right if near else max(first - usual, 0.0), float(points[places[-1]]), places))
        right = columns[-1].right
    single, several = "one cycle, or one state outside of cycles", "cycles, or states outside of cycles"
    in_cycles = units % 1.0 == 0.0
    if in_cycles.all():
        single, several = "one cycle", "cycles"
    elif not in_cycles.any():
        single, several = "one state", "states"
    return columns, f"each column is {single}" if joined == 1 else f"each column joins {joined} {several}"


def extents(states: Sequence[State], before: State | None) -> np.ndarray:
    """Return what each node does at some time between the state before and the last of the states, shape (n,).

    A node slips where its slip changes between two states at which it is closed. If the states have slip distances,
    slip forth and back counts too. Statuses count for nodes that were open before: a node at |T| = mu N may have the
    status of slip and rest.

    Parameters
    ----------
    states : sequence of State
    before : State or None
        The state from which the slip of the first one counts.
    """
    closed, up, down = np.zeros((3, states[0].grid.size), dtype=bool)
    for state in states:
        problem = state.problem
        least = NO_SLIP * problem.hole_radius * problem.surfaces.beta_star * float(state.pressure.max())
        known = state.status != OPEN
        if before is not None and not problem.frictionless:
            known = known & (before.status != OPEN)
            net = np.where(known, state.slip - before.slip, 0.0)
            distance = np.abs(net) if state.slip_distance is None else state.slip_distance
            closed |= distance > least
            up |= known & (distance + net > 2.0 * least)
            down |= known & (distance - net > 2.0 * least)
            known = ~known
        closed |= state.status != OPEN
        up |= known & (state.status == SLIP_POSITIVE)
        down |= known & (state.status == SLIP_NEGATIVE)
        before = state
    return np.select([up & down, up, down, closed], [BOTH_WAYS, SLIP_POSITIVE, SLIP_NEGATIVE, STICK], OPEN)


def extent_boxes(states: Sequence[State], columns: Sequence[MapColumn], frame: Frame) -> Iterator[ZoneBox]:
    """Yield the rectangles of all columns, without open nodes. A node reaches halfway to the nodes beside it."""
    middles = 0.5 * (frame.angle[1:] + frame.angle[:-1])
    ends = np.r_[frame.angle[0], middles, frame.angle[-1]]
    for column in columns:
        first = int(column.places[0])
        found = extents([states[place] for place in column.places], states[first - 1] if first else None)[frame.order]
        bounds = np.r_[0, np.flatnonzero(np.diff(found)) + 1, found.size]
        for begin, end in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
            if found[begin] != OPEN:
                yield ZoneBox(column.left, column.right, float(ends[begin]), float(ends[end]), int(found[begin]))

"""The sketch of a joint: pin, plate and bodies in their proportions, with the loads as arrows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle, Wedge

from fastpin.assess.outputs import ROUNDING
from fastpin.bodies.body import Shape
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import Subject
from fastpin.figures.stick_slip import zone_look, zone_patch
from fastpin.figures.style import COLOURS, caption, line, point_text, quantity, range_text
from fastpin.kernels.status import STICK
from fastpin.lugs import Lug, Part, PartLoad
from fastpin.model import Case, LoadHistory, Problem, checks
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.points import edge_body
from fastpin.solver.result import Result
from fastpin.states.choice import StateChoice
from fastpin.states.state import State

LoadRange = tuple[float, float]
"""Smallest and largest value of a load."""

WIDTH = 4.2
"""Width of a sketch, inches."""

GAP = 0.07
"""Drawn clearance, in radii of the hole. The true one could not be seen."""

LARGEST_GAP = 0.7 * GAP
"""Drawn size of the largest initial gap, in radii of the hole. Below the clearance, so that the pin fits in."""

ROUND = np.linspace(-math.pi, math.pi, 721)
"""Angles at which rims that are not round are drawn, rad."""

LONG, SHORT, LARGE = 1.45, 0.55, 14.0
"""Lengths of the arrow of a force and of a remote stress, in radii of the hole, and the height of a plate from which on
arrows of forces grow with the plate."""

ALLOY = "#E8EAED"
"""Shade of the plate."""

PARTS: dict[str, dict[str, Any]] = {
    "lug": {"facecolor": ALLOY, "edgecolor": "0.25", "linewidth": 1.2},
    "bush": {"facecolor": "#EAD9A8", "edgecolor": "0.25", "linewidth": 1.0},
    "hole": {"facecolor": "white", "edgecolor": "0.15", "linewidth": 1.2},
    "bore": {"facecolor": "white", "edgecolor": "0.15", "linewidth": 0.9},
}
"""Style of the parts of bodies."""

ARROW: dict[str, Any] = {"mutation_scale": 11.0, "linewidth": 1.5, "shrinkA": 0.0, "shrinkB": 0.0, "zorder": 6}
"""Style of all arrows."""

LETTERS: dict[str, Any] = {"fontsize": 7.5, "ha": "center", "va": "center", "parse_math": False, "zorder": 7}
"""Style of the words beside arrows."""

BOX = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.8}
"""White behind words, which so can be read over the bodies."""

FORCE, STRESS = "#B2182B", "#2166AC"
"""Colours of forces and of remote stresses."""

HOLD_WORDS = {"both": "held", "x": "held along x", "y": "held along y", "normal": "held along the normal"}
"""Words of the legend for supports."""

ARROWS = 5
"""Arrows of a load on each part; a short part has one."""

LOAD_ARROW = 0.08
"""Length of the longest arrow of a load, in parts of the plate's extent."""


class Scale(NamedTuple):
    """What the arrows of a sketch have in common.

    Half the size of the drawn plate, whether arrows of shear lie along its sides, the force of a long arrow and its
    length, and the side of the words on Q: 1 above the hole, -1 below it, where P does not point.
    """

    half: float
    sheared: bool
    force: float
    long: float
    beside: float


def sketch_plot(subject: Subject, states: StateChoice = None) -> Plot:
    """Return the sketch of the last one of some states; of the history's loads without a choice."""
    if states is None:
        return sketch_of(subject.shown)  # type: ignore[arg-type]
    drawn = subject.states(states)
    return replace(sketch_of(drawn[-1]), notes=drawn.notes)


def sketch_of(joint: Problem | Case | Result | State, history: LoadHistory | None = None) -> Plot:
    """Draw pin, plate, ring or bush in their proportions, and the loads as arrows. The clearance is exaggerated.

    A state has the arrows of its loads, and its contact as a thick arc. A case, a result or a problem with a history
    has an arrow for each load of the history, with the range of its values; the arrow has two heads if the load changes
    its sign.

    The `history` gives a problem its loads.
    """
    if history is not None:
        checks.instance("history", history, LoadHistory, "a LoadHistory")
        if not isinstance(joint, Problem):
            raise InputError("history", "is for a Problem; a case, a result and a state have loads of their own")
    if not isinstance(joint, (Problem, Case, Result, State)):
        raise InputError("joint", f"must be a Problem, Case, Result or State, not {checks.as_toml(joint)}")
    problem = joint if isinstance(joint, Problem) else joint.problem
    state = joint if isinstance(joint, State) else None
    loads = [joint] if isinstance(joint, State) else history if isinstance(joint, Problem) else joint.history
    ranges = {} if loads is None else load_ranges(loads)
    return Plot(
        lambda look: draw_sketch(problem, ranges, look, state),
        instead=f"Sketch of pin and {edge_body(problem, 'plate')} with arrows for the loads.",
        caption=f"The joint to scale, with an exaggerated clearance{' and initial gap' * bool(problem.gap)}, and its "
        "loads with their ranges over the history.",
        width=WIDTH,
    )


plot_sketch = plotter("plot_sketch", sketch_of)


def load_ranges(loads: LoadHistory | Sequence[State]) -> dict[str, LoadRange]:
    """The smallest and the largest value of each load at the corners of a history, or in some states.

    Loads that are always 0 are left out.
    """
    if isinstance(loads, LoadHistory):
        given = np.concatenate([block.given for block in loads.blocks])
        columns = {name: given[:, k][~np.isnan(given[:, k])] for k, name in enumerate(LOADS)}
    else:
        columns = {name: np.array([state.load[name] for state in loads]) for name in LOADS}
    return {name: (float(values.min()), float(values.max())) for name, values in columns.items() if values.any()}


def draw_sketch(
    problem: Problem, ranges: Mapping[str, LoadRange], look: Look, state: State | None = None, words: bool = True
) -> Sheet:
    """Draw a joint on a new sheet. `words` False leaves out heading, caption and legend."""
    sheet = look.sheet([look.width], extra=0.5 if words else 0.0)
    panel = sheet.axes[0, 0]
    panel.set_aspect("equal")
    panel.set_axis_off()
    shapes = problem.plate_body.drawing(problem.joint.hole)
    outside, supports = float(shapes[0].size), list[Line2D]()
    low, high = -outside * (1.0 + 1.0j), outside * (1.0 + 1.0j)
    stresses = {name: span for name, span in ranges.items() if LOAD_KIND[name] == "traction"}
    if shapes[0].plate is not None:
        low, high, supports = _draw_plate(panel, shapes[0], problem, stresses)
        outside, ranges = -low.imag, {name: span for name, span in ranges.items() if name not in stresses}
    for shape in shapes:
        _draw_shape(panel, shape)
    _draw_hole_and_pin(panel, problem, ranges)
    if state is not None:
        _draw_contact(panel, state)
    force = max((_size(ranges[name]) for name in ("P", "Q") if name in ranges), default=0.0)
    beside = -1.0 if ranges.get("P", (0.0, 0.0))[0] < 0.0 else 1.0
    long = LONG * max((high.imag - low.imag) / LARGE, 1.0)
    _draw_loads(panel, problem, ranges, Scale(outside, "sxy" in ranges, force, long, beside))
    has_room = any(LOAD_KIND[name] not in ("force", "moment") for name in {**ranges, **stresses})
    room = 1.25 * long / LONG if has_room else 0.15
    panel.set_xlim(low.real - room, high.real + room)
    panel.set_ylim(low.imag - room, high.imag + room)
    if words:
        zones = [STICK][: len(state.stick)] + [int(zone[2]) for zone in state.slip_zones] if state is not None else []
        looks = dict.fromkeys(zone_look(problem, status) for status in dict.fromkeys(zones))
        entries = [*(zone_patch(look) for look in looks), *supports]
        sheet.legend(entries, min(len(entries), 3))
        exaggerated = ["clearance"] * (problem.clearance > 0.0) + ["initial gap"] * bool(problem.gap)
        note = f"{' and '.join(exaggerated)} exaggerated" if exaggerated else ""
        heading = f"load point {point_text(state)}" if state is not None else ""
        text = caption(problem, () if state is None else [state])
        sheet.head(look.title, heading, caption="; ".join(part for part in (text, note) if part))
    return sheet


def _draw_shape(panel: Axes, shape: Shape, centre: complex = 0j, zorder: float = 1.0) -> None:
    """Draw a shape of a body about a centre."""
    size = shape.size
    if shape.kind == "circle":
        panel.add_patch(Circle((centre.real, centre.imag), size, zorder=zorder, **PARTS[shape.part]))
    elif shape.kind == "square":  # The plate goes on: its cut has no line.
        panel.add_patch(Rectangle((-size, -size), 2.0 * size, 2.0 * size, facecolor=ALLOY, linewidth=0.0))
    elif shape.kind != "outline":
        # Leaning strokes stand close, upright ones apart.
        leans, turn = shape.kind == "leaning strokes", np.linspace(0.0, 2.0 * math.pi, 73)[:-1]
        for angle in turn if leans else turn[::2]:
            begin = size * np.exp(1j * angle)
            end = (1.06 if leans else 1.03) * size * np.exp(1j * (angle + (0.05 if leans else 0.0)))
            panel.plot([begin.real, end.real], [begin.imag, end.imag], color="0.35", linewidth=0.7)


def _draw_plate(
    panel: Axes, shape: Shape, problem: Problem, stresses: Mapping[str, LoadRange]
) -> tuple[complex, complex, list[Line2D]]:
    """Draw a plate of any outline, its supports and its loads with their ranges.

    Returns the lowest and highest x and y that are shown, and the entries of the legend.
    """
    lug: Lug = shape.plate
    factor, entries = shape.size / lug.hole_radius, {}
    z = factor * np.concatenate([part.at(np.linspace(0.0, 1.0, 33)) for part in lug.outline])
    panel.add_patch(Polygon(np.column_stack([z.real, z.imag]), zorder=0.5, **PARTS["lug"]))
    for hole in lug.holes:
        centre = factor * hole.centre
        panel.add_patch(Circle((centre.real, centre.imag), factor * hole.radius, zorder=0.6, **PARTS["bore"]))
    for part in lug.edges:
        if part.name in lug.supports:
            hold = lug.supports[part.name]
            z_held, style = factor * part.at(np.linspace(0.0, 1.0, 33)), hold_line(hold)
            panel.plot(z_held.real, z_held.imag, zorder=2, **style)
            entries[hold] = Line2D([], [], label=HOLD_WORDS[hold], **style)
    for load in lug.loads:
        if load.name in stresses:
            span = stresses[load.name]
            sense = factor * (-1.0 if span[1] <= 0.0 else 1.0)
            draw_edge_load(panel, lug.edges, lug.extent, load, sense, STRESS, range_text(problem, load.name, span))
    low, high = complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
    return low, high, [*entries.values()]


def hold_line(hold: str) -> dict[str, Any]:
    """The look of a support. Dashes tell supports apart in grey."""
    place = list(HOLD_WORDS).index(hold)
    return line(place, place, 4.0)


def _draw_hole_and_pin(panel: Axes, problem: Problem, ranges: Mapping[str, LoadRange]) -> None:
    """Draw the hole, the pin where the force presses it against the hole, and the bore of a hollow pin."""
    clearance = GAP if problem.assembled_clearance > 0.0 else 0.0
    push = complex(_middle(ranges.get("Q")), -_middle(ranges.get("P"))) or -1j
    push /= abs(push)
    hole, pin = (profile.at(ROUND, problem.hole_radius) for profile in (problem.gap.hole, problem.gap.pin))
    scale = LARGEST_GAP / (float(np.abs([hole, pin, hole + pin]).max()) or 1.0)
    hole, pin = scale * hole, scale * pin
    along = np.cos(ROUND - np.angle(push))
    ahead = along > 0.0
    away = push * float(((clearance + hole + pin)[ahead] / along[ahead]).min()) if clearance else 0j
    _draw_rim(panel, 1.0 + hole, 0j, zorder=1.0, **PARTS["hole"])
    pin_style = {"facecolor": "#C9CDD3", "edgecolor": "0.15", "linewidth": 1.0}
    # Without clearance the pin fills the hole.
    _draw_rim(panel, 1.0 - clearance - pin if clearance else 1.0 + hole, away, zorder=3, **pin_style)
    if problem.assembled_clearance < 0.0:  # the free pin is larger than the hole
        free = {"facecolor": "none", "edgecolor": "0.3", "linewidth": 0.8, "linestyle": "--"}
        _draw_rim(panel, 1.0 + GAP - pin, 0j, zorder=3, **free)
    for shape in problem.pin_body.drawing(problem.joint.pin_rim):
        _draw_shape(panel, shape, away, zorder=4.0)


def _draw_rim(panel: Axes, radii: np.ndarray, centre: complex, **style: Any) -> None:
    """Draw a rim with a radius at each angle of :data:`ROUND`: a circle if they are equal."""
    if not np.ptp(radii):
        panel.add_patch(Circle((centre.real, centre.imag), float(radii[0]), **style))
        return
    points = centre + radii * np.exp(1j * ROUND)
    panel.add_patch(Polygon(np.column_stack([points.real, points.imag]), **style))


def _middle(span: LoadRange | None) -> float:
    return 0.0 if span is None else 0.5 * (span[0] + span[1])


def _draw_contact(panel: Axes, state: State) -> None:
    """Draw the contact as a thick arc, with colours and hatches of the map of stick and slip."""
    zones = [(start, stop, STICK) for start, stop in state.stick] + state.slip_zones
    for start, stop, status in zones:
        first, last = math.degrees(start), math.degrees(stop)
        colour, hatch, _ = zone_look(state.problem, int(status))
        panel.add_patch(
            Wedge((0.0, 0.0), 1.07, first, last, width=0.14, facecolor=colour, hatch=hatch,
                  edgecolor="0.25", linewidth=0.0, zorder=5)
        )  # fmt: skip


def _draw_loads(panel: Axes, problem: Problem, ranges: Mapping[str, LoadRange], scale: Scale) -> None:
    """Draw an arrow for each load, with its value."""
    largest = {kind: max((_size(ranges[name]) for name in ranges if LOAD_KIND[name] == kind), default=0.0)
               for kind in set(LOAD_KIND.values())}  # fmt: skip
    below = 0
    for name, span in ranges.items():
        if _size(span) <= ROUNDING * largest[LOAD_KIND[name]]:
            continue
        words = range_text(problem, name, span)
        if name in ("P", "Q"):
            _draw_force(panel, name, span, words, scale)
        elif name == "M":
            _draw_moment(panel, span, words)
        elif LOAD_KIND[name] == "traction":
            _draw_remote(panel, name, span, words, scale)
        else:  # displacements and rotations of the hub
            panel.text(0.0, -scale.half - 0.55 - 0.35 * below, words, color=FORCE, **LETTERS)
            below += 1


def _size(span: LoadRange) -> float:
    return max(abs(span[0]), abs(span[1]))


def draw_arrow(panel: Axes, tail: complex, head: complex, span: LoadRange, colour: str) -> None:
    """Draw an arrow from `tail` to `head` for a positive load, turned round for a negative one, two heads for both."""
    if span[1] <= 0.0:
        tail, head = head, tail
    style = "<|-|>" if span[0] < 0.0 < span[1] else "-|>"
    panel.add_patch(
        FancyArrowPatch((tail.real, tail.imag), (head.real, head.imag), arrowstyle=style, color=colour, **ARROW)
    )


def _draw_force(panel: Axes, name: str, span: LoadRange, words: str, scale: Scale) -> None:
    """Draw a force on the pin: from its centre, through it if the force changes its sign."""
    length = scale.long * max(_size(span) / scale.force, 0.35)  # a shorter arrow has no shaft
    along = -1j if name == "P" else 1.0
    both = span[0] < 0.0 < span[1]
    if span[1] <= 0.0:
        along, span = -along, (-span[1], -span[0])
    draw_arrow(panel, -length * along if both else 0j, length * along, span, FORCE)
    place = (length + 0.22) * along if name == "P" else scale.beside * 1.3j
    panel.text(place.real, place.imag, words, color=FORCE, bbox=BOX, **LETTERS)


def _draw_moment(panel: Axes, span: LoadRange, words: str) -> None:
    """Draw a moment as a turned arrow round the centre, counter-clockwise if positive."""
    ends = 0.55 * np.exp(1j * np.radians([200.0, 100.0] if span[1] <= 0.0 else [100.0, 200.0]))
    style = "<|-|>" if span[0] < 0.0 < span[1] else "-|>"
    bend = f"arc3,rad={-0.45 if span[1] <= 0.0 else 0.45}"
    (x0, x1), (y0, y1) = ends.real, ends.imag
    panel.add_patch(FancyArrowPatch((x0, y0), (x1, y1), arrowstyle=style, connectionstyle=bend, color=FORCE, **ARROW))
    panel.text(-0.1, 0.74, words, color=FORCE, bbox=BOX, **LETTERS)


def _draw_remote(panel: Axes, name: str, span: LoadRange, words: str, scale: Scale) -> None:
    """Draw a remote stress as arrows on two sides: outwards for tension, along the sides for shear."""
    half, out = scale.half, scale.half + 0.12 + (0.22 if scale.sheared else 0.0)
    shift = (0.55 * half * np.array([-1.0, 0.0, 1.0])).tolist()
    for side in (1.0, -1.0):
        if name == "sxx":
            for y in shift:
                draw_arrow(panel, complex(side * out, y), complex(side * (out + SHORT), y), span, STRESS)
        elif name == "syy":
            for x in shift:
                draw_arrow(panel, complex(x, side * out), complex(x, side * (out + SHORT)), span, STRESS)
        else:  # it acts along +x on the upper side, and along +y on the right side
            beside, ends = side * (half + 0.12), side * half * np.array([-0.7, 0.7])
            draw_arrow(panel, complex(ends[0], beside), complex(ends[1], beside), span, STRESS)
            draw_arrow(panel, complex(beside, ends[0]), complex(beside, ends[1]), span, STRESS)
    place = {"sxx": (half + 0.2, 0.9 * half), "syy": (0.0, out + SHORT + 0.25), "sxy": (0.0, -out - SHORT - 0.25)}[name]
    panel.text(*place, words, color=STRESS, bbox=BOX, **LETTERS)


def lug_of(lug: Lug) -> Plot:
    """Draw the outline with names of its parts, all holes, supports and loads. Lengths are in millimetres."""
    checks.instance("lug", lug, Lug, "fastpin.lugs.Lug")
    return Plot(lambda look: _draw(look, lug), width=5.0)


plot_lug = plotter("plot_lug", lug_of)


def _draw(look: Look, lug: Lug) -> Sheet:
    sheet = look.sheet([1.1 * look.width], extra=0.0)
    panel = sheet.axes[0, 0]
    kinds = {}
    for part in (*lug.contact_edge, *lug.edges):
        hold = lug.supports.get(part.name) if part.name else None
        place = 0 if hold is None else 1 + list(HOLD_WORDS).index(hold)
        kinds[place] = ("free", line(5, 0, 1.4)) if hold is None else (HOLD_WORDS[hold], hold_line(hold))
        z = 1e3 * part.at(np.linspace(0.0, 1.0, 61))
        # Snapped to pixels, straight parts would not meet the arcs.
        panel.plot(z.real, z.imag, **kinds[place][1], zorder=3 if hold else 2, snap=False)
    _write_names(panel, lug)
    for load in lug.loads:
        colour = COLOURS[2 + [each.name for each in lug.loads].index(load.name) % 3]
        draw_edge_load(panel, lug.edges, lug.extent, load, 1e3, colour, load.name)
    panel.set_aspect("equal")
    panel.margins(0.14)
    panel.set_xlabel(quantity("x", "mm"))
    panel.set_ylabel(quantity("y", "mm"))
    entries = [kinds[place] for place in sorted(kinds)]
    sheet.legend([Line2D([], [], label=label, **style) for label, style in entries], len(entries))
    sheet.head(look.title)
    return sheet


def _write_names(panel: Axes, lug: Lug) -> None:
    """Write the names inside the plate, each beside the longest of its parts, and in the holes."""
    for part in {part.name: part for part in sorted(lug.outline, key=lambda part: part.length)}.values():
        middle, inwards = _at(part, np.array([0.5]))
        place = 1e3 * (middle[0] + 0.04 * lug.extent * inwards[0])
        rotation = 90.0 if abs(inwards[0].real) > abs(inwards[0].imag) else 0.0
        style: Any = {"ha": "center", "va": "center", "fontsize": 8.0, "rotation": rotation, "parse_math": False}
        panel.text(place.real, place.imag, part.name, **style)
    for name, centre in (("pin", 0j), *((hole.name, hole.centre) for hole in lug.holes)):
        panel.text(1e3 * centre.real, 1e3 * centre.imag, name, ha="center", va="center", fontsize=8.0, parse_math=False)


def _at(part: Part, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of a part, and unit normals into the plate."""
    return part.at(share), 1j * part.direction(share)


def draw_edge_load(
    panel: Axes, parts: Sequence[Part], extent: float, load: PartLoad, factor: float, colour: str, words: str
) -> None:
    """Draw a load as arrows beside its parts, and its words at the last one. A negative `factor` turns the arrows.

    `parts` are those of a plate of the size `extent`, m.
    """
    longest = max(abs(complex(load.x, load.y)) + abs(load.normal), 1e-300)
    end = 0j
    for part in parts:
        if part.name not in load.parts:
            continue
        count = ARROWS if part.length > 0.2 * extent else 1
        points, inwards = _at(part, (np.arange(count) + 0.5) / count)
        points = points - 0.2 * LOAD_ARROW * extent * inwards  # beside the line of the edge
        arrows = (complex(load.x, load.y) - load.normal * inwards) * LOAD_ARROW * extent / longest
        arrows *= math.copysign(1.0, factor)
        outwards = (np.conj(arrows) * inwards).real < 0.0
        tails = np.where(outwards, points, points - arrows)
        for tail, arrow in zip(abs(factor) * tails, abs(factor) * arrows, strict=True):
            head = tail + arrow
            style: Any = {"arrowstyle": "->", "color": colour, "linewidth": 1.0}
            panel.annotate(
                "", xy=(head.real, head.imag), xytext=(tail.real, tail.imag), arrowprops=style, annotation_clip=True
            )
        outer = np.where(outwards, tails + arrows, tails) - 0.04 * extent * inwards
        end = abs(factor) * outer[count // 2]
    panel.text(end.real, end.imag, words, color=colour, fontsize=8.0, ha="center", va="center", parse_math=False)

"""The sketch of a joint of several pins: its plates beside one another, with supports, pins and loads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Rectangle

from fastpin.errors import InputError
from fastpin.figures.joint import JointSubject, extent_of, frame_plates, length_unit
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.sketch import (
    ALLOY,
    BOX,
    FORCE,
    HOLD_WORDS,
    LETTERS,
    PARTS,
    STRESS,
    LoadRange,
    draw_arrow,
    draw_edge_load,
    hold_line,
)
from fastpin.figures.style import span_text
from fastpin.joints import Joint, JointFile, JointPin, JointPlate, JointResult
from fastpin.model.checks import as_toml
from fastpin.report.joints import joint_units

PIN = {"facecolor": "#C9CDD3", "edgecolor": "0.15", "linewidth": 1.0}
"""Style of pins."""

LONG, AWAY, ROOM = 0.1, 0.015, 0.2
"""Length of an arrow, its distance from the edge, and room beside plates, in parts of the width of the panels."""

MOVES = {"": "", "x": "moves along x", "y": "moves along y", "xy": "moves along x and y", "free": "held by its pins"}
"""Words for what the supports of a plate do under load."""


class JointFileSubject(NamedTuple):
    """A joint file, in place of a :class:`fastpin.figures.states.Subject`."""

    case: JointFile

    @property
    def source(self) -> str:
        """A key of :data:`fastpin.figures.kinds.SOURCES`."""
        return "joint file"


class Corners(NamedTuple):
    """Least and largest x and y of all panels, in the unit of the axes."""

    left: float
    right: float
    bottom: float
    top: float


def plates_plot(subject: JointFileSubject | JointSubject) -> Plot:
    """Return the sketch of the joint of a file or of a result."""
    return joint_sketch_of(subject.result if isinstance(subject, JointSubject) else subject.case)


def joint_sketch_of(joint: Joint | JointFile | JointResult) -> Plot:
    """Draw every plate of a joint with its outline, supports, holes, pins and loads, to scale. Nothing is solved.

    A joint file and a result have an arrow for each load, with the range of its values; the arrow has two heads if the
    load changes its sign. A force on a pin stands in the first of its plates, a force on a plate at its edge. Lengths
    are in millimetres.
    """
    if not isinstance(joint, (Joint, JointFile, JointResult)):
        raise InputError("joint", f"must be a Joint, JointFile or JointResult, not {as_toml(joint)}")
    drawn = joint if isinstance(joint, Joint) else joint.joint
    ranges = {} if isinstance(joint, Joint) else load_ranges(drawn, joint)
    return Plot(
        lambda look: _draw(look, drawn, ranges),
        instead=f"Sketch of {len(drawn.plates)} plates and {len(drawn.pins)} pins with arrows for the loads.",
        caption="Plates, supports and pins to scale, and the loads with their ranges over the history.",
    )


plot_joint_sketch = plotter("plot_joint_sketch", joint_sketch_of)


def load_ranges(joint: Joint, of: JointFile | JointResult) -> dict[str, LoadRange]:
    """The smallest and the largest value of each load at the corners of a file, or in the states of a result.

    Loads that are always 0 are left out. A load that a corner does not give keeps its value.
    """
    found: dict[str, LoadRange] = {}
    for name in joint.load_names:
        values, now = [], 0.0
        for loads in of.corners if isinstance(of, JointFile) else [state.load for state in of.states.bare]:
            now = float(loads.get(name, now))
            values.append(now)
        if any(values):
            found[name] = min(values), max(values)
    return found


def _draw(look: Look, joint: Joint, ranges: Mapping[str, LoadRange]) -> Sheet:
    size = length_unit(joint)
    bounds = Corners(*(size.factor * each for each in extent_of(joint)))
    room = ROOM * (bounds.right - bounds.left)
    above = room if any(name.endswith("y") for name in ranges) else 0.3 * room
    bounds = Corners(bounds.left - room, bounds.right + room, bounds.bottom - above, bounds.top + above)
    height = max((look.width - 0.8) * (bounds.top - bounds.bottom) / (bounds.right - bounds.left), 0.8)
    sheet = look.sheet([min(height, 6.0)] * len(joint.plates), extra=1.0, sharex=True)
    holds, titles = dict[str, Any](), list[str]()
    for plate, panel in zip(joint.plates, sheet.axes[:, 0], strict=True):
        _draw_plate(panel, plate, size.factor, bounds, holds)
        for pin in joint.pins_of(plate):
            _draw_pin(panel, pin, plate, size.factor, bounds)
        _draw_loads(panel, joint, plate, ranges, bounds, size.factor)
        words = [plate.name, "infinite" * plate.is_infinite, MOVES[plate.moves]]
        words.append(f"{plate.slices} slices" if plate.slices > 1 else "")
        titles.append(", ".join(filter(None, words)))
    frame_plates(sheet, size, bounds, titles)
    entries = [Line2D([], [], label=HOLD_WORDS[hold], **style) for hold, style in holds.items()]
    sheet.legend(entries, max(len(entries), 1))
    sheet.head(look.title)
    return sheet


def _draw_plate(panel: Axes, plate: JointPlate, factor: float, bounds: Corners, holds: dict[str, Any]) -> None:
    """Draw a plate with its open holes and supports, whose styles are added to `holds`."""
    if plate.is_infinite:  # the plate goes on: its cut has no line
        width, height = bounds.right - bounds.left, bounds.top - bounds.bottom
        panel.add_patch(Rectangle((bounds.left, bounds.bottom), width, height, facecolor=ALLOY, zorder=0.4))
        return
    along, z = np.linspace(0.0, 1.0, 33), _points(plate, factor)
    panel.add_patch(Polygon(np.column_stack([z.real, z.imag]), zorder=0.5, **PARTS["lug"]))
    for hole in plate.holes:
        centre = factor * hole.centre
        panel.add_patch(Circle((centre.real, centre.imag), factor * hole.radius, zorder=0.6, **PARTS["bore"]))
    rims = {hole.name: factor * (hole.centre + hole.radius * np.exp(2j * np.pi * along)) for hole in plate.holes}
    for name, hold in plate.supports.items():
        holds[hold] = hold_line(hold)
        for z in [factor * part.at(along) for part in plate.outline if part.name == name] or [rims[name]]:
            panel.plot(z.real, z.imag, zorder=2, **holds[hold])


def _draw_pin(panel: Axes, pin: JointPin, plate: JointPlate, factor: float, bounds: Corners) -> None:
    """Draw a pin with its bush and its bore, and write its name."""
    x, y = factor * pin.at.real, factor * pin.at.imag
    outer, radius = factor * pin.hole_radius(plate.name), factor * pin.radius
    if outer > radius:
        panel.add_patch(Circle((x, y), outer, zorder=2.5, **PARTS["bush"]))
    panel.add_patch(Circle((x, y), radius, zorder=3, **PIN))
    if pin.bore_radius:
        panel.add_patch(Circle((x, y), factor * pin.bore_radius, zorder=3.5, **PARTS["bore"]))
    is_wide = radius > 0.03 * (bounds.right - bounds.left) and not pin.bore_radius  # the name has room inside
    down = 0.0 if is_wide else outer + 0.02 * (bounds.right - bounds.left)
    panel.text(x, y - down, pin.name, fontsize=7.5, ha="center", va="center" if is_wide else "top", parse_math=False,
               zorder=7)  # fmt: skip


def _draw_loads(
    panel: Axes, joint: Joint, plate: JointPlate, ranges: Mapping[str, LoadRange], bounds: Corners, factor: float
) -> None:
    """Draw the loads of a plate, and those of the pins whose first plate it is, as arrows with their values."""
    units, width, outline = joint_units(joint), bounds.right - bounds.left, _points(plate, factor)
    of_pins = [pin for pin in joint.pins if pin.plates[0] == plate.name]
    for name, span in ranges.items():
        owner, what = name.rsplit(".", 1)
        words, axis = span_text(name, units[joint.load_kind(name)], span), 1j if what.endswith("y") else 1.0
        for at in (factor * pin.at for pin in of_pins if pin.name == owner):
            tail = at - LONG * width * axis if span[0] < 0.0 < span[1] else at
            _draw_arrow(panel, tail, at + LONG * width * axis, span, FORCE, words)
        if owner != plate.name:
            continue
        if joint.load_kind(name) != "traction":
            (left, right), (low, high) = ((z.min(), z.max()) for z in (outline.real, outline.imag))
            side = complex(right, 0.5 * (low + high)) if axis == 1.0 else complex(0.5 * (left + right), high)
            begin = side + AWAY * width * axis
            _draw_arrow(panel, begin, begin + LONG * width * axis, span, FORCE, words)
        elif plate.is_infinite:
            _draw_remote(panel, what, span, bounds, words)
        else:
            size = max(map(float, map(np.ptp, (outline.real, outline.imag)))) / factor
            for load in (load for load in plate.loads if load.name == what):
                sense = factor * (-1.0 if span[1] <= 0.0 else 1.0)
                draw_edge_load(panel, plate.outline, size, load, sense, STRESS, words)


def _points(plate: JointPlate, factor: float) -> np.ndarray:
    """Points of an outline; none of an infinite plate."""
    parts = [part.at(np.linspace(0.0, 1.0, 33)) for part in plate.outline]
    return factor * np.concatenate([np.empty(0, dtype=complex), *parts])


def _draw_arrow(panel: Axes, tail: complex, head: complex, span: LoadRange, colour: str, words: str) -> None:
    """Draw the arrow of a load, and its words beside the head."""
    draw_arrow(panel, tail, head, span, colour)
    long, is_level = abs(head - tail), head.imag == tail.imag
    place = tail + (0.1 + 0.25j) * long if is_level else head + 0.2j * long
    panel.text(
        place.real, place.imag, words, color=colour, bbox=BOX, **LETTERS | {"ha": "left" if is_level else "center"}
    )


def _draw_remote(panel: Axes, name: str, span: LoadRange, bounds: Corners, words: str) -> None:
    """Draw the remote stress of an infinite plate as arrows at two sides of the panel, within it."""
    low, high = complex(bounds.left, bounds.bottom), complex(bounds.right, bounds.top)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    long = 1.4 * LONG * min(half.real, half.imag)
    along, at = {  # shear acts along +x on the upper side
        "sxx": (1.0 + 0.0j, middle + half.real - 1.3 * long),
        "syy": (1.0j, middle + (half.imag - 1.3 * long) * 1j),
        "sxy": (1.0 + 0.0j, middle + (half.imag - 0.4 * long) * 1j - 0.6 * half.real),
    }[name]
    for side in (1.0, -1.0):
        tail = middle + side * (at - middle)
        draw_arrow(panel, tail, tail + side * long * along, span, STRESS)
    place = at + {"sxx": (1.0 + 0.6j), "syy": (0.3 + 0.5j), "sxy": (0.0 - 0.6j)}[name] * long
    side_of = {"sxx": "right", "syy": "left", "sxy": "left"}[name]
    panel.text(place.real, place.imag, words, color=STRESS, bbox=BOX, **LETTERS | {"ha": side_of})

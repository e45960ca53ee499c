"""Figures of joints: a map of all holes, and the forces of the pins over the load points."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.lines import Line2D

from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, MAX_NAMED, draw_grid, line, quantity
from fastpin.joints import Joint, JointPlate, JointResult, JointState
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.checks import instance, whole_number
from fastpin.model.unit_systems import SI
from fastpin.model.units import Unit
from fastpin.report.joints import joint_units, moved_by, pin_forces

RING = 1.35
"""Outer radius of the ring that shows the hoop stress, in hole radii."""

AROUND = 721
"""Angles at which the hoop stress is drawn."""


def joint_of(result: JointResult, state: int = -1) -> Plot:
    """Draw every plate with its holes at one state: hoop stress, contact, and the force of each pin.

    The ring round a hole shows the hoop stress on its edge. Thick arcs on the edge are in contact: stick is black, slip
    is orange. Arrows are the forces of the pins on the plate. At each hole the slice with the largest hoop stress is
    drawn. Lengths are in millimetres, to scale. `state` is the number of the state, from 0; negative numbers count from
    the end.
    """
    instance("result", result, JointResult, "a JointResult")
    if not len(result):
        raise InputError("result", "has no state")
    chosen = result[whole_number("state", state, -len(result), len(result) - 1)]
    extent = _extent(chosen)
    return Plot(
        lambda look: _draw_map(look, chosen, extent),
        instead=f"Map of {len(chosen.joint.plates)} plates and {len(chosen.joint.pins)} pins with the hoop stress.",
        caption=f"Hoop stress, contact and forces of the pins at load point {chosen.step + 1}.",
    )


plot_joint = plotter("plot_joint", joint_of)


def shares_of(result: JointResult) -> Plot:
    """Draw the force of each pin on its first plate over the load points, and the friction of its faying surfaces."""
    instance("result", result, JointResult, "a JointResult")
    if not len(result):
        raise InputError("result", "has no state")
    return Plot(
        lambda look: _draw_shares(look, result),
        instead=f"Line chart of the forces of {len(result.joint.pins)} pins over {len(result)} load points.",
        caption="Force of each pin on its first plate, negative against its largest one"
        + ("; friction of the faying surfaces, in size." if result.joint.faying else "."),
    )


plot_shares = plotter("plot_shares", shares_of)


def _extent(state: JointState) -> tuple[float, float, float, float]:
    """Least and largest x and y, m, of all outlines and holes."""
    joint = state.joint
    points = [pin.at for pin in joint.pins]
    points += [z for plate in joint.plates for part in plate.outline for z in part.at(np.linspace(0.0, 1.0, 9))]
    margin = 2.0 * RING * joint.radius if any(plate.is_infinite for plate in joint.plates) else 0.5 * joint.radius
    x, y = np.real(points), np.imag(points)
    return x.min() - margin, x.max() + margin, y.min() - margin, y.max() + margin


def _draw_map(look: Look, state: JointState, extent: tuple[float, float, float, float]) -> Sheet:
    joint = state.joint
    left, right, bottom, top = extent
    height = max((look.width - 1.6) * (top - bottom) / (right - left), 0.8)
    sheet = look.sheet([min(height, 6.0)] * len(joint.plates), extra=1.3, sharex=True)
    theta = np.linspace(-np.pi, np.pi, AROUND)
    hoops = [contact.hoop_stress("plate", theta) for contact in state.contacts]
    of_joint, size = joint_units(joint), _length(joint)
    factor, unit = of_joint["traction"].scale([float(np.abs(hoop).max()) for hoop in hoops])
    largest = factor * max(float(np.abs(hoop).max()) for hoop in hoops) or 1.0
    norm = TwoSlopeNorm(0.0, -largest, largest)
    on_plates = [state.force(pin.name, plate.name) for plate in joint.plates for pin in joint.pins_of(plate)]
    longest = max(float(np.hypot(*force)) for force in on_plates)
    for place, (plate, panel) in enumerate(zip(joint.plates, sheet.axes[:, 0], strict=True)):
        for part in plate.outline:
            z = size.factor * part.at(np.linspace(0.0, 1.0, 61))
            held = part.name in plate.supports
            panel.plot(z.real, z.imag, color="0.2", linewidth=3.0 if held else 1.2, snap=False)
        for hole in plate.holes:
            z = size.factor * (hole.centre + hole.radius * np.exp(1j * theta))
            panel.plot(z.real, z.imag, color="0.2", linewidth=1.2)
        for pin in joint.pins_of(plate):
            k = max(joint.places(pin.name, plate.name), key=lambda k: float(np.abs(hoops[k]).max()))
            _draw_hole(panel, state, k, plate, theta, factor * hoops[k], norm, longest or 1.0)
        panel.set_aspect("equal")
        panel.set_xlim(size.factor * left, size.factor * right)
        panel.set_ylim(size.factor * bottom, size.factor * top)
        panel.set_ylabel(quantity("y", size.name))
        by = ", ".join(f"{size.factor * each:.3g}" for each in moved_by(state, place))
        words = f", moved by {by} {size.name}" if plate.moves else ""
        words += f"; at each hole the most stressed of {plate.slices} slices" if plate.slices > 1 else ""
        panel.set_title(f"{plate.name}{words}", fontsize=8.5, loc="left", parse_math=False)
    sheet.axes[-1, 0].set_xlabel(quantity("x", size.name))
    mappable = sheet.axes[0, 0].collections[0]
    label, panels = quantity("hoop stress", unit), list(sheet.axes[:, 0])
    sheet.figure.colorbar(mappable, ax=panels, label=label, shrink=0.8, pad=0.02)
    looks = {"sticks": "black", "slips": COLOURS[1]}
    entries = [Line2D([], [], color=colour, label=label, linewidth=3.0) for label, colour in looks.items()]
    words = f"load point {state.step + 1}, largest force: {of_joint['force'].text(longest, 3)}"
    sheet.legend([*entries, Line2D([], [], color="black", marker=">", label=words)], 3)
    sheet.head(look.title)
    return sheet


def _draw_hole(
    panel: Axes,
    state: JointState,
    place: int,
    plate: JointPlate,
    theta: np.ndarray,
    hoop: np.ndarray,
    norm: Any,
    longest: float,
) -> None:
    """Draw one hole: the ring of the hoop stress, the zones of contact, the force and the name of its pin."""
    contact, (pin, _) = state.contacts[place], state.joint.sections[place]
    radius, centre = _length(state.joint).factor * pin.radius, _length(state.joint).factor * pin.at
    ring = centre + radius * np.multiply.outer([1.0, RING], np.exp(1j * theta))
    panel.pcolormesh(
        ring.real, ring.imag, np.vstack([hoop, hoop]), cmap="RdBu_r", norm=norm, shading="gouraud", rasterized=True
    )
    edge = centre + radius * np.exp(1j * theta)
    panel.plot(edge.real, edge.imag, color="0.2", linewidth=0.8)
    half = 0.5 * float(np.diff(contact.theta[:2])[0])
    for angle, status in zip(contact.theta, contact.status, strict=True):
        if status != OPEN:
            arc = centre + 0.97 * radius * np.exp(1j * np.linspace(angle - half, angle + half, 5))
            colour = "black" if status == STICK else COLOURS[1]
            panel.plot(arc.real, arc.imag, color=colour, linewidth=3.0, solid_capstyle="butt")
    force = complex(*state.force(pin.name, plate.name)) / longest
    if abs(force) > 0.02:
        head = centre + 0.8 * radius * force
        style: Any = {"arrowstyle": "-|>", "color": "black", "linewidth": 1.2, "shrinkA": 0.0, "shrinkB": 0.0}
        panel.annotate("", xy=(head.real, head.imag), xytext=(centre.real, centre.imag), arrowprops=style)
    panel.text(
        centre.real, centre.imag - 0.55 * radius, pin.name, ha="center", va="center", fontsize=7.5, parse_math=False
    )


def _length(joint: Joint) -> Unit:
    """The unit of lengths along the axes; mm in SI units."""
    return Unit(1e3, "mm") if joint.unit_system == SI else joint_units(joint)["length"]


def _draw_shares(look: Look, result: JointResult) -> Sheet:
    joint, states, points = result.joint, result.states.bare, 1.0 + np.arange(len(result))
    sheet = look.sheet([2.6])
    panel = sheet.axes[0, 0]
    forces = {pin.name: pin_forces(result, pin) for pin in joint.pins}
    forces |= {
        f"friction {surface}": [float(np.hypot(*state.faying[k].force)) for state in states]
        for k, surface in enumerate(joint.faying)
    }
    largest = max(max(map(abs, values)) for values in forces.values())
    curves: dict[str, list[float]] = {}
    for name, values in forces.items():  # Curves less than the width of a line apart are one, with several names.
        same = [names for names, known in curves.items() if np.ptp([known, values], axis=0).max() <= 3e-3 * largest]
        known = curves.pop(same[0]) if same else values
        curves[", ".join([*same[:1], name])] = known
    factor, unit = joint_units(joint)["force"].scale([largest])
    few = len(points) <= 60
    for k, values in enumerate(curves.values()):
        style = line(k % MAX_NAMED, k // MAX_NAMED)
        panel.plot(points, factor * np.array(values), marker="o" if few else "", markersize=3.5, **style)
    draw_grid(panel)
    panel.set_xlabel("load point")
    panel.set_ylabel(quantity("force" if joint.faying else "force of the pin", unit))
    if min(map(min, forces.values())) >= 0.0:
        panel.set_ylim(bottom=0.0)
    if few and len(points) < 12:
        panel.set_xticks(points)
    handles = [Line2D([], [], label=name, **line(k % MAX_NAMED, k // MAX_NAMED)) for k, name in enumerate(curves)]
    sheet.legend(handles, min(len(handles), 5))
    sheet.head(look.title)
    return sheet

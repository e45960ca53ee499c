"""Figures of joints: a map of all holes, forces and shares of the pins, loads over displacements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from fastpin.assess.outputs import Curve
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, MAX_NAMED, draw_grid, line, quantity
from fastpin.joints import Joint, JointPlate, JointResult, JointState
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import ties
from fastpin.model.checks import instance, whole_number
from fastpin.model.unit_systems import SI
from fastpin.model.units import Unit
from fastpin.report.joints import joint_units, moved_by, pin_forces
from fastpin.states.choice import even_choice

RING = 1.35
"""Outer radius of the ring that shows the hoop stress, in hole radii."""

AROUND = 721
"""Angles at which the hoop stress is drawn."""

MOST_BARS = 24
"""Most load points with a bar of shares."""

HATCHES = ("", "////", "xxx", "\\\\\\\\")
"""Hatches of the bars, which tell them apart in grey. Dots would make a large SVG."""

SAME_SHARE = 0.3
"""Difference of two shares that can't be told apart, per cent."""


class JointSubject(NamedTuple):
    """A joint, in place of a :class:`fastpin.figures.states.Subject`."""

    result: JointResult

    @property
    def source(self) -> str:
        """A key of :data:`fastpin.figures.kinds.SOURCES`."""
        return "joint"


def holes_plot(subject: JointSubject, at: int | None = None) -> Plot:
    """Return the map of all holes at a load point, or the last one."""
    last = len(_with_states(subject.result))
    return joint_of(subject.result, (last if at is None else whole_number("at", at, 1, last)) - 1)


def shares_plot(subject: JointSubject) -> Plot:
    """Return the forces of all pins over the load points."""
    return shares_of(subject.result)


def share_bars_plot(subject: JointSubject) -> Plot:
    """Return the shares of the pins in the forces on the plates, as bars."""
    return share_bars_of(subject.result)


def displacement_plot(subject: JointSubject) -> Plot:
    """Return the loads of the plates that move, over their displacement."""
    return displacement_of(subject.result)


def _with_states(result: JointResult) -> JointResult:
    """Return a result with states. Without a state raise :class:`InputError`."""
    if not len(instance("result", result, JointResult, "a JointResult")):
        raise InputError("result", "has no state")
    return result


def joint_of(result: JointResult, state: int = -1) -> Plot:
    """Draw every plate with its holes at one state: hoop stress, contact, and the force of each pin.

    The ring round a hole shows the hoop stress on its edge. Thick arcs on the edge are in contact: stick is black, slip
    is orange. A bush has a second edge, its bore. Arrows are the forces of the pins on the plate. At each hole the
    slice with the largest hoop stress is drawn. Lengths are in millimetres, to scale. `state` is the number of the
    state, from 0; negative numbers count from the end.
    """
    _with_states(result)
    chosen = result[whole_number("state", state, -len(result), len(result) - 1)]
    extent = extent_of(chosen.joint)
    return Plot(
        lambda look: _draw_map(look, chosen, extent),
        instead=f"Map of {len(chosen.joint.plates)} plates and {len(chosen.joint.pins)} pins with the hoop stress.",
        caption=f"Hoop stress, contact and forces of the pins at load point {chosen.step + 1}.",
    )


plot_joint = plotter("plot_joint", joint_of)


def shares_of(result: JointResult) -> Plot:
    """Draw the force of each pin on its first plate over the load points, and the friction of its faying surfaces."""
    unit = joint_units(_with_states(result).joint)["force"]
    columns: dict[str, Any] = {"load point": _points(result)}
    for name, values in _forces(result).items():
        columns |= unit.column(name, np.array(values))
    return Plot(
        lambda look: _draw_shares(look, result),
        [Curve({}, columns)],
        instead=f"Line chart of the forces of {len(result.joint.pins)} pins over {len(result)} load points.",
        caption="Force of each pin on its first plate, negative against its largest one"
        + ("; friction of the faying surfaces, in size." if result.joint.faying else "."),
    )


plot_shares = plotter("plot_shares", shares_of)


def share_bars_of(result: JointResult) -> Plot:
    """Draw the share of each pin in the force on each plate at the load points, as bars one above the other.

    Plates with equal shares have one panel. Of many load points some are drawn, the one with the largest force of a pin
    among them. A load point whose pins do not load the plate together has no bar. Without a plate of two pins an
    :class:`InputError` is raised.
    """
    plates = [plate.name for plate in _with_states(result).joint.plates if len(result.joint.pins_of(plate)) > 1]
    if not plates:
        raise InputError("result", "has no plate with two pins: there are no shares")
    shares = {plate: result.shares(plate) for plate in plates}
    largest = ties.top([float(np.abs(state.forces).max()) for state in result.states.bare])
    places = even_choice(range(len(result)), MOST_BARS, {largest: "largest force"})
    columns: dict[str, Any] = {"load point": _points(result)}
    for plate, of_pins in shares.items():
        columns |= {f"{pin} on {plate}": values for pin, values in of_pins.items()}
    count = "" if len(places) == len(result) else f" {len(places)} of {len(result):,} load points are drawn."
    return Plot(
        lambda look: _draw_bars(look, result, shares, places),
        [Curve({}, columns)],
        f"Bars of the shares of {len(result.joint.pins)} pins in the forces on {len(plates)} plates.",
        f"Share of each pin in the force on a plate.{count}",
        [f"the figure shows {len(places)} of {len(result):,} load points"] if count else [],
    )


plot_share_bars = plotter("plot_share_bars", share_bars_of)


def displacement_of(result: JointResult) -> Plot:
    """Draw the load of each plate that moves over the displacement of its supports, with the first touch of each pin.

    The lines between the load points are straight; the path is not. Without such a plate an :class:`InputError` is
    raised.
    """
    joint, states = _with_states(result).joint, result.states.bare
    moving = [
        (f"{plate.name}.{axis}", [float(moved_by(state, place)[k]) for state in states])
        for place, plate in enumerate(joint.plates)
        for k, axis in enumerate("xy")
        if f"{plate.name}.{axis}" in joint.load_names
    ]
    if not moving:
        raise InputError("result", "has no plate that moves under a load of its own: there is no displacement to draw")
    unit = joint_units(joint)
    columns: dict[str, Any] = {"load point": _points(result)}
    for name, moved in moving:
        columns |= unit["force"].column(name, np.array([state.load[name] for state in states]))
        columns |= unit["displacement"].column(f"u {name}", np.array(moved))
    return Plot(
        lambda look: _draw_displacement(look, result, moving),
        [Curve({}, columns)],
        f"Line chart of the load over the displacement of {', '.join(name for name, _ in moving)}.",
        "Load over the displacement of the plates that move. Lines between the load points are straight. Triangles: "
        "the first load point at which pins touch a hole.",
    )


plot_displacement = plotter("plot_displacement", displacement_of)


def _points(result: JointResult) -> np.ndarray:
    """The numbers of the load points."""
    return np.arange(1, len(result) + 1)


def _forces(result: JointResult) -> dict[str, list[float]]:
    """The force of each pin on its first plate, with its sign, and the size of the friction of each faying surface."""
    joint, states = result.joint, result.states.bare
    found = {pin.name: pin_forces(result, pin) for pin in joint.pins}
    return found | {
        f"friction {surface}": [float(np.hypot(*state.faying[k].force)) for state in states]
        for k, surface in enumerate(joint.faying)
    }


def extent_of(joint: Joint) -> tuple[float, float, float, float]:
    """Least and largest x and y, m, of all outlines and holes."""
    points = [pin.at for pin in joint.pins]
    points += [z for plate in joint.plates for part in plate.outline for z in part.at(np.linspace(0.0, 1.0, 9))]
    radius = max(joint.radius_in(plate) for plate in joint.plates)
    margin = 2.0 * RING * radius if any(plate.is_infinite for plate in joint.plates) else 0.5 * radius
    x, y = np.real(points), np.imag(points)
    return x.min() - margin, x.max() + margin, y.min() - margin, y.max() + margin


def _draw_map(look: Look, state: JointState, extent: tuple[float, float, float, float]) -> Sheet:
    joint = state.joint
    left, right, bottom, top = extent
    height = max((look.width - 1.6) * (top - bottom) / (right - left), 0.8)
    sheet = look.sheet([min(height, 6.0)] * len(joint.plates), extra=1.3, sharex=True)
    theta = np.linspace(-np.pi, np.pi, AROUND)
    hoops = [(contact.seat or contact).hoop_stress("plate", theta) for contact in state.contacts]
    of_joint, size = joint_units(joint), length_unit(joint)
    factor, unit = of_joint["traction"].scale([float(np.abs(hoop).max()) for hoop in hoops])
    largest = factor * max(float(np.abs(hoop).max()) for hoop in hoops) or 1.0
    norm = TwoSlopeNorm(0.0, -largest, largest)
    on_plates = [state.force(pin.name, plate.name) for plate in joint.plates for pin in joint.pins_of(plate)]
    longest = max(float(np.hypot(*force)) for force in on_plates)
    titles = []
    is_wide = (look.width - 1.6) * joint.radius / (right - left) > 0.22  # inches: names have room inside
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
            radius = joint.radius_in(plate)
            down = 0.55 * radius if is_wide else -1.1 * RING * radius
            at, style = size.factor * (pin.at - 1j * down), "center" if is_wide else "bottom"
            panel.text(at.real, at.imag, pin.name, ha="center", va=style, fontsize=7.5, parse_math=False)
        panel.set_rasterization_zorder(0.0)  # the rings of a panel are one image
        by = ", ".join(f"{size.factor * each:.3g}" for each in moved_by(state, place))
        words = f", moved by {by} {size.name}" if plate.moves else ""
        words += f"; at each hole the most stressed of {plate.slices} slices" if plate.slices > 1 else ""
        titles.append(f"{plate.name}{words}")
    frame_plates(sheet, size, [size.factor * each for each in extent], titles)
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
    """Draw one hole: the ring of the hoop stress, the zones of contact, and the force of its pin."""
    contact, (pin, of), factor = state.contacts[place], state.joint.sections[place], length_unit(state.joint).factor
    radius, centre = factor * pin.hole_radius(of.name), factor * pin.at
    ring = centre + radius * np.multiply.outer([1.0, RING], np.exp(1j * theta))
    panel.pcolormesh(
        ring.real, ring.imag, np.vstack([hoop, hoop]), cmap="RdBu_r", norm=norm, shading="gouraud", zorder=-1.0
    )
    if pin.bore_radius:
        bore = centre + factor * pin.bore_radius * np.exp(1j * theta)
        panel.plot(bore.real, bore.imag, color="0.2", linewidth=0.8)
    for each in filter(None, (contact.seat, contact)):  # a bush and its bore, or the hole
        own = factor * each.problem.hole_radius
        edge = centre + own * np.exp(1j * theta)
        panel.plot(edge.real, edge.imag, color="0.2", linewidth=0.8)
        half = 0.5 * float(np.diff(each.theta[:2])[0])
        sticks, slips = each.status == STICK, (each.status != STICK) & (each.status != OPEN)
        for nodes, colour in ((sticks, "black"), (slips, COLOURS[1])):
            turns = np.add.outer(each.theta[nodes], [*np.linspace(-half, half, 5), np.nan]).ravel()
            arcs = centre + 0.97 * own * np.exp(1j * turns)  # one line with gaps, so that an SVG is small
            panel.plot(arcs.real, arcs.imag, color=colour, linewidth=3.0, solid_capstyle="butt")
    force = complex(*state.force(pin.name, plate.name)) / longest
    if abs(force) > 0.02:
        head = centre + 0.8 * radius * force
        style: Any = {"arrowstyle": "-|>", "color": "black", "linewidth": 1.2, "shrinkA": 0.0, "shrinkB": 0.0}
        panel.annotate("", xy=(head.real, head.imag), xytext=(centre.real, centre.imag), arrowprops=style)


def frame_plates(sheet: Sheet, size: Unit, bounds: Sequence[float], titles: Sequence[str]) -> None:
    """Give the panels of all plates one frame, to scale, and their titles.

    `bounds` are least and largest x and y in the unit `size` of lengths.
    """
    left, right, bottom, top = bounds
    for panel, title in zip(sheet.axes[:, 0], titles, strict=True):
        panel.set_aspect("equal")
        panel.set_xlim(left, right)
        panel.set_ylim(bottom, top)
        panel.set_ylabel(quantity("y", size.name))
        panel.set_title(title, fontsize=8.5, loc="left", parse_math=False)
    for panel in sheet.axes[:-1, 0]:
        panel.tick_params(axis="x", length=0.0)  # they would touch the title below
    sheet.axes[-1, 0].set_xlabel(quantity("x", size.name))


def length_unit(joint: Joint) -> Unit:
    """The unit of lengths along the axes; mm in SI units."""
    return Unit(1e3, "mm") if joint.unit_system == SI else joint_units(joint)["length"]


def _draw_shares(look: Look, result: JointResult) -> Sheet:
    joint, points, forces = result.joint, _points(result), _forces(result)
    sheet = look.sheet([2.6])
    panel = sheet.axes[0, 0]
    largest = max(max(map(abs, values)) for values in forces.values())
    curves: dict[str, list[float]] = {}
    for name, values in forces.items():  # Curves less than the width of a line apart are one, with several names.
        same = [names for names, known in curves.items() if np.ptp([known, values], axis=0).max() <= 3e-3 * largest]
        known = curves.pop(same[0]) if same else values
        curves[", ".join([*same[:1], name])] = known
    factor, unit = joint_units(joint)["force"].scale([largest])
    few = len(points) <= 60
    for k, values in enumerate(curves.values()):
        style = line(k % MAX_NAMED, (k + k // MAX_NAMED) % MAX_NAMED)
        panel.plot(points, factor * np.array(values), marker="o" if few else "", markersize=3.5, **style)
    draw_grid(panel)
    panel.set_xlabel("load point")
    panel.set_ylabel(quantity("force" if joint.faying else "force of the pin", unit))
    if min(map(min, forces.values())) >= 0.0:
        panel.set_ylim(bottom=0.0)
    if few and len(points) < 12:
        panel.set_xticks(points)
    handles = [
        Line2D([], [], label=name, **line(k % MAX_NAMED, (k + k // MAX_NAMED) % MAX_NAMED))
        for k, name in enumerate(curves)
    ]
    sheet.legend(handles, min(len(handles), 5))
    sheet.head(look.title)
    return sheet


def _draw_bars(
    look: Look, result: JointResult, shares: dict[str, dict[str, np.ndarray]], places: Sequence[int]
) -> Sheet:
    panels: dict[str, dict[str, np.ndarray]] = {}
    for plate, of_pins in shares.items():
        drawn = {pin: 100.0 * values[places] for pin, values in of_pins.items()}
        rows = np.array([*drawn.values()])
        twin = [
            names
            for names, known in panels.items()
            if known.keys() == drawn.keys() and np.allclose([*known.values()], rows, 0.0, SAME_SHARE, equal_nan=True)
        ]
        known = panels.pop(twin[0]) if twin else drawn
        panels[", ".join([*twin[:1], plate])] = known
    sheet = look.sheet([1.9] * len(panels), sharex=True)
    pins = [pin.name for pin in result.joint.pins]
    for (plates, of_pins), panel in zip(panels.items(), sheet.axes[:, 0], strict=True):
        draw_grid(panel, "y")
        panel.set_axisbelow(True)
        above, below = np.zeros(len(places)), np.zeros(len(places))
        for pin, values in of_pins.items():
            sizes = np.nan_to_num(values)
            bottom = np.where(sizes < 0.0, below, above)
            panel.bar(np.arange(len(places)), sizes, bottom=bottom, **_bar(pins.index(pin)))
            above, below = above + np.maximum(sizes, 0.0), below + np.minimum(sizes, 0.0)
            for x, size in enumerate(sizes if len(places) <= MOST_BARS // 2 else ()):
                if abs(size) >= 7.0:  # the name has room inside
                    box: Any = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
                    middle = bottom[x] + 0.5 * size
                    panel.text(x, middle, pin, fontsize=6.5, ha="center", va="center", bbox=box, parse_math=False)
        for x in np.flatnonzero(np.isnan(next(iter(of_pins.values())))).tolist():
            panel.text(x, 2.0, "none", fontsize=6.5, ha="center", va="bottom", rotation=90)
        panel.set_ylim(min(0.0, 1.05 * float(below.min())), max(100.0, 1.05 * float(above.max())))
        panel.set_ylabel(quantity("share", "%"))
        panel.set_title(plates, fontsize=8.5, loc="left", parse_math=False)
    last = sheet.axes[-1, 0]
    beside = 0.6 + 0.5 * max(6 - len(places), 0)  # a single bar is not as wide as the figure
    last.set_xlim(-beside, len(places) - 1 + beside)
    last.set_xticks(range(len(places)), [f"{place + 1:,}" for place in places])
    last.tick_params(axis="x", labelsize=6.5 if len(places) > MOST_BARS // 2 else None)
    last.set_xlabel("load point")
    sheet.legend([Patch(label=pin, **_bar(k)) for k, pin in enumerate(pins)], min(len(pins), 8))
    sheet.head(look.title)
    return sheet


def _bar(number: int) -> dict[str, Any]:
    """The keywords of the bars of a pin."""
    hatch = HATCHES[(number + number // MAX_NAMED) % len(HATCHES)]
    look = {"facecolor": COLOURS[number % MAX_NAMED], "edgecolor": "white", "linewidth": 0.8}
    return look | {"hatch": hatch}


def _draw_displacement(look: Look, result: JointResult, moving: Sequence[tuple[str, list[float]]]) -> Sheet:
    joint, states = result.joint, result.states.bare
    sheet = look.sheet([2.8])
    panel, unit = sheet.axes[0, 0], joint_units(joint)
    draw_grid(panel)
    force, force_unit = unit["force"].scale([state.load[name] for name, _ in moving for state in states])
    length, length_unit = unit["displacement"].scale([each for _, moved in moving for each in moved])
    touched: dict[int, list[str]] = {}
    for (pin, _), place in result.first_touches.items():
        if place >= 0 and pin not in touched.setdefault(place, []):
            touched[place].append(pin)
    handles = []
    for k, (name, moved) in enumerate(moving):
        x, y = length * np.array(moved), force * np.array([state.load[name] for state in states])
        few = len(states) <= 60
        panel.plot(x, y, marker="o" if few else "", markersize=3.0, **line(k % MAX_NAMED, k % MAX_NAMED))
        handles.append(Line2D([], [], label=name, **line(k % MAX_NAMED, k % MAX_NAMED)))
        panel.plot(x[list(touched)], y[list(touched)], "v", color="black", markersize=5.5)
        panel.annotate(" start", (x[0], y[0]), fontsize=7.0, ha="left", va="top")
    entries = [
        Line2D([], [], linestyle="none", marker="v", color="black", label=f"touch at {place + 1}: {', '.join(pins)}")
        for place, pins in sorted(touched.items())
    ]
    panel.set_xlabel(quantity("displacement", length_unit))
    panel.set_ylabel(quantity("load", force_unit))
    sheet.legend([*handles, *entries], 3)
    sheet.head(look.title)
    return sheet

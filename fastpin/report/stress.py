"""Curves of stresses: tractions, round the hole and the pin, below a place of the edge, and as a field."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fastpin.assess.outputs import Curve
from fastpin.damage.hole_strength import laminate_of
from fastpin.damage.laminates import first_ply_failure
from fastpin.errors import InputError
from fastpin.model import Problem, angles, checks, points
from fastpin.model.units import units
from fastpin.reading.stress import Stress
from fastpin.states.quantities import load_point
from fastpin.states.state import State

AROUND = 720
"""Equally spaced angles of a curve round the hole, beside the places of its states where the stress turns sharply."""

DEPTHS = 161
"""Depths of a profile. They gather at the edge."""

COMPONENTS = {
    "radial": "radial stress",
    "hoop": "hoop stress",
    "shear": "shear stress (polar)",
    "axial": "stress along the pin",
    "sxx": "stress along x",
    "syy": "stress along y",
    "sxy": "shear stress xy",
    "largest": "largest principal stress",
    "von_mises": "von Mises stress",
    "tresca": "Tresca stress",
    "hydrostatic": "mean normal stress",
}
"""Components of the stress that can be drawn, and their names."""

UTILIZATION = "utilization"
"""The name of the strength of a laminate that is used: 1 over the strength ratio of the first ply, by Hashin."""

FIELDS = COMPONENTS | {UTILIZATION: "used strength of the first ply (Hashin)"}
"""What maps show, and the words for it."""


def component_of(stress: Stress, component: str) -> np.ndarray:
    """A component of :data:`COMPONENTS`, shape of the points.

    Raises
    ------
    InputError
        If there is no such component.
    """
    name = checks.choice("component", component, tuple(COMPONENTS))
    values: np.ndarray = stress.principal[..., 0] if name == "largest" else getattr(stress, name)
    return values


def bodies_of(state: State, body: str = "both") -> tuple[points.Body, ...]:
    """The bodies to draw: "plate", "pin", "seat", or "both": all that the problem has, without rigid ones.

    Raises
    ------
    InputError
        If there is no such body.
    """
    if checks.choice("body", body, (*points.BODIES, "both")) != "both":
        return (body,)  # type: ignore[return-value]
    return points.elastic_bodies(state.problem)


def hoop_curves(states: Sequence[State], body: str = "both") -> list[Curve]:
    """The hoop stress round hole, seat of a bush and pin: a curve for each body and state.

    Columns: the angle in degrees from the bottom, -180 to 180, and the hoop stress in Pa or F/R; its part that the
    assembly leaves before any load, if something is pressed.
    """
    unit, curves = units(states[0].problem)["traction"], []
    for each in bodies_of(states[0], body):
        for state in states:
            around = -1.5 * math.pi + 2.0 * math.pi * np.arange(AROUND + 1) / AROUND
            sharp = np.concatenate([np.zeros(0), *(patch[:, 0] for patch in state.refined.tractions.patches)])
            sharp = np.remainder(sharp + 1.5 * math.pi, 2.0 * math.pi) - 1.5 * math.pi
            theta = np.unique(np.r_[around, sharp])
            columns = {"angle [deg]": np.degrees(theta) + 90.0}
            columns |= unit.column("hoop stress", state.hoop_stress(each, theta))
            if state.problem.is_pressed:
                before = state.assembly_stress(points.Points.at_depth(0.0, theta), each).hoop
                columns |= unit.column("hoop stress of the assembly", before)
            curves.append(Curve({"body": each, "load point": load_point(state)}, columns))
    return curves


def outline_curves(states: Sequence[State]) -> list[Curve]:
    """The hoop stress along the outline and the further holes of a plate of any outline: a curve for each state.

    Columns: the place along the edges, counter-clockwise from the beginning of the outline, x, y, the stress, and the
    name of the edge. A plate without an outline raises :class:`InputError`.
    """
    unit, curves = units(states[0].problem), []
    for state in states:
        found = state.outline_hoop_stress()
        columns: dict[str, np.ndarray] = {}
        for name, values in (("along the edges", found.along), ("x", found.x), ("y", found.y)):
            columns |= unit["length"].column(name, values)
        columns |= unit["traction"].column("hoop stress", found.hoop) | {"edge": np.array(found.edges)}
        curves.append(Curve({"load point": load_point(state)}, columns))
    return curves


def depth_curves(
    states: Sequence[State], body: points.Body = "plate", angle: float | None = None, depth: float | None = None
) -> list[Curve]:
    """Radial, hoop, shear and von Mises stress below a place of the edge: a curve for each state.

    Parameters
    ----------
    states : sequence of State
    body : {"plate", "pin", "seat"}
    angle : float, optional
        Degrees from the bottom; the place of the state's largest hoop stress unless given.
    depth : float, optional
        Largest depth, in units of the hole's radius; above 0, in the pin below 1. Unless given, it is 0.5 in the pin
        and 1 elsewhere, but no more than the wall, or than is known of a compliance.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    points.material_of(states[0].problem, body)
    usual = min(0.5 if body == "pin" else 1.0, points.known_depth(states[0].problem, body))
    deepest = usual if depth is None else checks.number("depth", depth)
    _check_depth(deepest, states[0].problem, body)
    unit = units(states[0].problem)
    radius, curves = states[0].problem.hole_radius, []
    below = deepest * radius * np.linspace(0.0, 1.0, DEPTHS) ** 3
    for state in states:
        given = None if angle is None else math.radians(checks.number("angle", angle) - 90.0)
        place = state.peak_hoop_stress(body).angle if given is None else given
        found = state.stress(points.Points.at_depth(below, place), body)
        columns = unit["length"].column("depth", below)
        for name in ("radial", "hoop", "shear", "von_mises"):
            columns |= unit["traction"].column(COMPONENTS[name], component_of(found, name))
        parameters = {"body": body, "load point": load_point(state), "angle [deg]": angles.from_bottom(place)}
        curves.append(Curve(parameters, columns))
    return curves


def _check_depth(depth: float, problem: Problem, body: points.Body) -> None:
    """Check the depth of a profile, in hole radii."""
    far, wall = points.far_rim(problem, body), points.known_depth(problem, body)
    # A force may act at the centre of a pin.
    inside = depth < wall if far == 0.0 else depth <= wall * (1.0 + points.ROUNDING)
    if depth > 0.0 and inside:
        return
    if math.isinf(wall):
        raise InputError("depth", f"must be above 0, not {depth:g}")
    if far is None:
        why = problem.plate_body.lug.near_only or "the nearest other edge"
        words = f"at most {wall:.3g} radii: {why}"
        raise InputError("depth", f"must be above 0 and {words}; not {depth:g}")
    if far == 0.0:
        raise InputError("depth", f"must be above 0 and below 1 radius, the centre of the pin, not {depth:g}")
    raise InputError("depth", f"must be above 0 and at most {wall:g} radii, the wall of the {body}, not {depth:g}")


def _farthest(lines: Sequence[np.ndarray], theta: np.ndarray) -> np.ndarray:
    """Distances from 0 at which rays in the directions `theta` leave all lines, complex; a little less, at least 1."""
    found = np.ones(theta.size)
    for line in lines:
        a, b = (part * np.exp(-1j * theta)[:, None] for part in (line[:-1], line[1:]))
        crossed = (a.imag * b.imag <= 0.0) & (a.imag != b.imag)
        share = np.divide(a.imag, a.imag - b.imag, out=np.zeros(a.shape), where=crossed)
        distance = np.where(crossed, a.real + share * (b.real - a.real), 1.0)
        found = np.maximum(found, 0.999 * distance.max(axis=1, initial=1.0))
    return found


def field_curves(
    state: State, component: str = "von_mises", body: str = "both", extent: float = 2.0, fineness: int = 240
) -> list[Curve]:
    """A component of the stress in pin and plate on a polar grid: a curve for each body.

    Columns: radius, angle in degrees from the bottom, and the component, from the inner circle outwards; each circle
    has 2 * `fineness` + 1 points.

    Parameters
    ----------
    state : State
    component : str
        A name of :data:`FIELDS`. The utilization is that of a laminate; the map then shows the plate alone.
    body : {"plate", "pin", "both"}
        The plate holds its bush.
    extent : float
        Outer radius of the plate's part, in units of the hole's radius; above 1, at most 100. A ring ends at its rim.
        Beyond an outline the component is NaN.
    fineness : int
        Number of circles in each body.

    Raises
    ------
    InputError
        If an argument is out of range, or there is no such component.
    """
    checks.choice("component", component, tuple(FIELDS))
    outer = checks.number("extent", extent)
    if not 1.0 < outer <= 100.0:
        raise InputError("extent", f"must be above 1 and at most 100 radii, not {outer:g}")
    unit, radius, curves = units(state.problem), state.problem.hole_radius, []
    checks.choice("body", body, ("plate", "pin", "both"))
    drawn = tuple(each for each in bodies_of(state, body) if each != "seat")  # the plate has it
    if component == UTILIZATION:
        drawn = ("plate",)
    lug, bush = state.problem.plate_body.lug, state.problem.joint.seat_ratio
    lines = [] if lug.geometry is None else lug.geometry.edge_lines
    if lines:  # a point takes longer there
        fineness //= 2
    theta = -1.5 * math.pi + 2.0 * math.pi * np.arange(2 * fineness + 1) / (2 * fineness)
    deepest = np.minimum(outer, bush * _farthest(lines, theta)) - 1.0
    if not lines:
        deepest = np.minimum(outer - 1.0, points.known_depth(state.problem, "plate"))
    for each in drawn:
        part, far = np.linspace(0.0, 1.0, fineness)[:, None], points.far_rim(state.problem, each)
        in_pin = radius * (1.0 - (far or 0.001)) * (1.0 - part) ** 2  # at a solid pin's centre the force may act
        below = radius * deepest * part**2 if each == "plate" else in_pin
        distance = radius + below if each == "plate" else radius - below
        places = np.broadcast_arrays(distance, np.degrees(theta) + 90.0)
        inside = np.ones(places[0].size, dtype=bool)
        if each == "plate":
            inside = lug.contains((distance / (radius * bush) * np.exp(1j * theta)).ravel())
        there = points.Points.at_depth(
            *(np.broadcast_to(part, places[0].shape).ravel()[inside] for part in (below, theta))
        )
        values, found = np.full(inside.size, math.nan), state.stress(there, each)
        if component == UTILIZATION:
            values[inside] = 1.0 / first_ply_failure(laminate_of(state.problem), found.in_plane).ratio
            column = {FIELDS[component]: values}
        else:
            values[inside] = component_of(found, component)
            column = unit["traction"].column(FIELDS[component], values)
        columns = unit["length"].column("radius", places[0].ravel()) | {"angle [deg]": places[1].ravel()} | column
        curves.append(Curve({"body": each, "load point": load_point(state)}, columns))
    return curves

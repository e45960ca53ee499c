"""The largest von Mises stress of each body in a state.

The stress is looked at on circles: the edges of the body, and circles below the edge that the contact or the bush
loads. Under a contact the largest stress lies below the edge. A plate of any outline has further edges.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fastpin.model.angles import from_bottom
from fastpin.model.grid import Grid
from fastpin.model.points import Body, Points, edge_words, elastic_bodies, known_depth, material_of, near_rim
from fastpin.model.problem import Problem
from fastpin.model.ties import top_angle
from fastpin.model.units import units
from fastpin.reading.stress import Stress

if TYPE_CHECKING:  # this module imports compiled code
    from fastpin.states.state import State

OWNERS = ("pin", "plate", "bush")
"""Bodies with a yield strength."""

PREFIX = "von_mises_"
"""Beginning of the names of the largest von Mises stresses among the extremes; an owner follows."""


class Circle(NamedTuple):
    """A circle on which the von Mises stress of a body is looked at.

    Attributes
    ----------
    owner : str
        One of :data:`OWNERS`.
    body : {"plate", "pin", "seat"}
        The body of its points.
    depth : float
        Depth of its points in the body, in units of the hole's radius; NaN on a further edge of a plate.
    edge : str
        A key of :data:`fastpin.model.doubts.EDGES`: the edge, or the one above the circle. A further edge has its name.
    """

    owner: str
    body: Body
    depth: float
    edge: str

    @property
    def is_further(self) -> bool:
        """Whether it is an edge of an outline, and no circle round the hole."""
        return math.isnan(self.depth)

    @property
    def is_edge(self) -> bool:
        """Whether the circle is an edge."""
        return self.depth == 0.0 or self.is_further or self.edge in ("rim of the bush", "bore of the pin")


def circles(problem: Problem) -> Iterator[Circle]:
    """The circles of a problem. A rigid body has none."""
    if problem.plate_body.bush is not None:
        wall = near_rim(problem, "seat") - 1.0
        if not problem.surfaces.plate.is_rigid:
            yield from (Circle("bush", "plate", depth, "bore of the bush") for depth in _depths(wall))
            yield Circle("bush", "plate", wall, "rim of the bush")
        if not problem.pair.plate.is_rigid:
            yield from (Circle("plate", "seat", depth, "seat") for depth in _depths(known_depth(problem, "seat")))
    elif not problem.surfaces.plate.is_rigid:
        yield from (Circle("plate", "plate", depth, "hole") for depth in _depths(known_depth(problem, "plate")))
    if "pin" in elastic_bodies(problem):
        wall = known_depth(problem, "pin")
        yield from (Circle("pin", "pin", depth, "pin") for depth in _depths(wall))
        if problem.pin_body.bore_radius:
            yield Circle("pin", "pin", wall, "bore of the pin")


def _depths(wall: float) -> tuple[float, ...]:
    """Depths of the circles below an edge in a wall, in units of the hole's radius."""
    return 0.0, *(depth for k in range(6) if (depth := 0.01 * 2.0**k) < 0.9 * wall)


def further_points(problem: Problem) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Points on the further edges of a plate: angles, rad, depths in units of the hole's radius, and names of edges."""
    (z, names), hole = problem.plate_body.lug.rims, problem.joint.seat_ratio
    return np.angle(z), hole * (np.abs(z) - 1.0), names


class Places(NamedTuple):
    """The points of a body at which its von Mises stress is looked at.

    Attributes
    ----------
    body : {"plate", "pin", "seat"}
        The body of the points.
    theta, depth : ndarray, shape (m,)
        Angles, rad, and depths in units of the hole's radius.
    circle : list of Circle
        The circle of each point.
    """

    body: Body
    theta: np.ndarray
    depth: np.ndarray
    circle: list[Circle]

    @classmethod
    def of(cls, problem: Problem, grid: Grid, owner: str, edges_only: bool = False) -> Places:
        """The points of an owner of :data:`OWNERS`: of all circles, or of edges only. A contact has the nodes, too."""
        around = math.pi * (2.0 * np.arange(180) / 180 - 1.0)
        if edges_only:  # away from the contact the stress changes slowly
            around = around[::4]
        nodes = grid.theta[:: -(-grid.size // 400)]  # at most 400, evenly chosen
        theta, depth, circle = [], [], []
        for one in circles(problem):
            if one.owner == owner and (one.is_edge or not edges_only):
                touches = one.depth == 0.0 and one.body != "seat"
                there = np.r_[around, nodes] if touches else around
                theta.append(there)
                depth.append(np.full(there.size, one.depth))
                circle += [one] * there.size
        if owner == "plate":
            angles, below, names = further_points(problem)
            theta.append(angles)
            depth.append(below)
            circle += [Circle(owner, circle[0].body, math.nan, name) for name in names]
        return cls(circle[0].body, np.concatenate(theta), np.concatenate(depth), circle)

    def von_mises(self, problem: Problem, stress: np.ndarray) -> np.ndarray:
        """Equivalent stresses of von Mises, shape (...,), from (srr, stt, srt), shape (3, ...)."""
        radial, hoop, shear = stress
        strain = problem.surfaces.plane == "strain"
        axial = (material_of(problem, self.body).nu if strain else 0.0) * (radial + hoop)
        return Stress(self.theta, radial, hoop, shear, axial).von_mises


class MisesPeak(NamedTuple):
    """The largest von Mises stress of a body in a state.

    Attributes
    ----------
    value : float
        Pa.
    angle : float
        Its place, rad.
    depth : float
        Depth of the place, in units of the hole's radius.
    circle : Circle
    """

    value: float
    angle: float
    depth: float
    circle: Circle


def von_mises_peak(state: State, owner: str, edges_only: bool = False) -> MisesPeak:
    """The largest von Mises stress of an elastic body of :data:`OWNERS`, with straight lines between the nodes.

    With `edges_only` it is the largest on the edges of the body.
    """
    places = Places.of(state.problem, state.grid, owner, edges_only)
    points = Points.at_depth(places.depth * state.problem.hole_radius, places.theta)
    found = state.stress(points, places.body, straight=True).von_mises
    top = top_angle(found, places.theta)
    return MisesPeak(float(found[top]), float(places.theta[top]), float(places.depth[top]), places.circle[top])


def yielding_owners(problem: Problem) -> dict[str, float]:
    """The elastic bodies of :data:`OWNERS` whose yield strength is known, with the strength, Pa.

    Stresses without dimensions have none.
    """
    found = {}
    for body in () if problem.dimensionless else elastic_bodies(problem):
        owner = problem.joint.owners[body]
        strength = problem.joint.materials[owner].known_yield_strength
        if strength is not None:
            found[owner] = strength
    return found


def place_words(problem: Problem, peak: MisesPeak) -> str:
    """Words for the place of a peak: its depth below the edge if it has one, and its angle; or where on an outline."""
    if peak.circle.is_further:
        away = problem.hole_radius * (near_rim(problem, peak.circle.body) + peak.depth)
        return edge_words(problem, peak.circle.edge, cmath.rect(away, peak.angle))
    depth = units(problem)["length"].text(peak.circle.depth * problem.hole_radius, 3)
    return f"{'' if peak.circle.is_edge else f'{depth} below the edge, '}at {from_bottom(peak.angle):z.1f} deg"

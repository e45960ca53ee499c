"""Points of pin and plate at which stresses are asked for."""

from __future__ import annotations

import cmath
import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fastpin.errors import InputError, InputWarning
from fastpin.model.angles import from_bottom
from fastpin.model.checks import as_toml, choice, in_one_shape, instance, numbers, set_fields
from fastpin.model.materials import Material
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Body = Literal["plate", "pin", "seat"]

ROUNDING = 1e-14
"""Distance from the edge that is rounding, in units of the hole's radius."""

MOST_ANGLE = 1e6
"""Largest size of an angle, rad. Beyond, a turn has too few digits."""

BODIES = ("plate", "pin", "seat")
"""Bodies with an edge: the plate with its hole, the pin, and the plate round a bush, whose edge is the bush's seat.

The edge of "plate" is that of the hole. With a bush it is the bore of the bush, and the plate's own edge is "seat".
"""

EDGES: tuple[Body, ...] = ("plate", "seat")
"""The edges of holes: of the pin's hole, and of the plate's own hole round a bush."""


@dataclass(frozen=True, eq=False)
class Points(ReadOnly):
    """Points by angle and radius, or by angle and depth below the edge of the hole. Both may be arrays of any shape.

    ``Points.at_radius``, ``Points.at_depth`` and ``Points.at_xy`` make them. Arrays are broadcast: a column of depths
    and a row of angles give a grid.

    Attributes
    ----------
    theta : ndarray
        Angles, rad, counter-clockwise from the +x axis; the bottom of the hole is -pi/2.
    radius : ndarray or None
        Distances from the centre, m; None for points by depth.
    depth : ndarray or None
        Distances from the body's edge, m, into the body; None for points by radius. No digit is lost close to the
        edge. The edge of the body "seat" is the seat of a bush.

    Raises
    ------
    InputError
        If an array holds no finite numbers, its shape is another one, or both or none of radius and depth are given.
    """

    theta: np.ndarray
    radius: np.ndarray | None
    depth: np.ndarray | None

    def __post_init__(self) -> None:
        if (self.radius is None) == (self.depth is None):
            raise InputError("radius", "or depth must be given, and not both")
        name, given = ("depth", self.depth) if self.radius is None else ("radius", self.radius)
        assert given is not None
        turned = numbers("theta", self.theta, -MOST_ANGLE, MOST_ANGLE)
        values, angles = in_one_shape(name, numbers(name, given, 0.0), turned)
        largest = float(np.abs(angles).max(initial=0.0))
        if largest > 4.0 * math.pi:  # more than two turns are probably in degrees
            words = f"{largest:g} rad is {math.degrees(largest):,.4g} degrees; angles are in rad"
            warnings.warn(InputWarning("theta", words), stacklevel=4)
        for field, array in ((name, values), ("theta", angles)):
            array.setflags(write=False)
            set_fields(self, **{field: array})

    @classmethod
    def at_radius(cls, radius: ArrayLike, theta: ArrayLike) -> Points:
        """Points at distances `radius` from the centre, m, at the angles `theta`, rad."""
        return cls(theta, radius, None)  # type: ignore[arg-type]

    @classmethod
    def at_depth(cls, depth: ArrayLike, theta: ArrayLike) -> Points:
        """Points at distances `depth` below the edge, m, at the angles `theta`, rad."""
        return cls(theta, None, depth)  # type: ignore[arg-type]

    @classmethod
    def at_xy(cls, x: ArrayLike, y: ArrayLike) -> Points:
        """Points at the coordinates `x` and `y` from the centre of the hole, m."""
        along, up = in_one_shape("x", numbers("x", x), numbers("y", y))
        return cls(np.arctan2(up, along), np.hypot(along, up), None)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the arrays."""
        return self.theta.shape

    def depths(self, problem: Problem, body: Body) -> np.ndarray:
        """Depths below the body's edge in units of the hole's radius, shape of the points.

        Raises
        ------
        InputError
            If a point lies outside the body, or in a plate that a compliance describes, too far from its hole.
        """
        instance("problem", problem, Problem, "a Problem")
        material_of(problem, body)
        radius, near, far = problem.hole_radius, near_rim(problem, body), far_rim(problem, body)
        wall = abs(far - near) if far is not None else math.inf
        if self.depth is not None:
            depth = self.depth / radius
            if np.any(depth > wall + ROUNDING * max(1.0, wall)):
                name = "radius" if far == 0.0 else "wall"
                raise InputError("depth", f"must be at most the {name} of {wall * radius:g} in the {body}")
        else:
            assert self.radius is not None
            depth = (self.radius - near * radius) / radius * (-1.0 if body == "pin" else 1.0)
            depth = np.where(np.abs(depth) < ROUNDING * near, 0.0, depth)
            if np.any(depth < 0.0):
                side, edge = "at most" if body == "pin" else "at least", "seat" if body == "seat" else "hole"
                raise InputError("radius", f"must be {side} the {edge}'s radius of {near * radius:g} in the {body}")
            if far is not None and np.any(depth > wall + ROUNDING * max(1.0, wall)):
                rim = "at least the bore" if body == "pin" else "at most the outer"
                raise InputError("radius", f"must be {rim} radius of {far * radius:g} in the {body}")
        if body != "pin":
            _check_inside(problem, ((near + depth) * np.exp(1j * self.theta)).ravel())
        return np.minimum(depth, wall)


def _check_inside(problem: Problem, z: np.ndarray) -> None:
    """Check that the stress of the plate is known at points, complex, in hole radii."""
    lug, hole, length = problem.plate_body.lug, problem.joint.seat_ratio, units(problem)["length"]
    outside = z[~lug.contains(z / hole)]
    if outside.size and lug.near_only:
        known = length.text(lug.reach * hole * problem.hole_radius)
        raise InputError("points", f"{lug.near_only}; here up to the radius {known}")
    if outside.size:
        x, y = (length.text(value * problem.hole_radius) for value in (outside[0].real, outside[0].imag))
        raise InputError("points", f"must lie in the plate, and x = {x}, y = {y} does not")


def is_beyond_bush(problem: Problem, depth: np.ndarray) -> np.ndarray:
    """Whether points of the plate at these depths, in units of the hole's radius, lie beyond the bush.

    False without a bush. The rim of the bush belongs to it, also where rounding makes its depth larger.
    """
    if problem.plate_body.bush is None:
        return np.zeros(depth.shape, dtype=bool)
    return 1.0 + depth > problem.joint.seat_ratio * (1.0 + ROUNDING)


def bodies_of(problem: Problem) -> tuple[Body, ...]:
    """The bodies of :data:`BODIES` that a problem has, from the hole outwards, then the pin."""
    return tuple(problem.joint.owners)  # type: ignore[arg-type]


def material_of(problem: Problem, body: Body) -> Material:
    """The material of a body at its edge: of "plate" the bush if there is one, of "seat" the plate round it.

    Raises
    ------
    InputError
        If there is no such body.
    """
    if choice("body", body, BODIES) == "pin" and problem.pin_body.is_bush:
        raise InputError(
            "body", "the pin of a seat is its bush: its stress is that of the joint, whose pin loads it, too"
        )
    if body not in problem.joint.owners:
        raise InputError("body", '"seat" is the edge of the plate round a bush; this plate has no bush')
    return problem.joint.materials[problem.joint.owners[body]]


def owner_of(problem: Problem, body: str) -> str:
    """The word for the body that the material of :func:`material_of` belongs to: "pin", "plate" or "bush"."""
    return "bush" if body == "pin" and problem.pin_body.is_bush else problem.joint.owners.get(body, body)


def edge_body(problem: Problem, body: str) -> str:
    """Return words for the body whose edge "plate", "seat" or "pin" names: the hole may be in a bush."""
    return "plate at the seat" if body == "seat" else owner_of(problem, body)


def elastic_bodies(problem: Problem) -> tuple[Body, ...]:
    """The bodies of a problem that have a stress: all that are not rigid."""
    materials, owners = problem.joint.materials, problem.joint.owners
    return tuple(body for body, owner in owners.items() if not materials[owner].is_rigid)  # type: ignore[misc]


CRITERION = "a criterion of fatigue"
"""Words for the criteria that have no meaning for a laminate."""


def isotropic_bodies(problem: Problem) -> tuple[Body, ...]:
    """The elastic bodies of a problem that are no laminates: criteria of metals have a meaning for them only."""
    return tuple(body for body in elastic_bodies(problem) if material_of(problem, body).is_isotropic)


def isotropic_material(field: str, problem: Problem, body: Body, subject: str) -> Material:
    """The material of a body, see :func:`material_of`.

    Raises
    ------
    InputError
        If there is no such body, or it is a laminate. The message says that the `subject` is one of isotropic bodies.
    """
    material = material_of(problem, body)
    if not material.is_isotropic:
        raise InputError(
            field, f"the {owner_of(problem, body)} is a laminate, and {subject} is that of isotropic bodies"
        )
    return material


def has_outline(problem: Problem) -> bool:
    """Whether the stress along further edges of the plate is known: it is elastic, and of any outline."""
    return problem.plate_body.lug.geometry is not None and not problem.pair.plate.is_rigid


def further_parts(problem: Problem, body: str, theta: ArrayLike, depth: ArrayLike) -> list[Any]:
    """The part of a further edge of a plate, :class:`fastpin.lugs.Part`, on which each point lies; None elsewhere.

    `theta` has the angles, rad, and `depth` the distances from the body's edge, m.
    """
    angles, below = (each.ravel() for each in np.broadcast_arrays(theta, depth))
    found: list[Any] = [None] * below.size
    beyond = np.flatnonzero(below)
    if beyond.size and owner_of(problem, body) == "plate" and has_outline(problem):
        away = near_rim(problem, body) * problem.hole_radius + below[beyond]  # type: ignore[arg-type]
        parts = problem.plate_body.lug.geometry.edges_at(away * np.exp(1j * angles[beyond]))
        for k, part in zip(beyond.tolist(), parts, strict=True):
            found[k] = part
    return found


def edge_words(problem: Problem, edge: str, place: complex) -> str:
    """Words for a place x + iy, m, on a further edge of a plate."""
    rounding = 1e-12 * abs(place)
    x, y = (
        units(problem)["length"].text(0.0 if abs(part) < rounding else part, 3) for part in (place.real, place.imag)
    )
    kind = " (a polyline)" if edge in problem.plate_body.lug.geometry.polylines else ""
    return f"on the edge {as_toml(edge)}{kind}, at x = {x}, y = {y}"


def point_words(problem: Problem, body: str, theta: float, depth: float, digits: int = 1) -> str:
    """Words for a point of a body: its angle and depth below the edge of the hole; or its further edge and place.

    `theta` and `depth` are those of :func:`further_parts`.
    """
    if (part := further_parts(problem, body, theta, depth)[0]) is not None:
        away = near_rim(problem, body) * problem.hole_radius + depth  # type: ignore[arg-type]
        return edge_words(problem, part.name, cmath.rect(away, theta))
    below = "" if depth == 0.0 else f", {units(problem)['length'].text(depth, 3)} below the edge"
    return f"at {from_bottom(theta):z.{digits}f} deg{below}"


def near_rim(problem: Problem, body: Body) -> float:
    """Radius of a body's edge over the hole's radius: above 1 at the seat of a bush."""
    return problem.joint.seat_ratio if body == "seat" else 1.0


def far_rim(problem: Problem, body: Body) -> float | None:
    """Radius of a body's other rim over the hole's radius; 0 for a solid pin, None for a plate without a rim."""
    if body == "pin":
        return problem.pin_body.bore_radius / problem.hole_radius
    outer = problem.plate_body.lug.outer_radius
    return outer / problem.hole_radius if math.isfinite(outer) else None


def known_depth(problem: Problem, body: Body) -> float:
    """Depth of a body below its edge, over the hole's radius, as far as its stress is known; infinite without a rim."""
    near, far = near_rim(problem, body), far_rim(problem, body)
    known = math.inf if body == "pin" else problem.plate_body.lug.reach * problem.joint.seat_ratio - near
    return known if far is None else min(known, abs(far - near))

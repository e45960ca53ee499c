"""How a crack is to be followed: its law, lengths, place, direction, body, and the residual stress on its line."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import DEGREE, angle_at, degrees_at, degrees_of
from fastpin.model.checks import as_toml, check_fields, choice, given_fields, is_above, items, number, numbers, positive
from fastpin.model.growth import KnownLaw, known_law, law_entries, law_from
from fastpin.model.points import EDGES, MOST_ANGLE, far_rim, isotropic_material, material_of, near_rim, owner_of
from fastpin.model.problem import Problem
from fastpin.model.units import units

MOST_INCLINATION = 60.0 * DEGREE
"""Largest inclination of a crack, rad. There 80 points still give 1e-4."""


@dataclass(frozen=True)
class CrackGrowth:
    """A crack at the edge of the hole, and how it grows.

    Parameters
    ----------
    first, last : float
        First and last length, m.
    law : Walker or Nasgro, optional
        Law of growth. Unless given, it is the law of the body's material.
    theta : float, optional
        Angle of its mouth, rad, counter-clockwise from the +x axis; where a crack grows fastest unless given.
    angle : float
        Its direction from the radius, rad, counter-clockwise, at most 60 deg.
    body : {"plate", "seat"}
        See :class:`fastpin.cracks.Crack`.
    residual_stress : float or sequence of (float, float), optional
        Normal stress on the line of the crack that is added at all times, Pa: a number, or pairs of a distance to the
        mouth, m, and the stress there. Between them it is a straight line; beyond the last one it stays.

    Raises
    ------
    InputError
        If a field can't be used.
    """

    first: float
    last: float
    law: KnownLaw | None = None
    theta: float | None = None
    angle: float = 0.0
    body: str = "plate"
    residual_stress: float | Sequence[Sequence[float]] | None = None

    def __post_init__(self) -> None:
        check_fields(self, positive, "first last")
        if self.last <= self.first:
            raise InputError("last", f"must be longer than the first length of {self.first:g} m, not {self.last:g}")
        if self.law is not None:
            known_law("law", self.law)
        check_fields(self, number, "theta", -MOST_ANGLE, MOST_ANGLE, optional=True)
        check_fields(self, number, "angle", -MOST_INCLINATION, MOST_INCLINATION)
        check_fields(self, choice, "body", EDGES)
        check_fields(self, checked_residual, "residual_stress", optional=True)

    def residual(self, s: np.ndarray) -> np.ndarray:
        """The residual stress at distances to the mouth, m, of any shape; 0 unless one is given, Pa."""
        return residual_at(self.residual_stress, numbers("s", s))

    def entries(self) -> dict[str, Any]:
        """The keys and values of the section [crack] of a case file. Angles are in degrees, theta from the bottom."""
        found = given_fields(self)
        if isinstance(self.residual_stress, tuple):
            found["residual_stress"] = [list(pair) for pair in self.residual_stress]
        if self.law is not None:
            found["law"] = law_entries(self.law)
        if self.theta is not None:
            found["theta"] = degrees_at(self.theta)
        del found["angle"], found["body"]
        usual = {"angle": degrees_of(self.angle)} if self.angle else {}
        return found | usual | ({} if self.body == "plate" else {"body": self.body})


MOST_OF_WALL = 0.9
"""Largest depth of a tip in parts of the wall. The ligament beyond is not elastic for long."""

MOST_OF_LIGAMENT = 0.95
"""Largest length of a crack in a plate of any outline, in parts of its line to the edge where it leaves the plate."""


def edge_of(body: str) -> Literal["plate", "seat"]:
    """The name of an edge as a type checker knows it."""
    return "seat" if body == "seat" else "plate"


def wall_of(problem: Problem, body: str) -> float:
    """Depth of a body behind its edge, in radii of the edge; infinite without a rim."""
    bush = problem.joint.bush
    if body == "plate" and bush is not None:
        return bush - 1.0
    far = far_rim(problem, edge_of(body))
    return math.inf if far is None else far / near_rim(problem, edge_of(body)) - 1.0


def depth_of(angle: float, length: float) -> float:
    """Depth of the tip of a crack, in radii of its edge. The length is in these radii, too."""
    return abs(1.0 + length * complex(math.cos(angle), math.sin(angle))) - 1.0


def other_edges(problem: Problem, body: str) -> Any:
    """The edges beyond the hole of a plate of any outline, :class:`fastpin.lugs.OtherEdges`; None for another body."""
    in_bush = body == "plate" and problem.joint.bush is not None
    return None if in_bush else problem.plate_body.lug.other_edges


def check_length(
    field: str,
    problem: Problem,
    body: str,
    angle: float,
    longest: float,
    theta: float | None = None,
    part: float = MOST_OF_LIGAMENT,
) -> None:
    """Raise :class:`InputError` if a length, m, is too large for the body.

    In a plate of any outline a crack at `theta` may take a `part` of its ligament.
    """
    length = units(problem)["length"]
    radius = problem.hole_radius * near_rim(problem, edge_of(body))
    wall, edges = wall_of(problem, body), other_edges(problem, body)
    if is_above(longest, 1e4 * radius):  # up to there it was checked against the crack in a plate without a hole
        raise InputError(field, f"must be at most 10000 radii of the hole, not {length.text(longest)}")
    if is_above(depth_of(angle, longest / radius), MOST_OF_WALL * wall):
        words = f"must end within {MOST_OF_WALL:g} of the wall of {length.text(wall * radius)}"
        raise InputError(field, f"{words}, not be {length.text(longest)}")
    if edges is None or theta is None:
        return
    ligament = edges.ligament(theta, angle) * radius
    if is_above(longest, part * ligament):
        end = radius * cmath.exp(1j * theta) + ligament * cmath.exp(1j * (theta + angle))
        within = "its ligament" if part == 1.0 else f"{part:g} of its ligament"
        words = f"must end within {within} of {length.text(ligament)}, not be {length.text(longest)}"
        place = f"x = {length.text(end.real)}, y = {length.text(end.imag)}"
        raise InputError(field, f"{words}: the line of the crack leaves the plate at {place}")


def check_crack(problem: Problem, crack: CrackGrowth) -> None:
    """Raise :class:`InputError` if no crack can grow so in a joint: its body, its length or its law."""
    body = edge_of(crack.body)
    if material_of(problem, body).is_rigid:
        raise InputError("body", f"the {owner_of(problem, body)} is rigid: no crack grows in it")
    isotropic_material("body", problem, body, "a stress intensity")
    check_inside(problem, body)
    check_length("last", problem, body, crack.angle, crack.last, crack.theta, 1.0)
    law_of(problem, crack)


def check_inside(problem: Problem, body: str) -> None:
    """Raise :class:`InputError` if the stress of the body is known near its hole only."""
    if not problem.plate_body.lug.has_inside and (body == "seat" or problem.joint.bush is None):
        words = "a compliance gives the stress near its hole only, and a crack needs all of it"
        raise InputError("body", f"{words}: a file with the outline gives it everywhere")


def law_of(problem: Problem, crack: CrackGrowth) -> KnownLaw:
    """The law of a crack: its own, or else that of its body's material.

    Raises
    ------
    InputError
        If there is none.
    """
    body = edge_of(crack.body)
    law = crack.law or material_of(problem, body).growth
    if law is None:
        words = f"the material of the {owner_of(problem, body)} has no constants of crack growth"
        raise InputError("law", f"is missing: {words}, and none are given")
    return law


CRACK_KEYS = tuple(each.name for each in fields(CrackGrowth))
"""The fields of :class:`CrackGrowth`, the keys of [crack] in a case file."""


def crack_from(**given: Any) -> CrackGrowth:
    """Return the crack of such entries: angles are in degrees, theta from the bottom, and a law may be a table.

    Raises
    ------
    InputError
        See :class:`CrackGrowth`.
    """
    if isinstance(given.get("law"), dict):
        given["law"] = law_from(given["law"])
    if given.get("theta") is not None:
        given["theta"] = angle_at(number("theta", given["theta"], -1e4, 1e4))
    if given.get("angle") is not None:
        given["angle"] = number("angle", given["angle"], -60.0, 60.0) * DEGREE
    for name in ("first", "last"):
        if given.get(name) is None:
            raise InputError(name, "is missing: give the length of the crack, m")
    return CrackGrowth(**given)


def residual_at(stress: Any, s: np.ndarray) -> np.ndarray:
    """A residual stress, a number or pairs, at distances to the edge, m, of any shape; 0 for None, Pa."""
    if not isinstance(stress, tuple):
        return np.full(np.shape(s), stress or 0.0)
    return np.interp(s, *np.array(stress).T)


def checked_residual(name: str, given: object) -> float | tuple[tuple[float, float], ...]:
    """Check a residual stress, Pa, or pairs of a distance to the edge, m, and a residual stress."""
    if not isinstance(given, (list, tuple, np.ndarray)):
        return number(name, given)
    pairs = items(name, given, "a number, or pairs of a distance and a stress")
    if not 2 <= len(pairs) <= 1000:
        raise InputError(name, f"must be a number or 2 to 1,000 pairs, not {len(pairs)}")
    found = []
    for pair in pairs:
        if not isinstance(pair, (list, tuple, np.ndarray)) or len(pair) != 2:
            raise InputError(name, f"must be pairs of a distance, m, and a stress, Pa, not {as_toml(pair)}")
        found.append((number(name, pair[0], 0.0), number(name, pair[1])))
    if any(later[0] <= earlier[0] for earlier, later in itertools.pairwise(found)):
        raise InputError(name, "must have increasing distances to the mouth")
    return tuple(found)

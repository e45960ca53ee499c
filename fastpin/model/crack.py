"""How a crack is to be followed: its law, lengths, place, direction, body, and the residual stress on its line."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
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
    """A crack at the edge of the hole, or at another edge of a plate of any outline, and how it grows.

    Parameters
    ----------
    first, last : float
        First and last length, m.
    law : Walker or Nasgro, optional
        Law of growth. Unless given, it is the law of the body's material.
    theta : float, optional
        Angle of its mouth, rad, counter-clockwise from the +x axis. With neither it nor a place, the crack begins at
        the hole where it grows fastest.
    angle : float
        Its direction from the radius, rad, counter-clockwise, at most 60 deg.
    body : {"plate", "seat"}
    place : (float, float), optional
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
    place: Sequence[float] | None = None

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
        check_fields(self, checked_place, "place", optional=True)
        if self.theta is not None and self.place is not None:
            raise InputError("place", "stands in place of theta: leave one of them out")

    def residual(self, s: np.ndarray) -> np.ndarray:
        """The residual stress at distances to the mouth, m, of any shape; 0 unless one is given, Pa."""
        return residual_at(self.residual_stress, numbers("s", s))

    def entries(self) -> dict[str, Any]:
        """The keys and values of the section [crack] of a case file. Angles are in degrees, theta from the bottom."""
        found = given_fields(self)
        if isinstance(self.residual_stress, tuple):
            found["residual_stress"] = [list(pair) for pair in self.residual_stress]
        if self.place is not None:
            found["place"] = list(self.place)
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
    if body == "plate" and problem.plate_body.bush is not None:
        return problem.joint.seat_ratio - 1.0
    far = far_rim(problem, edge_of(body))
    return math.inf if far is None else far / near_rim(problem, edge_of(body)) - 1.0


def depth_of(angle: float, length: float) -> float:
    """Depth of the tip of a crack, in radii of its edge. The length is in these radii, too."""
    return abs(1.0 + length * complex(math.cos(angle), math.sin(angle))) - 1.0


def other_edges(problem: Problem, crack: Any) -> Any:
    """The edges of a plate of any outline beyond that of a crack, :class:`fastpin.lugs.OtherEdges`; else None.

    The crack is a :class:`fastpin.cracks.Crack` or a :class:`CrackGrowth`.

    Raises
    ------
    InputError
        If the place of the crack is no mouth, or the plate has no other edges.
    """
    in_bush = crack.body == "plate" and problem.plate_body.bush is not None
    edges = None if in_bush else problem.plate_body.lug.other_edges
    if crack.place is None:
        return edges
    if edges is None:
        words = 'is on the plate round the bush: body = "seat"' if in_bush else "needs a plate of any outline"
        raise InputError("place", words)
    radius = problem.hole_radius * near_rim(problem, edge_of(crack.body))
    return edges.at(complex(*crack.place) / radius, lambda value: units(problem)["length"].text(value * radius))


def mouth_words(problem: Problem, crack: Any, form: str = "z.2f") -> str:
    """The mouth of a crack that has one: its angle from the bottom in this form, or its edge and place."""
    if crack.place is None:
        assert crack.theta is not None
        return f"{degrees_at(crack.theta):{form}} deg"
    x, y = (units(problem)["length"].text(value, 4) for value in crack.place)
    return f"x = {x}, y = {y} on the edge {as_toml(edge_name(problem, crack))}"


def edge_name(problem: Problem, crack: Any) -> str | None:
    """The name of the edge at which a crack begins; None at the hole."""
    return None if crack.place is None else other_edges(problem, crack).mouth.edge


def check_length(field: str, problem: Problem, crack: Any, longest: float, part: float = MOST_OF_LIGAMENT) -> None:
    """Raise :class:`InputError` if a length, m, is too large for the body.

    In a plate of any outline a crack whose mouth is known may take a `part` of its ligament.
    """
    length, body = units(problem)["length"], crack.body
    radius = problem.hole_radius * near_rim(problem, edge_of(body))
    wall, edges = wall_of(problem, body), other_edges(problem, crack)
    if is_above(longest, 1e4 * radius):  # up to there it was checked against the crack in a plate without a hole
        raise InputError(field, f"must be at most 10000 radii of the hole, not {length.text(longest)}")
    if is_above(depth_of(crack.angle, longest / radius), MOST_OF_WALL * wall):
        words = f"must end within {MOST_OF_WALL:g} of the wall of {length.text(wall * radius)}"
        raise InputError(field, f"{words}, not be {length.text(longest)}")
    if edges is None or (crack.theta is None and crack.place is None):
        return
    line, size = edges.line(crack.theta, crack.angle), edges.radius * radius
    ligament, known = edges.ligament(*line) * size, edges.known(*line) * size
    if is_above(longest, part * ligament):
        start, along = edges.start(*line)
        end = radius * start + ligament * along
        within = "its ligament" if part == 1.0 else f"{part:g} of its ligament"
        words = f"must end within {within} of {length.text(ligament)}, not be {length.text(longest)}"
        place = f"x = {length.text(end.real)}, y = {length.text(end.imag)}"
        raise InputError(field, f"{words}: the line of the crack leaves the plate at {place}")
    if known < ligament and is_above(longest, MOST_OF_LIGAMENT * known):
        words = f"must be at most {length.text(MOST_OF_LIGAMENT * known)}, not {length.text(longest)}"
        raise InputError(
            field, f"{words}: a longer crack comes too near to another edge, or its mirror image to the plate"
        )


def check_crack(problem: Problem, crack: CrackGrowth) -> None:
    """Raise :class:`InputError` if no crack can grow so in a joint: its body, its length or its law."""
    body = edge_of(crack.body)
    if material_of(problem, body).is_rigid:
        raise InputError("body", f"the {owner_of(problem, body)} is rigid: no crack grows in it")
    isotropic_material("body", problem, body, "a stress intensity")
    check_inside(problem, body)
    check_length("last", problem, crack, crack.last, 1.0)
    law_of(problem, crack)


def check_inside(problem: Problem, body: str) -> None:
    """Raise :class:`InputError` if the stress of the body is known near its hole only."""
    why = problem.plate_body.lug.near_only
    if why and (body == "seat" or problem.plate_body.bush is None):
        raise InputError("body", f"{why}; a crack needs all of it")


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


def checked_place(name: str, given: object) -> tuple[float, float]:
    """Check a place (x, y), m."""
    if not isinstance(given, (list, tuple, np.ndarray)) or len(given) != 2:
        raise InputError(name, f"must be a pair of coordinates, x and y, not {as_toml(given)}")
    return number(name, given[0]), number(name, given[1])


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

"""How a crack is to be followed: its law, lengths, place, direction, body, and the residual stress on its line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import DEGREE, angle_at, degrees_at, degrees_of
from fastpin.model.checks import as_toml, choice, items, number, positive
from fastpin.model.growth import KnownLaw, known_law, law_entries, law_from
from fastpin.model.points import EDGES, MOST_ANGLE

MOST_INCLINATION = 60.0 * DEGREE
"""Largest inclination of a crack, rad. There 80 points still give 1e-4."""

MOST_PAIRS = 1000
"""Pairs of a residual stress, at most."""


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
        object.__setattr__(self, "first", positive("first", self.first))
        object.__setattr__(self, "last", positive("last", self.last))
        if self.last <= self.first:
            raise InputError("last", f"must be longer than the first length of {self.first:g} m, not {self.last:g}")
        if self.law is not None:
            known_law("law", self.law)
        if self.theta is not None:
            object.__setattr__(self, "theta", number("theta", self.theta, -MOST_ANGLE, MOST_ANGLE))
        object.__setattr__(self, "angle", number("angle", self.angle, -MOST_INCLINATION, MOST_INCLINATION))
        object.__setattr__(self, "body", choice("body", self.body, EDGES))
        if self.residual_stress is not None:
            object.__setattr__(self, "residual_stress", _residual(self.residual_stress))

    def residual(self, s: np.ndarray) -> np.ndarray:
        """The residual stress at distances to the mouth, m, of any shape; 0 unless one is given, Pa."""
        if self.residual_stress is None:
            return np.zeros(np.shape(s))
        if isinstance(self.residual_stress, float):
            return np.full(np.shape(s), self.residual_stress)
        depth, stress = np.array(self.residual_stress).T
        return np.interp(s, depth, stress)

    def entries(self) -> dict[str, Any]:
        """The keys and values of the section [crack] of a case file. Angles are in degrees, theta from the bottom."""
        found = {each.name: getattr(self, each.name) for each in fields(self)}
        found = {name: value for name, value in found.items() if value is not None}
        if isinstance(self.residual_stress, tuple):
            found["residual_stress"] = [list(pair) for pair in self.residual_stress]
        if self.law is not None:
            found["law"] = law_entries(self.law)
        if self.theta is not None:
            found["theta"] = degrees_at(self.theta)
        del found["angle"], found["body"]
        usual = {"angle": degrees_of(self.angle)} if self.angle else {}
        return found | usual | ({} if self.body == "plate" else {"body": self.body})


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


def _residual(given: object) -> float | tuple[tuple[float, float], ...]:
    name = "residual_stress"
    if not isinstance(given, (list, tuple, np.ndarray)):
        return number(name, given)
    pairs = items(name, given, "a number, or pairs of a distance and a stress")
    if not 2 <= len(pairs) <= MOST_PAIRS:
        raise InputError(name, f"must be a number or 2 to {MOST_PAIRS:,} pairs, not {len(pairs)}")
    found = []
    for pair in pairs:
        if not isinstance(pair, (list, tuple, np.ndarray)) or len(pair) != 2:
            raise InputError(name, f"must be pairs of a distance, m, and a stress, Pa, not {as_toml(pair)}")
        found.append((number(name, pair[0], 0.0), number(name, pair[1])))
    if any(later[0] <= earlier[0] for earlier, later in zip(found, found[1:], strict=False)):
        raise InputError(name, "must have increasing distances to the mouth")
    return tuple(found)

"""Mouths of cracks on the edges of a plate of any outline beyond its hole."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.lugs.outline import Lug, distances, turn_between
from fastpin.lugs.panels import LEAST_TURN, TOUCHING
from fastpin.model.checks import as_toml

FLAT = 1e7
"""Radius of the circle that stands for a straight edge, in parts of the plate's extent: K changes by 1e-7."""

OFF = 0.01
"""Largest distance of a given place from its edge, in parts of its distance from the hole: texts are rounded."""

FROM_ENDS = 1e-3
"""Least distance of a mouth from both ends of its part, hole radii."""


class Mouth(NamedTuple):
    """The place at which a crack begins, on a part of the outline or on a further hole. Lengths are in hole radii.

    Attributes
    ----------
    edge : str
        Name of the edge.
    place : complex
    normal : complex
        Unit vector from the centre of the circle that the edge follows to the place.
    radius : float
        Radius of this circle; a very large one of a straight edge.
    is_inside : bool
        Whether the plate lies inside the circle.
    """

    edge: str
    place: complex
    normal: complex
    radius: float
    is_inside: bool

    @property
    def turn(self) -> float:
        """Angle from the radius of the circle to the normal into the plate, rad."""
        return math.pi if self.is_inside else 0.0

    def follows(self, z: np.ndarray, extent: float) -> np.ndarray:
        """Whether points (m,) lie on the circle, in a plate of this extent."""
        away = z - self.place
        height = (np.conj(self.normal) * away).real + 0.5 * np.abs(away) ** 2 / self.radius
        return np.asarray(np.abs(height) < extent / FLAT)

    def mirrored(self, z: np.ndarray) -> np.ndarray:
        """The mirror images of points (m,) in the circle."""
        away = np.conj((z - self.place) / self.normal) / self.radius
        return np.asarray(self.place - self.radius * self.normal * away / (1.0 + away))

    @classmethod
    def at(cls, lug: Lug, place: complex, length: Callable[[float], str]) -> Mouth:
        """The mouth on the edge that is nearest to a place, in hole radii; `length` gives lengths as text.

        Raises
        ------
        InputError
            If the place lies on no edge or at a corner, or the edge is held.
        """
        parts = [part.scaled(1.0 / lug.hole_radius) for part in lug.edges]
        away = np.array([distances(part, np.array([place]))[0] for part in parts])
        part, nearest = parts[int(away.argmin())], float(away.min())
        if nearest > OFF * max(abs(place), 1.0):
            where = f"{as_toml(part.name)}, is {length(nearest)} away"
            raise InputError("place", f"must lie on an edge beyond the hole; the nearest one, {where}")
        if part.name in lug.supports:
            raise InputError("place", f"lies on {as_toml(part.name)}, which is held, and a crack begins at a free edge")
        least, share = min(FROM_ENDS / part.length, 0.5), part.share(place)
        low, high = least, 1.0 - least
        for other in parts:
            for one, following, is_near in ((other, part, share < least), (part, other, share > 1.0 - least)):
                if not is_near or abs(following.start - one.end) > TOUCHING:
                    continue
                if abs(turn_between(one, following)) > LEAST_TURN:
                    x, y = length(one.end.real), length(one.end.imag)
                    raise InputError("place", f"lies at the corner x = {x}, y = {y}: a crack begins beside it")
                middle = following.at(np.array([0.5]))
                if np.abs(one.nearest(middle)[0] - middle)[0] < TOUCHING:  # one line or circle goes on
                    low, high = 0.0, 1.0
        at = np.array([min(max(share, low), high)])
        inwards = 1j * complex(part.direction(at)[0])
        is_inside = part.circle is not None and part.circle[3] > 0.0
        radius = FLAT * lug.extent / lug.hole_radius if part.circle is None else part.circle[1]
        return cls(part.name, complex(part.at(at)[0]), -inwards if is_inside else inwards, radius, is_inside)

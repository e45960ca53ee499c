"""An infinite plate, perhaps with a reaction at a point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.body import WIDEST, InWords, PlateBody, Remote, Rim, Table
from fastpin.bodies.walls import UNIT_STRESS, Amplitudes, Displacements, Other, force_on
from fastpin.errors import InputError
from fastpin.model.checks import is_between, number, set_fields
from fastpin.model.loads import REMOTE, P, Q
from fastpin.model.synonyms import explains_keywords


@explains_keywords
@dataclass(frozen=True)
class Plate(PlateBody):
    """An infinite plate.

    Parameters
    ----------
    reaction : (float, float), optional
        Point (x, y), m from the centre of the hole, at which a force balances P and Q, such as a bolt in the shank. By
        default the forces are balanced far away.

    Raises
    ------
    InputError
        If the point is no pair of numbers.
    """

    kind = "plate"
    keys: ClassVar = {"reaction": "length"}
    title = "infinite plate"
    is_infinite = True
    outer_radius = math.inf

    reaction: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.reaction is None:
            return
        if not isinstance(self.reaction, (tuple, list)) or len(self.reaction) != 2:
            raise InputError("reaction", "must be a point [x, y]")
        x, y = (number("reaction", value) for value in self.reaction)
        set_fields(self, reaction=(x, y))

    @classmethod
    def read(cls, table: Table) -> Plate | None:
        return table.build(cls, {"reaction": table.value("reaction")}, {"reaction": None})

    def check(self, radius: float, dimensionless: bool = False, name: str = "hole radius") -> None:
        least, most = 1.05 * radius, WIDEST * radius
        if self.reaction is not None and not is_between(least, math.hypot(*self.reaction), most):
            limits = f"must be a point from {least:g} to {most:g} from the centre"
            raise InputError("reaction", f"{limits}, not {math.hypot(*self.reaction):g}")

    def without_gauge(self, radius: float) -> str:
        return "" if self.reaction is None else "a plate with a reaction at a point has no gauge circle: leave it out"

    @property
    def force_points(self) -> tuple[complex, ...]:
        return () if self.reaction is None else (complex(*self.reaction),)

    def displacements(self, rim: Rim) -> Displacements:
        if rim.laminate is not None:
            moved = zip(REMOTE, map(rim.laminate.hole_displacement, np.eye(len(REMOTE))), strict=True)
            return {place: np.array([oval, 0.0, mean, 0.0, 0.0]) for place, (mean, oval) in moved}
        size = 0.25 * (rim.kolosov + 1.0) * rim.compliance
        # (T16)
        found = {place: size * np.array([D, 0.0, 0.5 * A, 0.0, 0.0]) for place, (A, D) in UNIT_STRESS.items()}
        if self.reaction is not None:
            x, y = (value / rim.radius for value in self.reaction)
            for place, force in ((Q, 1.0 + 0.0j), (P, -1.0j)):  # the force Q - iP on the pin, per unit load
                found[place] = _point_force(complex(x, y), -force / rim.ratio, rim.kolosov, rim.compliance)
        return found

    def translation(self, rim: Rim, gauge: float | None) -> tuple[float, float]:
        return super().translation(rim, gauge) if rim.laminate is None else (0.0, 0.0)

    def over_gauge(self, moved: complex, rim: Rim, force: complex, gauge: float | None) -> complex:
        if rim.laminate is None or gauge is None:
            return moved
        along = rim.laminate.gauge_tensor @ np.array([force.real, force.imag])
        return moved + math.log(gauge) / (2.0 * math.pi) * complex(*along)

    def add_fields(self, rim: Rim, t: np.ndarray, remote: Remote, amplitudes: Amplitudes) -> tuple[Other, ...]:
        if self.reaction is None:
            return ()
        x, y = (value / rim.radius for value in self.reaction)
        return (partial(_reaction, complex(x, y), -force_on(t), rim.kolosov),)

    def words(self, length: InWords) -> str:
        if self.reaction is None:
            return "infinite plate"
        x, y = (length(value) for value in self.reaction)
        return f"infinite plate, forces balanced at x = {x}, y = {y}"

    def rows(self, length: InWords, material: InWords) -> list[tuple[str, str]]:
        return [] if self.reaction is None else [("plate body", self.words(length))]

    def caption(self, length: InWords, material: InWords) -> str:
        if self.reaction is None:
            return ""
        return f", forces balanced at ({length(self.reaction[0])}, {length(self.reaction[1])})"

    def changed(self, values: Mapping[str, Any]) -> Self:
        if values:
            raise InputError(min(values), "an infinite plate has no outer radius, support or interference")
        return self


def _point_force(place: complex, force: complex, kolosov: float, compliance: float) -> np.ndarray:
    """Displacements of the free hole, radius 1, in the infinite plate under a force at the point `place`, (T40)."""
    highest = harmonics.harmonics_needed(math.sqrt(1.0 / abs(place)))
    count = 4 * highest + 2
    z = np.exp(2j * math.pi * np.arange(count) / count)
    e, conj_place = 0.5 / (math.pi * (kolosov + 1.0)), np.conj(place)
    s = 1.0 / z
    slope = -np.conj(force) * e / (s - conj_place)
    rest = kolosov * force * e * np.log(1.0 - s / conj_place) + np.conj(force) * e * place / (s - conj_place)
    moved = -force * e * np.log(1.0 - z / place) - z * slope - rest + np.conj(force) * e / conj_place * z
    spectrum = np.fft.fft(0.5 * compliance * (kolosov + 1.0) * moved / z) / count
    found = np.r_[spectrum[-highest:], spectrum[: highest + 1]]
    found[highest - 1] = 0.0  # a translation
    return found


def _reaction(place: complex, force: complex, kolosov: float, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """s_rr + s_tt and D at the points z, under a force at a point of the infinite plate with a free hole, (T47).

    The radius of the hole is 1.
    """
    share = force / (2.0 * math.pi * (kolosov + 1.0))
    other, conj_place, s = np.conj(share), np.conj(place), 1.0 / z
    away, image = z - place, s - conj_place
    slope, slope_2 = -share / away, share / away**2  # of the force alone: Omega', Omega''
    omega_1 = kolosov * other / away - share * conj_place / away**2
    mirrored, mirrored_1, mirrored_2 = -other / image, other / image**2, -2.0 * other / image**3
    at_centre = other / conj_place  # mirrored at s = 0
    rest = kolosov * share / image - other * place / image**2
    rest_1 = -kolosov * share / image**2 + 2.0 * other * place / image**3
    free = at_centre - mirrored + s * mirrored_1 + s * s * rest  # Omega' of the hole
    free_2 = -(s**3) * (mirrored_2 + 2.0 * rest + s * rest_1)
    free_omega = s * s * (mirrored + np.conj(at_centre) + free) - s * free_2
    both = 2.0 * np.real(slope + free)
    turn = z * z / np.abs(z) ** 2
    return 2.0 * both, both - z * (slope_2 + free_2) - turn * (omega_1 + free_omega)

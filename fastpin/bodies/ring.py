"""A ring lug: a plate with a circular outer rim."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple, Self

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.body import THINNEST, Control, InWords, PlateBody, Remote, Rim, Shape, Table, check_outer
from fastpin.bodies.harmonics import Layer
from fastpin.bodies.walls import UNIT_STRESS, Amplitudes, Displacements, Other, force_on, free_at_contact, spectrum
from fastpin.errors import InputError
from fastpin.model.checks import check_fields, choice, is_above, positive
from fastpin.model.loads import REMOTE, P, Q
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.synonyms import explains_keywords

Support = Literal["held", "uniform", "normal", "shear", "half", "body"]
"""Kinds of support of a ring's outer rim."""

SUPPORTS: tuple[Support, ...] = ("held", "uniform", "normal", "shear", "half", "body")


@explains_keywords
@dataclass(frozen=True)
class Ring(PlateBody):
    """A ring lug: a plate with a circular outer rim round the hole.

    Parameters
    ----------
    outer_radius : float
        Radius of the outer rim, m, more than the hole radius.
    support : {"held", "uniform", "normal", "shear", "half", "body"}
        How the forces on the pin leave the ring. "held": the rim is clamped. "uniform": a traction of one size and
        direction all round the rim. "normal": normal traction alone, like the cosine of the angle from the force.
        "shear": shear traction alone, like the sine. "half": normal pressure like the cosine, on the half of the rim
        that a positive force pushes towards: below for P, on the right for Q. "body": a uniform body force. A moment
        leaves by a uniform shear traction.

    Raises
    ------
    InputError
        If the radius is not positive, or the support is unknown.
    """

    kind = "ring"
    keys: ClassVar = {"outer_radius": "length", "support": ""}
    controlled = ("outer_radius", "support")
    title = "ring lug"

    outer_radius: float
    support: Support = "held"

    def __post_init__(self) -> None:
        check_fields(self, positive, "outer_radius")
        check_fields(self, choice, "support", SUPPORTS)

    @property
    def held(self) -> bool:
        """Whether the outer rim is clamped."""
        return self.support == "held"

    @classmethod
    def read(cls, table: Table, key: str = "outer_radius") -> Self | None:
        """Read the ring whose outer radius stands under `key`. None if it is wrong; all faults are reported."""
        table.require(key)
        outer, support = table.checked(key, positive), table.choice("support", SUPPORTS)
        return None if outer is None or support is None else cls(outer, support)

    def check(self, radius: float, dimensionless: bool = False, name: str = "hole radius") -> None:
        check_outer(self.outer_radius, radius, name, THINNEST)

    def without_gauge(self, radius: float) -> str:
        large = is_above(radius, self.outer_radius)
        return "" if not large else f"must be at most the outer radius {self.outer_radius:g}, not {radius:g}"

    def check_remote(self, name: str) -> None:
        if self.held:
            words = 'a held rim leaves no remote stress; leave it out, or choose another support, such as "uniform"'
            raise InputError(name, words)

    def unknown_when_warm(self, pair: MaterialPair) -> str:
        return "a rigid ring can't expand within a held rim" if self.held and pair.plate.is_rigid else ""

    # -- the response of the rim

    def change(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        return rim.compliance * harmonics.ring(order, self.far(rim), rim.kolosov, self.outer_kind)

    def displacements(self, rim: Rim) -> Displacements:
        found: Displacements = {}
        if not self.held:
            for place in REMOTE:
                total, difference = UNIT_STRESS[place]
                traction = np.zeros((1, 2), dtype=complex)
                traction[0, 1] = 0.5 * np.conj(difference)
                found[place] = self._displaced(rim, 0.5 * total, np.array([2.0]), traction)
        if self.support == "half":
            m = np.arange(1, harmonics.harmonics_needed(1.0 / self.far(rim)) // 2 + 1)
            for place, middle in ((P, -0.5 * math.pi), (Q, 0.0)):
                mean, half = harmonics.half_cosine(1.0, middle, self.far(rim), m)  # the resultant is 1
                found[place] = self._displaced(rim, mean, 2.0 * m, np.stack([half, half], axis=1)) / rim.ratio
        return found

    def expanded(self, rim: Rim) -> np.ndarray:
        found = super().expanded(rim)
        if self.held:  # the support moves the rim back: under a uniform s_rr (1 - 1/r^2) that frees the hole
            found *= 1.0 - (rim.kolosov + 1.0) / (rim.kolosov - 1.0 + 2.0 * self.far(rim) ** -2.0)
        return found

    def _displaced(self, rim: Rim, mean: float, order: np.ndarray, traction: np.ndarray) -> np.ndarray:
        """Displacements of the free hole under tractions on the outer rim: mean s_rr, and (t_n, conj t_-n), (m, 2)."""
        far = self.far(rim)
        layer = Layer(order, far, rim.kolosov, rim.compliance)
        moved = layer.contact_displacement(layer.loaded_outside(traction))
        return spectrum(order, moved, 0.25 * (rim.kolosov + 1.0) * rim.compliance * mean / (1.0 - far**-2.0))

    # -- stresses

    def add_fields(self, rim: Rim, t: np.ndarray, remote: Remote, amplitudes: Amplitudes) -> tuple[Other, ...]:
        far, kolosov = self.far(rim), rim.kolosov
        last = min(len(t) - 1, self.highest_inside(rim))
        n, used = np.arange(2.0, last + 1.0), slice(2, last + 1)
        growing, falling = free_at_contact(harmonics.ring(n, far, kolosov, self.outer_kind), t[used], kolosov)
        amplitudes.A[used], amplitudes.C[used] = growing * np.array([far**n, far ** (n - 2.0)])
        amplitudes.B[used] += falling[0]
        amplitudes.D[used] += falling[1]
        q = far**-2.0
        stiff = kolosov - 1.0 + 2.0 * q if self.held else -2.0 * ((1.0 - 1.0 / far) * (1.0 + 1.0 / far))
        amplitudes.add_uniform(q * t[0, 0].real / stiff)
        if self.held:
            if remote[-1] and rim.material.expansion:  # the traction that keeps the rim in place
                strain = rim.material.expansion * remote[-1]
                stiff = 0.5 * rim.compliance * (kolosov - 1.0 + 2.0 * far**-2.0)
                amplitudes.add_uniform(-strain / stiff)
        else:  # the outer rim carries the tractions of the remote stress
            total, difference = remote[0] + remote[1], complex(remote[0] - remote[1], 2.0 * remote[2])
            layer = Layer(np.array([2.0]), far, kolosov, rim.compliance)
            growing = layer.loaded_outside(np.array([[0.0, 0.5 * np.conj(difference)]]))
            amplitudes.A[2] += growing[0, 0]
            amplitudes.C[2] += growing[0, 1]
            self._free_hole(rim, np.array([2]), growing, amplitudes)
            amplitudes.add_uniform(0.25 * total / ((1.0 - 1.0 / far) * (1.0 + 1.0 / far)))
        return self._add_half_support(rim, force_on(t), amplitudes) if self.support == "half" else ()

    def _add_half_support(self, rim: Rim, force: complex, amplitudes: Amplitudes) -> tuple[Other, ...]:
        """Add the field of a ring under a half cosine of pressure on its outer rim, beyond the first harmonic.

        The field of the disk under the same pressure is returned: its series converges slowly at the rim, but has a
        closed form.
        """
        far = self.far(rim)
        half = [HalfCosine(-force.imag, -0.5 * math.pi, far), HalfCosine(force.real, 0.0, far)]
        m = np.arange(1, self.highest_inside(rim) // 2 + 1)
        m = m[2 * m < amplitudes.A.size]
        order = 2.0 * m
        t = sum(each.harmonics(m) for each in half)
        growing = Layer(order, far, rim.kolosov, rim.compliance).loaded_outside(np.stack([t, t], axis=1))
        amplitudes.A[2 * m] += growing[:, 0] - t / (order + 1.0)
        amplitudes.C[2 * m] += growing[:, 1] + t * order / (order - 1.0)
        self._free_hole(rim, 2 * m, growing, amplitudes)
        amplitudes.add_uniform(0.5 * sum(each.mean for each in half) / ((1.0 - 1.0 / far) * (1.0 + 1.0 / far)))
        return tuple(each.polar for each in half)

    def _free_hole(self, rim: Rim, place: np.ndarray, growing: np.ndarray, found: Amplitudes) -> None:
        """Add the field that frees the hole of the traction of growing amplitudes (m, 2), harmonics `place`."""
        n, far = np.asarray(place, dtype=float), self.far(rim)
        A, C = growing.T * np.array([far**-n, far ** (2.0 - n)])
        found.B[place] += -(n + 1.0) * A - C
        found.D[place] += -n * n * A - (n - 1.0) * C

    # -- words, drawing, controls

    def words(self, length: InWords) -> str:
        support = {
            "held": "rim clamped",
            "uniform": "held by a uniform traction on the rim",
            "normal": "held by normal traction on the rim",
            "shear": "held by shear traction on the rim",
            "half": "held by normal pressure on half of the rim",
            "body": "held by a uniform body force",
        }[self.support]
        return f"ring of outer radius {length(self.outer_radius)}, {support}"

    def caption(self, length: InWords, material: InWords) -> str:
        return f", ring to radius {length(self.outer_radius)}"

    def drawing(self, rim: Rim) -> list[Shape]:
        outside = self.outer_radius / rim.hole
        # A clamped rim has leaning strokes, as walls have in drawings; a rim with tractions has fewer, upright ones.
        strokes = {"held": ["leaning strokes"], "body": []}.get(self.support, ["strokes"])
        return [Shape(kind, outside, "lug") for kind in ("circle", *strokes)]

    @classmethod
    def usual(cls, radius: float, material: Material) -> Self:
        return cls(2.0 * radius)

    def page_controls(self, radius: float, clearance: float, dimensionless: bool) -> list[Control]:
        chooser = Control("support", self.support, choices=SUPPORTS)
        return [*super().page_controls(radius, clearance, dimensionless), chooser]


class HalfCosine(NamedTuple):
    """A disk of radius `outer` under a half cosine of pressure about the angle `middle`, its harmonics 2, 4 and so on.

    The pressure has the resultant `force`.
    """

    force: float
    middle: float
    outer: float

    @property
    def mean(self) -> float:
        """Mean s_rr on the rim."""
        return harmonics.half_cosine(self.force, self.middle, self.outer, np.zeros(0))[0]

    def harmonics(self, m: np.ndarray) -> np.ndarray:
        """t_n for n = 2 m; t_-n is its conjugate."""
        return harmonics.half_cosine(self.force, self.middle, self.outer, m)[1]

    def polar(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s_rr + s_tt and D at the points z, (T46)."""
        w = z / self.outer * np.exp(-1j * self.middle)
        beyond = np.maximum(np.abs(w) ** -2.0 - 1.0, 0.0)  # on the rim rounding may leave a negative one
        pole, near = w * w == -1.0, np.abs(w) < 0.2  # near the centre the series has all digits by 12 terms
        safe = np.where(pole | near, 1.0, w)
        arctan = np.arctan(safe)
        value = 0.5 * ((safe + 1.0 / safe) * arctan - 1.0)
        slope = 0.5 * ((safe - 1.0 / safe) * arctan + 1.0)
        value[pole], slope[pole] = -0.5, 0.0  # there `beyond` times the logarithm of the slope vanishes
        m = np.arange(1.0, 13.0)
        terms = (-1.0) ** (m + 1.0) / (4.0 * m * m - 1.0)
        square = w[near] ** 2
        value[near] = square * np.polynomial.polynomial.polyval(square, terms)
        slope[near] = square * np.polynomial.polynomial.polyval(square, 2.0 * m * terms)
        mean = 4.0 * self.mean * value.real
        return mean, 0.5 * mean + self.mean * beyond * slope

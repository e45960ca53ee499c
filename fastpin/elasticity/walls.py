"""Smooth stresses in hollow pins, rings, bushes and plates with a reaction: series of the harmonics of the tractions.

The stress in a body is that of the disk or the hole in the infinite plate under the same tractions, (T31) and (T32),
plus a smooth field that leaves the contact rim free of traction. The potentials of that field are sums, (T42). Lengths
are in units of the radius of the wall's contact rim, or of the lug's own hole round a bush.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fastpin.elasticity import bodies
from fastpin.elasticity.tractions import CHUNK, Tractions
from fastpin.kernels import fourier, harmonics, laurent
from fastpin.kernels.harmonics import First
from fastpin.model.bodies import Plate, Ring, Tube
from fastpin.model.compliance import Compliance
from fastpin.model.loads import REMOTE, P, Q
from fastpin.model.problem import Problem
from fastpin.runtime.threads import in_chunks

SMALLEST = 1e-18
"""Coefficients of the series below this part of the largest are left out: they are below rounding at every point."""

SERIES_BELOW, SERIES_TERMS = 0.2, 12
"""Radius, in parts of the rim's, below which the half cosine is summed by its series, and the terms of the series."""

LEAST_BORE = 1e-30
"""Least bore of the series, in parts of the radius: powers of smaller ones are no numbers."""

Other = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""A field in closed form: s_rr + s_tt and D = s_rr - i s_rtheta at the points z (m,)."""


@dataclass(frozen=True, eq=False)
class Wall:
    """A smooth field of stress between two circles.

    Attributes
    ----------
    growing, decaying : ndarray of complex, shape (3, ...)
        Coefficients of the series, see :mod:`fastpin.kernels.laurent`.
    smallest, largest : float
        Radii at which they are scaled.
    others : tuple of callable
        Fields in closed form that belong to it.
    """

    growing: np.ndarray
    decaying: np.ndarray
    smallest: float
    largest: float
    others: tuple[Other, ...] = ()

    def polar(self, theta: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Stresses (srr, stt, srt), shape (3, m), at the angles `theta` and radii `radius`, both (m,)."""
        found = np.zeros((theta.size, 2), dtype=complex)

        def compute(part: slice) -> None:
            laurent.add_polar(
                theta[part], radius[part], self.growing, self.decaying, self.smallest, self.largest, found[part]
            )
            for other in self.others:
                mean, first = other(radius[part] * np.exp(1j * theta[part]))
                found[part, 0] += mean
                found[part, 1] += first

        in_chunks(theta.size, CHUNK, compute)
        mean, radial = found[:, 0].real, found[:, 1].real
        return np.array([radial, mean - radial, -found[:, 1].imag])


class Amplitudes(NamedTuple):
    """Amplitudes A, C, conj B, conj D of the harmonics n = 0, 1 and so on, each (N + 1,), and the first harmonic.

    Omega = A z^(n+1) + B z^(1-n), omega = C z^(n-1) + D z^(-n-1). They are scaled by the radii of the wall:
    A b^n, C b^(n-2), B a^-n and D a^(-n-2), with a the smallest and b the largest. Index 0 is the uniform pressure.
    `first` holds the amplitudes A, D, L and b of :class:`fastpin.kernels.harmonics.First`, shape (4,), without scale.
    """

    A: np.ndarray
    C: np.ndarray
    B: np.ndarray
    D: np.ndarray
    first: np.ndarray

    @classmethod
    def zero(cls, highest: int) -> Amplitudes:
        """No field, with room for the harmonics up to `highest`."""
        A, C, B, D = np.zeros((4, highest + 1), dtype=complex)
        return cls(A, C, B, D, np.zeros(4, dtype=complex))

    def wall(self, kolosov: float, smallest: float, largest: float, others: tuple[Other, ...] = ()) -> Wall:
        """The field of the amplitudes in a wall with these radii, of a material with this Kolosov constant."""
        n = np.arange(self.A.size)
        A, C, B, D = (self.A, self.C, np.conj(self.B), np.conj(self.D))
        growing = np.array([(n + 1) * A, n * (n + 1) * A, (n - 1) * C])
        decaying = np.array([(1 - n) * B, n * (n - 1) * B, -(n + 1) * D])
        one, other, log, body = self.first
        share = body / (kolosov + 1.0)
        growing[:, 1] = (2.0 * one - share) * largest, (2.0 * one + 0.5 * (kolosov - 1.0) * share) * largest, 0.0
        growing[2, 1] = kolosov * log / largest
        decaying[:, 1] = -np.conj(log) / smallest, np.conj(log) / smallest, -2.0 * np.conj(other) * smallest**-3.0
        return Wall(_trimmed(growing), _trimmed(decaying), smallest, largest, others)


def _trimmed(series: np.ndarray) -> np.ndarray:
    """The series without its last coefficients that are below rounding."""
    size = np.abs(series).max(axis=0)
    kept = np.flatnonzero(size > SMALLEST * size.max())
    return np.ascontiguousarray(series[:, : kept[-1] + 1 if kept.size else 1])


# -- harmonics of the tractions -------------------------------------------------------------------------------


@lru_cache(maxsize=80)  # the hat functions of 32 nodes, see fastpin/states/reading_bounds.py
def traction_harmonics(tractions: Tractions, highest: int) -> np.ndarray:
    """Harmonics (t_n, conj t_-n) of t = s_rr + i s_rtheta on the contact rim, n = 0 to `highest`; (highest + 1, 2)."""
    found = np.zeros((highest + 1, 2), dtype=complex)
    for patch in tractions.patches:
        theta, steps = patch[:, 0], np.diff(patch[:, 0])
        left, right = np.r_[0.0, steps], np.r_[steps, 0.0]
        for begin in range(0, highest + 1, fourier.BLOCK):
            order = np.arange(begin, min(begin + fourier.BLOCK, highest + 1), dtype=float)
            pressure, shear = fourier.hat_coefficients(order, theta, left, right, patch[:, 1:]).T
            found[begin : begin + order.size] -= np.array([pressure - 1j * shear, pressure + 1j * shear]).T
    return found / (2.0 * math.pi)


# -- the pin --------------------------------------------------------------------------------------------------


@lru_cache(maxsize=80)  # the hat functions of 32 nodes, see fastpin/states/reading_bounds.py
def pin_wall(problem: Problem, tractions: Tractions) -> Wall | None:
    """The field of a hollow pin beyond that of a solid pin under a force at its centre; None for a solid pin."""
    body, joint = problem.pin_body, problem.joint
    if not isinstance(body, Tube):
        return None
    bore, kolosov = max(joint.bore, LEAST_BORE), joint.pair.pin_kolosov
    highest = harmonics.harmonics_needed(math.sqrt(bore))
    t = traction_harmonics(tractions, highest)
    n, q = np.arange(2.0, highest + 1.0), bore * bore
    found = Amplitudes.zero(highest)
    growing, (B, _) = _free_at_contact(harmonics.tube(n, bore, kolosov, joint.bore_kind), t[2:], kolosov)
    found.A[2:], found.C[2:] = growing
    found.B[2:] = B * bore**-n
    s = kolosov if body.held else -1.0
    # (n - 1) B - A cancels for a narrow bore: the condition at the bore gives D
    right = s * t[2:, 0] * bore**n / (n + 1.0) + (s + 1.0) * growing[0] * bore**n
    right -= (n - 1.0) * np.expm1(n * math.log(q)) * found.B[2:]
    found.D[2:] = right / -np.expm1((n + 1.0) * math.log(q))
    outward = (kolosov - 1.0) / (2.0 + (kolosov - 1.0) * q) if body.held else -1.0 / ((1.0 - bore) * (1.0 + bore))
    found.A[0], found.D[0] = -0.5 * q * outward * t[0, 0].real, outward * t[0, 0].real
    found.first[:] = _first_change(joint.pin_first, harmonics.first(0.0, kolosov, "centre"), t[1])
    return found.wall(kolosov, bore, 1.0)


def _free_at_contact(change: np.ndarray, t: np.ndarray, kolosov: float) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes (A, C) and (conj B, conj D), each (2, m), from the change a, b, d of the compliance, (T43).

    The field leaves the contact rim free. Then its displacement there is (kappa + 1) (A, conj B)/2G.
    """
    n = np.arange(2.0, len(t) + 2.0)
    a, b, d = change / (kolosov + 1.0)
    A, B = a * t[:, 0] + b * t[:, 1], b * t[:, 0] + d * t[:, 1]
    return np.array([A, -B - (n + 1.0) * A]), np.array([B, (n - 1.0) * B - A])


def _first_amplitudes(first: First, t: np.ndarray) -> np.ndarray:
    """Amplitudes A, D, L, b of a first harmonic, shape (4,), under (t_1, conj t_-1) on its contact rim."""
    return np.array([first.A @ t, first.D @ t, first.L @ t, first.b @ t])


def _first_change(first: First, known: First, t: np.ndarray) -> np.ndarray:
    """Amplitudes of a first harmonic, minus the amplitudes of a `known` one."""
    return _first_amplitudes(first, t) - _first_amplitudes(known, t)


# -- the plate ------------------------------------------------------------------------------------------------


class PlateWalls(NamedTuple):
    """The smooth fields of a plate: at the contact, and in the lug beyond a bush in units of its own hole's radius.

    The lug's field is whole. Only in an infinite plate under remote stress Kirsch's field comes on top.
    """

    surface: Wall
    lug: Wall | None


@lru_cache(maxsize=80)  # the hat functions of 32 nodes, see fastpin/states/reading_bounds.py
def plate_walls(problem: Problem, tractions: Tractions, remote: tuple[float, ...]) -> PlateWalls | None:
    """The smooth fields of a plate under tractions and a remote stress (sxx, syy, sxy); None for an infinite plate."""
    joint = problem.joint
    if problem.plate_body == Plate() or isinstance(problem.plate_body, Compliance):
        return None
    t = traction_harmonics(tractions, _highest(problem))
    if joint.bush is None:
        return PlateWalls(_lug_wall(problem, t, remote, whole=False), None)
    bush, passed = _bush_wall(problem, t, remote)
    return PlateWalls(bush, _lug_wall(problem, passed, remote, whole=True))


def _highest(problem: Problem) -> int:
    """The highest harmonic that matters in the plate, up to its outer rim."""
    joint = problem.joint
    walls = [joint.lug_rim] + ([joint.bush] if joint.bush else [])
    return max(harmonics.harmonics_needed(math.sqrt(1.0 / rim)) for rim in walls)


def _bush_wall(problem: Problem, t: np.ndarray, remote: tuple[float, ...]) -> tuple[Wall, np.ndarray]:
    """The field of the bush beyond that of the hole in the infinite plate, and the harmonics that it passes on."""
    joint, kolosov = problem.joint, problem.surfaces.plate_kolosov
    outer, unit, highest = joint.bush, problem.surfaces.plate_compliance, len(t) - 1
    order = np.arange(2.0, highest + 1.0)
    assert outer is not None
    moved = _moved_hole(problem, t[1], remote, highest)
    q, found, passed = outer**-2.0, Amplitudes.zero(highest), t.copy()
    amplitudes, misfit, growing_traction, decaying_traction = _bush_matrices(problem, highest)
    growing = (amplitudes @ t[2:, :, None])[..., 0]
    growing = growing + np.linalg.solve(misfit, bodies.pairs_of(moved)[..., None])[..., 0]
    found.A[2:], found.C[2:] = growing.T
    A, C = growing.T * np.array([outer**-order, outer ** (2.0 - order)])
    found.B[2:], found.D[2:] = -(order + 1.0) * A - C, -order * order * A - (order - 1.0) * C
    passed[2:] = ((growing_traction @ growing[..., None]) + (decaying_traction @ t[2:, :, None]))[..., 0]
    lug, wall = joint.lug_uniform, (1.0 - 1.0 / outer) * (1.0 + 1.0 / outer)
    stiff = 0.5 * unit * (kolosov - 1.0 + 2.0 * q) - 2.0 * lug * wall
    uniform = (q * t[0, 0].real * (lug + 0.5 * unit) + moved[highest].real) / stiff
    uniform -= 0.5 * problem.press_fit_pressure / wall
    found.A[0], found.D[0], passed[0] = uniform, -2.0 * uniform, q * t[0] + 2.0 * uniform * wall
    first = joint.pair.plate_compliance / unit * joint.lug_first.displacement()[0]
    grown = 2.0 / unit * moved[highest + 1] / harmonics.first_stiffness(outer, kolosov, first)
    found.first[:] = _first_change(joint.bush_first, harmonics.first(math.inf, kolosov, "uniform"), t[1])
    found.first[:2] += grown, -grown
    passed[1, 0] = joint.bush_first.traction(outer) @ t[1] + 2.0 * grown * (outer - outer**-3.0)
    passed[1, 1] = t[1, 1] / outer
    return found.wall(kolosov, 1.0, outer), passed


@lru_cache(maxsize=16)
def _bush_matrices(problem: Problem, highest: int) -> tuple[np.ndarray, ...]:
    """Matrices of the bush for the harmonics from 2 to `highest`, shape (m, 2, 2) each.

    They are the growing amplitudes per traction on the contact rim, the misfit, and the traction at the outer rim per
    growing amplitude and per traction on the contact rim; see :class:`fastpin.kernels.harmonics.Layer`.
    """
    order = np.arange(2.0, highest + 1.0)
    layer, far = bodies.bush_layer(problem, order), bodies.lug_compliance(problem, order)
    assert layer is not None
    return layer.amplitudes(far), layer.misfit(far), layer.growing_traction, layer.decaying_traction


def _moved_hole(problem: Problem, first: np.ndarray, remote: tuple[float, ...], highest: int) -> np.ndarray:
    """Displacement of the lug's own free hole over its radius under the loads, n = -`highest` to `highest`.

    `first` is (t_1, conj t_-1) on the contact rim, which has the force.
    """
    found = np.zeros(2 * highest + 1, dtype=complex)
    force = -2.0 * math.pi * np.conj(first[1])
    loads = {Q: force.real, P: -force.imag, **dict(zip(REMOTE, remote, strict=True))}
    for place, column in bodies.lug_columns(problem, problem.joint.bush or 1.0).items():
        low = min(column.size // 2, highest)
        middle = column.size // 2
        found[highest - low : highest + low + 1] += loads[place] * column[middle - low : middle + low + 1]
    return found


def _lug_wall(problem: Problem, t: np.ndarray, remote: tuple[float, ...], whole: bool) -> Wall:
    """The field of the lug under the harmonics `t` on its own hole, beyond the hole in the infinite plate or `whole`.

    The remote stress counts where it is a traction on a ring's rim.
    """
    joint, lug, kolosov = problem.joint, problem.joint.lug, problem.joint.pair.plate_kolosov
    n, found = np.arange(2.0, len(t)), Amplitudes.zero(len(t) - 1)
    known = _first_amplitudes(harmonics.first(math.inf, kolosov, "uniform"), t[1])
    found.first[:] = _first_amplitudes(joint.lug_first, t[1]) - (0.0 if whole else known)
    if whole:
        found.B[2:], found.D[2:] = t[2:, 1] / (1.0 - n), t[2:, 0] / (n + 1.0) - t[2:, 1]
        found.D[0] = t[0, 0]
    force = -2.0 * math.pi * np.conj(t[1, 1])
    if isinstance(lug, Ring):
        _add_ring(problem, t, found)
        others: tuple[Other, ...] = ()
        if not lug.held:
            _add_rim_stress(problem, remote, found)
        if lug.support == "half":
            others = _add_half_support(problem, force, found)
        return found.wall(kolosov, 1.0, joint.lug_rim, others)
    assert isinstance(lug, Plate)
    others = ()
    if lug.reaction is not None:
        x, y = (value / (problem.hole_radius * (joint.bush or 1.0)) for value in lug.reaction)
        others = (Reaction(complex(x, y), -force, kolosov).polar,)
    return found.wall(kolosov, 1.0, 1.0, others)


def _add_ring(problem: Problem, t: np.ndarray, found: Amplitudes) -> None:
    """Add the field of a ring less that of the infinite plate under the same tractions on the hole."""
    joint, kolosov = problem.joint, problem.joint.pair.plate_kolosov
    outer, q = joint.lug_rim, joint.lug_rim**-2.0
    last = min(len(t) - 1, harmonics.harmonics_needed(math.sqrt(1.0 / outer)))
    n, used = np.arange(2.0, last + 1.0), slice(2, last + 1)
    growing, falling = _free_at_contact(harmonics.ring(n, outer, kolosov, joint.lug_kind), t[used], kolosov)
    found.A[used], found.C[used] = growing * np.array([outer**n, outer ** (n - 2.0)])
    found.B[used] += falling[0]
    found.D[used] += falling[1]
    wall = (1.0 - 1.0 / outer) * (1.0 + 1.0 / outer)
    stiff = kolosov - 1.0 + 2.0 * q if joint.lug_kind == harmonics.HELD else -2.0 * wall
    uniform = q * t[0, 0].real / stiff
    found.A[0] += uniform
    found.D[0] -= 2.0 * uniform


def _add_growing(problem: Problem, place: np.ndarray | int, growing: np.ndarray, found: Amplitudes) -> None:
    """Add growing amplitudes (m, 2) of the harmonics `place` in a ring, and what keeps its hole free."""
    n, outer = np.asarray(place, dtype=float), problem.joint.lug_rim
    A, C = growing.T * np.array([outer**-n, outer ** (2.0 - n)])
    found.B[place] += -(n + 1.0) * A - C
    found.D[place] += -n * n * A - (n - 1.0) * C


def _add_rim_stress(problem: Problem, remote: tuple[float, ...], found: Amplitudes) -> None:
    """Add the field of a ring whose outer rim carries the tractions of a remote stress."""
    joint = problem.joint
    total, difference = remote[0] + remote[1], complex(remote[0] - remote[1], 2.0 * remote[2])
    layer = harmonics.Layer(np.array([2.0]), joint.lug_rim, joint.pair.plate_kolosov, joint.pair.plate_compliance)
    growing = layer.loaded_outside(np.array([[0.0, 0.5 * np.conj(difference)]]))
    found.A[2] += growing[0, 0]
    found.C[2] += growing[0, 1]
    _add_growing(problem, np.array([2]), growing, found)
    uniform = 0.25 * total / ((1.0 - 1.0 / joint.lug_rim) * (1.0 + 1.0 / joint.lug_rim))
    found.A[0] += uniform
    found.D[0] -= 2.0 * uniform


def _add_half_support(problem: Problem, force: complex, found: Amplitudes) -> tuple[Other, ...]:
    """Add the field of a ring under a half cosine of pressure on its outer rim, beyond the first harmonic.

    That of the disk under the same pressure is returned: its series converges slowly at the rim, but has a closed form.
    """
    joint, outer = problem.joint, problem.joint.lug_rim
    half = [HalfCosine(-force.imag, -0.5 * math.pi, outer), HalfCosine(force.real, 0.0, outer)]
    m = np.arange(1, harmonics.harmonics_needed(math.sqrt(1.0 / outer)) // 2 + 1)
    m = m[2 * m < found.A.size]
    order = 2.0 * m
    t = sum(each.harmonics(m) for each in half)
    layer = harmonics.Layer(order, outer, joint.pair.plate_kolosov, joint.pair.plate_compliance)
    growing = layer.loaded_outside(np.stack([t, t], axis=1))
    found.A[2 * m] += growing[:, 0] - t / (order + 1.0)
    found.C[2 * m] += growing[:, 1] + t * order / (order - 1.0)
    _add_growing(problem, 2 * m, growing, found)
    uniform = 0.5 * sum(each.mean for each in half) / ((1.0 - 1.0 / outer) * (1.0 + 1.0 / outer))
    found.A[0] += uniform
    found.D[0] -= 2.0 * uniform
    return tuple(each.polar for each in half)


# -- closed forms ---------------------------------------------------------------------------------------------


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
        pole, near = w * w == -1.0, np.abs(w) < SERIES_BELOW
        safe = np.where(pole | near, 1.0, w)
        arctan = np.arctan(safe)
        value = 0.5 * ((safe + 1.0 / safe) * arctan - 1.0)
        slope = 0.5 * ((safe - 1.0 / safe) * arctan + 1.0)
        value[pole], slope[pole] = -0.5, 0.0  # there `beyond` times the logarithm of the slope vanishes
        m = np.arange(1.0, SERIES_TERMS + 1.0)
        terms = (-1.0) ** (m + 1.0) / (4.0 * m * m - 1.0)
        square = w[near] ** 2
        value[near] = square * np.polynomial.polynomial.polyval(square, terms)
        slope[near] = square * np.polynomial.polynomial.polyval(square, 2.0 * m * terms)
        mean = 4.0 * self.mean * value.real
        return mean, 0.5 * mean + self.mean * beyond * slope


class Reaction(NamedTuple):
    """A force at the point `place` of the infinite plate with a free hole of radius 1, (T47)."""

    place: complex
    force: complex
    kolosov: float

    def polar(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """s_rr + s_tt and D at the points z."""
        share = self.force / (2.0 * math.pi * (self.kolosov + 1.0))
        other, conj_place, s = np.conj(share), np.conj(self.place), 1.0 / z
        away, image = z - self.place, s - conj_place
        slope, slope_2 = -share / away, share / away**2  # of the force alone: Omega', Omega''
        omega_1 = self.kolosov * other / away - share * conj_place / away**2
        mirrored, mirrored_1, mirrored_2 = -other / image, other / image**2, -2.0 * other / image**3
        at_centre = other / conj_place  # mirrored at s = 0
        rest = self.kolosov * share / image - other * self.place / image**2
        rest_1 = -self.kolosov * share / image**2 + 2.0 * other * self.place / image**3
        free = at_centre - mirrored + s * mirrored_1 + s * s * rest  # Omega' of the hole
        free_2 = -(s**3) * (mirrored_2 + 2.0 * rest + s * rest_1)
        free_omega = s * s * (mirrored + np.conj(at_centre) + free) - s * free_2
        both = 2.0 * np.real(slope + free)
        turn = z * z / np.abs(z) ** 2
        return 2.0 * both, both - z * (slope_2 + free_2) - turn * (omega_1 + free_omega)

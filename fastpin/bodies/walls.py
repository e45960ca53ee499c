"""Series of harmonics: smooth fields of stress in bodies, and displacements of a rim under the loads of a problem.

The stress in a body is that of the disk or the hole in the infinite plate under the same tractions, (T31) and (T32),
plus a smooth field that leaves the contact rim free of traction. The potentials of that field are sums, (T42). Lengths
are in units of the radius of the wall's contact rim, or of the lug's own hole round a bush.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fastpin.bodies.harmonics import First
from fastpin.model.loads import SXX, SXY, SYY

UNIT_STRESS = {SXX: (1.0, 1.0 + 0.0j), SYY: (1.0, -1.0 + 0.0j), SXY: (0.0, 2.0j)}
"""Sum sxx + syy and complex difference sxx - syy + 2i sxy of the remote stresses, per unit load."""

Displacements = dict[int, np.ndarray]
"""Fourier coefficients of v_r + i v_theta of a rim over its radius, for n = -N to N, by load."""

Other = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""A field in closed form: s_rr + s_tt and D = s_rr - i s_rtheta at the points z (m,)."""


class Wall(NamedTuple):
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


class PlateWalls(NamedTuple):
    """The smooth fields of a plate: at the contact, and in the lug beyond a bush in units of its own hole's radius.

    The lug's field is whole. Only in an infinite plate under remote stress Kirsch's field comes on top.
    """

    surface: Wall
    lug: Wall | None


class Amplitudes(NamedTuple):
    """Amplitudes A, C, conj B, conj D of the harmonics n = 0, 1 and so on, each (N + 1,), and the first harmonic.

    Omega = A z^(n+1) + B z^(1-n), omega = C z^(n-1) + D z^(-n-1). They are scaled by the radii of the wall:
    A b^n, C b^(n-2), B a^-n and D a^(-n-2), with a the smallest and b the largest. Index 0 is the uniform pressure.
    `first` holds the amplitudes A, D, L and b of :class:`fastpin.bodies.harmonics.First`, shape (4,), without scale.
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

    def add_uniform(self, uniform: float) -> None:
        """Add a uniform pressure that leaves the rim of the radius 1 free of traction."""
        self.A[0] += uniform
        self.D[0] -= 2.0 * uniform

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
    """The series without its last coefficients, below 1e-18 of the largest: they are rounding at every point."""
    size = np.abs(series).max(axis=0)
    kept = np.flatnonzero(size > 1e-18 * size.max())
    return np.ascontiguousarray(series[:, : kept[-1] + 1 if kept.size else 1])


def free_at_contact(change: np.ndarray, t: np.ndarray, kolosov: float) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes (A, C) and (conj B, conj D), each (2, m), from the change a, b, d of the compliance, (T43).

    The field leaves the contact rim free. Then its displacement there is (kappa + 1) (A, conj B)/2G.
    """
    n = np.arange(2.0, len(t) + 2.0)
    a, b, d = change / (kolosov + 1.0)
    A, B = a * t[:, 0] + b * t[:, 1], b * t[:, 0] + d * t[:, 1]
    return np.array([A, -B - (n + 1.0) * A]), np.array([B, (n - 1.0) * B - A])


def first_amplitudes(first: First, t: np.ndarray) -> np.ndarray:
    """Amplitudes A, D, L, b of a first harmonic, shape (4,), under (t_1, conj t_-1) on its contact rim."""
    return np.array([first.A @ t, first.D @ t, first.L @ t, first.b @ t])


def first_change(first: First, known: First, t: np.ndarray) -> np.ndarray:
    """Amplitudes of a first harmonic, minus the amplitudes of a `known` one."""
    return first_amplitudes(first, t) - first_amplitudes(known, t)


def force_on(t: np.ndarray) -> complex:
    """The force Q - iP on the pin, in units of stress times radius, from the harmonics `t` on a rim."""
    force: complex = -2.0 * math.pi * np.conj(t[1, 1])  # of NumPy, whose quotients round otherwise than Python's
    return force


def spectrum(order: np.ndarray, moved: np.ndarray, uniform: complex, first: complex = 0.0) -> np.ndarray:
    """Coefficients for n = -K to K from pairs (u_n, conj u_-n), shape (m, 2), of the harmonics `order` (m,)."""
    highest = int(order[-1])
    found = np.zeros(2 * highest + 1, dtype=complex)
    places = order.astype(int)
    found[highest + places], found[highest - places] = moved[:, 0], np.conj(moved[:, 1])
    found[highest], found[highest + 1] = uniform, first
    return found


def pairs_of(column: np.ndarray) -> np.ndarray:
    """Pairs (u_n, conj u_-n), shape (K - 1, 2), of the harmonics from 2 on, from coefficients for n = -K to K."""
    middle = column.size // 2
    return np.stack([column[middle + 2 :], np.conj(column[middle - 2 :: -1])], axis=1)

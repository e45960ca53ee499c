"""Faying surfaces: where a pin clamps two plates, friction carries load from one plate to the next.

A surface carries the force T between the mean motions of two rims. T acts on each plate as a uniform traction on the
edge of its hole. The surface slips by what its flexibility c does not take of the relative motion u of the rims:
slip = u + c T. T is at most the limit, friction times clamp force. Where T is at the limit, the slip grows against T.

The circle |T| = limit is a polygon of 2 q sides with the normals +-n_k, so that paths stay exact in load. Each pair of
sides is a node with friction, whose pressure is always 1. The normals are the columns of n, shape (2, q), with
n n' = q/2 I. The q tractions t and slips s have

    T = (2/q) n t        slip = n s        s = (2/q) n' (u + c T) + (I - (2/q) n' n) t/e

The stiffness e is small: t differs from n' T by no more than e s. Along each normal the polygon is exact; in between it
lies outside of the circle, by 2 % at most.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fastpin.bodies.compliance import translation_rows

SIDES = 8
"""Pairs of sides q of the polygon of friction."""

LEAST_HARDENING, MOST_HARDENING = 1e-5, 1e-4
"""Bounds of the stiffness e, times beta*. With 1e-6 rounding of a state is 1e-10, and paths are lost."""

HARDENED = 1e-3
"""Part of the limit by which friction may change over the slip that is expected, where the bounds of e allow it."""

NORMALS = np.exp(1j * math.pi / SIDES * np.arange(SIDES)).view(float).reshape(SIDES, 2).T
"""The matrix n, shape (2, SIDES)."""

SPREAD = 2.0 / SIDES * NORMALS
"""Maps the tractions of the sides to the force T, shape (2, SIDES)."""


@dataclass(frozen=True, eq=False)
class FayingSurface:
    """Two plates that a pin clamps, dimensionless.

    Attributes
    ----------
    sections : (int, int)
        The pin in the one plate and in the next, among the sections. T is the force on the first one.
    limit : float
        Friction times clamp force.
    flexibility : float
        The flexibility c.
    clearance : float
        Clearance of the pin in both plates: the slip before the pin touches.
    """

    sections: tuple[int, int]
    limit: float
    flexibility: float
    clearance: float

    @property
    def signs(self) -> Iterator[tuple[int, float]]:
        """Each section, and the sign with which T acts on its plate."""
        return zip(self.sections, (1.0, -1.0), strict=True)

    def compliance(self) -> np.ndarray:
        """The slips of the sides per traction, beside those of the plates, shape (SIDES, SIDES)."""
        expected = HARDENED * self.limit / (1.0 + self.clearance + self.flexibility * self.limit)
        hardening = min(max(expected, LEAST_HARDENING), MOST_HARDENING)
        return self.flexibility * (SPREAD.T @ SPREAD) + (np.eye(SIDES) - SPREAD.T @ NORMALS) / hardening


def rim_basis(size: int, sign: float, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """The basis of a compliance with so many coefficients at a surface, as that of nodes.

    Returns the slips of the sides per coefficient of the displacement of the rim, shape (SIDES, size), and the
    coefficients of the traction on the rim per traction of the sides, shape (size, SIDES).
    """
    rows = sign * (SPREAD.T @ translation_rows(size))
    return math.sqrt(0.5) * rows, rows.T / (math.pi * math.sqrt(2.0) * thickness)


def rows_of(surfaces: Sequence[FayingSurface], first: int) -> list[slice]:
    """The nodes of the sides of each surface, behind those of the contacts, of which there are `first`."""
    return [slice(first + SIDES * k, first + SIDES * (k + 1)) for k in range(len(surfaces))]

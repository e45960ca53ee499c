"""The stress anywhere in a plate of any outline, from what the integral equations of its compliance solve.

The smooth field is the field beyond that of the hole in the infinite plate. It leaves the hole free, and its negative
powers of z follow from the displacement of the hole's edge, (T48). So the integrals of :mod:`fastpin.lugs.cauchy` run
over the other edges. Lengths are in hole radii.
"""

from __future__ import annotations

import json
from functools import cached_property, lru_cache

import numpy as np

from fastpin.bodies.compliance import Compliance, complex_coefficients
from fastpin.errors import InputError
from fastpin.lugs.cauchy import EdgeField, traction_on
from fastpin.lugs.outline import Lug, distances
from fastpin.lugs.panels import Fineness
from fastpin.lugs.plates import boundaries, hole_compliance, respond

SAME = 1e-3
"""Largest difference of a file's matrix and the one made again from its outline, in parts of the largest entry. Another
plate differs by more. Edges that are held in their middle only have errors of 4e-6."""

FINENESS = Fineness(12, 16)
"""The discretisation. Stresses on edges have errors of 3e-8 of the largest, and 1e-6 with 10 nodes a panel."""

MOST_HARMONICS = 60
"""Most harmonics to which those of a file are doubled."""

CLOSEST = 1e-8
"""Distance from an edge below which a point is taken to be so far inside, hole radii. Nothing is lost there."""

LEAST_PANEL = 0.004
"""Half length of the panels on which a largest stress is looked for, hole radii; shorter ones crowd at corners."""

MOST_POINTS = 5_000
"""Points whose stresses are kept for other states, at most."""


class PlateField:
    """The stress in a plate for unit coefficients of its compliance.

    The coefficients are those of the traction on the hole, then the loads "sxx", "syy" and "sxy" of the plate, and the
    free thermal strain times G: 2 + 4 K + 4.

    Parameters
    ----------
    lug : Lug
    order : int
        Highest harmonic K.

    Attributes
    ----------
    order : int
    edges : Edges
        Panels and nodes of all edges.
    singular : ndarray of complex
        Places on other edges at which the stress is infinite.
    apart : float
        Distance from them within which no largest stress is looked for.
    matrix : ndarray, shape (2 + 4 K, 2 + 4 K)
        Coefficients G v/R on the hole's edge.
    """

    apart = 0.25  # hole radii

    def __init__(self, lug: Lug, order: int) -> None:
        self.order, self._lug = order, lug
        self.kolosov, response = lug.kolosov, respond(lug, order, FINENESS, lambda done: None)
        self.edges = edges = response.edges
        size, (moved, pulled) = 2 + 4 * order, response.whole()
        self.matrix = response.projected()[:, :size]
        loops = boundaries(lug, order)[1:]
        singular = [loop.parts[k].start for loop in loops for k in range(len(loop.parts)) if loop.is_singular(k)]
        self.singular = np.array(singular, dtype=complex)
        self._edges = [part.scaled(1.0 / lug.hole_radius) for part in lug.edges]
        self._outer = edges.part_of_node >= len(lug.contact_edge)
        field = EdgeField.of(edges, self.kolosov, moved, pulled).on(edges.part >= len(lug.contact_edge))
        potential, spread = _beside_hole(order, self.kolosov, edges.z[self._outer])
        field.potential[:, :size] -= potential
        field.traction[:, :size] -= traction_on(potential, spread, field.along[:, None])
        self._field = field

    def contains(self, z: np.ndarray) -> np.ndarray:
        """Whether points (m,) lie within the outline, but in no further hole; edges belong to the plate."""
        away = np.array([distances(part, z) for part in self._edges]).min(axis=0)
        return np.asarray((away <= CLOSEST) | self._lug.surrounds(z * self._lug.hole_radius))

    @cached_property
    def rims(self) -> tuple[np.ndarray, list[str]]:
        """Points on the other edges, apart from singular places, and the names of their edges."""
        edges = self.edges
        kept = self._outer & (edges.half[edges.panel] > LEAST_PANEL)
        kept &= (np.abs(edges.z[:, None] - self.singular) > self.apart).all(axis=1)
        names = [edges.parts[part].name for part in edges.part_of_node[kept]]
        return edges.z[kept], names

    def smooth(self, column: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part of the smooth field that the integrals give: s_rr + s_tt and s_rr - i s_rt at points z (m,)."""
        if z.size > MOST_POINTS:
            found = self._stresses(z, self._field.times(column[:, None]))
            return found[0][:, 0], found[1][:, 0]
        mean, radial = self._of_each(z.astype(complex).tobytes())
        return mean @ column, radial @ column

    @lru_cache(maxsize=8)  # noqa: B019  the states of a history ask for the same points
    def _of_each(self, places: bytes) -> tuple[np.ndarray, np.ndarray]:
        return self._stresses(np.frombuffer(places, dtype=complex), self._field)

    def _stresses(self, z: np.ndarray, field: EdgeField) -> tuple[np.ndarray, np.ndarray]:
        """s_rr + s_tt and s_rr - i s_rt of several fields at points z (m,), both (m, fields)."""
        potential, spread = field.inside(self._moved(z))
        return 4.0 * potential.real, 2.0 * potential.real - (z / np.conj(z))[:, None] * spread

    def _moved(self, z: np.ndarray) -> np.ndarray:
        """The points, those on an edge a little inside: the integrals jump there."""
        found = z.copy()
        for part in self._edges:
            near = np.flatnonzero(distances(part, z) < CLOSEST)
            foot, along = part.nearest(z[near])
            found[near] = foot + CLOSEST * 1j * along
        return found


def _beside_hole(order: int, kolosov: float, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Phi and S at points z (m,) beside the hole in the infinite plate under each harmonic, (m, 2 + 4 K); (T48)."""
    f = complex_coefficients(np.eye(2 + 4 * order))
    n, powers = np.arange(1.0, order + 1.0), z[:, None] ** -np.arange(order + 1.0)
    a = -f[order - 1 :: -1]  # of z^-n
    a[0] /= kolosov + 1.0
    potential, slope = powers[:, 1:] @ a, -(powers[:, 1:] * n) @ a
    back = powers @ np.conj(f[order:]) + np.outer(z, -kolosov * np.conj(a[0]))
    square = z[:, None] ** 2
    return potential, ((np.abs(square) - 1.0) * slope + back + potential) / square


@lru_cache(maxsize=4)
def plate_field(body: Compliance) -> PlateField:
    """Return the field of a compliance that knows its outline.

    Raises
    ------
    InputError
        If the compliance of the outline is not that of the body.
    """
    # The compliance falls like d^-2n with the harmonic n, the stress at the nearest edge d like d^-n.
    found, size = PlateField(lug_of(body), max(body.order, min(2 * body.order, MOST_HARMONICS))), len(body.matrix)
    made = found.matrix[:size, :size] - hole_compliance(body.order, found.kolosov)
    if float(np.abs(made - body.matrix).max()) > SAME * float(np.abs(body.matrix).max()):
        raise InputError("lug", "is not the plate of the matrix: make the file again with fastpin compliance")
    return found


@lru_cache(maxsize=8)
def lug_of(body: Compliance) -> Lug:
    """Return the plate of a compliance that knows its outline. A wrong one raises :class:`InputError`."""
    return Lug.from_document(json.loads(body.outline), body.nu, body.plane, body.hole_radius)

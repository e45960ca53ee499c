"""The stress anywhere in a plate of any outline, from what the integral equations of its compliance solve.

With Kolosov's potentials, S = conj(z) Phi' + Psi, the unit tangent tau of an edge with the plate to its left, and the
traction t on the plate, every edge has (k + 1) Phi tau = d(2G u)/ds + i t. Cauchy's integrals give both inside, (T60):

    2 pi i Phi(z) = int Phi dt/(t - z)
    2 pi i S(z) = int (-conj(Phi tau) - i conj(t)) ds/(t - z) - int Phi conj(t - z)/(t - z)^2 dt

The smooth field is the field beyond that of the hole in the infinite plate. It leaves the hole free, and its negative
powers of z follow from the displacement of the hole's edge, (T48). So the integrals run over the other edges. Lengths
are in hole radii.
"""

from __future__ import annotations

import json
import math
from functools import cached_property, lru_cache

import numpy as np

from fastpin.bodies.compliance import Compliance, complex_coefficients
from fastpin.errors import InputError
from fastpin.lugs.outline import Lug, distances
from fastpin.lugs.panels import Fineness, near_integrals
from fastpin.lugs.plates import boundaries, hole_compliance, respond

SAME = 1e-7
"""Largest difference of a file's matrix and the one made again from its outline, in parts of the largest entry."""

FINENESS = Fineness(12, 16)
"""The discretisation. Stresses on edges have errors of 3e-8 of the largest, and 1e-6 with 10 nodes a panel."""

CLOSEST = 1e-7
"""Distance from an edge below which a point is taken to be so far inside, hole radii. Nothing is lost there."""

APART = 0.25
"""Distance from a singular place within which no largest stress is looked for, hole radii."""

LEAST_PANEL = 0.004
"""Half length of the panels on which a largest stress is looked for, hole radii; shorter ones crowd at corners."""

MOST_NAMED = 4
"""Singular places that are named."""

BLOCK = 200
"""Points whose integrals are taken at once."""


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
    edges : Edges
        Panels and nodes of all edges.
    nearest : float
        Distance of the nearest other edge from the hole's centre.
    singular : list of complex
        Places on other edges at which the stress is infinite.
    matrix : ndarray, shape (2 + 4 K, 2 + 4 K)
        Coefficients G v/R on the hole's edge.
    """

    def __init__(self, lug: Lug, order: int) -> None:
        self.kolosov, response = lug.kolosov, respond(lug, order, FINENESS, lambda done: None)
        self.edges = edges = response.edges
        size, (moved, pulled) = 2 + 4 * order, response.whole()
        self.matrix = response.projected()[:, :size]
        by_panel = moved.reshape(edges.part.size, edges.points, -1)
        slope = (edges.derivative @ by_panel / edges.half[:, None, None]).reshape(moved.shape)
        along = 1j * edges.normals[:, None]
        whole = (slope + 1j * pulled) / ((self.kolosov + 1.0) * along)
        # Where the stress is singular the displacement jumps a little from panel to panel. Its slope lacks these jumps.
        (starts, stops), ends = edges.ends, edges.lagrange(np.array([-1.0, 1.0])) @ by_panel
        following, is_outer = np.abs(stops[:, None] - starts).argmin(axis=1), edges.part >= len(lug.contact_edge)
        self._stops, self._jumps = stops[is_outer], (ends[following, 0] - ends[:, 1])[is_outer] / (self.kolosov + 1.0)
        loops = boundaries(lug, order)[1:]
        self.singular = [loop.parts[k].start for loop in loops for k in range(len(loop.parts)) if loop.is_singular(k)]
        self.nearest = lug.nearest
        self._edges = [part.scaled(1.0 / lug.hole_radius) for part in lug.edges]
        self._outer = is_outer[edges.panel]
        potential, spread = _beside_hole(order, self.kolosov, edges.z[self._outer])
        self._smooth, pulled = whole[self._outer], pulled[self._outer]
        self._smooth[:, :size] -= potential
        pulled[:, :size] -= _traction(potential, spread, along[self._outer])
        self._other = -np.conj(self._smooth * along[self._outer]) - 1j * np.conj(pulled)

    def contains(self, z: np.ndarray) -> np.ndarray:
        """Whether points (m,) lie within the outline, but in no further hole; edges belong to the plate."""
        away = np.array([distances(part, z) for part in self._edges]).min(axis=0)
        turns = np.array([part.turn_round(z) for part in self._edges]).sum(axis=0)
        return np.asarray((away <= CLOSEST) | (turns > math.pi))

    @cached_property
    def rims(self) -> tuple[np.ndarray, list[str]]:
        """Points on the other edges, apart from singular places, and the names of their edges."""
        edges, places = self.edges, np.array(self.singular)
        kept = self._outer & (edges.half[edges.panel] > LEAST_PANEL)
        if places.size:
            kept &= np.abs(edges.z[:, None] - places).min(axis=1) > APART
        names = [edges.parts[part].name for part in edges.part_of_node[kept]]
        return edges.z[kept], names

    @property
    def apart(self) -> str:
        """Where no largest stress is looked for, in words; empty if there is no such place."""
        if not self.singular:
            return ""
        places = ", ".join(f"[{z.real:.4g}, {z.imag:.4g}]" for z in self.singular[:MOST_NAMED])
        more = f" and {len(self.singular) - MOST_NAMED} more" if len(self.singular) > MOST_NAMED else ""
        return f"apart from {APART:g} R about sharp corners and ends of supports, in R: {places}{more}"

    @lru_cache(maxsize=8)  # noqa: B019  the states of a history ask for the same points
    def _at(self, places: bytes) -> tuple[np.ndarray, np.ndarray]:
        z = np.frombuffer(places, dtype=complex)
        moved = self._moved(z)
        parts = [self._integrals(moved[k : k + BLOCK]) for k in range(0, z.size, BLOCK)]
        potential, spread = (np.concatenate(values) for values in zip(*parts, strict=True))
        return 4.0 * potential.real, 2.0 * potential.real - (z / np.conj(z))[:, None] * spread

    def smooth(self, column: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part of the smooth field that the integrals give: s_rr + s_tt and s_rr - i s_rt at points z (m,)."""
        mean, radial = self._at(z.astype(complex).tobytes())
        return mean @ column, radial @ column

    def _moved(self, z: np.ndarray) -> np.ndarray:
        """The points, those on an edge a little inside: the integrals jump there."""
        found = z.copy()
        for part in self._edges:
            near = np.flatnonzero(distances(part, z) < CLOSEST)
            foot, along = part.nearest(z[near])
            found[near] = foot + CLOSEST * 1j * along
        return found

    def _integrals(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Phi and S at points (m,) by the integrals over all edges but the hole."""
        first, second, third = self._kernels(z)
        away = self._stops - z[:, None]
        jump = 1.0 / (2j * math.pi * away)
        potential = first @ self._smooth + jump @ self._jumps
        spread = second @ self._other - third @ self._smooth
        spread -= jump @ np.conj(self._jumps) + (jump * np.conj(away) / away) @ self._jumps
        return potential, spread

    def _kernels(self, z: np.ndarray) -> np.ndarray:
        """Cauchy's three kernels between points (m,) and the nodes of other edges, over 2 pi i, shape (3, m, nodes)."""
        edges = self.edges

        def kernels(r: np.ndarray, along: np.ndarray) -> np.ndarray:
            return np.array([along / r, 1.0 / r, along * np.conj(r) / (r * r)])

        with np.errstate(divide="ignore", invalid="ignore"):  # a node itself comes below
            values = kernels(edges.z - z[:, None], 1j * edges.normals) * edges.weights
        rows, columns, sums = near_integrals(edges, np.arange(edges.part.size), z, kernels)
        for value, near in zip(values, sums.transpose(1, 0, 2), strict=True):
            value[rows, columns] = near
        return values[:, :, self._outer] / (2j * math.pi)


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


def _traction(potential: np.ndarray, spread: np.ndarray, along: np.ndarray) -> np.ndarray:
    """The traction on an edge with the unit tangents `along`, the plate to the left."""
    return np.asarray(-1j * along * (2.0 * potential.real + np.conj(spread * along**2)))


@lru_cache(maxsize=4)
def plate_field(body: Compliance) -> PlateField:
    """Return the field of a compliance that knows its outline.

    Raises
    ------
    InputError
        If the compliance of the outline is not that of the body.
    """
    found = PlateField(lug_of(body), body.order)
    made = found.matrix - hole_compliance(body.order, found.kolosov)
    if float(np.abs(made - body.matrix).max()) > SAME * float(np.abs(body.matrix).max()):
        raise InputError("lug", "is not the plate of the matrix: make the file again with fastpin compliance")
    return found


def lug_of(body: Compliance) -> Lug:
    """Return the plate of a compliance that knows its outline. A wrong one raises :class:`InputError`."""
    return Lug.from_document(json.loads(body.outline), body.nu, body.plane, body.hole_radius)

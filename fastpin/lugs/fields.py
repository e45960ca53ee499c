"""The stress anywhere in a plate of any outline, from what the integral equations of its compliance solve.

The smooth field is the field beyond that of the hole in the infinite plate. It leaves the hole free, and its negative
powers of z follow from the displacement of the hole's edge, (T48). The rest is regular in the hole. So the integrals of
:mod:`fastpin.lugs.cauchy` run over the other edges. Lengths are in hole radii.
"""

from __future__ import annotations

import json
import math
import threading
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache, wraps
from typing import Any, NamedTuple, TypeVar

import numpy as np

from fastpin.bodies.compliance import Compliance, complex_coefficients
from fastpin.errors import InputError
from fastpin.lugs.cauchy import EdgeField, traction_on
from fastpin.lugs.outline import Lug
from fastpin.lugs.panels import Fineness
from fastpin.lugs.plates import NO_PINS, boundaries, hole_compliance, respond

SAME = 1e-3
"""Largest difference of a file's matrix and the one made again from its outline, in parts of the largest entry. Another
plate differs by more. Edges that are held in their middle only have errors of 4e-6."""

FINENESS = Fineness(12, 16)
"""The discretisation. Stresses on edges have errors of 3e-8 of the largest, and 1e-6 with 10 nodes a panel."""

MOST_HARMONICS = 60
"""Most harmonics to which those of a file are doubled."""

LEAST_PANEL = 0.004
"""Half length of the panels on which a largest stress is looked for, hole radii; shorter ones crowd at corners."""

AROUND = 33
"""Points of a panel at which its hoop stress is known: a largest one between them is 3e-4 larger at most."""

MOST_POINTS = 5_000
"""Points whose stresses are kept for other states, at most."""


Found = TypeVar("Found")


def once(most: int) -> Callable[[Callable[..., Found]], Callable[..., Found]]:
    """Keep the last `most` results of a function. Threads that ask for one of them at once wait for one computation."""

    def decorate(function: Callable[..., Found]) -> Callable[..., Found]:
        known, locks = lru_cache(most)(function), [threading.Lock() for _ in range(16)]

        @wraps(function)
        def found(*arguments: Any) -> Found:
            with locks[hash(arguments) % len(locks)]:
                return known(*arguments)

        return found

    return decorate


class EdgeHoop(NamedTuple):
    """The hoop stress along the edges beyond the holes with pins: outline counter-clockwise, then further holes.

    Attributes
    ----------
    order : int
        Highest harmonic K of the tractions on the hole.
    z : ndarray of complex, shape (m,)
        Points, apart from singular places, hole radii.
    along : ndarray, shape (m,)
        Their places along the edges, from the beginning of the outline, hole radii.
    names : list of str
        Their edges.
    columns : ndarray, shape (m, coefficients)
        The stress for unit coefficients, see :class:`PlateField`.
    """

    order: int
    z: np.ndarray
    along: np.ndarray
    names: list[str]
    columns: np.ndarray


class PlateField:
    """The stress in a plate for unit coefficients of its compliance.

    The coefficients are those of the traction on the hole, then on each further hole with a pin, the loads "sxx", "syy"
    and "sxy" of the plate, and the free thermal strain times G: the sum of all 2 + 4 K, and 4.

    Parameters
    ----------
    lug : Lug
    order : int
        Highest harmonic K.
    pinned : mapping of str to int
        Names of the further holes with a pin, in the order of ``lug.holes``, and their highest harmonics.

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
    along_edges : EdgeHoop
    """

    apart = 0.25  # hole radii

    def __init__(self, lug: Lug, order: int, pinned: Mapping[str, int] = NO_PINS) -> None:
        self.order = order
        self.kolosov, response = lug.kolosov, respond(lug, order, FINENESS, lambda done: None, pinned)
        self.edges = edges = response.edges
        size, (moved, pulled) = 2 + 4 * order, response.whole()
        self.matrix = response.projected()[:, :size]
        loops = boundaries(lug, order, pinned)[1:]
        singular = [loop.parts[k].start for loop in loops for k in range(len(loop.parts)) if loop.is_singular(k)]
        self.singular = np.array(singular, dtype=complex)
        names = np.array([part.name for part in edges.parts])
        self._free = (edges.part >= edges.of_hole) & ~np.isin(names[edges.part], list(pinned))
        whole = EdgeField.of(edges, self.kolosov, moved, pulled)
        self.along_edges, field = self._hoop(whole.on(self._free)), whole.on(edges.part >= edges.of_hole)
        potential, spread = self._beside_hole(moved, edges.z[edges.is_further])
        field.potential[:] -= potential
        field.traction[:] -= traction_on(potential, spread, field.along[:, None])
        self._field = field

    @cached_property
    def rims(self) -> tuple[np.ndarray, list[str]]:
        """Nodes on other edges without a pin, apart from singular places, and the names of their edges."""
        return self._places(self.edges.rule[0])[1:]

    def _places(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[str]]:
        """Points at s from -1 to 1 of panels without a pin: which are kept (panels, s), the kept ones, and names."""
        edges = self.edges
        panels = np.flatnonzero(self._free)
        z = edges.at(panels[:, None], s)[0]
        kept = (np.abs(z[..., None] - self.singular) > self.apart).all(axis=-1)
        kept &= edges.half[panels, None] > LEAST_PANEL
        return kept, z[kept], [edges.parts[part].name for part in edges.part[panels[np.nonzero(kept)[0]]]]

    def _hoop(self, field: EdgeField) -> EdgeHoop:
        """The hoop stress along the other edges of a whole field there: 4 Re Phi is the sum of the normal stresses."""
        s, edges = np.linspace(-1.0, 1.0, AROUND), self.edges
        at_nodes = (4.0 * field.potential - field.traction / (-1j * field.along[:, None])).real
        kept, z, names = self._places(s)
        values = edges.lagrange(s) @ at_nodes.reshape(len(kept), edges.points, -1)
        length = np.array([part.length for part in edges.parts])
        starts, panels = np.cumsum(length) - length, self._free
        share = edges.share[panels, None] + 0.5 * edges.width[panels, None] * s
        part = edges.part[panels, None]
        along = (starts[part] + share * length[part])[kept] - starts[edges.of_hole]
        order = np.argsort(along, kind="stable")
        return EdgeHoop(self.order, z[order], along[order], [names[k] for k in order], values[kept][order])

    def _beside_hole(self, moved: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Negative powers of Phi and S about the hole of all fields, at points z (m,), both (m, fields); (T48).

        `moved` has the displacements 2G u/R of all nodes.
        """
        edges, K, n = self.edges, self.order, np.arange(-self.order, self.order + 1.0)[:, None]
        hole = ~edges.is_further
        waves = edges.weights[hole] / (2.0 * math.pi) * edges.z[hole] ** (-n - 1.0)
        f = complex_coefficients(np.eye(2 + 4 * K, moved.shape[1]))
        a = ((n + 1.0) * (waves @ moved[hole]) - f) / (self.kolosov + 1.0)
        decaying, powers = a[K - 1 :: -1], z[:, None] ** -np.arange(K + 1.0)
        potential, slope = powers[:, 1:] @ decaying, powers[:, 1:] @ (n[K - 1 :: -1] * decaying)
        back = powers @ np.conj(a[K:] + f[K:]) + a[K] - self.kolosov * np.outer(z, np.conj(decaying[0]))
        square = z[:, None] ** 2
        return potential, ((np.abs(square) - 1.0) * slope + back + potential) / square

    def smooth(self, column: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part of the smooth field that the integrals give: s_rr + s_tt and s_rr - i s_rt at points z (m,)."""
        if z.size > MOST_POINTS:
            found = self._stresses(z, self._field.times(column[:, None]))
            return found[0][:, 0], found[1][:, 0]
        mean, radial = self._of_each(z.astype(complex).tobytes())
        return mean @ column, radial @ column

    @once(8)  # the states of a history ask for the same points
    def _of_each(self, places: bytes) -> tuple[np.ndarray, np.ndarray]:
        return self._stresses(np.frombuffer(places, dtype=complex), self._field)

    def _stresses(self, z: np.ndarray, field: EdgeField) -> tuple[np.ndarray, np.ndarray]:
        """s_rr + s_tt and s_rr - i s_rt of several fields at points z (m,), both (m, fields)."""
        potential, spread = field.at(z)
        return 4.0 * potential.real, 2.0 * potential.real - (z / np.conj(z))[:, None] * spread


@once(4)
def plate_field(body: Compliance, pinned: tuple[str, ...] = ()) -> PlateField:
    """Return the field of a compliance that knows its outline. The further holes with the names `pinned` carry pins.

    Raises
    ------
    InputError
        If the compliance of the outline is not that of the body.
    """
    # The compliance falls like d^-2n with the harmonic n, the stress at the nearest edge d like d^-n.
    order, size = max(body.order, min(2 * body.order, MOST_HARMONICS)), len(body.matrix)
    found = PlateField(lug_of(body), order, dict.fromkeys(pinned, body.order))
    made = found.matrix[:size, :size] - hole_compliance(body.order, found.kolosov)
    if float(np.abs(made - body.matrix).max()) > SAME * float(np.abs(body.matrix).max()):
        raise InputError("lug", "is not the plate of the matrix: make the file again with fastpin compliance")
    return found


@lru_cache(maxsize=8)
def lug_of(body: Compliance) -> Lug:
    """Return the plate of a compliance that knows its outline. A wrong one raises :class:`InputError`."""
    return Lug.from_document(json.loads(body.outline), body.nu, body.plane, body.hole_radius)

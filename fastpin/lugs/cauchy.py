"""Stresses in a plate by Cauchy's integrals over its edges, from displacements and tractions there.

With Kolosov's potentials, S = conj(z) Phi' + Psi, the unit tangent tau of an edge with the plate to its left, and the
traction t on the plate, every edge has (k + 1) Phi tau = d(2G u)/ds + i t. Cauchy's integrals give both inside, (T59):

    2 pi i Phi(z) = int Phi dt/(t - z)
    2 pi i S(z) = int (-conj(Phi tau) - i conj(t)) ds/(t - z) - int Phi conj(t - z)/(t - z)^2 dt
"""

from __future__ import annotations

import math
from typing import NamedTuple, Self

import numpy as np

from fastpin.lugs.outline import CLOSEST
from fastpin.lugs.panels import Edges, near_integrals

BLOCK = 100
"""Points whose integrals are taken at once."""


class EdgeField(NamedTuple):
    """Phi and the traction on edges, for several fields at once.

    Attributes
    ----------
    edges : Edges
    panels : ndarray of bool, shape (panels,)
        The panels over which the integrals run: all, or the last ones.
    potential, traction : ndarray of complex, shape (nodes of these panels, m)
    joints, jumps : ndarray of complex, shape (joints,) and (joints, m)
        Corners of edges beyond the hole, or all ends of their panels, and jumps of 2G u/(k + 1) there, which the slope
        of u lacks.
    cut : ndarray, shape (joints,)
        Distance from each joint within which the jump is left out.
    """

    edges: Edges
    panels: np.ndarray
    potential: np.ndarray
    traction: np.ndarray
    joints: np.ndarray
    jumps: np.ndarray
    cut: np.ndarray

    @classmethod
    def of(cls, edges: Edges, kolosov: float, moved: np.ndarray, pulled: np.ndarray, far: bool = False) -> Self:
        """The field of displacements 2G u and tractions on all nodes, complex (nodes, m).

        For points that are `far` from all edges, by half a panel, all ends of panels are joints. Long panels then leave
        1e-8 instead of 1e-5.
        """
        by_panel = moved.reshape(edges.part.size, edges.points, -1)
        slope = (edges.derivative @ by_panel / edges.half[:, None, None]).reshape(moved.shape)
        potential = (slope + 1j * pulled) / ((kolosov + 1.0) * (1j * edges.normals[:, None]))
        starts = [part.start for part in edges.parts[edges.of_hole :]]
        joints = edges.ends[0][edges.part >= edges.of_hole] if far else np.array(starts)
        before, after = (np.abs(joints[:, None] - ends).argmin(axis=1) for ends in edges.ends[::-1])
        ends = edges.lagrange(np.array([-1.0, 1.0])) @ by_panel
        jumps = (ends[after, 0] - ends[before, 1]) / (kolosov + 1.0)
        cut = (0.0 if far else 2.0) * np.maximum(edges.half[before], edges.half[after])
        return cls(edges, np.ones(edges.part.size, dtype=bool), potential, pulled, joints, jumps, cut)

    def times(self, columns: np.ndarray) -> Self:
        """The fields that are sums of these with real factors (m, sums)."""
        sums = (each @ columns for each in (self.potential, self.traction, self.jumps))
        return self._replace(**dict(zip(("potential", "traction", "jumps"), sums, strict=True)))

    def on(self, panels: np.ndarray) -> Self:
        """The part of a whole field that the last panels give."""
        nodes = panels[self.edges.panel]
        return self._replace(panels=panels, potential=self.potential[nodes], traction=self.traction[nodes])

    @property
    def along(self) -> np.ndarray:
        """Unit tangents at the nodes of the panels."""
        return np.asarray(1j * self.edges.normals[self.panels[self.edges.panel]])

    def at(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Phi and S at points (p,) inside or on the edges of the panels, both (p, m)."""
        other = -np.conj(self.potential * self.along[:, None]) - 1j * np.conj(self.traction)
        edges, panels = self.edges, np.flatnonzero(self.panels)
        potential, spread = np.empty((2, z.size, self.potential.shape[1]), dtype=complex)
        for begin in range(0, z.size, BLOCK):
            part = np.arange(begin, min(begin + BLOCK, z.size))
            panel, s, away = edges.nearest(z[part], panels)
            inside, on_edge = part[away > CLOSEST], away <= CLOSEST
            potential[inside], spread[inside] = self._integrals(z[inside], other)
            for each in np.unique(panel[on_edge]).tolist():  # no integral is needed there
                there, start = np.flatnonzero(on_edge & (panel == each)), (each - panels[0]) * edges.points
                lagrange, along = edges.lagrange(s[there]), edges.at(panel[there], s[there])[1]
                values = (lagrange @ known[start : start + edges.points] for known in (self.potential, self.traction))
                potential[part[there]], traction = values
                spread[part[there]] = spread_on(potential[part[there]], traction, along[:, None])
        return potential, spread

    def _integrals(self, z: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, second, third = self._kernels(z)
        away = self.joints - z[:, None]
        jump = np.where(np.abs(away) > self.cut, 1.0 / (2j * math.pi * away), 0.0)
        potential = first @ self.potential + jump @ self.jumps
        spread = second @ other - third @ self.potential
        spread -= jump @ np.conj(self.jumps) + (jump * np.conj(away) / away) @ self.jumps
        return potential, spread

    def _kernels(self, z: np.ndarray) -> np.ndarray:
        """Cauchy's three kernels between points (p,) and nodes, over 2 pi i, shape (3, p, nodes of the panels)."""
        edges, panels = self.edges, np.flatnonzero(self.panels)
        first = panels[0] * edges.points
        with np.errstate(divide="ignore", invalid="ignore"):  # a node itself comes below
            r, along = edges.z[first:] - z[:, None], self.along
            inverse = edges.weights[first:] / r
            values = np.array([along * inverse, inverse, along * np.conj(r) / r * inverse])
        rows, columns, sums = near_integrals(edges, panels, z)
        for k, value in enumerate(values):
            value[rows, columns - first] = sums[:, 2 * k] + 1j * sums[:, 2 * k + 1]
        return values / (2j * math.pi)


def traction_on(potential: np.ndarray, spread: np.ndarray, along: np.ndarray) -> np.ndarray:
    """The traction on an edge with the unit tangents `along`, the plate to the left."""
    return np.asarray(-1j * along * (2.0 * potential.real + np.conj(spread * along**2)))


def spread_on(potential: np.ndarray, traction: np.ndarray, along: np.ndarray) -> np.ndarray:
    """S on an edge from the traction there; see :func:`traction_on`."""
    return np.asarray(np.conj(along) ** 2 * np.conj(1j * traction * np.conj(along) - 2.0 * potential.real))

"""The images of dislocations in the edges of a plate of any outline: what cracks at its hole need.

A dislocation beside the hole of the infinite plate leaves the hole free of tractions, in closed form. Its image takes
its tractions from free edges and its displacements from held ones, and leaves the hole free, too: (T60). The integral
equations of the plate give the image, :mod:`fastpin.lugs.cauchy` its stress. Along the lines of cracks the image is
smooth. So it is computed for sources and receivers at a few points of each line, and interpolated.

Lengths are in hole radii. Edges are cut so finely that all cracks up to :data:`SHALLOW` of their ligaments share one
factorised matrix. Those of deeper cracks have panels that shrink towards the cracks.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from fastpin.bodies.compliance import Compliance
from fastpin.lugs.cauchy import HOLE, EdgeField, traction_on
from fastpin.lugs.fields import lug_of
from fastpin.lugs.outline import Part, distances
from fastpin.lugs.panels import Edges, Fineness
from fastpin.lugs.plates import PlateEquations, boundaries

FINENESS = Fineness(10, 14)
"""The discretisation."""

SHALLOW, DEEP = 0.8, 0.955
"""Parts of the ligament up to which images are computed: on the edges of all cracks, and on edges of their own."""

HARMONICS = 12
"""Harmonics of images on the edge of the hole that its panels resolve to 1e-12."""

APART = 2.0
"""Longest panel in parts of its distance from a crack: ten nodes then leave 2e-8 of K."""

SMALL, MOST_POINTS = 5.0, 200
"""Length of a line, hole radii, from which more points keep its images, and most points of a line."""

Ray = tuple[float, float]
"""Angle of the mouth of a crack and its direction from the radius, rad."""


@dataclass(frozen=True)
class OtherEdges:
    """The edges beyond the hole, as cracks at the hole see them.

    Lines of cracks are triples: angle of the mouth and direction from the radius, rad, and the length in hole radii.
    """

    body: Compliance

    is_round: ClassVar[bool] = False

    def ligament(self, mouth: float, angle: float) -> float:
        """Length of the line of a crack to the edge at which it leaves the plate, hole radii."""
        return _ligament(self.body, mouth, angle)

    def deepest(self, lines: Sequence[tuple[float, float, float]]) -> float:
        """The largest part of its ligament that a crack takes."""
        return max(length / self.ligament(mouth, angle) for mouth, angle, length in lines)

    def influence(
        self, lines: Sequence[tuple[float, float, float]], s: np.ndarray, t: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The coefficients of g and of conj(g) in the tractions at distances s of dislocations at distances t.

        Both distances have the shape (cracks, p), both coefficients (cracks p, cracks p).
        """
        rays = tuple((mouth, angle) for mouth, angle, _ in lines)
        part = SHALLOW if self.deepest(lines) <= SHALLOW else DEEP
        ends = np.array([part * self.ligament(*ray) for ray in rays])[:, None]
        kept = _kept(self.body, rays, part)
        left, right = (_interpolation(distances / ends, kept[0].shape[0] // len(rays)) for distances in (s, t))
        straight, mirrored = (left @ one @ right.T for one in kept)
        return straight, mirrored


def _count(edges: Edges, lines: Sequence[Part]) -> int:
    """Number of points of each line at which images are kept.

    Images lie about twice as far from a line as the edges, and limit the interpolation by Bernstein's ellipse through
    them. In a wide plate the hole is small for its lines.
    """
    least = math.inf
    for line in lines:
        place = 2.0 * (edges.z[edges.part_of_node >= HOLE] - line.start) / (line.end - line.start) - 1.0
        mirrored = 2.0 * place - np.clip(place.real, -1.0, 1.0)
        root = np.sqrt(mirrored - 1.0) * np.sqrt(mirrored + 1.0)
        least = min(least, float(np.abs(mirrored + root).min()))
    wide = math.ceil(16.0 * max(math.log10(max(line.length for line in lines) / SMALL), 0.0))
    return min(max(24, math.ceil(22.0 / math.log(least))) + wide, MOST_POINTS)


def _chebyshev(count: int) -> np.ndarray:
    """Chebyshev's points on [0, 1]."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * (np.arange(count) + 0.5) / count)))


def _interpolation(share: np.ndarray, count: int) -> np.ndarray:
    """Matrix from the kept points of all lines, `count` on each, to shares (lines, p) of them."""
    lines, points = share.shape
    turn = np.pi * (np.arange(count) + 0.5) / count
    away = share[..., None] - _chebyshev(count)
    weights = (-1.0) ** np.arange(count) * np.sin(turn) / np.where(away == 0.0, 1e-300, away)
    found = np.zeros((lines, points, lines, count))
    found[np.arange(lines), :, np.arange(lines)] = weights / weights.sum(axis=2, keepdims=True)
    return found.reshape(lines * points, lines * count)


@lru_cache(maxsize=1024)
def _ligament(body: Compliance, mouth: float, angle: float) -> float:
    lug = lug_of(body)
    start, along = cmath.exp(1j * mouth), cmath.exp(1j * (mouth + angle))
    return min(part.crossing(start * lug.hole_radius, along) for part in lug.edges) / lug.hole_radius


@lru_cache(maxsize=1)
def _shared(body: Compliance) -> PlateEquations:
    """The equations on edges for all cracks up to :data:`SHALLOW` of their ligaments."""
    lug = lug_of(body)
    hole = [part.scaled(1.0 / lug.hole_radius) for part in lug.contact_edge]
    return _equations(body, [(part, APART * (1.0 - SHALLOW)) for part in hole])


def _equations(body: Compliance, beside: Sequence[tuple[Part, float]]) -> PlateEquations:
    lug = lug_of(body)
    first, *others = boundaries(lug, HARMONICS)
    edges = Edges([first, *(replace(loop, beside=tuple(beside)) for loop in others)], FINENESS)
    return PlateEquations(lug, edges, lambda done: None)


def is_fine(edges: Edges, lines: Sequence[Part]) -> bool:
    """Whether no panel is too long for its distance from the lines of cracks."""
    panels = np.flatnonzero(edges.part >= HOLE)
    points, _ = edges.at(panels[:, None], np.linspace(-1.0, 1.0, 7))
    away = np.array([distances(line, points.ravel()).reshape(points.shape).min(axis=1) for line in lines])
    return bool(np.all(2.0 * edges.half[panels] <= 1.25 * APART * away))


@lru_cache(maxsize=256)
def _kept(body: Compliance, rays: tuple[Ray, ...], part: float) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients between the kept points of all lines."""
    longest = np.array([part * _ligament(body, *ray) for ray in rays])
    starts = np.exp(1j * np.array([mouth for mouth, _ in rays]))
    along = np.exp(1j * np.array([mouth + angle for mouth, angle in rays]))
    ends = [Part("", *pair) for pair in zip(starts.tolist(), (starts + longest * along).tolist(), strict=True)]
    equations = _shared(body)
    if not is_fine(equations.edges, ends):
        equations = _equations(body, [(end, APART) for end in ends])
    count = _count(equations.edges, ends)
    s = np.multiply.outer(longest, _chebyshev(count)).ravel()
    starts, along = np.repeat(starts, count), np.repeat(along, count)
    return image(equations, starts + s * along, along, starts)


def image(
    equations: PlateEquations, z: np.ndarray, direction: np.ndarray, mouth: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients of g and of conj(g) in the tractions of images, both (m, m).

    Points z (m,) are sources and receivers. They lie on lines with a `direction` from a `mouth`, both (m,).
    """
    edges = equations.edges
    outer = edges.part_of_node >= HOLE
    tractions = np.zeros((edges.z.size, 2 * z.size), dtype=complex)
    moved = np.zeros_like(tractions)
    along = 1j * edges.normals[outer][:, None]
    for k, g in enumerate((1.0, 1j)):
        columns = slice(k * z.size, (k + 1) * z.size)
        potential, spread, displacement = dislocation(
            edges.z[outer][:, None], z, 0.5 * np.conj(g) * direction, mouth, equations.kolosov
        )
        tractions[outer, columns] = -traction_on(potential, spread, along)
        moved[outer, columns] = -displacement
    (u_x, u_y), (t_x, t_y) = equations.solve(tractions, moved)
    potential, spread = EdgeField.of(edges, equations.kolosov, u_x + 1j * u_y, t_x + 1j * t_y, True).inside(z)
    found = 2.0 * potential.real + direction[:, None] ** 2 * spread
    normal, tangential = found[:, : z.size], found[:, z.size :]
    return 0.5 * (normal - 1j * tangential), 0.5 * (normal + 1j * tangential)


def dislocation(
    z: np.ndarray, z0: np.ndarray, gamma: np.ndarray, mouth: np.ndarray, kolosov: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phi, S and 2G u at points z of dislocations at z0 beside the hole in the infinite plate; (T60).

    The displacement jumps on the line from the dislocation to the mouth of its crack only.
    """
    back, square, conj = z0.conj(), np.abs(z0) ** 2, gamma.conj()
    q, w = square - 1.0, 1.0 - z * back

    def potential_at(at: np.ndarray) -> np.ndarray:
        w = 1.0 - at * back
        return np.asarray(gamma / (at - z0) + gamma * back / w + conj * q / (back * w * w))

    potential = potential_at(z)
    slope = -gamma / (z - z0) ** 2 + gamma * (back / w) ** 2 + 2.0 * conj * q / w**3
    psi = (potential_at(1.0 / z.conj()).conj() + potential) / z**2 - slope / z
    turns = np.log((z - z0) / (z - mouth)) + np.log((z - mouth) / (z - 1.0 / back))
    phi = gamma * turns + conj * q / (back**2 * w)
    mirrored = gamma * (np.log(square) - turns.conj()) + conj * q / (back**2 * (1.0 - back / z.conj()))
    return potential, z.conj() * slope + psi, kolosov * phi + mirrored - (z - 1.0 / z.conj()) * potential.conj()

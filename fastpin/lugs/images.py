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
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from fastpin.bodies.compliance import Compliance
from fastpin.lugs.cauchy import EdgeField, traction_on
from fastpin.lugs.fields import lug_of
from fastpin.lugs.mouths import Mouth
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

SKIPPED, SHARE = 1e-9, 0.1
"""Length of a line at its mouth that is no part of its edge, hole radii, and part of it that its edge may come near."""

BESIDE = 0.1
"""Least distance of a tip from edges beside its line, in parts of its length. With less, K has errors above 1e-4."""

Ray = tuple[float, float]
"""Angle of the mouth of a crack and its direction from the radius, rad."""


@dataclass(frozen=True)
class OtherEdges:
    """The edges beyond the one at which cracks begin: beyond the hole, or beyond the edge with a :class:`Mouth`.

    Lines of cracks are triples: angle of the mouth and direction from the radius, rad, and the length. Lengths are in
    radii of the hole, or of the circle of the mouth, whose angle is 0 then.
    """

    body: Compliance
    mouth: Mouth | None = None

    is_round: ClassVar[bool] = False

    def at(self, place: complex, length: Callable[[float], str]) -> OtherEdges:
        """The edges beyond the one at a place, hole radii. See :meth:`Mouth.at`."""
        return OtherEdges(self.body, Mouth.at(lug_of(self.body), place, length))

    def line(self, theta: float, angle: float) -> Ray:
        """Angle of the mouth and direction from the radius of a crack; at a mouth `angle` counts from its normal."""
        return (theta, angle) if self.mouth is None else (0.0, self.mouth.turn + angle)

    @property
    def radius(self) -> float:
        """Radius of the circle at which cracks begin, hole radii."""
        return 1.0 if self.mouth is None else self.mouth.radius

    def start(self, mouth: float, angle: float) -> tuple[complex, complex]:
        """The mouth of a crack and its direction, hole radii."""
        if self.mouth is None:
            return cmath.exp(1j * mouth), cmath.exp(1j * (mouth + angle))
        return self.mouth.place, self.mouth.normal * cmath.exp(1j * angle)

    def ligament(self, mouth: float, angle: float) -> float:
        """Length of the line of a crack to the edge at which it leaves the plate."""
        return _ligament(self, mouth, angle) / self.radius

    def known(self, mouth: float, angle: float) -> float:
        """Length of the line up to which its mirror image lies outside of the plate, and K is known."""
        return _known(self, mouth, angle) / self.radius

    def deepest(self, lines: Sequence[tuple[float, float, float]]) -> float:
        """The largest part of its ligament that a crack takes."""
        return max(length / self.known(mouth, angle) for mouth, angle, length in lines)

    def influence(
        self, lines: Sequence[tuple[float, float, float]], s: np.ndarray, t: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The coefficients of g and of conj(g) in the tractions at distances s of dislocations at distances t.

        Both distances have the shape (cracks, p), both coefficients (cracks p, cracks p).
        """
        rays = tuple((mouth, angle) for mouth, angle, _ in lines)
        part = SHALLOW if self.deepest(lines) <= SHALLOW else DEEP
        ends = np.array([part * self.known(*ray) for ray in rays])[:, None]
        kept = _kept(self, rays, part)
        left, right = (_interpolation(distances / ends, kept[0].shape[0] // len(rays)) for distances in (s, t))
        straight, mirrored = (self.radius * (left @ one @ right.T) for one in kept)
        return straight, mirrored


def _count(nodes: np.ndarray, lines: Sequence[Part]) -> int:
    """Number of points of each line at which images in edges with these nodes are kept.

    Images lie about twice as far from a line as the edges, and limit the interpolation by Bernstein's ellipse through
    them. In a wide plate the hole is small for its lines.
    """
    least = math.inf
    for line in lines:
        place = 2.0 * (nodes - line.start) / (line.end - line.start) - 1.0
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
def _ligament(edges: OtherEdges, mouth: float, angle: float) -> float:
    lug, (start, along) = lug_of(edges.body), edges.start(mouth, angle)
    parts, skipped = lug.edges, 0.0
    if edges.mouth is not None:  # the edge itself is left out
        parts, skipped = (*parts, *lug.contact_edge), SKIPPED
    start = (start + skipped * along) * lug.hole_radius
    return skipped + min(part.crossing(start, along) for part in parts) / lug.hole_radius


@lru_cache(maxsize=1024)
def _known(edges: OtherEdges, mouth: float, angle: float) -> float:
    ligament, begins = _ligament(edges, mouth, angle), edges.mouth
    if begins is None:
        return ligament
    lug, (start, along) = lug_of(edges.body), edges.start(mouth, angle)
    lengths = ligament * np.linspace(0.0, 1.0, 201)[1:]
    line = start + lengths * along
    mirrored = lug.surrounds(begins.mirrored(line) * lug.hole_radius)
    if not begins.is_inside:  # the potentials have a pole at the centre of the circle, too
        mirrored |= lug.surrounds((start - begins.radius * begins.normal) * lug.hole_radius * np.ones(1))
    away = np.min([distances(part, line) for part in _other_parts(edges)], axis=0)
    bad = np.flatnonzero(mirrored | (away < BESIDE * np.minimum(lengths, ligament - lengths)))
    return float(lengths[bad[0] - 1] if bad.size and bad[0] else lengths[0] if bad.size else ligament)


def _other_parts(edges: OtherEdges) -> list[Part]:
    """All parts that do not lie on the circle of the mouth, hole radii."""
    lug = lug_of(edges.body)
    parts = [part.scaled(1.0 / lug.hole_radius) for part in (*lug.edges, *lug.contact_edge)]
    extent, middle = lug.extent / lug.hole_radius, np.array([0.5])
    return [part for part in parts if edges.mouth is None or not edges.mouth.follows(part.at(middle), extent)[0]]


@lru_cache(maxsize=1)
def _shared(body: Compliance) -> PlateEquations:
    """The equations on edges for all cracks up to :data:`SHALLOW` of their ligaments."""
    lug = lug_of(body)
    hole = [part.scaled(1.0 / lug.hole_radius) for part in lug.contact_edge]
    return _equations(body, [(part, APART * (1.0 - SHALLOW)) for part in hole])


def _equations(body: Compliance, beside: Sequence[tuple[Part, float]], to_hole: bool = False) -> PlateEquations:
    """The equations on edges with lines beside them, also beside the hole if a line leads to it."""
    lug = lug_of(body)
    first, *others = (replace(loop, beside=tuple(beside)) for loop in boundaries(lug, HARMONICS))
    edges = Edges([first if to_hole else replace(first, beside=()), *others], FINENESS)
    return PlateEquations(lug, edges, lambda done: None)


def is_fine(edges: Edges, lines: Sequence[Part]) -> bool:
    """Whether no panel is too long for its distance from the lines of cracks."""
    panels = np.flatnonzero(edges.part >= edges.of_hole)
    points, _ = edges.at(panels[:, None], np.linspace(-1.0, 1.0, 7))
    away = np.array([distances(line, points.ravel()).reshape(points.shape).min(axis=1) for line in lines])
    return bool(np.all(2.0 * edges.half[panels] <= 1.25 * APART * away))


@lru_cache(maxsize=256)
def _kept(other: OtherEdges, rays: tuple[Ray, ...], part: float) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients between the kept points of all lines."""
    longest = np.array([part * _known(other, *ray) for ray in rays])
    starts, along = (np.array(each) for each in zip(*(other.start(*ray) for ray in rays), strict=True))
    ends = [Part("", *pair) for pair in zip(starts.tolist(), (starts + longest * along).tolist(), strict=True)]
    equations = _equations_beside(other, ends)
    nodes = equations.edges.z[equations.edges.is_further]
    if other.mouth is not None:
        nodes = equations.edges.z[~other.mouth.follows(equations.edges.z, equations.edges.extent)]
    count = _count(nodes, ends)
    s = np.multiply.outer(longest, _chebyshev(count)).ravel()
    starts, along = np.repeat(starts, count), np.repeat(along, count)
    return image(equations, starts + s * along, along, starts, other.mouth)


def _equations_beside(other: OtherEdges, lines: Sequence[Part]) -> PlateEquations:
    """The equations on edges whose panels are short beside lines of cracks. They do not shrink towards a mouth."""
    if other.mouth is None:
        shared = _shared(other.body)
        return shared if is_fine(shared.edges, lines) else _equations(other.body, [(line, APART) for line in lines])
    (line,) = lines
    away = min(float(distances(part, np.array([line.start]))[0]) for part in _other_parts(other))
    share = min(SHARE, 0.5 * away / line.length)
    inner = Part("", line.start + share * (line.end - line.start), line.end)
    return _equations(other.body, [(inner, APART)], True)


def image(
    equations: PlateEquations,
    z: np.ndarray,
    direction: np.ndarray,
    place: np.ndarray,
    mouth: Mouth | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients of g and of conj(g) in the tractions of images, both (m, m).

    Points z (m,) are sources and receivers. They lie on lines with a `direction` from a `place`, both (m,): on the
    hole, or at the `mouth`.
    """
    edges = equations.edges
    if mouth is None:
        others, normal, radius, is_inside = edges.is_further, place, 1.0, False
    else:
        others = ~mouth.follows(edges.z, edges.extent)
        normal, radius, is_inside = np.full(z.size, mouth.normal), mouth.radius, mouth.is_inside
    tractions = np.zeros((edges.z.size, 2 * z.size), dtype=complex)
    moved = np.zeros_like(tractions)
    along = 1j * edges.normals[others][:, None]
    away = (edges.z[others][:, None] - place) / radius
    for k, g in enumerate((1.0, 1j)):
        columns = slice(k * z.size, (k + 1) * z.size)
        potential, spread, displacement = dislocation(
            away, (z - place) / radius, 0.5 * np.conj(g) * direction, normal, equations.kolosov, is_inside
        )
        tractions[others, columns] = -traction_on(potential, spread, along) / radius
        moved[others, columns] = -displacement
    (u_x, u_y), (t_x, t_y) = equations.solve(tractions, moved)
    field = EdgeField.of(edges, equations.kolosov, u_x + 1j * u_y, t_x + 1j * t_y, True)
    potential, spread = field.at(z)
    found = 2.0 * potential.real + direction[:, None] ** 2 * spread
    normal, tangential = found[:, : z.size], found[:, z.size :]
    return 0.5 * (normal - 1j * tangential), 0.5 * (normal + 1j * tangential)


def dislocation(
    away: np.ndarray, source: np.ndarray, gamma: np.ndarray, mouth: np.ndarray, kolosov: float, is_inside: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phi, S and 2G u of dislocations beside the free unit circle, outside of it or inside; (T60).

    Points and dislocations have the distances `away` and `source` from the place `mouth` on the circle. The
    displacement jumps on the line from the dislocation to the mouth only.
    """
    z, z0 = mouth + away, mouth + source
    back, conj, gap = z0.conj(), gamma.conj(), away - source
    Q, q = (2.0 * (mouth.conj() * each).real + np.abs(each) ** 2 for each in (away, source))
    w = -(away * mouth.conj() + mouth * source.conj() + away * source.conj())
    potential = gamma / gap + gamma * back / w + conj * q / (back * w * w)
    inverted = gamma / w.conj() + gamma * back / gap.conj() + conj * q * z.conj() / (back * gap.conj() ** 2)
    slope = -gamma / gap**2 + gamma * (back / w) ** 2 + 2.0 * conj * q / w**3
    spread = Q / z * slope + inverted.conj() / z + potential / z**2
    turns = np.log(gap / away) + np.log(-away * back / w)
    phi = gamma * turns + conj * q / (back**2 * w)
    mirrored = gamma * (np.log1p(q) - turns.conj()) + conj * q * z.conj() / (back**2 * gap.conj())
    moved = kolosov * phi + mirrored - Q / z.conj() * potential.conj()
    if is_inside:  # a stress that makes the centre regular
        even = -q * (gamma / z0).real
        potential, spread = potential + even, spread + 2.0 * even / z**2
        moved = moved + even * ((kolosov - 1.0) * z + 2.0 / z.conj())
    return potential, spread, moved

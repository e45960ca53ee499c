"""Boundary integrals of plane elasticity over the edges of a plate: panels, kernels, quadrature.

Edges are cut into straight and circular panels with Gauss-Legendre nodes. Panels shrink by halves towards corners and
towards other edges. On a closed edge with the plate to the left, Somigliana's identity reads

    u(x)/2 + int T(x, y) u(y) ds = int U(x, y) t(y) ds

at a smooth point x. U and T are Kelvin's displacement and traction. A node takes each panel near it in subintervals no
longer than two thirds of their distance, so that no singular quadrature is needed. Lengths are in hole radii,
displacements u stand for 2G u.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.lugs import quadrature
from fastpin.lugs.outline import Part, distances, turn_between
from fastpin.model.checks import as_toml

MOST_NODES = 4000
"""Most nodes of all edges. The two matrices then take one gigabyte."""

TOUCHING = 1e-8
"""Largest distance of the ends of two parts that meet, in hole radii."""

LEAST_TURN = 0.15
"""Least turn of the outline at a corner, rad. Panels do not shrink towards smaller ones."""


class Fineness(NamedTuple):
    """How finely edges are cut: nodes of a panel, and halvings of a part towards a corner."""

    points: int
    halvings: int


@dataclass(frozen=True)
class Boundary:
    """A closed edge: its parts in order, the plate to the left.

    Attributes
    ----------
    parts : tuple of Part
        In hole radii.
    marks : tuple of tuple
        The support and the loads of each part.
    free : tuple of bool
        Whether each part has no support.
    turn : float
        Largest angle of a circular panel, rad. Ten nodes resolve the default to 1e-12.
    beside : tuple of (Part, float)
        Lines in the plate, such as cracks, and the longest panel in parts of its distance from each.
    """

    parts: tuple[Part, ...]
    marks: tuple[tuple[str | None, tuple[int, ...]], ...]
    free: tuple[bool, ...]
    turn: float = math.pi / 4 * (1.0 + 1e-9)
    beside: tuple[tuple[Part, float], ...] = ()

    def halvings(self, place: int, most: int) -> int:
        """Halvings towards the start of the part at `place`: none where the edge goes on as it is.

        The stress is singular where a support or load changes, and at held corners. It vanishes at free convex corners:
        with 16 halvings elsewhere, 5 of them leave 4e-10 of the matrix there, and 1e-8 of the stress near by. At a
        re-entrant corner it is the more singular the more the outline turns: 8, 10 and 15 halvings at 20, 45 and 90 deg
        leave 1e-8 of the matrix. Where the outline turns by a small angle, as in a polyline, none leave 3e-7. None are
        needed at the square ends of a straight edge that slides: it mirrors the plate, and the edge goes on beyond it.
        """
        before, after, turn = self.parts[place - 1], self.parts[place], self._turn(place)
        if abs(turn - math.pi / 2) < 1e-6 and self._is_mirrored(place):
            return 0
        is_corner, is_free = abs(turn) > 1e-6, self.free[place - 1] and self.free[place]
        if self.marks[place - 1] != self.marks[place] or (is_corner and not is_free):
            return most
        if is_corner:
            share = 0.0 if abs(turn) <= LEAST_TURN else min(5.0 + 6.0 * max(-turn, 0.0), 16.0) / 16.0
            return math.ceil(most * share)
        if before.circle is None or after.circle is None:
            same = before.circle is after.circle
        else:
            same = abs(before.circle[0] - after.circle[0]) < TOUCHING
        return 0 if same else most // 2  # a jump of the curvature is a weak singularity

    def is_singular(self, place: int) -> bool:
        """Whether the stress is infinite at the start of the part: at re-entrant corners and ends of supports.

        A square corner between a free edge and one without friction is half of a straight free edge.
        """
        turn, same = self._turn(place), self.free[place - 1] == self.free[place]
        slides = "both" not in (self.marks[place - 1][0], self.marks[place][0])
        return turn < -LEAST_TURN or not (same or (turn > math.pi / 2 - 1e-6 and slides))

    def _is_mirrored(self, place: int) -> bool:
        """Whether one or both parts at a corner are straight and slide, and the other one is free of loads."""
        both = [(self.parts[k], *self.marks[k]) for k in (place - 1, place)]
        held = [(part, part.end - part.start, hold) for part, hold, _ in both if hold is not None]
        slide = [
            part.circle is None
            and (hold == "normal" or (hold != "both" and min(abs(along.real), abs(along.imag)) < TOUCHING))
            for part, along, hold in held
        ]
        return bool(held) and all(slide) and not any(loads for *_, loads in both)

    def _turn(self, place: int) -> float:
        """Angle by which the edge turns at the start of the part, rad; negative at re-entrant corners."""
        return turn_between(self.parts[place - 1], self.parts[place])


class Edges:
    """Panels and nodes of all edges.

    Attributes
    ----------
    parts : list of Part
        All parts, in the order of the loops.
    of_hole : int
        Number of the parts of the first loop, the edge of the pin's hole.
    part : ndarray of int, shape (panels,)
        The part of each panel.
    share, width : ndarray, shape (panels,)
        Middle and length of each panel, in parts of the length of its part.
    z, normals : ndarray of complex, shape (nodes,)
        Nodes, and outward unit normals.
    weights : ndarray, shape (nodes,)
        Lengths that belong to the nodes.

    Raises
    ------
    InputError
        If more than :data:`MOST_NODES` nodes are needed.
    """

    def __init__(self, loops: Sequence[Boundary], fineness: Fineness) -> None:
        self.parts, self.of_hole = [part for loop in loops for part in loop.parts], len(loops[0].parts)
        self.points = fineness.points
        panels = _panels(loops, self.parts, fineness)
        part, self.share, self.width = np.array(panels).T
        share, width = self.share, self.width
        self.part = part.astype(int)
        circles = [each.circle or (0j, 0.0, 0.0, 0.0) for each in self.parts]
        centre, radius, first, sweep = (np.array(values)[self.part] for values in zip(*circles, strict=True))
        self.is_straight = np.array([each.circle is None for each in self.parts])[self.part]
        start, end = (np.array([getattr(each, key) for each in self.parts])[self.part] for key in ("start", "end"))
        self._origin = np.where(self.is_straight, start + (end - start) * share, centre)
        self._span = np.where(self.is_straight, 0.5 * width * (end - start), radius)
        self._angle, self._turn = first + sweep * share, 0.5 * width * sweep
        self.half = np.abs(self._span) * np.where(self.is_straight, 1.0, np.abs(self._turn))
        self.panel = np.repeat(np.arange(self.part.size), self.points)
        gauss, weights = self.rule
        self.z, along = self.at(self.panel, np.tile(gauss, self.part.size))
        self.normals = -1j * along
        self.weights = np.tile(weights, self.part.size) * self.half[self.panel]

    @cached_property
    def rule(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodes and weights on [-1, 1]."""
        gauss, weights = np.polynomial.legendre.leggauss(self.points)
        return gauss, weights

    @property
    def part_of_node(self) -> np.ndarray:
        """The part of each node."""
        return self.part[self.panel]

    @property
    def is_further(self) -> np.ndarray:
        """Whether each node lies beyond the edge of the pin's hole."""
        return self.part_of_node >= self.of_hole

    @property
    def extent(self) -> float:
        """Largest distance of a node from the hole's centre."""
        return float(np.abs(self.z).max())

    @property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """First and last points of the panels."""
        places, one = np.arange(self.part.size), np.ones(self.part.size)
        return self.at(places, -one)[0], self.at(places, one)[0]

    def at(self, panel: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points and unit tangents of panels at s from -1 to 1."""
        straight, origin, span = self.is_straight[panel], self._origin[panel], self._span[panel]
        ray = np.exp(1j * (self._angle[panel] + self._turn[panel] * s))
        along = np.where(straight, span / np.abs(span), 1j * np.sign(self._turn[panel]) * ray)
        return origin + span * np.where(straight, s, ray), along

    def nearest(self, z: np.ndarray, panels: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The nearest of some panels, its s there, and the distance of points z (m,), each (m,)."""
        away, turn = (z[:, None] - self._origin[panels]) / self._span[panels], self._turn[panels]
        turned = np.angle(away * np.exp(-1j * self._angle[panels])) / np.where(turn == 0.0, 1.0, turn)
        s = np.clip(np.where(self.is_straight[panels], away.real, turned), -1.0, 1.0)
        distance = np.abs(self.at(panels, s)[0] - z[:, None])
        rows, best = np.arange(z.size), np.argmin(distance, axis=1)
        return panels[best], s[rows, best], distance[rows, best]

    @cached_property
    def derivative(self) -> np.ndarray:
        """Slopes at the nodes of a panel from values there, for s from -1 to 1, shape (points, points)."""
        legendre = np.polynomial.legendre
        slopes = [legendre.legval(self.rule[0], legendre.legder(one)) for one in np.eye(self.points)]
        found: np.ndarray = np.stack(slopes, axis=1) @ np.linalg.inv(legendre.legvander(self.rule[0], self.points - 1))
        return found

    def lagrange(self, s: np.ndarray) -> np.ndarray:
        """The polynomials that are 1 at one node of a panel and 0 at the others, at s; shape (..., points)."""
        return np.asarray(np.polynomial.legendre.legvander(s, self.points - 1) @ self.polynomials)

    @cached_property
    def polynomials(self) -> np.ndarray:
        """The polynomials of :meth:`lagrange` as sums of Legendre polynomials: factors, in columns."""
        return np.linalg.inv(np.polynomial.legendre.legvander(self.rule[0], self.points - 1))

    @property
    def geometry(self) -> tuple[np.ndarray, ...]:
        """What :func:`fastpin.lugs.quadrature.over_panels` knows of panels: shape, origin, span, angle, turn, half."""
        return self.is_straight, self._origin, self._span, self._angle, self._turn, self.half


def _panels(loops: Sequence[Boundary], parts: list[Part], fineness: Fineness) -> list[tuple[int, float, float]]:
    """Part, middle and width (in shares of the part's length) of each panel."""
    found: list[tuple[int, float, float]] = []
    for loop in loops:
        for place in range(len(loop.parts)):
            halvings = loop.halvings(place, fineness.halvings)
            following = loop.halvings((place + 1) % len(loop.parts), fineness.halvings)
            for low, high in _cuts(parts, loop, place, (halvings, following)):
                found.append((parts.index(loop.parts[place]), 0.5 * (low + high), high - low))
                if len(found) * fineness.points > MOST_NODES:
                    names = Counter(parts[each].name or "the pin's hole" for each, _, _ in found)
                    name, most = names.most_common(1)[0]
                    raise InputError(
                        "outline",
                        f"needs more than {MOST_NODES} nodes; {as_toml(name)} takes {most * fineness.points} of the "
                        f"first {len(found) * fineness.points}: edges are too near one another, or there are too many "
                        "parts or harmonics. Some 280 sides of a round end fit, 30 convex corners, or 7 steps with a "
                        "re-entrant corner of 90 degrees each",
                    )
    return found


def _cuts(parts: list[Part], loop: Boundary, place: int, halvings: tuple[int, int]) -> list[tuple[float, float]]:
    """Ends of the panels of a loop's part, in shares of its length. None is longer than its distance from others."""
    part = loop.parts[place]
    others = [other for other in parts if other is not part]
    at_start = [min(abs(other.start - part.start), abs(other.end - part.start)) < TOUCHING for other in others]
    at_end = [min(abs(other.start - part.end), abs(other.end - part.end)) < TOUCHING for other in others]
    sweep = abs(part.circle[3]) if part.circle is not None else 0.0
    found: list[tuple[float, float]] = []
    ends_of = np.linspace(0.0, 1.0, max(1, math.ceil(sweep / loop.turn)) + 1).tolist()
    waiting = [(low, high, halvings[0] * (low == 0.0), halvings[1] * (high == 1.0)) for low, high in pairwise(ends_of)]
    while waiting and len(found) < MOST_NODES:
        low, high, left, right = waiting.pop()
        points = part.at(np.linspace(low, high, 7))
        too_long = left > 0 or right > 0
        for line, most in loop.beside:
            too_long = too_long or (high - low) * part.length > most * float(distances(line, points).min())
        for other, starts, ends in zip(others, at_start, at_end, strict=True):
            met = (starts and (low == 0.0 or halvings[0] == 0)) or (ends and (high == 1.0 or halvings[1] == 0))
            if too_long or met:
                continue
            too_long = (high - low) * part.length > 1.01 * float(distances(other, points).min())
        if too_long:
            middle = 0.5 * (low + high)
            waiting += [(low, middle, left - 1, 0), (middle, high, 0, right - 1)]
        else:
            found.append((low, high))
    return found


# -- integrals over panels -------------------------------------------------------------------------------------


def matrices(
    edges: Edges, kolosov: float, scale: float, columns: np.ndarray, progress: Callable[[float], None]
) -> tuple[np.ndarray, np.ndarray]:
    """The matrices of Kelvin's U and T between nodes; T holds u/2 too.

    A rigid motion has no tractions, so that each row of T has the sum 0. It gives the entry of the node itself.

    Parameters
    ----------
    edges : Edges
    kolosov : float
    scale : float
        Unit of distances in the logarithm of U.
    columns : ndarray of int, shape (m,)
        Nodes that U is needed for, in order; all nodes of a panel or none.
    progress : callable
        Called with the part that is done.

    Returns
    -------
    ndarray, shape (2, nodes, 2, m)
    ndarray, shape (2, nodes, 2, nodes)
    """
    count, chunk, near = edges.z.size, 200, 32  # rows, and panels with near nodes, between calls of the progress
    U, T = np.empty((2, count, 2, columns.size)), np.empty((2, count, 2, count))
    place = np.full(count, -1)
    place[columns] = np.arange(columns.size)
    here, nodes_of = np.arange(count), (edges.z, 1j * edges.normals, edges.weights)
    for first in range(0, count, chunk):
        quadrature.between_nodes(here[first : first + chunk], *nodes_of, kolosov, scale, place, U, T)
        progress(0.5 * first / count)
    for first in range(0, edges.part.size, near):
        panels = np.arange(first, min(first + near, edges.part.size))
        rows, nodes, sums = near_integrals(edges, panels, edges.z, kolosov, scale)
        of_both = sums[:, [0, 1, 1, 2, 3, 4, 5, 6]].transpose(0, 2, 1).reshape(*nodes.shape, 2, 2, 2)
        known = place[nodes[:, 0]] >= 0
        U[:, rows[known], :, place[nodes[known]]] = of_both[known, :, 0]
        T[:, rows, :, nodes] = of_both[:, :, 1]
        progress(0.5 + 0.5 * first / edges.part.size)
    T[:, here, :, here] = 0.0
    T[:, here, :, here] = -T.sum(axis=3).transpose(1, 0, 2)
    return U, T


def near_integrals(
    edges: Edges, panels: np.ndarray, points: np.ndarray, kolosov: float = 0.0, scale: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integrals over panels and near points, of kernels times the polynomials of :meth:`Edges.lagrange`.

    Parameters
    ----------
    edges : Edges
    panels : ndarray of int, shape (p,)
    points : ndarray of complex, shape (m,)
    kolosov, scale : float
        Of Kelvin's kernels. Without them the kernels are Cauchy's; see :mod:`fastpin.lugs.quadrature`.

    Returns
    -------
    rows, columns : ndarray of int, shape (pairs, 1) and (pairs, points of a panel)
        The point and the nodes of the panel.
    sums : ndarray, shape (pairs, 7, points of a panel)
    """
    samples, _ = edges.at(panels[:, None], np.linspace(-1.0, 1.0, 9))
    distance = np.abs(points[:, None] - samples[:, None, :]).min(axis=2)
    place, node = np.nonzero(distance < 2.2 * edges.half[panels][:, None])  # within 1.1 lengths of a panel
    pairs = np.stack([panels[place], node], axis=1)
    sums = np.zeros((len(pairs), quadrature.KERNELS, edges.points))
    quadrature.over_panels(points, pairs, *edges.geometry, np.array(edges.rule), kolosov, scale, sums)
    return pairs[:, 1:], pairs[:, :1] * edges.points + np.arange(edges.points), sums @ edges.polynomials

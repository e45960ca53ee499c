"""Piecewise linear tractions on the edge of the hole: their Fourier coefficients and Cauchy integrals, exact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from fastpin.kernels import cauchy
from fastpin.runtime.threads import in_chunks

LEAF = 8
"""Linear pieces in a leaf of the tree of blocks."""

GAUSS = 24
"""Gauss points a piece for the moments. Their integrands go up to the power 28, also where a leaf is one long piece."""

ROUNDING = 1e-11
"""Moment of the shear that is rounding, in parts of the moment of its magnitude."""

CHUNK = 20_000
"""Points that one thread computes at a time."""


@dataclass(frozen=True, eq=False)
class Tractions:
    """Piecewise linear tractions on the edge of the hole.

    Attributes
    ----------
    patches : tuple of ndarray, each of shape (k, 3)
        Angle in rad, increasing; pressure N; shear T. At the ends of a patch both are zero. A patch all round ends with
        its first node, a whole turn further.
    """

    patches: tuple[np.ndarray, ...]

    @property
    def all_round(self) -> bool:
        """Whether the only patch goes round the whole hole."""
        return len(self.patches) == 1 and self.patches[0][-1, 0] - self.patches[0][0, 0] > 2.0 * math.pi - 1e-9

    @property
    def has_moment(self) -> bool:
        """Whether the shear has a moment beyond rounding."""
        whole = sum(float(np.trapezoid(patch[:, 2], patch[:, 0])) for patch in self.patches)
        size = sum(float(np.trapezoid(np.abs(patch[:, 2]), patch[:, 0])) for patch in self.patches)
        return abs(whole) > ROUNDING * size

    def coefficients(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Fourier coefficients of N and T, (1/2 pi) int g exp(-i k xi) dxi, for k = 0 to `count`."""
        points, weights = _gauss()
        result = np.zeros((2, count + 1), dtype=complex)
        for patch in self.patches:
            theta, values = patch[:, 0, None], patch[:, 1:, None]
            steps = np.diff(theta, axis=0)
            turn = np.exp(-1j * (theta[:-1] + steps * points))
            power = (values[:-1] + np.diff(values, axis=0) * points) * (steps * weights)[:, None] / (2.0 * math.pi)
            for k in range(count + 1):
                result[:, k] += power.sum(axis=(0, 2))
                power = power * turn[:, None]
        return result[0], result[1]

    @cached_property
    def low_coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        """The first two coefficients of N and T, which give the force and the moment."""
        return self.coefficients(1)

    @cached_property
    def tree(self) -> Tree:
        """The blocks of the linear pieces, for fast sums."""
        return Tree.of(self)


@dataclass(frozen=True, eq=False)
class RefinedTractions:
    """Tractions with power laws at contact edges and stick-slip borders, see :mod:`fastpin.reading.refined`.

    Attributes
    ----------
    tractions : Tractions
        With the moment of the nodal tractions. Their force differs by about 5e-5 with 401 nodes.
    resolved, unresolved : tuple of float
        Angles, rad, of the edges and borders with power laws, and of those where straight lines remain.
    """

    tractions: Tractions
    resolved: tuple[float, ...]
    unresolved: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Tree:
    """Blocks of linear pieces with the moments of their tractions, see :mod:`fastpin.kernels.cauchy`."""

    nodes: np.ndarray
    turn: int
    blocks: np.ndarray
    centres: np.ndarray
    radii: np.ndarray
    moments: np.ndarray

    @classmethod
    def of(cls, tractions: Tractions) -> Tree:
        """Build the tree: leaves of :data:`LEAF` pieces, then pairs of neighbours, up to one root."""
        patches = tractions.patches
        if not patches:
            return cls(
                np.zeros((0, 3)), 0, np.zeros((0, 4), np.int64), np.zeros(0, complex), np.zeros(0),
                np.zeros((0, 2, cauchy.TERMS), complex),
            )  # fmt: skip
        nodes = np.concatenate(patches)
        turn = len(nodes) - 1 if tractions.all_round else 0
        leaves, begin = [], 0
        for patch in patches:
            last = begin + len(patch) - 1
            leaves += [(first, min(first + LEAF, last)) for first in range(begin, last, LEAF)]
            begin = last + 1
        blocks = [(first, last, -1, -1) for first, last in leaves]
        places = np.exp(1j * nodes[:, 0])
        spans = [places[first : last + 1] for first, last in leaves]
        centres = [0.5 * (span[0] + span[-1]) for span in spans]
        radii = [float(np.abs(span - centre).max()) for span, centre in zip(spans, centres, strict=True)]
        filled = np.zeros((len(leaves), 2, cauchy.TERMS), dtype=complex)
        cauchy.moments(nodes, np.array(leaves), np.array(centres), *_gauss(), filled)
        all_moments = list(filled)
        binomials = _binomials()
        level = list(range(len(leaves)))
        while len(level) > 1:
            level = [
                _joined(level[k : k + 2], blocks, centres, radii, all_moments, binomials)
                for k in range(0, len(level), 2)
            ]
        if turn:
            nodes = np.concatenate([nodes[:-1], nodes + np.array([2.0 * math.pi, 0.0, 0.0])])
        return cls(nodes, turn, np.array(blocks), np.array(centres), np.array(radii), np.array(all_moments))


@cache
def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights on (0, 1)."""
    points, weights = np.polynomial.legendre.leggauss(GAUSS)
    return 0.5 * (points + 1.0), 0.5 * weights


@cache
def _binomials() -> np.ndarray:
    """Binomial coefficients m over k of the moments, shape (TERMS, TERMS)."""
    return np.array([[float(math.comb(m, k)) for k in range(cauchy.TERMS)] for m in range(cauchy.TERMS)])


def _joined(
    pair: list[int], blocks: list[tuple[int, int, int, int]], centres: list[complex], radii: list[float],
    all_moments: list[np.ndarray], binomials: np.ndarray,
) -> int:  # fmt: skip
    """Append the block that joins two neighbours, and return its place. A single block is returned as it is."""
    if len(pair) == 1:
        return pair[0]
    one, two = pair
    centre = 0.5 * (centres[one] + centres[two])
    moments = np.zeros_like(all_moments[0])
    for child in pair:
        cauchy.shift_moments(all_moments[child], centres[child] - centre, binomials, moments)
    blocks.append((blocks[one][0], blocks[two][1], one, two))
    centres.append(centre)
    radii.append(max(abs(centres[child] - centre) + radii[child] for child in pair))
    all_moments.append(moments)
    return len(blocks) - 1


def cauchy_integrals(tractions: Tractions, theta: np.ndarray, away: np.ndarray, outside: bool) -> np.ndarray:
    """C[p], C[T] and Z at points, shape (m, 3); see :mod:`fastpin.kernels.cauchy`.

    Parameters
    ----------
    tractions : Tractions
    theta, away : ndarray, shape (m,)
        Angles of the points, rad, and \\|ln(r/R)\\|.
    outside : bool
        Whether the points lie in the plate.
    """
    out, tree = np.empty((theta.size, 3), dtype=complex), tractions.tree
    given = tree.nodes, tree.turn, tree.blocks, tree.centres, tree.radii, tree.moments

    def compute(part: slice) -> None:
        cauchy.cauchy(theta[part], away[part], outside, *given, out[part])

    in_chunks(theta.size, CHUNK, compute)
    return out

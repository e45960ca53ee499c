"""Piecewise linear tractions on the edge of the hole: their Fourier coefficients and Cauchy integrals, exact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from fastpin.kernels import cauchy, conjugate
from fastpin.runtime.threads import in_chunks

GAUSS = 24
"""Gauss points a piece for the moments. Their integrands go up to the power 28, also where a leaf is one long piece."""

RULES = {3: 0.016, 4: 0.08, 5: 0.19, 6: 0.35, 8: 0.7, 12: 1.4, 16: 2.0}
"""Gauss points of a piece for the moments on the edge, and its length in parts of the half width of its block up to
which their error is rounding."""

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
        return abs(whole) > 1e-11 * size

    def coefficients(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Fourier coefficients of N and T, (1/2 pi) int g exp(-i k xi) dxi, for k = 0 to `count`."""
        result = np.zeros((2, count + 1), dtype=complex)
        for patch in self.patches:
            theta, values = patch[:, 0, None], patch[:, 1:, None]
            steps = np.diff(theta, axis=0)
            # For two coefficients of pieces up to 0.15 rad the error of 4 points is rounding.
            points, weights = _gauss(GAUSS if count > 1 or steps.max() > 0.15 else 4)
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
    def tree(self) -> tuple[np.ndarray | int, ...]:
        """The blocks of the linear pieces with their moments, for :func:`fastpin.kernels.cauchy.cauchy`.

        They are leaves of 8 pieces, then pairs of neighbours, up to one root.
        """
        if not self.patches:
            moments = np.zeros((0, 2, cauchy.TERMS), complex)
            return np.zeros((0, 3)), 0, np.zeros((0, 4), np.int64), np.zeros(0, complex), np.zeros(0), moments
        nodes, leaves = np.concatenate(self.patches), _leaves(self.patches, 8)
        turn, count = len(nodes) - 1 if self.all_round else 0, 2 * len(leaves) - 1
        blocks = np.full((count, 4), -1)
        blocks[: len(leaves), :2] = leaves
        centres, radii = np.empty(count, dtype=complex), np.empty(count)
        moments = np.zeros((count, 2, cauchy.TERMS), dtype=complex)
        cauchy.grow(nodes, len(leaves), *_gauss(), _binomials(), blocks, centres, radii, moments)
        if turn:
            nodes = np.concatenate([nodes[:-1], nodes + np.array([2.0 * math.pi, 0.0, 0.0])])
        return nodes, turn, blocks, centres, radii, moments

    @cached_property
    def _edge_blocks(self) -> tuple[np.ndarray | int, ...]:
        """The blocks of the linear pieces for points on the edge, for :func:`fastpin.kernels.conjugate.edge`."""
        nodes = np.concatenate([np.zeros((0, 3)), *self.patches])
        # A point visits all blocks. With the root of the number of pieces, it visits about as many pieces.
        blocks = _leaves(self.patches, max(7, math.isqrt(len(nodes)) // 3))
        centres, moments = np.empty((len(blocks), 4)), np.zeros((len(blocks), conjugate.TERMS))
        conjugate.gather(nodes, blocks, *_rules(), centres, moments)
        return nodes, len(nodes) - 1 if self.all_round else -1, blocks, centres, moments

    def on_edge(self, theta: np.ndarray, *field: float) -> np.ndarray:
        """Stresses (srr, stt, srt) at angles (m,) on the edge, shape (3, m).

        `field` has the parts of the hoop stress, see :func:`fastpin.kernels.conjugate.edge`.
        """
        out = np.empty((3, theta.size))
        conjugate.edge(np.array(theta), np.array(field), *self._edge_blocks, out)
        return out

    @cached_property
    def force(self) -> complex:
        """int (N - iT) exp(i xi) dxi."""
        pressure, shear = self.low_coefficients
        return complex(2.0 * math.pi * np.conj(pressure[1] + 1j * shear[1]))


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


def _leaves(patches: Sequence[np.ndarray], size: int) -> np.ndarray:
    """First and last node of leaves of up to `size` pieces, int, shape (l, 2). Nodes count through all patches."""
    leaves, begin = [], 0
    for patch in patches:
        last = begin + len(patch) - 1
        leaves += [(first, min(first + size, last)) for first in range(begin, last, size)]
        begin = last + 1
    return np.array(leaves, dtype=np.int64).reshape(-1, 2)


@cache
def _gauss(count: int = GAUSS) -> tuple[np.ndarray, np.ndarray]:
    """So many Gauss points and weights on (0, 1)."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


@cache
def _rules() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The rules of Gauss on (0, 1), see :func:`fastpin.kernels.conjugate.gather`."""
    points, weights = np.zeros((2, len(RULES), max(RULES)))
    for rule, count in enumerate(RULES):
        points[rule, :count], weights[rule, :count] = _gauss(count)
    return np.array(list(RULES.values())), points, weights


@cache
def _binomials() -> np.ndarray:
    """Binomial coefficients m over k of the moments, shape (TERMS, TERMS)."""
    return np.array([[float(math.comb(m, k)) for k in range(cauchy.TERMS)] for m in range(cauchy.TERMS)])


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

    def compute(part: slice) -> None:
        cauchy.cauchy(theta[part], away[part], outside, *tree, out[part])

    in_chunks(theta.size, CHUNK, compute)
    return out

"""The inverse of the operator at neighbouring, equally spaced nodes, and the responses of all other nodes.

The operator is block Toeplitz there, so the inverse takes O(n^2) operations (:mod:`fastpin.kernels.toeplitz`). In a
laminate it is block Toeplitz for tractions along fixed axes, (T51): those in which Lambda is diagonal. The expansion of
the pin under a uniform pressure is then an update of rank one, by the formula of Sherman and Morrison.
"""

from __future__ import annotations

import cmath
from functools import cached_property

import numpy as np

from fastpin.elasticity.operator import uniform_part
from fastpin.elasticity.system import System
from fastpin.kernels import toeplitz


class Neighbours:
    """Neighbouring nodes of a system whose operator is block Toeplitz.

    Rows and columns of all matrices belong to the pressures or gaps of the nodes first, then to their shears or slips.

    Parameters
    ----------
    system : System
    low, count : int
        The first of the nodes, and their number m.

    Attributes
    ----------
    core : ndarray, shape (2m, 2m)
        The inverse of the operator at these nodes. It is symmetric.
    """

    def __init__(self, system: System, low: int, count: int) -> None:
        self._low = low
        self._entries = self._entries_by_distance(system)
        self._inverse = toeplitz.inverse(*self._entries[:, :count])
        self.core = self._inverse

    @staticmethod
    def of(system: System, low: int, count: int) -> Neighbours:
        """The neighbours for any system whose ``is_toeplitz`` is true."""
        anisotropy = None if system.bodies is None else system.bodies.anisotropy
        return TurnedNeighbours(system, low, count, anisotropy) if anisotropy else Neighbours(system, low, count)

    def responses(self) -> np.ndarray:
        """The inverse times the columns of all n-m other nodes, shape (2m, 2(n-m)).

        At the ends of an arc the hats are halves, but the columns are computed for whole hats: these nodes never close.
        """
        return self._beside.responses()

    def complement(self) -> np.ndarray:
        """Gap and slip of the others for unit tractions on them, while these nodes are held; (2(n-m), 2(n-m))."""
        return self._beside.complement()

    @cached_property
    def _beside(self) -> toeplitz.NeighbourResponses:
        return toeplitz.NeighbourResponses(self._entries, self._inverse, self._low)

    def _entries_by_distance(self, system: System) -> np.ndarray:
        """Entries of the block Toeplitz matrix by the distance of two nodes, shape (3, n).

        The rows are gap of N, slip of T and gap of T. The largest distance of an arc is not needed, and 0.
        """
        return system.entries_by_distance[:, :-1]


class TurnedNeighbours(Neighbours):
    """The neighbours in a laminate: block Toeplitz along fixed axes, up to the expansion of the pin.

    `anisotropy` is that of the system's :class:`fastpin.elasticity.terms.BodyTerms`.
    """

    def __init__(self, system: System, low: int, count: int, anisotropy: complex) -> None:
        axes = 0.5 * cmath.phase(anisotropy)
        turn = np.exp(1j * (system.grid.theta - axes))
        run = np.arange(low, low + count)
        self._turn, self._inside, self._outside = turn, turn[run], np.delete(turn, run)
        spacing = float(system.grid.weights[1])
        self._expansion = -spacing * uniform_part(system.problem) / (4.0 * np.pi)  # gap of a node per pressure
        super().__init__(system, low, count)
        self._plain = _along_rim(self._inverse, self._inside, self._inside)
        self._pressed = self._plain[:, :count].sum(axis=1)
        self._factor = self._expansion / (1.0 + self._expansion * float(self._pressed[:count].sum()))
        self.core = self._plain - self._factor * np.outer(self._pressed, self._pressed)

    def responses(self) -> np.ndarray:
        plain = self._plain_responses
        return plain + self._factor * np.outer(self._pressed, self._left)

    def complement(self) -> np.ndarray:
        plain = _along_rim(super().complement(), self._outside, self._outside)
        return plain + self._factor * np.outer(self._left, self._left)

    @cached_property
    def _plain_responses(self) -> np.ndarray:
        """The responses without the expansion of the pin."""
        return _along_rim(super().responses(), self._inside, self._outside)

    @cached_property
    def _left(self) -> np.ndarray:
        """The pressure of unit tractions on the others that the held nodes do not take, summed; shape (2(n-m),)."""
        left = -self._plain_responses[: self._inside.size].sum(axis=0)
        left[: self._outside.size] += 1.0
        return left

    def _entries_by_distance(self, system: System) -> np.ndarray:
        n, end = system.grid.size, 0 if system.grid.closed else 1
        nodes, entries = np.arange(end, n), np.zeros((3, n))
        rows, columns = np.concatenate([nodes, n + nodes]), np.array([end, n + end])
        found = system.operator.entries(rows, columns)
        found[: nodes.size, 0] -= self._expansion
        along = _along_rim(found, self._turn[nodes].conj(), self._turn[[end]].conj())
        entries[:, : n - end] = along[: nodes.size, 0], along[nodes.size :, 1], along[: nodes.size, 1]
        return entries


def _along_rim(matrix: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """A matrix (2m, 2k) between vectors along fixed axes, for vectors along normal and tangent of the nodes.

    `rows` (m,) and `columns` (k,) are the directions of the normals against the axes, exp(i angle). Their complex
    conjugates turn the other way.
    """
    (m, k), found = (rows.size, columns.size), np.empty_like(matrix)
    cos, sin = rows.real[:, None], rows.imag[:, None]
    turned = np.concatenate([cos * matrix[:m] - sin * matrix[m:], sin * matrix[:m] + cos * matrix[m:]])
    found[:, :k] = turned[:, :k] * columns.real - turned[:, k:] * columns.imag
    found[:, k:] = turned[:, :k] * columns.imag + turned[:, k:] * columns.real
    return found

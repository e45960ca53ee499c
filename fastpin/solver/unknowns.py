"""The linear systems of given statuses, ready to be solved for the unknown tractions and the pin's motion.

N is unknown at closed nodes, and T at sticking nodes. At slipping nodes T = -sigma mu N is eliminated. The equations
are the gaps at the nodes with an unknown N, the slips at the nodes with an unknown T, and those of equilibrium.

At neighbouring, equally spaced nodes that stick (:class:`Neighbours`) the operator is block Toeplitz, so the inverse
takes O(n^2) operations (:mod:`fastpin.kernels.toeplitz`). In a laminate it is block Toeplitz for tractions along fixed
axes, (T51): those in which Lambda is diagonal. The expansion of the pin under a uniform pressure is then an update of
rank one, by the formula of Sherman and Morrison.
"""

from __future__ import annotations

import cmath
from functools import cached_property

import numpy as np

from fastpin.elasticity.operator import uniform_part
from fastpin.elasticity.system import System
from fastpin.kernels import toeplitz
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.extensions import lapack
from fastpin.runtime.products import add_product


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


SINGULAR = 1e-13
"""Smallest reciprocal condition number. A system below it is a mechanism."""

MOST_RESIDUAL = 1e-10
"""Largest residual of a fast inverse. Above it a factorisation takes its place."""

LEAST_NEIGHBOURS = 128
"""Smallest number of nodes for a fast inverse. With fewer nodes a factorisation is as fast."""


FEW_UNKNOWNS = 300
"""With at most so many unknowns a product with their stored columns takes less time than transforms (4,096 nodes)."""


class Unknowns:
    """The unknown tractions of given statuses, and the displacement that they cause in all rows.

    Attributes
    ----------
    status : ndarray of int8, shape (n,)
        The statuses.
    rows : ndarray of int, shape (count,)
        Rows of the unknowns among (N, T). The same rows among (h, s) are their equations.
    normal, tangential : ndarray of int
        Nodes with an unknown N, and nodes with an unknown T.
    count : int
        Number of unknown tractions.
    size : int
        Number of unknowns: the tractions, then the m motions.
    """

    def __init__(self, system: System, status: np.ndarray) -> None:
        n = system.grid.size
        self._system, self.status = system, status.copy()
        self.normal = np.flatnonzero(status != OPEN)
        self.tangential = np.flatnonzero(status == STICK)
        self.rows = np.concatenate([self.normal, n + self.tangential])
        self.count = self.rows.size
        self.size = self.count + system.motions
        self._coupling = np.where(np.abs(status) == 1, -system.friction * status, 0.0)  # T = coupling N where it slips

    @cached_property
    def others(self) -> np.ndarray:
        """All rows without an unknown, ndarray of int, shape (2n-count,)."""
        is_other = np.ones(2 * self._coupling.size, dtype=bool)
        is_other[self.rows] = False
        return np.flatnonzero(is_other)

    def fill_columns(self, rows: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` with the `rows` of the operator, one column for each unknown traction, friction eliminated."""
        operator = self._system.operator
        operator.fill(rows, self.rows, out)
        slipping = np.flatnonzero(self._coupling[self.normal])
        together = 256  # bounds the memory of the copies
        for begin in range(0, slipping.size, together):
            part = slipping[begin : begin + together]
            nodes = self.normal[part]
            out[:, part] += operator.entries(rows, self._coupling.size + nodes) * self._coupling[nodes]

    def balance_columns(self) -> np.ndarray:
        """The resultants (m, count) of unit unknown tractions, friction eliminated."""
        equilibrium, slipping = self._system.equilibrium, np.flatnonzero(self._coupling[self.normal])
        nodes, result = self.normal[slipping], equilibrium[:, self.rows]
        result[:, slipping] += equilibrium[:, self._coupling.size + nodes] * self._coupling[nodes]
        return result

    def expand(self, unknowns: np.ndarray) -> np.ndarray:
        """All tractions, (2n,) or (2n, k), from the unknowns, (size,) or (size, k)."""
        tractions = np.zeros((2 * self._coupling.size, *unknowns.shape[1:]), order="F")
        tractions[self.rows] = unknowns[: self.count]
        slipping = np.flatnonzero(self._coupling)
        tractions[self._coupling.size + slipping] = (self._coupling[slipping] * tractions[slipping].T).T
        return tractions

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Unknown tractions and motion, (size,), for given right-hand sides."""
        raise NotImplementedError

    def rates(self, load_rate: np.ndarray) -> np.ndarray:
        """Rates (size,) of the unknowns while the load changes and the statuses stay."""
        system = self._system
        return self.solve(np.r_[-system.load_displacement(load_rate)[self.rows], system.load_forces(load_rate)])

    def displacement(self, unknowns: np.ndarray) -> np.ndarray:
        """Gap and slip, (2n,) or (2n, k), that the unknowns, (size,) or (size, k), cause."""
        return self._system.operator @ self.expand(unknowns) + self._system.motion @ unknowns[self.count :]

    def at_others(self, unknowns: np.ndarray, acting: np.ndarray) -> np.ndarray:
        """Displacement of the others from the unknowns (size, k), added to `acting` (2n-count, k).

        `acting` may be overwritten.
        """
        if self.count > FEW_UNKNOWNS and not self._system.operator.is_stored:
            acting += self.displacement(unknowns)[self.others]
            return acting
        others = np.asfortranarray(acting)
        add_product(others, self._tied, unknowns)
        return others

    @cached_property
    def _tied(self) -> np.ndarray:
        """Rows of the others for the unknown tractions and the motion, shape (2n-count, size)."""
        system = self._system
        result = np.empty((self.others.size, self.size), order="F")
        self.fill_columns(self.others, result[:, : self.count])
        result[:, self.count :] = system.motion[self.others]
        return result

    def unit_responses(self, slots: np.ndarray, coupling: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement (2n, k) and resultants (m, k) of unit tractions in the rows `slots` among the others.

        Where `coupling` (k,) is not zero, the slot is a pressure N, and a shear coupling N comes with it.
        """
        system, pairs = self._system, np.flatnonzero(coupling)
        shears = self._coupling.size + slots[pairs]
        acting, balance = system.operator.entries(columns=slots), system.equilibrium[:, slots]
        acting[:, pairs] += coupling[pairs] * system.operator.entries(columns=shears)
        balance[:, pairs] += coupling[pairs] * system.equilibrium[:, shears]
        return acting, balance


class DenseUnknowns(Unknowns):
    """The unknowns of any statuses, by a factorisation. ``singular`` if the closed nodes can't hold the pin."""

    def __init__(self, system: System, status: np.ndarray) -> None:
        super().__init__(system, status)
        count, matrix = self.count, np.empty((self.size, self.size), order="F")
        self.fill_columns(self.rows, matrix[:count, :count])
        matrix[:count, count:] = system.motion[self.rows]
        matrix[count:, :count] = self.balance_columns()
        matrix[count:, count:] = system.motion_rows
        # The unknowns are forces, not tractions: entries are then of order one, and the condition number has a meaning.
        self._width = system.width
        matrix[:, :count] /= self._width
        norm = float(lapack.dlange("1", matrix))
        self._lu, self._pivots, info = lapack.dgetrf(matrix, overwrite_a=1)
        self.singular = info != 0 or not np.isfinite(norm)
        if not self.singular:
            rcond, _ = lapack.dgecon(self._lu, norm)
            self.singular = not rcond > SINGULAR

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Unknown tractions and motion, (size,) or (size, k), for given right-hand sides."""
        unknowns = lapack.dgetrs(self._lu, self._pivots, right)[0]
        unknowns[: self.count] /= self._width
        return unknowns

    def held_columns(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns (size, k), and displacement of the others, for a unit gap or slip at each rows[positions]."""
        right = np.zeros((self.size, positions.size), order="F")
        right[positions, np.arange(positions.size)] = 1.0
        unknowns = self.solve(right)
        return unknowns, self.at_others(unknowns, np.zeros((self.others.size, positions.size)))

    def given_columns(self, slots: np.ndarray, coupling: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns (size, k), and displacement of the others, for unit tractions (see :meth:`unit_responses`)."""
        acting, balance = self.unit_responses(slots, coupling)
        unknowns = self.solve(-np.concatenate([acting[self.rows], balance]))
        return unknowns, self.at_others(unknowns, acting[self.others])


class StickingRun(Unknowns):
    """The unknowns of neighbouring, equally spaced nodes that all stick, by a fast inverse.

    Their matrix is block Toeplitz. Its inverse takes O(n^2) operations. The motions and the conditions of equilibrium
    are added by their Schur complement. ``singular`` if the nodes can't hold the pin, or if the inverse
    has lost its digits.
    """

    def __init__(self, system: System, status: np.ndarray) -> None:
        super().__init__(system, status)
        self._neighbours = Neighbours.of(system, int(self.normal[0]), self.normal.size)
        self._core = self._neighbours.core
        motion, self._equilibrium = system.motion[self.rows], system.equilibrium[:, self.rows]
        self._moved = self._core @ motion
        complement = system.motion_rows - self._equilibrium @ self._moved
        scale = np.abs(self._equilibrium) @ np.abs(self._moved)
        sound = bool(np.all(np.isfinite(complement))) and np.linalg.cond(complement / scale.max()) < 1e8
        self.singular = not sound
        if sound:
            self._small = np.linalg.inv(complement)
            right = np.cos(np.arange(float(self.size)))  # one solve, checked by the matrices
            unknowns = self.solve(right)
            balance = system.equilibrium @ self.expand(unknowns) + system.motion_rows @ unknowns[self.count :]
            error = np.abs(np.r_[self.displacement(unknowns)[self.rows], balance] - right).max()
            self.singular = not error < MOST_RESIDUAL

    @staticmethod
    def is_for(system: System, status: np.ndarray) -> bool:
        """Whether statuses and grid allow the fast inverse.

        It takes friction, a uniform grid, and at least :data:`LEAST_NEIGHBOURS` closed nodes. They must lie side by
        side, all stick, and keep clear of the ends of an arc. On a circle at least one node must be open. Under a
        prescribed displacement, or with a compliance of any plate, the operator is no Toeplitz matrix.
        """
        closed = np.flatnonzero(status != OPEN)
        if not system.has_friction or np.any(status[closed] != STICK):
            return False
        return have_toeplitz_matrix(system, closed, LEAST_NEIGHBOURS)

    @classmethod
    def of(cls, system: System, status: np.ndarray) -> StickingRun | None:
        """The unknowns of given statuses; None if :meth:`is_for` says no, or if they are ``singular``."""
        if not cls.is_for(system, status):
            return None
        unknowns = cls(system, status)
        return None if unknowns.singular else unknowns

    @cached_property
    def _responses(self) -> np.ndarray:
        """The inverse ``_core`` times the columns of the others, shape (count, 2n-count)."""
        return self._neighbours.responses()

    @cached_property
    def _complement(self) -> np.ndarray:
        """Displacement of the others for unit tractions on them, while the sticking nodes are held."""
        return self._neighbours.complement()

    @cached_property
    def _tied_motion(self) -> np.ndarray:
        """Displacement of the others when the pin moves and tractions hold the sticking nodes in place."""
        motion = self._system.motion
        return motion[self.others] - self._responses.T @ motion[self.rows]

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Unknown tractions and motion, (size,), for given right-hand sides."""
        return self._moving(self._core @ right[: self.count], right[self.count :])

    def held_columns(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns (size, k), and displacement of the others, for a unit gap or slip at each rows[positions]."""
        no_forces = np.zeros((self._system.motions, positions.size))
        unknowns = self._moving(self._core[positions].T, no_forces)  # the core is symmetric
        return unknowns, self._responses[positions].T + self._tied_motion @ unknowns[self.count :]

    def given_columns(self, slots: np.ndarray, coupling: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns (size, k), and displacement of the others, for unit tractions (see :meth:`unit_responses`)."""
        acting, balance = self.unit_responses(slots, coupling)
        places, pairs = np.searchsorted(self.others, slots), np.flatnonzero(coupling)
        shears = np.searchsorted(self.others, self._coupling.size + slots[pairs])
        free = -self._responses[:, places]
        free[:, pairs] -= coupling[pairs] * self._responses[:, shears]
        unknowns = self._moving(free, -balance)
        if self.count < self.others.size:  # few sticking nodes: the product takes less time
            return unknowns, self.at_others(unknowns, acting[self.others])
        others = self._complement[:, places]
        others[:, pairs] += coupling[pairs] * self._complement[:, shears]
        return unknowns, others + self._tied_motion @ unknowns[self.count :]

    def _moving(self, free: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Tractions and motion (size, ...) for the resultants `forces`. `free` are the tractions without motion."""
        motion = self._small @ (forces - self._equilibrium @ free)
        result = np.empty((self.size, *free.shape[1:]), order="F")
        result[: self.count] = free
        result[: self.count] -= self._moved @ motion
        result[self.count :] = motion
        return result


def have_toeplitz_matrix(system: System, nodes: np.ndarray, least: int) -> bool:
    """Whether `nodes`, in increasing order and at least so many, have a block Toeplitz matrix.

    They must be equally spaced neighbours that keep clear of the ends of an arc, where hats are halves. On a circle at
    least one node must be left out.
    """
    n = system.grid.size
    if not system.is_toeplitz or not least <= nodes.size < n or nodes[-1] - nodes[0] + 1 != nodes.size:
        return False
    return bool(system.grid.closed or (nodes[0] > 0 and nodes[-1] < n - 1))

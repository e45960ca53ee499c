"""The tableau's columns, computed when they are asked for and brought up to date by matrix products."""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas

from fastpin.elasticity.system import System
from fastpin.kernels.exchange import CHUNK, WIDTH, Contact, Tableau
from fastpin.kernels.products import add_product
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver.unknowns import DenseUnknowns, StickingRun

ROOM = 2
"""Updates a node for which there is room; with more, the tableau is built anew."""


class TableauMemory:
    """Where tableaus are kept, one at a time, step after step. Fresh memory comes page by page, which takes time."""

    def __init__(self, nodes: int) -> None:
        updates = ROOM * nodes + CHUNK
        self.matrix = np.empty((2 * nodes + 3, 2 * nodes), order="F")  # what is never asked for takes no memory
        self.left = np.empty((2 * nodes + 3, updates), order="F")


class Columns:
    """The tableau of :mod:`fastpin.tableau` for given statuses and what becomes of it by updates.

    Parameters
    ----------
    system : System
    basis : StuckSet or FactoredSet
        The solvable system of the statuses.
    contact : Contact
        The configuration. Its ties are set.
    load_rate : ndarray, shape (6,)
        Dimensionless, per unit of the step.
    memory : Memory
        For the tableau. What was there is overwritten.

    Attributes
    ----------
    tableau : Tableau
    """

    def __init__(
        self,
        system: System,
        basis: StickingRun | DenseUnknowns,
        contact: Contact,
        load_rate: np.ndarray,
        memory: TableauMemory,
    ) -> None:
        n, updates = system.grid.size, memory.left.shape[1]
        self._system, self._basis = system, basis
        # of the unknowns and, below them, the others: where they stand among (N or h), (T or s) and the motion
        self._order = np.argsort(np.r_[basis.rows, 2 * n + np.arange(3), basis.others])
        self._position = np.full(2 * n, -1)
        self._position[basis.rows] = np.arange(basis.count)
        self._rows: list[np.ndarray] = []
        self.tableau = Tableau(
            matrix=memory.matrix,
            fresh=np.full(-(-2 * n // WIDTH), -1),
            left=memory.left,
            source=np.empty(updates, dtype=np.int64),
            slot=np.empty(updates, dtype=np.int64),
            delta=np.empty(updates),
            rates=self._rates(load_rate),
        )
        self._tie(contact)

    def _rates(self, load_rate: np.ndarray) -> np.ndarray:
        system, basis = self._system, self._basis
        unknowns = basis.rates(load_rate)
        displaced = system.loads @ load_rate + basis.displacement(unknowns)
        return np.r_[unknowns, displaced[basis.others]][self._order]

    def _tie(self, contact: Contact) -> None:
        """Tie the shear of every node as it will be when it slips; where that turns out wrong it costs an update."""
        n, rates = contact.status.size, self.tableau.rates
        contact.tie[:] = contact.status
        stuck, open_ = np.flatnonzero(contact.status == STICK), np.flatnonzero(contact.status == OPEN)
        contact.tie[stuck] = np.where(contact.shear[stuck] + rates[n + stuck] > 0.0, -1, 1)
        contact.tie[open_] = np.where(rates[n + open_] < 0.0, -1, 1)
        coupling = self._system.friction * contact.tie
        self._tied, self._drag = np.zeros(n), np.zeros(2 * n)
        self._tied[stuck] = coupling[stuck]  # tau = T + tied N where it sticks
        self._drag[open_] = -coupling[open_]  # a unit of N comes with so much T where it is open
        rates[n : 2 * n] += self._tied * rates[:n]

    def refresh(self, asked: int, updates: int) -> None:
        """Bring the block of the column `asked` up to the last whole chunk of the updates."""
        tableau = self.tableau
        block = asked // WIDTH
        slots = np.arange(block * WIDTH, min((block + 1) * WIDTH, tableau.matrix.shape[1]))
        values = tableau.matrix[:, slots[0] : slots[-1] + 1]
        if tableau.fresh[block] < 0:
            self._compute(slots, values)
            tableau.fresh[block] = 0
        begin, end = int(tableau.fresh[block]), updates - updates % CHUNK
        self._update(values, slots == tableau.slot[begin:end, None], begin, end)
        tableau.fresh[block] = end

    def response(self, given: np.ndarray, updates: int) -> np.ndarray:
        """The product (2n+3,) of the tableau and `given` (2n+3,), zero-rate variables and forces out of balance."""
        system, basis, n = self._system, self._basis, self._system.grid.size
        tractions = np.zeros(2 * n)
        tractions[basis.others] = given[basis.others]
        tractions[n:] += self._drag[:n] * tractions[:n]
        acting = system.operator @ tractions
        balance = given[2 * n :] - system.equilibrium @ tractions
        unknowns = basis.solve(np.r_[given[basis.rows] - acting[basis.rows], balance])
        acting += basis.displacement(unknowns)
        values = np.empty((2 * n + 3, 1), order="F")
        self._spread(np.r_[unknowns, acting[basis.others]][:, None], values)
        self._update(values, given[self.tableau.slot[:updates], None], 0, updates)
        return values[:, 0]

    def _compute(self, slots: np.ndarray, values: np.ndarray) -> None:
        """Columns `slots` before any update."""
        basis, position = self._basis, self._position[slots]
        held, given = np.flatnonzero(position >= 0), np.flatnonzero(position < 0)
        stacked, count = np.empty((self._order.size, slots.size), order="F"), basis.count + 3
        if held.size:
            stacked[:count, held], stacked[count:, held] = basis.held_columns(position[held])
        if given.size:
            stacked[:count, given], stacked[count:, given] = basis.given_columns(slots[given], self._drag[slots[given]])
        self._spread(stacked, values)

    def _spread(self, stacked: np.ndarray, values: np.ndarray) -> None:
        """All dependent variables, into `values`, from the unknowns and, below them, the displacement of the others."""
        n = self._system.grid.size
        np.take(stacked.T, self._order, axis=1, out=values.T, mode="clip")  # by rows of the transposed: contiguous
        values[n : 2 * n] += self._tied[:, None] * values[:n]

    def _update(self, values: np.ndarray, units: np.ndarray, begin: int, end: int) -> None:
        """Apply the updates from `begin`, a multiple of CHUNK, to `end` to the columns `values`.

        `units` (end-begin, k) are the zero-rate variables that they are the responses to, in the slots of the updates.
        First the factors of the updates, from the rows that they take, then all updates in one product.
        """
        tableau = self.tableau
        factors = np.where(tableau.source[begin:end, None] >= 0, values[tableau.source[begin:end]], 0.0)
        factors = np.asfortranarray(factors + tableau.delta[begin:end, None] * units)
        for first in range(begin, end, CHUNK):
            chunk = slice(first, min(first + CHUNK, end))
            taken, now = self._taken(chunk), slice(first - begin, chunk.stop - begin)
            add_product(factors[now], taken[:, begin:first], factors[: first - begin])
            # what the updates of the chunk itself make of the rows that later ones of them take
            factors[now] = blas.dtrsm(1.0, -taken[:, first:], factors[now], lower=1, diag=1)
        add_product(values, tableau.left[:, begin:end], factors)

    def _taken(self, chunk: slice) -> np.ndarray:
        """The rows of ``left`` that the updates of a chunk take, up to themselves; kept for whole chunks."""
        number, tableau = chunk.start // CHUNK, self.tableau
        if number < len(self._rows):
            return self._rows[number]
        source = tableau.source[chunk]
        rows = np.asfortranarray(np.where(source[:, None] >= 0, tableau.left[source, : chunk.stop], 0.0))
        if source.size == CHUNK:
            self._rows.append(rows)
        return rows

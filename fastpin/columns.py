"""The tableau's columns, computed when they are asked for and brought up to date by matrix products."""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas

from fastpin.basis import FactoredSet, StuckSet
from fastpin.collocation import System
from fastpin.products import add_product
from fastpin.state import OPEN, STICK
from fastpin.tableau import CHUNK, WIDTH, Contact, Tableau

ROOM = 2
"""Updates a node for which there is room; with more, the tableau is built anew."""


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

    Attributes
    ----------
    tableau : Tableau
    """

    def __init__(self, system: System, basis: StuckSet | FactoredSet, contact: Contact, load_rate: np.ndarray) -> None:
        n = system.grid.size
        self._system, self._basis = system, basis
        self._free = np.r_[basis.rows, 2 * n + np.arange(3)]
        self._order = np.argsort(np.r_[self._free, basis.others])
        self._position = np.full(2 * n, -1)
        self._position[basis.rows] = np.arange(basis.count)
        self._open, self._stuck = np.flatnonzero(contact.status == OPEN), np.flatnonzero(contact.status == STICK)
        self._rows: list[np.ndarray] = []
        capacity = ROOM * n + CHUNK
        self.tableau = Tableau(
            matrix=np.empty((2 * n + 3, 2 * n), order="F"),  # pages that are never asked for take no memory
            fresh=np.full(-(-2 * n // WIDTH), -1),
            left=np.empty((2 * n + 3, capacity), order="F"),
            source=np.empty(capacity, dtype=np.int64),
            slot=np.empty(capacity, dtype=np.int64),
            delta=np.empty(capacity),
            rates=self._rates(load_rate),
        )
        self._tie(contact)

    def _rates(self, load_rate: np.ndarray) -> np.ndarray:
        system, basis = self._system, self._basis
        change, rates = system.loads @ load_rate, np.empty(2 * system.grid.size + 3)
        unknowns = basis.solve(np.r_[-change[basis.rows], system.forces @ load_rate])
        change += system.operator @ basis.expand(unknowns) + system.motion @ unknowns[-3:]
        rates[self._free] = unknowns
        rates[basis.others] = change[basis.others]
        return rates

    def _tie(self, contact: Contact) -> None:
        """Tie the shear of every node as it will be when it slips; where that turns out wrong it costs an update."""
        n, rates = contact.status.size, self.tableau.rates
        contact.tie[:] = contact.status
        stuck, open_ = self._stuck, self._open
        contact.tie[stuck] = np.where(contact.shear[stuck] + rates[n + stuck] > 0.0, -1, 1)
        contact.tie[open_] = np.where(rates[n + open_] < 0.0, -1, 1)
        self._coupling = self._system.friction * contact.tie
        rates[n + stuck] += self._coupling[stuck] * rates[stuck]

    def refresh(self, asked: int, updates: int) -> None:
        """Bring the block of the column `asked` up to the last whole chunk of the updates."""
        tableau, block = self.tableau, asked // WIDTH
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
        tractions[n + self._open] -= self._coupling[self._open] * tractions[self._open]
        acting = system.operator @ tractions
        balance = given[2 * n :] - system.equilibrium @ tractions
        unknowns = basis.solve(np.r_[given[basis.rows] - acting[basis.rows], balance])
        acting += system.operator @ basis.expand(unknowns) + system.motion @ unknowns[-3:]
        values = np.empty((2 * n + 3, 1), order="F")
        self._spread(np.r_[unknowns, acting[basis.others]][:, None], values)
        self._update(values, given[self.tableau.slot[:updates], None], 0, updates)
        return values[:, 0]

    def _compute(self, slots: np.ndarray, values: np.ndarray) -> None:
        """Columns `slots` before any update."""
        basis, position = self._basis, self._position[slots]
        held, given = np.flatnonzero(position >= 0), np.flatnonzero(position < 0)
        nodes = slots[given]
        coupling = np.where(np.isin(nodes, self._open), -self._coupling[nodes % self._coupling.size], 0.0)
        stacked, count = np.empty((self._order.size, slots.size), order="F"), basis.count + 3
        stacked[:count, held], stacked[count:, held] = basis.held_columns(position[held])
        stacked[:count, given], stacked[count:, given] = basis.given_columns(nodes, coupling)
        self._spread(stacked, values)

    def _spread(self, stacked: np.ndarray, values: np.ndarray) -> None:
        """All dependent variables, into `values`, from the unknowns and, below them, the displacement of the others."""
        n, stuck = self._system.grid.size, self._stuck
        np.take(stacked.T, self._order, axis=1, out=values.T, mode="clip")  # by rows of the transposed: contiguous
        tied = np.zeros(n)
        tied[stuck] = self._coupling[stuck]
        values[n : 2 * n] += tied[:, None] * values[:n]

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

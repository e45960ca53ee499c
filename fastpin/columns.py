"""The tableau's columns, computed when they are asked for and brought up to date by matrix products."""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas

from fastpin.basis import FactoredSet, StuckSet
from fastpin.collocation import System
from fastpin.products import add_product
from fastpin.state import OPEN, STICK
from fastpin.tableau import CHUNK, WIDTH, Contact, Tableau


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
        self._position = np.full(2 * n, -1)
        self._position[basis.rows] = np.arange(basis.count)
        self._open, self._stuck = np.flatnonzero(contact.status == OPEN), np.flatnonzero(contact.status == STICK)
        self._triangles: list[np.ndarray] = []
        capacity = 2 * n + CHUNK
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
        self._spread(unknowns[:, None], acting[basis.others, None], values)
        self._update(values, given[self.tableau.slot[:updates], None], 0, updates)
        return values[:, 0]

    def _compute(self, slots: np.ndarray, values: np.ndarray) -> None:
        """Columns `slots` before any update."""
        basis, position = self._basis, self._position[slots]
        held, given = np.flatnonzero(position >= 0), np.flatnonzero(position < 0)
        nodes = slots[given]
        coupling = np.where(np.isin(nodes, self._open), -self._coupling[nodes % self._coupling.size], 0.0)
        unknowns = np.empty((basis.count + 3, slots.size), order="F")
        others = np.empty((basis.others.size, slots.size), order="F")
        unknowns[:, held], others[:, held] = basis.held_columns(position[held])
        unknowns[:, given], others[:, given] = basis.given_columns(nodes, coupling)
        self._spread(unknowns, others, values)

    def _spread(self, unknowns: np.ndarray, others: np.ndarray, values: np.ndarray) -> None:
        """All dependent variables, into `values`, from the unknowns and the displacement of the others."""
        n, stuck = self._system.grid.size, self._stuck
        for column, unknown, other in zip(values.T, unknowns.T, others.T, strict=True):
            column[self._free] = unknown
            column[self._basis.others] = other
            column[n + stuck] += self._coupling[stuck] * column[stuck]

    def _update(self, values: np.ndarray, units: np.ndarray, begin: int, end: int) -> None:
        """Apply the updates from `begin`, a multiple of CHUNK, to `end` to the columns `values`.

        `units` (end-begin, k) are the zero-rate variables that they are the responses to, in the slots of the updates.
        """
        tableau = self.tableau
        for first in range(begin, end, CHUNK):
            chunk = slice(first, min(first + CHUNK, end))
            source, delta = tableau.source[chunk, None], tableau.delta[chunk, None]
            factors = np.where(source >= 0, values[tableau.source[chunk]], 0.0)
            factors += delta * units[first - begin : chunk.stop - begin]
            factors = blas.dtrsm(1.0, self._triangle(chunk), factors, lower=1, diag=1)
            add_product(values, tableau.left[:, chunk], factors)

    def _triangle(self, chunk: slice) -> np.ndarray:
        """What the updates of a chunk make of the rows that later ones of them take: a unit lower triangle."""
        number = chunk.start // CHUNK
        if number < len(self._triangles):
            return self._triangles[number]
        tableau = self.tableau
        source = tableau.source[chunk]
        triangle = np.asfortranarray(np.where(source[:, None] >= 0, -tableau.left[source, chunk], 0.0))
        if source.size == CHUNK:
            self._triangles.append(triangle)
        return triangle

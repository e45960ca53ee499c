"""Columns of the tableau from their tractions alone: the operator gives gap and slip of the other rows.

A column of the tableau is a contact without rest gap and load. It has tractions at the closed nodes, and a motion of
the pin. Where the operator multiplies by Fourier transforms, gap and slip follow from the tractions in less time than
from hundreds of updates.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.arrays import Contact, Tableau
from fastpin.runtime.products import add_product

WORTHWHILE = 4_000_000
"""Least number of multiplications a column that transforms must save. They take as long at 4,096 nodes (measured)."""


class TractionRows:
    """The rows of a tableau that hold tractions, from update to update.

    Parameters
    ----------
    system : System
    rows : ndarray of int
        Rows among (N, T) that are unknown tractions before the first update.
    contact : Contact
        The configuration. Its ties are those before the first update.
    """

    def __init__(self, system: System, rows: np.ndarray, contact: Contact) -> None:
        self._system = system
        self._loaded = np.zeros(2 * system.grid.size, dtype=bool)
        self._loaded[rows] = True
        self._coupling = system.friction * contact.tie  # T = tau - coupling N
        self._done = 0  # updates that both include

    def update(
        self, tableau: Tableau, slots: np.ndarray, values: np.ndarray, updates: slice, factors: np.ndarray
    ) -> bool:
        """Bring the columns `slots` up to date by the `factors` of some updates. Returns whether it was worthwhile.

        If not, `values` (2n+m, k) stay as they are. `updates` may only grow from call to call.
        """
        if self._system.operator.is_stored:
            return False
        self._follow(tableau, updates.stop)
        n, rows, loaded = self._system.grid.size, len(values), self._loaded
        parts = [_extent(loaded[:n], 0), _extent(loaded[n:], n), slice(2 * n, rows)]
        kept = sum(part.stop - part.start for part in parts)
        if (rows - kept) * (updates.stop - updates.start) < WORTHWHILE:
            return False
        for part in parts:
            add_product(values[part], tableau.left[part, updates], factors)
        tractions = np.where(loaded[:, None], values[: 2 * n], 0.0).T.copy().T  # column by column
        given = np.flatnonzero(~loaded[slots])
        tractions[slots[given], given] = 1.0
        tractions[n:] -= self._coupling[:, None] * tractions[:n]
        displaced = self._system.operator @ tractions
        displaced += self._system.motion @ values[2 * n :]
        np.copyto(values[: 2 * n], displaced, where=~loaded[:, None])
        return True

    def _follow(self, tableau: Tableau, end: int) -> None:
        """Follow the exchanges and the changes of ties up to the update `end`. A tie that changes turns round."""
        for source, slot in zip(tableau.source[self._done : end], tableau.slot[self._done : end], strict=True):
            if source == slot:
                self._loaded[slot] = not self._loaded[slot]
            else:
                node = max(source, slot)
                self._coupling[node] = -self._coupling[node]
        self._done = end


def _extent(loaded: np.ndarray, begin: int) -> slice:
    """The rows from the first to the last that is loaded, counted from `begin`."""
    places = np.flatnonzero(loaded)
    return slice(begin + int(places[0]), begin + int(places[-1]) + 1) if places.size else slice(begin, begin)

"""The columns of the tableau: computed when the exchange loop needs them, updated by matrix products.

:mod:`fastpin.kernels.exchange` holds the loop and explains the tableau and its updates.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import conditions, exchange
from fastpin.kernels.arrays import Contact, LoadTerms, Queue, Tableau
from fastpin.kernels.exchange import CHUNK, WIDTH
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.extensions import blas
from fastpin.runtime.products import add_product
from fastpin.solver.configuration import Configuration, Correction
from fastpin.solver.unknowns import DenseUnknowns, StickingRun

ROOM = 2
"""Updates per node for which there is room. With more updates the tableau is rebuilt."""

WORTHWHILE = 4_000_000
"""Least number of multiplications a column that transforms must save. They take as long at 4,096 nodes (measured)."""


class TableauMemory:
    """Memory for one tableau, used again step after step. Fresh memory comes page by page, which takes time.

    It keeps the linear systems of the latest statuses, so that the same statuses give the same bits: at most one
    :class:`StickingRun` and one :class:`DenseUnknowns`; of a system whose operator is not stored, one of the two.

    Parameters
    ----------
    system : System
        With n nodes and m motions.

    Attributes
    ----------
    matrix : ndarray, shape (2n+m, 2n)
    left : ndarray, shape (2n+m, updates)
    blank : Tableau
        Its arrays, without rates, in which every tableau begins.
    held : Tableau or None
        The arrays of a tableau that begins with a held contact; None before the first one.
    """

    held: Tableau | None = None

    def __init__(self, system: System) -> None:
        rows, columns = len(system.motion) + system.motions, len(system.motion)
        self.matrix = np.empty((rows, columns), order="F")  # columns that are never needed take no memory
        self.left = np.empty((rows, ROOM * system.grid.size + CHUNK), order="F")
        (source, slot), delta = np.empty((2, self.left.shape[1]), dtype=np.int64), np.empty(self.left.shape[1])
        self.blank = Tableau(
            matrix=self.matrix, fresh=np.zeros(0, dtype=np.int64), left=self.left, source=source, slot=slot,
            delta=delta, factors=np.zeros(4), rates=np.zeros(0), order=np.zeros(0, dtype=np.int64), tied=np.zeros(0),
            drag=np.zeros(0), chunk=CHUNK, width=WIDTH,
        )  # fmt: skip
        self._sticking: tuple[tuple[System, bytes] | None, StickingRun | None] = None, None
        self._dense: tuple[tuple[System, bytes] | None, DenseUnknowns | None] = None, None

    def sticking(self, system: System, status: np.ndarray) -> StickingRun | None:
        """The unknowns of given statuses by a fast inverse, see :meth:`StickingRun.of`."""
        if not StickingRun.is_for(system, status):  # the kept one stays
            return None
        key = system, status.tobytes()
        if self._sticking[0] != key:  # the old one goes before a new one is made: there is memory for one
            self._sticking = None, None
            if not system.operator.is_stored:
                self._dense = None, None
            self._sticking = key, StickingRun.of(system, status)
        return self._sticking[1]

    def dense(self, system: System, status: np.ndarray) -> DenseUnknowns | None:
        """The unknowns of given statuses by a factorisation; None if the nodes can't hold the pin."""
        key = system, status.tobytes()
        if self._dense[0] != key:
            self._dense = None, None
            if not system.operator.is_stored:
                self._sticking = None, None
            self._dense = key, DenseUnknowns(system, status)
        found = self._dense[1]
        return None if found is None or found.singular else found

    def solvable(self, system: System, status: np.ndarray) -> StickingRun | DenseUnknowns | None:
        """The unknowns of given statuses by the faster of both ways; None if the nodes can't hold the pin."""
        return self.sticking(system, status) or self.dense(system, status)


class Columns:
    """The tableau that :func:`fastpin.kernels.exchange.follow` works on, begun from given statuses.

    Parameters
    ----------
    system : System
    basis : StickingRun or DenseUnknowns
        The solvable system of the statuses.
    contact : Contact
        The configuration. The ties in it are set.
    load_rate : ndarray, shape (loads,)
        Dimensionless, per unit of the step.
    memory : TableauMemory
        Memory for the tableau. It is overwritten.
    room : int, optional
        Updates before the tableau is rebuilt; as many as the memory holds unless given.

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
        room: int | None = None,
    ) -> None:
        n = system.grid.size
        self._system, self._basis = system, basis
        # Stacked vectors hold the unknowns and, below them, the others. `_order` has the places of (N or h), (T or s)
        # and the motion in them.
        self._order = np.argsort(np.r_[basis.rows, 2 * n + np.arange(system.motions), basis.others])
        self._position = np.full(2 * n, -1)
        self._position[basis.rows] = np.arange(basis.count)
        self._rows: list[np.ndarray] = []
        self._contact, self._updates = contact, 0
        unknowns = basis.rates(load_rate)
        displaced = system.load_displacement(load_rate) + basis.displacement(unknowns)
        rates = np.r_[unknowns, displaced[basis.others]][self._order]
        fresh = np.full(-(-2 * n // WIDTH), -1)
        self.tableau = memory.blank._replace(left=memory.left[:, :room], rates=rates, fresh=fresh)
        self._tie(contact)
        self._tractions = TractionRows(system, basis.rows, contact)

    def _tie(self, contact: Contact) -> None:
        """Tie the shear of each node to the pressure for the expected sense of slip. A wrong tie costs one update."""
        n, rates = contact.status.size, self.tableau.rates
        stuck, open_ = np.flatnonzero(contact.status == STICK), np.flatnonzero(contact.status == OPEN)
        contact.tie[:] = np.where(np.abs(contact.status) == 1, contact.status, expected_ties(contact, rates))
        coupling = self._system.friction * contact.tie
        self._tied, self._drag = np.zeros(n), np.zeros(2 * n)
        self._tied[stuck] = coupling[stuck]  # tau = T + tied N at sticking nodes
        self._drag[open_] = -coupling[open_]  # a unit of N comes with this T at open nodes
        rates[n : 2 * n] += self._tied * rates[:n]

    def follow(self, load: LoadTerms, queue: Queue, stop: float, most_events: int, all_at_once: int) -> int:
        """Follow the load up to the fraction `stop` of the step, and return the code of the kernel."""
        system = self._system
        code = exchange.follow(
            self.tableau, self._contact, load, queue, system.friction, system.fixed, system.operator.typical, stop,
            most_events, all_at_once,
        )  # fmt: skip
        self._updates = int(queue.counts[exchange.UPDATES])
        return int(code)

    def refresh(self, asked: int, updates: int) -> None:
        """Compute the block of the column `asked`, or bring it up to the last whole chunk of the updates.

        `updates` is the number of all updates so far.
        """
        tableau = self.tableau
        block = asked // WIDTH
        slots = np.arange(block * WIDTH, min((block + 1) * WIDTH, tableau.matrix.shape[1]))
        values = tableau.matrix[:, slots[0] : slots[-1] + 1]
        if tableau.fresh[block] < 0:
            basis, position = self._basis, self._position[slots]
            held, given = np.flatnonzero(position >= 0), np.flatnonzero(position < 0)
            stacked, count = np.empty((self._order.size, slots.size), order="F"), basis.size
            if held.size:
                stacked[:count, held], stacked[count:, held] = basis.held_columns(position[held])
            if given.size:
                drag = self._drag[slots[given]]
                stacked[:count, given], stacked[count:, given] = basis.given_columns(slots[given], drag)
            self._spread(stacked, values)
            tableau.fresh[block] = 0
        begin, end = int(tableau.fresh[block]), updates - updates % CHUNK
        factors = self._factors(values, slots == tableau.slot[begin:end, None], begin, end)
        if not self._tractions.update(tableau, slots, values, slice(begin, end), factors):
            add_product(values, tableau.left[:, begin:end], factors)
        tableau.fresh[block] = end

    def response(self, given: np.ndarray, updates: int) -> np.ndarray:
        """The product (2n+m,) of the tableau and the vector `given` (2n+m,).

        `given` holds the zero-rate variables, then the m forces out of balance. `updates` is the number of all
        updates so far.
        """
        system, basis, n = self._system, self._basis, self._system.grid.size
        tractions = np.zeros(2 * n)
        tractions[basis.others] = given[basis.others]
        tractions[n:] += self._drag[:n] * tractions[:n]
        acting = system.operator @ tractions
        balance = given[2 * n :] - system.equilibrium @ tractions
        unknowns = basis.solve(np.r_[given[basis.rows] - acting[basis.rows], balance])
        acting += basis.displacement(unknowns)
        values = np.empty((given.size, 1), order="F")
        self._spread(np.r_[unknowns, acting[basis.others]][:, None], values)
        factors = self._factors(values, given[self.tableau.slot[:updates], None], 0, updates)
        add_product(values, self.tableau.left[:, :updates], factors)
        return values[:, 0]

    def correct(self, now: Configuration) -> Correction:
        """Correct tractions and motion of `now` until its statuses, its held slip and its load hold to rounding.

        The tableau makes the corrections, and the matrices check them. Where the operator is stored,
        :func:`fastpin.kernels.conditions.correct_held` does the same in one call.
        """
        system, n = self._system, self._system.grid.size
        loaded, forces = system.load_displacement(now.load), system.load_forces(now.load)
        found = now.values._replace(
            pressure=np.where(now.closed, now.pressure, 0.0), shear=np.where(now.closed, now.shear, 0.0),
            motion=now.motion.copy(),
        )  # fmt: skip
        true, missing = np.empty(2 * n), np.empty(2 * n + now.motion.size)
        drift, last = 0.0, np.inf
        while True:
            elastic = system.operator @ np.concatenate([found.pressure, found.shear])
            error = conditions.imbalance(
                system.equations, found, elastic, loaded, forces, now.rest_gap, true, missing
            )  # fmt: skip
            if last == np.inf:
                drift = conditions.drift(elastic, true, now.gap, now.slip, now.motion, now.gap.max())
            if error <= conditions.ROUNDING or not error < 0.5 * last:
                break
            last = error
            change = self.response(missing, self._updates)
            conditions.correct(system.friction, self._contact.tie, change, found)
        return Correction.of(system, now, found._replace(gap=true[:n], slip=true[n:]), error, drift)

    def refine_rates(self, load_rate: np.ndarray) -> None:
        """Correct the rates by their residual from the matrices, times the tableau with all updates."""
        system, rates, n, contact = self._system, self.tableau.rates, self._system.grid.size, self._contact
        closed, stick = contact.status != OPEN, contact.status == STICK
        pressure = np.where(closed, rates[:n], 0.0)
        shear = np.where(stick, rates[n : 2 * n], 0.0) - system.friction * contact.tie * pressure
        tractions = np.r_[pressure, shear]
        displaced = system.elastic(tractions) + system.motion @ rates[2 * n :] + system.load_displacement(load_rate)
        balance = system.load_forces(load_rate) - system.equilibrium @ tractions - system.motion_rows @ rates[2 * n :]
        dependent = np.r_[closed, stick]
        change = self.response(np.r_[np.where(dependent, -displaced, 0.0), balance], self._updates)
        rates[: 2 * n] = np.where(dependent, rates[: 2 * n], displaced)
        rates += change

    def _spread(self, stacked: np.ndarray, values: np.ndarray) -> None:
        """Fill `values` with all dependent variables.

        `stacked` holds the unknowns and, below them, the displacement of the others.
        """
        n = self._system.grid.size
        np.take(stacked.T, self._order, axis=1, out=values.T, mode="clip")  # by rows of the transposed: contiguous
        values[n : 2 * n] += self._tied[:, None] * values[:n]

    def _factors(self, values: np.ndarray, units: np.ndarray, begin: int, end: int) -> np.ndarray:
        """The factors (end-begin, k) of the updates from `begin`, a multiple of CHUNK, to `end`, on columns `values`.

        The columns are responses to zero-rate variables. `units` (end-begin, k) holds these variables in the slots of
        the updates. The factors come from the rows that the updates take. Then one product applies all updates.
        """
        tableau = self.tableau
        factors = np.where(tableau.source[begin:end, None] >= 0, values[tableau.source[begin:end]], 0.0)
        factors = np.asfortranarray(factors + tableau.delta[begin:end, None] * units)
        for first in range(begin, end, CHUNK):
            chunk = slice(first, min(first + CHUNK, end))
            taken, rows = self._taken(chunk), slice(first - begin, chunk.stop - begin)
            add_product(factors[rows], taken[:, begin:first], factors[: first - begin])
            # Updates of the chunk change the rows that later updates of the same chunk take.
            factors[rows] = blas.dtrsm(1.0, -taken[:, first:], factors[rows], lower=1, diag=1)
        return factors

    def _taken(self, chunk: slice) -> np.ndarray:
        """The rows of ``left`` that the updates of a chunk take, up to the end of the chunk.

        The rows of whole chunks are stored for later.
        """
        number, tableau = chunk.start // CHUNK, self.tableau
        if number < len(self._rows):
            return self._rows[number]
        source = tableau.source[chunk]
        rows = np.asfortranarray(np.where(source[:, None] >= 0, tableau.left[source, : chunk.stop], 0.0))
        if source.size == CHUNK:
            self._rows.append(rows)
        return rows


class TractionRows:
    """The rows of a tableau that hold tractions, from update to update.

    They give columns from tractions alone. A column is a contact without rest gap and load: it has tractions at the
    closed nodes, and a motion of the pin. Where the operator multiplies by Fourier transforms, gap and slip follow from
    these in less time than from hundreds of updates.

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
        done, self._done = slice(self._done, updates.stop), updates.stop
        for source, slot in zip(tableau.source[done], tableau.slot[done], strict=True):
            if source == slot:
                self._loaded[slot] = not self._loaded[slot]
            else:  # the tie of a node has turned round
                node = max(source, slot)
                self._coupling[node] = -self._coupling[node]
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


def _extent(loaded: np.ndarray, begin: int) -> slice:
    """The rows from the first to the last that is loaded, counted from `begin`."""
    places = np.flatnonzero(loaded)
    return slice(begin + int(places[0]), begin + int(places[-1]) + 1) if places.size else slice(begin, begin)


def expected_ties(contact: Contact, rates: np.ndarray) -> np.ndarray:
    """The sense of slip (n,) that closed nodes would have at the end of the step, and open nodes when they close.

    `rates` (2n+m,) are the rates while the statuses stay.
    """
    n = contact.status.size
    tangential = rates[n : 2 * n]
    forward = np.where(contact.status == OPEN, tangential < 0.0, contact.shear + tangential > 0.0)
    return np.where(forward, -1, 1)


def has_turned(status: np.ndarray, pressure_rate: np.ndarray, shear_rate: np.ndarray, friction: np.ndarray) -> bool:
    """Whether the load has turned: most slipping nodes stick when the load goes on.

    Statuses, rates and coefficients of friction have the shape (k,). The rates are those while all closed nodes stick.
    Nodes without friction do not count.
    """
    slipping = (np.abs(status) == 1) & (friction > 0.0)
    slips_on = slipping & (-status * shear_rate > friction * pressure_rate)
    return bool(np.count_nonzero(slips_on) <= np.count_nonzero(slipping) // 2)

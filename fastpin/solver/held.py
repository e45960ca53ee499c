"""Contacts with all closed nodes held: inverted once, and used by every step that begins with these nodes closed.

With few nodes a step spends its time on the factorisation of its first statuses, and on the columns of the tableau. A
history closes the same nodes again and again. So a step begins with all closed nodes sticking, and then lets the
slipping ones slip by exchanges. The table of the held contact depends on the closed nodes alone. It is kept as it is,
so a step has the same bits whether it finds the table or computes it.
"""

from __future__ import annotations

import threading
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import held
from fastpin.kernels import held_table as held_table_kernels
from fastpin.kernels.arrays import Contact, ContactValues, LoadTerms, Queue
from fastpin.kernels.exchange import EVENTS, NEXT, QUEUED, REACHED, REBUILD, ROUND, UPDATES, WIDTH
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.extensions import blas
from fastpin.solver.configuration import Configuration, Correction
from fastpin.solver.tableau import TableauMemory
from fastpin.solver.unknowns import MOST_RESIDUAL, DenseUnknowns, Neighbours, have_toeplitz_matrix

FEW_NODES = 512
"""Most nodes of a grid whose steps begin with a held contact. Above, columns on demand take less time."""

MOST_NUMBERS = 4_000_000
"""Numbers in the tables of all held contacts of a system that are kept, at most: 32 MB."""

MOST_UPDATES = 240
"""Updates of a tableau beside those of the slipping nodes, at most. Then the closed nodes are held anew.

A column takes as long as it has updates, and a new table as long as some 20 columns (300 to 401 nodes).
"""

MOST_CONDITION = 1e8
"""Largest condition number of the equations of the motion. A contact above it hardly holds the pin."""


_LOCK = threading.Lock()  # threads may share the tables of a system


class HeldTable(NamedTuple):
    """The answers of a contact with all closed nodes sticking.

    Attributes
    ----------
    matrix : ndarray, shape (2n+m, 2n+m)
        It maps gap and slip of closed nodes, pressure and shear of open nodes, and the forces out of balance to
        pressure and shear of closed nodes, gap and slip of open nodes, and the motion. Rows and columns stand in the
        sequence of ``stack``. Columns of open end nodes of an arc are for whole hats: these nodes never close.
    stack : ndarray of int, shape (2n+m,)
        The variables in the sequence of the matrix: of closed nodes, of open nodes, of the motion.
    order : ndarray of int, shape (2n+m,)
        The place of each variable in ``stack``.
    """

    matrix: np.ndarray
    stack: np.ndarray
    order: np.ndarray


def known_table(system: System, closed: np.ndarray) -> HeldTable | None:
    """The table of the `closed` nodes (n,) of a system, which keeps it; see :func:`held_table`.

    Systems that differ in loads only share their tables. None if steps on the system do not begin with a held contact:
    on many nodes and without friction; or if the table has too few digits.
    """
    if system.grid.size > FEW_NODES or not system.has_friction or system.operator.matrix is None:
        return None
    tables, key = (system.held_as or system).held_tables, closed.tobytes()
    with _LOCK:
        if key in tables:
            tables.move_to_end(key)
            return tables[key]
    table = held_table(system, closed)
    with _LOCK:
        tables[key] = table
        while len(tables) > max(1, MOST_NUMBERS // (4 * closed.size * closed.size)):
            tables.popitem(last=False)
    return table


def held_table(system: System, closed: np.ndarray) -> HeldTable | None:
    """The table of a contact with all `closed` nodes (n,) sticking; None if they can't hold the pin."""
    n, size = closed.size, 2 * closed.size + system.motions
    nodes, others, places = closed.nonzero()[0], (~closed).nonzero()[0], np.arange(size)
    stack = np.concatenate([nodes, nodes + n, others, others + n, places[2 * n :]])
    order = np.empty(size, dtype=np.int64)
    order[stack] = places
    table = HeldTable(np.empty((size, size), order="F"), stack, order)
    is_sound, in_laminate = False, system.bodies is not None and bool(system.bodies.anisotropy)
    suits = in_laminate or system.motions == 3  # the kernel has the motions of one pin
    least = 192 if in_laminate else 1  # with fewer nodes a factorisation is as fast
    if suits and have_toeplitz_matrix(system, nodes, least):
        if in_laminate:
            is_sound = _fill_in_laminate(system, closed, table)
        else:
            condition, error = held_table_kernels.fill(
                system.entries_by_distance, int(nodes[0]), nodes.size, *system.equations[:3], table.matrix
            )
            is_sound = condition < MOST_CONDITION and error < MOST_RESIDUAL
    if is_sound:
        return table
    if 2 * nodes.size > 400:  # columns on demand take less time
        return None
    unknowns = DenseUnknowns(system, np.where(closed, STICK, OPEN).astype(np.int8))
    if unknowns.singular:
        return None
    matrix, count, others = table.matrix, unknowns.count, unknowns.others
    end = count + others.size
    acting, balance = unknowns.unit_responses(others, np.zeros(others.size))
    right = np.eye(unknowns.size, size)
    right[count:, :count], right[count:, count:end], right[count:, end:] = 0.0, -balance, np.eye(len(balance))
    right[:count, count:end] = -acting[unknowns.rows]
    found = unknowns.solve(right)
    matrix[:count], matrix[end:] = found[:count], found[count:]
    matrix[count:end] = unknowns.at_others(found, np.zeros((others.size, size)))
    matrix[count:end, count:end] += acting[others]
    return table if _holds(system, closed, table) else None


def _fill_in_laminate(system: System, closed: np.ndarray, table: HeldTable) -> bool:
    """Fill the matrix of a table whose closed nodes are neighbours in a laminate.

    Returns whether the nodes hold the pin so well that few digits are lost.
    """
    count, end, matrix = 2 * int(closed.sum()), 2 * closed.size, table.matrix
    rows, others = table.stack[:count], table.stack[count:end]
    neighbours = Neighbours.of(system, int(rows[0]), count // 2)
    core = neighbours.core
    motion, equilibrium = system.motion[rows], system.equilibrium[:, rows]
    moved = core @ motion
    complement = system.motion_rows - equilibrium @ moved
    try:
        small = np.linalg.inv(complement)  # the motion by the forces, while the closed nodes stick
    except np.linalg.LinAlgError:
        return False
    if not np.linalg.norm(complement) * np.linalg.norm(small) < MOST_CONDITION:
        return False
    responses = neighbours.responses()
    free, tied, acting = -responses, responses.T, neighbours.complement()
    moving = np.empty((len(small), len(matrix)))
    moving[:, :count] = -small @ (equilibrium @ core)
    moving[:, count:end] = -small @ (system.equilibrium[:, others] + equilibrium @ free)
    moving[:, end:] = small
    matrix[:count, :count] = core.T  # it is symmetric
    matrix[:count, count:end] = free
    matrix[count:end, :count] = tied
    matrix[count:end, count:end] = acting
    matrix[end:], matrix[:, end:] = 0.0, 0.0
    turned = np.concatenate([-moved, system.motion[others] - tied @ motion, np.eye(len(small))])
    blas.dgemm(1.0, turned, moving, beta=1.0, c=matrix, overwrite_c=1)
    return _holds(system, closed, table)


def _holds(system: System, closed: np.ndarray, table: HeldTable) -> bool:
    """Whether the answer of a table to one load meets the equations of the closed nodes and of equilibrium."""
    n, both = closed.size, np.concatenate([closed, closed])
    given = np.cos(np.arange(float(len(table.matrix))))
    given[: 2 * n] *= both
    answer = (table.matrix @ given[table.stack])[table.order]
    tractions = answer[: 2 * n] * both
    true = system.operator @ tractions + system.motion @ answer[2 * n :]
    balance = system.equilibrium @ tractions + system.motion_rows @ answer[2 * n :]
    error = max(float(np.abs((true - given[: 2 * n]) * both).max()), float(np.abs(balance - given[2 * n :]).max()))
    return error < MOST_RESIDUAL


class HeldColumns:
    """The tableau of :func:`fastpin.kernels.exchange.follow`, which begins with all closed nodes held.

    Parameters
    ----------
    system : System
    table : HeldTable
        It is not changed.
    contact : Contact
        The configuration.
    before, load_rate : ndarray, shape (loads,)
        Dimensionless load at the start, and its change along the step.
    rest_gap : ndarray, shape (n,)
    memory : TableauMemory
        Memory for the updates. It is overwritten.

    Attributes
    ----------
    tableau : Tableau
    turned : bool
        Whether the load has turned: most slipping nodes stick when the load goes on. It is known once the step has
        begun.
    """

    def __init__(
        self, system: System, table: HeldTable, contact: Contact, before: np.ndarray, load_rate: np.ndarray,
        rest_gap: np.ndarray, memory: TableauMemory,
    ) -> None:  # fmt: skip
        n = system.grid.size
        self._system, self._memory, self._contact, self._rest_gap = system, memory, contact, rest_gap
        self._before, self._rate = before, load_rate
        self._has_begun = self.turned = False
        if memory.held is None:
            memory.held = memory.blank._replace(
                order=table.order, fresh=np.zeros(-(-2 * n // WIDTH), dtype=np.int64), rates=np.empty(table.order.size),
                tied=np.empty(n), drag=np.empty(n), chunk=memory.left.shape[1] + 1,
            )  # fmt: skip
        self.tableau = memory.held
        self._begin(table, 0)

    def follow(self, load: LoadTerms, queue: Queue, stop: float, most_events: int, all_at_once: int) -> int:
        """Follow the load up to the fraction `stop` of the step, and return the code of the kernel.

        The first call begins the step: it sets the ties in the contact, and lets go the nodes that go on slipping.
        After many updates the nodes that are closed then are held, and the step goes on from there.
        """
        system, contact, status = self._system, self._contact, self._contact.status
        self._corrected = ContactValues._make([*np.empty((4, status.size)), status.copy(), contact.motion.copy()])
        before: np.ndarray | None = None
        while True:
            code, turned, self._errors = held.step(
                not self._has_begun, self._table.stack, system.operator.matrix, system.equations,
                system.fixed, system.operator.typical, self._before, self._rate, self._before + stop * self._rate,
                self._rest_gap, contact, self.tableau, load, queue, stop, most_events, all_at_once, self._corrected,
            )  # fmt: skip
            self.turned, self._has_begun, events = self.turned or turned, True, int(queue.counts[EVENTS])
            is_stuck = events == self._events
            if before is not None and is_stuck and code != REACHED:  # the slipping nodes can't be let go one by one
                contact.status[:], code = before, REBUILD
                queue.counts[[QUEUED, NEXT, ROUND]] = 0
            table = None if code != REBUILD or is_stuck else known_table(system, contact.status != OPEN)
            if table is None:
                return int(code)
            before = contact.status.copy()
            queue.counts[[UPDATES, QUEUED, NEXT, ROUND]] = 0
            self._begin(table, events)

    def _begin(self, table: HeldTable, events: int) -> None:
        """Begin with the nodes held that are closed after so many `events` of the step."""
        room = np.count_nonzero(self._contact.status & 1) + MOST_UPDATES  # statuses of slipping nodes are odd
        self._table, self._events, self._has_begun = table, events, False
        self.tableau = self.tableau._replace(matrix=table.matrix, order=table.order, left=self._memory.left[:, :room])

    def correct(self, now: Configuration) -> Correction:
        """Correct tractions and motion of `now`, at the stop that was reached, to rounding."""
        error, drift, *beyond = self._errors
        values = {**self._corrected._asdict(), "load": now.load.copy(), "slip_tally": now.slip_tally.copy()}
        return Correction(now.changed(**values), error, drift, (beyond[0], beyond[1]))


def blank_terms(system: System, rate: np.ndarray) -> LoadTerms:
    """The terms of the work along a straight change `rate` (loads,) of the load. Its columns and forces are not set."""
    (column, column_rate), (force, force_rate) = np.empty((2, 2 * system.grid.size)), np.empty((2, 2))
    reactions = system.drive.reaction_terms(system.both_weights, rate)
    return LoadTerms(column, column_rate, force, force_rate, system.weights, system.levers, system.stops, reactions)

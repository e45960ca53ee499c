"""Interfaces that feel each other through few numbers only, their ports; and the tableau of such interfaces.

The tractions of an interface act on all others through a few sums, the outputs: resultants, and the harmonics that the
other holes of its plate feel. A few numbers move an interface from outside, the inputs: its motion, and harmonics from
the other holes. Outputs and inputs of all interfaces are tied by one small set of equations,

    [motion_rows, 0; 0, 1] @ (motion, harmonics) + couplings @ outputs = (forces, 0).

So the tableau is a table for each interface, and the answers of these equations. A change of status is an update of
rank one of one table, and of the answers.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fastpin.elasticity.operator import Operator
from fastpin.elasticity.system import System
from fastpin.kernels import ports as kernels
from fastpin.kernels.arrays import Contact, LoadTerms, PortTables, Queue
from fastpin.kernels.exchange import CHUNK, UPDATES
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.extensions import lapack
from fastpin.runtime.products import add_product
from fastpin.solver.tableau import Columns, TableauMemory, expected_ties
from fastpin.solver.unknowns import SINGULAR


class Ports(Operator):
    """The operator of S interfaces of k nodes, each with p outputs and q inputs. Nothing between two of them is stored.

    All is dimensionless.

    Parameters
    ----------
    rows : ndarray of int, shape (S, 2k)
        Rows of each interface among (N, T) of all nodes.
    tables : ndarray, shape (S, 2k+p, 2k+q)
        Map (N, T) and the inputs of an interface to its (h, s) and outputs.
    motions : int
        Number of motions; the harmonics follow them.
    inputs : ndarray of int, shape (S, q)
        Places of the inputs among the motions and harmonics.
    couplings : ndarray, shape (g, S p)
        Map the outputs of all interfaces to the g equations of motions and harmonics.
    plates : sequence of list of int
        The interfaces of each plate. Only these feel the harmonics of one another.

    Attributes
    ----------
    place : ndarray of int, shape (2n,)
        The place of each row of all nodes among the rows of the interfaces.
    """

    is_quick = True
    by_distance = False

    def __init__(
        self,
        rows: np.ndarray,
        tables: np.ndarray,
        motions: int,
        inputs: np.ndarray,
        couplings: np.ndarray,
        plates: Sequence[list[int]],
    ) -> None:
        super().__init__(rows.size)
        self.rows, self.tables, self.motions, self.inputs, self.couplings = rows, tables, motions, inputs, couplings
        self.plates = plates
        self.place = np.argsort(rows.ravel())

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        count, nodes = self.rows.shape
        found = self.tables[:, :, :nodes] @ tractions[self.rows].reshape(count, nodes, -1)
        felt = -self.couplings @ found[:, nodes:].reshape(self.couplings.shape[1], -1)
        felt[: self.motions] = 0.0
        moved = found[:, :nodes] + self.tables[:, :nodes, nodes:] @ felt[self.inputs]
        return np.asarray(moved.reshape(self.size, -1)[self.place].reshape(tractions.shape))

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        together = 256  # bounds the memory
        for begin in range(0, columns.size, together):
            part = columns[begin : begin + together]
            unit = np.zeros((self.size, part.size))
            unit[part, np.arange(part.size)] = 1.0
            out[:, begin : begin + together] = (self @ unit)[rows]

    def softened(self, softness: np.ndarray) -> Ports:
        """The same with nodes that are softer: a pressure also opens the gap at its own node, by `softness` (n,)."""
        tables, half = self.tables.copy(), self.rows.shape[1] // 2
        own = np.arange(half)
        tables[:, own, own] += softness[self.rows[:, :half]]
        return Ports(self.rows, tables, self.motions, self.inputs, self.couplings, self.plates)

    def diagonal(self) -> np.ndarray:
        own = np.arange(self.rows.shape[1])
        return np.asarray(self.tables[:, own, own].ravel()[self.place])


class PortColumns(Columns):
    """The tableau of a system with ports, begun from the statuses of a contact.

    Parameters
    ----------
    system : System
    ports : Ports
    contact, load_rate, memory, room
        See :class:`Columns`.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the closed nodes can't hold all pins.
    """

    def __init__(
        self,
        system: System,
        ports: Ports,
        contact: Contact,
        load_rate: np.ndarray,
        memory: TableauMemory,
        room: int | None = None,
    ) -> None:
        n = system.grid.size
        self._system, self._ports, self._contact = system, ports, contact
        self._updates = 0
        status = contact.status
        self._coupling = np.where(np.abs(status) == 1, system.friction * status, 0.0)  # T = tau - coupling N
        dependent = np.r_[status != OPEN, status == STICK]
        self._tables = self._held(dependent)
        self._answers = self._joined()
        rows, columns = self._answers.shape
        self._left, self._right = np.empty((CHUNK, rows)), np.empty((CHUNK, columns))  # changes of the answers
        self._counts = np.array([0, 0, -1])
        displaced = system.load_displacement(load_rate)
        given = np.r_[np.where(dependent, -displaced, 0.0), system.load_forces(load_rate)]
        rates = self.response(given, 0)
        rates[: 2 * n] += np.where(dependent, 0.0, displaced)
        self._tie_all(rates)
        fresh = np.full(2 * n, -1)
        self.tableau = memory.blank._replace(left=memory.left[:, :room], rates=rates, fresh=fresh, chunk=1, width=1)
        self._arrays = PortTables(
            ports.rows, ports.place, ports.inputs, self._tables, self._answers, self._left, self._right,
            self._coupling, np.empty(rows), self._counts,
        )  # fmt: skip

    def follow(self, load: LoadTerms, queue: Queue, stop: float, most_events: int, all_at_once: int) -> int:
        system = self._system
        code = kernels.follow(
            self._arrays, self.tableau, self._contact, load, queue, system.friction, system.fixed,
            system.operator.typical, stop, most_events, all_at_once,
        )  # fmt: skip
        self._updates = int(queue.counts[UPDATES])
        return int(code)

    def refresh(self, asked: int, updates: int) -> None:
        """Make all `updates` in the tables. The kernel then computes the column `asked` itself."""
        self._catch_up(updates)

    def _catch_up(self, updates: int) -> None:
        """Make all `updates` in the tables, and add up the answers that wait when their room is full."""
        while not kernels.catch_up(self._arrays, self.tableau, updates):
            add_product(self._answers.T, self._right.T, np.asfortranarray(self._left))
            self._counts[kernels.WAITING] = 0

    def response(self, given: np.ndarray, updates: int) -> np.ndarray:
        if updates:
            self._catch_up(updates)
        rows, waiting = self._ports.rows, slice(0, self._counts[kernels.WAITING])
        nodes = rows.shape[1]
        own = (given[rows][:, None] @ self._tables[:, :nodes])[:, 0]
        acting = np.r_[-own[:, nodes:].ravel(), given[2 * self._coupling.size :]]
        moved = self._answers @ acting + (self._right[waiting] @ acting) @ self._left[waiting]
        values = own[:, :nodes] + (moved[self._ports.inputs][:, None] @ self._tables[:, nodes:, :nodes])[:, 0]
        return np.concatenate([values.ravel()[self._ports.place], moved[: self._system.motions]])

    def _held(self, dependent: np.ndarray) -> np.ndarray:
        """The tables of all interfaces, transposed, with the pairs `dependent` (2n,) exchanged. Other ties are 0.

        What an input moves then stands together in memory.
        """
        tables, rows = self._ports.tables.copy(), self._ports.rows
        half = rows.shape[1] // 2
        tables[:, :, :half] -= self._coupling[rows[:, :half]][:, None] * tables[:, :, half : 2 * half]
        for table, own in zip(tables, dependent[rows], strict=True):
            held = np.flatnonzero(own)
            columns, given = table[:, held], table[held]
            inverse = np.linalg.inv(columns[held])
            columns = columns @ inverse
            table -= columns @ given
            table[:, held], table[held] = columns, -inverse @ given
            table[np.ix_(held, held)] = inverse
        return np.ascontiguousarray(tables.transpose(0, 2, 1))

    def _joined(self) -> np.ndarray:
        """The motions and harmonics by outputs with the opposite sign, and by forces; (g, S p + m).

        The harmonics of each plate are eliminated on their own: those of two plates meet in the motions only.
        """
        ports, rows, nodes = self._ports, self._system.motion_rows, self._ports.rows.shape[1]
        m, matrix = len(rows), np.eye(len(ports.couplings))
        matrix[:m, :m] = rows
        for place, inputs in enumerate(ports.inputs):
            matrix[:, inputs] += ports.couplings[:, self._outputs(place)] @ self._tables[place, nodes:, nodes:].T
        answers = np.zeros((len(matrix), ports.couplings.shape[1] + m))
        left, right, of_plates = matrix[:m, :m], np.hstack([ports.couplings[:m], np.eye(m)]), []
        for places in ports.plates:
            felt, own = ports.inputs[places, 3:].ravel(), np.r_[*(self._outputs(place) for place in places)]
            found = np.linalg.solve(
                matrix[np.ix_(felt, felt)], np.hstack([matrix[felt, :m], ports.couplings[np.ix_(felt, own)]])
            )
            by_motion, by_outputs = found[:, :m], found[:, m:]
            left -= matrix[:m, felt] @ by_motion
            right[:, own] -= matrix[:m, felt] @ by_outputs
            of_plates.append((felt, own, by_motion, by_outputs))
        norm = float(lapack.dlange("1", left))
        factors, pivots, info = lapack.dgetrf(left)
        if info != 0 or not np.isfinite(norm) or not lapack.dgecon(factors, norm)[0] > SINGULAR:
            raise np.linalg.LinAlgError("nothing holds a pin or a plate")
        answers[:m] = lapack.dgetrs(factors, pivots, right)[0]
        for felt, own, by_motion, by_outputs in of_plates:
            answers[felt] = -by_motion @ answers[:m]
            answers[np.ix_(felt, own)] += by_outputs
        return answers

    def _outputs(self, place: int) -> slice:
        """The outputs of an interface among all."""
        count = self._tables.shape[2] - self._ports.rows.shape[1]
        return slice(place * count, (place + 1) * count)

    def _tie_all(self, rates: np.ndarray) -> None:
        """Tie the shear of open and sticking nodes to the pressure for the expected sense of slip."""
        contact, rows, n = self._contact, self._ports.rows, self._coupling.size
        stuck, is_open = contact.status == STICK, contact.status == OPEN
        contact.tie[:] = np.where(stuck | is_open, expected_ties(contact, rates), contact.status)
        self._coupling = self._system.friction * contact.tie
        half = rows.shape[1] // 2
        tied, drag = (np.where(nodes, self._coupling, 0.0)[rows[:, :half]] for nodes in (stuck, is_open))
        self._tables[:, :, half : 2 * half] += tied[:, None] * self._tables[:, :, :half]
        self._tables[:, :half] -= drag[:, :, None] * self._tables[:, half : 2 * half]
        rates[n : 2 * n] += np.where(stuck, self._coupling * rates[:n], 0.0)

"""The path solver: exact in load. Between two changes of status everything is linear, so it needs no increments.

:func:`fastpin.kernels.exchange.follow` follows the load from event to event. An event is a change of status. At every
stop, the end of the step included, the tractions are corrected until statuses, slip history and load hold to the last
digits. So rounding does not grow along a history, and a step depends only on the configuration at its start.

:class:`PathStep` follows one straight piece of a step. :mod:`fastpin.solver.path_stepper` makes one for each piece.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.operator import Operator
from fastpin.elasticity.system import System
from fastpin.kernels import conditions, exchange
from fastpin.kernels.arrays import Contact, ContactValues, Queue
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.loads import P, Q
from fastpin.solver.configuration import Configuration, Correction, snap_to_bounds, solve_unknowns
from fastpin.solver.held import FEW_NODES, HeldColumns, blank_terms, known_table
from fastpin.solver.settling import settle
from fastpin.solver.tableau import Columns, TableauMemory, has_turned
from fastpin.solver.unknowns import StickingRun

MOST_REBUILDS = 400
"""Rebuilds of the tableau in one piece of a step, and once more for each settling by Lemke's method, at most."""

MOST_EVENTS = 200
"""Events in one piece of a step, at most, for each node."""

MOST_DRIFT = 1e-10
"""Largest relative error of gap and slip, checked after every chunk of updates. Above it the tableau is rebuilt."""

SEVERE_DRIFT = 1e-6
"""Relative error of gap and slip with which events may have been missed. The step goes back to the last check."""

MOST_ERROR = 1e-12
"""Relative error that corrections may leave. Above it a factorisation computes the state anew."""


class StepLostError(Exception):
    """Internal: the step could not be followed to its end.

    Attributes
    ----------
    code : int
        A code of :mod:`fastpin.kernels.exchange`: NO_SUPPORT, CYCLING, ARC_END, ENDLESS or
        UNBONDED.
    fraction : float
        Fraction of the step that was followed.
    """

    def __init__(self, code: int, fraction: float) -> None:
        super().__init__(code, fraction)
        self.code = code
        self.fraction = fraction


class PathStep:
    """A straight change of the load, followed exactly: a step of the history, or a piece of one.

    Parameters
    ----------
    system : System
    configuration : Configuration
        The configuration at the start of the step, in contact. It is not changed.
    after : ndarray, shape (loads,)
        Dimensionless load at the end of the step.
    memory : TableauMemory, optional
        Memory for the tableau, for example from an earlier step.

    Attributes
    ----------
    now : Configuration
        The present configuration.
    before, rate : ndarray, shape (loads,)
        The load at the start, and its change along the step.
    rebuilds : int
        Tableaus built from the matrices, and states computed by a factorisation. The first tableau counts too, unless
        all closed nodes stick after a reversal.
    resettled : int
        Events at which Lemke's method found the statuses.
    """

    def __init__(
        self, system: System, configuration: Configuration, after: np.ndarray, memory: TableauMemory | None = None
    ) -> None:
        self.system = system
        self._memory = TableauMemory(system) if memory is None else memory
        self.now = configuration.copy()
        self.before = configuration.load.copy()
        self.rate = after - self.before
        n, now = system.grid.size, self.now
        self._contact, self._queue = _arrays_of(now)
        self._load = terms = blank_terms(system, self.rate)
        for load, column, force in ((self.before, *terms[:4:2]), (self.rate, *terms[1:4:2])):
            column[:], force[:] = system.both_weights * system.held_displacement(load), (load[Q], -load[P])
        self._all_at_once = max(32, n // 20)
        self._sample: slice | np.ndarray = slice(None)
        self._sampled: Operator | np.ndarray = system.operator
        if n > FEW_NODES and not system.operator.is_quick:
            nodes = np.unique(np.linspace(0, n - 1, 16).astype(int))  # compared with the matrices after every chunk
            rows = np.r_[nodes, n + nodes]
            self._sample, self._sampled = rows, system.operator.entries(rows=rows)
        self.rebuilds = 0
        self.resettled = 0
        self._room: int | None = None
        self._checked = configuration, self._queue.sums.copy()
        self._columns: Columns | HeldColumns
        self._first_status: np.ndarray | None = None  # while a held contact gets the statuses of the start
        table = known_table(system, now.closed)
        if table is not None:  # few nodes: all closed ones are held, and those that go on slipping are let go at once
            contact, rest_gap = self._contact, now.rest_gap
            self._columns = HeldColumns(system, table, contact, self.before, self.rate, rest_gap, self._memory)
            self._all_at_once = n  # one by one takes less time than a new tableau
            self._first_status = now.status.copy()
        elif (unknowns := self._sticking_after_reversal()) is not None:
            now.status[unknowns.normal] = STICK
            self._begin()
        else:
            self._rebuild()

    @property
    def fraction(self) -> float:
        """Fraction of the step that has been followed."""
        return float(self._queue.sums[exchange.TIME])

    @property
    def events(self) -> int:
        """Changes of status that the load has reached."""
        return int(self._queue.counts[exchange.EVENTS])

    @property
    def exchanges(self) -> int:
        """Exchanges that the tableau has made."""
        return int(self._queue.counts[exchange.EXCHANGES])

    @property
    def touched(self) -> np.ndarray:
        """Whether each node was ever closed during the step, bool, shape (n,)."""
        return self._contact.touched

    def follow(self, stop: float, report: Callable[[float], None] | None = None) -> Configuration:
        """Follow the step up to the fraction `stop` and return the configuration there.

        `report` is called now and then, with the fraction that was reached.

        Raises
        ------
        StepLostError
            If the load can't be followed any further.
        """
        system, counts = self.system, self._queue.counts
        most_events, checked, tries = MOST_EVENTS * system.grid.size, 0, 0
        while True:
            code = self._columns.follow(self._load, self._queue, stop, most_events, self._all_at_once)
            updates = int(counts[exchange.UPDATES])
            if self._is_stuck_at_start():
                self._start_anew()
            elif code == exchange.STALE:
                if updates // exchange.CHUNK > checked:
                    checked = updates // exchange.CHUNK
                    if report is not None:
                        report(self.fraction)
                    if self._repair():
                        checked = 0
                        continue
                    self._checked = self.now.copy(), self._queue.sums.copy()
                assert isinstance(self._columns, Columns)  # the table of a held contact is whole
                self._columns.refresh(int(counts[exchange.NEEDED_COLUMN]), updates)
            elif code in (exchange.REBUILD, exchange.ALL_AT_ONCE):
                if not (self._room is not None and self._drift() > SEVERE_DRIFT and self._go_back()):
                    self._book()
                    self._rebuild(all_at_once=code == exchange.ALL_AT_ONCE)
                checked = 0
            elif code == exchange.CYCLING:
                self._book()
                self._resettle()
                checked = 0
            elif code != exchange.REACHED:
                if not (self._drift() > SEVERE_DRIFT and self._go_back()):
                    self._book()
                    raise StepLostError(code, self.fraction)
                checked = 0
            else:
                self._book()
                if (correction := self._correct()) is None:
                    checked = 0
                    continue
                last = tries == 3
                if not exceeds_bounds(correction, last):
                    return correction.corrected
                if last:
                    raise StepLostError(exchange.CYCLING, self.fraction)
                # When a load is almost gone, rounding can keep a status too long. At its limit it changes at once.
                self._take(correction.corrected)
                tries += 1

    def _book(self) -> None:
        """Write load, work and dissipation into the present configuration."""
        self.now.load = self.before + self.fraction * self.rate
        _, self.now.dissipation, self.now.work, self.now.seat_dissipation = self._queue.sums.tolist()

    def _sticking_after_reversal(self) -> StickingRun | None:
        """The system with all closed nodes sticking, if the load has turned. Then most slipping nodes stick at once.

        None if the load has not turned, or if the closed nodes are no :class:`StickingRun`.
        """
        status = self.now.status
        unknowns = self._memory.sticking(self.system, np.where(status == OPEN, OPEN, STICK).astype(np.int8))
        if unknowns is None:
            return None
        rates = unknowns.rates(self.rate)
        normal, shear = rates[: unknowns.normal.size], rates[unknowns.normal.size : unknowns.count]
        closed = unknowns.normal
        return unknowns if has_turned(status[closed], normal, shear, self.system.friction[closed]) else None

    def _is_stuck_at_start(self) -> bool:
        """Whether the loop ended before all slipping nodes of a held contact were let go."""
        if self._first_status is None:
            return False
        counts = self._queue.counts
        assert isinstance(self._columns, HeldColumns)
        has_begun = self._columns.turned or counts[exchange.ROUND] > 0 or counts[exchange.EVENTS] > 0
        if has_begun or counts[exchange.NEXT] == counts[exchange.QUEUED]:
            self._first_status = None
        return self._first_status is not None

    def _start_anew(self) -> None:
        """Begin with the statuses of the start, factorised: a held contact can't reach them one by one."""
        assert self._first_status is not None
        self.now.status[:] = self._first_status
        self._first_status = None
        self._queue.counts[:] = 0
        self._rebuild()

    def _resettle(self) -> None:
        """Find the statuses after an event by Lemke's method, where their exchange has not settled."""
        status = settle(self.system, self.now, self.rate)
        self.resettled += 1
        if status is None or self.resettled > 20 * status.size:
            raise StepLostError(exchange.CYCLING, self.fraction)
        if np.any(status[self.system.ends] != OPEN):
            raise StepLostError(exchange.ARC_END, self.fraction)
        if np.any(status[self.system.bonded] != STICK):
            raise StepLostError(exchange.UNBONDED, self.fraction)
        counts = self._queue.counts
        counts[exchange.NEXT] = counts[exchange.QUEUED] = counts[exchange.ROUND] = 0
        counts[exchange.SETTLED] = 1
        counts[exchange.EXCHANGES] += np.count_nonzero(status != self.now.status)
        self.now.status[:] = status
        self._contact.touched[status != OPEN] = True
        self._rebuild()

    def _begin(self) -> bool:
        """Begin a new tableau from the present statuses. Returns whether the closed nodes hold the pin."""
        given = self._contact, self.rate, self._memory, self._room
        try:
            columns = self.system.columns(*given)
        except np.linalg.LinAlgError:
            return False
        if columns is None:
            unknowns = self._memory.solvable(self.system, self.now.status)
            if unknowns is None:
                return False
            columns = Columns(self.system, unknowns, *given)
        self._columns = columns
        self._queue.counts[exchange.UPDATES] = 0
        return True

    def _rebuild(self, all_at_once: bool = False) -> None:
        """Build the tableau of the present statuses from the matrices.

        After a change `all_at_once` that leaves the pin without support, the change is first taken back.
        """
        self.rebuilds += 1
        if self.rebuilds > MOST_REBUILDS * (1 + self.resettled):
            raise StepLostError(exchange.CYCLING, self.fraction)
        queue, is_held = self._queue, self._begin()
        if not is_held and all_at_once:
            # After the change all at once nothing holds the pin: change one by one instead.
            changed = slice(0, queue.counts[exchange.QUEUED])
            self.now.status[queue.node[changed]] = queue.status[changed]
            self._all_at_once = self.now.status.size
            queue.counts[exchange.NEXT] = queue.counts[exchange.QUEUED] = 0
            is_held = self._begin()
        if not is_held:
            raise StepLostError(exchange.NO_SUPPORT, self.fraction)

    def _drift(self) -> float:
        """Largest relative error of gap and slip at a sample of the nodes, from the matrices."""
        system, now, rows = self.system, self.now, self._sample
        load = self.before + self.fraction * self.rate
        elastic = self._sampled @ now.tractions
        true = elastic + system.motion[rows] @ now.motion + system.load_displacement(load, rows)
        nodes = rows if isinstance(rows, slice) else rows[: rows.size // 2]
        true[: true.size // 2] += now.rest_gap[nodes]
        return conditions.drift(elastic, true, now.gap[nodes], now.slip[nodes], now.motion, now.gap.max())

    def _go_back(self) -> bool:
        """Go back to the last configuration that was checked, and rebuild the tableau more often from there.

        Returns whether the tableau can be rebuilt more often than before.
        """
        smaller = [room for room in (24, 7) if self._room is None or room < self._room]  # updates before a rebuild
        if not smaller:
            return False
        self._room = smaller[0]
        configuration, sums = self._checked
        self._take(configuration)
        self._queue.sums[:] = sums
        counts = self._queue.counts
        counts[exchange.NEXT] = counts[exchange.QUEUED] = counts[exchange.ROUND] = counts[exchange.SETTLED] = 0
        self._book()
        self._rebuild()
        return True

    def _repair(self) -> bool:
        """Go back or compute the configuration anew, if its error is too large. Returns whether the tableau is new."""
        drift = self._drift()
        if drift > SEVERE_DRIFT and self._go_back():
            return True
        if drift <= MOST_DRIFT or self._mend_in_place():
            return False
        self._book()
        exact = self._exact_solution()
        if exact is not None:
            self._take(snap_to_bounds(self.system, self.now, exact))
        self._rebuild()
        return True

    def _mend_in_place(self) -> bool:
        """Correct configuration and rates by the tableau. Returns whether that was enough.

        It is not enough if the tableau itself has lost its digits. With few nodes a factorisation is made instead.
        """
        if self.system.operator.is_stored or not isinstance(self._columns, Columns):
            return False
        self._book()
        before = self.rebuilds
        correction = self._correct()
        if correction is None:
            return False
        self._take(correction.corrected)
        if self.rebuilds > before:
            return False
        self._columns.refine_rates(self.rate)
        return True

    def _take(self, better: Configuration) -> None:
        """Continue from better values of the present configuration."""
        for values, others in zip(self.now.values, better.values, strict=True):
            values[:] = others
        self.now.slip_tally.sums[:] = better.slip_tally.sums

    def _correct(self) -> Correction | None:
        """Correct the present tractions and motion until statuses, held slip and load hold to rounding.

        If the corrections leave more than MOST_ERROR, a factorisation computes the solution. None after a severe drift,
        if the step could go back.
        """
        correction = self._columns.correct(self.now)
        if correction.drift > SEVERE_DRIFT and self._go_back():
            return None
        if not correction.error <= MOST_ERROR:
            exact = self._exact_solution()
            if exact is not None:
                self.rebuilds += 1
                return Correction.of(self.system, self.now, exact, correction.error, correction.drift)
        return correction

    def _exact_solution(self) -> ContactValues | None:
        """The solution of the present statuses, by a factorisation; None if the closed nodes can't hold the pin."""
        now, unknowns = self.now, self._memory.dense(self.system, self.now.status)
        return None if unknowns is None else solve_unknowns(self.system, unknowns, now.slip, now.load, now.rest_gap)


class WholeStep(NamedTuple):
    """A step that was followed to its end.

    Attributes
    ----------
    now : Configuration
        The configuration at the end.
    touched : ndarray of bool, shape (n,)
        Whether each node was ever closed during the step.
    events, exchanges : int
        Changes of status that the load has reached, and exchanges that the tableau has made.
    """

    now: Configuration
    touched: np.ndarray
    events: int
    exchanges: int


def follow_whole(system: System, start: Configuration, after: np.ndarray, memory: TableauMemory) -> WholeStep | None:
    """Follow the load from a configuration in contact, which is not changed, to `after` (loads,), dimensionless.

    One call of the kernel goes from the held contact to the corrected end. Most steps of a history with few nodes need
    nothing else. None if the step needs more; a :class:`PathStep` then follows it from its start. It begins with the
    same calls, so a step has the same bits either way. The `memory` is overwritten.
    """
    n = start.status.size
    table = known_table(system, start.closed)
    if table is None:
        return None
    now, rate = start.copy(), after - start.load
    contact, queue = _arrays_of(now)
    columns = HeldColumns(system, table, contact, start.load, rate, start.rest_gap, memory)
    code = columns.follow(blank_terms(system, rate), queue, 1.0, MOST_EVENTS * n, n)
    if code != exchange.REACHED:
        return None
    now.load = after
    correction = columns.correct(now)
    if correction.drift > SEVERE_DRIFT or not correction.error <= MOST_ERROR or exceeds_bounds(correction):
        return None
    now, counts = correction.corrected, queue.counts
    _, now.dissipation, now.work, now.seat_dissipation = queue.sums.tolist()
    return WholeStep(now, contact.touched, int(counts[exchange.EVENTS]), int(counts[exchange.EXCHANGES]))


def _arrays_of(now: Configuration) -> tuple[Contact, Queue]:
    """The arrays on which kernels follow a step: those of the configuration `now`, and an empty queue."""
    n = now.status.size
    contact = Contact(
        now.pressure, now.shear, now.gap, now.slip, now.status, now.status.copy(), np.zeros(n, dtype=bool), now.motion,
        now.rest_slip, now.slip_tally.sums,
    )  # fmt: skip
    sums = np.array([0.0, now.dissipation, now.work, now.seat_dissipation])
    counts = np.zeros(exchange.COUNTS, dtype=np.int64)
    return contact, Queue(np.zeros(2 * n, dtype=np.int64), np.zeros(2 * n, dtype=np.int8), counts, sums)


def exceeds_bounds(correction: Correction, last: bool = False) -> bool:
    """Whether a correction exceeds the bounds of its statuses by more than rounding.

    At a stop where gaps have opened this instant, the largest gap is itself rounding. At the `last` trial rounding of
    the largest displacement counts, too.
    """
    corrected, (traction, gap) = correction.corrected, correction.beyond
    if traction > 0.0 and traction > MOST_DRIFT * corrected.pressure.max():
        return True
    length = max(float(np.abs(corrected.slip).max()), float(np.abs(corrected.motion).max())) if last else 0.0
    return bool(gap > conditions.ROUNDING * length and gap > MOST_DRIFT * corrected.gap.max())

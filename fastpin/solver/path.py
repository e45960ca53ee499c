"""The path solver: exact in load. Between two changes of status everything is linear, so no increment is ever cut.

A step of the history is followed from event to event by :func:`fastpin.tableau.follow`. At its end, and wherever a
state is asked for, the tractions are corrected until statuses, slip history and load hold to the last digits, so that
rounding does not grow along a history; and a step depends on nothing but the configuration at its start.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import exchange
from fastpin.kernels.status import OPEN, STICK
from fastpin.model.loads import M, P, Q
from fastpin.solver.configuration import Configuration, Solution, solve_statuses
from fastpin.solver.errors import CUT_OFF, ArcError, ConvergenceError, NoEquilibriumError, SolveError
from fastpin.solver.rest import release
from fastpin.solver.step import Piece, Position, Report, force_of, is_pushed
from fastpin.solver.tableau import Columns, TableauMemory
from fastpin.solver.unknowns import DenseUnknowns, StickingRun, solvable_unknowns

MOST_REBUILDS = 400
MOST_DRIFT = 1e-10
"""Relative error of gap and slip, checked after every chunk of updates, above which the tableau is built anew."""

ROUNDING = 5e-15
"""Relative error of gap, slip and equilibrium below which nothing is left to correct."""

MOST_ERROR = 1e-12
"""Relative error that corrections may leave; with more, a factorisation computes the state anew."""

MOST_SETTLINGS = 3
"""Times that statuses are settled anew at a stop, where the corrected state oversteps them."""

SAMPLED_NODES = 16
"""Nodes at which gap and slip are compared with the matrices after every chunk."""

FEW_NODES = 8
"""A contact of at most this many nodes that is lost during a complete unloading has just opened."""

NEGLIGIBLE = 1e-3
"""Part of a step's force below which a contact narrower than the grid is given up and looked for again."""

MOST_RELEASES = 20
"""Times that this may happen in one piece of a step."""

ALMOST_UNLOADED = 1.0 - 1e-8
"""Beyond this part of a complete unloading everything falls to zero together; the order of events is rounding."""


class StepLostError(Exception):
    """Internal: the step could not be followed; `code` is one of tableau.py."""

    def __init__(self, code: int, fraction: float) -> None:
        super().__init__(code, fraction)
        self.code = code
        self.fraction = fraction


class PathStep:
    """One straight step of the load history, followed exactly.

    Parameters
    ----------
    system : System
    configuration : Configuration
        Where the step starts; it is not changed. It must be in contact.
    after : ndarray, shape (6,)
        Dimensionless load at the end of the step.
    memory : Memory, optional
        For the tableau; of a step that has been followed.
    """

    def __init__(
        self, system: System, configuration: Configuration, after: np.ndarray, memory: TableauMemory | None = None
    ) -> None:
        self.system = system
        self._memory = TableauMemory(system.grid.size) if memory is None else memory
        self.now = configuration.copy()
        self.before = configuration.load.copy()
        self.rate = after - self.before
        n, now = system.grid.size, self.now
        weights = np.r_[system.weights, system.weights]
        self._contact = exchange.Contact(
            now.pressure,
            now.shear,
            now.gap,
            now.slip,
            now.status,
            now.status.copy(),
            np.zeros(n, dtype=bool),
            now.motion,
        )
        self._load = exchange.LoadTerms(
            column=weights * (system.loads @ self.before),
            column_rate=weights * (system.loads @ self.rate),
            force=np.array([self.before[Q], -self.before[P]]),
            force_rate=np.array([self.rate[Q], -self.rate[P]]),
            weights=system.weights,
        )
        self._queue = exchange.Queue(
            node=np.zeros(2 * n, dtype=np.int64),
            status=np.zeros(2 * n, dtype=np.int8),
            counts=np.zeros(exchange.COUNTS, dtype=np.int64),
            sums=np.zeros(exchange.SUMS),
        )
        self._queue.sums[exchange.DISSIPATION] = configuration.dissipation
        self._queue.sums[exchange.WORK] = configuration.work
        self._typical = float(np.median(np.abs(np.diagonal(system.operator))))
        self._all_at_once = max(32, n // 20)
        nodes = np.unique(np.linspace(0, n - 1, SAMPLED_NODES).astype(int))
        self._sample = np.r_[nodes, n + nodes]
        self._sampled = system.operator[self._sample]
        self.rebuilds = 0
        self._columns: Columns
        basis = self._sticking_after_reversal()
        if basis is None:
            self._rebuild()
        else:
            now.status[basis.normal] = STICK
            self._begin(basis)

    @property
    def fraction(self) -> float:
        """Fraction of the step that has been followed."""
        return float(self._queue.sums[exchange.TIME])

    @property
    def events(self) -> int:
        return int(self._queue.counts[exchange.EVENTS])

    @property
    def exchanges(self) -> int:
        return int(self._queue.counts[exchange.EXCHANGES])

    @property
    def touched(self) -> np.ndarray:
        """Nodes that were ever closed during the step."""
        return self._contact.touched

    def follow(self, stop: float, report: Callable[[float], None] | None = None) -> Configuration:
        """Follow the step up to the fraction `stop` and return the configuration there.

        `report` is called with the fraction reached now and then.

        Raises
        ------
        StepLostError
            If the load can't be followed any further.
        """
        system, counts = self.system, self._queue.counts
        n, checked, settlings = system.grid.size, 0, 0
        while True:
            code = exchange.follow(
                self._columns.tableau, self._contact, self._load, self._queue,
                system.friction, system.grid.closed, self._typical, stop, 1000 * n, self._all_at_once,
            )  # fmt: skip
            updates = int(counts[exchange.UPDATES])
            if code == exchange.STALE:
                if updates // exchange.CHUNK > checked:
                    checked = updates // exchange.CHUNK
                    if report is not None:
                        report(self.fraction)
                    if self._has_drifted():
                        self._mend()
                        checked = 0
                        continue
                self._columns.refresh(int(counts[exchange.NEEDED_COLUMN]), updates)
            elif code in (exchange.REBUILD, exchange.ALL_AT_ONCE):
                self._book()
                self._rebuild(all_at_once=code == exchange.ALL_AT_ONCE)
                checked = 0
            else:
                self._book()
                if code != exchange.REACHED:
                    raise StepLostError(code, self.fraction)
                solution = self._correct()
                settled = _snap_to_bounds(system, self.now, solution)
                if not _exceeds_bounds(settled, solution):
                    return settled
                if settlings == MOST_SETTLINGS:
                    raise StepLostError(exchange.CYCLING, self.fraction)
                # Rounding, when a load is almost gone, has kept a status too long: from its limit it changes at once.
                self._take(settled)
                settlings += 1

    def _book(self) -> None:
        """Write load, work and dissipation into the present configuration."""
        self.now.load = self.before + self.fraction * self.rate
        self.now.dissipation = float(self._queue.sums[exchange.DISSIPATION])
        self.now.work = float(self._queue.sums[exchange.WORK])

    def _sticking_after_reversal(self) -> StickingRun | None:
        """The set in which all closed nodes stick, if the load has turned so that most of the slipping ones do.

        None if it has not, or if that set can't be had fast.
        """
        status = self.now.status
        basis = StickingRun.of(self.system, np.where(status == OPEN, OPEN, STICK).astype(np.int8))
        if basis is None:
            return None
        rates = basis.rates(self.rate)
        normal, shear = rates[: basis.normal.size], rates[basis.normal.size : -3]
        slipping = np.abs(status[basis.normal]) == 1
        growth = -status[basis.normal] * shear - self.system.friction * normal
        if np.count_nonzero(growth[slipping] > 0.0) > np.count_nonzero(slipping) // 2:
            return None
        return basis

    def _begin(self, basis: StickingRun | DenseUnknowns) -> None:
        self._queue.counts[exchange.UPDATES] = 0
        self._columns = Columns(self.system, basis, self._contact, self.rate, self._memory)

    def _rebuild(self, all_at_once: bool = False) -> None:
        """Tableau of the present statuses from the matrices; after a `wholesale` change that can be taken back."""
        self.rebuilds += 1
        if self.rebuilds > MOST_REBUILDS:
            raise StepLostError(exchange.CYCLING, self.fraction)
        basis, queue = solvable_unknowns(self.system, self.now.status), self._queue
        if basis is None and all_at_once:
            # Changing all at once left nothing that holds the pin: change one by one instead.
            changed = slice(0, queue.counts[exchange.QUEUED])
            self.now.status[queue.node[changed]] = queue.status[changed]
            self._all_at_once = 2 * self.now.status.size
            queue.counts[exchange.NEXT] = queue.counts[exchange.QUEUED] = 0
            basis = solvable_unknowns(self.system, self.now.status)
        if basis is None:
            raise StepLostError(exchange.NO_SUPPORT, self.fraction)
        self._begin(basis)

    def _has_drifted(self) -> bool:
        """Whether gap and slip at a sample of the nodes have lost touch with the matrices."""
        system, now = self.system, self.now
        rows, load = self._sample, self.before + self.fraction * self.rate
        elastic = self._sampled @ np.r_[now.pressure, now.shear]
        true = elastic + system.motion[rows] @ now.motion + system.loads[rows] @ load
        true[: rows.size // 2] += now.rest_gap[rows[: rows.size // 2]]
        length = max(float(np.abs(elastic).max()), float(np.abs(now.motion).max()), 1e-4 * float(now.gap.max()))
        return not np.abs(true - np.r_[now.gap, now.slip][rows]).max() <= MOST_DRIFT * length

    def _mend(self) -> None:
        """Compute the present configuration anew, by a factorisation, and the tableau."""
        self._book()
        self._take(recompute(self.system, self.now))
        self._rebuild()

    def _take(self, better: Configuration) -> None:
        """Go on from better values of the present configuration."""
        for name in ("pressure", "shear", "gap", "slip", "motion"):
            getattr(self.now, name)[:] = getattr(better, name)

    def _correct(self) -> Solution:
        """The present tractions and motion, corrected until statuses, held slip and load hold to rounding."""
        system, now, n = self.system, self.now, self.system.grid.size
        pressure, shear, motion = now.pressure.copy(), now.shear.copy(), now.motion.copy()
        closed, stick = now.closed, now.status == STICK
        pressure[~closed] = shear[~closed] = 0.0
        slipping = closed & ~stick
        updates, last = int(self._queue.counts[exchange.UPDATES]), np.inf
        while True:
            tractions = np.r_[pressure, shear]
            elastic = system.operator @ tractions
            true = system.total_displacement(elastic, motion, now.load, now.rest_gap)
            balance = system.forces @ now.load - system.equilibrium @ tractions - system.motion_rows @ motion
            missing = np.r_[np.where(closed, -true[:n], 0.0), np.where(stick, now.slip - true[n:], 0.0), balance]
            # of the elastic part and of the force at work, however little is left of them in an unloading
            length = max(float(np.abs(elastic).max()), 1e-300)
            force = max(float((np.abs(system.equilibrium) @ np.abs(tractions)).max()), 1e-300)
            error = max(float(np.abs(missing[: 2 * n]).max()) / length, float(np.abs(balance).max()) / force)
            if error <= ROUNDING or not error < 0.5 * last:
                break
            last = error
            change = self._columns.response(missing, updates)
            pressure += np.where(closed, change[:n], 0.0)
            tied = change[n : 2 * n] - self._contact.tie * system.friction * change[:n]
            shear += np.where(stick, tied, 0.0)
            shear[slipping] = -system.friction * now.status[slipping] * pressure[slipping]
            motion += change[2 * n :]
        if not error <= MOST_ERROR:
            exact = solve_statuses(system, now.status, now.slip, now.load, now.rest_gap)
            if exact is not None:
                self.rebuilds += 1
                return exact
        return Solution(pressure, shear, true[:n], true[n:], motion)


def recompute(system: System, configuration: Configuration) -> Configuration:
    """The same configuration with its tractions, gap and slip computed anew from statuses, held slip and load."""
    solution = solve_statuses(
        system, configuration.status, configuration.slip, configuration.load, configuration.rest_gap
    )
    return configuration.copy() if solution is None else _snap_to_bounds(system, configuration, solution)


def _snap_to_bounds(system: System, configuration: Configuration, solution: Solution) -> Configuration:
    """The configuration with the solution of its statuses; what is beyond a bound, or almost at it, is put there."""
    new = configuration.copy()
    closed, stick = new.status != OPEN, new.status == STICK
    tiny = 1e-12 * max(float(np.abs(solution.pressure).max()), 1e-300)
    new.pressure = np.where(closed & (solution.pressure > tiny), solution.pressure, 0.0)
    bound = system.friction * new.pressure
    new.shear = np.where(closed, solution.shear, 0.0)
    near = stick & (np.abs(new.shear) > bound - tiny)
    new.shear = np.where(near, np.copysign(bound, new.shear), new.shear)
    new.shear = np.where(closed & (new.pressure == 0.0), 0.0, new.shear)
    shortest = 1e-12 * max(float(np.abs(solution.gap).max()), 1e-300)
    new.gap = np.where(closed | (solution.gap <= shortest), 0.0, solution.gap)
    new.slip = np.where(stick, new.slip, solution.slip)
    new.motion = solution.motion
    return new


def _exceeds_bounds(settled: Configuration, solution: Solution) -> bool:
    """Whether a solution was beyond the bounds of its statuses by more than rounding."""
    stick, gaping = settled.status == STICK, ~settled.closed
    traction, length = MOST_DRIFT * settled.pressure.max(), MOST_DRIFT * settled.gap.max()
    return bool(
        np.abs(settled.pressure - solution.pressure).max() > traction
        or np.abs(settled.shear - solution.shear)[stick].max(initial=0.0) > traction
        or np.abs(settled.gap - solution.gap)[gaping].max(initial=0.0) > length
    )


class PathStepper:
    """The path solver as a stepper: exact in load, from event to event.

    Parameters
    ----------
    system : System
    statistics : dict of str to float
        To which "events", "exchanges" and "rebuilds" are added.
    """

    def __init__(self, system: System, statistics: dict[str, float]) -> None:
        self._system = system
        self._statistics = statistics
        self._memory = TableauMemory(system.grid.size)
        self._step: PathStep | None = None
        self._begin = 0.0  # fraction of the history's step at which it starts
        self._releases = 0

    def begin_piece(self) -> None:
        """Get ready for another straight piece."""
        self._releases = 0

    def advance(self, position: Position, piece: Piece, stop: float, report: Report) -> None:
        """Follow a piece exactly, up to the fraction `stop` of the step or to where the contact is lost."""
        try:
            if self._step is None:
                self._begin = position.reached
                self._step = PathStep(self._system, position.now, piece.after, self._memory)
            begin, length = self._begin, piece.end - self._begin
            part = 1.0 if stop == piece.end else (stop - begin) / length
            position.now = self._step.follow(part, lambda done: report(begin + done * length))
            position.now.load = piece.load_at(stop)
        except StepLostError as lost:
            if self._step is not None:
                position.reached = self._begin + lost.fraction * (piece.end - self._begin)
                position.now = self._step.now
            if not self._has_just_opened(position.now, piece, lost):
                raise _solve_error(lost.code, position.now, self._system.problem.rotation == "fixed") from None
            self.leave(position)
            position.now = release(self._system, position.now, position.now.load)

    def leave(self, position: Position) -> None:
        """Forget the path that is being followed, note the nodes it touched, and count its events."""
        if self._step is None:
            return
        position.touched |= self._step.touched
        self._statistics["events"] += self._step.events
        self._statistics["exchanges"] += self._step.exchanges
        self._statistics["rebuilds"] += self._step.rebuilds
        self._step = None

    def _has_just_opened(self, now: Configuration, piece: Piece, lost: StepLostError) -> bool:
        """Whether a contact that lost its support has only become too small for the grid, or carried nothing."""
        if lost.code == exchange.ARC_END:
            return False
        unloading = not is_pushed(piece.after) and piece.after[M] == 0.0
        if unloading and lost.fraction > ALMOST_UNLOADED:
            return True
        if now.load[M] != 0.0 or int(now.closed.sum()) > FEW_NODES or self._releases == MOST_RELEASES:
            return False
        self._releases += 1
        return unloading or force_of(now.load) <= NEGLIGIBLE * max(force_of(piece.before), force_of(piece.after))


def _solve_error(code: int, lost: Configuration, held: bool) -> SolveError:
    """The error of a path that is lost at the configuration `lost`; `held` if the pin can't rotate freely."""
    closed = int(lost.closed.sum())
    if code == exchange.ARC_END:
        return ArcError(CUT_OFF)
    if closed < FEW_NODES // 2 or (held and closed <= FEW_NODES):
        return ConvergenceError(f"the contact has shrunk to {closed} nodes and is lost between them; use more nodes")
    if code == exchange.NO_SUPPORT:
        return NoEquilibriumError("nothing holds the pin any more: it spins, slides away or loses contact")
    return ConvergenceError("the stick and slip zones did not settle")

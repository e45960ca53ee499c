"""The path solver: exact in load. Between two changes of status everything is linear, so no increment is ever cut.

A step of the history is followed from event to event by :func:`fastpin.tableau.follow`. At its beginning and its end
the tractions are recomputed from the statuses and the slip history with one dense solve, so that rounding does not
grow along a history and a step depends on nothing but the configuration at its start.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import blas

from fastpin import tableau, toeplitz
from fastpin.collocation import ActiveSet, Configuration, P, Q, System
from fastpin.state import OPEN, STICK

BLOCK = 64
"""Rank-one updates applied to the tableau at a time."""

MOST_REBUILDS = 400
MOST_RESIDUAL = 1e-10
"""Of a fast inverse; with more, a factorisation takes its place."""


class PathStep:
    """One straight step of the load history, followed exactly.

    Parameters
    ----------
    system : System
    configuration : Configuration
        Where the step starts; it is not changed. It must be in contact.
    after : ndarray, shape (6,)
        Dimensionless load at the end of the step.
    """

    def __init__(self, system: System, configuration: Configuration, after: np.ndarray) -> None:
        self.system = system
        self.now = configuration.copy()
        self.before = configuration.load.copy()
        self.rate = after - self.before
        n = system.grid.size
        weights = np.r_[system.weights, system.weights]
        self._load_work = weights * (system.loads @ self.before)
        self._load_work_rate = weights * (system.loads @ self.rate)
        self._force = np.array([self.before[Q], -self.before[P]])
        self._force_rate = np.array([self.rate[Q], -self.rate[P]])
        self._typical = float(np.median(np.abs(np.diagonal(system.operator))))
        self._left = np.zeros((2 * n + 3, BLOCK), order="F")
        self._right = np.zeros((2 * n, BLOCK), order="F")
        self._queue = (np.zeros(2 * n, dtype=np.int64), np.zeros(2 * n, dtype=np.int8))
        self._counts = np.zeros(tableau.COUNTS, dtype=np.int64)
        self._sums = np.zeros(tableau.SUMS)
        self._sums[tableau.DISSIPATION] = configuration.dissipation
        self._sums[tableau.WORK] = configuration.work
        self.touched = np.zeros(n, dtype=bool)
        self.rebuilds = 0
        self._wholesale = max(32, n // 20)
        self._matrix: np.ndarray
        self._rates: np.ndarray
        if not self._begin_stuck():
            self._rebuild()

    @property
    def fraction(self) -> float:
        """Fraction of the step that has been followed."""
        return float(self._sums[tableau.TIME])

    @property
    def events(self) -> int:
        return int(self._counts[tableau.EVENTS])

    @property
    def exchanges(self) -> int:
        return int(self._counts[tableau.EXCHANGES])

    def follow(self, stop: float, report: Callable[[float], None] | None = None) -> Configuration:
        """Follow the step up to the fraction `stop` and return the configuration there.

        `report` is called with the fraction reached whenever a block of updates has been applied.

        Raises
        ------
        StepLostError
            If the load can't be followed any further.
        """
        system, now = self.system, self.now
        n = system.grid.size
        while True:
            checkpoint = now.status.copy()
            code = tableau.follow(
                self._matrix, self._left, self._right, self._rates,
                now.pressure, now.shear, now.gap, now.slip, now.motion, now.status,
                system.friction, system.weights,
                self._load_work, self._load_work_rate, self._force, self._force_rate,
                system.grid.closed, self._typical, stop,
                *self._queue, self.touched, self._counts, self._sums, 1000 * n, self._wholesale,
            )  # fmt: skip
            if code == tableau.FULL:
                self._apply_updates()
                if report is not None:
                    report(self.fraction)
            elif code == tableau.REBUILD:
                self._book()
                self._rebuild(checkpoint)
            elif code == tableau.REACHED:
                break
            else:
                self._book()
                raise StepLostError(code, self.fraction)
        self._book()
        return refined(system, now)

    def _book(self) -> None:
        """Write load, work and dissipation into the present configuration."""
        self.now.load = self.before + self.fraction * self.rate
        self.now.dissipation = float(self._sums[tableau.DISSIPATION])
        self.now.work = float(self._sums[tableau.WORK])

    def _begin_stuck(self) -> bool:
        """Begin with a tableau in which all closed nodes stick, if it can be had fast; else do nothing.

        If the load has turned, so that most of the slipping nodes would stick, they do. If not, they are queued to slip
        again, as long as that costs less than a factorisation.
        """
        status = self.now.status
        slipping = np.flatnonzero(np.abs(status) == 1)
        stuck = np.where(status == OPEN, OPEN, STICK).astype(np.int8)
        built = _stuck_tableau(self.system, stuck, self.rate)
        if built is None:
            return False
        rates, n = built[1], status.size
        growth = -status[slipping] * rates[n + slipping] - self.system.friction * rates[slipping]
        if np.count_nonzero(growth > 0.0) > slipping.size // 2:
            if slipping.size > n // 2:
                return False
            self._queue[0][: slipping.size], self._queue[1][: slipping.size] = slipping, status[slipping]
            self._counts[tableau.QUEUED] = slipping.size
        status[:] = stuck
        self._matrix, self._rates = built
        return True

    def _apply_updates(self) -> None:
        pending = int(self._counts[tableau.PENDING])
        if pending:
            self._matrix = blas.dgemm(
                1.0, self._left[:, :pending], self._right[:, :pending],
                beta=1.0, c=self._matrix, trans_b=1, overwrite_c=1,
            )  # fmt: skip
        self._counts[tableau.PENDING] = 0

    def _rebuild(self, fallback: np.ndarray | None = None) -> None:
        """Tableau of the present statuses from the matrices; `fallback` are statuses to go back to if it can't be."""
        self.rebuilds += 1
        self._counts[tableau.PENDING] = 0
        if self.rebuilds > MOST_REBUILDS:
            raise StepLostError(tableau.CYCLING, self.fraction)
        built = build_tableau(self.system, self.now.status, self.rate)
        if built is None and fallback is not None and not np.array_equal(fallback, self.now.status):
            # Changing all at once left nothing that holds the pin: change one by one instead.
            self.now.status[:] = fallback
            self._wholesale = 2 * self.now.status.size
            self._counts[tableau.NEXT] = self._counts[tableau.QUEUED] = 0
            built = build_tableau(self.system, self.now.status, self.rate)
        if built is None:
            raise StepLostError(tableau.NO_SUPPORT, self.fraction)
        self._matrix, self._rates = built


class StepLostError(Exception):
    """Internal: the step could not be followed; `code` is one of tableau.py."""

    def __init__(self, code: int, fraction: float) -> None:
        super().__init__(code, fraction)
        self.code = code
        self.fraction = fraction


def build_tableau(system: System, status: np.ndarray, load_rate: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Tableau (2n+3, 2n) and rates (2n+3,) for given statuses; None if the closed nodes can't hold the pin.

    The zero-rate variables of the unknown tractions' pairs are h and s, of the others N and tau.
    """
    built = _stuck_tableau(system, status, load_rate)
    if built is not None:
        return built
    active = ActiveSet(system, status)
    if active.singular:
        return None
    others = np.setdiff1d(np.arange(2 * system.grid.size), active.rows)
    tied = active.columns(system.operator, others)
    return _assembled(system, active.rows, others, active.inverse(), tied, load_rate)


def _stuck_tableau(system: System, status: np.ndarray, load_rate: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The tableau of equally spaced neighbours that all stick, fast; None if it can't be had in this way."""
    closed = np.flatnonzero(status != OPEN)
    if closed.size < 2 or not system.grid.uniform or system.friction == 0.0 or np.any(status[closed] != STICK):
        return None
    n, (low, high) = system.grid.size, closed[[0, -1]] + (0, 1)
    if high - low != closed.size or (not system.grid.closed and (low == 0 or high == n)):
        return None
    rows = np.r_[low:high, n + low : n + high]
    operator, count = system.operator, rows.size
    inverse = np.empty((count + 3, count + 3))
    core = toeplitz.inverse(operator[low:high, low], operator[n + low : n + high, n + low], operator[low:high, n + low])
    # The three motions and conditions of equilibrium, by the complement that they leave.
    motion, equilibrium = system.motion[rows], system.equilibrium[:, rows]
    moved, held = core @ motion, equilibrium @ core
    complement = system.motion_rows - equilibrium @ moved
    scale = np.abs(equilibrium) @ np.abs(moved)
    if not np.all(np.isfinite(complement)) or not np.linalg.cond(complement / scale.max()) < 1e8:
        return None
    small = np.linalg.inv(complement)
    inverse[:count, :count] = core + moved @ small @ held
    inverse[:count, count:] = -moved @ small
    inverse[count:, :count] = -small @ held
    inverse[count:, count:] = small
    probe, tractions = np.cos(np.arange(count + 3.0)), np.zeros(2 * n)
    found = inverse @ probe
    tractions[rows] = found[:count]
    displacement = system.displacement(tractions, found[count:], np.zeros_like(load_rate), 0.0)
    back = np.r_[displacement[rows], system.equilibrium @ tractions + system.motion_rows @ found[count:]]
    if not np.abs(back - probe).max() < MOST_RESIDUAL:
        return None
    others = np.setdiff1d(np.arange(2 * n), rows)
    return _assembled(system, rows, others, inverse, operator[np.ix_(others, rows)], load_rate)


def _assembled(
    system: System, rows: np.ndarray, others: np.ndarray, inverse: np.ndarray, tied: np.ndarray, load_rate: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Tableau and rates from the inverse of the system of the unknown tractions `rows` and the motion.

    `tied` are the columns of the operator for the unknown tractions, friction eliminated, at the `others`.
    """
    n, count = system.grid.size, rows.size
    given = np.empty((count + 3, others.size), order="F")  # effect of the other tractions on the held rows
    given[:count] = system.operator[np.ix_(rows, others)]
    given[count:] = system.equilibrium[:, others]
    response = inverse @ given
    tied = np.hstack([tied, system.motion[others]])

    matrix = np.empty((2 * n + 3, 2 * n), order="F")
    free = np.r_[rows, 2 * n + np.arange(3)]
    matrix[np.ix_(free, rows)] = inverse[:, :count]
    matrix[np.ix_(free, others)] = -response
    matrix[np.ix_(others, rows)] = tied @ inverse[:, :count]
    matrix[np.ix_(others, others)] = system.operator[np.ix_(others, others)] - tied @ response

    rates = np.zeros(2 * n + 3)
    change = system.loads @ load_rate
    rates[free] = inverse @ np.r_[-change[rows], system.forces @ load_rate]
    rates[others] = change[others] + tied @ rates[free]
    return matrix, rates


def refined(system: System, configuration: Configuration) -> Configuration:
    """The same configuration with its tractions, gap and slip recomputed from statuses, held slip and load."""
    solution = system.solve(configuration.status, configuration.slip, configuration.load, configuration.rest_gap)
    if solution is None:
        return configuration.copy()
    new = configuration.copy()
    closed, stick = new.status != OPEN, new.status == STICK
    tiny = 1e-12 * max(float(np.abs(solution.pressure).max()), 1e-300)
    new.pressure = np.where(closed & (np.abs(solution.pressure) > tiny), solution.pressure, 0.0)
    bound = system.friction * new.pressure
    new.shear = np.where(closed, solution.shear, 0.0)
    near = stick & (np.abs(new.shear) > bound - tiny)
    new.shear = np.where(near, np.copysign(bound, new.shear), new.shear)
    new.shear = np.where(closed & (new.pressure == 0.0), 0.0, new.shear)
    shortest = 1e-12 * max(float(np.abs(solution.gap).max()), 1e-300)
    new.gap = np.where(closed | (np.abs(solution.gap) <= shortest), 0.0, solution.gap)
    new.slip = np.where(stick, new.slip, solution.slip)
    new.motion = solution.motion
    return new

"""Statuses as the solution of a complementarity problem, where the exchange of violators does not settle.

At an event some nodes are *undecided*: the closed nodes at the limit of friction, and the nodes without pressure and
without gap. Their statuses in the next moment follow from a linear complementarity problem for the rates
(:func:`settle`). Lemke's method solves it. Where it has no solution, no state is near in the present direction: the
pin snaps, see :mod:`fastpin.solver.snap`. :class:`FiniteStep` solves the same problem for values instead of rates, at
all nodes.
"""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import complementarity
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.solver.configuration import (
    Configuration,
    Solution,
    accept_solution,
    resting_status,
    solve_statuses,
    solve_unknowns,
)
from fastpin.solver.unknowns import DenseUnknowns

MOST_VARIABLES = 1200
"""Variables of a complementarity problem, at most. Time and memory of a pivot grow with their square."""

MORE_NODES = 20
"""Nodes by which a contact may grow in one finite step, beyond twice its nodes."""


def lemke(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray | None:
    """Solve w = vector + matrix z, w >= 0, z >= 0, w z = 0 by Lemke's method.

    Returns z, shape (k,). None if the method ends on a ray, or if k is above :data:`MOST_VARIABLES`.
    """
    k = vector.size
    if k > MOST_VARIABLES:
        return None
    z = np.zeros(k)
    code = complementarity.lemke(
        matrix, vector, np.ones(k), 20 * k + 100, np.empty((k, 2 * k + 2)), np.empty(k, dtype=np.int64), z
    )
    return z if code == complementarity.SOLVED else None


def settle(system: System, now: Configuration, load_rate: np.ndarray) -> np.ndarray | None:
    """Find the statuses with which the contact goes on from an event.

    Parameters
    ----------
    system : System
    now : Configuration
        The contact at the event. Values at a limit are exactly at the limit.
    load_rate : ndarray, shape (loads,)
        Dimensionless, per unit of the step.

    Returns
    -------
    ndarray of int8, shape (n,), or None
        The statuses. None if Lemke's method finds no rates, or if the undecided nodes can't hold the pin.
    """
    n, mu = system.grid.size, system.friction
    closed = now.closed
    bare = np.where(closed, now.pressure == 0.0, now.gap == 0.0)
    limit = closed & ~bare & ((np.abs(now.status) == 1) | (np.abs(now.shear) >= mu * now.pressure)) & (mu > 0.0)
    status = np.where(bare | limit, resting_status(system), now.status).astype(np.int8)
    unknowns = DenseUnknowns(system, status)
    if unknowns.singular:
        return None
    first: np.ndarray = np.flatnonzero(limit)
    second: np.ndarray = np.flatnonzero(bare)
    if first.size + second.size == 0:
        return None
    # The sense of slip of each slipping variable, and the node and row (gap or slip) of each variable.
    sense = np.where(now.shear > 0.0, -1.0, 1.0)[first]
    if mu > 0.0:
        nodes = np.r_[first, second, second, second]
        factor = np.r_[sense, np.ones(2 * second.size), -np.ones(second.size)]
        rows = np.r_[n + first, second, n + second, n + second]
    else:
        nodes, rows, factor = second, second, np.ones(second.size)
    is_gap = rows < n
    positions = np.searchsorted(unknowns.rows, np.asarray(rows))
    answers = unknowns.held_columns(positions)[0][: unknowns.count] * factor
    rates = unknowns.rates(load_rate)[: unknowns.count]
    normal = np.searchsorted(unknowns.rows, nodes)
    reserve = np.where(is_gap, 1.0, mu)[:, None] * answers[normal]
    known = np.where(is_gap, 1.0, mu) * rates[normal]
    shears = np.flatnonzero(~is_gap)
    reserve[shears] += factor[shears, None] * answers[positions[shears]]
    known[shears] += factor[shears] * rates[positions[shears]]
    # Rates of tractions and of displacements have different sizes. Scaled, the covering vector of ones has a meaning.
    size = float(np.abs(known).max())
    z = lemke(np.ascontiguousarray(reserve), known / (size or 1.0))
    if z is None:
        return None
    found = status.copy()
    tolerance = 1e-11 * float(z.max(initial=0.0))
    slips = z > tolerance
    found[first] = np.where(slips[: first.size], sense, STICK)
    if mu == 0.0:
        found[second] = np.where(slips, OPEN, status[second])
        return found
    opens, forth, back = slips[first.size :].reshape(3, second.size)
    found[second] = np.select([opens, forth, back], [OPEN, SLIP_POSITIVE, SLIP_NEGATIVE], STICK)
    return found


class FiniteStep:
    """Steps from one configuration to a state at a finite distance, by Lemke's method for all nodes.

    All closed nodes stuck are the basis. With s = s+ - s- the slip since the start, the variables are

        closed nodes:  z = (h, s+, s-),            w = (N, mu N + T, mu N - T)
        open nodes:    z = (N, mu N + T, s-),      w = (h, s+, mu N - T)

    Without friction only the first of each three is there. Displacements are in units of a typical compliance.

    Parameters
    ----------
    system : System
    now : Configuration
        The configuration at the start. It is not changed.
    everywhere : bool
        Whether all nodes may close. If not, the contact may grow to twice its nodes and :data:`MORE_NODES` more.
    """

    def __init__(self, system: System, now: Configuration, everywhere: bool = False) -> None:
        n, mu = system.grid.size, system.friction
        self._system, self._now = system, now
        self._base = np.where(now.closed, resting_status(system), OPEN).astype(np.int8)
        self._unknowns = DenseUnknowns(system, self._base)
        self._length = float(np.median(np.abs(system.operator.diagonal())))
        self._closed = self._unknowns.normal
        away = np.flatnonzero(~now.closed)
        if not system.grid.closed:
            away = away[(away > 0) & (away < n - 1)]
        room = MOST_VARIABLES // (3 if mu > 0.0 else 1) - self._closed.size
        room = min(max(room, 0), system.grid.size if everywhere else self._closed.size + MORE_NODES)
        self._away = np.sort(away[np.argsort(now.gap[away], kind="stable")[:room]])
        if not self._unknowns.singular:
            self._matrix = self._complementarity_matrix()

    def to(self, load: np.ndarray) -> Configuration | None:
        """Find a state at `load`, shape (loads,), dimensionless.

        Returns
        -------
        Configuration or None
            The configuration at `load`, with the work and dissipation of the start. None if there is none, or if the
            closed nodes can't hold the pin.
        """
        system, now = self._system, self._now
        if self._unknowns.singular:
            return None
        resting = solve_unknowns(system, self._unknowns, now.slip, load, now.rest_gap)
        z = lemke(self._matrix, self._complementarity_vector(resting))
        if z is None:
            return None
        status = self._status(z)
        solution = solve_statuses(system, status, now.slip, load, now.rest_gap)
        return None if solution is None else accept_solution(now, solution, status, load)

    def _complementarity_matrix(self) -> np.ndarray:
        """Matrix (k, k) of the problem."""
        mu, length, a, b = self._system.friction, self._length, self._closed.size, self._away.size
        responses = self._responses()
        count = self._unknowns.count
        responses[:, :count] *= length
        responses[count:] /= length
        if mu == 0.0:
            return responses
        h, s, N, T = (responses[:, part] for part in np.split(np.arange(2 * a + 2 * b), [a, 2 * a, 2 * a + b]))
        columns = np.hstack([h, s, -s, N - mu * T, T, np.zeros((2 * a + 2 * b, b))])
        normal, shear, gap, slip = np.split(columns, [a, 2 * a, 2 * a + b])
        slip[:, 3 * a + 2 * b :] += np.eye(b)
        rest = np.zeros((b, columns.shape[1]))
        rest[:, 3 * a : 3 * a + b], rest[:, 3 * a + b : 3 * a + 2 * b] = 2.0 * mu * np.eye(b), -np.eye(b)
        return np.vstack([normal, mu * normal + shear, mu * normal - shear, gap, slip, rest])

    def _complementarity_vector(self, resting: Solution) -> np.ndarray:
        """Vector (k,) of the problem. `resting` is the solution with all closed nodes stuck."""
        mu, closed, away = self._system.friction, self._closed, self._away
        pressure, shear, gap = resting.pressure[closed], resting.shear[closed], resting.gap[away] / self._length
        if mu == 0.0:
            return np.r_[pressure, gap]
        slid = (resting.slip - self._now.slip)[away] / self._length
        return np.r_[pressure, mu * pressure + shear, mu * pressure - shear, gap, slid, np.zeros(away.size)]

    def _responses(self) -> np.ndarray:
        """Tractions of the closed nodes and displacements of the open ones, below one another.

        The columns are unit gaps and slips of the closed nodes, then unit tractions of the open nodes.
        """
        unknowns, n = self._unknowns, self._system.grid.size
        slots = self._away if self._system.friction == 0.0 else np.r_[self._away, n + self._away]
        places, count = np.searchsorted(unknowns.others, slots), unknowns.count
        held, beside = unknowns.held_columns(np.arange(count))
        given, further = unknowns.given_columns(slots, np.zeros(slots.size))
        return np.block([[held[:count], given[:count]], [beside[places], further[places]]])

    def _status(self, z: np.ndarray) -> np.ndarray:
        """The statuses of the solution `z` (k,)."""
        closed, away, status = self._closed, self._away, self._base.copy()
        a, b = closed.size, away.size
        positive = z > 1e-12 * float(z.max(initial=0.0))
        if self._system.friction == 0.0:
            status[closed[positive[:a]]] = OPEN
            status[away[positive[a:]]] = resting_status(self._system)
            return status
        opens, forth, back = positive[: 3 * a].reshape(3, a)
        status[closed] = np.select([opens, forth, back], [OPEN, SLIP_POSITIVE, SLIP_NEGATIVE], STICK)
        pressed, reserve, backwards = positive[3 * a :].reshape(3, b)
        status[away] = np.select([~pressed, backwards, reserve], [OPEN, SLIP_NEGATIVE, STICK], SLIP_POSITIVE)
        return status

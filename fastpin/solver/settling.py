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
    accept_solution,
    resting_status,
    solve_statuses,
    solve_unknowns,
)
from fastpin.solver.unknowns import DenseUnknowns

MOST_VARIABLES = 1200
"""Variables of a complementarity problem, at most. Time and memory of a pivot grow with their square."""


def lemke(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray | None:
    """Solve w = vector + matrix z, w >= 0, z >= 0, w z = 0 by Lemke's method.

    Returns z, shape (k,). None if the method ends on a ray, or if k is above :data:`MOST_VARIABLES`.
    """
    k = vector.size
    if k > MOST_VARIABLES:
        return None
    z = np.zeros(k)
    solved = complementarity.lemke(
        matrix, vector, np.ones(k), 20 * k + 100, np.empty((k, 2 * k + 2)), np.empty(k, dtype=np.int64), z
    )
    return z if solved else None


def settle(
    system: System, now: Configuration, load_rate: np.ndarray, growth: np.ndarray | None = None
) -> np.ndarray | None:
    """Find the statuses with which the contact goes on from an event.

    Parameters
    ----------
    system : System
    now : Configuration
        The contact at the event. Values at a limit are exactly at the limit.
    load_rate : ndarray, shape (loads,)
        Dimensionless, per unit of the step.
    growth : ndarray, shape (n,), optional
        Rate of the coefficient of friction. The limits then grow by it, too.

    Returns
    -------
    ndarray of int8, shape (n,), or None
        The statuses. None if Lemke's method finds no rates, or if the undecided nodes can't hold the pin.
    """
    n, mu = system.grid.size, system.friction
    closed = now.closed
    bare = np.where(closed, now.pressure == 0.0, now.gap == 0.0)
    rough = mu > 0.0
    limit = closed & ~bare & ((np.abs(now.status) == 1) | (np.abs(now.shear) >= mu * now.pressure)) & rough
    slippery = closed & ~rough & (now.status == STICK)
    status = np.where(bare | limit | slippery, resting_status(system), now.status)
    unknowns = DenseUnknowns(system, status)
    if unknowns.singular:
        return None
    first: np.ndarray = np.flatnonzero(limit)
    second: np.ndarray = np.flatnonzero(bare)
    rubbing = rough[second]
    third = second[rubbing]
    if first.size + second.size == 0:
        return status if slippery.any() else None
    # The sense of slip of each slipping variable, and the node and row (gap or slip) of each variable.
    sense = np.where(now.shear > 0.0, -1.0, 1.0)[first]
    nodes = np.concatenate([first, second, third, third])
    factor = np.r_[sense, np.ones(second.size + third.size), -np.ones(third.size)]
    rows = np.concatenate([n + first, second, n + third, n + third])
    reserve, known = _rate_problem(system, unknowns, load_rate, nodes, rows, factor)
    if growth is not None:
        known[: first.size] += growth[first] * now.pressure[first]
    # Rates of tractions and of displacements have different sizes. Scaled, the covering vector of ones has a meaning.
    size = float(np.abs(known).max())
    z = lemke(np.ascontiguousarray(reserve), known / (size or 1.0))
    if z is None:
        return None
    found = status.copy()
    tolerance = 1e-11 * float(z.max(initial=0.0))
    slips = z > tolerance
    found[first] = np.where(slips[: first.size], sense, STICK)
    opens, senses = np.split(slips[first.size :], [second.size])
    forth, back = senses.reshape(2, third.size)
    found[second] = np.where(opens, OPEN, status[second])
    found[third] = np.select([opens[rubbing], forth, back], [OPEN, SLIP_POSITIVE, SLIP_NEGATIVE], STICK)
    return found


def _rate_problem(
    system: System,
    unknowns: DenseUnknowns,
    load_rate: np.ndarray,
    nodes: np.ndarray,
    rows: np.ndarray,
    factor: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Matrix (k, k) and vector (k,) of the complementarity problem for rates.

    Each variable is `factor` (k,) times the rate of a gap or slip: of its node in `nodes` (k,), in its row of `rows`.
    Its reserve is a pressure, or mu N less the shear in the sense of the slip.
    """
    is_gap = rows < system.grid.size
    positions = np.searchsorted(unknowns.rows, rows)
    answers = unknowns.held_columns(positions)[0][: unknowns.count] * factor
    rates = unknowns.rates(load_rate)[: unknowns.count]
    normal = np.searchsorted(unknowns.rows, nodes)
    part = np.where(is_gap, 1.0, system.friction[nodes])
    reserve = part[:, None] * answers[normal]
    known = part * rates[normal]
    shears = np.flatnonzero(~is_gap)
    reserve[shears] += factor[shears, None] * answers[positions[shears]]
    known[shears] += factor[shears] * rates[positions[shears]]
    return reserve, known


class FiniteStep:
    """Steps from one configuration to a state at a finite distance, by Lemke's method for all nodes.

    All closed nodes stuck are the basis. With s = s+ - s- the slip since the start, the variables are

        closed nodes:  z = (h, s+, s-),            w = (N, mu N + T, mu N - T)
        open nodes:    z = (N, mu N + T, s-),      w = (h, s+, mu N - T)

    At nodes without friction only the first of each three is there. Displacements are in units of a typical compliance.

    Parameters
    ----------
    system : System
    now : Configuration
        The configuration at the start. It is not changed.
    everywhere : bool
        Whether all nodes may close. If not, the contact may grow to twice its nodes and 20 more.
    """

    def __init__(self, system: System, now: Configuration, everywhere: bool = False) -> None:
        self._system, self._now = system, now
        self._base = np.where(now.closed, resting_status(system), OPEN)
        self._unknowns = DenseUnknowns(system, self._base)
        self._length = float(np.median(np.abs(system.operator.diagonal())))
        self._closed = self._unknowns.normal
        away = np.flatnonzero(~now.closed)
        away = away[~system.ends[away]]
        room = MOST_VARIABLES // (3 if system.has_friction else 1) - self._closed.size
        room = min(max(room, 0), system.grid.size if everywhere else self._closed.size + 20)
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
        closed, away = self._closed, self._away
        (mu, rubbing), (_, rubbing_away) = self._friction(closed), self._friction(away)
        pressure, gap = resting.pressure[closed], resting.gap[away] / self._length
        bound, shear = mu * pressure[rubbing], resting.shear[closed[rubbing]]
        slid = (resting.slip - now.slip)[away[rubbing_away]] / self._length
        known = np.r_[pressure, bound + shear, bound - shear, gap, slid, np.zeros(slid.size)]
        z = lemke(self._matrix, known)
        if z is None:
            return None
        status, sizes = self._base.copy(), (closed.size, mu.size, mu.size, away.size, slid.size)
        positive = z > 1e-12 * float(z.max(initial=0.0))
        opens, forth, back, pressed, reserve, backwards = np.split(positive, np.cumsum(sizes))
        status[closed[opens]] = OPEN
        status[closed[rubbing]] = np.select([opens[rubbing], forth, back], [OPEN, SLIP_POSITIVE, SLIP_NEGATIVE], STICK)
        status[away[pressed]] = resting_status(system)[away[pressed]]
        senses = np.select([backwards, reserve], [SLIP_NEGATIVE, STICK], SLIP_POSITIVE)
        status[away[rubbing_away]] = np.where(pressed[rubbing_away], senses, OPEN)
        solution = solve_statuses(system, status, now.slip, load, now.rest_gap)
        return None if solution is None else accept_solution(now, solution, load)

    def _complementarity_matrix(self) -> np.ndarray:
        """Matrix (k, k) of the problem."""
        length, a, b, count = self._length, self._closed.size, self._away.size, self._unknowns.count
        mu, rubbing = self._friction(self._away)
        r = mu.size
        # Tractions of the closed nodes and displacements of the open ones, below one another. The columns are unit gaps
        # and slips of the closed nodes, then unit tractions of the open nodes.
        slots = np.concatenate([self._away, self._system.grid.size + self._away[rubbing]])
        places = np.searchsorted(self._unknowns.others, slots)
        held, beside = self._unknowns.held_columns(np.arange(count))
        given, further = self._unknowns.given_columns(slots, np.zeros(slots.size))
        responses = np.block([[held[:count], given[:count]], [beside[places], further[places]]])
        responses[:, :count] *= length
        responses[count:] /= length
        h, s, N, T = np.split(responses, [a, count, count + b], axis=1)
        N[:, rubbing] -= mu * T
        columns = np.hstack([h, s, -s, N, T, np.zeros((len(responses), r))])
        normal, shear, gap, slip = np.split(columns, [a, count, count + b])
        first, last = 2 * count - a, columns.shape[1] - r  # columns of N, and of the slip backwards
        slip[:, last:] += np.eye(r)
        rest = np.zeros((r, columns.shape[1]))
        rest[:, first + rubbing], rest[:, first + b : last] = 2.0 * mu * np.eye(r), -np.eye(r)
        mu, rubbing = self._friction(self._closed)
        bound = mu[:, None] * normal[rubbing]
        return np.vstack([normal, bound + shear, bound - shear, gap, slip, rest])

    def _friction(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients of friction (r,) where `nodes` have friction, and the places (r,) of these nodes in `nodes`."""
        mu = self._system.friction[nodes]
        rubbing = np.flatnonzero(mu)
        return mu[rubbing], rubbing

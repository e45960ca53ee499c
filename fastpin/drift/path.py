"""The path solver while the friction changes: exact in load and friction, from event to event.

At slipping nodes T = -sigma mu N. With a mu that varies along a step the equations of given statuses are
(A + t B) x = b + t c: everything is rational in the time t, and slip may turn round inside a step. The state at t does
not depend on the way, only on statuses and held slips. One factorisation gives the state, its rates and their rates,

    A(t) x' = c - B x,    A(t) x'' = -2 B x'.

The statuses hold as long as these functions are not negative:

    h at open nodes,  N at closed nodes,  mu N - T and mu N + T at sticking nodes,  sigma ds/dt at slipping nodes.

The first zero is an event. It is predicted by Newton's method and enclosed. There the statuses are settled as in
:mod:`fastpin.solver.settling`; a node whose slip has come to rest sticks first. Two zeros of a function between two
solutions are noticed by a third solution in their middle, and by the cubic through values and rates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import exchange
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.solver.configuration import (
    Configuration,
    dissipation_between,
    seat_dissipation_between,
    slip_tally_between,
    snap_to_bounds,
    solve_unknowns,
    work_between,
)
from fastpin.solver.path import MOST_EVENTS, StepLostError
from fastpin.solver.settling import settle
from fastpin.solver.unknowns import DenseUnknowns

LIMIT = 1e-13
"""Part of the largest pressure, displacement or rate. A function below it is at its limit."""

BROKEN = 1e-10
"""Part of the largest pressure, displacement or rate. A function below minus this part is no rounding."""

FALLING = 1e-10
"""Part of the largest rate. A function at its limit that falls faster ends its status."""

SAME_TIME = 1e-14
"""Distance of two solutions that enclose an event, at most."""

MOST_BEND = 1e-7
"""Largest difference of a solution from the cubic through its neighbours, relative. Beyond, the stretch is halved."""


@dataclass(frozen=True, eq=False)
class DriftingSystem(System):
    """A system whose friction goes to `later` (n,). One more load, the last one, says how far, from 0 to 1."""

    later: np.ndarray = field(kw_only=True)

    @classmethod
    def between(cls, first: System, later: np.ndarray) -> DriftingSystem:
        """The system `first` while its friction goes to `later` (n,)."""
        return cls(**{each.name: getattr(first, each.name) for each in fields(first)}, later=later)

    def under(self, load: np.ndarray) -> System:
        part = float(load[-1])
        return self.with_friction((1.0 - part) * self.friction + part * self.later)


class Moment:
    """The solution of given statuses at one time of a path, its rates, and the rates of these.

    Parameters
    ----------
    path : DriftPath
    time : float
    status, slip : ndarray, shape (n,)
        The statuses, and the slip that sticking nodes hold.

    Attributes
    ----------
    system : System
        With the friction at this time.
    solution, rates, bends : ContactValues
        Values, first and second derivatives.
    """

    def __init__(self, path: DriftPath, time: float, status: np.ndarray, slip: np.ndarray) -> None:
        self.time, self.status, self.slip = time, status, slip
        self.system = path.system_at(time)
        unknowns = DenseUnknowns(self.system, status)
        if unknowns.singular:
            raise StepLostError(exchange.NO_SUPPORT, path.fraction)
        self._growth = path.growth
        dragging = np.where(np.abs(status) == 1, -status * path.growth, 0.0)  # T' of slipping nodes, beside mu N'
        self.solution = solve_unknowns(self.system, unknowns, slip, path.load_at(time), path.now.rest_gap)
        self.rates = _rates(self.system, unknowns, path.rate, dragging * self.solution.pressure)
        self.bends = _rates(self.system, unknowns, np.zeros_like(path.rate), 2.0 * dragging * self.rates.pressure)

    @cached_property
    def scales(self) -> list[tuple[float, float]]:
        """Largest traction and displacement of the solution, of its rates, and of the rates of these.

        A displacement that is small against the force of the tractions is rounding.
        """
        found = []
        for each in (self.solution, self.rates, self.bends):
            traction = max(float(np.abs(each.pressure).max()), float(np.abs(each.shear).max()))
            force = float(self.system.weights @ (np.abs(each.pressure) + np.abs(each.shear)))
            length = max(float(np.abs(each.gap).max()), float(np.abs(each.slip).max()), force)
            found.append((traction or 1.0, length or 1.0))
        return found

    @cached_property
    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Sizes of the functions and of their rates, shape (4, n)."""
        (traction, length), (traction_rate, length_rate), (_, bend) = self.scales
        is_open, one = self.status == OPEN, np.ones(self.status.size)
        gaps = 0.1 * length  # an overlap that is left when a node closes becomes a pressure
        of_values = np.array([np.where(is_open, gaps, traction), *[traction * one] * 2, length_rate * one])
        traction_rate = max(traction_rate, float(np.abs(self._growth).max()) * traction)
        of_rates = np.array([np.where(is_open, length_rate, traction_rate), *[traction_rate * one] * 2, bend * one])
        return of_values, of_rates

    @cached_property
    def functions(self) -> tuple[np.ndarray, np.ndarray]:
        """The functions that must not be negative, and their rates, shape (4, n), in parts of their sizes.

        Their rows are the gap or the pressure, the reserves mu N - T and mu N + T, and the speed of slip. A function
        that a node does not have is infinite.
        """
        values, rates, bends, mu = self.solution, self.rates, self.bends, self.system.friction
        is_open, stick = self.status == OPEN, self.status == STICK
        slips = (np.abs(self.status) == 1) & (mu > 0.0)
        bound, growing = mu * values.pressure, mu * rates.pressure + self._growth * values.pressure
        found = np.array(
            [
                np.where(is_open, values.gap, values.pressure),
                np.where(stick, bound - values.shear, np.inf),
                np.where(stick, bound + values.shear, np.inf),
                np.where(slips, self.status * rates.slip, np.inf),
            ]
        )
        change = np.array(
            [
                np.where(is_open, rates.gap, rates.pressure),
                np.where(stick, growing - rates.shear, 0.0),
                np.where(stick, growing + rates.shear, 0.0),
                np.where(slips, self.status * bends.slip, 0.0),
            ]
        )
        return found / self.sizes[0], change / self.sizes[1]

    @cached_property
    def broken(self) -> np.ndarray:
        """Whether each function is negative, bool, shape (4, n): by more than rounding, or still falling."""
        values, rates = self.functions
        return (values < -BROKEN) | ((values < -LIMIT) & (rates < -FALLING))

    @cached_property
    def ending(self) -> np.ndarray:
        """Whether each function is at its limit and falls, bool, shape (4, n)."""
        values, rates = self.functions
        return (values <= LIMIT) & (rates < -FALLING)

    @property
    def holds(self) -> bool:
        """Whether the contact goes on with the statuses."""
        return not (self.broken.any() or self.ending.any())

    def first_zero(self, among: np.ndarray) -> float:
        """The distance to the first zero of some functions, bool (4, n), by their tangents; infinite without one."""
        (values, rates), (size, rate_size) = self.functions, self.sizes
        falls = among & (rates < 0.0)
        distances = values[falls] * size[falls] / (-rates[falls] * rate_size[falls])
        return float(distances.min(initial=np.inf))


class DriftPath:
    """A straight change of load and friction, followed exactly. It answers as :class:`fastpin.solver.path.PathStep`.

    Parameters
    ----------
    system : System
        With the friction at the start of the path.
    configuration : Configuration
        The configuration there, in contact. It is not changed.
    after : ndarray, shape (loads,)
        Dimensionless load at the end of the path.
    friction : ndarray, shape (n,)
        Coefficient of friction there.

    Attributes
    ----------
    now : Configuration
        The present configuration.
    fraction : float
        Fraction of the path that has been followed.
    rate : ndarray, shape (loads,)
        Change of the load along the path.
    growth : ndarray, shape (n,)
        Change of the friction along the path.
    touched : ndarray of bool, shape (n,)
        Whether each node was ever closed.
    events, exchanges, rebuilds, resettled : int
        Counts as those of a :class:`fastpin.solver.path.PathStep`. Each solution counts as a rebuild.
    """

    def __init__(self, system: System, configuration: Configuration, after: np.ndarray, friction: np.ndarray) -> None:
        self._system, self._before = system, configuration.load.copy()
        self.now = configuration.copy()
        self.rate, self.growth = after - configuration.load, friction - system.friction
        self.fraction = 0.0
        self.touched = configuration.closed.copy()
        self.events = self.exchanges = self.rebuilds = self.resettled = 0
        self._here: Moment | None = None

    def load_at(self, time: float) -> np.ndarray:
        """The dimensionless load (loads,) at a time from 0 to 1."""
        return self._before + time * self.rate

    def system_at(self, time: float) -> System:
        """The system with the friction at a time from 0 to 1."""
        return self._system.with_friction(self._system.friction + time * self.growth)

    def follow(self, stop: float, report: Callable[[float], None] | None = None) -> Configuration:
        """Follow the path up to the fraction `stop` and return the configuration there.

        `report` is called now and then, with the fraction that was reached.

        Raises
        ------
        StepLostError
            If the path can't be followed any further.
        """
        if self._here is None:
            self._here = self._settled(self._moment(self.fraction), np.zeros((4, self.now.status.size), dtype=bool))
        tried = {self._here.status.tobytes()}  # at this fraction
        while self.fraction < stop:
            before = self.fraction
            end, broken = self._stretch(self._here, stop)
            if end is not self._here:
                self._go(self._here, end)
            if broken.any() or end.ending.any():
                self.events += 1
                self._here = self._settled(end, broken)
            if self.fraction > before:
                tried.clear()
            status = self._here.status.tobytes()
            # What follows depends on the time and the statuses alone: statuses that come back come back for ever.
            if status in tried or len(tried) > self.now.status.size:
                raise StepLostError(exchange.CYCLING, self.fraction)
            tried.add(status)
            if self.events > MOST_EVENTS * self.now.status.size:
                raise StepLostError(exchange.ENDLESS, self.fraction)
            if report is not None:
                report(self.fraction)
        return self.now

    def _moment(self, time: float, status: np.ndarray | None = None) -> Moment:
        """The moment of the present statuses, or of others, with the slip that is held now."""
        self.rebuilds += 1
        return Moment(self, time, self.now.status if status is None else status, self.now.slip)

    def _stretch(self, here: Moment, stop: float) -> tuple[Moment, np.ndarray]:
        """The end of a stretch in which the statuses hold, and the functions that end it there, bool (4, n).

        The stretch has length 0 if the statuses hold no longer than now.
        """
        end, broken = self._first_event(here, None, min(here.time + 0.1, stop))
        while end.time - here.time > 1e-6:  # a shorter stretch is not halved
            middle = self._moment(0.5 * (here.time + end.time))
            if not middle.broken.any():
                bend = _bend(here, middle, end)
                if bend > MOST_BEND:
                    end, broken = middle, np.zeros_like(broken)
                    continue
                dip = _dip(here, end, 2.0 * bend)
                if dip is None:
                    self._middle = middle
                    return end, broken
                middle = self._moment(dip)
                if not middle.broken.any():
                    end, broken = middle, np.zeros_like(broken)
                    continue
            end, broken = self._first_event(here, middle, middle.time)
        self._middle = self._moment(0.5 * (here.time + end.time)) if end is not here else here
        return end, broken

    def _first_event(self, here: Moment, beyond: Moment | None, stop: float) -> tuple[Moment, np.ndarray]:
        """The first event after the moment `here`, or the moment at `stop`; and the functions that end there.

        At the moment `beyond` at least one function is broken already.
        """
        inside = here
        while True:
            ahead = inside.functions[0] > LIMIT
            wanted = inside.time + inside.first_zero(ahead)
            if beyond is not None:
                if beyond.time - inside.time <= SAME_TIME:
                    return inside, beyond.broken
                back = beyond.time + beyond.first_zero(beyond.broken) if beyond.broken.any() else np.inf
                room = beyond.time - inside.time
                wanted = min(wanted, back)
                if not 1e-3 * room < wanted - inside.time < 0.999 * room:
                    wanted = inside.time + 0.5 * room
            elif wanted >= stop:
                wanted = stop
            elif wanted - inside.time < SAME_TIME:
                wanted = inside.time + SAME_TIME
            moment = self._moment(wanted)
            if moment.broken.any():
                beyond = moment
            elif moment.time >= stop or moment.ending.any():
                return moment, np.zeros_like(moment.broken)
            else:
                inside = moment

    def _go(self, here: Moment, end: Moment) -> None:
        """Bring the configuration from one moment to the other, with work and dissipation of the stretch."""
        first, middle = self.now, self._configuration(self._middle)
        last = self._configuration(end)
        system = end.system
        parts = [(first, middle), (middle, last), (first, last)]
        sums = {"work": work_between, "dissipation": dissipation_between, "seat_dissipation": seat_dissipation_between}
        for name, between in sums.items():
            halves, rest, whole = (between(system, *part) for part in parts)
            setattr(last, name, getattr(first, name) + (4.0 * (halves + rest) - whole) / 3.0)  # Simpson's rule
        middle.slip_tally = slip_tally_between(first, middle)
        last.slip_tally = slip_tally_between(middle, last)
        if last.slip_tally.is_counted:
            tally, whole_tally = last.slip_tally.sums, slip_tally_between(first, last).sums
            for row in (1, *range(4, len(tally))):  # int -T ds, and int N |ds| with wear
                tally[row] = (4.0 * tally[row] - whole_tally[row]) / 3.0
        self.now, self.fraction, self._here = last, end.time, end

    def _configuration(self, moment: Moment) -> Configuration:
        """The configuration of a moment, without its energies."""
        found = snap_to_bounds(moment.system, self.now, moment.solution)
        found.load = self.load_at(moment.time)
        return found

    def _settled(self, moment: Moment, broken: np.ndarray) -> Moment:
        """The moment with the statuses with which the contact goes on. `broken` functions (4, n) end at once."""
        ending = broken | moment.broken | moment.ending
        if not ending.any():
            return moment
        system, found = moment.system, moment
        for _ in range(3):  # one by one; then Lemke's method finds them
            status = _flipped(found, ending)
            try:
                found = self._moment(moment.time, status)
            except StepLostError:
                break
            if found.holds:
                return self._with_statuses(found)
            ending = found.broken | found.ending
        self.resettled += 1
        settled = settle(system, self.now, self.rate, self.growth)
        if settled is None:
            raise StepLostError(exchange.CYCLING, self.fraction)
        found = self._moment(moment.time, settled)
        if not found.holds:
            raise StepLostError(exchange.CYCLING, self.fraction)
        return self._with_statuses(found)

    def _with_statuses(self, moment: Moment) -> Moment:
        """Take the statuses of a moment."""
        status = moment.status.astype(np.int8)
        if np.any(status[self._system.ends] != OPEN):
            raise StepLostError(exchange.ARC_END, self.fraction)
        if np.any(status[self._system.bonded] != STICK):
            raise StepLostError(exchange.UNBONDED, self.fraction)
        self.exchanges += int(np.count_nonzero(status != self.now.status))
        self.now.status = status
        self.touched |= self.now.closed
        return moment


def _rates(system: System, unknowns: DenseUnknowns, load_rate: np.ndarray, dragged: np.ndarray) -> ContactValues:
    """The rates of a solution while the load changes. At slipping nodes T changes by `dragged` (n,) beside mu N'."""
    n = system.grid.size
    shears = np.r_[np.zeros(n), dragged]
    known = system.load_displacement(load_rate) + system.elastic(shears)
    forces = system.load_forces(load_rate) - system.equilibrium @ shears
    found = unknowns.solve(np.r_[-known[unknowns.rows], forces])
    tractions, displaced = unknowns.expand(found) + shears, unknowns.displacement(found) + known
    motion = found[unknowns.count :]
    return ContactValues(tractions[:n], tractions[n:], displaced[:n], displaced[n:], unknowns.status, motion)


def _bend(here: Moment, middle: Moment, end: Moment) -> float:
    """Largest difference of the solution and its rates in the middle from the cubics through both ends, relative."""
    length, largest = end.time - here.time, 0.0
    (traction, shift), (_, speed), _ = end.scales
    for first, later, names, size in (
        ("solution", "rates", ("pressure", "shear"), traction),
        ("solution", "rates", ("gap", "slip"), shift),
        ("rates", "bends", ("gap", "slip"), speed),
    ):
        for name in names:
            values = [getattr(getattr(moment, first), name) for moment in (here, middle, end)]
            rates = [getattr(getattr(moment, later), name) for moment in (here, end)]
            cubic = 0.5 * (values[0] + values[2]) + 0.125 * length * (rates[0] - rates[1])
            largest = max(largest, float(np.abs(values[1] - cubic).max()) / size)
    return largest


def _dip(here: Moment, end: Moment, margin: float) -> float | None:
    """The time at which a function that is positive at both moments may be negative between them; or None.

    Its cubic falls below the `margin` there, in parts of its size.
    """
    length = end.time - here.time
    (first, falling), (last, rising) = here.functions, end.functions
    size = here.sizes[0]
    begin, stop = np.array([first, falling]), np.array([last, rising])
    begin[1] *= length * here.sizes[1] / size
    stop *= end.sizes[0] / size
    stop[1] = rising * length * end.sizes[1] / size
    turns = (begin[0] > max(LIMIT, margin)) & (stop[0] > max(LIMIT, margin)) & (begin[1] < 0.0) & (stop[1] > 0.0)
    turns &= np.isfinite(begin[0]) & np.isfinite(stop[0])
    if not turns.any():
        return None
    t, begin, stop = np.linspace(0.0, 1.0, 33)[1:-1, None], begin[:, turns], stop[:, turns]
    cubic = (1.0 + 2.0 * t) * (1.0 - t) ** 2 * begin[0] + t * (1.0 - t) ** 2 * begin[1]
    cubic += t * t * (3.0 - 2.0 * t) * stop[0] + t * t * (t - 1.0) * stop[1]
    place = int(np.argmin(cubic.min(axis=1)))
    if cubic[place].min() > margin:
        return None
    return float(here.time + length * t[place, 0])


def _flipped(moment: Moment, ending: np.ndarray) -> np.ndarray:
    """The statuses (n,) after the functions `ending` (4, n) have ended theirs."""
    status = moment.status.copy()
    normal, forward, backward, rest = ending
    slides = np.where(moment.rates.slip < 0.0, SLIP_NEGATIVE, SLIP_POSITIVE)
    status[forward] = SLIP_NEGATIVE  # T = +mu N drives the pin backward
    status[backward] = SLIP_POSITIVE
    status[rest] = STICK
    status[normal] = np.where(moment.status == OPEN, slides, OPEN)[normal]
    return status

"""The growth of a crack under a repeated load cycle: stress intensities, rates, life and arrest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from fastpin.cracks.intensity import Crack, CrackedBody, CrackedEdge, Residual, histories, sliding_doubt
from fastpin.errors import InputError, InputWarning
from fastpin.model.angles import from_bottom, near_bottom
from fastpin.model.checks import instance, numbers, positive
from fastpin.model.doubts import warn_of
from fastpin.model.growth import GrowthLaw, checked_law
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.state import State

COMPUTED, DRAWN = 8, 100
"""Lengths a decade at which K is computed, and lengths a decade of a result: lives are exact to 1e-5."""

MOST_DECADES = 8.0
"""Most decades from the first to the last length."""


@dataclass(frozen=True, eq=False, repr=False)
class Growth(ReadOnly):
    """The growth of a crack over many load cycles. The arrays have the shape (n,), one value for each length.

    Attributes
    ----------
    problem : Problem
    crack : Crack
    law : GrowthLaw
    length : ndarray
        From the first to the last length, m, equal steps of its logarithm.
    K_max, K_min : ndarray
        Largest and smallest K_I of the cycle, Pa sqrt(m). A negative one counts faces that overlap.
    K_II : ndarray
        K_II at the largest K_I, Pa sqrt(m).
    doubts : tuple of InputWarning
        Reasons to doubt the numbers.
    """

    problem: Problem
    crack: Crack
    law: GrowthLaw
    length: np.ndarray
    K_max: np.ndarray
    K_min: np.ndarray
    K_II: np.ndarray
    doubts: tuple[InputWarning, ...] = ()

    def __repr__(self) -> str:
        place = from_bottom(self.crack.theta)
        return f"<Growth of a crack at {place:.2f} deg from the bottom: {self.words}>"

    @property
    def delta_K(self) -> np.ndarray:
        """The range of the stress intensity that the law counts, Pa sqrt(m)."""
        return self.law.range(self.K_max, self.K_min)

    @property
    def threshold(self) -> np.ndarray:
        """The range up to which the crack does not grow, Pa sqrt(m)."""
        return self.law.threshold(self.K_max, self.K_min, self.length)

    @property
    def rate(self) -> np.ndarray:
        """da/dN, m per cycle: 0 up to the threshold, infinite from the toughness on."""
        return self.law.rate(self.K_max, self.K_min, self.length)

    @property
    def cycles(self) -> np.ndarray:
        """Cycles from the first length on; infinite where the crack never comes."""
        with np.errstate(divide="ignore"):
            pace = self.length / self.rate
        steps = 0.5 * (pace[1:] + pace[:-1]) * np.diff(np.log(self.length))
        return np.append(0.0, np.cumsum(steps))

    @property
    def life(self) -> float:
        """Cycles from the first to the last length, or to fracture; infinite if the crack stops before."""
        return float(self.cycles[-1])

    @property
    def arrest(self) -> float:
        """The first length at which the range is at most the threshold, m; NaN if the crack grows to the last one."""
        return self._first(self.threshold - self.delta_K)

    @property
    def fracture(self) -> float:
        """The first length at which the largest K_I reaches the toughness, m; NaN without one, or after an arrest."""
        toughness = self.law.fracture_toughness
        found = self._first(self.K_max - toughness) if math.isfinite(toughness) else math.nan
        return math.nan if found >= self.arrest else found

    def _first(self, excess: np.ndarray) -> float:
        """The first length with an excess of at least 0, read between the lengths; NaN without one."""
        beyond = np.flatnonzero(excess >= 0.0)
        if not beyond.size:
            return math.nan
        k = int(beyond[0])
        if k == 0:
            return float(self.length[0])
        part = excess[k - 1] / (excess[k - 1] - excess[k])
        return float(self.length[k - 1] * (self.length[k] / self.length[k - 1]) ** part)

    @property
    def words(self) -> str:
        """A sentence on life, arrest and fracture."""
        length = units(self.problem)["length"]
        first, last, stop = length.text(float(self.length[0])), length.text(float(self.length[-1])), self.arrest
        if stop == self.length[0]:
            return f"no growth at {first}"
        if not math.isnan(stop):
            return f"grows from {first} and stops at {length.text(stop, 4)}"
        if not math.isnan(self.fracture):
            return f"grows from {first} to fracture at {length.text(self.fracture, 4)} in {self.life:.3g} cycles"
        return f"grows from {first} to {last} in {self.life:.3g} cycles"


def growth(
    states: Sequence[State],
    crack: Crack,
    law: GrowthLaw,
    first: float,
    last: float,
    residual_stress: Residual | None = None,
) -> Growth:
    """The growth of a crack under a load cycle that is repeated for ever.

    The states are the stops of the cycle. Between two stops the stress intensities are unknown: keep states between the
    corners, ``solve(..., between=10)``. The order of the states makes no difference.

    Parameters
    ----------
    states : sequence of State
        All stops of one cycle of one problem, at least two; see :func:`fastpin.damage.cycle_states`.
    crack : Crack
    law : GrowthLaw
        :class:`Walker`, :func:`paris` or :class:`Nasgro`, with constants of the user.
    first, last : float
        The first and the last length, m.
    residual_stress : callable, optional
        Normal stress on the line of the crack that is added at every stop, Pa, from the distances to the mouth, m.

    Raises
    ------
    InputError
        If the states are no cycle of one problem, `last` is not longer than `first`, the crack is longer than the body,
        the body is rigid, or a compliance gives its plate no stress inside.
    """
    instance("crack", crack, Crack, "a Crack")
    stops = stops_of_one_problem(states)
    edge = CrackedEdge.of(stops[0].problem, crack.body)
    lengths = _lengths(edge, crack, first, last)
    checked_law(law)
    rows = [edge.lines([crack], length) for length in lengths]
    K = histories(stops, edge, rows, np.zeros(1), residual_stress)[:, 0, :, 0]
    found = edge.doubts("last", crack, float(lengths[-1])) + sliding_doubt("last", edge.problem, lengths, K)
    warn_of(found, 2)
    return _grown(edge.problem, crack, law, lengths, K, tuple(found))


@dataclass(frozen=True, eq=False, repr=False)
class EdgeGrowth(ReadOnly):
    """The growth of a crack at many places of an edge, each time alone.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        Angles of the mouths, rad.
    life : ndarray, shape (p,)
        Cycles from the first to the last length; infinite where the crack stops.
    arrest : ndarray, shape (p,)
        Length at which it stops, m; NaN where it does not.
    fastest : Growth
        The growth with the shortest life; without a life, the one that comes farthest.
    """

    theta: np.ndarray
    life: np.ndarray
    arrest: np.ndarray
    fastest: Growth

    def __repr__(self) -> str:
        return f"<EdgeGrowth at {self.theta.size} places; fastest {self.fastest!r}>"


def growth_along_edge(
    states: Sequence[State],
    law: GrowthLaw,
    first: float,
    last: float,
    theta: ArrayLike | None = None,
    angle: float = 0.0,
    body: CrackedBody = "plate",
) -> EdgeGrowth:
    """The growth of a crack at many places of the edge, to find the place at which it grows fastest.

    The hot spot of a criterion of fatigue need not be this place.

    Parameters
    ----------
    states, law, first, last
        See :func:`growth`.
    theta : array_like, optional
        Angles of the mouths, rad; each degree all round unless given.
    angle : float
        Direction of the cracks from the radius, rad.
    body : {"plate", "seat"}

    Raises
    ------
    InputError
        See :func:`growth`.
    """
    stops = stops_of_one_problem(states)
    every = np.linspace(-1.5 * np.pi, 0.5 * np.pi, 360, endpoint=False) if theta is None else numbers("theta", theta)
    every = np.array([near_bottom(place) for place in every.ravel()])
    if not every.size:
        raise InputError("theta", "must be at least one angle")
    crack = Crack(0.0, angle, body)
    edge = CrackedEdge.of(stops[0].problem, crack.body)
    lengths = _lengths(edge, crack, first, last)
    checked_law(law)
    rows, doubts = [edge.lines([crack], length) for length in lengths], edge.doubts("last", crack, float(lengths[-1]))
    grown = []
    for part in np.array_split(every, max(1, every.size // 40)):  # 40 places need some 30,000 points in each state
        K = histories(stops, edge, rows, part)[:, :, :, 0]
        for k, place in enumerate(part.tolist()):
            found = (*doubts, *sliding_doubt("last", edge.problem, lengths, K[:, k]))
            grown.append(_grown(edge.problem, Crack(place, angle, body), law, lengths, K[:, k], found))
    life, arrest = np.array([one.life for one in grown]), np.array([one.arrest for one in grown])
    farthest = np.where(np.isnan(arrest), np.inf, arrest)
    fastest = grown[int(np.lexsort((life, -farthest))[0])]
    warn_of(fastest.doubts, 2)
    return EdgeGrowth(every, life, arrest, fastest)


def _lengths(edge: CrackedEdge, crack: Crack, first: float, last: float) -> np.ndarray:
    """Check the first and the last length, m, and return the lengths at which K is computed."""
    start, end = positive("first", first), positive("last", last)
    decades = math.log10(end) - math.log10(start)
    if not 1e-6 < decades <= MOST_DECADES:
        most = f"and at most 1e{MOST_DECADES:g} times as long"
        raise InputError("last", f"must be longer than the first length of {start:g} m {most}, not {end:g}")
    edge.check("last", crack, np.array([end]))
    return np.geomspace(start, end, max(math.ceil(COMPUTED * decades) + 1, 4))


def _grown(
    problem: Problem,
    crack: Crack,
    law: GrowthLaw,
    lengths: np.ndarray,
    K: np.ndarray,
    doubts: tuple[InputWarning, ...],
) -> Growth:
    """The growth from K at the lengths, shape (states, m, 2). K/sqrt(a) is smooth over ln a."""
    count = max(math.ceil(DRAWN * math.log10(lengths[-1] / lengths[0])) + 1, 20)
    fine = np.geomspace(lengths[0], lengths[-1], count)
    spline = CubicSpline(np.log(lengths), K / np.sqrt(lengths)[:, None], axis=1)
    opening, sliding = np.moveaxis(spline(np.log(fine)) * np.sqrt(fine)[:, None], -1, 0)
    at = np.argmax(opening, axis=0)[None]
    K_II = np.take_along_axis(sliding, at, axis=0)[0]
    return Growth(problem, crack, law, fine, opening.max(axis=0), opening.min(axis=0), K_II, doubts)

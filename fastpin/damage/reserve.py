"""The factor by which all stresses of a spectrum may grow until a goal is missed: a life, or endurance.

The stresses of all states grow by one factor, also those of a press fit. The point and the plane that reach the goal
first need not be those of the largest damage under the given stresses: each point is looked at.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fastpin.damage.counted import CountedMaterial, Spectrum
from fastpin.damage.spectrum import SpectrumCount, halves
from fastpin.model.problem import Problem
from fastpin.model.ties import top, top_angle
from fastpin.runtime.extensions import optimize
from fastpin.states.quantities import load_point

LARGEST = 1e6
"""Largest factor that is looked for. No strength lies as far above the stress of a joint that is worth a question."""

PRECISION = 1e-7
"""Largest relative error of a factor. The damage on a plane is exact to 1e-7, and its logarithm is steeper."""

ENOUGH = 700.0
"""Largest size of the logarithm of a damage: beyond it doubles end. No damage counts as so little."""


MOST_SCALED = 2**20
"""Most states of the points whose stresses are scaled at a time: 32 MB."""


class Goal(NamedTuple):
    """What must not be missed.

    Attributes
    ----------
    kind : {"life", "endurance", "pass"}
        A life that is asked for; all cycles up to the knee; or one pass of the spectrum, in place of a life.
    number : float
        Passes of the spectrum, or the cycles at the knee.
    """

    kind: str
    number: float

    @classmethod
    def of(cls, life: float | None, knee: float | None) -> Goal:
        """The goal of an assessment with this life and this knee."""
        if life is not None:
            return cls("life", life)
        return cls("pass", 1.0) if knee is None else cls("endurance", knee)


class StressReserve(NamedTuple):
    """The factor of all stresses at which a body just reaches its goal.

    Attributes
    ----------
    problem : Problem
    criterion, body : str
    goal : Goal
    factor : float
        Infinite if no factor misses the goal: nothing is in tension, or nothing changes.
    theta, depth : float
        The point that reaches it first: its angle, rad, and distance from the edge, m. NaN without one.
    plane : float
        Angle of its plane's normal from the +x axis, rad; NaN without one.
    start, stop, largest : float
        Load points of both reversals of the cycle with the most damage there, for endurance with the largest
        parameter, and of the largest normal stress in it; NaN without one.
    loads : mapping
        The loads at the last of them by name.
    """

    problem: Problem
    criterion: str
    body: str
    goal: Goal
    factor: float = math.inf
    theta: float = math.nan
    depth: float = math.nan
    plane: float = math.nan
    start: float = math.nan
    stop: float = math.nan
    largest: float = math.nan
    loads: Mapping[str, float] = MappingProxyType({})

    @property
    def is_finite(self) -> bool:
        """Whether some factor misses the goal."""
        return math.isfinite(self.factor)


def stress_reserve(count: SpectrumCount, goal: Goal, progress: Callable[[float], None]) -> StressReserve:
    """Return the factor of a count of cycles, see :func:`fastpin.damage.assessed_reserves`.

    The points of a block are looked at under the smallest factor so far. Where they miss the goal, the worst of them
    gives a smaller factor, until no point misses it. Points whose largest cycle can't do enough damage are left out.
    """
    search = _Search(goal, Spectrum.of(count.order), count.order.size)
    tell_read, tell_counted = halves(lambda done, total: progress(done / total))
    for block, history in count.blocks(tell_read):
        for chosen, counted in count.parts:
            places = block.start + np.flatnonzero(chosen[block])
            search.take(counted, history[:, chosen[block]], places, count.theta.ravel()[places])
        tell_counted(block.stop / max(count.theta.size, 1))
    found = StressReserve(count.different[0].problem, count.criterion, count.body, goal)
    if search.best is None:
        return found
    (place, counted, history), factor = search.best, search.factor
    plane = search.plane(counted, factor * history)
    places, values = counted.cycles(factor * history, search.spectrum, plane)
    worst = top(values[:, 1 if goal.kind == "endurance" else 2])
    stops = [count.different[k] for k in places[worst].tolist()]
    where = float(count.theta.flat[place]), float(count.depth.flat[place]), plane
    start, stop, largest = (load_point(state) for state in stops)
    return StressReserve(*found[:4], factor, *where, start, stop, largest, stops[2].load)


class _Search:
    """The smallest factor of the points so far, and the point that it belongs to."""

    def __init__(self, goal: Goal, spectrum: Spectrum, cycles: int) -> None:
        self.factor, self.spectrum = LARGEST, spectrum
        self.best: tuple[int, CountedMaterial, np.ndarray] | None = None
        self._goal, self._cycles = goal, cycles

    def take(self, counted: CountedMaterial, history: np.ndarray, places: np.ndarray, theta: np.ndarray) -> None:
        """Look at the points at these places and angles, with stresses (states, points, 4)."""
        left = np.arange(places.size)
        if self.best is None and left.size:  # the point with the largest cycle is a good first guess
            self._try(counted, history, places, top_angle(counted.largest(history)[0], theta))
        while left.size:
            parts = np.array_split(left, math.ceil(left.size * len(history) / MOST_SCALED))
            used = np.concatenate([self._used(counted, self.factor * history[:, some]) for some in parts])
            worst = int(left[top_angle(used, theta[left])])
            if used.max() > 1.0:
                self._try(counted, history, places, worst)
            left = left[(used > 1.0) & (left != worst)]

    def _try(self, counted: CountedMaterial, history: np.ndarray, places: np.ndarray, which: int) -> None:
        """Take the factor of a point if it is smaller.

        It is a root in the logarithms, which are close to a straight line. Where a rule of small cycles lets the damage
        jump, it is the end below the jump.
        """
        one = history[:, which : which + 1].copy()

        def excess(exponent: float) -> float:
            used = float(self._used(counted, math.exp(exponent) * one, exact=True)[0])
            return min(max(math.log(used), -ENOUGH), ENOUGH) if used > 0.0 else -ENOUGH

        high = math.log(self.factor)
        if excess(high) <= 0.0:
            return
        low, step = high - 0.5, 1.0
        while excess(low) > 0.0:
            high, low, step = low, low - step, 2.0 * step
        root = float(optimize.brentq(excess, low, high, xtol=PRECISION, rtol=PRECISION))
        self.factor, self.best = math.exp(root - PRECISION * (1.0 + abs(root))), (int(places[which]), counted, one)

    def _used(self, counted: CountedMaterial, history: np.ndarray, exact: bool = False) -> np.ndarray:
        """The parts of the goal that the points use up, (points,): above 1 where they miss it.

        Unless it is to be exact, a part below 1 may be a bound: no spectrum has more cycles than stops.
        """
        parameter = counted.largest(history)[0]
        if self._goal.kind == "endurance":
            return np.asarray(parameter / math.exp(counted.life[4]))
        used = self._goal.number * self._cycles * counted.most_damage(parameter)
        if (counts := exact | (used > 1.0)).any():
            used[counts] = self._goal.number * counted.worst(history[:, counts], self.spectrum)[0]
        return used

    def plane(self, counted: CountedMaterial, history: np.ndarray) -> float:
        """The plane of one point that reaches the goal, rad."""
        if self._goal.kind == "endurance":
            return float(counted.largest(history)[1][0])
        return float(counted.worst(history, self.spectrum)[1][0])

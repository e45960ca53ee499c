"""Lives of cracks at random, and the same from K at 800 lengths."""

from __future__ import annotations

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

import fastpin
from fastpin.cracks import Crack, Growth, GrowthLaw, Nasgro, Walker, growth, spectrum_growth, stress_intensity
from fastpin.cracks.reversals import closed_cycles
from fastpin.states.quantities import load_point

M = 1e6
"""Pa sqrt(m) in MPa sqrt(m)."""

COMPUTED, READ = 800, 200_001
"""Lengths at which K is computed, and read between them."""

SPLINES = 2e-6
"""Relative error of a life by splines of K through so many lengths."""


class Compared(NamedTuple):
    """A life by fastpin and by the integral of its K; lengths of the arrest for a crack that stops.

    `slack` is the relative error of the reference: of its steps, more so where the crack stops or breaks, and of its
    splines. Half as many steps tell the error of the steps: it is large where the range of K nearly vanishes.
    """

    found: Growth
    value: float
    reference: float
    slack: float

    @property
    def error(self) -> float:
        """The relative error, 0 if both are 0 or not known."""
        if self.reference == self.value or (math.isnan(self.reference) and math.isnan(self.value)):
            return 0.0
        return abs(self.value / self.reference - 1.0)


def random_life(seed: int, nodes: int = 101, computed: int = COMPUTED) -> Compared:
    """A crack at random beside a pin."""
    draw = np.random.default_rng(seed)
    states = _states(draw, nodes)
    crack = Crack(float(draw.uniform(-math.pi, math.pi)), float(draw.choice([0.0, 0.3])))
    first, last = np.sort(10.0 ** draw.uniform(-5.0, -2.0, 2)) * [0.8, 1.25]
    counted = bool(draw.random() < 0.2)
    a = np.geomspace(first, last, computed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fastpin.errors.InputWarning)
        K = stress_intensity(states, crack, a).K_I
        law = _law(draw, K)
        found = (spectrum_growth if counted else growth)(states, crack, law, first, last)
    x = np.linspace(math.log(first), math.log(last), READ)
    a_fine = np.exp(x)
    K_fine = CubicSpline(np.log(a), K / np.sqrt(a), axis=1)(x) * np.sqrt(a_fine)
    rate, stops = _rates(law, a_fine, K_fine, counted)
    breaks = np.logical_or.accumulate(np.isinf(rate))
    if (stops & ~breaks).any():
        return Compared(found, found.arrest, float(a_fine[np.argmax(stops)]), SPLINES + x[1] - x[0])
    with np.errstate(divide="ignore"):
        pace = np.where(breaks, 0.0, a_fine / rate)
    life, coarse = (float(np.trapezoid(pace[::every], x[::every])) for every in (1, 2))
    last_step = float(pace[breaks.argmax() - 1]) * (x[1] - x[0]) / life if breaks.any() and not breaks[0] else 0.0
    steps = abs(coarse / life - 1.0) if 0.0 < life < math.inf else 0.0
    return Compared(found, found.life, life, SPLINES + last_step + steps)


def _states(draw: np.random.Generator, nodes: int) -> list[fastpin.State]:
    like = fastpin.Material(70e9, 0.33)
    pin = like if draw.random() < 0.5 else fastpin.Material(210e9, 0.3)
    problem = fastpin.Problem(
        fastpin.MaterialPair(pin, like), 10e-3, float(draw.choice([10e-6, 50e-6])), float(draw.uniform(0.05, 0.8))
    )
    P, swing = 10.0 ** draw.uniform(5.5, 6.8), float(draw.choice([0.02, 0.2, 0.9]))
    kind = draw.integers(3)
    name = ("P", "Q", "sxx")[kind]
    size = (P, 0.5 * problem.uniform_friction * P, 80e6)[kind]
    turn = [{"P": P, name: size}, {"P": P, name: size * (1.0 - swing)}]
    result = fastpin.solve(problem, turn * 2, nodes=nodes, between=int(draw.integers(4)))
    return [state for state in result if load_point(state) >= 2.0]


def _law(draw: np.random.Generator, K: np.ndarray) -> GrowthLaw:
    """A law whose threshold and toughness lie in or near the range of K."""
    top, swing = K.max(axis=0), np.ptp(np.maximum(K, 0.0), axis=0)
    threshold = float(draw.choice([0.0, 0.5, 1.0, 1.2])) * float(np.quantile(swing, draw.random()))
    toughness = float(np.quantile(np.maximum(top, 0.1 * M), draw.uniform(0.5, 1.0)) * draw.choice([1.0, 1.5]))
    if draw.random() < 0.5:
        power, exponent = float(draw.uniform(2.0, 8.0)), float(draw.uniform(0.3, 1.0))
        known: dict[str, Any] = {"toughness": toughness} if draw.random() < 0.3 else {}
        return Walker(1e-10, power, exponent, threshold, intrinsic_length=50e-6, **known)
    p, q = draw.choice([0.25, 0.5, 1.0], 2)
    return Nasgro(6e-10, 2.5, float(p), float(q), threshold, toughness, 1.5, 0.1, intrinsic_length=38e-6)


def _rates(law: GrowthLaw, a: np.ndarray, K: np.ndarray, counted: bool) -> tuple[np.ndarray, np.ndarray]:
    """The growth at lengths, and whether the crack stops there."""
    if not counted:
        top, bottom = K.max(axis=0), K.min(axis=0)
        return law.rate(top, bottom, a), law.range(top, bottom) <= law.threshold(top, bottom, a)
    values = np.ascontiguousarray(K.T)
    tops, bottoms, counts = np.empty(values.shape), np.empty(values.shape), np.empty(len(values), dtype=np.int64)
    closed_cycles(values, tops, bottoms, counts)
    rate = np.zeros(a.size)
    for k in range(int(counts.max(initial=0))):
        on = counts > k
        rate[on] += law.rate(tops[on, k], bottoms[on, k], a[on])
    return rate, rate <= 0.0

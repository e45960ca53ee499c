"""Lives by lengths that follow the bends of the rate, against integrals over many lengths."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from fastpin.cracks import Walker
from fastpin.cracks.lengths import EXACT, drawn, refined, spline_of, step_cycles
from tests.support.tiers import seeds

FIRST, LAST = 1e-5, 1e-2

DENSE = np.geomspace(FIRST, LAST, 100_001)


def steps_sum(pace):
    return float((0.5 * (pace[1:] + pace[:-1]) * np.diff(np.log(DENSE))).sum())


def life_of(K, law):
    """The life, its stated error, and the number of computed lengths, for K of a length: shape (states, lengths)."""

    def compute(a):
        return np.stack([K(a), np.zeros(K(a).shape)], axis=-1)

    def pace(a, K):
        top, bottom = K[..., 0].max(axis=0), K[..., 0].min(axis=0)
        with np.errstate(divide="ignore"):
            rate = a / law.rate(top, bottom, a)
        return np.array([rate, law.range(top, bottom) - law.threshold(top, bottom, a), law.fracture_toughness - top])

    lengths = np.geomspace(FIRST, LAST, 25)
    lengths, values, error = refined(lengths, compute(lengths), compute, pace)
    between = spline_of(lengths, values)
    a, rows, by_steps = drawn(np.geomspace(FIRST, LAST, 151), lambda a: pace(a, between(a)))
    return float(step_cycles(np.log(a), rows[0]).sum()), error + by_steps, lengths.size, pace(DENSE, compute(DENSE))[0]


def test_a_power_law_needs_no_more_lengths():
    life, error, count, pace = life_of(lambda a: 1e8 * np.sqrt(a) * np.array([[1.0], [0.1]]), Walker(1e-10, 8.0))
    exact = (LAST**-3.0 - FIRST**-3.0) / (1e-10 * 90.0**8 * -3.0)
    assert life == pytest.approx(exact, rel=1e-10)
    assert (count, error < 1e-9, steps_sum(pace)) == (25, True, pytest.approx(exact, rel=1e-7))


def kinked(seed):
    """K of three states that bend at a depth. The largest and the smallest change their states."""
    draw = np.random.default_rng(seed)
    level, slope = draw.uniform(0.7, 1.3, (3, 1)), draw.uniform(-0.15, 0.15, (3, 1))
    depth, height, width = 10.0 ** draw.uniform(-4.5, -2.5), draw.uniform(-0.1, 0.1, (3, 1)), draw.uniform(0.2, 1.0)
    return lambda a: 1e8 * np.sqrt(a) * (level + slope * np.log(a / 3e-4) + height * np.tanh(np.log(a / depth) / width))


def test_kinks_of_the_range_do_not_spoil_lives():
    for seed in seeds(30):
        draw = np.random.default_rng(seed)
        toughness = float(10.0 ** draw.uniform(6.0, 7.0)) if draw.random() < 0.5 else None
        law = Walker(1e-10, float(draw.uniform(2.0, 6.0)), float(draw.uniform(0.3, 1.0)), toughness=toughness)
        life, error, _, pace = life_of(kinked(seed), law)
        pace = np.where(np.logical_or.accumulate(pace == 0.0), 0.0, pace)
        own = 2e-6 + float(pace[pace > 0.0][-1]) * np.log(DENSE[1] / DENSE[0]) / steps_sum(pace)
        assert life == pytest.approx(steps_sum(pace), rel=error + own), seed
        assert error < 10.0 * EXACT, seed


@pytest.mark.parametrize("width", [0.3, 0.8])
@pytest.mark.parametrize("least", [0.01, 0.05])
def test_a_life_that_is_spent_at_its_first_length_is_exact(least, width):
    """K nearly vanishes there. The next lengths tell how far it bends in the first step."""

    def K(a):
        return 1e8 * np.sqrt(a) * (least + 1.0 - np.exp(-np.log(a / FIRST) / width)) * np.array([[1.0], [0.0]])

    life, error, _, _ = life_of(K, Walker(1e-10, 8.0))
    exact = quad(
        lambda x: np.exp(x) / (1e-10 * (1e-6 * K(np.exp(x))[0, 0]) ** 8), np.log(FIRST), np.log(LAST), limit=500
    )
    assert error < EXACT
    assert life == pytest.approx(exact[0], rel=error)


def test_cycles_after_fracture_do_not_count():
    x = np.linspace(0.0, 1.0, 11)
    pace = np.where(abs(x - 0.55) < 0.1, 0.0, 1.0)
    assert step_cycles(x, pace).sum() == pytest.approx(0.45)
    assert math.isinf(step_cycles(x, np.where(x > 0.75, np.inf, 1.0)).sum())

"""Turning points of records: the noise, the width that it demands, and the hysteresis."""

import numpy as np
import pytest

from fastpin.model.turning import least_reversal, noise, turning_points


def record(samples: int, cycles: float = 10.0, deviation: float = 0.0, drift: float = 0.0, seed: int = 0) -> np.ndarray:
    """A sine of amplitude 1."""
    turns = np.arange(1, round(cycles * samples) + 1) / samples
    scatter = deviation * np.random.default_rng(seed).normal(size=turns.size)
    return np.sin(2.0 * np.pi * turns) + drift * turns / cycles + scatter


@pytest.mark.parametrize("samples", [50, 80, 200, 500])
@pytest.mark.parametrize("deviation", [0.0, 0.006, 0.01, 0.03])
@pytest.mark.parametrize("drift", [0.0, 0.5])
def test_the_turning_points_of_a_sine(samples: int, deviation: float, drift: float) -> None:
    values = record(samples, 10.3, deviation, drift, seed=samples)
    found = turning_points(values, least_reversal(values))
    expected = (np.arange(20) * 0.5 + 0.25) * samples - 1.0
    assert found == pytest.approx(np.r_[expected, 10.25 * samples - 1.0][: len(found)], abs=0.08 * samples)
    assert len(found) in (20, 21)  # the last one lies 0.05 of a cycle before the end


@pytest.mark.parametrize("deviation", [0.003, 0.03])
def test_the_noise_of_a_sine(deviation: float) -> None:
    found = [noise(record(100, deviation=deviation, seed=seed)) for seed in range(20)]
    assert np.mean(found) == pytest.approx(deviation, rel=0.03)
    assert noise(record(100)) < 3e-4


def test_the_ends_are_no_turning_points() -> None:
    values = np.array([0.0, 3.0, 1.0, 1.4, -2.0, -1.8, 4.0, 3.9])
    assert turning_points(values, 0.5).tolist() == [1, 4]
    assert turning_points(values, 0.05).tolist() == [1, 2, 3, 4, 6]
    assert turning_points(-values, 0.5).tolist() == [1, 4]
    assert turning_points(values, 10.0).tolist() == []
    assert turning_points(values[:1], 0.5).tolist() == []


def test_the_first_one_is_further_than_the_width_from_the_first_sample() -> None:
    assert turning_points(np.array([1.0, 1.3, 0.0, 2.0]), 0.5).tolist() == [2]
    assert turning_points(np.array([1.0, 1.6, 0.0, 2.0]), 0.5).tolist() == [1, 2]

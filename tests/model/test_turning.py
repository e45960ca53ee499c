"""Turning points of records: the noise, the width that it demands, and the hysteresis."""

import numpy as np
import pytest

from fastpin.model.recorded import is_back, least_reversal, noise, recorded_cycles, turning_points


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


def samples(*columns: np.ndarray) -> np.ndarray:
    return np.column_stack([np.full(len(columns[0]), np.nan), *columns])


@pytest.mark.parametrize("deviation", [0.0, 0.01])
@pytest.mark.parametrize("size", [24, 50, 97, 200, 500])
def test_cycles_of_a_record_of_any_period(size: int, deviation: float) -> None:
    table = samples(record(size, 4.3, deviation, 0.05), np.full(round(4.3 * size), 6e3))
    marks, lengths = recorded_cycles(table)
    assert lengths == (pytest.approx(size, abs=max(0.04 * size, 1)),)
    assert marks.sum() >= 3
    assert marks[-1] == 1
    assert np.diff(np.flatnonzero(marks)).tolist() == [lengths[0]] * (int(marks.sum()) - 1)


@pytest.mark.parametrize(
    "values",
    [
        np.tile([1.0, -1.0], 50),  # listed corners
        np.random.default_rng(0).normal(size=400),
        np.cumsum(np.random.default_rng(1).normal(size=400)),
        np.linspace(0.0, 1.0, 200),
        record(100, 1.2),
        np.r_[record(60, 3.0), 0.3 * record(80, 0.4)],  # the last part is no cycle
    ],
)
def test_records_without_cycles(values: np.ndarray) -> None:
    marks, lengths = recorded_cycles(samples(values))
    assert lengths == ()
    assert not marks.any()


def test_all_columns_return() -> None:
    other = record(50, 8.0)
    assert recorded_cycles(samples(record(100, 4.0), other))[1] == (100,)
    assert recorded_cycles(samples(record(100, 4.0), np.arange(400.0)))[1] == ()


def test_a_record_is_back_within_its_noise_or_a_step() -> None:
    wave = np.cos(np.linspace(0.0, 2.0 * np.pi, 101))
    assert is_back(wave)
    assert is_back(np.r_[wave[:-1], wave[-1] + 0.03])
    assert not is_back(wave + np.linspace(0.0, 0.3, 101))
    assert not is_back(np.array([0.0, 1.0]))

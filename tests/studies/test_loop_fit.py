"""Errors of turning points that whole branches share, and noise that a filter has smoothed."""

import numpy as np
import pytest

from fastpin.studies.loop_fit import LEAST_VARIANCE, Whitening, correlated_samples


def test_distances_are_made_independent() -> None:
    """Their errors are e - V d. e is white, and d = A x with noise x that is a part of e."""
    rng = np.random.default_rng(0)
    shares, moved, normal = rng.normal(size=(3, 40)) / 8.0, rng.normal(size=(40, 3)), rng.uniform(-1.0, 1.0, 40)
    whitening = Whitening.of(moved, (normal * shares).T, shares @ shares.T)
    of_noise = np.diag(normal) - moved @ shares  # of the noise of the displacements; the force has the rest of e
    covariance = of_noise @ of_noise.T + np.diag(1.0 - normal**2)
    assert np.linalg.eigvalsh(covariance).min() > LEAST_VARIANCE
    found = whitening(whitening(covariance).T)
    assert found == pytest.approx(np.eye(40), abs=1e-12)
    assert whitening(covariance[:, 0]) == pytest.approx(whitening(covariance)[:, 0])


def test_a_combination_without_noise_does_not_decide_all() -> None:
    """A turning point that is one sample, and moves its distance by as much, leaves no error."""
    sample = np.zeros((5, 1))
    sample[2] = 1.0
    assert Whitening.of(sample, sample, np.eye(1))(sample[:, 0])[2] == pytest.approx(LEAST_VARIANCE**-0.5)


def test_no_turning_point_changes_nothing() -> None:
    assert np.array_equal(Whitening(np.zeros((4, 0)), np.zeros(0))(np.arange(4.0)), np.arange(4.0))


@pytest.mark.parametrize("count", [1, 3, 5])
def test_samples_of_filtered_noise_count_less(count: int) -> None:
    rng, found = np.random.default_rng(1), []
    for _ in range(200):
        found.append(correlated_samples(np.convolve(rng.normal(size=300), np.ones(count), "valid")))
    assert np.mean(found) == pytest.approx(count, rel=0.1)

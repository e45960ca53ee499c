"""Observed orders, limits and error bars of sequences whose limit is known."""

import math

import numpy as np
import pytest

from fastpin.states.error_bars import SAFETY, pair_bar
from fastpin.studies.extrapolate import ALIKE, CONVERGED, LATEST, SAFETY_NOISE, estimate

HALVED = [8.0, 4.0, 2.0, 1.0, 0.5]
UNEVEN = [1.0, 0.7, 0.45, 0.4, 0.15]


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("spacings", [HALVED, UNEVEN, HALVED[:3], UNEVEN[:3]], ids=str)
@pytest.mark.parametrize("factor", [-3.0, 1e-9])
def test_powers_are_found(order: float, spacings: list[float], factor: float) -> None:
    values = [5.0 + factor * h**order for h in spacings]
    found = estimate(spacings, values)
    assert found.verdict == "observed"
    assert found.order == pytest.approx(order, abs=1e-3 if abs(factor) > 1.0 else 0.01)
    assert found.limit == pytest.approx(5.0, abs=2e-3 * abs(factor))
    error = abs(values[-1] - 5.0)
    safety = SAFETY if len(values) > LATEST else SAFETY_NOISE
    least = pair_bar(values[-1], values[-2], 1.0, spacings[-2] / spacings[-1])
    assert found.bar == pytest.approx(max(safety * error, least), rel=0.03)


def test_an_order_above_two_is_told_but_not_used() -> None:
    values = [1.0 + h**3 for h in HALVED]
    found = estimate(HALVED, values)
    assert found.order == pytest.approx(3.0, abs=1e-3)
    assert found.bar > 2.0 * abs(values[-1] - 1.0)


@pytest.mark.parametrize(
    "values",
    [
        [1.0, 1.4, 0.9, 1.1, 1.0],  # oscillates
        [3.0, 2.0, 1.0, 1.5, 1.2],  # the last ones do
        [1.0, 2.0, 3.0, 4.0, 5.0],  # runs away: slower than a square root
        [1.0, 1.1, 1.3, 1.7, 2.5],  # diverges
        [9.0, 1.0, 0.99999, 0.99998, 0.99997],
        [1.0, 1.0, 1.0, 1.0, 2.0],
    ],
    ids=str,
)
def test_no_order_is_found_where_there_is_none(values: list[float]) -> None:
    found = estimate(HALVED, values)
    scatter = np.ptp(values[-LATEST:])
    assert found.verdict == ("converged" if scatter < CONVERGED else "not converged")
    assert math.isnan(found.order)
    assert math.isnan(found.limit)
    assert found.bar == pytest.approx(SAFETY_NOISE * scatter)
    assert found.scatter == pytest.approx(scatter / abs(values[-1]))


SCATTERED = np.array([0.3, -0.4, 0.1, 0.5, -0.2])
DRIFTING = np.array([0.0, 0.1, 0.22, 0.36, 0.52])


@pytest.mark.parametrize(
    ("shape", "size", "verdict"),
    [
        (SCATTERED, 0.5 * CONVERGED, "converged"),
        (SCATTERED, 1e-6, "converged"),
        (SCATTERED, 3.0 * CONVERGED, "not converged"),
        (DRIFTING, 0.5 * CONVERGED, "not converged"),
        (DRIFTING, 0.5 * ALIKE, "converged"),
        (DRIFTING[::-1], 0.5 * CONVERGED, "converged"),  # the steps shrink, slower than a square root
    ],
)
@pytest.mark.parametrize("last", [4.0, -4e-6])
def test_scatter_is_relative_and_tells_the_verdict(shape: np.ndarray, size: float, verdict: str, last: float) -> None:
    values = last * (1.0 + size * (shape - shape[-1]))
    found = estimate(HALVED, values.tolist())
    assert found.verdict == verdict
    assert found.scatter == pytest.approx(size * np.ptp(shape[-LATEST:]), rel=1e-6)
    told = estimate(HALVED, values.tolist(), reference=10.0 * abs(last))
    assert told.scatter == pytest.approx(0.1 * found.scatter)


def test_values_around_zero_have_not_converged() -> None:
    found = estimate(HALVED, [1e-3, -1e-3, 2e-3, -1e-3, 0.0])
    assert (found.verdict, found.scatter) == ("not converged", math.inf)


def test_a_constant_is_no_order() -> None:
    assert estimate(HALVED, [2.0] * 5)[0] == "to rounding"
    found = estimate(HALVED, [2.0, 2.0 + 1e-13, 2.0, 2.0 - 1e-13, 2.0], rounding=1e-12)
    assert found.verdict == "to rounding"
    assert found.limit == 2.0
    assert 0.0 < found.bar < 1e-12
    assert math.isnan(found.order)


def test_a_missing_value_is_not_compared() -> None:
    assert estimate(HALVED, [1.0, 2.0, math.nan, 1.0, 1.0])[0] == "not comparable"


@pytest.mark.gate
@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_bars_hold_with_noise(order: float) -> None:
    rng = np.random.default_rng(3)
    held, tight = 0, []
    for _ in range(200):
        values = [1.0 + h**order + 0.1 * HALVED[-1] ** order * rng.standard_normal() for h in HALVED]
        found = estimate(HALVED, values)
        held += abs(values[-1] - 1.0) <= found.bar
        tight.append(found.bar / abs(values[-1] - 1.0))
    assert held >= 190
    assert np.median(tight) < 5.0


def test_scale_and_shift_change_nothing() -> None:
    values = [1.0, 0.5, 0.3, 0.21, 0.16]
    one, two = estimate(HALVED, values), estimate([3e-9 * h for h in HALVED], [7.0 - 2e6 * v for v in values])
    assert two.order == pytest.approx(one.order, rel=1e-4)
    assert two.limit == pytest.approx(7.0 - 2e6 * one.limit, rel=1e-4)
    assert two.bar == pytest.approx(2e6 * one.bar, rel=1e-4)


def test_bar_of_two_grids() -> None:
    for order, ratio in ((1.0, 2.0), (2.0, 2.0), (1.5, 3.0)):
        fine, coarse = 1.0 + 0.1**order, 1.0 + (0.1 * ratio) ** order
        assert pair_bar(fine, coarse, order, ratio) == pytest.approx(SAFETY * (fine - 1.0))

"""Limits of wear: numbers, and the conditions that they come from."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from tests.support.checks.wear_limits import final_pressure, final_profile, final_volume, rigid_sliding


def test_the_final_state_of_partial_slip_has_known_numbers() -> None:
    volume, depth, end = final_volume(0.5)
    assert (volume, depth, end) == pytest.approx((0.072625, 0.112733, 1.16919), abs=5e-6)
    assert float(final_pressure(np.zeros(1), 0.5)[0]) == pytest.approx(1.06066, abs=5e-6)


@pytest.mark.parametrize("ratio", [0.05, 0.5, 0.95])
def test_volume_and_depth_are_those_of_the_profile(ratio: float) -> None:
    volume, depth, end = final_volume(ratio)
    stick = math.sqrt(1.0 - ratio)
    x = np.linspace(stick, end, 20_001)
    assert final_profile(x, ratio).max() == pytest.approx(depth, rel=1e-8)
    assert 2.0 * quad(lambda x: float(final_profile(np.array(x), ratio)), stick, end)[0] == pytest.approx(
        volume, rel=1e-7
    )
    assert not final_profile(np.array([0.0, stick, end + 1e-9, 3.0]), ratio).any()


@pytest.mark.parametrize("ratio", [0.05, 0.5, 0.95])
def test_the_pressure_carries_the_load_and_leaves_the_worn_surfaces_touching(ratio: float) -> None:
    """P = pi a p0/2. The slope of the parabola less the elastic one, int N/(x - t) dt/(pi p0), is that of the wear."""
    stick = math.sqrt(1.0 - ratio)

    def at(angle: float) -> float:
        """The pressure times dx, x = c sin angle: the ends are smooth then."""
        x = stick * math.sin(angle)
        return float(final_pressure(np.array(x), ratio)) * stick * math.cos(angle)

    half = 0.5 * math.pi * (1.0 - 1e-9)
    assert quad(at, -half, half)[0] == pytest.approx(0.5 * math.pi, rel=1e-6)
    x, step = 0.5 * (stick + final_volume(ratio)[2]), 1e-6
    elastic = quad(lambda angle: at(angle) / (x - stick * math.sin(angle)), -half, half)[0] / math.pi
    slope = np.diff(final_profile(np.array([x - step, x + step]), ratio))[0] / (2.0 * step)
    assert slope == pytest.approx(elastic - x, abs=1e-6)


def test_a_rigid_pin_wears_by_its_pressure() -> None:
    """The depth grows by N0 along the path, and late N0 is that of a pin that fills the hole."""
    assert rigid_sliding(1.0, 8.0, 0.2) == pytest.approx((5.2619, 0.6254), abs=6e-5)
    assert rigid_sliding(10.0, 8.0, 0.2) == pytest.approx((6.943, 0.6925), abs=5e-4)
    for path in (0.1, 2.0, 30.0):
        before, here, after = (rigid_sliding(1.0, path + change, 0.2) for change in (-1e-4, 0.0, 1e-4))
        assert (after[0] - before[0]) / 2e-4 == pytest.approx(here[1], rel=1e-6)
    assert rigid_sliding(1.0, 1e6, 0.2)[1] == pytest.approx(2.0 / (math.pi * math.hypot(1.0, 0.2)), rel=1e-5)

"""Angles from the bottom of the hole."""

import math

import numpy as np
import pytest

from fastpin.model.angles import BOTTOM, from_bottom, interval_from_bottom, interval_near_bottom, near_bottom

TURNS = [-3, -1, 0, 1, 2]


def test_angles_from_the_bottom() -> None:
    assert from_bottom(-0.5 * np.pi) == 0.0
    assert from_bottom(0.0) == pytest.approx(90.0)
    assert from_bottom(0.5 * np.pi) == pytest.approx(180.0)
    assert from_bottom(np.pi) == pytest.approx(-90.0)
    assert interval_from_bottom(0.0, np.pi) == pytest.approx((90.0, 270.0))


@pytest.mark.parametrize("turns", TURNS)
def test_angles_are_moved_next_to_the_bottom(turns: int) -> None:
    turn = 2.0 * math.pi * turns
    for angle in (BOTTOM, BOTTOM - 3.1, BOTTOM + 3.1, 0.5 * math.pi):
        assert near_bottom(angle + turn) == pytest.approx(angle, abs=1e-12)
        assert from_bottom(angle + turn) == pytest.approx(math.degrees(angle) + 90.0, abs=1e-9)
    for interval in ((BOTTOM - 0.3, BOTTOM + 0.2), (0.7, 2.4), (-4.9, -3.0), (BOTTOM - math.pi, BOTTOM + math.pi)):
        moved = interval_near_bottom(interval[0] + turn, interval[1] + turn)
        assert moved == pytest.approx(interval, abs=1e-12)
        degrees = interval_from_bottom(interval[0] + turn, interval[1] + turn)
        assert degrees == pytest.approx([math.degrees(angle) + 90.0 for angle in interval], abs=1e-9)


@pytest.mark.parametrize("turns", TURNS)
@pytest.mark.parametrize("rounding", [-1e-9, 0.0, 1e-9])
def test_rounding_does_not_choose_the_side_of_the_top(turns: int, rounding: float) -> None:
    top = 0.5 * math.pi + 2.0 * math.pi * turns + rounding
    assert near_bottom(top) == pytest.approx(0.5 * math.pi, abs=1e-8)
    assert from_bottom(top) == pytest.approx(180.0, abs=1e-6)
    assert interval_from_bottom(top - 0.4, top + 0.4)[0] > 0.0


def test_angles_within_half_a_turn_keep_their_bits() -> None:
    for angle in np.random.default_rng(1).uniform(-4.7, 1.5, 200).tolist():
        assert near_bottom(angle) == angle
        assert interval_near_bottom(angle - 0.1, angle + 0.1) == (angle - 0.1, angle + 0.1)
    assert math.isnan(near_bottom(math.nan))

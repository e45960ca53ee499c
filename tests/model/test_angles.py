"""Angles from the bottom of the hole."""

from __future__ import annotations

import numpy as np
import pytest

from fastpin.model.angles import from_bottom, interval_from_bottom


def test_angles_from_the_bottom() -> None:
    assert from_bottom(-0.5 * np.pi) == 0.0
    assert from_bottom(0.0) == pytest.approx(90.0)
    assert from_bottom(0.5 * np.pi) == pytest.approx(180.0)
    assert from_bottom(np.pi) == pytest.approx(-90.0)
    assert interval_from_bottom(0.0, np.pi) == pytest.approx((90.0, 270.0))

"""Units with prefixes."""

from __future__ import annotations

import pytest

from fastpin.model.units import scaled


@pytest.mark.parametrize(
    ("values", "unit", "expected"),
    [
        ([1.2e8, -3e7], "Pa", (1e-6, "MPa")),
        ([1e6], "Pa", (1e-6, "MPa")),
        ([999.0], "N/m", (1.0, "N/m")),
        ([2e-5], "m", (1e6, "um")),
        ([0.0], "m", (1.0, "m")),
        ([float("nan"), 1e3], "m", (1e-3, "km")),
        ([1e-9], "F/R", (1.0, "F/R")),
        ([1e30], "Pa", (1e-9, "GPa")),
    ],
)
def test_scaled(values: list[float], unit: str, expected: tuple[float, str]) -> None:
    factor, label = scaled(values, unit)
    assert (factor, label) == (pytest.approx(expected[0]), expected[1])

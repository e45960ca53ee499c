"""Units with prefixes."""

import pytest

from fastpin.model.problem import Problem
from fastpin.model.units import Unit, scaled, units, units_per_thickness
from tests.support.samples import PAIR


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
        ([3.8e-9], "m^2", (1e12, "um^2")),
        ([2e-7, 1e-9], "m^2", (1e6, "mm^2")),
        ([5e-11], "m^3", (1e9, "mm^3")),
        ([2e-14], "1/Pa", (1.0, "1/Pa")),
    ],
)
def test_scaled(values: list[float], unit: str, expected: tuple[float, str]) -> None:
    factor, label = scaled(values, unit)
    assert (factor, label) == (pytest.approx(expected[0]), expected[1])


def test_a_thickness_comes_as_a_factor_and_a_unit() -> None:
    plain, thick = (units(Problem(PAIR, 0.01, 2e-5, 0.4, thickness=each)) for each in (None, 0.01))
    assert {kind: unit.name for kind, unit in plain.items()} == units_per_thickness(Problem(PAIR, 0.01, 2e-5, 0.4))
    changed = {kind: (plain[kind].name, unit) for kind, unit in thick.items() if unit != plain[kind]}
    assert changed == {
        "force": ("N/m", Unit(0.01, "N")),
        "moment": ("N", Unit(0.01, "N m")),
        "stiffness": ("N/rad", Unit(0.01, "N m/rad")),
        "rig stiffness": ("N/m^2", Unit(0.01, "N per m")),
        "energy": ("J/m", Unit(0.01, "J")),
        "work per stress": ("m^2", Unit(0.01, "m^3")),
    }
    assert (plain["force"].text(5e5), thick["force"].text(5e5)) == ("500 kN/m", "5 kN")
    assert thick["force"].scale([5e5]) == (pytest.approx(1e-5), "kN")
    assert (plain["work per stress"].text(1e-8), thick["work per stress"].text(1e-8)) == ("0.01 mm^2", "0.1 mm^3")


def test_a_unit_without_its_factor_is_found() -> None:
    with pytest.raises(TypeError, match="a unit is printed by text or scale"):
        f"{Unit(0.01, 'N')}"

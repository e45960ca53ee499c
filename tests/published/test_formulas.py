"""The formulas for a spreadsheet against closed forms and fresh solves."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, Material, MaterialPair, Problem, State, solve
from fastpin.bodies.body import PinLoad
from fastpin.model.materials import Plane
from fastpin.published import half_angle, load_term, peak_pressure
from fastpin.published.handbook_formulas import SPREAD
from fastpin.verification import closed_forms

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "handbook-formulas.md").read_text(encoding="utf-8")
STEEL = MATERIALS["steel"]


def pushed(load_parameter: float, friction: float, material: Material, plane: Plane, pin_load: PinLoad) -> State:
    problem = Problem.from_load_parameter(MaterialPair(material, material, plane), load_parameter, friction, pin_load)
    return solve(problem, [{"P": 1.0}], nodes=151)[-1]


@pytest.mark.parametrize(
    ("places", "of_peak", "of_angle"),
    [(np.r_[0.0, np.logspace(-4.0, 6.0, 400)], 1.5e-4, 1.5e-4), (np.linspace(-0.06, 0.0, 25), 0.008, 0.012)],
    ids=["clearance", "an interference fit that opens"],
)
def test_without_friction_both_formulas_agree_with_the_closed_form(places, of_peak, of_angle) -> None:
    exact = closed_forms.persson_half_angle(places)
    peaks = 2.0 * np.array([closed_forms.persson_pressure(0.0, angle) for angle in np.asarray(exact)])
    assert np.abs(peak_pressure(places) / peaks - 1.0).max() < of_peak
    assert np.abs(half_angle(places) / exact - 1.0).max() < of_angle


@pytest.mark.parametrize("pin_load", ["body", "centre"])
@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_fresh_solves_with_friction(pin_load: PinLoad, plane: Plane) -> None:
    """The places are random, so none of them was used in fitting. The largest error of the fit is 0.73 %."""
    random = np.random.default_rng(20)
    for _ in range(10):
        place, friction, nu = 10.0 ** random.uniform(-3.0, 1.5), random.uniform(0.0, 0.9), random.uniform(0.0, 0.45)
        material = Material(1.0, nu)
        fitted = peak_pressure(place, friction, load_term(material, plane, pin_load))
        solved = 2.0 * pushed(place, friction, material, plane, pin_load).peak_pressure
        assert fitted == pytest.approx(solved, rel=0.008)


def test_the_term_of_the_load() -> None:
    material = Material(1.0, 0.3)
    assert load_term(material) == pytest.approx(SPREAD, rel=1e-12)
    assert load_term(material, "strain", "centre") == pytest.approx(1.0 / (4.0 * 0.7), rel=1e-12)
    assert load_term(material, "stress", "centre") == pytest.approx(1.3 / 4.0, rel=1e-12)


@pytest.mark.parametrize("arguments", [(-0.061,), (-0.01, 0.1), (0.1, 0.91), (0.1, -0.1), (0.1, 0.1, 0.6)])
def test_arguments_out_of_range_are_refused(arguments: tuple[float, ...]) -> None:
    with pytest.raises(InputError):
        peak_pressure(*arguments)


def test_the_lines_for_a_spreadsheet_are_the_formulas() -> None:
    """Each line is evaluated as Python, with the names of its cells."""
    lines = dict(re.findall(r"^(\w+) +=(.*)$", PAGE, re.MULTILINE))
    cells: dict[str, float] = {"F": 30e3, "L": 15e-3, "D": 20e-3, "clr": 20e-6, "mu": 0.3, "q": 0.5 / (4.0 * 0.7)}
    elastic = (1.0 - STEEL.nu**2) / STEEL.E
    cells["Es"] = 1.0 / (2.0 * elastic)
    names = {"SQRT": math.sqrt, "PI": lambda: math.pi, "DEGREES": math.degrees}
    for name in ("Lp", "x", "pfree", "p", "half"):
        cells[name] = eval(lines[name].replace("^", "**"), names, cells)
    nominal = cells["F"] / (cells["D"] * cells["L"])
    assert cells["pfree"] == pytest.approx(nominal * float(peak_pressure(cells["Lp"])), rel=1e-12)
    assert cells["p"] == pytest.approx(nominal * float(peak_pressure(cells["Lp"], 0.3)), rel=1e-12)
    assert cells["half"] == pytest.approx(math.degrees(float(half_angle(cells["Lp"]))), rel=1e-12)
    pair = MaterialPair(STEEL, STEEL)
    assert cells["Lp"] == pytest.approx(Problem(pair, 10e-3, cells["clr"], 0.3).load_parameter(2e6), rel=1e-12)
    printed = [
        f"{cells['Lp']:.4f}",
        f"{cells['pfree'] / 1e6:.1f} MPa",
        f"{cells['p'] / 1e6:.1f} MPa",
        f"{cells['half']:.1f}",
    ]
    for number in printed:
        assert number in PAGE, number

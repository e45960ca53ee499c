"""The formulas for a spreadsheet against closed forms and fresh solves."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from fastpin.benchmarks import half_angle, peak_pressure
from fastpin.errors import InputError
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.states.state import State
from fastpin.verification import closed_forms

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "handbook-formulas.md").read_text(encoding="utf-8")
STEEL = MATERIALS["steel"]


def pushed(load_parameter: float, friction: float, pin_load: str, plane: str = "strain") -> State:
    pair = MaterialPair(STEEL, STEEL, plane)  # type: ignore[arg-type]
    problem = Problem.from_load_parameter(pair, load_parameter, friction, pin_load)  # type: ignore[arg-type]
    return solve(problem, [{"P": 1.0}], nodes=201)[-1]


def test_without_friction_both_formulas_agree_with_the_closed_form() -> None:
    places = np.r_[0.0, np.logspace(-4.0, 6.0, 400)]
    exact = closed_forms.persson_half_angle(places)
    peaks = 2.0 * np.array([closed_forms.persson_pressure(0.0, angle) for angle in np.asarray(exact)])
    assert np.abs(peak_pressure(places) / peaks - 1.0).max() < 1.5e-4
    assert np.abs(half_angle(places) / exact - 1.0).max() < 1.5e-4


def test_an_interference_fit_that_opens_is_in_reach() -> None:
    places = np.linspace(-0.06, 0.0, 25)
    exact = closed_forms.persson_half_angle(places)
    peaks = 2.0 * np.array([closed_forms.persson_pressure(0.0, angle) for angle in np.asarray(exact)])
    assert np.abs(peak_pressure(places) / peaks - 1.0).max() < 0.008
    assert np.abs(half_angle(places) / exact - 1.0).max() < 0.012


@pytest.mark.parametrize("pin_load", ["body", "centre"])
def test_fresh_solves_with_friction(pin_load: str) -> None:
    """The places are random, so none of them was used in fitting. The largest error measured is 0.7 %."""
    random = np.random.default_rng(20)
    for load_parameter, friction in zip(
        10.0 ** random.uniform(-3.0, 1.5, 12), random.uniform(0.0, 0.9, 12), strict=True
    ):
        fitted = peak_pressure(load_parameter, friction, pin_load)  # type: ignore[arg-type]
        assert fitted == pytest.approx(2.0 * pushed(load_parameter, friction, pin_load).peak_pressure, rel=0.0075)


@pytest.mark.parametrize(("pin_load", "most"), [("body", 0.015), ("centre", 0.03)])
def test_the_error_in_plane_stress_is_stated(pin_load: str, most: float) -> None:
    """The term of the load of the pin is smaller than in plane strain. The worst places have small L_p."""
    errors = [
        float(peak_pressure(place, 0.85, pin_load)) / (2.0 * pushed(place, 0.85, pin_load, "stress").peak_pressure)
        - 1.0  # type: ignore[arg-type]
        for place in (0.002, 0.01)
    ]
    assert 0.005 < max(errors) < most


@pytest.mark.parametrize("arguments", [(-0.061,), (-0.01, 0.1), (0.1, 0.91), (0.1, -0.1), (0.1, 0.1, "top")])
def test_arguments_out_of_range_are_refused(arguments: tuple[float, ...]) -> None:
    with pytest.raises(InputError):
        peak_pressure(*arguments)  # type: ignore[arg-type]


def test_the_lines_for_a_spreadsheet_are_the_formulas() -> None:
    """Each line is evaluated as Python, with the names of its cells."""
    lines = dict(re.findall(r"^(\w+) +=(.*)$", PAGE, re.MULTILINE))
    cells: dict[str, float] = {"F": 30e3, "L": 15e-3, "D": 20e-3, "c": 20e-6, "mu": 0.3}
    elastic = (1.0 - STEEL.nu**2) / STEEL.E
    cells["Es"] = 1.0 / (2.0 * elastic)
    names = {"SQRT": math.sqrt, "PI": lambda: math.pi, "DEGREES": math.degrees}
    for name in ("Lp", "x", "p0", "p", "half"):
        cells[name] = eval(lines[name].replace("^", "**"), names, cells)
    nominal = cells["F"] / (cells["D"] * cells["L"])
    assert cells["p0"] == pytest.approx(nominal * float(peak_pressure(cells["Lp"])), rel=1e-12)
    assert cells["p"] == pytest.approx(nominal * float(peak_pressure(cells["Lp"], 0.3)), rel=1e-12)
    assert cells["half"] == pytest.approx(math.degrees(float(half_angle(cells["Lp"]))), rel=1e-12)
    pair = MaterialPair(STEEL, STEEL)
    assert cells["Lp"] == pytest.approx(Problem(pair, 10e-3, cells["c"], 0.3).load_parameter(2e6), rel=1e-12)
    printed = [
        f"{cells['Lp']:.4f}",
        f"{cells['p0'] / 1e6:.1f} MPa",
        f"{cells['p'] / 1e6:.1f} MPa",
        f"{cells['half']:.1f}",
    ]
    for number in printed:
        assert number in PAGE, number

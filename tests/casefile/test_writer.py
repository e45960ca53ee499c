"""Case files that are written read back as the same case."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from fastpin import MATERIALS, Case, InputError, LoadHistory, Material, MaterialPair, Problem, SolveOptions, casefile
from fastpin.bodies import Bushing, Compliance, Plate, Ring, Tube
from fastpin.casefile import parse_case
from fastpin.cracks import Walker
from fastpin.model import About

TITANIUM, ALUMINIUM = MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"]
STEEL, SHEET = MATERIALS["steel"], MATERIALS["2024-T3"]
THIRD = 1.0 / 3.0
"""A number of which no digit may be lost."""

BODIES: dict[str, dict[str, Any]] = {
    "plain": {},
    "held pin": {"pin_load": "centre", "rotation": "spring", "hub_stiffness": 1e6 * THIRD, "hub_radius": 5e-3 * THIRD},
    "driven": {"pin_load": "centre", "drive": "both", "gauge_radius": 0.02 * THIRD + 0.02},
    "tube": {"pin_load": "centre", "pin_body": Tube(4e-3 * THIRD, "normal")},
    "reaction": {"plate_body": Plate((0.0, 0.06 * THIRD))},
    "ring": {"plate_body": Ring(0.06 * THIRD, "half")},
    "bush": {"plate_body": Bushing(Material(110e9, THIRD), 0.0125, 2e-5 * THIRD)},
    "bush that slips": {
        "plate_body": Bushing(Material(110e9, THIRD), 0.0125, 2e-5 * THIRD, friction=0.2 * THIRD, bonded=False)
    },
    "bush in a ring": {"plate_body": Bushing(STEEL, 0.0125, inside=Ring(0.02, "normal"))},
}


@pytest.mark.parametrize("name", BODIES)
def test_a_written_case_reads_back_to_the_same_bits(name: str) -> None:
    pair = MaterialPair(dataclasses.replace(TITANIUM, E=116e9 * THIRD, name=""), ALUMINIUM, "stress")
    changes = {"pin_load": "body", **BODIES[name]}
    problem = Problem(pair, 0.01, 2e-5 * THIRD, 0.4 * THIRD, **changes)
    loads = {"ux": 1e-5, "uy": -1e-5} if name == "driven" else {"P": 1e6, "Q": -1e5}
    rows = [{key: value * math.sin(k) for key, value in loads.items()} for k in range(1, 21)]
    case = Case(
        problem, LoadHistory(rows), SolveOptions(nodes=61, arc=(-3.0, -0.1), slip_sums=True), 'a "title" \\ \xa0 µ',
        About('a "project" \\', "", "B", "2026-03-31"),
    )  # fmt: skip
    back = parse_case(casefile.case_text(case))
    assert back.problem == problem
    assert np.array_equal(back.history.values(), case.history.values())
    assert (back.options, back.title, back.about) == (case.options, case.title, case.about)


def test_named_rigid_and_worn_materials_are_written() -> None:
    worn = dataclasses.replace(SHEET, E=71e9, yield_strength=1e9 * THIRD, ultimate_strength=2e9 * THIRD)
    worn = dataclasses.replace(worn, growth=Walker(1e-10 * THIRD, 3.0, 0.5, toughness=3e7, source='a "book"'))
    for pair in (MaterialPair(STEEL, SHEET), MaterialPair(Material.rigid(), worn), MaterialPair(worn, STEEL)):
        problem = Problem(pair, 0.01, 0.0, 0.5)
        back = parse_case(casefile.case_text(Case(problem, LoadHistory([{"P": 1e6}]))))
        assert back.problem.pair.pin.E == pair.pin.E
        assert back.problem.pair.plate.fatigue == pair.plate.fatigue
        assert back.problem.pair.plate.strengths == pair.plate.strengths
        assert back.problem.pair.plate.growth == pair.plate.growth
        assert back.problem.pair.pin.fatigue == pair.pin.fatigue


def test_a_dimensionless_case_reads_back() -> None:
    problem = Problem.from_load_parameter(MaterialPair(TITANIUM, ALUMINIUM), 0.1 * THIRD, 0.4)
    back = parse_case(casefile.case_text(Case(problem, LoadHistory([{"P": 1.0}, {"Q": 0.1}]))))
    assert back.problem.dimensionless
    assert back.problem.clearance == problem.clearance
    assert pytest.approx(problem.pair.pin.E, rel=1e-14) == back.problem.pair.pin.E
    assert back.history.values().tolist() == [[1.0] + [0.0] * 11, [1.0, 0.1] + [0.0] * 10]


def test_the_built_in_case_is_written_whole() -> None:
    case = casefile.builtin_case()
    back = parse_case(casefile.case_text(case))
    assert (back.problem, back.options, back.title) == (case.problem, case.options, case.title)
    assert np.array_equal(back.history.values(), case.history.values())


def test_a_compliance_is_refused() -> None:
    body = Compliance(0.33, "strain", 1.0, np.diag(0.1 ** np.arange(18.0)))
    problem = Problem(
        MaterialPair(STEEL, Material(70e9, body.nu), body.plane), body.hole_radius, 0.0, 0.5, plate_body=body
    )
    with pytest.raises(InputError, match="plate_body: a compliance has a file of its own"):
        casefile.case_text(Case(problem, LoadHistory([{"P": 1e6}])))

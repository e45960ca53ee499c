"""Pins and holes of a joint that are not round: against one pin, a larger clearance, and in files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import Grid, MaterialPair, Problem
from fastpin.joints import Joint, JointPin, parse_joint, solve_joint
from fastpin.joints.document import document_of, joint_from
from fastpin.joints.varied import BaseJoint
from fastpin.model import InitialGap, Profile
from fastpin.model.angles import BOTTOM
from tests.support.faults import faults_of
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEET, SHEETS, STEEL, through_both, with_cover
from tests.support.refusals import refused

UNIT = BETA * FORCE
OVAL = InitialGap(Profile.ellipse(0.03 * UNIT, 0.3), Profile.harmonic(3, 0.01 * UNIT, 0.0))
LOADS = [{"A.y": -FORCE}, {"A.x": 0.3 * FORCE}, {"A.y": -0.3 * FORCE, "A.x": -0.3 * FORCE}]


def in_sheet(*pins: JointPin) -> Joint:
    return Joint((SHEET,), pins)


@pytest.mark.parametrize(
    ("clearance", "friction", "within"),
    [(-0.2, 0.3, 2e-9), (0.02, 0.3, 1e-6), (0.1, 0.0, 1e-6)],
    ids=["gripped", "gripped at bumps", "loose and smooth"],
)
def test_one_pin_is_that_of_solve(clearance: float, friction: float, within: float) -> None:
    gap = replace(OVAL, hole=Profile.lobes(3, 0.1 * UNIT, 0.3)) if clearance == 0.02 else OVAL
    pair = MaterialPair(STEEL, ALUMINIUM, "stress")
    problem = Problem(pair, 1.0, clearance * UNIT, friction, pin_load="body", gap=gap)
    history = [{"P": -load.get("A.y", -FORCE), "Q": load.get("A.x", 0.0)} for load in LOADS]
    alone = fastpin.solve(problem, history, grid=Grid.circle(48, BOTTOM))
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), clearance * UNIT, friction, gap=gap)
    joined = solve_joint(in_sheet(pin), LOADS, nodes=48)
    for one, state in zip(alone, joined, strict=True):
        found = state["A", "sheet"]
        assert found.problem.gap == gap
        np.testing.assert_array_equal(found.status, one.status)
        for name in ("pressure", "shear"):
            np.testing.assert_allclose(getattr(found, name), getattr(one, name), atol=within * FORCE)


@pytest.mark.gate
def test_a_gap_that_is_the_same_all_round_is_a_clearance() -> None:
    """In one plate of two, of pins that are loose there and gripped in the other plate."""
    fits = {"sheet": 0.05 * UNIT, "cover": -0.1 * UNIT}
    pins = [replace(through_both(f"p{k}", 9.0 * k, 0.0), clearance=fits) for k in range(2)]
    wider = [replace(pin, clearance=fits | {"sheet": 0.12 * UNIT}) for pin in pins]
    grown = [replace(pin, gap={"sheet": 0.07 * UNIT}) for pin in pins]
    load = {"sheet.sxx": 0.3 * FORCE, "p0.y": -0.2 * FORCE}
    one, other = (solve_joint(with_cover(*each), [load], nodes=32, harmonics=6)[0] for each in (wider, grown))
    for mine, theirs in zip(one.contacts, other.contacts, strict=True):
        np.testing.assert_allclose(mine.pressure, theirs.pressure, atol=1e-12 * FORCE)
        np.testing.assert_allclose(mine.slip, theirs.slip, atol=1e-12 * UNIT)
    assert other["p0", "sheet"].problem.gap
    assert not other["p0", "cover"].problem.gap


GAP = "gap = { hole = { ellipse = 3e-6, axis = 30.0 }, pin = [{ flat = 2e-6, centre = 0.0 }, 1e-6] }"
IN_PLATES = "gap = { sheet = { hole = { lobes = 3, size = 1e-6 } } }"


@pytest.mark.parametrize("gap", [GAP, IN_PLATES])
def test_a_file_has_the_gap_of_all_plates_or_of_each(gap: str) -> None:
    joint = parse_joint(SHEETS.replace("friction = 0.2", f"friction = 0.2\n{gap}")).joint
    kept = joint.pins[1].gap_in("sheet")
    if gap == GAP:
        assert kept.hole.at(np.array([np.radians(-60.0)]), 1.0) == pytest.approx(3e-6)
        assert len(kept.pin.terms) == 2
    else:
        assert kept.hole.at(np.array([BOTTOM]), 1.0) == pytest.approx(1e-6)
    assert joint_from(document_of(joint)) == joint
    plain = parse_joint(SHEETS).joint
    assert all("gap" not in pin for pin in document_of(plain)["pins"])


def test_a_gap_of_a_csv_file_and_its_variation(tmp_path: Path) -> None:
    (tmp_path / "gap.csv").write_text("angle [deg],gap [um]\n0,1\n90,2\n180,1\n270,2\n")
    text = SHEETS.replace("friction = 0.2", 'friction = 0.2\ngap = { hole = "gap.csv", pin = { ellipse = 1e-6 } }')
    base = BaseJoint(text, "joint.toml", tmp_path)
    assert base.file is not None
    assert base.file.joint.pins[0].gap_in("sheet").hole.at(np.array([0.0]), 1.0)[0] == pytest.approx(2e-6)
    assert base.fault(("pin", "A", "gap", "pin", "ellipse")) is None
    assert base.kind("pin.A.gap.pin.ellipse") == "displacement"
    _, varied = base.vary({"pin.A.gap.pin.ellipse": 2e-6})
    assert varied is not None
    sizes = [pin.gap_in("sheet").pin.at(np.array([BOTTOM]), 1.0)[0] for pin in varied.joint.pins]
    assert sizes == pytest.approx([2e-6, 1e-6])


@pytest.mark.parametrize(
    ("gap", "words"),
    [
        ("3e-6", "gap: must be a table { hole, pin }, not 3e-06"),
        ("{ holes = 1e-6 }", 'unknown key "holes" in gap, did you mean "hole"?'),
        ("{ hole = 1e-3 }", "hole: is too large for small strains"),
        ("{ hole = { zone = 1e-6, start = 0, stop = 9 } }", "hole: must not jump: a zone has a step at its ends"),
        ("{ sheet = { hole = { ellips = 1e-6 } } }", "hole: must be a table with one of"),
        ("{ sheet = { hole = 1e-6 }, skin = {} }", 'unknown key "skin" in gap; the plates of the pin are sheet'),
    ],
)
def test_a_wrong_gap_is_told(gap: str, words: str) -> None:
    text = SHEETS.replace("friction = 0.2", f"friction = 0.2\ngap = {gap}")
    found = faults_of(parse_joint, text)
    assert [line for line, _ in found] == [20], found
    assert words in found[0][1]


@pytest.mark.parametrize(("gap", "field"), [({"skin": 1e-6}, "gap"), ("oval", "gap.hole")])
def test_a_wrong_gap_of_a_pin_is_refused(gap: Any, field: str) -> None:
    assert refused(JointPin, "A", 0j, STEEL, 1.0, ("sheet",), gap=gap).field == field


def test_a_gap_that_is_too_large_is_refused_with_pin_and_plate() -> None:
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), gap=Profile.ellipse(0.2, 0.0))
    error = refused(in_sheet, pin)
    assert error.field == "pin.A.gap.hole"
    assert error.reason.startswith("in sheet: is too large for small strains")

"""Pins and plates of a joint that a displacement moves: against one pin, and against the reaction as a load."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import Grid, MaterialPair, Problem
from fastpin.bodies import Bushing
from fastpin.joints import Clamp, Joint, JointPin, JointResult, parse_joint, solve_joint
from fastpin.joints.document import document_of, joint_from
from fastpin.joints.varied import BaseJoint
from fastpin.model.angles import BOTTOM
from fastpin.report import joints as report
from fastpin.storage import record_joint
from tests.support.faults import faults_of
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEET, SHEETS, STEEL, lap
from tests.support.refusals import refused

UNIT = BETA * FORCE
MOVES = (-0.6, -0.2, -0.8)


def in_sheet(clearance: float = 0.1, friction: float = 0.3, **more: object) -> Joint:
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), clearance * UNIT, friction, **more)  # type: ignore[arg-type]
    return Joint((SHEET,), (pin,))


def check_same(one: JointResult, other: JointResult, within: float) -> None:
    for mine, theirs in zip(one, other, strict=True):
        np.testing.assert_allclose(mine.forces, theirs.forces, atol=within * FORCE)
        for name, value in mine.load.items():
            if name in theirs.load:
                assert theirs.load[name] == pytest.approx(value, abs=within * FORCE)
        for contact, same in zip(mine.contacts, theirs.contacts, strict=True):
            for a, b in filter(all, ((contact, same), (contact.seat, same.seat))):
                assert a is not None
                assert b is not None
                np.testing.assert_array_equal(a.status, b.status)
                np.testing.assert_allclose(a.pressure, b.pressure, atol=within * FORCE)
                np.testing.assert_allclose(a.shear, b.shear, atol=within * FORCE)
        assert max(mine.residuals.values()) < 1e-12


@pytest.mark.parametrize(("friction", "within"), [(0.0, 1e-12), (0.3, 5e-4)])
def test_one_pin_that_is_driven_is_that_of_solve(friction: float, within: float) -> None:
    """With friction the first contact differs, as under a force. The reaction has the springs of loose pins."""
    pair = MaterialPair(STEEL, ALUMINIUM, "stress")
    problem = Problem(pair, 1.0, 0.1 * UNIT, friction, pin_load="body", drive="both")
    moved = [(0.0, -0.6), (0.3, -0.6), (-0.3, -0.7)]
    history = [{"ux": x * UNIT, "uy": y * UNIT} for x, y in moved]
    alone = fastpin.solve(problem, history, grid=Grid.circle(48, BOTTOM))
    corners = [{f"A.{name}": value for name, value in load.items()} for load in history]
    driven = solve_joint(in_sheet(friction=friction, drive="both"), corners, nodes=48)
    for one, state in zip(alone, driven, strict=True):
        found = state["A", "sheet"]
        np.testing.assert_allclose(found.pressure, one.pressure, atol=within * FORCE)
        np.testing.assert_allclose(found.shear, one.shear, atol=4.0 * within * FORCE)
        reaction = [state.load["A.x"], -state.load["A.y"]]
        np.testing.assert_allclose(reaction, [one.load["Q"], one.load["P"]], atol=max(within, 1e-6) * FORCE)


def test_a_pin_in_a_bush_that_a_displacement_moves_is_that_under_its_reaction() -> None:
    bush = Bushing(ALUMINIUM, 1.3, 0.2 * UNIT, friction=0.2, bonded=False)
    driven = solve_joint(in_sheet(bush=bush, drive="uy"), [{"A.uy": each * UNIT} for each in MOVES], nodes=32)
    pushed = solve_joint(in_sheet(bush=bush), [{"A.y": state.load["A.y"]} for state in driven], nodes=32)
    check_same(driven, pushed, 1e-9)
    assert driven[0].load["A.y"] < -FORCE
    assert driven[0]["A", "sheet"].seat is not None


@pytest.mark.gate
@pytest.mark.parametrize("how", ["plain", "clamped", "sliced"])
def test_a_strap_that_a_displacement_moves_is_that_under_its_reaction(how: str) -> None:
    joint = lap((0.1, 0.3), 0.3)
    if how == "clamped":
        joint = replace(joint, pins=tuple(replace(pin, clamp=Clamp(2.0 * FORCE, 0.2)) for pin in joint.pins))
    if how == "sliced":
        plates = [replace(plate, slices=2) for plate in joint.plates]
        joint = Joint(tuple(plates), tuple(replace(pin, flexibility="beam") for pin in joint.pins))
    driven = replace(joint, plates=(joint.plates[0], replace(joint.plates[1], drive="ux")))
    given = [{"strap.ux": -each * UNIT} for each in (-3.0, -0.5, -2.0)]
    found = solve_joint(driven, given, nodes=24, harmonics=8)
    pulled = solve_joint(joint, [{"strap.x": state.load["strap.x"]} for state in found], nodes=24, harmonics=8)
    check_same(found, pulled, 1e-8)
    np.testing.assert_allclose([state.moved[1, 0] for state in found], [load["strap.ux"] for load in given], rtol=1e-12)


@pytest.mark.gate
def test_a_pin_of_two_plates_that_a_displacement_moves_is_that_under_its_reaction() -> None:
    joint = lap((0.1, 0.3), 0.3)
    driven = replace(joint, pins=(replace(joint.pins[0], drive="ux"), joint.pins[1]))
    found = solve_joint(driven, [{"p0.ux": 1.5 * UNIT}, {"p0.ux": 0.5 * UNIT}], nodes=24, harmonics=8)
    pushed = solve_joint(joint, [{"p0.x": state.load["p0.x"]} for state in found], nodes=24, harmonics=8)
    check_same(found, pushed, 1e-8)


DRIVEN = (
    SHEETS.replace("friction = 0.2", 'friction = 0.2\ndrive = "ux"')
    .replace('["A", "B"]', '"A"')
    .replace("[[0.0, 0.0], [20e-3, 0.0]]", "[0.0, 0.0]")
    .replace('"A.x" = 4e3\n"B.x" = 2e3', '"A.ux" = 20e-6')
    .replace('"A.x" = 1e3', '"A.ux" = 12e-6')
)


def test_a_file_tables_and_stored_results_have_displacements_and_reactions(tmp_path: Path) -> None:
    case = parse_joint(DRIVEN)
    assert case.corners == [{"A.ux": 20e-6}, {"A.ux": 12e-6}]
    assert joint_from(document_of(case.joint)) == case.joint
    stored = record_joint(case._replace(nodes=16), tmp_path / "joint.h5")
    check_same(stored, solve_joint(case.joint, case.corners, nodes=16), 1e-15)
    assert stored[0].load["A.ux"] == 20e-6
    assert stored[0].load["A.x"] > 1e3
    columns = {name: cells for name, _, cells in report.forces_columns(stored)}
    assert columns["A.ux"] == ["20", "12"]
    assert float(columns["A.x"][0]) > 1.0
    base = BaseJoint(DRIVEN, "joint.toml", tmp_path)
    assert base.kind("load.1.A.ux") == "displacement"
    assert base.fault(("load", "1", "A", "x")) is not None
    in_mm = DRIVEN.replace("title", 'units = "mm, N, MPa"\ntitle').replace("20e-6", "20e-3")
    assert parse_joint(in_mm.replace("5e-3\nplates", "5\nplates")).corners[0]["A.ux"] == pytest.approx(20e-6)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ('"A.ux" = 12e-6', '"A.x" = 1e3', 26, "A.x is the reaction to A.ux: drive gives the displacement in its place"),
        ('"A.ux" = 12e-6', '"A.uy" = 1e-6', 26, 'unknown key "A.uy" in [[load]]'),
        ('drive = "ux"', 'drive = "x"', 20, 'drive: must be "force", "ux", "uy" or "both", not "x"'),
        (
            "thickness = 2e-3",
            'thickness = 2e-3\ndrive = "ux"',
            11,
            "drive: the supports of sheet do not move along x: give moves",
        ),
    ],
)
def test_a_wrong_drive_is_told(old: str, new: str, line: int, words: str) -> None:
    found = faults_of(parse_joint, DRIVEN.replace(old, new))
    assert found[0][0] == line, found
    assert words in found[0][1]


def test_an_infinite_plate_with_several_pins_has_no_driven_one() -> None:
    """Under their forces its displacement has no limit."""
    pins = (*in_sheet(drive="ux").pins, JointPin("B", 5.0, STEEL, 1.0, ("sheet",)))
    error = refused(Joint, (SHEET,), pins)
    assert error.field == "pin.A.drive"
    assert error.reason.startswith("the infinite plate sheet has several pins, so A can't be driven")


def test_a_reaction_is_no_load() -> None:
    error = refused(solve_joint, in_sheet(drive="ux"), [{"A.x": 1.0}])
    assert str(error) == "corner 1: A.x is the reaction to A.ux: drive gives the displacement in its place"

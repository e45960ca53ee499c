"""Hollow pins in joints: against one hollow pin, a solid pin, and handbook formulas; their keys in files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import Grid, MaterialPair, Problem
from fastpin.bodies import Tube
from fastpin.joints import Joint, JointPin, JointPlate, parse_joint, solve_joint, tate_rosenfeld
from fastpin.joints.document import document_of, joint_from
from fastpin.joints.varied import BaseJoint
from fastpin.model.angles import BOTTOM
from tests.support.faults import faults_of
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEETS, STEEL, through_both, with_cover
from tests.support.refusals import refused

HOLLOW = SHEETS.replace("diameter = 5e-3", "diameter = 5e-3\nbore_radius = 1.5e-3")


def test_one_hollow_pin_is_that_of_solve() -> None:
    pair, clearance = MaterialPair(STEEL, ALUMINIUM, "stress"), 0.1 * BETA * FORCE
    problem = Problem(pair, 1.0, clearance, 0.3, pin_body=Tube(0.6, "body"))
    alone = fastpin.solve(problem, [{"P": FORCE}, {"Q": 0.5 * FORCE}], grid=Grid.circle(32, BOTTOM))
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), clearance, 0.3, bore_radius=0.6)
    joint = Joint((JointPlate("sheet", ALUMINIUM, 1.0),), (pin,))
    for one, state in zip(alone, solve_joint(joint, [{"A.y": -FORCE}, {"A.x": 0.5 * FORCE}], nodes=32), strict=True):
        found = state["A", "sheet"]
        np.testing.assert_array_equal(found.status, one.status)
        np.testing.assert_allclose(found.pressure, one.pressure, atol=1e-6 * FORCE)
        np.testing.assert_allclose(found.shear, one.shear, atol=1e-6 * FORCE)
        for body in ("plate", "pin"):
            assert found.peak_hoop_stress(body).value == pytest.approx(one.peak_hoop_stress(body).value, rel=1e-6)


@pytest.mark.gate
def test_a_pin_with_a_small_bore_is_a_solid_pin() -> None:
    """The error falls as the square of the bore, and its logarithm."""
    loads, found = [{"p0.y": 0.5 * FORCE, "p1.y": -0.8 * FORCE, "p1.x": 0.4 * FORCE}], {}
    for bore in (0.0, 0.1, 0.01):
        pins = (through_both(f"p{k}", at, 0.1, bore_radius=bore) for k, at in enumerate((0.0, 9.0 + 0.7j)))
        (state,) = solve_joint(with_cover(*pins), loads, nodes=24, harmonics=6)
        found[bore] = np.concatenate([contact.pressure for contact in state.contacts]) / FORCE
    errors = [float(np.abs(found[bore] - found[0.0]).max()) for bore in (0.1, 0.01)]
    assert errors[0] < 0.01
    assert errors[1] == pytest.approx(0.01 * errors[0], rel=0.1)


def test_the_flexibility_of_a_hollow_fastener() -> None:
    """By a thin tube: the area 2 pi r t, the second moment pi r^3 t, and the coefficient of shear 6/11."""
    plates, radius, wall = (ALUMINIUM, 2e-3), 2e-3, 1e-8
    area, moment = 2.0 * np.pi * radius * wall, np.pi * radius**3 * wall
    shear = 4.0 * 0.9 * 4e-3 / (9.0 * 6.0 / 11.0 * STEEL.shear_modulus * area)
    bending = 12.0 * 8e-9 / (40.0 * STEEL.E * moment)
    found = tate_rosenfeld(2.0 * radius, STEEL, plates, plates, radius - wall)
    assert found == pytest.approx(shear + bending, rel=1e-4)
    solid = tate_rosenfeld(2.0 * radius, STEEL, plates, plates)
    assert tate_rosenfeld(2.0 * radius, STEEL, plates, plates, 1e-9) == pytest.approx(solid)


def test_a_hollow_pin_from_a_file() -> None:
    joint = parse_joint(HOLLOW).joint
    assert [pin.bore_radius for pin in joint.pins] == [1.5e-3, 1.5e-3]
    assert joint_from(json.loads(json.dumps(document_of(joint)))) == joint
    assert "bore_radius" not in document_of(parse_joint(SHEETS).joint.pins[0])
    _, case = BaseJoint(SHEETS, "joint.toml", Path()).vary({"pin.A.bore_radius": 1e-3})
    assert case is not None
    assert [pin.bore_radius for pin in case.joint.pins] == [1e-3, 0.0]


@pytest.mark.parametrize("bore", ["2.45e-3", "-1e-3", "3e-3", '"wide"'])
def test_a_wrong_bore_has_its_line(bore: str) -> None:
    faults = faults_of(parse_joint, HOLLOW.replace("1.5e-3", bore))
    assert [line for line, text in faults if text.startswith("bore_radius: must")] == [17], faults


def test_a_wrong_bore_is_refused_in_python() -> None:
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), bore_radius=0.97)
    words = str(refused(Joint, (JointPlate("sheet", ALUMINIUM, 1.0),), (pin,)))
    assert words.startswith("pin.A.bore_radius: in sheet: must be at most 0.96")

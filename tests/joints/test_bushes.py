"""Joints with bushes that slip in their plates, against one pin in a bush, a joint without bushes, and files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, Material, MaterialPair, NoEquilibriumError, Problem
from fastpin.bodies import Bushing, Ring
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, parse_joint, solve_joint
from fastpin.joints.document import document_of, joint_from
from fastpin.joints.path import follow, unloaded
from fastpin.joints.solving import JointMatrices, joint_system, load_values, plate_compliance, reference_force
from fastpin.joints.varied import BaseJoint
from fastpin.kernels.status import STICK
from fastpin.model import LOADS
from fastpin.model.angles import BOTTOM
from fastpin.model.loads import Q
from fastpin.report import joints as report
from fastpin.solver import run as solver_run
from fastpin.solver.tableau import TableauMemory
from fastpin.storage import load_joint, record_joint, resume_joint
from tests.support.faults import faults_of
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEETS, STEEL, through_both, with_cover
from tests.support.refusals import refused

BRONZE, LUG = Material(110e9, 0.34), Material(69e9, 0.33)
UNIT = MaterialPair(STEEL, BRONZE, "strain").beta_star * FORCE
BUSH = 'bush = { material = "C93200", outer_radius = 3.5e-3, interference = 8e-6, bonded = false, friction = 0.15 }'
BUSHED = SHEETS.replace("friction = 0.2", f"friction = 0.2\n{BUSH}")


@pytest.mark.parametrize(
    ("clearance", "interference", "friction", "in_seat", "loads"),
    [
        (0.28, 0.26, 0.2, 0.2, ((1.0, 0.0), (1.0, 0.5))),
        (0.145, 0.065, 0.2, 0.3, ((1.0, 0.0), (0.2, 0.0))),
        (0.28, 0.26, 0.0, 0.2, ((1.0, 0.0), (1.0, 0.4))),
        (0.28, 0.26, 0.2, 0.0, ((1.0, 0.0),)),
        (0.1, -0.1, 0.0, 0.0, ((1.0, 0.4),)),
    ],
    ids=["cycle", "opens", "smooth bore", "smooth seat", "loose and smooth"],
)
def test_one_pin_in_a_bush_is_that_of_solve(
    clearance: float, interference: float, friction: float, in_seat: float, loads: Any
) -> None:
    bush = Bushing(BRONZE, 1.25, interference * UNIT, friction=in_seat, bonded=False)
    pair, clearance = MaterialPair(STEEL, LUG, "strain"), clearance * UNIT
    problem = Problem(pair, 1.0, clearance, friction, pin_load="body", plate_body=bush)
    history = [{"P": p * FORCE, "Q": q * FORCE} for p, q in loads]
    alone = fastpin.solve(problem, history, grid=Grid.circle(32, BOTTOM))
    pin = JointPin("A", 0j, STEEL, 1.0, ("lug",), clearance, friction, bush=bush)
    corners = [{"A.y": -p * FORCE, "A.x": q * FORCE} for p, q in loads]
    joined = solve_joint(Joint((JointPlate("lug", LUG, 1.0),), (pin,), "strain"), corners, nodes=32)
    for one, state in zip(alone, joined, strict=True):
        found = state["A", "lug"]
        for each, other in ((one, found), (one.seat, found.seat)):
            assert each is not None
            assert other is not None
            np.testing.assert_array_equal(other.status, each.status)
            np.testing.assert_allclose(other.pressure, each.pressure, atol=1e-5 * FORCE)
            np.testing.assert_allclose(other.shear, each.shear, atol=1e-5 * FORCE)
            np.testing.assert_allclose(other.rotation, each.rotation, atol=1e-5 * UNIT)
        assert found.seat.dissipation == pytest.approx(one.seat.dissipation, abs=1e-5 * FORCE * UNIT)
        for body in ("plate", "seat"):
            assert found.peak_hoop_stress(body).value == pytest.approx(one.peak_hoop_stress(body).value, rel=1e-3)


def test_a_joint_that_goes_on_from_the_first_contact_of_solve_is_that_of_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside :func:`fastpin.solve` a joint differs by the finite first step of `solve` alone, here by 1e-2."""
    begun: dict[str, Any] = {}

    def first_contact(system: Any, *arguments: Any) -> Any:
        begun["system"], found = system, found_by_solve(system, *arguments)
        begun["contact"] = found[0].copy()
        return found

    found_by_solve = solver_run.first_contact
    monkeypatch.setattr(solver_run, "first_contact", first_contact)
    bush = Bushing(BRONZE, 1.25, -0.1 * UNIT, friction=0.2, bonded=False)
    problem = Problem(MaterialPair(STEEL, LUG, "strain"), 1.0, 0.1 * UNIT, 0.2, pin_load="body", plate_body=bush)
    (alone,) = fastpin.solve(problem, [{"P": FORCE, "Q": 0.4 * FORCE}], grid=Grid.circle(24, BOTTOM))
    pin = JointPin("A", 0j, STEEL, 1.0, ("lug",), 0.1 * UNIT, 0.2, bush=bush)
    joint, corners = Joint((JointPlate("lug", LUG, 1.0),), (pin,), "strain"), [{"A.y": -FORCE, "A.x": 0.4 * FORCE}]
    values, plates = load_values(joint, corners), [plate_compliance(joint, each, None, float) for each in joint.plates]
    force = reference_force(joint, values)
    system = joint_system(joint, plates, force, 24)
    unit = JointMatrices(joint, plates, force, system).unit
    now, scales = begun["contact"], begun["system"].scales
    by, motion = scales.traction / system.scales.traction, now.motion.copy()
    motion[:2] += now.rest[:2]  # those of `solve` count from its first resting places
    motion[3:5] += now.rest[2:]
    part = now.load[Q] * scales.force / (0.4 * FORCE)
    loads = [np.r_[np.zeros(len(LOADS)), each * values[0] / unit, 0.0, 1.0] for each in (part, 1.0)]
    tractions, motion = by * now.tractions, by * motion
    gap, slip = np.split(system.displacement(tractions, motion, loads[0], system.initial_gap), 2)
    assert np.abs(gap[now.closed]).max() < 1e-12
    start = replace(
        unloaded(system), pressure=by * now.pressure, shear=by * now.shear, gap=np.where(now.closed, 0.0, gap),
        slip=slip, status=now.status, motion=motion, load=loads[0],
    )  # fmt: skip
    found, _ = follow(system, start, loads[1], TableauMemory(system), float)
    assert alone.seat is not None
    expected = np.r_[alone.pressure, alone.seat.pressure, alone.shear, alone.seat.shear] / system.scales.traction
    np.testing.assert_allclose(found.tractions, expected, atol=2e-6)


def stuck(joint: Joint, loads: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pressures, forces and moments, and motions of plates, if all nodes of all interfaces stick, also in tension."""
    values, plates = load_values(joint, [loads]), [plate_compliance(joint, each, 12, float) for each in joint.plates]
    force = reference_force(joint, values)
    system = joint_system(joint, plates, force, 48)
    unit = JointMatrices(joint, plates, force, system).unit
    acting = np.r_[np.zeros(len(LOADS)), values[0] / unit, 0.0, 0.0]
    matrix = np.block([[system.operator.entries(), system.motion], [system.equilibrium, system.motion_rows]])
    found = np.linalg.solve(matrix, np.r_[-system.loads @ acting, system.forces @ acting])
    own, nodes = len(joint.sections), 2 * system.grid.size
    moved = found[nodes + 3 * len(system.sections) :]
    return found[: 48 * own], system.passed(found[:nodes])[:own], moved


@pytest.mark.gate
def test_bushes_of_the_plates_own_material_that_stick_change_nothing() -> None:
    """Levers, turns and displacements of bushes: the pins pass moments. The error falls to 6e-6 with 128 nodes."""
    pins = [
        through_both(f"p{k}", at, 0.0, flexibility=0.07 * BETA, bore_radius=bore)
        for k, (at, bore) in enumerate(((0.0, 0.0), (9.0 + 0.7j, 0.5)))
    ]
    bush = Bushing(ALUMINIUM, 1.3, friction=1.0, bonded=False)
    bushed = [replace(pin, bush=bush) for pin in pins]
    partly = [replace(pin, bush={"sheet": bush}) for pin in pins]
    loads = {"sheet.sxx": 0.3 * FORCE, "sheet.sxy": 0.2 * FORCE, "p0.y": 0.5 * FORCE, "p1.y": -0.5 * FORCE}
    pressure, passed, moved = stuck(with_cover(*pins), loads)
    assert np.abs(passed[:, 2]).max() > 0.01
    for each in (bushed, partly):
        found = stuck(with_cover(*each), loads)
        for one, other in zip(found, (pressure, passed, moved), strict=True):
            np.testing.assert_allclose(one, other, atol=1e-4)


def in_plate(bush: Bushing, clearance: float = 0.1, **more: Any) -> Joint:
    """Two pins in bushes in an infinite sheet."""
    pins = [
        JointPin(name, at, STEEL, 1.0, ("sheet",), clearance * UNIT, 0.3, bush=bush, **more)
        for name, at in (("A", -4.0), ("B", 4.0))
    ]
    return Joint((JointPlate("sheet", ALUMINIUM, 1.0),), tuple(pins))


DOWN = [{"A.y": -FORCE, "B.y": -0.5 * FORCE}, {"A.y": 0.0}]


def pressures(result: JointResult) -> np.ndarray:
    return np.array([[*contact.pressure, *contact.seat.pressure] for state in result for contact in state.contacts])  # type: ignore[union-attr]


def test_a_bonded_bush_sticks_in_its_press_fit_or_opens() -> None:
    bonded = Bushing(BRONZE, 1.25, 1.5 * UNIT)
    slipping = replace(bonded, bonded=False, friction=1e3)
    found = solve_joint(in_plate(bonded), DOWN, nodes=24)
    assert all((contact.seat.status == STICK).all() for state in found for contact in state.contacts)  # type: ignore[union-attr]
    np.testing.assert_allclose(pressures(found), pressures(solve_joint(in_plate(slipping), DOWN, nodes=24)), atol=1.0)
    with pytest.raises(NoEquilibriumError, match="the press fit does not hold the bonded bush"):
        solve_joint(in_plate(replace(bonded, interference=0.03 * UNIT)), DOWN, nodes=24)


def test_a_shrunk_sleeve_of_the_pins_material_makes_it_a_larger_pin() -> None:
    sleeve = Bushing(STEEL, 1.25, -0.7 * UNIT, friction=0.3, bonded=False)
    joint = in_plate(sleeve, clearance=-0.5)
    found = solve_joint(joint, [{}, *DOWN], nodes=64)
    assert all((contact.status == STICK).all() for state in found for contact in state.contacts)
    loose = found[0]["A", "sheet"].seat
    assert loose is not None
    pins = [replace(pin, bush=None, radius=1.25, clearance=float(loose.gap.mean())) for pin in joint.pins]
    solid = solve_joint(replace(joint, pins=tuple(pins)), DOWN, nodes=64)
    for state, other in zip(found[1:], solid, strict=True):
        for contact, larger in zip(state.contacts, other.contacts, strict=True):
            assert contact.seat is not None
            np.testing.assert_allclose(contact.seat.pressure, larger.pressure, atol=5e-3 * FORCE)


# -- input -------------------------------------------------------------------------------------------------------------


def test_a_bush_from_a_file() -> None:
    joint = parse_joint(BUSHED).joint
    assert joint.pins[1].bush_in("sheet") == joint.pins[1].bush
    assert joint.radius_in(joint.plates[0]) == 3.5e-3
    assert joint_from(json.loads(json.dumps(document_of(joint)))) == joint
    named = parse_joint(BUSHED.replace("bush = {", "bush.sheet = {")).joint
    assert named.pins[0].bush_in("sheet") == joint.pins[0].bush
    assert joint_from(json.loads(json.dumps(document_of(named)))) == named
    inches = BUSHED.replace("3.5e-3", "3.5").replace("8e-6", "8e-3").replace("5e-3", "5").replace("5e-6", "5e-3")
    text = inches.replace("2e-3", "2").replace("20e-3", "20").replace('title = "two bolts"', 'units = "mm, N, MPa"')
    assert parse_joint(text).joint.pins[0].bush_in("sheet").outer_radius == pytest.approx(3.5e-3)  # type: ignore[union-attr]


@pytest.mark.parametrize(("written", "field"), [("bush = {", "bush"), ("bush.sheet = {", "bush.sheet")])
def test_a_sweep_varies_a_bush(written: str, field: str) -> None:
    base = BaseJoint(BUSHED.replace("bush = {", written), "joint.toml", Path())
    _, case = base.vary({f"pin.A.{field}.interference": 5e-6, f"pin.*.{field}.friction": 0.3})
    assert case is not None
    bushes = [pin.bush_in("sheet") for pin in case.joint.pins]
    assert [(bush.interference, bush.friction) for bush in bushes if bush] == [(5e-6, 0.3), (8e-6, 0.3)]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("outer_radius = 3.5e-3, ", "", "outer_radius is missing in bush"),
        ("outer_radius", "outer_radiu", 'unknown key "outer_radiu" in bush, did you mean "outer_radius"?'),
        ("3.5e-3", "2.5e-3", "pin.A.bush.outer_radius: in sheet: must lie between"),
        ("friction = 0.15", "friction = -1", "friction: must not be negative, not -1"),
        (", friction = 0.15", "", "friction: a bush that is not bonded needs its friction in the plate"),
        ("bonded = false, ", "", "friction: a bonded bush does not slip"),
        (
            "interference = 8e-6, bonded = false, friction = 0.15",
            "bonded = true",
            "pin.A.bush.interference: in sheet: must",
        ),
        ("bush = {", "bush.shee = {", 'unknown key "shee" in bush, did you mean "sheet"?'),
        (BUSH, "bush = 3", "bush: must be a table { material, outer_radius, ... }, not 3"),
        ('"C93200"', '"C9320"', 'there is no material "C9320", did you mean "C93200"?'),
    ],
)
def test_a_fault_of_a_bush_has_its_line(old: str, new: str, words: str) -> None:
    faults = faults_of(parse_joint, BUSHED.replace(old, new))
    assert [line for line, text in faults if words in text] == [20]


def test_a_wrong_bush_is_refused_in_python() -> None:
    bush = Bushing(BRONZE, 1.25, UNIT)
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",))
    sheet = (JointPlate("sheet", ALUMINIUM, 1.0),)
    assert 'bush: must be "sheet", not "skin"' in str(refused(replace, pin, bush={"skin": bush}))
    assert "must be a Bushing" in str(refused(replace, pin, bush=1.0))
    words = str(refused(replace, pin, bush=replace(bush, inside=Ring(3.0))))
    assert "bush.inside: the plate of the joint is round the bush" in words
    large = JointPin("B", 5.0, STEEL, 1.0, ("sheet",))
    words = str(refused(Joint, sheet, (replace(pin, bush=bush), large)))
    assert "pin.B.radius: all holes of sheet must have one radius: that of B has 1 m, that of A has 1.25 m" in words
    with pytest.raises(InputError, match=r"pin\.A\.bush\.interference: in sheet: must be positive: a bonded bush"):
        Joint(sheet, (replace(pin, bush=replace(bush, interference=0.0)),))


# -- outputs -----------------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_bushes_have_rows_of_their_own() -> None:
    case = parse_joint(BUSHED)
    result = solve_joint(case.joint, case.corners, nodes=case.nodes)
    text = report.describe(report.judged(result))
    assert "bush of B  sheet" in text
    rows = report.contact_rows(result)
    assert [(row["pin"], row["plate"]) for row in rows] == [
        (name, "sheet") for name in ("A", "bush of A", "B", "bush of B")
    ]
    seat = result[0]["A", "sheet"].seat
    assert seat is not None
    assert rows[1]["pressure"] == seat.peak_pressure
    assert {margin.margin.owner for margin in result.margins()} >= {"bush", "plate", "pin"}


@pytest.mark.gate
def test_a_file_holds_the_bushes_and_goes_on(tmp_path: Path) -> None:
    case = parse_joint(BUSHED)
    whole = record_joint(case, tmp_path / "whole.h5")
    solved = solve_joint(case.joint, case.corners, nodes=case.nodes)

    def stop(done: float, total: int) -> None:
        if done > 1.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record_joint(case, tmp_path / "split.h5", progress=stop)
    resumed = resume_joint(tmp_path / "split.h5", like=case)
    for result in (whole, resumed, load_joint(tmp_path / "split.h5")):
        np.testing.assert_array_equal(pressures(result), pressures(solved))
        for state, other in zip(result, solved, strict=True):
            for one, found in zip(state.contacts, other.contacts, strict=True):
                assert one.seat is not None
                assert found.seat is not None
                assert one.seat.problem == found.seat.problem
                assert (one.seat.load, one.seat.residuals) == (found.seat.load, found.seat.residuals)
                assert one.seat.dissipation == found.seat.dissipation
                assert one.peak_hoop_stress("seat").value == found.peak_hoop_stress("seat").value

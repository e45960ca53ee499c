"""Joints of several pins against exact solutions, reference numbers and one another."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, Interrupted, Material, MaterialPair, Problem, SolveError
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, solve_joint
from fastpin.joints.solving import load_values
from fastpin.lugs.outline import rectangle
from fastpin.model import LOADS
from fastpin.model.angles import BOTTOM
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEET, STEEL, dissipated, lap, peaks, through_both, with_cover
from tests.support.refusals import refused


def in_sheet(*centres: complex, clearance: float = 0.1, friction: float = 0.3, material: Material = STEEL) -> Joint:
    """Pins of radius 1 in an infinite sheet. The clearance is in units of F beta*."""
    pins = [
        JointPin(f"p{k}", at, material, 1.0, ("sheet",), clearance * BETA * FORCE, friction)
        for k, at in enumerate(centres)
    ]
    return Joint((SHEET,), tuple(pins))


def hoop_at_top(result: JointResult, step: int) -> float:
    return float(result[step].contacts[0].hoop_stress("plate", [0.5 * math.pi])[0]) / FORCE


# -- reference numbers, from finite elements too -----------------------------------------------------------------------


def test_two_pins_side_by_side() -> None:
    down = {"p0.y": -FORCE, "p1.y": -FORCE}
    result = solve_joint(in_sheet(-3.0, 3.0, friction=0.4), [down], nodes=64)
    assert peaks(result, 0) == pytest.approx([0.5126, 0.5126], abs=5e-4)
    assert dissipated(result, 0) == pytest.approx(0.003031, abs=5e-6)
    assert hoop_at_top(result, 0) == pytest.approx(-0.0588, abs=2e-4)


def test_two_pins_behind_one_another_and_a_remote_stress() -> None:
    result = solve_joint(
        in_sheet(2.0j, -2.0j), [{"p0.y": -FORCE, "p1.y": -FORCE}, {"sheet.syy": 0.3 * FORCE}], nodes=64
    )
    assert peaks(result, 0) == pytest.approx([0.5002, 0.5789], abs=1e-3)
    assert peaks(result, 1) == pytest.approx([0.508, 0.4991], abs=2e-3)
    assert [dissipated(result, k) for k in (0, 1)] == pytest.approx([0.004371, 0.005535], abs=1e-5)
    assert [hoop_at_top(result, k) for k in (0, 1)] == pytest.approx([-0.1171, -0.3498], abs=4e-4)


def test_two_pins_with_interference() -> None:
    down = {"p0.y": -FORCE, "p1.y": -FORCE}
    result = solve_joint(in_sheet(-3.0, 3.0, clearance=-0.2), [{}, down, {"sheet.syy": 0.2 * FORCE}], nodes=64)
    assert peaks(result, 0) == pytest.approx([0.7207, 0.7207], abs=4e-4)
    assert hoop_at_top(result, 0) == pytest.approx(0.68143, abs=2e-4)
    assert peaks(result, 2) == pytest.approx([0.7560, 0.7560], abs=6e-4)
    assert dissipated(result, 2) == pytest.approx(0.01205, abs=6e-5)


@pytest.mark.survey
def test_a_lap_of_three_pins_has_the_shares_of_finite_elements() -> None:
    equal = solve_joint(lap((0.1, 0.1, 0.1), 0.3), [{"strap.x": 3 * FORCE}, {"strap.x": 0.3 * FORCE}], nodes=64)
    forces = [state.forces[::2, 0] / FORCE for state in equal]
    np.testing.assert_allclose(forces[0], [1.1097, 0.7806, 1.1097], atol=5e-4)
    np.testing.assert_allclose(forces[1], [0.10658, 0.0868, 0.10658], atol=4e-4)
    assert [state.moved[1, 0] / (FORCE * BETA) for state in equal] == pytest.approx([3.1845, 0.53543], abs=4e-4)
    assert [dissipated(equal, k) for k in (0, 1)] == pytest.approx([0.02006, 0.02634], abs=1e-4)
    assert [hoop_at_top(equal, k) for k in (0, 1)] == pytest.approx([1.544, 0.14011], abs=1e-3)
    loose = solve_joint(lap((0.1, 0.3, 0.1), 0.3), [{"strap.x": 3 * FORCE}], nodes=64)
    np.testing.assert_allclose(loose[0].forces[::2, 0] / FORCE, [1.4324, 0.1353, 1.4324], atol=6e-4)
    neat = solve_joint(lap((0.0, 0.0, 0.0), 0.0), [{"strap.x": 3 * FORCE}], nodes=64)
    np.testing.assert_allclose(neat[0].forces[::2, 0] / FORCE, [1.10200, 0.79600, 1.10200], atol=2e-3)


@pytest.mark.survey
def test_a_lap_under_reversed_load_and_after_cycles_has_the_forces_of_finite_elements() -> None:
    joint, there, back = lap((0.1, 0.1, 0.1), 0.3), {"strap.x": 3 * FORCE}, {"strap.x": 0.3 * FORCE}
    reversed_ = solve_joint(joint, [there, {"strap.x": -3 * FORCE}], nodes=64)
    np.testing.assert_allclose(reversed_[1].forces[::2, 0] / FORCE, [-1.1261, -0.7478, -1.1261], atol=5e-4)
    assert peaks(reversed_, 1)[:3:2] == pytest.approx([0.7788, 0.5190], abs=1e-3)
    assert hoop_at_top(reversed_, 1) == pytest.approx(-0.5390, abs=3e-4)
    assert dissipated(reversed_, 1) == pytest.approx(0.03899, abs=4e-5)
    assert reversed_[1].moved[1, 0] / (FORCE * BETA) == pytest.approx(-2.55567, abs=2e-5)
    cycles = solve_joint(joint, [*[there, back] * 3, there], nodes=64)
    np.testing.assert_allclose(cycles[6].forces[::2, 0] / FORCE, [1.1096, 0.7807, 1.1096], atol=5e-4)
    assert dissipated(cycles, 6) == pytest.approx(0.09642, abs=2e-4)
    assert cycles[6].moved[1, 0] / (FORCE * BETA) == pytest.approx(3.18463, abs=1.5e-4)


@pytest.mark.survey
def test_a_lap_of_five_pins_has_the_forces_of_finite_elements() -> None:
    result = solve_joint(lap((0.1,) * 5, 0.3), [{"strap.x": 5 * FORCE}], nodes=64, harmonics=12)
    np.testing.assert_allclose(
        result[0].forces[::2, 0] / FORCE, [1.55282, 0.70637, 0.48161, 0.70637, 1.55282], atol=2e-4
    )
    assert peaks(result, 0)[:3:2] == pytest.approx([0.831, 0.4204], abs=3e-3)
    assert hoop_at_top(result, 0) == pytest.approx(2.5589, abs=3e-3)
    assert dissipated(result, 0) == pytest.approx(0.05770, abs=8e-5)
    assert result[0].moved[1, 0] / (FORCE * BETA) == pytest.approx(5.82644, abs=1e-4)


@pytest.mark.survey
def test_titanium_pins_in_unlike_plates_have_the_forces_of_finite_elements() -> None:
    titanium = Material(110e9, 0.31)
    beta = MaterialPair(titanium, ALUMINIUM, "stress").beta_star
    skin, strap = (
        replace(plate, thickness=2.0, material=each)
        for plate, each in zip(lap((0.0, 0.0), 0.0).plates, (ALUMINIUM, STEEL), strict=True)
    )
    pins = [
        JointPin(f"p{k}", at, titanium, 1.0, ("skin", "strap"), 0.2 * beta * FORCE, 0.2, 0.05 * beta)
        for k, at in enumerate((-3.0, 3.0))
    ]
    loads = [{"strap.x": 4 * FORCE}, {"strap.x": 0.4 * FORCE}]
    result = solve_joint(Joint((skin, strap), tuple(pins)), loads, nodes=64)
    np.testing.assert_allclose(
        [state.forces[::2, 0] / FORCE for state in result], [[2.2531, 1.7469], [0.2174, 0.1826]], atol=5e-4
    )
    assert peaks(result, 0)[::2] == pytest.approx([0.6282, 0.5524], abs=6e-4)
    assert peaks(result, 1)[::2] == pytest.approx([0.1691, 0.1555], abs=9e-4)
    assert [hoop_at_top(result, k) for k in (0, 1)] == pytest.approx([1.0659, 0.10100], abs=4e-4)
    assert [2.0 * dissipated(result, k) * BETA / beta for k in (0, 1)] == pytest.approx([0.006344, 0.00829], abs=3e-5)
    moved = [state.moved[1, 0] / (FORCE * beta) for state in result]
    assert moved == pytest.approx([1.6436, 0.55142], abs=1e-4)


@pytest.mark.survey
def test_pins_off_the_axis_pass_moments_as_finite_elements_say() -> None:
    skin, strap = lap((0.0, 0.0), 0.0).plates
    plates = (
        replace(skin, outline=rectangle((-12.0, 7.0), (-4.0, 4.0))),
        replace(strap, outline=rectangle((-7.0, 12.0), (-4.0, 4.0))),
    )
    pins = [
        JointPin(f"p{k}", at, STEEL, 1.0, ("skin", "strap"), each * BETA * FORCE, 0.3, 0.07 * BETA)
        for k, (at, each) in enumerate(((-3.0 + 0.7j, 0.1), (3.0 + 0.7j, 0.2)))
    ]
    state = solve_joint(Joint(plates, tuple(pins)), [{"strap.x": 2 * FORCE}], nodes=96)[0]
    np.testing.assert_allclose(state.forces[0] / FORCE, [1.2351, -0.1570], atol=1e-4)
    np.testing.assert_allclose(state.moments[::2] / FORCE, [0.0846, -0.0562], atol=2e-4)
    found = [float(state.contacts[k].pressure.max()) / FORCE for k in (0, 2)]
    assert found == pytest.approx([0.6666, 0.4974], abs=3e-4)
    assert sum(each.dissipation for each in state.contacts) / (FORCE * FORCE * BETA) == pytest.approx(0.01205, abs=1e-5)


@pytest.mark.gate
def test_a_free_cover_takes_a_part_of_the_load_of_a_sheet() -> None:
    """A doubler on an infinite sheet under tension: it floats between its three pins."""
    cover = JointPlate("cover", ALUMINIUM, 1.0, rectangle((-10.0, 10.0), (-4.0, 4.0)), moves="free")
    unit = BETA * FORCE
    pins = [
        JointPin(f"p{k}", at, STEEL, 1.0, ("sheet", "cover"), 0.02 * unit, 0.3, 0.15 * BETA)
        for k, at in enumerate((-6.0, 0.0, 6.0))
    ]
    result = solve_joint(Joint((SHEET, cover), tuple(pins)), [{"sheet.sxx": 0.3 * FORCE}], nodes=64)
    np.testing.assert_allclose(result[0].forces[::2, 0] / FORCE, [0.29178, 0.0, -0.29178], atol=1e-4)
    assert peaks(result, 0)[:3:2] == pytest.approx([0.2747, 0.106], abs=5e-3)
    assert hoop_at_top(result, 0) == pytest.approx(1.10, abs=0.01)
    assert dissipated(result, 0) == pytest.approx(0.00465, abs=2e-5)
    np.testing.assert_allclose(result[0].moved[1], 0.0, atol=1e-9 * unit)


@pytest.mark.gate
def test_a_plate_that_only_its_own_pins_hold_is_a_mechanism() -> None:
    strip = JointPlate("strip", ALUMINIUM, 1.0, rectangle((-5.0, 9.0), (-4.0, 4.0)), moves="free")
    pins = [
        JointPin(name, at, STEEL, 1.0, ("strip",), 1e-6 * BETA * FORCE, 0.3) for name, at in (("a", 0.0), ("b", 4.0))
    ]
    with pytest.raises(fastpin.NoEquilibriumError, match="nothing holds a pin or a plate: the joint is a mechanism"):
        solve_joint(Joint((strip,), tuple(pins)), [{"a.x": FORCE}], nodes=16, harmonics=8)
    with pytest.raises(InputError, match="moves: the plate strip is free and has one pin"):
        Joint((strip,), (pins[0],))


# -- exact solutions ---------------------------------------------------------------------------------------------------


def plug_error(nodes: int) -> float:
    """Plugs of the plate's own material that stick leave the plate whole under any remote stress."""
    joint = in_sheet(0.0, 4.0 + 1.0j, 9.0, clearance=0.0, friction=1e3, material=ALUMINIUM)
    loads = {"sheet.sxx": -0.1 * FORCE, "sheet.syy": -0.1 * FORCE, "sheet.sxy": 0.05 * FORCE}
    result, worst = solve_joint(joint, [loads], nodes=nodes), 0.0
    for contact in result[0].contacts:
        double = 2.0 * contact.theta
        for found, exact in (
            (-contact.pressure, -0.1 + 0.05 * np.sin(double)),
            (contact.shear, 0.05 * np.cos(double)),
            (contact.hoop_stress("plate", contact.theta), -0.1 - 0.05 * np.sin(double)),
        ):
            worst = max(worst, float(np.abs(found / FORCE - exact).max()))
    return worst


def test_plugs_leave_the_plate_whole() -> None:
    coarse, fine = plug_error(32), plug_error(64)
    assert coarse < 1e-3
    assert fine < 0.3 * coarse  # second order


@pytest.mark.parametrize(("friction", "allowed"), [(0.0, 2e-6), (0.4, 5e-4)])
def test_one_pin_is_the_contact_of_the_solver(friction: float, allowed: float) -> None:
    """With friction the first contact differs: the joint's pin comes on a weak spring."""
    joint = in_sheet(0.0, friction=friction)
    found = solve_joint(joint, [{"p0.y": -FORCE}, {"p0.y": -0.3 * FORCE, "p0.x": 0.1 * FORCE}], nodes=64)
    problem = Problem(MaterialPair(STEEL, ALUMINIUM, "stress"), 1.0, 0.1 * BETA * FORCE, friction, pin_load="body")
    known = fastpin.solve(problem, [{"P": FORCE}, {"P": 0.3 * FORCE, "Q": 0.1 * FORCE}], grid=Grid.circle(64, BOTTOM))
    for state, one in zip(known, found, strict=True):
        contact = one["p0", "sheet"]
        for name in ("pressure", "shear"):
            left = np.abs(getattr(state, name) - getattr(contact, name)).max()
            assert left < allowed * state.pressure.max()
        assert contact.peak_hoop_stress().value == pytest.approx(state.peak_hoop_stress().value, rel=allowed)
        assert contact.dissipation == pytest.approx(state.dissipation, rel=1e-5)
        assert contact.load["P"] == pytest.approx(state.load["P"], rel=2e-6)


# -- properties --------------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_the_first_touch_is_an_ordinary_event_and_a_loose_pin_comes_later() -> None:
    """The cover of a sheet under tension has one loose pin: with little load it carries nothing."""
    joint = with_cover(
        *(through_both(name, at, each) for name, at, each in (("a", 0, 0.02), ("b", 6, 0.02), ("c", 12, 0.3)))
    )
    result = solve_joint(joint, [{"sheet.sxx": size * FORCE} for size in (0.2, 2.0)], nodes=32, harmonics=6)
    assert result.first_touches["a", "cover"] == 0
    assert result.first_touches["c", "cover"] == 1
    carried = [[float(np.hypot(*state.forces[2 * k])) for k in range(3)] for state in result]
    assert carried[0][2] < 1e-5 * carried[0][0]
    assert carried[1][2] > 0.5 * carried[1][0]
    for state in result:
        np.testing.assert_allclose(state.forces[::2].sum(axis=0), 0.0, atol=1e-5 * FORCE)


@pytest.mark.gate
def test_every_pin_and_contact_is_in_equilibrium() -> None:
    """Recomputed from the nodal tractions by the trapezoidal rule, which is exact for the hats' harmonics to 1e-3."""
    joint = with_cover(through_both("p0", 0.0, 0.1), through_both("p1", 6.0, 0.02))
    result = solve_joint(joint, [{"p0.x": FORCE, "p1.y": -0.5 * FORCE}, {"p0.x": -FORCE}], nodes=64, harmonics=6)
    for state in result:
        for pin in joint.pins:
            total = np.zeros(3)
            for place, (of, plate) in enumerate(joint.sections):
                if of is pin:
                    contact = state.contacts[place]
                    out = np.exp(1j * contact.theta)
                    push = np.sum((contact.pressure - 1j * contact.shear) * out) * 2.0 * math.pi / 64
                    total += plate.thickness * np.array([push.real, push.imag, -contact.shear.sum() * math.pi / 32])
            outside = [state.load[f"{pin.name}.x"], state.load[f"{pin.name}.y"], 0.0]
            np.testing.assert_allclose(total, outside, atol=4e-3 * FORCE)
        on_cover = state.forces[1::2].sum(axis=0)
        np.testing.assert_allclose(on_cover, 0.0, atol=1e-5 * FORCE)
        assert max(state.residuals.values()) < 1e-9
        assert set(state.residuals) == {"gap", "slip", "cone", "equilibrium", "bodies"}


@pytest.mark.gate
def test_a_flexible_pin_takes_less_of_the_load() -> None:
    rigid, soft = (
        solve_joint(
            with_cover(*(through_both(f"p{at}", at, 0.0, friction=0.0, flexibility=each) for at in (0, 6))),
            [{"sheet.sxx": 0.5 * FORCE}], nodes=32, harmonics=6,
        )[0].forces[0, 0]
        for each in (0.0, 20.0 * BETA)
    )  # fmt: skip
    assert 0.02 * rigid < soft < 0.5 * rigid


def test_units_and_reference_force_do_not_matter() -> None:
    """Lengths in mm, stresses in MPa: the same contact, to rounding."""
    metre = in_sheet(0.0, 5.0)
    pins = [
        JointPin(p.name, 1e3 * p.at, Material(210e3, 0.3), 1e3, ("sheet",), 1e3 * float(p.clearance), 0.3)
        for p in metre.pins
    ]  # type: ignore[arg-type]
    milli = Joint((JointPlate("sheet", Material(72e3, 0.33), 1e3),), tuple(pins))
    one = solve_joint(metre, [{"p0.x": FORCE, "p1.y": FORCE}], nodes=32)[0]
    other = solve_joint(milli, [{"p0.x": FORCE, "p1.y": FORCE}], nodes=32)[0]
    for a, b in zip(one.contacts, other.contacts, strict=True):
        np.testing.assert_allclose(1e6 * b.pressure, a.pressure, atol=1e-9 * FORCE)
        np.testing.assert_allclose(1e-3 * b.slip, a.slip, atol=1e-9 * BETA * FORCE)
    np.testing.assert_allclose(other.forces, one.forces, atol=1e-6)


def test_mirrored_loads_give_mirrored_states() -> None:
    joint = in_sheet(-3.0, 3.0)
    right = solve_joint(joint, [{"p0.x": FORCE, "p1.x": 0.4 * FORCE}], nodes=32)[0]
    left = solve_joint(joint, [{"p1.x": -FORCE, "p0.x": -0.4 * FORCE}], nodes=32)[0]
    mirrored = -np.arange(32) % 32
    for a, b in ((0, 1), (1, 0)):
        there = left.contacts[b].pressure[mirrored]
        np.testing.assert_allclose(right.contacts[a].pressure, there, atol=1e-6 * FORCE)


def test_no_load_has_no_contact_and_no_share() -> None:
    result = solve_joint(in_sheet(0.0, 5.0), [{}], nodes=16)
    assert not any(contact.in_contact for contact in result[0].contacts)
    assert all(math.isnan(share) for share in result[0].shares("sheet").values())


def test_unloading_and_reversal_release_the_pins() -> None:
    result = solve_joint(in_sheet(0.0, 6.0), [{"p0.x": FORCE}, {"p0.x": 0.0}, {"p0.x": -FORCE}], nodes=32)
    assert [state.contacts[0].in_contact for state in result] == [True, False, True]
    np.testing.assert_allclose(result[2].forces[0], [-FORCE, 0.0], atol=1e-5 * FORCE)


@pytest.mark.gate
def test_loads_far_below_earlier_ones_are_like_none() -> None:
    """Clearance and motion of loose pins are larger by as much, and leave the tractions few digits."""
    joint = lap((0.1, 0.1), 0.3)
    nearly, exactly = (
        solve_joint(joint, [{"strap.x": part * FORCE} for part in (1.0, small, -1.0)], nodes=24, harmonics=8)
        for small in (1e-10, 0.0)
    )
    assert max(max(state.residuals.values()) for state in nearly) <= 1e-9
    assert np.abs(nearly[1].forces).max() <= 1e-9 * FORCE
    assert peaks(nearly, 2) == pytest.approx(peaks(exactly, 2), rel=1e-6)


def test_the_rounding_of_a_sine_is_no_load() -> None:
    joint = in_sheet(-3.0, 3.0)
    sine = [{"p0.x": math.sin(0.5 * math.pi * k), "sheet.sxx": 1e-20} for k in range(5)]
    values = load_values(joint, sine)
    assert values[:, joint.load_names.index("p0.x")].tolist() == [0.0, 1.0, 0.0, -1.0, 0.0]
    assert (values[:, joint.load_names.index("sheet.sxx")] == 1e-20).all()


def test_a_result_can_be_pickled() -> None:
    result = solve_joint(in_sheet(0.0, 4.0), [{"p0.x": FORCE}], nodes=16)
    again = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(again[0].contacts[0].pressure, result[0].contacts[0].pressure)
    assert again[0].contacts[0].peak_hoop_stress() == result[0].contacts[0].peak_hoop_stress()


FREE = JointPlate("free", STEEL, 1.0, rectangle((-4.0, 4.0), (-4.0, 4.0)))


# -- refusals ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: in_sheet(0.0, 2.05),
            "pin.p1.at: the holes of p0 and p1 in sheet are 2.05 m apart",
        ),
        (
            lambda: Joint((SHEET,), (JointPin("a", 0, STEEL, 1.0, ("skin",)),)),
            'pin.a.plates: must be "sheet", not "skin"',
        ),
        (
            lambda: Joint((SHEET, JointPlate("b", STEEL, 1.0)), in_sheet(0.0).pins),
            "plate.b.moves: the plate sheet is",
        ),
        (
            lambda: Joint((JointPlate("b", STEEL, 1.0), SHEET), in_sheet(0.0).pins),
            "plate.b: no pin goes",
        ),
        (lambda: JointPin("a", 0, STEEL, 1.0, ()), "plates: pin a goes through no plate"),
        (lambda: JointPin("a", 0, STEEL, 1.0, ("s", "s")), "plates: pin a goes through a plate twice"),
        (lambda: JointPin("a", 0, STEEL, 1.0, ("s",), clearance={}), "clearance: has no value for the plate s"),
        (lambda: in_sheet(0.0, friction=-1.0), "pin.p0.friction: in sheet: must not be negative, not -1"),
        (lambda: JointPlate("a.b", STEEL, 1.0), 'name: must be a text without a dot, not "a.b"'),
        (
            lambda: JointPlate("a", STEEL, 1.0, supports={"left": "both"}),
            "supports: has no meaning for an infinite plate",
        ),
        (lambda: Joint((SHEET,), (*in_sheet(0.0).pins, *in_sheet(0.0).pins)), 'name: two parts are called "p0"'),
        (
            lambda: Joint((FREE,), (JointPin("a", 0, STEEL, 1.0, ("free",)),)),
            "plate.free: support: the supports leave a rigid motion",
        ),
        (lambda: solve_joint(in_sheet(0.0), []), "corners: must have at least one corner"),
        (lambda: solve_joint(in_sheet(0.0), [{"p0.z": 1.0}]), 'corner 1: must be "sheet.sxx"'),
        (lambda: solve_joint(in_sheet(0.0), [{"p0.x": math.inf}]), "p0.x: must be a finite number, not inf"),
        (lambda: solve_joint(in_sheet(0.0), [{}], nodes=3), "nodes: must be a whole number from 16 to 720, not 3"),
        (lambda: solve_joint(in_sheet(0.0), [{}])[0]["p0", "skin"], 'plate: must be "sheet", not "skin"'),
    ],
)
def test_wrong_input_is_refused_in_one_sentence(make: Any, words: str) -> None:
    assert str(refused(make)).startswith(words)


def test_pins_of_two_sizes_are_refused() -> None:
    pins = (*in_sheet(0.0).pins, JointPin("large", 9.0, STEEL, 1.5, ("sheet",)))
    error = refused(Joint, (SHEET,), pins)
    assert "all holes of sheet must have one radius: that of large has 1.5 m, that of p0 has 1 m" in str(error)


def test_a_lost_load_is_told_with_its_place_and_keeps_what_was_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    from fastpin.joints import path

    followed = path.PathStep.follow

    def lose(step: Any, *arguments: Any) -> Any:
        if step.rate[len(LOADS) + 3] < 0.0:
            raise path.StepLostError(path.exchange.CYCLING, 0.25)
        return followed(step, *arguments)

    monkeypatch.setattr(path.PathStep, "follow", lose)
    monkeypatch.setattr(path, "_beyond", lambda *_: None)
    with pytest.raises(SolveError) as caught:
        solve_joint(in_sheet(0.0, 5.0), [{"p0.x": FORCE}, {"p0.x": 0.5 * FORCE}], nodes=16)
    assert str(caught.value).startswith("step 2, at 25 % (p0.x = 875000): the stick and slip zones did not settle")
    assert len(caught.value.result) == 1  # type: ignore[arg-type]


def test_an_interrupt_keeps_what_was_solved() -> None:
    def stop(done: float, total: int) -> None:
        if done >= 1.0:
            raise Interrupted

    with pytest.raises(Interrupted) as caught:
        solve_joint(in_sheet(0.0), [{"p0.x": FORCE}, {"p0.x": 2.0 * FORCE}], nodes=16, progress=stop)
    assert len(caught.value.result) == 1  # type: ignore[arg-type]

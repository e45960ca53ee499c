"""Plates in slices, and pins that bend as beams through them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from fastpin import figures, report
from fastpin.assess import outputs
from fastpin.joints import Clamp, Joint, JointPin, JointPlate, JointResult, SectionCrack, parse_joint, solve_joint
from fastpin.joints.bending import RoundBar, beam, bending_moments, springs
from fastpin.lugs.outline import PartLoad, rectangle
from fastpin.model.crack import CrackGrowth
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEETS, STEEL, lap
from tests.support.refusals import refused
from tests.support.tiers import for_gate


def clevis(ear: int, lug: int, heads: Any = "free", **extra: Any) -> Joint:
    """A lug between two ears, strips with one hole: width 8, edge 4, 10 to the end; thickness 2, 4, 2; all in radii."""
    outer = partial(
        JointPlate, material=ALUMINIUM, thickness=2.0, outline=rectangle((-10.0, 4.0), (-4.0, 4.0)),
        supports={"left": "both"}, slices=ear,
    )  # fmt: skip
    inner = JointPlate("lug", ALUMINIUM, 4.0, rectangle((-4.0, 10.0), (-4.0, 4.0)), {"right": "both"}, "x", slices=lug)
    names = ("near", "lug", "far")
    pin = JointPin("pin", 0j, STEEL, 1.0, names, 0.1 * BETA * FORCE, 0.3, "beam", heads=heads, **extra)
    return Joint((outer("near"), inner, outer("far")), (pin,))


def pulled(joint: Joint, nodes: int = 16, harmonics: int = 4) -> JointResult:
    return solve_joint(joint, [{"lug.x": 4.0 * FORCE}], nodes=nodes, harmonics=harmonics)


@pytest.fixture(scope="module")
@for_gate
def short() -> JointResult:
    return pulled(clevis(2, 3))


# -- reference numbers -------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_a_lug_in_a_clevis_has_the_reference_forces() -> None:
    result = pulled(clevis(4, 8), 64, 12)
    forces = result[0].forces[:, 0] / FORCE
    np.testing.assert_allclose(forces[:4], [0.1054, 0.3553, 0.6264, 0.9129], atol=1e-4)
    np.testing.assert_allclose(-forces[4:8], [0.7678, 0.5389, 0.3851, 0.3083], atol=1e-4)
    np.testing.assert_allclose(forces, forces[::-1], atol=1e-6)
    outermost = result[0].contacts[0]
    assert float(outermost.pressure.max()) / FORCE == pytest.approx(0.1658, abs=5e-4)
    assert float(outermost.hoop_stress("plate", [0.5 * math.pi])[0]) / FORCE == pytest.approx(0.1499, abs=4e-4)
    dissipated = sum(contact.dissipation * 0.5 for contact in result[0].contacts)
    assert dissipated / (FORCE * FORCE * BETA) == pytest.approx(0.0309, abs=1e-4)
    assert result[0].moved[1, 0] / (FORCE * BETA) == pytest.approx(2.0122, abs=3e-4)


@pytest.mark.parametrize(("heads", "first"), [("held", 0.3712), ("free", 0.3457)])
@pytest.mark.gate
def test_a_lap_in_slices_has_the_reference_share(heads: str, first: float) -> None:
    joint = lap((0.1, 0.1, 0.1), 0.3)
    pins = tuple(replace(pin, flexibility="beam", heads=heads) for pin in joint.pins)
    plates = tuple(replace(plate, slices=4) for plate in joint.plates)
    found = solve_joint(Joint(plates, pins), [{"strap.x": 3 * FORCE}], nodes=32)[0].shares("skin")
    assert found[joint.pins[0].name] == pytest.approx(first, abs=5e-4)


# -- exact checks ------------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_slices_with_rigid_pins_are_the_plate() -> None:
    joint = lap((0.1, 0.2), 0.3)
    whole = solve_joint(joint, [{"strap.x": FORCE}], nodes=24, harmonics=8)[0]
    plates = tuple(replace(plate, slices=2) for plate in joint.plates)
    sliced = solve_joint(Joint(plates, joint.pins), [{"strap.x": FORCE}], nodes=24, harmonics=8)[0]
    for pin, plate in joint.sections:
        np.testing.assert_allclose(
            sliced.force(pin.name, plate.name), whole.force(pin.name, plate.name), atol=1e-7 * FORCE
        )
        for number in (1, 2):
            one, other = sliced[pin.name, f"{plate.name}.{number}"], whole[pin.name, plate.name]
            np.testing.assert_allclose(one.pressure, other.pressure, atol=1e-7 * FORCE)
            angles = np.linspace(0.0, 6.0, 7)
            hoops = [each.hoop_stress("plate", angles) for each in (one, other)]
            np.testing.assert_allclose(*hoops, atol=1e-6 * FORCE)
    np.testing.assert_allclose(sliced.moved, whole.moved, rtol=1e-7, atol=1e-12)


def test_the_forces_of_a_pin_that_tilts_freely_have_no_moment(short: JointResult) -> None:
    forces = short[0].forces[:, 0]
    thickness = np.array([plate.thickness for _, plate in short.joint.sections])
    places = np.cumsum(thickness) - 0.5 * thickness
    assert abs(forces.sum()) < 1e-6 * FORCE  # the weak springs of loose pins
    assert abs(forces @ (places - 4.0)) < 1e-5 * FORCE
    assert forces[1] > 1.3 * forces[0] > 0.0 > forces[2]
    assert abs(forces[2]) > 1.05 * abs(forces[3])


def test_heads_stiffen_the_joint(short: JointResult) -> None:
    free, soft, stiff, held = (pulled(clevis(2, 3, heads))[0].moved[1, 0] for heads in (0.0, 1e-3, 1e16, "held"))
    assert free == pytest.approx(short[0].moved[1, 0], rel=1e-12)
    assert soft == pytest.approx(free, rel=1e-9)
    assert stiff == pytest.approx(held, rel=1e-4)
    assert held < 0.95 * free


@pytest.mark.parametrize(("heads", "bore"), [(0.0, 0.0), (3e11, 0.0), (math.inf, 0.0), (3e11, 0.6)])
def test_the_beam_is_that_of_finite_elements(heads: float, bore: float) -> None:
    rng = np.random.default_rng(5)
    edges = np.r_[0.0, np.cumsum(rng.uniform(0.3, 2.0, 5))]
    places, count = 0.5 * (edges[1:] + edges[:-1]), 5
    modulus, shear = STEEL.E * 0.25 * math.pi * (1.0 - bore**4), STEEL.shear_modulus * math.pi * (1.0 - bore**2)
    square = (1.0 + bore**2) ** 2
    shear *= 6.0 * 1.5 * square / (10.0 * square + 26.0 * bore**2)  # Cowper's tube with nu = 1/2
    nodes = np.r_[edges[0], places, edges[-1]]
    stiffness = np.zeros((2 * nodes.size, 2 * nodes.size))
    for k, length in enumerate(np.diff(nodes)):  # Timoshenko elements, exact for loads at their ends
        phi = 12.0 * modulus / (shear * length * length)
        own = np.array([
            [12.0, 6.0 * length, -12.0, 6.0 * length],
            [6.0 * length, (4.0 + phi) * length**2, -6.0 * length, (2.0 - phi) * length**2],
            [-12.0, -6.0 * length, 12.0, -6.0 * length],
            [6.0 * length, (2.0 - phi) * length**2, -6.0 * length, (4.0 + phi) * length**2],
        ])  # fmt: skip
        stiffness[2 * k : 2 * k + 4, 2 * k : 2 * k + 4] += modulus / (length**3 * (1.0 + phi)) * own
    for end in (1, 2 * nodes.size - 1):
        stiffness[end, end] += 1e8 * modulus if math.isinf(heads) else heads
    ground = 1e10 * rng.uniform(0.5, 2.0, count)  # springs between the sections and their plates
    stiffness[2:-2:2, 2:-2:2] += np.diag(ground)
    load = np.zeros(2 * nodes.size)
    load[2:6:2] = 0.5e6  # the force on the pin, on two sections
    moved = np.linalg.solve(stiffness, load)[2:-2:2]
    forces = ground * moved
    found = beam(RoundBar(STEEL, 1.0, bore), edges.tolist(), 2, heads)
    left = found.displacements @ moved + found.forces @ forces - found.outside * 1e6
    size = np.abs(found.displacements) @ np.abs(moved) + np.abs(found.forces) @ np.abs(forces)
    assert np.max(np.abs(left) / size) < 1e-6


def test_springs_part_the_sections_by_the_force_that_passes() -> None:
    found = springs([0.0, 2e-9])
    assert (found.displacements @ [1.0, 1.0, 1.0] == 0.0).all()
    np.testing.assert_allclose(found.forces @ [3.0, 4.0, 9.0], [0.0, 14e-9])
    np.testing.assert_allclose(found.outside, [0.0, 2e-9])


# -- what users see ----------------------------------------------------------------------------------------------------


def test_a_slice_has_its_name_in_texts_and_in_the_json(short: JointResult) -> None:
    state = short[0]
    assert state["pin", "lug.2"] is state.contacts[3]
    np.testing.assert_allclose(state.force("pin", "near"), state.forces[:2].sum(axis=0))
    assert state.shares("near") == state.shares("near.1") == {"pin": pytest.approx(1.0)}
    judged = report.joints.judged(short)
    text = report.joints.describe(judged)
    assert "pin on near" in text
    assert " lug.3 " in text
    document = outputs.whole_document(
        report.joint_document.JOINT, judged, report.joints.joint_units(short.joint), title="clevis"
    )
    assert [each["plate"] for each in document["states"][0]["contacts"]][:3] == ["near.1", "near.2", "lug.1"]
    assert sum(each["dissipation"] for each in document["states"][0]["contacts"]) > 0.0


def test_the_map_draws_one_slice_and_says_so(short: JointResult) -> None:
    figure = figures.plot_joint(short)
    assert [panel.get_title("left") for panel in figure.axes[:2]] == [
        "near; at each hole the most stressed of 2 slices",
        f"lug, moved by {1e3 * short[0].moved[1, 0]:.3g}, 0 mm; at each hole the most stressed of 3 slices",
    ]


def test_a_file_gives_slices_and_heads() -> None:
    text = SHEETS.replace("thickness = 2e-3", "thickness = 2e-3\nslices = 4")
    for words, value in (('heads = "held"', math.inf), ("heads = 2e3", 2e3), ("", None)):
        joint = parse_joint(text.replace("friction = 0.2", f'flexibility = "beam"\n{words}')).joint
        assert (joint.pins[0].flexibility, joint.pins[0].heads, joint.plates[0].slices) == ("beam", value, 4)
    in_mm = 'units = "mm, N, MPa"\n' + text.replace("friction = 0.2", 'flexibility = "beam"\nheads = 2e3')
    assert parse_joint(in_mm).joint.pins[0].heads == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"slices": 0}, "slices: must be a whole number from 1 to 40, not 0"),
        ({"heads": "stiff"}, 'heads: must be a number, not "stiff"; or "free" or "held"'),
        ({"heads": -1.0}, 'heads: must not be negative, not -1; or "free" or "held"'),
        ({"flexibility": "soft"}, 'flexibility: must be "beam", not "soft"'),
        ({"flexibility": 0.0, "heads": "held"}, 'heads: needs a pin that bends, flexibility = "beam"'),
        ({"flexibility": 0.0, "heads": "free"}, 'heads: needs a pin that bends, flexibility = "beam"'),
        ({"clamp": Clamp(1e3, 0.2)}, "pin.pin.clamp: pin pin can't clamp near, which has slices"),
    ],
)
def test_bad_slices_and_heads_are_refused(change: dict[str, Any], words: str) -> None:
    joint = clevis(2, 3)

    def make() -> None:
        if "slices" in change:
            replace(joint.plates[0], **change)
        else:
            Joint(joint.plates, (replace(joint.pins[0], **change),))

    assert str(refused(make)) == words


def test_only_own_parts_of_a_plate_are_held_and_loaded() -> None:
    skin = lap((0.1, 0.1), 0.3).plates[0]
    words = 'supports: must be "bottom", "right", "top" or "left", not "hole of p1"'
    assert str(refused(replace, skin, supports={"left": "both", "hole of p1": "both"})) == words
    on_hole = (PartLoad("sxx", ("hole of p1",), x=1.0),)
    assert str(refused(replace, skin, loads=on_hole)) == words.replace("supports", "loads")


def test_a_beam_needs_enough_slices() -> None:
    joint = lap((0.1, 0.1), 0.3)
    pins = tuple(replace(pin, flexibility="beam") for pin in joint.pins)
    words = (
        f"pin.{pins[0].name}.flexibility: pin {pins[0].name} is a beam and needs 3 slices in all its plates, or heads"
    )
    assert str(refused(Joint, joint.plates, pins)) == words
    Joint(joint.plates, tuple(replace(pin, heads="held") for pin in pins))


def test_names_of_slices_are_checked(short: JointResult) -> None:
    state, crack = short[0], SectionCrack("pin", "lug.1", CrackGrowth(1e-4, 1e-3))
    assert str(refused(state.__getitem__, ("pin", "lug"))) == "plate: lug has slices: name one of lug.1 to lug.3"
    assert str(refused(short.of, "pin", "lug.4")) == 'plate: the slices of lug are lug.1 to lug.3, not "lug.4"'
    words = "plate: lug.1 is a slice: its stress is known near its holes only"
    assert str(refused(short.of, "pin", "lug.1", whole=True)) == words
    assert str(refused(short.crack_growth, crack)) == words


@pytest.mark.parametrize(("heads", "ends", "middle"), [(0.0, 0.0, -0.25), (math.inf, 0.125, -0.125)])
def test_the_moments_of_a_beam_under_a_force_in_its_middle(heads: float, ends: float, middle: float) -> None:
    edges = [0.0, 1e-9, 1.0 - 1e-9, 1.0 + 1e-9, 2.0 - 1e-9, 2.0]
    loads = np.array([[-0.5, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [-0.5, 0.0]])
    places, moments = bending_moments(RoundBar(STEEL, 0.1), edges, heads, loads)
    assert (places[0], places[-1]) == (0.0, 2.0)
    np.testing.assert_allclose(moments[[0, 3, -1], 0], 2.0 * np.array([ends, middle, ends]), atol=1e-8)
    assert not moments[:, 1].any()


@pytest.mark.gate
def test_the_bending_of_a_pin_is_told(short: JointResult) -> None:
    result, joint = short, short.joint
    (row,) = report.joints.bending_rows(result)
    places, moments = result[0].bending(row["pin"])
    loads = -result[0].forces
    middles = places[1:-1]
    by_hand = [float(np.hypot(*((np.maximum(at - middles, 0.0)) @ loads))) for at in places]
    assert row["moment"] == pytest.approx(max(by_hand), rel=1e-6)
    assert row["stress"] == pytest.approx(32.0 * row["moment"] / (math.pi * (2.0 * joint.radius) ** 3))
    assert row["place"] in places
    assert moments.shape == (len(places), 2)
    judged = report.joints.judged(result)
    document = outputs.whole_document(report.joint_document.JOINT, judged, report.joints.joint_units(joint), title="")
    assert document["bending"][0]["pin"] == row["pin"]
    assert "bending stress" in report.joints.describe(judged)
    assert str(refused(result[0].bending, "z")).startswith("pin: must be")

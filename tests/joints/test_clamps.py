"""Clamped plates: friction of faying surfaces against closed forms, limits and reference numbers."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from fastpin import figures
from fastpin.assess.outputs import whole_document
from fastpin.joints import Clamp, Joint, JointPin, JointPlate, JointResult, parse_joint, solve_joint
from fastpin.lugs import fields, plates, several_holes
from fastpin.lugs.outline import rectangle
from fastpin.lugs.plates import COARSE
from fastpin.model import Points
from fastpin.report import joints as report
from fastpin.report import json_schema
from fastpin.report.joint_document import JOINT
from tests.support.faults import faults_of
from tests.support.laps import (
    ALUMINIUM,
    BETA,
    FORCE,
    SHEET,
    SHEETS,
    STEEL,
    dissipated,
    lap,
    peaks,
    through_both,
    with_cover,
)
from tests.support.refusals import refused

LOOSE = 50.0
"""A clearance with which no pin touches, over F beta*."""


def clamped(joint: Joint, *clamps: Clamp) -> Joint:
    """The joint with clamps of its pins, one for all or one each."""
    each = clamps * len(joint.pins) if len(clamps) == 1 else clamps
    return replace(joint, pins=tuple(replace(pin, clamp=one) for pin, one in zip(joint.pins, each, strict=True)))


def strips(*clearances: float, moves: str = "x") -> Joint:
    """Two strips with one or two pins without friction; the second one moves."""
    centres = (0.0, 8.0)[: len(clearances)]
    one = JointPlate("skin", ALUMINIUM, 1.0, rectangle((-8.0, 14.0), (-4.0, 4.0)), {"left": "both"})
    other = JointPlate("strap", ALUMINIUM, 1.0, rectangle((-6.0, 16.0), (-4.0, 4.0)), {"right": "both"}, moves)
    pins = (
        JointPin(f"p{k}", at, STEEL, 1.0, ("skin", "strap"), each * BETA * FORCE)
        for k, (at, each) in enumerate(zip(centres, clearances, strict=True))
    )
    return Joint((one, other), tuple(pins))


def solved(joint: Joint, *loads: float, nodes: int = 16) -> JointResult:
    """The joint under forces on the strap along x, in F."""
    return solve_joint(joint, [{"strap.x": load * FORCE} for load in loads], nodes=nodes, harmonics=4)


def rubbed(result: JointResult, step: int) -> np.ndarray:
    """Friction along x of each faying surface, in F."""
    return np.array([each.force[0] for each in result[step].faying]) / FORCE


def moved(result: JointResult) -> np.ndarray:
    """Displacement of the strap along x at every state, over F beta*."""
    return np.array([state.moved[1, 0] for state in result]) / (FORCE * BETA)


# -- limits and closed forms -------------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize("clamp", [Clamp(0.0, 0.3), Clamp(FORCE, 0.0, BETA)])
def test_a_clamp_without_force_or_friction_changes_no_bit(clamp: Clamp) -> None:
    plain = with_cover(through_both("p0", 0.0, 0.1), through_both("p1", 6.0, 0.02))
    corners = [{"sheet.sxx": 0.3 * FORCE}, {"sheet.sxx": -0.1 * FORCE}]
    for one, other in zip(
        *(solve_joint(joint, corners, nodes=16, harmonics=6) for joint in (plain, clamped(plain, clamp))), strict=True
    ):
        assert other.faying == ()
        np.testing.assert_array_equal(one.forces, other.forces)
        for a, b in zip(one.contacts, other.contacts, strict=True):
            np.testing.assert_array_equal(a.pressure, b.pressure)
            np.testing.assert_array_equal(a.shear, b.shear)


@pytest.mark.gate
def test_friction_without_limit_is_a_spring() -> None:
    """With a loose pin all load goes through the clamp: its flexibility adds c P to the displacement."""
    soft, stiff = (
        solved(clamped(strips(LOOSE), Clamp(1e3 * FORCE, 1.0, c * BETA)), 0.0, 1.0, -2.0, 0.0) for c in (7.0, 0.5)
    )
    loads = np.array([0.0, 1.0, -2.0, 0.0])
    np.testing.assert_allclose(moved(soft) - moved(stiff), 6.5 * loads, atol=2e-4)
    np.testing.assert_allclose([rubbed(soft, k)[0] for k in range(4)], loads, atol=2e-5)
    assert soft[3].faying[0].dissipation == 0.0
    np.testing.assert_allclose(soft[3].faying[0].slip, 0.0, atol=1e-12 * BETA * FORCE)


@pytest.mark.gate
def test_soft_clamps_share_the_load_as_springs_until_one_slips() -> None:
    springs = [Clamp(FORCE, limit, c * BETA) for limit, c in ((0.4, 1e3), (9.0, 2e3))]
    result = solved(clamped(strips(40.0 * LOOSE, 40.0 * LOOSE), *springs), 0.3, 0.9)
    # The springs of loose pins take 1e-6 of the displacement, 200 and 1000. Friction grows by 1e-5 of the slip, 600.
    assert rubbed(result, 0) == pytest.approx([0.2, 0.1], abs=1e-3)
    assert rubbed(result, 1) == pytest.approx([0.4, 0.5], abs=8e-3)


@pytest.mark.gate
def test_a_cycle_dissipates_the_loop_of_a_slider_and_the_work_of_the_load() -> None:
    """The loop of a slider has the area 4 L (u_max - c L), where 2 u_max is the range of the relative displacement."""
    limit, c = 0.5, 0.1
    joint = clamped(strips(0.05, 0.05), Clamp(5.0 * FORCE, 0.1, c * BETA))
    loads = 2.0 * np.cos(2.0 * math.pi * np.arange(129) / 64.0)
    result = solved(joint, *loads)
    whole, loops = 0.0, 0.0
    for place in range(2):
        at = [state.faying[place] for state in result.states[64:]]
        u = [float(each.slip[0] / BETA + c * each.force[0]) / FORCE for each in at]
        assert [max(u), u[64]] == pytest.approx([u[0], u[0]], rel=1e-9)
        assert min(u) == pytest.approx(u[32], rel=1e-9)
        loops += 4.0 * limit * (0.5 * (u[64] - u[32]) - c * limit)
        whole += (at[64].dissipation - at[0].dissipation) / (FORCE * FORCE * BETA)
    assert whole == pytest.approx(loops, rel=1e-3)
    P, u = loads[64:], moved(result)[64:]
    work = float(np.sum(0.5 * (P[1:] + P[:-1]) * np.diff(u)))
    assert work == pytest.approx(whole, rel=0.01)


@pytest.mark.gate
def test_the_limit_of_friction_is_nearly_a_circle_and_friction_acts_against_the_slip() -> None:
    joint = clamped(strips(0.3, moves="xy"), Clamp(4.0 * FORCE, 0.2, 0.05 * BETA))
    angles = math.radians(10.0) + 2.0 * math.pi * np.arange(9) / 8.0
    corners = [{"strap.x": 1.5 * FORCE * math.cos(a), "strap.y": 1.5 * FORCE * math.sin(a)} for a in angles]
    result = solve_joint(joint, corners, nodes=32, harmonics=6)
    before = np.zeros(2)
    for state, corner in zip(result, corners, strict=True):
        (at,) = state.faying
        assert 0.998 < np.hypot(*at.force) / (0.8 * FORCE) < 1.0 / math.cos(math.pi / 16) + 1e-3
        assert at.force @ (at.slip - before) > 0.0
        before = at.slip
        np.testing.assert_allclose(state.forces[0] + at.force, list(corner.values()), atol=1e-5 * FORCE)
        assert max(state.residuals.values()) < 1e-9


@pytest.mark.gate
def test_friction_loads_the_plate_round_other_holes() -> None:
    """Two clamps of a cover press a sheet together; a hole half-way sees both forces: Kelvin and Kirsch."""
    half = 30.0
    cover = JointPlate("cover", ALUMINIUM, 1.0, rectangle((-half - 4.0, half + 4.0), (-4.0, 4.0)), moves="free")
    ends = [through_both(name, at, LOOSE) for name, at in (("a", -half), ("b", half))]
    middle = JointPin("c", 0.0, STEEL, 1.0, ("sheet",), LOOSE * BETA * FORCE)
    plain = Joint((SHEET, cover), (*ends, middle))
    bonded = replace(plain, pins=(*(replace(pin, clamp=Clamp(FORCE, 1e3)) for pin in ends), middle))
    hoops, states = [], []
    for joint in (plain, bonded):
        states.append(solve_joint(joint, [{"sheet.sxx": 0.2 * FORCE}], nodes=16)[0])
        hoops.append(float(states[-1]["c", "sheet"].hoop_stress("plate", [0.5 * math.pi])[0]))
    one, other = (each.force[0] for each in states[1].faying)
    assert one == pytest.approx(-other, rel=1e-5)
    assert one > 0.1 * FORCE
    kelvin = -2.0 * one / (4.0 * math.pi * half) * (3.0 * (3.0 + ALUMINIUM.nu) + (1.0 - ALUMINIUM.nu))
    assert hoops[1] - hoops[0] == pytest.approx(kelvin, rel=0.01)


@pytest.mark.gate
def test_friction_is_in_balance_with_the_stress_of_the_plate(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sections before and behind the loose pins carry all load, half of it, and none. Both holes know one stress."""
    for module in (fields, plates, several_holes):
        monkeypatch.setattr(module, "FINENESS" if module is fields else "FINE", COARSE)
    result = solved(clamped(strips(LOOSE, LOOSE), Clamp(FORCE, 1e3, BETA)), 1.0)
    first, second = rubbed(result, 0)
    y, weights = np.polynomial.legendre.leggauss(24)
    for place, expected in ((-3.0, 1.0), (4.0, second), (11.5, 0.0)):
        found = []
        for name, centre in (("p0", 0.0), ("p1", 8.0)):
            (state,) = result.of(name, "skin", whole=True)
            stress = state.stress(Points.at_xy(np.full(24, place - centre), 4.0 * y), "plate")
            found.append(stress.sxx)
        np.testing.assert_allclose(found[0], found[1], atol=1e-4 * FORCE)
        assert 4.0 * float(weights @ found[0]) / FORCE == pytest.approx(expected, abs=1e-4)
    assert first + second == pytest.approx(1.0, abs=1e-4)
    (state,), theta = result.of("p0", "skin", whole=True), np.linspace(-3.0, 3.0, 13)
    edge = state.stress(Points.at_depth(0.0, theta), "plate")
    np.testing.assert_allclose(edge.hoop, result[0]["p0", "skin"].hoop_stress("plate", theta), atol=2e-4 * FORCE)


@pytest.mark.gate
@pytest.mark.parametrize("clearance", [0.0, -0.05])
def test_neat_and_tight_pins_of_clamped_plates(clearance: float) -> None:
    joint = clamped(strips(clearance, clearance), Clamp(2.0 * FORCE, 0.1))
    result = solved(joint, 0.0, 1.0, -1.0, 0.0)
    carried = [float(state.forces[::2, 0].sum()) / FORCE + rubbed(result, k).sum() for k, state in enumerate(result)]
    np.testing.assert_allclose(carried, [0.0, 1.0, -1.0, 0.0], atol=1e-5)
    assert max(max(state.residuals.values()) for state in result) < 1e-9


@pytest.mark.gate
def test_a_pin_clamps_every_pair_of_neighbouring_plates() -> None:
    """Double shear: both covers of a sheet carry the same friction."""
    covers = [
        JointPlate(name, ALUMINIUM, 0.5, rectangle((-4.0, 10.0), (-4.0, 4.0)), moves="free") for name in ("a", "b")
    ]
    pins = [
        JointPin(f"p{k}", at, STEEL, 1.0, ("a", "sheet", "b"), 0.02 * BETA * FORCE, 0.3, clamp=Clamp(0.2 * FORCE, 0.2))
        for k, at in enumerate((0.0, 6.0))
    ]
    joint = Joint((covers[0], SHEET, covers[1]), tuple(pins))
    state = solve_joint(joint, [{"sheet.sxx": 0.4 * FORCE}], nodes=24, harmonics=6)[0]
    assert [str(surface) for surface in joint.faying[:2]] == ["p0 a-sheet", "p0 sheet-b"]
    first, second, *_ = state.faying
    np.testing.assert_allclose(first.force, -second.force, atol=1e-5 * FORCE)
    assert np.hypot(*first.force) == pytest.approx(0.04 * FORCE, rel=1e-3)


# -- reference numbers -------------------------------------------------------------------------------------------------


@pytest.mark.survey
def test_a_clamped_lap_locks_load_in() -> None:
    """At the minimum the pins keep more than the load. The references have 128 nodes."""
    joint = clamped(lap((0.1, 0.1, 0.1), 0.3), Clamp(4.0 * FORCE, 0.2, 0.05 * BETA))
    result = solve_joint(joint, [{"strap.x": 3.0 * FORCE}, {"strap.x": 0.3 * FORCE}], nodes=64)
    forces = [state.forces[::2, 0] / FORCE for state in result]
    np.testing.assert_allclose(forces[0], [0.3, 0.0, 0.3], atol=1e-4)
    np.testing.assert_allclose(forces[1], [0.5230, 0.2865, 0.5230], atol=4e-4)
    assert peaks(result, 0)[:3:2] == pytest.approx([0.2624, 0.0], abs=4e-4)
    assert peaks(result, 1)[:3:2] == pytest.approx([0.2864, 0.2074], abs=3e-4)
    assert moved(result) == pytest.approx([2.8285, 0.7297], abs=3e-4)
    rubbing = [sum(each.dissipation for each in state.faying) / (FORCE * FORCE * BETA) for state in result]
    whole = [dissipated(result, k) + rubbing[k] for k in (0, 1)]
    assert whole == pytest.approx([0.9930, 0.9977], abs=4e-4)


# -- files, texts, refusals --------------------------------------------------------------------------------------------

CLAMPED = (
    SHEETS.replace('plates = ["sheet"]', 'plates = ["sheet", "cover"]\nclamp = { force = 4e3, friction = 0.2 }')
    .replace("[[pin]]", '[[plate]]\nname = "cover"\nmaterial = "aluminium"\nthickness = 2e-3\nmoves = "free"\n'
             "x = [-10e-3, 30e-3]\ny = [-10e-3, 10e-3]\n\n[[pin]]")
    .replace("[joint]\nnodes = 24", "[joint]\nnodes = 16\nharmonics = 4")
)  # fmt: skip


def test_a_clamp_is_read_with_units() -> None:
    pin = parse_joint(CLAMPED).joint.pins[1]
    assert pin.clamp == Clamp(4e3, 0.2)
    text = CLAMPED.replace("friction = 0.2 }", "friction = 0.2, flexibility = 1e-6 }").replace("e-3", "")
    in_mm = parse_joint('units = "mm, N, MPa"\n' + text.replace("5e-6", "5e-3")).joint.pins[1]
    assert in_mm.clamp is not None
    assert (in_mm.clamp.force, in_mm.clamp.flexibility) == pytest.approx((4e3, 1e-9), rel=1e-12)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("{ force = -4e3, friction = 0.2 }", "clamp.force: must not be negative, not -4000"),
        ("{ force = 4e3, friction = nan }", "clamp.friction: must be a finite number, not nan"),
        ("{ force = 4e3, friction = 0.2, flexibility = true }", "clamp.flexibility: must be a number, not true"),
        ("4e3", "clamp: must be a table { force, friction, flexibility }, not 4000.0"),
        ("{ friction = 0.2 }", "clamp: force is missing"),
        ("{ force = 4e3, frition = 0.2 }", 'clamp: unknown key "frition", did you mean "friction"?'),
    ],
)
def test_a_faulty_clamp_has_its_line(given: str, words: str) -> None:
    found = faults_of(parse_joint, CLAMPED.replace("{ force = 4e3, friction = 0.2 }", given))
    assert any(words in sentence and line == 27 for line, sentence in found), found


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Clamp(-1.0, 0.2), "force: must not be negative, not -1"),
        (lambda: Clamp(1.0, math.inf), "friction: must be a finite number, not inf"),
        (lambda: Clamp(1.0, 0.2, -1e-9), "flexibility: must not be negative, not -1e-09"),
        (
            lambda: JointPin("a", 0, STEEL, 1.0, ("s",), clamp=Clamp(1.0, 0.2)),
            "clamp: pin a goes through one plate: it clamps no two plates together",
        ),
        (lambda: JointPin("a", 0, STEEL, 1.0, ("s", "t"), clamp=3.0), "clamp: must be a Clamp"),  # type: ignore[arg-type]
    ],
)
def test_a_wrong_clamp_is_refused_in_one_sentence(make: Any, words: str) -> None:
    assert str(refused(make)).startswith(words)


@pytest.mark.gate
def test_text_json_and_figure_tell_the_same_friction() -> None:
    case = parse_joint(CLAMPED)
    judged = report.judged(solve_joint(case.joint, case.corners, nodes=16, harmonics=8))
    text, document = report.describe(judged), whole_document(JOINT, judged, {}, title="")
    Draft202012Validator(json_schema("joint")).validate(document)
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    row, first = document["largest_faying"][0], document["states"][0]["faying"][0]
    assert (row["pin"], row["plates"]) == (first["pin"], first["plates"]) == ("A", ["sheet", "cover"])
    assert row["force"] == max(math.hypot(*state["faying"][0]["force"]) for state in document["states"])
    assert row["used"] == row["force"] / 800.0
    assert row["slip"] == max(math.hypot(*state["faying"][0]["slip"]) for state in document["states"])
    assert row["dissipation"] == document["states"][-1]["faying"][0]["dissipation"]
    (line,) = [line.split() for line in text.split("\n") if line.split()[:2] == ["A", "sheet-cover"]]
    assert float(line[3]) == pytest.approx(100.0 * row["used"], rel=1e-3)
    assert "friction A sheet-cover.x" in text
    figure = figures.plot_shares(judged.result)
    heights = [np.max(line.get_ydata()) for line in figure.axes[0].lines]
    assert any(height == pytest.approx(1e-3 * row["force"]) for height in heights)  # kN
    labels = [words.get_text() for each in figure.legends for words in each.get_texts()]
    assert "friction A sheet-cover, friction B sheet-cover" in labels  # equal frictions are one curve

"""Lives of wear of joints: against one pin, exact checks, bushes, files and the command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import fastpin
from fastpin import Grid, LoadHistory, MaterialPair, Problem, SolveError
from fastpin.bodies import Bushing
from fastpin.cli.main import main
from fastpin.joints import Joint, JointPin, parse_joint, solve_joint
from fastpin.joints.solving import JointMatrices, JointTask, reference_force
from fastpin.model import FatigueAssessment, Wear
from fastpin.model.angles import BOTTOM
from fastpin.report import json_schema
from fastpin.wear_lives import JointWearResult, wear_joint
from fastpin.wear_lives.fat_cycles import FatCycles
from fastpin.wear_lives.joint_run import JointWearRun
from tests.support.faults import faults_of
from tests.support.laps import ALUMINIUM, BETA, FORCE, SHEET, SHEETS, STEEL, lap, through_both, with_cover
from tests.support.refusals import refused

UNIT = BETA * FORCE
LOADS = [{"A.y": -FORCE, "A.x": 0.5 * FORCE}, {"A.y": -0.3 * FORCE, "A.x": -0.5 * FORCE}]


def in_sheet(clearance: float = 0.1, friction: float = 0.2, **more: object) -> Joint:
    pin = JointPin("A", 0j, STEEL, 1.0, ("sheet",), clearance * UNIT, friction, **more)  # type: ignore[arg-type]
    return Joint((SHEET,), (pin,))


def test_one_pin_wears_as_that_of_wear() -> None:
    """A pin that is gripped: to 1e-7 of the depth, for the weak springs of loose pins."""
    problem = Problem(MaterialPair(STEEL, ALUMINIUM, "stress"), 1.0, -0.2 * UNIT, 0.2, pin_load="body")
    cycle = [{"P": -load["A.y"], "Q": load["A.x"]} for load in LOADS]
    given = {"pin": 0.02 / FORCE, "plate": 0.06 / FORCE, "cycles": 12, "at": [1, 5]}
    history = LoadHistory(cycle) + LoadHistory(cycle).repeated(12)
    alone = fastpin.wear(problem, history, grid=Grid.circle(40, BOTTOM), **given)  # type: ignore[arg-type]
    joined = wear_joint(in_sheet(-0.2), LOADS * 2, Wear(**given), nodes=40)  # type: ignore[arg-type]
    for one, other in zip(alone, joined, strict=True):
        found = other["A", "sheet"]
        assert (one.cycle, one.solved, one.next_jump) == (found.cycle, found.solved, found.next_jump)
        assert np.abs(one.pin_depth - found.pin_depth).max() < 1e-7 * one.depth
        assert np.abs(one.plate_depth - found.plate_depth).max() < 1e-7 * one.depth
        assert found.dissipation == pytest.approx(one.dissipation, rel=1e-7)
        for mine, state in zip(one.states, other.states, strict=True):
            np.testing.assert_allclose(state["A", "sheet"].pressure, mine.pressure, atol=2e-9 * FORCE)
            np.testing.assert_allclose(state["A", "sheet"].shear, mine.shear, atol=2e-9 * FORCE)
    whole = joined.of("A", "sheet")
    assert whole.summary().split()[:6] == alone.summary().split()[:6]
    assert whole.coefficients == pytest.approx(alone.coefficients)


def bushed_pair() -> Joint:
    """Two pins with unlike fits, one of them in a bush that slips."""
    bush = Bushing(ALUMINIUM, 1.3, 0.05 * UNIT, friction=0.1, bonded=False)
    first, second = (through_both(f"p{k}", 9.0 * k, 0.1 + 0.2 * k, friction=0.3) for k in range(2))
    return with_cover(replace(first, bush=bush), replace(second, radius=1.3))


@pytest.mark.gate
def test_worn_volume_is_the_coefficient_times_the_dissipated_work() -> None:
    """At each interface, to rounding, in every step of a cycle, whatever its radius."""
    joint, loads = bushed_pair(), [{"sheet.sxx": 0.3 * FORCE, "p0.y": -0.5 * FORCE}, {"sheet.sxx": -0.1 * FORCE}]
    task = JointTask.of(joint, loads, 16, 6, None)
    run = JointWearRun(
        JointMatrices.of(joint, reference_force(joint, task.values), task, lambda part: None), lambda part: None
    )
    life, system = FatCycles(run, Wear(coefficient=0.5 / FORCE), task.values), run.system
    rubbed = 0
    for values in (*task.values, *task.values):
        run.step_to(values)
        depth = life.worn_by(run.latest.slip_tally.sums, 1)[0]
        for section, nodes, lost in zip(system.sections, system.nodes.parts, run.latest.dissipation, strict=True):
            volume = system.weights[nodes] @ depth[nodes]
            friction = section.problem.uniform_friction
            assert volume * friction == pytest.approx(0.5 / FORCE * system.scales.traction * lost, rel=1e-10, abs=1e-16)
            rubbed += lost > 1e-8
        run.wear(depth)
    assert rubbed > 6


@pytest.mark.gate
def test_a_joint_without_friction_has_the_state_of_one_with_the_worn_gaps() -> None:
    """What a life holds as its gaps is what `gap` of a new joint says, in every contact."""
    pins = [through_both(f"p{k}", 9.0 * k, 0.1 + 0.2 * k, friction=0.0) for k in range(2)]
    joint = with_cover(*pins)
    loads = [{"p0.y": -FORCE, "p1.x": 0.0}, {"p0.y": -0.2 * FORCE, "p1.x": 0.3 * FORCE}]
    last = wear_joint(joint, loads * 2, Wear(coefficient=0.3 / FORCE, cycles=4), nodes=24, harmonics=6)[-1]
    worn = [replace(pin, gap={plate: last[pin.name, plate].gap for plate in pin.plates}) for pin in pins]
    fresh = solve_joint(replace(joint, pins=tuple(worn)), loads, nodes=24, harmonics=6)
    assert last.depth > 1e-3 * UNIT
    for one, other in zip(last.states[1:], fresh, strict=True):
        for mine, theirs in zip(one.contacts, other.contacts, strict=True):
            np.testing.assert_allclose(mine.pressure, theirs.pressure, atol=1e-9 * FORCE)
        np.testing.assert_allclose(one.forces, other.forces, atol=1e-9 * FORCE)


def test_equal_pins_in_bushes_wear_equally_on_both_sides_of_the_bush() -> None:
    bush = Bushing(ALUMINIUM, 1.3, 0.02 * UNIT, friction=0.1, bonded=False)
    pins = [
        JointPin(name, at, STEEL, 1.0, ("sheet",), 0.1 * UNIT, 0.3, bush=bush) for name, at in (("A", -4.0), ("B", 4.0))
    ]
    down = [
        {f"{name}.y": -size * FORCE for name in "AB"} | {"A.x": x * FORCE, "B.x": -x * FORCE}
        for size, x in ((1.0, 0.6), (0.2, -0.6))
    ]
    life = wear_joint(Joint((SHEET,), tuple(pins)), down * 2, Wear(coefficient=0.2 / FORCE, cycles=5), nodes=24)
    one, other, seat, same = life[-1].contacts
    assert life[-1].names == [("A", "sheet"), ("B", "sheet"), ("bush of A", "sheet"), ("bush of B", "sheet")]
    for mine, theirs in ((one, other), (seat, same)):
        assert mine.volume > 0.0
        assert theirs.volume == pytest.approx(mine.volume, rel=1e-6)
        assert theirs.depth == pytest.approx(mine.depth, rel=1e-6)
    assert life.of("A", "sheet", seat=True)[-1] is seat
    assert max(max(state.residuals.values()) for each in life for state in each.states) < 1e-10
    assert refused(life.of, "A", "sheet", seat="no").field == "seat"


def uneven() -> JointWearResult:
    loads = [{"strap.x": 3 * FORCE}, {"strap.x": 0.3 * FORCE}] * 2
    how = Wear(pin=0.2 / FORCE, plate=0.4 / FORCE, cycles=60, tolerance=0.1, at=[10, 30])
    return wear_joint(lap((0.1, 0.3, 0.1), 0.3), loads, how, nodes=24, harmonics=8)


@pytest.mark.gate
def test_shares_of_unequal_clearances_converge_with_wear() -> None:
    life = uneven()
    shares = life.shares("skin")
    assert np.all(np.diff(shares["p1"]) > 0.0)
    assert np.all(np.diff(shares["p0"]) < 0.0)
    assert shares["p1"][-1] > 2.0 * shares["p1"][0]
    np.testing.assert_allclose(shares["p0"], shares["p2"], rtol=1e-4)
    assert life[-1].solved < 60
    assert max(max(state.residuals.values()) for each in life for state in each.states) < 1e-10
    limit = 0.5 * (life[1].depth + life[2].depth)
    assert life.cycles_to(limit) == pytest.approx(20.0)
    assert life.cycles_to(2.0 * life[-1].depth) == float("inf")
    assert refused(life.cycles_to, -1.0).field == "depth"


@pytest.mark.gate
def test_fat_cycles_keep_their_promise() -> None:
    joint, loads = lap((0.1, 0.2), 0.3), [{"strap.x": 2 * FORCE}, {"strap.x": 0.2 * FORCE}] * 2
    how = {"coefficient": 0.1 / FORCE, "cycles": 60, "at": [20]}
    every, fat = (
        wear_joint(joint, loads, Wear(**how, tolerance=each), nodes=20, harmonics=6)  # type: ignore[arg-type]
        for each in (0.0, 0.1)
    )
    assert every[-1].solved == 60
    for one, other in zip(every[1:], fat[1:], strict=True):
        for mine, theirs in zip(one.contacts, other.contacts, strict=True):
            assert np.abs(mine.gap_growth - theirs.gap_growth).max() < 0.1 * one.depth


@pytest.mark.gate
def test_the_life_of_one_hole_has_the_fatigue_of_a_pin(tmp_path: Path) -> None:
    """Material points lie where the stress beside the hole is known. The life without wear is that of the joint."""
    sheet = replace(SHEET, material=fastpin.MATERIALS["2024-T3"], thickness=2e-3)
    pins = [JointPin(name, at, STEEL, 2.5e-3, ("sheet",), 5e-6, 0.3) for name, at in (("A", -8e-3), ("B", 8e-3))]
    joint, pulses = Joint((sheet,), tuple(pins)), [{"A.y": -size, "B.y": -size} for size in (4e3, 0.4e3)] * 2
    life = wear_joint(joint, pulses, Wear(pin=1e-15, plate=4e-15, cycles=1e4, at=[1000], tolerance=0.1), nodes=24)
    hole = life.of("A", "sheet")
    found = hole.fatigue("smith-watson-topper", "plate", depth=[0.0, 0.2e-3])
    assert hole.fatigue("smith-watson-topper", "plate", theta=[0.0, 3.0]).depth[-1] > 0.3e-3
    first = solve_joint(joint, pulses, nodes=24).assessed_fatigue(FatigueAssessment(over="cycle"))
    at_hole = next(each.found for each in first if (each.pin, each.found.body) == ("A", "plate"))
    assert found.first_life == pytest.approx(at_hole.hot_spot.life, rel=1e-3)
    hole.plot(tmp_path / "scar.svg", kind="scar")
    assert (tmp_path / "scar.svg").stat().st_size > 1000


def test_wear_that_is_too_fast_or_too_deep_is_refused() -> None:
    with pytest.raises(SolveError, match=r"cycle 1: wear is too fast"):
        wear_joint(in_sheet(), LOADS * 2, Wear(coefficient=1e5 / FORCE), nodes=16)


WORN = SHEETS.replace("[joint]", "[wear]\npin = 1e-14\nplate = 2e-14\ncycles = 3\n\n[joint]\nrepeat = 2")


def test_the_command_prints_and_writes_the_life_of_a_joint(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "joint.toml").write_text(WORN)
    out = tmp_path / "out.json"
    assert main(["wear", str(tmp_path / "joint.toml"), "--json", str(out), "--nodes", "16", "--cycles", "2"]) == 0
    text, document = capsys.readouterr().out, json.loads(out.read_text())
    assert list(Draft202012Validator(json_schema("wear")).iter_errors(document)) == []
    last = document["cycles"][-1]
    assert [each["cycle"] for each in document["cycles"]] == [0, 1, 2]
    assert last["shares"]["sheet"]["A"] > last["shares"]["sheet"]["B"]
    assert [(each["pin"], each["plate"]) for each in last["contacts"]] == [("A", "sheet"), ("B", "sheet")]
    volumes = [each["inner_volume"] + each["outer_volume"] for each in last["contacts"]]
    assert last["volume"] == pytest.approx(sum(volumes))
    assert "share of A" in text
    assert "2 cycles, 2 of them solved; debris is not modelled" in text
    assert main(["wear", str(tmp_path / "joint.toml"), "-o", str(tmp_path / "a.h5")]) == 2
    assert "--output: is for a life of one pin: that of a joint stays in memory" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("repeat = 2", "", 4, "wear: the history has no cycles: repeat = 2 in [joint] repeats its corners"),
        ("cycles = 3", "cycle = 3", 7, 'unknown key "cycle" in [wear], did you mean "cycles"?'),
        ("pin = 1e-14", "pin = -1e-14", 5, "pin: must not be negative, not -1e-14"),
        ("cycles = 3", "cycles = 1e12", 7, "cycles: must be a whole number from 1 to 49999998, not 1000000000000"),
    ],
)
def test_a_wrong_wear_is_told(old: str, new: str, line: int, words: str) -> None:
    found = faults_of(parse_joint, WORN.replace(old, new))
    assert words in found[0][1], found
    assert found[0][0] == line


def test_a_history_without_a_cycle_does_not_wear() -> None:
    error = refused(wear_joint, in_sheet(), LOADS, Wear(coefficient=1e-14))
    assert str(error) == "wear: the history has no cycles: repeat = 2 in [joint] repeats its corners"
    assert parse_joint(WORN).wear == Wear(pin=1e-14, plate=2e-14, cycles=3)

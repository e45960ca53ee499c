"""``fastpin run``, ``show`` and ``plot`` of a joint whose bush slips in its seat."""

import json
import re
from pathlib import Path

import pytest

from fastpin import InputError, Problem, solve, wear
from fastpin.casefile import parse_case
from fastpin.figures.kinds import KINDS
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.report.states import bush_line, seat_lines
from tests.support.commands import printed, refused, said
from tests.support.drawing import OF_SOME_PLATES
from tests.support.faults import fault_of
from tests.support.seats import BONDED, LOADS, SLIPS, TEXT, sample_case, sample_seat, stored_sample

NOT_OF_STATES = {"gap"} | {name for name, kind in KINDS.items() if "result" not in kind.sources} | OF_SOME_PLATES
"""Kinds that need a life of wear or several pins, or have nothing to show of this joint."""


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return stored_sample(tmp_path_factory.mktemp("seat") / "joint.h5")


# --- text ------------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_run_and_show_say_the_same_of_the_seat(stored: Path) -> None:
    lines = []
    for words in (["run", stored.with_suffix(".toml")], ["show", stored]):
        out = printed(*words)
        assert "would slip" not in out
        assert "bonded bush" not in out
        lines += [line for line in out.splitlines() if line.startswith("bush in its seat")]
    (line, walk), again = lines[:2], lines[2:]
    assert [line, walk] == again
    result = sample_seat()
    seats = result.seat.states
    most = max(seats, key=lambda seat: abs(seat.peak_slip))
    assert line.startswith("bush in its seat at load point 10: contact all round, stick ")
    slip = f"{most.peak_slip * 1e6:.4g} um at {from_bottom(most.peak_slip_angle):.2f} deg, load point {most.step + 1}"
    assert f"largest slip in all kept states: {slip}; " in line
    walked = seats[-1].rotation - seats[-4].rotation
    turned = units(result.problem)["rotation"]
    words = f"turned {turned.text(seats[-1].rotation, 4)} so far, {turned.text(walked, 3)} in the last cycle; "
    assert words in line
    dissipated = f"{seats[-1].dissipation * 10.0:.4g} mJ of {result[-1].dissipation * 10.0:.4g} mJ"
    assert line.endswith(f"dissipated {dissipated}")


def test_a_bush_that_opens_says_where() -> None:
    case = parse_case(TEXT.replace("interference = 20e-6", "interference = 4e-6"))
    states = solve(case.problem, [{"P": 4e6}], nodes=48).states
    assert re.match(r"the bush opens in its seat at -?[\d.]+ deg, load point 1$", bush_line(case.problem, states))


def test_without_a_seat_there_is_no_line() -> None:
    problem = parse_case(BONDED + LOADS).problem
    (state,) = solve(problem, [{"P": 2e6}], nodes=48).states
    assert seat_lines(problem, [state], state) == []
    assert "the bush sticks with a friction of" in bush_line(problem, [state])


def test_check_says_that_the_bush_slips(stored: Path) -> None:
    assert "outer radius 12.5 mm, slips, friction 0.15 in the plate\n" in printed("check", stored.with_suffix(".toml"))


# --- the seat alone --------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_show_prints_the_table_of_the_seat(stored: Path) -> None:
    out = printed("show", stored, "--interface", "seat", "--json", "seat.json").splitlines()
    assert out[0] == "seat of the bush"
    seat = sample_seat().seat
    last = next(line.split() for line in out if line.split()[:1] == ["10"])
    assert last[3:5] == [f"{seat[-1].peak_pressure / 1e6:.5g}", f"{from_bottom(seat[-1].peak_pressure_angle):.2f}"]
    turned = next(line for line in out if line.startswith("to corner 10"))
    walked = units(seat.problem)["rotation"].text(seat.cycles[-1].rotation_change, 3)
    assert turned.endswith(f"bush turned {walked}")
    document = json.loads(Path("seat.json").read_text(encoding="utf-8"))
    assert document["states"][-1]["rotation"] == seat[-1].rotation
    assert "seat" not in document["states"][-1]


@pytest.mark.gate
def test_the_summary_of_a_state_has_its_seat(stored: Path) -> None:
    said("show", stored, "--json", "joint.json")
    document = json.loads(Path("joint.json").read_text(encoding="utf-8"))
    seats = sample_seat().seat.states
    for told, seat in zip(document["states"], seats, strict=True):
        assert told["seat"]["rotation"] == seat.rotation
        assert told["seat"]["peak_pressure"] == seat.peak_pressure
        assert len(told["seat"]["stick"]) == len(seat.stick)
        assert told["seat"]["dissipation"] == pytest.approx(0.01 * seat.dissipation, rel=1e-15)
    slip = document["extremes"]["seat_slip"]
    assert max(abs(slip[side]["value"]) for side in slip) == max(abs(seat.peak_slip) for seat in seats)


@pytest.mark.gate
@pytest.mark.parametrize("kind", sorted(KINDS.keys() - NOT_OF_STATES))
def test_every_kind_of_figure_shows_the_seat(kind: str, stored: Path) -> None:
    said("plot", stored, kind, "--interface", "seat", "-o", "a.png")
    sample_seat().seat.plot("b.png", kind=kind)
    assert all(Path(name).read_bytes().startswith(b"\x89PNG") for name in ("a.png", "b.png"))


def test_the_numbers_of_a_figure_are_those_of_the_seat(stored: Path) -> None:
    said("plot", stored, "tractions", "--interface", "seat", "--states", "last", "-o", "a.png", "--csv", "a.csv")
    head, *rows = [line.split(",") for line in Path("a.csv").read_text(encoding="utf-8").splitlines()]
    pressure = [float(row[next(k for k, name in enumerate(head) if "pressure" in name)] or "nan") for row in rows]
    assert max(pressure) == pytest.approx(sample_seat()[-1].seat.pressure.max(), rel=1e-2)


@pytest.mark.gate
def test_other_files_have_no_seat(stored: Path) -> None:
    Path("bonded.toml").write_text(BONDED + "[solve]\nnodes = 48\n[[load]]\nP = 40e3\n", encoding="utf-8")
    said("run", "bonded.toml", "-o", "bonded.h5")
    for command in ("show", "plot"):
        words = "--interface: bonded.h5: the joint has no seat of a bush that slips (bonded = false)"
        assert words in refused(command, "bonded.h5", "--interface", "seat")
    words = "--interface: chooses a contact of a result; a case file has none"
    assert words in refused("plot", stored.with_suffix(".toml"), "--interface", "seat")


# --- what is refused, in Python and in files -------------------------------------------------------------------


def fault(text: str) -> tuple[int, str]:
    return fault_of(parse_case, text)


def line_of(text: str, start: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if line.startswith(start))


def test_friction_and_bonded_go_together() -> None:
    bonded, free = BONDED + "friction = 0.15\n" + LOADS, BONDED + "bonded = false\n" + LOADS
    words = "friction: a bonded bush does not slip: leave friction out, or set bonded = false"
    assert fault(bonded)[1] == words
    assert fault(free)[1] == "friction: a bush that is not bonded needs its friction in the plate"
    assert fault(BONDED + 'bonded = "no"\nfriction = 0.15\n' + LOADS)[1] == 'bonded: must be true or false, not "no"'
    assert fault(BONDED + "bonded = false\nfriction = -1\n" + LOADS)[1] == "friction: must not be negative, not -1"


@pytest.mark.parametrize("drive", ["ux", "uy", "both"])
def test_a_displacement_does_not_drive_a_pin_in_a_bush_that_slips(drive: str) -> None:
    words = 'drive: must be "force" in a bush that slips, or in a lug of any outline; a joint of one pin can be driven'
    text = (BONDED + SLIPS + LOADS).replace("friction = 0.2\n", f'friction = 0.2\ndrive = "{drive}"\n', 1)
    assert fault(text) == (line_of(text, "drive"), words)
    problem = sample_case().problem
    with pytest.raises(InputError) as caught:
        Problem(
            problem.pair, problem.hole_radius, problem.clearance, 0.2, drive=drive, plate_body=problem.plate_body
        )  # fmt: skip
    assert str(caught.value) == words


def test_wear_needs_a_bonded_bush() -> None:
    words = "bonded: must be true, in an infinite plate or a ring: with another bush a joint of one pin wears"
    text = TEXT + "[wear]\ncoefficient = 1e-15\ncycles = 10\n"
    assert fault(text) == (line_of(text, "bonded"), words)
    Path("case.toml").write_text(TEXT, encoding="utf-8")
    assert refused("wear", "case.toml", "--coefficient", "1e-15") == f"fastpin: {words}\n"
    case = sample_case()
    for problem in (case.problem, case.problem.interfaces[1]):
        with pytest.raises(InputError) as caught:
            wear(problem, case.history, coefficient=1e-15)
        assert str(caught.value) == words

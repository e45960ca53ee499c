"""Joints of several pins in files: the same bits as in memory, after interrupts and kills too."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import InputError, Interrupted
from fastpin.cli.main import main
from fastpin.joints import (
    Clamp,
    Joint,
    JointFile,
    JointPin,
    JointPlate,
    JointResult,
    SectionCrack,
    parse_joint,
    solve_joint,
)
from fastpin.lugs.outline import Hole, PartLoad, rectangle
from fastpin.model import MATERIALS, CrackGrowth, FatigueAssessment
from fastpin.storage import StoredResult, load_joint, record_joint, resume_joint, stored_joint, writer
from tests.support.files import replaced, written
from tests.support.laps import FORCE, SHEETS, STEEL, through_both, with_cover
from tests.support.processes import finished, python
from tests.support.refusals import refused

CASE = parse_joint(SHEETS)
CORNERS = [*CASE.corners, {"B.y": 1e3, "sheet.sxx": 2e7}, {"A.x": 3e3}]
LONGER = CASE._replace(corners=CORNERS)


def bits(value: Any) -> Any:
    """All numbers of a state, also of its contacts and their holes, as bytes."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (tuple, list)):
        return [bits(each) for each in value]
    if isinstance(value, (fastpin.State, fastpin.Problem, type(value))) and hasattr(value, "__dataclass_fields__"):
        return {each.name: bits(getattr(value, each.name)) for each in fields(value)}
    return repr(value)


def assert_same(found: JointResult, expected: JointResult) -> None:
    """Check that two results have the same bits."""
    assert (len(found), found.snaps, found.nodes) == (len(expected), expected.snaps, expected.nodes)
    assert (found.joint, found.harmonics) == (expected.joint, expected.harmonics)
    for one, other in zip(found, expected, strict=True):
        assert bits(one) == bits(other)


def clamped() -> tuple[Joint, list[dict[str, float]]]:
    """A sheet with a free cover; one of three pins is tightened, one is loose, one is driven in."""
    clearances = 0.02, 0.05, -0.01
    clamps = None, Clamp(0.5 * FORCE, 0.2), None
    pins = [through_both(f"p{k}", 4.0 * k, clearances[k], clamp=clamps[k]) for k in range(3)]
    rng = np.random.default_rng(1)
    corners = [{"sheet.sxx": 0.3 * FORCE * x, "p1.y": 0.2 * FORCE * y} for x, y in rng.uniform(-1.0, 1.0, (3, 2))]
    return with_cover(*pins), corners


def stop_at(corner: int) -> Callable[[float, float], None]:
    """Progress that interrupts a joint where it has come to a corner."""

    def progress(done: float, total: float) -> None:
        if done >= corner:
            raise Interrupted

    return progress


@pytest.fixture(scope="module")
def in_memory() -> JointResult:
    return solve_joint(CASE.joint, CORNERS, nodes=24)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a good file."""
    path = tmp_path_factory.mktemp("whole") / "joint.h5"
    record_joint(LONGER, path)
    return path.read_bytes()


def test_a_file_has_the_bits_of_the_states_in_memory(path: Path, in_memory: JointResult) -> None:
    found = record_joint(LONGER, path)
    assert_same(found, in_memory)
    assert bits(found[-2]) == bits(in_memory[2])
    assert bits(found[1:3]) == bits(tuple(in_memory[1:3]))
    assert found.first_touches == in_memory.first_touches
    assert bits(found.of("A", "sheet")) == bits(in_memory.of("A", "sheet"))
    assert [one.name for one in path.parent.iterdir()] == ["a.h5"]


@pytest.mark.gate
def test_a_file_has_the_bits_of_pins_that_bend(path: Path) -> None:
    sheet = JointPlate("sheet", MATERIALS["aluminium"], 4e-3, slices=2)
    pins = [
        JointPin(name, at, MATERIALS["steel"], 2.5e-3, ("sheet",), 5e-6, 0.2, flexibility="beam", heads="held")
        for name, at in (("A", 0.0), ("B", 20e-3))
    ]
    joint, corners = Joint((sheet,), tuple(pins)), [{"A.x": 4e3, "B.y": 1e3}, {"A.x": -1e3}]
    found = record_joint(JointFile(joint, corners, nodes=16), path)
    assert_same(found, solve_joint(joint, corners, nodes=16))
    assert stored_joint(path).joint == joint


@pytest.mark.gate
def test_a_file_keeps_what_is_followed_and_asked(path: Path) -> None:
    skin = JointPlate(
        "skin", MATERIALS["2024-T3"], 2e-3, rectangle((-0.03, 0.05), (-0.02, 0.02)), {"left": "both"},
        holes=(Hole("free", 0.02 + 0.01j, 2e-3),), loads=(PartLoad("sxx", ("right",), x=1.0),),
    )  # fmt: skip
    sheet = JointPlate("cover", MATERIALS["aluminium"], 1e-3, rectangle((-0.01, 0.02), (-0.01, 0.01)), moves="free")
    pins = [
        JointPin(name, at, MATERIALS["steel"], 2e-3, ("skin", "cover"), {"skin": 1e-6, "cover": 2e-6}, 0.2, 1e-9, clamp)
        for name, at, clamp in (("a", 0j, Clamp(1e3, 0.3, 1e-9)), ("b", 0.01 + 0j, None))
    ]
    joint = Joint((skin, sheet), tuple(pins), "strain", "mm, N, MPa")
    crack = SectionCrack("a", "skin", CrackGrowth(1e-4, 1e-3, theta=0.0, law=fastpin.cracks.Walker(1e-10, 3.0)))
    how = FatigueAssessment(over="history", life=1e5)
    record_joint(JointFile(joint, [{"skin.sxx": 1e7}, {}], "a title", 16, 8, how, crack), path)
    found = stored_joint(path)
    assert found.joint == joint
    assert found.corners == [dict.fromkeys(joint.load_names, 0.0) | {"skin.sxx": 1e7}] * 2
    assert (found.title, found.nodes, found.harmonics, found.fatigue, found.crack) == ("a title", 16, 8, how, crack)
    assert StoredResult(path).is_joint


@pytest.mark.gate
def test_a_joint_goes_on_from_a_corner_with_the_same_bits(path: Path) -> None:
    joint, corners = clamped()
    expected = solve_joint(joint, corners, nodes=16)
    for corner in (1, 2):
        with pytest.raises(Interrupted) as ended:
            record_joint(JointFile(joint, corners, nodes=16), path, overwrite=True, progress=stop_at(corner))
        assert len(ended.value.result) == len(load_joint(path)) == corner
        assert_same(resume_joint(path), expected)


KILLED = """
import os, signal, sys
from fastpin.joints import parse_joint
from fastpin.storage import record_joint, resume_joint, writer
from tests.support.laps import SHEETS
writer.CHECKPOINT_EVERY, writer.CHECKPOINT_SHARE, writer.MOST_PENDING = 0.0, 0.0, int(sys.argv[3])
case, path, last = parse_joint(SHEETS), sys.argv[1], int(sys.argv[2])
def progress(done, total):
    if done >= last:
        os.kill(os.getpid(), signal.SIGKILL)
if os.path.exists(path):
    resume_joint(path, progress=progress)
else:
    record_joint(case._replace(corners=case.corners * 6, nodes=16), path, progress=progress)
"""


@pytest.mark.gate
@pytest.mark.parametrize("pending", [1, 5])
def test_a_joint_that_is_killed_has_the_same_bits(path: Path, pending: int) -> None:
    for last in (3, 8):
        done = finished(python(KILLED, path, last, pending), check=False)
        assert done.returncode == -signal.SIGKILL, done.stderr
        reached = load_joint(path)  # a reader undoes the transaction in memory
        assert last - 1 - pending <= len(reached) <= last
    assert_same(resume_joint(path), solve_joint(CASE.joint, CASE.corners * 6, nodes=16))


def test_states_of_a_damaged_checkpoint_are_found_again(
    path: Path, in_memory: JointResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writer, "CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(writer, "CHECKPOINT_SHARE", 0.0)
    monkeypatch.setattr(writer, "MOST_PENDING", 1)

    def killed(done: float, total: float) -> None:
        if done >= 3.0:
            raise RuntimeError("killed")

    with pytest.raises(RuntimeError, match="killed"):
        record_joint(LONGER, path, progress=killed)
    assert writer.checkpoint_of(path).exists()
    with h5py.File(writer.checkpoint_of(path), "r+") as file:
        file["restart/latest/configuration/gap"][0, 0] = np.nan
    assert len(load_joint(path)) == 3
    assert_same(resume_joint(path), in_memory)
    assert not writer.checkpoint_of(path).exists()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (replaced("states/forces", 5.0), "states/forces has shape"),
        (written("states/forces", (0, 0), np.nan), "states/forces has a number that is not finite"),
        (written("states/step", 0, 2), "states/step has other corners than the rows before"),
        (written("history/corners", (0, 0), np.inf), "history/corners has a number that is not finite"),
        (written("joint/document", 0, 64), "Expecting value"),
        (replaced("interfaces/0/matrix", np.zeros((3, 3))), "matrix: must have the shape"),
        (replaced("interfaces/0/matrix", np.zeros((300, 300))), "interfaces/0/matrix has the shape"),
        (written("interfaces/1/states/pressure", (0, 3), np.nan), "states/pressure has a number that is not finite"),
        (written("interfaces/1/states/status", (0, 3), 77), "states/status has a number outside -1 to 2"),
        (written("interfaces/1/states/edge", (0, 3), np.inf), "states/edge has a number that is not finite"),
        (lambda file: file["interfaces/1/states/gap"].resize(1, axis=0), "states/gap has 1 rows, not 4"),
        (lambda file: file["states/loads"].resize(300_000_000, axis=0), "only .* bytes in the file"),
        (lambda file: file.__delitem__("interfaces/1"), "there is no part interfaces/1"),
        (lambda file: file["solver"].attrs.__setitem__("nodes", 10**9), "nodes: must be a whole number from 16 to 720"),
        (lambda file: file["solver/statistics"].attrs.__setitem__("snaps", "x"), "snaps: must be a number"),
    ],
)
def test_a_damaged_joint_is_described(path: Path, whole: bytes, change: Callable[[Any], None], reason: str) -> None:
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        change(file)
    before = path.read_bytes()
    with pytest.raises(InputError, match=reason) as raised:
        list(load_joint(path))
    assert str(raised.value).startswith(f"{path}: is damaged: ")
    assert "\n" not in str(raised.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "place", "value", "reason"),
    [
        ("configuration/pressure", (0, 0), np.inf, "configurations/pressure has a number that is not finite"),
        ("configuration/status", (0, 0), 77, "configurations/status has a number outside"),
        ("rest", (0, 0), np.inf, "rest of the restart does not fit the joint"),
    ],
)
def test_a_damaged_restart_is_described(
    path: Path, whole: bytes, name: str, place: Any, value: float, reason: str
) -> None:
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
        file[f"restart/latest/{name}"][place] = value
    with pytest.raises(InputError, match=reason):
        resume_joint(path)


@pytest.mark.parametrize(
    ("damage", "reason"),
    [
        (lambda file: file["interfaces/0/states"].pop("edge"), "no array interfaces/0/states/edge"),
        (lambda file: file["states"].pop("moved"), "no array states/moved"),
        (lambda file: file["states/state"].__setitem__(0, 77), "states/state does not count the states"),
        (lambda file: file["solver"].attrs.pop("harmonics"), "was begun with other compliances of its plates"),
    ],
)
def test_a_file_that_cannot_grow_is_refused(path: Path, damage: Callable[[h5py.File], Any], reason: str) -> None:
    with pytest.raises(Interrupted):
        record_joint(LONGER._replace(harmonics=7), path, progress=stop_at(2))
    with h5py.File(path, "r+") as file:
        damage(file)
    before = path.read_bytes()
    assert reason in str(refused(resume_joint, path))
    assert path.read_bytes() == before


def test_files_of_other_results_are_refused(path: Path, whole: bytes, tmp_path: Path) -> None:
    path.write_bytes(whole)
    one_pin = tmp_path / "one.h5"
    problem = fastpin.Problem.from_load_parameter(fastpin.MaterialPair(STEEL, STEEL), 0.1, 0.4)
    fastpin.record(problem, [{"P": 1.0}], one_pin, nodes=31)
    for read in (load_joint, resume_joint, stored_joint):
        words = (
            f"{one_pin}: holds the result of one pin, not of a joint of several; fastpin show and fastpin.load read it"
        )
        assert str(refused(read, one_pin)) == words
    for take in (fastpin.load, fastpin.resume, lambda path: StoredResult(path).case):
        assert str(refused(take, path)).startswith(
            f"{path}: holds a joint of several pins; fastpin show, joint --resume"
        )
    assert not StoredResult(one_pin).is_joint
    assert "holds a finished joint: there is nothing to go on with" in str(refused(resume_joint, path))
    assert "exists already; overwrite=True (--overwrite)" in str(refused(record_joint, LONGER, path))
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
    assert "holds an unfinished run: resume it" in str(refused(record_joint, LONGER, path))
    others = {
        "another joint": CASE._replace(joint=replace(CASE.joint, plane="strain")),
        "other loads": CASE._replace(corners=CORNERS[:2]),
        "other nodes": CASE._replace(corners=CORNERS, nodes=32),
        "other harmonics": CASE._replace(corners=CORNERS, harmonics=8),
        "another title": LONGER._replace(title="other"),
        "another [fatigue]": LONGER._replace(fatigue=FatigueAssessment(over="cycle")),
    }
    for words, like in others.items():
        assert str(refused(resume_joint, path, like)) == f"resume: {path} was begun with {words}"
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 9
    assert "has a format that this version of fastpin can't read" in str(refused(load_joint, path))


@pytest.mark.gate
def test_show_says_what_the_command_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, stored, other = (str(tmp_path / name) for name in ("joint.toml", "joint.h5", "map.svg"))
    text = SHEETS.replace('"aluminium"', '"2024-T3"').replace("4e3", "8e3") + "[fatigue]\n"
    Path(file).write_text(text)

    def said(*arguments: str) -> str:
        assert main(list(arguments)) == 0
        return capsys.readouterr().out

    printed = said("joint", file)
    assert said("joint", file, "-o", stored) == printed == said("show", stored)
    one, two = (json.loads(said(*words, "--json")) for words in (("joint", file), ("show", stored)))
    assert one | {"seconds": 0.0} == two | {"seconds": 0.0}
    said("show", stored, "--plot", other, "--at", "1", "--shares", str(tmp_path / "shares.svg"))
    assert Path(other).stat().st_size > 10_000


def test_the_command_goes_on_with_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, stored = tmp_path / "joint.toml", tmp_path / "joint.h5"
    file.write_text(SHEETS)
    with pytest.raises(Interrupted):
        record_joint(CASE, stored, progress=stop_at(1))
    assert main(["show", str(stored)]) == 0
    assert "note: 1 of 2 load points were reached" in capsys.readouterr().err
    other = tmp_path / "other.toml"
    other.write_text(SHEETS.replace("4e3", "5e3"))
    assert main(["joint", str(other), "--resume", str(stored)]) == 2
    assert f"--resume: {stored} was begun with other loads" in capsys.readouterr().err
    assert main(["joint", str(file), "--resume", str(stored)]) == 0
    whole = capsys.readouterr().out
    assert main(["joint", str(file)]) == 0
    assert capsys.readouterr().out == whole


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["joint", "--resume", "j.h5", "-o", "k.h5"], "--output: is that of the file to go on with (--resume)"),
        (["joint", "--resume", "j.h5", "--nodes", "32"], "--nodes: is that of the file to go on with (--resume)"),
        (["joint", "joint.toml", "--overwrite"], "--overwrite: needs --output FILE"),
        (["joint", "joint.toml", "-o", "j.h5"], "j.h5: exists already; overwrite=True (--overwrite) replaces it"),
        (["joint", "many.toml"], "--output: is needed: the history has 12,000 corners, more than 10,000"),
        (["show", "j.h5", "--states", "last"], "--states: is for the result of one pin, not of a joint"),
        (["show", "j.h5", "--interface", "seat"], "--interface: is for a bush that slips in its seat, not for a joint"),
    ],
)
def test_the_commands_refuse_what_means_nothing(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    arguments: list[str], words: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "j.h5").write_bytes(whole)
    (tmp_path / "joint.toml").write_text(SHEETS)
    (tmp_path / "many.toml").write_text(SHEETS.replace("nodes = 24", "nodes = 24\nrepeat = 6000"))
    assert main(arguments) == 2
    assert words in capsys.readouterr().err

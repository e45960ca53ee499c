"""A joint on the page: pictures of all holes, loads, shares, nodes, files, and wrong requests."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.cli import live as live_command
from fastpin.cli.main import main
from fastpin.joints import parse_joint, solve_joint
from fastpin.live import protocol
from fastpin.live.joint import MOST_OF_ALL, LiveJoint, most_nodes
from fastpin.live.page import recorded_page
from fastpin.live.recording import record_joint_page
from fastpin.live.server import Server
from tests.support.laps import SHEETS
from tests.support.live_pages import Page, Wire, floats, in_a_loop, recorded

COVER = """[[plate]]
name = "cover"
material = "aluminium"
thickness = 1e-3
x = [-0.02, 0.04]
y = [-0.01, 0.01]
moves = "free"

[[pin]]
clamp = { force = 1e3, friction = 0.2 }"""

COVERED = SHEETS.replace("[[pin]]", COVER).replace('["sheet"]', '["sheet", "cover"]')
"""The two bolts clamp a free cover to the sheet."""

INCHES = """units = "in, lbf, ksi"
[[plate]]
name = "sheet"
material = "aluminium"
thickness = 0.08
[[pin]]
name = ["A", "B"]
at = [[0.0, 0.0], [0.8, 0.0]]
material = "steel"
diameter = 0.2
plates = ["sheet"]
bush = { material = "C93200", outer_radius = 0.14, interference = 4e-4, bonded = false, friction = 0.15 }
[[load]]
"A.x" = 100.0
"sheet.sxx" = 1.0
"""


def joint(text: str = SHEETS, nodes: int | None = 16) -> LiveJoint:
    """Return the contacts of a joint file."""
    return LiveJoint(parse_joint(text), text, nodes)


def test_a_page_of_a_joint_begins_with_the_first_corner() -> None:
    page = Page(joint())
    (picture,) = page.pictures
    case = page.latest["case"]
    assert (picture["load"]["A.x"], picture["load"]["B.x"]) == (4e3, 2e3)
    assert [(hole["pin"], hole["plate"]) for hole in case["holes"]] == [("A", "sheet"), ("B", "sheet")]
    assert [load["name"] for load in case["loads"]] == list(page.live.session.joint.given_names)
    assert [load["size"] for load in case["loads"]][3:] == [4e3, 4e3, 2e3, 4e3]
    assert {load["unit"]["name"] for load in case["loads"]} == {"N", "Pa"}
    assert (case["controls"], case["axes"], case["nodes"], case["most_nodes"]) == ([], [], 16, 720)
    assert picture["shares"] == {"sheet": {"A": pytest.approx(2.0 / 3.0), "B": pytest.approx(1.0 / 3.0)}}
    json.dumps(page.latest, allow_nan=False)


def test_a_drag_has_the_states_of_solve_joint_bit_by_bit() -> None:
    page = Page(joint())
    for part in (0.5, -0.2, 1.2):
        page.tell("load", loads={"A.x": part * 4e3, "sheet.sxx": part * 1e7})
    session = page.live.session
    result = solve_joint(session.joint, session.history, nodes=16)
    assert len(page.pictures) == len(result) == 4
    for picture, state in zip(page.pictures, result, strict=True):
        assert picture["load"] == state.load
        assert picture["forces"] == state.forces.tolist()
        assert picture["residual"] == max(state.residuals.values())
        for hole, contact in zip(picture["holes"], state.contacts, strict=True):
            assert (hole["peak_pressure"], hole["dx"]) == (contact.peak_pressure, contact.dx)
            for name in ("pressure", "shear", "gap"):
                assert np.array_equal(floats(hole[name]), getattr(contact, name).astype("<f4"))
            degrees = floats(hole["hoop"]["degrees"]).astype(float)
            hoop = contact.hoop_stress("plate", np.radians(degrees - 90.0))
            assert np.allclose(floats(hole["hoop"]["stress"]), hoop, rtol=1e-5, atol=1e-4 * np.abs(hoop).max())


def test_undo_reset_reference_and_nodes() -> None:
    page = Page(joint())
    page.tell("load", loads={"A.x": 1e3}, gesture=5)
    page.tell("keep", on=True)
    assert page.latest["reference"] == page.pictures[-1]
    page.tell("nodes", nodes=32, follow="history")
    assert (page.latest["case"]["nodes"], len(page.pictures)) == (32, 2)
    assert len(floats(page.pictures[-1]["holes"][0]["pressure"])) == 32
    page.tell("nodes", nodes=20, follow="load", gesture=9)
    assert [picture["load"]["A.x"] for picture in page.pictures] == [1e3]
    for count in (2, 2, 1):
        page.tell("undo")
        assert len(page.pictures) == count
    page.tell("redo")
    assert page.pictures[-1] == page.latest["reference"]
    page.tell("reset")
    assert page.pictures == []


BAD: list[tuple[str, dict[str, Any], str]] = [
    ("load", {"loads": {"Z.x": 1.0}}, 'corner 1: must be "sheet.sxx"'),
    ("load", {"loads": {"A.x": 1e300}}, "A.x: must lie between -4e+09 and 4e+09, not 1e+300"),
    ("change", {"changes": {"friction": 0.1}}, "friction: is no control of the page of a joint"),
    ("nodes", {"nodes": 12}, "nodes: must be a whole number from 16 to 720, not 12"),
    ("nodes", {"nodes": 721}, "nodes: must be a whole number from 16 to 720, not 721"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "fields", "sentence"), BAD)
def test_a_wrong_request_is_refused_and_changes_nothing(kind: str, fields: dict[str, Any], sentence: str) -> None:
    page = Page(joint())
    state = page.live.session.state
    answer = page.tell(kind, **fields)
    assert (answer["kind"], answer["sentence"][: len(sentence)]) == ("refused", sentence)
    assert page.live.session.state is state


def test_a_lost_load_is_told_and_changes_nothing() -> None:
    bonded = SHEETS.replace(
        "clearance", 'bush = { material = "C93200", outer_radius = 3.5e-3, interference = 1e-6 }\nclearance'
    )
    page = Page(joint(bonded.replace("4e3", "40.0").replace("2e3", "20.0").replace("1e3", "10.0")))
    assert len(page.pictures) == 1
    answer = page.tell("load", loads={"A.x": 1e3})
    assert (answer["kind"], answer["error"], answer["load"].keys()) == (
        "lost", "NoEquilibriumError", page.pictures[0]["load"].keys()
    )  # fmt: skip
    assert page.live.session.state.load["A.x"] == 40.0


def test_nodes_and_pictures_have_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    pins = "".join(f'"p{k}", ' for k in range(25)), "".join(f"[{0.02 * k}, 0.0], " for k in range(25))
    many = parse_joint(
        SHEETS.replace('"A", "B"', pins[0]).replace("[0.0, 0.0], [20e-3, 0.0]", pins[1]).split("[[load]]")[0]
        + '[[load]]\n"p0.x" = 1e3\n'
    )
    assert most_nodes(many.joint) == MOST_OF_ALL // 25
    monkeypatch.setattr(protocol, "MOST_OF_HOLES", 6)
    page = Page(joint())
    for k in range(5):
        page.tell("load", loads={"A.x": 1e3 + k})
    assert [picture["load"]["A.x"] for picture in page.pictures] == [1002.0, 1003.0, 1004.0]
    assert len(page.live.session.history) == 6


@pytest.mark.gate
def test_pictures_have_bushes_clamps_and_plates() -> None:
    page = Page(joint(INCHES, None))
    case, picture = page.latest["case"], page.pictures[-1]
    assert case["nodes"] == 64
    assert {load["unit"]["name"] for load in case["loads"]} == {"lbf", "ksi"}
    assert [hole["bush"] for hole in case["holes"]] == [pytest.approx(0.14 * 25.4e-3)] * 2
    assert picture["holes"][0]["seat"] is not None
    page = Page(joint(COVERED))
    case, picture = page.latest["case"], page.pictures[-1]
    assert [plate["name"] for plate in case["plates"]] == ["sheet", "cover"]
    assert case["plates"][0]["outline"] is None
    assert np.ptp(case["plates"][1]["outline"], axis=0) == pytest.approx([0.06, 0.02])
    assert [name for name, *_ in picture["faying"]] == ["A sheet-cover", "B sheet-cover"]
    assert list(picture["moved"]) == ["cover"]
    assert picture["shares"]["cover"].keys() == {"A", "B"}


DRIVEN = (
    SHEETS.split("[[load]]")[0].replace('["A", "B"]', '"A"').replace("[[0.0, 0.0], [20e-3, 0.0]]", "[0.0, 0.0]")
    + 'drive = "ux"\n[[load]]\n"A.ux" = 2e-5\n'
)
"""One bolt, which is moved by a given displacement."""


def test_a_displacement_is_led_and_its_force_is_shown() -> None:
    page = Page(joint(DRIVEN))
    page.tell("load", loads={"A.ux": 1e-5})
    loads = {load["name"]: load for load in page.latest["case"]["loads"]}
    assert "A.x" not in loads
    assert (loads["A.ux"]["unit"]["name"], loads["A.ux"]["size"]) == ("m", 2e-5)
    assert [picture["load"]["A.ux"] for picture in page.pictures] == [2e-5, 1e-5]
    assert page.pictures[0]["load"]["A.x"] == pytest.approx(page.pictures[0]["forces"][0][0])
    assert str(page.tell("load", loads={"A.x": 1.0})["sentence"]).startswith("corner 1: A.x is the reaction to A.ux")


@pytest.mark.parametrize("text", [SHEETS, INCHES, DRIVEN])
def test_the_saved_file_leads_to_the_same_state(text: str) -> None:
    page = Page(joint(text))
    page.tell("load", loads={"A.x": 123.4})
    saved, session = parse_joint(page.live.case_text()), page.live.session
    assert (saved.joint, saved.title, saved.nodes) == (session.joint, parse_joint(text).title, 16)
    state = solve_joint(saved.joint, saved.corners, nodes=saved.nodes)[-1]
    assert state.load == pytest.approx(session.state.load)
    np.testing.assert_allclose(state.forces, session.state.forces, atol=1e-6)
    page.tell("reset")
    with pytest.raises(fastpin.InputError, match="case: no load was followed yet"):
        page.live.case_text()


def test_a_recording_holds_all_holes() -> None:
    page = Page(joint())
    found = recorded(recorded_page(page.live.recording()))
    assert found["add"] == json.loads(json.dumps(page.pictures))
    assert [hole["pin"] for hole in found["case"]["holes"]] == ["A", "B"]


@pytest.mark.gate
def test_the_command_records_a_joint_and_shows_it(tmp_path, monkeypatch, capsys) -> None:
    path, stored, pages = tmp_path / "joint.toml", tmp_path / "joint.h5", [tmp_path / f"{k}.html" for k in range(2)]
    path.write_text(SHEETS, encoding="utf-8")
    assert main(["joint", str(path), "-o", str(stored), "--record", str(pages[0])]) == 0
    assert main(["show", str(stored), "--record", str(pages[1])]) == 0
    first, again = (recorded(page.read_text(encoding="utf-8")) for page in pages)
    assert (first["add"], first["grids"]) == (again["add"], again["grids"])
    assert [picture["load"]["A.x"] for picture in first["add"]] == [4e3, 1e3]
    live = LiveJoint(parse_joint(SHEETS), SHEETS, 24)
    assert first["add"][0]["holes"][1]["shear"] == live.recording()["add"][0]["holes"][1]["shear"]
    assert main(["joint", str(path), "--record", "page.pdf"]) == 2
    assert "--record: must be the name of a page, which ends in .html" in capsys.readouterr().err
    monkeypatch.setattr(protocol, "MOST_OF_HOLES", 2)
    case = parse_joint(SHEETS)
    result = solve_joint(case.joint, [*case.corners, {"A.x": 0.0}], nodes=16)
    found = recorded(record_joint_page(case, result, "lost"))
    assert ([picture["load"]["A.x"] for picture in found["add"]], found["sentence"]) == ([4e3, 0.0], "lost")
    with pytest.raises(fastpin.InputError, match="result: must be a JointResult"):
        record_joint_page(case, [])


@in_a_loop
async def test_the_server_answers_the_page_of_a_joint() -> None:
    server = Server(joint)
    talk = Wire(server)
    name, first = await talk.hello()
    assert len(first["add"][0]["holes"]) == 2
    answer = await talk.tell("load", loads={"A.x": 1e3}, gesture=1)
    assert answer["add"][0]["load"]["A.x"] == 1e3
    assert (await talk.tell("load", loads={"A.sheet": 1e3}, gesture=1))["kind"] == "refused"
    assert parse_joint(str(await server.saved(name, "case.toml"))).corners[-1]["A.x"] == 1e3


def test_the_command_takes_a_joint_file(tmp_path, monkeypatch, capsys) -> None:
    asked: list[object] = []
    monkeypatch.setattr(live_command.live, "serve", lambda make, port, ready: asked.append(make().session.nodes))
    path = tmp_path / "joint.toml"
    path.write_text(SHEETS, encoding="utf-8")
    assert main(["live", str(path), "--nodes", "20"]) == 0
    assert main(["live", str(path)]) == 0
    assert asked == [20, 64]
    assert main(["live", str(path), "--nodes", "1000"]) == 2
    assert "--nodes: must be a whole number from 16 to 720, not 1000" in capsys.readouterr().err
    path.write_text(SHEETS.replace('plates = ["sheet"]', 'plates = ["skin"]'), encoding="utf-8")
    assert main(["live", str(path)]) == 2
    assert 'must be "sheet", not "skin"' in capsys.readouterr().err

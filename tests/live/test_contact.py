"""The contact of a page: messages in, pictures out, and the states of fastpin.solve."""

from __future__ import annotations

import gc
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import casefile
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.elasticity.system import System
from fastpin.live import contact as contact_module
from fastpin.live import pin as pin_module
from fastpin.live import protocol
from fastpin.live.pictures import CURVE_ERROR
from fastpin.live.pin import LivePin
from fastpin.model import About, InitialGap, Profile, Wear
from fastpin.model.angles import angle_at
from fastpin.states.curves import traction_patches
from fastpin.states.state import State
from tests.support.checks.body_cases import ring_compliance
from tests.support.live_pages import FREE, NODES, Page, contact, floats, solved
from tests.support.seats import TEXT as BUSH_SLIPS
from tests.support.tiers import gate, some_survey

P, Q = 2.42e6, 7.26e5
MOST_LEFT = contact_module.MOST_LEFT
KEPT = 8
"""Systems of the latest problems, which the next run may need."""


@pytest.fixture(autouse=True)
def hardly_collected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Collecting garbage among the objects of all tests takes longer than a step."""
    monkeypatch.setattr(contact_module, "MOST_LEFT", 1_000)


def drag(page: Page, gesture: int, count: int = 12, turn: float = 1.0) -> None:
    """Move the load along an arc."""
    for k in range(count):
        angle = turn * (k + 1) / count
        page.tell("load", loads={"P": P * math.cos(angle), "Q": P * math.sin(angle)}, gesture=gesture)


def assert_shown(picture: dict, state: State) -> None:
    """A picture shows a state: numbers to the last bit, arrays as float32."""
    assert picture["load"] == state.load
    assert (picture["dx"], picture["dy"], picture["rotation"]) == (state.dx, state.dy, state.rotation)
    assert (picture["peak_pressure"], picture["dissipation"]) == (state.peak_pressure, state.dissipation)
    for name in ("pressure", "shear", "gap"):
        assert np.array_equal(floats(picture[name]), getattr(state, name).astype("<f4"))
    if (seat := state.seat) is None:
        assert picture["seat"] is None
        return
    shown = picture["seat"]
    assert (shown["rotation"], shown["dissipation"], shown["peak_slip"]) == (
        seat.rotation,
        seat.dissipation,
        seat.peak_slip,
    )
    assert len(shown["stick"]) == len(seat.stick)
    assert shown["frictionless"] is False


def test_a_page_begins_with_the_first_corner_of_the_case() -> None:
    page = Page(contact())
    (picture,) = page.pictures
    assert picture["load"]["P"] == P
    assert page.latest["case"]["title"].startswith("Ti-6Al-4V")
    assert (page.latest["undos"], page.latest["redos"], page.latest["sentence"]) == (0, 0, "")
    json.dumps(page.latest, allow_nan=False)


@pytest.mark.parametrize("text", [None, *gate(BUSH_SLIPS)], ids=["built in", "bush that slips"])
def test_a_drag_has_the_states_of_solve_bit_by_bit(text: str | None) -> None:
    page = Page(contact(text))
    drag(page, 5)
    page.tell("load", loads={"Q": -Q}, gesture=6)
    session = page.live.session
    result = solved(page.live)
    assert len(result) == len(page.pictures) == 14
    for picture, state in zip(page.pictures, result, strict=True):
        assert_shown(picture, state)
    last = result[-1]
    for name in ("pressure", "shear", "gap", "slip", "status"):
        assert np.array_equal(getattr(session.state, name), getattr(last, name))
    if text is not None:
        assert np.array_equal(session.state.seat.slip, last.seat.slip)
        assert last.seat.rotation != 0.0
        json.dumps(page.latest, allow_nan=False)


def test_the_same_load_in_two_ways_has_two_shears() -> None:
    page = Page(contact())
    page.tell("load", loads={"Q": Q}, gesture=1)
    page.tell("load", loads={"Q": 0.3 * Q}, gesture=2)
    first = page.pictures[-1]
    page.tell("keep", on=True)
    assert page.latest["reference"]["serial"] == first["serial"]
    page.tell("reset")
    assert page.pictures == []
    page.tell("load", loads={"P": P, "Q": 0.3 * Q}, gesture=3)
    second = page.pictures[-1]
    assert second["load"] == first["load"]
    apart = np.abs(floats(first["shear"]) - floats(second["shear"])).max()
    assert apart > 0.3 * abs(second["peak_shear"])
    page.tell("keep", on=False)
    assert page.latest["reference"] is None


@pytest.mark.gate
@pytest.mark.parametrize("text", [None, BUSH_SLIPS], ids=["built in", "bush that slips"])
def test_undo_takes_back_a_gesture_and_redo_brings_it_again(text: str | None) -> None:
    page = Page(contact(text))
    friction = page.live.session.problem.friction
    drag(page, 5, 6)
    after_drag = page.pictures
    page.tell("load", loads={"Q": -Q}, gesture=6)
    page.tell("change", changes={"friction": 0.25}, gesture=7)
    assert (page.latest["undos"], len(page.pictures)) == (3, 1)
    page.tell("undo")
    assert page.latest["case"]["friction"] == friction
    page.tell("undo")
    assert page.pictures == after_drag
    page.tell("undo")
    assert len(page.pictures) == 1
    assert page.tell("undo")["sentence"] == "undo: there is nothing before to go back to"
    for _ in range(2):
        page.tell("redo")
    assert page.pictures[:-1] == after_drag
    page.tell("load", loads={"Q": 0.0}, gesture=8)  # goes on from there, and forgets what was undone
    assert page.tell("redo")["sentence"] == "redo: nothing was undone"
    assert_shown(page.pictures[-1], solved(page.live)[-1])


def test_changes_of_one_gesture_are_undone_together_and_none_is_joined_after_undo() -> None:
    page = Page(contact())
    for friction in (0.3, 0.35, 0.5):
        page.tell("change", changes={"friction": friction}, gesture=4)
    page.tell("undo")
    assert page.live.session.problem.friction == 0.4
    assert page.latest["undos"] == 0
    for _ in range(2):
        drag(page, 5, 3)
        before = page.pictures
        page.tell("undo")
        assert len(page.pictures) == 1
    page.tell("redo")
    page.tell("reset")
    assert page.live.session.state is None
    page.tell("undo")
    assert page.pictures == before


@pytest.mark.parametrize("follow", ["load", "history"])
def test_a_change_of_the_problem_follows_the_load_or_the_history(follow: str) -> None:
    page = Page(contact())
    drag(page, 5, 6)
    page.tell("change", changes={"friction": 0.25, "clearance": 3e-5}, follow=follow)
    session = page.live.session
    assert (session.problem.friction, session.problem.clearance) == (0.25, 3e-5)
    assert len(page.pictures) == (1 if follow == "load" else 7)
    assert_shown(page.pictures[-1], solved(page.live)[-1])


@pytest.mark.gate
def test_bodies_and_materials_can_be_changed() -> None:
    page = Page(contact(nodes=21))
    page.tell("change", changes={"pin_bore": 4e-3})
    assert page.live.session.problem.pin_body == Tube(4e-3, "uniform")
    page.tell("change", changes={"plate_body": "ring"})
    page.tell("change", changes={"outer_radius": 0.03})
    assert page.live.session.problem.plate_body == Ring(0.03)
    page.tell("change", changes={"plate_body": "bushing"})
    page.tell("change", changes={"bush_material": "steel"})
    page.tell("change", changes={"interference": 1e-5})
    assert page.tell("change", changes={"seat_friction": 0.3})["kind"] == "refused"  # a bonded bush does not slip
    bush = page.live.session.problem.plate_body
    assert isinstance(bush, Bushing)
    assert (bush.material.E, bush.interference) == (210e9, 1e-5)
    page.tell("change", changes={"pin_material": "rigid"})
    page.tell("change", changes={"plate_E": 200e9, "plane": "stress"})
    pair = page.live.session.problem.pair
    assert (pair.pin.is_rigid, pair.plate.E, pair.plane) == (True, 200e9, "stress")
    page.tell("change", changes={"pin_bore": 0.0})
    page.tell("change", changes={"plate_body": "plate"})
    assert not page.live.session.problem.has_bodies
    assert page.latest["case"]["plate"] == "plate"


SEAT = [
    ({"friction": 0.3}, True), ({"outer_radius": 0.013}, True), ({"interference": 1e-5}, True),
    ({"bush_E": 9e10}, True), ({"seat_friction": 0.3}, True), ({"rotation": "fixed"}, True),
    ({"plate_body": "plate"}, False),
]  # fmt: skip
"""Changes of a joint whose bush slips, and whether there is a seat after them."""


@pytest.mark.gate
@pytest.mark.parametrize(("changes", "slips"), SEAT)
def test_changes_of_the_problem_keep_the_bush_slipping(changes: dict[str, object], slips: bool) -> None:
    page = Page(contact(BUSH_SLIPS))
    answer = page.tell("change", changes=changes, follow="history", gesture=3)
    assert answer["kind"] == "pictures", answer
    assert (page.live.session.problem.seat is not None) == slips
    assert (page.pictures[-1]["seat"] is not None) == slips


def test_friction_is_not_followed_in_a_bush_that_slips() -> None:
    session = fastpin.Session(contact(BUSH_SLIPS).session.problem, NODES)
    session.advance({"P": P})
    with pytest.raises(fastpin.InputError, match='replay: "follow" needs a bush that is bonded'):
        session.change(friction=0.25, replay="follow")


VARIED = FREE.replace("friction = 0.3\n", "friction = [{ constant = 0.2 }, { zone = 0.2, start = -30, stop = 30 }]\n")
"""A case whose friction varies along the rim."""

OVAL = VARIED.replace(
    "[[load]]",
    "[gap]\nhole = [{ crown = 1e-6, centre = 0, half_width = 20 }, { ellipse = 4e-6, axis = 30 }]\n"
    "pin = [{ flat = 1e-6, centre = 90 }]\n[[load]]",
    1,
)
"""The same with initial gaps of hole and pin."""


SENT = [(None, {}), (None, {"pin_bore": 4e-3}), (None, {"plate_body": "ring"}), (None, {"plate_body": "bushing"}),
        (OVAL, {}), (OVAL, {"friction_along": "uniform", "pin_lobes": "5"})]  # fmt: skip


@pytest.mark.gate
@pytest.mark.parametrize(("text", "changes"), some_survey(SENT, SENT[-1]))
def test_every_control_can_be_sent_back_unchanged(
    text: str | None, changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "MOST_NODES", 21)
    page = Page(contact(text, nodes=21))
    if changes:
        page.tell("change", changes=changes)
    before = page.live.session.problem
    for control in page.latest["case"]["controls"]:
        answer = page.tell("change", changes={control["name"]: control["value"]})
        assert answer["kind"] == "pictures", answer
    problem = page.live.session.problem
    assert (problem.pair.pin.E, problem.pair.plate.E) == (before.pair.pin.E, before.pair.plate.E)
    assert (problem.pin_body, problem.plate_body) == (before.pin_body, before.plate_body)
    theta = np.linspace(-np.pi, np.pi, 73)
    assert np.array_equal(problem.friction_at(theta), before.friction_at(theta))
    assert np.allclose(problem.gap_at(theta)[0], before.gap_at(theta)[0], rtol=0.0, atol=1e-20)


def controls_of(page: Page) -> dict[str, dict]:
    """The controls of the page by their names."""
    return {control["name"]: control for control in page.latest["case"]["controls"]}


def around(page: Page, name: str) -> np.ndarray:
    """The values of a profile along the rim that the page has."""
    return floats(page.latest["case"]["profiles"][name])


def test_friction_that_varies_is_scaled_by_its_slider_and_keeps_its_shape() -> None:
    page = Page(contact(VARIED))
    json.dumps(page.latest, allow_nan=False)
    given = page.live.session.problem.friction
    assert controls_of(page)["most_friction"]["value"] == 0.4
    assert "friction" not in controls_of(page)
    for most in (0.6, 0.0, 0.2):  # the shape comes back after 0
        page.tell("change", changes={"most_friction": most})
        assert page.live.session.problem.friction == given.scaled(most / 0.4)
        assert page.latest["case"]["friction"] == pytest.approx(most)
    values = around(page, "contact.friction")
    assert values.size == 1440
    assert (values[0], values[720]) == pytest.approx((0.1, 0.2))  # at the top and at the bottom
    assert_shown(page.pictures[-1], solved(page.live)[-1])
    state = page.live.session.state
    assert np.all(np.abs(state.shear) <= state.friction * state.pressure * (1.0 + 1e-12))


def test_friction_that_varies_can_be_made_uniform_and_be_brought_back() -> None:
    page = Page(contact(VARIED))
    given = page.live.session.problem.friction
    page.tell("change", changes={"friction_along": "uniform"})
    assert (page.live.session.problem.friction, page.latest["case"]["profiles"]) == (0.4, {})
    page.tell("change", changes={"friction": 0.2})
    page.tell("change", changes={"friction_along": "case"}, gesture=9)
    assert page.live.session.problem.friction == given.scaled(0.5)
    page.tell("undo")
    assert page.live.session.problem.friction == 0.2
    one = Page(contact())
    assert not controls_of(one).keys() & {"most_friction", "friction_along"}
    answer = one.tell("change", changes={"most_friction": 0.2})
    assert answer["sentence"] == "most_friction: the friction of the case is the same all round"


@pytest.mark.gate
def test_hole_and_pin_get_lobes_by_words() -> None:
    page = Page(contact())
    assert [controls_of(page)[f"{body}_lobes"]["value"] for body in ("hole", "pin")] == ["0", "0"]
    page.tell("change", changes={"hole_lobes": "2"})
    usual = page.live.session.problem.clearance
    assert controls_of(page)["hole_amplitude"]["value"] == pytest.approx(0.5 * usual)
    page.tell("change", changes={"hole_axis": 30.0, "hole_amplitude": 4e-6})
    page.tell("change", changes={"pin_lobes": "3"})
    page.tell("change", changes={"pin_amplitude": 2e-6})
    gap = InitialGap(Profile.ellipse(4e-6, np.radians(-60.0)), Profile.lobes(3, 2e-6, np.radians(-90.0)))
    theta = np.linspace(-np.pi, np.pi, 73)
    session = page.live.session
    assert np.allclose(session.problem.gap_at(theta)[0], gap.values(theta, 0.01)[0], rtol=0.0, atol=1e-20)
    assert around(page, "gap.hole")[720 + 4 * 30] == pytest.approx(4e-6, rel=1e-6)  # 30 degrees from the bottom
    assert_shown(page.pictures[-1], solved(page.live)[-1])
    page.tell("change", changes={"hole_lobes": "6"})
    assert controls_of(page)["hole_axis"]["value"] == pytest.approx(-30.0)  # that of the lobe next to the bottom
    assert controls_of(page)["hole_amplitude"]["value"] == pytest.approx(4e-6)
    page.tell("change", changes={"hole_lobes": "0", "pin_amplitude": 0.0}, gesture=9)
    assert not page.live.session.problem.gap
    page.tell("undo")
    assert len(page.live.session.problem.gap.given) == 2


@pytest.mark.gate
def test_lobes_of_the_case_are_controlled_and_its_other_terms_stay() -> None:
    page = Page(contact(OVAL))
    assert page.latest["sentence"] == ""
    assert [name for name, _ in page.latest["case"]["profile_words"]] == ["hole profile", "pin profile", "friction"]
    found = controls_of(page)
    assert found["hole_lobes"]["value"] == "2"
    assert (found["hole_amplitude"]["value"], found["hole_axis"]["value"]) == pytest.approx((4e-6, 30.0))
    crown, flat = page.live.session.problem.gap.hole.terms[0], page.live.session.problem.gap.pin.terms[0]
    page.tell("change", changes={"hole_amplitude": 6e-6})
    assert crown in page.live.session.problem.gap.hole.terms
    page.tell("change", changes={"hole_lobes": "0"})
    assert page.live.session.problem.gap == InitialGap(Profile((crown,)), Profile((flat,)))
    page.tell("change", changes={"pin_lobes": "2"})
    assert flat in page.live.session.problem.gap.pin.terms
    case = casefile.parse_case(page.live.case_text())
    assert case.problem == page.live.session.problem


@pytest.mark.parametrize(
    ("kind", "fields", "sentence"),
    [
        ("load", {"loads": {"R": 1.0}}, 'corner 1: unknown load "R"; the loads are'),
        ("load", {"loads": {"M": 1e3}}, "M: a body-loaded pin can't carry a moment"),
        ("load", {"loads": {"P": 1e300}}, "P: must lie between"),
        ("change", {"changes": {"friction": -1}}, "friction: must not be negative"),
        ("change", {"changes": {"friction": None}}, "friction: must be a number"),
        ("change", {"changes": {"colour": 1}}, "colour: is no control of the page"),
        ("change", {"changes": {"pin_material": "wood"}}, "pin_material: must be"),
        ("change", {"changes": {"plane": []}}, "plane: must be"),
        ("change", {"changes": {"hole_lobes": "7"}}, "hole_lobes: must be"),
        ("change", {"changes": {"hole_lobes": "2", "hole_amplitude": "1"}}, "hole_amplitude: must be a number"),
        ("change", {"changes": {"hole_lobes": "2", "hole_amplitude": 1.0}}, "gap.hole: is too large for small strains"),
        ("change", {"changes": {"pin_lobes": "2", "pin_axis": 1e3}}, "pin_axis: must lie between"),
        ("change", {"changes": {"friction_along": "wavy"}}, "friction_along: must be"),
        ("change", {"changes": {"outer_radius": 1.0}}, "outer_radius: an infinite plate has no outer radius"),
        ("change", {"changes": {"pin_bore": 0.0099}}, "bore_radius: must be at most"),
    ],
)
def test_input_that_cannot_be_used_is_refused_and_changes_nothing(kind: str, fields: dict, sentence: str) -> None:
    page = Page(contact())
    before = page.live.session.state
    answer = page.tell(kind, **fields)
    assert (answer["kind"], answer["id"]) == ("refused", 1)
    assert answer["sentence"].startswith(sentence)
    assert page.live.session.state is before
    assert page.tell("load", loads={"Q": Q})["kind"] == "pictures"


def test_a_load_that_nothing_carries_is_lost_and_the_state_before_stays() -> None:
    page = Page(contact(FREE))
    before = page.live.session.state
    answer = page.tell("load", loads={"M": 1e6}, gesture=4)
    assert (answer["kind"], answer["error"]) == ("lost", "NoEquilibriumError")
    assert "nothing holds the pin any more" in answer["sentence"].lower()
    assert 0.0 < answer["fraction"] < 1.0
    assert 0.0 < answer["load"]["M"] < 1e6
    assert page.live.session.state is before
    page.tell("load", loads={"M": 100.0}, gesture=4)
    page.tell("undo")
    assert page.pictures[-1]["load"]["M"] == 0.0


@pytest.mark.parametrize("follow", ["load", "history"])
def test_a_load_that_the_changed_problem_does_not_take_is_left_out(follow: str) -> None:
    page = Page(contact(FREE))
    page.tell("load", loads={"M": 100.0}, gesture=5)
    page.tell("change", changes={"rotation": "fixed"}, follow=follow)
    assert page.latest["sentence"] == "The changed problem takes no M: left out"
    assert page.live.session.state.load["M"] == 0.0
    assert "M" not in [control["name"] for control in page.latest["case"]["loads"]]
    page.tell("undo")
    assert page.live.session.state.load["M"] == 100.0
    page.tell("change", changes={"friction": 0.0})  # then nothing holds the pin against the moment
    assert page.live.session.problem.friction == 0.3


def test_a_case_that_fails_at_once_says_why() -> None:
    page = Page(contact(FREE.replace("P = 1e6", "P = 1e6\nM = 1e6")))
    assert page.pictures == []
    assert page.latest["sentence"].startswith("The moment is 100 times force times radius")
    assert page.tell("load", loads={"P": 1e6})["kind"] == "pictures"
    assert page.latest["sentence"] == ""


def test_a_narrow_contact_gets_more_nodes_until_it_is_wide_again() -> None:
    page = Page(contact(FREE, 101))
    page.tell("change", changes={"clearance": 2e-4})
    assert 101 < page.live.session.grid.size < protocol.MOST_NODES
    assert np.count_nonzero(page.live.session.state.pressure) >= pin_module.LEAST_CLOSED
    page.tell("change", changes={"clearance": 1e-5})
    assert page.live.session.grid.size == 101
    load = page.pictures[-1]["load"]
    page.tell("nodes", nodes=201)
    assert (page.live.session.grid.size, page.pictures[-1]["load"]) == (201, load)
    page.tell("undo")
    assert (page.live.session.grid.size, page.latest["case"]["nodes"]) == (101, 101)


def test_a_contact_too_narrow_for_the_circle_gets_nodes_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol, "MOST_NODES", 41)
    text = FREE.replace("clearance = 1e-5", "clearance = 1e-3").replace("P = 1e6", "P = 1e4")
    page = Page(contact(text, 41))
    assert page.latest["sentence"] == ""
    session = page.live.session
    assert np.count_nonzero(session.state.pressure) > 5
    page.tell("load", loads={"Q": 1e3}, gesture=2)
    result = solved(page.live)
    assert page.live.session.state.peak_pressure == pytest.approx(result[-1].peak_pressure, rel=1e-9)


def test_displacements_can_be_led() -> None:
    text = FREE.replace("friction = 0.3", 'friction = 0.3\ndrive = "both"').replace("P = 1e6", "uy = -2e-5")
    page = Page(contact(text))
    assert [axis["load"] for axis in page.latest["case"]["axes"]] == ["ux", "uy"]
    page.tell("load", loads={"ux": 1e-6}, gesture=2)
    assert page.pictures[-1]["load"]["P"] > 0.0


def test_a_pressure_above_the_yield_strength_is_in_doubt() -> None:
    page = Page(contact())
    assert (page.pictures[-1]["doubt"], page.latest["case"]["doubts"]) == ("", [])
    page.tell("load", loads={"P": 20.0 * P}, gesture=2)
    assert "is above the yield strength" in page.pictures[-1]["doubt"]
    page.tell("change", changes={"friction": 40})
    assert page.latest["case"]["doubts"][0].startswith("friction: 40")


def test_a_new_page_gets_the_whole_history() -> None:
    page = Page(contact())
    drag(page, 5, 4)
    other = Page(page.live)
    assert other.pictures == page.pictures
    assert set(other.latest["grids"]) == {picture["grid"] for picture in page.pictures}


@pytest.mark.gate
def test_the_history_and_its_memory_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol, "MOST_UNDONE", 7)
    monkeypatch.setattr(protocol, "MOST_PICTURES", 5)
    page = Page(contact(nodes=21))
    drag(page, 5, 8)
    assert len(page.pictures) == 5
    assert len(page.live.session.history) == 9
    for gesture in range(10, 20):
        page.tell("load", loads={"Q": 1e3 * gesture}, gesture=gesture)
    assert page.latest["undos"] == 7
    assert len(page.live._pictures) == 5
    for _ in range(6):
        page.tell("undo")
    assert page.pictures == []  # they are forgotten, but the contact is there
    assert page.live.session.state is not None
    page.tell("load", loads={"Q": 5.0}, gesture=1)
    assert page.pictures[-1]["load"]["Q"] == 5.0
    monkeypatch.setattr(protocol, "MOST_UNDONE_NODES", 5 * NODES)
    page = Page(contact())
    for k in range(8):
        page.tell("load", loads={"Q": 1e4 * k}, gesture=k)
    assert page.latest["undos"] == 5  # they have few nodes together


def test_the_states_of_the_session_stay_small() -> None:
    page = Page(contact())
    drag(page, 5, 3)
    fields = set(type(page.live.session.state).__dataclass_fields__)
    assert set(vars(page.live.session.state)) == fields  # nothing that was read for the picture is kept


def test_the_saved_case_has_the_same_states() -> None:
    page = Page(contact())
    drag(page, 5, 6)
    case = casefile.parse_case(page.live.case_text())
    result = fastpin.solve(case.problem, case.history, **case.options.keywords())
    assert np.array_equal(result.grid.theta, page.live.session.grid.theta)
    assert np.array_equal(result[-1].shear, page.live.session.state.shear)
    assert result[-1].load == page.live.session.state.load
    page.tell("reset")
    with pytest.raises(fastpin.InputError, match="no load was followed yet"):
        page.live.case_text()


def test_the_saved_case_keeps_its_origin_and_its_wear() -> None:
    case = replace(
        casefile.parse_case(FREE), title="A joint", about=About(author="A. Smith"), wear=Wear(2e-15, cycles=9)
    )
    saved = casefile.parse_case(LivePin(case, NODES).case_text())
    assert (saved.title, saved.about, saved.wear) == (case.title, case.about, case.wear)


def test_a_plate_from_a_compliance_file_is_not_saved_but_its_loads_are_pointed_to() -> None:
    case = casefile.parse_case(FREE)
    ring = replace(case.problem, plate_body=Ring(0.02))
    live = LivePin(replace(case, problem=replace(ring, plate_body=ring_compliance(ring, 8))), NODES)
    assert live.session.state is not None
    with pytest.raises(fastpin.InputError, match=r"^case: a plate from a compliance file .* save the loads \(CSV\)"):
        live.case_text()


@pytest.mark.parametrize("nodes", [61, 201])
def test_the_curve_of_the_hoop_stress_has_its_peak(nodes: int) -> None:
    """Every two degrees alone miss 12 % of it: the peak is at a border of the contact."""
    page = Page(contact(nodes=nodes))
    for _ in range(2):
        hoop, state = page.pictures[-1]["hoop"], page.live.session.state
        degrees, stress = floats(hoop["degrees"]), floats(hoop["stress"])
        assert stress.max() == pytest.approx(state.peak_hoop_stress().value, rel=1e-3)
        assert (degrees[0], degrees[-1]) == (-180.0, 180.0)
        assert np.all(np.diff(degrees) > 0.0)
        page.tell("load", loads={"P": 2e6, "Q": 6e5})


def test_the_picture_has_the_stress_of_the_assembly_of_a_pressed_joint() -> None:
    """The hole of an interference pin has it all round; a pin with clearance has none."""
    page = Page(contact())
    assert "assembly" not in page.pictures[-1]["hoop"]
    page.tell("change", changes={"clearance": -2e-5})
    hoop, state = page.pictures[-1]["hoop"], page.live.session.state
    assert floats(hoop["assembly"]) == pytest.approx(state.peak_hoop_stress().assembly, rel=1e-6)


def systems() -> int:
    """Return the number of systems of matrices in this process."""
    return sum(isinstance(one, System) for one in gc.get_objects())


@pytest.fixture
def frozen() -> Iterator[None]:
    """Leave all objects of other tests alone, and collect garbage as often as usual."""
    gc.freeze()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact_module, "MOST_LEFT", MOST_LEFT)
        yield
    gc.unfreeze()


@pytest.mark.gate
def test_gestures_that_can_be_undone_hold_no_matrices(frozen: None) -> None:
    page = Page(contact(nodes=21))
    before = systems()
    for k in range(20):
        page.tell("change", changes={"friction": 0.2 + 0.01 * k}, gesture=k)
        page.tell("load", loads={"Q": 1e5}, gesture=k)
    assert page.latest["undos"] == 20
    assert systems() - before <= KEPT + MOST_LEFT + 1
    page.tell("undo")
    page.tell("load", loads={"Q": 2e5}, gesture=99)
    assert np.array_equal(page.live.session.state.shear, solved(page.live)[-1].shear)


@pytest.mark.parametrize("load", [{"P": P}, {"P": -P}, {"P": 0.0, "Q": P}, {"P": 0.0, "Q": -P}])
def test_a_symmetric_load_turns_the_pin_by_rounding_only(load: dict[str, float]) -> None:
    """With 201 nodes none stands at the bottom: one of its neighbours closed first, and the pin turned by 28 nrad."""
    assert pin_module.NODES % 4 == 0
    page = Page(contact(nodes=pin_module.NODES))
    page.tell("reset")
    page.tell("load", loads=load)
    (picture,) = page.pictures
    assert abs(picture["rotation"]) <= picture["rounding"]["rotation"]
    assert picture["rounding"]["rotation"] < 1e-9 * abs(picture["dx"] + picture["dy"]) / 1e-3


def test_the_curves_of_a_picture_are_those_of_figures() -> None:
    page = Page(contact(nodes=200))
    drag(page, 5, 4, 0.5)
    state = page.live.session.state
    found = [floats(page.pictures[-1]["curves"][name]) for name in ("degrees", "pressure", "shear")]
    ((angle, pressure, shear),) = [points.T for points in traction_patches(state)]
    close = 5.0 * CURVE_ERROR * state.peak_pressure  # of four thinnings, and float32
    assert np.allclose(np.interp(angle, found[0], found[1]), pressure, rtol=0.0, atol=close)
    assert np.allclose(np.interp(angle, found[0], found[2]), shear, rtol=0.0, atol=close)
    assert found[0].size < 0.6 * angle.size
    edges = np.degrees([end for ends in state.contact for end in ends]) + 90.0
    assert found[0][[0, -1]] == pytest.approx(edges, abs=1e-4)
    assert np.allclose(found[1][[0, -1]], 0.0, atol=1e-12 * state.peak_pressure)


def test_curves_across_the_top_have_a_part_at_either_end() -> None:
    page = Page(contact())
    page.tell("reset")
    page.tell("load", loads={"P": -P})
    degrees, pressure = (floats(page.pictures[-1]["curves"][name]) for name in ("degrees", "pressure"))
    assert np.isnan(degrees).sum() == 1
    assert np.nanmin(degrees) == -180.0
    assert np.nanmax(degrees) == 180.0
    assert pressure[0] == pytest.approx(pressure[-1]) == pytest.approx(np.nanmax(pressure), rel=1e-3)
    page.tell("reset")
    page.tell("change", changes={"clearance": -1e-4})
    page.tell("load", loads={"P": 1e4})
    degrees = floats(page.pictures[-1]["curves"]["degrees"])
    assert not np.isnan(degrees).any()
    assert np.all(np.diff(degrees) >= 0.0)


LAMINATE = """
[pin]
material = "steel"
[plate]
layup = "[0/45/-45/90]2s"
ply = "T300/5208"
axis = 120
[contact]
plane = "stress"
hole_radius = 10e-3
clearance = 20e-6
friction = 0.4
[[load]]
P = 2.42e6
"""


def test_a_laminate_has_a_control_of_its_axis_only() -> None:
    page = Page(contact(LAMINATE, nodes=21))
    assert controls_of(page)["plate_axis"]["value"] == -60.0
    assert not {"plate_material", "plate_E", "plate_nu", "plate_body"} & controls_of(page).keys()
    page.tell("change", changes={"plate_axis": 30.0})
    plate = page.live.session.problem.pair.plate
    assert plate.axis == angle_at(30.0)
    assert plate.layup == "[0/45/-45/90]2s"
    page.tell("change", changes={"plane": "strain"})
    assert page.live.session.problem.pair.plate == plate
    for changes, words in [({"plate_E": 1e9}, "the plate is a laminate"), ({"plate_axis": "x"}, "must be a number")]:
        assert words in page.tell("change", changes=changes)["sentence"]
    other = Page(contact(nodes=21))
    assert "belongs to a laminate" in other.tell("change", changes={"plate_axis": 30.0})["sentence"]

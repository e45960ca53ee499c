"""The live page of a joint whose bush slips in its seat."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import fastpin
from tests.support.live_pages import Page, contact, solved
from tests.support.seats import TEXT

FORCE = 4e6


@pytest.fixture
def page() -> Page:
    return Page(contact(TEXT, 48))


def turn(page: Page, count: int = 3) -> None:
    for k in range(count):
        angle = 2.0 * math.pi * (k + 1) / count
        page.tell("load", loads={"P": FORCE * math.cos(angle), "Q": FORCE * math.sin(angle)}, gesture=1, drag=True)


@pytest.mark.gate
def test_a_drag_has_the_states_of_solve_with_the_bush(page: Page) -> None:
    turn(page)
    result = solved(page.live)
    assert len(result) == len(page.pictures) == 4
    for picture, state in zip(page.pictures, result, strict=True):
        seat, shown = state.seat, picture["seat"]
        assert (shown["rotation"], shown["dissipation"]) == (seat.rotation, seat.dissipation)
        assert shown["peak_slip"] == seat.peak_slip
        assert len(shown["stick"]) == len(seat.stick)
        assert shown["frictionless"] is False
    assert page.pictures[-1]["seat"]["rotation"] != 0.0
    json.dumps(page.latest, allow_nan=False)


@pytest.mark.gate
def test_undo_and_redo_lead_back_to_the_same_seat(page: Page) -> None:
    turn(page)
    before = page.pictures[-1]
    page.tell("undo")
    assert len(page.pictures) == 1
    page.tell("redo")
    assert page.pictures[-1] == before
    page.tell("load", loads={"P": FORCE, "Q": 0.5 * FORCE}, gesture=2)
    last, again = page.live.session.state, solved(page.live)[-1]
    assert np.array_equal(again.seat.slip, last.seat.slip)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("changes", "slips"),
    [
        ({"friction": 0.3}, True), ({"outer_radius": 0.013}, True), ({"interference": 1e-5}, True),
        ({"bush_E": 9e10}, True), ({"seat_friction": 0.3}, True), ({"rotation": "fixed"}, True),
        ({"plate_body": "plate"}, False),
    ],
)  # fmt: skip
def test_changes_of_the_problem_keep_the_bush_slipping(page: Page, changes: dict[str, object], slips: bool) -> None:
    answer = page.tell("change", changes=changes, follow="history", gesture=3)
    assert answer["kind"] == "pictures", answer
    assert (page.live.session.problem.seat is not None) == slips
    assert (page.pictures[-1]["seat"] is not None) == slips


def test_friction_is_not_followed_in_a_bush_that_slips() -> None:
    session = fastpin.Session(contact(TEXT, 48).session.problem, 48)
    session.advance({"P": FORCE})
    with pytest.raises(fastpin.InputError, match='replay: "follow" needs a bush that is bonded'):
        session.change(friction=0.25, replay="follow")

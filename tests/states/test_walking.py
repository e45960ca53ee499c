"""Whether a bush walks in its seat, or rests."""

from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin.assess.margins import ROW, in_json
from fastpin.assess.outputs import document
from fastpin.errors import InputWarning
from fastpin.states.margins import smallest_margin, walk_margins
from fastpin.states.walking import LEAST_WALK, Walk, walk_doubts, walk_words
from tests.support.outcomes import value
from tests.support.seats import sample_seat


@pytest.fixture(scope="module")
def cycle() -> list[fastpin.State]:
    return list(sample_seat().states[-4:])


def turned(states: list[fastpin.State], turn: float, sticks: bool) -> list[fastpin.State]:
    """The same states with other rotations of the bush, and with a seat that sticks everywhere or slips everywhere."""
    changed = []
    for state, part in zip(states, np.linspace(0.0, 1.0, len(states)), strict=True):
        seat = state.seat
        assert seat is not None
        status = np.full(seat.status.shape, 0 if sticks else 1)
        slip = np.zeros(seat.slip.shape) if sticks else part * 1e-6 * (1.0 + np.arange(seat.slip.size))
        seat = replace(seat, rotation=part * turn, status=status.astype(seat.status.dtype), slip=slip)
        changed.append(replace(state, seat=seat))
    return changed


def test_the_walk_is_that_of_the_cycles_and_of_a_study(cycle: list[fastpin.State]) -> None:
    walk, result = Walk.of(cycle), sample_seat()
    assert walk is not None
    assert walk.turn == pytest.approx(result.seat.cycles[-1].rotation_change, rel=1e-12)
    assert walk.sticking == pytest.approx(value({"cycle": "sticking_part"}, result.seat), rel=1e-12)


@pytest.mark.parametrize(
    ("turn", "sticks", "goes_on"), [(1e-3, False, True), (-1e-3, False, True), (1e-3, True, False)]
)
def test_a_bush_walks_where_no_part_of_its_seat_sticks_throughout(cycle, turn, sticks, goes_on) -> None:
    states = turned(cycle, turn, sticks)
    walk = Walk.of(states)
    assert walk is not None
    assert (walk.goes_on, walk.sticking > 0.0) == (goes_on, sticks)
    (margin,) = walk_margins(states)
    words = "walks 1 mrad a cycle, 6,283 cycles for a full turn" if goes_on else "rests: "
    assert margin.remark.startswith(words)
    assert goes_on or margin.remark.endswith(" % of its seat sticks throughout the last cycle")
    assert margin.margin == (-1.0 if goes_on else np.inf)
    assert walk_words(states) == f"it {margin.remark}"
    assert margin.loads == states[-1].load
    (row,) = (document(ROW, each, {}) for each in in_json(states[0].problem, [margin]))
    assert (row["name"], row["body"], row["smallest"]) == ("walk", "bush", goes_on)
    assert smallest_margin([margin]) == (margin if goes_on else None)
    found = walk_doubts(states, sample_seat().cycles)
    assert [str(each) for each in found] == ([f"bush: it {words}"] if goes_on else [])
    assert all(isinstance(each, InputWarning) for each in found)


def test_to_and_fro_is_no_walk(cycle) -> None:
    states = turned(cycle, 1e-3, sticks=False)
    back = replace(states[-1], seat=replace(states[-1].seat, rotation=0.1 * LEAST_WALK * 1e-3))
    assert (
        walk_words([*states[:-1], back]) == "it slips to and fro: no part of its seat sticks throughout the last cycle"
    )


def test_a_cycle_without_all_corners_or_without_a_seat_has_no_walk(cycle) -> None:
    cycles = sample_seat().cycles
    assert walk_doubts([*turned(cycle, 1e-3, sticks=False)[:2], *turned(cycle, 1e-3, sticks=False)[3:]], cycles) == []
    assert Walk.of([replace(state, seat=None) for state in cycle]) is None
    body = replace(cycle[0].problem.plate_body, bonded=True, friction=None)
    bonded = replace(cycle[0].problem, plate_body=body)
    assert Walk.of([replace(state, problem=bonded) for state in cycle]) is None
    assert walk_margins([]) == []
    assert walk_doubts([], cycles) == []

"""The choice of states: words, load points, slices, and one sentence for each fault."""

import numpy as np
import pytest

from fastpin import InputError, LoadHistory
from fastpin.states.choice import (
    check_choice,
    chosen_cycles,
    chosen_places,
    even_choice,
    missing_corners,
    span_of,
    states_between,
)
from fastpin.states.cycles import Cycle, innermost_cycles
from tests.support.refusals import refused
from tests.support.samples import sample_result

POINTS = np.array([0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0])
CYCLES = (Cycle(1, 2, 1, 0.0, 0.0, 0.0, 0.0, True), Cycle(3, 2, 2, 0.0, 0.0, 0.0, 0.0, True))


@pytest.mark.parametrize(
    ("chosen", "places"),
    [
        (None, [0, 1, 2, 3, 4, 5, 6]),
        ("all", [0, 1, 2, 3, 4, 5, 6]),
        ("last", [6]),
        ("cycle", [3, 4, 5, 6]),
        ("1, 2.5", [1, 4]),
        ([4, 0.5], [6, 0]),
        (np.array([1.0, 3.0]), [1, 5]),
        (2, [3]),
        (slice(-2, None), [5, 6]),
        ("1-2", [1, 2, 3]),
        ("2.5-", [4, 5, 6]),
        ("-1", [0, 1]),
        ("4, 1-1.5", [6, 1, 2]),
        ("1.6-3.4", [3, 4, 5]),
        ("1e0", [1]),
    ],
)
def test_choices(chosen, places):
    assert chosen_places(POINTS, CYCLES, chosen) == places


KINDS = "states: must be last, cycle, all or load points such as 2,3.5, 1-9 or 10-, not "


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ("now", f"{KINDS}'now'"),
        ("1,,2", f"{KINDS}'1,,2'"),
        ("nan", f"{KINDS}'nan'"),
        ([], f"{KINDS}[]"),
        ([True], f"{KINDS}[true]"),
        ({}, f"{KINDS}"),
        ([[1.0]], f"{KINDS}[[1.0]]"),
        ("3-1", f"{KINDS}'3-1'"),
        ("-", f"{KINDS}'-'"),
        ("1-2-3", f"{KINDS}'1-2-3'"),
        ("5-9", "states: there is no state in the load points 5-9; the last is 4"),
        ("3.2-3.8", "states: there is no state in the load points 3.2-3.8; the last is 4"),
        (7, "states: there is no state at load point 7; the last is 4"),
        ([-1], "states: there is no state at load point -1; the last is 4"),
        (slice(9, 12), "states: the slice holds no state; there are 7"),
    ],
)
def test_faults(chosen, message):
    assert str(refused(chosen_places, POINTS, CYCLES, chosen)).startswith(message)


def test_there_must_be_states_and_cycles():
    with pytest.raises(InputError, match="there is no state to plot"):
        chosen_places(np.zeros(0), (), None)
    with pytest.raises(InputError, match="no cycle of the history has ended"):
        chosen_places(POINTS, (), "cycle")
    with pytest.raises(InputError, match="the states of the last cycle were not kept"):
        chosen_places(POINTS[:2], CYCLES, "cycle")


def test_a_choice_is_checked_before_the_history_is_solved():
    history = LoadHistory([{"P": 1.0}, {"P": 2.0}])
    for good in (None, "last", "all", "1.5", 2, slice(0), "1-9", "2-", "-2"):
        check_choice(good, history)
    for bad in ("cycle", "3", 0, "first", "3-", "2-1"):
        with pytest.raises(InputError, match="states"):
            check_choice(bad, history)
    check_choice("cycle", history.repeated(2))


@pytest.mark.parametrize(
    ("chosen", "places"),
    [("last", [3]), ("all", [0, 1, 2, 3]), ("blocks", [1, 3]), ("2", [1]), ("3-,1", [0, 2, 3]), ("-2", [0, 1])],
)
def test_cycles_are_chosen_by_their_number(chosen, places):
    blocks = [Cycle(c, 2, k, 0.0, 0.0, 0.0, 0.0, True) for c, k in ((3, 1), (5, 2), (9, 1), (11, 2))]
    assert chosen_cycles(blocks, chosen) == places


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ("first", "cycle: must be last, blocks, all, or cycles such as 3, 1,5 or 10-, not 'first'"),
        ("2-1", "cycle: must be last, blocks, all, or cycles such as 3, 1,5 or 10-, not '2-1'"),
        ("3", "cycle: there is no cycle 3; the history has 2, counted from 1"),
        ("1,4-", "cycle: there is no cycle 4-; the history has 2, counted from 1"),
    ],
)
def test_faults_of_chosen_cycles(chosen, message):
    assert str(refused(chosen_cycles, CYCLES, chosen)) == message
    with pytest.raises(InputError, match="no cycle of the history has ended"):
        chosen_cycles((), chosen)


def test_the_innermost_cycles_contain_no_other():
    inner = [Cycle(c, 2, k, 0.0, 0.0, 0.0, 0.0, True) for c, k in ((3, 1), (5, 2), (8, 1), (10, 2))]
    outer = [Cycle(6, 5, 1, 0.0, 0.0, 0.0, 0.0, True), Cycle(11, 5, 2, 0.0, 0.0, 0.0, 0.0, True)]
    assert innermost_cycles([*inner, *outer]) == inner
    assert innermost_cycles(outer) == outer


def test_states_of_a_cycle():
    result = sample_result([{"P": 1.0 + k} for k in range(5)])
    assert span_of(CYCLES[-1]) == (2, 4)
    assert [state.step for state in states_between(result, 2, 4)] == [1, 2, 3]
    assert missing_corners(result, 2, 4) == []
    assert missing_corners(result[2:4], 2, 5) == [2, 5]


def test_an_even_choice_has_the_kept_places() -> None:
    places = list(range(0, 100, 2))
    assert even_choice(places, 5) == [0, 24, 48, 74, 98]
    assert even_choice(places, 5, (36, 37)) == [0, 32, 36, 66, 98]
    assert even_choice(places[:4], 5, (2,)) == [0, 2, 4, 6]
    assert even_choice(places, 3, places) == [0, 2, 4]

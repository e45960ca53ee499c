"""The choice of states of a history: the last one, a cycle, or load points.

Load points count as tables do: 1 is the first corner of the history, 1.5 lies halfway to the second one. The same words
choose states in Python (``states=``) and on the command line (``--states``).
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, instances, items, number, places_of
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.states.cycles import Cycle, consecutive_cycles
from fastpin.states.quantities import load_point
from fastpin.states.state import State

StateChoice = str | float | Sequence[float] | slice | None
"""A choice of states: "last", "cycle", "all", load points (numbers, or a text such as "1,5,9"), or a slice of places.

A text may hold ranges of load points: "1-9", "10-" or "1,5-9".

None leaves the choice to the figure.
"""

MOST_CHOSEN = 100_000
"""Most load points of a choice."""

NO_CYCLE = "no cycle of the history has ended; add repeat = 2 to a [[load]] block"
"""Refusal of a cycle where there is none."""


class Range(NamedTuple):
    """All numbers from one to another, both included. A single number is a range of equal ends.

    Attributes
    ----------
    first, last : float
        -inf and inf are open ends.
    """

    first: float
    last: float

    @property
    def is_single(self) -> bool:
        """Whether it is a single number."""
        return self.first == self.last

    def __str__(self) -> str:
        ends = [f"{end:g}" if math.isfinite(end) else "" for end in self]
        return ends[0] if self.is_single else "-".join(ends)


def ranges_in(text: str) -> list[Range]:
    """Return the numbers and ranges of a text, in their order.

    Raises
    ------
    ValueError
        If a part is neither a number nor a range, is not finite, or a range ends before it begins.
    """
    number = r"(\d+(?:\.\d*)?|\.\d+)?"
    found = []
    for part in map(str.strip, text.split(",")):
        match = re.fullmatch(rf"{number}\s*-\s*{number}", part)
        if match and (match[1] or match[2]):
            ends = Range(float(match[1] or -math.inf), float(match[2] or math.inf))
        else:
            ends = Range(float(part), float(part))
            if not math.isfinite(ends.first):
                raise ValueError(f"{part} is not finite")
        if ends.last < ends.first:
            raise ValueError(f"{part} goes downwards")
        found.append(ends)
    return found


def span_of(cycle: Cycle) -> tuple[int, int]:
    """The corners, counted from 1, at which a cycle begins and ends. It begins at 0 if it begins without load."""
    return cycle.corner + 1 - cycle.length, cycle.corner + 1


def loaded_span_of(cycle: Cycle) -> tuple[int, int]:
    """The corners, counted from 1, at which a cycle begins and ends, with a state at both.

    Raises
    ------
    InputError
        If the cycle begins without load.
    """
    first, last = span_of(cycle)
    if first < 1:
        raise InputError("cycle", f"the cycle to corner {last} begins without load: choose a later one")
    return first, last


def stops_of_one_problem(states: Sequence[State], least: int = 2) -> list[State]:
    """Check the stops of a cycle, at least so many, and return them as a list.

    Raises
    ------
    InputError
        If they are no states of one problem, or fewer.
    """
    stops = instances("states", states, State, "a sequence of fastpin.State")
    if len(stops) < least:
        least_words = "the stops of a cycle, at least two" if least > 1 else "at least one state"
        raise InputError("states", f"must be {least_words}, not {len(stops)}")
    if not share_problem(stops):
        raise InputError("states", "must be states of one problem")
    return stops


def share_problem(states: Sequence[State]) -> bool:
    """Whether the states are of one problem. What other pins of a joint do to the hole differs from state to state."""
    first, *others = dict.fromkeys(state.problem for state in states)
    return all(_without_others(other) == _without_others(first) for other in others)


def _without_others(problem: Problem) -> Problem:
    body = problem.plate_body.without_others
    return problem if body is problem.plate_body else replace(problem, plate_body=body)


def states_between(states: Sequence[State], first: float, last: float) -> list[State]:
    """The states from one load point to another, both included, in the order of the history."""
    return sorted((state for state in states if first <= load_point(state) <= last), key=load_point)


def missing_corners(states: Sequence[State], first: int, last: int) -> list[int]:
    """The corners from `first` to `last`, counted from 1, whose states are not among `states`."""
    kept = {state.step + 1 for state in states if state.fraction == 1.0}
    return [corner for corner in range(first, last + 1) if corner not in kept]


def last_cycle_states(states: Sequence[State], cycles: Sequence[Cycle]) -> list[State]:
    """The states of the last cycle that has ended. There are none if the state at a corner of it was not kept."""
    if not cycles:
        return []
    first, last = span_of(cycles[-1])
    within = states_between(states, first, last)
    return [] if missing_corners(within, first, last) else within


def chosen_places(points: np.ndarray, cycles: Sequence[Cycle], chosen: StateChoice) -> list[int]:
    """The places of the chosen states, in the order of the choice.

    Parameters
    ----------
    points : ndarray, shape (k,)
        Load points of the states.
    cycles : sequence of Cycle
        The cycles of the history that have ended.
    chosen : StateChoice
        None chooses all states.

    Raises
    ------
    InputError
        If there is no state, no such state or no cycle, or the choice is of another kind. The field is "states".
    """
    if not len(points):
        raise InputError("states", "there is no state to plot")
    if isinstance(chosen, slice):
        places = list(places_of("states", chosen, len(points)))
        if not places:
            raise InputError("states", f"the slice holds no state; there are {len(points):,}")
        return places
    word = chosen if isinstance(chosen, str) else ""
    if chosen is None or word == "all":
        return list(range(len(points)))
    if word == "last":
        return [len(points) - 1]
    if word == "cycle":
        if not cycles:
            raise InputError("states", NO_CYCLE)
        first, last = span_of(cycles[-1])
        places = np.flatnonzero((points >= first) & (points <= last)).tolist()
        if not places:
            raise InputError("states", "the states of the last cycle were not kept")
        return places
    wanted = _points_of(chosen)
    by_range = {}
    for ends in dict.fromkeys(wanted):  # texts such as 2.333333333 name thirds of a step
        within = np.flatnonzero((points > ends.first - 1e-9) & (points < ends.last + 1e-9))
        if not within.size:
            raise _no_state(ends, points[-1])
        by_range[ends] = within[:1].tolist() if ends.is_single else within.tolist()
    return [place for ends in wanted for place in by_range[ends]]


def even_choice(places: Sequence[int], most: int, kept: Collection[int] = ()) -> list[int]:
    """Thin `places` out evenly to `most`; those in `kept` stay, and so do the first and the last of the others."""
    if len(places) <= most:
        return list(places)
    chosen = [place for place in places if place in kept][:most]
    others = [place for place in places if place not in chosen]
    spread = np.linspace(0, len(others) - 1, most - len(chosen)).round().astype(int)
    return sorted({*chosen, *(others[k] for k in spread.tolist())})


def check_choice(chosen: StateChoice, history: LoadHistory) -> None:
    """Check a choice of states before a history is solved.

    Raises
    ------
    InputError
        If the history can't have such a state, or the choice is of another kind. The field is "states".
    """
    if isinstance(chosen, str) and chosen == "cycle" and not history.longest_cycle:
        raise InputError("states", NO_CYCLE)
    if chosen is None or isinstance(chosen, slice) or (isinstance(chosen, str) and chosen in ("last", "cycle", "all")):
        return
    for ends in _points_of(chosen):
        if not (ends.last > 0.0 and ends.first <= len(history)):
            raise _no_state(ends, len(history))


def _points_of(chosen: Any) -> list[Range]:
    """The load points, and ranges of them, that a choice names."""
    parts = [chosen] if isinstance(chosen, (int, float, np.number)) else chosen
    if isinstance(chosen, str):
        parts = chosen.split(",")
    try:
        listed = items("states", parts, "load points")
        if isinstance(chosen, str):
            points = ranges_in(",".join(listed[:MOST_CHOSEN]))
        else:
            points = [Range(point, point) for point in (number("states", part) for part in listed[:MOST_CHOSEN])]
    except (InputError, ValueError):
        points = []
    if points and len(listed) > MOST_CHOSEN:
        raise InputError("states", f"must be at most {MOST_CHOSEN:,} load points, not {len(listed):,}")
    if not points:
        shown = repr(chosen) if isinstance(chosen, str) else as_toml(chosen)
        raise InputError("states", f"must be last, cycle, all or load points such as 2,3.5, 1-9 or 10-, not {shown}")
    return points


def _no_state(ends: Range, last: float) -> InputError:
    where = f"at load point {ends}" if ends.is_single else f"in the load points {ends}"
    return InputError("states", f"there is no state {where}; the last is {last:g}")


def chosen_cycles(cycles: Sequence[Cycle], chosen: str) -> list[int]:
    """Return the places of the chosen cycles among `cycles`, in their order.

    Parameters
    ----------
    cycles : sequence of Cycle
        All cycles of a history that have ended.
    chosen : str
        "last", "all", "blocks" (the last cycle of each block), or numbers and ranges such as "1,5-9,20-". Cycles count
        from 1, in the order of their ends.

    Raises
    ------
    InputError
        If there is no cycle, no such cycle, or the choice is none. The field is "cycle".
    """
    if not cycles:
        raise InputError("cycle", NO_CYCLE)
    if chosen == "last":
        return [len(cycles) - 1]
    if chosen == "all":
        return list(range(len(cycles)))
    if chosen == "blocks":
        return sorted(cycles.index(block[-1]) for block in consecutive_cycles(cycles))
    try:
        wanted = ranges_in(chosen)
    except ValueError:
        allowed = "last, blocks, all, or cycles such as 3, 1,5 or 10-"
        raise InputError("cycle", f"must be {allowed}, not {chosen!r}") from None
    in_ranges: set[int] = set()
    for ends in wanted:
        places = [place for place in range(len(cycles)) if ends.first <= place + 1 <= ends.last]
        if not places:
            raise InputError("cycle", f"there is no cycle {ends}; the history has {len(cycles):,}, counted from 1")
        in_ranges.update(places)
    return sorted(in_ranges)

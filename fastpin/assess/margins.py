"""The margins of safety of a result: all of them, and the smallest one as an outcome."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fastpin.assess.crack import grown
from fastpin.assess.fatigue import Assessed
from fastpin.assess.kept import kept
from fastpin.assess.strength import WorstState, worst_state
from fastpin.cracks.margins import crack_margins
from fastpin.damage.margins import last_cycle_margins, reserve_margins, strength_margins
from fastpin.model.problem import Problem
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import KeptStates, marked_extremes
from fastpin.states.margins import Margin, smallest_margin, static_margins
from fastpin.states.state import State

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.cracks import Growth

LEAST = "least"
"""The smallest of all margins that are known, as tables mark it."""


def all_margins(
    static: Sequence[Margin],
    last_cycle: Sequence[Margin],
    fatigue: Assessed | None = None,
    crack: Growth | None = None,
    strength: WorstState | None = None,
) -> list[Margin]:
    """Return the margins of a result: those of all states and of the last cycle, and of what its case asks for."""
    rows = [*static, *last_cycle]
    rows += [] if fatigue is None else reserve_margins(fatigue.reserves, fatigue.how)
    rows += [] if crack is None else crack_margins(crack)
    return rows + ([] if strength is None else strength_margins(*strength))


def result_margins(
    problem: Problem, static: Sequence[Margin], states: Sequence[State], cycles: Sequence[Cycle], **asked: Any
) -> list[Margin]:
    """Return the known margins of a result: `states` hold its last cycle. See :func:`all_margins`."""
    return all_margins(static, last_cycle_margins(problem, states, cycles), **asked)


def of_margin(name: str, owner: str | None, sections: tuple[tuple[str, Any], ...], result: Any) -> float:
    """The smallest margin, or the smallest one of a kind, of all bodies or of one; NaN if none is known.

    The margins are computed from the states, with the strengths that the problem of the result has. `sections` are
    those of the case, pairs of a name and a value.

    Raises
    ------
    FastpinError
        If a fatigue or a strength can't be assessed, or a crack can't be followed.
    """
    rows = [row for row in _margins(result, sections) if owner in (None, row.owner)]
    if name != LEAST:
        rows = [row._replace(name="") for row in rows if row.name == name]  # also one that is no failure
    least = smallest_margin(rows)
    return math.nan if least is None else least.margin


@kept
def _margins(result: Any, sections: tuple[tuple[str, Any], ...]) -> list[Margin]:
    """All margins of a result, as ``fastpin run`` prints them."""
    how, states = dict(sections), KeptStates(result.states)
    asked: dict[str, Any] = {}
    if "fatigue" in how:
        asked["fatigue"] = Assessed(how["fatigue"], [], result.assessed_reserves(how["fatigue"]))
    if "crack" in how:
        asked["crack"] = grown(result, how["crack"])
    if "strength" in how:
        asked["strength"] = worst_state(result, how["strength"])
    static = static_margins(result.problem, marked_extremes(states), states.read)
    return result_margins(result.problem, static, result.states, result.cycles, **asked)

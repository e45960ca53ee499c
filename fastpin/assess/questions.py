"""The questions that a case asks of its result: for each a section beside the problem, and the file that answers it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fastpin.assess import crack, fatigue, strength
from fastpin.assess.margins import last_cycle_margins
from fastpin.assess.outputs import Question, kept
from fastpin.model.problem import Problem
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import Found, KeptStates, marked_extremes
from fastpin.states.margins import Margin, smallest_margin, static_margins
from fastpin.states.state import State

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.solver.result import Result


QUESTIONS: dict[str, Question] = {
    "fatigue": fatigue.QUESTION, "crack": crack.QUESTION, "strength": strength.QUESTION
}  # fmt: skip
"""The questions by the names of their sections, in the order of all texts."""

LEAST = "least"
"""The smallest of all margins that are known, as tables mark it."""


def of_question(name: str, quantity: str, how: Any, result: Result) -> float:
    """Return an outcome of a question; `how` is the value of its section.

    Raises
    ------
    FastpinError
        If the result can't be judged so.
    """
    output, read = QUESTIONS[name].outcomes[quantity]
    value: float = output.number(read(result, how))
    return value


def all_margins(static: Sequence[Margin], last_cycle: Sequence[Margin], found: Mapping[str, Any]) -> list[Margin]:
    """Return the margins of a result: of all states, of the last cycle, and of what is `found` for the questions."""
    rows = [*static, *last_cycle]
    for name in QUESTIONS:
        rows += [] if found.get(name) is None else QUESTIONS[name].margins(found[name])
    return rows


def result_margins(
    problem: Problem, static: Sequence[Margin], last: Sequence[State], cycles: Sequence[Cycle], found: Mapping[str, Any]
) -> list[Margin]:
    """Return the known margins of a result: `last` holds the states of its last cycle. See :func:`all_margins`."""
    return all_margins(static, last_cycle_margins(problem, last, cycles), found)


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
    return margins_of(result, {name: QUESTIONS[name].judged(result, how) for name, how in sections})


def margins_of(result: Any, found: Mapping[str, Any]) -> list[Margin]:
    """Return the known margins of a result in memory over all its states. See :func:`all_margins`."""
    kept = KeptStates(result.states)
    static = static_margins(result.problem, marked_extremes(kept) if result.states else Found(), kept.read)
    return result_margins(result.problem, static, result.states, result.cycles, found)

"""Outcomes of margins of safety: the smallest margin of a result, or the smallest one of a kind."""

from __future__ import annotations

import math
from typing import Any

from fastpin.assess.crack import grown
from fastpin.assess.kept import kept
from fastpin.assess.strength import worst_state
from fastpin.cracks.margins import crack_margins
from fastpin.damage.margins import last_cycle_margins, reserve_margins, strength_margins
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.crack import CrackGrowth
from fastpin.model.strength import StrengthAssessment
from fastpin.solver.result import Result
from fastpin.states.extremes import KeptStates, marked_extremes
from fastpin.states.margins import Margin, smallest_margin, static_margins

LEAST = "least"
"""The smallest of all margins that are known, as tables mark it."""


def of_margin(name: str, owner: str | None, sections: tuple[tuple[str, Any], ...], result: Result) -> float:
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
def _margins(result: Result, sections: tuple[tuple[str, Any], ...]) -> list[Margin]:
    return margins_of(result, **dict(sections))


def margins_of(
    result: Result,
    fatigue: FatigueAssessment | None = None,
    crack: CrackGrowth | None = None,
    strength: StrengthAssessment | None = None,
) -> list[Margin]:
    """All margins of a result, as ``fastpin run`` prints them.

    Raises
    ------
    FastpinError
        See :func:`of_margin`.
    """
    found = marked_extremes(KeptStates(result.states))
    rows = static_margins(result.problem, found, lambda places: [result.states[place] for place in places])
    rows += last_cycle_margins(result.problem, result.states, result.cycles)
    rows += [] if fatigue is None else reserve_margins(result.assessed_reserves(fatigue), fatigue)
    rows += [] if crack is None else crack_margins(grown(result, crack))
    return rows + ([] if strength is None else strength_margins(strength, *worst_state(result, strength)))

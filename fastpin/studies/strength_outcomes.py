"""Outcomes of the strength of a laminate round the hole, in the worst state of a result."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fastpin import damage
from fastpin.model.doubts import doubts_given
from fastpin.model.strength import StrengthAssessment
from fastpin.solver.result import Result
from fastpin.states.state import State
from fastpin.studies.failure import failure_load
from fastpin.studies.kept import kept


class StrengthQuantity(NamedTuple):
    """A number of the strength of a laminate, see :class:`CycleQuantity`.

    `of` gives its value for a result. Without a kind it has no unit.
    """

    kind: str
    of: Callable[[Result, StrengthAssessment], float]


@kept
def least_of(result: Result, how: StrengthAssessment) -> tuple[State, damage.JointStrength]:
    """The worst state and its strength. They are kept while the result lives."""
    return damage.least_strength(result.states, how)


def _factor(result: Result, how: StrengthAssessment) -> float:
    """The factor on the loads at failure, on as many nodes and with states at the same fractions of each step."""
    fractions = sorted({state.fraction for state in result} - {1.0})
    options: dict[str, Any] = {"between": fractions} if fractions else {}
    with doubts_given():
        return failure_load(
            result.problem, result.history, how.criterion, **how.lengths, over="history",
            nodes=result.grid.size, **options,
        ).factor  # fmt: skip


STRENGTH_QUANTITIES: dict[str, StrengthQuantity] = {
    "ratio": StrengthQuantity("", lambda result, how: least_of(result, how)[1].least_ratio),
    "angle": StrengthQuantity("angle", lambda result, how: least_of(result, how)[1].angle),
    "factor": StrengthQuantity("", _factor),
}
"""The quantities of the strength of a laminate, by name.

"ratio" is the least strength ratio of all states. "angle" is its place on the hole. "factor" is the factor on all loads
at which the first ply fails; the history is solved several times for it.
"""


def of_strength(quantity: str, how: StrengthAssessment, result: Result) -> float:
    """The value of a name in :data:`STRENGTH_QUANTITIES`.

    Raises
    ------
    FastpinError
        If the strength can't be assessed, or no factor is found.
    """
    return STRENGTH_QUANTITIES[quantity].of(result, how)

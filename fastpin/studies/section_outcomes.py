"""Outcomes of the sections of a case beside its problem: fatigue, crack and strength."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from fastpin.assess.crack import GROWTH, grown
from fastpin.assess.fatigue import DAMAGE, worst_damage
from fastpin.assess.outputs import Output, chosen
from fastpin.assess.strength import PLACE, FailureLoad, failure_load, worst_state
from fastpin.model.doubts import doubts_given
from fastpin.model.strength import StrengthAssessment

if TYPE_CHECKING:  # the solver is compiled code, and a plan is read without it
    from fastpin.solver.result import Result


class SectionOutcome(NamedTuple):
    """An outcome of a section.

    Attributes
    ----------
    output : Output
    read : callable
        ``read(result, how)`` gives the subject of the output, where `how` is the value of the section.
    """

    output: Output
    read: Callable[[Any, Any], Any]


def _load_at_failure(result: Result, how: StrengthAssessment) -> FailureLoad:
    """Find the load at failure, on as many nodes and with states at the same fractions of each step."""
    fractions = sorted({state.fraction for state in result} - {1.0})
    options: dict[str, Any] = {"between": fractions} if fractions else {}
    with doubts_given():
        return failure_load(
            result.problem, result.history, how.criterion, **how.lengths, over="history",
            nodes=result.grid.size, **options,
        )  # fmt: skip


def _read_by(read: Callable[[Any, Any], Any], outputs: Mapping[str, Output]) -> dict[str, SectionOutcome]:
    return {name: SectionOutcome(output, read) for name, output in outputs.items()}


SECTION_OUTCOMES = {
    "fatigue": _read_by(worst_damage, chosen(DAMAGE, ("life", "damage", "angle"))),
    "crack": _read_by(
        grown,
        chosen(GROWTH, ("fate", "life", "arrest"))
        | {
            "theta": chosen(GROWTH, ("angle_of_mouth",))["angle_of_mouth"],
            "largest_K": Output("largest_K", "stress intensity", lambda found: found.K_max.max()),
        },
    ),
    "strength": _read_by(worst_state, chosen(PLACE, ("ratio", "angle")))
    | _read_by(_load_at_failure, {"factor": Output("factor", "", lambda found: found.factor)}),
}
"""The outcomes of each section by name.

Those of fatigue belong to the hot spot with the largest damage of all bodies. Of a crack, "theta" is its mouth, and
"largest_K" the largest K_I up to the last length. The history is solved several times for the "factor" at failure.
"""


def of_section(section: str, quantity: str, how: Any, result: Result) -> float:
    """The value of a name in :data:`SECTION_OUTCOMES`.

    Raises
    ------
    FastpinError
        If the result can't be judged so.
    """
    output, read = SECTION_OUTCOMES[section][quantity]
    return output.number(read(result, how))


def unit_of_life(passes: str) -> tuple[str, str]:
    """Return the kind of a life that counts these passes, and its unit where it has no kind: spectra are no cycles."""
    return ("life", "") if passes == "cycles" else ("", passes)

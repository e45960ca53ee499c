"""The strength of a laminate as the section [strength] of its case asks for it: text, and JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from fastpin import damage, studies
from fastpin.assess import outputs
from fastpin.assess.asked import strength_words
from fastpin.assess.strength import PLACE, WorstState
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.case import Case
from fastpin.model.doubts import doubts_given
from fastpin.model.strength import LENGTHS, StrengthAssessment
from fastpin.model.units import printed_loads, units
from fastpin.solver.errors import SolveError
from fastpin.states.quantities import load_point
from fastpin.states.state import State


class StrengthFound(NamedTuple):
    """The strength of a laminate in the worst state of a history.

    Attributes
    ----------
    how : StrengthAssessment
    states : int
        Number of states of which it is the worst.
    state : State
    strength : JointStrength
    failure : FailureLoad or None
        None unless it is asked for and found.
    reason : str
        Why it was not found; empty if it was, or was not asked for.
    """

    how: StrengthAssessment
    states: int
    state: State
    strength: damage.JointStrength
    failure: studies.FailureLoad | None
    reason: str

    @property
    def worst(self) -> WorstState:
        """How it was assessed, the worst state and its strength."""
        return WorstState(self.how, self.state, self.strength)


def assess_strength(
    case: Case, states: Sequence[State], progress: Callable[[float, float], None] | None = None
) -> StrengthFound:
    """Return the strength in the worst of some states of a case with a section [strength], and its load at failure.

    Raises
    ------
    InputError
        If the strength can't be assessed.
    """
    how = case.strength
    assert how is not None
    state, strength = damage.least_strength(states, how, progress)
    failure, reason = None, ""
    if how.failure:
        options = case.options.keywords() | {"error_bars": False}  # they need another run each time
        try:
            with doubts_given():
                failure = studies.failure_load(
                    case.problem, case.history, how.criterion, **how.lengths, over="history", **options
                )
        except (InputError, SolveError) as error:
            reason = str(error)
    return StrengthFound(how, len(states), state, strength, failure, reason)


def strength_lines(found: StrengthFound) -> list[str]:
    """Return lines of text: the least strength ratio with its place and mode, and the factor on the loads."""
    ratio, words = found.strength.least_ratio, strength_words(found.state.problem, found.how)
    if not math.isfinite(ratio):
        return [f"strength by {words}: no stress"]
    line = f"strength ratio {ratio:.4g} by {words}"
    if found.states > 1:
        line += f", the least of {found.states:,} kept states, at load point {load_point(found.state):.6g}"
    lines = [f"{line}; {place_words(found.strength)}"]
    if found.failure is not None:
        at = f"load point {load_point(found.failure.state):.6g}; " if found.states > 1 else ""
        words = f"{at}{place_words(found.failure.strength)}"
        lines.append(f"load at failure: {found.failure.factor:.4g} times all loads; {words}")
    elif found.reason:
        lines.append(f"load at failure: not found, {found.reason}")
    return lines


def place_words(strength: damage.JointStrength) -> str:
    """Return the place of the least ratio, its ply and its modes in words."""
    at = f"at {from_bottom(strength.angle):z.2f} deg from the bottom"
    parts = [at, f"ply of {strength.ply_angle:g} deg by {strength.ply_mode}", strength.joint_mode]
    return ", ".join(filter(None, parts))


def document(found: StrengthFound) -> dict[str, Any]:
    """Return a strength as a JSON-ready dict. A ratio without stress is infinite."""
    unit, failure = units(found.state.problem), None
    lengths = {name: unit["length"].factor * value for name, value in found.how.lengths.items()}
    if found.failure is not None:
        load = printed_loads(found.state.problem, found.failure.state.load)
        failure = {"factor": found.failure.factor, "load": load, "solved": found.failure.solved}
        failure |= outputs.document(PLACE, found.failure, unit)
    return {
        "criterion": found.how.criterion,
        **dict.fromkeys(LENGTHS),
        **lengths,
        "states": found.states,
        **outputs.document(PLACE, found, unit),
        "failure": failure,
        "error": found.reason or None,
    }

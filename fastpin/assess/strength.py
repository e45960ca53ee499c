"""The strength of a laminate round the hole: its outputs, its text, and the load at which the first ply fails."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from fastpin import damage, solver
from fastpin.assess import outputs
from fastpin.assess.margins import strength_margins
from fastpin.damage.hole_strength import JOINT_MODES
from fastpin.damage.laminates import MODES
from fastpin.errors import InputError
from fastpin.model import Case, LoadHistory, Problem, angles, checks
from fastpin.model.case import BESIDE
from fastpin.model.doubts import doubts_given
from fastpin.model.loads import LOAD_KIND, Corner
from fastpin.model.ply import CRITERION_NAMES, PlyCriterion
from fastpin.model.strength import LENGTHS, StrengthAssessment
from fastpin.model.units import printed_loads, units
from fastpin.solver.errors import ConvergenceError, SolveError
from fastpin.states.quantities import load_point
from fastpin.states.state import State

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.storage.held import Held

CLOSE = 1e-6
"""Largest difference of the strength ratio from 1 at the load at failure."""


MOST_SOLVED = 40
"""Most histories that are solved to find it. Three or four are usual: stresses nearly grow with the load."""


PLACE = (
    outputs.Output("load_point", "", lambda found: load_point(found.state)),
    outputs.Output(
        "ratio", "", lambda found: found.strength.least_ratio,
        "factor on the stresses at which the first ply fails; null: no stress", optional=True,
    ),
    outputs.Output("angle", "angle", lambda found: found.strength.angle),
    outputs.Output("depth", "length", lambda found: float(found.strength.depth[found.strength.least])),
    outputs.Output(
        "ply", "whole", lambda found: int(found.strength.ply[found.strength.least]),
        "place in the stack, 0 for the lowest ply",
    ),
    outputs.Output("ply_angle", "", lambda found: found.strength.ply_angle),
    outputs.Output("ply_mode", "text", lambda found: found.strength.ply_mode, allowed=MODES),
    outputs.Output("joint_mode", "text", lambda found: found.strength.joint_mode, allowed=("", *JOINT_MODES)),
)  # fmt: skip
"""Outputs of a state and its strength: the least ratio, and its place."""


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
    failure: FailureLoad | None = None
    reason: str = ""

    def length(self, name: str) -> float | None:
        """A length of the assessment, m; None if it has another one."""
        return self.how.lengths.get(name)


@outputs.kept
def worst_state(result: Any, how: StrengthAssessment) -> StrengthFound:
    """Return the strength in the worst state of a result. It is kept while the result lives.

    Raises
    ------
    InputError
        If the strength can't be assessed.
    """
    return StrengthFound(how, len(result.states), *damage.least_strength(result.states, how))


def _load_at_failure(result: Any, how: StrengthAssessment) -> FailureLoad:
    """Find the load at failure, on as many nodes and with states at the same fractions of each step."""
    fractions = sorted({state.fraction for state in result} - {1.0})
    options: dict[str, Any] = {"between": fractions} if fractions else {}
    with doubts_given():
        return failure_load(
            result.problem, result.history, how.criterion, **how.lengths, over="history",
            nodes=result.grid.size, **options,
        )  # fmt: skip


def strength_words(problem: Problem, how: StrengthAssessment) -> str:
    """Criterion of an assessment of strength, and where it is evaluated."""
    length = units(problem)["length"]
    if how.distance is not None:
        return f"{how.criterion} {f'{length.text(how.distance, 3)} from' if how.distance else 'at'} the edge"
    lengths = (f"{length.text(value, 3)} in {name}" for name, value in how.lengths.items())
    return f"{how.criterion} on the characteristic curve of {' and '.join(lengths)}"


def find(case: Case, held: Held | None, progress: outputs.Follow | None = None) -> StrengthFound | None:
    """Return the strength in the worst state as [strength] asks for it, and its load at failure if the run is complete.

    None without a state.

    Raises
    ------
    InputError
        If the strength can't be assessed.
    """
    how = case.strength
    if how is None or held is None or not held.points.size:
        return None
    states = held.whole().states
    state, strength = damage.least_strength(states, how, progress)
    failure, reason = None, ""
    if how.failure and held.result.complete:
        options = case.options.keywords() | {"error_bars": False}  # they need another run each time
        try:
            with doubts_given():
                failure = failure_load(
                    case.problem, case.history, how.criterion, **how.lengths, over="history", **options
                )
        except (InputError, SolveError) as error:
            reason = str(error)
    return StrengthFound(how, len(states), state, strength, failure, reason)


def lines(found: StrengthFound, over: Mapping[str, float]) -> list[str]:
    """Return lines of text: the least strength ratio with its place and mode, and the factor on the loads."""
    ratio, words = found.strength.least_ratio, strength_words(found.state.problem, found.how)
    if not math.isfinite(ratio):
        return [f"strength by {words}: no stress"]
    line = f"strength ratio {ratio:.4g} by {words}"
    if found.states > 1:
        line += f", the least of {found.states:,} kept states, at load point {load_point(found.state):.6g}"
    text = [f"{line}; {place_words(found.strength)}"]
    if found.failure is not None:
        at = f"load point {load_point(found.failure.state):.6g}; " if found.states > 1 else ""
        words = f"{at}{place_words(found.failure.strength)}"
        text.append(f"load at failure: {found.failure.factor:.4g} times all loads; {words}")
    elif found.reason:
        text.append(f"load at failure: not found, {found.reason}")
    return text


def place_words(strength: damage.JointStrength) -> str:
    """Return the place of the least ratio, its ply and its modes in words."""
    at = f"at {angles.from_bottom(strength.angle):z.2f} deg from the bottom"
    parts = [at, f"ply of {strength.ply_angle:g} deg by {strength.ply_mode}", strength.joint_mode]
    return ", ".join(filter(None, parts))


FOUND = (
    outputs.Output("criterion", "text", lambda found: found.how.criterion, allowed=CRITERION_NAMES),
    *(outputs.Output(name, "length", partial(StrengthFound.length, name=name), optional=True) for name in LENGTHS),
    outputs.Output("states", "whole"),
    *PLACE,
    outputs.Output(
        "failure", optional=True,
        parts=(
            outputs.Output("factor"),
            outputs.Output(
                "load", of=lambda found: printed_loads(found.state.problem, found.state.load),
                form=outputs.map_of(outputs.NUMBER, "loads of the state that fails"),
            ),
            outputs.Output("solved", "whole"),
            *PLACE,
        ),
    ),
    outputs.Output("error", "text", lambda found: found.reason or None, optional=True),
)  # fmt: skip
"""Outputs of a :class:`StrengthFound`. A ratio without stress is infinite."""


QUESTION = outputs.Question(
    words=lambda problem, how: strength_words(problem, how) + ", with the load at failure" * how.failure,
    bar="state {n} of {total}",
    failed="no strength is assessed",
    margin_names={"ply": "factor on the stresses at which the first ply fails"},
    unvaried="changes no run of a sweep",
    keys=BESIDE["strength"].keys[:-1],
    outcomes={name: (output, worst_state) for name, output in outputs.chosen(PLACE, ("ratio", "angle")).items()}
    | {"factor": (outputs.Output("factor"), _load_at_failure)},
    find=find,
    judged=worst_state,
    lines=lines,
    document=lambda found, over: outputs.document(FOUND, found, units(found.state.problem)),
    schema=lambda: outputs.schema_of(FOUND),
    margins=lambda found: strength_margins(found.how, found.state, found.strength),
    in_sweeps=lambda how: replace(how, failure=False),
)
"""The strength of [strength]. The history is solved several times for its outcome "factor" at failure."""


@dataclass(frozen=True, eq=False)
class FailureLoad:
    """The load at which the first ply fails.

    Attributes
    ----------
    factor : float
        Factor on all loads of the history.
    state : State
        The state in which it fails, of the history times this factor.
    strength : JointStrength
        The strength there; its least ratio is 1.
    solved : int
        Number of histories that were solved.
    """

    factor: float
    state: State
    strength: damage.JointStrength
    solved: int


def failure_load(
    problem: Problem,
    history: LoadHistory | Sequence[Corner],
    criterion: PlyCriterion = "hashin",
    *,
    distance: float | None = None,
    tension: float | None = None,
    compression: float | None = None,
    over: Literal["end", "history"] = "end",
    **options: Any,
) -> FailureLoad:
    """The factor on a load history at which the first ply fails at a distance from the hole.

    With a clearance the stresses are not in proportion to the load. So histories are solved until the strength ratio is
    1. Damage before failure, which spreads the load, is not known to it.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        The loads that the factor multiplies. A change of friction is kept as it is.
    criterion, distance, tension, compression
        See :func:`joint_strength`.
    over : {"end", "history"}
        Where it fails: at the end of the history, or in any state that is kept.
    **options
        Options of :func:`fastpin.solve`, such as ``nodes``.

    Raises
    ------
    InputError
        See :func:`joint_strength`; also if the laminate carries no stress there.
    SolveError
        If a history can't be followed, or no factor is found.
    """
    loads = history if isinstance(history, LoadHistory) else LoadHistory(history)
    how = StrengthAssessment(criterion, distance, tension, compression)
    last = slice(-1 if checks.choice("over", over, ("end", "history")) == "end" else 0, None)
    scaled = [name for name, kind in LOAD_KIND.items() if kind != "ratio"]  # all but the change of friction
    factor, known = 1.0, []
    for solved in range(1, MOST_SOLVED + 1):
        states = solver.solve(problem, loads.scaled(dict.fromkeys(scaled, factor)), **options)[last]
        state, strength = damage.least_strength(states, how)
        ratio = strength.least_ratio
        if not math.isfinite(ratio):
            raise InputError("history", "must stress the laminate: no factor makes a ply fail")
        if abs(ratio - 1.0) <= CLOSE:
            return FailureLoad(factor, state, strength, solved)
        known.append((math.log(factor), math.log(ratio)))
        factor = math.exp(_next_factor(known))
    raise ConvergenceError(f"no load at failure was found after {MOST_SOLVED} histories")


def _next_factor(known: list[tuple[float, float]]) -> float:
    """The logarithm of the next factor to try, from those of the known factors and their strength ratios.

    A ratio above 1 asks for a larger factor. The secant of the logarithms is taken where it stays between the nearest
    factors on both sides, and else the step for stresses in proportion to the load, or the middle.
    """
    low = max((x for x, y in known if y > 0.0), default=-math.inf)
    high = min((x for x, y in known if y < 0.0), default=math.inf)
    x, y = known[-1]
    found = x + y
    if len(known) > 1:
        before, value = known[-2]
        if y != value and low < (secant := x - y * (x - before) / (y - value)) < high:
            found = secant
    return found if low < found < high else 0.5 * (low + high)

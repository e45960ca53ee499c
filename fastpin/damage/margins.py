"""Margins of safety of fatigue, over the last cycle and against the goal of [fatigue], and of the first ply."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

from fastpin.damage.criteria import criterion_title
from fastpin.damage.hole_strength import JointStrength
from fastpin.damage.hot_spots import Fatigue, cycle_states
from fastpin.damage.hot_spots import fatigue as fatigue_of
from fastpin.damage.reserve import Goal, StressReserve
from fastpin.errors import InputError
from fastpin.model import FatigueAssessment, Problem, StrengthAssessment
from fastpin.model.angles import from_bottom
from fastpin.model.points import edge_body, isotropic_bodies, owner_of, point_words
from fastpin.states.cycles import Cycle
from fastpin.states.margins import Margin, part_of, walk_margins
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State

MOST_STOPS = 100
"""Most states of a cycle whose fatigue is printed unasked: some tenths of a second."""


def fatigue_margins(problem: Problem, known: Sequence[Fatigue] | str, states: Sequence[State]) -> list[Margin]:
    """Return the margins of fatigue over the last cycle, with a row for each elastic edge of a hole.

    Parameters
    ----------
    problem : Problem
    known : sequence of Fatigue or str
        Smith, Watson and Topper's parameter over the last cycle; or why it is not known.
    states : sequence of State
        The states of the last cycle.
    """
    rows = []
    for body in (body for body in isotropic_bodies(problem) if body != "pin"):
        subject = f"last cycle only: {edge_body(problem, body)}, fatigue"
        limited = None
        if states and not isinstance(known, str):
            with contextlib.suppress(InputError):  # its limit follows from the bending and the torsion limit
                limited = fatigue_of(states, "findley", body)
        one = next((one for one in known if not isinstance(one, str) and one.body == body), None)
        if limited is not None:
            spot, owner = limited.hot_spot, owner_of(problem, body)
            place = "" if math.isnan(spot.theta) else point_words(problem, body, spot.theta, spot.depth)
            limit = math.nan if limited.limit is None else float(limited.limit)
            row = Margin(f"{subject}, Findley", "traction", spot.parameter, limit, remark=place, name="findley")
            rows.append(row._replace(owner=owner, part=part_of(problem, owner)))
        elif one is None:
            why = known.rstrip(".") if isinstance(known, str) else "no constants of fatigue given"
            rows.append(Margin(subject, remark=f"not known: {why[0].lower()}{why[1:]}"))
        else:
            life, owner = one.hot_spot.life, owner_of(problem, body)
            remark = f"not known: a margin needs Findley's bending_limit and torsion_limit of the {owner}"
            if not math.isnan(life):
                remark += f"; life {life:.3g} cycles" if math.isfinite(life) else "; infinite life"
            words = f"{subject}, {criterion_title(one.criterion)}"
            rows.append(Margin(words, one.kind, one.hot_spot.parameter, remark=remark, owner=owner))
    return rows


def last_cycle_margins(problem: Problem, states: Sequence[State], cycles: Sequence[Cycle]) -> list[Margin]:
    """Return the margins over the last of the cycles that are known: of a bush that may walk, and of fatigue.

    None of fatigue is found if that takes long.
    """
    try:
        stops = cycle_states(states, cycles[-1]) if cycles else []
    except InputError:  # a corner of the cycle was not kept
        return []
    rows = fatigue_margins(problem, [], stops) if len(stops) <= MOST_STOPS else []
    return walk_margins(stops) + [row for row in rows if not math.isnan(row.margin)]


def reserve_margins(reserves: Sequence[StressReserve], how: FatigueAssessment) -> list[Margin]:
    """Return the margins of a spectrum on stress: by what factor all stresses may grow until the goal is missed.

    The value of each row is 1, the stresses as they are, and the allowable is the factor.
    """
    return [
        Margin(
            f"{edge_body(one.problem, one.body)}: {criterion_title(one.criterion)}, factor on all stresses",
            "ratio", 1.0, one.factor, one.largest, _remark(one, how), one.loads, "fatigue",
            owner_of(one.problem, one.body), part_of(one.problem, owner_of(one.problem, one.body)),
        )
        for one in reserves
    ]  # fmt: skip


def goal_words(goal: Goal, how: FatigueAssessment) -> str:
    """Return the goal of a reserve in words."""
    if goal.kind == "life":
        return f"for a life of {goal.number:.6g} {how.passes}"
    if goal.kind == "endurance":
        return f"for endurance, the largest cycle at the knee of {goal.number:.6g} cycles; no life is asked for"
    return f"for {'one spectrum' if how.over == 'history' else 'one cycle'}; no life is asked for"


def _remark(one: StressReserve, how: FatigueAssessment) -> str:
    words = f"{goal_words(one.goal, how)}{how.reliability_words}"
    if not one.is_finite:
        return f"{words}: no stress is too large"
    ends = f"by load points {point_name(one.start)} and {point_name(one.stop)}"
    return f"{words}; {point_words(one.problem, one.body, one.theta, one.depth)}, {ends}"


def strength_margins(how: StrengthAssessment, state: State, strength: JointStrength) -> list[Margin]:
    """Return the margin of the first ply in the worst state. The value is 1, and the allowable the strength ratio."""
    ratio = strength.least_ratio
    place = f"at {from_bottom(strength.angle):z.1f} deg, ply of {strength.ply_angle:g} deg by {strength.ply_mode}"
    remark = place if math.isfinite(ratio) else "no stress"
    point, subject = load_point(state), f"plate: first ply by {how.criterion}, factor on the stresses"
    return [Margin(subject, "ratio", 1.0, ratio, point, remark, state.load, "ply", "plate")]

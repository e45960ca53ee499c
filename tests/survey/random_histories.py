"""Solve random histories: does the path solver return a wrong state, raise an error, or hang?

:func:`examine` solves a case of a class of :mod:`tests.survey.histories`. It recomputes the contact conditions of every
state without the matrices of the solver, see :mod:`tests.survey.conditions`. A dense examination has many states inside
each step, and checks the direction of slip and the dissipation too.
"""

from __future__ import annotations

import collections
import math
import signal
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from fastpin.errors import FastpinError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.storage.wear_files import wear
from fastpin.wear_lives.wear_result import WearResult
from tests.survey.conditions import TOLERANCE, check_direction, check_dissipation, check_states, floats
from tests.survey.histories import RandomCase, generate
from tests.survey.joint_conditions import check_joint

BETWEEN = 39
"""States inside each step of a dense examination."""

TOLERANCES = collections.defaultdict(
    lambda: TOLERANCE,
    {"balance": 0.05, "dissipated": 0.02, "dissipation >= 0": 1e-6, "dissipation in the seat >= 0": 1e-3},
)
"""Largest violations that are not reported. The energies are sums over the nodes: second order in their distance.

The first nodes of a contact get their slip from a fit, so their dissipation may be slightly negative. One increment
loads the seat of a loose bush with them.
"""

LONGEST = 60
"""Time after which a case counts as hanging, s."""


class HangError(BaseException):
    """A case took too long. No solver may catch it."""


@dataclass
class Outcome:
    """The outcome of one case.

    Attributes
    ----------
    ending : str
        "solved", "spins", "too fast", "hang", or the name of the error.
    message : str
        The message of the error.
    states, nodes : int
        Number of states that were checked, and of nodes.
    jumps : float
        Snaps of the pin.
    worst : dict of str to (float, int)
        Largest violation of each condition, and the state where it is.
    """

    kind: str
    seed: int
    ending: str = "solved"
    message: str = ""
    states: int = 0
    nodes: int = 0
    jumps: float = 0.0
    worst: dict[str, tuple[float, int]] = field(default_factory=dict)

    def violations(self) -> dict[str, tuple[float, int]]:
        """The violations beyond their tolerances."""
        return {name: found for name, found in self.worst.items() if not found[0] <= TOLERANCES[name]}


def ending_of(error: FastpinError) -> str:
    """The name of an error; "spins" where a moment acts that may exceed the friction, "too fast" for wear."""
    if "wear is too fast" in str(error):
        return "too fast"
    return "spins" if "spins" in str(error) and "M = " in str(error) else type(error).__name__


def examine(kind: str, seed: int, dense: bool = False) -> Outcome:
    """Solve a case and check all its states."""
    case, outcome = generate(kind, seed), Outcome(kind, seed)
    result: Result | WearResult | None = None
    try:
        with_stops = {"between": BETWEEN} if dense else {}
        if case.wears:
            result = wear(case.problem, case.history, **case.options)
        else:
            result = solve(case.problem, case.history, **case.options, **with_stops)
    except FastpinError as error:
        outcome.ending, outcome.message = ending_of(error), str(error)
        result = getattr(error, "result", None)
    if isinstance(result, WearResult):
        _check_wear(outcome, result)
    elif result is not None and result.states:
        _check(outcome, case, result, dense)
    return outcome


def _check_wear(outcome: Outcome, result: WearResult) -> None:
    """Note the largest violation of each condition at the states on worn profiles.

    The sums of work and dissipation leave out the material that has gone.
    """
    outcome.nodes, outcome.jumps = result.grid.size, result.statistics.get("jumps", 0.0)
    pairs = [(state, each.gap_growth) for each in result for state in each.states]
    outcome.states = len(pairs)
    if not pairs:
        return
    states, grown = [list(column) for column in zip(*pairs, strict=True)]
    found = check_states(states, grown)
    if floats(states, grown):  # a new contact between two chosen cycles has a slip of its own
        parts = [check_states(each.states, [each.gap_growth] * len(each.states)) for each in result]
        for conditions, alone in zip(found, (one for part in parts for one in part), strict=True):
            conditions.pop("slip", None)
            conditions |= {name: value for name, value in alone.items() if name == "slip"}
    for place, conditions in enumerate(found):
        for name, value in conditions.items():
            if name != "balance" and (name not in outcome.worst or not value <= outcome.worst[name][0]):
                outcome.worst[name] = value, place


def _check(outcome: Outcome, case: RandomCase, result: Result, dense: bool) -> None:
    """Note the largest violation of each condition."""
    outcome.states, outcome.nodes, outcome.jumps = len(result), result.grid.size, result.statistics["jumps"]
    check = check_states if case.problem.seat is None else check_joint
    for place, conditions in enumerate(check(result.states)):
        for name, value in conditions.items():
            if name not in outcome.worst or not value <= outcome.worst[name][0]:
                outcome.worst[name] = value, place
    if outcome.jumps:
        outcome.worst.pop("balance", None)  # a snap sets energy free
    elif "balance" in outcome.violations():
        outcome.worst["balance"] = _balance_on_finer_nodes(case), outcome.worst["balance"][1]
    if dense and outcome.ending == "solved":
        outcome.worst["direction"] = check_direction(result)
        if not outcome.jumps:
            outcome.worst["dissipated"] = check_dissipation(result), len(result) - 1


def _balance_on_finer_nodes(case: RandomCase) -> float:
    """Violation of the energy balance with twice the nodes: a sum that nearly cancels may be far off on coarse ones."""
    try:
        result = solve(case.problem, case.history, **{**case.options, "nodes": 2 * case.options["nodes"]})
    except FastpinError:
        return math.nan
    check = check_states if case.problem.seat is None else check_joint
    return max(conditions["balance"] for conditions in check(result.states))


def within_time(job: Callable[..., Any], *arguments: Any) -> Any | None:
    """What the job returns, or None if it takes longer than :data:`LONGEST`."""

    def stop(*_: object) -> None:
        raise HangError

    signal.signal(signal.SIGALRM, stop)
    signal.alarm(LONGEST)
    try:
        return job(*arguments)
    except HangError:
        return None
    finally:
        signal.alarm(0)


def examine_in_time(kind: str, seed: int, dense: bool = False) -> Outcome:
    """As :func:`examine`, with the ending "hang" after a long time."""
    return within_time(examine, kind, seed, dense) or Outcome(kind, seed, "hang")

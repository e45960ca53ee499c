"""Warnings about von Mises stresses above the yield strengths of the bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from fastpin.errors import InputWarning
from fastpin.model.doubts import are_given, are_loads_plausible, yield_doubt
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.states.extremes import Found, KeptStates, yield_extremes
from fastpin.states.state import State
from fastpin.states.yielding import PREFIX, place_words, von_mises_peak, yielding_owners


def yield_doubts(
    problem: Problem,
    history: LoadHistory,
    extremes: Callable[[], Found],
    read: Callable[[Sequence[int]], list[State]],
) -> list[InputWarning]:
    """Return a warning for each body whose largest von Mises stress exceeds its yield strength.

    A warning names the largest stress of all states, with its place. A body without a known yield strength has none.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        If its loads are in doubt, the stresses are not.
    extremes : callable
        ``extremes()`` gives extremes of all states, among them those of :func:`fastpin.states.extremes.yield_extremes`.
        It is called only if a strength is known.
    read : callable
        ``read(places)`` gives the states at these places.
    """
    owners = yielding_owners(problem)
    if not owners or are_given() or not are_loads_plausible(problem, history):
        return []
    found, doubts = extremes(), []
    for owner in owners:
        extreme = found.get((PREFIX + owner, "largest"))
        if extreme is not None:
            peak = von_mises_peak(read([extreme.place])[0], owner)
            where = f"{place_words(problem, peak)}, load point {extreme.load_point:.5g}"
            doubts.append(yield_doubt(problem, peak.circle.edge, peak.value, where))
    return [doubt for doubt in doubts if doubt is not None]


def yield_doubts_of(problem: Problem, history: LoadHistory, states: Sequence[State]) -> list[InputWarning]:
    """Return the warnings of :func:`yield_doubts` for states in memory."""
    if not states:
        return []
    kept = KeptStates(states)
    return yield_doubts(problem, history, lambda: yield_extremes(kept), kept.read)

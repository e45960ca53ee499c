"""Whether a bush that slips in its seat walks: whether it turns on with each cycle, or rests.

A node of the seat that sticks throughout the cycle holds the bush; docs/bush.md has the evidence. Between the kept
states nothing is known, unless slip sums are counted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputWarning
from fastpin.model.doubts import are_given
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.states.choice import last_cycle_states
from fastpin.states.cycles import Cycle
from fastpin.states.load_cycle import LoadCycle, NodeBehaviour
from fastpin.states.state import State

LEAST_WALK = 1e-3
"""Least turn of a cycle, in parts of the largest rotation of the bush within it, that is no error of the nodes."""


class Walk(NamedTuple):
    """How a bush turns in its seat over a cycle.

    Attributes
    ----------
    turn : float
        Rotation of the bush from the beginning of the cycle to its end, rad.
    swing : float
        Largest rotation less the smallest one within the cycle, rad.
    sticking : float
        The part of the seat that sticks at all kept states of the cycle.
    """

    turn: float
    swing: float
    sticking: float

    @classmethod
    def of(cls, states: Sequence[State]) -> Walk | None:
        """The walk over the states of a cycle. None without a bush that slips, or with fewer than two states."""
        seats = tuple(state.seat for state in states if state.seat is not None and state.problem.bush_slips)
        if len(seats) < 2:
            return None
        rotations = np.array([seat.rotation for seat in seats])
        sticks = LoadCycle(seats).behaviour == NodeBehaviour.STICKS
        part = float(seats[0].grid.weights @ sticks) / (2.0 * math.pi)
        return cls(float(rotations[-1] - rotations[0]), float(np.ptp(rotations)), part)

    @property
    def goes_on(self) -> bool:
        """Whether the bush walks: no node sticks throughout, and the cycle has turned it."""
        return self.sticking == 0.0 and abs(self.turn) > LEAST_WALK * self.swing

    def words(self, problem: Problem) -> str:
        """What the bush of a joint does, with its turn in a cycle."""
        if self.goes_on:
            turn = units(problem)["rotation"].text(abs(self.turn), 3)
            cycles = 2.0 * math.pi / abs(self.turn)
            return f"it walks {turn} a cycle, {cycles:,.4g} cycles for a full turn"
        if self.sticking:
            return f"it rests: {100.0 * self.sticking:.3g} % of its seat sticks throughout the last cycle"
        return "it slips to and fro: no part of its seat sticks throughout the last cycle"


def walk_words(states: Sequence[State]) -> str:
    """What a bush does in its seat over the states of a cycle; empty if that is not known."""
    walk = Walk.of(states)
    return "" if walk is None else walk.words(states[0].problem)


def walk_doubts(states: Sequence[State], cycles: Sequence[Cycle]) -> list[InputWarning]:
    """Return a warning if the bush walks over the last cycle. A study has none: its plan asks for the walk."""
    if are_given() or not states or states[-1].seat is None:
        return []
    walk = Walk.of(last_cycle_states(states, cycles))
    return [InputWarning("bush", walk.words(states[-1].problem))] if walk is not None and walk.goes_on else []

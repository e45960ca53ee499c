"""The crack of a case: the states under which it grows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from fastpin import cracks, damage
from fastpin.errors import InputError
from fastpin.model.crack import CrackGrowth
from fastpin.model.history import LoadHistory
from fastpin.states.choice import missing_corners, span_of
from fastpin.states.cycles import Cycle
from fastpin.states.state import State

LEAST_CORNERS = 3
"""Least corners of a history without cycles that counts as a spectrum unasked, as for fatigue."""


class CrackStops(NamedTuple):
    """One pass of the loads under which a crack grows.

    Attributes
    ----------
    states : list of State
        In the order of time.
    is_spectrum : bool
        Whether they are a whole history, else the last cycle.
    """

    states: list[State]
    is_spectrum: bool

    @classmethod
    def of(
        cls,
        corners: int,
        cycles: Sequence[Cycle],
        read: Callable[[int, int], Sequence[State]],
        spectrum: bool = False,
    ) -> CrackStops:
        """Choose the last cycle that has ended, or else the whole history.

        Parameters
        ----------
        corners : int
            Number of corners of the history.
        cycles : sequence of Cycle
            The cycles that have ended.
        read : callable
            ``read(first, last)`` gives the kept states from one corner to another, or more of them.
        spectrum : bool
            Whether the whole history is asked for.

        Raises
        ------
        InputError
            If the history has neither a cycle nor three corners, or the state at a corner was not kept.
        """
        if cycles and not spectrum:
            return cls(damage.cycle_states(read(*span_of(cycles[-1])), cycles[-1]), False)
        if corners < LEAST_CORNERS and not spectrum:
            words = "has no cycle that has ended, and less than three corners; add repeat = 2 to a [[load]] block"
            raise InputError("history", words)
        states = list(read(0, corners))
        if len(states) < 2:
            raise InputError("states", "a spectrum needs at least two kept states")
        if missing_corners(states, 1, corners):
            raise InputError("states", 'not all corners of the history are kept; keep = "all" keeps them')
        return cls(states, True)

    def growth(self, how: CrackGrowth, progress: Callable[[float, float], None] | None = None) -> cracks.Growth:
        """Follow a crack under this pass, again and again. See :func:`fastpin.cracks.planned_growth`."""
        return cracks.planned_growth(self.states, how, self.is_spectrum, progress)


def passes_of(history: LoadHistory) -> str:
    """Return the name of the passes that a crack counts under a whole history: "cycles" or "spectra"."""
    return "cycles" if history.longest_cycle else "spectra"

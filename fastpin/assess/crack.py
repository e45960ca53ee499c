"""The crack of a case: the states under which it grows, and its outputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from fastpin import cracks, damage
from fastpin.assess.kept import kept
from fastpin.assess.outputs import Output
from fastpin.cracks.fates import CRACK_FATES
from fastpin.errors import InputError
from fastpin.model.crack import CrackGrowth
from fastpin.model.doubts import doubts_given
from fastpin.model.growth import Nasgro, Walker, law_entries
from fastpin.model.history import LoadHistory
from fastpin.model.points import EDGES
from fastpin.states.choice import missing_corners, span_of
from fastpin.states.cycles import Cycle
from fastpin.states.state import State

GROWTH = (
    Output("angle_of_mouth", "angle", lambda found: found.crack.theta),
    Output("direction", "width", lambda found: found.crack.angle),
    Output("body", "text", lambda found: found.crack.body, allowed=EDGES),
    Output(
        "law", "table", lambda found: law_entries(found.law) if isinstance(found.law, Walker | Nasgro) else None
    ),
    Output("repeated", "text", lambda found: found.per, allowed=("cycle", "spectrum")),
    Output("fate", "class", lambda found: found.fate, classes=CRACK_FATES),
    Output("life", "life", lambda found: found.life, "cycles or spectra; null: no end", optional=True),
    Output(
        "error", "", lambda found: found.error, "numerical, in parts of the life or of the arrest; null: unknown",
        optional=True,
    ),
    Output("first", "length", lambda found: float(found.length[0]), optional=True),
    Output("last", "length", lambda found: float(found.length[-1]), optional=True),
    Output("arrest", "length", lambda found: found.arrest, optional=True),
    Output("fracture", "length", lambda found: found.fracture, optional=True),
    Output("words", "text", lambda found: found.words),
    Output("doubts", "texts", lambda found: [str(doubt) for doubt in found.doubts]),
)  # fmt: skip
"""Outputs of a :class:`fastpin.cracks.Growth`."""

LENGTHS = (
    Output("length", "length", lambda found: found.length),
    Output("K_max", "stress intensity", lambda found: found.K_max, heading="K_I largest"),
    Output("K_min", "stress intensity", lambda found: found.K_min, heading="K_I smallest", short="smallest"),
    Output("K_II", "stress intensity", lambda found: found.K_II, heading="K_II"),
    Output("delta_K", "stress intensity", lambda found: found.delta_K, heading="range"),
    Output("threshold", "stress intensity", lambda found: found.threshold),
    Output("rate", "crack growth", lambda found: found.rate, short="growth"),
    Output("cycles", "", lambda found: found.cycles),
)
"""Outputs at each length: columns of CSV, JSON and the table of ``fastpin crack``."""


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
        if corners < 3 and not spectrum:  # as for fatigue
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


@kept
def grown(result: Any, how: CrackGrowth) -> cracks.Growth:
    """Return the growth of a crack under a result. It is kept while the result lives.

    Raises
    ------
    InputError
        If the result has neither a cycle nor a spectrum, or the crack can't be followed.
    """
    stops = CrackStops.of(len(result.history), result.cycles, lambda first, last: result)
    with doubts_given():
        return stops.growth(how)

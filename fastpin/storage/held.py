"""What is read of a result on demand: its states, extremes and residuals. Here it is in memory, without h5py."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from fastpin.errors import InputWarning
from fastpin.model.checks import whole_number
from fastpin.model.doubts import pressure_doubts
from fastpin.solver.result import Result
from fastpin.states import extremes, walking
from fastpin.states.choice import span_of
from fastpin.states.extremes import Found, KeptStates
from fastpin.states.margins import Margin, static_margins
from fastpin.states.quantities import load_point
from fastpin.states.state import State


class Held:
    """A result in memory.

    Attributes
    ----------
    result : Result
        Perhaps without its states.
    path : Path or None
        Its file.
    source : str
        A key of :data:`fastpin.figures.kinds.SOURCES`.
    """

    source = "result"

    def __init__(self, result: Result, path: Path | None = None) -> None:
        self.result, self.path = result, path

    @cached_property
    def points(self) -> np.ndarray:
        """Load points of all states, shape (states,)."""
        return np.array([load_point(state) for state in self.result])

    @cached_property
    def extremes(self) -> Found:
        """The extremes of all states that texts and figures show."""
        return extremes.marked_extremes(KeptStates(self.result.states)) if self.result.states else Found()

    @cached_property
    def marks(self) -> dict[int, str]:
        """The places of the extremes of all states, with words on each."""
        return extremes.marked_places(self.extremes)

    @cached_property
    def peaks(self) -> list[State]:
        """The states of the extremes, at the places of the :attr:`marks`."""
        return self.read(list(self.marks))

    @cached_property
    def static_margins(self) -> list[Margin]:
        """The margins of the strengths and of the bush over all states."""
        at = dict(zip(self.marks, self.peaks, strict=True))
        return static_margins(self.result.problem, self.extremes, lambda places: [at[place] for place in places])

    @cached_property
    def residuals(self) -> dict[str, float]:
        """The largest residual of each kind over all states."""
        found: dict[str, float] = {}
        for state in self.result:
            found = {name: max(value, found.get(name, 0.0)) for name, value in state.residuals.items()}
        return found

    @cached_property
    def pressure(self) -> float:
        """The largest pressure at a node over all states, Pa."""
        return max((float(state.pressure.max()) for state in self.result), default=0.0)

    @property
    def span(self) -> tuple[int, int] | None:
        """The corners between which the slip of a pin in a joint is shown: its history itself tells no cycle."""
        return None

    def read(self, places: Sequence[int]) -> list[State]:
        """Return the states at these places, in increasing order."""
        return [self.result.states[place] for place in places]

    def between(self, first: int, last: int) -> list[State]:
        """Return the states from one corner to another."""
        first, last = whole_number("first", first, 0), whole_number("last", last, 0)
        return self.read(np.flatnonzero((self.points >= first) & (self.points <= last)).tolist())

    def part(self, first: int, last: int) -> Result:
        """Return the result with the states from one corner to another only."""
        return replace(self.result, states=self.between(first, last))

    def whole(self) -> Result:
        """Return the result with all its states."""
        return self.result

    def doubts(self) -> Iterator[InputWarning]:
        """Yield warnings of doubtful pressures and von Mises stresses in all states, and of a bush that walks."""
        problem, history = self.result.problem, self.result.history
        yield from pressure_doubts(problem, history, [np.array([self.pressure])])
        if self.points.size:
            yield from extremes.yield_doubts(problem, history, self._yield_extremes, self.read)
        if problem.seat is not None and (cycles := self.result.cycles):
            yield from walking.walk_doubts(self.between(*span_of(cycles[-1])), cycles)

    def _yield_extremes(self) -> Found:
        """The extremes on which warnings of von Mises stresses depend."""
        return extremes.yield_extremes(KeptStates(self.result.states))

"""A pin in a plate of a joint as a result of one pin, for figures and pages. Its states are read on demand."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np

from fastpin.errors import InputError
from fastpin.joints.read import JointFile
from fastpin.joints.result import JointResult
from fastpin.model.case import Case
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.options import SolveOptions
from fastpin.solver.result import Result
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import Found, marked_extremes
from fastpin.states.state import State
from fastpin.storage.held import Held

ROUNDED = 1e-9
"""A load of the hole that is never larger is rounding, in parts of the largest force, or of it times the radius."""


class HeldHole(Held):
    """A pin in a plate of a joint. Loads P, Q and M of its history are those that the pin passes on to this plate.

    Parameters
    ----------
    case : JointFile
    joined : JointResult
        With a state at least.
    pin, plate : str
        Of a plate with slices, one of them.
    whole : bool
        Whether the states know the whole plate, see :meth:`fastpin.joints.JointResult.of`.
    path : Path, optional

    Attributes
    ----------
    case : Case

    Raises
    ------
    InputError
        If a name is unknown, there is no state, or the whole of a plate without an outline is asked for.
    """

    source = "hole"

    def __init__(
        self, case: JointFile, joined: JointResult, pin: str, plate: str, whole: bool = False, path: Path | None = None
    ) -> None:
        place = joined.joint.place(pin, plate)
        if not len(joined):
            raise InputError("result", "has no state")
        self._kept, self._joined = joined.states.section(place), joined
        self._known = joined.knowing_plate(pin, plate) if whole else None
        loads = np.concatenate([block.loads for block in self._kept.blocks()])
        sizes = dict(zip(LOADS, np.abs(loads).max(axis=0).tolist(), strict=True))
        force = max(sizes["P"], sizes["Q"])
        least = {"P": force, "Q": force, "M": force * joined.joint.radius}
        self._nothing = {name for name, size in sizes.items() if size <= ROUNDED * least.get(name, 0.0)}
        acting = [name not in self._nothing for name in LOADS]
        history = LoadHistory.from_array(np.where(acting, loads, np.nan))
        problem, complete = self._kept.problem, len(joined) == len(case.corners)
        super().__init__(Result([], problem, history, self._kept.grid, "path", {}, complete), path)
        self.case = Case(problem, history, SolveOptions(nodes=joined.nodes), case.title, fatigue=case.fatigue)

    @cached_property
    def points(self) -> np.ndarray:
        """Load points of all states, shape (states,)."""
        return self._kept.points

    @cached_property
    def extremes(self) -> Found:
        """The extremes of all states near the hole that texts and figures show."""
        return marked_extremes(self._kept)

    @cached_property
    def residuals(self) -> dict[str, float]:
        """The largest residual of each kind over all states, of the whole joint."""
        states = self._joined.states.bare
        return {name: max(state.residuals[name] for state in states) for name in states[0].residuals}

    @cached_property
    def pressure(self) -> float:
        """The largest pressure at a node over all states, Pa."""
        return max(float(block.pressure.max()) for block in self._kept.blocks())

    @property
    def span(self) -> tuple[int, int] | None:
        """The corners between which the last cycle of the joint lies, or its whole history; None of one corner."""
        places = self._joined.last_cycle_places or range(self.points.size)
        return (places[0] + 1, places[-1] + 1) if len(places) > 1 else None

    def read(self, places: Sequence[int]) -> list[State]:
        """Return the states at these places, in increasing order."""
        none = dict.fromkeys(self._nothing, 0.0)
        found = [replace(state, load=state.load | none) for state in self._kept.read(places)]
        return found if self._known is None else [self._known(state) for state in found]

    def part(self, first: int, last: int) -> Result:
        """Return the result with the states from one corner to another only.

        They are of one problem: what the other pins do to the hole is left out. Slip and tractions do not need it.
        """
        states = [replace(state, problem=self._kept.problem) for state in self.between(first, last)]
        return replace(self.result, states=states)

    def whole(self) -> Result:
        """Return the result with all its states, and with the last cycle of the joint. Its changes are not known."""
        places, nan = self._joined.last_cycle_places, math.nan
        cycles = (Cycle(places[-1], len(places) - 1, 1, nan, nan, nan, nan, True),) if places else ()
        return replace(self.result, states=self.read(range(self.points.size)), cycles=cycles)

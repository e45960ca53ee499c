"""A place in a session, to which the session can go back: a problem, the loads so far, and the contact there.

The loads of many places share their memory. :class:`Undoing` remembers places. :func:`changed_problem` leads to another
problem.
"""

from __future__ import annotations

from collections import deque
from collections.abc import MutableSequence, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, TypeVar

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, whole_number
from fastpin.model.grid import Grid
from fastpin.model.history import MAX_CORNERS, LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest
from fastpin.solver.result import Restart
from fastpin.states.state import State

ROWS = 1024
"""Loads in one block of :class:`Loads`."""

PlaceT = TypeVar("PlaceT", bound=Any)
StateT = TypeVar("StateT")


class Loads:
    """The loads of a session so far. Adding one gives another object, and leaves this one as it was.

    A load takes 80 bytes. Later objects share the loads of earlier ones.

    Attributes
    ----------
    count : int
        Number of loads.
    """

    def __init__(self, full: tuple[np.ndarray, ...] = (), last: Sequence[np.ndarray] = (), count: int = 0) -> None:
        self._full, self._last, self.count = full, last, count

    def with_load(self, given: np.ndarray) -> Loads:
        """These loads and one more, shape (loads,), SI; NaN keeps the last value."""
        here, last = self.count % ROWS, self._last
        if not isinstance(last, list) or len(last) != here:  # other loads have followed these before
            last = list(last[:here])
        last.append(given)
        if here + 1 < ROWS:
            return Loads(self._full, last, self.count + 1)
        return Loads((*self._full, np.array(last)), (), self.count + 1)

    def rows(self) -> np.ndarray:
        """The loads, shape (count, loads), SI; NaN keeps the last value. There is at least one."""
        return np.vstack([*self._full, *self._last[: self.count % ROWS]])

    def history(self) -> LoadHistory:
        """The loads as a history. There is at least one."""
        return LoadHistory.from_array(self.rows())

    def __getstate__(self) -> tuple[Any, ...]:
        return self._full, list(self._last[: self.count % ROWS]), self.count

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._full, self._last, self.count = state


@dataclass(frozen=True, eq=False)
class Place:
    """A place in a session. It is never changed.

    Attributes
    ----------
    problem : Problem
    loads : Loads
        The loads from the start to here.
    grid : Grid or None
        None before the first load.
    force : float
        The reference force, N/m; 0 without a grid.
    restart : Restart or None
        None under no load.
    state : State or None
        None under no load.
    followed : bool
        Whether a change of the friction was followed on the way. Then the loads alone do not lead here.
    """

    problem: Problem
    loads: Loads
    grid: Grid | None = None
    force: float = 0.0
    restart: Restart | None = None
    state: State | None = None
    followed: bool = False


class Undoing(Generic[PlaceT, StateT]):
    """What is at a place, and remembers the places before: the base of sessions.

    Parameters
    ----------
    here : place
        Its ``state`` is None under no load.
    undo : int or None
        Number of places that are remembered; None means all.
    """

    def __init__(self, here: PlaceT, undo: int | None) -> None:
        self._here = here
        self._undo = deque[PlaceT](maxlen=None if undo is None else whole_number("undo", undo, 0, MAX_CORNERS))
        self._redo: list[PlaceT] = []

    @property
    def state(self) -> StateT | None:
        """The present state; None before the first load."""
        state: StateT | None = self._here.state
        return state

    @property
    def undos(self) -> int:
        """Number of places to which :meth:`undo` can go back."""
        return len(self._undo)

    @property
    def redos(self) -> int:
        """Number of places to which :meth:`redo` can go forward."""
        return len(self._redo)

    def undo(self, times: int = 1) -> StateT | None:
        """Go back to the place before the last load or change, and return its state; `times` times.

        Raises
        ------
        InputError
            If so many places are not remembered.
        """
        if whole_number("times", times, 1) > len(self._undo):
            raise InputError("times", f"only {len(self._undo)} earlier places are remembered, not {as_toml(times)}")
        return self._move(self._undo, self._redo, times)

    def redo(self, times: int = 1) -> StateT | None:
        """Take back so many calls of :meth:`undo`, and return the state. A new load or change forgets them.

        Raises
        ------
        InputError
            If there were fewer.
        """
        if whole_number("times", times, 1) > len(self._redo):
            raise InputError("times", f"only {len(self._redo)} steps were undone, not {as_toml(times)}")
        return self._move(self._redo, self._undo, times)

    def _move(self, places: MutableSequence[PlaceT], left: MutableSequence[PlaceT], times: int) -> StateT | None:
        """Go to the last of some places, `times` times, and add each place that is left to `left`."""
        for _ in range(times):
            left.append(self._here)
            self._here = places.pop()
        return self.state

    def _leave_for(self, place: PlaceT) -> None:
        """Remember the present place, and go to another one."""
        self._undo.append(self._here)
        self._redo.clear()
        self._here = place

    def _begin_at(self, place: PlaceT) -> None:
        """Be at a place, and forget all others."""
        self._here = place
        self._undo.clear()
        self._redo.clear()

    def __getstate__(self) -> dict[str, Any]:
        return {"here": self._here, "undo": self._undo.copy(), "redo": self._redo.copy()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            setattr(self, f"_{name}", value)


def changed_problem(problem: Problem, changes: dict[str, Any]) -> Problem:
    """The problem with some fields changed. A dimensionless one keeps R = F = beta* = 1.

    Raises
    ------
    InputError
        If there is no such field, or its value can't be used.
    """
    names = [field.name for field in fields(Problem) if field.name not in ("dimensionless", "thickness", "unit_system")]
    if not changes:
        raise InputError("change", f"give at least one field of the problem: {', '.join(names)}")
    for name in changes:
        if name not in names:
            raise InputError(name, f"is no field of a problem; there are {', '.join(names)}{closest(name, names)}")
    if not problem.dimensionless or not changes.keys() & {"pair", "plate_body", "hole_radius"}:
        return replace(problem, **changes)
    if "hole_radius" in changes:
        raise InputError("hole_radius", "is the unit of a dimensionless problem")
    values = {name: getattr(problem, name) for name in names} | changes
    del values["hole_radius"]
    return Problem.from_load_parameter(load_parameter=values.pop("clearance"), **values)


def check_nodes(problem: Problem, options: SolveOptions, grid: Grid | None) -> None:
    """Raise :class:`InputError` if a bush slips, and its pin would start on an arc that can't grow."""
    if problem.seat is None:
        return
    reason = "must be the whole circle: in a session, the nodes in a bush that slips go all round"
    if grid is not None and not grid.closed:
        raise InputError("grid", reason)
    if options.arc is not None and not options.is_full_turn:
        raise InputError("arc", reason)

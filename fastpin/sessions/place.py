"""A place in a session, to which the session can go back: a problem, the loads so far, and the contact there.

The loads of many places share their memory. :func:`changed_problem` leads to another problem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest
from fastpin.solver.result import Restart
from fastpin.states.state import State

ROWS = 1024
"""Loads in one block of :class:`Loads`."""


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

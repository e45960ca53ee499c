"""The states in an HDF5 file, read: those of the pin, and of the seat of a bush that slips; and their extremes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import h5py
import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.errors import ReadingError
from fastpin.model import Grid, Problem
from fastpin.model.loads import named_load
from fastpin.reading.marks import Marks
from fastpin.reading.peaks import peak_slips
from fastpin.states import extremes
from fastpin.states.extremes import AT_ONCE, MARKS, READINGS, Extreme, Found, KeptStates
from fastpin.states.reading_bounds import NUMBERS, StateBlock
from fastpin.states.state import State
from fastpin.storage import hdf5, layout
from fastpin.storage.hdf5 import check_between, check_extremes, check_finite, dataset_of, text_of

LEAST_STORED = 500
"""Least states of a result whose extremes are stored. Those of fewer states are found in a second."""


def read_seat_grid(file: h5py.Group, problem: Problem, grid: Grid) -> Grid | None:
    """Read the nodes of the seat of a bush that slips, beside the nodes `grid` of the pin; None without one.

    Raises
    ------
    ValueError
        If the file has a seat that the problem has not, or other nodes than the seat has.
    """
    if (problem.seat is None) != ("seat" not in file["states"]):
        raise ValueError("states/seat does not fit the problem")
    if problem.seat is None:
        return None
    made = seat_grid(problem, grid)
    theta = dataset_of(file["states/seat"], "theta", float, ())
    if theta.shape != made.theta.shape or not np.array_equal(theta[()], made.theta):
        raise ValueError("states/seat/theta has other nodes than the seat")
    return made


def all_nodes(file: h5py.Group, problem: Problem, grid: Grid) -> int:
    """The number of nodes of pin and seat in a file; `grid` has those of the pin."""
    seat = read_seat_grid(file, problem, grid)
    return grid.size + (0 if seat is None else seat.size)


def read_states(
    file: h5py.File, problem: Problem, grid: Grid, picked: slice | Sequence[int], corners: int
) -> list[State]:
    """Read some states of a result, by their places in the file.

    `corners` is the number of corners of the history.

    Raises
    ------
    ValueError
        If the arrays don't fit each other or the nodes of `grid`, or a number is out of range or not finite.
    """
    group, seat = file["states"], read_seat_grid(file, problem, grid)
    layout.check_states(file, grid.size)
    rows = layout.read_rows(group, layout.state_rows(group), picked)
    check_finite("states/loads", rows["loads"])
    # A life of wear has the state before the first corner, too, if its first cycle begins there.
    check_between("states/step", rows["step"], -1 if "wear" in file else 0, corners - 1)
    check_between("states/fraction", rows["fraction"], 0.0, 1.0)
    loads = layout.all_loads(rows["loads"], 0.0)
    residuals = [zip(layout.RESIDUALS, row, strict=True) for row in rows["residuals"].tolist()]
    common = [
        {"load": named_load(load), "residuals": {name: value for name, value in pairs if not np.isnan(value)}}
        for load, pairs in zip(loads, residuals, strict=True)
    ]
    fields = [name for name in layout.node_fields(group) if name not in layout.BORDER_FIELDS]
    seats: list[State] | list[None] = [None] * len(common)
    if seat is not None and problem.seat is not None:
        own = {
            name.removeprefix(layout.SEATED[1]): array
            for name, array in rows.items()
            if name.startswith(layout.SEATED[1])
        }
        still = [{**each, "load": {**each["load"], "friction_change": 0.0}} for each in common]
        seats = _states_of({**rows, **own}, fields, still, (problem.seat, seat), "states/seat", [None] * len(common))
    return _states_of(rows, fields, common, (problem, grid), "states", seats)


def _states_of(
    rows: layout.Rows, fields: list[str], common: list[dict[str, Any]], where: tuple[Problem, Grid], label: str,
    seats: Sequence[State | None],
) -> list[State]:  # fmt: skip
    """The states of pin or seat from their checked rows. `common` are more fields of each, `where` problem and grid."""
    numbers = [name for name in layout.NUMBER_FIELDS if name in rows]
    for name in (*fields, *numbers):
        if name not in layout.EXTREMES:
            check_finite(f"{label}/{name}", rows[name])
    if layout.EXTREMES[0] in rows:
        lowest, highest = (rows[name] for name in layout.EXTREMES)
        check_extremes(f"{label}/slip_lowest", lowest, highest, np.isnan(lowest) & np.isnan(highest))
    check_between(f"{label}/status", rows["status"], *layout.STATUS_LIMITS)
    if "old_borders" in rows:
        check_finite(f"{label}/old_borders", rows["old_borders"])
        layout.check_old_borders(label, rows["old_borders"], rows["old_places"])
    states, (problem, grid) = [], where
    for k, (each, seat) in enumerate(zip(common, seats, strict=True)):
        per_node = {name: rows[name][k] for name in fields}
        for array in per_node.values():
            array.setflags(write=False)
        marks = Marks.stored(rows["old_borders"][k], rows["old_places"][k]) if "old_borders" in rows else None
        given = dict.fromkeys(layout.OF_WHOLE, math.nan) | {name: rows[name][k].item() for name in numbers}
        states.append(
            State(**per_node, **given, **each, theta=grid.theta, problem=problem, grid=grid, marks=marks, seat=seat)
        )
    return states


class StoredStates(KeptStates):
    """The states of an open file.

    Parameters
    ----------
    file : h5py.Group
        Also a group of a file with its states in ``states``.
    problem : Problem
    grid : Grid
    corners : int
        Corners of the history.
    """

    def __init__(self, file: h5py.Group, problem: Problem, grid: Grid, corners: int) -> None:
        self.problem, self.grid, self._file, self._corners = problem, grid, file, corners
        layout.check_states(file, grid.size)
        rows = layout.read_rows(file["states"], ("step", "fraction"), slice(None))
        self.points = rows["step"] + rows["fraction"]

    @classmethod
    def of(cls, file: h5py.File) -> StoredStates:
        """The states of a result."""
        return cls(file, layout.read_problem(file), layout.read_grid(file), len(layout.read_history(file)))

    def blocks(self) -> Iterator[StateBlock]:
        """Give the nodal values of all states, in order."""
        group = self._file["states"]
        marks = [name for name in layout.BORDER_FIELDS if name in layout.node_fields(group)]
        numbers = [name for name in NUMBERS if name in layout.number_fields(group)]
        names = ["pressure", "shear", "status", *marks, *numbers]
        seated = [
            f"{layout.SEATED[1]}{name}"
            for name in ("pressure", "shear", "status", "slip", *marks, *layout.SEAT_NUMBERS)
        ]
        seated = seated if "seat" in group else []
        for begin in range(0, self.points.size, AT_ONCE):
            rows = layout.read_rows(group, [*names, "loads", *seated], slice(begin, begin + AT_ONCE))
            for name in ("pressure", "shear", "loads", *numbers, *seated):
                if not name.endswith(tuple(layout.BORDER_FIELDS)):
                    check_finite(f"states/{name}", rows[name])
            loads = layout.all_loads(rows["loads"], 0.0)
            block = _block_of(rows, loads, marks)
            if seated:
                own = {name.removeprefix(layout.SEATED[1]): rows[name] for name in seated}
                block.numbers["seat_slip"] = peak_slips(own["slip"], own["status"], self.grid.theta)
                block = block._replace(seat=_block_of({**rows, **own}, loads, marks))
            yield block

    def read(self, places: Sequence[int]) -> list[State]:
        """Read the states at these places."""
        return read_states(self._file, self.problem, self.grid, places, self._corners)


def _block_of(rows: layout.Rows, loads: np.ndarray, marks: list[str]) -> StateBlock:
    """The nodal values of some states from their rows. `marks` are the names of the arrays of old borders."""
    more = tuple(rows[name] for name in marks), {name: rows[name] for name in NUMBERS if name in rows}
    return StateBlock(rows["pressure"], rows["shear"], rows["status"], loads, *more)


def read_extremes(file: h5py.File, find: Callable[[KeptStates], Found]) -> Found:
    """Return the extremes of all states of a file: those that it names, or those that are found."""
    kept = StoredStates.of(file)
    return _stored(file, kept) or find(kept)


def write_extremes(file: h5py.File, kept: KeptStates | None = None) -> None:
    """Write the extremes of a complete result with many states to its file. `kept` has the states of the file."""
    size = layout.count(file["states"])
    if size < LEAST_STORED:
        return
    try:
        found = extremes.marked_extremes(StoredStates.of(hdf5.Group(file)) if kept is None else kept)
    except ReadingError:  # who asks for the extremes is told
        return
    group = file.create_group("extremes")
    group.attrs["states"] = size
    group.attrs["names"] = [" ".join(pair) for pair in found]
    group["place"] = np.array([each.place for each in found.values()], dtype=np.int64)
    group["value"] = np.array([each.value for each in found.values()])


def _stored(file: hdf5.Group, kept: StoredStates) -> Found | None:
    """Return the extremes that a file names.

    It is None if the file names none, if states came later, or if a state has another value: then the file comes from
    a version that reads otherwise, or is damaged.
    """
    group = file.get("extremes")
    try:
        if group is None or int(group.attrs["states"]) != kept.points.size:
            return None
        names = [text_of(name) for name in group.attrs["names"]]
        places = dataset_of(group, "place", np.int64, ())[()].tolist()
        values = dataset_of(group, "value", float, ())[()].tolist()
        wanted = {" ".join(pair): pair for pair in MARKS if READINGS[pair[0]].exists(kept.problem)}
        if set(names) != set(wanted) or not all(0 <= place < kept.points.size for place in places):
            return None
        found = Found()
        for name, place, value in zip(names, places, values, strict=True):
            (state,), pair = kept.read([place]), wanted[name]
            read = READINGS[pair[0]].of(state)
            if not math.isclose(read, value, rel_tol=1e-9):  # more than rounding
                return None
            found[pair] = Extreme(read, place, float(kept.points[place]))
    except (KeyError, ValueError, TypeError):
        return None
    return found

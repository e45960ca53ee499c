"""The states in an HDF5 file, read: those of the pin, and of the seat of a bush that slips."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import h5py
import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.model import Grid, Problem
from fastpin.model.loads import named_load
from fastpin.reading.marks import Marks
from fastpin.states.state import State
from fastpin.storage import layout
from fastpin.storage.damage import check_between, check_extremes, check_finite, dataset_of


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
    for name in (*fields, *layout.NUMBER_FIELDS):
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
        numbers = {name: rows[name][k].item() for name in layout.NUMBER_FIELDS}
        states.append(
            State(**per_node, **numbers, **each, theta=grid.theta, problem=problem, grid=grid, marks=marks, seat=seat)
        )
    return states

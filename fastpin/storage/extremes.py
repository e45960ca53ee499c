"""The extremes of a stored result: found when a long history is written, or else when they are asked for.

A file names the states of its extremes. It may be anybody's: each value is read from its state again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import h5py
import numpy as np

from fastpin.errors import ReadingError
from fastpin.reading.peaks import peak_slips
from fastpin.states import extremes
from fastpin.states.extremes import AT_ONCE, MARKS, READINGS, Extreme, Found, Kept
from fastpin.states.reading_bounds import NUMBERS, StateBlock
from fastpin.states.state import State
from fastpin.storage import hdf5, layout
from fastpin.storage.damage import check_finite, dataset_of, text_of
from fastpin.storage.stored_states import read_states

LEAST_STORED = 500
"""Least states of a result whose extremes are stored. Those of fewer states are found in a second."""


class StoredStates:
    """The states of an open file, see :class:`fastpin.states.extremes.Kept`."""

    def __init__(self, file: h5py.File) -> None:
        self.problem, self.grid, self._file = layout.read_problem(file), layout.read_grid(file), file
        layout.check_states(file, self.grid.size)
        self._corners = len(layout.read_history(file))
        rows = layout.read_rows(file["states"], ("step", "fraction"), slice(None))
        self.points = rows["step"] + rows["fraction"]

    def blocks(self) -> Iterator[StateBlock]:
        """Give the nodal values of all states, in order."""
        group = self._file["states"]
        marks = [name for name in layout.BORDER_FIELDS if name in layout.node_fields(group)]
        names = ["pressure", "shear", "status", *marks, *NUMBERS]
        seated = [
            f"{layout.SEATED[1]}{name}"
            for name in ("pressure", "shear", "status", "slip", *marks, *layout.SEAT_NUMBERS)
        ]
        seated = seated if "seat" in group else []
        for begin in range(0, self.points.size, AT_ONCE):
            rows = layout.read_rows(group, [*names, "loads", *seated], slice(begin, begin + AT_ONCE))
            for name in ("pressure", "shear", "loads", *NUMBERS, *seated):
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
    more = tuple(rows[name] for name in marks), {name: rows[name] for name in NUMBERS}
    return StateBlock(rows["pressure"], rows["shear"], rows["status"], loads, *more)


def read_extremes(file: h5py.File, find: Callable[[Kept], Found] = extremes.marked_extremes) -> Found:
    """Return the extremes of all states of a file: those that it names, or those that are found."""
    kept = StoredStates(file)
    return _stored(file, kept) or find(kept)


def write_extremes(file: h5py.File, kept: Kept | None = None) -> None:
    """Write the extremes of a complete result with many states to its file. `kept` has the states of the file."""
    size = layout.count(file["states"])
    if size < LEAST_STORED:
        return
    try:
        found = extremes.marked_extremes(StoredStates(hdf5.Group(file)) if kept is None else kept)
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
        wanted = {" ".join(pair): pair for pair in MARKS if extremes.exists(kept.problem, pair[0])}
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

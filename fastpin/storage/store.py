"""Results in HDF5 files: all states with problem, history, grid, versions and units.

:func:`save` writes a result that is in memory. :func:`fastpin.record` writes the same kind of file during a run. The
layout of a file stands in layout.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any

import h5py
import numpy as np

from fastpin.errors import InputError
from fastpin.model import checks
from fastpin.model.case import checked_beside
from fastpin.model.history import LoadHistory
from fastpin.model.inputs import note_input
from fastpin.solver.result import Restart, Result, with_error_bars
from fastpin.solver.task import Task
from fastpin.states.extremes import KeptStates
from fastpin.states.state import State
from fastpin.storage import files, hdf5, journal, layout, packed
from fastpin.storage.file_objects import written_h5
from fastpin.storage.hdf5 import reading, text_of
from fastpin.storage.restarts import read_restart, write_restart
from fastpin.storage.stored_states import all_nodes, read_states, write_extremes

ALL = slice(None)
"""All states of a file."""

MOST_IN_MEMORY = 4_000_000
"""Most values of a node field in a file that is made in memory. Such a file has some 100 MB, and is there twice."""


def save(
    result: Result,
    path: str | Path,
    error: str | None = None,
    restart: bool = True,
    sections: Mapping[str, Any] = MappingProxyType({}),
) -> None:
    """Write a result to an HDF5 file, whole or not at all. The coarse result behind error bars is written too.

    Parameters
    ----------
    result : Result
    path : path
        An existing result is overwritten, but not an unfinished run. No other file is overwritten.
    error : str, optional
        Why the result is incomplete; stored in the file.
    restart : bool
        Also write the restart, from which another solution can continue.
    sections : mapping of str
        The sections beside the problem by name: how the result is judged by ``fastpin show`` and ``fastpin report``.

    Raises
    ------
    InputError
        If `path` must not be replaced: it holds an unfinished run or no result, or another run is writing to it. Also
        if a state of the result is on another grid, or the result is the seat of a bush.
    OutputError
        If the file can't be written.
    """
    checks.instance("result", result, Result, "a Result")
    checks.true_or_false("restart", restart)
    sections = checked_beside(result.problem, sections)
    if error is not None:
        checks.string("error", error)
    path = checks.file_path("path", path)
    files.check_writable(path, result=True)
    if is_unfinished(path):
        raise InputError(str(path), "holds an unfinished run; resume it, or remove it")
    if any(not np.array_equal(state.theta, result.grid.theta) for state in result):
        raise InputError("result", "all states must be on the grid of the result")
    if result.problem.pin_body.is_bush:
        raise InputError("result", "is the seat of a bush: save the result of its joint, which holds the seat")
    if path.exists() and not path.is_file():
        raise InputError(str(path), "must be an ordinary file")
    large = len(result) * result.grid.size > MOST_IN_MEMORY
    with files.replacing(path, result=True) as temporary, written_h5(temporary, large) as file:
        _write(file, result, error, sections)
        if result.complete and result.states:
            write_extremes(file, KeptStates(result.states))
        if restart and result.restart is not None:
            write_restart(file.create_group("restart/latest"), result.restart)
        if restart and result.coarse is not None and result.coarse.restart is not None:
            write_restart(file.create_group("coarse/restart/latest"), result.coarse.restart)


def _write(
    file: h5py.File | packed.PackedGroup, result: Result, error: str | None, sections: Mapping[str, Any]
) -> None:
    """Write a result into an empty file, all but its restart."""
    layout.write_head(file, result.problem, result.history, result.grid, layout.options_of(result))
    file["solver"].attrs.update(layout.beside_attributes(sections))
    file.attrs["complete"] = result.complete
    if error is not None:
        file.attrs["error"] = error
    layout.write_statistics(file, result.statistics)
    layout.append(file["states"], layout.rows_of(list(result)))
    layout.append(file["cycles"], layout.cycle_rows(result.cycles))
    if result.coarse is not None:
        coarse, group = result.coarse, file.create_group("coarse")
        layout.write_grid(group, coarse.problem, coarse.history, coarse.grid, layout.node_fields_of(coarse.states))
        layout.append(group["states"], layout.rows_of(list(coarse)))
        layout.append(group["cycles"], layout.cycle_rows(coarse.cycles))


def pack(
    result: Result, error: str | None, most: int, sections: Mapping[str, Any] = MappingProxyType({})
) -> bytes | None:
    """Return a result in few bytes, without its restart; see packed.py. None if it needs more than `most` bytes.

    `error` tells why the result is incomplete.
    """
    if len(result) * result.grid.size > most:  # a byte of status each, and more
        return None
    file = packed.PackedGroup()
    _write(file, result, error, sections)
    content = packed.to_bytes(file)
    return content if len(content) <= most else None


def unpack(content: bytes, path: Path) -> tuple[Result, dict[str, Any]]:
    """Return the result and the sections of :func:`pack`. `path` names them in errors.

    Raises
    ------
    InputError
        If the bytes are damaged.
    """
    with _opened(content, path) as file:
        return read_result(file, path, ALL)[0], layout.read_beside(file)


@contextmanager
def _opened(
    content: bytes, path: Path, *arguments: str, form: str | None = layout.FORMAT
) -> Iterator[packed.PackedGroup]:
    """Open a packed result for reading. `path` names it in errors."""
    with reading(path, *arguments):
        file = packed.from_bytes(content)
        layout.check_format(file, str(path), form)
        yield file


def load(path: str | Path, states: slice | Sequence[int] = ALL, after: int | None = None) -> Result:
    """Read a result. The run of the file may be finished, unfinished or killed.

    Parameters
    ----------
    path : path
    states : slice or sequence of int
        States to read, by their place in the file from 0; negative places count from the end. All states by default.
        Slip fields count since states before in the file. A state that does not follow on the one before loses them.
    after : int, optional
        Read the result only up to this corner, counted from 1. ``solve(..., start=result)`` then continues from the
        corner. If the corner has no restart in the file, the steps from the last restart before it are solved again.
        They give the same bits.

    Returns
    -------
    Result
        The states in `states`. Another solution can continue from a finished result.

    Raises
    ------
    InputError
        If the file can't be read, was cut short, or is no result of fastpin. Also if it has no such corner or state.
    """
    path = checks.file_path("path", path)
    if not isinstance(states, slice):
        states = checks.items("states", states, "a slice or whole numbers")
        if not all(map(checks.is_whole, states)):
            raise InputError("states", f"must be a slice or whole numbers, not {checks.as_toml(states)}")
    else:
        checks.places_of("states", states, 0)
    with open_result(path, "states", "after") as file:
        result, task = read_result(file, path, states, after)
    restart = result.restart
    if task is not None and restart is not None and restart.corner < len(task.history):
        # The file is closed by now: this may take long.
        result.restart = task.continue_from(None, restart, result.grid).restart()
    return result


def read_result(
    file: hdf5.Group | packed.PackedGroup, path: Path, states: slice | Sequence[int], after: int | None = None
) -> tuple[Result, Task | None]:
    """Read a result, see :func:`load`. The task leads from its restart to the corner `after`; None without one."""
    problem, grid, history = layout.read_problem(file), layout.read_grid(file), layout.read_history(file)
    complete, restart, task = bool(file.attrs["complete"]), None, None
    restarts = file.get("restart", {})
    found = layout.count(file["states"])
    if after is not None:
        task, restart = _way_to(path, file, history, after, all_nodes(file, problem, grid))
        history, complete = history[:after], True
        found = int(np.searchsorted(file["states/step"][()], after))
    elif "latest" in restarts and ("run" not in file.attrs or complete or "error" in file.attrs):
        restart = read_restart(restarts["latest"], all_nodes(file, problem, grid))
    if isinstance(states, slice):
        states = slice(*states.indices(found))
    elif any(not -found <= state < found for state in states):
        raise InputError("states", f"must be places from 0 to {found - 1}, not {checks.as_toml(states)}")
    else:
        states = [state % found for state in states]
    found_states = read_states(file, problem, grid, states, len(history))
    places = range(*states.indices(found)) if isinstance(states, slice) else states
    cycles = [cycle for cycle in layout.read_cycles(file) if after is None or cycle.corner < after]
    result = Result(
        states=_without_gaps(found_states, places),
        problem=problem,
        history=history,
        grid=grid,
        method=text_of(file["solver"].attrs["method"]),
        statistics=layout.read_statistics(file),
        complete=complete,
        restart=restart,
        cycles=tuple(cycles),
    )
    coarse = _read_coarse(file, result, places, found, after)
    return result if coarse is None else with_error_bars(result, coarse), task


def _read_coarse(
    file: hdf5.Group | packed.PackedGroup, fine: Result, places: Sequence[int], fine_states: int, after: int | None
) -> Result | None:
    """Read the states of a file that give the states `fine` their error bars, at the same places of the file.

    It is None without error bars, or if their run has not come as far. `fine_states` is the number of fine states.
    Up to a corner `after` there is no restart on the coarse grid.
    """
    group = file.get("coarse")
    if group is None or layout.count(group["states"]) < fine_states:
        return None
    grid, restart = layout.read_grid(group), None
    if after is None and "restart" in group:
        restart = read_restart(group["restart/latest"], all_nodes(group, fine.problem, grid))
    states = read_states(group, fine.problem, grid, list(places), len(fine.history))
    if any((one.step, one.fraction) != (two.step, two.fraction) for one, two in zip(fine, states, strict=True)):
        raise ValueError("coarse/states has other load points than states")
    cycles = tuple(cycle for cycle in layout.read_cycles(group) if after is None or cycle.corner < after)
    return replace(fine, states=_without_gaps(states, places), grid=grid, restart=restart, cycles=cycles)


def _without_gaps(states: list[State], places: Sequence[int]) -> list[State]:
    """The states of some places in a file. States that don't follow on the one before lose their slip fields."""
    follow = [True, *(before + 1 == place for before, place in pairwise(places))]
    lost: dict[str, Any] = dict.fromkeys(layout.SLIP_FIELDS)
    return [state if follows else replace(state, **lost) for state, follows in zip(states, follow, strict=False)]


def is_unfinished(path: Path) -> bool:
    """Whether a file holds an unfinished run."""
    try:
        with open_result(path, form=None) as file:
            return "run" in file.attrs and not file.attrs.get("complete", True)
    except InputError:
        return False


@contextmanager
def open_result(path: Path, *arguments: str, form: str | None = layout.FORMAT) -> Iterator[Any]:
    """Open a result for reading, as its last transaction left it.

    A result in the index of a sweep has the path of a file that is not there, see :func:`packed.packed_result`.
    `arguments` are names in errors of the block that don't come from the file. `form` is the format; None is any.

    Raises
    ------
    InputError
        If the file can't be read, was cut short, or is no result of fastpin. Also if the block finds damaged data.
    """
    content = packed.packed_result(path)
    if content is not None:
        with _opened(content, path, *arguments, form=form) as file:
            yield file
        return
    files.check_exists(path)
    note_input(path)
    with journal.open_h5(path) as h5, reading(path, *arguments):
        stored = hdf5.Group(h5)
        layout.check_format(stored, str(path), form)
        yield stored


def _way_to(path: Path, file: h5py.File, history: LoadHistory, after: int, nodes: int) -> tuple[Task, Restart]:
    """Return the task up to the corner `after`, and the latest restart at or before that corner."""
    checks.whole_number("after", after, 1)
    reached = max((int(group.attrs["corner"]) for group in file.get("restart", {}).values()), default=0)
    if layout.count(file["states"]):
        last = int(file["states/step"][-1]) + (1 if file["states/fraction"][-1] == 1.0 else 0)
        reached = max(reached, last)
    if not 1 <= after <= reached:
        raise InputError(
            "after", f"must be a corner from 1 to {reached}, not {checks.as_toml(after)}: {path} has no others"
        )
    stored = [group for group in file.get("restart", {}).values() if group.attrs["corner"] <= after]
    if "run" not in file.attrs or not stored:
        raise InputError("after", f"{path} was not written by a run: nothing can continue from it")
    start = read_restart(max(stored, key=lambda group: int(group.attrs["corner"])), nodes)
    task = stored_task(file)
    return replace(
        task, history=history[:after], options=task.options.changed(shortcut=True), save_after=frozenset()
    ), start


def stored_task(file: h5py.File) -> Task:
    """Read the task of the run of a file, on its grid."""
    save_after = frozenset(file["solver"].attrs["save_after"].tolist())
    problem, history, options = layout.read_problem(file), layout.read_history(file), layout.read_options(file)
    return Task(problem, history, options, layout.read_grid(file), save_after=save_after)

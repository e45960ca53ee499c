"""Results in HDF5 files: all states with problem, history, grid, versions and units. See layout.py for what is where.

:func:`fastpin.record.record` writes such files while a history is followed; here are results that are in memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from fastpin.checks import whole_number
from fastpin.errors import InputError
from fastpin.files import check_exists, check_writable, replacing
from fastpin.journal import check_free, open_h5, settled
from fastpin.keep import Keep
from fastpin.layout import (
    append,
    check_format,
    count,
    cycle_rows,
    plain,
    read_cycles,
    read_grid,
    read_history,
    read_problem,
    read_states,
    read_statistics,
    rows_of,
    write_head,
    write_statistics,
)
from fastpin.loading import LoadHistory
from fastpin.restart import read_restart, write_restart
from fastpin.run import Restart
from fastpin.solver import Task
from fastpin.state import Result

if TYPE_CHECKING:
    import xarray

ALL = slice(None)


def save(result: Result, path: str | Path, error: str | None = None, restart: bool = True) -> None:
    """Write a result to an HDF5 file, whole or not at all. Error bars are not kept.

    Parameters
    ----------
    result : Result
    path : path
        Overwritten if it exists, unless it holds an unfinished run.
    error : str, optional
        Why the result is incomplete, kept with it.
    restart : bool
        Also keep what is needed to go on from the result.

    Raises
    ------
    InputError
        If `path` can't be written.
    """
    check_writable(path)
    check_free(Path(path))
    if is_unfinished(Path(path)):
        raise InputError(str(path), "holds an unfinished run; resume it, or remove it")
    if any(not np.array_equal(state.theta, result.grid.theta) for state in result):
        raise InputError("result", "all states must be on the grid of the result")
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        write_head(file, result.problem, result.history, result.grid, {"method": result.method})
        file.attrs["complete"] = result.complete
        if error is not None:
            file.attrs["error"] = error
        write_statistics(file, result.statistics)
        append(file["states"], rows_of(list(result)))
        append(file["cycles"], cycle_rows(result.cycles))
        if restart and result.restart is not None:
            write_restart(file.create_group("restart/latest"), result.restart)


def load(path: str | Path, states: slice | Sequence[int] = ALL, after: int | None = None) -> Result:
    """Read a result, also of a run that is still being written or was killed.

    Parameters
    ----------
    path : path
    states : slice or sequence of int
        Which states to read, by their place in the file; all unless given.
    after : int, optional
        Only what was found up to this corner, counted from 1, to go on from there: ``solve(..., start=result)``. If it
        is not one of those that were saved, what lies between is solved again, which gives the same bits.

    Returns
    -------
    Result
        The states that were asked for. A finished result can be gone on from.

    Raises
    ------
    InputError
        If the file can't be read, was cut short, or is no result of fastpin; or has no such corner.
    """
    path = Path(path)
    with opened(path) as file:
        problem, grid, history = read_problem(file), read_grid(file), read_history(file)
        complete, restart, task = bool(file.attrs["complete"]), None, None
        restarts = file.get("restart", {})
        found = count(file["states"])
        if after is not None:
            task, restart = _way_to(path, file, history, after)
            history, complete = history[:after], True
            found = int(np.searchsorted(file["states/step"][()], after))
        elif "latest" in restarts and ("run" not in file.attrs or complete or "error" in file.attrs):
            restart = read_restart(restarts["latest"])
        if isinstance(states, slice):
            states = slice(*states.indices(found))
        elif any(not -found <= state < found for state in states):
            raise InputError("states", f"must be places from 0 to {found - 1}, not {list(states)}")
        else:
            states = [state % found for state in states]
        cycles = [cycle for cycle in read_cycles(file) if after is None or cycle.corner < after]
        result = Result(
            states=read_states(file, problem, grid, states),
            problem=problem,
            history=history,
            grid=grid,
            method=str(file["solver"].attrs["method"]),
            statistics=read_statistics(file),
            complete=complete,
            restart=restart,
            cycles=cycles,
        )
    if task is not None and restart is not None and restart.corner < len(task.history):
        result.restart = task.reach(restart, grid)  # the file is free again: this may take a while
    return result


def is_unfinished(path: Path) -> bool:
    """Whether a file holds a run that has not come to its end."""
    try:
        with opened(path) as file:
            return "run" in file.attrs and not file.attrs.get("complete", True)
    except InputError:
        return False


def size(path: str | Path) -> int:
    """Number of states in a file.

    Raises
    ------
    InputError
        See :func:`load`.
    """
    with opened(Path(path)) as file:
        return count(file["states"])


def to_xarray(path: str | Path) -> xarray.Dataset:
    """All states as an xarray.Dataset with the dimensions "state" and "theta", and units as attributes.

    A finished file can also be read piece by piece, without fastpin: ``xarray.open_dataset(path, group="states")``.

    Raises
    ------
    InputError
        See :func:`load`; also if xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise InputError("xarray", "is not installed: pip install fastpin[xarray]") from None
    with opened(Path(path)) as file:
        group, variables = file["states"], {}
        for name, dataset in group.items():
            scales = [dimension.values() for dimension in dataset.dims]
            dimensions = [scale[0].name.rpartition("/")[2] if scale else name for scale in scales]
            values = dataset.asstr()[()] if h5py.check_string_dtype(dataset.dtype) else dataset[()]
            unit = dataset.attrs.get("unit", "")
            units = {"units": unit if isinstance(unit, str) else ", ".join(unit)}
            variables[name] = (dimensions, values, units)
        attributes = {name: plain(value) for name, value in file.attrs.items()}
    return xarray.Dataset(variables, attrs=attributes).set_coords([name for name in variables if name in _COORDINATES])


_COORDINATES = ("state", "theta", "load_name", "residual_name", "step", "fraction")


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """A result open for reading, as its last transaction left it.

    Raises
    ------
    InputError
        If the file can't be read, was cut short, or is no result of fastpin; also where its user found it damaged.
    """
    check_exists(path)
    with settled(path), open_h5(path) as file:
        check_format(file, str(path))
        try:
            yield file
        except (OSError, KeyError, ValueError, TypeError, IndexError, RuntimeError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(str(path), f"is damaged: {_first_line(error)}") from None


def _way_to(path: Path, file: h5py.File, history: LoadHistory, after: int) -> tuple[Task, Restart]:
    """The history up to a corner, and the latest restart on the way there."""
    whole_number("after", after, 1)
    reached = max((int(group.attrs["corner"]) for group in file.get("restart", {}).values()), default=0)
    if count(file["states"]):
        last = int(file["states/step"][-1]) + (1 if file["states/fraction"][-1] == 1.0 else 0)
        reached = max(reached, last)
    if not 1 <= after <= reached:
        raise InputError("after", f"must be a corner from 1 to {reached}, not {after}: {path} has no others")
    stored = [group for group in file.get("restart", {}).values() if group.attrs["corner"] <= after]
    if "run" not in file.attrs or not stored:
        raise InputError("after", f"{path} was not written by a run: it can't be gone on from")
    start = read_restart(max(stored, key=lambda group: int(group.attrs["corner"])))
    return replace(stored_task(file), history=history[:after], shortcut=True, stops=frozenset()), start


def stored_task(file: h5py.File) -> Task:
    """What the run of a file was asked for, on its grid."""
    options = {name: plain(value) for name, value in file["solver"].attrs.items()}
    return Task(
        problem=read_problem(file),
        history=read_history(file),
        nodes=options["nodes"],
        method=options["method"],
        increments=options["increments"],
        arc=tuple(options["arc"].tolist()) if "arc" in options else None,
        grid=read_grid(file),
        fractions=options["fractions"],
        keep=Keep.of(options["keep"]),
        shortcut=bool(options["shortcut"]),
        progress=None,
        stops=frozenset(options["save_after"].tolist()),
    )


def _first_line(error: Exception) -> str:
    return (str(error).strip("\"'").splitlines() or [type(error).__name__])[0]

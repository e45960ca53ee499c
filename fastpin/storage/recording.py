"""Runs that write to a file. Every state is appended to the file soon after it is solved, and is never lost again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from fastpin.errors import InputError, InputWarning
from fastpin.model.case import About, Case
from fastpin.model.checks import (
    as_toml,
    check_callable,
    file_path,
    instance,
    items,
    string,
    true_or_false,
    whole_number,
)
from fastpin.model.doubts import doubts, pressure_doubts, warn_of
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.options import OptionValues, SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.synonyms import unknown_keyword
from fastpin.solver.errors import ArcError, ConvergenceError
from fastpin.solver.result import Result
from fastpin.solver.run import Progress
from fastpin.solver.task import Task, as_history, check_options, check_start
from fastpin.states.yield_doubts import yield_doubts
from fastpin.storage.damage import text_of
from fastpin.storage.files import check_exists, check_writable
from fastpin.storage.layout import read_about, read_history, read_options, read_problem
from fastpin.storage.origin import largest_pressure, stored_yield_extremes
from fastpin.storage.store import load, open_result
from fastpin.storage.writer import FileRecorder, closing_file, log, reopen


def record(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    path: str | Path,
    *,
    title: str = "",
    about: About | None = None,
    save_after: Sequence[int] = (),
    overwrite: bool = False,
    grid: Grid | None = None,
    start: Result | None = None,
    progress: Progress | None = None,
    **options: Unpack[OptionValues],
) -> None:
    """Follow a load history as :func:`fastpin.solve`, and write the states to an HDF5 file.

    A state is safe in the file 0.1 s after it is solved, or when the run reaches the next state or corner, if that is
    later. A killed process does not lose a safe state. Memory does not grow with the history. :func:`resume` continues
    a run that has ended early. :func:`fastpin.load` reads the file, also during the run.

    Parameters
    ----------
    problem, history, grid, start, progress
        See :func:`fastpin.solve`.
    path : path
        The file. Until the run ends, a journal and a checkpoint stand beside it.
    title : str
        Title of the run, stored in the file.
    about : About, optional
        Project, author, revision and date, stored in the file for its report.
    save_after : sequence of int
        Corners, counted from 1, with a restart in the file. ``load(path, after=corner)`` is quick at these corners.
    overwrite : bool
        Replace an existing result. No other file is replaced.
    **options
        See :class:`fastpin.SolveOptions`. Error bars are refused: a file has no place for them.

    Raises
    ------
    InputError
        Naming the field that can't be used; also if the file exists, or can't be written.
    SolveError
        See :func:`fastpin.solve`. The earlier states are in the file. ``result`` of the error holds the last of them.
    OutputError
        If the file can't be written any more, for example because the disk is full. The states in the file stay.

    A KeyboardInterrupt ends the file properly, with all earlier states.
    """
    path = file_path("path", path)
    check_writable(path, result=True)
    string("title", title)
    if about is not None:
        instance("about", about, About, "an About")
    true_or_false("overwrite", overwrite)
    if start is not None:
        check_start(problem, start)
    corners = items("save_after", save_after, "a list of corners")
    save_corners = frozenset(whole_number("save_after", corner, 1) for corner in corners)
    _check_names(options)
    solve_options = SolveOptions(**options)
    check_options(solve_options, grid, start)
    if solve_options.error_bars:
        raise InputError("error_bars", "are not kept in files; leave them out, or solve without a file")
    task = Task(problem, as_history(history), solve_options, grid, progress, save_corners)
    if max(save_corners, default=0) > len(task.history):
        raise InputError(
            "save_after", f"must be corners from 1 to {len(task.history)}, not {as_toml(max(save_corners))}"
        )
    warn_of(doubts(problem, task.history, solve_options), 2)
    writer = FileRecorder(path, task, title, about or About())
    writer.overwrite = overwrite
    writer.check_overwriting()
    writer.chosen_arc &= start is None
    with closing_file(writer):
        if start is not None and start.restart is not None:
            task.branch(writer, start.restart, start.grid)
        else:
            task.follow(writer)
    warn_of(_pressure_doubts(path, task), 2)


def resume(path: str | Path, progress: Progress | None = None) -> None:
    """Continue the run of a file after a kill, an interrupt or an error.

    States and cycles equal those of an uninterrupted run to the last bit. Only `solved`, `met`, the statistics, the
    run's id and its date may differ.

    Parameters
    ----------
    path : path
        The file of :func:`record`.
    progress : callable, optional
        See :func:`fastpin.solve`.

    Raises
    ------
    InputError
        If the file is no result, holds a finished run, or another process is writing to it.
    SolveError, OutputError
        See :func:`record`.
    """
    path = file_path("path", path)
    check_callable("progress", progress)
    check_exists(path)
    writer, restart = reopen(path, progress)
    task = writer.task
    with closing_file(writer):
        log.info("continuing from corner %d of %d", restart.corner, len(task.history))
        assert task.grid is not None
        try:
            task.continue_from(writer, restart, task.grid, strict=writer.chosen_arc)
        except (ArcError, ConvergenceError) as error:
            if not writer.chosen_arc:
                raise
            task.follow(writer, unfit=(task.grid, error))
    warn_of(_pressure_doubts(path, task), 2)


def stored_error(path: str | Path) -> str | None:
    """Return the message of the error that ended a stored run early; None if no error did.

    Raises
    ------
    InputError
        See :func:`fastpin.load`.
    """
    with open_result(file_path("path", path)) as file:
        error = file.attrs.get("error")
        return None if error is None else text_of(error)


def stored_case(path: str | Path) -> Case:
    """Read the case of a stored result: problem, history, options, title, and who made it for what.

    Raises
    ------
    InputError
        See :func:`fastpin.load`.
    """
    with open_result(file_path("path", path)) as file:
        title = text_of(file["solver"].attrs.get("title", ""))
        return Case(read_problem(file), read_history(file), read_options(file), title, read_about(file))


def _pressure_doubts(path: Path, task: Task) -> list[InputWarning]:
    """The doubts about the largest pressure and the largest stresses of the run that has been written to a file."""
    found = pressure_doubts(task.problem, task.history, [np.array([largest_pressure(path)])])
    return found + yield_doubts(
        task.problem,
        task.history,
        lambda: stored_yield_extremes(path),
        lambda places: load(path, list(places)).states,
    )


def _check_names(options: Mapping[str, Any]) -> None:
    """Raise :class:`TypeError`, as Python does, if an option of :func:`record` is unknown."""
    known = [field.name for field in fields(SolveOptions)]
    for name in options:
        if name not in known:
            raise unknown_keyword("record", name, known)

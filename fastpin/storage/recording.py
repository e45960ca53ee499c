"""Histories followed into a file: states are appended as they come, and nothing that was appended is ever lost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Unpack

from fastpin.errors import InputError
from fastpin.model.case import Case
from fastpin.model.checks import whole_number
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.options import OptionValues, SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.errors import ArcError
from fastpin.solver.result import Result
from fastpin.solver.run import Progress
from fastpin.solver.task import Task, as_history, check_grid, check_start
from fastpin.storage.files import check_exists, check_writable
from fastpin.storage.layout import read_history, read_options, read_problem
from fastpin.storage.store import open_result
from fastpin.storage.writer import FileRecorder, closing_file, log, reopen


def record(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    path: str | Path,
    *,
    title: str = "",
    save_after: Sequence[int] = (),
    overwrite: bool = False,
    grid: Grid | None = None,
    start: Result | None = None,
    progress: Progress | None = None,
    **options: Unpack[OptionValues],
) -> None:
    """Follow a load history as :func:`fastpin.solve` does, into an HDF5 file instead of memory.

    States are in the file, for good, a tenth of a second after they were found, whatever happens to the process.
    Memory does not grow with the history. :func:`resume` goes on where a run has ended early, with the same bits as if
    it had not; :func:`fastpin.store.load` reads the file, also while it is being written.

    Parameters
    ----------
    problem, history, grid, start, progress
        See :func:`fastpin.solve`.
    path : path
        The file. Until the run ends, a journal and a checkpoint stand beside it.
    title : str
        Kept with the file.
    save_after : sequence of int
        Corners at which a restart is kept: ``load(path, after=corner)`` is quick then.
    overwrite : bool
        Replace a file that exists.
    **options
        See :class:`fastpin.SolveOptions`. Error bars are not kept in files, so they are refused.

    Raises
    ------
    InputError
        Naming the field that can't be used; also if the file exists, or can't be written.
    SolveError
        As :func:`fastpin.solve`. What was solved before is in the file; ``result`` holds the last state of it.
    OSError
        If the file can't be written any more, for example because the disk is full. What was in it stays.

    A KeyboardInterrupt ends the file properly; what was solved before is in it.
    """
    path = Path(path)
    check_writable(path)
    if start is not None:
        check_start(problem, start)
    saved = frozenset(whole_number("save_after", corner, 1) for corner in save_after)
    chosen = SolveOptions(**options)
    check_grid(chosen, grid)
    if chosen.error_bars:
        raise InputError("error_bars", "are not kept in files; leave them out, or solve without a file")
    task = Task(problem, as_history(history), chosen, grid, progress, saved)
    if max(saved, default=0) > len(task.history):
        raise InputError("save_after", f"must be corners from 1 to {len(task.history)}, not {max(saved)}")
    writer = FileRecorder(path, task, title)
    writer.overwrite = overwrite
    writer.check_overwriting()
    writer.chosen_arc &= start is None
    with closing_file(writer):
        if start is not None and start.restart is not None:
            task.branch(writer, start.restart, start.grid)
        else:
            task.follow(writer)


def resume(path: str | Path, progress: Progress | None = None) -> None:
    """Go on with the run of a file that was killed, interrupted or stopped by an error.

    Parameters
    ----------
    path : path
    progress : callable, optional

    Raises
    ------
    InputError
        If the file is no result, holds a finished run, or another process is writing to it.
    SolveError, OSError
        See :func:`record`.
    """
    path = Path(path)
    check_exists(path)
    writer, restart = reopen(path, progress)
    task = writer.task
    with closing_file(writer):
        log.info("going on from corner %d of %d", restart.corner, len(task.history))
        assert task.grid is not None
        try:
            task.go_on(writer, restart, task.grid)
        except ArcError:
            if not writer.chosen_arc:
                raise
            task.follow(writer, beyond=task.grid)


def stored_case(path: str | Path) -> Case:
    """The case of a stored result: problem, history and options.

    Raises
    ------
    InputError
        See :func:`fastpin.store.load`.
    """
    with open_result(Path(path)) as file:
        title = str(file["solver"].attrs.get("title", ""))
        return Case(read_problem(file), read_history(file), read_options(file), title)

"""Runs that write to a file. Every state is appended to the file soon after it is solved, and is never lost again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Unpack

from fastpin.errors import InputError
from fastpin.model import (
    About,
    CrackGrowth,
    FatigueAssessment,
    Grid,
    LoadHistory,
    Problem,
    StrengthAssessment,
    checks,
    synonyms,
)
from fastpin.model.case import checked_beside
from fastpin.model.doubts import doubts, warn_of
from fastpin.model.options import OPTIONS, OptionValues, SolveOptions
from fastpin.solver import ArcError, ConvergenceError, Interrupted, Result, SolveError
from fastpin.solver.run import RunProgress
from fastpin.solver.solving import check_halves, coarse_task, words_for_coarse
from fastpin.solver.task import Task, Unfit, as_history, check_options, check_start
from fastpin.storage import files, journal
from fastpin.storage.store import is_unfinished, load, stored_task
from fastpin.storage.stored import StoredResult
from fastpin.storage.writer import FileRecorder, add_coarse, check_overwriting, coarse_of, log


def record(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    path: str | Path,
    *,
    title: str = "",
    about: About | None = None,
    fatigue: FatigueAssessment | None = None,
    crack: CrackGrowth | None = None,
    strength: StrengthAssessment | None = None,
    save_after: Sequence[int] = (),
    overwrite: bool = False,
    grid: Grid | None = None,
    start: Result | None = None,
    progress: RunProgress | None = None,
    **options: Unpack[OptionValues],
) -> None:
    """Follow a load history as :func:`fastpin.solve`, and write the states to an HDF5 file.

    A state is safe in the file after the next commit. Commits take about 1/20 of the run, and at most 64 states wait
    for one. A killed process does not lose a safe state. Memory does not grow with the history. :func:`resume`
    continues a run that has ended early. :func:`fastpin.load` reads the file, also during the run.

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
    fatigue : FatigueAssessment, optional
        How the fatigue is assessed, stored in the file for its text, figures and report.
    crack : CrackGrowth, optional
        How a crack grows from the hole, stored in the file for ``fastpin crack`` and its report.
    strength : StrengthAssessment, optional
        How the strength of a laminate is assessed, stored in the file for its text, figures and report.
    save_after : sequence of int
        Corners, counted from 1, with a restart in the file. ``load(path, after=corner)`` is quick at these corners.
    overwrite : bool
        Replace an existing result. No other file is replaced.
    **options
        See :class:`fastpin.SolveOptions`. With `error_bars` the history is followed again on a coarse grid, and these
        states go into the file too. They stand in a file ``.coarse`` beside it until this run ends. A run with `start`
        has no error bars in a file.

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
    path = checks.file_path("path", path)
    files.check_writable(path, result=True)
    checks.string("title", title)
    about = About() if about is None else checks.instance("about", about, About, "an About")
    checks.true_or_false("overwrite", overwrite)
    if start is not None:
        check_start(problem, start)
    history = as_history(history)
    save_corners = _checked_corners(save_after, len(history))
    for name in options:
        if name not in OPTIONS:
            raise synonyms.unknown_keyword("record", name, OPTIONS)
    solve_options = SolveOptions(**options)
    check_options(solve_options, grid, start)
    _check_bars(solve_options, start)
    task = Task(problem, history, solve_options, grid, progress, save_corners)
    if solve_options.error_bars:
        check_halves(task, start)
    warn_of(doubts(problem, task.history, solve_options, grid), 2)
    beside = checked_beside(problem, {"fatigue": fatigue, "crack": crack, "strength": strength})
    writer = FileRecorder(path)
    writer.take(task, title, about, beside)
    writer.overwrite = overwrite
    check_overwriting(path, overwrite)
    writer.chosen_arc &= start is None
    with writer.closing():
        if start is not None and start.restart is not None:
            task.branch(writer, start.restart, start.grid)
        else:
            task.follow(writer)
    if solve_options.error_bars:
        _record_coarse(path, task)
    _look_at(path)


def _look_at(path: Path) -> None:
    """Warn of doubtful states, at the line that called the function that calls this one."""
    with StoredResult(path) as stored:
        warn_of(stored.doubts(), 3)


def _check_bars(options: SolveOptions, start: Result | None) -> None:
    """Refuse error bars of a run in a file that continues another one."""
    if options.error_bars and start is not None:
        words = "a run that continues another one has none in a file; leave them or the file out"
        raise InputError("error_bars", words)


def _checked_corners(save_after: Sequence[int], count: int) -> frozenset[int]:
    """Check the corners with a restart, of a history of so many corners, counted from 1."""
    given = checks.items("save_after", save_after, "a list of corners")
    corners = frozenset(checks.whole_number("save_after", corner, 1) for corner in given)
    most = max(corners, default=0)
    if most > count:
        raise InputError("save_after", f"must be corners from 1 to {count}, not {checks.as_toml(most)}")
    return corners


def _record_coarse(path: Path, task: Task) -> None:
    """Follow the history of a finished file on the coarse grid too, and add these states to the file.

    An earlier run on the coarse grid goes on. It has a file of its own until it ends.
    """
    beside, run = coarse_of(path), StoredResult(path).origin["run"]
    journal.check_beside(beside)
    halves = replace(coarse_task(task, load(path, states=[]).grid), save_after=frozenset())
    try:
        with words_for_coarse(halves):
            if not (beside.is_file() and _title_of(beside) == run):
                writer = FileRecorder(beside)
                writer.take(halves, run, About())
                with writer.closing():
                    halves.follow(writer)
            elif is_unfinished(beside):
                writer, restart = FileRecorder.reopened(beside, task.progress)
                assert halves.grid is not None
                with writer.closing():
                    halves.continue_from(writer, restart, halves.grid)
    except SolveError as error:
        beside.unlink(missing_ok=True)
        error.result = load(path, states=slice(-1, None))
        raise
    except Interrupted as error:
        error.result = load(path, states=slice(-1, None))
        raise
    add_coarse(path, beside)


def _title_of(path: Path) -> str:
    """Return the title of a stored run; empty if the file is no result."""
    try:
        return StoredResult(path).case.title
    except InputError:
        return ""


def resume(path: str | Path, progress: RunProgress | None = None) -> None:
    """Continue the run of a file after a kill, an interrupt or an error.

    States and cycles equal those of an uninterrupted run to the last bit, and error bars to rounding. Only `solved`,
    `met`, the statistics, the run's id and its date may differ.

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
    path = checks.file_path("path", path)
    checks.check_callable("progress", progress)
    files.check_exists(path)
    if not journal.is_empty(path) and (stored := StoredResult(path)).lacks_error_bars:
        with stored.opened() as file:
            task = replace(stored_task(file), progress=progress)
        _record_coarse(path, task)
        _look_at(path)
        return
    writer, restart = FileRecorder.reopened(path, progress)
    task = writer.task
    with writer.closing():
        log.info("continuing from corner %d of %d", restart.corner, len(task.history))
        assert task.grid is not None
        try:
            task.continue_from(writer, restart, task.grid, strict=writer.chosen_arc)
        except (ArcError, ConvergenceError) as error:
            if not writer.chosen_arc:
                raise
            task.follow(writer, unfit=Unfit(task.grid, error))
    if task.options.error_bars:
        _record_coarse(path, task)
    _look_at(path)

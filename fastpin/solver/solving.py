"""solve(): follow a load history on one grid and return the states at its corners."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fastpin.errors import InputError
from fastpin.model.grid import Grid, halved
from fastpin.model.history import LoadHistory
from fastpin.model.options import KeepRule, Method, SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.arc import first_direction
from fastpin.solver.errors import Interrupted, SolveError
from fastpin.solver.result import Result
from fastpin.solver.run import Progress, Run
from fastpin.solver.task import Task, as_history, check_grid, check_start
from fastpin.states.cycles import Cycle
from fastpin.states.error_bars import LEAST_COARSE
from fastpin.states.state import State

DEFAULTS = SolveOptions()


def solve(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    *,
    nodes: int = DEFAULTS.nodes,
    method: Method = DEFAULTS.method,
    increments: int | None = DEFAULTS.increments,
    arc: tuple[float, float] | None = DEFAULTS.arc,
    between: int | Sequence[float] = DEFAULTS.between,
    keep: str | KeepRule = DEFAULTS.keep,
    shortcut: bool = DEFAULTS.shortcut,
    error_bars: bool = DEFAULTS.error_bars,
    grid: Grid | None = None,
    start: Result | None = None,
    progress: Progress | None = None,
) -> Result:
    """Follow a load history and return the states of the contact at its corners.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        Corners of the loads; between corners loads are linear. It starts from no load, or where `start` ended.
    nodes, method, increments, arc, between, keep, shortcut, error_bars
        See :class:`fastpin.SolveOptions`.
    grid : Grid, optional
        The nodes themselves, for example graded ones; `nodes` is then not used, and `arc` is not allowed.
    start : Result, optional
        Continue from the last state of this result, on its grid. The states are those of an unsplit history on that
        grid, bit for bit. If the contact will reach further than before, give the first part a wider `arc`. With
        `error_bars`, `start` must have them too.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)`` now and then.

    Returns
    -------
    Result
        Every state meets the contact conditions to 1e-9 (see ``State.residuals``).

    Raises
    ------
    InputError
        Naming the field that can't be used.
    NoEquilibriumError
        If no state carries the load; it says where the load was lost and holds the result so far.
    ConvergenceError
        If no state that meets the conditions was found; it holds the result so far.
    ArcError
        If the contact reaches an end of a given arc.

    A KeyboardInterrupt leaves with the result so far in its ``result``, as these errors do.
    """
    options = SolveOptions(
        nodes=nodes, method=method, increments=increments, arc=arc, between=between, keep=keep, shortcut=shortcut,
        error_bars=error_bars,
    )  # fmt: skip
    check_grid(options, grid)
    if start is not None:
        check_start(problem, start)
    task = Task(problem, as_history(history), options, grid, progress)
    if error_bars:
        _check_halves(task, start)
    result = _follow_task(task, start)
    return _with_coarse(task, start, result) if error_bars else result


def _follow_task(task: Task, start: Result | None) -> Result:
    """Follow the history of a task, from no load or from the end of another result."""
    kept = MemoryRecorder()
    began = time.perf_counter()
    try:
        if start is not None and start.restart is not None:
            task.branch(kept, start.restart, start.grid)
        else:
            task.follow(kept)
    except (SolveError, Interrupted) as ended:
        if kept.run is not None:  # else it ended before a grid was found
            ended.result = kept.result(task, time.perf_counter() - began)
        raise
    return kept.result(task, time.perf_counter() - began)


def _check_halves(task: Task, start: Result | None) -> None:
    """Raise :class:`InputError` if there can be no error bars."""
    if start is not None and (start.coarse is None or start.coarse.restart is None):
        raise InputError("error_bars", "the result to go on from was solved without them: it has no coarse grid")
    if start is None:
        size = task.options.nodes if task.grid is None else task.grid.size
        if (size + 1) // 2 < LEAST_COARSE:
            least = 2 * LEAST_COARSE - 1
            raise InputError("nodes", f"must be at least {least} for error bars, which half as many take, not {size}")


def _with_coarse(task: Task, start: Result | None, result: Result) -> Result:
    """The result with error bars; where the coarse grid has none to give, what is raised holds it without."""
    if start is None:
        grid, begin = halved(result.grid, first_direction(task.history.distinct())), None
    else:
        assert start.coarse is not None
        grid, begin = start.coarse.grid, start.coarse
    try:
        coarse = _follow_task(replace(task, options=task.options.changed(arc=None), grid=grid), begin)
    except (SolveError, Interrupted) as ended:
        ended.result = result
        if isinstance(ended, SolveError):
            ended.args = (f"{ended} (on the coarse grid of {grid.size} nodes that the error bars take)",)
        raise
    return result.with_coarse(coarse)


class MemoryRecorder:
    """The states and cycles of a run, kept in memory."""

    def __init__(self) -> None:
        self.run: Run | None = None
        self.states: list[State] = []
        self.cycles: list[Cycle] = []

    def begin(self, run: Run) -> None:
        self.run, self.states, self.cycles = run, [], []

    def add(self, state: State) -> None:
        self.states.append(state)

    def add_cycle(self, cycle: Cycle) -> None:
        self.cycles.append(cycle)

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray) -> None:
        latest = self.states[len(self.states) - len(steps) :]
        for state, step, lost, done in zip(latest, steps.tolist(), dissipation.tolist(), work.tolist(), strict=True):
            load, residuals = dict(state.load), dict(state.residuals)
            self.states.append(replace(state, step=step, dissipation=lost, work=done, load=load, residuals=residuals))

    def corner_reached(self) -> None:
        pass

    def result(self, task: Task, seconds: float) -> Result:
        """What was solved."""
        assert self.run is not None
        run, statistics = self.run, {**self.run.statistics, "seconds": seconds}
        return Result(
            self.states, task.problem, task.history, run.system.grid, run.options.method, statistics, run.complete,
            run.restart(), tuple(self.cycles),
        )  # fmt: skip

"""The function :func:`solve` follows a load history and returns the states at its corners.

:class:`MemoryRecorder` keeps these states in memory.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from fastpin.elasticity.tractions import Tractions
from fastpin.errors import InputError
from fastpin.kernels.status import STICK
from fastpin.model.checks import instance
from fastpin.model.doubts import are_given, doubts, doubts_given, pressure_doubts, warn_of
from fastpin.model.grid import Grid, halved
from fastpin.model.history import LoadHistory
from fastpin.model.options import KeepRule, Method, SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.synonyms import explains_keywords
from fastpin.reading.stress import tractions_of
from fastpin.solver.arc import first_direction
from fastpin.solver.errors import Interrupted, SolveError
from fastpin.solver.result import Result, with_error_bars
from fastpin.solver.run import Run, RunProgress
from fastpin.solver.task import Task, as_history, check_options, check_start
from fastpin.states.cycles import Cycle
from fastpin.states.error_bars import check_nodes
from fastpin.states.extremes import yield_doubts_of
from fastpin.states.state import SlipFields, State, state_again
from fastpin.states.walking import walk_doubts

DEFAULTS = SolveOptions()
"""The default options of :func:`solve`."""


@explains_keywords
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
    slip_sums: bool = DEFAULTS.slip_sums,
    grid: Grid | None = None,
    start: Result | None = None,
    progress: RunProgress | None = None,
) -> Result:
    """Follow a load history and return the states of the contact at its corners.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        Corners of the loads. Between corners the loads are linear. It starts from no load, or where `start` ended.
    nodes : int
        Number of nodes, 5 to 20,000.
    method : {"path", "increment"}
        "path" is exact in load. "increment" takes implicit load increments, as the paper does.
    increments : int, optional
        Increments a step, only with ``method="increment"``; 80 unless given.
    arc : (float, float), optional
        Start and end angle of the nodes, rad; the bottom is -pi/2. Chosen by the solver unless given.
    between : int or sequence of float
        States inside each step: their number, or increasing fractions of the step.
    keep : str
        States to keep: "all", "corners", "cycles" or "every N" (corners). The last state is always kept.
    shortcut : bool
        Take the states of a periodic contact from the period before. They have the same bits.
    error_bars : bool
        Also solve on a grid with half the intervals. Every state then has error bars.
    slip_sums : bool
        Sum up the slip distance and the friction energy of each node, and note its extremes of slip, see
        :class:`State`.
    grid : Grid, optional
        A ready grid, for example a graded one. `nodes` is then not used, and `arc` is not allowed.
    start : Result, optional
        Continue from the last state of this result, on its grid. The states equal the states of the unsplit history
        on that grid, bit for bit. If the contact will reach further than before, give the first part a wider `arc`.
        With `error_bars`, `start` must have error bars too.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)`` now and then. It starts anew for each arc that is tried, and for
        the coarse grid of error bars.

    Returns
    -------
    Result
        Every state meets the contact conditions to 1e-9 (see ``State.residuals``).

    Raises
    ------
    InputError
        If an input can't be used. The error names the field.
    NoEquilibriumError
        If no state carries the load. The error says where the load was lost.
    ConvergenceError
        If no state that meets the contact conditions was found.
    ArcError
        If the contact reaches an end of a given arc.
    Interrupted
        After Ctrl-C. It is a KeyboardInterrupt.

    The ``result`` of the last four is the result so far; None if the grid was not yet chosen.
    """
    options = SolveOptions(
        nodes=nodes, method=method, increments=increments, arc=arc, between=between, keep=keep, shortcut=shortcut,
        error_bars=error_bars, slip_sums=slip_sums,
    )  # fmt: skip
    check_options(options, grid, start)
    if start is not None:
        check_start(problem, start)
    task = Task(problem, as_history(history), options, grid, progress)
    if error_bars:
        check_halves(task, start)
    if not are_given():  # else they were looked for before
        warn_of(doubts(problem, task.history, options, grid), 3)  # above are the explanation of keywords and the user
    result = _follow_task(task, start)
    pressed = pressure_doubts(problem, task.history, (state.pressure for state in result.states))
    yielding = yield_doubts_of(problem, task.history, result.states)
    warn_of([*pressed, *yielding, *walk_doubts(result.states, result.cycles)], 3)
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
        if kept.run is not None:  # None if it ended before a grid was found
            ended.result = kept.result(task, time.perf_counter() - began)
        raise
    else:
        return kept.result(task, time.perf_counter() - began)
    finally:
        kept.run = None  # run and recorder refer to each other: the memory of the tableau would wait for a collection


def check_halves(task: Task, start: Result | None) -> None:
    """Raise :class:`InputError` if the task can't have error bars."""
    if start is not None and start.coarse is None:
        raise InputError("error_bars", "the result to continue from was solved without them: it has no coarse grid")
    if start is not None and start.coarse is not None and start.coarse.restart is None:
        raise InputError("error_bars", "continue from the end of a result only: the coarse grid has no restart before")
    if start is None:
        check_nodes(task.options.nodes if task.grid is None else task.grid.size)


def _with_coarse(task: Task, start: Result | None, result: Result) -> Result:
    """Follow the history on the coarse grid too, and return the result with error bars.

    If the history can't be followed there, the error holds the result without error bars.
    """
    begin = None if start is None else start.coarse
    halves = coarse_task(task, result.grid if begin is None else begin.grid, is_coarse=begin is not None)
    try:
        with words_for_coarse(halves):
            coarse = _follow_task(halves, begin)
    except (SolveError, Interrupted) as ended:
        ended.result = result
        raise
    return with_error_bars(result, coarse)


def coarse_task(task: Task, grid: Grid, is_coarse: bool = False) -> Task:
    """Return the task that gives a task its error bars: the same history with half the intervals of `grid`.

    `is_coarse`: the grid is the coarse grid already.
    """
    if not is_coarse:
        grid = halved(grid, first_direction(task.problem, task.history.distinct()))
    return replace(task, options=task.options.changed(arc=None, error_bars=False), grid=grid)


@contextmanager
def words_for_coarse(halves: Task) -> Iterator[None]:
    """Say in errors of the block that they come from the coarse grid."""
    try:
        yield
    except SolveError as ended:
        assert halves.grid is not None
        ended.args = (f"{ended} (on the coarse grid of {halves.grid.size} nodes that the error bars take)",)
        raise


class MemoryRecorder:
    """A recorder that keeps the states and cycles of a run in memory.

    Attributes
    ----------
    run : Run or None
        The run that is recorded; None before it begins.
    states : list of State
    cycles : list of Cycle
    """

    def __init__(self) -> None:
        self.run: Run | None = None
        self.states: list[State] = []
        self.cycles: list[Cycle] = []

    def begin(self, run: Run) -> None:
        """Forget everything. From here on all states come from `run`."""
        self.run, self.states, self.cycles = run, [], []

    def add(self, state: State) -> None:
        """Keep a state."""
        self.states.append(state)

    def add_cycle(self, cycle: Cycle) -> None:
        """Keep the changes of one cycle."""
        self.cycles.append(cycle)

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray, slip: SlipFields) -> None:
        """Keep the latest states once more, as states of other steps; see :meth:`fastpin.solver.run.Recorder`."""
        latest = self.states[len(self.states) - len(steps) :]
        for state, step, lost, done in zip(latest, steps.tolist(), dissipation.tolist(), work.tolist(), strict=True):
            self.states.append(state_again(state, step, lost, done))
        given: dict[str, Any] = {**slip}
        if any(not np.array_equal(getattr(latest[0], name), values, equal_nan=True) for name, values in given.items()):
            self.states[-len(steps)] = replace(self.states[-len(steps)], **slip)

    def corner_reached(self) -> None:
        """Do nothing: the run itself remembers its last corner."""

    def result(self, task: Task, seconds: float) -> Result:
        """The result of the run so far, solved in this many seconds."""
        assert self.run is not None
        run, statistics = self.run, {**self.run.statistics, "seconds": seconds}
        return Result(
            self.states, task.problem, task.history, run.grid, run.options.method, statistics, run.complete,
            run.restart(), tuple(self.cycles),
        )  # fmt: skip


def assembled_tractions(problem: Problem, grid: Grid) -> tuple[Tractions, ...]:
    """The tractions before any load, Pa: on the pin, and in the seat of a bush if that is an interface of its own.

    Those of a round joint are the pressures of Lame. Any other joint is solved without loads.

    Parameters
    ----------
    problem : Problem
    grid : Grid
        The nodes of the pin.

    Returns
    -------
    tuple of Tractions
        Empty if nothing is pressed.
    """
    return _assembled(instance("problem", problem, Problem, "a Problem"), instance("grid", grid, Grid, "a Grid"))


@lru_cache(maxsize=64)
def _assembled(problem: Problem, grid: Grid) -> tuple[Tractions, ...]:
    if not problem.is_pressed:
        return ()
    if not problem.is_round:
        with doubts_given():
            state = solve(problem, [{}], grid=grid)[-1]
        return tuple(each.refined.tractions for each in (state, state.seat) if each is not None)
    pressures = problem.joint.assembly_pressures(problem.assembled_clearance)[: len(problem.interfaces)]
    around = Grid.circle(16)
    none, closed = np.zeros(around.size), np.full(around.size, STICK, dtype=np.int8)
    return tuple(
        tractions_of(around, closed, none + pressure, none) if pressure else Tractions(()) for pressure in pressures
    )

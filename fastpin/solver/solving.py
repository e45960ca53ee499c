"""solve(): follow a load history on one grid and return the states at its corners."""

from __future__ import annotations

import functools
import logging
import math
import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from fastpin.arc import first_direction, grids_to_try
from fastpin.checks import finite, one_of, whole_number
from fastpin.collocation import System
from fastpin.errorbars import LEAST_COARSE, halved
from fastpin.errors import CUT_OFF, ArcError, InputError, Interrupted, SolveError
from fastpin.grid import LEAST_NODES, Grid
from fastpin.interrupt import Asked, held_back
from fastpin.keep import Keep
from fastpin.loading import LoadHistory, check_loads
from fastpin.problem import Problem
from fastpin.run import Method, Progress, Recorder, Restart, Run
from fastpin.state import Cycle, Result, State

log = logging.getLogger(__name__)


def solve(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    nodes: int = 401,
    method: Method = "path",
    increments: int = 80,
    arc: tuple[float, float] | None = None,
    grid: Grid | None = None,
    between: int | Sequence[float] = 0,
    start: Result | None = None,
    progress: Progress | None = None,
    keep: str | Keep = "all",
    shortcut: bool = True,
    error_bars: bool = False,
) -> Result:
    """Follow a load history and return the contact's states at its corners.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        Corner points of the loads; between them loads are linear. It starts from no load, or where `start` ended.
    nodes : int
        Number of nodes of the arc, which spans all places that are ever in contact and a little more.
    method : {"path", "increment"}
        "path" is exact in load. "increment" is the paper's way: implicit increments, first order in their size.
    increments : int
        Increments a step, for the increment solver: of equal size, or growing linearly in a step that starts without
        contact.
    arc : (float, float), optional
        Start and end angle of the arc, rad (the bottom is -pi/2). Chosen from a coarse run if not given. A span of
        2 pi or more means the whole circle.
    grid : Grid, optional
        The nodes themselves, for example graded ones; `nodes` and `arc` are then not used.
    between : int or sequence of float
        Also return states inside each step: so many equally spaced ones, or at these fractions of a step.
    start : Result, optional
        Go on from the last state of this result, on its grid. The states are those of an unsplit history on that grid,
        bit for bit. If the contact will reach further than before, give the first part an `arc` wide enough.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)`` now and then.
    keep : str
        Which states are kept: "all", "corners", "cycles" (where a cycle of the history ends) or "every N" (corners).
        The last one is always kept.
    shortcut : bool
        Where the contact has become periodic under loads that repeat, take the states from the period before instead of
        solving them again. They are the same to the last bit.
    error_bars : bool
        Also follow the history on a grid with half the intervals, which gives every state its ``error_bars`` and the
        result its ``coarse``. The states are otherwise the same to the last bit. `start` must have been solved so, too.

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
    if start is not None:
        check_start(problem, start)
    if error_bars:
        _check_halves(nodes, grid, start)
    task = Task.checked(
        problem, history, nodes, method, increments, arc, grid, between, Keep.of(keep), shortcut, progress
    )
    result = _solved(task, start)
    return _with_coarse(task, start, result) if error_bars else result


def _solved(task: Task, start: Result | None) -> Result:
    """Follow the history of a task, from no load or from the end of another result."""
    kept = Kept()
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


def _check_halves(nodes: int, grid: Grid | None, start: Result | None) -> None:
    """Raise :class:`InputError` if there can be no error bars."""
    if start is not None and (start.coarse is None or start.coarse.restart is None):
        raise InputError("error_bars", "the result to go on from was solved without them: it has no coarse grid")
    if start is None:
        size = whole_number("nodes", nodes, LEAST_NODES) if grid is None else grid.size
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
        coarse = _solved(replace(task, arc=None, grid=grid), begin)
    except (SolveError, Interrupted) as ended:
        ended.result = result
        if isinstance(ended, SolveError):
            ended.args = (f"{ended} (on the coarse grid of {grid.size} nodes that the error bars take)",)
        raise
    return result.with_coarse(coarse)


class Kept:
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
            self.states, task.problem, task.history, run.system.grid, run.method, statistics, run.complete,
            run.restart(), self.cycles,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Task:
    """A history to follow and how; see :func:`solve`, whose arguments these are, checked."""

    problem: Problem
    history: LoadHistory
    nodes: int
    method: Method
    increments: int
    arc: tuple[float, float] | None
    grid: Grid | None
    fractions: np.ndarray
    keep: Keep
    shortcut: bool
    progress: Progress | None
    stops: frozenset[int] = frozenset()

    @classmethod
    def checked(
        cls,
        problem: Problem,
        history: LoadHistory | Sequence[dict[str, float]],
        nodes: int,
        method: Method,
        increments: int,
        arc: tuple[float, float] | None,
        grid: Grid | None,
        between: int | Sequence[float],
        keep: str | Keep,
        shortcut: bool,
        progress: Progress | None,
    ) -> Task:
        """Check the arguments of :func:`solve`, or raise :class:`InputError`."""
        if not isinstance(problem, Problem):
            raise InputError("problem", f"must be a Problem, not {problem!r}")
        if not isinstance(history, LoadHistory):
            if not isinstance(history, Sequence):
                raise InputError("history", f"must be a LoadHistory or a sequence of corners, not {history!r}")
            history = LoadHistory(history)
        if grid is not None and not isinstance(grid, Grid):
            raise InputError("grid", f"must be a Grid, not {grid!r}")
        one_of("method", method, ("path", "increment"))
        increments = whole_number("increments", increments, 1)
        check_loads(problem, history)
        keep = Keep.of(keep)
        if keep.which == "cycles" and not history.longest_cycle:
            raise InputError("keep", "the history has no cycles: none of its blocks is repeated")
        fractions = _fractions(between)
        if arc is not None:
            arc = _checked_arc(arc)
        return cls(problem, history, nodes, method, increments, arc, grid, fractions, keep, bool(shortcut), progress)

    def follow(self, recorder: Recorder, beyond: Grid | None = None) -> None:
        """Follow the history from no load, on the first grid that is wide enough, of those `beyond` one that is not."""
        force = reference_force(self.problem, self.history.distinct())
        with held_back() as asked, _one_thread():
            progress = self._progress(asked)
            given = None if beyond is not None else self.grid
            for chosen in replace(self, grid=given).grids(progress):
                if beyond is not None:
                    if np.allclose(chosen.theta, beyond.theta, rtol=0.0, atol=1e-9):
                        beyond = None
                    continue
                log.info("%d nodes from %.5g to %.5g rad", chosen.size, chosen.theta[0], chosen.theta[-1])
                try:
                    self._run(System.build(self.problem, chosen, force), recorder, None, progress)
                    return
                except ArcError:
                    if self.arc is not None or given is not None:
                        raise
                    log.info("the contact reaches an end of the arc: once more on a wider one")
        raise ArcError(CUT_OFF)  # the grid to go on from is none of those that are chosen here and now

    def grids(self, progress: Progress | None = None) -> Iterator[Grid]:
        """The given grid, or those to try one after the other until the contact stays clear of the ends."""
        values = self.history.distinct()
        force = reference_force(self.problem, values)
        yield from _grids(self.problem, values, force, self.nodes, self.arc, self.grid, progress)

    def go_on(self, recorder: Recorder, start: Restart, grid: Grid) -> None:
        """Follow the history from a corner where another run stood, on its grid."""
        with held_back() as asked, _one_thread():
            system = System.build(self.problem, grid, start.force)
            self._run(system, recorder, start, self._progress(asked))

    def branch(self, recorder: Recorder, start: Restart, grid: Grid) -> None:
        """Follow the history from where another one has led."""
        try:
            self.go_on(recorder, start.elsewhere(), grid)
        except ArcError as error:
            error.args = (f"{error}; here it is that of the result to go on from: solve that one on a wider arc",)
            raise

    def reach(self, start: Restart, grid: Grid) -> Restart:
        """Follow the history from a corner to its end, and keep nothing but what is needed to go on from there."""
        with held_back() as asked, _one_thread():
            system = System.build(self.problem, grid, start.force)
            run = self._made(system, None, start, self._progress(asked))
            run.follow()
            return run.restart()

    def _run(self, system: System, recorder: Recorder, start: Restart | None, progress: Progress) -> None:
        run = self._made(system, recorder, start, progress)
        recorder.begin(run)
        run.follow()

    def _made(self, system: System, recorder: Recorder | None, start: Restart | None, progress: Progress) -> Run:
        return Run(
            self.history, system, self.method, self.increments, self.fractions, recorder, self.keep, progress, start,
            self.shortcut, self.stops,
        )  # fmt: skip

    def _progress(self, asked: Asked) -> Progress:
        """What a run reports to: stops it where somebody asked for it."""

        def progress(done: float, total: int) -> None:
            if asked.stop:
                raise Interrupted
            if self.progress is not None:
                self.progress(done, total)

        return progress


def check_start(problem: Problem, start: Result) -> None:
    """Raise :class:`InputError` if a result of `problem` can't be gone on from."""
    if not isinstance(start, Result):
        raise InputError("start", f"must be a Result, not {start!r}")
    if start.problem != problem:
        raise InputError("start", "the result to go on from belongs to another problem")
    if start.restart is None:
        raise InputError("start", "this result can't be gone on from: its file holds states only")


def _one_thread() -> AbstractContextManager[Any]:
    """One thread for BLAS: results don't depend on the number of cores. Large products have two (products.py)."""
    return _threads().limit(limits=1, user_api="blas")


@functools.cache
def _threads() -> ThreadpoolController:
    """The BLAS libraries of this process; to look for them takes longer than a small step."""
    return ThreadpoolController()


def _checked_arc(arc: tuple[float, float]) -> tuple[float, float]:
    if not isinstance(arc, Sequence) or isinstance(arc, str) or len(arc) != 2:
        raise InputError("arc", f"must be two angles, start and end in rad, not {arc!r}")
    return finite("arc start", arc[0]), finite("arc stop", arc[1])


def _grids(
    problem: Problem,
    values: np.ndarray,
    force: float,
    nodes: int,
    arc: tuple[float, float] | None,
    grid: Grid | None,
    progress: Progress | None,
) -> Iterator[Grid]:
    """The given grid, or those to try one after the other until the contact stays clear of the ends."""
    if grid is None and arc is None:
        yield from grids_to_try(problem, values, force, nodes, progress)
        return
    if grid is None:
        assert arc is not None
        whole = arc[1] - arc[0] >= 2.0 * np.pi
        grid = Grid.circle(nodes, arc[0]) if whole else Grid.arc(arc[0], arc[1], nodes)
    if problem.clearance < 0.0 and not grid.closed:
        raise InputError("arc", "an interference fit is in contact all round: its grid must be the whole circle")
    yield grid


def reference_force(problem: Problem, values: np.ndarray) -> float:
    """The force F, N/m, in which a history is made dimensionless: its largest load, rounded up.

    It is R/beta* times a power of two, so that no bit of a result depends on it.
    """
    radius = problem.hole_radius
    pin = float(np.hypot(values[:, 0], values[:, 1]).max())
    moment = float(np.abs(values[:, 2]).max()) / radius
    remote = float(np.abs(values[:, 3:5]).max()) * radius
    unit = radius / problem.pair.beta_star
    largest = max(pin, moment) or remote or unit
    return unit * 2.0 ** math.ceil(math.log2(largest / unit))


def _fractions(between: int | Sequence[float]) -> np.ndarray:
    """Fractions of a step at which states are returned, the corner included."""
    if isinstance(between, (int, np.integer)) and not isinstance(between, bool):
        if between < 0:
            raise InputError("between", f"must not be negative, not {between}")
        return np.arange(1, between + 2) / (between + 1)
    try:
        inner = np.asarray(between, dtype=float)
    except (TypeError, ValueError):
        raise InputError("between", f"must be a whole number or fractions of a step, not {between!r}") from None
    if inner.ndim != 1 or not np.all((inner > 0.0) & (inner < 1.0)):
        raise InputError("between", "must be a whole number or fractions of a step between 0 and 1")
    return np.r_[np.unique(inner), 1.0]

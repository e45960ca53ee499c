"""solve(): follow a load history on one grid and return the states at its corners."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Iterator, Sequence

import numpy as np
from threadpoolctl import ThreadpoolController

from fastpin.arc import grids_to_try
from fastpin.checks import finite, one_of, whole_number
from fastpin.collocation import System
from fastpin.errors import ArcError, InputError, SolveError
from fastpin.grid import Grid
from fastpin.loading import LoadHistory, check_loads
from fastpin.problem import Problem
from fastpin.run import Method, Progress, Run
from fastpin.state import Result


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
    """
    if not isinstance(problem, Problem):
        raise InputError("problem", f"must be a Problem, not {problem!r}")
    if not isinstance(history, LoadHistory):
        if not isinstance(history, Sequence):
            raise InputError("history", f"must be a LoadHistory or a sequence of corners, not {history!r}")
        history = LoadHistory(history)
    if grid is not None and not isinstance(grid, Grid):
        raise InputError("grid", f"must be a Grid, not {grid!r}")
    if start is not None and not isinstance(start, Result):
        raise InputError("start", f"must be a Result, not {start!r}")
    one_of("method", method, ("path", "increment"))
    increments = whole_number("increments", increments, 1)
    check_loads(problem, history)
    fractions = _fractions(between)
    if arc is not None:
        arc = _checked_arc(arc)
    if start is not None and start.problem != problem:
        raise InputError("start", "the result to go on from belongs to another problem")
    if start is not None and start.restart is None:
        raise InputError("start", "this result can't be gone on from: it was read from a file")
    began = time.perf_counter()
    # One thread for BLAS: results don't depend on the number of cores. Large products have two (products.py).
    with _threads().limit(limits=1, user_api="blas"):
        if start is not None and start.restart is not None:
            last = start.restart
            system = System.build(problem, start.grid, last.force)
            run = Run(system, method, increments, fractions, progress, last.configuration.copy(), last.repeats.copy())
            return _finished(run, history, history.values(initial=last.load), began)

        values = history.values()
        force = reference_force(problem, values)
        for chosen in _grids(problem, values, force, nodes, arc, grid, progress):
            run = Run(System.build(problem, chosen, force), method, increments, fractions, progress)
            try:
                return _finished(run, history, values, began)
            except ArcError:
                if arc is not None or grid is not None:
                    raise
    raise AssertionError("the whole circle has no ends")


@functools.cache
def _threads() -> ThreadpoolController:
    """The BLAS libraries of this process; to look for them takes longer than a small step."""
    return ThreadpoolController()


def _checked_arc(arc: tuple[float, float]) -> tuple[float, float]:
    if not isinstance(arc, Sequence) or isinstance(arc, str) or len(arc) != 2:
        raise InputError("arc", f"must be two angles, start and end in rad, not {arc!r}")
    return finite("arc start", arc[0]), finite("arc stop", arc[1])


def _finished(run: Run, history: LoadHistory, values: np.ndarray, began: float) -> Result:
    """Follow the history; an error leaves with what was solved before."""
    try:
        run.follow(values)
    except SolveError as error:
        error.result = run.result(history, time.perf_counter() - began)
        raise
    return run.result(history, time.perf_counter() - began)


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

"""Convergence studies: every reported quantity on finer and finer grids, and with more and more load increments."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import whole_number
from fastpin.model.grid import MAX_NODES, Grid
from fastpin.model.history import LoadHistory
from fastpin.model.options import Method, SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.arc import first_direction
from fastpin.solver.errors import ArcError, SolveError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.solver.task import Task, as_history
from fastpin.states.error_bars import PLACE_FLOOR, spacing
from fastpin.states.quantities import matching_values, quantity, size, values
from fastpin.studies.extrapolate import Estimate, estimate

LEAST_GRIDS = 3
LEAST_RATIO = 1.1
LEAST_NODES = 51
LEAST_CLOSED = 10
"""Nodes in contact below which a grid says nothing about the quantities of finer ones."""

SHORT = 6
"""Up to so many corners are all studied, of a longer history the last one."""

INCREMENT_NODES = 201
"""The increment solver has the first grid of so many nodes or more, or the finest."""

ROUNDING = 1e-9
"""Values that differ by so small a part of the quantity's size are the same."""

NODES = (101, 201, 401, 801)

Progress = Callable[[float, float, str], None]


class QuantitySeries(NamedTuple):
    """One quantity at one corner.

    Attributes
    ----------
    corner : int
        From 1.
    name : str
        See :data:`fastpin.quantities.QUANTITIES`.
    values : tuple of float
        On every grid or for every number of increments; SI or in the units of a dimensionless problem, angles in rad.
        NaN where a value can't be compared with the last one.
    estimate : Estimate
        Observed order, limit and error bar of the last value.
    size : float
        The natural size of the quantity, see :func:`fastpin.quantities.size`.
    path : float
        The value of the path solver on the same grid, for a study of increments; NaN for one of grids.
    """

    corner: int
    name: str
    values: tuple[float, ...]
    estimate: Estimate
    size: float
    path: float


@dataclass(frozen=True)
class Study:
    """What one solver gives.

    Attributes
    ----------
    method : {"path", "increment"}
    counts : tuple of int
        Numbers of nodes ("path"), or of increments a step.
    nodes : int
        Nodes of the (finest) grid.
    series : tuple of Series
        Corner by corner.
    """

    method: Method
    counts: tuple[int, ...]
    nodes: int
    series: tuple[QuantitySeries, ...]


@dataclass(frozen=True)
class Convergence:
    """A convergence study.

    Attributes
    ----------
    problem : Problem
    grid : Grid
        The finest one; all others are on its arc.
    loads : dict of int to dict
        The loads at the corners that are studied, counted from 1.
    studies : tuple of Study
        That of the path solver, and that of the increment solver if it was asked for.
    complete : bool
        False if it was interrupted, or lost its loads; finer grids, increments or later corners are then missing.
    """

    problem: Problem
    grid: Grid
    loads: dict[int, dict[str, float]]
    studies: tuple[Study, ...]
    complete: bool = True

    def __repr__(self) -> str:
        counts = ", ".join(f"{study.method}: {'-'.join(map(str, study.counts))}" for study in self.studies)
        return f"<Convergence: {counts}; corners {', '.join(map(str, self.loads))}>"


class StudyInterrupted(KeyboardInterrupt):
    """Ctrl-C during a study; ``study`` is what was found before, None with fewer than three grids."""

    def __init__(self, study: Convergence | None) -> None:
        super().__init__("interrupted")
        self.study = study


class StudyLostError(SolveError):
    """A grid on which the loads can't be followed, or that does not fit in memory; the message names it.

    ``study`` is what was found: the corners before the one that was lost, or the grids before the one that was too
    large; None if there are none, or fewer than three grids.
    """

    study: Convergence | None = None


def converge(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    nodes: Sequence[int] = NODES,
    increments: Sequence[int] = (),
    increment_nodes: int | None = None,
    corner: int | None = None,
    arc: tuple[float, float] | None = None,
    progress: Progress | None = None,
) -> Convergence:
    """Follow a history on several grids, and say how its quantities converge.

    All grids are on one arc: `arc`, or one that a coarse run chooses as for :func:`fastpin.solve`. A node of as many of
    them as can be lies where the first force points.

    Parameters
    ----------
    problem, history
        See :func:`fastpin.solve`.
    nodes : sequence of int
        At least three numbers of nodes, increasing, from 51 on. Multiples of the numbers of intervals, as in 101, 201,
        401, give the smoothest sequences; others will do.
    increments : sequence of int
        Also follow it with the increment solver, with these numbers of increments a step: at least three, increasing.
    increment_nodes : int, optional
        Nodes of the increment solver's grid; of `nodes` the first of 201 or more unless given, or the last.
    corner : int, optional
        The corner that is studied, counted from 1; what follows it is left out, but for the choice of the arc. By
        default all of up to six, or the last one.
    arc : (float, float), optional
        Start and end angle, rad; 2 pi apart for the whole circle.
    progress : callable, optional
        Called as ``progress(done, total, what)`` now and then; a unit is some constant time.

    Raises
    ------
    InputError
        Naming the field that can't be used, before anything is solved; also where a grid has too few nodes in contact.
    StudyLostError
        Where the loads can't be followed to the end on a grid, which the message names; it holds the study of the
        corners before that.
    StudyInterrupted
        By Ctrl-C; it holds the study of the grids that were finished, if they are three.
    """
    counts = _increasing("nodes", nodes, LEAST_NODES, MAX_NODES)
    for before, after in pairwise(counts):
        if after < LEAST_RATIO * before:
            raise InputError("nodes", f"must grow by a tenth at least to show an order, but {after} follows {before}")
    wanted = np.size(increments) > 0
    steps = _increasing("increments", increments, 1) if wanted else ()
    single = next((count for count in counts if count >= INCREMENT_NODES), counts[-1])
    if increment_nodes is not None:
        if not steps:
            raise InputError("increment_nodes", "is for the increment solver: give increments, too")
        single = whole_number("increment_nodes", increment_nodes, LEAST_NODES, MAX_NODES)
    task = Task(problem, as_history(history), SolveOptions(nodes=counts[0], arc=arc))
    if corner is not None and whole_number("corner", corner, 1) > len(task.history):
        raise InputError("corner", f"must be one of the history, 1 to {len(task.history)}, not {corner}")
    return _Work(task, counts, steps, single, corner, progress).study()


def _increasing(field: str, numbers: object, least: int, most: int | None = None) -> tuple[int, ...]:
    numbers = numbers.tolist() if isinstance(numbers, np.ndarray) else numbers
    if not isinstance(numbers, Sequence) or isinstance(numbers, str) or len(numbers) < LEAST_GRIDS:
        raise InputError(field, f"must be at least {LEAST_GRIDS} numbers, not {numbers!r}: an order takes as many")
    checked = tuple(whole_number(field, number, least, most) for number in numbers)
    for before, after in pairwise(checked):
        if after <= before:
            raise InputError(field, f"must increase from one to the next, but {after} follows {before}")
    return checked


class _Work:
    """What is to be solved, and what has been."""

    def __init__(
        self,
        task: Task,
        counts: tuple[int, ...],
        increments: tuple[int, ...],
        increment_nodes: int,
        corner: int | None,
        progress: Progress | None,
    ) -> None:
        self.task, self.counts, self.increments, self.single = task, counts, increments, increment_nodes
        self.history = task.history if corner is None else task.history[:corner]
        corners = len(self.history)
        self.every = corner is None and corners <= SHORT
        self.corners = range(1, corners + 1) if self.every else range(corners, corners + 1)
        self.keep = "corners" if self.every else f"every {corners}"
        self.lost: StudyLostError | None = None
        self.progress = progress
        self.done = 0.0
        self.total = sum(_cost("path", count, 0) for count in (*counts, *self._path_apart()))
        self.total += sum(_cost("increment", self.single, count) for count in increments)
        self.found: dict[int, Result] = {}  # of the path solver, by nodes
        self.found_increments: list[Result] = []

    def study(self) -> Convergence:
        try:
            self._follow()
        except KeyboardInterrupt:
            raise StudyInterrupted(self._finished_study()) from None
        except StudyLostError as error:
            error.study = self._finished_study()
            raise
        if self.lost is not None:
            self.lost.study = self._finished_study()
            raise self.lost
        return self._convergence(complete=True)

    def _finished_study(self) -> Convergence | None:
        """The study of the grids that are finished, if they are enough."""
        enough = sum(count in self.found for count in self.counts) >= LEAST_GRIDS
        return self._convergence(complete=False) if enough else None

    def _path_apart(self) -> list[int]:
        """The increment solver's grid, where it is none of the others."""
        return [self.single] if self.increments and self.single not in self.counts else []

    def _follow(self) -> None:
        """All grids on the first arc that is wide enough for all of them."""
        common = math.gcd(*(count - 1 for count in self.counts))
        coarsest = common + 1 if common >= LEAST_NODES - 1 else self.counts[0]
        for arc in replace(self.task, options=self.task.options.changed(nodes=coarsest)).grids():
            try:
                self.found, self.done = {}, 0.0
                for count in (*self.counts, *self._path_apart()):
                    self.found[count] = self._solve_grid(arc, count, "path", 0)
                break
            except ArcError:
                if self.task.options.arc is not None or arc.closed:
                    raise
        for count in self.increments:
            self.found_increments.append(self._solve_grid(arc, self.single, "increment", count))

    def _solve_grid(self, arc: Grid, nodes: int, method: Method, increments: int) -> Result:
        """The history on one grid."""
        if arc.closed:
            direction = first_direction(self.history.distinct())
            grid = Grid.circle(nodes, float(arc.theta[0]) if direction is None else direction)
        else:
            grid = arc.with_nodes(nodes)
        what = f"{nodes} nodes" if method == "path" else f"{increments} increments"
        cost = _cost(method, nodes, increments)

        def progress(done: float, total: int) -> None:
            if self.progress is not None:
                self.progress(self.done + cost * done / total, self.total, what)

        where = what if method == "path" else f"{what} a step and {nodes} nodes"
        try:
            result = solve(
                self.task.problem, self.history, method=method, increments=increments or None, grid=grid,
                keep=self.keep, progress=progress,
            )  # fmt: skip
        except ArcError as error:
            error.args = (f"with {where}: {error}",)
            raise
        except SolveError as error:
            lost = StudyLostError(f"with {where}: {error}", error.step, error.fraction, error.load, error.result)
            if not self.every or error.result is None or error.step < 1:
                raise lost from None
            self.lost, result = self.lost or lost, error.result  # study the corners before that
            self.corners = range(1, error.step + 1)
            self.history = self.history[: error.step]
        except MemoryError:
            raise StudyLostError(f"with {where}: not enough memory") from None
        for corner, state in zip(self.corners, result, strict=False):
            closed = int(np.count_nonzero(state.pressure))
            if 0 < closed < LEAST_CLOSED:
                field = "nodes" if nodes in self.counts else "increment_nodes"
                raise InputError(
                    field, f"{nodes} put only {closed} in the contact at corner {corner}; take at least {LEAST_CLOSED}"
                )
        self.done += cost
        return result

    def _convergence(self, complete: bool) -> Convergence:
        counts = tuple(count for count in self.counts if count in self.found)
        results = [self.found[count] for count in counts]
        finest = results[-1]
        intervals = [grid.size - (not grid.closed) for grid in (result.grid for result in results)]
        series = self._series([1.0 / number for number in intervals], results, None)
        studies = [Study("path", counts, counts[-1], tuple(series))]
        steps = self.increments[: len(self.found_increments)]
        if len(steps) >= LEAST_GRIDS:
            spacings, path = [1.0 / step for step in steps], self.found[self.single]
            series = self._series(spacings, self.found_increments, path)
            studies.append(Study("increment", steps, self.single, tuple(series)))
        loads = {corner: state.load for corner, state in zip(self.corners, finest, strict=False)}
        return Convergence(self.task.problem, finest.grid, loads, tuple(studies), complete)

    def _series(
        self, spacings: Sequence[float], results: Sequence[Result], path: Result | None
    ) -> Iterator[QuantitySeries]:
        for place, corner in enumerate(self.corners):
            last = results[-1][place]
            rows = [matching_values(last, result[place]) for result in results]
            other = {} if path is None else matching_values(last, path[place])
            for name, value in values(last).items():
                if math.isfinite(value):
                    numbers, natural = tuple(row[name] for row in rows), size(name, last)
                    found = estimate(spacings, numbers, ROUNDING * natural)
                    if quantity(name).kind in ("angle", "width") and found.bar <= ROUNDING * natural:
                        # read at or between nodes that all grids have
                        found = Estimate("not observed", math.nan, math.nan, PLACE_FLOOR * spacing(last))
                    yield QuantitySeries(corner, name, numbers, found, natural, other.get(name, math.nan))


def _cost(method: Method, nodes: int, increments: int) -> float:
    """About what a run costs: 20 increments at 201 nodes as much as 6 paths, at 401 nodes as much as 20."""
    return float(nodes**2 * (1.0 if method == "path" else 0.5 * increments))

"""Convergence studies: the reported quantities on ever finer grids, and with ever more load increments."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess.outputs import ROUNDING
from fastpin.errors import InputError
from fastpin.model import LoadHistory, Problem, checks, synonyms
from fastpin.model.doubts import doubts, doubts_given, warn_of
from fastpin.model.grid import MAX_NODES, Grid
from fastpin.model.options import Method, SolveOptions
from fastpin.model.read_only import ReadOnly
from fastpin.solver import ArcError, Result, SolveError, solve
from fastpin.solver.arc import first_direction
from fastpin.solver.task import Task, as_history, follow_on_arcs
from fastpin.states.error_bars import PLACE_FLOOR, spacing
from fastpin.states.quantities import QUANTITIES, ZONES, matching_values, quantity, size, sizes, values
from fastpin.states.state import State
from fastpin.studies.extrapolate import Estimate, estimate
from fastpin.studies.outcome_tables import Outcomes, outcomes_from
from fastpin.studies.outcomes import OutcomeValue, StudyOutcome, check_loadable, value_of

LEAST_GRIDS = 3
"""Fewest grids, or numbers of increments, of a study."""

LEAST_NODES = 51
"""Fewest nodes of a grid."""

LEAST_CLOSED = 10
"""Fewest nodes in contact. A coarser grid says nothing about the quantities of finer grids."""

LEAST_REFERENCE = 1e-3
"""Least reference of relative differences, in parts of the quantity's size. A value near zero says nothing."""

NODES = (101, 201, 401, 801)
"""Default numbers of nodes."""

StudyProgress = Callable[[float, float, str], None]
"""Receives the work that is done, all the work, and the name of the present run."""


class QuantitySeries(NamedTuple):
    """One quantity at one corner.

    Attributes
    ----------
    corner : int
        Counted from 1.
    name : str
        See :data:`fastpin.states.QUANTITIES`. Or the name of an outcome of the user.
    values : tuple of float
        Values for every grid or every number of increments, SI or in the units of a dimensionless problem, angles in
        rad. NaN stands for a value that can't be compared with the last one.
    estimate : Estimate
        Verdict, observed order, limit, error bar of the last value, and scatter of the last values.
    size : float
        The natural size of the quantity, see :func:`fastpin.states.quantities.size`.
    reference : float
        The size to which differences are relative. It is the magnitude of the last value, and of a place on the hole
        the width of the contact. It is at least a thousandth of the natural size.
    path : float
        In a study of increments, the value of the path solver on the same grid. In a study of grids, NaN.
    outcome : Outcome or None
        The outcome of the user. None for a quantity. An outcome belongs to the history up to its corner.
    """

    corner: int
    name: str
    values: tuple[float, ...]
    estimate: Estimate
    size: float
    reference: float
    path: float
    outcome: StudyOutcome | None = None


@dataclass(frozen=True)
class Study:
    """The series of one solver.

    Attributes
    ----------
    method : {"path", "increment"}
    counts : tuple of int
        Numbers of nodes for "path", numbers of increments in each step for "increment".
    nodes : int
        Nodes of the grid; of the finest grid for "path".
    series : tuple of QuantitySeries
        The series of all quantities, corner by corner.
    """

    method: Method
    counts: tuple[int, ...]
    nodes: int
    series: tuple[QuantitySeries, ...]

    @property
    def of_grids(self) -> bool:
        """Whether its values are those of several grids, not of several numbers of increments."""
        return self.method == "path"


@dataclass(frozen=True)
class Convergence(ReadOnly):
    """A convergence study.

    Attributes
    ----------
    problem : Problem
    grid : Grid
        The finest grid. All other grids are on its arc.
    loads : dict of int to dict
        The loads at the studied corners. Corners are counted from 1.
    studies : tuple of Study
        The study of the path solver. With increments, also the study of the increment solver.
    complete : bool
        False after an interrupt, or after a grid that can't follow the loads. Finer grids, increments or later corners
        are then missing.
    unread : dict of str to str
        Outcomes that could not be read on a grid, and the first reason.
    """

    problem: Problem
    grid: Grid
    loads: dict[int, dict[str, float]]
    studies: tuple[Study, ...]
    complete: bool = True
    unread: dict[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        counts = ", ".join(f"{study.method}: {'-'.join(map(str, study.counts))}" for study in self.studies)
        return f"<Convergence: {counts}; corners {', '.join(map(str, self.loads))}>"

    @property
    def arc(self) -> tuple[float, float]:
        """Start and stop of the nodes, rad."""
        start = float(self.grid.theta[0])
        return start, 2.0 * math.pi + start if self.grid.closed else float(self.grid.theta[-1])


class StudyInterrupted(KeyboardInterrupt):
    """Ctrl-C during a study. ``study`` holds the finished grids, or None for fewer than three grids."""

    def __init__(self, study: Convergence | None) -> None:
        super().__init__("interrupted")
        self.study = study


class StudyLostError(SolveError):
    """A grid can't follow the loads, or does not fit in memory. The message names the grid.

    ``study`` holds the corners before the lost corner, or the grids before the grid that was too large. It is None
    without such a corner, or with fewer than three grids.
    """

    study: Convergence | None = None
    """The finished part of the study, or None."""


@synonyms.explains_keywords
def converge(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    nodes: Sequence[int] = NODES,
    increments: Sequence[int] = (),
    increment_nodes: int | None = None,
    corner: int | None = None,
    arc: tuple[float, float] | None = None,
    progress: StudyProgress | None = None,
    outcomes: Mapping[str, Any] | None = None,
) -> Convergence:
    """Follow a history on several grids, and estimate how its quantities converge.

    All grids are on one arc: `arc`, or the arc that a coarse run chooses as in :func:`fastpin.solve`. On as many grids
    as possible, a node lies in the direction of the first force.

    Parameters
    ----------
    problem, history
        See :func:`fastpin.solve`.
    nodes : sequence of int
        At least three numbers of nodes, increasing, at least 51 each. Each number must exceed the one before by a
        tenth. Multiples of the numbers of intervals, as in 101, 201, 401, give the smoothest sequences.
    increments : sequence of int
        Also follow the history with the increment solver, with these numbers of increments in each step: at least
        three, increasing.
    increment_nodes : int, optional
        Nodes of the increment solver's grid. By default the first number of `nodes` from 201 on, or else the last.
    corner : int, optional
        The studied corner, counted from 1. Later corners are not followed; they only take part in the choice of the
        arc. By default all corners of a history of up to six, or else the last corner.
    arc : (float, float), optional
        Start and end angle, rad. A difference of 2 pi means the whole circle.
    progress : callable, optional
        Called as ``progress(done, total, label)`` now and then. `done` and `total` are in units of some constant time.
        `label` names the present run.
    outcomes : mapping of str, optional
        Numbers to study besides the quantities, see :func:`fastpin.studies.outcome_tables.outcomes_from`. They are read
        from the history up to the last studied corner, whose corners are then all kept, with slip sums.

    Returns
    -------
    Convergence

    Raises
    ------
    InputError
        Naming the field that can't be used, before any grid is solved. Also if a grid has too few nodes in contact.
    StudyLostError
        If a grid can't follow the loads to the end, or does not fit in memory. The message names the grid. The error
        holds the finished part of the study.
    StudyInterrupted
        After Ctrl-C. It holds the study of the finished grids, if there are three.
    """
    checks.check_callable("progress", progress, 3)
    counts = _increasing("nodes", nodes, LEAST_NODES, MAX_NODES)
    for before, after in pairwise(counts):
        if after < 1.1 * before:
            raise InputError("nodes", f"must grow by a tenth at least to show an order, but {after} follows {before}")
    steps = () if _is_empty(increments) else _increasing("increments", increments, 1)
    single = next((count for count in counts if count >= 201), counts[-1])
    if increment_nodes is not None:
        if not steps:
            raise InputError("increment_nodes", "is for the increment solver: give increments, too")
        single = checks.whole_number("increment_nodes", increment_nodes, LEAST_NODES, MAX_NODES)
    task = Task(problem, as_history(history), SolveOptions(nodes=counts[0], arc=arc))
    if corner is not None and checks.whole_number("corner", corner, 1) > len(task.history):
        words = f"must be one of the history, 1 to {len(task.history)}"
        raise InputError("corner", f"{words}, not {checks.as_toml(corner)}")
    chosen = _checked_outcomes({} if outcomes is None else outcomes)
    warn_of(doubts(problem, task.history, task.options), 3)  # above are the explanation of keywords and the user
    return _Work(task, counts, steps, single, corner, progress, chosen).study()


def _checked_outcomes(outcomes: Mapping[str, Any]) -> Outcomes:
    chosen = outcomes_from(outcomes)
    for name in chosen:
        if name in QUANTITIES or (name.startswith(ZONES) and name.endswith(("_start", "_stop"))):
            raise InputError("outcomes", f"{name}: is a quantity that every study has; choose another name")
    check_loadable(chosen)
    return chosen


def _is_empty(values: object) -> bool:
    return values.size == 0 if isinstance(values, np.ndarray) else isinstance(values, Sequence) and not values


def _increasing(field: str, numbers: object, least: int, most: int | None = None) -> tuple[int, ...]:
    listed: list[Any] = []
    if isinstance(numbers, Sequence | np.ndarray) and not isinstance(numbers, (str, bytes)):
        listed = checks.items(field, numbers, "a list of numbers")
    if len(listed) < LEAST_GRIDS:
        words = f"must be at least {LEAST_GRIDS} numbers, from which an order follows"
        raise InputError(field, f"{words}, not {checks.as_toml(numbers)}")
    checked = tuple(checks.whole_number(field, number, least, most) for number in listed)
    for before, after in pairwise(checked):
        if after <= before:
            raise InputError(field, f"must increase from one to the next, but {after} follows {before}")
    return checked


class _Work:
    """The runs of one study, and their results."""

    def __init__(
        self,
        task: Task,
        counts: tuple[int, ...],
        increments: tuple[int, ...],
        increment_nodes: int,
        corner: int | None,
        progress: StudyProgress | None,
        outcomes: Outcomes,
    ) -> None:
        self.outcomes = outcomes
        self.read: dict[Result, dict[str, OutcomeValue]] = {}
        self.task, self.counts, self.increments, self.single = task, counts, increments, increment_nodes
        self.history = task.history if corner is None else task.history[:corner]
        corners = len(self.history)
        self.every = corner is None and corners <= 6  # of a longer history the last corner is studied
        self.corners = range(1, corners + 1) if self.every else range(corners, corners + 1)
        self.keep = "corners" if self.every or outcomes else f"every {corners}"
        self.lost: StudyLostError | None = None
        self.progress = progress
        self.done = 0.0
        self.total = sum(_cost("path", count, 0) for count in (*counts, *self._path_apart()))
        self.total += sum(_cost("increment", self.single, count) for count in increments)
        self.results: dict[int, Result] = {}  # results of the path solver, by number of nodes
        self.increment_results: list[Result] = []

    def study(self) -> Convergence:
        """Solve all runs and return the study. See :func:`converge` for the errors."""
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
        """Return the study of the finished grids, or None for fewer than three."""
        enough = sum(count in self.results for count in self.counts) >= LEAST_GRIDS
        return self._convergence(complete=False) if enough else None

    def _path_apart(self) -> list[int]:
        """Return the increment solver's number of nodes, unless the path solver has such a grid anyway."""
        return [self.single] if self.increments and self.single not in self.counts else []

    def _follow(self) -> None:
        """Solve all grids on the first arc that is wide enough for all of them, then all increments."""
        common = math.gcd(*(count - 1 for count in self.counts))
        coarsest = common + 1 if common >= LEAST_NODES - 1 else self.counts[0]
        coarse = replace(self.task, options=self.task.options.changed(nodes=coarsest))
        arc = follow_on_arcs(coarse.arcs(), self._follow_grids)
        for count in self.increments:
            self.increment_results.append(self._solve_grid(arc, self.single, "increment", count))

    def _follow_grids(self, arc: Grid, strict: bool) -> Grid:
        """Solve all grids of the path solver on one arc, and return the arc."""
        self.results, self.read, self.done = {}, {}, 0.0
        for count in (*self.counts, *self._path_apart()):
            self.results[count] = self._solve_grid(arc, count, "path", 0)
        return arc

    def _solve_grid(self, arc: Grid, nodes: int, method: Method, increments: int) -> Result:
        """Follow the history on one grid."""
        if arc.closed:
            direction = first_direction(self.task.problem, self.history.distinct())
            grid = Grid.circle(nodes, float(arc.theta[0]) if direction is None else direction)
        else:
            grid = arc.with_nodes(nodes)
        label = f"{nodes} nodes" if method == "path" else f"{increments} increments"
        cost = _cost(method, nodes, increments)

        def progress(done: float, total: int) -> None:
            if self.progress is not None:
                self.progress(self.done + cost * done / total, self.total, label)

        setting = label if method == "path" else f"{label} a step and {nodes} nodes"
        try:
            with doubts_given():
                result = solve(
                    self.task.problem, self.history, method=method, increments=increments or None, grid=grid,
                    keep=self.keep, progress=progress, slip_sums=bool(self.outcomes),
                )  # fmt: skip
        except ArcError as error:
            error.args = (f"with {setting}: {error}",)
            raise
        except SolveError as error:
            lost = StudyLostError(f"with {setting}: {error}", error.step, error.fraction, error.load, error.result)
            if not self.every or error.result is None or error.step < 1:
                raise lost from None
            self.lost, result = self.lost or lost, error.result  # Study the corners before.
            self.corners = range(1, error.step + 1)
            self.history = self.history[: error.step]
        except MemoryError:
            raise StudyLostError(f"with {setting}: not enough memory") from None
        if self.lost is None:
            self.read[result] = {name: value_of(outcome, result) for name, outcome in self.outcomes.items()}
        for corner, state in zip(self.corners, self._states(result), strict=False):
            closed = int(np.count_nonzero(state.pressure))
            if 0 < closed < LEAST_CLOSED:
                field = "nodes" if nodes in self.counts else "increment_nodes"
                words = f"{nodes} put only {closed} in the contact at corner {corner}"
                raise InputError(field, f"{words}; take at least {LEAST_CLOSED}")
        self.done += cost
        return result

    def _states(self, result: Result) -> list[State]:
        """Return the states at the studied corners."""
        return result.states if self.every else result.states[-1:]

    def _convergence(self, complete: bool) -> Convergence:
        counts = tuple(count for count in self.counts if count in self.results)
        results = [self.results[count] for count in counts]
        finest = results[-1]
        intervals = [grid.size - (not grid.closed) for grid in (result.grid for result in results)]
        series = self._series([1.0 / number for number in intervals], results, None)
        studies = [Study("path", counts, counts[-1], tuple(series))]
        steps = self.increments[: len(self.increment_results)]
        if len(steps) >= LEAST_GRIDS:
            spacings, path = [1.0 / step for step in steps], self.results[self.single]
            series = self._series(spacings, self.increment_results, path)
            studies.append(Study("increment", steps, self.single, tuple(series)))
        loads = {corner: state.load for corner, state in zip(self.corners, self._states(finest), strict=False)}
        return Convergence(self.task.problem, finest.grid, loads, tuple(studies), complete, self._unread())

    def _unread(self) -> dict[str, str]:
        """Return the first reason why an outcome could not be read, by its name."""
        unread: dict[str, str] = {}
        for result, read in self.read.items():
            for name, value in read.items():
                if value.reason is not None:
                    unread.setdefault(name, f"{result.grid.size} nodes: {value.reason}")
        return unread

    def _series(
        self, spacings: Sequence[float], results: Sequence[Result], path: Result | None
    ) -> Iterator[QuantitySeries]:
        """Yield the series of all quantities at all corners, and of all outcomes.

        `path` is the path solver's result for comparison.
        """
        for index, corner in enumerate(self.corners):
            last = self._states(results[-1])[index]
            rows = [matching_values(last, self._states(result)[index]) for result in results]
            path_values = {} if path is None else matching_values(last, self._states(path)[index])
            for name, value in values(last).items():
                if math.isfinite(value):
                    numbers, natural_size = tuple(row[name] for row in rows), size(name, last)
                    reference = _reference(quantity(name).kind, value, natural_size)
                    limit = _estimate(quantity(name).kind, spacings, numbers, natural_size, reference, last)
                    path_value = path_values.get(name, math.nan)
                    yield QuantitySeries(corner, name, numbers, limit, natural_size, reference, path_value)
        if self.lost is None:
            yield from self._outcome_series(spacings, results, path)

    def _outcome_series(
        self, spacings: Sequence[float], results: Sequence[Result], path: Result | None
    ) -> Iterator[QuantitySeries]:
        """Yield the series of all outcomes. A value that a result does not have is NaN."""
        last = results[-1][-1]
        for name, outcome in self.outcomes.items():
            read = [self.read[result][name].value for result in (*results, *([path] if path else []))]
            every = [math.nan if value is None else value for value in read]
            if outcome.kind == "angle":  # next to the last one, also across the top
                latest = every[len(results) - 1]
                every = [latest + math.remainder(value - latest, 2.0 * math.pi) for value in every]
            numbers = tuple(every[: len(results)])
            natural_size = sizes(last).get(outcome.kind, max(map(abs, numbers)))
            reference = _reference(outcome.kind, numbers[-1], natural_size)
            limit = _estimate(outcome.kind, spacings, numbers, natural_size, reference, last)
            path_value = every[-1] if path else math.nan
            yield QuantitySeries(self.corners[-1], name, numbers, limit, natural_size, reference, path_value, outcome)


def _reference(kind: str, value: float, natural_size: float) -> float:
    """Return the size to which differences of a quantity are relative, see :class:`QuantitySeries`."""
    return natural_size if kind == "angle" else max(abs(value), LEAST_REFERENCE * natural_size)


def _estimate(
    kind: str, spacings: Sequence[float], numbers: Sequence[float], natural_size: float, reference: float, last: State
) -> Estimate:
    """Return the estimate of a sequence of values of some kind. `last` is the state on the finest grid."""
    limit = estimate(spacings, numbers, ROUNDING * natural_size, reference)
    if kind in ("angle", "width") and limit.bar <= ROUNDING * natural_size:
        # All grids share the nodes at which, or between which, this place was read. Thus equal values show no order.
        return Estimate("converged", math.nan, math.nan, PLACE_FLOOR * spacing(last), limit.scatter)
    return limit


def _cost(method: Method, nodes: int, increments: int) -> float:
    """Return the approximate cost of a run. A path run costs the square of its nodes.

    Measured: 20 increments cost as much as 6 path runs at 201 nodes, and as much as 20 path runs at 401 nodes.
    """
    return float(nodes**2 * (1.0 if method == "path" else 0.5 * increments))

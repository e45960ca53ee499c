"""A task is one history to follow: from no load, from a corner, or from the end of another history.

From no load the nodes are chosen by trial, see :meth:`Task.follow_on_grids`. A run that begins at a corner keeps its
nodes. It is tried strictly, and then not. A strict run ends where the contact is too narrow. Otherwise a contact that
carries next to nothing is let go, and a new one begins without memory.

A history is followed with Ctrl-C held back, and with one thread of BLAS: :func:`deferred_interrupts`,
:func:`one_blas_thread`.
"""

from __future__ import annotations

import functools
import itertools
import logging
import math
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, fields, replace
from types import FrameType
from typing import Any, NamedTuple, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

from fastpin.elasticity.build import build_system
from fastpin.elasticity.system import System
from fastpin.errors import InputError
from fastpin.model.acting import check_arc, check_keep, check_loads
from fastpin.model.checks import as_toml, check_callable, instance
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import REMOTE, THERMAL, Corner, M
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.runtime.threads import STOPPING
from fastpin.solver.arc import candidate_grids
from fastpin.solver.errors import CUT_OFF, ArcError, ConvergenceError, Interrupted, SolveError
from fastpin.solver.result import Restart, Result
from fastpin.solver.run import Recorder, Run, RunProgress
from fastpin.solver.step import pushes

log = logging.getLogger(__name__)

Followed = TypeVar("Followed")

LEAST_LOAD = 1e-50
"""Least force, or remote stress times R, that is the largest of a history, in parts of R/beta*."""


class Unfit(NamedTuple):
    """A grid on which an earlier run has ended, and its error."""

    grid: Grid
    error: SolveError


@dataclass(frozen=True, eq=False)
class Task:
    """A history to follow, with its options. Problem, history, options and grid are checked together.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
    options : SolveOptions
    grid : Grid, optional
        A ready grid. ``options.nodes`` is then not used.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)`` now and then.
    save_after : frozenset of int
        Numbers of corners after which the recorder saves a restart.

    Raises
    ------
    InputError
        If a field can't be used. The error names the field.
    """

    problem: Problem
    history: LoadHistory
    options: SolveOptions = field(default_factory=SolveOptions)
    grid: Grid | None = None
    progress: RunProgress | None = None
    save_after: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        instance("problem", self.problem, Problem, "a Problem")
        object.__setattr__(self, "history", as_history(self.history))
        if self.grid is not None:
            instance("grid", self.grid, Grid, "a Grid")
            if not self.grid.closed and (reason := self.problem.needs_circle):
                raise InputError("grid", f"{reason}: it needs the whole circle")
        check_callable("progress", self.progress)
        check_loads(self.problem, self.history)
        check_arc(self.problem, self.options)
        check_keep(self.history, self.options)

    def follow(self, recorder: Recorder, unfit: Unfit | None = None) -> None:
        """Follow the history from no load, on the first grid that is wide enough and fine enough.

        With `unfit` the grid is chosen anew, from those that are tried after this one.

        Raises
        ------
        SolveError
            If the history can't be followed to its end.
        Interrupted
            After Ctrl-C.
        """
        with deferred_interrupts() as caught, one_blas_thread():
            progress = self._stoppable_progress(caught)
            chooser = self if unfit is None else replace(self, grid=None)
            run = chooser.follow_on_grids(functools.partial(self._follow_on, recorder, progress, None), progress, unfit)
            if run.statistics["released"]:
                log.warning(
                    "%d times a narrow contact that carried less than 0.1 %% of the force was let go and lost its "
                    "memory",
                    run.statistics["released"],
                )

    def follow_on_grids(
        self,
        follow: Callable[[Grid, bool], Followed],
        progress: RunProgress | None = None,
        unfit: Unfit | None = None,
        arcs: Callable[[], Iterable[Grid]] | None = None,
    ) -> Followed:
        """Follow the history on one grid after the other, until it is followed from no load to its end.

        1. Equally spaced nodes: those of the user, or nodes on the arc that a coarse run chooses. Wider arcs follow, up
           to the whole circle, if the contact reaches an end.
        2. Graded grids, if the contact gets too narrow for these nodes. They are dense where a survey of the history
           finds narrow contacts. Nodes that the user has chosen have no graded grids.
        3. The arcs once more, not strictly, if graded grids do not help.

        Parameters
        ----------
        follow : callable
            ``follow(grid, strict)`` follows the history on a grid. What it returns is returned.
        progress : callable, optional
            Called during coarse runs.
        unfit : Unfit, optional
            The tries begin after this one.
        arcs : callable, optional
            Gives equally spaced nodes in place of :meth:`arcs`.

        Raises
        ------
        SolveError
            The error of the last try.
        """
        arcs = functools.partial(self.arcs, progress) if arcs is None else arcs
        try:
            if unfit is None:
                return follow_on_arcs(arcs(), follow)
            if isinstance(unfit.error, ArcError):
                return follow_on_arcs(after_grid(unfit.grid, arcs()), follow)
            raise unfit.error
        except ConvergenceError as error:
            if self.options.method != "path":
                raise
            lost = error
        for grid in self._graded(progress, unfit):
            log.info("%s: once more with %d nodes that are dense where the contact is narrow", lost, grid.size)
            try:
                return follow(grid, True)
            except ConvergenceError as error:
                lost = error
        log.info("%s", lost)
        return follow_on_arcs(arcs(), follow, strict=False)

    def arcs(self, progress: RunProgress | None = None) -> Iterator[Grid]:
        """Equally spaced nodes: those of the user, or candidates that grow to the whole circle."""
        nodes, arc = self.options.nodes, self.options.arc
        if self.grid is not None:
            return iter([self.grid])
        if arc is None:
            return candidate_grids(self.problem, self.history.distinct(), self.force, nodes, progress)
        return iter([Grid.circle(nodes, arc[0]) if self.options.is_full_turn else Grid.arc(arc[0], arc[1], nodes)])

    def _graded(self, progress: RunProgress | None, unfit: Unfit | None) -> Iterable[Grid]:
        """Graded grids for narrow contacts. If an earlier run has ended on one of them, the grids after it."""
        if self.grid is not None or self.options.arc is not None:
            return ()
        from fastpin.narrow import narrow_grids

        grids = narrow_grids(self.problem, self.history.distinct(), self.force, self.options, progress)
        if unfit is None:
            return grids
        listed = list(grids)
        return after_grid(unfit.grid, listed) if any(_is_same(grid, unfit.grid) for grid in listed) else listed

    @functools.cached_property
    def force(self) -> float:
        """The reference force of the history, N/m."""
        return reference_force(self.problem, self.history.distinct())

    def continue_from(self, recorder: Recorder | None, start: Restart, grid: Grid, strict: bool = False) -> Run:
        """Continue the history from a corner that another run reached, on the grid of that run, and return the run.

        With `strict`, a contact that gets too narrow for the nodes is an error, also where it carries next to nothing.

        Raises
        ------
        SolveError, Interrupted
            See :meth:`follow`.
        """
        with deferred_interrupts() as caught, one_blas_thread():
            progress = self._stoppable_progress(caught)
            try:
                return self._follow_on(recorder, progress, start, grid, strict=True)
            except ConvergenceError:
                if strict:
                    raise
                return self._follow_on(recorder, progress, start, grid, strict=False)

    def branch(self, recorder: Recorder, start: Restart, grid: Grid) -> None:
        """Follow the history from the end of another history, on the grid of that history.

        Raises
        ------
        SolveError, Interrupted
            See :meth:`follow`.
        """
        try:
            self.continue_from(recorder, start.for_new_history(), grid)
        except ArcError as error:
            error.args = (
                f"{error}; here the arc is fixed by the result to continue from: solve that result on a wider arc",
            )
            raise

    def _follow_on(
        self, recorder: Recorder | None, progress: RunProgress, start: Restart | None, grid: Grid, strict: bool
    ) -> Run:
        """Follow the history on one grid, from `start` or from no load; see :class:`Run` for `strict`."""
        is_joint = self.problem.seat is not None
        build = build_system if is_joint or self.options.method == "path" else System.build
        system = build(self.problem, grid, self.force if start is None else start.force)
        run = Run(self.history, system, self.options, recorder, progress, start, self.save_after, strict)
        if recorder is not None:
            recorder.begin(run)
        run.follow()
        return run

    def _stoppable_progress(self, caught: list[int]) -> RunProgress:
        """The progress callable of a run. It raises Interrupted, which stops the run, after a `caught` Ctrl-C."""

        def progress(done: float, total: int) -> None:
            if caught:
                raise Interrupted
            if self.progress is not None:
                self.progress(done, total)

        return progress


def follow_on_arcs(arcs: Iterable[Grid], follow: Callable[[Grid, bool], Followed], strict: bool = True) -> Followed:
    """Follow a history on one arc after the other, until the contact keeps clear of its ends.

    Returns what ``follow(grid, strict)`` returns.

    Raises
    ------
    SolveError
        The error of the last try.
    """
    lost = ArcError(CUT_OFF)
    for number, grid in enumerate(arcs):
        if number:
            log.info("the contact reaches an end of the arc: once more on a wider one")
        log.info("%d nodes from %.5g to %.5g rad", grid.size, grid.theta[0], grid.theta[-1])
        try:
            return follow(grid, strict)
        except ArcError as error:
            lost = error
    raise lost


def after_grid(grid: Grid, grids: Iterable[Grid]) -> Iterator[Grid]:
    """The grids that come after `grid` among `grids`."""
    return itertools.islice(itertools.dropwhile(lambda other: not _is_same(other, grid), grids), 1, None)


def _is_same(one: Grid, two: Grid) -> bool:
    """Whether two grids have the same nodes, up to rounding."""
    return one.size == two.size and bool(np.allclose(one.theta, two.theta, rtol=0.0, atol=1e-9))


def as_history(history: LoadHistory | Sequence[Corner], field: str = "history") -> LoadHistory:
    """A load history from corners, or the history itself.

    Raises
    ------
    InputError
        If it is neither. The error names the `field`.
    """
    if isinstance(history, LoadHistory):
        return history
    if not isinstance(history, (Sequence, Mapping)):
        raise InputError(field, f"must be a LoadHistory or a list of corners, not {as_toml(history)}")
    return LoadHistory(history)


def check_options(options: SolveOptions, grid: Grid | None, start: Result | None) -> None:
    """Raise :class:`InputError` if an arc is given together with a grid; log a warning of states that are not kept."""
    if options.between and not options.keep_rule.inside:
        log.warning('between has no effect with keep = "%s": states inside steps are not kept', options.keep)
    if grid is not None and options.arc is not None:
        raise InputError("arc", "has no effect where a grid is given; leave it out")
    for name, value in (("grid", grid), ("arc", options.arc)):
        if start is not None and value is not None:
            raise InputError(name, "has no effect with start: the grid is the one of that result; leave it out")


def check_start(problem: Problem, start: Result) -> None:
    """Raise :class:`InputError` if another solution of `problem` can't continue from a result."""
    instance("start", start, Result, "a Result")
    if start.problem != problem:
        names = [
            each.name for each in fields(problem) if getattr(start.problem, each.name) != getattr(problem, each.name)
        ]
        differing = f"the result to continue from belongs to another problem; not the same: {', '.join(names)}"
        raise InputError("start", f"{differing}; only the loads and options of the solver may differ")
    if start.restart is None:
        raise InputError("start", "nothing can continue from this result: its file holds states only")


def reference_force(problem: Problem, values: np.ndarray) -> float:
    """The reference force F of a history, N/m: its largest load, rounded up.

    It is R/beta* times a power of two, so that no bit of a result depends on it. A moment M counts as M/R. Remote
    stresses times R, and strains of temperatures times R/beta*, count only where no force and no moment acts. The
    reaction to a prescribed displacement is estimated. `values` are the loads at the corners, SI, of the shape
    (corners, loads).

    Raises
    ------
    InputError
        If the largest load is below :data:`LEAST_LOAD`, but not 0.
    """
    radius = problem.hole_radius
    force = pushes(problem, values)
    pin = float(np.hypot(force[:, 1], force[:, 0]).max())
    moment = float(np.abs(values[:, M]).max()) / radius
    remote = float(np.abs(values[:, REMOTE]).max()) * radius
    unit = radius / problem.surfaces.beta_star
    thermal = max(abs(each or 0.0) for each in problem.expansions) * float(np.abs(values[:, THERMAL]).max()) * unit
    largest = max(pin, moment) or remote or thermal or unit
    if largest < LEAST_LOAD * unit:
        printed = units(problem)["force"]
        least = f"{LEAST_LOAD:g} times R/beta* = {printed.factor * unit:g} {printed.name}"
        raise InputError("history", f"the largest load must be at least {least}, or all zero")
    return unit * 2.0 ** math.ceil(math.log2(largest / unit))


@contextmanager
def deferred_interrupts() -> Iterator[list[int]]:
    """Note the signal of a first Ctrl-C in a list instead of raising. A second one raises KeyboardInterrupt as usual.

    Outside the main thread, and where the program has its own handlers, the first Ctrl-C is not held back. SIGTERM and
    SIGHUP are treated like Ctrl-C if the program has given them Python's handler of SIGINT.
    """
    caught: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if caught:
            signal.default_int_handler(number, frame)
        caught.append(number)

    held = []
    if threading.current_thread() is threading.main_thread():
        held = [number for number in STOPPING if signal.getsignal(number) is signal.default_int_handler]
    for number in held:
        signal.signal(number, note)
    try:
        yield caught
    finally:
        for number in held:
            signal.signal(number, signal.default_int_handler)


def one_blas_thread() -> AbstractContextManager[Any]:
    """A context with one thread for BLAS, so that results don't depend on the number of cores.

    Large products have two threads all the same (runtime/products.py).
    """
    libraries = _blas_libraries()
    if all(library.num_threads == 1 for library in libraries.lib_controllers):
        return nullcontext()
    return libraries.limit(limits=1)


@functools.cache
def _blas_libraries() -> ThreadpoolController:
    """The BLAS libraries of this process. Finding them takes longer than a small step."""
    return ThreadpoolController().select(user_api="blas")

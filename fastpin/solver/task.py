"""A task is one history to follow: from no load, from a corner, or from the end of another history.

It is followed with Ctrl-C held back, and with one thread of BLAS: :func:`deferred_interrupts`, :func:`one_blas_thread`.
"""

from __future__ import annotations

import functools
import logging
import math
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, fields, replace
from types import FrameType
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from fastpin.elasticity.large import build_system
from fastpin.elasticity.system import System
from fastpin.errors import InputError
from fastpin.model.case import check_arc, check_keep
from fastpin.model.checks import as_toml, check_callable, instance
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory, check_loads
from fastpin.model.loads import REMOTE, Corner, M
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.runtime.threads import STOPPING
from fastpin.solver.attempts import Attempts, Unfit
from fastpin.solver.errors import ArcError, ConvergenceError, Interrupted
from fastpin.solver.result import Restart, Result
from fastpin.solver.run import Recorder, Run, RunProgress
from fastpin.solver.step import pushes

log = logging.getLogger(__name__)

LEAST_LOAD = 1e-50
"""Least force, or remote stress times R, that is the largest of a history, in parts of R/beta*."""


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
    stops : frozenset of int
        Numbers of corners at which the recorder wants to see the run.

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
    stops: frozenset[int] = frozenset()

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

        With `unfit` the grid is chosen anew, and only the attempts after this one are made.

        Raises
        ------
        SolveError
            If the history can't be followed to its end.
        Interrupted
            After Ctrl-C.
        """
        with deferred_interrupts() as request, one_blas_thread():
            progress = self._stoppable_progress(request)
            attempts = self.attempts(progress) if unfit is None else replace(self.attempts(progress), grid=None)
            run = attempts.first_followed(functools.partial(self._follow_on, recorder, progress, None), unfit=unfit)
            if run.statistics["released"]:
                log.warning(
                    "%d times a narrow contact that carried less than 0.1 %% of the force was let go and lost its "
                    "memory",
                    run.statistics["released"],
                )

    def attempts(self, progress: RunProgress | None = None) -> Attempts:
        """The attempts at this history. Coarse runs report their `progress`."""
        return Attempts(self.problem, self.history.distinct(), self.force, self.options, self.grid, progress)

    @property
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
        with deferred_interrupts() as request, one_blas_thread():
            progress = self._stoppable_progress(request)
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
        run = Run(self.history, system, self.options, recorder, progress, start, self.stops, strict)
        if recorder is not None:
            recorder.begin(run)
        run.follow()
        return run

    def _stoppable_progress(self, request: StopRequest) -> RunProgress:
        """The progress callable of a run. After Ctrl-C it raises Interrupted, which stops the run."""

        def progress(done: float, total: int) -> None:
            if request.stop:
                raise Interrupted
            if self.progress is not None:
                self.progress(done, total)

        return progress


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
    stresses times R count only where no force and no moment acts. The reaction to a prescribed displacement is
    estimated. `values` are the loads at the corners, SI, shape (corners, loads).

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
    largest = max(pin, moment) or remote or unit
    if largest < LEAST_LOAD * unit:
        printed = units(problem)["force"]
        least = f"{LEAST_LOAD:g} times R/beta* = {printed.factor * unit:g} {printed.name}"
        raise InputError("history", f"the largest load must be at least {least}, or all zero")
    return unit * 2.0 ** math.ceil(math.log2(largest / unit))


class StopRequest:
    """A request to stop. ``stop`` becomes True at the first Ctrl-C."""

    def __init__(self) -> None:
        self.stop = False


@contextmanager
def deferred_interrupts() -> Iterator[StopRequest]:
    """Note a first Ctrl-C in the request instead of raising. A second Ctrl-C raises KeyboardInterrupt as usual.

    Outside the main thread, and where the program has its own handlers, the first Ctrl-C is not held back. SIGTERM and
    SIGHUP are treated like Ctrl-C if the program has given them Python's handler of SIGINT.
    """
    request = StopRequest()

    def note(number: int, frame: FrameType | None) -> None:
        if request.stop:
            signal.default_int_handler(number, frame)
        request.stop = True

    held = []
    if threading.current_thread() is threading.main_thread():
        held = [number for number in STOPPING if signal.getsignal(number) is signal.default_int_handler]
    for number in held:
        signal.signal(number, note)
    try:
        yield request
    finally:
        for number in held:
            signal.signal(number, signal.default_int_handler)


def one_blas_thread() -> AbstractContextManager[Any]:
    """A context with one thread for BLAS, so that results don't depend on the number of cores.

    Large products have two threads all the same (runtime/products.py).
    """
    return _blas_libraries().limit(limits=1, user_api="blas")


@functools.cache
def _blas_libraries() -> ThreadpoolController:
    """The BLAS libraries of this process. Finding them takes longer than a small step."""
    return ThreadpoolController()

"""Batches of runs for an executor, or for a pool of processes that survives their deaths: sweeps, and many cases."""

from __future__ import annotations

import functools
import itertools
import multiprocessing
import os
import signal
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from multiprocessing import resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

from fastpin.errors import FastpinError, InputError
from fastpin.model.case import Case
from fastpin.model.checks import instance, items, whole_number
from fastpin.model.doubts import doubts, doubts_given, warn_of
from fastpin.runtime.jit import limit_to_one_thread
from fastpin.runtime.threads import in_one_thread
from fastpin.solver import Result, SolveError, solve
from fastpin.storage import layout
from fastpin.studies.index import Index
from fastpin.studies.outcomes import OutcomeValue, check_loadable, pickled, values_in_worker
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import RunEnd
from fastpin.studies.run_kinds import RUNS
from fastpin.version import __version__

K = TypeVar("K")
T = TypeVar("T")

DIED = "the worker process died; perhaps it needed more memory than there is"
"""Reason of a run whose worker process died."""

MOST_SUBMITTED = 1_000
"""Most tasks in a user's executor at a time: enough for a cluster."""

Batch = tuple[K, ...]
"""Tasks that a worker does one after the other. Their return values come back together."""

Submit = Callable[[Executor, Batch[K]], "Future[list[T]]"]
"""Submits a batch to an executor."""


Size = Callable[[int], int]
"""Number of tasks of the next batch, from the number of tasks that wait."""


class WorkerDiedError(Exception):
    """The process of a task died."""


class BrokenError(Exception):
    """An executor broke, or cancelled its tasks. ``tasks`` were submitted, and their batches had not ended."""

    def __init__(self, tasks: list[Any]) -> None:
        super().__init__("the executor broke")
        self.tasks = tasks


class Pool:
    """Worker processes, spawned, with one thread each.

    Parameters
    ----------
    workers : int
        Number of processes.

    Attributes
    ----------
    executor : ProcessPoolExecutor

    Raises
    ------
    FastpinError
        If the processes don't start.
    """

    def __init__(self, workers: int) -> None:
        context = multiprocessing.get_context("spawn")
        before = set(multiprocessing.active_children())
        resource_tracker.ensure_running()  # Start it before: its start would release the held signals.
        with _interrupts_held_back():  # Workers inherit the blocked signal.
            self.executor = ProcessPoolExecutor(workers, mp_context=context, initializer=prepare)
            first, *_ = [self.executor.submit(os.getpid) for _ in range(workers)]  # Each task starts a process.
        self._processes = set(multiprocessing.active_children()) - before
        try:
            first.result()
        except BrokenExecutor:
            words = 'a script that runs a sweep must do so under if __name__ == "__main__", because they import it'
            raise FastpinError(f"worker processes can't be started; {words}") from None

    def stop(self, busy: bool = True) -> None:
        """End the workers. Busy workers are killed."""
        if busy:
            for process in self._processes:
                process.kill()
        self.executor.shutdown(cancel_futures=True)


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Hold Ctrl-C back until the block ends."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


Ended = Generator[tuple[Batch[K], list[T] | BaseException], None, None]
"""Yields each batch with its return values or exception when it ends."""


def through(
    executor: Executor, waiting: deque[K], submit: Submit[K, T], size: Size = lambda _: 1, ahead: int = MOST_SUBMITTED
) -> Ended[K, T]:
    """Run tasks with any executor. Yield each batch with its return values or exception when it ends.

    At most `ahead` batches are submitted at a time. A submitted task leaves `waiting`.

    Raises
    ------
    BrokenError
        If the executor breaks. It holds the submitted tasks.
    """
    running: dict[Future[list[T]], Batch[K]] = {}
    ended_futures: SimpleQueue[Future[list[T]]] = SimpleQueue()
    try:
        while waiting or running:
            while waiting and len(running) < ahead:
                batch = tuple(itertools.islice(waiting, size(len(waiting))))
                try:
                    future = submit(executor, batch)
                except RuntimeError:  # The executor is broken, or shut down.
                    raise BrokenExecutor from None
                running[future] = batch
                for _ in batch:
                    waiting.popleft()
                future.add_done_callback(ended_futures.put)
            future = ended_futures.get()
            error = future.exception()
            if isinstance(error, BrokenExecutor):
                raise error
            yield running.pop(future), future.result() if error is None else error
    except (BrokenExecutor, CancelledError):  # A task ended with it.
        raise BrokenError([task for batch in running.values() for task in batch]) from None
    finally:
        for future in running:
            future.cancel()


def through_processes(
    workers: int, tasks: Collection[K], submit: Submit[K, T], size: Size = lambda _: 1, alone: bool = False
) -> Ended[K, T]:
    """Run tasks in worker processes. Yield each batch with its return values or exception when it ends.

    After the death of a process all submitted tasks are repeated, one task at a time (`alone`). A task whose process
    dies again gets a :class:`WorkerDiedError`.
    """
    waiting = deque(tasks)
    while waiting:
        suspects: list[K] = []
        pool = Pool(min(workers, len(waiting)))
        busy = True
        try:
            yield from through(pool.executor, waiting, submit, size, 1 if alone else 2 * workers)
            busy = False
        except BrokenError as broken:
            suspects = broken.tasks or [waiting.popleft()]
        finally:
            pool.stop(busy)
        if alone:
            yield from (((task,), WorkerDiedError(DIED)) for task in suspects)
        elif suspects:
            yield from through_processes(1, suspects, submit, alone=True)


def prepare() -> None:
    """Make this process a worker: one thread, deaf to Ctrl-C. It ends when the main process ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # The main process handles interrupts.
    threading.Thread(target=_end_with_parent, daemon=True).start()
    limit_to_one_thread()
    one_thread()


@functools.cache
def one_thread() -> None:
    """Limit every BLAS and OpenMP library of this process to one thread, from now on."""
    threadpool_limits(limits=1)


PickledOutcomes = dict[str, tuple[str, bytes]]
"""Definition and pickled outcome by name, see :func:`fastpin.studies.outcomes.values_in_worker`."""


@dataclass(frozen=True)
class Setting:
    """What all tasks of one call of a sweep share.

    Attributes
    ----------
    main_process : int
        Process id of the sweep. The threads of this process are not limited by its tasks.
    version : str
        Version of fastpin in the sweep. Another version in a worker is a failure.
    most : int
        Largest packed result, bytes. A larger result gets a file of its own; 0: every result.
    form : str
        The kind of the base file, see :data:`fastpin.studies.run_kinds.RUNS`.
    """

    main_process: int
    version: str
    most: int
    form: str = "case file"

    def begin(self) -> str | None:
        """Limit the threads of a worker. Return why it can't work for this sweep, or None."""
        if os.getpid() != self.main_process:
            one_thread()
        other = f"the worker has fastpin {__version__}, the sweep {self.version}"
        return None if self.version == __version__ else other


def in_turn(function: Callable[..., RunEnd], batch: list[tuple[Any, ...]], setting: Setting) -> list[RunEnd]:
    """Call a function with the arguments of each run of a batch, its id first, and the setting: what a worker does."""
    if (refused := setting.begin()) is not None:
        return [RunEnd(run, refused) for run, *_ in batch]
    with in_one_thread(), doubts_given():
        return [function(*arguments, setting) for arguments in batch]


def solve_run(run: str, case: Any, path: str, outcomes: PickledOutcomes, setting: Setting) -> RunEnd:
    """Solve one case or joint, pack or save its result, and read its outcomes.

    Parameters
    ----------
    run : str
        Id of the run.
    case : Case or JointFile
    path : str
        HDF5 file of a result that is too large to be packed. It is written only if there is a state.
    outcomes : dict of str to (str, bytes)
        Definition and pickled outcome by name.
    setting : Setting

    Returns
    -------
    RunEnd
        Key figures, times, outcomes and the packed result. Every exception of the run becomes the reason of a failure.
        An exception of an outcome becomes the reason of its missing value.
    """
    started, host = datetime.now(UTC).isoformat(timespec="milliseconds"), socket.gethostname()
    ended = functools.partial(RunEnd, run, started=started, host=host, versions=layout.versions())
    began, way = time.perf_counter(), RUNS[setting.form]
    result: Any
    try:
        try:
            result, reason = way.solve(case), None
        except SolveError as error:
            result, reason = error.result, str(error)
        seconds = time.perf_counter() - began
        if result is None or not len(result):
            return ended(reason, seconds=seconds)
        figures, bars = way.figures(result)
        content = way.keep(case, result, reason, path, setting.most)
        values = values_in_worker(outcomes, way.judged(result)) if reason is None else {}
        return ended(reason, figures, seconds, outcomes=values, bars=bars, content=content)
    except MemoryError:
        return ended("not enough memory", seconds=time.perf_counter() - began)
    except Exception as error:  # Any error is the failure of this run only. The other runs continue.
        return ended(f"{type(error).__name__}: {error}", seconds=time.perf_counter() - began)


def read_run(run: str, path: str, content: bytes | None, outcomes: PickledOutcomes, setting: Setting) -> RunEnd:
    """Read outcomes from the stored result of a finished run.

    Parameters are those of :func:`solve_run`, and the packed result; None if `path` holds the result.

    Returns
    -------
    RunEnd
        The outcomes and their time. A reason: the result can't be read.
    """
    began = time.perf_counter()
    try:
        result = RUNS[setting.form].read(path, content)
    except Exception as error:  # The other runs continue.
        return RunEnd(run, f"the result can't be read: {error}")
    values = values_in_worker(outcomes, result)
    return RunEnd(run, None, seconds=time.perf_counter() - began, outcomes=values)


def _end_with_parent() -> None:
    """End this worker with its main process. A worker would wait for tasks forever after a kill of the main process."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


MOST_PACKED = 1_000_000
"""Largest result that is kept in the index, bytes. HDF5 takes little of the time of a larger one, and compresses it."""

BATCH_SECONDS = 0.25
"""Time of a batch of runs, s. A kill loses the unfinished batches; a message and a commit take some 5 ms."""

MOST_IN_BATCH = 32
"""Most runs of a batch."""


def pickled_outcomes(plan: Plan) -> PickledOutcomes:
    """Return the outcomes of a plan for workers. The files of functions are run, to find their faults early."""
    check_loadable(plan.outcomes)
    content = {}
    for name, outcome in plan.outcomes.items():
        try:
            content[name] = outcome.definition, pickled(outcome)
        except FastpinError as error:
            raise InputError("outcomes", f"{name}: {error}") from None
    return content


Endings = Generator[list[RunEnd], None, None]
"""Yields the ends of the runs of a batch when it ends."""


@dataclass(eq=False)
class Work:
    """The tasks of one call: runs that are solved, and finished runs whose outcomes are read."""

    plan: Plan
    index: Index
    results: Path
    outcomes: PickledOutcomes
    executor: Executor | None
    workers: int
    files: bool

    def __post_init__(self) -> None:
        self._setting = Setting(os.getpid(), __version__, 0 if self.files else MOST_PACKED, self.plan.base.form)

    def solve(self, todo: Collection[str]) -> Endings:
        """Yield the ends of the runs of each batch when it ends.

        If the worker of a run died, perhaps in a function of the user, the outcomes of the run are left for later.
        """
        submitted: set[str] = set()

        def task(run: str) -> tuple[Any, ...]:
            outcomes = {} if run in submitted else self.outcomes
            submitted.add(run)
            return run, self.plan.case(self.plan.runs[run]), str(self._path(run)), outcomes

        for run in todo:
            self._path(run).unlink(missing_ok=True)  # A damaged file, or the states of a failed run.
        return self._run(neighbours(self.plan, todo), solve_run, task, lambda end: _arrived(end, self._path(end.id)))

    def read(self, missing: dict[str, list[str]]) -> Endings:
        """Yield the outcomes of finished runs, when they are read. `missing` has their names by run."""

        def task(run: str) -> tuple[Any, ...]:
            path = self._path(run)
            packed = None if path.exists() else self.index.content(run)
            return run, str(path), packed, {name: self.outcomes[name] for name in missing[run]}

        def known(end: RunEnd) -> RunEnd:
            if end.reason is None:
                return end
            lost = {name: OutcomeValue(self.outcomes[name][0], None, end.reason) for name in missing[end.id]}
            return RunEnd(end.id, None, outcomes=lost)

        return self._run(missing, read_run, task, known)

    def _run(
        self,
        runs: Collection[str],
        function: Callable[..., RunEnd],
        task: Callable[[str], tuple[Any, ...]],
        seen: Callable[[RunEnd], RunEnd],
    ) -> Endings:
        """Call a function for each run, with the arguments of its `task`, and yield the ends as they are `seen`.

        An exception of a worker is the end of each run of its batch, with the exception as its reason.
        """
        if not runs:
            return
        pace = Pace(self.workers)

        def submit(executor: Executor, batch: Batch[str]) -> Future[list[RunEnd]]:
            return executor.submit(in_turn, function, [task(run) for run in batch], self._setting)

        # An executor may run its tasks in this process. They have one thread for BLAS, as in every worker.
        with threadpool_limits(limits=1, user_api="blas"):
            try:
                if self.executor is not None:  # one run at a time: its workers may be far apart
                    batches = through(self.executor, deque(runs), submit)
                else:
                    batches = through_processes(self.workers, runs, submit, pace.size)
                with closing(batches):
                    for batch, ends in batches:
                        if isinstance(ends, BaseException):
                            died = type(ends).__name__ in ("WorkerDiedError", "KilledWorker")  # KilledWorker is dask's.
                            reason = DIED if died else f"{type(ends).__name__}: {ends}"
                            ends = [RunEnd(run, reason) for run in batch]
                        pace.learn(ends)
                        yield [seen(end) for end in ends]
            except BrokenError:
                raise FastpinError("the executor has stopped working; runs that are finished are kept") from None

    def _path(self, run: str) -> Path:
        return self.results / f"{run}.h5"


class Pace:
    """Chooses the size of batches from the time of the runs that have ended."""

    def __init__(self, workers: int) -> None:
        self._workers, self._runs, self._seconds = workers, 0, 0.0

    def learn(self, ends: list[RunEnd]) -> None:
        """Note the times of some runs. A run without a time has failed before it began."""
        self._runs += len(ends)
        self._seconds += sum(end.seconds or 0.0 for end in ends)

    def size(self, waiting: int) -> int:
        """Number of runs of the next batch: fewer towards the end, so that all workers end together."""
        if self._runs == 0:
            return 1
        by_time = BATCH_SECONDS * self._runs / max(self._seconds, 1e-3)
        return max(1, min(int(by_time), MOST_IN_BATCH, waiting // (4 * self._workers)))


def neighbours(plan: Plan, todo: Collection[str]) -> list[str]:
    """Order runs so that runs follow one another which differ in friction only: such runs share their matrices."""
    groups: dict[str, list[str]] = {}
    for run in todo:
        others = {name: value for name, value in plan.runs[run].values.items() if name != "contact.friction"}
        groups.setdefault(repr(others), []).append(run)
    return [run for group in groups.values() for run in group]


def _arrived(end: RunEnd, path: Path) -> RunEnd:
    """Return the end of a run. A missing result becomes a failure."""
    if end.reason is None and end.content is None and not path.exists():
        return RunEnd(end.id, f"the result did not arrive: {end.host} must see {path.parent} under the same path")
    return end


def solve_many(cases: Iterable[Case], workers: int = 1) -> list[Result | FastpinError]:
    """Solve many cases, and return the result of each, or its error.

    A case that fails does not stop the others. Results have the same bits as those of :func:`fastpin.solve`. The number
    of workers changes no bit. Doubts about the input are warned of before the first case is solved. Yield is not looked
    for.

    Parameters
    ----------
    cases : iterable of Case
        For example of :func:`fastpin.read_case`, or ``Case(problem, history, options)``.
    workers : int
        Number of processes. With 1 the cases are solved in this process. With more the call must stand under
        ``if __name__ == "__main__"``, because the processes import the script.

    Returns
    -------
    list of Result or FastpinError
        In the order of the cases. The message of an error names the place of its case: ``"cases[3]: ..."``, from 0. A
        :class:`fastpin.SolveError` has the states before it in its ``result``.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    given = {f"cases[{k}]": case for k, case in enumerate(items("cases", cases, "a list of cases"))}
    for place, case in given.items():
        instance(place, case, Case, "a Case")
    whole_number("workers", workers, 1)
    warn_of([doubt for case in given.values() for doubt in doubts(case.problem, case.history, case.options)], 2)
    if workers == 1:
        return solve_in_turn(given)

    def submit(executor: Executor, batch: Batch[str]) -> Future[list[Result | FastpinError]]:
        return executor.submit(solve_in_turn, {place: given[place] for place in batch})

    batches = through_processes(workers, given, submit, lambda left: min(MOST_IN_BATCH, -(-left // (4 * workers))))
    found: dict[str, Result | FastpinError] = {}
    with closing(batches):
        for batch, ends in batches:
            if isinstance(ends, BaseException):
                ends = [FastpinError(f"{place}: {ends}") for place in batch]
            found |= zip(batch, ends, strict=True)
    return [found[place] for place in given]


def solve_in_turn(cases: dict[str, Case]) -> list[Result | FastpinError]:
    """Return the result or the error of each case, one after the other. Errors name the places that are the keys."""
    ends: list[Result | FastpinError] = []
    with doubts_given():
        for place, case in cases.items():
            try:
                ends.append(solve(case.problem, case.history, **case.options.keywords()))
            except InputError as error:
                ends.append(InputError(place, str(error)))
            except FastpinError as error:
                error.args = (f"{place}: {error}",)
                ends.append(error)
            except Exception as error:  # It is the failure of this case only.
                ends.append(FastpinError(f"{place}: {type(error).__name__}: {error}"))
    return ends

"""Executors of a sweep: any of :mod:`concurrent.futures`, or a pool of processes that outlives its workers' deaths."""

from __future__ import annotations

import functools
import multiprocessing
import os
import signal
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Generator, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from datetime import UTC, datetime
from multiprocessing import resource_tracker
from queue import SimpleQueue
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits

from fastpin.errors import FastpinError
from fastpin.kernels.jit import on_one_thread
from fastpin.kernels.products import in_one_thread
from fastpin.model.case import Case
from fastpin.solver.errors import SolveError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.storage import store
from fastpin.storage.layout import versions
from fastpin.studies.outcome import Outcome, key_figures
from fastpin.version import __version__

K = TypeVar("K")
T = TypeVar("T")

DIED = "the worker process died; perhaps it needed more memory than there is"
MOST_SUBMITTED = 1_000
"""Tasks that an executor of others is given at a time: enough for a cluster."""

Submit = Callable[[Executor, K], "Future[T]"]
"""Hands one task to an executor."""


def cores() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class WorkerDiedError(Exception):
    """The process of a task died."""


class BrokenError(Exception):
    """An executor broke, or threw its tasks away; ``tasks`` were on their way."""

    def __init__(self, tasks: list[Any]) -> None:
        super().__init__("the executor broke")
        self.tasks = tasks


class Pool:
    """Worker processes, started afresh (spawned) and pinned to one thread each.

    Parameters
    ----------
    workers : int

    Raises
    ------
    FastpinError
        If they don't start.
    """

    def __init__(self, workers: int) -> None:
        context = multiprocessing.get_context("spawn")
        before = set(multiprocessing.active_children())
        resource_tracker.ensure_running()  # before signals are held back: it would let them pass again
        with _interrupts_held_back():  # a worker inherits that
            self.executor = ProcessPoolExecutor(workers, mp_context=context, initializer=prepare)
            first, *_ = [self.executor.submit(os.getpid) for _ in range(workers)]  # each starts a process
        self._processes = set(multiprocessing.active_children()) - before
        try:
            first.result()
        except BrokenExecutor:
            raise FastpinError(
                "worker processes can't be started; a script that runs a sweep must do so under "
                'if __name__ == "__main__", because they import it'
            ) from None

    def stop(self, busy: bool = True) -> None:
        """End the workers, whatever they are doing."""
        if busy:
            for process in self._processes:
                process.kill()
        self.executor.shutdown(cancel_futures=True)


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Ctrl-C comes after the block."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run_tasks(
    executor: Executor | None, workers: int, tasks: Collection[K], submit: Submit[K, T]
) -> Generator[tuple[K, T | BaseException], None, None]:
    """Tasks with what they return or raise, in the order in which they end.

    Through `executor`, or without one through so many worker processes of our own. If an executor that is given breaks,
    :class:`BrokenError` is raised.
    """
    if executor is not None:
        return through(executor, deque(tasks), submit)
    return through_processes(workers, tasks, submit)


def through(
    executor: Executor, waiting: deque[K], submit: Submit[K, T], ahead: int = MOST_SUBMITTED
) -> Generator[tuple[K, T | BaseException], None, None]:
    """Tasks with what they return or raise, in the order in which they end, through any executor.

    Not more than `ahead` are on their way at a time; they leave `waiting`. Raises :class:`BrokenError`.
    """
    running: dict[Future[T], K] = {}
    ended: SimpleQueue[Future[T]] = SimpleQueue()
    try:
        while waiting or running:
            while waiting and len(running) < ahead:
                try:
                    future = submit(executor, waiting[0])
                except RuntimeError:  # broken, or shut down
                    raise BrokenError(list(running.values())) from None
                running[future] = waiting.popleft()
                future.add_done_callback(ended.put)
            future = ended.get()
            error = future.exception()
            if isinstance(error, BrokenExecutor):
                raise error
            yield running.pop(future), future.result() if error is None else error
    except (BrokenExecutor, CancelledError):  # of a task
        raise BrokenError(list(running.values())) from None
    finally:
        for future in running:
            future.cancel()


def through_processes(
    workers: int, tasks: Collection[K], submit: Submit[K, T], alone: bool = False
) -> Generator[tuple[K, T | BaseException], None, None]:
    """Tasks with what they return or raise, through worker processes of our own.

    Where a process dies, all tasks that were on their way are tried again, each alone; one whose process dies then has
    a :class:`WorkerDiedError`.
    """
    waiting = deque(tasks)
    while waiting:
        suspects: list[K] = []
        pool = Pool(min(workers, len(waiting)))
        busy = True
        try:
            yield from through(pool.executor, waiting, submit, 1 if alone else 2 * workers)
            busy = False
        except BrokenError as broken:
            suspects = broken.tasks or [waiting.popleft()]
        finally:
            pool.stop(busy)
        if alone:
            yield from ((task, WorkerDiedError(DIED)) for task in suspects)
        elif suspects:
            yield from through_processes(1, suspects, submit, alone=True)


def prepare() -> None:
    """Make this process a worker of ours: one thread, deaf to Ctrl-C, and gone when the main process is."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the main process decides what an interrupt means
    threading.Thread(target=_end_with_parent, daemon=True).start()
    on_one_thread()
    one_thread()


@functools.cache
def one_thread() -> None:
    """One thread for every BLAS and OpenMP library of this process, from now on."""
    threadpool_limits(limits=1)


def solve_run(run: str, case: Case, path: str, main_process: int, version: str) -> Outcome:
    """Solve one case and save its result.

    Parameters
    ----------
    run : str
        Id of the run.
    case : Case
    path : str
        Where the result goes. Nothing is written without a state.
    main_process : int
        Process id of the sweep: its threads are not touched where the run happens in it.
    version : str
        Of fastpin, in the sweep.
    """
    if version != __version__:
        return Outcome(run, f"the worker has fastpin {__version__}, the sweep {version}")
    if os.getpid() != main_process:
        one_thread()
    started = datetime.now(UTC).isoformat(timespec="milliseconds")
    began = time.perf_counter()
    reason: str | None = None
    figures: dict[str, Any] = {}
    try:
        try:
            with in_one_thread():
                result: Result | None = solve(case.problem, case.history, **case.options.keywords())
        except SolveError as error:
            reason, result = str(error), error.result
        seconds = time.perf_counter() - began
        if result is not None and len(result):
            figures = key_figures(result)
            store.save(result, path, error=reason, restart=False)
    except MemoryError:
        seconds, reason, figures = time.perf_counter() - began, "not enough memory", {}
    except Exception as error:  # whatever goes wrong in one run is its own failure, and the others go on
        seconds, reason, figures = time.perf_counter() - began, f"{type(error).__name__}: {error}", {}
    return Outcome(run, reason, figures, seconds, started, socket.gethostname(), versions())


def _end_with_parent() -> None:
    """A worker waits for work for ever, also after its main process was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

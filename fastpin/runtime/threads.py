"""Work on several cores by threads, and the signals that ask a process to stop.

Each item is computed by itself: no bit depends on the number of threads.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Item = TypeVar("Item")
Found = TypeVar("Found")

STOPPING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Ctrl-C; the end of a job of a batch system; the end of a terminal, which Windows does not tell by a signal."""

LATE = 2.0
"""Seconds after which a thread that has not begun is taken for lost."""

_alone = ContextVar("_alone", default=False)
_starting = threading.Lock()


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def in_one_thread() -> Iterator[None]:
    """Let the calling thread do its work alone inside the block, because every core has other work."""
    before = _alone.set(True)
    try:
        yield
    finally:
        _alone.reset(before)


def works_alone() -> bool:
    """Whether the calling thread is to work alone."""
    return _alone.get()


def in_threads(work: Callable[[Item], Found], items: Sequence[Item]) -> list[Found]:
    """Return ``work(item)`` for all items, in their order, computed in a thread for each core.

    The threads start no others. A thread that is to work alone computes all items itself.
    """
    most = 1 if works_alone() else min(len(items), cores())
    if most <= 1:
        return [work(item) for item in items]
    with ThreadPoolExecutor(most, initializer=_alone.set, initargs=(True,)) as threads:
        return list(threads.map(work, items))


def in_chunks(count: int, size: int, work: Callable[[slice], None]) -> None:
    """Call `work` with slices of at most `size` that cover range(`count`), by :func:`in_threads`."""
    in_threads(work, [slice(first, first + size) for first in range(0, count, size)])


class _Beginning(threading.Event):
    """Whether a thread has begun. Who starts it does not wait for ever."""

    def wait(self, timeout: float | None = None) -> bool:
        return super().wait(LATE if timeout is None else timeout)


class _Undisturbed(threading.Thread):
    """A thread that computes one result. No process ends before it has.

    Python 3.11 may raise an exception that is meant for the caller in a new thread, which ends before its first line.
    """

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__(name="fastpin", daemon=False)
        self._started = _Beginning()
        self.work, self.result, self.works, self.taken = work, Future[object](), threading.Lock(), threading.Lock()
        self.works.acquire()

    def is_lost(self) -> bool:
        """Whether the thread has not begun in time. Then it never computes anything."""
        return not self._started.is_set() and self.taken.acquire(blocking=False)

    def run(self) -> None:
        if not self.taken.acquire(blocking=False):
            return
        try:
            self.result.set_result(self.work())
        except BaseException as error:
            self.result.set_exception(error)
        finally:
            self.works.release()

    def start(self) -> None:
        with _starting:
            before = threading.stack_size(2**24)  # compilers go deep, and some systems give threads little
            try:
                super().start()
            finally:
                threading.stack_size(before)


def undisturbed(work: Callable[[], Found]) -> Found:
    """Return ``work()``, computed whole in a thread of its own. Exceptions in the caller meanwhile are raised after it.

    Handlers of signals run in the main thread, and other threads may raise exceptions in the caller's. Both would be
    lost in a call from a library in C to Python, and the library would go on without a result.
    """
    if isinstance(threading.current_thread(), _Undisturbed):
        return work()
    thread = _Undisturbed(work)
    raised: BaseException | None = None
    try:
        thread.start()
    except RuntimeError:  # no more threads, or the interpreter is about to end
        return work()
    if thread.is_lost():
        return work()
    while thread.works.locked():
        try:
            with thread.works:
                pass
        except BaseException as error:
            raised = error if raised is None else raised
    if raised is not None:
        raise raised
    return thread.result.result()  # type: ignore[return-value]

"""Work on several cores by threads. Each item is computed by itself: no bit depends on the number of threads."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Item = TypeVar("Item")
Found = TypeVar("Found")

STACK = 2**24
"""Bytes of the stack of an undisturbed thread: compilers go deep, and some systems give threads little."""

_alone = ContextVar("_alone", default=False)


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


class _Undisturbed(threading.Thread):
    """A thread that computes one result. No process ends before it has."""

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__(name="fastpin", daemon=False)
        self.work, self.result, self.works = work, Future[object](), threading.Lock()
        self.works.acquire()

    def run(self) -> None:
        try:
            self.result.set_result(self.work())
        except BaseException as error:
            self.result.set_exception(error)
        finally:
            self.works.release()

    def start(self) -> None:
        before = threading.stack_size(STACK)
        try:
            super().start()
        finally:
            threading.stack_size(before)


def undisturbed(work: Callable[[], Found]) -> Found:
    """Return ``work()``, computed whole in a thread of its own. What is raised in the caller meanwhile, comes after it.

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
    while thread.works.locked():
        try:
            with thread.works:
                pass
        except BaseException as error:
            raised = error if raised is None else raised
    if raised is not None:
        raise raised
    return thread.result.result()  # type: ignore[return-value]

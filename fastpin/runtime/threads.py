"""Work on several cores by threads. Each item is computed by itself: no bit depends on the number of threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Item = TypeVar("Item")
Found = TypeVar("Found")

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

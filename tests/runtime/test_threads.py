"""Work in threads: all items in order, errors handed on, and no threads where there are to be none."""

import ctypes
import signal
import threading
from collections.abc import Callable
from functools import partial

import pytest

from fastpin.runtime import threads


def test_items_come_in_order(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 3)
    used = set()

    def work(item):
        used.add(threading.get_ident())
        assert threads.works_alone()  # no threads inside threads
        return item * item

    assert threads.in_threads(work, range(50)) == [item * item for item in range(50)]
    assert threading.get_ident() not in used
    assert not threads.works_alone()


@pytest.mark.parametrize(("cores", "items"), [(1, 9), (4, 1)])
def test_one_core_or_one_item_needs_no_thread(monkeypatch, cores, items):
    monkeypatch.setattr(threads, "cores", lambda: cores)
    mine = threading.get_ident()
    assert threads.in_threads(lambda _: threading.get_ident(), range(items)) == [mine] * items


def test_a_thread_that_works_alone_starts_no_others(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 4)
    with threads.in_one_thread():
        assert set(threads.in_threads(lambda _: threading.get_ident(), range(9))) == {threading.get_ident()}


def test_chunks_cover_all(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 2)
    seen = []
    threads.in_chunks(10, 4, lambda part: seen.append((part.start, part.stop)))
    assert sorted(seen) == [(0, 4), (4, 8), (8, 12)]
    threads.in_chunks(0, 4, seen.clear)
    assert len(seen) == 3


def test_errors_are_handed_on(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 2)
    with pytest.raises(ZeroDivisionError):
        threads.in_threads(lambda item: 1 / item, [1, 0, 2])


class Stop(BaseException):
    """Raised by a signal, or in another thread."""


def stop(*_: object) -> None:
    raise Stop


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="a system without signals to threads")
def test_signals_and_exceptions_wait_for_undisturbed_work() -> None:
    caller, ends = threading.get_ident(), []
    thrown = ctypes.pythonapi.PyThreadState_SetAsyncExc, ctypes.c_ulong(caller), ctypes.py_object(Stop)

    def work(disturb: Callable[..., object], *arguments: object) -> int:
        disturb(*arguments)
        ends.append(threads.undisturbed(threading.get_ident) == threading.get_ident() != caller)
        return len(ends)

    before = signal.signal(signal.SIGUSR1, stop)
    try:
        for disturbance in ((signal.pthread_kill, caller, signal.SIGUSR1), thrown):
            with pytest.raises(Stop):
                threads.undisturbed(partial(work, *disturbance))
        assert threads.undisturbed(partial(work, int)) == 3
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert ends == [True, True, True]


def test_undisturbed_work_raises_its_own_errors_and_needs_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ZeroDivisionError):
        threads.undisturbed(lambda: 1 // 0)

    def refuse(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    size = threading.stack_size()
    monkeypatch.setattr(threading.Thread, "start", refuse)
    assert threads.undisturbed(threading.get_ident) == threading.get_ident()
    assert threading.stack_size() == size


def test_undisturbed_work_is_done_if_its_thread_is_lost_before_its_first_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python 3.11 may raise an exception that is meant for the caller in a thread that it has just made."""
    monkeypatch.setattr(threads, "LATE", 0.01)
    monkeypatch.setattr(threading.Thread, "_bootstrap", lambda thread: None)
    assert threads.undisturbed(threading.get_ident) == threading.get_ident()


def test_a_thread_that_begins_late_does_not_work_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    begin, times = threading.Thread._bootstrap, []
    done, ended = threading.Event(), threading.Event()

    def slow(thread: threading.Thread) -> None:
        done.wait(10.0)
        begin(thread)
        ended.set()

    monkeypatch.setattr(threads, "LATE", 0.01)
    monkeypatch.setattr(threading.Thread, "_bootstrap", slow)
    threads.undisturbed(lambda: times.append(1))
    done.set()
    assert ended.wait(10.0)
    assert times == [1]

"""Work in threads: all items in order, errors handed on, and no threads where there are to be none."""

import threading

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

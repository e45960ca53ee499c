"""One thread at a time may use a session: others are refused with one sentence, and nothing is lost."""

import copy
import pickle
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

import fastpin
from fastpin.solver.run import Run

CALLS: dict[str, Callable[[fastpin.Session], Any]] = {
    "advance": lambda session: session.advance({"P": 2.0}),
    "change": lambda session: session.change(friction=0.3),
    "undo": lambda session: session.undo(),
    "redo": lambda session: session.redo(),
    "reset": lambda session: session.reset(),
    "copy": lambda session: session.copy(),
    "result": lambda session: session.result(),
    "problem": lambda session: session.problem,
    "state": lambda session: session.state,
    "history": lambda session: session.history,
    "grid": lambda session: session.grid,
    "undos": lambda session: session.undos,
    "redos": lambda session: session.redos,
}


@pytest.fixture
def session(titanium_in_aluminium) -> fastpin.Session:
    problem = fastpin.Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4)
    session = fastpin.Session(problem, nodes=51)
    session.advance({"P": 1.0})
    return session


def test_the_table_has_all_public_names() -> None:
    assert set(CALLS) == {name for name in dir(fastpin.Session) if not name.startswith("_")}


@pytest.mark.parametrize("name", [*CALLS, "pickle", "copy of it", "text"])
def test_a_call_during_a_step_of_another_thread_is_refused(session, name, monkeypatch):
    call = (CALLS | {"pickle": pickle.dumps, "copy of it": copy.copy, "text": repr})[name]
    inside, go_on, step_to = threading.Event(), threading.Event(), Run.step_to

    def slow(run: Run, load: Any) -> None:
        inside.set()
        assert go_on.wait(60.0)
        step_to(run, load)

    monkeypatch.setattr(Run, "step_to", slow)
    with ThreadPoolExecutor(1) as thread:
        step = thread.submit(session.advance, {"Q": 0.2})
        try:
            assert inside.wait(60.0)
            with pytest.raises(fastpin.InputError, match="session: is being used by another thread"):
                call(session)
        finally:
            go_on.set()
        assert step.result().load["Q"] == 0.2
    assert session.state is step.result()
    assert (len(session.history), session.undos, session.redos) == (2, 2, 0)


def test_threads_lose_no_load(session):
    begun, kept, refused = threading.Barrier(3), [], []

    def work(first: int) -> None:
        begun.wait()
        for load in range(first, 60, 3):
            try:
                kept.append((0.01 * load, session.advance({"Q": 0.01 * load % 0.3}).load["Q"]))
            except fastpin.InputError as error:
                refused.append(error)

    with ThreadPoolExecutor(3) as threads:
        list(threads.map(work, range(3)))
    assert len(kept) + len(refused) == 60
    assert len(session.history) == len(kept) + 1
    assert all(got == asked % 0.3 for asked, got in kept)
    assert sorted(got for _, got in kept) == sorted(session.history.values()[1:, 1].tolist())


def test_a_session_may_go_from_thread_to_thread_and_copies_are_independent(session):
    other = pickle.loads(pickle.dumps(session))
    with ThreadPoolExecutor(1) as thread:
        assert thread.submit(session.advance, {"Q": 0.1}).result().load["Q"] == 0.1
    assert session.advance({"Q": 0.2}).load["Q"] == 0.2
    assert other.advance({"Q": 0.1}).load["Q"] == 0.1

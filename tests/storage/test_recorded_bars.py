"""Error bars of runs that write to a file: the same as in memory, also after an interrupt in either run."""

import h5py
import numpy as np
import pytest

from fastpin import InputError, Interrupted, NoEquilibriumError, record, resume, solve
from fastpin.storage import StoredResult, recording, store, writer
from fastpin.storage.writer import coarse_of
from tests.support.commands import printed, said
from tests.support.programs import P, assert_same, q

HISTORY = P + q(*np.random.default_rng(2).uniform(-0.28, 0.28, 12))
OPTIONS = {"nodes": 101, "arc": (-3.0, -0.1), "between": 1}


class StopAtRun:
    """Raise Ctrl-C in the n-th run from 1, at a part of its steps."""

    def __init__(self, run, steps):
        self.run, self.steps, self.runs, self.last = run, steps, 1, 0.0

    def __call__(self, done, total):
        self.runs += done < self.last
        self.last = done
        if self.runs == self.run and done >= self.steps:
            raise Interrupted


@pytest.fixture(scope="module")
def expected(problem):
    return solve(problem, HISTORY, error_bars=True, **OPTIONS)


def assert_bars(path, expected):
    found = store.load(path)
    assert_same(found, expected)
    assert_same(found.coarse, expected.coarse)
    for one, two in zip(found[::5], expected[::5], strict=True):
        assert repr(dict(one.error_bars)) == repr(dict(two.error_bars))
    assert not StoredResult(path).lacks_error_bars
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


@pytest.mark.gate
def test_a_file_holds_the_bars_of_a_solution(problem, expected, path):
    record(problem, HISTORY, path, error_bars=True, **OPTIONS)
    assert_bars(path, expected)
    assert StoredResult(path).case.options.error_bars
    with pytest.raises(InputError, match="holds a finished run: there is nothing to continue"):
        resume(path)


@pytest.mark.gate
@pytest.mark.parametrize(("run", "steps"), [(1, 0.0), (1, 6.0), (2, 0.0), (2, 6.0), (2, 12.0)])
def test_an_interrupted_run_gets_its_bars(problem, expected, path, run, steps):
    with pytest.raises(Interrupted) as ended:
        record(problem, HISTORY, path, error_bars=True, progress=StopAtRun(run, steps), **OPTIONS)
    early = store.load(path)
    assert early.coarse is None
    assert all(state.error_bars is None for state in early)
    assert StoredResult(path).lacks_error_bars == early.complete == (run == 2)
    if run == 2:
        assert ended.value.result[-1].dissipation == expected[-1].dissipation
    resume(path)
    assert_bars(path, expected)


@pytest.mark.gate
def test_a_run_killed_before_its_coarse_states_are_in_the_file(problem, expected, path, monkeypatch):
    def fail(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(recording, "add_coarse", fail)
        with pytest.raises(KeyboardInterrupt):
            record(problem, HISTORY, path, error_bars=True, **OPTIONS)
    with monkeypatch.context() as patch:
        patch.setattr(writer.layout, "read_cycles", fail)  # the coarse states are in the file, but not for good
        with pytest.raises(KeyboardInterrupt):
            resume(path)
    assert StoredResult(path).lacks_error_bars
    resume(path)
    assert_bars(path, expected)


@pytest.mark.gate
def test_the_coarse_run_of_another_run_is_not_used(problem, expected, path):
    with pytest.raises(Interrupted):
        record(problem, HISTORY[:5], path, error_bars=True, progress=StopAtRun(2, 3.0), **OPTIONS)
    assert coarse_of(path).exists()
    record(problem, HISTORY[:5], path, overwrite=True, **OPTIONS)
    assert not coarse_of(path).exists()
    record(problem, HISTORY[:5], coarse_of(path), **OPTIONS)
    record(problem, HISTORY, path, overwrite=True, error_bars=True, **OPTIONS)
    assert_bars(path, expected)


def test_a_coarse_grid_that_loses_the_load_leaves_the_states(problem, path, monkeypatch):
    def lose(*_, **__):
        raise NoEquilibriumError("lost", 0, 0.5, {})

    first = recording.Task.follow
    monkeypatch.setattr(
        recording.Task, "follow", lambda task, writer: first(task, writer) if task.grid is None else lose()
    )
    with pytest.raises(NoEquilibriumError, match=r"lost .*on the coarse grid of \d+ nodes that the error bars take"):
        record(problem, HISTORY, path, error_bars=True, **OPTIONS)
    found = store.load(path)
    assert found.complete
    assert found.coarse is None


def test_a_branch_has_no_bars_in_a_file(problem, expected, path):
    with pytest.raises(InputError, match="error_bars: a run that continues another one has none in a file"):
        record(problem, q(0.1), path, start=expected, error_bars=True)
    assert not path.exists()


@pytest.mark.gate
def test_only_the_end_of_a_file_goes_on_with_bars(problem, expected, path):
    record(problem, HISTORY, path, error_bars=True, save_after=[4], **OPTIONS)
    whole, part = store.load(path, states=[]), store.load(path, after=4)
    branches = [solve(problem, q(0.1), start=start, error_bars=True)[-1] for start in (whole, expected)]
    assert repr(branches[0].error_bars) == repr(branches[1].error_bars)
    assert repr(part[-1].error_bars) == repr(expected[len(part) - 1].error_bars)
    with pytest.raises(InputError, match="error_bars: continue from the end of a result only"):
        solve(problem, q(0.1), start=part, error_bars=True)


@pytest.mark.gate
def test_damaged_coarse_states_are_one_sentence(problem, path):
    record(problem, HISTORY[:3], path, error_bars=True, **OPTIONS)
    with h5py.File(path, "r+") as file:
        file["coarse/states/step"][0] = 1
    with pytest.raises(InputError, match="coarse/states has other load points than states"):
        store.load(path)


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_show_says_what_is_missing(problem, path):
    with pytest.raises(Interrupted):
        record(problem, HISTORY[:5], path, error_bars=True, progress=StopAtRun(2, 2.0), **OPTIONS)
    words = f"no error bars: their run on the coarse grid has not ended; continue with: fastpin resume {path}"
    out = printed("show", path)
    assert "+-" not in out
    assert f"note: {words}" in out
    assert "+-" in printed("resume", path)
    page = path.with_suffix(".html")
    said("report", path, "-o", page)
    assert "There are no error bars" not in page.read_text(encoding="utf-8")

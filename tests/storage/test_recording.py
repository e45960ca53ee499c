"""Histories followed into a file: the same states as in memory, and nothing lost when a run ends early."""

from __future__ import annotations

import errno
import itertools
import os
import shutil
import signal
import threading
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from fastpin.errors import InputError, OutputError
from fastpin.model.case import About
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.inputs import HDF5_SIGNATURE
from fastpin.model.problem import Problem
from fastpin.solver.errors import ArcError, ConvergenceError, Interrupted, NoEquilibriumError
from fastpin.solver.solving import solve
from fastpin.storage import journal, layout, store, writer
from fastpin.storage.journal import journal_of
from fastpin.storage.recording import record as follow
from fastpin.storage.recording import resume
from fastpin.storage.stored import StoredResult
from fastpin.storage.writer import checkpoint_of, coarse_of
from tests.support.interrupts import StopAt, record_in_parts
from tests.support.programs import PROGRAMS, P, assert_same, known, q
from tests.support.tiers import some_gate, some_survey

RANDOM = P + q(*np.random.default_rng(1).uniform(-0.28, 0.28, 40))


@pytest.fixture(scope="module")
def whole(problem):
    """The solution of RANDOM on one arc."""
    return solve(problem, RANDOM, nodes=61, arc=(-3.0, -0.1))


@pytest.fixture(scope="module")
def denser(problem):
    """The same with a state inside each step."""
    return solve(problem, RANDOM, nodes=61, between=1, arc=(-3.0, -0.1))


def assert_file(path: Path, expected) -> None:
    found = store.load(path)
    assert_same(found, expected)
    assert known(found) == known(expected)
    assert found.complete


@pytest.mark.parametrize("keep", some_gate(["all", "cycles", "every 3"], "every 3"))
@pytest.mark.parametrize(
    "program", some_gate(PROGRAMS, *(PROGRAMS.keys() - {"cycles", "corners", "minus zero", "pressed again and again"}))
)
def test_the_file_holds_what_a_solution_returns(problem, path, program, keep):
    history = PROGRAMS[program]
    keep = keep if history.longest_cycle or keep != "cycles" else "every 7"
    follow(problem, history, path, nodes=61, between=1, keep=keep)
    expected = solve(problem, history, nodes=61, between=1, keep=keep)
    assert_file(path, expected)
    found = store.load(path)
    assert [cycle.solved for cycle in found.cycles] == [cycle.solved for cycle in expected.cycles]
    assert found.history.values().tolist() == history.values().tolist()
    assert {**found.statistics, "seconds": 0.0} == {**expected.statistics, "seconds": 0.0}
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


@pytest.mark.gate
def test_a_history_that_begins_inside_a_cycle_goes_on_as_it_was(problem, path):
    history = (P + q(0.2, -0.2, 0.1).repeated(4))[2:]
    with pytest.raises(Interrupted):
        follow(problem, P + history, path, nodes=61, progress=StopAt(1.0), arc=(-3.0, -0.1))
    resume(path)
    assert_file(path, solve(problem, P + history, nodes=61, arc=(-3.0, -0.1)))
    stored = store.load(path).history.blocks
    assert [(block.count, block.cycle, block.size) for block in stored] == [(1, False, 0), (1, True, 3), (3, True, 0)]


def test_a_period_after_another_of_the_same_length_has_its_own_states(problem, path):
    history = P + q(0.2, -0.2).repeated(5) + q(0.1, -0.1).repeated(5)
    follow(problem, history, path, nodes=41, arc=(-3.0, -0.1))
    expected = solve(problem, history, nodes=41, arc=(-3.0, -0.1), shortcut=False)
    assert_same(store.load(path), expected)


@pytest.mark.parametrize("ticks", [0, 10])
def test_states_wait_for_one_commit_after_the_other(problem, path, monkeypatch, ticks):
    """The clock ticks each time that it is looked at, and so often in a commit. Slower commits are fewer."""
    commits, clock, commit = [], itertools.count(), writer.JournaledFile.commit

    def slow(file):
        commits.append([next(clock) for _ in range(ticks)])
        commit(file)

    monkeypatch.setattr(writer, "time", SimpleNamespace(monotonic=lambda: float(next(clock))))
    monkeypatch.setattr(writer, "CHECKPOINT_EVERY", 1e9)
    monkeypatch.setattr(writer.JournaledFile, "commit", slow)
    follow(problem, RANDOM, path, nodes=61, arc=(-3.0, -0.1))
    assert len(commits) == (4 if ticks else 7)


# -- runs that end early -------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize("corner", [0.0, 0.5, 1.0, 7.0, 20.5, 39.0])
def test_an_interrupted_run_goes_on(problem, denser, path, corner):
    with pytest.raises(Interrupted):
        follow(problem, RANDOM, path, nodes=61, between=1, progress=StopAt(corner), arc=(-3.0, -0.1))
    interrupted = store.load(path)
    assert not interrupted.complete
    assert corner * 2 - 1 <= len(interrupted) <= corner * 2 + 2
    for one, other in zip(interrupted, denser, strict=False):
        assert np.array_equal(one.shear, other.shear)
    resume(path)
    assert_file(path, denser)
    assert sorted(entry.name for entry in path.parent.iterdir()) == [path.name]


@pytest.mark.gate
@pytest.mark.parametrize("stops", some_survey([1.75, 6.0], 1.75))
@pytest.mark.parametrize("program", list(PROGRAMS))
def test_a_run_interrupted_again_and_again(problem, path, program, stops):
    history = PROGRAMS[program][: 12 if stops < 2.0 else 40]
    options = {"nodes": 61, "arc": (-3.0, -0.1), "between": 1 if stops < 2.0 else 0}
    record_in_parts(problem, history, path, stops, **options)
    assert_file(path, solve(problem, history, **options))


def test_ctrl_c_leaves_a_solution_in_memory_with_what_was_solved(problem, whole):
    with pytest.raises(Interrupted) as stopped:
        solve(problem, RANDOM, nodes=61, progress=StopAt(5.0), arc=(-3.0, -0.1))
    assert isinstance(stopped.value, KeyboardInterrupt)
    first = stopped.value.result
    assert len(first) == 5
    assert not first.complete
    second = solve(problem, RANDOM[5:], start=first)
    assert np.array_equal(second[-1].shear, whole[-1].shear)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_handlers_of_the_program_and_other_threads_are_left_alone(problem):
    seen = []
    before = signal.signal(signal.SIGINT, lambda *_: seen.append(1))
    try:
        assert len(solve(problem, RANDOM[:6], nodes=61, progress=StopAt(2.0), arc=(-3.0, -0.1))) == 6
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == [1]
    results = []
    thread = threading.Thread(target=lambda: results.append(solve(problem, RANDOM[:3], nodes=61)))
    thread.start()
    thread.join()
    assert len(results[0]) == 3


def interrupt_twice() -> None:
    signal.raise_signal(signal.SIGINT)
    signal.raise_signal(signal.SIGINT)


def crash() -> None:
    raise RuntimeError("something else")


@pytest.mark.gate
@pytest.mark.parametrize(("end", "error"), [(interrupt_twice, KeyboardInterrupt), (crash, RuntimeError)])
def test_a_run_that_ends_at_once_leaves_a_good_file(problem, whole, path, end, error):
    """A second Ctrl-C does not wait, as the first one does."""

    def progress(done: float, total: int) -> None:
        if total > 1 and done > 10.0:
            end()

    with pytest.raises(error) as stopped:
        follow(problem, RANDOM, path, nodes=61, progress=progress, arc=(-3.0, -0.1))
    assert type(stopped.value) is error  # no Interrupted
    resume(path)
    assert_file(path, whole)


@pytest.mark.gate
def test_a_lost_load_is_kept_with_what_was_solved(similar, path):
    problem = Problem.from_load_parameter(similar, 0.5, 0.55)
    history = LoadHistory([{"P": 1.0}, {"Q": 0.2}, {"M": 2.0}])
    with pytest.raises(NoEquilibriumError) as caught:
        follow(problem, history, path, nodes=61)
    assert [state.step for state in caught.value.result] == [1]
    found = store.load(path)
    assert len(found) == 2
    assert not found.complete
    with h5py.File(path) as file:
        assert file.attrs["error"] == str(caught.value)
    with pytest.raises(NoEquilibriumError, match="step 3"):
        resume(path)
    expected = solve(problem, [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.1}], grid=found.grid)
    assert np.array_equal(solve(problem, [{"Q": -0.1}], start=found)[-1].shear, expected[-1].shear)


@pytest.mark.gate
def test_a_contact_that_leaves_the_arc_begins_again_on_a_wider_one(similar, path, tmp_path, monkeypatch):
    """The coarse run is made to see the first step only."""
    from fastpin.solver import arc

    monkeypatch.setattr(arc, "outermost_corners", lambda problem, values: values[:1])
    problem = Problem.from_load_parameter(similar, 0.1, 0.4, "body")
    history = LoadHistory([{"P": 1.0}, {"Q": 0.05}, {"Q": 0.6}, {"Q": 0.1}])
    expected = solve(problem, history, nodes=61)
    follow(problem, history, path, nodes=61)
    assert_file(path, expected)
    first = next(arc.candidate_grids(problem, history.values(), 1.0, 61))
    assert first.theta[-1] < expected.grid.theta[-1]
    with pytest.raises(Interrupted):  # and in a run that was interrupted before
        follow(problem, history, path, nodes=61, progress=StopAt(2.0), overwrite=True)
    assert np.array_equal(store.load(path).grid.theta, first.theta)
    resume(path)
    assert_file(path, expected)
    with pytest.raises(ArcError):
        follow(problem, history, path, nodes=61, arc=(first.theta[0], first.theta[-1]), overwrite=True)
    with pytest.raises(ArcError, match="give a wider one"):
        resume(path)
    with pytest.raises(ArcError, match="the result to continue from"):
        follow(problem, [{"Q": 0.6}], tmp_path / "b.h5", start=store.load(path, after=2))
    with pytest.raises(ArcError):
        resume(tmp_path / "b.h5")


def begin_and_die(path: Path) -> None:
    """Leave a file as a process does that is killed in its first transaction."""
    path.unlink()
    file = journal.JournaledFile(path, new=True)
    file.write_at(memoryview(HDF5_SIGNATURE), 0)
    os.close(file._journal)
    os.close(file._file)


@pytest.mark.gate
def test_a_full_disk_leaves_what_was_there(problem, whole, path, monkeypatch):
    written, allowed = os.pwrite, [2_000_000]

    def pwrite(file: int, data: bytes, place: int) -> int:
        allowed[0] -= len(data)
        if allowed[0] < 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        return written(file, data, place)

    monkeypatch.setattr(writer, "COMMIT_SHARE", 0.0)
    with monkeypatch.context() as patch:
        patch.setattr(journal.os, "pwrite", pwrite)
        with pytest.raises(OutputError, match="can't be written: No space left"):
            follow(problem, RANDOM, path, nodes=61, arc=(-3.0, -0.1))
    assert 1 < StoredResult(path).points.size < 40
    resume(path)
    assert_file(path, whole)


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(errno.ENOSPC, "No space left on device")])
def test_what_happens_at_the_very_end_locks_nobody_out(problem, path, monkeypatch, error):
    def fail(*_):
        raise error

    with monkeypatch.context() as patch:
        patch.setattr(layout, "write_statistics", fail)
        with pytest.raises((KeyboardInterrupt, OSError)):
            follow(problem, RANDOM[:6], path, nodes=61, arc=(-3.0, -0.1))
    assert StoredResult(path).points.size <= 6
    resume(path)
    assert_file(path, solve(problem, RANDOM[:6], nodes=61, arc=(-3.0, -0.1)))


def test_a_run_that_ended_before_it_began(problem, path):
    path.write_bytes(b"")
    with pytest.raises(InputError, match="start it again"):
        resume(path)
    follow(problem, RANDOM[:3], path, nodes=61)
    assert len(store.load(path)) == 3


@pytest.mark.gate
def test_links_lead_to_one_run(problem, whole, path, tmp_path):
    (tmp_path / "below").mkdir()
    link = tmp_path / "below" / "link.h5"
    link.symlink_to(path)
    assert checkpoint_of(link) == checkpoint_of(path)
    with pytest.raises(Interrupted):
        follow(problem, RANDOM, link, nodes=61, progress=StopAt(9.0), arc=(-3.0, -0.1))
    resume(path)
    assert_file(link, whole)
    assert link.is_symlink()


# -- checkpoints ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def died(problem, tmp_path_factory):
    """The folder of a run that has died after some twelve corners, with checkpoints."""
    folder = tmp_path_factory.mktemp("died")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writer, "CHECKPOINT_EVERY", 0.0)
        patch.setattr(writer, "CHECKPOINT_SHARE", 0.0)
        patch.setattr(writer.FileRecorder, "end", lambda recorder, _: recorder.abort())
        with pytest.raises(Interrupted):
            follow(problem, RANDOM, folder / "a.h5", nodes=61, progress=StopAt(12.0), arc=(-3.0, -0.1))
    return folder


@pytest.fixture
def left(died, whole, path):
    """A copy of the run that has died; the solution that it would have come to."""
    shutil.copytree(died, path.parent, dirs_exist_ok=True)
    return whole


def test_a_dead_run_goes_on_from_its_checkpoint(left, path):
    assert checkpoint_of(path).exists()
    steps = []
    resume(path, lambda done, total: steps.append(done))
    assert min(steps) >= 10.0
    assert_file(path, left)
    assert not checkpoint_of(path).exists()


@pytest.mark.parametrize("damage", ["missing", "cut", "other"])
def test_without_a_good_checkpoint_a_run_goes_on_from_its_beginning(left, path, damage, problem, caplog):
    checkpoint = checkpoint_of(path)
    if damage == "missing":
        checkpoint.unlink()
    elif damage == "cut":
        checkpoint.write_bytes(checkpoint.read_bytes()[:1000])
    else:
        with h5py.File(checkpoint, "a") as file:
            file.attrs["run"] = "another"
    steps = []
    resume(path, lambda done, total: steps.append(done))
    assert min(steps) < 2.0
    assert_file(path, left)
    assert ("can't be read" in caplog.text) == (damage == "cut")
    assert "differ from those in the file" not in caplog.text


def test_an_unfinished_run_is_not_overwritten_by_accident(left, path, problem):
    with pytest.raises(InputError, match="unfinished run"):
        follow(problem, RANDOM, path, nodes=61)
    with pytest.raises(InputError, match="unfinished run"):
        store.save(left, path)
    follow(problem, RANDOM[:3], path, nodes=61, overwrite=True)
    assert len(store.load(path)) == 3
    for words in ("exists already", "is no result"):  # a finished one, and a file of another kind
        before = path.read_bytes()
        with pytest.raises(InputError, match=words):
            follow(problem, RANDOM[:4], path, nodes=61)
        assert path.read_bytes() == before
        path.write_text("something else")
    path.write_text("")
    follow(problem, RANDOM[:4], path, nodes=61)
    assert len(store.load(path)) == 4
    begin_and_die(path)
    assert path.read_bytes()
    follow(problem, RANDOM[:3], path, nodes=61)
    assert len(store.load(path)) == 3
    with pytest.raises(InputError, match="ordinary file"):
        follow(problem, RANDOM[:4], "/dev/null", nodes=61)


def test_an_unfinished_run_can_be_looked_at_but_not_gone_on_from_its_end(left, path, problem):
    found = store.load(path)
    assert 7 <= len(found) <= 13
    assert not found.complete
    with pytest.raises(InputError, match="nothing can continue from this result"):
        solve(problem, [{"Q": 0.1}], start=found)
    assert len(solve(problem, [{"Q": 0.1}], start=store.load(path, after=6))) == 1
    assert len(store.load(path, after=len(found))) == len(found)
    with pytest.raises(InputError, match=f"must be a corner from 1 to {len(found)}, not {len(found) + 1}"):
        store.load(path, after=len(found) + 1)


def test_states_that_differ_from_those_in_the_file_are_reported(left, path, caplog):
    checkpoint_of(path).unlink()
    with h5py.File(path, "a") as file:
        file["states/pressure"][3] *= 1.0 + 1e-15
    resume(path)
    assert caplog.text.count("differ from those in the file") == 1


def test_only_unfinished_runs_are_gone_on_with(problem, path, tmp_path):
    follow(problem, RANDOM[:3], path, nodes=61)
    for wrong, words in (
        (path, "finished run"),
        (tmp_path / "b.h5", "no such file"),
        (tmp_path, "is a directory"),
    ):
        with pytest.raises(InputError, match=words):
            resume(wrong)
    for name in ("x", "run"):
        with h5py.File(path, "w") as file:
            file.attrs[name] = "of another program"
        with pytest.raises(InputError, match="not a result of fastpin"):
            resume(path)
    with pytest.raises(InputError, match="exists already"):
        follow(problem, RANDOM[:3], path, nodes=61)
    follow(problem, RANDOM[:3], path, nodes=61, overwrite=True)
    whole = path.read_bytes()
    for content, words in (
        (whole[: len(whole) // 2], "is damaged or cut short"),
        (b"P,Q\n1,2\n", "is no HDF5 file, and no result"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=words):
            resume(path)
        assert path.read_bytes() == content
        assert not journal_of(path).exists()


def test_two_runs_do_not_write_to_one_file(problem, path):
    def progress(done: float, total: int) -> None:
        if total > 1 and done == 3.0:
            for write in (
                lambda: resume(path),
                lambda: follow(problem, RANDOM, path, nodes=61, arc=(-3.0, -0.1), overwrite=True),
                lambda: store.save(whole, path),
            ):
                with pytest.raises(InputError, match="another run is writing"):
                    write()
            seen.append(len(store.load(path)))

    whole = solve(problem, RANDOM[:6], nodes=61, arc=(-3.0, -0.1))
    seen: list[int] = []
    follow(problem, RANDOM[:6], path, nodes=61, progress=progress, arc=(-3.0, -0.1))
    assert seen
    assert_file(path, whole)


@pytest.mark.gate
def test_a_run_can_be_looked_at_while_it_goes_on(problem, path, monkeypatch):
    monkeypatch.setattr(writer, "COMMIT_SHARE", 0.0)
    sizes = []

    def progress(done: float, total: int) -> None:
        if total > 1 and path.exists():
            found = store.load(path)
            assert [state.step for state in found] == list(range(len(found)))
            sizes.append(len(found))

    follow(problem, RANDOM, path, nodes=61, progress=progress, arc=(-3.0, -0.1))
    assert sizes == sorted(sizes)
    assert sizes[-1] >= 40


# -- branches ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stem(problem, tmp_path_factory):
    """The file of a run with two restarts on its way."""
    path = tmp_path_factory.mktemp("stem") / "a.h5"
    follow(problem, RANDOM, path, nodes=61, save_after=[5, 12])
    return path


@pytest.mark.parametrize("corner", [1, 5, 6, 20, 41])
def test_a_branch_goes_on_from_any_corner(problem, stem, tmp_path, corner):
    trunk = store.load(stem, after=corner)
    assert len(trunk) == len(trunk.history) == corner
    branch = LoadHistory([{"Q": 0.25}, {"Q": -0.25}])
    expected = solve(problem, RANDOM[:corner] + branch, grid=trunk.grid)
    result = solve(problem, branch, start=trunk)
    assert np.array_equal(result[-1].shear, expected[-1].shear)
    assert result[-1].dissipation == expected[-1].dissipation
    follow(problem, branch, tmp_path / "b.h5", start=trunk)
    assert_same(store.load(tmp_path / "b.h5"), result)


@pytest.mark.gate
def test_corners_to_branch_from_are_not_skipped(problem, path):
    history = P + q(0.2, -0.2, 0.1, -0.1).repeated(50)
    wanted = [20, 21, 22, 23, 50, 51, 61, 100, 201]
    follow(problem, history, path, nodes=61, save_after=wanted, keep="cycles")
    with h5py.File(path) as file:
        assert sorted(file["restart"], key=str) == sorted([*map(str, wanted), "start", "latest"])
        assert all(file["restart"][str(corner)].attrs["corner"] == corner for corner in wanted)
    found = store.load(path)
    assert_same(found, solve(problem, history, nodes=61, keep="cycles"))
    assert found.statistics["repeated"] > 120
    for corner in (22, 100):
        branch = solve(problem, [{"Q": 0.25}], start=store.load(path, after=corner))
        expected = solve(problem, history[:corner] + q(0.25), grid=found.grid)
        assert np.array_equal(branch[-1].shear, expected[-1].shear)


def test_the_way_to_a_corner_is_not_solved_again_where_it_repeats(problem, path):
    history = P + q(0.2, -0.2).repeated(8)
    follow(problem, history, path, nodes=41, arc=(-3.0, -0.1), shortcut=False)
    trunk = store.load(path, after=16)
    assert trunk.statistics["repeated"] == 0
    assert trunk.restart.statistics["repeated"] > 0
    branch = solve(problem, history[16:], start=trunk)
    assert np.array_equal(branch[-1].shear, store.load(path)[-1].shear)


@pytest.mark.gate
def test_a_branch_of_a_branch_that_was_interrupted(problem, whole, path, tmp_path):
    follow(problem, RANDOM[:10], path, nodes=61, arc=(-3.0, -0.1))
    second, third = tmp_path / "b.h5", tmp_path / "c.h5"
    with pytest.raises(Interrupted):
        follow(problem, RANDOM[10:30], second, start=store.load(path), progress=StopAt(7.0))
    resume(second)
    follow(problem, RANDOM[30:], third, start=store.load(second))
    assert np.array_equal(store.load(third)[-1].shear, whole[-1].shear)
    assert store.load(third)[-1].dissipation == whole[-1].dissipation
    fourth = solve(problem, RANDOM[35:], start=store.load(third, after=5))
    assert np.array_equal(fourth[-1].shear, whole[-1].shear)


@pytest.mark.gate
def test_corners_that_can_not_be_branched_from(problem, path, tmp_path):
    follow(problem, RANDOM[:4], path, nodes=61)
    for given, words in (
        ({"after": 5}, "must be a corner from 1 to 4"),
        *(({"after": after}, "whole number") for after in (0, -1, 2.5, True)),
        *(({"states": places}, "must be places from 0 to 3") for places in ([4], [-5], [1000])),
        ({"states": [3], "after": 2}, "must be places from 0 to 1"),
    ):
        with pytest.raises(InputError, match=words):
            store.load(path, **given)
    for wrong in ([0], [42]):
        with pytest.raises(InputError, match="save_after"):
            follow(problem, RANDOM, tmp_path / "b.h5", save_after=wrong)
    store.save(solve(problem, RANDOM[:3], nodes=61), path)
    for use in (lambda: store.load(path, after=2), lambda: resume(path)):
        with pytest.raises(InputError, match="not written by a run"):
            use()
    assert len(solve(problem, [{"Q": 0.1}], start=store.load(path))) == 1


def test_what_a_run_was_asked_for_is_in_its_file(problem, path):
    follow(problem, PROGRAMS["two levels"], path, nodes=61, between=[0.25], keep="every 2", title="A title")
    case = StoredResult(path).case
    assert case.problem == problem
    assert case.title == "A title"
    assert (case.options.nodes, case.options.keep, case.options.between) == (61, "every 2", (0.25,))
    assert [(len(b.given), b.count, b.cycle) for b in case.history.blocks] == [
        (len(b.given), b.count, b.cycle) for b in PROGRAMS["two levels"].blocks
    ]
    assert case.history.longest_cycle == 16


def test_the_arc_of_a_run_is_in_its_file(problem, path):
    follow(problem, P, path, nodes=21, arc=(-3.0, -0.1))
    assert StoredResult(path).case.options.arc == (-3.0, -0.1)
    with h5py.File(path, "r+") as file:
        file["solver"].attrs["arc"] = (-3.0, 5.0)  # an earlier version took it as a circle
    assert StoredResult(path).case.options.arc == (-3.0, -3.0 + 2.0 * np.pi)


@pytest.mark.gate
def test_graded_grids_and_increments_go_on_as_well(problem, path):
    theta = -0.5 * np.pi + 1.4 * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, 61))
    options = {"grid": Grid(theta), "method": "increment", "increments": 5}
    with pytest.raises(Interrupted):
        follow(problem, RANDOM[:8], path, progress=StopAt(4.0), **options)
    resume(path)
    assert_file(path, solve(problem, RANDOM[:8], **options))


def test_bad_input_leaves_no_file(problem, path):
    with pytest.raises(InputError):
        follow(problem, RANDOM, path, nodes=2)
    with pytest.raises(InputError, match="keep"):
        follow(problem, RANDOM, path, keep="nothing")
    with pytest.raises(InputError, match="does not exist"):
        follow(problem, RANDOM, path.parent / "none" / "a.h5")
    with pytest.raises(ConvergenceError):  # no first contact: nothing is solved, and that is in the file
        follow(problem, [{"P": 1e-5}, {"P": 1.0}], path, nodes=31, arc=(-3.0, -0.1))
    assert not store.load(path).complete
    assert len(list(path.parent.iterdir())) == 1


@pytest.mark.parametrize("again", ["resume", "replace"])
def test_a_checkpoint_that_is_a_link_is_neither_read_nor_written(left, path, again, problem):
    """A stranger's folder may hold a link to a file of the user beside a result."""
    precious = path.with_name("precious.txt")
    precious.write_text("keep")
    checkpoint_of(path).unlink()
    checkpoint_of(path).symlink_to(precious)
    with pytest.raises(InputError, match="must be an ordinary file; please remove it"):
        resume(path) if again == "resume" else follow(problem, [{"P": 1.0}], path, nodes=31, overwrite=True)
    assert precious.read_text() == "keep"


@pytest.mark.parametrize("beside", [checkpoint_of, coarse_of])
@pytest.mark.parametrize("again", ["resume", "replace"])
def test_a_directory_beside_a_result_is_refused_before_the_work(left, path, beside, again, problem):
    beside(path).unlink(missing_ok=True)
    beside(path).mkdir()
    with pytest.raises(InputError, match="must be an ordinary file; please remove it"):
        resume(path) if again == "resume" else follow(problem, [{"P": 1.0}], path, nodes=31, overwrite=True)
    assert beside(path).is_dir()


def test_a_file_keeps_who_made_its_case_also_after_an_interruption(problem, path):
    about, history = About("Hinge 4711", "", "B <b>", "2026-03-31"), RANDOM
    with pytest.raises(Interrupted):
        follow(problem, history, path, title="title", about=about, nodes=61, arc=(-3.0, -0.1), progress=StopAt(20))
    assert StoredResult(path).case.about == about
    resume(path)
    assert (StoredResult(path).case.title, StoredResult(path).case.about) == ("title", about)
    with pytest.raises(InputError, match="about: must be an About"):
        follow(problem, history, path, about="me", overwrite=True)

"""Lives of wear in files: the same bits as in memory, after interrupts and kills too."""

from __future__ import annotations

import random
import signal
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import InputError, Interrupted
from fastpin.model import FatigueAssessment
from fastpin.solver.errors import ResolutionError
from fastpin.storage import StoredResult, wear_files, writer
from fastpin.storage.journal import JournaledFile
from fastpin.wear_lives import WearResult
from fastpin.wear_lives.fat_cycles import FatCycles, Worn
from tests.support.interrupts import StopAt
from tests.support.processes import finished, python
from tests.support.tiers import gate
from tests.support.wear_cases import BUMPED, BUMPED_TURNS, WEAR_CASES, life

CASE = WEAR_CASES["unlike"]
PARTS = ("pressure", "shear", "gap", "slip", "status", "slip_distance", "dissipation", "work", "energy", "step")


def assert_same_life(one: WearResult, other: WearResult) -> None:
    assert [each.cycle for each in one] == [each.cycle for each in other]
    assert one.complete == other.complete
    for first, second in zip(one, other, strict=True):
        for name in ("next_jump", "solved", "dissipation", "removed"):
            assert getattr(first, name) == getattr(second, name)
        for name in ("pin_depth", "plate_depth"):
            assert np.array_equal(getattr(first, name), getattr(second, name))
        for state, again in zip(first.states, second.states, strict=True):
            for name in PARTS:
                assert np.array_equal(getattr(state, name), getattr(again, name)), name


@pytest.mark.gate
def test_a_file_holds_the_life_to_the_last_bit(path, tmp_path):
    written, kept = life(path, title="one life"), life()
    assert_same_life(written, kept)
    read = fastpin.load_wear(path)
    assert_same_life(read, kept)
    assert read.law == "archard"
    assert np.array_equal(read.coefficients, kept.coefficients)
    assert read.statistics["solved"] == kept[-1].solved
    # It is a result, too: its states are those over one cycle after each chosen cycle.
    states = fastpin.load(path)
    assert len(states) == 3 * len(kept)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.h5"]


@pytest.mark.survey
def test_a_history_may_be_its_cycle_alone(path):
    history = fastpin.LoadHistory([{"P": 1.0}, {"P": 0.5}]).repeated(2)
    written = life(path, history)
    assert_same_life(written, life(history=history))
    assert [state.step for state in written[0].states] == [-1, 0, 1]
    assert not written[0].states[0].in_contact
    assert [state.step for state in written[-1].states] == [119, 120, 121]


@pytest.mark.gate
def test_an_interrupted_life_goes_on_to_the_same_bits(tmp_path):
    path, corners = tmp_path / "life.h5", [5, 12, 13, 30, 47]
    for number, corner in enumerate(corners):
        with pytest.raises(Interrupted) as caught:
            life(path, resume=number > 0, progress=StopAt(corner))
        found = caught.value.result
        assert isinstance(found, WearResult)
        assert not found.complete
        assert found[-1].cycle <= corner
    assert_same_life(life(path, resume=True), life())


@pytest.mark.gate
def test_a_life_goes_on_from_its_checkpoint(path, monkeypatch):
    monkeypatch.setattr(writer, "CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(writer, "CHECKPOINT_SHARE", 0.0)

    def stop(done: float, total: int) -> None:
        if done >= 46.0:
            raise RuntimeError("killed")

    with pytest.raises(RuntimeError):
        life(path, at=[2], progress=stop)
    begun: list[float] = []
    found = life(path, at=[2], resume=True, progress=lambda done, total: begun.append(done))
    assert begun[0] > 30
    assert_same_life(found, life(at=[2]))


@pytest.mark.gate
def test_a_life_that_needs_finer_nodes_later_begins_anew_there(tmp_path, monkeypatch):
    """Interrupted or not: the nodes are too coarse from the sixth cycle on."""
    follow = FatCycles.next

    def next_cycle(self: FatCycles, place: Worn, target: int) -> Worn:
        if place.cycle >= 5 and self.run.system.grid.size == 21:
            raise ResolutionError("the contact is narrower than the nodes can resolve")
        return follow(self, place, target)

    monkeypatch.setattr(FatCycles, "next", next_cycle)
    given: dict[str, Any] = {"cycles": 8, "tolerance": 0.0, "grid": None, "nodes": 21}
    whole = life(**given)
    assert whole.grid.size == 41
    path = tmp_path / "life.h5"
    for number, corner in enumerate([3, 7]):  # on the coarse nodes, and on the fine ones
        with pytest.raises(Interrupted):
            life(path, resume=number > 0, progress=StopAt(corner), **given)
    assert_same_life(life(path, resume=True, **given), whole)
    with pytest.raises(ResolutionError):
        life(**{**given, "grid": CASE.grid(21)})


@pytest.mark.gate
def test_a_life_that_ended_before_its_first_transaction_begins_anew(path, monkeypatch):
    def fail(file: JournaledFile) -> None:
        raise RuntimeError("killed")

    with monkeypatch.context() as patch:
        patch.setattr(JournaledFile, "commit", fail)
        with pytest.raises(RuntimeError):
            life(path, cycles=2)
    with pytest.raises(InputError, match="is empty, and no result; if its run was killed, start it again"):
        fastpin.load_wear(path)
    assert_same_life(life(path, cycles=2, resume=True), life(cycles=2))


@pytest.mark.gate
def test_a_life_whose_pin_touches_beyond_its_arc_later_begins_anew_there(path):
    """Interrupted or not: a bump is touched in the fourth cycle."""
    given: dict[str, Any] = {"coefficient": 0.1, "cycles": 5, "tolerance": 0.0, "nodes": 31}
    whole = fastpin.wear(BUMPED, BUMPED_TURNS, **given)
    with pytest.raises(Interrupted) as caught:
        fastpin.wear(BUMPED, BUMPED_TURNS, output=path, progress=StopAt(2), **given)
    assert np.ptp(caught.value.result.grid.theta) < 0.7 * np.ptp(whole.theta)
    assert_same_life(fastpin.wear(BUMPED, BUMPED_TURNS, output=path, resume=True, **given), whole)


@pytest.mark.gate
def test_a_life_of_another_kind_is_not_continued(path):
    with pytest.raises(Interrupted):
        life(path, progress=StopAt(5))
    for name, value in {"coefficient": 2.0, "tolerance": 0.01, "law": "energy", "at": [7]}.items():
        with pytest.raises(InputError, match=f"resume: .* was begun with another {name}"):
            life(path, resume=True, **{name: value})
    with pytest.raises(InputError, match="was begun with another history"):
        life(path, resume=True, cycles=70)
    with pytest.raises(InputError, match="holds an unfinished run: resume it"):
        life(path)
    with pytest.raises(InputError, match="belongs to a life of wear"):
        fastpin.resume(path)
    life(path, resume=True)
    with pytest.raises(InputError, match=r"there is nothing to continue; try fastpin show .*a\.h5 --json"):
        life(path, resume=True)
    with pytest.raises(InputError, match="exists already"):
        life(path)


def test_other_files_hold_no_life(path):
    fastpin.record(CASE.problem, [{"P": 1.0}], path, nodes=31)
    with pytest.raises(InputError, match="holds no wear: it is the result of a run"):
        fastpin.load_wear(path)
    with pytest.raises(InputError, match="holds no wear: it is the result of a run"):
        life(path, resume=True)


@pytest.mark.parametrize("part", ["pin_depth", "cycle", *gate("coefficients")])
def test_a_damaged_file_is_told_in_one_sentence(path, part):
    life(path, cycles=2)
    with h5py.File(path, "r+") as file:
        if part == "cycle":
            del file["wear/cycle"]
        else:
            file[f"wear/{part}"][0, 3] = np.nan
    with pytest.raises(InputError, match="is damaged"):
        fastpin.load_wear(path)


def shorten(array):
    group, name, values = array.parent, array.name, array[:-1]
    del group[name]
    group[name] = values


def spoil(array):
    array[-1] = np.nan if array.dtype.kind == "f" else -1


@pytest.mark.gate
@pytest.mark.parametrize("damage", [spoil, shorten, lambda array: array.resize(10**8, axis=0)])
def test_a_damaged_life_is_not_continued(path, damage):
    with pytest.raises(Interrupted):
        life(path, progress=StopAt(5))
    before = path.read_bytes()
    for part in ("cycle", "solved", "removed", "plate_depth"):
        path.write_bytes(before)
        with h5py.File(path, "r+") as file:
            damage(file[f"wear/{part}"])
        with pytest.raises(InputError, match=rf"a\.h5: is damaged: .*wear/(cycle|pin_depth|{part}) "):
            life(path, resume=True)


@pytest.mark.gate
def test_a_life_without_a_stored_cycle_keeps_its_title(path, monkeypatch):
    def full(*_):
        raise MemoryError

    with monkeypatch.context() as patched:
        patched.setattr(wear_files.WearFile, "add", full)
        with pytest.raises(MemoryError):
            life(path, title="one life")
    life(path, resume=True, title="one life")
    assert StoredResult(path).case.title == "one life"


KILLED = """
import os, signal, sys
from pathlib import Path
from fastpin.storage import wear_files, writer
from tests.support.wear_cases import life
writer.CHECKPOINT_EVERY = writer.CHECKPOINT_SHARE = 0.0
path, left, before = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3] == "True"
write = wear_files._write_place
def counted(*arguments):
    global left
    left -= 1
    if left or not before:
        write(*arguments)
    if left == 0:
        os.kill(os.getpid(), signal.SIGKILL)
wear_files._write_place = counted
life(path, cycles=3000, tolerance=0.005, resume=path.exists())
"""
"""Dies before it writes a place, or before the file of this place is finished."""


@pytest.mark.survey
def test_a_life_that_is_killed_ten_times_has_the_same_bits(tmp_path):
    """Each process dies with its second to fifth place: a checkpoint, or that of a chosen cycle."""
    path, chance = tmp_path / "life.h5", random.Random(5)
    for _ in range(10):
        done = finished(python(KILLED, path, chance.randint(2, 5), chance.random() < 0.5), check=False)
        assert done.returncode == -signal.SIGKILL, done.stderr
    life(path, cycles=3000, tolerance=0.005, resume=True)
    assert_same_life(fastpin.load_wear(path), life(cycles=3000, tolerance=0.005))


@pytest.mark.parametrize("given", [{"residual_stress": -1e8}, {"reliability": 0.99, "criterion": "stress-life"}])
def test_a_life_of_wear_takes_median_lives_without_residual_stress(given):
    with pytest.raises(InputError, match="fatigue: must have neither residual_stress nor reliability: a life of wear"):
        fastpin.storage.wear(BUMPED, BUMPED_TURNS, coefficient=1e-15, fatigue=FatigueAssessment(**given))

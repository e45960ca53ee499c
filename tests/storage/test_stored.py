"""A stored result is read in parts, from a file that is opened once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, MaterialPair, Problem, storage
from fastpin.cli.main import main
from fastpin.joints import JOINT_EXAMPLE
from fastpin.solver.solving import solve
from fastpin.storage import journal
from fastpin.storage.store import save
from fastpin.storage.stored import StoredResult

PROBLEM = Problem(MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"]), 1e-2, 1e-5, 0.3)
HISTORY = [{"P": 1e5}, {"Q": 2e4}, {"Q": -2e4}]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    save(solve(PROBLEM, HISTORY, nodes=61), tmp_path / "a.h5")
    return tmp_path / "a.h5"


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The files that are opened, one after the other."""
    found, before = [], journal.open_h5

    def counted(path):
        found.append(path)
        return before(path)

    monkeypatch.setattr(journal, "open_h5", counted)
    return found


def look(stored: StoredResult) -> None:
    """Read all parts of a result."""
    assert not stored.is_joint
    assert not stored.is_life
    assert not stored.lacks_error_bars
    assert stored.error is None
    assert stored.result.complete
    assert stored.case.title == ""
    assert "host" in stored.origin
    assert len(stored.read([0, 2])) == 2
    assert stored.extremes
    assert stored.residuals
    assert stored.pressure > 0.0


def test_each_reading_opens_the_file_but_in_a_block_it_stays_open(path, opened):
    look(StoredResult(path))
    assert len(opened) > 5
    opened.clear()
    with StoredResult(path) as stored:
        look(stored)
    assert len(opened) == 1


def test_few_states_are_read_at_once(path, opened, monkeypatch):
    stored = StoredResult(path)
    first, *_, last = stored.read([0, 1, 2])
    reads = len(opened)
    assert stored.read([2]) == [last]
    assert stored.read([0]) == [first]
    found = stored.extremes
    assert len(opened) == reads
    monkeypatch.setattr(storage.stored, "AT_ONCE", 2)
    many = StoredResult(path)
    assert many.few is None
    assert many.extremes == found
    for one, other in zip(many.read([0, 1, 2]), stored.read([0, 1, 2]), strict=True):
        assert np.array_equal(one.pressure, other.pressure)
    assert len(opened) > reads


def test_a_file_that_another_run_has_replaced_is_opened_again(path, opened, monkeypatch):
    monkeypatch.setattr(storage.stored, "AT_ONCE", 1)
    other = solve(PROBLEM, HISTORY[:2], nodes=61)
    with StoredResult(path) as stored:
        assert len(stored.read([0, 1, 2])) == 3
        save(other, path)
        assert np.array_equal(stored.read([1])[0].pressure, other[1].pressure)
    assert len(opened) == 3  # save looks at the old file


def test_a_run_that_writes_does_not_wait_for_the_end_of_a_block(path, opened, monkeypatch):
    monkeypatch.setattr(storage.stored, "AT_ONCE", 1)
    journal.journal_of(path).touch()
    with StoredResult(path) as stored:
        stored.read([0])
        stored.read([1])
    assert len(opened) == 3  # the load points say how many states there are


@pytest.mark.gate
@pytest.mark.parametrize("command", ["show {} --json a.json", "show {}", "plot {} hoop -o a.png"])
def test_commands_open_their_file_once(path, opened, monkeypatch, command):
    monkeypatch.chdir(path.parent)
    assert main(command.format(path).split()) == 0
    assert len(opened) == 1


def test_the_functions_of_a_path_read_the_same(path):
    stored = StoredResult(path)
    assert storage.StoredResult(path).points.tolist() == stored.points.tolist() == [1.0, 2.0, 3.0]
    assert [state.step for state in storage.StoredResult(path).between(1, 2)] == [0, 1]
    assert storage.StoredResult(path).extremes == stored.extremes


@pytest.mark.gate
def test_the_result_of_a_joint_is_opened_once(tmp_path, opened):
    joint, path = tmp_path / "joint.toml", tmp_path / "joint.h5"
    joint.write_text(JOINT_EXAMPLE, encoding="utf-8")
    assert main(["joint", str(joint), "-o", str(path), "--nodes", "41"]) == 0
    opened.clear()
    assert main(["show", str(path), "--json", str(tmp_path / "joint.json")]) == 0
    assert len(opened) == 1

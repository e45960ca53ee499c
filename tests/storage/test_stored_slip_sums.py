"""Slip sums in files: resumed runs, restarts, states that are read in part, and files without them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from fastpin import InputError, Interrupted, Problem, load, record, resume, solve
from fastpin.storage import StoredResult, to_xarray, writer
from fastpin.storage.layout import SLIP_FIELDS
from tests.support.files import replaced, written
from tests.support.interrupts import StopAt, record_in_parts
from tests.support.programs import PROGRAMS, P, assert_same, known, q
from tests.support.tiers import gate, some_survey

RANDOM = P + q(*np.random.default_rng(1).uniform(-0.28, 0.28, 40))


@pytest.mark.gate
@pytest.mark.parametrize("keep", some_survey(["all", "cycles", "every 7"], "cycles"))
@pytest.mark.parametrize("program", [*gate("spectrum"), "two levels", "pressed again and again"])
def test_a_run_interrupted_again_and_again(problem: Problem, path: Path, program: str, keep: str) -> None:
    history = PROGRAMS[program][:60]
    options: dict[str, Any] = {"nodes": 61, "arc": (-3.0, -0.1), "keep": keep, "slip_sums": True}
    record_in_parts(problem, history, path, 11.0, **options)
    found, expected = load(path), solve(problem, history, **options)
    assert_same(found, expected)
    assert known(found) == known(expected)


@pytest.mark.gate
def test_a_restart_holds_the_sums_since_the_latest_kept_state(problem: Problem, path: Path) -> None:
    options: dict[str, Any] = {"nodes": 61, "keep": "every 9", "slip_sums": True}
    record(problem, RANDOM, path, save_after=[9, 13], **options)
    with h5py.File(path) as file:
        assert "slip_tally" not in file["restart/9"]
        assert file["restart/13/slip_tally"].shape == (4, 61)
        assert "slip_distance" not in "".join(file["restart/13/configurations"])
    branch = solve(problem, RANDOM[13:], start=load(path, after=13), slip_sums=True)
    straight = solve(problem, RANDOM, nodes=61, slip_sums=True)
    for one, two in zip(branch, straight[13:], strict=True):  # they count from the branch on
        assert np.array_equal(one.slip_distance, two.slip_distance)
        assert np.array_equal(one.friction_energy, two.friction_energy)


@pytest.mark.gate
def test_many_states_are_copied_piece_by_piece(problem: Problem, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "PIECE", 7)
    for keep in ("all", "every 3"):
        record(problem, PROGRAMS["spectrum"], path, nodes=61, keep=keep, slip_sums=True, overwrite=True)
        found, expected = load(path), solve(problem, PROGRAMS["spectrum"], nodes=61, keep=keep, slip_sums=True)
        assert_same(found, expected)
        assert known(found) == known(expected)


def test_files_without_the_option_have_nothing_new(problem: Problem, path: Path) -> None:
    record(problem, RANDOM, path, nodes=61, keep="every 9", save_after=[13])
    with h5py.File(path) as file:
        assert not set(SLIP_FIELDS) & set(file["states"])
        assert "slip_tally" not in file["restart/13"]
        assert "slip_sums" not in file["solver"].attrs
    assert load(path)[-1].slip_distance is None


@pytest.mark.gate
def test_states_that_do_not_follow_on_one_another_lose_their_sums(problem: Problem, path: Path) -> None:
    record(problem, RANDOM, path, nodes=61, slip_sums=True)
    for picked in (slice(5, 9), [5, 6, 7]):
        assert all(state.friction_energy is not None for state in load(path, states=picked))
    known_sums = [state.slip_distance is not None for state in load(path, states=[3, 4, 7, 8, 2])]
    assert known_sums == [True, True, False, True, False]
    assert [state.slip_distance is None for state in load(path, states=slice(None, None, 3))][1:] == [True] * 13
    assert [state.step for state in StoredResult(path).between(3, 5)] == [2, 3, 4]


def test_datasets_have_the_sums_with_units(problem: Problem, path: Path) -> None:
    record(problem, RANDOM, path, nodes=61, slip_sums=True)
    from_file, from_memory = to_xarray(path), to_xarray(load(path))
    lengths = dict.fromkeys(("slip_distance", "slip_lowest", "slip_highest"), "F beta*")
    for name, unit in {**lengths, "friction_energy": "F^2 beta*/R"}.items():
        assert from_file[name].dims == ("state", "theta")
        assert from_file[name].attrs["units"] == unit
        assert np.array_equal(from_file[name], from_memory[name], equal_nan=True)


def raised(file: h5py.File) -> None:
    file["restart/latest/slip_tally"][2] += 1.0


DAMAGES: dict[str, Callable[[h5py.File], object]] = {
    "missing": lambda file: file.pop("states/friction_energy"),
    "shape": replaced("states/slip_distance", np.zeros((1, 7))),
    "restart": replaced("restart/latest/slip_tally", np.zeros((3, 61))),
    "order": raised,
    "half": written("restart/latest/slip_tally", (3, 30), -np.inf),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_sums_are_told(problem: Problem, path: Path, damage: str) -> None:
    with pytest.raises(Interrupted):
        record(problem, RANDOM, path, nodes=61, keep="every 9", slip_sums=True, arc=(-3.0, -0.1), progress=StopAt(13.0))
    with h5py.File(path, "a") as file:
        DAMAGES[damage](file)
    with pytest.raises(InputError, match="damaged"):
        resume(path)


@pytest.mark.parametrize("damage", ["order", "half", "infinite"])
def test_damaged_extremes_of_a_state_are_told(problem: Problem, path: Path, damage: str) -> None:
    record(problem, RANDOM, path, nodes=61, keep="every 9", slip_sums=True)
    with h5py.File(path, "a") as file:
        closed = int(np.flatnonzero(file["states/status"][2] != 2)[0])
        value = {"order": file["states/slip_highest"][2, closed] + 1.0, "half": np.nan, "infinite": -np.inf}[damage]
        file["states/slip_lowest"][2, closed] = value
    with pytest.raises(InputError, match="damaged: states/slip_lowest and the highest slip don't fit"):
        load(path)

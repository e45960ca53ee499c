"""Results with damaged parts: every reader says in one sentence what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.storage import to_xarray


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a good file."""
    path = tmp_path_factory.mktemp("whole") / "result.h5"
    steel = fastpin.MATERIALS["steel"]
    problem = fastpin.Problem.from_load_parameter(fastpin.MaterialPair(steel, steel), 0.1, 0.4)
    history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(2)
    fastpin.record(problem, history, path, nodes=31, save_after=[2])
    return path.read_bytes()


def replaced(name: str, value: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = value

    return change


def written(name: str, place: Any, value: float) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file[name][place] = value

    return change


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (replaced("states/pressure", 5.0), "states/pressure"),
        (replaced("states/pressure", ["a", "b"]), "states/pressure has numbers of the type"),
        (written("states/pressure", (0, 3), np.nan), "states/pressure has a number that is not finite"),
        (written("states/status", (0, 3), 77), "states/status has a number outside -1 to 2"),
        (written("states/step", 0, 1000), "states/step has a number outside 0 to 4"),
        (written("states/fraction", 0, -1.0), "states/fraction has a number outside 0 to 1"),
        (written("history/blocks", (0, 1), -3), "count: must be a whole number"),
        (written("history/corners", (0, 0), np.inf), "given: must be finite numbers"),
        (written("restart/latest/load", 0, np.nan), "load has a number that is not finite"),
        (written("restart/latest/configurations/pressure", (0, 0), np.inf), "is not finite"),
        (lambda file: file["restart/latest"].attrs.__setitem__("force", 0.0), "force: must lie between"),
        (lambda file: file["restart/latest"].attrs.__setitem__("corner", "x"), "corner: must be a whole number"),
        (lambda file: file["solver/statistics"].attrs.__setitem__("events", "x"), "events: must be a number"),
        (lambda file: file.attrs.__setitem__("format", [1, 2]), "is damaged|not a result of fastpin"),
    ],
)
def test_a_damaged_result_is_described(whole, tmp_path, change, reason):
    path = tmp_path / "damaged.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        change(file)
    before = path.read_bytes()
    with pytest.raises(InputError, match=reason) as raised:
        fastpin.load(path)
    assert "\n" not in str(raised.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize("name", ["state", "theta", "load_name", "residual_name"])
def test_a_result_without_its_scales_is_described(whole, tmp_path, name):
    """HDF5 itself crashes when it follows a reference to a removed scale."""
    path = tmp_path / "damaged.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        del file[f"states/{name}"]
    with pytest.raises(InputError, match="is damaged"):
        to_xarray(path)


def test_an_unfinished_result_that_can_not_grow_is_not_continued(whole, tmp_path):
    path = tmp_path / "damaged.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
        rows = file["states/gap"][()]
        replaced("states/gap", rows)(file)
    with pytest.raises(InputError, match="states/gap can't grow"):
        fastpin.resume(path)


def test_an_unfinished_result_with_damaged_statistics_is_not_continued(whole, tmp_path):
    """They are written again at the end of the run, which must not fail there."""
    path = tmp_path / "damaged.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
        del file["solver/statistics"]
    with pytest.raises(InputError, match="is damaged"):
        fastpin.resume(path)

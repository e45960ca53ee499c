"""Results in HDF5 files come back as they were, or with one clear error."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import h5py
import numpy as np
import pytest
from samples import PAIR, sample_result

from fastpin.errors import InputError
from fastpin.materials import MATERIALS, Material, MaterialPair
from fastpin.problem import Problem
from fastpin.state import Result, State
from fastpin.store import FORMAT_VERSION, NODE_FIELDS, NUMBER_FIELDS, OTHER_FIELDS, load, save


def assert_same(first: Result, second: Result) -> None:
    assert second.problem == first.problem
    assert np.array_equal(second.history.values(), first.history.values())
    assert np.array_equal(second.grid.theta, first.grid.theta)
    assert second.grid.closed == first.grid.closed
    assert (second.method, second.complete) == (first.method, first.complete)
    assert second.statistics == first.statistics
    assert len(second) == len(first)
    for one, other in zip(first, second, strict=True):
        for name in (field.name for field in dataclasses.fields(State)):
            expected, found = getattr(one, name), getattr(other, name)
            if isinstance(expected, np.ndarray):
                assert np.array_equal(found, expected), name
                assert found.dtype == expected.dtype, name
            elif name == "grid":
                assert found is second.grid
            else:
                assert found == expected, name
                assert type(found) is type(expected), name
        assert other.contact == one.contact


def test_every_field_of_a_state_is_stored() -> None:
    known = {*NODE_FIELDS, *NUMBER_FIELDS, *OTHER_FIELDS}
    assert known == {field.name for field in dataclasses.fields(State)}


@pytest.mark.parametrize(
    "result",
    [
        sample_result(),
        sample_result(closed=True, complete=False),
        sample_result(problem=Problem(PAIR, 0.01, 0.0, 0.0, "centre", "fixed", 0.004)),
        sample_result(problem=Problem(MaterialPair(Material.rigid(), MATERIALS["steel"], "stress"), 0.01, -1e-6, 0.4)),
        sample_result(problem=Problem.from_load_parameter(PAIR, 0.1, 0.4)),
    ],
    ids=["arc", "circle", "fixed", "rigid", "dimensionless"],
)
def test_round_trip(result: Result, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    save(result, path)
    assert_same(result, load(path))


def test_what_a_history_never_gave_stays_not_given(tmp_path: Path) -> None:
    result = sample_result([{"P": 1e6}, {"Q": 2e5}])
    save(result, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        corners = file["history/corners"][()]
        columns = list(file["history/corners"].attrs["columns"])
    assert np.isnan(corners[:, columns.index("M")]).all()
    assert corners[:, columns.index("P")].tolist() == [1e6, 1e6]


def test_units_versions_and_packing_are_in_the_file(tmp_path: Path) -> None:
    save(sample_result(nodes=401), tmp_path / "a.h5", error="the pin slid away")
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["states/pressure"].attrs["unit"] == "Pa"
        assert file["states/rotation"].attrs["unit"] == "rad"
        assert list(file["states/load"].attrs["unit"][:3]) == ["N/m", "N/m", "N"]
        assert file["states/pressure"].compression == "gzip"
        assert file["states/status"].dtype == np.int8
        assert file.attrs["version_numpy"] == np.__version__
        assert file.attrs["error"] == "the pin slid away"


def test_a_result_without_states(tmp_path: Path) -> None:
    some = sample_result()
    empty = Result([], some.problem, some.history, some.grid, "path", {}, False, None)
    save(empty, tmp_path / "a.h5")
    assert len(load(tmp_path / "a.h5")) == 0


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.7, 0.999])
def test_a_file_cut_short_is_refused(share: float, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    save(sample_result(), path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match=r"a\.h5"):
        load(path)


def test_other_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with pytest.raises(InputError, match="no such file"):
        load(path)
    path.write_text("P,Q\n1,2\n")
    with pytest.raises(InputError, match="not a whole HDF5 file"):
        load(path)
    with h5py.File(path, "w") as file:
        file["x"] = 1
    with pytest.raises(InputError, match="not a result of fastpin"):
        load(path)


def test_newer_formats_and_missing_parts_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    save(sample_result(), path)
    with h5py.File(path, "a") as file:
        file.attrs["format_version"] = FORMAT_VERSION + 1
    with pytest.raises(InputError, match="format that this version can't read"):
        load(path)
    for part in ("states/gap", "problem/pin", "grid/theta", "solver/statistics"):
        save(sample_result(), path)
        with h5py.File(path, "a") as file:
            del file[part]
        with pytest.raises(InputError, match="is damaged"):
            load(path)
    save(sample_result(), path)
    with h5py.File(path, "a") as file:
        del file["states/gap"]
        file["states/gap"] = np.zeros((3, 5))
    with pytest.raises(InputError, match="has shape"):
        load(path)


def test_failed_writing_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    save(sample_result(), path)
    broken = sample_result()
    broken.statistics["events"] = object()  # type: ignore[assignment]
    with pytest.raises(TypeError):
        save(broken, path)
    assert_same(sample_result(), load(path))
    assert list(tmp_path.iterdir()) == [path]


def test_a_directory_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        save(sample_result(), tmp_path / "none" / "a.h5")

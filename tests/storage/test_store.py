"""Results in HDF5 files come back as they were, or with one clear error."""

import dataclasses
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.cycles import CYCLE_KINDS, Cycle
from fastpin.states.state import State
from fastpin.storage.export import to_xarray
from fastpin.storage.layout import NODE_FIELDS, NUMBER_FIELDS, SLIP_FIELDS, WITH_LAMINATE
from fastpin.storage.store import load, save
from fastpin.storage.stored import StoredResult
from tests.support.files import replaced
from tests.support.samples import PAIR, sample_result


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
                assert np.array_equal(found, expected, equal_nan=expected.dtype == float), name
                assert found.dtype == expected.dtype, name
            elif name == "grid":
                assert found is second.grid
            elif name == "marks":
                pairs = zip(found.arrays(one.grid.size), expected.arrays(one.grid.size), strict=True)
                assert all(np.array_equal(*pair, equal_nan=True) for pair in pairs)
            else:
                assert found == expected, name
                assert type(found) is type(expected), name
        assert other.contact == one.contact


def test_every_field_of_a_state_is_stored() -> None:
    # Fields that are stored in another form, or not at all.
    others = ("load", "theta", "residuals", "problem", "grid", "error_bars", "marks", "seat")
    known = {*NODE_FIELDS, *SLIP_FIELDS, *NUMBER_FIELDS, *others}
    assert known == {field.name for field in dataclasses.fields(State)}
    assert set(CYCLE_KINDS) == set(Cycle._fields)


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
def test_round_trip(result: Result, path: Path) -> None:
    save(result, path)
    assert_same(result, load(path))


def test_what_a_history_never_gave_stays_not_given(path: Path) -> None:
    result = sample_result([{"P": 1e6}, {"Q": 2e5}])
    save(result, path)
    with h5py.File(path) as file:
        corners = file["history/corners"][()]
        columns = list(file["history/corners"].attrs["columns"])
    assert np.isnan(corners[:, columns.index("M")]).all()
    assert np.array_equal(corners[:, columns.index("P")], [1e6, np.nan], equal_nan=True)


def test_units_versions_and_packing_are_in_the_file(path: Path) -> None:
    save(sample_result(nodes=401), path, error="the pin slid away")
    with h5py.File(path) as file:
        assert file["states/pressure"].attrs["unit"] == "Pa"
        assert file["states/rotation"].attrs["unit"] == "rad"
        assert list(file["states/loads"].attrs["unit"][:3]) == ["N/m", "N/m", "N"]
        assert file["states/pressure"].compression == "gzip"
        assert file["states/status"].dtype == np.int8
        assert file.attrs["version_numpy"] == np.__version__
        assert file.attrs["error"] == "the pin slid away"
        assert file.attrs["host"]
        assert file.attrs["created"].startswith("20")


def test_a_result_without_states(path: Path) -> None:
    some = sample_result()
    empty = Result([], some.problem, some.history, some.grid, "path", {}, False, None)
    save(empty, path)
    assert len(load(path)) == 0


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.7, 0.999])
def test_a_file_cut_short_is_refused(share: float, path: Path) -> None:
    save(sample_result(), path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match=r"a\.h5"):
        load(path)


def test_newer_formats_and_missing_parts_are_refused(path: Path) -> None:
    save(sample_result(), path)
    with h5py.File(path, "a") as file:
        file.attrs["format_version"] = WITH_LAMINATE + 1
    with pytest.raises(InputError, match="format that this version of fastpin can't read; it was written by fastpin"):
        load(path)
    for part in ("states/gap", "problem/pin", "grid/theta", "solver/statistics"):
        save(sample_result(), path)
        with h5py.File(path, "a") as file:
            del file[part]
        with pytest.raises(InputError, match="is damaged"):
            load(path)
    save(sample_result(), path)
    with h5py.File(path, "a") as file:
        replaced("states/gap", np.zeros((3, 5)))(file)
    with pytest.raises(InputError, match="has shape"):
        load(path)


def test_failed_writing_leaves_the_old_file(path: Path, tmp_path: Path) -> None:
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


# -- parts, and other programs -------------------------------------------------------------------------------


def test_some_states_alone(path: Path) -> None:
    result = sample_result([{"P": 1e6 * k} for k in range(1, 8)])
    save(result, path)
    assert StoredResult(path).points.size == 7
    for picked, steps in ((slice(2, 5), [2, 3, 4]), ([0, 6], [0, 6]), ([], []), (slice(-1, None), [6])):
        found = load(path, states=picked)
        assert [state.step for state in found] == steps
        assert len(found.history) == 7


def test_cycles_are_kept(path: Path) -> None:
    result = sample_result()
    result.history = LoadHistory([{"P": 2.42e6}]).repeated(3)
    cycles = [Cycle(2, 2, 1, 0.5, 0.25, 1e-3, 1e-6, True), Cycle(4, 2, 2, 0.0, 0.0, 1e-4, 0.0, False)]
    save(Result(list(result), result.problem, result.history, result.grid, "path", {}, True, None, cycles), path)
    found = load(path).cycles
    assert list(found) == cycles
    assert [type(value) for value in found[0]] == [type(value) for value in cycles[0]]


@pytest.mark.gate
def test_xarray_reads_the_states_with_and_without_us(path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    result = sample_result()
    save(result, path)
    ours = to_xarray(path)
    assert ours.pressure.dims == ("state", "theta")
    assert ours.pressure.attrs["units"] == "Pa"
    assert np.array_equal(ours.pressure.sel(state=1), result[1].pressure)
    assert np.array_equal(ours.theta, result.grid.theta)
    assert ours.loads.sel(load_name="Q").values.tolist() == [0.0, 4.84e5, -4.84e5]
    assert ours.attrs["complete"] is True
    with xarray.open_dataset(path, group="states") as theirs:
        assert set(theirs.variables) == set(ours.variables)
        for name in theirs.variables:
            assert theirs[name].dims == ours[name].dims
            assert np.array_equal(theirs[name].values, ours[name].values, equal_nan=name == "old_places")


def test_without_xarray_there_is_one_sentence(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save(sample_result(), path)
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match=r"pip install 'fastpin\[xarray\]'"):
        to_xarray(path)


def test_other_programs_may_have_the_file_open(path: Path) -> None:
    save(sample_result(), path)
    with h5py.File(path, "r"):
        assert len(load(path)) == 3


def test_a_file_with_fewer_loads_is_read_and_continued(path):
    """A version before the last load wrote load vectors without it, at the same places."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    problem = Problem.from_load_parameter(pair, 0.3, 0.4)
    whole = solve(problem, [{"P": 1.0}, {"Q": 0.1, "sxx": 0.01}, {"Q": -0.1}], nodes=61)
    first = solve(problem, whole.history[:2], grid=whole.grid)
    save(first, path)
    with h5py.File(path, "r+") as file:
        for name in ("states/loads", "history/corners", "restart/latest/load", "restart/latest/configurations/load"):
            shorter, attributes = file[name][()][..., :-1], dict(file[name].attrs)
            del file[name]
            file[name] = shorter
            file[name].attrs.update({key: value for key, value in attributes.items() if key != "DIMENSION_LIST"})
    stored = load(path)
    assert [state.load for state in stored] == [state.load for state in first]
    assert np.array_equal(stored.history.values(), first.history.values())
    last = solve(problem, whole.history[2:], start=stored)[-1]
    assert np.array_equal(last.shear, whole[-1].shear)
    assert last.load == whole[-1].load


def test_configurations_of_a_restart_have_equal_lengths(similar, path):
    save(solve(Problem.from_load_parameter(similar, 0.1, 0.4), [{"P": 1.0}], nodes=21), path)
    with h5py.File(path, "r+") as file:
        group = file["restart/latest/configurations"]
        replaced("motion", np.concatenate([group["motion"], group["motion"]]))(group)
    with pytest.raises(InputError, match="different lengths"):
        load(path)

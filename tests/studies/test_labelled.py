"""Sweeps as labelled arrays."""

import sys
from pathlib import Path

import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, parse_plan
from scripts.inline import Inline
from tests.support.case_texts import PRESSED
from tests.support.plans import MOMENT

xarray = pytest.importorskip("xarray")

PLAN = """
title = "slip of two pins"
[grid]
contact.friction = [0.3, 0.4, 0.5]
solve.nodes = [41, 51]
load.2.Q = [[7e5, -7e5]]
[[list]]
pin.material = "steel"
[[list]]
pin.material = "aluminium"
[outcomes]
work = { quantity = "dissipation" }
where = { quantity = "peak_pressure_angle" }
gross = { quantity = "regime" }
[labels]
work = "friction work"
"""


@pytest.fixture(scope="module")
def plan() -> Plan:
    return parse_plan(PLAN)


@pytest.fixture(scope="module")
def directory(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("labelled") / "sweep"
    sweep.run(plan, directory, Inline())
    return directory


def test_the_grid_gives_the_dimensions(plan: Plan, directory: Path) -> None:
    data = sweep.to_xarray(plan, directory)
    assert dict(data.sizes) == {"run": 2, "contact.friction": 3, "solve.nodes": 2, "load.2.Q": 1}
    assert data["contact.friction"].values.tolist() == [0.3, 0.4, 0.5]
    assert data["pin.material"].dims == ("run",)
    assert data["pin.material"].values.tolist() == ["steel", "aluminium"]
    assert data["load.2.Q"].values.tolist() == ["[700000.0, -700000.0]"]
    assert data.attrs == {"title": "slip of two pins"}
    for row in sweep.rows(plan, directory):
        place = {name: row[name] for name in ("contact.friction", "solve.nodes")}
        run = int(np.flatnonzero(data["pin.material"].values == row["pin.material"])[0])
        here = data.sel(place).isel({"run": run, "load.2.Q": 0})
        assert here["id"].item() == row["id"]
        assert here["status"].item() == "done"
        for name in ("work", "where", "gross", "peak_pressure", "max_shear", "nodes"):
            assert here[name].item() == row[name]


def test_variables_have_units_and_words(plan: Plan, directory: Path) -> None:
    data = sweep.to_xarray(plan, directory)
    assert data["work"].attrs == {"units": "J/m", "long_name": "friction work"}
    assert data["where"].attrs == {"units": "deg", "long_name": "where"}
    assert data["peak_pressure"].attrs == {"units": "Pa", "long_name": "peak pressure"}
    assert data["contact.friction"].attrs == {"units": "", "long_name": "friction coefficient"}
    assert data["load.2.Q"].attrs == {"units": "N/m", "long_name": "force Q in load 2"}
    assert data["gross"].attrs["flag_meanings"].split()[-1] == "gross_sliding"
    assert len(data["gross"].attrs["flag_values"]) == len(data["gross"].attrs["flag_meanings"].split())


def test_failed_and_waiting_runs_are_missing(tmp_path: Path) -> None:
    """A failed run has key figures of its last state, which are no results."""
    moments = parse_plan(MOMENT)
    waiting = sweep.to_xarray(moments, tmp_path / "none")
    assert set(waiting["status"].values.ravel()) == {"waiting"}
    assert np.isnan(waiting["peak_pressure"].values).all()
    sweep.run(moments, tmp_path, Inline())
    assert any(row["states"] for row in sweep.rows(moments, tmp_path) if row["status"] == "failed")
    data = sweep.to_xarray(moments, tmp_path).squeeze()
    assert data["status"].values.tolist() == [["done", "failed", "failed"], ["done"] * 3]
    assert np.array_equal(np.isnan(data["peak_pressure"].values), data["status"].values == "failed")
    assert np.array_equal(np.isnan(data["states"].values), data["status"].values == "failed")
    assert [bool(reason) for reason in data["reason"].values[0]] == [False, True, True]


def test_a_plan_of_lists_has_one_dimension(tmp_path: Path) -> None:
    listed = parse_plan("[[list]]\ncontact.friction = 0.3\n[[list]]\ncontact.friction = 0.4\nsolve.nodes = 41\n")
    data = sweep.to_xarray(listed, tmp_path)
    assert dict(data.sizes) == {"run": 2}
    assert data["contact.friction"].values.tolist() == [0.3, 0.4]
    assert np.array_equal(data["solve.nodes"].values, [np.nan, 41.0], equal_nan=True)
    assert data["run"].values.tolist() == [1, 2]


def test_files_of_loads_and_their_columns_can_be_varied(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("Force [kN/m],Other [kN/m]\n1000,2000\n")
    text = """
        [grid]
        load.1.csv = ["a.csv", "b.csv"]
        load.1.P = ["Force", { column = "Other", scale = 0.25 }]
        solve.nodes = [41]
    """
    (tmp_path / "case.toml").write_text(PRESSED.replace("P = 1e6", 'csv = "a.csv"\nP = "Force"'))
    files = parse_plan('case = "case.toml"\n' + text, folder=tmp_path)
    assert sweep.run(files, tmp_path / "sweep", Inline()).done == 2  # both files have the same loads
    assert [row["load.1.csv"] for row in sweep.rows(files, tmp_path / "sweep")] == ["a.csv"] * 2 + ["b.csv"] * 2
    assert min(str(row["load.1.P"]) for row in sweep.load(tmp_path / "sweep")) == "Force"
    data = sweep.to_xarray(files, tmp_path / "sweep").squeeze()
    assert data["load.1.csv"].values.tolist() == ["a.csv", "b.csv"]
    assert data["load.1.P"].values.tolist() == ["Force", '{"column": "Other", "scale": 0.25}']
    assert (data["peak_pressure"][:, 0] > data["peak_pressure"][:, 1]).all()


@pytest.mark.gate
def test_a_dataset_can_be_written_and_read(plan: Plan, directory: Path, tmp_path: Path) -> None:
    data = sweep.to_xarray(plan, directory)
    data.to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf") as read:
        assert np.array_equal(read["work"].values, data["work"].values)
        assert read["work"].attrs["units"] == "J/m"


def test_without_xarray_one_sentence_says_how_to_install_it(plan, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match=r"^xarray: is not installed: pip install 'fastpin\[xarray\]'$"):
        sweep.to_xarray(plan, tmp_path)

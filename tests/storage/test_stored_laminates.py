"""Laminates in result files."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.model import Laminate, Ply, PlyStrengths
from fastpin.storage.layout import FORMAT_VERSION, WITH_LAMINATE

OWN = Ply(135e9, 9e9, 5e9, 0.3, 0.125e-3, PlyStrengths(2e9, 1e9, 5e7, 2e8, 1e8), "mine", "tests")
SEVERAL = [("T300/5208", 0.0), (OWN, 45.0), (OWN, 45.0), ("T300/5208", 0.0)]

LAMINATES = {
    "layup": Laminate.from_layup("[0/45/-45/90]2s", "T300/5208", axis=0.3, name="skin"),
    "several": Laminate.from_plies(
        [(fastpin.model.PLIES[ply] if isinstance(ply, str) else ply, angle) for ply, angle in SEVERAL]
    ),
    "moduli": Laminate.from_moduli(60e9, 60e9, 10e9, 0.1, axis=1.0),
    "compliance": Laminate(compliance=(2e-11, -5e-12, 3e-11, 1e-12, -2e-12, 6e-11), name="any"),
}


def result_of(laminate: fastpin.Material) -> fastpin.Result:
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], laminate, "stress")
    problem = fastpin.Problem(pair, 3e-3, 2e-5, 0.2)
    return fastpin.solve(problem, fastpin.LoadHistory([{"P": 1e6}]), nodes=31, arc=(-3.0, -0.1))


@pytest.mark.parametrize("name", LAMINATES)
def test_a_stored_laminate_comes_back(name: str, tmp_path: Path) -> None:
    laminate = LAMINATES[name]
    result_of(laminate).save(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["format_version"] == WITH_LAMINATE
    found = fastpin.load(tmp_path / "a.h5").problem.pair.plate
    assert found == laminate
    assert isinstance(found, Laminate)
    assert found.compliance == laminate.compliance


def test_an_isotropic_plate_is_stored_as_before(tmp_path: Path) -> None:
    result_of(fastpin.MATERIALS["aluminium"]).save(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["format_version"] == FORMAT_VERSION
        assert "laminate" not in file["problem/plate"]


def test_a_damaged_laminate_is_refused(tmp_path: Path) -> None:
    result_of(LAMINATES["several"]).save(tmp_path / "a.h5")
    for change in ("places", "missing", "moduli"):
        result_of(LAMINATES["several"]).save(tmp_path / f"{change}.h5")
        with h5py.File(tmp_path / f"{change}.h5", "r+") as file:
            group = file["problem/plate/laminate"]
            if change == "places":
                group["which"][0] = 7
            elif change == "missing":
                del group["angles"]
            else:
                group["plies/1"].attrs["E1"] = -1.0
        with pytest.raises(InputError):
            fastpin.load(tmp_path / f"{change}.h5")

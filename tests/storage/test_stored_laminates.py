"""Laminates in result files."""

import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.model import Laminate, Ply, PlyStrengths
from fastpin.storage.layout import FORMAT_VERSION, WITH_LAMINATE
from tests.support.files import replaced

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
def test_a_stored_laminate_comes_back(name: str, path: Path) -> None:
    laminate = LAMINATES[name]
    result_of(laminate).save(path)
    with h5py.File(path) as file:
        assert file.attrs["format_version"] == WITH_LAMINATE
    found = fastpin.load(path).problem.pair.plate
    assert found == laminate
    assert isinstance(found, Laminate)
    assert found.compliance == laminate.compliance


def test_an_isotropic_plate_is_stored_as_before(path: Path) -> None:
    result_of(fastpin.MATERIALS["aluminium"]).save(path)
    with h5py.File(path) as file:
        assert file.attrs["format_version"] == FORMAT_VERSION
        assert "laminate" not in file["problem/plate"]


DAMAGE: dict[str, Callable[[h5py.Group], object]] = {
    "a place beyond the plies": replaced("which", [0, 1, 7, 0]),
    "places that are no whole numbers": replaced("which", [0.0, 1.0, 1.0, 0.0]),
    "too few places": replaced("which", [0, 1]),
    "no angles": lambda group: group.pop("angles"),
    "a group of angles": lambda group: (group.pop("angles"), group.create_group("angles")),
    "angles in two dimensions": replaced("angles", np.zeros((4, 2))),
    "angles that are texts": replaced("angles", ["a", "b", "c", "d"]),
    "a stack that bends": replaced("angles", [90.0, 45.0, 45.0, 0.0]),
    "a ply with a negative modulus": lambda group: group["plies/1"].attrs.modify("E1", -1.0),
    "a ply without a modulus": lambda group: group["plies/1"].attrs.pop("E1"),
    "plies under other names": lambda group: group["plies"].move("0", "zero"),
    "an axis that is a text": lambda group: group.attrs.create("axis", "x"),
    "no plies and no compliances": lambda group: group.pop("plies"),
}


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("laminates") / "a.h5"
    result_of(LAMINATES["several"]).save(path)
    return path


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_laminate_is_refused(damage: str, stored: Path, path: Path) -> None:
    shutil.copy(stored, path)
    with h5py.File(path, "r+") as file:
        DAMAGE[damage](file["problem/plate/laminate"])
    with pytest.raises(InputError, match="is damaged"):
        fastpin.load(path)


def test_names_of_later_versions_are_skipped(stored: Path, path: Path) -> None:
    shutil.copy(stored, path)
    with h5py.File(path, "r+") as file:
        group = file["problem/plate/laminate"]
        group.attrs["later"] = 3.0
        group["more"] = np.zeros(3)
        group["plies/0"].attrs["later"] = 3.0
    assert fastpin.load(path).problem.pair.plate == LAMINATES["several"]

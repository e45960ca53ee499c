"""Files of an older version are read: ``old_files.zip`` was written before bodies and fields became records.

It holds results of both versions of the format with their summaries (``show --json``), a finite plate, and a sweep with
its table. ``python -m scripts.corpus`` wrote them. A new format adds files, and leaves the old ones.
"""

import csv
import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

import fastpin
from fastpin import load, read_case
from fastpin.studies import identity, sweep
from tests.support.commands import printed

RESULTS = ("example", "fretting", "stopped")

READ = ("peak_shear", "angle", "stick", "contact", "slip_zones", "hoop", "kt_", ".slip[")
"""Parts of the names of what is read between the nodes. Ways of reading change, and a node distance is 0.8 degrees."""


@pytest.fixture(scope="module")
def old(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("old")
    with zipfile.ZipFile(Path(__file__).with_name("old_files.zip")) as archive:
        archive.extractall(folder)
    return folder


TIED = ("place", "load_point")
"""Where an extreme is. Rounding chose among equal ones before there was a rule."""

MIRRORED = ".states[0].error_bars.peak_shear_angle"
"""The bar of a symmetric state. It reached to the mirrored peak before."""


def assert_kept(new: Any, old: Any, place: str = "") -> None:
    """Check that nothing of an older summary is missing or different. Numbers may differ by rounding."""
    if isinstance(old, dict):
        assert old.keys() <= new.keys(), place
        for key in old:
            if not (".extremes." in place and key in TIED):
                assert_kept(new[key], old[key], f"{place}.{key}")
    elif isinstance(old, list):
        assert len(new) == len(old), place
        for index, both in enumerate(zip(new, old, strict=True)):
            assert_kept(*both, f"{place}[{index}]")
    elif place == MIRRORED:
        assert new <= old
    elif isinstance(old, float):
        is_read = any(part in place for part in READ)
        relative = 0.1 if "error_bars" in place else 5e-3  # bars are estimates
        rounding = 1e-6 if "shear_integral" in place else 1e-12  # N/m: shear of both senses cancels
        assert new == pytest.approx(old, rel=relative if is_read else 1e-6, abs=1.5 if is_read else rounding), place
    else:
        assert new == old, place


@pytest.mark.gate
@pytest.mark.parametrize("name", RESULTS)
def test_an_old_result_has_the_same_summary(name, old):
    new = json.loads(printed("show", old / f"{name}.h5", "--json"))
    assert_kept(new, json.loads((old / f"{name}.json").read_text(encoding="utf-8")))


def test_an_old_result_has_its_bodies_and_options(old):
    result = load(old / "fretting.h5")
    assert result.problem.pin_body == fastpin.bodies.Tube(4e-3, "uniform")
    assert result.problem.plate_body.outer_radius == 12e-3
    assert result.problem.thickness == 5e-3
    assert result.states[-1].slip_distance.max() > 0.0


def test_an_old_case_has_its_id(old):
    assert identity.run_id(identity.canonical(read_case(old / "example.toml")), "0") == "4ff5bbe128ed40d9"


def test_an_old_finite_plate_is_read(old):
    document = json.loads((old / "lug.compliance").read_text(encoding="utf-8"))
    assert fastpin.bodies.Compliance.from_file(old / "lug.compliance").document() == document


def test_an_old_sweep_is_finished(old):
    """Its runs are not solved again, and its rows are the same."""
    assert "6 done" in printed("sweep", old / "plan.toml", "-o", old / "runs", "--status")
    with (old / "table.csv").open(encoding="utf-8") as file:
        before = list(csv.DictReader(line for line in file if not line.startswith("#")))
    rows = {row["id"]: row for row in sweep.load(old / "runs")}
    assert len(rows) == len(before) == 6
    for row in before:
        new = rows[row["id"]]
        assert row.keys() <= new.keys()
        for name, text in row.items():
            if isinstance(new[name], float) and name != "seconds":
                assert new[name] == pytest.approx(float(text)), name

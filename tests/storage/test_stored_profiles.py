"""Profiles along the rim in HDF5 files and packed results: equal when read back, and described when damaged."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile
from fastpin.report.schema import json_schema
from fastpin.report.summary import document
from fastpin.solver.errors import Interrupted
from fastpin.storage import packed
from fastpin.storage.layout import FORMAT_VERSION, WITH_PROFILES
from fastpin.storage.recording import record, resume, stored_case
from fastpin.storage.store import load, pack, save
from fastpin.studies.identity import canonical, canonical_json
from tests.support.interrupts import StopAt
from tests.support.samples import PAIR, sample_result

HOLE = Profile.ellipse(1e-5 / 3.0, 0.7) + Profile.of("gap", lambda theta: 1e-6 * np.cos(theta) ** 5)
PIN = Profile.flat(1e-5, 0.1) + Profile.crown(-1e-6 / 3.0, -1.0, 0.3)
FRICTION = Profile.constant(0.3) + Profile.zone(0.2, -2.0, -1.0 / 3.0)


def problem(**given: Any) -> Problem:
    return Problem(PAIR, 0.01, 2e-5, **({"friction": 0.3} | given))


GAPS = {"hole": InitialGap(HOLE), "pin": InitialGap(pin=PIN), "both": InitialGap(HOLE, PIN)}


@pytest.mark.parametrize("kind", GAPS)
def test_a_gap_is_stored_exactly(tmp_path: Path, kind: str) -> None:
    result = sample_result(problem=problem(gap=GAPS[kind]))
    save(result, tmp_path / "a.h5")
    assert load(tmp_path / "a.h5").problem == result.problem
    content = pack(result, None, 1_000_000)
    assert content is not None
    assert packed.from_bytes(content).attrs["format_version"] == WITH_PROFILES
    (tmp_path / "a.fastpin").write_bytes(content)
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["format_version"] == WITH_PROFILES
        assert [*file["problem/gap"]] == [*GAPS[kind].given]


def test_files_without_profiles_are_as_before(tmp_path: Path) -> None:
    save(sample_result(), tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["format_version"] == FORMAT_VERSION
        assert "gap" not in file["problem"]
        assert file["problem"].attrs["friction"] == 0.4


@pytest.mark.gate
def test_a_recorded_run_is_resumed_to_the_same_bits(tmp_path: Path) -> None:
    given = problem(friction=FRICTION, gap=InitialGap(Profile.ellipse(3e-6, 0.7)))
    history = LoadHistory([{"P": 5e5}, {"Q": 1e5}, {"Q": -1e5}, {"Q": 1e5}])
    record(given, history, tmp_path / "whole.h5", nodes=41, arc=(-3.0, -0.1))
    with pytest.raises(Interrupted):
        record(given, history, tmp_path / "part.h5", nodes=41, arc=(-3.0, -0.1), progress=StopAt(1.0))
    resume(tmp_path / "part.h5")
    whole, resumed = load(tmp_path / "whole.h5"), load(tmp_path / "part.h5")
    assert resumed.problem == whole.problem == given
    assert [state.pressure.tobytes() for state in resumed] == [state.pressure.tobytes() for state in whole]
    case = stored_case(tmp_path / "whole.h5")
    assert case.problem == given
    found = document(case, whole)
    assert [next(iter(term)) for term in found["problem"]["friction"]] == ["constant", "zone"]
    assert found["problem"]["gap"].keys() == {"hole"}
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(found, json_schema("run"))
    plain = found["problem"] | {"friction": 0.3}
    del plain["gap"]
    jsonschema.validate(found | {"problem": plain}, json_schema("run"))


@pytest.mark.gate
def test_a_profile_enters_ids_with_every_bit(tmp_path: Path) -> None:
    save(sample_result(), tmp_path / "plain.h5")
    assert '"gap"' not in canonical_json(canonical(stored_case(tmp_path / "plain.h5")))
    texts = set()
    for size in (1e-5, np.nextafter(1e-5, 1.0), 0.0):
        save(sample_result(problem=problem(gap=Profile.ellipse(float(size)))), tmp_path / "a.h5")
        texts.add(canonical_json(canonical(stored_case(tmp_path / "a.h5"))))
    save(sample_result(problem=problem(gap=InitialGap(pin=Profile.ellipse(1e-5)))), tmp_path / "a.h5")
    texts.add(canonical_json(canonical(stored_case(tmp_path / "a.h5"))))
    assert len(texts) == 4


def rename(group: Any) -> None:
    group["gap/hole/0"].attrs["kind"] = "bulge"


def no_array(group: Any) -> None:
    del group["gap/hole/1/heights"]


def long_array(group: Any) -> None:
    del group["gap/hole/1/heights"]
    group["gap/hole/1/heights"] = np.zeros(20_001)


def not_finite(group: Any) -> None:
    group["gap/hole/0"].attrs["cosine"] = np.nan


def more(group: Any) -> None:
    group["gap/hole/0"].attrs["size"] = 1.0


def missing(group: Any) -> None:
    del group["gap/hole/0"]


DAMAGES = {
    rename: 'the kind "bulge" of a profile is unknown',
    no_array: "missing",
    long_array: "is no row of at most 20,000 numbers",
    not_finite: "cosine: must be a finite number, not nan",
    more: "size",
    missing: "hole",
}


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_damage_is_described(tmp_path: Path, damage: Any) -> None:
    path = tmp_path / "a.h5"
    save(sample_result(problem=problem(gap=HOLE)), path)
    with h5py.File(path, "a") as file:
        damage(file["problem"])
    with pytest.raises(InputError, match=f"is damaged: .*{DAMAGES[damage]}"):
        load(path)

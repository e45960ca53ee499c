"""Profiles along the rim in HDF5 files and packed results: equal when read back, and described when damaged."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from fastpin import InputError, LoadHistory, Problem, load, record, save
from fastpin.model import InitialGap, Profile
from fastpin.report import json_schema
from fastpin.report.summary import document
from fastpin.storage import packed, stored_case
from fastpin.storage.layout import FORMAT_VERSION, WITH_PROFILES
from fastpin.storage.store import pack
from fastpin.studies.identity import canonical, canonical_json
from tests.support.files import replaced
from tests.support.samples import PAIR, sample_result

HOLE = Profile.ellipse(1e-5 / 3.0, 0.7) + Profile.of("gap", lambda theta: 1e-6 * np.cos(theta) ** 5)
PIN = Profile.flat(1e-5, 0.1) + Profile.crown(-1e-6 / 3.0, -1.0, 0.3)
FRICTION = Profile.constant(0.3) + Profile.zone(0.2, -2.0, -1.0 / 3.0)


def problem(**given: Any) -> Problem:
    return Problem(PAIR, 0.01, 2e-5, **({"friction": 0.3} | given))


GAPS = {"hole": InitialGap(HOLE), "pin": InitialGap(pin=PIN), "both": InitialGap(HOLE, PIN)}


@pytest.mark.parametrize("kind", GAPS)
def test_a_gap_is_stored_exactly(path: Path, kind: str) -> None:
    result = sample_result(problem=problem(gap=GAPS[kind]))
    save(result, path)
    assert load(path).problem == result.problem
    assert packed.from_bytes(pack(result, None, 1_000_000)).attrs["format_version"] == WITH_PROFILES
    with h5py.File(path) as file:
        assert file.attrs["format_version"] == WITH_PROFILES
        assert [*file["problem/gap"]] == [*GAPS[kind].given]


def test_files_without_profiles_are_as_before(path: Path) -> None:
    save(sample_result(), path)
    with h5py.File(path) as file:
        assert file.attrs["format_version"] == FORMAT_VERSION
        assert "gap" not in file["problem"]
        assert file["problem"].attrs["friction"] == 0.4


@pytest.mark.gate
def test_a_run_has_its_profiles_in_its_document(path: Path) -> None:
    given = problem(friction=FRICTION, gap=InitialGap(Profile.ellipse(3e-6, 0.7)))
    history = LoadHistory([{"P": 5e5}, {"Q": 1e5}, {"Q": -1e5}, {"Q": 1e5}])
    record(given, history, path, nodes=41, arc=(-3.0, -0.1))
    case = stored_case(path)
    assert case.problem == given
    found = document(case, load(path))
    assert [next(iter(term)) for term in found["problem"]["friction"]] == ["constant", "zone"]
    assert found["problem"]["gap"].keys() == {"hole"}
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(found, json_schema("run"))
    plain = found["problem"] | {"friction": 0.3}
    del plain["gap"]
    jsonschema.validate(found | {"problem": plain}, json_schema("run"))


@pytest.mark.gate
def test_a_profile_enters_ids_with_every_bit(path: Path) -> None:
    ovals = [Profile.ellipse(size) for size in (0.0, 1e-5, float(np.nextafter(1e-5, 1.0)))]
    texts = []
    for gap in (*ovals, InitialGap(pin=Profile.ellipse(1e-5))):
        save(sample_result(problem=problem(gap=gap)), path)
        texts.append(canonical_json(canonical(stored_case(path))))
    assert '"gap"' not in texts[0]
    assert len(set(texts)) == 4


DAMAGES: dict[str, tuple[Callable[[Any], object], str]] = {
    "another kind": (lambda hole: hole["0"].attrs.modify("kind", "bulge"), 'kind "bulge" of a profile is unknown'),
    "no array": (lambda hole: hole.pop("1/heights"), "missing"),
    "a long array": (replaced("1/heights", np.zeros(20_001)), "is no row of at most 20,000 numbers"),
    "not finite": (lambda hole: hole["0"].attrs.modify("cosine", np.nan), "cosine: must be a finite number, not nan"),
    "a key more": (lambda hole: hole["0"].attrs.modify("size", 1.0), "size"),
    "no term": (lambda hole: hole.pop("0"), "hole"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_described(path: Path, damage: str) -> None:
    change, words = DAMAGES[damage]
    save(sample_result(problem=problem(gap=HOLE)), path)
    with h5py.File(path, "a") as file:
        change(file["problem/gap/hole"])
    with pytest.raises(InputError, match=f"is damaged: .*{words}"):
        load(path)

"""Bodies, profiles along the rim and laminates of stored problems: equal when read back, described when damaged."""

import shutil
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Problem, load, record, save
from fastpin.bodies import Bushing, Compliance, Disk, Plate, Ring, Tube
from fastpin.cracks import Nasgro
from fastpin.model import InitialGap, Laminate, Ply, PlyStrengths, Profile
from fastpin.report import json_schema
from fastpin.report.summary import document
from fastpin.storage import StoredResult, packed, to_xarray
from fastpin.storage.layout import FORMAT_VERSION, WITH_LAMINATE, WITH_PROFILES
from fastpin.storage.store import pack
from fastpin.studies.identity import canonical, canonical_json
from tests.support.files import replaced
from tests.support.samples import PAIR, sample_result

LAW = Nasgro(1e-10 / 3.0, 2.5, 1.0, 0.5, 1e6 / 3.0, 4e7, threshold_slope=-0.1, source="own tests")
BUSH = Bushing(Material(110e9, 0.34, "bronze", yield_strength=2e8, ultimate_strength=4e8, growth=LAW), 0.0125)


def plate() -> Compliance:
    """A compliance whose numbers use all their bits."""
    noise = 1e-3 * np.random.default_rng(1).normal(size=(18, 18))
    noise[0, 0] = 0.3
    noise[-4:] = noise[:, -4:] = 0.0
    return Compliance(0.33, "strain", 0.01, noise + noise.T, {"sxx": np.linspace(0.0, 1.0, 18) / 3.0}, "by hand")


BODIES: list[dict[str, Any]] = [
    {},
    {"pin_body": Tube(0.005)},
    {"pin_body": Tube(1.0 / 300.0, "held"), "plate_body": Ring(0.02, "half")},
    {"plate_body": Plate((1.0 / 30.0, -0.06))},
    {"plate_body": BUSH},
    {"plate_body": Bushing(MATERIALS["2024-T3"], 0.0125, 1e-5 / 3.0, Ring(0.02, "normal"))},
    {"plate_body": Bushing(MATERIALS["steel"], 0.0125, inside=Plate((0.0, 0.05)))},
    {"plate_body": plate()},
]


def problem(**given: Any) -> Problem:
    return Problem(PAIR, 0.01, 2e-5, **({"friction": 0.4} | given))


@pytest.mark.parametrize("bodies", BODIES, ids=repr)
def test_a_problem_with_bodies_comes_back_equal(bodies, path):
    save(sample_result(problem=problem(**bodies)), path)
    found = load(path).problem
    assert found == problem(**bodies)
    assert repr(found) == repr(problem(**bodies))
    assert to_xarray(path).sizes["state"] == 3
    with h5py.File(path) as file:
        assert {"pin_body", "plate_body"} & set(file["problem"]) == set(bodies)


def test_a_compliance_is_stored_whole(path):
    save(sample_result(problem=problem(plate_body=plate())), path)
    found = load(path).problem.plate_body
    assert found.matrix.tobytes() == plate().matrix.tobytes()
    assert found.columns["sxx"].tobytes() == plate().columns["sxx"].tobytes()
    assert found.made_by == "by hand"
    assert found.digest == plate().digest


def test_bodies_in_units_of_the_paper_come_back_equal(path):
    bush = Bushing(Material(110e9, 0.34), 1.25, interference=3.0)
    whole = Problem.from_load_parameter(PAIR, 5.0, 0.4, pin_body=Tube(0.5), plate_body=bush)
    save(sample_result([{"P": 1.0}], problem=whole), path)
    assert load(path).problem == whole


def test_a_file_without_bodies_has_a_solid_pin_in_an_infinite_plate(path):
    save(sample_result(), path)
    found = load(path).problem
    assert (found.pin_body, found.plate_body) == (Disk(), Plate())


def changed(place: str, name: str, value: Any) -> Any:
    """A change of an attribute of a group of /problem."""
    return lambda group: group[place].attrs.__setitem__(name, value)


@pytest.mark.parametrize(
    ("bodies", "change", "words"),
    [
        (BODIES[2], changed("pin_body", "bore_radius", 0.011), "bore_radius: must be at most 0.0096"),
        (BODIES[2], changed("pin_body", "bore_radius", np.nan), "bore_radius: must be a finite number"),
        (BODIES[2], changed("pin_body", "load", "x"), "load: must be"),
        (BODIES[2], changed("pin_body", "kind", "cube"), 'the kind "cube" of problem/pin_body is unknown'),
        (BODIES[2], changed("pin_body", "kind", 5), "the kind 5 of problem/pin_body is unknown"),
        (BODIES[2], changed("plate_body", "outer_radius", -1.0), "outer_radius: must be positive"),
        (BODIES[2], changed("plate_body", "support", 3), "support: must be"),
        (BODIES[3], changed("plate_body", "reaction", [1.0, np.nan]), "reaction: must be a finite number"),
        (BODIES[3], changed("plate_body", "reaction", 5.0), "reaction: must be a point"),
        (BODIES[5], changed("plate_body", "interference", -1.0), "interference: must not be negative"),
        (BODIES[5], changed("plate_body/material", "E", -1.0), "E: Young's modulus must be positive"),
        (BODIES[5], changed("plate_body/inside", "kind", "tube"), "is damaged"),
        (BODIES[5], lambda group: group.__delitem__("plate_body/material"), "is damaged: .*material"),
        (BODIES[7], replaced("plate_body/matrix", np.eye(18)[:5]), "matrix: must have the shape"),
        (BODIES[7], replaced("plate_body/matrix", np.triu(np.ones((18, 18)))), "matrix: must be symmetric"),
        (
            BODIES[7],
            replaced("plate_body/matrix", ["a", "b"]),
            "problem/plate_body/matrix has numbers of the type object",
        ),
        (BODIES[7], lambda group: group.__delitem__("plate_body/matrix"), "no array problem/plate_body/matrix"),
        (BODIES[7], replaced("plate_body/columns/sxx", np.ones(5)), "columns.sxx: must have the shape"),
        (BODIES[7], changed("plate_body", "nu", 0.3), "the compliance was made for nu = 0.3"),
    ],
)
def test_damaged_bodies_are_described(bodies, change, words, path):
    save(sample_result(problem=problem(**bodies)), path)
    with h5py.File(path, "r+") as file:
        change(file["problem"])
    with pytest.raises(InputError, match=words) as raised:
        load(path)
    assert "\n" not in str(raised.value)


class Word(StrEnum):
    BODY = "body"
    RING = "held"
    NAME = "bronze"


@pytest.mark.parametrize("word", [np.str_, Word])
def test_words_of_numpy_and_of_enumerations_become_plain_words(word, tmp_path):
    """HDF5 knows no others."""
    pair = MaterialPair(Material(2e11, 0.3, word("bronze")), PAIR.plate)
    given = Problem(pair, 0.01, 2e-5, 0.4, word("body"), plate_body=Ring(0.02, word("held")))
    assert type(given.pin_load) is type(given.plate_body.support) is type(given.pair.pin.name) is str
    save(sample_result(problem=given), tmp_path / "a.h5")
    assert load(tmp_path / "a.h5").problem == given


HOLE = Profile.ellipse(1e-5 / 3.0, 0.7) + Profile.of("gap", lambda theta: 1e-6 * np.cos(theta) ** 5)
PIN = Profile.flat(1e-5, 0.1) + Profile.crown(-1e-6 / 3.0, -1.0, 0.3)
FRICTION = Profile.constant(0.3) + Profile.zone(0.2, -2.0, -1.0 / 3.0)


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
    case = StoredResult(path).case
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
        texts.append(canonical_json(canonical(StoredResult(path).case)))
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
def test_damaged_profiles_are_described(path: Path, damage: str) -> None:
    change, words = DAMAGES[damage]
    save(sample_result(problem=problem(gap=HOLE)), path)
    with h5py.File(path, "a") as file:
        change(file["problem/gap/hole"])
    with pytest.raises(InputError, match=f"is damaged: .*{words}"):
        load(path)


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


LAMINATE_DAMAGES: dict[str, Callable[[h5py.Group], object]] = {
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


@pytest.mark.parametrize("damage", LAMINATE_DAMAGES)
def test_a_damaged_laminate_is_refused(damage: str, stored: Path, path: Path) -> None:
    shutil.copy(stored, path)
    with h5py.File(path, "r+") as file:
        LAMINATE_DAMAGES[damage](file["problem/plate/laminate"])
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

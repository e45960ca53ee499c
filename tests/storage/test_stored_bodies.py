"""Bodies of problems in HDF5 files: equal when read back, and described when damaged."""

from enum import StrEnum
from typing import Any

import h5py
import numpy as np
import pytest

from fastpin import MATERIALS, InputError, Material, MaterialPair, Problem, load, save
from fastpin.bodies import Bushing, Compliance, Disk, Plate, Ring, Tube
from fastpin.cracks import Nasgro
from fastpin.storage import to_xarray
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


def problem(**bodies: Any) -> Problem:
    return Problem(PAIR, 0.01, 2e-5, 0.4, **bodies)


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

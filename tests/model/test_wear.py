"""How bodies wear: the coefficients, the law, the cycles."""

import pickle

import numpy as np
import pytest

import fastpin
from fastpin import InputError
from fastpin.model import Profile, Wear
from fastpin.model.doubts import wear_doubts
from fastpin.model.profile_terms import Zone
from tests.support.refusals import refused

THETA = np.linspace(-3.0, 0.0, 7)


def test_one_coefficient_is_shared_in_halves():
    assert np.array_equal(Wear(2e-3).coefficients(1.0, THETA), np.full((2, 7), 1e-3))


def test_bodies_have_coefficients_of_their_own_and_zones():
    wear = Wear(pin=1.0, plate=Profile.constant(1.0) + Profile((Zone(2.0, -2.0, -1.0),)))
    pin, plate = wear.coefficients(1.0, THETA)
    assert set(pin) == {1.0}
    assert set(plate) == {1.0, 3.0}
    assert not Wear(plate=1.0).coefficients(1.0, THETA)[0].any()


def test_ten_cycles_a_decade_are_chosen():
    chosen = Wear(1.0, cycles=1e5).chosen
    assert chosen[:6] == (0, 1, 2, 3, 4, 5)
    assert chosen[-1] == 100_000
    assert sum(1000 < each <= 10_000 for each in chosen) == 10
    assert Wear(1.0, cycles=100, at=[5, 50]).chosen == (0, 5, 50, 100)
    assert Wear(1.0).chosen == (0, 1)


def test_wear_can_be_pickled():
    wear = Wear(pin=1.0, cycles=7, at=[3])
    assert pickle.loads(pickle.dumps(wear)) == wear


WRONG = {
    "coefficient: give the wear coefficient, or those of pin and plate": {},
    "coefficient: is that of both bodies together; give it, or those of pin and plate": {"coefficient": 1, "pin": 1},
    "pin: must not be negative, not -1": {"pin": -1.0},
    "cycles: must be a whole number, not 2.5": {"pin": 1, "cycles": 2.5},
    "cycles: must lie between 1 and 1e+12, not 0": {"pin": 1, "cycles": 0},
    "tolerance: must lie between 0 and 0.1, not 0.5": {"pin": 1, "tolerance": 0.5},
    'law: must be "archard" or "energy"': {"pin": 1, "law": "linear"},
    "at: must be at most 10,000 increasing numbers of cycles": {"pin": 1, "cycles": 9, "at": [3, 2]},
    "at: must lie between": {"pin": 1, "cycles": 9, "at": [10]},
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_wear_is_refused_in_one_sentence(message):
    assert str(refused(Wear, **WRONG[message])).startswith(message)


def test_coefficients_of_zero_are_refused():
    with pytest.raises(InputError, match="coefficient: must be positive somewhere on pin or plate"):
        Wear(0.0).coefficients(1.0, THETA)


@pytest.mark.parametrize(
    ("given", "doubtful"),
    [
        ({"coefficient": 1e-14}, False),
        ({"coefficient": 1e-8}, True),  # 1e-14 in 1/MPa
        ({"pin": 1e-15, "plate": Profile.constant(1e-15) + Profile((Zone(1e-5, -2.0, -1.0),))}, True),
        ({"plate": 3e-11}, False),
    ],
)
def test_a_coefficient_in_another_unit_is_doubted(given, doubtful):
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
    found = [str(doubt) for doubt in wear_doubts(problem, Wear(**given))]
    assert len(found) == doubtful
    assert all("1/Pa is more than any surface wears; numbers in 1/MPa are to be" in each for each in found)
    in_megapascals = fastpin.MaterialPair(fastpin.Material(116e3, 0.32), fastpin.Material(69e3, 0.33))
    other = fastpin.Problem(in_megapascals, hole_radius=10.0, clearance=0.02, friction=0.4)
    assert wear_doubts(other, Wear(1e-8)) == []  # N, mm and MPa fit together
    assert wear_doubts(fastpin.Problem.from_load_parameter(pair, 0.1, 0.4), Wear(7.0)) == []

"""Profiles in Python: what stands for one, and the sentences of values that can't."""

import math

import numpy as np
import pytest

import fastpin
from fastpin import InputError
from fastpin.model import Profile, Wear
from tests.support.refusals import refused

THETA = np.linspace(-np.pi, np.pi, 41)

PROFILES = [
    Profile.constant(0.3),
    Profile.lobes(3, 0.1, 0.4),
    Profile.crown(-0.2, 0.5, 0.3),
    Profile.zone(0.3, -1.0, 0.5),
    Profile.samples([-2.0, -1.0, 0.0, 1.0, 2.5], [0.1, 0.2, 0.1, 0.4, 0.3]),
    Profile.constant(0.2) + Profile.zone(0.1, 0.0, 1.0) + Profile.harmonic(2, 0.1, -0.05),
]


def test_a_function_of_one_angle_is_named_with_its_failure() -> None:
    with pytest.raises(InputError, match=r"gap\.hole: failed for an array of angles: ") as raised:
        fastpin.model.InitialGap(lambda theta: 1e-6 * math.cos(theta))
    assert isinstance(raised.value.__cause__, TypeError)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: Profile.ellipse(1.0).values("0", 1.0), "theta: "),
        (lambda: Profile.ellipse(1.0).values([0.0], "1"), "radius: "),
        (lambda: Profile.ellipse(1.0).angles(-1, 1.0), "count: "),
        (lambda: Profile.ellipse(1.0).words(3), "text: "),
        (lambda: Profile.of(3, 0.1), "place: "),
        (lambda: Wear(1e-15).coefficients(1.0, 0.0), "theta: "),
        (lambda: Wear(1e-15).coefficients(0.0, [0.0]), "radius: "),
        (lambda: Profile.constant(0.3).scaled("2"), "factor: must be a number"),
        (lambda: Profile.flat(0.1, 0.0).scaled(-1.0), "depth: must be positive, not -0.1"),
        (
            lambda: fastpin.model.InitialGap(pin="roundness.csv"),
            'gap.pin: is the name of a file: Profile.from_csv("roundness.csv") reads it',
        ),
    ],
)
def test_arguments_are_checked(call, sentence: str) -> None:
    assert str(refused(call)).startswith(sentence)


def test_values_are_those_of_lists_and_of_whole_numbers() -> None:
    profile = Profile.ellipse(2.0)
    assert profile.values([0, 1], 1).tolist() == profile.values(np.array([0.0, 1.0]), 1.0).tolist()


def test_a_constant_has_no_sine() -> None:
    assert Profile.harmonic(0, 1.0, 0.5) == Profile.constant(1.0)


@pytest.mark.parametrize("profile", PROFILES, ids=repr)
@pytest.mark.parametrize("factor", [0.0, -1.0, 2.5])
def test_a_scaled_profile_has_scaled_values(profile: Profile, factor: float) -> None:
    found = profile.scaled(factor)
    assert np.allclose(found.values(THETA, 1.0), factor * profile.values(THETA, 1.0), rtol=1e-14, atol=1e-15)
    assert [type(term) for term in found.terms] == [type(term) for term in profile.terms]


def test_a_scaled_flat_has_another_depth() -> None:
    assert Profile.flat(0.1, 0.0).scaled(0.5) == Profile.flat(0.05, 0.0)

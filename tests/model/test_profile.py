"""Profiles in Python: what stands for one, and the sentences of values that can't."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.model.profile import Profile
from fastpin.model.wear import Wear


def test_a_function_of_one_angle_is_named_with_its_failure() -> None:
    with pytest.raises(InputError, match=r"gap\.hole: failed for an array of angles: ") as raised:
        fastpin.model.InitialGap(lambda theta: 1e-6 * math.cos(theta))
    assert isinstance(raised.value.__cause__, TypeError)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: Profile.ellipse(1.0).values("0", 1.0), "theta"),
        (lambda: Profile.ellipse(1.0).values([0.0], "1"), "radius"),
        (lambda: Profile.ellipse(1.0).angles(-1, 1.0), "count"),
        (lambda: Profile.ellipse(1.0).words(3), "text"),
        (lambda: Profile.of(3, 0.1), "place"),
        (lambda: Wear(1e-15).coefficients(1.0, 0.0), "theta"),
        (lambda: Wear(1e-15).coefficients(0.0, [0.0]), "radius"),
    ],
)
def test_arguments_of_methods_are_checked(call, field: str) -> None:
    with pytest.raises(InputError) as raised:
        call()
    assert raised.value.field == field


def test_values_are_those_of_lists_and_of_whole_numbers() -> None:
    profile = Profile.ellipse(2.0)
    assert profile.values([0, 1], 1).tolist() == profile.values(np.array([0.0, 1.0]), 1.0).tolist()


def test_a_constant_has_no_sine() -> None:
    assert Profile.harmonic(0, 1.0, 0.5) == Profile.constant(1.0)

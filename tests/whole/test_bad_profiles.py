"""A wrong profile along the rim gets the same sentence in Python, case files, plans and on the command line."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import InputError, Problem
from fastpin.model import InitialGap, Profile
from tests.support.case_texts import PRESSED
from tests.support.everywhere import one_sentence
from tests.support.samples import PAIR


def hole(profile: Any) -> Problem:
    return Problem(PAIR, 0.01, 1e-5, 0.3, gap=profile)


sampled = Profile.samples


def rubbed(profile: Any) -> Problem:
    return Problem(PAIR, 0.01, 1e-5, profile)


FOUR = [0.0, 1.5, 3.0, 4.5]

CASES: list[tuple[str, str, str, Callable[[], Any]]] = [
    ("gap.hole", "{ ellipse = 5e-3 }", "", lambda: hole(Profile.ellipse(5e-3))),
    ("gap.hole", "{ ellipse = nan }", "ellipse", lambda: Profile.ellipse(math.nan)),
    ("gap.hole", "{ lobes = 0, size = 1e-6 }", "lobes", lambda: Profile.lobes(0, 1e-6)),
    ("gap.hole", "{ lobes = 3, size = true }", "size", lambda: Profile.lobes(3, True)),
    ("gap.hole", "{ harmonic = 1001 }", "harmonic", lambda: Profile.harmonic(1001)),
    ("gap.hole", "{ flat = -1e-6, centre = 0 }", "flat", lambda: Profile.flat(-1e-6, 0.0)),
    ("gap.pin", "{ crown = inf, centre = 0, half_width = 9 }", "crown", lambda: Profile.crown(math.inf, 0.0, 0.1)),
    ("gap.pin", "{ zone = 1e-6, start = 0, stop = 9 }", "", lambda: InitialGap(pin=Profile.zone(1e-6, 0.0, 0.1))),
    ("gap.pin", "{ angles = [0, 90, 180, 270], values = [0, 1, 2] }", "values", lambda: sampled(FOUR, [0, 1, 2])),
    ("gap.pin", "{ angles = [0, 90, 180, 170], values = [0, 1, 2, 1] }", "angles", lambda: sampled([0, 1, 2, 1], FOUR)),
    ("gap.hole", '"wide"', "", lambda: InitialGap("wide")),  # type: ignore[arg-type]
    ("contact.friction", "{ harmonic = 1, cosine = 0.1 }", "", lambda: rubbed(Profile.harmonic(1, 0.1))),
    ("contact.friction", "{ zone = 2e6, start = -9, stop = 9 }", "", lambda: rubbed(Profile.zone(2e6, 0, 1))),
    ("contact.friction", "{ flat = 1e-5, centre = 0 }", "", lambda: rubbed(Profile.flat(1e-5, 0.0))),
    ("contact.friction", "[0.4]", "", lambda: rubbed([0.4])),
    ("contact.friction", '"rough"', "", lambda: rubbed("rough")),
]  # fmt: skip


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]} {case[1]}")
def test_a_wrong_profile_gets_the_same_sentence_everywhere(case: Any, tmp_path: Path) -> None:
    field, value, word, in_python = case
    section, key = field.split(".")
    text = PRESSED.replace("friction = 0.3", f"friction = {value}")
    if section == "gap":
        text = f"{PRESSED}\n[gap]\n{key} = {value}\n"
    _, words = one_sentence(in_python, section, text, PRESSED, f"[grid]\n{field} = [{value}]\n", tmp_path)
    assert words.startswith(f"{key}.{word}: " if word else f"{key}: ")


def test_functions_that_are_no_profiles_are_refused() -> None:
    for function, words in (
        (lambda theta: theta, "values: must be equal at the ends of a turn"),
        (lambda theta: 1e-6, "must return an array of the shape"),
        (lambda: 1e-6, "must be a callable of 1 arguments"),
        (lambda theta: theta * np.nan, "must be finite numbers in one row"),
        (lambda theta: theta * 1j, "must be a number"),
    ):
        with pytest.raises(InputError, match=words):
            hole(function)


def test_angles_in_degrees_are_refused_in_python() -> None:
    for made in (
        lambda: Profile.ellipse(1e-6, 45.0),
        lambda: Profile.flat(1e-6, -90.0),
        lambda: Profile.zone(0.1, -30.0, 30.0),
        lambda: Profile.crown(1e-6, 45.0, 0.1),
    ):
        with pytest.raises(InputError, match="must lie within two turns: angles are in rad"):
            made()
    with pytest.raises(InputError, match="must increase, all within one turn"):
        hole(([0.0, 90.0, 180.0, 270.0], [0.0, 1e-6, 0.0, 1e-6]))

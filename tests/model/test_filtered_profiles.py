"""Profiles that are filtered, and the doubt about waves that the nodes do not resolve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import InputError, SolveOptions
from fastpin.model import InitialGap, Profile
from fastpin.model.doubts import doubts
from tests.support.refusals import refused

ANGLES = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]

STEEL = fastpin.MATERIALS["steel"]


def rough(theta: np.ndarray) -> np.ndarray:
    """The form of a hole, and a wave of its roughness, m."""
    return 1e-6 + 4e-6 * np.cos(2.0 * theta - 1.0) + 1e-7 * np.sin(15.0 * theta) + 3e-7 * np.cos(90.0 * theta)


def warned(gap: InitialGap | Profile, nodes: int, force: float = 2e6) -> list[str]:
    problem = fastpin.Problem(fastpin.MaterialPair(STEEL, STEEL), 10e-3, 20e-6, 0.2, gap=gap)
    found = doubts(problem, fastpin.LoadHistory([{"P": force}]), SolveOptions(nodes=nodes))
    return [str(doubt) for doubt in found if doubt.field == "gap"]


def test_a_filter_keeps_the_long_waves() -> None:
    filtered = Profile.samples(ANGLES, rough(ANGLES), 15)
    form = rough(ANGLES) - 3e-7 * np.cos(90.0 * ANGLES)
    assert filtered.at(ANGLES, 1.0) == pytest.approx(form, abs=1e-13)
    assert filtered.words(lambda value: f"{value}") == "16 waves, with up to 15 round the hole"
    assert filtered.filtered(20).at(ANGLES, 1.0) == pytest.approx(form, abs=1e-13)
    assert Profile.harmonic(3, 1e-6, 2e-6).filtered(2).at(ANGLES, 1.0) == pytest.approx(np.zeros(720), abs=1e-20)


def test_a_filter_in_a_case_file_is_that_of_python(tmp_path: Path) -> None:
    rows = "".join(
        f"{np.degrees(angle) + 90.0:.17g},{value:.17g}\n" for angle, value in zip(ANGLES, rough(ANGLES), strict=True)
    )
    (tmp_path / "hole.csv").write_text("angle [deg],gap [m]\n" + rows)
    case = EXAMPLE.format('{ file = "hole.csv", harmonics = 15 }')
    (tmp_path / "case.toml").write_text(case)
    hole = fastpin.read_case(tmp_path / "case.toml").problem.gap.hole
    assert hole.entries() == Profile.from_csv(tmp_path / "hole.csv", harmonics=15).entries()
    assert hole.at(ANGLES, 1.0) == pytest.approx(Profile.samples(ANGLES, rough(ANGLES), 15).at(ANGLES, 1.0), abs=1e-12)


EXAMPLE = """pin.material = "steel"
plate.material = "steel"
contact = {{ hole_radius = 10e-3, clearance = 20e-6, friction = 0.2 }}
gap.hole = {}
load = [{{ P = 2e6 }}]
"""

REFUSED = {
    '{ file = "no.csv", harmonics = 15 }': "hole.file: no.csv: there is no such file",
    "{ lobes = 2, size = 1e-6, harmonics = 0 }": "hole.harmonics: must be a whole number from 1 to 500, not 0",
    "{ flat = 1e-6, centre = 0, harmonics = 15 }": "hole.harmonics: can't filter a flat",
    '{ file = "no.csv", axis = 15 }': "hole: must be a table with one of",
    "{ harmonics = 15 }": "hole: must be a table with one of",
}


@pytest.mark.parametrize("table", REFUSED)
def test_refusals(table: str, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(EXAMPLE.format(table))
    assert REFUSED[table] in str(refused(fastpin.read_case, tmp_path / "case.toml"))


def test_a_filter_of_too_many_waves_is_refused() -> None:
    with pytest.raises(InputError, match="harmonics: must be a whole number from 1 to 500, not 501"):
        Profile.ellipse(1e-6).filtered(501)


def test_waves_shorter_than_the_nodes_are_doubted() -> None:
    """101 nodes on half of the rim: eight of them are 14.4 degrees. The wave presses with four times its slope."""
    measured = Profile.samples(ANGLES, rough(ANGLES))
    (sentence,) = warned(measured, 101)
    assert sentence == (
        "gap: has waves shorter than 14 degrees, 25 round the hole, the shortest that 101 nodes resolve; they press "
        "with 1.1 times the bearing stress, and results follow the nodes; harmonics = 15 in the profile filters them"
    )
    assert warned(measured, 801) == warned(measured.filtered(15), 101) == []
    assert warned(InitialGap(pin=measured), 101) == [sentence]
    assert warned(Profile.ellipse(20e-6), 21) == warned(Profile.flat(4e-6, 0.0), 101) == []
    assert warned(measured, 101, force=2e8) == []

"""Profiles along the rim in figures: on their own, in captions, and exaggerated in sketches."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Circle, Polygon

from fastpin import InputError, Problem, read_case
from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.figures import plot_gap, plot_sketch
from fastpin.figures.sketch import GAP, LARGEST_GAP
from fastpin.figures.style import caption
from fastpin.model import InitialGap, Profile
from tests.support.case_texts import PRESSED
from tests.support.drawing import legend_words, plain
from tests.support.samples import PAIR

ROUND = Problem(PAIR, 0.01, 2e-5, 0.4, "body")
BOTTOM = -0.5 * np.pi
HOLE, PIN = Profile.ellipse(4e-6) + Profile.lobes(5, 1e-6), Profile.crown(-2e-6, BOTTOM, 0.5)
FRICTION = Profile.constant(0.4) + Profile.zone(-0.3, BOTTOM - 0.5, BOTTOM + 1.0)
LOBED = replace(ROUND, gap=InitialGap(HOLE, PIN), friction=FRICTION)


def test_gaps_and_friction_have_a_panel_each() -> None:
    upper, lower = plot_gap(LOBED, title="Lobes").axes
    hole, pin, both, *_ = (each.get_xydata().T for each in upper.lines)
    theta = np.radians(hole[0] - 90.0)
    assert hole[1] == pytest.approx(1e6 * HOLE.at(theta, 0.01), abs=1e-9)
    assert pin[1] == pytest.approx(1e6 * PIN.at(theta, 0.01), abs=1e-9)
    assert both[1] == pytest.approx(hole[1] + pin[1])
    assert upper.get_ylabel() == "initial gap (µm)"
    angle, friction = lower.lines[0].get_xydata().T
    assert np.ptp(angle) > 359.0
    assert (friction.min(), friction.max()) == (pytest.approx(0.1), pytest.approx(0.4))
    (jump,) = np.flatnonzero(np.diff(friction) < -0.2)
    assert angle[jump : jump + 2] == pytest.approx(np.degrees(-0.5), abs=1e-3)


def test_only_what_varies_is_drawn() -> None:
    (panel,) = plot_gap(replace(ROUND, friction=FRICTION)).axes
    assert panel.get_ylabel() == "friction coefficient"
    figure = plot_gap(replace(ROUND, gap=InitialGap(HOLE)))
    assert legend_words(figure) == ["hole"]
    with pytest.raises(InputError, match=r"^gap: there is no initial gap, and the friction is the same all round$"):
        plot_gap(ROUND)
    with pytest.raises(InputError, match=r"^joint: must be a Problem, Case or Result, not 3$"):
        plot_gap(3)  # type: ignore[arg-type]


def test_captions_hold_the_profiles() -> None:
    text = plain(caption(LOBED))
    assert "friction coefficient 0.1 to 0.4 along the rim: 0.4 and -0.3 more from -28.65 to 57.3 deg" in text
    assert "initial gap of the hole: oval of 4 µm, largest at 90 deg and 5 lobes of 1 µm, one at" in text
    assert "initial gap of the pin: crown of −2 µm at 0 deg, half width 28.65 deg" in text
    many = Profile.crown(0.0, 0.5, 1e-6)
    for k in range(1, 6):
        many = many + Profile.lobes(k, 1e-7)
    assert " and 2 more terms" in caption(replace(ROUND, gap=InitialGap(many)))
    assert "gap" not in caption(ROUND)


@pytest.mark.gate
def test_a_case_file_has_the_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    text = f"{PRESSED}[gap]\nhole = {{ ellipse = 2e-6, axis = 0 }}\n"
    Path("case.toml").write_text(text)
    assert main(["plot", "case.toml", "gap", "--csv", "gap.csv"]) == 0
    rows = list(csv.DictReader(Path("gap.csv").read_text().splitlines()))
    angle, gap = (np.array([float(row[name]) for row in rows]) for name in ("angle [deg]", "gap of the hole [m]"))
    assert gap == pytest.approx(2e-6 * np.cos(2.0 * np.radians(angle)), abs=1e-12)
    for extra, words in ((["--after", "1"], "--after: chooses a profile"), (["--states", "1"], "--states: ")):
        assert main(["plot", "case.toml", "gap", *extra]) == 2
        assert words in capsys.readouterr().err
    assert plot_gap(parse_case(text)).axes


def test_the_case_of_the_documents_has_all_profiles() -> None:
    case = read_case(Path(__file__).parents[2] / "docs" / "worn-lug.toml")
    assert set(case.problem.profiles) == {"gap.hole", "gap.pin", "contact.friction"}
    assert case.wear is not None


def rims(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """The drawn points of hole and pin, as complex numbers."""
    hole, pin = plot_sketch(problem).axes[0].patches[1:3]
    assert isinstance(hole, Polygon)
    assert isinstance(pin, (Polygon, Circle))
    found = [
        patch.get_path().transformed(patch.get_patch_transform()).interpolated(20).vertices for patch in (hole, pin)
    ]
    return found[0] @ (1.0, 1j), found[1] @ (1.0, 1j)


@pytest.mark.parametrize("problem", [LOBED, replace(ROUND, gap=InitialGap(Profile.lobes(3, 1e-6, 0.4), HOLE))])
def test_a_sketch_exaggerates_the_gap_and_lets_the_pin_touch(problem: Problem) -> None:
    hole, pin = rims(problem)
    grown = np.abs(hole) - 1.0
    assert np.abs(grown).max() <= LARGEST_GAP + 1e-9
    given = problem.gap.hole.at(np.angle(hole), 0.01)
    assert np.corrcoef(grown, given)[0, 1] > 0.999
    room = np.interp(np.angle(pin), np.angle(hole), np.abs(hole), period=2.0 * np.pi) - np.abs(pin)
    assert room.min() == pytest.approx(0.0, abs=2e-2 * GAP)  # the pin moves little, so that it touches at first order
    assert np.angle(pin[np.argmin(room)]) == pytest.approx(BOTTOM, abs=0.5 * np.pi)
    words = plot_sketch(problem).axes[0].get_title().replace("\n", " ")
    assert "clearance and initial gap exaggerated" in words


def test_a_pin_without_clearance_fills_its_hole() -> None:
    tight = replace(ROUND, clearance=-1e-5, gap=InitialGap(HOLE))
    hole, pin = rims(tight)
    assert np.abs(hole) == pytest.approx(np.abs(pin))

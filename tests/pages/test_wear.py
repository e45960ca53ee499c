"""The page of a life of wear."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import InputError, Interrupted
from fastpin.assess.outputs import MAX_ROWS
from fastpin.model import About
from fastpin.model.wear import cycles_text
from fastpin.pages import source, write_report
from fastpin.pages.sections import provenance
from fastpin.pages.wear import WEAR_SECTIONS, damage, numbers, overview
from fastpin.wear_lives import WearResult, WornCycle
from tests.support.html import Page, words_of
from tests.support.lives import JOINT, sample_life
from tests.support.tiers import gate

CASE = """title = "Worn lug"
[pin]
material = "steel"
[plate]
material = "2024-T3"
[plate.fatigue]
fatigue_strength = 714e6
strength_exponent = -0.078
fatigue_ductility = 0.166
ductility_exponent = -0.538
[contact]
hole_radius = 0.01
clearance = 2e-5
friction = 0.5
pin_load = "centre"
rotation = "fixed"
[gap]
hole = { ellipse = 1e-6, axis = 90 }
[[load]]
P = 2e6
[[load]]
Q = [8e5, -8e5]
repeat = 3
[wear]
pin = 2e-12
plate = 8e-12
"""
"""The case of :func:`sample_life`, with another number of cycles."""


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wear")
    (folder / "life.toml").write_text(CASE)
    sample_life(folder / "life.h5")
    return folder / "life.h5"


@pytest.fixture(scope="module")
def life(stored: Path) -> WearResult:
    return fastpin.load_wear(stored)


@pytest.fixture
def only(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """A function that leaves these sections on the page, without damage: it takes seconds."""

    def leave(*sections: object) -> None:
        monkeypatch.setattr("fastpin.pages.result.WEAR_SECTIONS", sections)
        monkeypatch.setattr(source, "damages", lambda cycles, how: [])

    return leave


@pytest.mark.gate
@pytest.mark.filterwarnings("error")
def test_page_of_a_stored_life_is_whole(stored: Path, life: WearResult) -> None:
    calls: list[tuple[float, float]] = []
    write_report(stored, stored.with_name("page.html"), progress=lambda done, total: calls.append((done, total)))
    page = Page(stored.with_name("page.html").read_text(encoding="utf-8"))
    assert calls[-1] == (len(WEAR_SECTIONS), len(WEAR_SECTIONS))
    assert [found["id"] for tag, found in page.attributes if tag == "section"] == [
        "overview", "wear", "profile", "damage", "case", "materials", "loads", "contact", "stresses", "margins",
        "checks", "provenance",
    ]  # fmt: skip
    assert page.tags.count("svg") + page.tags.count("img") == page.tags.count("figcaption") == 11
    last, found = life[-1], life.fatigue()
    assert "summed up from" not in page.text
    for part in (
        "Worn lug", "Complete: 60 cycles.", "Stored cycles",
        f"{last.solved} cycles were really solved", "Debris is not modelled.",
        "wear coefficient of the plate", "8e-12 1/Pa", "0.01 of the largest depth", f"{1e9 * last.depth:.4g} nm deep",
        "20 % of the volume from the pin", f"{1e-6 * life[2].largest_pressure:.5g}",
        f"{1e12 * last.volumes[1]:.4g} um^2",
        "gone with the material", "no crack within 60 cycles", cycles_text(float(f"{found.first_life:.4g}")), "x 60",
        f"{found.hot_spots[-1].damage:.4g}, at", "One cycle on the profile after 60 cycles: load points 121 to 123.",
        "SHA-256 of the file", "Input of the life of wear", '"law": "archard"', '"plate": 8e-12', "repeat = 3", "met",
    ):  # fmt: skip
        assert part in page.text, part
    assert "not met" not in page.text
    assert "2e+05" not in page.text
    assert "nan" not in page.text.split()


@pytest.mark.survey
@pytest.mark.usefixtures("undrawn")
def test_a_life_in_memory_has_the_same_page(stored, life, tmp_path, monkeypatch):
    monkeypatch.setattr("fastpin.pages.result.now", lambda: "today")
    about = About(project="Hinge")
    found = words_of(life, tmp_path / "memory.html", title="Worn lug", about=about)
    assert "none: a result in memory" in found
    assert "Hinge" in found
    kept = words_of(stored, tmp_path / "file.html", about=about)
    first, last = (kept.index(words) for words in ("2. Wear\n", "5. Case\n"))
    assert kept[first:last] in found
    life.report(tmp_path / "page.html", title="Worn lug", about=about)
    assert (tmp_path / "page.html").read_text() == (tmp_path / "memory.html").read_text()


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_the_case_file_must_be_that_of_the_life(stored: Path, only: Callable[..., None], tmp_path: Path) -> None:
    only(provenance)
    other = tmp_path / "other.toml"
    other.write_text(CASE.replace("Q = [8e5, -8e5]", "Q = [8e5, -7e5]"))
    with pytest.raises(InputError, match=r"other\.toml is not the case of this result: loads differs"):
        write_report(stored, tmp_path / "page.html", case=other)
    other.write_text(CASE.replace("repeat = 3", "repeat = 60"))
    assert "repeat = 60" in words_of(stored, tmp_path / "page.html", case=other)


def longer(life: WearResult, count: int) -> WearResult:
    """A life with so many stored cycles, whose largest pressure is in their middle."""
    first = life[0]
    pressed = tuple(replace(state, pressure=2.0 * state.pressure) for state in first.states)
    cycles: list[WornCycle] = [replace(first, cycle=k, plate_depth=k * 1e-9 + first.plate_depth) for k in range(count)]
    cycles[count // 2] = replace(cycles[count // 2], states=pressed)
    return replace(life, cycles=tuple(cycles))


@pytest.mark.usefixtures("undrawn")
def test_a_long_table_is_cut_and_holds_the_extremes(life, only, tmp_path):
    only(overview, numbers)
    many = longer(life, 101)
    found = words_of(many, tmp_path / "page.html")
    assert found.count("more …") == 2
    assert "The table lacks its middle, but not the extremes" in found
    largest = f"{1e-6 * many[50].largest_pressure:.5g}"
    assert f"Largest contact pressure over a cycle: {1e-6 * many[50].largest_pressure:.4g} MPa after 50 cycles" in found
    lines = many.summary().splitlines()
    assert len(lines) == MAX_ROWS + 2 + 3
    assert [line.split()[4] for line in lines if line.split()[0] == "50"] == [largest]
    assert [line for line in lines if "more" in line] == ["... 30 more ...", "... 30 more ..."]


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_the_damage_of_many_cycles_says_from_how_many_it_is(life, tmp_path, monkeypatch):
    monkeypatch.setattr(source, "MOST_SUMMED", 3)
    monkeypatch.setattr("fastpin.pages.result.WEAR_SECTIONS", [damage])
    assert "The damage is summed up from 3 of 4 stored cycles." in words_of(life, tmp_path / "page.html")


@pytest.mark.usefixtures("undrawn")
def test_an_unfinished_life_says_so(stored: Path, life: WearResult, only: Callable[..., None], tmp_path: Path) -> None:
    only(overview)
    ended = replace(life, cycles=life.cycles[:3], complete=False)
    found = words_of(ended, tmp_path / "page.html")
    assert "Unfinished: 20 of 60 cycles." in found
    assert "Complete" not in found
    path = tmp_path / "ended.h5"
    path.write_bytes(stored.read_bytes())
    for error, words in (
        ("the depth is too large", "The reason: the depth is too large."),
        (str(Interrupted()), f"Continue with: fastpin wear CASE -o {path} --resume."),
    ):
        with h5py.File(path, "r+") as file:
            file.attrs["complete"], file.attrs["error"] = False, error
        assert words in words_of(path, tmp_path / "page.html")


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("count", [0, *gate(1)])
def test_a_life_that_ended_at_once_says_what_is_missing(count: int, life: WearResult, tmp_path: Path) -> None:
    ended = replace(life, cycles=life.cycles[:count], complete=False)
    found = words_of(ended, tmp_path / "page.html")
    assert "Unfinished: 0 of 60 cycles." in found
    assert ("There is no stored profile: the life ended before its first cycle." in found) == (count == 0)
    assert "Damage needs the profile of cycle 0 and another one." in found
    assert count == 0 or "There is no figure of the slip: the cycle to corner 3 is not closed" in found


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_plate_without_constants_has_no_damage(tmp_path: Path) -> None:
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
    plain = sample_life(problem=replace(JOINT, pair=pair), cycles=2, at=[1], pin=None, tolerance=0.0)
    found = words_of(plain, tmp_path / "page.html")
    assert "Damage needs constants for a life by smith-watson-topper" in found
    assert "wear coefficient of the pin" not in found
    assert "0: every cycle is solved" in found
    assert not np.any(plain[-1].pin_depth)


def test_a_pin_that_turns_by_more_than_a_node_is_doubted(life: WearResult, tmp_path: Path) -> None:
    assert life.doubts == []
    far = tuple(replace(state, slip_distance=np.full_like(state.pressure, 1e-3)) for state in life[0].states)
    turned = replace(life, cycles=(replace(life[0], states=far), *life.cycles[1:]))
    assert [str(each) for each in turned.doubts] == [
        "pin: the pin slips by 0.001 m in a piece of the cycle, more than a node distance, 0.00036 m; its wear is kept "
        "where the pin touched first"
    ]

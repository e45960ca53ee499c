"""The page of a sweep: plan, maps, runs, failed runs; where the plan is found."""

import re
from pathlib import Path

import pytest

from fastpin.errors import InputError
from fastpin.pages import write_sweep_report
from fastpin.studies import read_plan, sweep
from scripts.inline import Inline
from tests.support.html import Page
from tests.support.samples import JOINT

CASE = f"""{JOINT}
pin_load = "centre"
[[load]]
P = 1e6
[[load]]
M = 0.0
[solve]
nodes = 41
"""

PLAN = """title = "Moments & <i>friction</i>"
case = "case.toml"
[grid]
"load.2.M" = [0.0, 1e7]
"contact.friction" = [0.2, 0.4]
[outcomes]
largest = { quantity = "peak_pressure", take = "largest" }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The directory of a sweep of four runs, two of which fail, beside its plan."""
    place = tmp_path_factory.mktemp("sweep")
    (place / "case.toml").write_text(CASE)
    (place / "plan.toml").write_text(PLAN)
    summary = sweep.run(read_plan(place / "plan.toml"), place / "plan", Inline())
    assert (summary.done, len(summary.failed)) == (2, 2)
    return place / "plan"


@pytest.fixture(scope="module")
def text(folder: Path) -> str:
    """The page of the sweep."""
    path = folder.parent / "page.html"
    write_sweep_report(folder, path)
    return path.read_text(encoding="utf-8")


@pytest.mark.gate
def test_page_is_whole_and_escapes_the_title(text: str) -> None:
    page = Page(text)
    assert len(page.ids) == len(set(page.ids))
    inside = {link for link in page.links if link.startswith("#")}
    assert {link.removeprefix("#") for link in inside} <= set(page.ids)
    assert all(link.startswith("data:image/png;base64,") for link in set(page.links) - inside)
    assert page.sources == []
    assert "http" not in re.sub(r'http-equiv="[^"]*"', "", text)
    assert "i" not in page.tags
    assert "Moments & <i>friction</i>" in page.text


def test_page_has_plan_figures_runs_failed_runs_and_versions(text: str, folder: Path) -> None:
    page = Page(text)
    assert page.tags.count("svg") == 1
    assert "4 points: 2 done, 2 failed, 0 waiting" in page.text
    for row in sweep.rows(read_plan(folder.parent / "plan.toml"), folder):
        assert page.text.count(row["id"]) >= 1 + (row["status"] == "failed")
        if row["status"] == "failed":
            assert row["reason"] in page.text
    assert '"contact.friction" = [0.2, 0.4]' in page.text
    assert "SHA-256 of fields and runs" in page.text


OUTCOMES = """
energy = { quantity = "dissipation" }
width = { quantity = "contact_width" }
volume = { wear = "volume", cycles = 1e4, coefficient = 1e-14 }
lost = { cycle = "dissipation" }
share = { wear = "pin_share", cycles = 5, pin = [{ constant = 1e-14 }, { zone = 2e-14, start = -9, stop = 9 }] }
life = { wear = "life", cycles = 10, pin = 1e-14, law = "energy", criterion = "fatemi-socie" }
"""


@pytest.mark.gate
@pytest.mark.parametrize("extra", ["", "plate.nu = [0.3, 0.31]\n"])
def test_maps_of_several_outcomes_stand_side_by_side(folder: Path, extra: str, tmp_path: Path) -> None:
    """The case has no cycles, so the outcomes of cycles have no values."""
    plan = folder.parent / "several.toml"
    plan.write_text(PLAN.replace("[outcomes]", f"{extra}[outcomes]") + OUTCOMES)
    sweep.run(read_plan(plan), tmp_path / "several", Inline())
    write_sweep_report(tmp_path / "several", tmp_path / "page.html", plan=plan)
    page = Page((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert page.tags.count("figcaption") == (3 if extra else 1)  # a panel for each value of a third field
    together = re.search(r"Largest \(\w+\), energy \(\w+/m\), width \(deg\) over ", page.text)
    assert (together is None) == bool(extra)
    assert extra or "energy (J/m): 2 points have no value." in re.sub(r"\([a-z]?J", "(J", page.text)
    for name in ("volume", "lost", "life"):
        assert f"There is no figure of {name}: no run has a value." in page.text
    for words in (
        'quantity = "dissipation", take = "last", over = "history"',
        'wear = "volume", coefficient = 1e-14, cycles = 10000', 'cycle = "dissipation"',
        'wear = "pin_share", cycles = 5, pin = 1e-14; 2e-14 more from -9 to 9 deg',
        'wear = "life", criterion = "fatemi-socie", cycles = 10, law = "energy", pin = 1e-14',
    ):  # fmt: skip
        assert words in page.text, words


@pytest.mark.usefixtures("undrawn")
def test_runs_of_a_larger_plan_are_waiting(folder: Path, tmp_path: Path) -> None:
    (folder.parent / "larger.toml").write_text(PLAN.replace("[0.2, 0.4]", "[0.2, 0.4, 0.6]"))
    write_sweep_report(folder, tmp_path / "page.html", plan=folder.parent / "larger.toml")
    words = Page((tmp_path / "page.html").read_text(encoding="utf-8")).text
    assert "2 points are waiting" in words
    assert "with another plan than this one" in words


@pytest.mark.parametrize(
    ("remove", "words"),
    [("plan/plan.toml", "holds no copy of its plan"), ("case.toml", "its plan can't be read from here; name the plan")],
)
def test_a_plan_that_is_not_found_is_asked_for(remove: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "plan.toml").write_text(PLAN.replace("[0.0, 1e7]", "[0.0]").replace("[0.2, 0.4]", "[0.2]"))
    sweep.run(read_plan(tmp_path / "plan.toml"), tmp_path / "plan", Inline())
    (tmp_path / remove).unlink()
    with pytest.raises(InputError, match=words):
        write_sweep_report(tmp_path / "plan", tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


def test_a_changed_base_case_is_seen(folder: Path, tmp_path: Path) -> None:
    case = folder.parent / "case.toml"
    case.write_text(CASE.replace("nodes = 41", "nodes = 43"))
    try:
        with pytest.raises(InputError, match="its base case has changed since the sweep was run"):
            write_sweep_report(folder, tmp_path / "page.html")
    finally:
        case.write_text(CASE)


def test_a_sweep_of_another_version_is_refused(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fastpin.pages.sweep.__version__", "99.0")
    with pytest.raises(InputError, match=r"was made by fastpin .*: write its page with that version"):
        write_sweep_report(folder, tmp_path / "page.html")

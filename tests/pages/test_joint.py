"""The page of a joint of several pins: what it holds, what it refuses, and joints that ended early."""

from pathlib import Path

import pytest

from fastpin import InputError
from fastpin.joints import parse_joint, solve_joint
from fastpin.pages import write_report
from fastpin.solver import SolveError
from fastpin.storage import record_joint
from tests.support.commands import refused, said
from tests.support.html import Page, words_of
from tests.support.laps import SHEETS

TEXT = SHEETS.replace("nodes = 24", "nodes = 16\nrepeat = 2").replace('"aluminium"', '"2024-T3"')
TEXT = (
    TEXT.replace("plates =", "bore_radius = 1e-3\nplates =").replace("two bolts", "two <b>bolts</b>")
    + '\n[fatigue]\nover = "cycle"\n'
)
CASE = parse_joint(TEXT)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("joints") / "joint.h5"
    path.with_suffix(".toml").write_text(TEXT)
    record_joint(CASE, path)
    return path


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_page_has_shares_holes_lives_and_the_worst_contact(stored: Path) -> None:
    write_report(stored, stored.with_suffix(".html"))
    page = stored.with_suffix(".html").read_text(encoding="utf-8")
    found = Page(page)
    assert "<b>bolts</b>" not in page
    assert [name for name in found.ids if f'section id="{name}"' in page] == [
        "overview", "shares", "holes", "displacement", "margins", "fatigue", "tractions", "zones", "stresses", "case",
        "checks", "provenance",
    ]  # fmt: skip
    for words in (
        "Complete: all 4 load points solved.",
        "Shortest life: A in sheet, hole, Smith-Watson-Topper",
        "A in sheet: stick and slip",
        "Share of each pin in the force on a plate.",
        "A sheet, B sheet",  # the first touches
        "result has no plate that moves under a load of its own",
        "equilibrium of every pin and plate",
        "steel, bore radius 1 mm, at 0, 0 mm",
        "repeat = 2",  # the joint file beside the result
    ):
        assert words in found.text, words


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_joint_in_memory_shows_the_chosen_hole(stored: Path, tmp_path: Path) -> None:
    result = solve_joint(CASE.joint, CASE.corners[:1], nodes=16)
    text = words_of(result, tmp_path / "a.html", hole=("B", "sheet"))
    assert "B in sheet: tractions" in text
    assert "Complete: the only load point solved." in text
    with pytest.raises(InputError, match="is not the joint file of this result: loads differs"):
        write_report(result, tmp_path / "b.html", case=stored.with_suffix(".toml"))
    assert not (tmp_path / "b.html").exists()


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_joint_file_whose_history_fails_has_a_page(stored: Path, tmp_path: Path, monkeypatch) -> None:
    def fails(*arguments: object, **keywords: object) -> None:
        error = SolveError("step 2: lost")
        error.result = solve_joint(CASE.joint, CASE.corners[:1], nodes=16)
        raise error

    monkeypatch.setattr("fastpin.cli.report.joints.solve_joint", fails)
    said("report", stored.with_suffix(".toml"), "-o", tmp_path / "b.html", "--author", "N. N.", "--pin", "B", code=1)
    text = Page((tmp_path / "b.html").read_text()).text
    for words in ("Unfinished: 1 of 4 load points. The reason: step 2: lost.", "N. N.", "B in sheet: tractions"):
        assert words in text
    assert "Not known: the history has not come to its end." in text  # the fatigue


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--pin", "C"], '--pin: must be "A" or "B", not "C"'),
        (["--plate", "sheet"], "--pin: is missing beside --plate; the pins are A, B"),
        (["--pin", "A", "--plate", "lug"], 'plate: must be "sheet", not "lug"'),
        (["--error-bars"], "--error-bars: has no effect on a stored result; it is for a case file"),
    ],
)
def test_wrong_options_are_refused(stored: Path, arguments: list[str], message: str, tmp_path: Path) -> None:
    assert message in refused("report", stored, "-o", tmp_path / "a.html", *arguments)
    assert not list(tmp_path.iterdir())

"""The page bushed-lug.md: its files are those it shows, and its case prints its numbers."""

import re
import shutil
from pathlib import Path

import pytest

from fastpin.cli.main import main
from fastpin.studies import read_tolerances

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "bushed-lug.md").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in DOCS.glob("bushed-lug*.*"):
        shutil.copy(path, path.name)


def test_the_page_shows_its_files() -> None:
    shown = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert shown == [Path(f"bushed-lug{part}.toml").read_text(encoding="utf-8") for part in ("", "-tolerances")]


@pytest.mark.gate
def test_the_case_of_the_page_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "bushed-lug.toml"]) == 0
    assert re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)[0] in capsys.readouterr().out


def test_the_plan_of_the_page_has_its_runs() -> None:
    study = read_tolerances("bushed-lug-tolerances.toml")
    assert len(study.plan.points) == 43
    assert study.plan.outcomes.keys() == {"hoop", "life", "growth"}

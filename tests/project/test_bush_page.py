"""The page of the bush that slips: its numbers come out, and its plan maps the walk."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from fastpin import read_case
from fastpin.studies import read_plan

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "bush.md").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("bush-walk.toml", "bush-walk-plan.toml"):
        shutil.copy(DOCS / name, name)


@pytest.mark.gate
def test_the_page_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    """Each block of Python is followed by what it prints."""
    names: dict[str, Any] = {}
    found = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)
    for code, text in found:
        exec(compile(code, "bush.md", "exec"), names)
        assert capsys.readouterr().out == text
    assert len(found) == 2


def test_the_files_of_the_page_hold_what_it_says() -> None:
    bush = read_case("bush-walk.toml").problem.plate_body.bush
    assert not bush.bonded
    shown = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert shown is not None
    for line in shown.group(1).splitlines():
        assert line.split("#")[0].strip() in (DOCS / "bush-walk.toml").read_text(encoding="utf-8")
    plan = read_plan("bush-walk-plan.toml")
    assert len(plan.points) == 64
    assert plan.outcomes.keys() == {"walk", "sticking", "least"}

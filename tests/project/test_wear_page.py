"""The page of wear: it shows its files, prints its numbers, and its fretting map can be drawn."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

import fastpin
from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.damage import Race
from fastpin.states import Regime
from fastpin.studies import read_plan, sweep

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "wear.md").read_text(encoding="utf-8")
FILES = ("worn-joint.toml", "fretting-map.toml")
VALUES = "regime,energy,volume,life"


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in FILES:
        shutil.copy(DOCS / name, name)


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


def test_the_page_shows_its_files() -> None:
    shown = [text for text in blocks("toml") if text.startswith("# The ")]
    assert shown == [(DOCS / name).read_text(encoding="utf-8") for name in FILES]


def test_the_profiles_of_the_page_can_be_read() -> None:
    case = Path("worn-joint.toml").read_text(encoding="utf-8")
    gap, friction = (next(text for text in blocks("toml") if word in text) for word in ("[gap]", "greased"))
    assert parse_case(case + gap).problem.gap.given.keys() == {"hole", "pin"}
    (line,) = re.findall(r"^friction = .*$", friction, re.MULTILINE)
    changed = parse_case(re.sub(r"^friction = .*$", line, case, count=1, flags=re.MULTILINE)).problem
    assert changed.friction_at(changed.hole_radius * 0.0 - 1.6) == pytest.approx(0.2)


@pytest.mark.gate
def test_the_page_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    """Each block of Python that prints is followed by what it prints."""
    names: dict[str, Any] = {}
    printed = 0
    for code, text in re.findall(r"```python\n(.*?)```\n(?:\n```text\n(.*?)```)?", PAGE, re.DOTALL):
        exec(compile(code, "wear.md", "exec"), names)
        assert capsys.readouterr().out == text
        printed += bool(text)
    assert printed == 5


@pytest.mark.gate
def test_the_table_of_the_page_is_that_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["wear", "worn-joint.toml", "-o", "life.h5"]) == 0
    shown = next(text for text in blocks("text") if "energy/cycle" in text)
    assert shown in capsys.readouterr().out
    assert main(["plot", "life.h5", "damage"]) == 0


@pytest.mark.survey
def test_the_fretting_map_is_drawn_by_one_command(capsys: pytest.CaptureFixture[str]) -> None:
    """The same plan on a small grid, with few nodes and cycles."""
    plan = read_plan("fretting-map.toml")
    assert len(plan.points) == 56
    text = Path("fretting-map.toml").read_text(encoding="utf-8")
    text = text.replace("from = 2e5, to = 1.6e6, count = 8", "from = 6e5, to = 1.2e6, count = 2")
    text = text.replace("from = 1e5, to = 1e6, count = 7", "from = 1e5, to = 8.5e5, count = 2")
    Path("fretting-map.toml").write_text(text, encoding="utf-8")
    case = Path("worn-joint.toml").read_text(encoding="utf-8")
    case = re.sub(r"^at = .*$", "at = [100_000]", case.replace("nodes = 101", "nodes = 41"), flags=re.MULTILINE)
    Path("worn-joint.toml").write_text(case, encoding="utf-8")
    assert main(["sweep", "fretting-map.toml", "--workers", "1", "--plot", "map.png", "--value", VALUES]) == 0
    assert "4 runs in fretting-map: 4 done" in capsys.readouterr().out
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")
    rows = sweep.rows(read_plan("fretting-map.toml"), "fretting-map")
    assert [row["regime"] for row in rows] == [Regime.PARTIAL_SLIP, Regime.GROSS_SLIDING, *[Regime.PARTIAL_SLIP] * 2]
    assert [row["race"] for row in rows] == [Race.OPEN, Race.WEAR, Race.OPEN, Race.CRACK]
    assert [row["life"] is None for row in rows] == [True, True, True, False]
    joint = fastpin.read_case("worn-joint.toml")
    assert joint.wear is not None
    loads = fastpin.LoadHistory([{"P": 6e5}]) + fastpin.LoadHistory([{"Q": -8.5e5}, {"Q": 8.5e5}]).repeated(1)
    worn = fastpin.wear(joint.problem, loads, nodes=41, **joint.wear.given)
    assert rows[1]["volume"] == pytest.approx(worn[-1].volume, rel=0.03)

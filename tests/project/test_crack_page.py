"""The page of cracks: it shows its files, and its map can be drawn."""

import re
import shutil
from pathlib import Path

import pytest

from fastpin.cli.main import main
from fastpin.cracks import CrackFate
from fastpin.studies import read_plan, sweep

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "cracks.md").read_text(encoding="utf-8")
FILES = ("cracked-joint.toml", "crack-map.toml")


def test_the_page_shows_its_plan() -> None:
    assert f"```toml\n{(DOCS / 'crack-map.toml').read_text(encoding='utf-8')}```" in PAGE


@pytest.mark.gate
def test_the_map_is_drawn_by_one_command(tmp_path, monkeypatch, capsys):
    """The same plan on a small grid, with few nodes."""
    monkeypatch.chdir(tmp_path)
    for name in FILES:
        shutil.copy(DOCS / name, name)
    assert len(read_plan("crack-map.toml").points) == 63
    text = Path("crack-map.toml").read_text(encoding="utf-8")
    text = text.replace("from = 1e6, to = 9e6, count = 9", "from = 3e6, to = 9e6, count = 2")
    text = text.replace("from = 0.2e6, to = 2e6, count = 7", "from = 0.5e6, to = 2e6, count = 2")
    Path("crack-map.toml").write_text(text, encoding="utf-8")
    case = Path("cracked-joint.toml").read_text(encoding="utf-8")
    Path("cracked-joint.toml").write_text(re.sub("nodes = 201", "nodes = 101", case), encoding="utf-8")
    assert main(["sweep", "crack-map.toml", "--workers", "1", "--plot", "map.png", "--value", "fate,life"]) == 0
    assert "4 runs in crack-map: 4 done" in capsys.readouterr().out
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")
    rows = sweep.rows(read_plan("crack-map.toml"), "crack-map")
    assert [row["fate"] for row in rows] == [CrackFate.STOPS, CrackFate.GROWS, CrackFate.NONE, CrackFate.BREAKS]

"""The page on a bolt in a carbon laminate shows its files and prints its numbers."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from fastpin.cli.main import main
from fastpin.studies import read_plan, sweep
from tests.support.tiers import gate

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "carbon-laminate.md").read_text(encoding="utf-8")
FILES = ("carbon-laminate.toml", "carbon-fit.toml", "carbon-axis.toml", "carbon-envelope.toml")


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in FILES:
        shutil.copy(DOCS / name, name)


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


def solved(name: str) -> list[dict[str, Any]]:
    """The rows of a plan of the page."""
    plan = read_plan(f"{name}.toml")
    assert sweep.run(plan, name, workers=1).failed == []
    return sweep.rows(plan, name)


def test_the_page_shows_its_files() -> None:
    assert blocks("toml") == [(DOCS / name).read_text(encoding="utf-8") for name in FILES]


@pytest.mark.gate
def test_the_run_prints_the_lines_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "carbon-laminate.toml"]) == 0
    assert blocks("text")[0] in capsys.readouterr().out


def test_python_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = blocks("python")
    exec(compile(code, "carbon-laminate.md", "exec"), {})
    assert capsys.readouterr().out == blocks("text")[1]


@pytest.mark.gate
@pytest.mark.parametrize(
    ("criterion", "lengths", "start"),
    [
        *gate(
            ("yamada-sun", "tension = 0.5e-3\ncompression = 1.5e-3", "| `yamada-sun`, curve of 0.5 mm and 1.5 mm | ")
        ),
        ("hashin", "distance = 0.5e-3", "| `hashin`, 0.5 mm from the edge | "),
    ],
)
def test_other_assessments(criterion: str, lengths: str, start: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = Path("carbon-laminate.toml").read_text(encoding="utf-8").replace("yamada-sun", criterion)
    Path("other.toml").write_text(re.sub(r"distance = .*", lengths, text), encoding="utf-8")
    assert main(["run", "other.toml"]) == 0
    printed = capsys.readouterr().out
    (row,) = [line for line in PAGE.splitlines() if line.startswith(start)]
    ratio, place, ply, factor = (cell.strip() for cell in row.split("|")[2:6])
    assert f"strength ratio {ratio} by {criterion}" in printed
    angle, words = ply.split(" deg, ")
    assert f"ply of {angle} deg by {words}" in printed
    assert f"load at failure: {factor} times all loads" in printed
    found = re.search(r"; at (-?[\d.]+) deg from the bottom", printed)
    assert found is not None
    assert abs(round(abs(float(found[1])))) == int(place.removesuffix(" deg"))


@pytest.mark.gate
def test_clearance_and_friction() -> None:
    ratios = {(row["contact.clearance"], row["contact.friction"]): row["ratio"] for row in solved("carbon-fit")}
    assert f"from {ratios[0, 0.2]:.2f} to {ratios[60e-6, 0.2]:.2f} at a friction of 0.2" in PAGE
    assert 1.3 < ratios[0, 0.4] / ratios[0, 0.0] < 1.4
    assert f"and by {100.0 * (ratios[60e-6, 0.4] / ratios[60e-6, 0.0] - 1.0):.0f} % at 60 um" in PAGE


@pytest.mark.gate
def test_the_table_of_axes() -> None:
    ratios = {(row["plate.layup"], row["plate.axis"]): row["ratio"] for row in solved("carbon-axis")}
    for layup in {layup for layup, _ in ratios}:
        cells = " | ".join(f"{ratios[layup, axis]:.3f}" for axis in (0, 15, 30, 45))
        assert f"| {layup} | {cells} |" in PAGE
        assert ratios[layup, 30] == pytest.approx(ratios[layup, 60], rel=1e-6)


@pytest.mark.gate
def test_the_envelope() -> None:
    factors = {(row["load.1.syy"], row["contact.clearance"]): row["factor"] for row in solved("carbon-envelope")}
    taken = 1.0 - factors[0, 40e-6] / factors[0, 10e-6]
    assert f"takes {100.0 * taken:.0f} % of the bearing strength" in PAGE
    assert factors[-100e6, 10e-6] < factors[0, 10e-6] < factors[50e6, 10e-6]
    assert factors[400e6, 40e-6] > factors[400e6, 10e-6]
    assert main(["sweep", "carbon-envelope.toml", "--envelope", "--plot", "envelope.svg"]) == 0

"""The documents: what they link to exists, and the tests that they name are there."""

import importlib
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from fastpin.cli.main import main
from fastpin.figures.kinds import KINDS
from fastpin.paper import catalog
from fastpin.studies import sweep
from fastpin.studies.outcome_tables import KEYS
from fastpin.studies.outcomes import CYCLE_QUANTITIES, TAKES, WEAR_QUANTITIES
from fastpin.studies.plan import parse_plan, read_plan
from fastpin.studies.run_end import KEY_FIGURES
from scripts.inline import Inline

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted((ROOT / "docs").glob("*.md"))


def found(pattern: str, paths: Iterable[Path] = DOCUMENTS) -> set[tuple[Path, str]]:
    """Where a pattern stands: files and words."""
    return {(path, word) for path in paths for word in re.findall(pattern, path.read_text(encoding="utf-8"))}


def test_links_lead_somewhere() -> None:
    assert [(path.name, to) for path, to in found(r"\]\(([^):#]+)") if not (path.parent / to).exists()] == []


def test_named_tests_and_scripts_exist() -> None:
    tests = {name for _, name in found(r"\bdef (test_\w+)\(", (ROOT / "tests").rglob("test_*.py"))}
    assert [(path.name, name) for path, name in found(r"`(test_\w+)`") if name not in tests] == []
    files = found(r"`((?:tests|scripts|fastpin)/[\w/]+(?:\.py)?)`")
    assert [(path.name, name) for path, name in files if not (ROOT / name).exists()] == []


def test_names_of_the_package_exist() -> None:
    """In docstrings and documents, such as ``fastpin.studies.sweep.run``."""
    files = [*sorted((ROOT / "fastpin").rglob("*.py")), *DOCUMENTS, ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    named = found(r"(?<![\w./\"])fastpin(?:\.[A-Za-z_]\w*)+", files)
    assert [(path, name) for path, name in named if not name.endswith((".py", ".toml")) and not exists(name)] == []


def exists(name: str) -> bool:
    """Whether a dotted name is a module, or an attribute of a module or class."""
    value, parts = importlib.import_module("fastpin"), name.split(".")
    for count, part in enumerate(parts[1:], start=2):
        try:
            value = getattr(value, part)
        except AttributeError:
            try:
                value = importlib.import_module(".".join(parts[:count]))
            except ImportError:
                return False
    return True


def test_every_statement_of_the_paper_has_a_number_a_verdict_and_a_test() -> None:
    text = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    text = text[text.index("## Statements") : text.index("## Figures")]
    rows = [line.replace("\\|", "").split("|")[1:-1] for line in text.splitlines() if re.match(r"\| \d+ \|", line)]
    assert len(rows) == 60
    for number, row in enumerate(rows, start=1):
        assert len(row) == 6
        assert int(row[0]) == number
        assert "`test_" in row[5]
        assert re.search(r"\d", row[3])
        verdict = row[4].strip()
        assert verdict.startswith(("confirmed", "**not confirmed**", "only", "exact")), verdict


def test_every_figure_is_shown() -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in DOCUMENTS)
    for name in (*catalog.PAPER, *catalog.BEYOND):
        assert f"figures/{catalog.stem(name)}.png" in text


def test_the_plan_of_the_sweeps_can_be_run(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    case, plan, outcomes, *_ = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "case.toml").write_text(case)
    assert len(parse_plan(plan, folder=tmp_path).runs) == 3 * 10 * 2 * 2
    assert "3 x 10 x 2 x 2 = 120 runs" in text
    (tmp_path / "wear.py").write_text(re.findall(r"```python\n(import numpy.*?)```", text, re.DOTALL)[0])
    grid = "[grid]\nsolve.nodes = [61]\n"
    small = parse_plan(f'case = "case.toml"\n{grid}{outcomes}', folder=tmp_path)
    summary = sweep.run(small, tmp_path / "out", Inline())
    assert (summary.done, summary.unread) == (1, [])
    (row,) = sweep.rows(small, tmp_path / "out")
    assert list(small.outcomes) == ["shear", "swing", "lost", "wear"]
    assert (row["shear"], row["lost"]) == (row["max_shear"], row["dissipation"])
    assert row["swing"] > 0.0
    assert row["wear"] > 0.0


def test_every_way_to_an_outcome_is_explained() -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    for name in (*CYCLE_QUANTITIES, *WEAR_QUANTITIES, *TAKES):
        assert f'"{name}"' in text, name
    for key in {key for keys in KEYS.values() for key in keys}:
        assert f"`{key}`" in text, key


@pytest.mark.survey
def test_the_examples_of_fatigue_print_their_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / "fatigue.md").read_text(encoding="utf-8")
    codes, printed = (re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL) for kind in ("python", "text"))
    names: dict[str, Any] = {}
    for code, lines in zip(codes, printed, strict=True):
        exec(compile(code, "fatigue.md", "exec"), names)
        assert capsys.readouterr().out == lines


@pytest.mark.gate
def test_the_example_of_cracks_prints_its_numbers(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "cracks.md").read_text(encoding="utf-8")
    code, printed = ("".join(re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL)) for kind in ("python", "text"))
    names: dict[str, Any] = {}
    exec(compile(code, "cracks.md", "exec"), names)
    assert capsys.readouterr().out == printed
    assert names["own"].fate.words == "grows"
    assert [path.name for path in tmp_path.iterdir()] == ["growth.png"]


@pytest.mark.gate
def test_the_example_of_figures_draws_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names: dict[str, Any] = {}
    exec(compile(code, "figures.md", "exec"), names)
    files = ["cycle.gif", "loops.pdf", "map.svg", "scar.pdf", "tractions.pdf"]
    assert sorted(path.name for path in tmp_path.iterdir()) == files
    assert names["axes"].texts
    for kind in KINDS:
        assert f"`{kind}`" in text, kind


@pytest.mark.gate
def test_the_examples_of_sessions_run() -> None:
    text = (ROOT / "docs" / "sessions.md").read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(compile(code, "sessions.md", "exec"), names)
    session, state = names["session"], names["state"]
    assert 1e5 < names["force"] < 7e5
    assert 0.2 < names["friction"] < 0.4
    assert session.problem.friction == pytest.approx(names["friction"], rel=1e-4)
    assert session.state is state
    assert names["lost"] is None


RIVET = (ROOT / "docs" / "riveted-joint.md").read_text(encoding="utf-8")


def test_the_riveted_joint_shows_its_files() -> None:
    shown = re.findall(r"```toml\n(.*?)```", RIVET, re.DOTALL)
    assert shown == [(ROOT / "docs" / f"riveted-joint{part}.toml").read_text() for part in ("", "-plan")]


@pytest.mark.survey
def test_the_riveted_joint_prints_its_numbers(monkeypatch, capsys):
    """The joint is symmetric, so the side of a printed angle is left to rounding."""
    monkeypatch.chdir(ROOT / "docs")
    run, printed = re.findall(r"```text\n(.*?)```", RIVET, re.DOTALL)
    assert main(["run", "riveted-joint.toml"]) == 0
    lines = without_sides(capsys.readouterr().out).splitlines()
    for line in run.splitlines():
        assert without_sides(line) in lines
    (code,) = re.findall(r"```python\n(.*?)```", RIVET, re.DOTALL)
    exec(compile(code, "riveted-joint.md", "exec"), {})
    assert capsys.readouterr().out == printed


def without_sides(text: str) -> str:
    """Printed angles without their signs, and without the load point, one of several with equal stress."""
    return re.sub(r"load point \d+;", "", re.sub(r"-(\d[\d.]* deg)", r"\1", text))


@pytest.mark.gate
def test_the_plan_of_the_riveted_joint_can_be_run(tmp_path: Path) -> None:
    plan = read_plan(ROOT / "docs" / "riveted-joint-plan.toml")
    assert len(plan.runs) == 18
    text = (ROOT / "docs" / "riveted-joint-plan.toml").read_text(encoding="utf-8")
    friction = "contact.friction = { from = 0.2, to = 0.6, count = 9 }"
    assert friction in text
    small = parse_plan(text.replace(friction, "solve.nodes = [101]"), folder=ROOT / "docs")
    summary = sweep.run(small, tmp_path, Inline())
    assert (summary.done, summary.unread) == (2, [])
    clearance, interference = sorted(sweep.rows(small, tmp_path), key=lambda row: -row["contact.clearance"])
    assert clearance["life"] < 0.1 * interference["life"]
    assert clearance["energy"] < 0.1 * interference["energy"]


def test_every_column_of_the_index_is_explained() -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    for name in (
        *KEY_FIGURES,
        "id",
        "status",
        "reason",
        "dimensionless",
        "seconds",
        "started",
        "host",
        "versions",
        "input",
    ):
        assert f"`{name}`" in text, name

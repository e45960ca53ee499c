"""The documents: what they link to exists, and the tests that they name are there."""

import importlib
import re
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import pytest

from docs.beyond.figures import FIGURES
from fastpin.assess.wear import RACE_OUTCOMES, WEAR_OUTCOMES
from fastpin.published import catalog
from fastpin.studies import parse_plan, sweep
from fastpin.studies.outcome_tables import KEYS
from fastpin.studies.outcomes import CYCLE_QUANTITIES, TAKES
from fastpin.studies.run_end import KEY_FIGURES
from scripts.inline import Inline
from tests.support.documents import page_text, statements, texts
from tests.survey import calls
from tests.survey.valid_values import Valid

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted((ROOT / "docs").glob("*.md"))
RECORDS = sorted((ROOT / "docs" / "decisions").glob("*.md"))


def found(pattern: str, paths: Iterable[Path] = DOCUMENTS) -> set[tuple[Path, str]]:
    """Where a pattern stands: files and words."""
    return {(path, word) for path in paths for word in re.findall(pattern, path.read_text(encoding="utf-8"))}


@pytest.mark.gate
def test_each_parameter_of_the_reference_has_a_valid_value(tmp_path, monkeypatch) -> None:
    """A new public name needs one in tests/survey/valid_values.py. The calls of the survey take minutes."""
    monkeypatch.chdir(tmp_path)
    targets = calls.public_targets()
    caller, lacking = calls.Caller(targets, Valid()), []
    for name in targets:
        try:
            caller.arguments(calls.Attempt(name, ()))
        except LookupError as error:
            lacking.append(str(error))
    assert lacking == []


def test_links_lead_somewhere() -> None:
    links = found(r"\]\(([^):#]+)", (*DOCUMENTS, *RECORDS, ROOT / "README.md", ROOT / "CONTRIBUTING.md"))
    assert [(path.name, to) for path, to in links if not (path.parent / to).exists()] == []


def test_named_tests_and_scripts_exist() -> None:
    tests = {name for _, name in found(r"\bdef (test_\w+)\(", (ROOT / "tests").rglob("test_*.py"))}
    assert [(path.name, name) for path, name in found(r"`(test_\w+)`") if name not in tests] == []
    files = found(r"`((?:tests|scripts|fastpin)/[\w/]+(?:\.py)?)`")
    files |= found(r"((?:tests|scripts|fastpin|bench)/[\w/]+\.py)", (*DOCUMENTS, *RECORDS))
    modules = found(r"python -m ((?:scripts|bench)\.\w+)", (*DOCUMENTS, *RECORDS, ROOT / "CONTRIBUTING.md"))
    files |= {(path, f"{name.replace('.', '/')}.py") for path, name in modules}
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
    assert len(statements()) == 60
    for number, row in enumerate(statements(), start=1):
        assert len(row) == 6
        assert int(row[0]) == number
        assert "`test_" in row[5]
        assert re.search(r"\d", row[3])
        verdict = row[4].strip()
        assert verdict.startswith(("confirmed", "**not confirmed**", "only", "exact")), verdict


def test_every_figure_is_shown() -> None:
    text = "".join(path.read_text(encoding="utf-8") for path in DOCUMENTS)
    for name in (*map(catalog.stem, catalog.FIGURES), *FIGURES):
        assert f"figures/{name}.png" in text


def test_the_plan_of_the_sweeps_can_be_run(tmp_path: Path) -> None:
    case, plan, outcomes, *_ = texts("sweeps.md", "toml")
    (tmp_path / "case.toml").write_text(case)
    assert len(parse_plan(plan, folder=tmp_path).runs) == 3 * 10 * 2 * 2
    assert "3 x 10 x 2 x 2 = 120 runs" in page_text("sweeps.md")
    (tmp_path / "wear.py").write_text(texts("sweeps.md", "python")[0])
    grid = "[grid]\nsolve.nodes = [61]\n"
    small = parse_plan(f'case = "case.toml"\n{grid}{outcomes}', folder=tmp_path)
    summary = sweep.run(small, tmp_path / "out", Inline())
    assert (summary.done, summary.unread) == (1, [])
    (row,) = sweep.rows(small, tmp_path / "out")
    assert list(small.outcomes) == ["shear", "swing", "lost", "wear"]
    assert (row["shear"], row["lost"]) == (row["max_shear"], row["dissipation"])
    assert row["swing"] > 0.0
    assert row["wear"] > 0.0


def test_every_way_to_an_outcome_and_every_column_of_the_index_are_explained() -> None:
    text = page_text("sweeps.md")
    columns = ("id", "status", "reason", "dimensionless", "seconds", "started", "host", "versions", "input")
    quoted = (f'"{name}"' for name in (*CYCLE_QUANTITIES, *WEAR_OUTCOMES, *RACE_OUTCOMES, *TAKES))
    listed = (f"`{name}`" for name in (*chain(*KEYS.values()), *KEY_FIGURES, *columns))
    assert [name for name in (*quoted, *listed) if name not in text] == []

"""The documentation site: its examples run, its reference is complete, and every page is listed."""

import ast
import importlib
import re
import runpy
from pathlib import Path
from types import ModuleType

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import KEYS
from fastpin.cli.options import parser
from fastpin.states.cycles import CYCLE_KINDS
from fastpin.storage import layout, stored_states, wear_files
from tests.support.tiers import some_survey

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
EXAMPLES = sorted((DOCS / "gallery").glob("*.py"))
QUICK = ("plot_01_neat_fit", "plot_05_path_dependence", "plot_10_hollow_pin")
"""Short examples. The others run when the site is made."""

LONGEST_EXAMPLE = 60
"""Most lines of an example, so that it stays an example."""


@pytest.fixture
def extension(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The texts that the build generates. Sphinx need not be installed."""
    monkeypatch.syspath_prepend(DOCS / "extensions")  # type: ignore[no-untyped-call]
    return __import__("generated_text")


@pytest.mark.parametrize(
    "path", some_survey(EXAMPLES, *(path for path in EXAMPLES if path.stem not in QUICK)), ids=lambda path: path.stem
)
def test_an_example_runs_and_draws_a_figure(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each example also asserts a fact of its own."""
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    plt.close("all")
    names = runpy.run_path(str(path), run_name="__main__")
    assert any(np.any(np.asarray(axes.bbox.bounds) > 0) and axes.has_data() for axes in names["figure"].axes)
    plt.close("all")


def test_there_are_enough_examples_and_each_explains_and_checks_itself() -> None:
    assert len(EXAMPLES) >= 15
    assert set(QUICK) <= {path.stem for path in EXAMPLES}
    for path in EXAMPLES:
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        title, line, *words = (ast.get_docstring(tree) or "").splitlines()
        assert set(line) == {"="}, path.name
        assert len(line) == len(title), path.name
        assert len(" ".join(words).split()) > 15, path.name
        assert any(isinstance(node, ast.Assert) for node in ast.walk(tree)), path.name
        stored = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        assert "figure" in stored, path.name
        assert len(text.splitlines()) <= LONGEST_EXAMPLE, path.name


def test_the_reference_has_every_public_name() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in (DOCS / "reference").glob("*.md"))
    shown = set(re.findall(r"^\.\. (?:auto\w+|py:data):: (\S+)$", text, re.MULTILINE))
    modules = {name for name in fastpin.__all__ if isinstance(getattr(fastpin, name), ModuleType)}
    names = {f"fastpin.{name}" for name in set(fastpin.__all__) - modules - {"__version__"}}
    assert names - shown == set()
    for name in shown:
        module, _, last = name.rpartition(".")
        assert hasattr(importlib.import_module(module), last), name


def test_every_page_is_in_the_table_of_contents() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in (DOCS / "index.md", DOCS / "reference" / "index.md"))
    listed = set(text.splitlines())
    for page in (*DOCS.glob("*.md"), *(DOCS / "project").glob("*.md")):
        name = str(page.relative_to(DOCS).with_suffix(""))
        assert name == "index" or {name, f"../{name}"} & listed, name


def test_the_command_line_of_the_reference_is_that_of_the_parser(extension: ModuleType) -> None:
    text = extension.PARTS["command_line"]()
    commands = re.findall(r"^\s+\{?([\w,]+)\}? ", parser().format_help(), re.MULTILINE)
    shown = re.findall(r"^## fastpin (\w+)$", text, re.MULTILINE)
    assert len(shown) > 10
    assert set(shown) <= set(commands) | set(re.findall(r"\w+", parser().format_help()))
    assert "`--nodes N`" in text
    assert "%(" not in text


def test_every_key_of_a_case_file_is_explained(extension: ModuleType) -> None:
    text = extension.PARTS["case_keys"]()
    for section, keys in KEYS.items():
        part = text.partition(f"[{section}]")[2].partition("\n## ")[0]
        for key in keys:
            assert re.search(rf"^\| `{key}` \| \S", part, re.MULTILINE), (section, key)


def assert_explained(text: str, *names: str) -> None:
    """Each of the names has a row with words in the last cell."""
    assert [name for name in names if not re.search(rf"^\| `{name}` \| .* \| .+ \|$", text, re.MULTILINE)] == []


@pytest.mark.gate
def test_the_file_format_of_the_reference_has_every_array(extension, monkeypatch):
    """The sample has few states: the extremes of many are stored."""
    for module in (__import__("file_layout"), stored_states):
        monkeypatch.setattr(module, "LEAST_STORED", 6)
    text = extension.PARTS["file_layout"]()
    assert "\n## /extremes\n" in text
    assert_explained(text, *layout.FIELD_KINDS, *CYCLE_KINDS)


def test_the_file_format_of_a_life_of_wear_has_every_member(extension: ModuleType) -> None:
    text = extension.PARTS["wear_layout"]()
    more = "coefficients", "chosen", "jump", "depth", "restart/"
    assert_explained(text, *wear_files.DEPTHS, *wear_files.NUMBERS, *more)
    assert "| `plate_depth` | number | (cycle, node) | m |" in text


@pytest.mark.parametrize("name", ["materials", "plan_fields", "plan_outcomes", "quantities"])
def test_tables_are_generated(name: str, extension: ModuleType) -> None:
    lines = extension.PARTS[name]().splitlines()
    assert lines[1].startswith("| ---")
    assert len(lines) > 5


def test_marks_of_pages_name_texts(extension: ModuleType) -> None:
    found = 0
    for page in DOCS.rglob("*.md"):
        for mark in re.findall(r"<!-- insert: (\w+)", page.read_text(encoding="utf-8")):
            assert mark in extension.PARTS, (page.name, mark)
            found += 1
    assert found > 10

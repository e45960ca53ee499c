"""The rules of the layout hold, and each rule notices when it is broken."""

import ast
import importlib
import inspect
import re
from pathlib import Path

import pytest

import fastpin
from tests.support import layout
from tests.support.processes import finished, python
from tests.support.tiers import for_gate

ROOT = Path(__file__).resolve().parents[2]

BREAKS = {
    "a folder without a rank": ("known_folders", "more/a.py", '"""More."""\n'),
    "a folder inside a folder": ("known_folders", "model/inner/a.py", '"""More."""\n'),
    "an import from a higher rank": ("one_direction", "model/grid.py", "import fastpin.solver.turns\n"),
    "an import under TYPE_CHECKING": (
        "one_direction",
        "model/angles.py",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from fastpin.solver.turns import InTurns\n",
    ),
    "an import from the upper floor of the model": (
        "one_direction",
        "model/options.py",
        "from fastpin.model.units import PASCAL\n",
    ),
    "an import from a folder of the same rank": (
        "one_direction",
        "casefile/reader.py",
        "import fastpin.elasticity.system\n",
    ),
    "a wing in the core": ("wings_apart", "reading/peaks.py", "from fastpin.lugs.plates import respond\n"),
    "an import of the public face": ("one_direction", "storage/store.py", "import fastpin\n"),
    "a circle of files": ("no_circles", "reading/old_borders.py", "from fastpin.reading.zones import end_place\n"),
    "a circle through names": ("no_circles", "cli/run.py", "from fastpin.cli.main import main\n"),
    "the face of the own folder": ("nothing_hidden", "states/cycles.py", "from fastpin import states\n"),
    "a name of the own face": ("nothing_hidden", "states/cycles.py", "from fastpin.states import Regime\n"),
    "a relative import": ("nothing_hidden", "states/cycles.py", "from .regimes import Regime\n"),
    "a file by its name": (
        "nothing_hidden",
        "solver/arc.py",
        "import importlib\nimportlib.import_module('fastpin.model.grid')\n",
    ),
    "a file for later": ("nothing_hidden", "solver/arc.py", "grid = Later('fastpin.model.grid')\n"),
    "a kernel that imports the package": ("kernels_alone", "kernels/toeplitz.py", "import fastpin.errors\n"),
    "an import below the kernels": ("one_direction", "runtime/threads.py", "import fastpin.errors\n"),
    "a kernel of a kernel that calls one of another file": (
        "kernels_alone",
        "kernels/toeplitz.py",
        "from fastpin.kernels.influence import clausen\n@compiled\ndef more(x):\n    return clausen(x)\n"
        "@compiled\ndef most(x):\n    return more(x)\n",
    ),
    **{f"{package} elsewhere": ("one_home", "solver/arc.py", f"import {package}\n") for package in layout.HOMES},
    "numba elsewhere, for later": ("one_home", "solver/arc.py", "numba = Later('numba')\n"),
    "a part of matplotlib elsewhere": ("one_home", "report/table.py", "from matplotlib import figure\n"),
    "print elsewhere": ("one_home", "report/case.py", "print(1)\n"),
    "print in a command": ("one_home", "cli/run.py", "print(1)\n"),
    "units per thickness in an output": (
        "units_with_thickness",
        "report/sweep.py",
        "from fastpin.model.units import units_per_thickness\n",
    ),
    "a private name of another file": (
        "nothing_private",
        "reading/peaks.py",
        "from fastpin.reading.zones import _alike\n",
    ),
    "a private attribute of a module": (
        "nothing_private",
        "reading/peaks.py",
        "from fastpin.reading import zones\nzones._alike\n",
    ),
    "an import inside a function": ("imports_at_the_top", "solver/arc.py", "def more():\n    import json\n"),
    "a long file": ("small", "solver/arc.py", "\n" * layout.MOST_LINES),
    "a long function": ("small", "solver/arc.py", "def more():\n" + "    x = 1\n" * (layout.MOST_FUNCTION_LINES + 1)),
    "many parameters": ("small", "solver/arc.py", "def more(a, b, c, d, e, f, g, h, i):\n    return a\n"),
    "a folder without a sentence": ("sentences_in_folders", "model/__init__.py", None),
}
"""For each way to break the layout: the rule, the file, and the text that is added to it; None empties the file."""


@pytest.fixture(scope="module")
@for_gate
def texts():
    return layout.texts_of(ROOT)


def test_every_rule_holds(texts):
    assert len(texts) > 150
    assert layout.broken(texts) == []


@pytest.mark.parametrize("name", BREAKS)
def test_a_broken_rule_is_noticed(name, texts):
    rule, file, text = BREAKS[name]
    sentences = layout.broken({**texts, file: "" if text is None else f"{texts.get(file, '')}\n{text}"})
    assert sentences
    assert {sentence.split(":")[0] for sentence in sentences} == {rule}


def test_every_rule_is_broken_once():
    tried = {rule for rule, _, _ in BREAKS.values()}
    assert {rule.__name__ for rule in layout.RULES} - tried == {"exceptions_used"}


def test_an_exception_that_is_not_needed_is_noticed(texts, monkeypatch):
    monkeypatch.setitem(layout.UPWARD, "model/grid.py", "no reason")
    monkeypatch.setitem(layout.MANY_PARAMETERS, "solver/arc.py nothing", "no reason")
    assert len(layout.broken(texts)) == 2


# -- the public face -----------------------------------------------------------------------------------------


def stub_names(path: Path, also_files: bool = True) -> list[str]:
    """Names that an ``__init__.pyi`` makes public."""
    nodes = [node for node in ast.parse(path.read_text(encoding="utf-8")).body if isinstance(node, ast.ImportFrom)]
    return [alias.name for node in nodes if also_files or node.module for alias in node.names]


def test_the_public_face_is_small_and_listed_once():
    names = stub_names(ROOT / "fastpin" / "__init__.pyi")
    assert sorted(names) == sorted(fastpin.__all__)
    assert len(names) <= layout.MOST_PUBLIC_NAMES
    assert dir(fastpin) == sorted(names)


def stubs() -> list[Path]:
    """The lists of public names."""
    return [path for folder in ("", *layout.RANKS) if (path := ROOT / "fastpin" / folder / "__init__.pyi").exists()]


def test_public_names_exist_and_are_documented():
    for stub in stubs():
        module = importlib.import_module(".".join(stub.relative_to(ROOT).parent.parts))
        for name in stub_names(stub):
            value = getattr(module, name)
            if inspect.ismodule(value) or inspect.isclass(value) or inspect.isroutine(value):
                assert inspect.getdoc(value), (stub, name)


def test_no_public_name_is_also_the_name_of_a_file():
    """The import of the file would put the module in the place of the function."""
    for stub in stubs():
        if stub.parent.name == "fastpin":
            continue
        # "from . import FILE" makes the file itself public, and has no module.
        names = stub_names(stub, also_files=False)
        assert [name for name in names if (stub.parent / f"{name}.py").exists()] == [], stub


@pytest.mark.gate
def test_completion_shows_the_same_before_and_after_a_solve():
    code = (
        "import fastpin\n"
        "before = dir(fastpin)\n"
        "pair = fastpin.MaterialPair(fastpin.MATERIALS['steel'], fastpin.MATERIALS['aluminium'])\n"
        "problem = fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4)\n"
        "fastpin.solve(problem, [{'P': 1.0}], nodes=41)\n"
        "assert dir(fastpin) == before == sorted(fastpin.__all__), dir(fastpin)\n"
    )
    finished(python(code))


# -- the tests -----------------------------------------------------------------------------------------------


def test_tests_lie_in_the_folders_of_the_package():
    folders = {path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders - set(layout.RANKS) == {"project", "support", "survey", "whole"}


IMPORT = re.compile(r"^\s*(?:from\s+(\S+)\s+)?import\s+(\([^)]*\)|[^\n]*)", re.MULTILINE)
"""The module and the names of an import. Parsing all tests takes a second."""


def test_no_test_imports_a_test_or_changes_the_path():
    assert IMPORT.findall("from tests.a import (\n    b,\n)\nimport c") == [("tests.a", "(\n    b,\n)"), ("", "c")]
    for path in (ROOT / "tests").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        words = {word for found in IMPORT.findall(text) for part in found for word in re.findall(r"\w+", part)}
        assert not [word for word in words if word.startswith("test_")], path
        assert "sys.path." + "insert" not in text, path
        assert "sys.path." + "append" not in text, path
    assert not list((ROOT / "tests" / "support").glob("test_*.py"))


def test_every_test_of_the_survey_is_marked():
    for path in (ROOT / "tests" / "survey").glob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        assert re.search(r"^pytestmark = \[?\s*pytest\.mark\.survey", text, re.MULTILINE), path


@pytest.mark.gate
def test_files_name_only_modules_that_the_faces_of_folders_list() -> None:
    """In a test another import may have loaded the module; in a process of its own it has none."""
    unknown = []
    for path in sorted((ROOT / "fastpin").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        imports = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module == "fastpin"]
        faces = {each.name for node in imports for each in node.names}
        for node in ast.walk(tree):
            if not (isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in faces):
                continue
            face = f"fastpin.{node.value.id}"
            is_module = (ROOT / face.replace(".", "/") / f"{node.attr}.py").exists()
            if is_module and node.attr not in importlib.import_module(face).__all__:
                unknown.append(f"{path.name}, line {node.lineno}: {face}.{node.attr}")
    assert unknown == []

"""Every code block of README, CONTRIBUTING and docs/ runs or is checked.

* Blocks of Python run, a page after the other, with the names and files that the page speaks of. Pages whose output is
  compared too have a test of their own, named in :data:`ELSEWHERE`.
* Blocks of TOML have known sections and keys only.
* Commands of fastpin have options that exist. Other commands name files that exist. Scripts of a shell can be parsed.
* Queries run on a small sweep.
"""

import os
import re
import shlex
import shutil
import sqlite3
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import fastpin
from fastpin.casefile import EXAMPLE, LUG_EXAMPLE, builtin_case, parse_lug
from fastpin.casefile.lug import LUG_KEYS
from fastpin.casefile.materials import FILE_KEYS
from fastpin.casefile.reader import KEYS, ROOT_KEYS
from fastpin.cli.options import join_words, parser
from fastpin.joints.read import JOINT_KEYS
from fastpin.lugs import plate_compliance
from fastpin.studies import parse_plan, sweep
from fastpin.studies.tolerances import KEYS as TOLERANCE_KEYS
from scripts.inline import Inline
from tests.support.documents import texts
from tests.support.processes import finished

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
CHECKED = ("python", "toml", "console", "sh", "bash", "sql", "text", "math")
"""Languages of blocks. Texts are output, which the tests of ELSEWHERE compare; formulas are drawn by the site."""

ELSEWHERE = {
    "README.md": "test_readme.py",
    "cluster.md": "test_cluster_recipes.py",
    "bush.md": "test_pages.py",
    "carbon-laminate.md": "test_pages.py",
    "coming-from.md": "test_pages.py",
    "cracks.md": "test_pages.py",
    "fatigue.md": "test_pages.py",
    "figures.md": "test_pages.py",
    "interference.md": "test_pages.py",
    "reading-results.md": "test_pages.py",
    "riveted-joint.md": "test_pages.py",
    "sessions.md": "test_pages.py",
    "superposition.md": "test_pages.py",
    "tolerances.md": "test_pages.py",
    "tutorial.md": "test_pages.py",
    "wear.md": "test_pages.py",
}
"""Pages whose blocks of Python run in another test of this folder, as some of them may come later."""

LONG = {
    **dict.fromkeys(("convergence.md", "compliance.md", "histories.md"), pytest.mark.gate),
    "report.md": pytest.mark.survey,
}
"""Pages whose blocks of Python take long, and the mark of their test."""

PLAN_KEYS = {"title", "case", "grid", "list", "outcomes", "labels"}
"""Keys of a plan, as docs/reference/plan-file.md lists them."""

PROGRAMS = ("pip", "source", "ssh", "sbatch", "squeue", "snakemake", "module", "mkdir", "cd")
"""Programs of others, in commands that can't be checked here."""


def with_blocks(*languages: str) -> list[Any]:
    """The pages that have blocks in some languages, as parameters."""
    pages = [page for page in PAGES if texts(page, *languages)]
    assert pages, languages
    return [pytest.param(page, id=page.name) for page in pages]


def here() -> list[Any]:
    """The pages whose Python runs in this file, as parameters."""
    pages = [page for page in PAGES if texts(page, "python") and page.name not in ELSEWHERE]
    return [pytest.param(page, id=page.name, marks=LONG.get(page.name, ())) for page in pages]


@pytest.fixture(scope="module")
def small_sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a plan, its case, its function of wear and its finished sweep."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "case.toml").write_text(EXAMPLE, encoding="utf-8")
    (folder / "wear.py").write_text(texts(ROOT / "docs" / "sweeps.md", "python")[0], encoding="utf-8")
    text = (
        'case = "case.toml"\n[grid]\ncontact.friction = [0.3, 0.4]\npin.material = ["steel"]\nsolve.nodes = [61]\n'
        'load.2.Q = [[7e5, -7e5]]\n[outcomes]\nworn = { function = "wear.py:wear" }\n'
    )
    (folder / "plan.toml").write_text(text, encoding="utf-8")
    summary = sweep.run(parse_plan(text, folder=folder), folder / "plan", Inline())
    assert (summary.done, summary.unread) == (2, [])
    return folder


@pytest.fixture(scope="module")
def common_names(small_sweep: Path) -> dict[str, Any]:
    """The names that pages take for granted. The result is also the file case.h5, beside the sweep."""
    case = builtin_case()
    history = fastpin.LoadHistory([{"P": 2.42e6}]) + fastpin.LoadHistory([{"Q": 5e5}, {"Q": -5e5}]).repeated(2)
    fastpin.record(case.problem, case.history, small_sweep / "case.h5", nodes=61, slip_sums=True)
    loads = [{"P": 2.42e6}, {"Q": 5e5}]
    return {
        "fastpin": fastpin,
        "np": np,
        "pair": case.problem.pair,
        "problem": case.problem,
        "history": history,
        "loads": loads,
        "result": fastpin.load(small_sweep / "case.h5"),
        "study": fastpin.converge(case.problem, loads, nodes=[51, 61, 75]),
        "theta": np.linspace(-2.5, -0.6, 5),
    }


@pytest.fixture
def names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, small_sweep: Path, common_names: dict[str, Any]
) -> dict[str, Any]:
    """The common names; their files lie in the working directory."""
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    shutil.copytree(small_sweep, tmp_path, dirs_exist_ok=True)
    return dict(common_names)


@pytest.mark.gate
@pytest.mark.parametrize("page", here())
def test_python_runs(page: Path, names: dict[str, Any]) -> None:
    if page.name == "compliance.md":
        Path("lug.json").write_text(plate_compliance(parse_lug(LUG_EXAMPLE).lug).compliance.to_text(), encoding="utf-8")
    if page.name == "sweeps.md":
        run_as_script(texts(page, "python"))
        return
    for code in texts(page, "python"):
        exec(compile(code, page.name, "exec"), names)
    plt.close("all")


def run_as_script(codes: list[str]) -> None:
    """Run the last three blocks of the page on sweeps, in a process of its own: workers import the script."""
    *_, script, outcomes, many = codes
    lines = "".join(f"    {line}\n" for line in f"{outcomes}\n{many}\nassert len(peaks) == 2".splitlines())
    Path("script.py").write_text(f"from wear import wear\n\n{script}\n{lines}", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{Path.cwd()}"}
    said = finished([sys.executable, "script.py"], cwd=Path.cwd(), env=environment).stdout
    assert len(said.splitlines()) == 3


def test_pages_that_run_elsewhere_are_named_there() -> None:
    tests = {path.name: path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("test_*.py")}
    for page in PAGES:
        if page.name in ELSEWHERE and texts(page, "python"):
            text = tests[ELSEWHERE[page.name]]
            assert page.name in text or page.stem in text or page.stem.upper() in text, page.name


def has_known_keys(table: Mapping[str, Any], sections: Mapping[str, Any]) -> bool:
    """Whether all sections and keys of a TOML table are known. None stands for any keys."""
    for section, value in table.items():
        for inner in value if isinstance(value, list) else [value]:
            if section not in sections:
                return False
            if isinstance(inner, Mapping) and sections[section] is not None and set(inner) - set(sections[section]):
                return False
    return True


@pytest.mark.parametrize("page", with_blocks("toml"))
def test_toml_has_known_keys(page: Path) -> None:
    case = {**KEYS, **dict.fromkeys(ROOT_KEYS)}
    plan, tolerances = dict.fromkeys(PLAN_KEYS), dict.fromkeys(TOLERANCE_KEYS)
    for text in texts(page, "toml"):
        table = tomllib.loads(text)
        materials = dict.fromkeys(table, FILE_KEYS)
        assert any(
            has_known_keys(table, sections) for sections in (case, plan, tolerances, LUG_KEYS, JOINT_KEYS, materials)
        ), text
        if "grid" in table:
            for section in table["grid"]:
                assert section.partition(".")[0] in KEYS, section


def test_unknown_keys_are_noticed() -> None:
    assert not has_known_keys({"contact": {"fricton": 0.3}}, KEYS)
    assert not has_known_keys({"contacts": {}}, KEYS)
    assert not has_known_keys({"load": [{"P": 1.0}, {"p": 1.0}]}, KEYS)


@pytest.mark.parametrize("page", with_blocks("console"))
def test_commands_exist(page: Path) -> None:
    for text in texts(page, "console"):
        for line in filter(None, map(str.strip, text.replace("\\\n", " ").splitlines())):
            check_command(line.removeprefix("$ "))


@pytest.mark.gate
@pytest.mark.parametrize("page", with_blocks("sh", "bash"))
def test_shell_scripts_can_be_read(page: Path) -> None:
    for text in texts(page, "sh", "bash"):
        finished(["bash", "-n"], said=text)


def check_command(line: str) -> None:
    """Check one command: the options of fastpin, or the file that it runs."""
    words = shlex.split(re.split(r" [|>&]|&&", line)[0], comments=True)
    while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
        words.pop(0)
    if not words:
        return
    program, *arguments = words
    if program == "fastpin":
        parser().parse_args(join_words(arguments))
    elif program.startswith(("./", ".ci/", "scripts/")):
        assert os.access(ROOT / program, os.X_OK), line
    elif program in ("python", "pytest"):
        file = next(word for word in arguments if not word.startswith("-"))
        assert (ROOT / file).exists() or (ROOT / f"{file.replace('.', '/')}.py").exists(), line
    else:
        assert program in PROGRAMS, line


def test_queries_run(small_sweep: Path) -> None:
    (text,) = texts(ROOT / "docs" / "sweeps.md", "sql")
    text = text.replace("'wear'", "'worn'")
    with sqlite3.connect(small_sweep / "plan" / "index.sqlite") as index:
        rows = [index.execute(query).fetchall() for query in text.split(";") if query.strip()]
    index.close()
    assert [len(found) for found in rows] == [2, 2, 1]


def test_every_language_is_checked() -> None:
    for page in PAGES:
        languages = re.findall(r"^```(\w+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
        assert set(languages) <= set(CHECKED), page.name

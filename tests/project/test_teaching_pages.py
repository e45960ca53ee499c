"""The pages that teach: their files, commands and scripts run, and print the numbers that the pages show."""

import re
from pathlib import Path

import pytest

from fastpin.bodies import Bushing, Ring
from fastpin.casefile import parse_case
from fastpin.studies import read_plan, sweep
from fastpin.studies.plan import parse_plan
from scripts import tutorial
from scripts.inline import Inline
from tests.support.documents import DOCS, blocks, run_page
from tests.support.tiers import gate

HOW_TO = [
    "tutorial",
    "riveted-joint",
    "bushed-lug",
    "case-files",
    "histories",
    "sessions",
    "figures",
    "live",
    "report",
    "reading-results",
    "sweeps",
    "cluster",
    "bodies",
    "interference",
    "compliance",
    "superposition",
    "fatigue",
    "wear",
    "convergence",
    "coming-from",
    "glossary",
]
"""The tutorials and the how-to pages."""


@pytest.fixture(autouse=True)
def _inside_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.survey
def test_the_tutorial_runs_as_printed() -> None:
    """Figures are left to `scripts/tutorial.py`, which draws them by the same commands."""
    run_page("tutorial.md", lambda command: "" if command.startswith("plot") else command.partition(" --plot")[0])
    assert Path("joint.toml").read_text() == (DOCS / "tutorial.toml").read_text()
    assert [block.kind for block in blocks("tutorial.md")].count("text") == 9


def test_the_tutorial_shows_the_figures_of_its_script(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tutorial, "main", lambda command: 0)
    names = [path.name for path in tutorial.draw(DOCS / "figures")]
    assert re.findall(r"\(figures/([\w.-]+)\)", (DOCS / "tutorial.md").read_text(encoding="utf-8")) == names
    assert all((DOCS / "figures" / name).exists() for name in names)


@pytest.mark.parametrize("page", ["coming-from.md", *gate("superposition.md", "interference.md")])
def test_a_page_of_scripts_prints_its_numbers(page: str) -> None:
    run_page(page)


@pytest.mark.gate
def test_results_are_read_as_shown() -> None:
    """The sweep runs in this process, and drawn figures are left out."""

    def solved_here(command: str) -> str:
        if command.startswith("sweep"):
            summary = sweep.run(read_plan("plan.toml"), "plan", Inline(), files="--files" in command)
            assert (summary.done, summary.unread) == (2, [])
        return command if command.startswith("show") else ""

    names = run_page("reading-results.md", solved_here)
    assert len(names["paths"]) == 2


@pytest.mark.gate
def test_the_map_of_slip_regimes_is_a_plan() -> None:
    for block in blocks("sweeps.md"):
        if block.file is not None:
            Path(block.file).write_text(block.text, encoding="utf-8")
    whole = read_plan("regimes.toml")
    assert len(whole.runs) == 120
    text = re.sub(r"\{ from = 0.1.*\}", "[0.1, 1.0]", whole.text)
    text = re.sub(r"\{ from = 5e4.*\}", "[5e4, 6e5]\nsolve.nodes = [41]", text)
    few = parse_plan(text, folder=Path.cwd())
    assert sweep.run(few, "out", Inline()).done == 4
    rows = {(row["contact.friction"], row["load.2.amplitude.Q"]): row for row in sweep.rows(few, "out")}
    assert {key: row["regime"] for key, row in rows.items()} == {
        (0.1, 5e4): 2,
        (0.1, 6e5): 3,
        (1.0, 5e4): 1,
        (1.0, 6e5): 2,
    }
    assert {key: row["harm"] for key, row in rows.items() if key[1] == 5e4} == {(0.1, 5e4): 1, (1.0, 5e4): 0}


def test_every_case_of_bodies_is_read() -> None:
    """The second one has a bush in a ring."""
    ring, bush = (parse_case(block.text).problem.plate_body for block in blocks("bodies.md") if block.kind == "toml")
    assert isinstance(ring, Ring)
    assert isinstance(bush, Bushing)
    assert isinstance(bush.inside, Ring)


@pytest.mark.parametrize("page", HOW_TO)
def test_a_page_begins_with_its_purpose(page: str) -> None:
    """Below its title."""
    title, _, first, *_ = page_text(f"{page}.md").splitlines()
    assert title.startswith("# ")
    assert first.startswith("This page ")


def test_the_glossaries_share_no_word() -> None:
    """A word has one home."""
    words = [
        set(re.findall(r"^\| ([^|]+?) \|", page_text(name), re.MULTILINE)) for name in ("glossary.md", "solver.md")
    ]
    assert len(words[0]) > 40
    assert words[0] & words[1] <= {"word"}


def page_text(name: str) -> str:
    return (DOCS / name).read_text(encoding="utf-8")

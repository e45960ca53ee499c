"""The pages of docs/ that teach: they show their files, and their commands and scripts print the numbers they show."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import fastpin
from fastpin.bodies import Bushing, Ring
from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.cracks import CrackFate
from fastpin.damage import Race
from fastpin.figures.kinds import KINDS
from fastpin.states import Regime
from fastpin.studies import read_plan, read_tolerances, sweep, workers
from fastpin.studies.plan import Plan, parse_plan
from scripts import tutorial
from scripts.inline import Inline
from tests.support.documents import DOCS, assert_shown, blocks, page_text, printing, run_page, run_python, texts
from tests.support.tiers import gate

HOW_TO = [
    "tutorial",
    "riveted-joint",
    "bushed-lug",
    "rig",
    "signature",
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
    "joints",
    "interference",
    "temperature",
    "compliance",
    "superposition",
    "fatigue",
    "stress-life",
    "wear",
    "convergence",
    "coming-from",
    "glossary",
]
"""The tutorials and the how-to pages."""

FILES = {
    "carbon-laminate.md": ["carbon-laminate.toml", "carbon-fit.toml", "carbon-axis.toml", "carbon-envelope.toml"],
    "wear.md": ["worn-joint.toml", "fretting-map.toml"],
    "cracks.md": ["crack-map.toml"],
    "bushed-lug.md": ["bushed-lug.toml", "bushed-lug-tolerances.toml"],
    "signature.md": ["signature.toml"],
    "riveted-joint.md": ["riveted-joint.toml", "riveted-joint-plan.toml"],
    "rig.md": ["rig.toml", "rig-map.toml"],
}
"""The files that a page shows as a whole, in this order. Each of them begins with a comment."""

CARBON = page_text("carbon-laminate.md")


@pytest.fixture(autouse=True)
def _beside_the_files_of_docs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in (*DOCS.glob("*.toml"), *DOCS.glob("*.csv")):
        shutil.copy(path, path.name)


def change(file: str, *changes: tuple[str, str]) -> None:
    """Replace words of a file in the working directory."""
    text = Path(file).read_text(encoding="utf-8")
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    Path(file).write_text(text, encoding="utf-8")


def write_files(page: str) -> None:
    """Write the blocks of a page that are files."""
    for block in blocks(page):
        if block.file is not None:
            Path(block.file).write_text(block.text, encoding="utf-8")


def drawn() -> list[str]:
    """The files in the working directory that a page has made."""
    return sorted(path.name for path in Path().iterdir() if not (DOCS / path.name).exists())


def solved(plan: Plan, count: int) -> list[dict[str, Any]]:
    """The rows of a plan of so many runs, solved in this process."""
    summary = sweep.run(plan, "out", Inline())
    assert (summary.done, summary.unread) == (count, [])
    return sweep.rows(plan, "out")


# -- all pages ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("page", HOW_TO)
def test_a_page_begins_with_its_purpose(page: str) -> None:
    """Below its title."""
    title, _, first, *_ = page_text(f"{page}.md").splitlines()
    assert title.startswith("# ")
    assert first.startswith("This page ")


@pytest.mark.parametrize("page", FILES)
def test_a_page_shows_its_files(page: str) -> None:
    shown = [text for text in texts(page, "toml") if text.startswith("# ")]
    assert shown == [(DOCS / name).read_text(encoding="utf-8") for name in FILES[page]]


@pytest.mark.parametrize(
    ("page", "count"),
    [
        ("carbon-laminate.md", 1),
        ("stress-life.md", 2),
        *gate(("bush.md", 2), ("wear.md", 5)),
        pytest.param("fatigue.md", 5, marks=pytest.mark.survey),
    ],
)
def test_python_prints_the_numbers_of_the_page(page: str, count: int) -> None:
    """So many of its blocks of Python print something."""
    assert sum(bool(text) for _, text in printing(page)) == count
    run_python(page)


@pytest.mark.gate
@pytest.mark.parametrize("page", ["carbon-laminate", "bushed-lug", "signature"])
def test_the_run_of_a_page_prints_its_numbers(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", f"{page}.toml"]) == 0
    assert texts(f"{page}.md", "text")[0] in capsys.readouterr().out


@pytest.mark.gate
def test_a_cold_worked_hole_passes_as_shown(capsys: pytest.CaptureFixture[str]) -> None:
    """The other commands of the page check the case and write its report."""
    assert main(["run", "signature-cold.toml"]) == 0
    assert texts("signature.md", "text")[1] in capsys.readouterr().out
    plain, cold = (
        Path(name).read_text(encoding="utf-8").splitlines()[1:] for name in ("signature.toml", "signature-cold.toml")
    )
    assert [line for line in cold if line not in plain] == [
        "residual_stress = -100e6    # what cold working has left, Pa"
    ]
    assert main(["check", "signature.toml"]) == 0
    assert main(["run", "signature.toml", "-o", "signature.h5"]) == 0
    assert Path("signature.csv").read_text(encoding="utf-8") in page_text("signature.md")


@pytest.mark.parametrize("page", ["coming-from.md", *gate("superposition.md", "interference.md")])
def test_a_page_of_scripts_prints_its_numbers(page: str) -> None:
    run_page(page)


def test_the_glossaries_share_no_word() -> None:
    """A word has one home."""
    words = [
        set(re.findall(r"^\| ([^|]+?) \|", page_text(name), re.MULTILINE)) for name in ("glossary.md", "solver.md")
    ]
    assert len(words[0]) > 40
    assert words[0] & words[1] <= {"word"}


# -- the tutorial, reading results, sweeps -----------------------------------------------------------------------------


@pytest.mark.survey
def test_the_tutorial_runs_as_printed() -> None:
    """Figures are left to `scripts/tutorial.py`, which draws them by the same commands."""
    run_page("tutorial.md", lambda command: "" if command.startswith("plot") else command.partition(" --plot")[0])
    assert Path("joint.toml").read_text() == (DOCS / "tutorial.toml").read_text()
    assert len(texts("tutorial.md", "text")) == 9


def test_the_tutorial_shows_the_figures_of_its_script(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tutorial, "main", lambda command: 0)
    names = [path.name for path in tutorial.draw(DOCS / "figures")]
    assert re.findall(r"\(figures/([\w.-]+)\)", page_text("tutorial.md")) == names
    assert all((DOCS / "figures" / name).exists() for name in names)


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
    write_files("sweeps.md")
    whole = read_plan("regimes.toml")
    assert len(whole.runs) == 120
    text = re.sub(r"\{ from = 0.1.*\}", "[0.1, 1.0]", whole.text)
    text = re.sub(r"\{ from = 5e4.*\}", "[5e4, 6e5]\nsolve.nodes = [41]", text)
    rows = {
        (row["contact.friction"], row["load.2.amplitude.Q"]): row for row in solved(parse_plan(text, folder="."), 4)
    }
    regimes = {(0.1, 5e4): 2, (0.1, 6e5): 3, (1.0, 5e4): 1, (1.0, 6e5): 2}
    assert {key: row["regime"] for key, row in rows.items()} == regimes
    assert {key: row["harm"] for key, row in rows.items() if key[1] == 5e4} == {(0.1, 5e4): 1, (1.0, 5e4): 0}


@pytest.mark.gate
def test_the_example_of_figures_draws_them() -> None:
    names = run_python("figures.md")
    assert drawn() == ["loops.pdf", "map.svg", "scar.pdf", "tractions.pdf"]
    assert names["axes"].texts
    for kind in KINDS:
        assert f"`{kind}`" in page_text("figures.md"), kind


@pytest.mark.gate
def test_the_examples_of_sessions_run() -> None:
    names = run_python("sessions.md")
    session, state = names["session"], names["state"]
    assert 1e5 < names["force"] < 7e5
    assert 0.2 < names["friction"] < 0.4
    assert session.problem.friction == pytest.approx(names["friction"], rel=1e-4)
    assert session.state is state
    assert names["lost"] is None


@pytest.mark.survey
def test_the_plan_of_tolerances_prints_its_numbers(monkeypatch, capsys):
    def inline(_: object, tasks: list[str], submit: Callable[..., Any], size: int) -> Any:
        for task in tasks:
            yield (task,), submit(Inline(), (task,)).result()

    monkeypatch.setattr(workers, "through_processes", inline)
    write_files("tolerances.md")
    effects, _ = texts("tolerances.md", "text")
    assert main(["tolerances", "tolerances.toml"]) == 0
    out = capsys.readouterr().out
    assert "119 runs in tolerances: 119 done" in out
    assert effects in out
    run_python("tolerances.md")


# -- a riveted joint and a bushed lug ----------------------------------------------------------------------------------


@pytest.mark.survey
def test_the_riveted_joint_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    """The load point is one of several with equal stress."""
    assert main(["run", "riveted-joint.toml"]) == 0
    shown, printed = (
        re.sub(r"load point \d+;", "", text) for text in (texts("riveted-joint.md", "text")[0], capsys.readouterr().out)
    )
    assert_shown(shown, printed)
    run_python("riveted-joint.md")


@pytest.mark.gate
def test_the_plan_of_the_riveted_joint_can_be_run() -> None:
    plan = read_plan("riveted-joint-plan.toml")
    assert len(plan.runs) == 18
    change("riveted-joint-plan.toml", ("contact.friction = { from = 0.2, to = 0.6, count = 9 }", "solve.nodes = [101]"))
    rows = solved(read_plan("riveted-joint-plan.toml"), 2)
    clearance, interference = sorted(rows, key=lambda row: -row["contact.clearance"])
    assert clearance["life"] < 0.1 * interference["life"]
    assert clearance["energy"] < 0.1 * interference["energy"]


def test_the_plan_of_the_bushed_lug_has_its_runs() -> None:
    study = read_tolerances("bushed-lug-tolerances.toml")
    assert len(study.plan.points) == 43
    assert study.plan.outcomes.keys() == {"hoop", "life", "growth"}


# -- a loop of a rig ---------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_the_loop_of_the_rig_prints_its_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", "rig.toml", "rig.csv"]) == 0
    assert_shown(texts("rig.md", "text")[0], capsys.readouterr().out)


def test_the_map_of_the_rig_has_its_runs() -> None:
    plan = read_plan("rig-map.toml")
    assert len(plan.runs) == 30
    assert plan.outcomes.keys() == {"regime", "energy"}


# -- a bolt in a carbon laminate ---------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize(
    ("criterion", "lengths", "start"),
    [
        ("yamada-sun", "tension = 0.5e-3\ncompression = 1.5e-3", "| `yamada-sun`, curve of 0.5 mm and 1.5 mm | "),
        ("hashin", "distance = 0.5e-3", "| `hashin`, 0.5 mm from the edge | "),
    ],
)
def test_other_assessments(criterion: str, lengths: str, start: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = Path("carbon-laminate.toml").read_text(encoding="utf-8").replace("yamada-sun", criterion)
    Path("other.toml").write_text(re.sub(r"distance = .*", lengths, text), encoding="utf-8")
    assert main(["run", "other.toml"]) == 0
    printed = capsys.readouterr().out
    (row,) = [line for line in CARBON.splitlines() if line.startswith(start)]
    ratio, place, ply, factor = (cell.strip() for cell in row.split("|")[2:6])
    assert f"strength ratio {ratio} by {criterion}" in printed
    angle, words = ply.split(" deg, ")
    assert f"ply of {angle} deg by {words}" in printed
    assert f"load at failure: {factor} times all loads" in printed
    found = re.search(r"; at (-?[\d.]+) deg from the bottom", printed)
    assert round(abs(float(found[1]))) == int(place.removesuffix(" deg"))


@pytest.mark.gate
def test_clearance_and_friction() -> None:
    rows = solved(read_plan("carbon-fit.toml"), 15)
    ratios = {(row["contact.clearance"], row["contact.friction"]): row["ratio"] for row in rows}
    assert f"from {ratios[0, 0.2]:.2f} to {ratios[60e-6, 0.2]:.2f} at a friction of 0.2" in CARBON
    assert 1.3 < ratios[0, 0.4] / ratios[0, 0.0] < 1.4
    assert f"and by {100.0 * (ratios[60e-6, 0.4] / ratios[60e-6, 0.0] - 1.0):.0f} % at 60 um" in CARBON


@pytest.mark.gate
def test_the_table_of_axes() -> None:
    rows = solved(read_plan("carbon-axis.toml"), 21)
    ratios = {(row["plate.layup"], row["plate.axis"]): row["ratio"] for row in rows}
    for layup in {layup for layup, _ in ratios}:
        cells = " | ".join(f"{ratios[layup, axis]:.3f}" for axis in (0, 15, 30, 45))
        assert f"| {layup} | {cells} |" in CARBON
        assert ratios[layup, 30] == pytest.approx(ratios[layup, 60], rel=1e-6)


@pytest.mark.gate
def test_the_envelope() -> None:
    rows = solved(read_plan("carbon-envelope.toml"), 18)
    factors = {(row["load.1.syy"], row["contact.clearance"]): row["factor"] for row in rows}
    taken = 1.0 - factors[0, 40e-6] / factors[0, 10e-6]
    assert f"takes {100.0 * taken:.0f} % of the bearing strength" in CARBON
    assert factors[-100e6, 10e-6] < factors[0, 10e-6] < factors[50e6, 10e-6]
    assert factors[400e6, 40e-6] > factors[400e6, 10e-6]
    assert main(["sweep", "carbon-envelope.toml", "-o", "out", "--envelope", "--plot", "envelope.svg"]) == 0


# -- wear, cracks and bushes -------------------------------------------------------------------------------------------


def test_the_profiles_of_the_page_on_wear_can_be_read() -> None:
    case = Path("worn-joint.toml").read_text(encoding="utf-8")
    gap, friction = (next(text for text in texts("wear.md", "toml") if word in text) for word in ("[gap]", "greased"))
    assert parse_case(case + gap).problem.gap.given.keys() == {"hole", "pin"}
    (line,) = re.findall(r"^friction = .*$", friction, re.MULTILINE)
    changed = parse_case(re.sub(r"^friction = .*$", line, case, count=1, flags=re.MULTILINE)).problem
    assert changed.friction_at(changed.hole_radius * 0.0 - 1.6) == pytest.approx(0.2)


@pytest.mark.gate
def test_the_table_of_wear_is_that_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["wear", "worn-joint.toml", "-o", "life.h5"]) == 0
    shown = next(text for text in texts("wear.md", "text") if "energy/cycle" in text)
    assert shown in capsys.readouterr().out
    assert main(["plot", "life.h5", "damage"]) == 0


def mapped(name: str, value: str, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """The rows of a plan of four runs whose map one command draws."""
    assert main(["sweep", f"{name}.toml", "--workers", "1", "--plot", "map.png", "--value", value]) == 0
    assert f"4 runs in {name}: 4 done" in capsys.readouterr().out
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")
    return sweep.rows(read_plan(f"{name}.toml"), name)


@pytest.mark.survey
def test_the_fretting_map_is_drawn_by_one_command(capsys: pytest.CaptureFixture[str]) -> None:
    """The same plan on a small grid, with few nodes and cycles."""
    assert len(read_plan("fretting-map.toml").points) == 56
    change(
        "fretting-map.toml",
        ("from = 2e5, to = 1.6e6, count = 8", "from = 6e5, to = 1.2e6, count = 2"),
        ("from = 1e5, to = 1e6, count = 7", "from = 1e5, to = 8.5e5, count = 2"),
    )
    (at,) = re.findall(r"^at = .*$", Path("worn-joint.toml").read_text(encoding="utf-8"), re.MULTILINE)
    change("worn-joint.toml", ("nodes = 101", "nodes = 41"), (at, "at = [100_000]"))
    rows = mapped("fretting-map", "regime,energy,volume,life", capsys)
    assert [row["regime"] for row in rows] == [Regime.PARTIAL_SLIP, Regime.GROSS_SLIDING, *[Regime.PARTIAL_SLIP] * 2]
    assert [row["race"] for row in rows] == [Race.OPEN, Race.WEAR, Race.OPEN, Race.CRACK]
    assert [row["life"] is None for row in rows] == [True, True, True, False]
    joint = fastpin.read_case("worn-joint.toml")
    loads = fastpin.LoadHistory([{"P": 6e5}]) + fastpin.LoadHistory([{"Q": -8.5e5}, {"Q": 8.5e5}]).repeated(1)
    worn = fastpin.wear(joint.problem, loads, nodes=41, **joint.wear.given)
    assert rows[1]["volume"] == pytest.approx(worn[-1].volume, rel=0.03)


@pytest.mark.gate
def test_the_map_of_cracks_is_drawn_by_one_command(capsys: pytest.CaptureFixture[str]) -> None:
    """The same plan on a small grid, with few nodes."""
    assert len(read_plan("crack-map.toml").points) == 63
    change(
        "crack-map.toml",
        ("from = 1e6, to = 9e6, count = 9", "from = 3e6, to = 9e6, count = 2"),
        ("from = 0.2e6, to = 2e6, count = 7", "from = 0.5e6, to = 2e6, count = 2"),
    )
    change("cracked-joint.toml", ("nodes = 201", "nodes = 101"))
    rows = mapped("crack-map", "fate,life", capsys)
    assert [row["fate"] for row in rows] == [CrackFate.STOPS, CrackFate.GROWS, CrackFate.NONE, CrackFate.BREAKS]


@pytest.mark.gate
def test_the_example_of_cracks_prints_its_numbers_and_draws_a_figure() -> None:
    assert [bool(text) for _, text in printing("cracks.md")] == [True, False, True]
    assert run_python("cracks.md")["own"].fate.words == "grows"
    assert drawn() == ["growth.png"]


def test_the_files_of_the_page_on_bushes_hold_what_it_says() -> None:
    assert not fastpin.read_case("bush-walk.toml").problem.plate_body.bush.bonded
    (shown,) = texts("bush.md", "toml")
    for line in shown.splitlines():
        assert line.split("#")[0].strip() in Path("bush-walk.toml").read_text(encoding="utf-8")
    plan = read_plan("bush-walk-plan.toml")
    assert len(plan.points) == 64
    assert plan.outcomes.keys() == {"walk", "sticking", "least"}


def test_every_case_of_bodies_is_read() -> None:
    """The second one has a bush in a ring."""
    ring, bush = (parse_case(text).problem.plate_body for text in texts("bodies.md", "toml"))
    assert isinstance(ring, Ring)
    assert isinstance(bush, Bushing)
    assert isinstance(bush.inside, Ring)

"""The command ``tolerances``: what it prints, its exit codes, its files and its report."""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fastpin.cli.main import main
from fastpin.report import json_schema
from fastpin.studies import workers
from scripts.inline import Inline

PLAN = """
title = "Moment that friction may not carry"
case = "case.toml"
samples = 6
[tolerances]
contact.friction = { from = 0.02, to = 0.5 }
load.2.M = { from = 1000.0, to = 3000.0 }
[outcomes]
pressure = { quantity = "peak_pressure", take = "largest" }
"""

CASE = """
pin.material = "steel"
plate.material = "aluminium"
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.3
pin_load = "centre"
[[load]]
P = 1e6
[[load]]
M = 1200.0
[solve]
nodes = 41
"""


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A plan in the working directory; its runs are made in this process. Small friction can't carry the moment."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(workers, "through_processes", lambda _, tasks, submit, size: inline(tasks, submit))
    Path("case.toml").write_text(CASE)
    Path("moment.toml").write_text(PLAN)
    return "moment.toml"


def inline(tasks: list[str], submit: Callable[..., Any]) -> Any:
    for task in tasks:
        yield (task,), submit(Inline(), (task,)).result()


@pytest.mark.gate
def test_a_study_prints_its_effects_and_names_what_failed(plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tolerances", plan, "--status"]) == 0
    assert capsys.readouterr().out.endswith("15 runs in moment: 0 done, 0 failed, 15 waiting\n")
    assert not Path("moment").exists()

    assert main(["tolerances", plan]) == 1  # some runs have failed
    out = capsys.readouterr().out
    assert "nothing holds the pin any more" in out
    assert "failed: 2 of 4 corners, " in out
    assert "1 of 3 values of contact.friction alone; they count nowhere below" in out
    lines = out.splitlines()
    assert any(line.startswith("pressure: nominal ") and line.endswith(" MPa") for line in lines)
    (friction,) = (line for line in lines if line.split()[:1] == ["contact.friction"])
    assert friction.split()[1:4] == ["0.02", "0.5", "-"]  # no value at the lower limit
    (largest,) = (line for line in lines if line.startswith("largest of 4 corners: "))
    assert largest.endswith("MPa at contact.friction = 0.5, load.2.M = 3 kN")
    assert any(line.startswith("percentiles of 6 samples: 5 %: ") for line in lines)

    assert main(["tolerances", plan, "--status"]) == 0
    assert "failed: 2 of 4 corners" in capsys.readouterr().out


@pytest.mark.gate
def test_files_come_after_the_runs(plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--table", "a.csv", "--plot", "a.png", "--scatter", "b.svg", "--json"]
    assert main(["tolerances", plan, "-o", "out", *options]) == 1
    document = json.loads(capsys.readouterr().out)
    assert (document["points"], document["corners"], document["samples"]) == (15, 4, 6)
    assert [each["part"] for each in document["failed"]][:3] == ["contact.friction alone", "a corner", "a corner"]
    found = document["outcomes"]["pressure"]
    assert found["fields"]["contact.friction"]["outcomes"][0] is None
    assert found["corners"]["largest"]["values"] == {"contact.friction": 0.5, "load.2.M": 3000.0}
    rows = list(csv.DictReader(Path("a.csv").read_text().splitlines()[2:]))
    assert len(rows) == 15
    assert max(float(row["pressure"]) for row in rows if row["pressure"]) == found["all"]["largest"]["value"]
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in Path("b.svg").read_text()
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(document, json_schema("tolerances"))

    assert main(["report", "out", "-o", "out.html"]) == 0
    page = Path("out.html").read_text()
    assert "A tolerance study of the frictional contact" in page
    assert "Failed: 2 of 4 corners" in page
    assert "random samples between the limits" in page
    assert main(["report", "out", "--plan", plan, "-o", "again.html"]) == 0
    assert "Fields and their limits" in Path("again.html").read_text()


def test_options_without_effect_are_refused(plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("none.toml").write_text(PLAN.replace("samples = 6", "samples = 0"))
    for options, words in (
        (["--value", "pressure"], "--value: says what a figure shows; --plot FILE or --scatter FILE is missing"),
        (["--plot", "a.png", "--value", "presure"], '--value: there is no outcome "presure", did you mean "pressure"?'),
        (["--plot", "a.txt"], "--plot"),
        (["--plot", "a.png", "--scatter", "a.png"], "--scatter: writes the same file as --plot"),
        (["--status", "--retry"], "--retry: runs what failed again"),
    ):
        assert main(["tolerances", plan, *options]) == 2
        assert words in capsys.readouterr().err
    assert main(["tolerances", "none.toml", "--scatter", "a.png"]) == 2
    assert "--scatter: draws samples, and the plan has none" in capsys.readouterr().err
    assert not Path("moment").exists()


def test_figures_of_a_study_that_has_not_begun_are_empty(plan: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tolerances", plan, "--status", "--plot", "a.png", "--scatter", "b.png", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcomes"]["pressure"]["nominal"] is None
    assert Path("a.png").stat().st_size > 0


@pytest.mark.gate
def test_a_study_that_is_interrupted_continues(plan, capsys, monkeypatch):
    def interrupted(_: object, tasks: list[str], submit: Callable[..., Any], size: int) -> Any:
        for number, end in enumerate(inline(tasks, submit)):
            if number == 4:
                raise KeyboardInterrupt
            yield end

    with monkeypatch.context() as patch:
        patch.setattr(workers, "through_processes", interrupted)
        assert main(["tolerances", plan]) == 130
    assert "4 of 15 runs are finished and kept; the same command continues" in capsys.readouterr().err
    assert main(["tolerances", plan]) == 1
    assert "; 11 in " in capsys.readouterr().out

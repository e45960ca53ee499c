"""The command ``tolerances``: what it prints, its exit codes, its files and its report."""

import csv
import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fastpin.report import json_schema
from fastpin.studies import workers
from tests.support.body_texts import HEAD
from tests.support.commands import printed, refused, said
from tests.support.plans import run_here

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

CASE = HEAD.replace("friction = 0.3", 'friction = 0.3\npin_load = "centre"')
CASE += "[[load]]\nM = 1200.0\n[solve]\nnodes = 41\n"


@pytest.fixture
def plan(monkeypatch: pytest.MonkeyPatch) -> str:
    """A plan in the working directory; its runs are made in this process. Small friction can't carry the moment."""
    monkeypatch.setattr(workers, "through_processes", run_here)
    Path("case.toml").write_text(CASE)
    Path("moment.toml").write_text(PLAN)
    return "moment.toml"


@pytest.mark.gate
def test_a_study_prints_its_effects_and_names_what_failed(plan: str) -> None:
    assert printed("tolerances", plan, "--status").endswith("15 runs in moment: 0 done, 0 failed, 15 waiting\n")
    assert not Path("moment").exists()

    out = said("tolerances", plan, code=1).out  # some runs have failed
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

    assert "failed: 2 of 4 corners" in printed("tolerances", plan, "--status")


@pytest.mark.gate
def test_files_come_after_the_runs(plan: str) -> None:
    options = ["--table", "a.csv", "--plot", "a.png", "--scatter", "b.svg", "--json"]
    document = json.loads(said("tolerances", plan, "-o", "out", *options, code=1).out)
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

    said("report", "out", "-o", "out.html")
    page = Path("out.html").read_text()
    assert "A tolerance study of the frictional contact" in page
    assert "Failed: 2 of 4 corners" in page
    assert "random samples between the limits" in page
    said("report", "out", "--plan", plan, "-o", "again.html")
    assert "Fields and their limits" in Path("again.html").read_text()


def test_options_without_effect_are_refused(plan: str) -> None:
    Path("none.toml").write_text(PLAN.replace("samples = 6", "samples = 0"))
    for options, words in (
        (["--value", "pressure"], "--value: says what a figure shows; --plot FILE or --scatter FILE is missing"),
        (["--plot", "a.png", "--value", "presure"], '--value: there is no outcome "presure", did you mean "pressure"?'),
        (["--plot", "a.txt"], "--plot"),
        (["--plot", "a.png", "--scatter", "a.png"], "--scatter: writes the same file as --plot"),
        (["--status", "--retry"], "--retry: runs what failed again"),
    ):
        assert words in refused("tolerances", plan, *options)
    assert "--scatter: draws samples, and the plan has none" in refused("tolerances", "none.toml", "--scatter", "a.png")
    assert not Path("moment").exists()


def test_figures_of_a_study_that_has_not_begun_are_empty(plan: str) -> None:
    words = printed("tolerances", plan, "--status", "--plot", "a.png", "--scatter", "b.png", "--json")
    assert json.loads(words)["outcomes"]["pressure"]["nominal"] is None
    assert Path("a.png").stat().st_size > 0


@pytest.mark.gate
def test_a_study_that_is_interrupted_continues(plan, monkeypatch):
    def interrupted(*given: Any) -> Iterator[Any]:
        yield from itertools.islice(run_here(*given), 4)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(workers, "through_processes", interrupted)
        words = said("tolerances", plan, code=130).err
    assert "4 of 15 runs are finished and kept; the same command continues" in words
    assert "; 11 in " in said("tolerances", plan, code=1).out

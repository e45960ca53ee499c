"""The command ``identify``: what it prints, its files, its exit codes, and wrong input."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fastpin import figures, studies
from fastpin.assess.outputs import whole_document
from fastpin.report import identify as report
from fastpin.report import json_schema
from fastpin.studies import FittedValue, Identified
from fastpin.studies.measured_loop import measured_loop
from tests.support.case_texts import IN_A_RIG
from tests.support.commands import refused, said
from tests.support.loops import THICKNESS, Measured, joint

jsonschema = pytest.importorskip("jsonschema")

CASE = 'title = "fretting rig"\n' + IN_A_RIG.replace(
    "[[load]]", "thickness = 8e-3\ngauge_radius = 20e-3\nhub_radius = 2e-3\n[[load]]"
)
LOOP = Measured(80e-6, 40, 0.005, cycles=1.3)


def write_case(measured: Measured | None = LOOP) -> None:
    Path("rig.toml").write_text(CASE)
    if measured is not None:
        loop = measured.loop(measured.clean(), 0)
        rows = zip((1e6 * loop["ux"]).tolist(), (loop["Q"] * THICKNESS).tolist(), strict=True)
        Path("rig.csv").write_text("way [um];Q [N];P [N]\n" + "".join(f"{u};{q};6000\n" for u, q in rows))


def identified(**changes: object) -> Identified:
    """What a loop could tell, without a fit."""
    turns = np.arange(131) / 50.0
    loop = measured_loop(("ux", "Q"), 1e-5 * np.sin(2.0 * np.pi * turns), 1e5 * np.sin(2.0 * np.pi * turns + 0.1))
    estimates = {"friction": FittedValue(0.6, 0.5, 0.9), "stiffness": FittedValue(3e10, 2.9e10, 3.1e10)}
    estimates |= {"displacement_offset": FittedValue(1e-6, 0.0, 2e-6), "force_offset": FittedValue(0.0, -1e3, 1e3)}
    computed, energies = (loop.displacement, 1.001 * loop.force), np.array([[0.3, 0.1, 0.35]])
    tied = {("friction", "stiffness"): -0.93, ("displacement_offset", "force_offset"): 0.5}
    found = Identified(joint(0.6), ("ux", "Q"), estimates, tied, 1.1, loop, computed, energies, ("a doubt",), 40)
    return replace(found, **changes)  # type: ignore[arg-type]


@pytest.mark.gate
def test_a_loop_is_read_fitted_and_written() -> None:
    write_case()
    words = ("identify", "rig.toml", "rig.csv", "--nodes", 25)
    lines = said(*words, "--csv", "out.csv", "--json", "out.json", "--plot", "out.png").out.splitlines()
    assert lines[0] == "fretting rig"
    assert lines[2] == "52 samples of ux and Q: 3 turning points (reversals above 3.21 um), 1 whole cycle"
    (friction,) = (line.split() for line in lines if line.split()[:1] == ["friction"])
    assert 0.97 * float(friction[2]) < 0.68 < 1.03 * float(friction[3])
    (stiffness,) = (line.split() for line in lines if line.split()[:1] == ["stiffness"])
    assert 0.99 * float(stiffness[2]) < 250.0 < 1.01 * float(stiffness[3])
    assert stiffness[4:] == ["MN", "per", "m"]
    document = json.loads(Path("out.json").read_text())
    jsonschema.validate(document, json_schema("identify"))
    assert f"{document['estimates']['friction']['value']:.4g}" == friction[1]
    rows = list(csv.DictReader(Path("out.csv").read_text().splitlines()))
    assert len(rows) == 52
    assert float(rows[5]["Q computed [N]"]) == pytest.approx(float(rows[5]["Q [N]"]), abs=400.0)
    assert Path("out.png").stat().st_size > 0


@pytest.mark.gate
def test_a_loop_that_tells_no_friction_has_its_exit_code() -> None:
    write_case(Measured(2e-6, 30, 0.01, cycles=1.3))
    out = said("identify", "rig.toml", "rig.csv", "--nodes", 25, code=3).out
    assert "note: friction: the loop does not tell it; " in out
    assert "  stiffness " in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--fit", "mass"], '--fit: must be "stiffness", "clearance", "drift" or "scale", not "mass"'),
        (["--start", "now"], '--start: must be "rest" or "cycle", not "now"'),
        (["--over", "uz"], '--over: must be "ux", "uy" or "rotation", not "uz"'),
        (["--force-factor", "0"], "--force-factor: must not be 0"),
        (["--force-factor", "-1"], "Q: falls where ux rises: turn its sign"),
        (["--force", "load"], 'rig.csv, line 1: Q: the file has no column "load"'),
        (["--plot", "out.txt"], "--plot: "),
        (["--csv", "a.png", "--plot", "a.png"], "writes the same file as"),
    ],
)
def test_wrong_options_are_refused(words: list[str], message: str) -> None:
    write_case(None)
    turns = np.arange(60) / 25.0
    rows = "".join(f"{10.0 * np.sin(2.0 * np.pi * t)};{900.0 * np.sin(2.0 * np.pi * t)}\n" for t in turns)
    Path("rig.csv").write_text("way [um];Q [N]\n" + rows)
    assert message in refused("identify", "rig.toml", "rig.csv", *words)


def test_the_text_says_what_is_told_and_what_is_not() -> None:
    lines = report.text(identified()).splitlines()
    assert lines[3].split() == ["value", "95", "%:", "from", "to"]
    assert lines[4].split() == ["friction", "0.6", "0.5", "0.9"]
    assert lines[5].split() == ["stiffness", "240", "232", "248", "MN", "per", "m"]
    assert lines[6].split() == ["displacement", "offset", "1", "0", "2", "um"]
    assert lines[-3:] == [
        "correlation of friction and stiffness: -0.93",
        "cycle 1: energy 2.4 +- 0.8 mJ, computed 2.8 mJ",
        "note: a doubt",
    ]
    stuck = identified(estimates={"friction": FittedValue(np.nan, 0.4, np.inf)})
    assert report.text(stuck).splitlines()[4].split() == ["friction", "not", "told", "0.4", "no", "bound"]


def test_the_json_has_the_text_s_numbers() -> None:
    document = whole_document(report.IDENTIFIED, identified(), {}, title="rig")
    jsonschema.validate(document, json_schema("identify"))
    assert document["estimates"]["stiffness"]["value"] == 3e10 * THICKNESS
    assert document["energies"] == [{"measured": 0.3 * 8e-3, "deviation": 0.1 * 8e-3, "computed": 0.35 * 8e-3}]
    stuck = identified(estimates={"friction": FittedValue(np.nan, 0.4, np.inf)})
    document = whole_document(report.IDENTIFIED, stuck, {}, title="rig")
    jsonschema.validate(document, json_schema("identify"))
    assert document["estimates"]["friction"] == {"value": None, "low": 0.4, "high": None}


def test_units_are_per_thickness_without_a_thickness() -> None:
    plain, thick = (report.text(identified(problem=joint(thickness=each))) for each in (None, THICKNESS))
    assert " 30  " in plain
    for words in ("GN/m^2", " kN/m", "J/m"):
        assert words in plain
        assert words not in thick


def test_the_figure_has_a_panel_for_each_question() -> None:
    figure = figures.plot_identified(identified(), title="rig")
    assert [panel.get_ylabel() for panel in figure.axes] == ["force Q (N)", "force Q less a line (N)", "energy (mJ)"]
    cycles = {"friction 1": FittedValue(0.6, 0.5, 0.9), "friction 2": FittedValue(np.nan, 0.5, np.inf)}
    figure = figures.plot_identified(identified(estimates=cycles, energies=np.empty((0, 3))))
    assert [panel.get_ylabel() for panel in figure.axes][2:] == ["friction"]


def test_python_reads_the_same_columns() -> None:
    write_case(None)
    Path("rig.csv").write_text("way [um];Q [N]\n1;16\n")
    found = studies.read_loop("rig.csv", joint())
    assert {name: values.tolist() for name, values in found.items()} == {"ux": [1e-6], "Q": [2000.0]}

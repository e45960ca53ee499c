"""Error bars of sweeps: of key figures and outcomes, in the index, tables, CSV files and charts."""

import csv
import math
import shutil
import sqlite3
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import CaseFileError, InputError, Result
from fastpin.report.sweep import chart, text, write_csv
from fastpin.states.error_bars import pair_bar
from fastpin.studies import parse_plan, sweep
from fastpin.studies.index import Index
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import CYCLE_QUANTITIES, bar_of, value_of
from fastpin.studies.plan import Plan
from scripts.inline import Inline
from tests.support.plans import MOMENT
from tests.support.tiers import for_gate

CASE = """
[pin]
material = "steel"
[plate]
material = "aluminium"
[contact]
hole_radius = 10e-3
clearance = 20e-6
thickness = 5e-3
friction = 0.4
pin_load = "centre"
rotation = "fixed"
[[load]]
P = 5e3
[[load]]
mean = { P = 5e3 }
amplitude = { Q = 5e2 }
repeat = 2
[solve]
nodes = 101
slip_sums = true
error_bars = true
"""
PLAN = """
case = "case.toml"
[grid]
contact.friction = [0.3, 0.6]
load.2.amplitude.Q = [250.0, 1000.0]
[outcomes]
regime = { cycle = "regime" }
loss = { cycle = "dissipation" }
peak = { quantity = "peak_shear", take = "largest magnitude" }
at = { quantity = "peak_pressure_angle", take = "smallest" }
stick = { quantity = "stick_width" }
"""
LATER = PLAN + 'swing = { quantity = "rotation", take = "range" }\nlow = { quantity = "work", take = "largest" }\n'


def own(result: Result) -> float:
    """A number without a kind."""
    return result[-1].work / result[-1].dissipation


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory):
    place = tmp_path_factory.mktemp("bars")
    (place / "case.toml").write_text(CASE)
    return place


@pytest.fixture(scope="module")
def plan(folder) -> Plan:
    return parse_plan(PLAN, folder=folder)


@pytest.fixture(scope="module")
@for_gate
def directory(plan: Plan, folder):
    assert not sweep.run(plan, folder / "out", Inline()).failed
    return folder / "out"


@pytest.fixture(scope="module")
def result(plan: Plan) -> Result:
    case = plan.case(plan.points[1])
    return fastpin.solve(case.problem, case.history, **case.options.keywords())


def test_rows_have_bars_of_key_figures_and_outcomes(plan: Plan, directory, result: Result) -> None:
    row, last = sweep.rows(plan, directory)[1], result[-1]
    for name in ("peak_pressure", "dx", "dissipation"):
        assert row[f"{name}_bar"] == last.error_bars[name]
    for name in ("peak_pressure_angle", "stick_width"):
        assert row[f"{name}_bar"] == math.degrees(last.error_bars[name])
    assert row["contact_start_bar"] == math.degrees(last.error_bars["contact_1_start"])
    assert row["stick_bar"] == row["stick_width_bar"]
    assert 0.0 < row["loss_bar"] < 0.1 * row["loss"]
    assert row["regime_bar"] == abs(result.coarse.cycle().regime - result.cycle().regime)
    loaded = next(each for each in sweep.load(directory) if each["id"] == row["id"])
    assert {name: loaded[name] for name in row if name.endswith("_bar")} == {
        name: value for name, value in row.items() if name.endswith("_bar")
    }


def test_bars_are_those_of_the_two_grids(result: Result) -> None:
    given = {
        "largest": {"quantity": "peak_pressure", "take": "largest"},
        "range": {"quantity": "dx", "take": "range", "over": "cycle"},
        "loss": {"cycle": "dissipation"},
        "place": {"cycle": "largest_slip_range_angle"},
        "own": own,
    }
    for name, outcome in outcomes_from(given).items():
        value, other = (value_of(outcome, each).value for each in (result, result.coarse))
        bar = bar_of(outcome, value, result)
        least = pair_bar(value, other, 1.0)
        assert bar == least if name == "own" else bar > least
        assert bar < max(1.2 * least, 0.05 * abs(value))
        assert bar_of(outcome, value, replace(result, coarse=None)) is None


def test_a_number_that_the_coarse_grid_lacks_has_an_unknown_bar(result: Result) -> None:
    def fine(each: Result) -> float | None:
        return 1.0 if each.grid.size == result.grid.size else None

    def broken(each: Result) -> float:
        return 1.0 / (each.grid.size == result.grid.size)

    for function in (fine, broken):
        assert bar_of(outcomes_from({"f": function})["f"], 1.0, result) == math.inf


@pytest.mark.parametrize(
    "name",
    ["dissipation", "regime", "shear_change", "rotation_change"]
    + [name for name in CYCLE_QUANTITIES if name.startswith("largest")],
)
def test_every_quantity_of_a_cycle_has_a_bar(name: str, result: Result) -> None:
    outcome = outcomes_from({"f": {"cycle": name}})["f"]
    value = value_of(outcome, result).value
    assert value is not None
    assert bar_of(outcome, value, result) >= 0.0


def test_later_outcomes_have_bars_from_the_stored_results(folder, directory, tmp_path) -> None:
    later, packed = parse_plan(LATER, folder=folder), tmp_path / "out"
    summary = sweep.run(later, packed, Inline())
    summary_later = sweep.run(later, directory, Inline())
    assert (summary.read, summary_later.ended, summary_later.read) == (0, 0, 4)
    bars = [[(row["swing_bar"], row["low_bar"]) for row in sweep.rows(later, each)] for each in (packed, directory)]
    assert bars[0] == bars[1]


def test_parts_keep_their_bars(plan: Plan, directory, tmp_path) -> None:
    parts = [tmp_path / "1", tmp_path / "2"]
    for k, part in enumerate(parts, start=1):
        sweep.run(plan, part, Inline(), shard=(k, 2))
    sweep.merge(parts, tmp_path / "whole")
    with Index(tmp_path / "whole") as one, Index(directory) as two:
        found = two.bars()
        assert one.bars() == {
            run: {n: b for n, b in each.items() if n not in ("swing", "low")} for run, each in found.items()
        }


def test_tables_and_files_show_bars(plan: Plan, directory, tmp_path) -> None:
    rows = sweep.rows(plan, directory)
    table = text(plan, rows)
    assert table.count("+-") == 4 * 4  # four outcomes, without the class
    path = tmp_path / "a.csv"
    write_csv(plan, rows, path)
    with path.open() as file:
        lines = list(csv.DictReader(line for line in file if not line.startswith("#")))
    thickness = 5e-3
    for line, row in zip(lines, rows, strict=True):
        assert float(line["stick_bar"]) == row["stick_bar"]
        assert float(line["loss_bar"]) == pytest.approx(thickness * row["loss_bar"])  # J
        assert float(line["peak_pressure_bar"]) == row["peak_pressure_bar"]
        assert "seconds_bar" not in line
    assert list(lines[0])[:5] == ["id", "contact.friction", "load.2.amplitude.Q", "regime", "regime_bar"]


def test_infinite_bars_and_other_classes_have_a_question_mark(plan: Plan, directory) -> None:
    rows = [row | {"stick_bar": math.inf, "regime_bar": 1.0} for row in sweep.rows(plan, directory)]
    table = text(plan, rows)
    assert table.count("+-?") == 4
    assert table.count("partial slip ?") == 4


def test_charts_have_bars_in_their_unit(plan: Plan, directory) -> None:
    rows = sweep.rows(plan, directory)
    found = chart(plan, rows, "peak")
    assert found.label == "peak (MPa)"
    assert found.bars[0].T.ravel() == pytest.approx([1e-6 * row["peak_bar"] for row in rows])
    assert chart(plan, rows, "seconds").bars == []
    bare = [{name: value for name, value in row.items() if not name.endswith("_bar")} for row in rows]
    assert chart(plan, bare, "peak").bars == []
    assert "+-" not in text(plan, bare)


def test_a_sweep_without_error_bars_has_none(tmp_path) -> None:
    plan = parse_plan(MOMENT)
    sweep.run(plan, tmp_path / "out", Inline())
    rows: list[dict[str, Any]] = [*sweep.rows(plan, tmp_path / "out"), *sweep.load(tmp_path / "out")]
    assert not any(name.endswith("_bar") for row in rows for name in row)


def test_error_bars_may_vary(folder) -> None:
    fields = '[grid]\n"solve.error_bars" = [true, false]\n'
    both = parse_plan(f'case = "case.toml"\n{fields}', folder=folder)
    assert len(both.runs) == 2
    sweep.run(both, folder / "both", Inline())
    one, other = sweep.rows(both, folder / "both")
    assert "dx_bar" in one
    assert "dx_bar" not in other
    assert one["peak_pressure"] == other["peak_pressure"]


def test_the_name_of_a_bar_is_no_outcome(folder, plan: Plan) -> None:
    words = "peak_bar: is the column of the error bar of peak; choose another name"
    for name in ("peak", "dx"):
        with pytest.raises(CaseFileError, match=words.replace("peak", name)):
            parse_plan(f'{PLAN}{name}_bar = {{ quantity = "dx" }}\n', folder=folder)
    with pytest.raises(InputError, match=words):
        plan.with_outcomes({"peak_bar": {"quantity": "dx"}})
    assert np.size(parse_plan(PLAN + 'crow_bar = { quantity = "dx" }\n', folder=folder).points) == 4


def test_a_damaged_bar_is_one_sentence(plan: Plan, directory, tmp_path) -> None:
    shutil.copytree(directory, tmp_path / "copy")
    with sqlite3.connect(tmp_path / "copy" / "index.sqlite") as database:
        database.execute("UPDATE bars SET bar = -1.0 WHERE name = 'dx'")
    database.close()
    with pytest.raises(InputError, match="is damaged: dx: must lie between 0 and inf, not -1"):
        sweep.rows(plan, tmp_path / "copy")

"""The commands ``sweep`` and ``merge``: what they print, their exit codes, their tables and figures."""

from __future__ import annotations

import csv
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

from fastpin.cli import sweep
from fastpin.cli.main import main
from fastpin.errors import InputError
from fastpin.figures import sweep
from fastpin.report import sweep
from fastpin.report.sweep import Axis, chart, check_axes
from fastpin.studies import sweep
from fastpin.studies.outcome import KEY_FIGURES
from fastpin.studies.plan import Plan
from tests.support.plans import FRICTION, MOMENT, Inline

MAP = """
[grid]
"contact.friction" = [0.2, 0.4]
"contact.clearance" = { from = 1e-6, to = 1e-4, count = 3, spacing = "log" }
[[list]]
"pin.material" = "steel"
[[list]]
"pin.E" = 1e11
"""


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A plan file in the working directory; its runs are made in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("fastpin.pool.through_processes", lambda workers, tasks, submit: inline(tasks, submit))
    (tmp_path / "moment.toml").write_text(MOMENT)
    return Path("moment.toml")


def inline(tasks: list[str], submit: Callable[..., Any]) -> Any:
    for task in tasks:
        yield task, submit(Inline(), task).result()


@pytest.fixture(scope="module")
def plan() -> Plan:
    return sweep.parse_plan(MAP)


@pytest.fixture
def rows(plan: Plan) -> list[dict[str, Any]]:
    """Made up: the value is 100 times the friction plus the place of the clearance; one failed, one waits."""
    rows = []
    for index, point in enumerate(plan.points):
        number = 100.0 * point.values["contact.friction"] + index % 3
        row = dict.fromkeys((*plan.fields, *KEY_FIGURES, "seconds", "started", "host")) | point.values
        row |= {"id": point.id, "status": "done", "reason": None, "dimensionless": 0}
        rows.append(row | {"peak_pressure": 1e6 * number, "contact_start": -number, "states": 3, "seconds": 0.1})
    rows[1] |= {"status": "failed", "reason": "lost, at last", "peak_pressure": None}
    rows[2] = {
        "id": rows[2]["id"],
        "status": "waiting",
        "reason": None,
        **dict.fromkeys(plan.fields),
        **plan.points[2].values,
    }
    return rows


# -- commands --------------------------------------------------------------------------------------------------


def test_a_sweep_says_what_was_done_and_what_failed(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(path), "--status"]) == 0
    out = capsys.readouterr().out
    assert out == "Moment that friction carries\n6 runs in moment: 0 done, 0 failed, 6 waiting\n"
    assert not Path("moment").exists()

    assert main(["sweep", str(path)]) == 1
    captured = capsys.readouterr()
    lines = captured.out.splitlines()
    assert lines[1].startswith("6 runs in moment: 4 done, 2 failed, 0 waiting; 6 in ")
    assert len([line for line in lines if line.startswith("failed: ") and "nothing holds the pin" in line]) == 2
    assert 'contact.pin_load = "centre", solve.nodes = 41, contact.friction = 0.1, load.2.M = 3000.0' in lines[2]
    assert captured.err == ""  # no progress bar: standard error is no terminal

    assert main(["sweep", str(path), "--status"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "6 runs in moment: 4 done, 2 failed, 0 waiting"
    assert main(["sweep", str(path)]) == 1
    assert "; 0 in " in capsys.readouterr().out
    assert main(["sweep", str(path), "--retry"]) == 1
    assert "; 2 in " in capsys.readouterr().out


def test_table_csv_and_figure_come_after_the_runs(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(path), "-o", "out", "--table", "--plot", "a.png"]) == 1
    captured = capsys.readouterr()
    assert "note: 2 of 6 points have no value in the figure" in captured.err
    table = captured.out.splitlines()[-8:]
    assert table[0].split()[:4] == ["run", "contact.pin_load", "solve.nodes", "contact.friction"]
    assert [line.split()[-1] for line in table[2:]] == ["done", "failed", "failed", "done", "done", "done"]
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")

    assert main(["sweep", str(path), "-o", "out", "--status", "--table", "a.csv"]) == 0
    lines = Path("a.csv").read_text().splitlines()
    assert lines[0].startswith("# fastpin ")
    assert "peak_pressure Pa, peak_pressure_angle deg" in lines[1]
    found = list(csv.DictReader(lines[2:]))
    known = {row["id"]: row for row in sweep.load("out")}
    assert [float(row["load.2.M"]) for row in found] == pytest.approx([1000.0, 3000.0, 9000.0] * 2)
    for row in found:
        assert row["status"] == known[row["id"]]["status"]
        if row["status"] == "done":
            assert float(row["peak_pressure"]) == known[row["id"]]["peak_pressure"]


def test_parts_are_merged(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for part in ("1/2", "2/2"):
        main(["sweep", str(path), "--shard", part, "-o", f"part{part[0]}"])
        assert "3 runs in part" in capsys.readouterr().out
    assert main(["merge", "part1", "part2", "-o", "whole"]) == 0
    assert capsys.readouterr().out == "6 runs in whole\n"
    assert main(["sweep", str(path), "--status", "-o", "whole"]) == 0
    assert "6 runs in whole: 4 done, 2 failed, 0 waiting" in capsys.readouterr().out


def test_points_that_share_a_run_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("[grid]\nplate.nu = [0.33, 0.330]\n")
    assert main(["sweep", str(path), "--status", "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    assert "1 runs in " in out
    assert "1 points of the plan have the same input as another and share its run" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--shard", "3/2"], "--shard: must be I/N with I from 1 to N, such as 1/8, not '3/2'"),
        (["--shard", "1"], "--shard: must be I/N"),
        (["--workers", "0"], "--workers: must be a whole number of at least 1, not 0"),
        (["--workers", "2", "--dask", "x"], "--workers: is for processes of this machine"),
        (["--x", "load.2.M"], "--x: says what a figure shows; --plot FILE is missing"),
        (["--plot", "a.xyz"], "--plot: the figure's name must end in .png, .pdf, .svg, not 'a.xyz'"),
        (["--plot", "a.png", "--value", "peak"], "--value: there is no key figure 'peak'"),
        (["--plot", "a.png", "--x", "contact.frict"], "--x: the plan does not vary 'contact.frict', did you mean"),
        (["--plot", "a.png", "--x", "contact.pin_load"], "--x: the values of contact.pin_load are not all numbers"),
        (["--plot", "none/a.png"], "the directory none does not exist"),
        (["--table", "moment.toml"], "--table: won't overwrite the plan moment.toml"),
        (["--dask", "tcp://127.0.0.1:9"], "--dask: there is no scheduler at tcp://127.0.0.1:9"),
        (["-o", "moment.toml"], "moment.toml: can't be made: File exists"),
    ],
)
def test_what_can_not_be_done_is_told_before_the_runs(
    arguments: list[str],
    words: str,
    path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sweep, "CLUSTER_SECONDS", 0.1)
    assert main(["sweep", str(path), *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert not Path("moment").exists()


def test_a_plan_with_faults_prints_them_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("[grid]\ncontact.friction = [-1]\nsolve.nodes = [1]\n")
    assert main(["sweep", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(": ")[1] for line in lines] == ["contact.friction", "solve.nodes"]
    assert all(line.startswith(f"{path}, line ") for line in lines)


def test_a_foreign_index_is_one_sentence(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("moment").mkdir()
    Path("moment/index.sqlite").write_text("mine" * 1000)
    for arguments in ([], ["--status"]):
        assert main(["sweep", str(path), *arguments]) == 2
        err = capsys.readouterr().err
        assert "index.sqlite: is no index of a sweep, or a damaged one" in err
        assert err.count("\n") == 1


def test_the_cluster_extra_is_asked_for(
    path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["sweep", str(path), "--dask", "tcp://x:1"]) == 2
    assert "pip install 'fastpin[cluster]'" in capsys.readouterr().err


def test_the_progress_bar_has_the_time_left(
    path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = []

    class Bar:
        n = total = 0

        def __enter__(self) -> Bar:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def update(self, more: int) -> None:
            self.n += more
            shown.append((self.n, self.total))

    def bar(total: int, text: str) -> Bar:
        assert "{n} of {total}" in text
        return Bar()

    monkeypatch.setattr(sweep, "bar", bar)
    main(["sweep", str(path)])
    assert shown == [(k, 6) for k in range(7)]


# -- figures ---------------------------------------------------------------------------------------------------


def test_axes_are_chosen(plan: Plan) -> None:
    others = ["pin.material", "pin.E"]
    assert check_axes(plan, "dx", None, None) == ("contact.friction", "contact.clearance", others)
    assert check_axes(plan, "dx", "contact.clearance", None) == (
        "contact.clearance",
        None,
        ["pin.material", "pin.E", "contact.friction"],
    )
    assert check_axes(plan, "dx", None, "contact.friction") == ("contact.clearance", "contact.friction", others)
    one = sweep.parse_plan(FRICTION.replace("COUNT", "3"))
    assert check_axes(one, "seconds", None, None) == ("contact.friction", None, [])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[grid]\npin.material = ["steel", "aluminium"]\n', "plot: a figure needs a field with several numbers"),
        (
            f"[grid]\nsolve.nodes = [41, 51]\nplate.nu = [0.1, 0.2]\nload.2.Q = {[[k, -k] for k in range(1, 20)]}\n",
            "plot: the figure would have 19 maps, at most 12 fit; choose other axes",
        ),
    ],
)
def test_figures_that_can_not_be(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_axes(sweep.parse_plan(text), "dx", None, None)


def test_numbers_of_a_map(plan: Plan, rows: list[dict[str, Any]]) -> None:
    found = chart(plan, rows, "peak_pressure")
    assert found.label == "peak pressure  [MPa]"
    assert found.missing == 2
    assert found.y is not None
    assert (found.x.label, found.x.log, found.x.values.tolist()) == ("contact.friction", False, [0.2, 0.4])
    assert (found.y.label, found.y.log) == ("contact.clearance  [um]", True)
    assert found.y.values == pytest.approx([1.0, 10.0, 100.0])
    (name, numbers, failed), (other, complete, none) = found.parts
    assert (name, other) == ('pin.material = "steel"', "pin.E = 1e+11")
    assert numbers == pytest.approx(np.array([[20.0, 40.0], [np.nan, 41.0], [np.nan, 42.0]]), nan_ok=True)
    assert complete == pytest.approx(np.array([[20.0, 40.0], [21.0, 41.0], [22.0, 42.0]]))
    assert failed.tolist() == [[False, False], [True, False], [False, False]]
    assert not none.any()


def test_numbers_of_curves(plan: Plan, rows: list[dict[str, Any]]) -> None:
    found = chart(plan, rows, "contact_start", "contact.clearance")
    assert found.label == "contact start  [deg]"
    assert found.y is None
    assert [name.splitlines()[-1] for name, _, _ in found.parts] == [
        "contact.friction = 0.2",
        "contact.friction = 0.4",
    ] * 2
    assert found.parts[3][1].tolist() == [-40.0, -41.0, -42.0]


def test_runs_with_different_units_have_none(plan: Plan, rows: list[dict[str, Any]]) -> None:
    rows[0]["dimensionless"] = 1
    assert chart(plan, rows, "peak_pressure").label == "peak pressure"


@pytest.mark.parametrize(
    ("values", "log", "edges"),
    [
        ([1.0, 2.0, 4.0], False, [0.5, 1.5, 3.0, 5.0]),
        ([1.0, 10.0, 100.0], True, [10**-0.5, 10**0.5, 10**1.5, 10**2.5]),
        ([3.0], False, [1.5, 4.5]),
        ([0.0], False, [-0.5, 0.5]),
    ],
)
def test_edges_of_cells(values: list[float], log: bool, edges: list[float]) -> None:
    assert sweep.cell_edges(Axis("", np.array(values), log)) == pytest.approx(edges)


def test_a_map_shows_every_value_and_hatches_failures(plan: Plan, rows: list[dict[str, Any]]) -> None:
    figure = sweep._draw_maps(chart(plan, rows, "peak_pressure"))
    maps, bar = figure.axes[:2], figure.axes[-1]
    mesh = maps[0].collections[0]
    assert np.ma.filled(mesh.get_array(), np.nan).ravel() == pytest.approx(
        [20, 40, np.nan, 41, np.nan, 42], nan_ok=True
    )
    assert [patch.get_hatch() for patch in maps[0].patches] == ["////", None]
    assert maps[0].patches[0].get_xy() == pytest.approx((0.1, 10**0.5))
    assert not list(maps[1].patches)
    assert maps[0].get_yscale() == "log"
    assert bar.get_ylabel() == "peak pressure  [MPa]"
    assert mesh.get_clim() == (20.0, 42.0)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["failed", "no value"]


def test_curves_have_gaps_and_crosses_where_runs_failed(plan: Plan, rows: list[dict[str, Any]]) -> None:
    figure = sweep._draw_curves(chart(plan, rows, "peak_pressure", "contact.clearance"))
    (panel,) = figure.axes
    curve, crosses = panel.lines[:2]
    assert curve.get_ydata() == pytest.approx([20.0, np.nan, np.nan], nan_ok=True)
    assert crosses.get_xdata() == pytest.approx([10.0])
    assert panel.get_xscale() == "log"
    assert panel.get_xlabel() == "contact.clearance  [um]"


@pytest.mark.parametrize("x", [None, "contact.clearance"])
def test_figures_are_saved_without_a_trace(
    plan: Plan, rows: list[dict[str, Any]], x: str | None, tmp_path: Path
) -> None:
    before = dict(mpl.rcParams)
    path = tmp_path / "a.pdf"
    sweep.plot_sweep(chart(plan, rows, "peak_pressure", x), path)
    assert path.read_bytes().startswith(b"%PDF")
    assert dict(mpl.rcParams) == before
    assert os.listdir(tmp_path) == ["a.pdf"]


def test_figures_without_any_value(plan: Plan, tmp_path: Path) -> None:
    for x in (None, "contact.friction"):
        sweep.plot_sweep(chart(plan, sweep.rows(plan, tmp_path), "dx", x), tmp_path / "a.png")


def test_long_tables_are_cut_in_the_middle() -> None:
    plan = sweep.parse_plan(FRICTION.replace("COUNT", "81"))
    text = sweep.text(plan, sweep.rows(plan, Path("nowhere")))
    assert len(text.splitlines()) == 43
    assert "41 more" in text


def test_a_printed_table_scales_its_units(plan: Plan, rows: list[dict[str, Any]]) -> None:
    names, unit, first, second, *_ = (line.split() for line in sweep.text(plan, rows).splitlines())
    assert names[:6] == ["run", "pin.material", "pin.E", "contact.friction", "contact.clearance", "peak"]
    assert unit[:3] == ["GPa", "um", "MPa"]
    assert first[1:6] == ["steel", "-", "0.2", "1", "20"]
    assert second[-1] == "failed"

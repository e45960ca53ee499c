"""Figures of sweeps: maps and curves, with their gaps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

from fastpin.figures import sweep as sweep_figure
from fastpin.figures.sweep import cell_edges, plot_sweep
from fastpin.report.sweep import Axis, chart
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, parse_plan
from tests.support.plans import MAP, made_up_rows


@pytest.fixture(scope="module")
def plan() -> Plan:
    return parse_plan(MAP)


@pytest.fixture
def rows(plan: Plan) -> list[dict[str, Any]]:
    return made_up_rows(plan)


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
    assert cell_edges(Axis("", np.array(values), log)) == pytest.approx(edges)


def test_a_map_shows_every_value_and_hatches_failures(plan: Plan, rows: list[dict[str, Any]]) -> None:
    figure = sweep_figure._draw_maps(chart(plan, rows, "peak_pressure"))
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
    figure = sweep_figure._draw_curves(chart(plan, rows, "peak_pressure", "contact.clearance"))
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
    plot_sweep(chart(plan, rows, "peak_pressure", x), path)
    assert path.read_bytes().startswith(b"%PDF")
    assert dict(mpl.rcParams) == before
    assert [file.name for file in tmp_path.iterdir()] == ["a.pdf"]


def test_figures_without_any_value(plan: Plan, tmp_path: Path) -> None:
    for x in (None, "contact.friction"):
        plot_sweep(chart(plan, sweep.rows(plan, tmp_path), "dx", x), tmp_path / "a.png")


@pytest.mark.parametrize(("value", "scale"), [(101.0, "log"), (99.0, "linear"), (-101.0, "linear")])
def test_values_that_span_two_decades_have_a_logarithmic_scale(
    value: float, scale: str, plan: Plan, rows: list[dict[str, Any]]
) -> None:
    known = [row for row in rows if row.get("peak_pressure")]
    largest = max(known, key=lambda row: row["peak_pressure"])
    for row in known:
        row["peak_pressure"] = 1.0
    largest["peak_pressure"] = value
    figure = sweep_figure._draw_maps(chart(plan, rows, "peak_pressure"))
    assert isinstance(figure.axes[0].collections[0].norm, mpl.colors.LogNorm) == (scale == "log")
    curves = sweep_figure._draw_curves(chart(plan, rows, "peak_pressure", "contact.clearance"))
    assert curves.axes[0].get_yscale() == scale

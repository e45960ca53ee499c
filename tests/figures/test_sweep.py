"""Figures of sweeps: maps and curves, with their gaps."""

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures import sweep as sweep_figure
from fastpin.figures.style import MAX_NAMED
from fastpin.figures.sweep import CLASS_LOOKS, cell_edges, plot_sweep, sweeps_of
from fastpin.report.sweep import Axis, Chart, chart
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, parse_plan
from tests.support.drawing import legend_words
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


@pytest.mark.gate
def test_a_map_shows_every_value_and_hatches_failures(plan: Plan, rows: list[dict[str, Any]]) -> None:
    figure = plot_sweep(chart(plan, rows, "peak_pressure"))
    maps, bar = figure.axes[:2], figure.axes[-1]
    mesh = maps[0].collections[0]
    shown = np.ma.filled(mesh.get_array(), np.nan).ravel()
    assert shown == pytest.approx([20, 40, np.nan, 41, np.nan, 42], nan_ok=True)
    assert [patch.get_hatch() for patch in maps[0].patches] == ["////", None]
    assert maps[0].patches[0].get_xy() == pytest.approx((0.1, 10**0.5))
    assert not list(maps[1].patches)
    assert maps[0].get_yscale() == "log"
    assert bar.get_ylabel() == "peak pressure (MPa)"
    assert mesh.get_clim() == (20.0, 42.0)
    assert legend_words(figure) == ["failed run", "no value"]


def test_curves_have_gaps_and_crosses_where_runs_failed(plan: Plan, rows: list[dict[str, Any]]) -> None:
    figure = plot_sweep(chart(plan, rows, "peak_pressure", "contact.clearance"))
    (panel,) = figure.axes
    curve, crosses = panel.lines[:2]
    assert curve.get_ydata() == pytest.approx([20.0, np.nan, np.nan], nan_ok=True)
    assert crosses.get_xdata() == pytest.approx([10.0])
    assert panel.get_xscale() == "log"
    assert panel.get_xlabel() == "clearance (µm)"
    names = legend_words(figure)
    assert names[0] == "material of the pin = steel, friction coefficient = 0.2"
    assert names[-1] == "failed run"


@pytest.mark.gate
@pytest.mark.parametrize("x", [None, "contact.clearance"])
def test_figures_are_saved_without_a_trace(plan, rows, x, tmp_path):
    before = dict(mpl.rcParams)
    path = tmp_path / "a.pdf"
    plot_sweep(chart(plan, rows, "peak_pressure", x), path)
    assert path.read_bytes().startswith(b"%PDF")
    assert dict(mpl.rcParams) == before
    assert [file.name for file in tmp_path.iterdir()] == ["a.pdf"]


@pytest.mark.gate
def test_figures_without_any_value(plan: Plan, tmp_path: Path) -> None:
    for x in (None, "contact.friction"):
        plot_sweep(chart(plan, sweep.rows(plan, tmp_path), "dx", x), tmp_path / "a.png")


@pytest.mark.gate
@pytest.mark.parametrize(("value", "scale"), [(31.0, "log"), (29.0, "linear"), (-31.0, "linear")])
def test_values_that_span_decades_have_a_logarithmic_scale(value, scale, plan, rows):
    known = [row for row in rows if row.get("peak_pressure")]
    largest = max(known, key=lambda row: row["peak_pressure"])
    for row in known:
        row["peak_pressure"] = 1.0
    largest["peak_pressure"] = value
    figure = plot_sweep(chart(plan, rows, "peak_pressure"))
    assert isinstance(figure.axes[0].collections[0].norm, mpl.colors.LogNorm) == (scale == "log")
    curves = plot_sweep(chart(plan, rows, "peak_pressure", "contact.clearance"))
    assert curves.axes[0].get_yscale() == scale


@pytest.mark.gate
def test_parameters_that_do_not_vary_are_in_the_caption(plan: Plan, rows: list[dict[str, Any]]) -> None:
    found = chart(plan, rows, "peak_pressure")
    assert found.varied == ("pin.material", "pin.E", "contact.friction", "contact.clearance")
    assert sweep_figure._fixed_parameters(found) == "plane strain, hole radius 10\N{NO-BREAK SPACE}mm"
    text = sweep_figure._fixed_parameters(replace(found, varied=("contact.clearance", "load.1.P")))
    assert text.startswith("pin: steel, body force; plate: E = 69\N{NO-BREAK SPACE}GPa, ν = 0.33; plane strain")
    assert "friction coefficient 0.2, hole radius" in text
    assert "clearance" not in text
    assert "hole radius 10" in plot_sweep(found).get_suptitle()


@pytest.fixture
def smooth() -> Chart:
    """A map with 5 x 4 cells, one of them empty."""
    x, y = (
        Axis("friction coefficient", np.linspace(0.1, 0.9, 5), False),
        Axis("clearance (um)", np.geomspace(1, 8, 4), True),
    )
    numbers = 10.0 + 100.0 * x.values + 5.0 * np.log2(y.values)[:, None]
    numbers[0, 0] = np.nan
    return Chart("a map", "peak pressure (MPa)", x, y, [("", numbers, np.isnan(numbers))], 1)


def test_contours_join_equal_values(smooth: Chart) -> None:
    figure = plot_sweep(smooth)
    lines = figure.axes[0].collections[1]
    numbers = smooth.parts[0][1]
    assert len(lines.levels) >= 4
    assert np.all((lines.levels > np.nanmin(numbers)) & (lines.levels < np.nanmax(numbers)))
    assert np.all(lines.levels % 5.0 == 0.0)
    for level, path in zip(lines.levels, lines.get_paths(), strict=True):
        friction, clearance = path.vertices.T
        assert 10.0 + 100.0 * friction + 5.0 * np.log2(clearance) == pytest.approx(level, abs=2.0)


@pytest.mark.gate
def test_contours_of_decades_stand_at_powers_of_ten(smooth: Chart) -> None:
    name, numbers, failed = smooth.parts[0]
    figure = plot_sweep(replace(smooth, parts=[(name, 10.0 ** (numbers / 20.0), failed)]))
    assert set(np.round(np.log10(figure.axes[0].collections[1].levels) % 1.0, 6)) <= {0.0, 0.477121}
    assert figure.axes[1].get_yscale() == "log"


@pytest.mark.gate
def test_numbers_of_logarithmic_axes_are_plain(smooth: Chart) -> None:
    figure = plot_sweep(smooth)
    figure.draw_without_rendering()
    shown = [label.get_text() for label in figure.axes[0].get_yticklabels()]
    assert {"1", "2", "5"} <= set(shown)
    assert figure.axes[0].get_ylabel() == "clearance (µm)"


def test_a_given_axes_holds_one_map_or_curves(smooth: Chart, plan: Plan, rows: list[dict[str, Any]]) -> None:
    host = Figure()
    left, right = host.subplots(1, 2)
    assert plot_sweep(smooth, ax=left) is host
    assert left.get_title() == "a map"
    curves = chart(plan, rows, "peak_pressure", "contact.clearance")
    assert plot_sweep(curves, ax=right) is host
    assert len(right.get_legend().get_texts()) == 5
    with pytest.raises(InputError, match="ax: holds one map, but the chart has 2"):
        plot_sweep(chart(plan, rows, "peak_pressure"), ax=left)


def test_no_more_curves_than_can_be_told_apart() -> None:
    x = Axis("friction coefficient", np.array([0.1, 0.2]), False)
    parts = [(f"force P in load 1 = {k} N", np.array([1.0, 2.0]) * k, np.zeros(2, bool)) for k in range(12)]
    figure = plot_sweep(Chart("", "dx (m)", x, None, parts, 0))
    drawn = [one for one in figure.axes[0].lines if len(one.get_xdata()) == 2]
    assert len(drawn) == MAX_NAMED
    looks = {(one.get_color(), str(one._dash_pattern), one.get_marker()) for one in drawn}
    assert len(looks) == len(drawn) == len({one.get_marker() for one in drawn})
    assert figure.legends[0].get_title().get_text() == "8 of 12 curves"
    names = set(legend_words(figure))
    assert {"force P in load 1 = 0 N", "force P in load 1 = 11 N"} <= names


# -- classes and labels --------------------------------------------------------------------------------------

CLASSES = {0: "none", 1: "a part", 2: "all"}


def class_chart(numbers: Any, failed: Any = None) -> Chart:
    """A map of classes over two fields."""
    values = np.array(numbers, dtype=float)
    marks = np.zeros(values.shape, dtype=bool) if failed is None else np.array(failed)
    rows, columns = values.shape
    x, y = Axis("x", np.arange(columns) + 1.0, False), Axis("y", np.arange(rows) + 1.0, False)
    return Chart("Title", "regime", x, y, [("", values, marks)], 0, classes=CLASSES)


def test_a_map_of_classes_has_names_and_one_line_between_two_classes() -> None:
    figure = plot_sweep(class_chart([[0, 0, 1], [0, 1, 1], [2, 1, 1]]))
    (panel,) = figure.axes  # no bar of colours
    fills = [shape for shape in panel.collections if isinstance(shape, PolyCollection)]
    assert sorted(len(shape.get_paths()) for shape in fills if len(shape.get_facecolor())) == [1, 3, 5]
    (borders,) = (shape for shape in panel.collections if isinstance(shape, LineCollection))
    sides = sorted(tuple(map(tuple, side)) for side in borders.get_segments())
    assert len(sides) == 5
    assert ((0.5, 2.5), (1.5, 2.5)) in sides  # between 0 and 2, one line, and no line of a third class
    assert not panel.texts  # no labels of contours
    assert legend_words(figure) == ["none", "a part", "all"]


def test_classes_differ_in_grey_or_by_their_hatches() -> None:
    colours = (to_rgb(colour) for colour, _ in CLASS_LOOKS)
    greys = [0.299 * red + 0.587 * green + 0.114 * blue for red, green, blue in colours]
    for one, other in itertools.combinations(range(len(CLASS_LOOKS)), 2):
        assert CLASS_LOOKS[one][1] != CLASS_LOOKS[other][1] or abs(greys[one] - greys[other]) > 0.3


def test_absent_classes_are_not_in_the_legend_but_failures_are() -> None:
    figure = plot_sweep(class_chart([[0, np.nan], [1, np.nan]], [[False, True], [False, False]]))
    assert legend_words(figure) == ["none", "a part", "failed run", "no value"]
    (borders,) = (shape for shape in figure.axes[0].collections if isinstance(shape, LineCollection))
    assert len(borders.get_segments()) == 1  # no line towards a cell without a value


def test_curves_of_classes_have_names_on_their_axis() -> None:
    part = ("", np.array([0.0, 1.0, 2.0]), np.zeros(3, bool))
    curve = Chart("", "regime", Axis("x", np.arange(3.0), False), None, [part], 0, classes=CLASSES)
    panel = plot_sweep(curve).axes[0]
    assert [tick.get_text() for tick in panel.get_yticklabels()] == ["none", "a part", "all"]


@pytest.mark.gate
def test_labels_of_contour_lines_do_not_overlap() -> None:
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 30), np.linspace(0.0, 1.0, 30))
    steep = 100.0 / (1.0 + np.exp(-60.0 * (x - 0.5))) + 5.0 * y  # all lines in a narrow band
    axes = [Axis(name, np.arange(30.0), False) for name in "xy"]
    figure = plot_sweep(Chart("", "value", *axes, [("", steep, np.zeros(steep.shape, bool))], 0))
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    assert boxes
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


@pytest.mark.gate
def test_titles_of_maps_do_not_run_into_one_another() -> None:
    axes = [Axis(name, np.arange(2.0), False) for name in "xy"]
    name = "amplitude of the cyclic force across the lug = 2 kN\nforce of the first load along its axis = 10 kN"
    part = name, np.arange(4.0).reshape(2, 2), np.zeros((2, 2), bool)
    figure = plot_sweep(Chart("", "value", *axes, [part] * 3, 0))
    figure.draw_without_rendering()
    boxes = [panel.title.get_window_extent() for panel in figure.axes]
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


# -- error bars --------------------------------------------------------------------------------------------------


def test_curves_have_error_bars() -> None:
    numbers, bars = np.array([1.0, 2.0, 4.0, np.nan]), np.array([0.1, np.inf, 0.5, np.nan])
    part = ("", numbers, np.isnan(numbers))
    drawn = Chart("", "dx (m)", Axis("x", np.arange(4.0), False), None, [part], 1, bars=[bars])
    figure = plot_sweep(drawn)
    (collection,) = figure.axes[0].collections
    segments = [[round(float(y), 9) for y in segment[:, 1]] for segment in collection.get_segments()]
    assert segments == [[0.9, 1.1], [3.5, 4.5]]  # an infinite bar has no ends
    assert dots(figure) == [(1.0, 2.0)]  # and an open point in their place
    assert legend_words(figure) == ["error not known", "failed run"]
    assert "largest error bar: 0.5 m, 17 % of the range; not known in 1 runs" in figure.get_suptitle()


@pytest.mark.gate
def test_a_map_marks_cells_whose_bar_hides_the_differences(smooth: Chart) -> None:
    numbers = smooth.parts[0][1]
    bars = np.full(numbers.shape, 1e-6)
    plain, marked = plot_sweep(replace(smooth, bars=[bars])), bars.copy()
    steps = [abs(numbers[1, 1] - each) for each in (numbers[0, 1], numbers[2, 1], numbers[1, 0], numbers[1, 2])]
    marked[1, 1] = 1.01 * max(steps)
    unsure = plot_sweep(replace(smooth, bars=[marked]))
    assert dots(plain) == []
    assert dots(unsure) == [(smooth.x.values[1], smooth.y.values[1])]
    marked[1, 1] = 0.99 * max(steps)
    assert dots(plot_sweep(replace(smooth, bars=[marked]))) == []
    assert legend_words(unsure)[-1] == "error bar not known, or above the differences to all sides"
    assert "largest error bar" in unsure.get_suptitle()
    assert "largest error bar" not in (plot_sweep(smooth).get_suptitle() or "")


def test_a_map_marks_cells_whose_bar_is_not_known(smooth: Chart) -> None:
    """Also a cell without neighbours; no other cell has a bar."""
    numbers = smooth.parts[0][1].copy()
    bars = np.full(numbers.shape, np.nan)
    bars[0, 0], bars[1, 1] = np.inf, np.inf
    numbers[0, 0], numbers[0, 1], numbers[1, 0] = 1.0, np.nan, np.nan
    figure = plot_sweep(replace(smooth, bars=[bars], parts=[("", numbers, np.zeros(numbers.shape, bool))]))
    x, y = smooth.x.values, smooth.y.values
    assert dots(figure) == [(x[0], y[0]), (x[1], y[1])]
    assert "not resolved by the nodes: 2 runs" in figure.get_suptitle()


def test_a_map_of_classes_marks_those_that_the_coarse_grid_does_not_find() -> None:
    drawn = class_chart([[1.0, 1.0], [2.0, 0.0]])
    figure = plot_sweep(replace(drawn, bars=[np.array([[0.0, 1.0], [0.0, np.nan]])]))
    assert dots(figure) == [(drawn.x.values[1], drawn.y.values[0])]
    assert "another class on the coarse grid: 1 of 3 runs" in figure.get_suptitle()


def dots(figure: Figure) -> list[tuple[float, float]]:
    """The places of the dots of a map."""
    lines = [line for line in figure.axes[0].lines if line.get_markerfacecolor() == "white"]
    return [place for line in lines for place in zip(line.get_xdata(), line.get_ydata(), strict=True)]


@pytest.mark.gate
def test_charts_side_by_side_say_what_each_shows(plan: Plan, rows: list[dict[str, Any]]) -> None:
    charts = [chart(plan, rows, name) for name in ("peak_pressure", "stick_width")]
    one = [replace(each, parts=each.parts[:1]) for each in charts]
    figure = plot_sweep(one)
    titles = [panel.get_title() for panel in figure.axes if panel.get_title()]
    assert [title.splitlines()[0] for title in titles] == ["peak pressure (MPa)", "stick width (deg)"]
    plot = sweeps_of(one)
    assert plot.caption.startswith("Peak pressure (MPa), stick width (deg) over ")
    assert plot.instead.startswith("Maps of peak pressure (MPa), stick width (deg) over ")
    with pytest.raises(InputError, match=r"chart: peak pressure \(MPa\) has 2 maps; side by side each chart has one"):
        plot_sweep(charts)
    with pytest.raises(InputError, match="ax: holds one chart; give a list of charts no axes"):
        plot_sweep(one, ax=figure.axes[0])


@pytest.mark.gate
def test_several_charts_stand_side_by_side(smooth: Chart, plan: Plan, rows: list[dict[str, Any]]) -> None:
    given = chart(plan, rows, "peak_pressure", "contact.clearance")
    curves = replace(given, parts=[(f"P = {k}", *part[1:]) for k, part in enumerate(given.parts)])
    named = replace(smooth, label="depth (um)", title="Both")
    figure = plot_sweep([named, curves, replace(named, label="volume (m^2)")])
    titles = {"depth (µm)", "volume (m²)"}
    panels = {panel.get_title(): panel for panel in figure.axes if panel.get_title()}
    assert titles <= set(panels)
    assert len(panels) == 3
    assert not titles & {panel.get_ylabel() for panel in figure.axes}  # the bar of colours repeats no title
    assert figure.get_suptitle() == "Both"
    (legend,) = [legend for panel in figure.axes if (legend := panel.get_legend()) and len(legend.get_texts()) > 2]
    names = [*(name for name, _, _ in curves.parts), "failed run"]
    assert [text.get_text() for text in legend.get_texts()] == names[::2] + names[1::2]  # two columns, to read by rows


def test_what_does_not_fit_side_by_side_is_told(smooth: Chart, plan: Plan, rows: list[dict[str, Any]]) -> None:
    maps = chart(plan, rows, "peak_pressure")
    with pytest.raises(InputError, match="has 2 maps; side by side each chart has one"):
        plot_sweep([smooth, maps])
    with pytest.raises(InputError, match="ax: holds one chart"):
        plot_sweep([smooth, smooth], ax=Figure().subplots())
    with pytest.raises(InputError, match="chart: must be"):
        plot_sweep([smooth, "depth"])  # type: ignore[list-item]


@pytest.mark.parametrize(
    ("values", "written"),
    [
        ([0.0, -0.5, 30000.0], ["0", "−0.5", "30000"]),
        ([3e4, 1e5, 3e5], [r"$3\times10^{4}$", "$10^{5}$", r"$3\times10^{5}$"]),
        ([1e-11, 2.5e-3], ["$10^{-11}$", r"$2.5\times10^{-3}$"]),
    ],
)
def test_round_numbers_are_written_in_full_or_all_as_powers_of_ten(values: list[float], written: list[str]) -> None:
    words = sweep_figure._in_round_numbers(np.array(values))
    assert [words(value) for value in values] == written


def test_lives_that_do_not_end_are_arrows_on_the_whole_axis() -> None:
    """The axis has all values, and lives have a logarithmic scale."""
    x, lives = Axis("amplitude (µm)", np.array([12.0, 16.0, 20.0, 24.0, 28.0]), False), np.array([1, 3, 2, 1, 1]) * 1e6
    lives[:2] = np.nan
    ends, failed = np.array([True, False, False, False, False]), np.array([False, True, False, False, False])
    (panel,) = (
        figure := plot_sweep(Chart("", "life (cycles)", x, None, [("", lives, failed)], 2, endless=[ends]))
    ).axes
    arrows = next(each for each in panel.lines if "arrow" in str(each.get_marker()))
    assert arrows.get_xdata() == pytest.approx([12.0])
    assert panel.get_yscale() == "log"
    assert panel.get_xlim()[0] < 12.0 < 28.0 < panel.get_xlim()[1]
    assert legend_words(figure) == ["life does not end", "failed run"]


def test_a_map_without_any_value_has_no_bar_of_colours() -> None:
    axes = Axis("x", np.arange(3.0), False), Axis("y", np.arange(2.0), False)
    none = np.full((2, 3), np.nan)
    figure = plot_sweep(Chart("", "life (cycles)", *axes, [("", none, np.zeros((2, 3), dtype=bool))], 6))
    assert len(figure.axes) == 1
    assert legend_words(figure) == ["no value"]

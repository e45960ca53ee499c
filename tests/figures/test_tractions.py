"""Figures: what is drawn, where, and that none of the kinds of results breaks it."""

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from fastpin import InputError, Problem, Result, plot_cycles, plot_tractions, solve
from fastpin.bodies.bushing import STUCK
from fastpin.figures import plot_hoop_stress, plot_sketch, plot_stick_slip
from fastpin.figures.states import drawn_states
from fastpin.figures.style import COLOURS, DASHES, MAX_NAMED, Drawing, caption, spread
from fastpin.figures.tractions import traction_curves
from fastpin.states.cycles import Cycle
from tests.support.common_sizes import bushed
from tests.support.drawing import legend_words, plain
from tests.support.samples import PAIR, sample_result, with_values
from tests.support.tiers import gate


def curves(panel: mpl.axes.Axes, thicker_than: float = 0.8) -> list[np.ndarray]:
    return [line.get_xydata() for line in panel.lines if len(line.get_xdata()) > 2 and line.get_lw() > thicker_than]


@pytest.mark.gate
def test_a_bonded_seat_has_no_bounds_of_its_shear() -> None:
    """A pin in a hole with as much friction is not bonded."""
    result = solve(bushed(9e-3, 11e-3, any_outline=True), [{"P": 1e6}, {"P": 5e5}], nodes=61)
    states = [state.seat for state in result]
    panels = plot_tractions(states)
    assert "thin: bounds ±μN of T" not in legend_words(panels)
    assert panels.axes[1].get_ylim()[1] < 100.0
    assert caption(states[0].problem).count("bonded") == 1
    rough = replace(sample_result().problem, friction=STUCK)
    assert "bonded" not in caption(rough)
    assert "thin: bounds ±μN of T" in legend_words(plot_tractions(solve(rough, [{"P": 2e6}], nodes=61)))


def test_tractions_are_drawn_in_degrees_from_the_bottom_and_in_megapascal() -> None:
    result = sample_result()
    pressure, shear, zones = plot_tractions(result).axes
    assert len(curves(pressure)) == len(curves(shear)) == len(result)
    for state, line in zip(result, curves(pressure), strict=True):
        at_nodes = np.interp(np.degrees(state.theta) + 90.0, line[:, 0], line[:, 1], left=0.0, right=0.0)
        assert np.allclose(at_nodes, state.pressure / 1e6, atol=3.0)  # 2.1: these roots have another exponent than fits
        assert np.max(line[:, 1]) == pytest.approx(100.0, rel=1e-3)
    assert pressure.get_ylabel() == "pressure N (MPa)"
    assert shear.get_ylabel() == "shear traction T (MPa)"
    assert zones.get_xlabel() == "angle from the bottom of the hole, counter-clockwise (deg)"


@pytest.mark.parametrize("half", [*gate(0.02, 0.3), 1.0, 1.4])
def test_both_ends_of_the_axis_of_angles_have_numbers(half: float) -> None:
    result = sample_result(nodes=401)
    away = np.abs(result[0].theta + 0.5 * np.pi)
    pressure = 1e8 * np.sqrt(np.maximum(1.0 - (away / half) ** 2, 0.0))
    status = np.where(pressure > 0.0, 0, 2)
    result.states = [with_values(state, pressure=pressure, shear=0.0, status=status) for state in result]
    for panel, axis in ((plot_tractions(result).axes[-1], "x"), (plot_stick_slip(result).axes[-1], "y")):
        low, high = getattr(panel, f"get_{axis}lim")()
        ticks = [tick for tick in getattr(panel, f"get_{axis}ticks")() if low - 1e-6 <= tick <= high + 1e-6]
        assert (ticks[0], ticks[-1]) == pytest.approx((low, high))
        assert 4 <= len(ticks) <= 14
        assert low < -np.degrees(half) < np.degrees(half) < high
    panels = plot_tractions(result).axes
    assert len({panel.get_xlim() for panel in panels}) == 1


def test_curves_end_at_the_edges_like_a_square_root() -> None:
    state = sample_result()[0]
    (line,) = curves(plot_tractions(state).axes[0])
    first, last = np.degrees(state.contact[0]) + 90.0
    assert line[0] == pytest.approx((first, 0.0), abs=1e-9)
    assert line[-1] == pytest.approx((last, 0.0), abs=1e-9)
    spacing = np.degrees(state.theta[1] - state.theta[0])
    near = line[(line[:, 0] > first) & (line[:, 0] < first + spacing)]
    assert len(near) > 20  # the points gather between the edge and the first node
    rise = near[:, 1] / np.sqrt(near[:, 0] - first)
    assert np.ptp(rise) < 0.15 * rise.mean()  # 0.12; the exponent is 0.48. A straight line has more than 2.
    wide = np.diff(line[:, 0])
    assert wide.max() <= 0.5 + 1e-9


def test_shear_lies_within_its_drawn_bounds() -> None:
    _, shear, _ = plot_tractions(sample_result()).axes
    bounds = [line.get_xydata() for line in shear.lines if len(line.get_xdata()) > 2 and line.get_lw() < 0.8]
    assert len(bounds) == 2 * len(curves(shear))
    upper, line = bounds[0], curves(shear)[0]
    inside = np.isfinite(upper[:, 1])
    assert inside.any()
    assert np.all(np.abs(line[inside, 1]) <= upper[inside, 1] + 1e-12)


def test_legend_names_what_differs_and_the_title_what_does_not() -> None:
    figure = plot_tractions(sample_result(), title="A case")
    assert legend_words(figure)[:3] == ["1:  Q = 0", "2:  Q = +0.484 MN/m", "3:  Q = −0.484 MN/m"]
    assert figure.legends[0].get_title().get_text() == "load point:  loads there"
    assert figure.get_suptitle() == "A case\nP = 2.42 MN/m"
    caption = plain(figure.axes[0].get_title())
    parts = "pin: Ti-6Al-4V", "plate: aluminium", "friction coefficient 0.4", "clearance 20 µm", "load parameter "
    assert [part for part in parts if part not in caption] == []


def test_numbers_in_captions_are_rounded_and_rounding_is_zero() -> None:
    figure = plot_tractions(sample_result([{"P": 1e6, "Q": 1e-7}, {"P": 2e6, "Q": 2e-7}], friction=0.2444444))
    assert "friction coefficient 0.244," in figure.axes[0].get_title().replace("\n", " ")
    assert legend_words(figure)[:2] == ["1:  P = 1 MN/m,  Q = 0", "2:  P = 2 MN/m,  Q = 0"]


@pytest.mark.gate
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6])
def test_legend_lies_within_the_figure(count: int) -> None:
    corners = [{"P": 1e6 + k, "Q": 1.234e5 * k, "sxx": 1.234e7 * k} for k in range(count)]
    figure = plot_tractions(sample_result(corners))
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width
    assert 0.0 <= box.y0 < box.y1 < figure.axes[-1].get_window_extent().y0


def test_zones_of_each_state() -> None:
    result = sample_result()
    panel = plot_tractions(result).axes[-1]
    bars = sorted((bar.get_y(), bar.get_x(), bar.get_width()) for bar in panel.patches)
    expected = sum(len(state.stick) + len(state.slip_zones) for state in result)
    assert len(bars) == expected
    start, stop = result[0].stick[0]
    assert any(np.allclose(bar[1:], (np.degrees(start) + 90, np.degrees(stop - start)), atol=1e-6) for bar in bars)
    assert [label.get_text() for label in panel.get_yticklabels()] == ["1", "2", "3"]


def test_an_arrow_points_at_a_slip_zone_that_is_too_narrow_to_be_seen() -> None:
    result = sample_result(nodes=401)
    state = result[0]
    status, shear = np.where(state.status != 2, 0, 2), np.zeros(state.shear.size)
    first = np.flatnonzero(status != 2)[:2]
    status[first], shear[first] = 1, 0.4 * state.pressure[first]
    result.states[0] = state = with_values(state, status=status, shear=shear)
    (narrow,) = state.slip_zones
    assert np.degrees(narrow[1] - narrow[0]) < 3.0
    panel = plot_tractions(result).axes[-1]
    arrows = [text for text in panel.texts if text.get_text() and text.xy[1] < 0.0 and text.arrow_patch is not None]
    assert [text.get_text() for text in arrows] == ["→"]
    assert narrow[0] < np.radians(arrows[0].xy[0] - 90.0) < narrow[1]


def test_one_state_is_shaded_where_it_slips() -> None:
    figure = plot_tractions(sample_result()[0])
    assert len(figure.axes) == 2
    assert all(len(panel.patches) == 2 for panel in figure.axes)
    assert "slip" in legend_words(figure)


def test_without_friction_there_is_no_shear_panel() -> None:
    figure = plot_tractions(sample_result(friction=0.0))
    assert [panel.get_ylabel().split()[0] for panel in figure.axes] == ["pressure"]


def test_dimensionless_units() -> None:
    figure = plot_tractions(sample_result([{"P": 1.0}], problem=Problem.from_load_parameter(PAIR, 0.1, 0.4)))
    assert "F/R" in figure.axes[0].get_ylabel()


@pytest.mark.gate
def test_many_states_are_thinned_to_curves_that_can_be_told_apart() -> None:
    result = sample_result([{"P": 1e6 * (k + 1)} for k in range(50)])
    figure = plot_tractions(result)
    assert len(curves(figure.axes[0])) == MAX_NAMED == 8
    assert "8 of 50 states drawn" in figure.axes[0].get_title()
    words = "8 of 50 states: load points 1, 2, 11, 21, 30, 40, 49, 50"  # extremes at 2 and 49
    assert drawn_states(result).note == words
    assert len({line.get_color() for line in figure.axes[0].lines}) == MAX_NAMED
    assert len(set(COLOURS)) == len(set(DASHES)) == MAX_NAMED
    chosen = plot_tractions(result, states=[2, 50])
    assert legend_words(chosen)[:2] == ["2:  P = 2 MN/m", "50:  P = 50 MN/m"]
    assert legend_words(plot_tractions(result, states="last")) == legend_words(plot_tractions(result[-1]))


def test_axes_of_the_caller() -> None:
    figure = mpl.figure.Figure(figsize=(8.0, 6.0))
    left, right = figure.subplots(1, 2)
    assert plot_tractions(sample_result(), ax=left) is figure
    assert len(left.child_axes) == 3
    assert not right.lines
    assert "pressure" in left.child_axes[0].get_ylabel()
    plot_tractions(sample_result(friction=0.0), ax=right)
    assert len(curves(right)) == 3
    assert right.get_ylabel() == "pressure N (MPa)"
    assert right.get_legend() is not None
    with pytest.raises(InputError, match="ax: must be axes of Matplotlib"):
        plot_tractions(sample_result(), ax=figure)


@pytest.mark.gate
def test_notebooks_show_a_figure_without_pyplot() -> None:
    assert plot_tractions(sample_result())._repr_png_().startswith(b"\x89PNG")
    for plot in (plot_stick_slip, plot_sketch, plot_hoop_stress):
        assert isinstance(plot(sample_result()), Drawing)


@pytest.mark.parametrize("centre", [-0.5 * np.pi, 0.0, 0.5 * np.pi, 0.75 * np.pi])
def test_a_contact_across_the_seam_of_the_circle_is_drawn_in_one_piece(centre: float) -> None:
    result = sample_result(closed=True, centre=centre, nodes=120)
    figure = plot_tractions(result)
    line = curves(figure.axes[0])[0]
    drawn = np.flatnonzero(np.isfinite(line[:, 1]))
    assert np.all(np.diff(drawn) == 1)
    assert np.all(np.diff(line[:, 0]) > 0.0)
    low, high = figure.axes[0].get_xlim()
    assert low < line[drawn[0], 0]
    assert line[drawn[-1], 0] < high
    middle = line[np.nanargmax(line[:, 1]), 0]
    assert (middle - np.degrees(centre) - 90.0) % 360.0 == pytest.approx(0.0, abs=3.1) or middle % 360 > 356.0
    assert len(figure.axes[-1].patches) == 9  # stick and two slip zones of each state, none cut or lost


def test_contact_all_round() -> None:
    result = sample_result([{"P": 1e6}, {"Q": 1e5}], closed=True, nodes=60)
    result.states = [with_values(state, pressure=1e8, status=0) for state in result]
    figure = plot_tractions(result)
    low, high = figure.axes[0].get_xlim()
    assert high - low == pytest.approx(360.0)


@pytest.mark.gate
def test_states_without_contact(tmp_path: Path) -> None:
    result = sample_result()
    result.states = [with_values(state, pressure=0.0, shear=0.0, status=2) for state in result]
    plot_tractions(result, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 0


@pytest.mark.gate
@pytest.mark.parametrize(("suffix", "magic"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_formats(suffix: str, magic: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"a.{suffix}"
    plot_tractions(sample_result(), path)
    assert path.read_bytes().startswith(magic)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.gate
def test_print_quality(tmp_path: Path) -> None:
    figure = plot_tractions(sample_result(), tmp_path / "a.svg")
    assert "<text" not in (tmp_path / "a.svg").read_text(encoding="utf-8")  # letters are paths
    plot_tractions(sample_result(), tmp_path / "a.pdf")
    figure.savefig(tmp_path / "later.pdf")
    for name in ("a.pdf", "later.pdf"):
        content = (tmp_path / name).read_bytes()
        assert b"/FontFile2" in content  # TrueType, embedded
        assert b"/Type3" not in content
    plot_tractions(sample_result(), tmp_path / "a.png", width=3.0)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.width == 900


def test_the_size_may_be_any_number() -> None:
    class Reading:
        def __float__(self) -> float:
            return 6.0

    assert plot_tractions(sample_result(), width=Reading(), dpi=np.int64(50)).get_figwidth() == 6.0


def test_a_sketch_may_stand_beside_the_pressure() -> None:
    pressure = plot_tractions(sample_result(), sketch=True).axes[0]
    (panel,) = pressure.child_axes
    assert [text.get_text()[:2] for text in panel.texts] == ["P ", "Q:"]
    with pytest.raises(InputError, match="sketch: must be true or false"):
        plot_tractions(sample_result(), sketch="yes")


def test_no_global_state_is_touched() -> None:
    before = dict(mpl.rcParams)
    plot_tractions(sample_result())
    assert dict(mpl.rcParams) == before


def test_nothing_to_plot_and_unknown_formats(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no state"):
        plot_tractions([])
    with pytest.raises(InputError, match="must be the name of a figure"):
        plot_tractions(sample_result(), tmp_path / "a.docx")
    assert list(tmp_path.iterdir()) == []


def test_equal_states_share_a_line() -> None:
    result = sample_result([{"P": 1e6, "Q": 1e5}, {"Q": -1e5}, {"Q": 1e5}, {"Q": 1e5}])
    same = {name: getattr(result[0], name) for name in ("pressure", "shear", "status")}
    result.states[2] = with_values(result[2], **same)
    figure = plot_tractions(result)
    assert legend_words(figure)[:3] == ["1, 3:  Q = +0.1 MN/m", "2:  Q = −0.1 MN/m", "4:  Q = +0.1 MN/m"]
    colours = [line.get_color() for line in figure.axes[0].lines]
    assert colours == [COLOURS[k] for k in (0, 1, 0, 3)]
    pressure = result[0].pressure.copy()
    pressure[40] += 2e-3 * 1e8
    result.states[2] = with_values(result[2], pressure=pressure)
    assert legend_words(plot_tractions(result))[0] == "1:  Q = +0.1 MN/m"


def test_numbers_of_tractions_are_the_drawn_curves() -> None:
    states = drawn_states(sample_result())
    panel = plot_tractions(states).axes[0]
    for curve, line in zip(traction_curves(states), curves(panel), strict=True):
        assert np.array_equal(curve["angle [deg]"], line[:, 0], equal_nan=True)
        assert np.allclose(curve["pressure [Pa]"], 1e6 * line[:, 1], equal_nan=True)
        assert curve["pressure [Pa]"][[0, -1]].tolist() == [0.0, 0.0]
    assert [curve.parameters["load point"] for curve in traction_curves(states)] == [1.0, 2.0, 3.0]


def with_cycles(*cycles: Cycle) -> Result:
    return replace(sample_result(), cycles=cycles)


UNKNOWN = float("nan")


@pytest.mark.gate
def test_cycles(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no repeated blocks"):
        plot_cycles(sample_result())
    result = with_cycles(
        Cycle(1, 2, 1, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN, True),
        Cycle(3, 2, 2, 1e-3, 1e-2, 1.0, 2e-6, True),
        Cycle(5, 2, 3, 1e-6, 0.0, 1e-15, 1e-6, True),
        Cycle(5, 6, 1, 0.5, 0.5, 2.0, 0.0, True),
    )
    figure = plot_cycles(result, tmp_path / "a.png", title="Cycles")
    change, lost, turned = figure.axes
    assert sorted(len(drawn.get_xdata()) for drawn in change.lines) == [1, 1, 3, 3]
    pressure, shear = change.lines[:2]
    assert pressure.get_xdata().tolist() == [1, 2, 3]  # cycles, not corners
    assert "cycle" in turned.get_xlabel()
    floor = change.get_ylim()[0]
    assert pressure.get_ydata()[1:] == pytest.approx([1e-3, 1e-6])
    assert shear.get_ydata()[1:] == pytest.approx([1e-2, floor])  # 0 stands at the lower end
    figure.draw_without_rendering()
    assert change.get_yticklabels()[0].get_text() == "0"
    assert lost.lines[0].get_ydata()[1:] == pytest.approx([1.0, lost.get_ylim()[0]])  # 1e-15 J/m is rounding
    assert turned.lines[0].get_ydata().tolist() == pytest.approx([0.0, 0.0, 2.0, 3.0])
    assert turned.get_ylabel().endswith("(µrad)")
    assert figure.get_suptitle() == "Cycles\n4 cycles, not yet periodic"
    assert (tmp_path / "a.png").exists()
    assert [spread(count, 3) for count in (0, 1, 2, 5)] == [[], [0], [0, 1], [0, 2, 4]]


def test_later_blocks_of_cycles_go_on_turning_where_earlier_ones_ended() -> None:
    first = [Cycle(k, 2, k // 2, 0.1, 0.1, 1.0, 1e-6, True) for k in (3, 5)]
    second = [Cycle(k, 2, k // 2 - 5, 0.0, 0.0, 1.0, 1e-6, True) for k in (13, 15)]
    figure = plot_cycles(with_cycles(*first, *second))
    one, two = (line for line in figure.axes[2].lines if len(line.get_xdata()) == 3)
    assert one.get_ydata().tolist() == pytest.approx([0.0, 1.0, 2.0])
    assert two.get_ydata().tolist() == pytest.approx([2.0, 3.0, 4.0])
    assert two.get_xdata().tolist() == [2, 3, 4]
    assert "periodic from here" in legend_words(figure)


def test_a_block_with_cycles_of_another_length_goes_on_turning_too() -> None:
    first = [Cycle(k, 2, k // 2, 0.1, 0.1, 1.0, 1e-6, True) for k in (3, 5)]
    second = [Cycle(k, 3, k // 3 - 1, 0.0, 0.0, 1.0, -1e-6, True) for k in (8, 11)]
    around = [Cycle(11, 10, 1, 0.1, 0.1, 9.0, 5e-6, True)]
    drawn = plot_cycles(with_cycles(*first, *second, *around)).axes[2].lines
    turned = {tuple(line.get_xdata()): list(line.get_ydata()) for line in drawn}
    assert turned[0, 1, 2] == pytest.approx([0.0, 1.0, 2.0])
    assert turned[2, 3, 4] == pytest.approx([2.0, 1.0, 0.0])
    assert turned[0, 5] == pytest.approx([0.0, 5.0])


def test_a_panel_of_cycles_that_is_always_zero_is_left_out() -> None:
    still = [Cycle(k, 2, k // 2, 0.1, 0.1, 1.0, 1e-16, True) for k in (3, 5, 7)]  # the rotation is rounding
    figure = plot_cycles(with_cycles(*still))
    assert [panel.get_ylabel().split("\n")[0] for panel in figure.axes] == ["largest change of", "dissipated"]
    nothing = [Cycle(k, 2, k // 2, 0.0, 0.0, 0.0, 0.0, True) for k in (3, 5)]
    assert len(plot_cycles(with_cycles(*nothing)).axes) == 1


def test_long_histories_have_a_logarithmic_axis_of_cycles() -> None:
    cycles = [Cycle(2 * k, 2, k, 10.0**-k, 10.0**-k, 1.0, 0.0, True) for k in range(1, 200)]
    change = plot_cycles(with_cycles(*cycles)).axes[0]
    assert change.get_xscale() == "log"
    assert change.get_ylim()[0] == pytest.approx(1e-10)  # below 1e-9 of the largest all is rounding
    second = [Cycle(400 + 3 * k, 3, k, 0.1, 0.1, 1.0, 0.0, True) for k in range(1, 5)]
    assert plot_cycles(with_cycles(*cycles, *second)).axes[0].get_xscale() == "linear"


def test_a_remote_stress_has_one_name_in_title_and_legend() -> None:
    figure = plot_tractions(sample_result([{"P": 1e6, "sxx": 2e7, "syy": 1e7}, {"sxx": 3e7}]))
    assert figure.get_suptitle() == "P = 1 MN/m,  syy = +10 MPa"
    assert legend_words(figure)[:2] == ["1:  sxx = +20 MPa", "2:  sxx = +30 MPa"]


def bands(panel: mpl.axes.Axes) -> list[np.ndarray]:
    """The corners of the bands in a panel, of all contact zones of a state together."""
    return [np.concatenate([path.vertices for path in band.get_paths()]) for band in panel.collections]


def test_bands_show_the_error_bars_and_stand_in_the_numbers() -> None:
    result = solve(Problem(PAIR, 0.01, 2e-5, 0.4), [{"P": 2e6}, {"Q": 2e5}], nodes=101, error_bars=True)
    plain, figure = plot_tractions(result), plot_tractions(result, bars=True)
    assert "band: error bars of the curves" in legend_words(figure)
    assert "band: error bars of the curves" not in legend_words(plain)
    assert not plain.axes[0].collections
    found = traction_curves(drawn_states(result), bars=True)
    for row, name in enumerate(("pressure", "shear")):
        for state, curve, band in zip(result, found, bands(figure.axes[row]), strict=True):
            bar = state.error_bars.of_curves(np.radians(curve["angle [deg]"] - 90.0))[row]
            assert np.allclose(curve[f"{name} bar [Pa]"], bar, rtol=1e-9)
            ends = np.r_[curve[f"{name} [Pa]"] - bar, curve[f"{name} [Pa]"] + bar] / 1e6
            assert (band[:, 1].min(), band[:, 1].max()) == pytest.approx((ends.min(), ends.max()))
    assert list(traction_curves(drawn_states(result))[0].columns) == ["angle [deg]", "pressure [Pa]", "shear [Pa]"]


def test_bands_of_several_zones_leave_gaps_and_frictionless_states_have_no_shear() -> None:
    problem = Problem(PAIR, 0.01, -2e-5, 0.0)
    result = solve(problem, [{"sxx": 2e8}, {"sxx": 4e8}], nodes=240, error_bars=True)
    assert len(result[-1].contact) == 2
    curve = traction_curves(drawn_states(result), bars=True)[-1]
    gaps = np.isnan(curve["angle [deg]"])
    assert gaps.any()
    assert np.array_equal(np.isnan(curve["pressure bar [Pa]"]), gaps)
    assert np.nanmax(curve["shear bar [Pa]"]) == 0.0
    assert len(plot_tractions(result, bars=True).axes) == 1


def test_bands_need_error_bars() -> None:
    with pytest.raises(InputError, match=r"^bars: needs states with error bars: fastpin run CASE --error-bars, or "):
        plot_tractions(sample_result(), bars=True)
    with pytest.raises(InputError, match=r"^bars: must be true or false"):
        plot_tractions(sample_result(), bars=1)  # type: ignore[arg-type]

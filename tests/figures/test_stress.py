"""Figures of stresses, load cycles and fatigue."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Points, Problem, figures, solve
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.damage import fatigue, spectrum_damage
from fastpin.figures.load_cycle import area_doubt
from fastpin.model import FatigueConstants
from fastpin.report.stress import COMPONENTS, depth_curves, field_curves, hoop_curves
from tests.support.drawing import legend_words
from tests.support.fatigue import ALUMINIUM
from tests.support.refusals import refused


@pytest.fixture(scope="module")
def result():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"], "stress")
    problem = Problem(pair, hole_radius=2.4e-3, clearance=10e-6, friction=0.4, pin_load="body")
    cycle = LoadHistory([{"Q": 1e5, "sxx": 60e6}, {"Q": -1e5, "sxx": 6e6}])
    return solve(problem, LoadHistory([{"P": 6e5}]) + cycle.repeated(2), nodes=121, between=1, slip_sums=True)


@pytest.fixture
def coarse(monkeypatch):
    """Maps of few points: those of a usual one take tenths of a second."""
    monkeypatch.setattr(figures.stress, "field_curves", functools.partial(field_curves, fineness=40))


@pytest.mark.gate
def test_hoop_stress_with_its_peaks(result, tmp_path):
    figure = figures.plot_hoop_stress(list(result)[-2:], tmp_path / "hoop.png", title="joint")
    plate, pin = figure.axes
    assert plate.get_ylabel() == "hoop stress of the plate (MPa)"
    assert pin.get_ylabel() == "hoop stress of the pin (MPa)"
    for state, dot in zip(result[-2:], [line for line in plate.lines if line.get_marker() == "o"], strict=True):
        peak = state.peak_hoop_stress()
        assert dot.get_ydata()[0] == pytest.approx(peak.value / 1e6)
        assert (dot.get_markerfacecolor() == "white") == (not peak.resolved)
        curve = next(line for line in plate.lines if line.get_color() == dot.get_color() and line is not dot)
        assert max(curve.get_ydata()) <= peak.value / 1e6 * (1.0 + 1e-9)
        assert max(curve.get_ydata()) > 0.99 * peak.value / 1e6
    assert (tmp_path / "hoop.png").stat().st_size > 10_000


def test_one_body_has_one_panel_with_the_states_of_the_last_cycle(result):
    (panel,) = figures.plot_hoop_stress(result, body="pin").axes
    assert panel.get_ylabel() == "hoop stress of the pin (MPa)"
    assert len([line for line in panel.lines if len(line.get_xdata()) > 2]) == 5
    assert "5 of 10 states drawn" in panel.get_title()


def test_curves_far_from_zero_are_not_flattened_for_it():
    bush = Bushing(MATERIALS["C93200"], 3e-3, 5e-6)
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"])
    held = solve(Problem(pair, 2.4e-3, 10e-6, 0.4, plate_body=bush), [{"P": 3e4}, {"P": 4e4}], nodes=61)
    bore, _, pin = figures.plot_hoop_stress(held).axes
    low, high = bore.dataLim.intervaly
    assert high < -2.0 * (high - low)
    bottom, top = bore.get_ylim()
    assert bottom < low < high < top < 0.0
    assert top - bottom < 1.2 * (high - low)
    assert pin.get_ylim()[0] < 0.0 < pin.get_ylim()[1]


@pytest.mark.gate
def test_solid_lines_of_an_svg_have_no_dashes_of_no_length(result, tmp_path):
    """Some readers, and what makes a PDF of a report, draw nothing for "stroke-dasharray: ;"."""
    figures.plot_hoop_stress(result, tmp_path / "hoop.svg")
    assert "stroke-dasharray: ;" not in (tmp_path / "hoop.svg").read_text(encoding="utf-8")


def test_a_rigid_body_is_left_out():
    pair = MaterialPair(Material.rigid(), Material(1.0, 0.3))
    rigid = solve(Problem.from_load_parameter(pair, 0.1, 0.3), [{"P": 1.0}], nodes=61)
    figure = figures.plot_hoop_stress(rigid)
    assert [panel.get_ylabel() for panel in figure.axes] == ["hoop stress of the plate (F/R)"]
    assert len(field_curves(rigid[-1], fineness=10)) == 1
    with pytest.raises(InputError, match="the pin is rigid"):
        figures.plot_stress_profile(rigid, body="pin")


def test_profiles_begin_with_the_stress_on_the_edge(result):
    state = result[-1]
    curve = depth_curves([state], "plate", 30.0, 0.4)[0]
    at_edge = state.hoop_stress("plate", np.radians([-60.0]))[0]  # another formula has it on the edge alone
    assert curve["hoop stress [Pa]"][0] == pytest.approx(at_edge, rel=1e-13)
    assert curve["depth [m]"][[0, -1]] == pytest.approx([0.0, 0.4 * 2.4e-3])
    figure = figures.plot_stress_profile(result, angle=30.0)
    assert "at 30.00 deg" in figure.get_suptitle()
    at_peak = depth_curves([state])[0]
    assert at_peak["hoop stress [Pa]"][0] == pytest.approx(state.peak_hoop_stress().value)


def test_profiles_end_at_the_far_rim():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    bodies = {"pin_body": Tube(5e-3), "plate_body": Ring(25e-3)}
    ring = solve(Problem(pair, 10e-3, 20e-6, 0.3, **bodies), [{"P": 1e6}], nodes=61)
    for body, wall in (("plate", 1.5), ("pin", 0.5)):
        assert depth_curves(ring, body, 0.0, wall)[0]["depth [m]"][-1] == pytest.approx(wall * 10e-3)
        words = f"depth: must be above 0 and at most {wall} radii, the wall of the {body}, not 3"
        assert str(refused(depth_curves, ring, body, 0.0, 3.0)) == words


@pytest.mark.gate
def test_the_edge_of_the_hole_may_be_that_of_a_bush():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    bush = Bushing(MATERIALS["2024-T3"], 12e-3, 10e-6)
    joint = solve(Problem(pair, 10e-3, 20e-6, 0.3, plate_body=bush), [{"P": 1e6}, {"P": 5e5}], nodes=61)
    labels = [panel.get_ylabel() for panel in figures.plot_hoop_stress(joint).axes]
    seat = "hoop stress of the plate\nat the seat (MPa)"
    assert labels == ["hoop stress of the bush (MPa)", seat, "hoop stress of the pin (MPa)"]
    assert "below the edge of the bush" in figures.plot_stress_profile(joint).get_suptitle()
    assert figures.plot_fatigue(fatigue(joint, "smith-watson-topper")).get_suptitle() == "bush, on the edge"


def test_fatigue_of_bush_and_seat_share_the_panels():
    pair = MaterialPair(MATERIALS["steel"], ALUMINIUM)
    bush = Bushing(Material(103e9, 0.34), 12.5e-3, 40e-6)
    joint = solve(Problem(pair, 10e-3, 60e-6, 0.3, plate_body=bush), [{"P": 1e6}, {"P": 5e5}], nodes=61)
    found = [fatigue(joint, "smith-watson-topper", body) for body in ("plate", "seat")]
    figure = figures.plot_fatigue(found)
    assert figure.get_suptitle() == "bush, on the edge; plate at the seat, on the edge"
    parameter, life = figure.axes
    assert [len(curve.get_ydata()) for curve in parameter.lines[:2]] == [one.theta.size for one in found]
    assert len(life.lines) == 1
    words = legend_words(figure)
    assert "bush: the parameter is 0 everywhere: no crack is expected" in words
    assert any(each.startswith("plate at the seat: hot spot at ") for each in words)
    # alone, an axis without a scale
    (panel,) = figures.plot_fatigue(found[0]).axes
    assert panel.get_yticks().tolist() == [0.0]
    other = fatigue(joint, "crossland", "seat", constants=FatigueConstants(bending_limit=1e8, torsion_limit=7e7))
    for wrong, reason in (([found[0], other], "one problem and one criterion"), ([], "not an empty list")):
        with pytest.raises(InputError, match=reason):
            figures.plot_fatigue(wrong)


@pytest.mark.usefixtures("coarse")
def test_a_point_force_does_not_set_the_colours_of_a_map():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    for load in ("centre", "body"):
        state = solve(Problem(pair, 10e-3, 20e-6, 0.3, pin_load=load), [{"P": 2e6}], nodes=121)[-1]
        _, bar = figures.plot_stress_field(state).axes
        assert bar.get_ylabel() == "von Mises stress (MPa)"
        assert bar.get_ylim()[1] < 2.0 * state.peak_pressure / 1e6


@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize("component", COMPONENTS)
def test_maps_of_all_components(result, component):
    figure = figures.plot_stress_field(result[-1], component=component)
    assert any(COMPONENTS[component] in panel.get_ylabel() for panel in figure.axes)


@pytest.mark.usefixtures("coarse")
def test_a_map_of_a_result_is_that_of_its_last_state(result):
    figure = figures.plot_stress_field(result)
    assert figure.get_suptitle().startswith("load point 5: ")


def test_no_rounding_is_drawn_as_slip():
    pair = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
    cycle = LoadHistory([{"Q": 3e4}, {"Q": -3e4}]).repeated(12)
    settled = solve(Problem(pair, 0.01, 2e-5, 0.4), LoadHistory([{"P": 2.42e6}]) + cycle, nodes=61, slip_sums=True)
    assert 0.0 < settled.cycle().largest_slip_range < 1e-15
    upper, lower = figures.plot_slip(settled).axes
    assert not upper.lines[0].get_ydata().any()
    assert not lower.lines[0].get_ydata().any()
    assert upper.texts[0].get_text() == "0: no node slips"


def test_a_map_has_the_stresses_of_its_points(result):
    state = result[-1]
    for curve in field_curves(state, "hoop", fineness=20):
        radius, angle = curve["radius [m]"], np.radians(curve["angle [deg]"] - 90.0)
        edge = radius == 2.4e-3
        expected = state.hoop_stress(curve.parameters["body"], angle[edge])
        assert curve["hoop stress [Pa]"][edge] == pytest.approx(expected)


def test_the_stress_of_the_assembly_is_drawn_and_written():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"], "stress")
    pressed = solve(Problem(pair, 0.01, -2e-5, 0.4), [{"P": 2e5}], nodes=41)
    for curve in hoop_curves(pressed):
        body = curve.parameters["body"]
        before = pressed[0].assembly_stress(Points.at_depth(0.0, 0.0), body).hoop
        assert curve["hoop stress of the assembly [Pa]"] == pytest.approx(float(before), rel=1e-12)
    figure = figures.plot_hoop_stress(pressed)
    assert "of the assembly, before any load" in legend_words(figure)
    assert [sum(line.get_linestyle() == ":" for line in panel.lines) for panel in figure.axes] == [1, 1]


def test_hoop_curves_are_of_both_bodies(result):
    assert [curve.parameters["body"] for curve in hoop_curves([result[-1]])] == ["plate", "pin"]


@pytest.mark.gate
def test_slip_and_loops_of_a_cycle(result, tmp_path):
    cycle = result.cycle()
    slip = figures.plot_slip(cycle, tmp_path / "slip.pdf")
    upper, lower = slip.axes
    assert max(upper.lines[0].get_ydata()) == pytest.approx(cycle.slip_range.max() * 1e9)
    assert lower.get_ylabel().startswith("friction energy")
    loops = figures.plot_loops(cycle, tmp_path / "loops.svg", title="loops")
    names = [panel.get_ylabel().partition(" ")[0] for panel in loops.axes if panel.get_visible()]
    assert names == ["Q", "sxx"]
    areas = [panel.texts[0].get_text() for panel in loops.axes]
    assert all(area.startswith("area ") and "J/m" in area for area in areas)
    corners = solve(result.problem, [{"P": 6e5}, {"Q": 1e5}, {"Q": -1e5}, {"Q": 1e5}], nodes=61)
    (line,) = figures.plot_loops(corners.cycle(first=2, last=4)).axes
    assert line.texts[0].get_text() == "area unknown: no states between the corners"
    whole = figures.plot_slip(result).axes[0].lines[0].get_ydata()
    assert np.array_equal(whole, upper.lines[0].get_ydata())
    with pytest.raises(InputError, match="cycle: must be a result, or a load cycle"):
        figures.plot_slip(result[-1])
    with pytest.raises(InputError, match="has no loop"):
        figures.plot_loops(solve(result.problem, [{"P": 1e5}, {"P": 1e5}], nodes=61).cycle(first=1, last=2))


@pytest.fixture(scope="module")
def rig():
    """A pin whose hub is moved to and fro: two blocks."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    problem = Problem(
        pair, 10e-3, 20e-6, 0.4, pin_load="centre", rotation="fixed", drive="ux", hub_radius=2e-3, gauge_radius=50e-3
    )
    parts = [LoadHistory([{"ux": far}, {"ux": -far}]).repeated(3) for far in (5e-6, 15e-6)]
    return solve(problem, LoadHistory([{"P": 1e6}]) + parts[0] + parts[1], nodes=41, between=5)


def loop_panel(figure, name="Q"):
    return next(panel for panel in figure.axes if panel.get_ylabel().startswith(f"{name} "))


def test_loops_of_several_cycles_lie_over_one_another(rig):
    cycles = [rig.cycle(2), rig.cycle(5)]
    figure = figures.plot_loops(cycles, names=["cycle 3", "cycle 6"])
    panel = loop_panel(figure)
    assert [max(drawn.get_xdata()) for drawn in panel.lines] == pytest.approx([5.0, 15.0])
    entries = legend_words(figure)
    assert entries[0].startswith("cycle 3, corners 5 to 7: area ")
    assert "dissipated on the path" in entries[1]
    with pytest.raises(InputError, match="cycle: must be 1 to 8 cycles, not 9"):
        figures.plot_loops(cycles[:1] * 9)


def test_a_loop_is_drawn_over_the_prescribed_displacement_or_over_that_of_the_pin(rig):
    cycle = rig.cycle()
    prescribed = loop_panel(figures.plot_loops(rig))
    assert prescribed.get_xlabel() == "prescribed displacement ux (µm)"
    assert prescribed.lines[0].get_xdata() == pytest.approx([1e6 * state.load["ux"] for state in cycle.states])
    pin = loop_panel(figures.plot_loops(rig, abscissa="pin"))
    assert pin.get_xlabel() == "displacement of the pin (µm)"
    assert max(pin.lines[0].get_xdata()) < 14.9  # pin and plate deform on the way to the gauge circle
    x, q = prescribed.lines[0].get_data()
    over_pin = pin.lines[0].get_data()
    areas = [np.sum(0.5 * (b[1:] + b[:-1]) * np.diff(a)) for a, b in ((x, q), over_pin)]
    assert areas[0] == pytest.approx(areas[1], rel=0.05)  # not equal: the contact has not settled


def test_the_abscissa_must_be_known(rig, result):
    with pytest.raises(InputError, match="abscissa: no displacement is prescribed here; the other choice is pin"):
        figures.plot_loops(result, abscissa="prescribed")
    with pytest.raises(InputError, match='abscissa: must be "prescribed" or "pin"'):
        figures.plot_loops(rig, abscissa="hub")


def test_areas_that_miss_the_dissipation_are_doubted(rig):
    few = rig.cycle()
    assert "few states draw the loop" in area_doubt(few) or "not settled" in area_doubt(few)
    assert "not settled" in area_doubt(rig.cycle(first=9, last=11))
    problem = Problem(few.states[0].problem.pair, 10e-3, 20e-6, 0.4, pin_load="centre", rotation="fixed")
    history = LoadHistory([{"P": 1e6}]) + LoadHistory([{"Q": 4e5}, {"Q": -4e5}]).repeated(3)
    exact = [solve(problem, history, nodes=41, between=between).cycle() for between in (2, 40)]
    assert "few states draw the loop" in area_doubt(exact[0])
    assert area_doubt(exact[1]) == ""
    heading = figures.plot_loops(exact[0]).get_suptitle() or figures.plot_loops(exact[0]).axes[0].get_title()
    assert "dissipated on the path" in heading
    assert [panel.get_ylabel()[0] for panel in figures.plot_loops(exact[0]).axes] == ["Q"]  # M turns nothing


def test_fatigue_along_the_edge(result):
    found = fatigue(list(result)[-4:], "smith-watson-topper")
    figure = figures.plot_fatigue(found, title="SWT")
    parameter, life = figure.axes
    assert max(parameter.lines[0].get_ydata()) == pytest.approx(found.hot_spot.parameter / 1e3)
    assert min(life.lines[0].get_ydata()) == pytest.approx(found.hot_spot.life)
    with pytest.raises(InputError, match="found: must be a fatigue result"):
        figures.plot_fatigue(result)


def test_damage_along_the_edge(result):
    constants = MATERIALS["2024-T3"].fatigue
    found = [spectrum_damage(list(result), body=body, constants=constants, straight=True) for body in ("plate", "pin")]
    figure = figures.plot_fatigue(found[0], title="flight")
    damage, life = figure.axes
    assert max(damage.lines[0].get_ydata()) == pytest.approx(found[0].hot_spot.damage)
    assert np.nanmin(life.lines[0].get_ydata()) == pytest.approx(found[0].hot_spot.life)
    assert len(figures.plot_fatigue(found).axes) == 2
    none = replace(found[0], damage=0.0 * found[0].damage)
    assert figures.plot_fatigue(none).axes[0].lines
    other = spectrum_damage(list(result), constants=constants, depth=np.array([[0.0], [1e-4]]), straight=True)
    with pytest.raises(InputError, match=r"^found: must be of points at one depth$"):
        figures.plot_fatigue(other)
    with pytest.raises(InputError, match=r"^found: must be damage of a spectrum"):
        figures.plot_fatigue([found[0], 1.0])


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda r: figures.plot_hoop_stress([]), "states: there is no state"),
        (lambda r: figures.plot_hoop_stress(r, body="hub"), 'body: must be "plate", "pin", "seat" or "both"'),
        (lambda r: figures.plot_hoop_stress(r, body=["pin"]), 'body: must be "plate", "pin", "seat" or "both"'),
        (lambda r: figures.plot_stress_profile(r, body={}), 'body: must be "plate", "pin" or "seat"'),
        (lambda r: figures.plot_stress_profile(r, body="both"), 'body: must be "plate", "pin" or "seat"'),
        (lambda r: figures.plot_stress_profile(r, depth=0.0), "depth: must be above 0"),
        (lambda r: figures.plot_stress_profile(r, angle="a"), "angle: must be a number"),
        (lambda r: figures.plot_stress_field(r.states), "state: must be a State"),
        (
            lambda r: figures.plot_loops(solve(r.problem, [{"P": 1e5}], nodes=61)),
            "cycle: no cycle of the history has ended",
        ),
        (lambda r: figures.plot_stress_field(r[0], component="x"), "component: must be"),
        (lambda r: figures.plot_stress_field(r[0], extent=1.0), "extent: must be above 1"),
        (lambda r: figures.plot_hoop_stress(r, "hoop.txt"), "path: must be the name of a figure"),
    ],
)
def test_bad_input(result, draw, message):
    with pytest.raises(InputError, match=message):
        draw(result)

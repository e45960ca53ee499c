"""Hoop stress and fatigue along the edges beyond the hole: closed forms, another way, outputs, files."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Case, InputError, Material, MaterialPair, Points, Problem, damage, solve
from fastpin.assess.fatigue import _place, edge_of
from fastpin.assess.outputs import write_csv
from fastpin.bodies import Bushing, Ring
from fastpin.damage.distance import points_of_means
from fastpin.errors import InputWarning
from fastpin.live.controls import ControlScales
from fastpin.live.pictures import picture
from fastpin.live.pin import case_document
from fastpin.lugs import fields
from fastpin.lugs.fields import PlateField, plate_field
from fastpin.lugs.outline import Lug
from fastpin.lugs.panels import Fineness
from fastpin.model import FatigueConstants, LoadHistory
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.points import edge_words
from fastpin.report.states import hoop_lines, state_table
from fastpin.report.stress import outline_curves
from fastpin.report.summary import document
from fastpin.storage import load, save
from tests.support.lugs import disc, lug_with_neck, lug_with_nose, problem_with, rough_body

LOADS = [{"P": 1e8}, {"P": 3e7, "Q": 2e7}, {"P": 9e7, "Q": -4e7}, {"P": 3e7, "Q": 2e7}]


def steel(body, **given):
    """A problem of steel bodies with a hole of 1 m, in plane stress."""
    pair = MaterialPair(Material(200e9, 0.3), Material(200e9, 0.3, **given), plane="stress")
    return Problem(pair, hole_radius=1.0, clearance=1e-3, friction=0.3, plate_body=body)


@pytest.mark.gate
def test_the_rim_of_a_ring_under_pressure_has_lame_s_stress():
    field = PlateField(Lug(0.3, "stress", 1.0, disc(2.0), {"rim": "both"}), 4)
    share = -1.3 / (0.7 * 4.0)  # A/B of s_rr = A - B/r^2, s_tt = A + B/r^2 with u(2) = 0
    lame = (share + 0.25) / (1.0 - share)
    found = math.sqrt(2.0) * field.along_edges.columns[:, 0]
    assert found == pytest.approx(lame, abs=1e-8)
    assert np.abs(field.along_edges.z) == pytest.approx(2.0)
    assert field.along_edges.along[-1] == pytest.approx(4.0 * math.pi)


@pytest.mark.gate
def test_the_rim_of_a_ring_has_the_stress_of_its_closed_form(monkeypatch):
    body = rough_body(monkeypatch, Lug(0.3, "stress", 1.0, disc(2.0), {"rim": "both"}), 10)
    state = solve(problem_with(Ring(2.0)), [{"P": 1.0, "Q": 0.2}], nodes=101)[-1]
    found = replace(state, problem=problem_with(body)).outline_hoop_stress()
    expected = state.stress(Points.at_xy(found.x, found.y), straight=True).hoop
    assert found.hoop == pytest.approx(expected, abs=2e-4 * state.peak_pressure)
    assert found.peak.value == pytest.approx(expected.max(), abs=2e-4 * state.peak_pressure)


@pytest.mark.gate
def test_edges_of_a_lug_agree_with_another_discretisation():
    """The values of two other discretisations, under t_r = -sin(theta)/pi on the hole."""
    edges = PlateField(lug_with_nose(), 8).along_edges
    hoop, names = -edges.columns[:, 3] / math.pi, np.array(edges.names)
    assert hoop[np.abs(edges.z + 2.2j) < 1e-9] == pytest.approx(0.326184372, abs=1e-6)
    right = names == "right"
    found = np.interp([1.0, 5.0, 9.0], edges.z[right].imag, hoop[right])
    assert found == pytest.approx([0.147560604, 0.232199395, 0.209992614], abs=1e-4)


@pytest.mark.gate
@pytest.mark.parametrize("bush", [False, True])
def test_the_hoop_stress_of_edges_is_that_of_points_on_them(monkeypatch, bush):
    body = rough_body(monkeypatch, lug_with_nose())
    monkeypatch.setattr(fields, "FINENESS", Fineness(12, 6))
    problem = steel(body)
    if bush:
        body = Bushing(Material(100e9, 0.3), 1.0, 1e-3, body, friction=0.2, bonded=False)
        problem = Problem(problem.pair, hole_radius=0.8, clearance=3e-3, friction=0.3, plate_body=body)
    state = solve(problem, [{"P": 1e8, "Q": 2e7}], nodes=81)[-1]
    found = state.outline_hoop_stress()
    z = found.x + 1j * found.y
    away = [np.abs(z - corner) > 0.3 for corner in (2.2, -2.2, 2.2 + 10j, -2.2 + 10j)]
    free = (np.array(found.edges) != "top") & np.all(away, axis=0)
    there = state.stress(Points.at_xy(found.x[free], found.y[free]), "seat" if bush else "plate", straight=True)
    assert found.hoop[free] == pytest.approx(there.radial + there.hoop, abs=1e-4 * np.abs(found.hoop).max())
    peak = state.outline_peak
    assert (peak.value, peak.edge) == (found.hoop.max(), found.edges[int(np.argmax(found.hoop))])


def test_plates_without_an_outline_have_no_such_stress():
    state = solve(problem_with(Ring(2.0)), [{"P": 1.0}], nodes=41)[-1]
    with pytest.raises(InputError, match="plate_body: has no outline"):
        state.outline_hoop_stress()
    result = solve(problem_with(Ring(2.0)), [{"P": 1.0}], nodes=41)
    shown = document(Case(result.problem, LoadHistory(LOADS)), result)["states"][0]
    assert shown["peak_hoop_outline"] is None
    assert "peak_hoop_outline_place" not in shown
    assert "outline" not in state_table(result.problem, result.states)


@pytest.mark.gate
def test_text_json_and_tables_tell_the_same_edge_also_from_a_file(monkeypatch, tmp_path):
    result = solve(steel(rough_body(monkeypatch, lug_with_neck())), LOADS, nodes=41)
    peaks = [state.outline_peak for state in result]
    shown = document(Case(result.problem, LoadHistory(LOADS)), result)
    places = [state["peak_hoop_outline_place"] for state in shown["states"]]
    assert [place["edge"] for place in places] == [peak.edge for peak in peaks]
    assert [state["peak_hoop_outline"] for state in shown["states"]] == [peak.value for peak in peaks]
    largest = max(range(len(peaks)), key=lambda k: peaks[k].value)
    assert shown["extremes"]["peak_hoop_outline"]["largest"]["value"] == peaks[largest].value
    assert shown["extremes"]["peak_hoop_outline"]["largest"]["place"] == largest
    line = hoop_lines(result.problem, result.states)[-1]
    words = f'"{peaks[largest].edge}", at x = '
    assert words in line
    assert f"load point {largest + 1}; apart from 250 mm about sharp corners" in line
    rows = state_table(result.problem, result.states).splitlines()[2:]
    assert [row.split()[-2] for row in rows] == [peak.edge for peak in peaks]
    save(result, tmp_path / "neck.h5")
    again = load(tmp_path / "neck.h5")
    assert [state.outline_peak for state in again] == peaks
    frame = again.to_dataframe()
    assert list(frame["peak_hoop_outline_edge"]) == [peak.edge for peak in peaks]
    assert list(frame["peak_hoop_outline"]) == [peak.value for peak in peaks]


@pytest.mark.gate
def test_figure_page_and_live_page_show_the_governing_place(monkeypatch, tmp_path):
    result = solve(steel(rough_body(monkeypatch, lug_with_neck())), LOADS, nodes=41)
    curves = outline_curves(result.states)
    for state, curve in zip(result, curves, strict=True):
        peak, values = state.outline_peak, curve["hoop stress [Pa]"]
        assert values.max() == pytest.approx(peak.value, rel=1e-9)  # of equal places the rightmost one is named
        assert curve["edge"][np.argmax(values)] == peak.edge
    result.plot(tmp_path / "outline.png", kind="outline")
    write_csv(curves, tmp_path / "outline.csv")
    rows = (tmp_path / "outline.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "load point,along the edges [m],x [m],y [m],hoop stress [Pa],edge"
    assert len(rows) == 1 + sum(len(curve["edge"]) for curve in curves)
    shown = picture(result[0], 1, 1, "grid", LoadHistory(LOADS))["outline"]
    assert (shown["value"], shown["edge"]) == (result[0].outline_peak.value, result[0].outline_peak.edge)
    scales = ControlScales(result.problem, LoadHistory(LOADS))
    sides = case_document("", result.problem, scales)["outline"]
    assert [side["hold"] for side in sides] == [None, None, "both", None, None, None, None, None]
    assert sides[0]["line"][0] == [2.2, 3.0]


CONSTANTS = FatigueConstants(
    fatigue_strength=1e9, strength_exponent=-0.1, fatigue_ductility=0.5, ductility_exponent=-0.6,
    threshold_range=1e6, limit_range=1e8, bending_limit=3e8, torsion_limit=2e8,
)  # fmt: skip


@pytest.mark.gate
def test_the_hot_spot_is_looked_for_on_all_edges(monkeypatch):
    """The neck carries F/(0.6 R) along its free edges: the parameter is that of a bar."""
    problem = steel(rough_body(monkeypatch, lug_with_neck()), fatigue=CONSTANTS)
    states = solve(problem, [{"P": 1e7}, {"P": 1e8}], nodes=41).states
    found = damage.fatigue(states, "smith-watson-topper")
    stress = 1e8 / 0.6
    assert found.hot_spot.parameter == pytest.approx(0.5 * stress * (0.9 * stress) / 200e9, rel=0.05)
    assert edge_of(found) == "neck"
    assert _place(found).startswith('on the edge "neck", at x = ')
    alone = damage.fatigue(states, "smith-watson-topper", depth=0.0)
    assert alone.hot_spot.parameter < found.hot_spot.parameter
    assert edge_of(alone) == ""
    spectrum = damage.assessed_fatigue(states)[0]
    assert edge_of(spectrum) == "neck"
    (reserve,) = damage.assessed_reserves(states)
    assert (reserve.theta, reserve.depth) == (spectrum.hot_spot.theta, spectrum.hot_spot.depth)


@pytest.mark.gate
@pytest.mark.parametrize(("method", "deep"), [("point", 1.3), ("line", 0.4), ("area", 0.5)])
def test_critical_distances_below_other_edges(monkeypatch, method, deep):
    """The stress in the neck is uniform: each mean is that of the edge. A deep profile leaves the neck, and is told."""
    problem = steel(rough_body(monkeypatch, lug_with_neck()), fatigue=CONSTANTS)
    states = solve(problem, [{"P": 1e7}, {"P": 1e8}], nodes=41).states
    edge = damage.fatigue(states, "smith-watson-topper").hot_spot
    mean = damage.fatigue_at_distance(states, "smith-watson-topper", method, length=0.02).hot_spot
    assert mean.parameter == pytest.approx(edge.parameter, rel=0.02)
    assert (mean.theta, mean.depth) == (edge.theta, edge.depth)
    how = FatigueAssessment(method=method, length=0.02)
    (found,) = damage.assessed_fatigue(states, how)
    assert found.theta.size == 2  # the hole, and the neck
    assert edge_of(found) == "neck"
    (reserve,) = damage.assessed_reserves(states, how)
    assert reserve.depth == found.hot_spot.depth
    with pytest.raises(
        InputError, match='length: 2 reaches out of the plate below a place on the edge "neck", at x = '
    ):
        damage.fatigue_at_distance(states, "smith-watson-topper", method, length=2.0)
    with pytest.warns(InputWarning, match='on the edge "neck", at x = .* this edge is left out'):
        (found,) = damage.assessed_fatigue(states, how.changed(length=deep))
    assert found.theta.size == 1


@pytest.mark.gate
def test_a_residual_stress_of_the_hole_stays_at_the_hole(monkeypatch):
    problem = steel(rough_body(monkeypatch, lug_with_neck()), fatigue=CONSTANTS)
    states = solve(problem, [{"P": 1e7}, {"P": 1e8}], nodes=41).states
    one, other = (damage.assessed_fatigue(states, FatigueAssessment(residual_stress=each))[0] for each in (None, -2e8))
    beyond = one.depth > 0.0
    assert one.damage[beyond] == pytest.approx(other.damage[beyond], rel=1e-9, abs=1e-9 * one.damage.max())
    assert other.damage[~beyond].max() < one.damage[~beyond].max()


def test_points_below_a_straight_edge_an_arc_and_a_hole(monkeypatch):
    """Depths of the point method lie along the inward normal of each kind of edge."""
    problem = steel(rough_body(monkeypatch, lug_with_nose()))
    for place, inward in ((2.2 + 4j, -1.0), (-2.2j, 1j)):
        points, weights = points_of_means(problem, "point", "plate", 0.2, np.array([np.angle(place)]), abs(place) - 1.0)
        found = complex(points.radius[0, 0] * np.exp(1j * points.theta[0, 0]))
        assert found == pytest.approx(place + 0.1 * inward, abs=1e-9)
        assert weights.sum() == pytest.approx(1.0)


def test_polylines_are_marked(monkeypatch):
    turns = np.exp(1j * np.linspace(-np.pi, 0.0, 13))
    nose = [replace(lug_with_nose().outline[-1], start=2.2 * one, end=2.2 * two, through=None)
            for one, two in zip(turns[:-1].tolist(), turns[1:].tolist(), strict=True)]  # fmt: skip
    lug = replace(lug_with_nose(), outline=(*lug_with_nose().outline[:-1], *nose))
    assert lug.polylines == {"nose"}
    assert lug_with_nose().polylines == set()
    problem = steel(rough_body(monkeypatch, lug))
    assert edge_words(problem, "nose", -2.2j) == 'on the edge "nose" (a polyline), at x = 0 m, y = -2.2 m'
    assert plate_field(problem.plate_body).along_edges.names[0] in ("right", "nose")
    assert json.loads(problem.plate_body.outline)["parts"][0]["name"] == "right"

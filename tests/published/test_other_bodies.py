"""The figures of other bodies, on few nodes and in few cases."""

import math

import numpy as np
import pytest
from matplotlib.text import Text

from docs.beyond import finite_bodies, rectangular_lug, rigid_pin
from docs.beyond.figures import FIGURES
from fastpin.assess.outputs import Curve
from fastpin.bodies.ring import SUPPORTS
from fastpin.lugs import plates
from fastpin.model.problem import Problem
from fastpin.published import half_plane

pytestmark = pytest.mark.gate

NODES = 121


def curve_of(curves: list[Curve], column: str, **parameters: float | str) -> np.ndarray:
    found = [curve for curve in curves if column in curve.columns and curve.parameters == parameters]
    assert len(found) == 1
    return found[0][column]


def assert_drawn(name: str, curves: list[Curve], *words: str) -> None:
    """A figure has its legends inside, and these words."""
    figure = FIGURES[name].draw(curves)
    figure.draw_without_rendering()
    for legend in figure.legends:
        assert 0.0 <= legend.get_window_extent().x0 < legend.get_window_extent().x1 <= figure.bbox.width
    assert len(figure._suptitle.get_text().splitlines()) <= 2
    text = " ".join(item.get_text() for item in figure.findobj(Text))
    assert [part for part in words if part not in text] == []


def test_rings_have_the_pressures_of_the_support_table():
    """The peaks with mu = 0.3 are those of an independent trial; 121 nodes give them to 1e-4."""
    curves = FIGURES["rings"].compute(NODES)
    peaks = {
        "infinite plate": max(curve_of(curves, "N", support="infinite plate")),
        **{kind: max(curve_of(curves, "N", support=kind, outer_radius=2.0)) for kind in ("held", "uniform")},
    }
    assert peaks == pytest.approx({"infinite plate": 0.5562, "held": 0.6219, "uniform": 0.4601}, abs=2e-4)
    held = [max(curve_of(curves, "N", support="held", outer_radius=outer)) for outer in (1.5, 2.0, 3.0, 4.0)]
    assert held == sorted(held, reverse=True)
    assert held[-1] > peaks["infinite plate"]
    parts = "load parameter 0.1", "friction coefficient 0.3", "outer radius 1.5 R", "ring held at its rim"
    assert_drawn("rings", curves, *parts)


def test_supports_tend_to_the_infinite_plate(monkeypatch):
    monkeypatch.setattr(finite_bodies, "OUTER_RADII", (2.0, 200.0))
    curves = FIGURES["supports"].compute(NODES)
    infinite = curve_of(curves, "N_max", support="infinite plate")[0]
    expected = {"held": 0.6219, "uniform": 0.4601, "normal": 0.4585, "half": 0.5197}
    for support in SUPPORTS:
        near, far = curve_of(curves, "N_max", support=support)
        assert near == pytest.approx(expected.get(support, near), abs=2e-4)
        slow = support == "half"  # its mean pressure falls like the radius, the others like the square
        assert far == pytest.approx(infinite, abs=6e-4 if slow else 2e-5)
        assert curve_of(curves, "half_angle_deg", support=support)[1] == pytest.approx(64.7, abs=0.2)
    parts = "load parameter 0.1", "friction coefficient 0.3", "pressure on half of the rim", "infinite plate"
    assert_drawn("supports", curves, *parts)


def test_hollow_pins_tend_to_a_load_at_the_centre(monkeypatch):
    monkeypatch.setattr(finite_bodies, "BORES", (0.0, 0.02, 0.5))
    curves = FIGURES["hollow-pins"].compute(NODES)
    for load in finite_bodies.BORE_LOADS:
        for friction in finite_bodies.FRICTIONS:
            solid, narrow, hollow = curve_of(curves, "N_max", load=load, mu=friction)
            assert narrow == pytest.approx(solid, abs=1e-3)
            assert (hollow > solid) == (load == "held")
    assert curve_of(curves, "N_max", load="uniform", mu=0.0)[2] == pytest.approx(0.558417, abs=2e-4)  # case A1
    parts = "load parameter 0.1", "friction coefficient 0.3", "rigid core in the bore", "N_{max} R/F$"
    assert_drawn("hollow-pins", curves, *parts)


def test_a_rectangular_lug_has_less_pressure_and_more_hoop_stress(monkeypatch):
    """An independent finite-element model has the peaks 0.563806 and 0.465317."""
    monkeypatch.setattr(plates, "FINE", plates.COARSE)  # errors of 2e-9
    monkeypatch.setattr(rectangular_lug, "HALF_WIDTHS", (2.5,))
    curves = FIGURES["rectangular-lug"].compute(NODES)
    for friction, peak in ((0.0, 0.563806), (0.4, 0.465317)):
        infinite, lug = curve_of(curves, "N_max", mu=friction)
        assert lug == pytest.approx(peak, abs=1e-4)
        assert lug < infinite
        hoop = [
            curve_of(curves, "hoop", plate=plate, mu=friction).max() for plate in ("rectangular lug", "infinite plate")
        ]
        assert hoop[0] > 1.6 * hoop[1]
        assert curve_of(curves, "half_width", mu=friction).tolist() == [math.inf, 2.5]
    parts = "load parameter 0.1", "friction coefficient 0.4", "6 R above", "2.5 R below", "half-width 2.5 R"
    assert_drawn("rectangular-lug", curves, *parts)


def test_rigid_pins_have_one_quantity_on_each_axis(monkeypatch):
    monkeypatch.setattr(rigid_pin, "RATIOS", (1.0, 10.0, 100.0))
    curves = FIGURES["rigid-pin"].compute(101)
    differences = curves[-1]
    assert np.all(np.diff(differences["N, centre to rigid"]) < 0.0)
    figure = FIGURES["rigid-pin"].draw(curves)
    labels = [panel.get_ylabel() for panel in figure.axes]
    assert labels == ["pressure  $N\\,R/F$", "shear traction  $T\\,R/F$", "∫|ΔN| / ∫N", "∫|ΔT| / ∫N"]
    assert [len(panel.lines) for panel in figure.axes] == [7, 7, 3, 3]
    parts = "friction coefficient 0.4", "load parameter 0.1", "above: rigid pin", "below: centre load to body load"
    assert_drawn("rigid-pin", curves, *parts)


def test_every_line_of_the_half_plane_figure_has_its_quantity():
    like = Problem.from_load_parameter(half_plane.SIMILAR, 1.0, half_plane.FRICTION, "centre", "fixed")
    found = list(half_plane.like_errors(like.load_parameter(1.0), half_plane.FRICTION, 201))
    found += half_plane.like_errors(1.0, half_plane.LOW_FRICTION, 201)
    for ratio in half_plane.MU_OVER_BETA:
        found += half_plane.unlike_errors(1.0, ratio, 0.5, 201)
    quantities = {(panel, quantity) for panel, quantity, _ in found}
    drawn = {(panel, name) for panel, theory in half_plane.THEORIES.items() for name in theory.lines}
    assert drawn <= quantities
    curves = [
        Curve({"panel": panel, "quantity": name}, {"L_p": np.array([1.0, 10.0]), "error": np.array([0.3, 0.1])})
        for panel, name in sorted(quantities)
    ]
    figure = half_plane.draw(curves)
    figure.draw_without_rendering()
    for panel, theory in zip(figure.axes, half_plane.THEORIES.values(), strict=False):
        assert len([line for line in panel.lines if line.get_marker() != "None"]) == len(theory.lines)
        legend = panel.get_legend()
        assert [text.get_text() for text in legend.get_texts()] == [*theory.colours, *theory.dashes]
        box = legend.get_window_extent()
        assert 0.0 <= box.x0 < box.x1 <= figure.bbox.width
        looks = {(line.get_marker(), str(line._dash_pattern)) for line in panel.lines if line.get_marker() != "None"}
        assert len(looks) == len(theory.lines)

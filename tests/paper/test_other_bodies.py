"""The figures of other bodies, on few nodes and in few cases."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fastpin.paper import catalog, hollow_pins, rectangular_lug, supports
from fastpin.report.curves import Curve

NODES = 121


def curve_of(curves: list[Curve], column: str, **parameters: float | str) -> np.ndarray:
    found = [curve for curve in curves if column in curve.columns and curve.parameters == parameters]
    assert len(found) == 1
    return found[0][column]


def test_rings_have_the_pressures_of_the_support_table():
    """The peaks with mu = 0.3 are those of an independent trial; 121 nodes give them to 1e-4."""
    curves = catalog.script("rings").compute(NODES)
    peaks = {
        "infinite plate": max(curve_of(curves, "N", support="infinite plate")),
        **{kind: max(curve_of(curves, "N", support=kind, outer_radius=2.0)) for kind in ("held", "uniform")},
    }
    assert peaks == pytest.approx({"infinite plate": 0.5562, "held": 0.6219, "uniform": 0.4601}, abs=2e-4)
    held = [max(curve_of(curves, "N", support="held", outer_radius=outer)) for outer in (1.5, 2.0, 3.0, 4.0)]
    assert held == sorted(held, reverse=True)
    assert held[-1] > peaks["infinite plate"]


def test_supports_tend_to_the_infinite_plate(monkeypatch):
    monkeypatch.setattr(supports, "OUTER_RADII", (2.0, 200.0))
    curves = catalog.script("supports").compute(NODES)
    infinite = curve_of(curves, "N_max", support="infinite plate")[0]
    expected = {"held": 0.6219, "uniform": 0.4601, "normal": 0.4585, "half": 0.5197}
    for support in supports.SUPPORTS:
        near, far = curve_of(curves, "N_max", support=support)
        assert near == pytest.approx(expected.get(support, near), abs=2e-4)
        slow = support == "half"  # its mean pressure falls like the radius, the others like the square
        assert far == pytest.approx(infinite, abs=6e-4 if slow else 2e-5)
        assert curve_of(curves, "half_angle_deg", support=support)[1] == pytest.approx(64.7, abs=0.2)


def test_hollow_pins_tend_to_a_load_at_the_centre(monkeypatch):
    monkeypatch.setattr(hollow_pins, "BORES", (0.0, 0.02, 0.5))
    curves = catalog.script("hollow-pins").compute(NODES)
    for load in hollow_pins.LOADS:
        for friction in hollow_pins.FRICTION:
            solid, narrow, hollow = curve_of(curves, "N_max", load=load, mu=friction)
            assert narrow == pytest.approx(solid, abs=1e-3)
            assert (hollow > solid) == (load == "held")
    assert curve_of(curves, "N_max", load="uniform", mu=0.0)[2] == pytest.approx(0.558417, abs=2e-4)  # case A1


def test_a_rectangular_lug_has_less_pressure_and_more_hoop_stress(monkeypatch):
    """An independent finite-element model has the peaks 0.563806 and 0.465317."""
    monkeypatch.setattr(rectangular_lug, "HALF_WIDTHS", (2.5,))
    curves = catalog.script("rectangular-lug").compute(NODES)
    for friction, peak in ((0.0, 0.563806), (0.4, 0.465317)):
        infinite, lug = curve_of(curves, "N_max", mu=friction)
        assert lug == pytest.approx(peak, abs=1e-4)
        assert lug < infinite
        hoop = [
            curve_of(curves, "hoop", plate=plate, mu=friction).max() for plate in ("rectangular lug", "infinite plate")
        ]
        assert hoop[0] > 1.6 * hoop[1]
        assert curve_of(curves, "half_width", mu=friction).tolist() == [math.inf, 2.5]

"""Fatigue of bush and lug of a joint whose bush slips: the stresses are those of each state."""

from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin import Points
from fastpin.damage import fatigue
from fastpin.states.error_bars import bars
from tests.support.refusals import refused
from tests.support.seats import sample_case, sample_seat

THETA = np.linspace(-3.0, 3.0, 7)


@pytest.mark.parametrize("body", ["seat", "plate"])
def test_fatigue_reads_the_stress_of_each_state(body: str) -> None:
    """Smith, Watson and Topper by hand: the largest of sigma_max times the amplitude of the strain over all planes."""
    result = sample_seat()
    states = result[6:]
    found = result.fatigue("smith-watson-topper", body, points=Points.at_depth(0.0, THETA))
    problem = result.problem
    material = problem.pair.plate if body == "seat" else problem.surfaces.plate
    stresses = [state.stress(Points.at_depth(0.0, THETA), body) for state in states]
    assert problem.pair.plane == "strain"
    best = np.zeros(THETA.size)
    for angle in np.linspace(0.0, np.pi, 721):
        cos, sin = np.cos(angle), np.sin(angle)
        normal = np.array([s.radial * cos**2 + s.hoop * sin**2 + 2.0 * s.shear * cos * sin for s in stresses])
        whole = np.array([s.radial + s.hoop for s in stresses])
        strain = (1.0 + material.nu) / material.E * (normal - material.nu * whole)
        best = np.maximum(best, np.maximum(normal.max(axis=0), 0.0) * 0.5 * np.ptp(strain, axis=0))
    assert best.max() > 1e3
    assert found.parameter == pytest.approx(best, rel=1e-3, abs=1e-3 * best.max())


def test_fatigue_at_the_seat_differs_from_that_of_a_bonded_bush() -> None:
    """The tractions of the seat count: with those of another load the parameter is another one."""
    states = sample_seat()[6:]
    given = fatigue(states, "smith-watson-topper", "seat").hot_spot.parameter
    still = [replace(state, seat=states[0].seat) for state in states]
    assert fatigue(still, "smith-watson-topper", "seat").hot_spot.parameter < 1e-9 * given


def test_the_seat_alone_has_the_fatigue_of_the_lug_and_none_of_the_bush() -> None:
    result = sample_seat()
    points = Points.at_depth(0.0, THETA)
    seat = result.seat.fatigue("smith-watson-topper", points=points)
    lug = result.fatigue("smith-watson-topper", "seat", points=points)
    assert seat.parameter == pytest.approx(lug.parameter, rel=1e-12)
    words = "body: the pin of a seat is its bush: its stress is that of the joint, whose pin loads it, too"
    assert str(refused(result.seat.fatigue, "smith-watson-topper", "pin")) == words


@pytest.mark.gate
def test_states_of_the_seat_have_error_bars() -> None:
    case = sample_case()
    result = fastpin.solve(case.problem, [{"P": 4e6}, {"Q": 2e6}], nodes=101, error_bars=True)
    for state, joint, coarse in zip(result.seat, result, result.seat.coarse, strict=True):
        known = state.error_bars
        assert dict(known) == bars(state, coarse)
        assert np.isfinite(known["peak_pressure"])
        assert np.isfinite(known["rotation"])
        assert 0.0 < known["peak_hoop"] < 0.2 * state.peak_hoop_stress().value
        assert known.pressure.shape == state.pressure.shape
        assert joint.error_bars["peak_hoop_seat"] > 0.0

"""Tables of states."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import MATERIALS, Material, MaterialPair, Problem, State, solve
from fastpin.kernels.status import OPEN
from fastpin.model.angles import interval_from_bottom
from fastpin.report import state_table
from fastpin.report.states import hoop_line
from tests.support.samples import PAIR, sample_result, with_values


def test_long_tables_are_cut_in_the_middle() -> None:
    corners = [{"P": 1e6 + k} for k in range(100)]
    text = state_table(sample_result().problem, list(sample_result(corners)))
    assert len(text.splitlines()) < 60
    assert "60 more" in text


def test_many_zones_have_their_number_and_both_ends(states: list[State]) -> None:
    state = states[0]
    many = with_values(state, status=np.where(np.arange(state.status.size) % 4 == 0, OPEN, state.status))
    ends = interval_from_bottom(many.contact[0][0], many.contact[-1][1])
    assert len(many.contact) > 6
    assert f"{len(many.contact)} zones within {ends[0]:.2f} to {ends[1]:.2f}" in state_table(state.problem, [many])


@pytest.fixture(scope="module")
def states() -> list[State]:
    return list(solve(Problem(PAIR, 0.01, 2e-5, 0.4), [{"P": 2e6}, {"sxx": 5e7}, {"P": 1e6}], nodes=61))


def test_the_largest_hoop_stress_is_told_with_its_concentrations(states: list[State]) -> None:
    peaks = [state.peak_hoop_stress() for state in states]
    assert peaks[1].value == max(peak.value for peak in peaks)
    line = hoop_line(states[0].problem, states)
    assert f"{peaks[1].value / 1e6:.4g} MPa" in line
    assert "load point 2; " in line
    assert (
        f"Kt {peaks[1].kt_bearing:.4g} on the bearing stress; Kt {peaks[1].kt_gross:.4g} on the remote stress" in line
    )
    parts = [float(word) for word in line.rsplit("it is ", 1)[1].split() if word[0].isdigit()]
    sums = parts[0] * peaks[1].gross_stress + parts[1] * peaks[1].bearing_stress
    assert sums == pytest.approx(peaks[1].value, rel=1e-3)


def test_without_remote_stress_there_is_one_concentration(states: list[State]) -> None:
    line = hoop_line(states[0].problem, states[:1])
    assert line.endswith(f"load point 1; Kt {states[0].peak_hoop_stress().kt_bearing:.4g} on the bearing stress")


def test_the_error_bar_of_the_hoop_stress_is_told() -> None:
    (state,) = solve(Problem(PAIR, 0.01, 2e-5, 0.4), [{"P": 2e6}], nodes=101, error_bars=True)
    bar = state.error_bars["peak_hoop"]
    assert f"{state.peak_hoop_stress().value / 1e6:.4g} +-{bar / 1e6:.2g} MPa" in hoop_line(state.problem, [state])


def test_a_peak_that_the_nodes_do_not_resolve_is_marked() -> None:
    states = solve(Problem(PAIR, 0.01, 2e-5, 0.4), [{"P": 2e6}, {"P": 5e5}], nodes=61)
    marked = [" (not resolved by the nodes) at " in hoop_line(state.problem, [state]) for state in states]
    assert marked == [not state.peak_hoop_stress().resolved for state in states]
    assert marked == [False, True]


def test_no_hoop_stress_is_told_of_a_rigid_plate_or_without_contact() -> None:
    rigid = Problem(MaterialPair(MATERIALS["steel"], Material.rigid()), 0.01, 2e-5, 0.4)
    assert hoop_line(rigid, list(sample_result(problem=rigid))) == ""
    closed = sample_result()[0]
    empty = with_values(closed, pressure=0.0, shear=0.0, status=OPEN)
    assert hoop_line(closed.problem, [empty]) == ""
    assert hoop_line(closed.problem, [empty, closed]) != ""


def test_the_stress_of_an_open_hole_is_told() -> None:
    """Kirsch: three times the stress of the sheet. No pin touches."""
    (state,) = solve(Problem(PAIR, 0.01, 2e-3, 0.4), [{"syy": 1e8}], nodes=31)
    assert not state.in_contact
    line = "largest hoop stress of the plate in all kept states: 300 MPa at 90.00 deg, load point 1; "
    assert hoop_line(state.problem, [state]) == f"{line}Kt 3 on the remote stress"


def test_repeated_states_are_looked_at_once(states: list[State], monkeypatch: pytest.MonkeyPatch) -> None:
    copies = [replace(state) for state in states] * 5
    line, looked, peak = hoop_line(states[0].problem, states), [], State.peak_hoop_stress
    monkeypatch.setattr(State, "peak_hoop_stress", lambda state, body: looked.append(state) or peak(state, body))
    assert hoop_line(states[0].problem, copies) == line
    assert len({id(state) for state in looked}) == len(states)

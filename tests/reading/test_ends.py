"""Ends of zones and peaks: made-up values whose answers are known, and how fast those of contacts converge."""

import dataclasses
import math

import numpy as np
import pytest

from fastpin import MaterialPair, Problem, solve
from fastpin.reading.half_line import End, half_line
from fastpin.reading.zones import end_angle
from fastpin.verification import closed_forms
from tests.support.half_line import columns

BOTTOM = -0.5 * math.pi
CYCLE = [{"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}]
UNLIKE = MaterialPair.from_dundurs(0.6, 0.25, nu_pin=0.3)


# --- made-up values ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("exponent", [0.42, 0.5, 0.56])
@pytest.mark.parametrize("beyond", [0.1, 0.5, 0.93])
def test_an_edge_is_read_in_either_direction(exponent, beyond):
    """Values of the half line: the nodes of a zone whose traction falls to zero at a known place."""
    line = half_line(exponent)
    theta = 0.7 + 0.01 * np.arange(40)
    values = columns(End(line, 0, 1, 4, -beyond), 40) @ [1.0, 0.02, -1e-4]
    found = end_angle(theta, values, line, 0.69)
    assert found == pytest.approx(0.7 - 0.01 * beyond, abs=1e-8)
    assert end_angle(-theta, values, line, -0.69) == pytest.approx(-found, abs=1e-14)


def test_an_edge_without_a_shape_is_where_the_outermost_nodes_point():
    line, theta = half_line(0.5), 0.7 + 0.01 * np.arange(60)
    noise = np.random.default_rng(1).uniform(0.1, 1.0, 60)
    noise[:2] = 0.2, 0.3
    zero = 0.7 - 0.01 * 0.2**2 / (0.3**2 - 0.2**2)
    assert end_angle(theta, noise, line, 0.69) == pytest.approx(zero)
    assert end_angle(theta[:2], noise[:2], line, 0.69) == pytest.approx(zero)
    assert end_angle(theta[:2], np.array([0.29, 0.3]), line, 0.69) == pytest.approx(0.69)  # no farther
    for values in (noise[:1], noise[1::-1]):
        assert end_angle(theta[: values.size], values, line, 0.69) == pytest.approx(0.695)  # halfway


# --- solved contacts --------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_contact_edges_are_second_order(similar):
    """Against Persson's closed form; on 401 nodes the half-angle is right to a fiftieth of the node distance."""
    sizes, rng = np.array([101, 201, 401, 801]), np.random.default_rng(7)
    squares = np.zeros(sizes.size)
    for load_parameter in 10.0 ** rng.uniform(-2.0, 0.3, 6):
        exact = closed_forms.persson_half_angle(load_parameter)
        problem = Problem.from_load_parameter(similar, load_parameter, 0.0)
        for k, nodes in enumerate(sizes):
            wide = exact * rng.uniform(1.1, 1.3)
            state = solve(problem, [{"P": 1.0}], nodes=int(nodes), arc=(BOTTOM - wide, BOTTOM + wide))[-1]
            error = state.contact[0][1] - BOTTOM - exact
            squares[k] += error**2
            assert abs(error) < (0.1 if nodes == 101 else 0.02) * state.grid.weights[1]
    order, _ = np.polyfit(np.log(sizes), np.log(np.sqrt(squares)), 1)
    assert -order > 1.9


@pytest.mark.gate
def test_peaks_of_shear_and_borders_of_a_cycle(similar):
    """P, Q, -Q, Q: the third peak is where the border of the first half cycle was, and far from any border now."""
    problem = Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed")
    fine, middle, coarse = (solve(problem, CYCLE, nodes=nodes) for nodes in (1201, 401, 201))
    for k, bounds in enumerate([(1e-5, 1e-4), (4e-5, 1e-4), (2e-5, 1e-4), (2e-4, 8e-4)]):
        for result, bound in zip((middle, coarse), bounds, strict=True):
            assert result[k].peak_shear == pytest.approx(fine[k].peak_shear, rel=bound)
    assert middle[3].peak_shear_angle == pytest.approx(middle[1].stick[0][0], abs=2e-4)
    borders = np.array(middle[3].stick[0])
    assert np.min(np.abs(middle[3].peak_shear_angle - borders)) > 0.2
    nodal = np.abs(middle[3].shear).max() / abs(fine[3].peak_shear) - 1.0
    assert abs(nodal) > 3e-3  # what the fit makes good
    for k, ends in ((1, (0, 1)), (2, (0, 1)), (3, (1,))):
        for end in ends:
            assert middle[k].stick[0][end] == pytest.approx(fine[k].stick[0][end], abs=2e-4)
        assert middle[k].contact[0] == pytest.approx(fine[k].contact[0], abs=5e-5)


def test_readings_of_a_mirrored_contact_are_mirrored(similar):
    """At the same grid: no direction is preferred, and no window begins a node earlier because of rounding."""
    problem = Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed")
    right = solve(problem, CYCLE, nodes=161, arc=(BOTTOM - 1.0, BOTTOM + 1.0))
    left = solve(problem, [{name: -value if name == "Q" else value for name, value in c.items()} for c in CYCLE],
                 nodes=161, arc=(BOTTOM - 1.0, BOTTOM + 1.0))  # fmt: skip
    for one, other in zip(right[1:], left[1:], strict=True):
        assert one.peak_shear == pytest.approx(-other.peak_shear, rel=1e-9)
        assert one.peak_shear_angle - BOTTOM == pytest.approx(BOTTOM - other.peak_shear_angle, abs=1e-8)
        for zones, mirrored in ((one.contact, other.contact), (one.stick, other.stick)):
            (start, stop), (first, last) = zones[0], mirrored[0]
            assert (start - BOTTOM, stop - BOTTOM) == pytest.approx((BOTTOM - last, BOTTOM - first), abs=1e-8)


@pytest.mark.gate
def test_exponents_of_edges_and_borders_of_unlike_bodies():
    """(T21), (T26): with them 201 nodes agree with 801 at edges and borders; with others they do not."""
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    coarse, fine = (solve(problem, [{"P": 1.0}], nodes=nodes)[-1] for nodes in (201, 801))
    spacing = coarse.grid.weights[1]
    for name in ("contact", "stick"):
        assert getattr(coarse, name)[0] == pytest.approx(getattr(fine, name)[0], abs=0.005 * spacing)
    tilt = math.atan(0.6 * 0.25) / math.pi
    assert coarse.coupling.tilt[1:] == pytest.approx(np.full((2, 201), tilt))
    for other in (0.0, -tilt):
        wrong = [dataclasses.replace(state) for state in (coarse, fine)]
        for state in wrong:
            changed = dataclasses.replace(state.coupling, tilt=np.full((3, state.theta.size), other))
            state.__dict__["coupling"] = changed
        assert wrong[0].contact[0][1] != pytest.approx(wrong[1].contact[0][1], abs=0.01 * spacing)
        assert wrong[0].stick[0][1] != pytest.approx(fine.stick[0][1], abs=0.01 * spacing)


@pytest.mark.gate
def test_the_peak_shear_of_unlike_bodies_is_a_little_beyond_the_border():
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    for nodes in (201, 801):
        state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
        assert abs(state.peak_shear) == pytest.approx(0.241913, rel=3e-4)
        beyond = abs(state.peak_shear_angle - BOTTOM) - state.stick[0][1] + BOTTOM
        assert 0.004 < beyond < 0.012


@pytest.mark.gate
def test_the_pressure_of_unlike_bodies_has_a_corner_where_they_first_touched():
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    coarse, fine = (solve(problem, [{"P": 1.0}], nodes=nodes)[-1] for nodes in (201, 1201))
    assert coarse.peak_pressure == pytest.approx(fine.peak_pressure, rel=2e-4)
    bottom = np.argmax(fine.pressure)
    slopes = np.diff(fine.pressure[bottom - 1 : bottom + 3])
    assert slopes[0] > 0.0 > slopes[1]
    assert abs(slopes[1]) > 0.5 * abs(slopes[2])  # a smooth top would have a third of it

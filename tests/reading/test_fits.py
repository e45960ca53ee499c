"""Fits of edges, borders, cusps and corners: made-up tractions whose answers are known, and how fast they converge."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from fastpin.model.materials import MaterialPair
from fastpin.model.problem import Problem
from fastpin.reading import fits
from fastpin.solver.solving import solve
from fastpin.verification import closed_forms

BOTTOM = -0.5 * math.pi
CYCLE = [{"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}]
UNLIKE = MaterialPair.from_dundurs(0.6, 0.25, nu_pin=0.3)


def order(sizes, errors):
    return -np.polyfit(np.log(sizes), np.log(errors), 1)[0]


# --- made-up tractions ------------------------------------------------------------------------------------------


def from_an_edge(place, exponent, nodes, decaying=0.0, first=0.7):
    """Nodes 1, 2, ... of a zone whose edge is at `place`; the first node is at `first`, and values there."""
    theta = first + 0.01 * np.arange(nodes)
    x = (theta - place) / 0.01
    powered = (x + 0.02 * x**2 - 1e-4 * x**3 + decaying / x) / 10.0
    return theta, powered**exponent


@pytest.mark.parametrize("exponent", [0.42, 0.5, 0.56])
@pytest.mark.parametrize("beyond", [0.1, 0.5, 0.93])
def test_an_edge_is_found_exactly(exponent, beyond):
    theta, values = from_an_edge(0.7 - 0.01 * beyond, exponent, 40)
    found = fits.edge(theta, values, exponent, 0.69, 40)
    assert found == pytest.approx(0.7 - 0.01 * beyond, abs=1e-10)
    mirrored = fits.edge(-theta, values, exponent, -0.69, 40)
    assert mirrored == pytest.approx(-found, abs=1e-14)


def test_a_part_that_falls_with_the_distance_does_not_move_an_edge():
    theta, values = from_an_edge(0.694, 0.5, 60, decaying=0.02)
    values[:3] *= [0.9, 1.03, 0.999]  # as nodes beside an edge are
    assert fits.edge(theta, values, 0.5, 0.69, 60) == pytest.approx(0.694, abs=2e-6)
    assert fits.edge(theta, values, 0.5, 0.69, 5) == pytest.approx(0.694, abs=2e-6)  # too few to be limited to them


def test_an_edge_without_a_shape_is_where_the_outermost_nodes_point():
    theta = 0.7 + 0.01 * np.arange(60)
    noise = np.random.default_rng(1).uniform(0.1, 1.0, 60)
    noise[:2] = 0.2, 0.3
    line = 0.7 - 0.01 * 0.2**2 / (0.3**2 - 0.2**2)
    assert fits.edge(theta, noise, 0.5, 0.69, 60) == pytest.approx(line)
    assert fits.edge(theta[:2], noise[:2], 0.5, 0.69, 2) == pytest.approx(line)
    assert fits.edge(theta[:2], np.array([0.29, 0.3]), 0.5, 0.69, 2) == pytest.approx(0.69)  # no farther
    assert fits.edge(theta[:5], np.sqrt(np.arange(0.3, 5.0)), 0.5, 0.69, 5) == pytest.approx(0.697)
    for values in (noise[:1], noise[1::-1], np.ones(60)):
        assert fits.edge(theta[: values.size], values, 0.5, 0.69, 60) == pytest.approx(0.695)  # halfway


def test_an_edge_agrees_with_the_nearest_nodes():
    """The limit stands in docs/accuracy-tables.md. Beyond the eighth node the values point to another edge."""
    x = np.arange(80.0)
    for seed in range(40):
        rng = np.random.default_rng(seed)
        powered = x + 0.3 + np.where(x < 8.0, rng.uniform(-0.03, 0.03, 80), rng.uniform(-0.3, 0.3))
        zeros = np.roots(np.polyfit(x[2:8], powered[2:8], 2))
        nearest = zeros[np.argmin(np.abs(zeros))].real
        line = fits.by_two_nodes(*np.sqrt(powered[:2]), 0.5, -1.0)
        found = fits.edge(0.01 * x, np.sqrt(powered), 0.5, -0.01, 80) / 0.01
        assert abs(found - nearest) < 0.12 or found == pytest.approx(line, abs=1e-9)


def test_beyond_the_next_border_nothing_is_used():
    theta, values = from_an_edge(0.6937, 0.5, 80)
    values[12:] *= 1.0 + 0.2 * np.sqrt(np.arange(68.0))  # a kink at the thirteenth node
    assert fits.edge(theta, values, 0.5, 0.69, 12) == pytest.approx(0.6937, abs=1e-9)


@pytest.mark.parametrize("place", [-1.3, 0.0, 0.4, 1.1])
def test_a_cusp_that_a_border_has_left(place):
    x = np.arange(-50.0, 51.0)
    before = np.maximum(place - x, 0.0)
    values = 2.0 - 0.01 * x + 1e-4 * x**2 - 0.05 * np.sqrt(before) * (1.0 - 0.01 * before)
    values[np.abs(x) <= 2.0] -= 0.003
    exact = 2.0 - 0.01 * place + 1e-4 * place**2
    found = fits.cusp(x, values, 0.5)
    assert found is not None
    assert (found.place, found.value) == pytest.approx((place, exact), abs=2e-4)
    falling = values - 0.003 * np.where(x < place, np.maximum(before, 1.0) ** -1.5, 0.0)
    found = fits.cusp(x, falling, 0.5)
    assert found is not None
    assert found.place == pytest.approx(place, abs=0.02)
    assert found.value == pytest.approx(exact, abs=3e-4)
    assert fits.cusp(x[42:59], values[42:59], 0.5) is not None  # as many as the narrowest window has
    assert fits.cusp(x[43:59], values[43:59], 0.5) is fits.cusp(x[42:58], values[42:58], 0.5) is None  # too few nodes


def test_no_cusp_where_there_is_none():
    x = np.arange(-50.0, 51.0)
    found = fits.cusp(x, np.sin(0.2 * x), 0.5)
    assert found is None or found.error > 1e-4


@pytest.mark.parametrize("exponent", [0.45, 0.5, 0.55])
def test_the_bound_beside_a_border(exponent):
    x = np.arange(-40.0, 41.0) + 0.3
    slipping = np.maximum(x, 0.0)
    smooth = 1.0 - 0.01 * x - 1e-4 * x**2
    falling = fits.border_peak(x, smooth - 0.03 * slipping**exponent, exponent)
    assert falling is not None
    assert falling.value == pytest.approx(1.0, abs=1e-9)
    assert falling.place == 0.0
    rising = fits.border_peak(x, smooth + 0.03 * slipping**exponent, exponent)
    fine = np.linspace(0.0, 20.0, 200_001)
    curve = 1.0 - 0.01 * fine - 1e-4 * fine**2 + 0.03 * fine**exponent
    assert rising is not None
    assert rising.value == pytest.approx(curve.max(), abs=1e-9)
    assert rising.place == pytest.approx(fine[np.argmax(curve)], abs=1e-3)
    assert fits.border_peak(x, np.random.default_rng(2).uniform(0.0, 1.0, x.size), exponent) is None
    assert fits.border_peak(x[36:45], smooth[36:45], exponent) is None


def test_the_richest_bound_beside_a_border_is_found_from_twelve_nodes():
    """A quartic and three terms of the cusp. The two nodes nearest to the border on either side are left out."""

    def bound(x):
        beyond = np.maximum(x, 0.0)
        return np.polyval([2e-6, 2e-5, -1e-4, -0.01, 1.0], x) + np.sqrt(beyond) * np.polyval(
            [3e-4, -0.012, 0.05], beyond
        )

    x = np.arange(-8.0, 9.0) + 0.3
    found = fits.border_peak(x, bound(x) + np.where(np.abs(x) < 2.0, 0.02 * (-1.0) ** np.arange(17), 0.0), 0.5)
    assert found is not None
    assert found.value == pytest.approx(bound(np.linspace(0.0, 8.0, 200_001)).max(), abs=1e-8)


def test_a_corner_between_two_branches():
    x = np.arange(-40.0, 41.0)
    values = 3.0 - 0.02 * np.abs(x) - 1e-4 * x**2
    values[39:42] = 2.97  # the nodes of the first contact
    found = fits.corner(x, values)
    assert found is not None
    assert found.value == pytest.approx(3.0, abs=1e-9)
    assert fits.corner(x, 3.0 - 1e-3 * x**2) is None
    assert fits.corner(x, 3.0 + 0.01 * x - 0.002 * np.abs(x)) is None


# --- solved contacts --------------------------------------------------------------------------------------------


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
    assert order(sizes, np.sqrt(squares)) > 1.9


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


def test_exponents_of_edges_and_borders_of_unlike_bodies():
    """(T21), (T26): with them 201 nodes agree with 801 at edges and borders; with others they do not."""
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    coarse, fine = (solve(problem, [{"P": 1.0}], nodes=nodes)[-1] for nodes in (201, 801))
    spacing = coarse.grid.weights[1]
    for name in ("contact", "stick"):
        assert getattr(coarse, name)[0] == pytest.approx(getattr(fine, name)[0], abs=0.005 * spacing)
    tilt = math.atan(0.6 * 0.25) / math.pi
    assert tilt == pytest.approx(coarse.tilt)
    for other in (0.0, -tilt):
        wrong = [dataclasses.replace(state) for state in (coarse, fine)]
        for state in wrong:
            state.__dict__["tilt"] = other
        assert wrong[0].contact[0][1] != pytest.approx(wrong[1].contact[0][1], abs=0.01 * spacing)
        assert wrong[0].stick[0][1] != pytest.approx(fine.stick[0][1], abs=0.01 * spacing)


def test_the_peak_shear_of_unlike_bodies_is_a_little_beyond_the_border():
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    for nodes in (201, 801):
        state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
        assert abs(state.peak_shear) == pytest.approx(0.241913, rel=3e-4)
        beyond = abs(state.peak_shear_angle - BOTTOM) - state.stick[0][1] + BOTTOM
        assert 0.004 < beyond < 0.012


def test_the_pressure_of_unlike_bodies_has_a_corner_where_they_first_touched():
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.6, "body")
    coarse, fine = (solve(problem, [{"P": 1.0}], nodes=nodes)[-1] for nodes in (201, 1201))
    assert coarse.peak_pressure == pytest.approx(fine.peak_pressure, rel=2e-4)
    bottom = np.argmax(fine.pressure)
    slopes = np.diff(fine.pressure[bottom - 1 : bottom + 3])
    assert slopes[0] > 0.0 > slopes[1]
    assert abs(slopes[1]) > 0.5 * abs(slopes[2])  # a smooth top would have a third of it

"""Edges, borders and peaks read between nodes, on made-up tractions whose answers are known."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.kernels.status import OPEN, STICK
from fastpin.reading import peaks, zones
from fastpin.reading.cusps import ShearNodes
from fastpin.reading.exponents import isotropic_coupling
from fastpin.reading.marks import Marks

SAMPLED = 0.2
"""Largest error of an edge, in node distances, that is read from samples of a root.

The nodal values of a solved contact differ from samples near an edge; tests/states/test_half_line.py has such values.
The largest error here is 0.18.
"""


def contact(grid, values):
    """The intervals of a contact of like bodies with these nodal pressures (n,)."""
    status = np.where(values > 0.0, STICK, OPEN)
    return zones.contact_intervals(grid, status, values, isotropic_coupling(np.zeros(grid.size).tobytes(), 0.0))


def half_circle(theta, start, stop):
    """sqrt((theta - start)(stop - theta)) inside, 0 outside."""
    return np.sqrt(np.clip((theta - start) * (stop - theta), 0.0, None))


T = np.linspace(-1.0, 1.0, 300)
GRADED = Grid(1.5 * (T + 0.1 * np.sin(np.pi * T)))


@pytest.mark.parametrize(
    ("grid", "ends"),
    [*((Grid.arc(-2.0, 0.5, nodes), (-1.7123, 0.2345)) for nodes in (60, 200, 1000)), (GRADED, (-1.1, 0.9))],
    ids=["60", "200", "1000", "graded"],
)
def test_square_root_edges(grid, ends):
    found = contact(grid, half_circle(grid.theta, *ends))[0]
    assert found == pytest.approx(ends, abs=SAMPLED * grid.weights.max())


def test_zones_across_the_seam_of_the_circle():
    grid = Grid.circle(400, start=0.0)
    values = half_circle(np.where(grid.theta > math.pi, grid.theta - 2.0 * math.pi, grid.theta), -0.5, 0.7)
    found = contact(grid, values)
    assert len(found) == 1
    assert found[0] == pytest.approx((2.0 * math.pi - 0.5, 2.0 * math.pi + 0.7), abs=SAMPLED * grid.weights[0])
    full = contact(grid, np.ones(400))
    assert full == [(0.0, 2.0 * math.pi)]
    assert contact(grid, np.zeros(400)) == []


def test_several_zones_and_tiny_ones():
    grid = Grid.arc(0.0, 3.0, 301)
    values = half_circle(grid.theta, 0.3, 1.1) + half_circle(grid.theta, 1.9, 2.6)
    values[150] = 0.1  # a zone of one node ends halfway to its neighbours
    found = contact(grid, values)
    assert np.allclose(found, [(0.3, 1.1), (1.495, 1.505), (1.9, 2.6)], atol=SAMPLED * 0.01)


def test_slip_zones_are_what_is_left_of_the_contact():
    grid = Grid.arc(-1.0, 1.0, 201)
    status = np.full(201, OPEN, dtype=np.int8)
    status[(grid.theta > -0.8) & (grid.theta < 0.8)] = 1
    status[(grid.theta > -0.3) & (grid.theta < 0.2)] = STICK
    status[(grid.theta > 0.2) & (grid.theta < 0.8)] = -1
    left = zones.complement(grid, [(-0.8, 0.8)], [(-0.3, 0.2)], status)
    assert left == [(-0.8, -0.3, 1), (0.2, 0.8, -1)]
    status[(grid.theta > -0.305) & (grid.theta < 0.205)] = 1
    assert [zone[2] for zone in zones.complement(grid, [(-0.8, 0.8)], [], status)] == [1, -1]


@pytest.mark.parametrize("turn", [-2.0 * math.pi, 0.0, 2.0 * math.pi, 4.0 * math.pi])
def test_slip_zones_of_a_contact_whole_turns_away(turn):
    grid = Grid.circle(100, start=0.0)
    status = np.full(100, OPEN, dtype=np.int8)
    status[(grid.theta > 1.0) & (grid.theta < 2.0)] = 1
    status[(grid.theta > 2.0) & (grid.theta < 3.0)] = -1
    left = zones.complement(grid, [(1.0 + turn, 3.0 + turn)], [], status)
    assert [zone[2] for zone in left] == [1, -1]
    assert np.allclose([zone[:2] for zone in left], [(1.0 + turn, 2.0 + turn), (2.0 + turn, 3.0 + turn)], atol=0.04)


def test_stick_zones_of_a_contact_all_round():
    grid = Grid.circle(100, start=0.0)
    status = np.ones(100, dtype=np.int8)
    sticking = (grid.theta < 1.0) | (grid.theta > 5.0)
    status[sticking] = STICK
    none, pressure = np.zeros(100), np.ones(100)
    coupling = isotropic_coupling(none.tobytes(), 0.0)
    shear = np.where(sticking, 0.0, 1.0)
    nodes = ShearNodes(grid, pressure, shear, sticking, Marks(), np.ones(100), coupling)
    whole = contact(grid, pressure)
    stick = nodes.stick_intervals(np.ones(100, dtype=bool), whole)
    assert len(stick) == 1
    assert stick[0] == pytest.approx((5.0, 2.0 * math.pi + 1.0), abs=0.07)
    (slip,) = zones.complement(grid, whole, stick, status)
    assert slip == (stick[0][1], stick[0][0] + 2.0 * math.pi, 1)


def test_slip_zones_between_two_stick_zones_of_a_contact_all_round():
    """The stick zones come in any order, a turn apart."""
    grid = Grid.circle(100, start=0.0)
    status = np.where(grid.theta < 2.0, 1, -1).astype(np.int8)
    status[(grid.theta < 0.7) | (grid.theta > 5.5) | ((grid.theta > 2.0) & (grid.theta < 3.0))] = STICK
    turn = 2.0 * math.pi
    slip = zones.complement(grid, [(0.0, turn)], [(5.5, 0.7 + turn), (2.0, 3.0)], status)
    assert [zone[2] for zone in slip] == [1, -1]
    assert np.allclose([zone[:2] for zone in slip], [(0.7 + turn, 2.0 + turn), (3.0 + turn, 5.5 + turn)])


def test_peaks_between_nodes():
    grid = Grid.arc(-1.0, 1.0, 60)
    smooth = 2.0 - 3.0 * (grid.theta - 0.1234) ** 2
    assert peaks.pressure_peak(grid, smooth) == pytest.approx((2.0, 0.1234), abs=1e-12)
    kink = 2.0 - np.abs(grid.theta - grid.theta[20])
    assert peaks.pressure_peak(grid, kink) == (2.0, grid.theta[20])


def test_the_parts_of_a_solved_contact_fit_together(similar):
    problem = Problem.from_load_parameter(similar, 0.05, 0.55, "body")
    for state in solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=301, between=4):
        (contact,) = state.contact
        parts = sorted([*state.stick, *[zone[:2] for zone in state.slip_zones]])
        assert parts[0][0] == pytest.approx(contact[0])
        assert parts[-1][1] == pytest.approx(contact[1])
        for (_, end), (begin, _) in pairwise(parts):
            assert begin == pytest.approx(end, abs=1e-8)
        for start, stop, sign in state.slip_zones:
            middle = int(np.argmin(np.abs(state.theta - 0.5 * (start + stop))))
            assert state.status[middle] in (sign, STICK)
            assert sign * state.shear[middle] <= 0.0
        largest = float(np.abs(state.shear).max())  # under P alone both sides are equal up to rounding
        assert abs(state.peak_shear) >= largest * (1.0 - 1e-10)
        assert abs(state.peak_shear) < 1.02 * np.abs(state.shear).max()
        assert contact[0] <= state.peak_shear_angle <= contact[1]


def test_a_sticking_node_at_coulombs_bound_counts_as_slipping(similar):
    """At the end of a step a node may have |T| = mu N before its status changes."""
    problem = Problem.from_load_parameter(similar, 0.1, 0.4)
    state = solve(problem, [{"P": 1.0}, {"Q": 0.1}], nodes=41).states[-1]
    slipping = np.flatnonzero((state.status != OPEN) & (state.status != STICK))
    assert slipping.size > 1
    status = state.status.copy()
    status[slipping] = STICK
    (before,), (after,) = state.stick_runs, replace(state, status=status).stick_runs
    np.testing.assert_array_equal(after[0], before[0])

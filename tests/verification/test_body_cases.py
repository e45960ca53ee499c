"""Joints with finite bodies: the press fit of a bush, and convergence in nodes."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.bodies import Bushing
from tests.support.bodies import UNLIKE
from tests.support.checks.body_cases import CASES
from tests.support.tiers import some_survey

FINE = (1601, 0.0)
"""The nodes of the table, and the change of the peak pressure with more nodes."""


def test_a_press_fit_makes_the_clearance_smaller():
    """A bush with an interference behaves as one without, with the smaller clearance."""
    bush = Bushing(UNLIKE.plate, 1.25, interference=0.05)
    pressed = Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=bush)
    assert pressed.assembled_clearance < 0.1
    smaller = Problem.from_load_parameter(
        UNLIKE, pressed.assembled_clearance, 0.3, plate_body=replace(bush, interference=0.0)
    )
    grid = Grid.arc(-3.1, -0.05, 101)
    one, two = (solve(problem, [{"P": 1.0}], grid=grid)[-1] for problem in (pressed, smaller))
    assert one.pressure == pytest.approx(two.pressure, abs=1e-13)
    assert one.shear == pytest.approx(two.shear, abs=1e-13)


@pytest.mark.gate
@pytest.mark.parametrize(("nodes", "change"), some_survey([(201, 3e-5), (801, 1e-6), FINE], (801, 1e-6), FINE))
@pytest.mark.parametrize("name", CASES)
def test_nodes(name, nodes, change):
    """With 1,601 nodes the values are those of the table: 5e-7 (peak), 5e-7 (int N), 5e-5 (half-angle, rounded).

    From 801 to 1,601 nodes the peak changes by up to 9e-7, and int N by up to 3.5e-6; from 201 on by up to 2.4e-5.
    """
    case = CASES[name]
    found = solve(case.problem, case.history, nodes=nodes)[-1]
    assert found.peak_pressure == pytest.approx(case.peak, abs=6e-7 + change)
    assert found.grid.weights @ found.pressure == pytest.approx(case.total, abs=6e-7 + 3.5 * change)
    assert 0.5 * np.ptp(found.contact[0]) == pytest.approx(case.half_angle, abs=6e-5 + 3.0 * change)

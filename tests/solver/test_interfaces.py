"""The pin as it sees the bore of a bush that sticks."""

import numpy as np

from fastpin.elasticity.build import build_system
from fastpin.elasticity.interfaces import SEAT
from fastpin.model.grid import Grid
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.interfaces import PinView
from tests.support.seats import sample_case


def test_the_bore_has_a_profile_once_it_is_no_longer_round() -> None:
    problem = sample_case().problem
    joint = build_system(problem, Grid.circle(24), 1e3)
    now = unloaded_configuration(joint)
    assert not PinView(joint, now).system.problem.gap
    seat = joint.nodes.rows(SEAT)[: joint.nodes.rows(SEAT).size // 2]
    now.pressure[seat] += 0.1 * np.cos(2.0 * joint.alone[SEAT].grid.theta)
    bent = PinView(joint, now).system
    theta = joint.alone[0].grid.theta
    height = bent.problem.gap_at(theta)[0] / joint.scales.displacement
    shift = bent.initial_gap - joint.alone[0].initial_gap
    assert np.ptp(height) > 0.0
    assert np.abs(height - (shift - shift.mean())).max() < 1e-2 * np.ptp(height)

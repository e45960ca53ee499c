"""Curves of the tractions, for figures."""

import numpy as np

from fastpin import MaterialPair, Problem, solve
from fastpin.elasticity.tractions import RefinedTractions, Tractions
from fastpin.states.curves import traction_patches, tractions_at


def test_curves_have_no_angle_twice(similar: MaterialPair) -> None:
    state = solve(Problem.from_load_parameter(similar, 0.5, 0.0), [{"P": 1.0}], nodes=101)[-1]
    (patch,) = state.refined.tractions.patches
    angles = np.linspace(-1.6, -1.5, 1001)
    joined = np.degrees(angles) + 90.0 == np.degrees(np.nextafter(angles, 0.0)) + 90.0  # two angles, one in degrees
    middle = float(angles[joined][0])
    beside = np.nextafter(middle, 0.0)
    place = int(np.searchsorted(patch[:, 0], middle))
    patch = np.insert(patch, place, [[middle, *patch[place, 1:]], [beside, *patch[place, 1:]]], axis=0)
    state.__dict__["refined"] = RefinedTractions(Tractions((patch,)), (), ())
    (points,) = traction_patches(state)
    assert np.all(np.diff(points[:, 0]) > 0.0)


def test_curves_are_zero_beside_the_contact_and_turn_with_the_circle() -> None:
    patch = np.array([[170.0, 0.0, 0.0], [180.0, 2.0, 1.0], [200.0, 0.0, 0.0]])
    values = tractions_at([patch], np.array([169.0, 175.0, -180.0, -170.0, 190.0, 201.0, 540.0]))
    assert values[0].tolist() == [0.0, 1.0, 2.0, 1.0, 1.0, 0.0, 2.0]
    assert values[1].tolist() == [0.0, 0.5, 1.0, 0.5, 0.5, 0.0, 1.0]

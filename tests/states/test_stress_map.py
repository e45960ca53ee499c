"""Stresses as linear functions of the nodal tractions."""

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Bushing
from fastpin.elasticity.tractions import Tractions
from fastpin.reading.stress import stress_components
from fastpin.states.stress_map import StressMap
from fastpin.states.yielding import Places


@pytest.mark.parametrize("owner", ["pin", "plate", "bush"])
def test_nodal_stresses_of_a_press_fit_under_remote_stress_are_those_of_the_state(owner):
    steel, bronze = Material(210e9, 0.3), Material(103e9, 0.34)
    joint = Problem(MaterialPair(steel, steel), 10e-3, 60e-6, 0.3, plate_body=Bushing(bronze, 12.5e-3, 30e-6))
    state = solve(joint, [{"P": 1e6}, {"sxx": 4e7, "sxy": 1e7}], nodes=41)[-1]
    places = Places.of(joint, state.grid, owner)

    def stress(given: list[Tractions], remote: np.ndarray) -> np.ndarray:
        load = dict(zip(("sxx", "syy", "sxy", "temperature"), remote.tolist(), strict=True))
        return stress_components(joint, given[0], load, (places.theta, places.depth), places.body)

    map_of = StressMap(joint, [state.grid], stress)
    tractions = [(state.pressure[None], state.shear[None])]
    map_of.learn(tractions)
    remote = np.array([4e7, 0.0, 1e7, 0.0])
    there = state.stress(Points.at_depth(places.depth * 10e-3, places.theta), places.body, straight=True)
    for component, expected in enumerate((there.radial, there.hoop, there.shear)):
        found = map_of.component(component, tractions, remote)[0]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(there.hoop).max())

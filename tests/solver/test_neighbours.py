"""The inverse of neighbouring nodes and the responses of the others, against dense matrices."""

import numpy as np
import pytest

from fastpin import Grid, Material, MaterialPair, Problem
from fastpin.elasticity.system import System
from fastpin.solver.unknowns import Neighbours, TurnedNeighbours
from tests.support.laminates import RIGID, STEEL, TURNED

PLATES = {"isotropic": Material(70e9, 0.33), "laminate": TURNED}


@pytest.mark.parametrize(("grid", "low", "count"), [(Grid.circle(60), 20, 25), (Grid.arc(-2.5, 0.7, 61), 5, 40)])
@pytest.mark.parametrize("pin", [STEEL, RIGID], ids=["steel", "rigid"])
@pytest.mark.parametrize("plate", PLATES)
def test_inverse_and_responses_are_those_of_the_whole_matrix(plate, pin, grid, low, count):
    problem = Problem.from_load_parameter(MaterialPair(pin, PLATES[plate], "stress"), 0.1, 0.3)
    system = System.build(problem, grid, 1.0)
    found = Neighbours.of(system, low, count)
    assert isinstance(found, TurnedNeighbours) == (plate == "laminate")
    matrix, n, run = np.asarray(system.operator), grid.size, np.arange(low, low + count)
    others = np.setdiff1d(np.arange(n), run)
    rows, beside = np.r_[run, n + run], np.r_[others, n + others]
    core = np.linalg.inv(matrix[np.ix_(rows, rows)])
    responses = core @ matrix[np.ix_(rows, beside)]
    complement = matrix[np.ix_(beside, beside)] - matrix[np.ix_(beside, rows)] @ responses
    whole = np.tile(grid.closed | ~np.isin(others, [0, n - 1]), 2)  # the hats at the ends of an arc are halves
    assert found.core == pytest.approx(core, abs=1e-13 * np.abs(core).max())
    assert found.core == pytest.approx(found.core.T, abs=1e-13 * np.abs(core).max())
    assert found.responses()[:, whole] == pytest.approx(responses[:, whole], abs=1e-13 * np.abs(responses).max())
    one, other = found.complement()[np.ix_(whole, whole)], complement[np.ix_(whole, whole)]
    assert one == pytest.approx(other, abs=1e-13 * np.abs(complement).max())

"""The contact in a finite plate, from its outline to peak pressures."""

import pytest

from fastpin import MATERIALS, Material, MaterialPair, Problem, solve
from fastpin.elasticity.plates import plate_compliance
from tests.support.lugs import plate


@pytest.fixture(scope="module")
def compliance():
    return plate_compliance(plate(), 10).compliance


@pytest.mark.parametrize(("friction", "peak"), [(0.0, 0.563799), (0.4, 0.465304)])
def test_peaks_agree_with_finite_elements(compliance, friction, peak):
    """The peaks were computed with a matrix of 10 harmonics from finite elements of the plate."""
    like = Material(MATERIALS["steel"].E, 0.3)
    pair = MaterialPair(like, like, plane="strain")
    problem = Problem(pair, 1.0, 0.1 * pair.beta_star, friction, pin_load="body", plate_body=compliance)
    assert solve(problem, [{"P": 1.0}], nodes=401)[-1].peak_pressure == pytest.approx(peak, rel=3e-5)

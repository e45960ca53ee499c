"""One fretting history for the tests of this folder."""

import pytest

import fastpin
from fastpin.model import FatigueConstants

CONSTANTS = FatigueConstants(
    fatigue_strength=1100e6,
    strength_exponent=-0.124,
    fatigue_ductility=0.22,
    ductility_exponent=-0.59,
    shear_fatigue_strength=640e6,
    shear_strength_exponent=-0.124,
    shear_fatigue_ductility=0.38,
    shear_ductility_exponent=-0.59,
    yield_strength=379e6,
    bending_limit=140e6,
    torsion_limit=85e6,
    threshold_range=3e6,
    limit_range=200e6,
    normal_stress_factor=1.0,
    source="for tests",
)


@pytest.fixture(scope="session")
def fretting():
    """A titanium pin in an aluminium plate: P, then three cycles of Q with ten stops a step."""
    plate = fastpin.Material(70e9, 0.33, "aluminium", CONSTANTS)
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], plate)
    problem = fastpin.Problem(pair, 10e-3, 40e-6, 0.4, pin_load="body")
    history = fastpin.LoadHistory([{"P": 2.4e6}]) + fastpin.LoadHistory([{"Q": 6e5}, {"Q": -6e5}]).repeated(3)
    return fastpin.solve(problem, history, nodes=201, between=9)

"""An aluminium alloy with all constants of fatigue."""

from collections.abc import Sequence

import numpy as np

import fastpin
from fastpin.model import FatigueConstants

CONSTANTS = FatigueConstants(
    curve="2024-T3 sheet, Kt 1",
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

ALUMINIUM = fastpin.Material(70e9, 0.33, "aluminium", CONSTANTS)
PAIR = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], ALUMINIUM)
"""A titanium pin in a plate of it."""


def uniaxial(values: Sequence[float]) -> np.ndarray:
    """A stress sxx alone, in plane stress, shape (states, 1, 4)."""
    history = np.zeros((len(values), 1, 4))
    history[:, 0, 0] = values
    return history

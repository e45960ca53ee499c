"""Lives and sums of damage."""

import numpy as np
import pytest

from fastpin import damage
from tests.support.refusals import refused

SWT = (70e9, 1100e6, -0.124, 0.22, -0.59)
FS = (27e9, 600e6, -0.12, 0.4, -0.6)


def swt(cycles):
    E, strength, b, ductility, c = SWT
    return strength**2 / E * (2 * cycles) ** (2 * b) + strength * ductility * (2 * cycles) ** (b + c)


def fs(cycles):
    G, strength, b, ductility, c = FS
    return strength / G * (2 * cycles) ** b + ductility * (2 * cycles) ** c


@pytest.mark.parametrize(
    ("life", "curve", "constants"), [(damage.smith_watson_topper_life, swt, SWT), (damage.fatemi_socie_life, fs, FS)]
)
def test_lives_lie_on_the_curve(life, curve, constants):
    cycles = np.logspace(-3.0, 20.0, 50).reshape(5, 10)  # below half a cycle 2N is less than 1
    np.testing.assert_allclose(life(curve(cycles), *constants), cycles, rtol=1e-10)


def test_one_power_alone():
    """Where the plastic part vanishes, the life has a closed form."""
    found = damage.smith_watson_topper_life(1e5, 200e9, 1e9, -0.1, 1e-300, -0.6)
    assert found == pytest.approx(0.5 * (1e5 * 200e9 / 1e18) ** (-1.0 / 0.2), rel=1e-12)


def test_no_parameter_means_an_infinite_life():
    assert damage.smith_watson_topper_life([0.0, 1e5], *SWT)[0] == np.inf
    assert damage.fatemi_socie_life(0.0, *FS) == np.inf
    assert damage.smith_watson_topper_life(1e-300, *SWT) == np.inf


def test_miner():
    """n = 1e5 of 1e6, 2e4 of 1e5 and any number of an infinite life: 0.3."""
    assert damage.miner([1e5, 2e4, 1e9], [1e6, 1e5, np.inf]) == pytest.approx(0.3, rel=1e-15)
    many = damage.miner([1, 2], [[10.0, 100.0], [10.0, np.inf]])
    np.testing.assert_allclose(many, [0.3, 0.01], rtol=1e-15)


NO_COEFFICIENT = "must give a coefficient that is a positive number"

BAD = {
    "parameter: must be at least 0, not -1": (damage.smith_watson_topper_life, -1.0, *SWT),
    "fatigue_strength: must be positive, not -1": (damage.smith_watson_topper_life, 1.0, 1.0, -1.0, -1, 1, -1),
    f"fatigue_strength: {NO_COEFFICIENT}, not 0": (damage.smith_watson_topper_life, 1, 1, 1e-200, -1, 1, -1),
    f"fatigue_ductility: {NO_COEFFICIENT}, not inf": (damage.smith_watson_topper_life, 1, 1e200, 1e200, -1, 1e200, -1),
    f"shear_fatigue_strength: {NO_COEFFICIENT}, not 0": (damage.fatemi_socie_life, 1, 1e200, 1e-200, -1, 1, -1),
    "ductility_exponent: must be negative, not 0.5": (damage.smith_watson_topper_life, 1.0, 1, 1, -1, 1, 0.5),
    "shear_strength_exponent: must be negative, not 0": (damage.fatemi_socie_life, 1.0, 1, 1, 0, 1, -1),
    "counts: must be at least 0, not -1": (damage.miner, [-1], [10.0]),
    "lives: must have as many rows as there are counts, not (2,)": (damage.miner, [1], [10.0, 20.0]),
    "lives: must be above 0": (damage.miner, [1], [0.0]),
}


@pytest.mark.parametrize("sentence", BAD)
def test_bad_input(sentence):
    assert str(refused(*BAD[sentence])) == sentence

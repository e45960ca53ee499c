"""Fretting parameters and wear."""

import numpy as np
import pytest

from fastpin import damage
from tests.support.refusals import refused


def test_ruiz_by_hand():
    """s_T 200 MPa, tau 100 MPa, delta 5 um: F1 = 500 J/m^2, F2 = 1e11 Pa^2 m."""
    shear, hoop = np.array([[-100e6], [60e6]]), np.array([[200e6], [-300e6]])
    assert damage.ruiz(shear, [5e-6])[0] == pytest.approx(500.0, rel=1e-15)
    assert damage.ruiz(shear, [5e-6], hoop)[0] == pytest.approx(1e11, rel=1e-15)
    assert damage.ruiz(shear, [5e-6], -np.abs(hoop))[0] == 0.0


def test_ruiz_multiplies_stresses_of_one_stop():
    shear, hoop = np.array([[100.0], [10.0]]), np.array([[1.0], [20.0]])
    assert damage.ruiz(shear, [1.0], hoop)[0] == 200.0


def test_archard_by_hand():
    """k_w 1e-8 /MPa, p 100 MPa, slip from -5 to 5 um and back: 2e-5 um a cycle."""
    slip = np.array([[-5e-6], [5e-6], [-5e-6]])
    assert damage.archard_depth(np.full((3, 1), 100e6), slip, 1e-14)[0] == pytest.approx(2e-11, rel=1e-15)


def test_archard_takes_the_mean_pressure_of_a_step():
    depth = damage.archard_depth([[0.0, 2.0], [2.0, 2.0]], [[0.0, 0.0], [3.0, 0.0]], 0.5)
    assert depth.tolist() == [1.5, 0.0]


BAD = {
    "slip_range: must be at least 0, not -1": (damage.ruiz, [[1.0]], [-1.0]),
    "slip_range: must have the shape (1,), not (2,)": (damage.ruiz, [[1.0]], [1.0, 2.0]),
    "shear: must have the shape (stops, points), not (1,)": (damage.ruiz, [1.0], [1.0]),
    "hoop: must have the shape (1, 1), not (2, 1)": (damage.ruiz, [[1.0]], [1.0], [[1.0], [2.0]]),
    "pressure: must be at least 0, not -2": (damage.archard_depth, [[-2.0]], [[1.0]], 1.0),
    "wear_coefficient: must be positive, not 0": (damage.archard_depth, [[2.0]], [[1.0]], 0.0),
}


@pytest.mark.parametrize("sentence", BAD)
def test_bad_input(sentence):
    assert str(refused(*BAD[sentence])) == sentence

"""Numbers of a life of wear: the damage of its material points."""

import numpy as np

from fastpin.assess.wear import damage_curve
from fastpin.damage.worn import WornFatigue
from tests.support.lives import JOINT


def test_the_damage_of_a_life_is_that_after_its_last_cycle() -> None:
    """Two depths at three angles; the surface at the first angle has worn off in the end."""
    damage, depth = np.arange(18.0).reshape(3, 2, 3), np.array([0.0, 1e-6])
    worn = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [5e-7, 0.0, 0.0]])
    found = WornFatigue(
        JOINT, "smith-watson-topper", "plate", np.array([-2.0, -1.5, -1.0]), depth, np.array([0.0, 2.0, 20.0]), worn,
        np.zeros_like(damage), damage, np.full((2, 3), np.inf),
    )  # fmt: skip
    columns = damage_curve(found).columns
    assert columns["damage"].tolist() == damage[-1].ravel().tolist()
    assert columns["worn off"].tolist() == [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert columns["depth [m]"].tolist() == [0.0, 0.0, 0.0, 1e-6, 1e-6, 1e-6]

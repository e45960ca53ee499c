"""Joints of the tests of cracks."""

import fastpin

LIKE = fastpin.Material(70e9, 0.33)

DIRECTION = {"bulk": -120.0, "lug": -24.0, "Q": -8.0, "small": -24.0}
"""Angle of the mouth in each case of tests/cracks/conftest.py, deg."""


def problem_of(pin: fastpin.Material, clearance: float, friction: float, **fields) -> fastpin.Problem:
    """A plate of aluminium with a hole of 10 mm under a body-loaded pin."""
    return fastpin.Problem(fastpin.MaterialPair(pin, LIKE), 10e-3, clearance, friction, pin_load="body", **fields)

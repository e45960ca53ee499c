"""Joints whose pin snaps: problem and corners."""

from fastpin import Material, MaterialPair, Problem


def problem(pin, plate, load_parameter, friction):
    pair = MaterialPair(Material(*pin), Material(*plate))
    return Problem.from_load_parameter(pair, load_parameter, friction, "centre", "free")


GRIPPED = (
    problem((24, 0.1), (4.5, 0.25), 4.7, 0.43),
    [
        {"P": 0.48, "Q": 0.13, "sxx": -7.2, "syy": 1.3, "sxy": 0.5},
        {"P": 0.08, "Q": -0.01, "sxx": -0.1, "syy": -8.1, "sxy": 5.9},
        {"P": 0.31, "Q": 0.15, "sxx": 3.8, "syy": 6.9, "sxy": -6.2},
    ],
)
"""An oval hole grips the pin at two places and then lets it go."""

TURNED = (
    problem((8, 0.2), (7, 0.2), 0.4, 0.84),
    [
        {"P": 0.75, "Q": -0.25, "M": -0.44, "sxx": 0.2, "syy": -0.24, "sxy": -0.37},
        {"P": 0.12, "Q": 0.03, "M": -0.01, "sxx": 0.7, "syy": -0.7, "sxy": -0.67},
        {"P": 0.87, "Q": 0.39, "M": 0.44, "sxx": -0.26, "syy": -0.07, "sxy": 0.6},
    ],
)
"""A moment comes on while the hole grips the pin."""

"""Laminates of the tests, and their reference numbers: a lamina of 135, 9 and 5 GPa, nu12 = 0.3."""

from typing import NamedTuple

from fastpin import MATERIALS, Material, MaterialPair, Problem
from fastpin.model import Laminate
from tests.support.checks.laminate_rows import laminate

HARD = (0.0, 0.0, 45.0, -45.0)

RIGID, STEEL = Material.rigid(), MATERIALS["steel"]

TURNED = laminate((0.0, 30.0), 35.0)
"""A laminate without an axis of symmetry in the axes of the tests."""


class Row(NamedTuple):
    """A row of reference numbers with a body load, free rotation, and plane stress. Angles are rad from the bottom.

    The largest hoop stress is left out where it was read at points that miss it.
    """

    angles: tuple[float, ...]
    axis: float
    pin: Material
    load_parameter: float
    friction: float
    peak: float
    contact: tuple[float, float]
    stick: tuple[float, float] | None
    total: float
    hoop: float | None = None
    more: tuple[dict[str, float], ...] = ()

    def problem(self) -> Problem:
        pair = MaterialPair(self.pin, laminate(self.angles, self.axis), "stress")
        return Problem.from_load_parameter(pair, self.load_parameter, self.friction, "body")

    @property
    def history(self) -> list[dict[str, float]]:
        return [{"P": 1.0}, *self.more]


ROWS = {
    "A1": Row((0.0,), 90.0, RIGID, 0.0, 0.0, 1.000238, (-1.39177, 1.39177), None, 1.139906, 1.06207),
    "A2": Row((0.0,), 90.0, RIGID, 0.0, 0.2, 0.723857, (-1.44641, 1.44641), (-0.0705, 0.0705), 1.072214, 1.13136),
    "A3": Row((0.0,), 90.0, RIGID, 0.0, 0.4, 0.594157, (-1.50389, 1.50389), (-0.2584, 0.2584), 1.000748, 1.23740),
    "A4": Row((0.0,), 0.0, RIGID, 0.0, 0.0, 0.697298, (-1.45748, 1.45748), None, 1.534287),
    "A5": Row((0.0,), 0.0, RIGID, 0.0, 0.4, 0.510922, (-1.54553, 1.54553), (-0.1220, 0.1220), 1.150752),
    "A6": Row((45.0, -45.0), 90.0, RIGID, 0.0, 0.0, 0.611648, (-1.37628, 1.37628), None, 1.265590),
    "A7": Row((45.0, -45.0), 90.0, RIGID, 0.0, 0.2, 0.497723, (-1.42139, 1.42139), (-0.0238, 0.0238), 1.150241),
    "A8": Row(HARD, 90.0, STEEL, 0.1, 0.0, 0.805463, (-1.06714, 1.06714), None, 1.130460, 0.53570),
    "A9": Row(HARD, 90.0, STEEL, 0.1, 0.2, 0.647628, (-1.08898, 1.08898), (-0.1116, 0.1116), 1.052127, 0.59252),
    "A10": Row(HARD, 90.0, STEEL, 0.1, 0.4, 0.553829, (-1.10798, 1.10798), (-0.3835, 0.3835), 0.986397, 0.70826),
    "A11": Row(HARD, 60.0, STEEL, 0.1, 0.0, 0.776183, (-0.98379, 1.21989), None, 1.154370, 0.79054),
    "A12": Row(HARD, 60.0, STEEL, 0.1, 0.2, 0.654692, (-1.01537, 1.23046), (-0.1490, 0.0846), 1.066197, 0.91435),
    "A13": Row(HARD, 45.0, RIGID, 0.0, 0.4, 0.505444, (-1.36747, 1.71483), (-0.2545, 0.1360), 1.071516, 0.5956),
    "A14": Row((0.0,), 75.0, STEEL, 0.05, 0.0, 0.997334, (-0.92605, 1.38382), None, 1.127209, 1.40219),
    "A15": Row((0.0,), 75.0, STEEL, 0.05, 0.4, 0.669635, (-1.01112, 1.41605), (-0.3895, 0.2757), 0.988736, 1.5410),
    "A16": Row(
        (0.0, 30.0), 90.0, STEEL, 0.1, 0.3, 0.724834, (-1.20666, 0.91261), (-0.2240, 0.3068), 1.008727, 1.00455
    ),
    "A17": Row(
        HARD, 60.0, STEEL, 0.1, 0.3, 0.608485, (-0.76049, 1.55861), (-0.7605, 1.556), 1.137593,
        more=({"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}),
    ),
    "A18": Row(
        HARD, 90.0, STEEL, 0.1, 0.2, 0.638636, (-1.57793, 1.17880), (-1.041, -0.874), 1.244151, 1.83947,
        more=({"syy": 0.3}, {"sxy": 0.1}),
    ),
    "A19": Row(HARD, 60.0, STEEL, -0.05, 0.2, 0.558338, (-1.81208, 2.18969), (-0.2218, 0.1152), 1.324336, 0.43528),
}  # fmt: skip
"""Rows by name, of 1,601 nodes. A17 and A18 end with further loads."""


def orthotropic(ratio: float, shear: float, nu12: float = 0.3, axis: float = 0.0) -> Laminate:
    """A laminate with E2 = 1, E1 = `ratio` and G12 = `shear`."""
    return Laminate.from_moduli(ratio, 1.0, shear, nu12, axis=axis)

"""Radii of bores and bushes of common sizes, in mm and inches."""

import itertools
from collections.abc import Iterator

from fastpin import MATERIALS, MaterialPair, Problem
from fastpin.bodies import Bushing, Ring, Tube
from tests.support.bodies import softer_hole

INCH = 25.4
BORES = [0.5 * k for k in range(8, 50)], [INCH / 16 * k for k in range(2, 16)]
WALLS = [0.25 * k for k in range(4, 14)], [INCH / 32 * k for k in range(2, 8)]
PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["7075-T6"], "stress")


def sizes() -> Iterator[tuple[float, float]]:
    """Radii of the bore and of the bush, m, as a person writes them."""
    for bores, walls in zip(BORES, WALLS, strict=True):
        for bore, wall in itertools.product(bores, walls):
            yield float(f"{bore:.6g}e-3"), float(f"{bore + wall:.6g}e-3")


def bushed(radius: float, outer: float, any_outline: bool) -> Problem:
    around = softer_hole(outer, PAIR.plate.nu, "stress") if any_outline else Ring(3.0 * outer)
    bush = Bushing(MATERIALS["C93200"], outer, interference=1e-5, inside=around)
    return Problem(PAIR, radius, 2e-5, 0.2, plate_body=bush, pin_body=Tube(0.4 * radius))

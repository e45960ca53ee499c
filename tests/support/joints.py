"""Joints whose bush slips, and the ten cases of another program. All are dimensionless: displacements over F beta*."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from fastpin import Material, MaterialPair, Problem, Result
from fastpin.bodies import Bushing, Plate, Ring
from fastpin.kernels.status import OPEN, STICK

STEEL, BRONZE, ALUMINIUM = Material(210.0, 0.3), Material(110.0, 0.34), Material(69.0, 0.33)

Corners = list[dict[str, float]]


def turns(count: int, pieces: int = 24, sense: float = 1.0) -> Corners:
    """A unit force that rotates counter-clockwise from the bottom, in straight pieces."""
    angles = sense * 2.0 * math.pi * np.arange(count * pieces + 1) / pieces
    return [{"P": math.cos(angle), "Q": math.sin(angle)} for angle in angles]


def joint(
    clearance: float, interference: float, outer: float = 1.25, pin_load: str = "body", friction: float = 0.2,
    seat_friction: float = 0.2, bush: Material = BRONZE, **inside: Any,
) -> Problem:  # fmt: skip
    """A steel pin in a bush in an aluminium lug, dimensionless."""
    body = Bushing(bush, outer, interference, friction=seat_friction, bonded=False, **inside)
    pair = MaterialPair(STEEL, ALUMINIUM, "strain")
    return Problem.from_load_parameter(pair, clearance, friction, pin_load, plate_body=body)  # type: ignore[arg-type]


def random_bush(seed: int) -> tuple[Problem, Corners]:
    """A pin, free or held, in a bush with a friction of 0, 1e-6 to 1 in its seat; a moment acts or the hub turns."""
    rng = np.random.default_rng([71, seed])
    pin, plate, bush = (Material(10.0 ** rng.uniform(-0.4, 0.5), rng.uniform(0.2, 0.4)) for _ in range(3))
    outer, rotation = float(rng.uniform(1.1, 1.6)), str(rng.choice(["fixed", "spring", "free"], p=[0.4, 0.4, 0.2]))
    interference = float(rng.choice([-0.05, 0.0, 0.1, 0.3, 0.6]))
    held: dict[str, Any] = {"hub_radius": 0.6} if rotation != "free" and rng.random() < 0.4 else {}
    held |= {"hub_stiffness": 10.0 ** rng.uniform(-1.0, 1.5)} if rotation == "spring" else {}
    body = Bushing(
        bush, outer, interference, [Plate(), Ring(2.0 * outer, "uniform"), Ring(2.0 * outer, "half")][rng.integers(3)],
        friction=float(rng.choice([0.0, 1e-6, 10.0 ** rng.uniform(-6.0, 0.0)], p=[0.4, 0.2, 0.4])), bonded=False,
    )  # fmt: skip
    clearance = float(rng.choice([0.05, 0.3, 0.6] + [-0.05] * (interference > 0.0)))
    friction = float(rng.choice([0.0, 0.05, 0.2, 0.5, 1.0]))
    pair = MaterialPair(pin, plate, "strain" if rng.random() < 0.5 else "stress")
    problem = Problem.from_load_parameter(
        pair,
        clearance,
        friction,
        "centre",
        rotation,
        plate_body=body,
        **held,  # type: ignore[arg-type]
    )
    corners = [{"P": float(rng.uniform(0.3, 1.5)), "Q": float(rng.uniform(-0.5, 0.5))}]
    for _ in range(rng.integers(1, 5)):
        corner = {"P": float(rng.uniform(-1.0, 1.5)), "Q": float(rng.uniform(-0.6, 0.6))}
        corner = {name: value if rng.random() < 0.8 else 0.0 for name, value in corner.items()}
        if rotation != "free":
            corner["rotation"] = float(rng.uniform(-0.4, 0.4))
        elif rng.random() < 0.3:
            corner["M"] = float(rng.uniform(-0.15, 0.15))
        corners.append(corner)
    return problem, corners


def _to_and_fro(size: float, times: int) -> Corners:
    return [{"P": 1.0}, {"Q": size}, *({"Q": sense * size} for _ in range(times) for sense in (-1.0, 1.0))]


def _loop(times: int) -> Corners:
    corners = [(1.0, 0.5), (0.2, 0.5), (0.2, -0.5), (1.0, -0.5)] * times
    return [{"P": 1.0, "Q": 0.0}, *({"P": P, "Q": Q} for P, Q in corners)]


CASES: dict[str, tuple[Callable[[], Problem], Corners]] = {
    "A1": (lambda: joint(0.280496, 0.261450), [{"P": 1.0}, {"P": 0.1}] * 3),
    "A2": (lambda: joint(0.280496, 0.261450), _to_and_fro(0.5, 4)),
    "A3": (lambda: joint(0.280496, 0.261450), turns(4)),
    "A4": (lambda: joint(0.145124, 0.065363, seat_friction=0.3), [{"P": 1.0}, {"P": 0.2}]),
    "A5": (lambda: joint(0.280496, 0.261450, seat_friction=0.0), [{"P": 1.0}]),
    "A6": (
        lambda: joint(0.532143, 0.599915, 1.1, "centre", friction=0.15, seat_friction=0.15, bush=STEEL),
        _to_and_fro(0.3, 3),
    ),
    "A7": (lambda: joint(0.235372, 0.154626, inside=Ring(2.5, "held")), _to_and_fro(0.5, 2)),
    "A8": (lambda: joint(0.235372, 0.196088), [{"P": 0.5}, {"syy": 0.2}]),
    "A9": (lambda: joint(0.235372, 0.196088), _loop(6)),
    "A10": (lambda: joint(1.135372, 0.196088), turns(4)),
}  # fmt: skip
"""The cases: how to make the problem, and its history."""


def numbers(result: Result) -> dict[str, float]:
    """The numbers of the last state."""
    state, slid = result[-1], 0.0
    seat = state.seat
    for each in result.states:
        slid = slid + each.seat.slip_distance
    weights, around = state.grid.weights, seat.grid.weights
    return {
        "peak N1": state.peak_pressure,
        "int N1": float(weights @ state.pressure),
        "min N2": float(seat.pressure.min()),
        "max N2": float(seat.pressure.max()),
        "int |T2|": float(around @ np.abs(seat.shear)),
        "slip": float(np.max(slid)),
        "D2": seat.dissipation,
        "omega2": seat.rotation,
        "stick": float((seat.status == STICK).mean()),
        "open": float((seat.status == OPEN).mean()),
    }

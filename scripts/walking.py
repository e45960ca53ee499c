"""Does a bush walk only if no node of its seat sticks throughout a steady cycle?

``python -m scripts.walking [--count 200] [--turns 40] [--nodes 48]`` follows random load cycles of random joints with
bushes that slip, and compares the rotation of the bush over the last cycle with the nodes that stuck all the time.
"""

from __future__ import annotations

import argparse
import math
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.kernels.status import STICK
from fastpin.model.history import LoadHistory
from fastpin.solver.solving import solve
from scripts.seat_accuracy import joint

BETWEEN = 8
"""Kept states inside each step: a node may slip between two corners."""

WALKS, STEADY = 1e-6, 0.97
"""Rotation over the last cycle, in parts of the largest slip over R and of the rotation before, above which a bush
walks. A smaller part of the cycle before dies out."""


class Walk(NamedTuple):
    """The last cycles of one joint.

    Attributes
    ----------
    last, before : float
        Rotation of the bush over the last cycle and over the one before.
    sticking : int
        Nodes of the seat that stuck throughout the last cycle.
    slip : float
        Largest slip distance of a node over the last cycle.
    """

    last: float
    before: float
    sticking: int
    slip: float

    @property
    def walks(self) -> bool:
        """Whether the bush goes on walking."""
        return abs(self.last) > WALKS * max(self.slip, 1e-6) and abs(self.last) > STEADY * abs(self.before)


def random_walk(seed: int, cycles: int, nodes: int) -> Walk | None:
    """Follow a random cycle; None if it can't be followed."""
    rng = np.random.default_rng(seed)
    problem = joint(
        rng.uniform(0.1, 1.5), rng.uniform(0.05, 0.45), 1.0 + rng.uniform(0.1, 0.6),
        friction=rng.uniform(0.05, 0.6), seat_friction=rng.uniform(0.05, 0.5),
    )  # fmt: skip
    sides = int(rng.integers(2, 7))
    if rng.random() < 0.3:  # a force that rotates, or rocks
        angles = np.linspace(0.0, 2.0 * math.pi, 12, endpoint=False)
        size = rng.uniform(0.5, 1.0)
        corners = [{"P": size * math.cos(angle), "Q": size * math.sin(angle)} for angle in angles]
    else:
        corners = [{"P": rng.uniform(0.1, 1.0), "Q": rng.uniform(-0.7, 0.7)} for _ in range(sides)]
    history = LoadHistory(corners[:1]) + LoadHistory([*corners[1:], corners[0]]).repeated(cycles)
    try:
        result = solve(problem, history, nodes=nodes, between=BETWEEN, slip_sums=True)
    except FastpinError:
        return None
    seats = [state.seat for state in result.states]
    count = (BETWEEN + 1) * len(corners)
    turned = [seat.rotation for seat in seats[-1::-count] if seat is not None]
    last = [seat for seat in seats[-count - 1 :] if seat is not None]
    stuck = np.all([seat.status == STICK for seat in last], axis=0)
    slid = np.sum([seat.slip_distance for seat in last[1:]], axis=0)
    return Walk(turned[0] - turned[1], turned[1] - turned[2], int(stuck.sum()), float(slid.max()))


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--turns", type=int, default=40)
    parser.add_argument("--nodes", type=int, default=48)
    options = parser.parse_args()
    counts = {(walks, sticks): 0 for walks in (False, True) for sticks in (False, True)}
    lost = 0
    for seed in tqdm(range(options.count), disable=None, delay=2.0):
        walk = random_walk(seed, options.turns, options.nodes)
        if walk is None:
            lost += 1
            continue
        counts[walk.walks, walk.sticking > 0] += 1
        if walk.walks == (walk.sticking > 0):
            print(f"seed {seed}: {walk}")
    for (walks, sticks), number in counts.items():
        words = "walks" if walks else "rests", "some nodes stick throughout" if sticks else "no node sticks throughout"
        print(f"{number:4}  {words[0]}, {words[1]}")
    print(f"{lost:4}  not followed")


if __name__ == "__main__":
    main()

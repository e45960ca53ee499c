"""Cost of a bush that slips: a cycle of two interfaces against a cycle of one with twice the nodes.

``python bench/seat.py [--nodes 256] [--rounds 5]`` times a cycle of a joint whose bush slips, with `nodes` nodes at
the pin and in the seat. Beside it stands the joint with its bush bonded, with twice the nodes: on the arc of its
contact, and all round. Two cycles are timed: a force to and fro, and a force that rotates. All joints run in turn in
every round. The ratios are those of the fastest rounds. BLAS has one thread.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import replace

from bodies import fastest
from threadpoolctl import threadpool_limits

from fastpin.bodies import Bushing
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.options import ALL_ROUND
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve

BUSH = Bushing(MATERIALS["C93200"], 1.25, 0.26, friction=0.2, bonded=False)

SLIPS = Problem.from_load_parameter(
    MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"], "strain"), 0.28, 0.2, "body", plate_body=BUSH
)
"""The joint of docs/bush.md without units."""

BONDED = replace(SLIPS, plate_body=replace(BUSH, bonded=True, friction=None))

SIZE = 0.3
"""The force to and fro, over P."""

CORNERS = 24
"""Corners of a turn."""

TURN = [
    {"P": math.cos(2.0 * math.pi * corner / CORNERS), "Q": math.sin(2.0 * math.pi * corner / CORNERS)}
    for corner in range(1, CORNERS + 1)
]

CYCLES = {"to and fro": [{"Q": SIZE}, {"Q": -SIZE}], "rotating": TURN}


def jobs_of(cycle: list[dict[str, float]], nodes: int) -> dict[str, Callable[[], object]]:
    """Return a job for each joint: one more cycle, after two."""
    joints = {
        f"slips, 2 x {nodes}": (SLIPS, nodes, None),
        f"bonded, {2 * nodes} on the arc": (BONDED, 2 * nodes, None),
        f"bonded, {2 * nodes} all round": (BONDED, 2 * nodes, ALL_ROUND),
    }
    found: dict[str, Callable[[], object]] = {}
    for name, (problem, count, arc) in joints.items():
        steady = solve(problem, [{"P": 1.0}, *cycle, *cycle], nodes=count, arc=arc)
        found[name] = lambda problem=problem, steady=steady: solve(problem, cycle, start=steady)  # type: ignore[misc]
    return found


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=256, help="nodes of each interface")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        for name, cycle in CYCLES.items():
            times = fastest(jobs_of(cycle, options.nodes), options.rounds, name)
            ours, *others = times
            print(f"{name}: {ours} takes {1e3 * times[ours]:.1f} ms")
            for other in others:
                print(f"  {times[ours] / times[other]:.2f} times {other}, {1e3 * times[other]:.1f} ms")


if __name__ == "__main__":
    main()

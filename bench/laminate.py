"""Cost of a laminate: a first load and a cycle in a laminate, against the isotropic plate with the same lambda0 and s.

``python bench/laminate.py [--nodes 101,401,1601] [--rounds 5]`` times all plates in turn in every round. A laminate
changes its statuses more often than an isotropic plate. So there is a nearly isotropic laminate too, whose statuses
change as often. The ratios are those of the fastest rounds. BLAS has one thread.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

from bodies import fastest
from threadpoolctl import threadpool_limits

from fastpin.model.laminate import Laminate
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve

PLATE = Laminate.from_moduli(135e9, 9e9, 5e9, 0.3)
"""Fibres along the load."""

ISOTROPIC = Material(PLATE.E, PLATE.nu)

NEARLY = Laminate.from_moduli(1.0001 * PLATE.E, PLATE.E, ISOTROPIC.shear_modulus, PLATE.nu)

PLATES = {"fibres along the load": PLATE, "nearly isotropic": NEARLY, "isotropic": ISOTROPIC}

FIRST = [{"P": 1.0}]
CYCLE = [{"Q": 0.3}, {"Q": -0.3}]


def jobs_of(cycle: list[dict[str, float]], nodes: int) -> dict[str, Callable[[], object]]:
    """Return a job for each plate: the first load without a `cycle`, or one more cycle after two."""
    found: dict[str, Callable[[], object]] = {}
    for name, plate in PLATES.items():
        problem = Problem.from_load_parameter(MaterialPair(MATERIALS["steel"], plate, "stress"), 0.1, 0.3, "body")
        steady = solve(problem, [*FIRST, *cycle, *cycle], nodes=nodes) if cycle else None
        corners = cycle or FIRST
        found[name] = lambda problem=problem, corners=corners, start=steady: solve(  # type: ignore[misc]
            problem, corners, start=start, **({} if start else {"nodes": nodes})
        )
    return found


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", default="101,401,1601", help="numbers of nodes")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        for nodes in map(int, options.nodes.split(",")):
            for name, cycle in (("first load", []), ("cycle", CYCLE)):
                times = fastest(jobs_of(cycle, nodes), options.rounds, f"{name}, {nodes} nodes")
                other = times.pop("isotropic")
                print(f"{name}, {nodes} nodes: {1e3 * other:.1f} ms in an isotropic plate")
                for plate, ours in times.items():
                    print(f"  {ours / other:.2f} times as long in a laminate, {plate}")


if __name__ == "__main__":
    main()

"""Cost of other bodies against a solid pin in an infinite plate: fill of the matrices, first load and cycle.

``python bench/bodies.py [--nodes 101,401,1601] [--rounds 5]`` times all bodies in turn in every round, and prints the
ratios of the fastest rounds to those of the solid pin in the infinite plate. BLAS has one thread.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

from cases import CYCLE, FORCE, PROBLEM, STEADY, graded_grid, uniform_grid
from threadpoolctl import threadpool_limits
from tqdm import tqdm

from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.bodies.body import PinBody, PlateBody
from fastpin.elasticity.system import System
from fastpin.model.grid import Grid
from fastpin.model.materials import Material
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve

BODIES: dict[str, tuple[PinBody, PlateBody]] = {
    "solid pin, infinite plate": (Disk(), Plate()),
    "tube 0.5": (Tube(0.5), Plate()),
    "ring 2 held": (Disk(), Ring(2.0)),
    "bush 1.25": (Disk(), Bushing(Material(PROBLEM.pair.plate.E * 1.5, 0.34), 1.25)),
    "tube 0.8, ring 1.5 half": (Tube(0.8), Ring(1.5, "half")),
    "ring 1.05 held": (Disk(), Ring(1.05)),
}
"""The timed bodies by name. The first is the reference."""


def problem_of(pin: PinBody, plate: PlateBody) -> Problem:
    """Return the main case with other bodies."""
    pin_load = "body" if isinstance(pin, Disk) else "centre"
    return Problem.from_load_parameter(PROBLEM.pair, 0.05, 0.55, pin_load, pin_body=pin, plate_body=plate)


def fastest(jobs: dict[str, Callable[[], object]], rounds: int, label: str) -> dict[str, float]:
    """Return the fastest time of each job, s. In every round all jobs run one after the other."""
    found = dict.fromkeys(jobs, float("inf"))
    for _ in tqdm(range(rounds), desc=label, delay=2.0, leave=False):
        for name, job in jobs.items():
            began = time.perf_counter()
            job()
            found[name] = min(found[name], time.perf_counter() - began)
    return found


def timed_jobs(nodes: int) -> dict[str, dict[str, Callable[[], object]]]:
    """Return what is timed at one size: a job for each body, by the name of the column."""
    problems = {name: problem_of(*bodies) for name, bodies in BODIES.items()}
    circle = Grid.circle(nodes)

    def fill(grid: Grid) -> dict[str, Callable[[], object]]:
        return {name: lambda each=each: System.build(each, grid, FORCE) for name, each in problems.items()}

    columns = {
        "fill, arc": fill(uniform_grid(nodes)),
        "fill, circle": fill(circle),
        "fill, graded": fill(graded_grid(nodes)),
    }
    steady = {name: solve(each, STEADY, nodes=nodes) for name, each in problems.items()}
    columns["first load"] = {
        name: lambda each=each: solve(each, STEADY[:1], nodes=nodes) for name, each in problems.items()
    }
    columns["cycle"] = {
        name: lambda each=each, name=name: solve(each, CYCLE, start=steady[name]) for name, each in problems.items()
    }
    return columns


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", default="101,401,1601", help="numbers of nodes, separated by commas")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    with threadpool_limits(limits=1, user_api="blas"):
        for nodes in map(int, options.nodes.split(",")):
            columns = {
                label: fastest(jobs, options.rounds, f"{nodes} nodes, {label}")
                for label, jobs in timed_jobs(nodes).items()
            }
            print(f"{nodes} nodes".ljust(28) + "".join(label.rjust(14) for label in columns))
            for name in BODIES:
                ratios = (times[name] / next(iter(times.values())) for times in columns.values())
                print(name.ljust(28) + "".join(f"{ratio:14.2f}" for ratio in ratios))
            reference = "".join(f"{next(iter(times.values())) * 1e3:11.1f} ms" for times in columns.values())
            print("the first, in ms".ljust(28) + reference + "\n")


if __name__ == "__main__":
    main()

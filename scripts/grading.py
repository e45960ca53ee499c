"""Equally spaced nodes against nodes that gather at edges and borders: error against time.

    python -m scripts.grading               four histories with partial slip, 101 to 801 nodes
    python -m scripts.grading --dense 12    nodes twelve times as dense at these places as between them

The places are the contact edges and the borders of stick zones in all states of a run with 201 nodes. The last state of
a run with 3,201 equally spaced nodes is the reference. The time is the median processor time of ``solve`` with a given
grid, on one thread; the search for the places is not counted. All errors are relative.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.runtime.threads import in_one_thread
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from scripts.cusps import CASES, Case

TITLES = (
    "L_p 2, held, +-0.02",
    "L_p 0.5, held, decreasing",
    "L_p 0.05, body, decreasing",
    "L_p 20, held, decreasing",
)
REFERENCE = 3201


def run(case: Case, grid: Grid) -> Result:
    """Solve a case on a grid."""
    pair, load_parameter, friction, pin_load, rotation, history = case
    return solve(Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation), history, grid=grid)


def gathered(arc: Grid, places: np.ndarray, nodes: int, dense: float) -> Grid:
    """Nodes on the same arc, `dense` times as dense at `places` as far from them."""
    theta = np.linspace(arc.theta[0], arc.theta[-1], 20_001)
    width = 0.02 * (theta[-1] - theta[0])
    near = 1.0 / (1.0 + (np.abs(theta[:, None] - places).min(axis=1) / width) ** 2)
    count = np.concatenate([[0.0], np.cumsum(1.0 + (dense - 1.0) * 0.5 * (near[1:] + near[:-1]))])
    return Grid(np.interp(np.linspace(0.0, count[-1], nodes), count, theta))


def places_of(result: Result) -> np.ndarray:
    """Contact edges and borders of stick zones in all states, rad."""
    zones = [zone for state in result for zone in (*state.contact, *state.stick)]
    return np.unique([end for zone in zones for end in zone])


def quantities(result: Result) -> np.ndarray:
    """Peak shear, contact edge and largest hoop stress of the plate, of the last state."""
    state = result[-1]
    hoop = state.peak_hoop_stress("plate").value
    return np.array([abs(state.peak_shear), state.contact[-1][1], hoop])


def timed(case: Case, grid: Grid, rounds: int) -> tuple[float, Result]:
    """Median processor time of a solution, s, and the result."""
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        result = run(case, grid)
        times.append(time.process_time() - begin)
    return statistics.median(times), result


def main() -> None:
    """Print a table for each history."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dense", type=float, default=6.0)
    parser.add_argument("--nodes", type=int, nargs="+", default=[101, 201, 401, 801])
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    for title in TITLES:
        case = CASES[title]
        pair, load_parameter, friction, pin_load, rotation, history = case
        problem = Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation)
        first = solve(problem, history, nodes=201)
        arc, places = first.grid, places_of(first)
        exact = quantities(run(case, arc.with_nodes(REFERENCE)))
        print(f"\n{title}\n\n| nodes | grid | time, ms | peak shear | contact edge | hoop stress |")
        print("|--:|---|--:|--:|--:|--:|")
        for nodes in options.nodes:
            for kind, grid in (
                ("equal", arc.with_nodes(nodes)),
                ("gathered", gathered(arc, places, nodes, options.dense)),
            ):
                seconds, result = timed(case, grid, options.rounds)
                errors = np.abs(quantities(result) / exact - 1.0)
                cells = " | ".join(f"{error:.1e}" for error in errors)
                print(f"| {nodes} | {kind} | {1e3 * seconds:.1f} | {cells} |", flush=True)


if __name__ == "__main__":
    with in_one_thread():
        main()

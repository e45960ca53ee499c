"""Readings of the four states of a run, over the run itself. The material changes for each run.

    python bench/readings.py                   30 runs of unlike bodies, and 30 of like bodies, with 101 nodes
    python bench/readings.py --runs 100 --nodes 201

So no matrix, table or fit of an earlier run is found again. Key figures are those that a sweep stores. "Readings" are
the key figures and the largest hoop stress of each state; their bar is 1, in parts of the run. Times are processor
times, medians of the runs. They are also given over LAPACK's dgetrf of 202 unknowns, and over a fixed loop of plain
Python, in the same process: other programs slow these down alike.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import lapack
from threadpoolctl import threadpool_limits

import fastpin
from fastpin.model.materials import Material, MaterialPair
from fastpin.runtime.threads import in_one_thread
from fastpin.studies.run_end import key_figures

HISTORY = fastpin.LoadHistory([{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"Q": 0.2}])

LOOPS = 10_000
"""Rounds of the loop of plain Python."""


def problem(seed: int, like: bool) -> fastpin.Problem:
    """A random problem."""
    rng = np.random.default_rng(seed)
    ratio, nu = (1.0, 0.3) if like else (float(rng.uniform(1.5, 4.0)), float(rng.uniform(0.2, 0.4)))
    pair = MaterialPair(Material(1.0, nu), Material(ratio, 0.3), "strain")
    load_parameter, friction = float(rng.uniform(0.04, 0.3)), float(rng.uniform(0.35, 0.6))
    return fastpin.Problem.from_load_parameter(pair, load_parameter, friction, pin_load="body", rotation="free")


def timed(times: list[float], work: Callable[[], Any]) -> Any:
    """Return what `work` returns. Its processor time, ms, is added to `times`."""
    began = time.process_time()
    found = work()
    times.append(1e3 * (time.process_time() - began))
    return found


def python_loop() -> float:
    """A fixed piece of plain Python."""
    total = 0.0
    for k in range(LOOPS):
        total += 0.5 * (k % 7)
    return total


def measured(runs: int, nodes: int, like: bool) -> dict[str, float]:
    """Medians of processor times, ms."""
    times: dict[str, list[float]] = {name: [] for name in ("run", "key figures", "hoop", "LU", "Python")}
    matrix = np.random.default_rng(0).normal(size=(202, 202))
    for seed in range(-2, runs):  # the first ones load the kernels
        case = problem(seed % 100_000, like)
        result = timed(times["run"], lambda: fastpin.solve(case, HISTORY, nodes=nodes))  # noqa: B023  called at once
        timed(times["key figures"], lambda: key_figures(result))  # noqa: B023
        timed(times["hoop"], lambda: [state.peak_hoop_stress() for state in result])  # noqa: B023
        timed(times["LU"], lambda: lapack.dgetrf(matrix))
        timed(times["Python"], python_loop)
    return {name: statistics.median(values[2:]) for name, values in times.items()}


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--nodes", type=int, default=101)
    options = parser.parse_args()
    with threadpool_limits(limits=1), in_one_thread():
        for like in (False, True):
            found = measured(options.runs, options.nodes, like)
            read = found["key figures"] + found["hoop"]
            print(f"{'like' if like else 'unlike'} bodies: " + ", ".join(f"{k} {v:.2f} ms" for k, v in found.items()))
            print(f"    key figures / run {found['key figures'] / found['run']:.2f}, hoop / run "
                  f"{found['hoop'] / found['run']:.2f}, readings / run {read / found['run']:.2f}; readings / LU "
                  f"{read / found['LU']:.0f}, readings / Python {read / found['Python']:.1f}")  # fmt: skip


if __name__ == "__main__":
    main()

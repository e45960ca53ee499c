"""Wall time of a long history of cycles that are all different: ``python bench/history.py [--cycles 1000]``.

The processor time is printed, too. If it is much less than the wall time, the machine was busy with other work.
"""

from __future__ import annotations

import argparse
import json
import time

import cases
from tqdm import tqdm

import fastpin


def follow(cycles: int, nodes: int) -> fastpin.Result:
    """Solve the variable history from the steady state, with a progress bar."""
    history = cases.variable_cycles(cycles)
    start = cases.steady_state(nodes)
    with tqdm(total=cycles, unit="cycle") as bar:

        def show(done: float, steps: int) -> None:
            bar.update(int(0.5 * done) - bar.n)

        return fastpin.solve(cases.PROBLEM, history, start=start, progress=show)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=1000)
    parser.add_argument("--nodes", type=int, default=401)
    options = parser.parse_args()
    cases.steady_state(61)  # compiles
    cases.steady_state(options.nodes)
    began = time.process_time()
    result = follow(options.cycles, options.nodes)
    processor = time.process_time() - began
    worst = max(max(state.residuals.values()) for state in result)
    seconds = result.statistics["seconds"]
    numbers = {
        "nodes": options.nodes,
        "cycles": options.cycles,
        "seconds_per_cycle": seconds / options.cycles,
        "processor_seconds": processor,
        "largest_residual": worst,
        **result.statistics,
    }
    print(json.dumps(numbers, indent=2))


if __name__ == "__main__":
    main()

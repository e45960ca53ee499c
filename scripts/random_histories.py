"""Random histories: does the path solver return a wrong state, raise an error, or hang?

``python -m scripts.random_histories [--count 1000] [--first 0]`` solves `count` random problems with fixed seeds on
small grids. It checks every state independently of the solver's own residuals, and prints every error raised.
"""

from __future__ import annotations

import argparse
import collections
import time

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.state import State
from scripts.histories import NODES, random_case


def violation(state: State) -> float:
    """Return the largest relative violation of Signorini, Coulomb and equilibrium, from the fields a user reads."""
    if not state.in_contact:
        return max(
            -state.gap.min() / state.problem.clearance,
            np.abs(state.pressure).max(),
            np.abs(state.shear).max(),
        )
    peak, length = state.pressure.max(), max(np.abs(state.slip).max(), np.abs(state.gap).max())
    mu = state.problem.friction
    force = np.hypot(state.load["P"], state.load["Q"])
    balance = max(abs(state.resultants[name] - state.load[name]) for name in ("P", "Q"))
    if state.problem.rotation == "free":
        balance = max(balance, abs(state.resultants["M"] - state.load["M"]))
    return max(
        -state.pressure.min() / peak,
        float((np.abs(state.shear) - mu * state.pressure).max()) / peak,
        -state.gap.min() / length,
        float((state.gap * state.pressure).max()) / (length * peak),
        balance / force,
    )


def outcome(seed: int) -> tuple[str, float, Result | None]:
    """Solve a case. Return its ending ("solved", or the error's name and message), largest violation and result."""
    problem, history = random_case(seed)
    try:
        result, ending = solve(problem, history, nodes=NODES), "solved"
    except FastpinError as error:
        result, ending = getattr(error, "result", None), f"{type(error).__name__}: {error}"
    return ending, max((violation(state) for state in result or []), default=0.0), result


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    endings: collections.Counter[str] = collections.Counter()
    worst, slowest, states = 0.0, 0.0, 0
    for seed in tqdm(range(options.first, options.first + options.count), disable=None, delay=2.0):
        began = time.perf_counter()
        ending, violated, result = outcome(seed)
        slowest = max(slowest, time.perf_counter() - began)
        worst = max(worst, violated)
        states += len(result or [])
        endings[ending.split(":")[0]] += 1
        if ending != "solved" or violated > 1e-8:
            print(f"seed {seed}: {ending} (violation {violated:.1e})")
    print(dict(endings), f"{states} states, largest violation {worst:.1e}, slowest case {slowest:.2f} s")


if __name__ == "__main__":
    main()

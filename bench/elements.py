"""The load and three half cycles: times and errors of the shear, ``python bench/elements.py``.

The problem is the main case of ``cases.py``, from no load on: P, then Q = +, -, + 0.275. The error compares the shear
with the shear on the finest grid: the integral of the absolute difference over the integral of the absolute shear. The
largest of the four states counts.
"""

from __future__ import annotations

import argparse

import cases
import numpy as np

import fastpin

HISTORY = fastpin.LoadHistory([{"P": 1.0}, *({"Q": sign * cases.AMPLITUDE} for sign in (1.0, -1.0, 1.0))])
SIZES = (51, 101, 201, 401, 801)
ROUNDS = 3


def shear_error(state: fastpin.State, exact: fastpin.State) -> float:
    """Return int |difference of T| over int |T|, on the nodes of the finer state."""
    shear = np.interp(exact.theta, state.theta, state.shear)
    weights = exact.grid.weights
    return float(weights @ np.abs(shear - exact.shear) / (weights @ np.abs(exact.shear)))


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", type=int, default=3201, help="nodes of the solution that counts as exact")
    options = parser.parse_args()
    cases.steady_state(61)  # compiles
    exact = fastpin.solve(cases.PROBLEM, HISTORY, nodes=options.reference, arc=cases.ARC)
    print("| nodes | node distance, rad | seconds, arc given | seconds, arc found | error of the shear |")
    print("|---|--:|--:|--:|--:|")
    for nodes in SIZES:
        given = [fastpin.solve(cases.PROBLEM, HISTORY, nodes=nodes, arc=cases.ARC) for _ in range(ROUNDS)]
        found = [fastpin.solve(cases.PROBLEM, HISTORY, nodes=nodes) for _ in range(ROUNDS)]
        times = [min(result.statistics["seconds"] for result in results) for results in (given, found)]
        error = max(shear_error(state, true) for state, true in zip(given[0], exact, strict=True))
        distance = 2.0 * cases.HALF_ARC / (nodes - 1)
        print(f"| {nodes} | {distance:.4f} | {times[0]:.3f} | {times[1]:.3f} | {error:.2g} |")


if __name__ == "__main__":
    main()

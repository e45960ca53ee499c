"""The path against the increment solver at equal error, over one steady cycle: ``python bench/compare.py``.

1. The path solver, from few nodes to many, with errors against the largest number. Both solvers have this mesh error.
2. The increment solver on one coarse grid, from few increments to many, against the path on the same grid. This is the
   error of the increments alone; it hardly depends on the grid.
3. For every quantity the fewest nodes and increments from which on its error stays below the tolerance, and the times
   of a cycle with these. Both solvers get the same nodes. The increment solver would need more, since it has the errors
   of the mesh and of the increments.

The largest number of nodes is not exact either. If errors are first order, its error is at most the largest error times
nodes, over its own nodes: the row "reference". If this is more than the tolerance, the needed nodes are marked
uncertain. This happens for peak T: it is read at a node where an earlier border has left a kink.

A cycle in increments may take longer than ``--longest`` seconds. Its time is then estimated: the cost of an increment
of that size on that grid times the number of increments. The cost is the mean of some increments at five places of a
step.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import cases
import numpy as np

import fastpin

QUANTITIES = ("peak N", "peak T", "int T", "int abs T")
"""The compared quantities."""

PATH_SIZES = (101, 151, 201, 301, 401, 501, 601, 701, 801, 1001, 1201, 1601)
"""Numbers of nodes of the path solver."""

COUNTS = (10, 20, 40, 80, 160, 320, 640, 1280)
"""Numbers of increments a step."""

PLACES = (0.0, 0.2, 0.4, 0.6, 0.8)
"""Fractions of the step from +Q to -Q with samples of the cost of an increment."""

SAMPLED = 4
"""Increments at each place."""

Values = np.ndarray
"""Quantities at the ends of both steps of a cycle, shape (2, quantities)."""


def steady_cycle(nodes: int, **options: Any) -> fastpin.Result:
    """Solve one cycle from the steady state of the same solver."""
    steady = fastpin.solve(cases.PROBLEM, cases.STEADY, nodes=nodes, arc=cases.ARC, **options)
    return fastpin.solve(cases.PROBLEM, cases.CYCLE, start=steady, **options)


def values(result: fastpin.Result) -> Values:
    """Return the quantities in the states of a cycle, shape (2, quantities)."""
    weights = result.grid.weights
    return np.array(
        [
            [state.peak_pressure, abs(state.peak_shear), weights @ state.shear, weights @ np.abs(state.shear)]
            for state in result
        ]
    )


def errors(found: Values, exact: Values, total_pressure: float) -> np.ndarray:
    """Return the largest error of each quantity in the cycle, of peaks relative to peak N, of integrals to int N."""
    scales = np.array([exact[:, 0].min(), exact[:, 0].min(), total_pressure, total_pressure])
    return np.abs(found - exact).max(axis=0) / scales


def sufficient(tried: Sequence[int], error: Sequence[float], tolerance: float) -> int | None:
    """Return the smallest number from which on the error stays within the tolerance; None if there is none."""
    good = list(itertools.takewhile(lambda pair: pair[1] <= tolerance, reversed(list(zip(tried, error, strict=True)))))
    return good[-1][0] if good else None


def increment_cycle_seconds(nodes: int, increments: int) -> float:
    """Estimate the seconds of a cycle in increments, from some increments at several places of a step."""
    way = 2.0 * cases.AMPLITUDE
    seconds = 0.0
    for place in PLACES:
        start = cases.steady_state(nodes)
        if place > 0.0:
            start = fastpin.solve(cases.PROBLEM, [{"Q": cases.AMPLITUDE - place * way}], start=start)
        target = [{"Q": cases.AMPLITUDE - (place + SAMPLED / increments) * way}]
        sample = fastpin.solve(cases.PROBLEM, target, start=start, method="increment", increments=SAMPLED)
        seconds += sample.statistics["seconds"]
    return 2 * increments * seconds / (SAMPLED * len(PLACES))


def timed_increments(nodes: int, increments: int, longest: float) -> tuple[float, str]:
    """Return the seconds of a cycle in increments, and "measured" or "estimated"."""
    estimate = increment_cycle_seconds(nodes, increments)
    if estimate > longest:
        return estimate, "estimated"
    start = cases.steady_state(nodes)
    cycle = fastpin.solve(cases.PROBLEM, cases.CYCLE, start=start, method="increment", increments=increments)
    return cycle.statistics["seconds"], "measured"


def path_seconds(nodes: int) -> float:
    """Return the shortest of three times of a cycle by the path solver, seconds."""
    start = cases.steady_state(nodes)
    return min(fastpin.solve(cases.PROBLEM, cases.CYCLE, start=start).statistics["seconds"] for _ in range(3))


def table(header: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """Print a Markdown table."""
    print("\n| " + " | ".join(header) + " |")
    print("|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row) + " |")


def study(tried: Sequence[int], solved: Callable[[int], fastpin.Result], exact: Values, name: str) -> np.ndarray:
    """Solve with every number, print the table of errors, and return them, shape (tried, quantities)."""
    found = []
    for number in tried:
        result = solved(number)
        total = float(result.grid.weights @ result[-1].pressure)
        found.append(errors(values(result), exact, total))
    table([name, *QUANTITIES], [[number, *map(float, row)] for number, row in zip(tried, found, strict=True)])
    return np.array(found)


def reference_errors(sizes: Sequence[int], mesh: np.ndarray, reference: int) -> np.ndarray:
    """Return the largest possible error of the reference in every quantity, if errors are at least first order."""
    return (np.asarray(sizes)[:, None] * mesh).max(axis=0) / reference


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--reference", type=int, default=2401, help="nodes of the solution that counts as exact")
    parser.add_argument("--coarse", type=int, default=201, help="nodes on which increments are compared with the path")
    parser.add_argument("--longest", type=float, default=120.0, help="seconds a cycle in increments may take")
    options = parser.parse_args()
    cases.steady_state(61)  # compiles

    sizes = [size for size in PATH_SIZES if size < options.reference]
    print(f"Path, error against {options.reference} nodes; peaks in parts of peak N, integrals in parts of int N.")
    mesh = study(sizes, steady_cycle, values(steady_cycle(options.reference)), "nodes")
    doubt = reference_errors(sizes, mesh, options.reference)
    print("| reference | " + " | ".join(f"{value:.3g}" for value in doubt) + " |")
    print(f"\nIncrements a step, error against the path, both on {options.coarse} nodes.")
    coarse = values(steady_cycle(options.coarse))
    steps = study(
        COUNTS, lambda count: steady_cycle(options.coarse, method="increment", increments=count), coarse, "increments"
    )

    print(f"\nOne cycle within {options.tolerance:g}. A pin that rotates freely has int T = 0 in every state.")
    rows: list[list[Any]] = []
    for name, columns in {**{name: [k] for k, name in enumerate(QUANTITIES)}, "all": [0, 1, 2, 3]}.items():
        nodes = sufficient(sizes, mesh[:, columns].max(axis=1), options.tolerance)
        count = sufficient(COUNTS, steps[:, columns].max(axis=1), options.tolerance)
        if nodes is None or count is None:
            rows.append([name, nodes or f"> {sizes[-1]}", count or f"> {COUNTS[-1]}", *5 * [""]])
            continue
        certain = "" if doubt[columns].max() <= options.tolerance else "nodes uncertain"
        path = path_seconds(nodes)
        seconds, how = timed_increments(nodes, count, options.longest)
        rows.append([name, nodes, count, path, seconds, how, f"{seconds / path:.0f}", certain])
    table(["within", "nodes", "increments a step", "path, s", "increments, s", "", "ratio", ""], rows)


if __name__ == "__main__":
    main()

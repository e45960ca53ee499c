"""Lives of wear: time and error of fat cycles, growth with nodes and cycles, explicit and implicit jumps.

    python bench/wear.py                     all parts: some five minutes, on one thread
    python bench/wear.py cycle control       only some parts

* cycle: a cycle of the built-in case, and the part of its time in the compiled path
* control: 2,000 cycles one by one and by fat cycles; the errors that are promised and seen
* growth: the built-in case over nodes and cycles
* jumps: equal fat cycles against 800, explicit and implicit

All times are processor times. The tables are Markdown, for docs/wear-accuracy.md.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from typing import Any, NamedTuple
from unittest import mock

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import fastpin
from fastpin.casefile import builtin_case
from fastpin.kernels import held
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.joint_rows import step, wearing

Corners = list[dict[str, float]]

BOTTOM = -0.5 * math.pi
FORCE = 2.42e6
"""P of the built-in case, N/m."""

PUSHED: Corners = [{"P": FORCE}, {"Q": 0.3 * FORCE}]
CYCLES: dict[str, Corners] = {
    "Q": [{"Q": -0.3 * FORCE}, {"Q": 0.3 * FORCE}],
    "P and Q": [{"P": 0.5 * FORCE, "Q": -0.2 * FORCE}, {"P": FORCE, "Q": 0.3 * FORCE}],
}
"""Cycles of the built-in case. Under Q alone the joint shakes down within nine cycles: nothing slips any more."""

COEFFICIENT = 1e-13
"""Wear coefficient of the built-in case, 1/Pa: some 1e-4 mm^3/(N m)."""


class Timed(NamedTuple):
    """A life, and its time, s."""

    result: fastpin.WearResult
    seconds: float


def live(cycle: str, cycles: float, **options: Any) -> Timed:
    """Follow a life of the built-in case."""
    history = LoadHistory(PUSHED) + LoadHistory(CYCLES[cycle]).repeated(1)
    given = {"coefficient": COEFFICIENT, "nodes": 101, **options}
    began = time.process_time()
    result = fastpin.wear(builtin_case().problem, history, cycles=cycles, **given)
    return Timed(result, time.process_time() - began)


def row(*cells: object) -> None:
    """Print a row of a table."""
    print("|", " | ".join(str(cell) for cell in cells), "|", flush=True)


def head(*cells: str) -> None:
    """Print the head of a table."""
    print()
    row(*cells)
    row(*["---", *["--:"] * (len(cells) - 1)])


def cycle() -> None:
    """Time single cycles, with the time in the compiled steps."""
    kernel, spent = held.step, [0.0]

    def timed(*arguments: Any) -> Any:
        began = time.process_time()
        found = kernel(*arguments)
        spent[0] += time.process_time() - began
        return found

    head("cycle of two corners", "nodes", "events", "ms", "compiled, ms")
    for name in CYCLES:
        for nodes in (101, 201, 401):
            count = 40_000 // nodes
            with mock.patch.object(held, "step", timed):
                spent[0] = 0.0
                found = live(name, count, nodes=nodes, tolerance=0.0, at=[count], coefficient=1e-2 * COEFFICIENT)
            events = found.result.statistics["events"] / count
            row(name, nodes, f"{events:.0f}", *(f"{1e3 * part / count:.2f}" for part in (found.seconds, spent[0])))


def control() -> None:
    """Compare 2,000 cycles one by one with fat cycles."""
    cycles = 2_000
    head("2,000 cycles, 101 nodes", "promised", "solved", "worn gap", "volume", "pressure", "s", "times as fast")
    for name, factor in (("P and Q", 1.0), ("P and Q", 10.0), ("P and Q", 100.0), ("Q", 1.0)):
        words, how = f"{name}, {COEFFICIENT * factor:g}/Pa", {"coefficient": factor * COEFFICIENT}
        direct = live(name, cycles, tolerance=0.0, **how)
        row(words, 0, direct.result[-1].solved, 0, 0, 0, f"{direct.seconds:.1f}", 1)
        for tolerance in (1e-2, 1e-3):
            fat = live(name, cycles, tolerance=tolerance, **how)
            errors = [0.0, 0.0, 0.0]
            for one, other in zip(direct.result[1:], fat.result[1:], strict=True):
                found = (
                    np.abs(one.gap_growth - other.gap_growth).max() / one.depth,
                    abs(one.volume - other.volume) / one.volume,
                    np.abs(one.pressure - other.pressure).max() / one.pressure.max(),
                )
                errors = [max(pair) for pair in zip(errors, found, strict=True)]
            seen = (f"{error:.1e}" for error in errors)
            ratio = direct.seconds / fat.seconds
            row(words, f"{tolerance:g}", fat.result[-1].solved, *seen, f"{fat.seconds:.2f}", f"{ratio:.0f}")


def growth() -> None:
    """Time lives of more nodes and cycles, of equal wear: the coefficient times the cycles is the same."""
    head("cycle", "nodes", "cycles", "depth, um", "solved", "s", "ms a solved cycle")
    sizes = [("P and Q", 101, n) for n in (1e3, 1e4, 1e5, 1e6)] + [("P and Q", n, 1e5) for n in (201, 401)]
    for name, nodes, cycles in [*sizes, ("Q", 101, 1e5)]:
        found = live(name, cycles, nodes=nodes, coefficient=1e5 * COEFFICIENT / cycles)
        last = found.result[-1]
        each = 1e3 * found.seconds / last.solved
        row(
            name, nodes, f"{cycles:,.0f}", f"{1e6 * last.depth:.3f}", last.solved, f"{found.seconds:.1f}", f"{each:.2f}"
        )


def equal(
    problem: Problem, grid: Grid, corners: tuple[Corners, Corners], tau: float, fat: int, implicit: bool
) -> tuple[float, float]:
    """Live so many equal fat cycles. Returns volume and largest pressure; NaN if the contact is lost."""
    first, again = corners
    run, worn = wearing(problem, grid), np.zeros(grid.size)
    for loads in (*first, *again):
        step(run, loads)
    for loads in fat * again:
        try:
            rubbed, _ = step(run, loads)
        except fastpin.SolveError:
            return math.nan, math.nan
        slip, pressure = run.corner_log.latest.slip_tally.sums[0], run.now.pressure
        mean = np.divide(rubbed, pressure, out=np.full_like(slip, np.inf), where=pressure > 0.0)
        softness = tau / fat * np.minimum(slip, mean) if implicit else None
        worn = worn + run.wear(tau / fat * rubbed, softness).depth
    return float(run.system.weights @ worn), float(run.now.pressure.max())


def jumps() -> None:
    """Compare explicit and implicit jumps with 800 explicit fat cycles."""
    half, held = math.sqrt(1.0 / (200.0 * math.pi)), ("centre", "fixed")
    cases: dict[str, tuple[Problem, Grid, tuple[Corners, Corners], float]] = {
        "partial slip, L_p 200, tau = 10 a": (
            Problem.from_load_parameter(LIKE, 200.0, 0.5, *held),
            Grid.arc(BOTTOM - 1.4 * half, BOTTOM + 1.4 * half, 101),
            ([{"P": 1.0}, {"Q": 0.25}], [{"Q": -0.25}, {"Q": 0.25}]),
            10.0 * half,
        ),
        "gross sliding, L_p 0.1, tau = 0.1": (
            Problem.from_load_parameter(UNLIKE, 0.1, 0.2, *held),
            Grid.arc(BOTTOM - 1.9, BOTTOM + 1.9, 41),
            ([{"P": 1.0}, {"rotation": 3.0}], [{"rotation": -3.0}, {"rotation": 3.0}]),
            0.1,
        ),
    }
    counts = (10, 20, 40, 80, 160)
    head("fat cycles", *(str(count) for count in counts))
    for words, case in cases.items():
        volume, peak = equal(*case, 800, False)
        for kind, implicit in (("explicit", False), ("implicit", True)):
            found = [equal(*case, count, implicit) for count in counts]
            row(f"{words}, {kind}: V", *(f"{each[0] / volume - 1.0:.1e}" for each in found))
            row("peak N", *(f"{each[1] / peak - 1.0:.1e}" for each in found))


PARTS = {"cycle": cycle, "control": control, "growth": growth, "jumps": jumps}


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="parts (default: all)")
    options = parser.parse_args()
    for name in CYCLES:
        live(name, 5.0)  # compiles
    for name in options.parts or PARTS:
        PARTS[name]()


if __name__ == "__main__":
    main()

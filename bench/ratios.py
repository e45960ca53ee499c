"""Small jobs beside an LU factorisation and a loop of Python: ``python bench/ratios.py [OTHER] [--nodes 101 201]``.

A fresh run has a material that no run had before, four corners, and the search for its arc. Then come the key figures
of its states, a step of a session, and a cycle unlike all others. LU is LAPACK's dgetrf of 202 unknowns. OTHER is
another checkout. Jobs of both checkouts run by turns, and each is the first one in half of the turns. Each checkout has
one process with one thread. The numbers are medians of processor times in ms; in brackets are their ratios to LU and to
the loop.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parents[1]
LOOP, UNKNOWNS = 20_000, 202
WARM_UP = 3
"""Jobs before the timed ones. They load compiled code."""

HISTORY = [{"P": 2.4e6}, {"Q": 4e5}, {"Q": -4e5}, {"Q": 4e5}]
"""The corners of a fresh run."""


def jobs(nodes: int) -> dict[str, Callable[[], object]]:
    """The jobs by name. Those that need something first return a job."""
    import fastpin
    from fastpin.runtime.extensions import lapack

    new, rng = count(), np.random.default_rng(0)
    matrix = rng.normal(size=(UNKNOWNS, UNKNOWNS))

    def problem(stiffness: float) -> fastpin.Problem:
        materials = fastpin.Material(116e9 * stiffness, 0.32), fastpin.Material(70e9, 0.33)
        return fastpin.Problem(
            fastpin.MaterialPair(*materials, plane="strain"), 10e-3, clearance=20e-6, friction=0.3, pin_load="body"
        )

    def fresh() -> Callable[[], object]:
        unknown = problem(1.0 + 1e-4 * next(new))
        return lambda: fastpin.solve(unknown, HISTORY, nodes=nodes)

    def figures() -> Callable[[], object]:
        states = fastpin.solve(problem(1.0 + 1e-4 * next(new)), HISTORY, nodes=nodes).states
        return lambda: [(state.peak_pressure, state.peak_shear, state.contact, state.stick) for state in states]

    known = problem(1.0)
    grid = fastpin.solve(known, HISTORY, nodes=nodes).grid
    session = fastpin.Session(known, grid=grid)
    session.advance({"P": 2.4e6})
    shares = iter(rng.uniform(0.1, 1.0, 100_000).tolist())

    def step() -> Callable[[], object]:
        load = {"P": 2.4e6 * (0.99 + 0.02 * next(shares)), "Q": 2.4e5 * (0.99 + 0.02 * next(shares))}
        return lambda: session.advance(load)

    last = fastpin.solve(known, HISTORY, grid=grid)

    def cycle() -> Callable[[], object]:
        amplitude = 4e5 * next(shares)
        return lambda: fastpin.solve(known, [{"Q": amplitude}, {"Q": -amplitude}], start=last)

    timed = {"fresh run": fresh, "key figures": figures, "session step": step, "varied cycle": cycle}
    return {
        "LU": lambda: lambda: lapack.dgetrf(matrix),
        "loop": lambda: lambda: sum(i * i % 7 for i in range(LOOP)),
        **timed,
    }


def answer(nodes: int) -> None:
    """Do the job that each line of the input names, and print its processor time."""
    known = jobs(nodes)
    for line in sys.stdin:
        job = known[line.strip()]()
        began = time.process_time()
        job()
        print(time.process_time() - began, flush=True)


def begin(checkout: Path, nodes: int) -> subprocess.Popen[str]:
    """Start the process of a checkout."""
    python = checkout / ".venv" / "bin" / "python"
    command = [str(python) if python.exists() else sys.executable, "-W", "ignore", __file__, "--answer", str(nodes)]
    single = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(checkout)}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    return subprocess.Popen(command, env=os.environ | single, cwd=checkout, text=True, **pipes)  # type: ignore[call-overload,no-any-return]


def ask(process: subprocess.Popen[str], name: str) -> float:
    """The processor time of a job, s."""
    assert process.stdin is not None
    assert process.stdout is not None
    print(name, file=process.stdin, flush=True)
    return float(process.stdout.readline())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", nargs="?", type=Path, help="checkout that is measured by turns with this one")
    parser.add_argument("--nodes", type=int, nargs="+", default=[101, 201], help="nodes (default 101 and 201)")
    parser.add_argument("--rounds", type=int, default=60, help="jobs of each kind (default 60)")
    parser.add_argument("--answer", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.answer:
        answer(options.answer)
        return
    checkouts = [HERE] if options.other is None else [options.other.resolve(), HERE]
    for nodes in options.nodes:
        processes = [begin(checkout, nodes) for checkout in checkouts]
        names = ["LU", "loop", "fresh run", "key figures", "session step", "varied cycle"]
        found = [{name: [] for name in names} for _ in checkouts]
        turns = list(zip(processes, found, strict=True))
        for turn in range(WARM_UP + options.rounds):
            turns.reverse()  # the second of two equal jobs takes up to a quarter more or less
            for name in names:
                for process, times in turns:
                    took = 1e3 * ask(process, name)
                    if turn >= WARM_UP:
                        times[name].append(took)
        for checkout, process, times in zip(checkouts, processes, found, strict=True):
            process.communicate()
            lu, loop, *rest = (statistics.median(times[name]) for name in names)
            words = [
                f"{name} {took:.2f} ({took / lu:.1f}, {took / loop:.2f})"
                for name, took in zip(names[2:], rest, strict=True)
            ]
            print(f"{checkout.name}, {nodes} nodes: {'; '.join(words)}; LU {lu:.3f}, loop {loop:.2f}", flush=True)


if __name__ == "__main__":
    main()

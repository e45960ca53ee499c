"""Small steps of a session against ``solve(..., start=result)``: ``python bench/session.py [OTHER] [--nodes 201]``.

Each step changes both forces by up to 1 %, up and down in turn, so most steps turn the load. OTHER is another checkout,
with its own ``.venv``, whose ``solve`` is timed; without it the one of this checkout. Both run in turn in processes of
their own, with one thread. The numbers are medians of processor times, and the ratio of the medians.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parents[1]
WARM_UP = 20
"""Steps before the timed ones. They load compiled code and settle the contact."""


def loads(count: int) -> list[dict[str, float]]:
    """Return the loads of so many steps."""
    changes = 0.01 * np.random.default_rng(0).uniform(0.5, 1.0, (count, 2)) * (-1.0) ** np.arange(count)[:, None]
    return [{"P": 1.0 + float(p), "Q": 0.1 * (1.0 + float(q))} for p, q in changes]


def measure(kind: str, nodes: int, steps: int) -> float:
    """Return the median processor time of a step, s, by "solve" or "session"."""
    import fastpin

    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
    problem = fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4, pin_load="body")
    advance: Callable[[dict[str, float]], object]
    if kind == "session":
        advance = fastpin.Session(problem, nodes, arc=(-2.85, -0.29)).advance
        advance({"P": 1.0})
    else:
        result = fastpin.solve(problem, [{"P": 1.0}], nodes=nodes, arc=(-2.85, -0.29))

        def advance(load: dict[str, float]) -> None:
            nonlocal result
            result = fastpin.solve(problem, [load], start=result)

    times = []
    for load in loads(WARM_UP + steps):
        began = time.process_time()
        advance(load)
        times.append(time.process_time() - began)
    return statistics.median(times[WARM_UP:])


def in_process(checkout: Path, kind: str, nodes: int, steps: int) -> float:
    """Return :func:`measure` in a process of a checkout."""
    python = checkout / ".venv" / "bin" / "python"
    command = [str(python) if python.exists() else sys.executable, __file__, "--measure", kind]
    command += ["--nodes", str(nodes), "--steps", str(steps)]
    single = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(checkout)}
    done = subprocess.run(command, env=os.environ | single, cwd=checkout, check=True, capture_output=True, text=True)
    return float(json.loads(done.stdout))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", nargs="?", type=Path, default=HERE, help="checkout whose solve is timed")
    parser.add_argument("--nodes", type=int, default=201, help="nodes (default 201)")
    parser.add_argument("--steps", type=int, default=200, help="timed steps of a process (default 200)")
    parser.add_argument("--rounds", type=int, default=3, help="processes of each kind (default 3)")
    parser.add_argument("--measure", choices=("solve", "session"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        print(json.dumps(measure(options.measure, options.nodes, options.steps)))
        return
    found: dict[str, list[float]] = {"solve": [], "session": []}
    for _ in range(options.rounds):
        for kind, checkout in (("solve", options.other.resolve()), ("session", HERE)):
            found[kind].append(in_process(checkout, kind, options.nodes, options.steps))
    solve, session = (1e3 * statistics.median(found[kind]) for kind in ("solve", "session"))
    print(f"{options.nodes} nodes: solve {solve:.2f} ms, session {session:.2f} ms, ratio {solve / session:.1f}")


if __name__ == "__main__":
    main()

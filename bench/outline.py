"""A stepped lug with fatigue and a crack beside an LU factorisation: ``python bench/outline.py [OTHER] [--rounds 3]``.

Each job is a process with one thread: the lug's field, the solver alone, ``fastpin run``, ``fastpin show``, and the
fatigue of the stored states at 5,000 points. OTHER is another checkout; jobs of both run by turns. The numbers are
medians of processor times, s, with imports. In brackets are their ratios to LAPACK's dgetrf of 3,000 unknowns in the
same process. The memory is the largest one.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parents[1]
UNKNOWNS, POINTS = 3_000, 5_000

CASE = """
[pin]
material = "Ti-6Al-4V"
[plate]
material = "2024-T3"
[contact]
plane = "stress"
hole_radius = 10e-3
clearance = 20e-6
friction = 0.3
pin_load = "body"
[plate_body]
file = "lug.json"
[[load]]
P = 3e6
[[load]]
Q = 6e5
[[load]]
P = 3e5
Q = 1e5
[[load]]
P = 3e6
Q = 6e5
[fatigue]
criterion = "smith-watson-topper"
[crack]
first = 0.5e-3
last = 5e-3
theta = 80
law = { law = "walker", C = 1e-10, m = 3, exponent = 0.5 }
[solve]
nodes = 101
"""


def write_files() -> None:
    """Write the case and the compliance of its lug: sides at 2.2 R, fillets of 0.1 R to a step at 6 R, held at 10 R."""
    from fastpin.lugs import Lug, Part, plate_compliance

    right = [2.2 + 0j, 2.2 + 5.9j, 2.3 + 6j, 3.0 + 6j, 3.0 + 10j]
    ends = [1e-2 * z for z in (*right, *(-z.conjugate() for z in reversed(right)))]
    names = ["right", "fillet", "step", "shank", "top", "shank", "step", "fillet", "left", "nose"]
    middle = 1e-2 * (2.3 + 5.9j + 0.1 * np.exp(0.75j * np.pi))
    through = {1: middle, 7: -middle.conjugate(), 9: -2.2e-2j}
    parts = [Part(name, ends[k], ends[(k + 1) % len(ends)], through.get(k)) for k, name in enumerate(names)]
    lug = Lug(0.33, "stress", 1e-2, tuple(parts), {"top": "both"})
    Path("lug.json").write_text(plate_compliance(lug).compliance.to_text(), encoding="utf-8")
    Path("case.toml").write_text(CASE, encoding="utf-8")


def solve() -> None:
    """Solve the case."""
    import fastpin

    case = fastpin.read_case("case.toml")
    fastpin.solve(case.problem, case.history, **case.options.keywords())


def field() -> None:
    """Solve for the field of the lug."""
    import fastpin

    _ = fastpin.read_case("case.toml").problem.plate_body.rims


def fatigue() -> None:
    """Compute the fatigue of the stored states at points below the hole."""
    import fastpin
    from fastpin import damage

    rng = np.random.default_rng(0)
    points = fastpin.Points.at_xy(*(1e-2 * rng.uniform(*ends, POINTS) for ends in ((-2.1, 2.1), (1.5, 9.9))))
    damage.fatigue(list(fastpin.load("case.h5")), "smith-watson-topper", points=points)


def command(*words: str) -> Callable[[], None]:
    """Return the job of a command."""

    def job() -> None:
        from fastpin.cli.main import main

        main([*words])

    return job


JOBS = {
    "field": field,
    "solve": solve,
    "run": command("run", "case.toml", "-o", "case.h5", "--overwrite"),
    "show": command("show", "case.h5"),
    "fatigue": fatigue,
}


def answer(name: str) -> None:
    """Do a job, and tell its processor time, its memory in MB, and the processor time of LU on standard error."""
    JOBS[name]()
    times = [time.process_time()]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    from fastpin.runtime.extensions import lapack

    matrix = np.random.default_rng(0).normal(size=(UNKNOWNS, UNKNOWNS))
    times.append(time.process_time())
    lapack.dgetrf(matrix)
    print("answer", times[0], memory, time.process_time() - times[1], file=sys.stderr)


def ask(checkout: Path, name: str, folder: str) -> list[float]:
    """Run a job of a checkout in a process of its own."""
    own = checkout / ".venv" / "bin" / "python"
    single = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(checkout)}
    words = [str(own if own.exists() else sys.executable), "-P", __file__, "--answer", name]
    done = subprocess.run(words, cwd=folder, env=os.environ | single, capture_output=True, text=True)
    return [float(word) for word in done.stderr.split("answer ")[-1].split()]


def main() -> None:
    """Print the medians of all jobs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", nargs="?", type=Path, help="checkout that is measured by turns with this one")
    parser.add_argument("--rounds", type=int, default=3, help="times that each job is measured (default 3)")
    parser.add_argument("--answer", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.answer:
        answer(options.answer)
        return
    checkouts = [HERE] if options.other is None else [options.other.resolve(), HERE]
    found: dict[tuple[str, Path], list[list[float]]] = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        write_files()
        for _ in range(options.rounds):
            for name in JOBS:
                for checkout in checkouts:
                    found.setdefault((name, checkout), []).append(ask(checkout, name, folder))
    for (name, checkout), rounds in found.items():
        seconds, memory, lu = (statistics.median(column) for column in zip(*rounds, strict=True))
        print(f"{name:8s} {checkout.name:12s} {seconds:6.2f} ({seconds / lu:5.1f}), {memory:5.0f} MB")


if __name__ == "__main__":
    main()

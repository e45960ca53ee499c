"""Start-up of whole processes, in parts of the import of NumPy: all in turns, medians.

    python bench/startup.py                            this checkout
    python bench/startup.py ../before --rounds 9       beside others: checkouts, or folders that hold an installed wheel
    python bench/startup.py --cold 3                   also with nothing compiled, three times

A checkout with an environment .venv is run by its Python, others by this one. "Cold over warm" compares the shortest
wall times of the first run with nothing compiled, and of the runs after it.
The processor time (user and system) of a process is steadier than its wall time on a machine with other work. Both are
shown, with their ratios to ``python -c "import numpy"`` of the same checkout. A round that is not counted compiles the
kernels.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]

RUN = ["-m", "fastpin", "run"]
COMMANDS = {
    "python -c pass": ["-c", "pass"],
    "import numpy": ["-c", "import numpy"],
    "import numpy, scipy.linalg, numba": ["-c", "import numpy, scipy.linalg, numba"],
    "fastpin --help": ["-m", "fastpin", "--help"],
    "fastpin run": RUN,
    "fastpin run --plot": [*RUN, "--plot", "figure.png"],
}
COLD, WARM = "fastpin run, nothing compiled", "fastpin run, the next ones"
UNIT = "import numpy"

CHANGING = "PYTHONDONTWRITEBYTECODE"
"""The variable that the processes do not get: it leaves Python's own compiled files unwritten."""

Times = tuple[float, float]
"""Processor time and wall time of a process, s."""


def measure(checkout: Path, arguments: list[str], folder: Path, cache: Path | None = None) -> Times:
    """Run a process of a checkout from an empty folder. `cache` is a folder for its compiled code."""
    environment = {name: value for name, value in os.environ.items() if name != CHANGING}
    environment["PYTHONPATH"] = str(checkout)
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = str(cache)
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    own = checkout / ".venv/bin/python"
    command = [str(own if own.exists() else sys.executable), "-P", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def measure_all(checkouts: list[Path], rounds: int, cold: int) -> dict[tuple[Path, str], list[Times]]:
    """Times of all commands of all checkouts, in turns."""
    found: dict[tuple[Path, str], list[Times]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(rounds + 1):
            for words, arguments in COMMANDS.items():
                for checkout in checkouts:
                    times = measure(checkout, arguments, folder)
                    if number > 0:
                        found.setdefault((checkout, words), []).append(times)
        for number in range(cold):
            for place, checkout in enumerate(checkouts):
                cache = folder / f"cache{number}-{place}"
                for words in (COLD, WARM, WARM):
                    found.setdefault((checkout, words), []).append(measure(checkout, RUN, folder, cache))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("others", type=Path, nargs="*", help="other checkouts, or folders that hold a wheel")
    parser.add_argument("--rounds", type=int, default=5, help="times that each command is measured (default 5)")
    parser.add_argument("--cold", type=int, default=0, help="times that it is measured with nothing compiled")
    options = parser.parse_args()
    checkouts = [*(other.resolve() for other in options.others), HERE]
    found = measure_all(checkouts, options.rounds, options.cold)
    medians = {key: [statistics.median(column) for column in zip(*times, strict=True)] for key, times in found.items()}
    print(f"{'':36s}" + "".join(f"{checkout.name:>34s}" for checkout in checkouts))
    print(f"{'':36s}" + f"{'processor, ms':>14s}{'ratio':>6s}{'wall':>8s}{'ratio':>6s}" * len(checkouts))
    for words in (*COMMANDS, *([COLD, WARM] if options.cold else [])):
        row = f"{words:36s}"
        for checkout in checkouts:
            for place, width in ((0, 14), (1, 8)):
                seconds = medians[checkout, words][place]
                row += f"{1e3 * seconds:{width}.0f}{seconds / medians[checkout, UNIT][place]:6.1f}"
        print(row)
    if options.cold:
        shortest = {key: min(wall for _, wall in times) for key, times in found.items()}
        ratios = (shortest[checkout, COLD] / shortest[checkout, WARM] for checkout in checkouts)
        print(f"{'cold over warm':36s}" + "".join(f"{ratio:34.1f}" for ratio in ratios))


if __name__ == "__main__":
    main()

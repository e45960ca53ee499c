"""Compare the speed of two checkouts side by side: the benchmarks of each run in turns, on the same machine.

    python bench/versions.py ../before                     all benchmarks, three times each, in turns
    python bench/versions.py ../before --rounds 5 -k cycle

Each checkout needs its environment ``.venv`` (``./scripts/test`` makes it). For each benchmark the table shows the
shortest time of all rounds of either checkout, and the ratio of this checkout to the other one. FASTPIN_BENCH_SIZES
chooses the numbers of nodes.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]

Times = dict[str, float]
"""Shortest time of each benchmark, s."""


def measure(checkout: Path, chosen: str) -> Times:
    """Run the benchmarks of a checkout once, in its own environment."""
    with tempfile.TemporaryDirectory() as folder:
        stored = Path(folder, "times.json")
        command = [str(checkout / ".venv/bin/python"), "-m", "pytest", "bench", "-q", f"--benchmark-json={stored}"]
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run(
            [*command, *(["-k", chosen] if chosen else [])],
            cwd=checkout,
            env=environment,
            capture_output=True,
            text=True,
        )
        if done.returncode != 0:
            sys.exit(f"the benchmarks of {checkout} failed:\n{done.stdout}{done.stderr}")
        found = json.loads(stored.read_text(encoding="utf-8"))["benchmarks"]
    return {entry["name"]: float(entry["stats"]["min"]) for entry in found}


def shortest(one: Times, other: Times) -> Times:
    """The shorter of two times of each benchmark."""
    return {name: min(one.get(name, seconds), seconds) for name, seconds in {**one, **other}.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=Path, help="the other checkout")
    parser.add_argument("--rounds", type=int, default=3, help="times that each checkout is measured (default 3)")
    parser.add_argument("-k", dest="chosen", default="", help="benchmarks to run, as for pytest")
    options = parser.parse_args()
    times: dict[Path, Times] = {}
    for number in range(options.rounds):
        for checkout in (options.other.resolve(), HERE):
            print(f"round {number + 1}: {checkout.name}", file=sys.stderr)
            found = measure(checkout, options.chosen)
            times[checkout] = shortest(found, times.get(checkout, found))
    before, after = times[options.other.resolve()], times[HERE]
    print(f"{'benchmark':60s} {'other, ms':>12s} {'this, ms':>12s} {'ratio':>7s}")
    for name in before:
        if name in after:
            print(f"{name:60s} {1e3 * before[name]:12.3f} {1e3 * after[name]:12.3f} {after[name] / before[name]:7.3f}")


if __name__ == "__main__":
    main()

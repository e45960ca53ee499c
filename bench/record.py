"""Processor time of a stored corner in histories on both sides of the number of states from which files have extremes.

    python bench/record.py [--nodes 201] [--corners 450 550] [--most 1.5]

The corners are different amplitudes of the main case. Histories are recorded in turn, and the fastest round counts. The
exit code is 1 if a corner of the longer history costs more than ``--most`` corners of the shorter one.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import cases

import fastpin


def seconds(corners: int, nodes: int, folder: Path) -> float:
    """Record a history with so many corners. Return the processor time of a corner, s."""
    history = (cases.FIRST_LOAD + cases.variable_cycles((corners + 1) // 2))[:corners]
    began = time.process_time()
    fastpin.record(cases.PROBLEM, history, folder / "run.h5", nodes=nodes, arc=cases.ARC, overwrite=True)
    return (time.process_time() - began) / corners


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=201, help="nodes (default 201)")
    parser.add_argument("--corners", type=int, nargs=2, default=[450, 550], help="corners (default 450 550)")
    parser.add_argument("--rounds", type=int, default=3, help="rounds (default 3)")
    parser.add_argument("--most", type=float, default=1.5, help="largest ratio (default 1.5)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        seconds(options.corners[1], options.nodes, Path(folder))  # compiles
        rounds = [[seconds(n, options.nodes, Path(folder)) for n in options.corners] for _ in range(options.rounds)]
    short, long = (min(times) for times in zip(*rounds, strict=True))
    print(json.dumps({"nodes": options.nodes, "corners": options.corners, "ms_per_corner": [1e3 * short, 1e3 * long],
                      "ratio": long / short}, indent=2))  # fmt: skip
    return int(long > options.most * short)


if __name__ == "__main__":
    sys.exit(main())

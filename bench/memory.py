"""Peak memory of the first load, the way to the steady state and one cycle: ``python bench/memory.py NODES``.

It prints JSON: the peak of the whole process in MB, and the part above the baseline, in MB and in matrices of 2n rows
and columns. The baseline is the memory of Python, the libraries and the compiled code, measured at 61 nodes. Run it
twice: compiling raises the baseline. Each size needs its own process.
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

import cases

import fastpin


def peak_memory() -> float:
    """Return the largest resident memory of this process so far, MB.

    On Linux ``ru_maxrss`` includes the memory of the process that started this one. ``VmHWM`` does not.
    """
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return float(lines["VmHWM"].split()[0]) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def cycle(nodes: int) -> None:
    """Solve from no load to the steady state, and one cycle."""
    fastpin.solve(cases.PROBLEM, cases.CYCLE, start=cases.steady_state(nodes))


def main() -> None:
    """Measure one size and print the numbers."""
    nodes = int(sys.argv[1])
    cycle(61)
    baseline = peak_memory()
    cycle(nodes)
    peak = peak_memory()
    above = peak - baseline
    matrices = above * 2.0**20 / (8.0 * (2 * nodes) ** 2)
    print(json.dumps({"peak_mb": peak, "above_mb": above, "matrices": matrices}))


if __name__ == "__main__":
    main()

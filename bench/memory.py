"""Peak memory of the first load, the way to the steady state and one cycle: ``python bench/memory.py NODES``.

Prints JSON: the peak of the whole process, and of that what Python, the libraries and the compiled code take, found at
61 nodes. Run it twice: where code has to be compiled first, that part is larger. Each size needs a process of its own.
"""

from __future__ import annotations

import json
import resource
import sys
from pathlib import Path

import cases

import fastpin


def peak_memory() -> float:
    """Largest resident memory of this process so far, MB.

    Linux also charges to ``ru_maxrss`` what the process that started this one had; its own count does not.
    """
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return float(lines["VmHWM"].split()[0]) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def cycle(nodes: int) -> None:
    """From no load to the steady state, and once round."""
    fastpin.solve(cases.PROBLEM, cases.CYCLE, start=cases.steady_state(nodes))


def main() -> None:
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

"""Time and memory of a drag on the live page, without a browser: ``python bench/live.py [--nodes 201] [--loads 2000]``.

The load turns about the bottom of the hole. Each load is one message; its picture is made and written as JSON, as the
server does. The time is processor time. Memory is counted after a tenth of the loads and at the end.
"""

from __future__ import annotations

import argparse
import json
import math
import time

import numpy as np
import psutil

from fastpin import casefile
from fastpin.live.contact import LiveContact
from fastpin.live.protocol import Message

FORCE = 2.42e6
"""Force of the drag, N/m: that of the built-in case."""

PER_GESTURE = 300
"""Loads of a gesture: ten seconds of dragging."""


def measure(nodes: int, loads: int) -> dict[str, float]:
    """Drag, and return milliseconds and bytes of an update, and the growth of the process, MB."""
    contact, process = LiveContact(casefile.builtin_case(), nodes), psutil.Process()
    times, size, early = [], 0, 0
    for k in range(loads):
        turn = 0.05 * k
        given = {"P": FORCE * math.cos(0.9 * math.sin(0.3 * turn)), "Q": 0.5 * FORCE * math.sin(turn)}
        began = time.process_time()
        answer = contact.obey(Message("load", k, {"loads": given, "gesture": k // PER_GESTURE}))
        size = len(json.dumps(answer, separators=(",", ":")))
        times.append(time.process_time() - began)
        if k == loads // 10:
            early = process.memory_info().rss
    late = process.memory_info().rss
    warm = times[min(50, loads // 2) :]
    return {
        "median": 1e3 * float(np.median(warm)),
        "slow": 1e3 * float(np.quantile(warm, 0.95)),
        "bytes": size,
        "before": 1e-6 * early,
        "after": 1e-6 * late,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, nargs="+", default=[101, 201, 401], help="nodes (default 101 201 401)")
    parser.add_argument("--loads", type=int, default=2000, help="loads of the drag (default 2000)")
    options = parser.parse_args()
    for nodes in options.nodes:
        found = measure(nodes, options.loads)
        print(
            f"{nodes} nodes: median {found['median']:.1f} ms, 95 % {found['slow']:.1f} ms, {found['bytes']:,} bytes; "
            f"memory {found['before']:.0f} MB after {options.loads // 10:,} loads, {found['after']:.0f} MB at the end"
        )


if __name__ == "__main__":
    main()

"""The first load over its products at the rate of BLAS: ``python bench/first_load.py [NODES ...] [--rounds 3]``.

The products are those of the exchanges, with all rows stored: every exchange brings one column of 2n + 3 rows up to
date, by all exchanges before. For k exchanges these are (2n + 3) k^2 flops. The rate is that of ``dgemm`` with square
matrices of 2,000 rows on one thread, measured in turns with the first load. All times are processor times, so the
number of threads does not matter. The script prints JSON. It runs with older versions too, to compare the ratios.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from collections.abc import Callable
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import cases
import numpy as np
from scipy.linalg import blas

import fastpin

ORDER = 2000
"""Rows of the matrices whose product gives the rate: large enough for the full rate, 32 MB each."""


def processor_time(function: Callable[[], Any]) -> float:
    """The processor time of a call, s."""
    began = time.process_time()
    function()
    return time.process_time() - began


def measure(nodes: int, rounds: int) -> dict[str, float]:
    """Median times of first load and product, and their ratio."""
    matrix = np.asfortranarray(np.random.default_rng(0).random((ORDER, ORDER)))
    out = np.zeros_like(matrix)
    loads: list[float] = []
    products: list[float] = []
    kept: list[fastpin.Result] = []

    def load() -> None:
        kept[:] = [fastpin.solve(cases.PROBLEM, cases.FIRST_LOAD, nodes=nodes, arc=cases.ARC)]

    for _ in range(rounds):
        products.append(processor_time(lambda: blas.dgemm(1.0, matrix, matrix, beta=0.0, c=out, overwrite_c=1)))
        loads.append(processor_time(load))
    rate = 2.0 * ORDER**3 / statistics.median(products)
    exchanges = kept[0].statistics["exchanges"]
    flops = (2 * nodes + 3) * exchanges**2
    seconds = statistics.median(loads)
    return {
        "nodes": nodes, "seconds": seconds, "exchanges": exchanges, "gflops": 1e-9 * rate,
        "first load / products": seconds * rate / flops, "residual": max(kept[0][-1].residuals.values()),
    }  # fmt: skip


def main() -> None:
    """Measure all sizes and print the numbers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nodes", nargs="*", type=int, default=[4096], help="numbers of nodes (default 4096)")
    parser.add_argument("--rounds", type=int, default=3, help="rounds (default 3)")
    options = parser.parse_args()
    fastpin.solve(cases.PROBLEM, cases.FIRST_LOAD, nodes=61, arc=cases.ARC)  # compiles
    for nodes in options.nodes:
        print(json.dumps(measure(nodes, options.rounds)))


if __name__ == "__main__":
    main()

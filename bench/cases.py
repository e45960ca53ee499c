"""The cases that are timed. They stay as they are, so that times of different versions can be compared."""

from __future__ import annotations

import os

import numpy as np

from fastpin import MATERIALS, LoadHistory, MaterialPair, Problem

SIZES = tuple(int(size) for size in os.environ.get("FASTPIN_BENCH_SIZES", "101,401").split(","))
"""Numbers of nodes; set FASTPIN_BENCH_SIZES=101,401,1601 for more."""

ARC = (-0.5 * np.pi - 1.6, -0.5 * np.pi + 1.6)
"""The nodes' arc: given, so that the search for one is not timed."""

PROBLEM = Problem.from_load_parameter(
    MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"]),
    load_parameter=0.1,
    friction=0.4,
    pin_load="body",
)

FIRST_LOAD = LoadHistory([{"P": 1.0}])
CYCLE = LoadHistory([{"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}])

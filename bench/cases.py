"""The timed cases. They never change, so that times of different versions can be compared.

The main case: like bodies that conform closely (L_p = 0.05), body load, free rotation, mu = 0.55. Its history is the
load P = 1 and then cycles of Q = +-0.275, timed in the steady state.
"""

from __future__ import annotations

import functools
import math
import os

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.state import State
from tests.support.checks.integral_equations import residuals

SIZES = (101, 201, 401, 801, 1201, 2401)
"""Numbers of nodes that are timed."""

SMALL_SIZES = (101,)
"""Numbers of nodes of a run without timing. Such a run only shows that the benchmarks work."""

HALF_ARC = 1.75
CENTRE = -0.5 * math.pi
ARC = (CENTRE - HALF_ARC, CENTRE + HALF_ARC)
"""The arc of the nodes, rad. It is given, so that no search for an arc is timed."""

PROBLEM = Problem.from_load_parameter(
    MaterialPair(MATERIALS["aluminium"], MATERIALS["aluminium"]),
    load_parameter=0.05,
    friction=0.55,
    pin_load="body",
    rotation="free",
)
"""The problem of the main case."""

FORCE = 1.0
"""The reference force of the matrices."""

AMPLITUDE = 0.275
"""Amplitude of Q in the steady cycles."""
FIRST_LOAD = LoadHistory([{"P": 1.0}])
CYCLE = LoadHistory([{"Q": -AMPLITUDE}, {"Q": AMPLITUDE}])
STEADY_CYCLES = 2
"""Whole cycles before the steady cycle."""

STEADY = LoadHistory([{"P": 1.0}, {"Q": AMPLITUDE}, *STEADY_CYCLES * [{"Q": -AMPLITUDE}, {"Q": AMPLITUDE}]])
"""The history from no load to the steady state at +Q, where :data:`CYCLE` begins."""

SEED = 1934
"""Seed of the variable history."""

SMALLEST_SHARE = 0.1
"""Smallest amplitude of the variable history, relative to :data:`AMPLITUDE`."""

HISTORY_CYCLES = 4
"""Cycles of the variable history in the timed suite."""

INCREMENTS = 40
"""Increments a step of the timed increment solver."""

LARGEST_INCREMENT_SIZE = 401
"""Most nodes of the timed increment solver."""


def sizes(timed: bool) -> tuple[int, ...]:
    """Return the numbers of nodes. FASTPIN_BENCH_SIZES=101,401,4096 chooses others."""
    given = os.environ.get("FASTPIN_BENCH_SIZES")
    if given:
        return tuple(int(size) for size in given.split(","))
    return SIZES if timed else SMALL_SIZES


def uniform_grid(nodes: int) -> Grid:
    """Return a grid of equally spaced nodes."""
    return Grid.arc(*ARC, nodes)


def graded_grid(nodes: int) -> Grid:
    """Return a grid on the same arc, about half as dense in its middle as at its ends."""
    x = np.linspace(-1.0, 1.0, nodes)
    return Grid(CENTRE + HALF_ARC * (x + np.sin(math.pi * x) / (3.0 * math.pi)))


GRIDS = {"uniform": uniform_grid, "graded": graded_grid}
"""The timed grids by name."""


@functools.cache
def steady_state(nodes: int) -> Result:
    """Solve up to the steady state at +Q, where a cycle or a variable history begins."""
    return solve(PROBLEM, STEADY, nodes=nodes, arc=ARC)


def variable_cycles(cycles: int) -> LoadHistory:
    """Return cycles of Q between +a and -a, each with its own amplitude a. The first k are the same for any number."""
    shares = np.random.default_rng(SEED).uniform(SMALLEST_SHARE, 1.0, cycles)
    return LoadHistory([{"Q": float(sign * AMPLITUDE * share)} for share in shares for sign in (1.0, -1.0)])


def singular_residuals(state: State) -> tuple[np.ndarray, np.ndarray]:
    """Return the residuals of the singular integral equations (46), (47) at all nodes, from tractions as fields."""
    return residuals(PROBLEM, FORCE, state.grid, state.pressure, state.shear, state.slip, state.rotation)

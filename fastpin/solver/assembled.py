"""The tractions that the assembly of a joint leaves, before any load."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fastpin.elasticity.tractions import Tractions
from fastpin.kernels.status import STICK
from fastpin.model.doubts import doubts_given
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.reading.stress import tractions_of
from fastpin.solver.solving import solve


@lru_cache(maxsize=8)
def assembled_tractions(problem: Problem, grid: Grid) -> tuple[Tractions, ...]:
    """The tractions before any load, Pa: on the pin, and in the seat of a bush if that is an interface of its own.

    Those of a round joint are the pressures of Lame. Any other joint is solved without loads.

    Parameters
    ----------
    problem : Problem
    grid : Grid
        The nodes of the pin.

    Returns
    -------
    tuple of Tractions
        Empty if nothing is pressed.
    """
    if not problem.is_pressed:
        return ()
    if not problem.is_round:
        with doubts_given():
            state = solve(problem, [{}], grid=grid)[-1]
        return tuple(each.refined.tractions for each in (state, state.seat) if each is not None)
    pressures = problem.joint.assembly_pressures(problem.assembled_clearance)[: len(problem.interfaces)]
    around = Grid.circle(16)
    none, closed = np.zeros(around.size), np.full(around.size, STICK, dtype=np.int8)
    return tuple(
        tractions_of(around, closed, none + pressure, none) if pressure else Tractions(()) for pressure in pressures
    )

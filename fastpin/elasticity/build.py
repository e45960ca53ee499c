"""The system of a problem on a grid: built, or one of the latest systems."""

from __future__ import annotations

import threading

import numpy as np

from fastpin.elasticity.interfaces import JointSystem, seat_grid
from fastpin.elasticity.system import System
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem

MOST_DENSE = 400
"""Nodes of unequal spacing, at most, for which the whole operator is filled."""

MOST_KEPT = 512
"""Most nodes of a system that is kept. It takes 8 MB."""

_KEPT: list[System] = []
"""The latest systems with few nodes. A history that goes on in pieces asks for the same one again and again."""

_LOCK = threading.Lock()


def build_system(problem: Problem, grid: Grid, force: float) -> System:
    """The system of `problem` on `grid` with reference force `force`, N/m; a :class:`fastpin.narrow.LargeSystem` where
    that is due.

    Where a bush slips, `grid` has the nodes of the pin, and as many go round the seat. Other systems with few nodes
    are those of :func:`latest_system`.
    """
    if problem.seat is not None:
        return JointSystem.join(problem, (grid, seat_grid(problem, grid)), force)
    if grid.closed and not grid.uniform and grid.size > MOST_DENSE:
        from fastpin.narrow import LargeSystem

        return LargeSystem.build(problem, grid, force)
    return latest_system(problem, grid, force)


def latest_system(problem: Problem, grid: Grid, force: float) -> System:
    """The system of the pin, with a bush that sticks.

    The latest systems with few nodes are kept, and returned again for the same problem and grid. Problems that differ
    in friction and fit only share their matrices, as many runs of a sweep do.
    """
    if grid.size > MOST_KEPT:
        return System.build(problem, grid, force)
    with _LOCK:
        alike = [
            known for known in _KEPT
            if known.scales.force == force and known.grid.closed == grid.closed
            and np.array_equal(known.grid.theta, grid.theta)
        ]  # fmt: skip
    same, changed = (known for known in alike if known.problem == problem), (known.changed(problem) for known in alike)
    system = next(same, None) or next(filter(None, changed), None) or System.build(problem, grid, force)
    with _LOCK:  # eight: of a history, of its coarse run, the same two for its error bars, and those of the runs before
        _KEPT[:] = [system, *(known for known in _KEPT if known is not system)][:8]
    return system

"""A system of many nodes of which few are in contact at a time: its operator is never stored."""

from __future__ import annotations

import threading

import numpy as np

from fastpin.elasticity.drive import Drive
from fastpin.elasticity.interfaces import JointSystem, seat_grid
from fastpin.elasticity.operator import AnisotropicTerm, Operator, uniform_part
from fastpin.elasticity.system import System
from fastpin.elasticity.terms import BodyTerms
from fastpin.kernels import fourier, influence
from fastpin.model.grid import Grid, arc_of
from fastpin.model.problem import Problem

MOST_DENSE = 400
"""Nodes of unequal spacing, at most, for which the whole operator is filled."""

MOST_KEPT = 512
"""Most nodes of a system that is kept. It takes 8 MB."""

_KEPT: list[System] = []
"""The latest systems with few nodes. A history that goes on in pieces asks for the same one again and again."""

_LOCK = threading.Lock()


class ColumnsOperator(Operator):
    """An operator without stored entries. A product computes the columns of the nodes that carry tractions."""

    def __init__(self, problem: Problem, grid: Grid, bodies: BodyTerms | None, drive: Drive) -> None:
        super().__init__(2 * grid.size)
        self._problem, self._grid, self._bodies, self._drive = problem, grid, bodies, drive
        factor = None if bodies is None else bodies.anisotropy
        self._term = AnisotropicTerm(grid, factor) if factor else None

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        grid, pair = self._grid, self._problem.surfaces
        n, scale = grid.size, 1.0 / (4.0 * np.pi)
        pressure, shear = tractions[:n], tractions[n:]
        loaded = np.flatnonzero((pressure != 0.0) | (shear != 0.0))
        left, right = grid.halves
        gap = np.full(n, -scale * uniform_part(self._problem) * float(grid.weights @ pressure))
        slip = np.zeros(n)
        for begin in range(0, loaded.size, 64):  # so many columns at a time
            nodes = loaded[begin : begin + 64]
            direct, cross = (np.empty((n, nodes.size), order="F") for _ in range(2))
            influence.log_columns(
                grid.theta, grid.theta[nodes], left[nodes], right[nodes], pair.alpha_star / pair.beta_star, scale,
                direct, cross,
            )  # fmt: skip
            gap += direct @ pressure[nodes] + cross @ shear[nodes]
            slip += direct @ shear[nodes] - cross @ pressure[nodes]
            if self._term is not None:
                moved = self._term.columns(nodes) @ (pressure[nodes] + 1j * shear[nodes])
                gap += moved.real
                slip -= moved.imag
        found = np.r_[gap, slip]
        if self._bodies is not None and self._bodies.coefficients.any():
            given = np.array([pressure, shear])
            found += fourier.product(grid.theta, grid.theta, left, right, self._bodies.coefficients, given).ravel()
        if self._bodies is not None and self._bodies.matrix.size:
            found += self._bodies.matrix_product(grid, tractions)
        moved, coupling = self._drive.factors
        return found + moved @ (coupling @ tractions) if coupling.size else found


class LargeSystem(System):
    """A system whose operator has no stored entries. Solvers work on a window of neighbouring nodes."""

    def window(self, nodes: np.ndarray) -> System:
        """The system of neighbouring `nodes`, shape (k,), in their order round the hole. Its end nodes stay open."""
        built = System.build(self.problem, arc_of(self.grid, nodes), self.scales.force)
        return built.with_friction(self.friction[nodes])

    @staticmethod
    def _operator(problem: Problem, grid: Grid, bodies: BodyTerms | None, drive: Drive) -> Operator:
        return ColumnsOperator(problem, grid, bodies, drive)


def build_system(problem: Problem, grid: Grid, force: float) -> System:
    """The system of `problem` on `grid` with reference force `force`, N/m; a :class:`LargeSystem` where that is due.

    Where a bush slips, `grid` has the nodes of the pin, and as many go round the seat. Other systems with few nodes
    are those of :func:`latest_system`.
    """
    if problem.seat is not None:
        return JointSystem.join(problem, (grid, seat_grid(problem, grid)), force)
    if grid.closed and not grid.uniform and grid.size > MOST_DENSE:
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
    system = next((known for known in alike if known.problem == problem), None)
    if system is None:
        changed = (known.changed(problem) for known in alike)
        system = next(filter(None, changed), None) or System.build(problem, grid, force)
    with _LOCK:  # four: of a history, of its coarse run, and the same two for its error bars or the run before
        _KEPT[:] = [system, *(known for known in _KEPT if known is not system)][:4]
    return system

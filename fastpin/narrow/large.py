"""A system of many nodes of which few are in contact at a time: its operator is never stored."""

from __future__ import annotations

import numpy as np

from fastpin.elasticity.drive import Drive
from fastpin.elasticity.operator import AnisotropicTerm, Operator, uniform_part
from fastpin.elasticity.system import System
from fastpin.elasticity.terms import BodyTerms
from fastpin.kernels import fourier, influence
from fastpin.model.grid import Grid, arc_of
from fastpin.model.problem import Problem


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

    needs_windows = True

    def part(self, nodes: np.ndarray) -> System:
        """The system of neighbouring `nodes`, shape (k,), in their order round the hole. Its end nodes stay open."""
        built = System.build(self.problem, arc_of(self.grid, nodes), self.scales.force)
        return built.with_friction(self.friction[nodes])

    @staticmethod
    def _operator(problem: Problem, grid: Grid, bodies: BodyTerms | None, drive: Drive) -> Operator:
        return ColumnsOperator(problem, grid, bodies, drive)

"""The operator of a system: the map from the tractions (N, T) to the elastic part of gap and slip (h, s).

Solvers need products with vectors, and entries. :class:`DenseOperator` holds all entries. :class:`ToeplitzOperator` is
for many equally spaced nodes. There an entry depends on the distance of two nodes only, up to the half hats at the ends
of an arc. So a product is a convolution, by fast Fourier transforms, and an entry is looked up by its distance.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from fastpin.elasticity.anisotropy import AnisotropicTerm
from fastpin.elasticity.convolution import spectra
from fastpin.elasticity.drive import Drive
from fastpin.elasticity.terms import BodyTerms
from fastpin.kernels import influence, toeplitz
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.runtime.extensions import fft

LARGEST_DENSE = 1_000
"""Equally spaced nodes, at most, for which all entries are stored.

Up to here the matrix has 32 MB, and transforms would save less than a tenth of the time (measured at 801 nodes).
"""


class Operator:
    """A square matrix that is not necessarily stored, with one row and one column for each traction.

    Attributes
    ----------
    size : int
        Number of rows, 2n.
    is_stored : bool
        Whether all entries are stored. If not, products with many columns are better made by the operator itself than
        from a copy of its entries.
    by_distance : bool
        Whether the entries of equally spaced nodes depend on their distance, up to what bodies and drive add.
    matrix : ndarray, shape (2n, 2n), or None
        All entries, column by column; None if they are not stored together.
    """

    matrix: np.ndarray | None = None
    is_stored = False
    by_distance = True

    def __init__(self, size: int) -> None:
        self.size = size

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        """Gap and slip, shape (2n,) or (2n, k), of tractions (N, T) of the same shape."""
        raise NotImplementedError

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` (r, k), stored column by column, with the entries in `rows` (r,) and `columns` (k,).

        Rows are indices among (h, s), columns among (N, T).
        """
        unit = np.zeros(self.size)
        for place, column in enumerate(columns):
            unit[column] = 1.0
            out[:, place] = (self @ unit)[rows]
            unit[column] = 0.0

    def entries(self, rows: np.ndarray | None = None, columns: np.ndarray | None = None) -> np.ndarray:
        """A copy of the entries in `rows` (r,) and `columns` (k,), shape (r, k). None stands for all of them."""
        rows, columns = (np.arange(self.size) if given is None else given for given in (rows, columns))
        out = np.empty((rows.size, columns.size), order="F")
        self.fill(rows, columns, out)
        return out

    def diagonal(self) -> np.ndarray:
        """The entries of the diagonal, shape (2n,)."""
        return np.array([self.entries(np.array([place]), np.array([place]))[0, 0] for place in range(self.size)])

    @cached_property
    def typical(self) -> float:
        """A typical compliance, to judge pivots: the median of the diagonal."""
        return float(np.sort(np.abs(self.diagonal()))[self.size // 2])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        """All entries, for tests and studies of small systems."""
        return self.entries().astype(dtype or float, copy=False)


class DenseOperator(Operator):
    """An operator whose entries are all stored in `matrix`, shape (2n, 2n), column by column."""

    matrix: np.ndarray
    is_stored = True

    def __init__(self, matrix: np.ndarray) -> None:
        super().__init__(len(matrix))
        self.matrix = np.asfortranarray(matrix)

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        product: np.ndarray = self.matrix @ tractions
        return product

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        np.take(self.matrix.T.take(columns, axis=0), rows, axis=1, out=out.T, mode="clip")

    def entries(self, rows: np.ndarray | None = None, columns: np.ndarray | None = None) -> np.ndarray:
        if rows is None:  # whole columns or rows are copied faster than their parts
            return self.matrix.copy() if columns is None else self.matrix[:, columns]
        if columns is None:
            return self.matrix[rows]
        return self.matrix.T.take(columns, axis=0).take(rows, axis=1).T

    def diagonal(self) -> np.ndarray:
        return np.diagonal(self.matrix)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.matrix, dtype) if copy else self.matrix.astype(dtype or float, copy=False)


class SoftOperator(Operator):
    """An operator whose nodes are softer: a pressure also opens the gap at its own node.

    Parameters
    ----------
    base : Operator
    softness : ndarray, shape (n,)
        Gap per pressure at each node, beside that of `base`.
    """

    by_distance = False

    def __init__(self, base: Operator, softness: np.ndarray) -> None:
        super().__init__(base.size)
        self.is_stored = base.is_stored
        self._base, self._softness = base, np.concatenate([softness, np.zeros_like(softness)])

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        product: np.ndarray = self._base @ tractions + (self._softness * tractions.T).T
        return product

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        self._base.fill(rows, columns, out)
        out += np.where(rows[:, None] == columns, self._softness[columns], 0.0)

    def diagonal(self) -> np.ndarray:
        return self._base.diagonal() + self._softness

    @cached_property
    def matrix(self) -> np.ndarray | None:  # type: ignore[override]
        return None if self._base.matrix is None else self.entries()


class ToeplitzOperator(Operator):
    """The operator of equally spaced nodes.

    Parameters
    ----------
    blocks : ndarray, shape (2, 2, n, k)
        Columns of the hats from which all columns follow, see :func:`fastpin.kernels.influence.uniform_columns`.
    closed : bool
        Whether the nodes go round the whole circle.
    left : ndarray, shape (2n, r)
    right : ndarray, shape (r, 2n)
        Factors of a matrix that is added. It may have the rank r = 0.
    """

    def __init__(self, blocks: np.ndarray, closed: bool, left: np.ndarray, right: np.ndarray) -> None:
        n = blocks.shape[2]
        super().__init__(2 * n)
        self._closed, self._left, self._right = closed, left, right
        self._by_distance = np.array(influence.by_distance(blocks, closed))
        self._half_hat = np.zeros((4, 0)) if closed else np.ascontiguousarray(blocks[..., 0].reshape(4, n))
        self._period, found = spectra(self._by_distance, (1.0, 1.0, -1.0), closed)
        self._even, self._odd = np.ascontiguousarray(found[:2].real), 1j * found[2].imag

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        n, period = self.size // 2, self._period
        given = tractions.T.reshape(*tractions.shape[1:], 2, n)
        whole = given
        if not self._closed:
            whole = given.copy()
            whole[..., [0, -1]] = 0.0  # the ends have half hats
        pressure, shear = np.moveaxis(fft.rfft(whole, period, workers=1), -2, 0)
        turned = np.empty((*given.shape[:-1], pressure.shape[-1]), dtype=complex)
        turned[..., 0, :] = self._even[0] * pressure + self._odd * shear
        turned[..., 1, :] = self._even[1] * shear - self._odd * pressure
        found = fft.irfft(turned, period, workers=1, overwrite_x=True)[..., :n].reshape(tractions.T.shape).T
        if not self._closed and given[..., [0, -1]].any():
            ends = np.array([0, n - 1, n, 2 * n - 1])
            hats = np.empty((2 * n, 4), order="F")
            self._fill_hats(np.arange(2 * n), ends, hats)
            found = found + hats @ tractions[ends]
        return found + self._left @ (self._right @ tractions) if self._right.size else found

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        self._fill_hats(rows, columns, out)
        if self._right.size:
            out += self._left[rows] @ self._right[:, columns]

    def _fill_hats(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` (r, k), column by column, with the entries without the added matrix."""
        for place, column in enumerate(columns):
            toeplitz.fill_column(*self._by_distance, self._half_hat, self._closed, rows, column, out[:, place])

    def diagonal(self) -> np.ndarray:
        n = self.size // 2
        found = np.repeat(self._by_distance[:2, 0], n)
        if not self._closed:
            found[[0, n - 1]], found[[n, -1]] = self._half_hat[0, 0], self._half_hat[3, 0]
        return found + np.einsum("ij,ji->i", self._left, self._right) if self._right.size else found


class AnisotropicOperator(Operator):
    """An operator of equally spaced nodes whose entries are not stored, and the term of a laminate.

    Parameters
    ----------
    base : Operator
    term : AnisotropicTerm
    """

    def __init__(self, base: Operator, term: AnisotropicTerm) -> None:
        super().__init__(base.size)
        self._base, self._term = base, term

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        product: np.ndarray = self._base @ tractions + self._term.product(tractions)
        return product

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        self._base.fill(rows, columns, out)
        self._term.add_entries(rows, columns, out)

    def diagonal(self) -> np.ndarray:
        own = self._term.diagonal().real
        return self._base.diagonal() + np.r_[own, -own]


def make_operator(problem: Problem, grid: Grid, bodies: BodyTerms | None, drive: Drive) -> Operator:
    """The operator of `problem` on `grid`, dimensionless.

    `bodies` are the smooth terms of pin and plate. The `drive` adds its coupling.
    """
    n, pair = grid.size, problem.surfaces
    left, right = grid.knots()
    hats = grid.theta, left, right, grid.uniform, grid.closed, pair.alpha_star / pair.beta_star, uniform_part(problem)
    smooth = None if bodies is None or not bodies.coefficients.any() else bodies.coefficients
    term = None if bodies is None or not bodies.anisotropy else AnisotropicTerm(grid, bodies.anisotropy)
    if grid.uniform and n > LARGEST_DENSE:
        factors = [drive.factors]  # of the part of the operator that is no Toeplitz matrix
        if bodies is not None and bodies.matrix.size:
            factors.insert(0, bodies.factors(grid))
        parts = zip(*factors, strict=True)
        blocks = influence.uniform_columns(*hats, smooth)
        base = ToeplitzOperator(blocks, grid.closed, np.hstack(next(parts)), np.vstack(next(parts)))
        return base if term is None else AnisotropicOperator(base, term)
    matrix = np.empty((2 * n, 2 * n), order="F")
    influence.fill_operator(*hats, matrix, smooth)
    if bodies is not None and bodies.matrix.size:
        waves, displaced = bodies.factors(grid)
        matrix += waves @ displaced
    if term is not None:
        term.add_to(matrix)
    moved, coupling = drive.factors
    if coupling.size:
        matrix += moved @ coupling
    return DenseOperator(matrix)


def uniform_part(problem: Problem) -> float:
    """The part of the operator that a uniform pressure has in the pin, per beta*."""
    pair = problem.surfaces
    return (pair.pin_kolosov + 1.0) * pair.pin_compliance / (2.0 * pair.beta_star)

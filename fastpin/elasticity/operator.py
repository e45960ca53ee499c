"""The operator of a system: the map from the tractions (N, T) to the elastic part of gap and slip (h, s).

Solvers need products with vectors, and entries. :class:`DenseOperator` holds all entries. :class:`ToeplitzOperator` is
for many equally spaced nodes. There an entry depends on the distance of two nodes only, up to the half hats at the ends
of an arc. So a product is a convolution, by fast Fourier transforms, and an entry is looked up by its distance.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np

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
    is_quick : bool
        Whether a product takes no longer than that of a few stored rows.
    by_distance : bool
        Whether the entries of equally spaced nodes depend on their distance, up to what bodies and drive add.
    matrix : ndarray, shape (2n, 2n), or None
        All entries, column by column; None if they are not stored together.
    """

    matrix: np.ndarray | None = None
    is_stored = False
    is_quick = False
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


def _spectra(kernels: np.ndarray, signs: tuple[float, ...], closed: bool) -> tuple[int, np.ndarray]:
    """The period of convolutions with kernels of the distance of two nodes, and the transforms of the kernels.

    On a circle a convolution is periodic. On an arc its period has room for all distances of either sign.

    Parameters
    ----------
    kernels : ndarray, shape (k, n)
        Their values at the distances of 0 to n - 1 nodes.
    signs : tuple of float
        1 for an even kernel, whose transform is real; -1 for an odd one, whose transform is imaginary.
    closed : bool
        Whether the nodes go round the whole circle.

    Returns
    -------
    int, ndarray of shape (k, m)
    """
    n = kernels.shape[1]
    period = n if closed else fft.next_fast_len(2 * n - 1, real=True)
    whole = np.zeros((len(kernels), period))
    whole[:, :n] = kernels
    if not closed:
        whole[:, period - n + 1 :] = np.array(signs)[:, None] * kernels[:, :0:-1]
    return period, fft.rfft(whole, workers=1)


class AnisotropicTerm:
    """The term by which the hole in a laminate differs from the hole in an isotropic plate, on a grid; (T51).

    With p = N + iT the term adds D p to h - i s of the nodes:

        D_ij = f exp(-2i theta_i) K_ij,   f = -2 delta/beta*,   4 pi K_ij = int (C + iS) L(theta_i - xi) hat_j(xi) dxi.

    On equally spaced nodes the symmetric form f exp(-i (theta_i + theta_j)) k_ij takes its place, with the even k = Re
    exp(-i (theta_i - theta_j)) K of the distance of two nodes. The error stays of the second order in their spacing,
    and the operator stays symmetric.

    Parameters
    ----------
    grid : Grid
        n nodes.
    factor : complex
        The number f = -2 delta/beta*.
    """

    def __init__(self, grid: Grid, factor: complex) -> None:
        self.grid, self._factor = grid, complex(factor)
        self._turn = np.exp(-1j * grid.theta)

    @cached_property
    def by_distance(self) -> np.ndarray:
        """The numbers k of whole hats by the distance of two nodes, for equally spaced nodes; shape (n,)."""
        grid = self.grid
        n = grid.size
        spacing = 2.0 * math.pi / n if grid.closed else float(grid.theta[-1] - grid.theta[0]) / (n - 1)
        away, width = spacing * np.arange(n), np.array([spacing])
        return np.ascontiguousarray((np.exp(-1j * away) * _hats(away, np.zeros(1), width, width)[:, 0]).real)

    @cached_property
    def _half_hats(self) -> np.ndarray:
        """The columns D of the first and the last node of an arc, complex, shape (n, 2)."""
        return self._plain(np.array([0, self.grid.size - 1]))

    @cached_property
    def _spectrum(self) -> tuple[int, np.ndarray]:
        """The period of a convolution with the even k, and the transform of k, real."""
        period, found = _spectra(self.by_distance[None], (1.0,), self.grid.closed)
        return period, np.ascontiguousarray(found[0].real)

    def columns(self, nodes: np.ndarray) -> np.ndarray:
        """The columns D of the `nodes` (k,), complex, shape (n, k)."""
        if not self.grid.uniform:
            return self._plain(nodes)
        n = self.grid.size
        found: np.ndarray = self._factor * np.outer(self._turn, self._turn[nodes])
        found *= self.by_distance[np.abs(np.arange(n)[:, None] - nodes)]
        if not self.grid.closed:
            for end, node in enumerate((0, n - 1)):
                found[:, nodes == node] = self._half_hats[:, [end]]
        return found

    def diagonal(self) -> np.ndarray:
        """The entries D_ii, complex, shape (n,), on equally spaced nodes."""
        found: np.ndarray = self._factor * self._turn**2 * self.by_distance[0]
        if not self.grid.closed:
            found[[0, -1]] = self._half_hats[[0, -1], [0, 1]]
        return found

    def _plain(self, nodes: np.ndarray) -> np.ndarray:
        """The columns D of the `nodes` (k,) in the form that takes any spacing, complex, shape (n, k)."""
        theta, (left, right) = self.grid.theta, self.grid.halves
        hats = _hats(theta, theta[nodes], left[nodes], right[nodes])
        return self._factor * (self._turn**2)[:, None] * hats

    def product(self, tractions: np.ndarray) -> np.ndarray:
        """Gap and slip, shape (2n,) or (2n, k), of tractions (N, T) of the same shape, on equally spaced nodes."""
        n = self.grid.size
        both = (tractions[:n] + 1j * tractions[n:]).T
        whole = both * self._turn
        if not self.grid.closed:
            whole[..., [0, -1]] = 0.0
        period, spectrum = self._spectrum  # of a convolution with k
        parts = fft.rfft(np.stack([whole.real, whole.imag]), period, workers=1) * spectrum
        real, imag = fft.irfft(parts, period, workers=1)[..., :n]
        moved = self._factor * self._turn * (real + 1j * imag)
        if not self.grid.closed and both[..., [0, -1]].any():
            moved = moved + both[..., [0, -1]] @ self._half_hats.T
        return np.concatenate([moved.real, -moved.imag], axis=-1).T

    def add_entries(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        """Add the entries in `rows` (r,) among (h, s) and `columns` (k,) among (N, T) to `out` (r, k).

        The nodes are equally spaced. `out` is stored column by column.
        """
        n = self.grid.size
        for place, column in enumerate(columns.tolist()):
            if not self.grid.closed and column % n in (0, n - 1):
                moved = self._half_hats[rows % n, int(column % n > 0)] * (1j if column >= n else 1.0)
                out[:, place] += np.where(rows >= n, -moved.imag, moved.real)
            else:
                toeplitz.add_turned_column(self.by_distance, self._turn, self._factor, rows, column, out[:, place])

    def add_to(self, matrix: np.ndarray) -> None:
        """Add the term to a matrix of all entries, shape (2n, 2n)."""
        n = self.grid.size
        found = self.columns(np.arange(n))
        matrix[:n, :n] += found.real
        matrix[:n, n:] -= found.imag
        matrix[n:, :n] -= found.imag
        matrix[n:, n:] -= found.real


def _hats(seen: np.ndarray, nodes: np.ndarray, h_left: np.ndarray, h_right: np.ndarray) -> np.ndarray:
    """The integrals K of hats, complex, one column for each hat; see :func:`fastpin.kernels.influence.log_columns`."""
    direct, cross = (np.empty((seen.size, nodes.size), order="F") for _ in range(2))
    influence.log_columns(seen, nodes, h_left, h_right, 0.0, 1.0 / (4.0 * math.pi), direct, cross)
    return np.asarray(1j * cross - direct)


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
    term : AnisotropicTerm or None
        The term of a laminate, which is added too.
    """

    def __init__(
        self, blocks: np.ndarray, closed: bool, left: np.ndarray, right: np.ndarray, term: AnisotropicTerm | None
    ) -> None:
        n = blocks.shape[2]
        super().__init__(2 * n)
        self._closed, self._left, self._right, self._term = closed, left, right, term
        self._by_distance = np.array(influence.by_distance(blocks, closed))
        self._half_hat = np.zeros((4, 0)) if closed else np.ascontiguousarray(blocks[..., 0].reshape(4, n))
        self._period, found = _spectra(self._by_distance, (1.0, 1.0, -1.0), closed)
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
        if self._right.size:
            found = found + self._left @ (self._right @ tractions)
        return found if self._term is None else found + self._term.product(tractions)

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        self._fill_hats(rows, columns, out)
        if self._right.size:
            out += self._left[rows] @ self._right[:, columns]
        if self._term is not None:
            self._term.add_entries(rows, columns, out)

    def _fill_hats(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` (r, k), column by column, with the entries without the added matrix."""
        for place, column in enumerate(columns):
            toeplitz.fill_column(*self._by_distance, self._half_hat, self._closed, rows, column, out[:, place])

    def diagonal(self) -> np.ndarray:
        n = self.size // 2
        found = np.repeat(self._by_distance[:2, 0], n)
        if not self._closed:
            found[[0, n - 1]], found[[n, -1]] = self._half_hat[0, 0], self._half_hat[3, 0]
        if self._right.size:
            found = found + np.einsum("ij,ji->i", self._left, self._right)
        if self._term is not None:
            own = self._term.diagonal().real
            found = found + np.r_[own, -own]
        return found


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
        return ToeplitzOperator(blocks, grid.closed, np.hstack(next(parts)), np.vstack(next(parts)), term)
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

"""The term by which the hole in a laminate differs from the hole in an isotropic plate, in dimensionless form; (T51).

With p = N + iT the term adds D p to h - i s of the nodes:

    D_ij = f exp(-2i theta_i) K_ij,    f = -2 delta/beta*,    4 pi K_ij = int (C + iS) L(theta_i - xi) hat_j(xi) dxi.

On equally spaced nodes the symmetric form f exp(-i (theta_i + theta_j)) k_ij takes its place, with the even k = Re
exp(-i (theta_i - theta_j)) K of the distance of two nodes. The error stays of the second order in their spacing, and
the operator stays symmetric.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from fastpin.elasticity.convolution import spectra
from fastpin.kernels import influence, toeplitz
from fastpin.model.grid import Grid
from fastpin.runtime.extensions import fft


class AnisotropicTerm:
    """The matrix of the term on the nodes of a grid, of which parts and products can be asked for.

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
        period, found = spectra(self.by_distance[None], (1.0,), self.grid.closed)
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
        theta, (left, right) = self.grid.theta, self.grid.knots()
        hats = _hats(theta, theta[nodes], theta[nodes] - left[nodes], right[nodes] - theta[nodes])
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

"""Spectral finite elements of a plate whose edge is seen from its hole: an independent check of stresses.

Rays from the hole to the outline cut the plate into quadrilaterals, which layers cut across. Displacements are
polynomials of the degree p in both directions, with the nodes and the quadrature of Gauss and Lobatto. Patera (1984)
has the method. Lengths are in hole radii, and the plate is in plane stress.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from numpy.polynomial import legendre

from fastpin.lugs.outline import Part


def lobatto(p: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes and weights on [-1, 1] of the degree p, and the matrix of derivatives."""
    series = np.eye(p + 1)[p]
    x = np.r_[-1.0, np.sort(legendre.legroots(legendre.legder(series)).real), 1.0]
    values = legendre.legval(x, series)
    away = x[:, None] - x + np.eye(p + 1)
    slopes = values[:, None] / values / away * (1.0 - np.eye(p + 1))
    slopes -= np.diag(slopes.sum(axis=1))
    return x, 2.0 / (p * (p + 1) * values**2), slopes


class SpectralPlate:
    """A plate of any outline, held at the parts of one name.

    Parameters
    ----------
    outline : sequence of Part
        Counter-clockwise; each ray from 0 meets it once.
    cuts : sequence of ndarray
        Shares of each part at which rays cut it, from 0 to 1.
    layers : ndarray
        Shares of the way from the hole to the outline, from 0 to 1.
    p : int
    held : str
    nu : float
    crack : (int, slice), optional
        A ray between two elements, and its nodes that a crack opens: they are doubled.

    Attributes
    ----------
    z : ndarray of complex, shape (around, across)
        Nodes, from the hole outwards.
    """

    def __init__(
        self, outline: list[Part], cuts: list[np.ndarray], layers: np.ndarray, p: int, held: str, nu: float,
        crack: tuple[int, slice] = (0, slice(0)),
    ) -> None:  # fmt: skip
        self.p, (x, self.weights, self.slopes) = p, lobatto(p)
        inner = 0.5 * (x[:-1] + 1.0)
        around, is_held = [], []
        for part, shares in zip(outline, cuts, strict=True):
            each = (shares[:-1, None] + np.diff(shares)[:, None] * inner).ravel()
            around.append(part.at(each))
            is_held += [part.name == held] * each.size
        rim = np.concatenate(around)
        self.share = np.r_[(layers[:-1, None] + np.diff(layers)[:, None] * inner).ravel(), 1.0]
        hole = rim / np.abs(rim)
        self.z = hole[:, None] + (rim - hole)[:, None] * self.share
        self.law = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]]) / (1.0 - nu**2)
        held_nodes = np.array(is_held)
        held_nodes |= np.roll(held_nodes, 1)  # the end of a part is the start of the next
        is_held_node = np.zeros(self.z.shape, dtype=bool)
        is_held_node[held_nodes, -1] = True
        self._number = np.arange(self.z.size).reshape(self.z.shape)
        self._ray, self._opened = crack
        doubled = self._number[crack]
        self._points = np.r_[self.z.ravel(), self.z.ravel()[doubled]]
        self._held = np.r_[is_held_node.ravel(), is_held_node.ravel()[doubled]]

    def blocks(self) -> list[np.ndarray]:
        """Numbers of the nodes between two rays of elements, (p + 1, across)."""
        found = [self._number[np.arange(k, k + self.p + 1) % len(self.z)] for k in range(0, len(self.z), self.p)]
        opened = found[self._ray // self.p][0, self._opened]
        found[self._ray // self.p][0, self._opened] = self.z.size + np.arange(opened.size)
        return found

    def elements(self) -> list[np.ndarray]:
        """Numbers of the nodes of each element, (p + 1, p + 1)."""
        starts = range(0, self.z.shape[1] - 1, self.p)
        return [block[:, m : m + self.p + 1] for block in self.blocks() for m in starts]

    def strains(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Strains per displacement at the nodes of an element, (points, 3, 2, points), and the areas of the points."""
        z, count = self._points[nodes], nodes.size
        one, other = np.kron(self.slopes, np.eye(self.p + 1)), np.kron(np.eye(self.p + 1), self.slopes)
        a, b = one @ z.ravel(), other @ z.ravel()
        area = (np.conj(a) * b).imag
        along_x = (b.imag[:, None] * one - a.imag[:, None] * other) / area[:, None]
        along_y = (-b.real[:, None] * one + a.real[:, None] * other) / area[:, None]
        found = np.zeros((count, 3, 2, count))
        found[:, 0, 0], found[:, 1, 1] = along_x, along_y
        found[:, 2, 0], found[:, 2, 1] = along_y, along_x
        return found, np.abs(area) * np.outer(self.weights, self.weights).ravel()

    def moved(self, traction: np.ndarray) -> tuple[np.ndarray, float]:
        """Displacements of all points times Young's modulus, (2, points), under tractions on the hole, (around,).

        The strain energy times Young's modulus comes with them.
        """
        count, pieces = self._points.size, []
        for nodes in self.elements():
            strains, areas = self.strains(nodes)
            stiff = np.einsum("pauk,ab,pbvl,p->ukvl", strains, self.law, strains, areas, optimize=True)
            places = (count * np.arange(2)[:, None] + nodes.ravel()).ravel()
            pieces.append((stiff.reshape(places.size, -1), places))
        rows = np.concatenate([np.repeat(places, places.size) for _, places in pieces])
        columns = np.concatenate([np.tile(places, places.size) for _, places in pieces])
        matrix = scipy.sparse.csc_matrix(
            (np.concatenate([each.ravel() for each, _ in pieces]), (rows, columns)), (2 * count, 2 * count)
        )
        force = np.zeros((2, count))
        for k, block in enumerate(self.blocks()):
            pulled = traction[np.arange(k * self.p, k * self.p + self.p + 1) % len(self.z)]
            length = np.abs(self.slopes @ self._points[block[:, 0]]) * self.weights
            force[:, block[:, 0]] += length * np.array([pulled.real, pulled.imag])
        free = np.flatnonzero(~np.r_[self._held, self._held])
        found = np.zeros(2 * count)
        found[free] = scipy.sparse.linalg.spsolve(matrix[free][:, free], force.ravel()[free])
        return found.reshape(2, -1), 0.5 * float(force.ravel() @ found)

    def stresses(self, traction: np.ndarray) -> np.ndarray:
        """(sxx, syy, sxy) at all nodes, shape (3, around, across), under tractions on the hole, complex (around,)."""
        both, count = self.moved(traction)[0], self._points.size
        sums, times = np.zeros((3, count)), np.zeros(count)
        for nodes in self.elements():
            strains, _ = self.strains(nodes)
            here = np.einsum("ab,pbuk,uk->ap", self.law, strains, both[:, nodes.ravel()], optimize=True)
            sums[:, nodes.ravel()] += here
            times[nodes.ravel()] += 1.0
        return (sums / times)[:, : self.z.size].reshape(3, *self.z.shape)

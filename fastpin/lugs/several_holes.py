"""The compliance of a plate with several pinned holes of one radius, between the Fourier coefficients of their edges.

The blocks of the matrix are those of :mod:`fastpin.bodies.compliance`, one row of blocks and one column for each hole:
G v_j/R = hole f_j + sum over i of matrix_ji f_i. The first harmonics hold the forces of the pins and the translations
of the holes. In an infinite plate the translation of a hole counts from the place of an unloaded plate, up to the
logarithm ln(r/R) of each force.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from fastpin.lugs.outline import Lug
from fastpin.lugs.plates import FINE, edge_basis, hole_compliance, respond
from fastpin.model.loads import LOADS, SXX, SXY, SYY


@dataclass(frozen=True, eq=False)
class HolesCompliance:
    """What the plate adds to the compliance of each hole in an infinite plate of its own, dimensionless.

    Attributes
    ----------
    matrix : ndarray, shape (H m, H m)
        For H holes and m = 2 + 4 K coefficients.
    columns : dict of str to ndarray, shape (H m,)
        Displacement G v/R per unit of a load of the plate, by the name of the load.
    holes : int
        H.
    resultants : dict of str to ndarray, shape (3,)
        Force along x and y and moment about the first hole of each load, per thickness, of a plate that floats.
    """

    matrix: np.ndarray
    columns: dict[str, np.ndarray]
    holes: int
    resultants: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def order(self) -> int:
        """The highest harmonic K."""
        return (len(self.matrix) // self.holes - 2) // 4

    def block(self, to: int, by: int) -> np.ndarray:
        """The displacement of one hole by the harmonics of another one, or its own, shape (m, m)."""
        each = 2 + 4 * self.order
        return self.matrix[each * to : each * to + each, each * by : each * by + each]

    def column(self, name: str, hole: int) -> np.ndarray:
        """The displacement of a hole by a load of the plate, shape (m,)."""
        each = 2 + 4 * self.order
        return self.columns[name][each * hole : each * hole + each]


def holes_in_outline(lug: Lug, pinned: Sequence[str], order: int, progress: Callable[[float], None]) -> HolesCompliance:
    """The compliance of a finite plate: its first hole and the further holes with these names carry a pin.

    ``progress(done)`` is called from time to time, with the part that is done.
    """
    each, count = 2 + 4 * order, 1 + len(pinned)
    response = respond(lug, order, FINE, progress, dict.fromkeys(pinned, order))
    whole = response.projected()
    square = whole[:, : each * count]
    matrix = 0.5 * (square + square.T) - np.kron(np.eye(count), hole_compliance(order, lug.kolosov))
    columns = dict(zip(response.loads, whole[:, each * count :].T, strict=True))
    carried = () if response.resultants is None else response.resultants[:, each * count :].T
    return HolesCompliance(matrix, columns, count, dict(zip(response.loads, carried, strict=False)))


def holes_in_infinite_plate(kolosov: float, centres: np.ndarray, order: int) -> HolesCompliance:
    """The compliance of an infinite plate with holes of radius 1 round `centres` (H,), complex.

    Each hole alone has Kolosov's potentials phi' = sum A_k w^-k and psi' = sum B_k w^-k, w = z - centre. Their
    tractions and displacements on all edges are projected on the harmonics: S and D. The compliance is D S^-1.
    """
    count, each = centres.size, 2 + 4 * order
    points = 4 * order + 16
    theta = 2.0 * math.pi / points * np.arange(points)
    radial = np.exp(1j * theta)
    basis = 2.0 / points * np.conj(edge_basis(radial, order)).T * radial  # of r and theta components

    def projected(field: np.ndarray) -> np.ndarray:
        """The coefficients (2 + 4 K, ...) of a field of r + i theta components (points, ...)."""
        return (basis @ field).real

    tractions, moved = np.empty((2, count * each, count * each))
    potentials = _potentials(order, kolosov)
    for i in range(count):
        own = slice(each * i, each * i + each)
        for j in range(count):
            w = radial + (centres[j] - centres[i])
            on_edge, displaced = _fields(potentials, w, radial, kolosov)
            rows = slice(each * j, each * j + each)
            tractions[rows, own], moved[rows, own] = projected(on_edge), projected(displaced)
    compliance = np.linalg.solve(tractions.T, moved.T).T
    columns = {}
    for place, (mean, deviator) in {SXX: (0.25, -0.5), SYY: (0.25, 0.5), SXY: (0.0, 1j)}.items():
        remote_traction, remote_moved = np.empty((2, count * each))
        for j in range(count):
            rows, z = slice(each * j, each * j + each), radial + centres[j]
            spread = 2.0 * mean - radial**2 * deviator  # s_rr - i s_rtheta of the uniform stress
            turned = 0.5 * (kolosov * mean * z - mean * z - np.conj(deviator * z)) * np.conj(radial)
            remote_traction[rows] = projected(-np.conj(spread))
            remote_moved[rows] = projected(turned)
        columns[LOADS[place]] = remote_moved - compliance @ remote_traction
    matrix = 0.5 * (compliance + compliance.T) - np.kron(np.eye(count), hole_compliance(order, kolosov))
    return HolesCompliance(matrix, columns, count)


def _potentials(order: int, kolosov: float) -> np.ndarray:
    """Coefficients A_k and B_k, shape (2, K + 3, 2 + 4 K), of a hole alone under each function of the basis."""
    each = 2 + 4 * order
    s = np.zeros((2 * order + 1, each), dtype=complex)  # s_rr - i s_rtheta = sum of s_n exp(i n theta), n = -K to K
    r, along = -1.0, 1j  # the plate's traction f is -(s_rr, s_rtheta)
    s[order, 0], s[order, 1] = r / math.sqrt(2.0), along / math.sqrt(2.0)
    for n in range(1, order + 1):
        first = 4 * n - 2
        for place, unit in enumerate((r, r, along, along)):
            cos = place % 2 == 0
            s[order + n, first + place] = unit * (0.5 if cos else -0.5j)
            s[order - n, first + place] = unit * (0.5 if cos else 0.5j)
    A, B = np.zeros((2, order + 3, each), dtype=complex)
    A[1] = np.conj(s[order + 1]) / (1.0 + kolosov)
    A[2 : order + 1] = np.conj(s[order + 2 :])
    B[1] = -kolosov * np.conj(A[1])
    B[2] = -s[order]
    for n in range(1, order + 1):
        B[n + 2] = (1.0 + n) * A[n] - s[order - n]
    return np.array([A, B])


def _fields(potentials: np.ndarray, w: np.ndarray, radial: np.ndarray, kolosov: float) -> tuple[np.ndarray, np.ndarray]:
    """Traction on the plate and displacement G v/R, in r and theta as a complex number, shape (points, 2 + 4 K).

    `w` (points,) are the places seen from the hole of the potentials, `radial` their normals.
    """
    A, B = potentials
    k = np.arange(len(A))
    powers = w[:, None] ** -k.astype(float)
    phi, slope, psi = powers @ A, (powers * -k) @ A / w[:, None], powers @ B
    spread = phi + np.conj(phi) - radial[:, None] ** 2 * (np.conj(w)[:, None] * slope + psi)
    rest = np.where(k > 1, 1.0 / np.where(k == 1, 1, 1 - k), 0.0)
    integral = (powers * w[:, None] * rest) @ np.array([A, B])
    log = np.log(np.abs(w))[:, None]
    moved = kolosov * (integral[0] + A[1] * log) - w[:, None] * np.conj(phi) - np.conj(integral[1] + B[1] * log)
    return -np.conj(spread), 0.5 * moved * np.conj(radial)[:, None]

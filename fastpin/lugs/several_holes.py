"""The compliance of a plate with several pinned holes of one radius, between the Fourier coefficients of their edges.

The blocks of the matrix are those of :mod:`fastpin.bodies.compliance`, one row of blocks and one column for each hole:
G v_j/R = hole f_j + sum over i of matrix_ji f_i. The first harmonics hold the forces of the pins and the translations
of the holes. In an infinite plate the translation of a hole counts from the place of an unloaded plate, up to the
logarithm ln(r/R) of each force.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fastpin.bodies.compliance import LEAST_ORDER
from fastpin.lugs.outline import Lug
from fastpin.lugs.panels import Boundary, Edges
from fastpin.lugs.plates import (
    FINE,
    PlateEquations,
    balanced,
    boundaries,
    edge_basis,
    harmonic_matrix,
    hole_compliance,
    load_tractions,
)
from fastpin.model.loads import LOADS, SXX, SXY, SYY

FURTHER = 12
"""Harmonics of the series beyond those that are kept."""


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

    The field has the series of each hole alone, as in :func:`holes_in_infinite_plate`, and a rest that is regular in
    these holes. Integral equations on all other edges give the rest. Betti's theorem gives what the holes feel of it.

    ``progress(done)`` is called from time to time, with the part that is done.
    """
    places = {hole.name: hole.centre / lug.hole_radius for hole in lug.holes}
    centres, highest = np.array([0j, *(places[name] for name in pinned)]), order + FURTHER
    edges = Edges(_edges_beside(lug, pinned), FINE)
    equations = PlateEquations(lug, edges, progress)
    modes, kolosov = equations.modes, equations.kolosov
    potentials = _potentials(highest, kolosov)
    alone = [_fields(potentials, edges.z - centre, edges.normals, kolosov) for centre in centres]
    on_edges, displaced = (np.hstack(fields) for fields in zip(*alone, strict=True))
    felt_there = np.flatnonzero(np.abs(on_edges).max(axis=0) > 1e-15)  # of unit tractions: less is rounding
    along = edges.normals[:, None]
    pulled, moved = -on_edges[:, felt_there] * along, 2.0 * displaced[:, felt_there] * along  # t and 2G u/R
    acting, loads = load_tractions(lug, edges)
    given, back, resultants = np.hstack([-pulled, acting]), np.hstack([-moved, np.zeros_like(acting)]), None
    if modes is not None:
        given, resultants = balanced(given, modes)
    u, t = (x + 1j * y for x, y in equations.solve(given, back))
    if modes is not None:  # the mean of the whole motion of the outline vanishes
        u += modes.mean_motion(back)
    (tractions, displacements), count = _series(centres, highest, kolosov), on_edges.shape[1]
    felt = np.zeros((count, count + len(loads)))
    felt[np.ix_(felt_there, np.r_[felt_there, count : felt.shape[1]])] = (
        0.5 / math.pi * (_work(edges, moved, t) - _work(edges, pulled, u))
    )
    # The product with the series of a function of the basis is a coefficient of v - hole f, with v = G u/R, tractions f
    # and "hole" of (T41). Inside the hole f_n = -2 (n + 1)/k v_n, f_-n = -2 (n - 1) v_-n and f_0 = -4/(k - 1) v_0.
    n, whole, by_hole = np.arange(1, highest + 1), kolosov + 1.0, felt.reshape(centres.size, -1, felt.shape[1])
    backward = np.where(n > 1, 1.0 / whole, 1.0)
    maps = (
        harmonic_matrix((-4.0 / whole, 0.0), -2.0 * (n + 1) / whole, -2.0 * (n - 1) / whole),
        harmonic_matrix(((kolosov - 1.0) / whole, 1.0), np.full(highest, kolosov / whole), backward),
    )
    rest = [(each @ by_hole).reshape(felt.shape) for each in maps]
    compliance = np.linalg.solve((tractions + rest[0][:, :count]).T, (displacements + rest[1][:, :count]).T).T
    by_loads = rest[1][:, count:] - compliance @ rest[0][:, count:]
    kept = np.flatnonzero(np.arange(count) % (2 + 4 * highest) < 2 + 4 * order)
    carried = () if resultants is None else resultants[:, felt_there.size :].T
    matrix = _beyond_holes(compliance[np.ix_(kept, kept)], order, lug.kolosov)
    columns = dict(zip(loads, by_loads[kept].T, strict=True))
    return HolesCompliance(matrix, columns, centres.size, dict(zip(loads, carried, strict=False)))


def holes_in_infinite_plate(kolosov: float, centres: np.ndarray, order: int) -> HolesCompliance:
    """The compliance of an infinite plate with holes of radius 1 round `centres` (H,), complex.

    Each hole alone has Kolosov's potentials phi' = sum A_k w^-k and psi' = sum B_k w^-k, w = z - centre. Their
    tractions and displacements on all edges are projected on the harmonics: S and D. The compliance is D S^-1.
    """
    tractions, moved = _series(centres, order, kolosov)
    compliance = np.linalg.solve(tractions.T, moved.T).T
    radial, basis = _rim(order)
    columns = {}
    for place, (mean, deviator) in {SXX: (0.25, -0.5), SYY: (0.25, 0.5), SXY: (0.0, 1j)}.items():
        z = radial + centres[:, None]
        spread = 2.0 * mean - radial**2 * deviator  # s_rr - i s_rtheta of the uniform stress
        turned = 0.5 * (kolosov * mean * z - mean * z - np.conj(deviator * z)) * np.conj(radial)
        remote = np.tile((basis @ -np.conj(spread)).real, centres.size)
        columns[LOADS[place]] = (turned @ basis.T).real.ravel() - compliance @ remote
    return HolesCompliance(_beyond_holes(compliance, order, kolosov), columns, centres.size)


def _rim(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Points on the edge of a hole, and the map of r + i theta components there to coefficients (2 + 4 K)."""
    points = 4 * order + 16
    radial = np.exp(2j * math.pi / points * np.arange(points))
    return radial, 2.0 / points * np.conj(edge_basis(radial, order)).T * radial


def _series(centres: np.ndarray, order: int, kolosov: float) -> tuple[np.ndarray, np.ndarray]:
    """Tractions and displacements of all holes (H m) by the series of each hole alone (H m)."""
    (radial, basis), potentials = _rim(order), _potentials(order, kolosov)
    each = 2 + 4 * order
    found = np.empty((2, centres.size, each, centres.size, each))
    for i, own in enumerate(centres):
        for j, other in enumerate(centres):
            fields = _fields(potentials, radial + (other - own), radial, kolosov)
            found[:, j, :, i] = [(basis @ field).real for field in fields]
    tractions, moved = found.reshape(2, centres.size * each, -1)
    return tractions, moved


def _beyond_holes(compliance: np.ndarray, order: int, kolosov: float) -> np.ndarray:
    """A compliance, made symmetric, without that of each hole in an infinite plate of its own."""
    own = hole_compliance(order, kolosov)
    return np.asarray(0.5 * (compliance + compliance.T) - np.kron(np.eye(len(compliance) // len(own)), own))


def _edges_beside(lug: Lug, pinned: Sequence[str]) -> list[Boundary]:
    """All edges without a pin, in hole radii. Their panels are no longer than the distance of a hole with a pin."""
    own, *loops = boundaries(lug, LEAST_ORDER)
    with_pin = [own, *(loop for loop in loops if loop.parts[0].name in pinned)]
    beside = tuple((part, 1.0) for loop in with_pin for part in loop.parts)
    others = [replace(loop, beside=beside) for loop in loops if loop.parts[0].name not in pinned]
    return [Boundary((), (), ()), *others]  # the first one stands for the pin's hole


def _work(edges: Edges, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Integrals along the edges of the products of two sets of vectors, (nodes, m) and (nodes, c), shape (m, c)."""
    weighted = edges.weights[:, None] * other
    return np.asarray(one.real.T @ weighted.real + one.imag.T @ weighted.imag)


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

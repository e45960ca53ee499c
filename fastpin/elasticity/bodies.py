"""The terms by which pin and plate differ from a solid pin in an infinite plate, in dimensionless form.

Both surfaces lie on the circle R, and the singular kernels belong to their materials. The rest is smooth. For bodies
that are symmetric about the axis it is a Fourier series of the distance of two angles, (T38); for any other plate a
small matrix between Fourier coefficients (T41). The loads have other columns, (T39), (T40).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from fastpin.kernels import fourier, harmonics
from fastpin.kernels.harmonics import FEWEST
from fastpin.model.bodies import Plate, Ring, Tube
from fastpin.model.compliance import Compliance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, REMOTE, SXX, SXY, SYY, P, Q
from fastpin.model.problem import Problem

UNIT_FORCE = {Q: 1.0 + 0.0j, P: -1.0j}
"""Complex force Q - iP on the pin, per unit load."""

UNIT_STRESS = {SXX: (1.0, 1.0 + 0.0j), SYY: (1.0, -1.0 + 0.0j), SXY: (0.0, 2.0j)}
"""Sum sxx + syy and complex difference sxx - syy + 2i sxy of the remote stresses, per unit load."""

Displacements = dict[int, np.ndarray]
"""Fourier coefficients of v_r + i v_theta of a rim over its radius, for n = -N to N, by load."""


@dataclass(frozen=True, eq=False)
class BodyTerms:
    """The smooth terms of pin and plate. Gap and slip are in units of F beta*, tractions in F/R.

    Attributes
    ----------
    coefficients : ndarray, shape (3, N + 1)
        The kernels first, second and cross of (T38), divided by 4 pi: gap += int [first cos N + cross sin T],
        slip += int [-cross sin N + second cos T].
    matrix : ndarray, shape (m, m)
        Matrix between the coefficients of (N, T) and of (gap, slip), for a compliance; else (0, 0). The basis is that
        of :mod:`fastpin.model.compliance`.
    force_factor : float
        Factor of the columns (sin, cos) of P and (-cos, sin) of Q: the first harmonic that a force causes.
    columns : dict of int to ndarray of complex, shape (2 K + 1,)
        Fourier coefficients of v_r + i v_theta per unit of a load, n = -K to K, by the place of the load: of P and Q
        beyond ``force_factor``, and of the remote stresses.
    """

    coefficients: np.ndarray
    matrix: np.ndarray
    force_factor: float
    columns: Displacements = field(default_factory=dict)

    def add_matrix(self, grid: Grid, operator: np.ndarray) -> None:
        """Add the matrix of a compliance to the `operator`, shape (2n, 2n). Without one nothing changes."""
        if self.matrix.size:
            waves, displaced = self.factors(grid)
            operator += waves @ displaced

    def factors(self, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
        """Factors (2n, m) and (m, 2n) of the matrix that a compliance adds to the operator."""
        waves, integrals = basis(self.matrix, grid)
        return waves, self.matrix @ integrals

    def matrix_product(self, grid: Grid, tractions: np.ndarray) -> np.ndarray:
        """Gap and slip, shape (2n,), that the matrix of a compliance gives for tractions (N, T), shape (2n,)."""
        waves, integrals = basis(self.matrix, grid)
        found: np.ndarray = waves @ (self.matrix @ (integrals @ tractions))
        return found

    def radial(self, load: np.ndarray, theta: np.ndarray | float) -> np.ndarray:
        """v_r under the remote stresses of a `load` (loads,), and two derivatives, at `theta`; shape (3, ...)."""
        angles = np.asarray(theta)
        found = np.zeros((3, *angles.shape))
        for place in REMOTE:
            column = self.columns.get(place)
            if column is None or load[place] == 0.0:
                continue
            order = np.arange(column.size) - column.size // 2
            waves = load[place] * column * np.exp(1j * np.multiply.outer(angles, order))
            found += np.array([np.real((waves * (1j * order) ** k).sum(axis=-1)) for k in range(3)])
        return found

    def load_columns(self, theta: np.ndarray) -> dict[int, np.ndarray]:
        """Gap and slip, shape (2n,), per unit of each load with a column, at the angles `theta` (n,)."""
        if not self.columns:
            return {}
        highest = max(column.size // 2 for column in self.columns.values())
        padded = np.array([np.pad(column, highest - column.size // 2) for column in self.columns.values()])
        moved = fourier.waves(theta, -highest, 2 * highest + 1) @ padded.T
        return {place: np.r_[v.real, -v.imag] for place, v in zip(self.columns, moved.T, strict=True)}


def basis(matrix: np.ndarray, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """The basis of a compliance's `matrix` (m, m) at the nodes, (2n, m), and the coefficients of hats in it, (m, 2n).

    Rows and columns of the nodes belong to (gap, slip) and (N, T).
    """
    n = np.arange((len(matrix) - 2) // 4 + 1.0)
    left, right = grid.knots()
    waves = np.exp(-1j * np.multiply.outer(grid.theta, n))
    hats = fourier.hat_moments(n, grid.theta - left, right - grid.theta) * waves / math.pi
    return _in_basis(waves), _in_basis(hats).T


def _in_basis(waves: np.ndarray) -> np.ndarray:
    """Columns of the basis (2n, 2 + 4K) for gap and slip from exp(-i n theta), shape (n, K + 1).

    The theta component of the basis is turned: the traction on the plate is (N, -T), and the slip counts -v_theta.
    """
    n, order = waves.shape[0], waves.shape[1] - 1
    found = np.zeros((2 * n, 2 + 4 * order))
    found[:n, 0] = waves[:, 0].real / math.sqrt(2.0)
    found[n:, 1] = -waves[:, 0].real / math.sqrt(2.0)
    found[:n, 2::4], found[:n, 3::4] = waves[:, 1:].real, -waves[:, 1:].imag
    found[n:, 4::4], found[n:, 5::4] = -waves[:, 1:].real, waves[:, 1:].imag
    return found


@lru_cache(maxsize=16)
def body_terms(problem: Problem) -> BodyTerms | None:
    """The terms of the bodies of a problem; None for a solid pin in an infinite plate."""
    if not problem.has_bodies:
        return None
    joint, surfaces, beta = problem.joint, problem.surfaces, problem.surfaces.beta_star
    order = np.arange(2.0, _highest(problem) + 1.0)
    change = _pin_change(problem, order) - _plate_change(problem, order)  # a, b, d of g, in 1/Pa
    coefficients = np.zeros((3, order.size + 2))
    a, b, d = change
    coefficients[:, 2:] = a + d + 2.0 * b, a + d - 2.0 * b, a - d
    pin, plate = surfaces.pin_compliance, surfaces.plate_compliance
    of_pin, of_plate = pin * joint.pin_first.displacement(), plate * _plate_first(problem)
    coefficients[:, 1] = of_pin[0] - 0.5 * pin * surfaces.pin_kolosov - (of_plate[0] + 0.5 * plate)
    coefficients[0, 0] = 2.0 * joint.uniform_compliance - (plate + 0.5 * pin * (surfaces.pin_kolosov - 1.0))
    coefficients[1, 0] = -2.0 * _twist(problem) - plate
    columns, matrix = _columns(problem), np.zeros((0, 0))
    if isinstance(problem.plate_body, Compliance):
        coefficients[0, 0] -= 2.0 * plate * float(problem.plate_body.matrix[0, 0])  # it is in the matrix
        matrix, columns = _compliance_terms(problem.plate_body)
    scale = 1.0 / (4.0 * math.pi * beta)
    unit = plate / beta if isinstance(problem.plate_body, Compliance) else 1.0 / beta
    return BodyTerms(
        scale * coefficients, plate / beta * matrix, -scale * float(of_pin[1] - of_plate[1]),
        {place: unit * column for place, column in columns.items()},
    )  # fmt: skip


def _highest(problem: Problem) -> int:
    """The highest harmonic that matters in the bodies that are symmetric about the axis."""
    joint = problem.joint
    ratios = [joint.bore] + ([1.0 / joint.bush] if joint.bush else [])
    if isinstance(joint.lug, Ring):
        ratios.append(1.0 / (joint.lug_rim * (joint.bush or 1.0)))
    return max((harmonics.harmonics_needed(ratio) for ratio in ratios), default=FEWEST)


def _pin_change(problem: Problem, order: np.ndarray) -> np.ndarray:
    """a, b, d of the pin less those of a disk, in 1/G, shape (3, m)."""
    joint = problem.joint
    if not isinstance(problem.pin_body, Tube):
        return np.zeros((3, order.size))
    return joint.pair.pin_compliance * harmonics.tube(order, joint.bore, joint.pair.pin_kolosov, joint.bore_kind)


def _plate_change(problem: Problem, order: np.ndarray) -> np.ndarray:
    """a, b, d of the plate less those of an infinite plate of the surface's material, in 1/G, shape (3, m)."""
    joint = problem.joint
    if isinstance(problem.plate_body, Ring):
        change = harmonics.ring(order, joint.lug_rim, joint.pair.plate_kolosov, joint.lug_kind)
        return joint.pair.plate_compliance * change
    layer = bush_layer(problem, order)
    if layer is None:
        return np.zeros((3, order.size))
    moved = 2.0 * layer.contact_displacement(layer.amplitudes(lug_compliance(problem, order)))
    return np.array([moved[:, 0, 0], 0.5 * (moved[:, 0, 1] + moved[:, 1, 0]), moved[:, 1, 1]])


def bush_layer(problem: Problem, order: np.ndarray) -> harmonics.Layer | None:
    """The bush, for the harmonics `order` >= 2; None without a bush."""
    surfaces, outer = problem.surfaces, problem.joint.bush
    if outer is None:
        return None
    return harmonics.Layer(order, outer, surfaces.plate_kolosov, surfaces.plate_compliance)


def lug_compliance(problem: Problem, order: np.ndarray) -> np.ndarray:
    """Whole compliances of the lug's own hole, shape (m, 2, 2), 1/Pa, for the harmonics `order` >= 2."""
    joint = problem.joint
    kolosov, compliance = joint.pair.plate_kolosov, joint.pair.plate_compliance
    whole = harmonics.hole(order, kolosov, compliance)
    if math.isfinite(joint.lug_rim):
        change = harmonics.ring(order, joint.lug_rim, kolosov, joint.lug_kind)
        whole += 0.5 * compliance * harmonics.as_matrices(change)
    return whole


def _plate_first(problem: Problem) -> np.ndarray:
    """c11 and c12 of the plate on the contact rim, in units of 1/2G of its surface."""
    joint = problem.joint
    return (joint.lug_first if joint.bush is None else joint.bush_first).displacement()


def _twist(problem: Problem) -> float:
    """Rotation of the contact rim per shear stress, 1/Pa: u_theta/r over s_rtheta, against the lug's far rim."""
    joint = problem.joint
    pair, surfaces = joint.pair, problem.surfaces
    far = -0.5 * pair.plate_compliance * (1.0 - joint.lug_rim**-2.0)
    if joint.bush is None:
        return far
    part = joint.bush**-2.0
    return -0.5 * surfaces.plate_compliance * (1.0 - part) + part * far


# -- columns of the loads -------------------------------------------------------------------------------------


def _columns(problem: Problem) -> Displacements:
    """Displacements v/R of the contact rim per unit load, 1/Pa, beyond those of (T16) and of ``force_factor``."""
    joint = problem.joint
    rim = joint.bush or 1.0
    columns = lug_columns(problem, rim)
    if joint.bush is None:
        return columns
    return {place: _through_bush(problem, column) for place, column in columns.items()}


@lru_cache(maxsize=16)
def lug_columns(problem: Problem, rim: float) -> Displacements:
    """Displacements over the radius of the lug's own hole, `rim` R, per unit load."""
    joint, lug = problem.joint, problem.joint.lug
    kolosov, compliance = joint.pair.plate_kolosov, joint.pair.plate_compliance
    if isinstance(lug, Ring):
        found: Displacements = {}
        if not lug.held:
            found = {place: _rim_stress(problem, *UNIT_STRESS[place]) for place in REMOTE}
        if lug.support == "half":
            for place, middle in ((P, -0.5 * math.pi), (Q, 0.0)):
                found[place] = _half_support(problem, middle) / rim
        return found
    found = _infinite_plate(kolosov, compliance)
    if isinstance(lug, Plate) and lug.reaction is not None:
        x, y = (value / (problem.hole_radius * rim) for value in lug.reaction)
        for place, force in UNIT_FORCE.items():
            found[place] = _point_force(complex(x, y), -force / rim, kolosov, compliance)
    return found


def _infinite_plate(kolosov: float, compliance: float) -> Displacements:
    """Displacements of the hole in the infinite plate per remote stress (T16)."""
    size = 0.25 * (kolosov + 1.0) * compliance
    return {
        place: size * np.array([difference, 0.0, 0.5 * total, 0.0, 0.0])
        for place, (total, difference) in UNIT_STRESS.items()
    }


def _rim_stress(problem: Problem, total: float, difference: complex) -> np.ndarray:
    """Displacements of a ring's hole when its outer rim carries the tractions of a remote stress."""
    traction = np.zeros((1, 2), dtype=complex)
    traction[0, 1] = 0.5 * np.conj(difference)
    return _ring_displacement(problem, 0.5 * total, np.array([2.0]), traction)


def _half_support(problem: Problem, middle: float) -> np.ndarray:
    """Displacements of a ring's hole under a half cosine of pressure about the angle `middle`, beyond n = 1.

    Its resultant is 1 in units of stress times R.
    """
    rim = problem.joint.lug_rim
    m = np.arange(1, harmonics.harmonics_needed(1.0 / rim) // 2 + 1)
    mean, traction = harmonics.half_cosine(1.0, middle, rim, m)
    return _ring_displacement(problem, mean, 2.0 * m, np.stack([traction, traction], axis=1))


def _ring_displacement(problem: Problem, mean: float, order: np.ndarray, traction: np.ndarray) -> np.ndarray:
    """Displacements of a ring's free hole under tractions on its outer rim: mean s_rr, and (t_n, conj t_-n), (m, 2)."""
    joint = problem.joint
    kolosov, compliance = joint.pair.plate_kolosov, joint.pair.plate_compliance
    layer = harmonics.Layer(order, joint.lug_rim, kolosov, compliance)
    moved = layer.contact_displacement(layer.loaded_outside(traction))
    uniform = 0.25 * (kolosov + 1.0) * compliance * mean / (1.0 - joint.lug_rim**-2.0)
    return _spectrum(order, moved, uniform)


def _spectrum(order: np.ndarray, moved: np.ndarray, uniform: complex, first: complex = 0.0) -> np.ndarray:
    """Coefficients for n = -K to K from pairs (u_n, conj u_-n), shape (m, 2), of the harmonics `order` (m,)."""
    highest = int(order[-1])
    found = np.zeros(2 * highest + 1, dtype=complex)
    places = order.astype(int)
    found[highest + places], found[highest - places] = moved[:, 0], np.conj(moved[:, 1])
    found[highest], found[highest + 1] = uniform, first
    return found


def pairs_of(column: np.ndarray) -> np.ndarray:
    """Pairs (u_n, conj u_-n), shape (K - 1, 2), of the harmonics from 2 on, from coefficients for n = -K to K."""
    middle = column.size // 2
    return np.stack([column[middle + 2 :], np.conj(column[middle - 2 :: -1])], axis=1)


def _point_force(place: complex, force: complex, kolosov: float, compliance: float) -> np.ndarray:
    """Displacements of the free hole, radius 1, in the infinite plate under a force at the point `place`, (T40)."""
    highest = harmonics.harmonics_needed(math.sqrt(1.0 / abs(place)))
    count = 4 * highest + 2
    z = np.exp(2j * math.pi * np.arange(count) / count)
    e, conj_place = 0.5 / (math.pi * (kolosov + 1.0)), np.conj(place)
    s = 1.0 / z
    slope = -np.conj(force) * e / (s - conj_place)
    rest = kolosov * force * e * np.log(1.0 - s / conj_place) + np.conj(force) * e * place / (s - conj_place)
    moved = -force * e * np.log(1.0 - z / place) - z * slope - rest + np.conj(force) * e / conj_place * z
    spectrum = np.fft.fft(0.5 * compliance * (kolosov + 1.0) * moved / z) / count
    found = np.r_[spectrum[-highest:], spectrum[: highest + 1]]
    found[highest - 1] = 0.0  # a translation
    return found


def _through_bush(problem: Problem, column: np.ndarray) -> np.ndarray:
    """Displacements of the contact rim when the lug's own free hole is displaced by `column`, n = -K to K."""
    joint = problem.joint
    highest = column.size // 2
    kolosov, outer = problem.surfaces.plate_kolosov, joint.bush
    unit = problem.surfaces.plate_compliance
    assert outer is not None
    q, inner = outer**-2.0, 2.0 * joint.lug_uniform / unit
    half = 0.5 * (kolosov - 1.0)
    uniform = 0.5 * (kolosov + 1.0) * column[highest].real / (half + q - inner * (1.0 - q))
    first = joint.pair.plate_compliance / unit * joint.lug_first.displacement()[0]
    moved_first = (kolosov + 1.0) * column[highest + 1] / harmonics.first_stiffness(outer, kolosov, first)
    order = np.arange(2.0, highest + 1.0)
    layer = bush_layer(problem, order)
    assert layer is not None
    growing = layer.moved_outside(lug_compliance(problem, order), pairs_of(column))
    rotation = 1j * column[highest].imag
    return _spectrum(order, layer.contact_displacement(growing), uniform + rotation, moved_first)


# -- any other plate ------------------------------------------------------------------------------------------


def translation_rows(body: Compliance) -> np.ndarray:
    """Unit vectors, shape (2, m), of the force along x and y in the basis of a compliance.

    They are also a translation of the hole along x and y by the square root of 1/2.
    """
    rows = np.zeros((2, len(body.matrix)))
    rows[0, [2, 5]] = math.sqrt(0.5) * np.array([1.0, -1.0])
    rows[1, [3, 4]] = math.sqrt(0.5)
    return rows


def _compliance_terms(body: Compliance) -> tuple[np.ndarray, Displacements]:
    """The matrix without resultant and translation, and the columns of the loads, in units of 1/G."""
    rows = translation_rows(body)
    keep = np.eye(len(body.matrix)) - rows.T @ rows
    columns: Mapping[int, np.ndarray] = {
        Q: body.matrix @ rows[0] / (math.pi * math.sqrt(2.0)),
        P: -body.matrix @ rows[1] / (math.pi * math.sqrt(2.0)),
        **{LOADS.index(name): column for name, column in body.columns.items()},
    }
    return keep @ body.matrix @ keep, {place: complex_coefficients(keep @ column) for place, column in columns.items()}


def complex_coefficients(column: np.ndarray) -> np.ndarray:
    """Fourier coefficients of v_r + i v_theta, n = -K to K, from coefficients in the real basis (2 + 4K, ...)."""
    order = (len(column) - 2) // 4
    found = np.zeros((2 * order + 1, *column.shape[1:]), dtype=complex)
    found[order] = (column[0] + 1j * column[1]) / math.sqrt(2.0)
    cos, sin = column[2::4] + 1j * column[4::4], column[3::4] + 1j * column[5::4]
    found[order + 1 :], found[order - 1 :: -1] = 0.5 * (cos - 1j * sin), 0.5 * (cos + 1j * sin)
    return found


def plate_coefficients(pressure: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Coefficients of the traction (N, -T) on the plate in the basis of a compliance, shape (2 + 4K, ...).

    `pressure` and `shear`, shape (K + 1, ...), are int g exp(-i n xi) dxi/pi of N and T, n = 0 to K.
    """
    found = np.empty((4 * len(pressure) - 2, *pressure.shape[1:]))
    found[0], found[1] = pressure[0].real / math.sqrt(2.0), -shear[0].real / math.sqrt(2.0)
    found[2::4], found[3::4] = pressure[1:].real, -pressure[1:].imag
    found[4::4], found[5::4] = -shear[1:].real, shear[1:].imag
    return found

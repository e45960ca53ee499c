"""The terms by which pin and plate differ from a solid pin in an infinite plate, in dimensionless form.

Both surfaces lie on the circle R, and the singular kernels belong to their materials. The rest is smooth. For bodies
that are symmetric about the axis it is a Fourier series of the distance of two angles, (T38); for any other plate a
small matrix between Fourier coefficients (T41). The loads have other columns, (T39), (T40).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from fastpin.bodies.compliance import basis
from fastpin.bodies.walls import Displacements
from fastpin.kernels import fourier
from fastpin.model.grid import Grid
from fastpin.model.loads import PIN_TEMPERATURE, REMOTE, TEMPERATURE, THERMAL
from fastpin.model.problem import Problem


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
        of :mod:`fastpin.bodies.compliance`.
    force_factor : float
        Factor of the columns (sin, cos) of P and (-cos, sin) of Q: the first harmonic that a force causes.
    columns : dict of int to ndarray of complex, shape (2 K + 1,)
        Fourier coefficients of v_r + i v_theta per unit of a load, n = -K to K, by the place of the load: of P and Q
        beyond ``force_factor``, and of the remote stresses.
    anisotropy : complex or None
        The factor of :class:`fastpin.elasticity.operator.AnisotropicTerm`; None in a plate that is no laminate.
    """

    coefficients: np.ndarray
    matrix: np.ndarray
    force_factor: float
    columns: Displacements = field(default_factory=dict)
    anisotropy: complex | None = None

    def factors(self, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
        """Factors (2n, m) and (m, 2n) of the matrix that a compliance adds to the operator."""
        waves, integrals = basis(self.matrix, grid)
        return waves, self.matrix @ integrals

    def matrix_product(self, grid: Grid, tractions: np.ndarray) -> np.ndarray:
        """Gap and slip, shape (2n,), that the matrix of a compliance gives for tractions (N, T), shape (2n,)."""
        waves, integrals = basis(self.matrix, grid)
        found: np.ndarray = waves @ (self.matrix @ (integrals @ tractions))
        return found

    def ellipse(self, load: np.ndarray) -> tuple[float, float, float]:
        """Mean, cosine and sine of 2 theta of v_r under the remote stresses of a `load` (loads,), in a laminate."""
        mean, oval = (sum(load[place] * self.columns[place][order] for place in REMOTE) for order in (2, 0))
        return float(mean.real), float(oval.real), float(oval.imag)

    def radial(self, load: np.ndarray, theta: np.ndarray | float) -> np.ndarray:
        """v_r under remote stresses and temperatures of a `load`, and two derivatives, at `theta`; (3, ...)."""
        angles = np.asarray(theta)
        found = np.zeros((3, *angles.shape))
        for place in (*REMOTE, *THERMAL):
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


def thermal_columns(problem: Problem) -> dict[int, np.ndarray]:
    """Displacement of the hole over the pin by each temperature; none where an expansion is not known.

    Pins expand freely, and most plates. There the gap grows all round by R times the difference of the strains.
    """
    pin, hole = problem.expansions
    if pin is None:
        return {}
    found = {PIN_TEMPERATURE: np.array([-pin + 0j])}
    if hole is not None:
        moved = problem.joint.plate_body.expanded(problem.joint.hole)
        moved[moved.size // 2] -= pin
        found[TEMPERATURE] = moved
    return found


@lru_cache(maxsize=16)
def body_terms(problem: Problem) -> BodyTerms | None:
    """The terms of the bodies of a problem; None for a solid pin in an infinite, isotropic plate."""
    if problem.pair.plate.is_isotropic and not problem.has_bodies:
        return None
    joint, surfaces, beta = problem.joint, problem.surfaces, problem.surfaces.beta_star
    (pin_rim, hole), pin_body, plate_body = (joint.pin_rim, joint.hole), joint.pin_body, joint.plate_body
    order = np.arange(2.0, max(pin_body.highest(pin_rim), plate_body.highest(hole)) + 1.0)
    a, b, d = pin_body.change(pin_rim, order) - plate_body.change(hole, order)  # of g, in 1/Pa
    coefficients = np.zeros((3, order.size + 2))
    coefficients[:, 2:] = a + d + 2.0 * b, a + d - 2.0 * b, a - d
    pin, plate = surfaces.pin_compliance, surfaces.plate_compliance
    of_pin, of_plate = pin * joint.pin_first.displacement(), plate * joint.plate_first.displacement()
    coefficients[:, 1] = of_pin[0] - 0.5 * pin * surfaces.pin_kolosov - (of_plate[0] + 0.5 * plate)
    coefficients[0, 0] = 2.0 * joint.uniform_compliance - (plate + 0.5 * pin * (surfaces.pin_kolosov - 1.0))
    coefficients[0, 0] -= plate_body.pressed_by_matrix(hole)
    coefficients[1, 0] = -2.0 * plate_body.twist(hole) - plate
    if not problem.has_bodies:  # the rest is rounding
        coefficients[:] = 0.0
    scale = 1.0 / (4.0 * math.pi * beta)
    columns = {**plate_body.load_columns(hole, beta), **thermal_columns(problem)}
    matrix = plate_body.matrix_in(hole, beta)
    laminate = hole.laminate
    factor = None if laminate is None else -2.0 * laminate.delta / beta
    return BodyTerms(scale * coefficients, matrix, -scale * float(of_pin[1] - of_plate[1]), columns, factor)

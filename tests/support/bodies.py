"""Joints with hollow pins, ring lugs, bushes and compliances, and the compliance of a ring from its harmonics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.elasticity.bodies import body_terms
from fastpin.kernels import harmonics
from fastpin.model.bodies import Bushing, Plate, Ring, Tube
from fastpin.model.compliance import Compliance
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
STEEL, BRONZE, ALUMINIUM = Material(210e9, 0.3), Material(110e9, 0.34), Material(69e9, 0.33)
STEEL_ALUMINIUM = MaterialPair(STEEL, ALUMINIUM)

JOINTS = {
    "tube": (LIKE, {"pin_body": Tube(0.5)}),
    "held tube": (UNLIKE, {"pin_body": Tube(0.7, "held")}),
    "tube, body load": (LIKE, {"pin_body": Tube(0.6, "body")}),
    "held ring": (UNLIKE, {"plate_body": Ring(2.0)}),
    "tube in a ring": (LIKE, {"pin_body": Tube(0.8), "plate_body": Ring(1.5, "uniform")}),
    "half ring": (UNLIKE, {"plate_body": Ring(2.0, "half")}),
    "reaction": (UNLIKE, {"plate_body": Plate((0.7, 2.5))}),
    "bush": (STEEL_ALUMINIUM, {"plate_body": Bushing(BRONZE, 1.25)}),
    "tube, bush, ring": (
        UNLIKE, {"pin_body": Tube(0.5, "shear"), "plate_body": Bushing(BRONZE, 1.3, inside=Ring(2.0, "normal"))}
    ),
}  # fmt: skip
"""Materials and bodies of some joints, in units of the hole radius, by name."""


def joint_problem(name: str, load_parameter: float, friction: float, **options: object) -> Problem:
    """The dimensionless problem of one of the :data:`JOINTS`, or "ring, compliance": a ring by its compliance."""
    if name == "ring, compliance":
        ring = Problem.from_load_parameter(UNLIKE, load_parameter, friction, plate_body=Ring(2.0, "normal"), **options)
        return replace(ring, plate_body=ring_compliance(ring, 20))
    pair, bodies = JOINTS[name]
    return Problem.from_load_parameter(pair, load_parameter, friction, **bodies, **options)


def ring_compliance(problem: Problem, order: int) -> Compliance:
    """The compliance of the ring of a problem with a solid pin, with `order` harmonics, from the closed forms.

    The first harmonic holds no translation of the hole. A torque has no support: the rotation is that of the problem.
    """
    joint = problem.joint
    assert isinstance(problem.plate_body, Ring)
    kolosov, rim, kind = problem.pair.plate_kolosov, joint.lug_rim, joint.lug_kind
    matrix = np.zeros((2 + 4 * order, 2 + 4 * order))
    # Traction (N, -T) on the plate: s_rr = -f_r and s_rtheta = -f_theta. G v/R = c/2 times the traction.
    matrix[0, 0] = -0.5 * (harmonics.uniform(rim, kolosov, kind) + 1.0)
    matrix[1, 1] = -0.5 * rim**-2.0
    n = np.arange(2.0, order + 1.0)
    first, cross = joint.lug_first.displacement()
    of_n = [np.array([[first + 0.5, cross], [cross, 0.0]])]
    of_n += list(harmonics.as_matrices(harmonics.ring(n, rim, kolosov, kind)))
    for k, c in enumerate(of_n, 1):
        radial, shear, mixed = 0.5 * (c[0, 0] + c[1, 1]), 0.5 * (c[0, 0] + c[1, 1]), 0.5 * (c[0, 0] - c[1, 1])
        radial, shear = radial + c[0, 1], shear - c[0, 1]
        place = 2 + 4 * (k - 1)
        # s_rr = cos, s_rtheta = sin (and s_rr = sin, s_rtheta = -cos): C_rr, C_tt, C_rt of the harmonic
        block = np.zeros((4, 4))
        block[[0, 1], [0, 1]], block[[2, 3], [2, 3]] = radial, shear
        block[0, 3] = block[3, 0] = mixed
        block[1, 2] = block[2, 1] = -mixed
        matrix[place : place + 4, place : place + 4] = -0.5 * block
    return Compliance(problem.pair.plate.nu, problem.pair.plane, problem.hole_radius, matrix, _stresses(problem, order))


def _stresses(problem: Problem, order: int) -> dict[str, np.ndarray]:
    """Columns of the remote stresses on a ring's rim, from its terms."""
    terms = body_terms(problem)
    assert terms is not None
    unit = problem.pair.plate_compliance / problem.surfaces.beta_star
    found = {}
    for place in REMOTE:
        if place in terms.columns:
            found[LOADS[place]] = _real_basis(terms.columns[place] / unit, order)
    return found


def _real_basis(column: np.ndarray, order: int) -> np.ndarray:
    """Coefficients in the real basis, shape (2 + 4K,), from those of v_r + i v_theta for n = -m to m."""
    wide, middle = np.zeros(2 * order + 1, dtype=complex), column.size // 2
    reach = min(order, middle)
    wide[order - reach : order + reach + 1] = column[middle - reach : middle + reach + 1]
    found = np.zeros(2 + 4 * order)
    found[0], found[1] = np.sqrt(2.0) * wide[order].real, np.sqrt(2.0) * wide[order].imag
    above, below = wide[order + 1 :], wide[order - 1 :: -1]
    cos, sin = above + below, 1j * (above - below)
    found[2::4], found[4::4], found[3::4], found[5::4] = cos.real, cos.imag, sin.real, sin.imag
    return found

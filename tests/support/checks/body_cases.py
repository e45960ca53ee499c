"""Joints with hollow pins, ring lugs and bushes: reference values, closed forms, a ring by its compliance.

All problems are dimensionless (R = F = beta* = 1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from fastpin import Material, MaterialPair, Problem
from fastpin.bodies import Bushing, Compliance, Ring, Tube, harmonics
from fastpin.elasticity.terms import body_terms
from fastpin.model.loads import LOADS, REMOTE
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.joint_rows import BRONZE


@dataclass(frozen=True)
class BodyCase:
    """A joint and the reference values of its last state.

    Attributes
    ----------
    problem : Problem
    peak, total, half_angle : float
        Peak pressure, int N dtheta and half-angle of the contact, from 1,601 nodes: their last digit.
    elements : float or None
        Peak pressure of an independent finite-element model of both bodies, 720 to 1,440 nodes on the rim.
    history : tuple of dict
        The load history.
    """

    problem: Problem
    peak: float
    total: float
    half_angle: float
    elements: float | None = None
    history: tuple[dict[str, float], ...] = ({"P": 1.0},)


_THIN = partial(Problem.from_load_parameter, LIKE, pin_body=Tube(0.8), plate_body=Ring(1.5, "uniform"))
_HALF = partial(Problem.from_load_parameter, LIKE, pin_load="body", plate_body=Ring(2.0, "half"))
_HELD = partial(Problem.from_load_parameter, UNLIKE, pin_load="body", plate_body=Ring(2.0))
_TUBE = partial(Problem.from_load_parameter, LIKE, pin_body=Tube(0.5))

CASES = {
    "hollow pin": BodyCase(_TUBE(0.1, 0.0), 0.558417, 1.285346, 1.32091, 0.558428),
    "hollow pin, mu = 0.4": BodyCase(_TUBE(0.1, 0.4), 0.434548, 1.021761, 1.31365, 0.434553),
    "held ring": BodyCase(_HELD(0.05, 0.0), 0.676888, 1.190693, 1.21846, 0.676905),
    "held ring, mu = 0.3": BodyCase(_HELD(0.05, 0.3), 0.560914, 1.038295, 1.21576, 0.560925),
    "thin tube, ring": BodyCase(_THIN(0.1, 0.0), 0.566339, 1.571103, 1.7037, 0.566350),
    "thin tube, ring, mu = 0.4": BodyCase(_THIN(0.1, 0.4), 0.370067, 1.175293, 1.7349, 0.370089),
    "half rim": BodyCase(_HALF(0.1, 0.0), 0.646326, 1.196523, 1.18361, 0.646338),
    "half rim, mu = 0.3": BodyCase(_HALF(0.1, 0.3), 0.519729, 1.066921, 1.22666, 0.519747),
    "hollow pin, interference": BodyCase(_TUBE(-0.05, 0.3), 0.439983, 1.274162, 1.92521),
    "hollow pin, body load": BodyCase(
        Problem.from_load_parameter(replace(LIKE, plane="stress"), 0.0, 0.3, pin_body=Tube(0.6, "body")),
        0.412542, 1.181457, 1.65224,
    ),
    "bush": BodyCase(
        Problem.from_load_parameter(
            MaterialPair(Material(210e9, 0.3), Material(69e9, 0.33)),  # steel in aluminium
            0.1, 0.2, "body", plate_body=Bushing(BRONZE, 1.25),
        ),
        0.549388, 1.085855, 1.17797,
    ),
    "held ring, fretting": BodyCase(
        Problem.from_load_parameter(LIKE, 0.5, 0.55, "centre", "fixed", plate_body=Ring(3.0)),
        0.980067, 1.049797, 0.675325,
        history=({"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}),
    ),
}  # fmt: skip
"""Joints by name. All pins rotate freely but the fretting one."""


RING = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body", plate_body=Ring(2.0, "normal"))
"""A ring whose compliance is known."""


def cut_layer_difference(kind: str) -> float:
    """Return the difference of a bush cut into two layers from one layer, in a ring whose rim is free or held.

    It is the largest difference of a compliance of the harmonics 2 to 60, in parts of the largest.
    """
    order, kolosov = np.arange(2.0, 61.0), 1.7

    def compliance(outer: float, far: np.ndarray) -> np.ndarray:
        layer = harmonics.Layer(order, outer, kolosov, 0.7)
        return harmonics.hole(order, kolosov, 0.7) + layer.contact_displacement(layer.amplitudes(far))

    ring = harmonics.as_matrices(harmonics.ring(order, 2.0, 2.1, kind))
    far = harmonics.hole(order, 2.1, 1.9) + 0.5 * 1.9 * ring
    one, two = compliance(1.3, far), compliance(1.1, compliance(1.3 / 1.1, far))
    return float(np.abs(two - one).max() / np.abs(one).max())


def ring_compliance(problem: Problem, order: int) -> Compliance:
    """Return the compliance of the ring of `problem` with the harmonics up to `order`, from closed forms.

    Its first harmonic holds no translation of the hole. The mean rotation of the outer rim is 0.
    """
    ring, hole, size = problem.plate_body, problem.joint.hole, 2 + 4 * order
    kolosov, rim, kind = hole.kolosov, ring.far(hole), ring.outer_kind
    matrix = np.zeros((size, size))
    # The traction on the plate is (N, -T) = (-s_rr, -s_rtheta), and G v/R = c/2 times s.
    matrix[0, 0] = -0.5 * (harmonics.uniform(rim, kolosov, kind) + 1.0)
    matrix[1, 1] = -0.5 * rim**-2.0
    of_traction, of_force = ring.first(hole).displacement()
    change = harmonics.ring(np.arange(2.0, order + 1.0), rim, kolosov, kind).T
    for k, (a, b, d) in enumerate([(of_traction + 0.5, of_force, 0.0), *change]):
        radial, shear, mixed = 0.5 * (a + d) + b, 0.5 * (a + d) - b, 0.5 * (a - d)
        start = 2 + 4 * k
        block = matrix[start : start + 4, start : start + 4]  # r cos, r sin, theta cos, theta sin
        block += -0.5 * np.diag([radial, radial, shear, shear])
        block[[0, 3], [3, 0]], block[[1, 2], [2, 1]] = -0.5 * mixed, 0.5 * mixed
    columns = _stress_columns(problem, order)
    return Compliance(problem.pair.plate.nu, problem.pair.plane, problem.hole_radius, matrix, columns)


def _stress_columns(problem: Problem, order: int) -> dict[str, np.ndarray]:
    """Return the columns of the stresses on a ring's rim for its compliance, from the terms of the ring."""
    terms = body_terms(problem)
    assert terms is not None
    unit = problem.pair.plate_compliance / problem.surfaces.beta_star
    places = [place for place in REMOTE if place in terms.columns]
    return {LOADS[place]: _real_coefficients(terms.columns[place] / unit, order) for place in places}


def _real_coefficients(column: np.ndarray, order: int) -> np.ndarray:
    """Return coefficients in the real basis of a compliance, from coefficients of v_r + i v_theta, n = -m to m."""
    reach, middle = min(order, column.size // 2), column.size // 2
    above, below = np.zeros((2, order), dtype=complex)
    above[:reach], below[:reach] = column[middle + 1 :][:reach], column[:middle][::-1][:reach]
    real = np.zeros(2 + 4 * order)
    real[:2] = np.sqrt(2.0) * np.array([column[middle].real, column[middle].imag])
    cos, sin = above + below, 1j * (above - below)
    real[2::4], real[4::4], real[3::4], real[5::4] = cos.real, cos.imag, sin.real, sin.imag
    return real

"""Residuals of the singular integral equations (46), (47) of partial slip.

The solvers work with the displacements themselves and logarithmic kernels. The paper applies the operator
[[1, d], [-d, 1]] to them, which leaves Cauchy kernels cot((theta - xi)/2). With matrices of their own, the
equations are an independent check of a solved state inside its contact.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.kernels import influence
from fastpin.model.checks import number
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem


def cauchy_matrix(grid: Grid) -> np.ndarray:
    """Principal values of int hat_j(xi) cot((theta_i - xi)/2) dxi, shape (n, n), rows theta_i.

    The hats at the ends of an arc have no principal value at their own nodes: NaN there.
    """
    left, right = grid.knots()
    out = np.empty((grid.size, grid.size))
    influence.fill_cauchy(grid.theta, left, right, grid.uniform, grid.closed, out)
    return out


def residuals(
    problem: Problem,
    force: float,
    grid: Grid,
    pressure: ArrayLike,
    shear: ArrayLike,
    total_slip: ArrayLike,
    rotation: float,
    sxx: float = 0.0,
    syy: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Left minus right side of (46) and (47) at every node, divided by F beta*.

    Both vanish, up to discretisation, where the gap is zero. At a gap h > 0 they are -h/(F beta*) and
    h'/(F beta*). Leave out the nodes beside contact edges and borders of zones, where tractions and slip
    have kinks. (46) needs the derivative of the slip, and a stick zone keeps the kinks that earlier borders
    left in it: after a reversal (47) is the sharper check.

    Parameters
    ----------
    problem : Problem
        Materials, R, R - R_D and whether the pin's load acts at the centre (39) or as body forces (56).
    force : float
        Reference force F, N/m, positive; the scale of the result only.
    grid : Grid
    pressure, shear : array_like, shape (n,)
        N and T (on the pin, counter-clockwise positive), Pa.
    total_slip : array_like, shape (n,)
        s of Eq. (18), m, counted from the pin at the bottom of the hole. Counted from the concentric
        position, as in an interference fit, it is smaller by (R - R_D) cos theta.
    rotation : float
        C_omega, rad, from the same position.
    sxx, syy : float
        Remote stress, Pa.

    Returns
    -------
    r46, r47 : ndarray, shape (n,)
        NaN at an end of an arc that carries traction, where the principal value does not exist.

    Raises
    ------
    InputError
        If an array does not have one number per node or `force` is not positive.
    """
    unit = number("force", force)
    if unit <= 0.0:
        raise InputError("force", f"must be positive, not {unit:g}")
    pair, radius = problem.pair, problem.hole_radius
    length = unit * pair.beta_star
    N = _nodal("pressure", pressure, grid) * radius / unit
    T = _nodal("shear", shear, grid) * radius / unit
    s = _nodal("total_slip", total_slip, grid) / length
    C_omega = number("rotation", rotation) * radius / length
    clearance = problem.clearance / length
    A = (number("sxx", sxx) + number("syy", syy)) * radius / unit
    D = (number("sxx", sxx) - number("syy", syy)) * radius / unit

    # composite constants over beta*: kappa'/G of the plate, and (39) or (56)
    alpha = pair.alpha_star / pair.beta_star
    plate = 0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / pair.beta_star
    if problem.pin_load == "centre":
        gamma, gamma_prime = pair.gamma / pair.beta_star, pair.gamma_prime / pair.beta_star
    else:
        gamma, gamma_prime = pair.gamma_body / pair.beta_star, pair.gamma_body_prime / pair.beta_star

    theta = grid.theta
    cos, sin = np.cos(theta), np.sin(theta)
    cos_moment, sin_moment = grid.trig_moments()
    N_cos, N_sin, N_total = cos_moment @ N, sin_moment @ N, grid.weights @ N
    T_cos, T_sin, T_total = cos_moment @ T, sin_moment @ T, grid.weights @ T
    C_N, S_N = cos * N_cos + sin * N_sin, sin * N_cos - cos * N_sin
    C_T, S_T = cos * T_cos + sin * T_sin, sin * T_cos - cos * T_sin

    cauchy = cauchy_matrix(grid)
    cot_N, cot_T = _principal_value(cauchy, N), _principal_value(cauchy, T)

    G_s = 0.5 * plate * (0.5 * A - D * np.cos(2.0 * theta))  # (44)
    G_p = 0.5 * plate * D * np.sin(2.0 * theta)  # (45)
    left_46 = -clearance * (1.0 + sin) - _derivative(s, grid) - G_s
    right_46 = cot_T - math.pi * alpha * N - gamma * S_T + plate * N_total + gamma * C_N
    left_47 = C_omega - s + clearance * cos - G_p
    right_47 = -T_total - gamma_prime * C_T + math.pi * alpha * T + cot_N - gamma_prime * S_N
    return left_46 - right_46 / (4.0 * math.pi), left_47 - right_47 / (4.0 * math.pi)


def _principal_value(cauchy: np.ndarray, traction: np.ndarray) -> np.ndarray:
    # the NaN of an end node counts only if that node carries traction
    carrying = traction != 0.0
    return cauchy[:, carrying] @ traction[carrying]


def _derivative(values: np.ndarray, grid: Grid) -> np.ndarray:
    """d/dtheta at the nodes, second order on any spacing; one-sided at the ends of an arc."""
    theta = grid.theta
    if not grid.closed:
        return np.gradient(values, theta, edge_order=2)
    around = np.concatenate([[theta[-1] - 2.0 * math.pi], theta, [theta[0] + 2.0 * math.pi]])
    return np.gradient(np.concatenate([values[-1:], values, values[:1]]), around)[1:-1]


def _nodal(field: str, values: ArrayLike, grid: Grid) -> np.ndarray:
    array = np.asarray(values, dtype=float)
    if array.shape != (grid.size,):
        raise InputError(field, f"must have one number per node, shape ({grid.size},), not {array.shape}")
    return array

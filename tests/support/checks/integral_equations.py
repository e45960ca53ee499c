"""Residuals of the singular integral equations (46), (47) of partial slip.

The solvers work with displacements and logarithmic kernels. The paper applies the operator [[1, d], [-d, 1]] to the
displacements, which leaves Cauchy kernels cot((theta - xi)/2). The equations have separate matrices, so they check a
solved state inside its contact independently.

An initial gap g0 adds -g0 to the left side of (46), and g0' to the left side of (47). Finite bodies add smooth terms X
to gap and slip. With gap and slip h_X and s_X, (46) gains s_X' - h_X and (47) gains h_X' + s_X.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fastpin import Grid, InputError, Problem, State
from fastpin.bodies.compliance import complex_coefficients, plate_coefficients
from fastpin.elasticity.system import System
from fastpin.elasticity.terms import BodyTerms, body_terms
from fastpin.kernels import fourier, influence
from fastpin.model import LOADS, angles, loads
from fastpin.model.checks import number, numbers, positive
from fastpin.model.grid import LEAST_NODES
from fastpin.model.loads import SXX, SXY, SYY, P, Q
from fastpin.solver.rest import rest_position


def cauchy_matrix(grid: Grid) -> np.ndarray:
    """Principal values of int hat_j(xi) cot((theta_i - xi)/2) dxi, shape (n, n), row i, column j.

    The hat at an end of an arc has no principal value at its own node: this entry is NaN.
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
    sxy: float = 0.0,
    rest: tuple[float, float] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Left minus right side of (46) and (47) at every node, divided by F beta*.

    Both residuals vanish, up to discretisation, where the gap is zero. At a gap h > 0 they are -h/(F beta*) and
    h'/(F beta*). Leave out the nodes beside contact edges and borders of zones: tractions and slip have kinks there.

    (46) needs the derivative of the slip. A stick zone keeps the kinks that earlier borders left in the slip. So after
    a reversal (47) is the sharper check. Leave out nodes at kinks of an initial gap too: edges of flats and worn zones.

    Parameters
    ----------
    problem : Problem
        Gives the materials, the bodies, R, R - R_D and the load on the pin: at the centre (39) or as body forces (56).
    force : float
        Reference force F, N/m, positive. It only scales the result.
    grid : Grid
        The nodes.
    pressure, shear : array_like, shape (n,)
        N and T (on the pin, counter-clockwise positive), Pa.
    total_slip : array_like, shape (n,)
        Slip s of Eq. (18), m, positive along +theta, counted from the pin at `rest`.
    rotation : float
        C_omega, rad, counter-clockwise, from the same position.
    sxx, syy, sxy : float
        Remote stress, Pa.
    rest : (float, float), optional
        Position of the pin's centre from which slip counts, m. The default is the bottom of a round hole. In an
        interference fit it is (0, 0). :func:`fastpin.solver.rest.rest_position` finds it in a hole with an initial gap.

    Returns
    -------
    r46, r47 : ndarray, shape (n,)
        Residuals of (46) and (47). NaN at an end of an arc that carries traction: there is no principal value there.

    Raises
    ------
    InputError
        If an array does not have one number per node or `force` is not positive.
    """
    pair, radius, unit = problem.surfaces, problem.hole_radius, positive("force", force)
    length = unit * pair.beta_star
    N = _nodal("pressure", pressure, grid) * radius / unit
    T = _nodal("shear", shear, grid) * radius / unit
    s = _nodal("total_slip", total_slip, grid) / length
    C_omega = number("rotation", rotation) * radius / length
    opened, along = _at_rest(problem, grid.theta, rest) / length
    stresses = {SXX: sxx, SYY: syy, SXY: sxy}
    remote = {place: number(LOADS[place], stress) * radius / unit for place, stress in stresses.items()}

    # Composite constants over beta*, with kappa'/G of the plate.
    alpha = pair.alpha_star / pair.beta_star
    plate = 0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / pair.beta_star
    gamma, gamma_prime = _pin_constants(problem)

    theta, cos, sin = grid.theta, np.cos(grid.theta), np.sin(grid.theta)
    cos_moment, sin_moment = grid.trig_moments()
    N_cos, N_sin, N_total = cos_moment @ N, sin_moment @ N, grid.weights @ N
    T_cos, T_sin, T_total = cos_moment @ T, sin_moment @ T, grid.weights @ T
    C_N, S_N = cos * N_cos + sin * N_sin, sin * N_cos - cos * N_sin
    C_T, S_T = cos * T_cos + sin * T_sin, sin * T_cos - cos * T_sin

    cauchy = cauchy_matrix(grid)
    cot_N, cot_T = _principal_value(cauchy, N), _principal_value(cauchy, T)

    left_46 = -opened - _derivative(s, grid)
    right_46 = cot_T - math.pi * alpha * N - gamma * S_T + plate * N_total + gamma * C_N
    left_47 = C_omega - s + along
    right_47 = -T_total - gamma_prime * C_T + math.pi * alpha * T + cot_N - gamma_prime * S_N
    bodies = body_terms(problem)
    if bodies is None:
        added = _remote_terms(plate, theta, remote)
    else:
        remote |= {Q: float(N_cos + T_sin), P: float(T_cos - N_sin)}
        added = _traction_terms(bodies, grid, np.array([N, T])) + _load_terms(problem, bodies, theta, remote)
        added += _laminate_terms(bodies, theta, cot_N + 1j * cot_T, complex(N_total, T_total), remote)
    return left_46 - right_46 / (4.0 * math.pi) + added[0], left_47 - right_47 / (4.0 * math.pi) + added[1]


def _at_rest(problem: Problem, theta: np.ndarray, rest: tuple[float, float] | None) -> np.ndarray:
    """The gap of the rigid pin at `rest`, m, at the angles `theta` (n,), and its derivative, shape (2, n)."""
    x, y = (0.0, -problem.assembled_clearance) if rest is None else numbers("rest", rest)
    gap, slope, _ = problem.gap_at(theta)
    cos, sin = np.cos(theta), np.sin(theta)
    found: np.ndarray = np.array([problem.assembled_clearance - x * cos - y * sin + gap, x * sin - y * cos + slope])
    return found


def _pin_constants(problem: Problem) -> tuple[float, float]:
    """Return the composite constants gamma and gamma' over beta*, (39) or (56)."""
    pair = problem.surfaces
    if problem.pin_load == "centre":
        return pair.gamma / pair.beta_star, pair.gamma_prime / pair.beta_star
    return pair.gamma_body / pair.beta_star, pair.gamma_body_prime / pair.beta_star


def _remote_terms(plate: float, theta: np.ndarray, stress: dict[int, float]) -> np.ndarray:
    """Terms -G_s of (46) and -G_p of (47), shape (2, n), of remote stresses in an infinite plate; (44), (45), (T16)."""
    A, D = stress[SXX] + stress[SYY], stress[SXX] - stress[SYY] + 2j * stress[SXY]
    G = 0.5 * plate * (0.5 * A - D * np.exp(-2j * theta))
    return -np.array([G.real, G.imag])


def _traction_terms(bodies: BodyTerms, grid: Grid, tractions: np.ndarray) -> np.ndarray:
    """Terms of (46) and (47), shape (2, n), by which tractions (N, T), shape (2, n), move finite bodies."""
    left, right = grid.knots()
    highest = max(bodies.coefficients.shape[1] - 1, (len(bodies.matrix) - 2) // 4)
    order = np.arange(highest + 1.0)
    spectra = fourier.hat_coefficients(order, grid.theta, grid.theta - left, right - grid.theta, tractions.T)
    first, second, cross = bodies.coefficients
    pressure, shear = spectra[: first.size].T
    gap, slip = first * pressure - 1j * cross * shear, second * shear + 1j * cross * pressure
    n = order[: first.size]
    waves = np.exp(1j * np.multiply.outer(grid.theta, n))
    terms = np.array([waves @ (1j * n * slip - gap), waves @ (1j * n * gap + slip)]).real
    if bodies.matrix.size:
        low = spectra[: (len(bodies.matrix) + 2) // 4] / math.pi
        moved = complex_coefficients(bodies.matrix @ plate_coefficients(*low.T))
        terms += _of_displacement(moved, grid.theta)
    return terms


def _laminate_terms(
    bodies: BodyTerms, theta: np.ndarray, principal: np.ndarray, total: complex, load: dict[int, float]
) -> np.ndarray | float:
    """Terms of (46) and (47), shape (2, n), of the anisotropy of a laminate, (T58); 0 in an isotropic plate.

    `principal` (n,) is the principal value of int cot(phi/2) (N + iT), and `total` is int (N + iT).
    """
    if not bodies.anisotropy:
        return 0.0
    turn, force = np.exp(1j * theta), complex(load[Q], load[P])
    moved = bodies.anisotropy / (4j * math.pi) / turn**2 * (principal + 1j * total + 1j * turn * force)
    return -np.array([moved.real, moved.imag])


def _load_terms(problem: Problem, bodies: BodyTerms, theta: np.ndarray, load: dict[int, float]) -> np.ndarray:
    """Terms of (46) and (47), shape (2, n), by which loads move finite bodies.

    The first harmonic of P and Q counts beyond that of a solid pin, which (39) and (56) hold.
    """
    pair, share = problem.surfaces, 1.0 if problem.pin_load == "centre" else 0.5  # the number w of section 4
    point = bodies.force_factor - share * pair.pin_compliance / (4.0 * math.pi * pair.beta_star)
    force = load[Q] - 1j * load[P]
    moved = 2.0 * point * np.conj(force) * np.exp(1j * theta)
    terms = np.array([moved.real, moved.imag])
    for place, column in bodies.columns.items():
        terms += _of_displacement(load[place] * column, theta)
    return terms


def _of_displacement(column: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Terms of (46) and (47) from coefficients of v_r + i v_theta, n = -K to K. The gap is v_r, the slip -v_theta."""
    order = np.arange(column.size) - column.size // 2
    moved = np.exp(1j * np.multiply.outer(theta, order)) @ ((order + 1.0) * column)
    return -np.array([moved.real, moved.imag])


def _principal_value(cauchy: np.ndarray, traction: np.ndarray) -> np.ndarray:
    # Columns without traction are left out, because the NaN of an end node times zero would be NaN.
    carrying = traction != 0.0
    return cauchy[:, carrying] @ traction[carrying]


def _derivative(values: np.ndarray, grid: Grid) -> np.ndarray:
    """Derivative d/dtheta at the nodes, second order on any spacing. It is one-sided at the ends of an arc."""
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


def residuals_away(state: State, margin: float) -> tuple[float, float]:
    """Return the largest residuals of (46) and (47) inside the contact, away from its edges and borders.

    Parameters
    ----------
    state : State
        A state with one contact interval. The pin must have been pressed to the bottom first, and no load reversed: a
        reversal leaves kinks of the slip. An initial gap must be smooth.
    margin : float
        Least distance from contact edges and stick borders, rad.

    Returns
    -------
    r46, r47 : float
        In units of F beta* with F = P.
    """
    load = state.load
    equations = residuals(
        state.problem, load["P"], state.grid, state.pressure, state.shear, state.slip, state.rotation,
        sxx=load["sxx"], syy=load["syy"], sxy=load["sxy"], rest=_bottom(state),
    )  # fmt: skip
    ((start, stop),) = state.contact
    away = np.abs(angles.angle_between(state.theta, 0.5 * (start + stop))) < 0.5 * (stop - start) - margin
    for border in np.ravel(state.stick):
        away &= np.abs(angles.angle_between(state.theta, border)) > margin
    first, second = (float(np.abs(residual[away]).max()) for residual in equations)
    return first, second


def _bottom(state: State) -> tuple[float, float] | None:
    """The position of the rigid pin that is pushed to the bottom of a hole with a gap, m; None in a round hole."""
    if not state.problem.gap:
        return None
    system = System.build(state.problem, Grid.circle(LEAST_NODES), state.problem.natural_loads()["force"])
    x, y = rest_position(system, np.zeros(len(loads.LOADS)), angles.BOTTOM)[0] * system.scales.displacement
    return float(x), float(y)

"""The integral equations (46), (47) on manufactured and on solved states.

Their displacements come from the logarithmic kernels: two forms of the theory are held against each other.
"""

import math

import numpy as np
import pytest

from fastpin import MATERIALS, Grid, Material, MaterialPair, Problem, solve
from fastpin.kernels import influence
from fastpin.verification import closed_forms
from tests.support.bodies import JOINTS, joint_problem
from tests.support.checks.integral_equations import cauchy_matrix, residuals, residuals_away
from tests.support.integrals import log_integrals
from tests.support.refusals import refused

STEEL = MATERIALS["steel"]
PAIRS = [
    MaterialPair(STEEL, STEEL),
    MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"]),
    MaterialPair(Material(3e9, 0.49), STEEL, "stress"),
    MaterialPair(Material.rigid(), STEEL),
]


def graded(start, stop, n):
    """An arc whose spacing varies smoothly by a factor of 3."""
    t = np.linspace(0.0, 1.0, n)
    return Grid(start + (stop - start) * (t - 0.5 / (2.0 * np.pi) * np.sin(2.0 * np.pi * t)))


def displacements(problem, grid, N, T):
    """v_r - u_r and v_theta - u_theta over R, from (30), (31) with the logarithmic kernels."""
    pair = problem.pair
    direct, cross = log_integrals(grid, False, pair.alpha_star / pair.beta_star)
    cosine, sine = grid.trig_moments()
    c, s = np.cos(grid.theta), np.sin(grid.theta)
    C, S = np.outer(c, cosine) + np.outer(s, sine), np.outer(s, cosine) - np.outer(c, sine)
    w = 1.0 if problem.pin_load == "centre" else 0.5
    beta, g, k = pair.beta_star, pair.pin_compliance, 0.5 * (pair.pin_kolosov + 1.0)
    radial = beta * (direct @ N + cross @ T) - w * g * (C @ N - S @ T) - k * g * (grid.weights @ N)
    tangential = beta * (cross @ N - direct @ T) - w * g * (S @ N + C @ T)
    return radial / (4.0 * math.pi), tangential / (4.0 * math.pi)


def rate(errors):
    """Fitted order of convergence for meshes that double."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]


# --- frictionless: Persson's closed form ------------------------------------------------------------------


def persson_errors(grid, load_parameter, of_pressure=None):
    """Largest residuals of Persson's pressure, or of that of another load parameter."""
    problem = Problem.from_load_parameter(PAIRS[0], load_parameter, 0.0)
    half_angle = closed_forms.persson_half_angle(load_parameter if of_pressure is None else of_pressure)
    phi = grid.theta + math.pi / 2.0
    N = closed_forms.persson_pressure(np.where(np.abs(phi) > math.pi, math.pi, phi), half_angle)
    none = np.zeros(grid.size)
    radial, tangential = displacements(problem, grid, N, none)
    # the gap (15) is zero at the bottom, where h_d = -Delta
    delta = np.interp(-math.pi / 2.0, grid.theta, radial)
    slip = -delta * np.cos(grid.theta) - tangential
    inside = np.abs(phi) < 0.7 * half_angle
    return [np.abs(r[inside]).max() for r in residuals(problem, 1.0, grid, N, none, slip, 0.0)]


def arcs(make, load_parameter):
    """Meshes of the contact by Persson."""
    half_angle = closed_forms.persson_half_angle(load_parameter)
    return [make(-math.pi / 2.0 - half_angle, -math.pi / 2.0 + half_angle, n) for n in (41, 81, 161, 321)]


ROUND = closed_forms.persson_load_parameter(0.4 * math.pi)
"""The edges of this contact are nodes of every mesh of the circle."""


@pytest.mark.parametrize(
    ("meshes", "load_parameter"),
    [
        *((arcs(make, load), load) for load in (0.05, 0.5) for make in (Grid.arc, graded)),
        ([Grid.circle(n) for n in (150, 300, 600)], ROUND),
    ],
    ids=["uniform, 0.05", "graded, 0.05", "uniform, 0.5", "graded, 0.5", "circle"],
)
def test_persson_satisfies_both_equations(meshes, load_parameter):
    errors = np.array([persson_errors(grid, load_parameter) for grid in meshes])
    assert np.all(errors[-1] < 1e-4)
    # the root singularity of the pressure at the edges holds the order at 3/2
    assert rate(errors[:, 0]) > 1.35
    assert rate(errors[:, 1]) > 1.35


def test_a_wrong_state_does_not_satisfy_them():
    assert min(persson_errors(Grid.arc(-3.0, -0.1, 321), 0.05, of_pressure=0.06)) > 1e-3


# --- every term: arbitrary tractions, whose gap is then the residual --------------------------------------


def manufactured_errors(problem, grid, start, stop):
    """Largest |r46 + h| and |r47 - h'| over F beta*, for smooth tractions that leave a gap h."""
    force, pair, radius = 2e6, problem.pair, problem.hole_radius
    length = force * pair.beta_star
    theta = grid.theta
    x = (2.0 * theta - start - stop) / (stop - start)
    bump = np.maximum(1.0 - x * x, 0.0) ** 2.5
    N, T = bump * (1.0 + 0.3 * x), bump * np.sin(2.0 * x + 0.4)
    radial, tangential = displacements(problem, grid, N, T)
    cx, delta, omega, sxx, syy, sxy = 0.31, 0.73, 0.17, 0.4, -0.25, 0.15  # lengths in F beta*, stresses in F/R
    plate = 0.25 * (pair.plate_kolosov + 1.0) * pair.plate_compliance
    oval = (sxx - syy + 2j * sxy) * np.exp(-2j * theta)
    remote_r, remote_t = plate * (0.5 * (sxx + syy) + oval.real), plate * oval.imag  # (42), (T16)
    cos, sin = np.cos(theta), np.sin(theta)
    gap = problem.clearance / length * (1.0 + sin) - cx * cos + delta * sin + (radial + remote_r) / pair.beta_star
    slip = omega - delta * cos - cx * sin - (tangential + remote_t) / pair.beta_star
    r46, r47 = residuals(
        problem, force, grid, N * force / radius, T * force / radius, slip * length, omega * length / radius,
        *np.array([sxx, syy, sxy]) * force / radius,
    )  # fmt: skip
    inside = np.abs(x) < 0.9
    gap_rate = np.gradient(gap, theta, edge_order=2)
    return [np.abs((r46 + gap)[inside]).max(), np.abs((r47 - gap_rate)[inside]).max()]


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("pin_load", ["centre", "body"])
def test_manufactured_tractions(pair, pin_load):
    problem = Problem(pair, 0.02, 1.5e-5, 0.4, pin_load)
    start, stop = -2.6, -0.3
    errors = np.array([manufactured_errors(problem, graded(start, stop, n), start, stop) for n in (61, 121, 241)])
    assert np.all(errors[-1] < 1e-3)
    assert rate(errors[:, 0]) == pytest.approx(2.0, abs=0.15)
    assert rate(errors[:, 1]) == pytest.approx(2.0, abs=0.15)


def test_manufactured_tractions_all_round():
    problem = Problem(PAIRS[1], 0.02, -1.5e-5, 0.4)
    errors = np.array([manufactured_errors(problem, Grid.circle(n, -math.pi), -2.9, 2.6) for n in (100, 200, 400)])
    assert np.all(errors[-1] < 1e-3)
    assert np.all([rate(column) == pytest.approx(2.0, abs=0.15) for column in errors.T])


# --- border cases -----------------------------------------------------------------------------------------


def test_reference_force_is_a_scale_only():
    grid, problem = Grid.arc(-2.5, -0.5, 41), Problem(PAIRS[1], 0.02, 1e-5, 0.3)
    N = 1e7 * np.maximum(1.0 - (grid.theta + 1.5) ** 2, 0.0)
    state = (grid, N, 0.2 * N, 1e-6 * np.cos(3.0 * grid.theta), 1e-4, 1e6, 2e6)
    one, two = (np.array(residuals(problem, f, *state)) for f in (1e5, 2e5))
    np.testing.assert_allclose(one, 2.0 * two, rtol=1e-12)


def test_traction_at_the_end_of_an_arc_has_no_principal_value():
    grid, problem = Grid.arc(-2.5, -0.5, 21), Problem(PAIRS[0], 0.02, 1e-5, 0.3)
    N = np.ones(grid.size)
    N[-1] = 0.0
    r46, r47 = residuals(problem, 1.0, grid, N, 0.0 * N, 0.0 * N, 0.0)
    assert np.isfinite(r46).all()
    assert np.isnan(r47[0])
    assert np.isfinite(r47[1:]).all()


def test_cauchy_matrix_picks_the_quick_fill_only_on_uniform_grids():
    for grid in (Grid.arc(-2.5, -0.5, 21), graded(-2.5, -0.5, 21), Grid(np.linspace(-2.5, -0.5, 21), closed=True)):
        left, right = grid.knots()
        out = np.empty((grid.size, grid.size))
        influence.fill_cauchy(grid.theta, left, right, False, grid.closed, out)
        np.testing.assert_allclose(cauchy_matrix(grid), out, atol=2e-11, equal_nan=True)


def test_bad_input_names_the_argument():
    grid, problem = Grid.arc(-2.5, -0.5, 21), Problem(PAIRS[0], 0.02, 1e-5, 0.3)
    ok = np.zeros(21)
    for field, arguments in (
        ("force", (0.0, grid, ok, ok, ok, 0.0)),
        ("pressure", (1.0, grid, ok[1:], ok, ok, 0.0)),
        ("shear", (1.0, grid, ok, ok[1:], ok, 0.0)),
        ("total_slip", (1.0, grid, ok, ok, ok[1:], 0.0)),
        ("rotation", (1.0, grid, ok, ok, ok, math.nan)),
    ):
        assert refused(residuals, problem, *arguments).field == field


# --- solved states ----------------------------------------------------------------------------------------


# --- finite bodies ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*JOINTS, "ring, compliance"])
def test_solved_states_of_finite_bodies_satisfy_them(name):
    """Measured with 401 nodes: (46) 3e-6 to 1.1e-5, (47) 2e-7 to 1.4e-6, as without bodies (6e-6, 3e-7)."""
    problem = joint_problem(name, 0.1, 0.4)
    first, second = zip(
        *(residuals_away(solve(problem, [{"P": 1.0}], nodes=nodes)[-1], 0.15) for nodes in (101, 401)), strict=True
    )
    assert first[1] < min(1.5e-5, 0.25 * first[0])
    assert second[1] < min(2e-6, 0.1 * second[0])


@pytest.mark.parametrize("name", ["half ring", "reaction", "bush", "tube, bush, ring", "ring, compliance"])
def test_the_columns_of_finite_bodies_satisfy_them(name):
    """P and Q together, and remote stress: every load moves the bodies. Measured: 1.5e-7 to 9e-7."""
    problem = joint_problem(name, 0.3, 0.5)
    history = [{"P": 1.0}, {"Q": 0.1, "sxx": 0.05, "syy": -0.03, "sxy": 0.05}]
    state = solve(problem, history, nodes=401)[-1]
    assert residuals_away(state, 0.15)[1] < 2e-6


@pytest.mark.parametrize("name", ["tube", "held ring", "half ring", "bush"])
def test_the_equations_of_solid_bodies_do_not_hold_for_finite_ones(name):
    """Without the terms of the bodies the residuals are thousands of times larger."""
    problem = joint_problem(name, 0.1, 0.4)
    state = solve(problem, [{"P": 1.0}], nodes=201)[-1]
    solid = Problem.from_load_parameter(problem.surfaces.scaled(1.0), 0.1, 0.4)
    r46, r47 = residuals(solid, 1.0, state.grid, state.pressure, state.shear, state.slip, state.rotation)
    inside = np.abs(state.theta + 0.5 * math.pi) < 0.5
    assert min(np.abs(r46[inside]).max(), np.abs(r47[inside]).max()) > 5e-3

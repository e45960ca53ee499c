"""Formulas of docs/theory.md that no other test checks, by its equation numbers."""

import math

import mpmath
import numpy as np
import pytest

from fastpin import MATERIALS, Grid, Material, MaterialPair, Problem, solve
from fastpin.kernels import influence
from fastpin.verification import closed_forms
from tests.support.checks.integral_equations import cauchy_matrix
from tests.support.integrals import log_integrals
from tests.support.potentials import (
    KOLOSOV,
    RADIUS,
    THETA,
    Potentials,
    functions,
    pin_body,
    pin_normal,
    pin_shear,
    plate,
    printed,
)

PI = math.pi
PAIRS = [
    MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"]),
    MaterialPair(Material(3e9, 0.49), MATERIALS["steel"], "stress"),
    MaterialPair(Material.rigid(), MATERIALS["steel"]),
    MaterialPair(MATERIALS["steel"], Material.rigid()),
]


# --- section 2: the datum of the displacements --------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_surfaces_do_not_move_on_average(kappa):
    # midpoints: the errors of the logarithm and of the jump at the load fall with the spacing
    n = 4000
    angle = (np.arange(n) + 0.5) * 2.0 * PI / n - PI
    rotation = {"pin N": 0.0, "pin T": kappa, "plate N": 0.0, "plate T": -1.0, "body N": 0.0, "body T": 0.0}
    for name, turn in rotation.items():
        field = 2.0 * PI * printed(name, angle, kappa)
        assert abs(np.mean(field * np.exp(1j * angle))) < 2e-3
        assert np.mean(field.imag) == pytest.approx(turn, abs=2e-3)


# --- section 4: remote stress and hoop stress ---------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_remote_stress(kappa):
    sxx, syy, sxy, a = 0.7, -0.4, 0.3, RADIUS
    A, D = sxx + syy, sxx - syy + 2j * sxy

    problem = Potentials(
        kappa,
        lambda z: 0.25 * A * z + 0.5 * D * a**2 / z,
        lambda z: 0.25 * A - 0.5 * D * a**2 / z**2,
        lambda z: D * a**2 / z**3,
        lambda z: -0.5 * (D.conjugate() * z - D * a**4 / z**3) - 0.5 * A * a**2 / z,
        lambda z: -0.5 * (D.conjugate() + 3.0 * D * a**4 / z**4) + 0.5 * A * a**2 / z**2,
    )
    edge = a * np.exp(1j * THETA)
    assert np.abs(problem.traction(edge, edge / a)).max() < 1e-14
    far = 1e4 * np.exp(1j * THETA)
    assert problem.traction(far, 1.0 + 0.0j) == pytest.approx(sxx + 1j * sxy, abs=1e-6)
    assert problem.traction(far, 1j) == pytest.approx(sxy + 1j * syy, abs=1e-6)
    # 2G (v_r + i v_theta), (T16): Eq. (42) with the half on A that its print lacks
    moved = problem.displacement(edge) * np.exp(-1j * THETA)
    expected = a * 0.5 * (kappa + 1.0) * (0.5 * A + D * np.exp(-2j * THETA))
    np.testing.assert_allclose(moved, expected, atol=1e-14)
    hoop = 4.0 * np.real(problem.Omega_1(edge))
    np.testing.assert_allclose(hoop, A - 2.0 * np.real(D * np.exp(-2j * THETA)), atol=1e-14)


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_hoop_stress(kappa):
    # (T17) beside a point load N or T at theta = 0
    C, S, _, _ = functions(THETA)
    cot, k = 1.0 / np.tan(0.5 * THETA), 2.0 * kappa / (kappa + 1.0)
    z = RADIUS * np.exp(1j * THETA)

    def hoop(problem):
        along = 1j * np.exp(1j * THETA)
        return PI * RADIUS * np.real(problem.traction(z, along) / along)

    np.testing.assert_allclose(hoop(plate(kappa, 1.0)), 1.0 + k * C, atol=1e-12)
    np.testing.assert_allclose(hoop(plate(kappa, -1j)), cot - k * S, atol=1e-12)
    at_centre = 2.0 / (kappa + 1.0)
    np.testing.assert_allclose(hoop(pin_normal(kappa)), at_centre * C, atol=1e-12)
    np.testing.assert_allclose(hoop(pin_shear(kappa)), -cot - at_centre * S, atol=1e-12)
    np.testing.assert_allclose(hoop(pin_body(kappa)), -at_centre * C, atol=1e-12)


# --- section 7: full sliding --------------------------------------------------------------------------------


def sliding_error(pair, w, sign, nodes, mu=0.6):
    """Largest |right side of (T19) - (h + h'')| for arbitrary tractions T = +-mu N that leave a gap."""
    grid = Grid.arc(-2.8, -0.4, nodes)
    theta, beta = grid.theta, pair.beta_star
    alpha, pin, k = pair.alpha_star / beta, pair.pin_compliance / beta, 0.5 * (pair.pin_kolosov + 1.0)
    hole = 0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / beta
    x = (2.0 * theta + 3.2) / 2.4
    N = np.maximum(1.0 - x * x, 0.0) ** 4 * (1.0 + 0.4 * x)
    slope = np.gradient(N, theta, edge_order=2)
    T = sign * mu * N
    direct, cross = log_integrals(grid, True, alpha)
    cos, sin = np.cos(theta), np.sin(theta)
    cosine, sine = grid.trig_moments()
    N_total, P, Q = grid.weights @ N, cosine @ T - sine @ N, sine @ T + cosine @ N  # equilibrium (T18)
    F_r = Q * cos - P * sin
    clearance, A, D = 0.21, 0.3, -0.7
    gap = clearance * (1.0 + sin) - 0.3 * cos + 0.8 * sin
    gap += (direct @ N + cross @ T - w * pin * F_r - k * pin * N_total) / (4.0 * PI)  # (T9), (T10)
    gap += 0.5 * hole * (0.5 * A + D * np.cos(2.0 * theta))  # (T16)
    H = 0.5 * hole * (0.5 * A - 3.0 * D * np.cos(2.0 * theta))
    cauchy = np.nan_to_num(cauchy_matrix(grid))
    bracket = hole * N_total + (alpha + 2.0) * F_r - PI * alpha * (N + sign * mu * slope)
    bracket -= cauchy @ (slope - sign * mu * N)
    both = gap + np.gradient(np.gradient(gap, theta, edge_order=2), theta, edge_order=2)
    inside = slice(nodes // 10, -nodes // 10)
    return np.abs((clearance + H + bracket / (4.0 * PI) - both)[inside]).max()


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("w", [1.0, 0.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_full_sliding_is_the_radial_equation_twice_differentiated(pair, w, sign):
    coarse, fine = sliding_error(pair, w, sign, 201), sliding_error(pair, w, sign, 401)
    assert fine < 3e-4
    assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


def dominant(power, x, left, mu_beta, length=1.2):
    """[-PV int cot((theta - xi)/2) N' -+ 2 pi mu beta_D N']/(2 pi), upper sign, N = x^power (1 - x/length)^2."""
    x, length = mpmath.mpf(x), mpmath.mpf(length)

    def slope(y):
        return power * y ** (power - 1) * (1 - y / length) ** 2 - 2 * y**power * (1 - y / length) / length

    # with distances from the edge the cotangent integral is the same at both; theta and N' change sign at the right
    near = mpmath.quad(lambda u: (slope(x - u) - slope(x + u)) * mpmath.cot(u / 2), [0, x / 2, x])
    far = mpmath.quad(lambda y: slope(y) * mpmath.cot((x - y) / 2), [2 * x, 4 * x, 16 * x, 256 * x, length])
    return float(-(near + far) / (2 * mpmath.pi) - (1 if left else -1) * mu_beta * slope(x))


@pytest.mark.gate
@pytest.mark.parametrize("left", [True, False])
def test_edge_exponents(left):
    """(T20), (T21): the dominant part stays bounded towards an edge with the right exponent only."""
    mu_beta = 0.4
    turn = math.atan(mu_beta) / PI if left else -math.atan(mu_beta) / PI

    def growth(power):
        return abs(dominant(power, 1e-6, left, mu_beta) - dominant(power, 1e-4, left, mu_beta))

    assert growth(0.5 + turn) < 1e-2
    for wrong in (0.5, 0.5 - turn, 0.5 + 1.1 * turn):
        assert growth(wrong) > 1.0


# --- section 8: which groups matter -------------------------------------------------------------------------


def test_the_pins_load_and_its_poisson_ratio_make_one_group():
    """Body load with kappa_I + 1 = 2 and centre load with kappa_I + 1 = 4: the same w/(kappa_I + 1)."""
    history = [{"P": 1.0}, {"Q": 0.25}]

    def follow(nu, pin_load):
        pair = MaterialPair.from_dundurs(0.0, 0.0, nu)
        problem = Problem.from_load_parameter(pair, 0.1, 0.4, pin_load, "free")
        return solve(problem, history, nodes=121, arc=(-0.5 * PI - 1.6, -0.5 * PI + 1.6))

    body, centre, other = follow(0.5, "body"), follow(0.0, "centre"), follow(0.0, "body")
    for one, two, three in zip(body, centre, other, strict=True):
        np.testing.assert_allclose(one.pressure, two.pressure, atol=1e-10)
        np.testing.assert_allclose(one.shear, two.shear, atol=1e-10)
        # Dundurs' parameters are the same, the tractions are not
        assert np.abs(one.shear - three.shear).max() > 0.05


@pytest.mark.parametrize("pair", PAIRS)
def test_normalised_remote_stress(pair):
    alpha, _ = pair.dundurs()
    share = 0.25 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / pair.beta_star
    assert 0.25 * (1.0 + alpha) == pytest.approx(share, rel=1e-12, abs=1e-15)
    offset = (1.0 - alpha) / (pair.pin_kolosov + 1.0)
    assert pair.pin_compliance / pair.beta_star == pytest.approx(offset, rel=1e-12, abs=1e-15)


# --- section 9: limits --------------------------------------------------------------------------------------


@pytest.mark.parametrize("half_angle", [0.4, 1.3, 2.4])
def test_total_pressure_of_the_frictionless_contact(half_angle):
    n = 20000
    t = (np.arange(n) + 0.5) * PI / n
    total = np.sum(closed_forms.persson_pressure(half_angle * np.cos(t), half_angle) * np.sin(t)) * half_angle * PI / n
    b = math.tan(0.5 * half_angle)
    assert total == pytest.approx((math.log(b * b + 1.0) + 2.0 * b**4) / (b * b * (b * b + 1.0)), rel=1e-7)


@pytest.mark.parametrize("pair", PAIRS)
def test_interference_pressure(pair):
    # a uniform pressure N R/F = 1 closes the gap -(1 + alpha_D - 2 beta_D)/4 in F beta*, all from (T9)
    grid = Grid.circle(720)
    direct, cross = log_integrals(grid, True, pair.alpha_star / pair.beta_star)
    alpha, beta = pair.dundurs()
    radial = (direct.sum(axis=1) - 0.5 * (1.0 - alpha) * 2.0 * PI) / (4.0 * PI)
    np.testing.assert_allclose(radial, 0.25 * (1.0 + alpha - 2.0 * beta), atol=1e-12)
    lame = 0.5 * pair.plate_compliance + 0.25 * (pair.pin_kolosov - 1.0) * pair.pin_compliance
    assert radial.mean() == pytest.approx(lame / pair.beta_star, abs=1e-12)
    np.testing.assert_allclose(cross.sum(axis=1), 0.0, atol=1e-11)


def test_kernels_of_half_planes():
    for ratio in (-0.4, 0.0, 0.9):
        for x in (-1e-5, 1e-5):
            direct, cross = influence.log_kernels(x, ratio)
            assert direct == pytest.approx(-2.0 * math.log(abs(x)), abs=1e-4)
            assert cross == pytest.approx(-0.5 * PI * ratio * math.copysign(1.0, x), abs=1e-3)


# --- section 10: second antiderivatives ---------------------------------------------------------------------


def test_table_of_second_antiderivatives():
    def log(x):
        return math.log(2.0 - 2.0 * math.cos(x))

    def jump(x):
        return math.copysign(0.5 * PI, x)

    def CL(x):
        return (1.0 - math.cos(x)) * (log(x) - 1.0) - 0.5 * x * x + math.cos(x)

    def SL(x):
        return -2.0 * influence.clausen(x) - log(x) * math.sin(x) + 2.0 * math.sin(x)

    def SA(x):
        return -math.cos(x) - 0.5 * x * math.sin(x) + jump(x) * (math.sin(x) - x)

    def CA(x):
        return 0.5 * (math.sin(x) - x * math.cos(x)) + jump(x) * (math.cos(x) - 1.0) + 0.5 * math.sin(x)

    def hat(K2, theta, a, b, c):
        return (K2(theta - a) - K2(theta - b)) / (b - a) - (K2(theta - b) - K2(theta - c)) / (c - b)

    ratio, (a, b, c) = 0.37, (-0.2, 0.1, 0.35)
    for theta in (-2.9, -0.7, -0.1, 0.0, 0.3, 1.4, 3.0):
        direct, cross = influence.hat_log(theta - b, b - a, c - b, ratio)
        assert ratio * hat(SA, theta, a, b, c) - hat(CL, theta, a, b, c) == pytest.approx(direct, abs=1e-9)
        assert ratio * hat(CA, theta, a, b, c) + hat(SL, theta, a, b, c) == pytest.approx(cross, abs=1e-9)

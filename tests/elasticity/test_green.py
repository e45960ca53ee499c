"""The surface displacements (9)-(12), (54), (55) against Kolosov-Muskhelishvili potentials.

Convention: 2G (u_x + i u_y) = kappa Omega - z conj(Omega') - conj(omega), sxx + syy = 4 Re Omega' and
syy - sxx + 2i sxy = 2 (conj(z) Omega'' + omega'). With it (1)-(4) leave the edge free of traction, and
(9)-(12) follow up to rigid motions, which the tests state: a translation each, and for (10) also the rotation
(kappa_I + 1) M / (4 pi G_I a^2), M = -T a: the term i M z/(2 pi a^2) of (3) is this rotation and nothing
else, and (10) leaves it out.
"""

import math

import numpy as np
import pytest

from fastpin.kernels import influence
from tests.support.potentials import (
    KOLOSOV,
    PAIRS,
    PI,
    RADIUS,
    THETA,
    displacement_kernels,
    edge_force,
    functions,
    pin_body,
    pin_normal,
    pin_shear,
    plate,
    printed,
    rigid_part,
)

# --- the pin ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize(("name", "build", "sense"), [("pin N", pin_normal, -1.0), ("pin T", pin_shear, 1j)])
def test_pin(kappa, name, build, sense):
    z = RADIUS * np.exp(1j * THETA)
    problem = build(kappa)
    assert np.abs(problem.traction(z, z / RADIUS)).max() < 1e-13
    move, turn, rest = rigid_part(problem.displacement(z) - printed(name, THETA, kappa) * np.exp(1j * THETA), z)
    assert rest < 1e-14
    # 2G times (kappa + 1) M/(4 pi G a^2) with M = -a: the rotation that (3) has and (10) has not
    expected = -(kappa + 1.0) / (2.0 * PI * RADIUS) if build is pin_shear else 0.0
    assert turn == pytest.approx(expected, rel=1e-12, abs=1e-14)
    assert move == pytest.approx(sense * (1.0 + kappa * math.log(RADIUS)) / (PI * (1.0 + kappa)), abs=1e-14)


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_datum_of_the_pins_rotation(kappa):
    # with (10) the mean rotation of the circle r is [(kappa + 1) - a^2/r^2] T/(4 pi G a)
    angle = (np.arange(400) + 0.5) * 2.0 * PI / 400
    problem = pin_shear(kappa)
    datum = (kappa + 1.0) / (2.0 * PI * RADIUS)  # gives back the rotation that (10) leaves out
    for share in (0.3, 0.598, 1.0 / math.sqrt(kappa + 1.0), 0.9):
        r = share * RADIUS
        z = r * np.exp(1j * angle)
        field = problem.displacement(z) + 1j * datum * z
        mean = np.mean(np.imag(field * np.exp(-1j * angle))) / r
        assert mean == pytest.approx((kappa + 1.0 - 1.0 / share**2) / (2.0 * PI * RADIUS), abs=1e-12)
    assert np.sqrt(1.0 / 2.8) == pytest.approx(0.598, abs=5e-4)  # nu = 0.3 in plane strain


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_pin_body_force(kappa):
    z = RADIUS * np.exp(1j * THETA)
    problem = pin_body(kappa)
    assert np.abs(problem.traction(z, z / RADIUS)).max() < 1e-14
    # the ring between a small circle and the edge: traction on its inner edge + its body force = 0
    angle, small = (np.arange(2000) + 0.5) * 2.0 * PI / 2000, 0.2
    normal = np.exp(1j * angle)
    inner = np.sum(problem.traction(small * normal, -normal)) * small * 2.0 * PI / 2000
    assert inner == pytest.approx(-problem.body * PI * (RADIUS**2 - small**2), abs=1e-12)
    move, turn, rest = rigid_part(problem.displacement(z) - printed("body N", THETA, kappa) * np.exp(1j * THETA), z)
    assert rest < 1e-14
    assert turn == pytest.approx(0.0, abs=1e-14)
    assert move.imag == pytest.approx(0.0, abs=1e-14)
    # (55) is (54) turned by a quarter: a force T along +y at theta = 0 is -N turned by -pi/2
    turned = printed("body N", THETA + PI / 2.0, kappa)
    np.testing.assert_allclose(printed("body T", THETA, kappa), turned, atol=1e-15)


@pytest.mark.parametrize(
    ("build", "load", "centre"), [(pin_normal, -1.0, 1.0), (pin_shear, 1j, -1j)], ids=["normal", "tangential"]
)
def test_resultants_in_the_pin(build, load, centre):
    problem = build(1.8)
    # a small disc at the centre is pulled by the rest with minus the force at the centre
    angle = (np.arange(2000) + 0.5) * 2.0 * PI / 2000
    for r in (0.2, 0.7):
        normal = np.exp(1j * angle)
        pull = problem.traction(r * normal, normal) * r * 2.0 * PI / 2000
        assert np.sum(pull) == pytest.approx(-centre, abs=1e-12)
        couple = np.sum(np.imag(np.conj(r * normal) * pull))
        assert couple == pytest.approx(RADIUS if build is pin_shear else 0.0, abs=1e-12)
    assert edge_force(problem, inside=True) == pytest.approx(load, abs=1e-10)


# --- the plate --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize(("name", "force"), [("plate N", 1.0), ("plate T", -1j)])
def test_plate(kappa, name, force):
    # N pushes the edge outwards (+x at theta = 0); T is clockwise positive on the plate (-y)
    z = RADIUS * np.exp(1j * THETA)
    problem = plate(kappa, force)
    assert np.abs(problem.traction(z, -z / RADIUS)).max() < 1e-13
    assert edge_force(problem, inside=False) == pytest.approx(force, abs=1e-10)
    # infinity carries the force, with stresses that fall like 1/r
    angle = (np.arange(4000) + 0.5) * 2.0 * PI / 4000
    normal = np.exp(1j * angle)
    for r in (3.0, 50.0):
        assert np.sum(problem.traction(r * normal, normal)) * r * 2.0 * PI / 4000 == pytest.approx(-force, abs=1e-12)
    far = [np.abs(problem.traction(r * normal, normal)).max() for r in (1e3, 2e3)]
    assert math.log2(far[0] / far[1]) == pytest.approx(1.0, abs=1e-2)
    move, turn, rest = rigid_part(problem.displacement(z) - printed(name, THETA, kappa) * np.exp(1j * THETA), z)
    assert rest < 1e-14
    assert turn == pytest.approx(0.0, abs=1e-14)
    assert move == pytest.approx(-force * kappa * math.log(RADIUS) / (PI * (1.0 + kappa)), abs=1e-14)


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("w", [1.0, 0.5])
def test_kernels_are_plate_minus_pin(pair, w):
    got = displacement_kernels(pair, w, THETA)
    for load, radial, tangential in (("N", 0, 2), ("T", 1, 3)):
        pin = printed(f"pin {load}", THETA, pair.pin_kolosov)
        if w == 0.5:
            pin = pin + printed(f"body {load}", THETA, pair.pin_kolosov)
        hole = printed(f"plate {load}", THETA, pair.plate_kolosov)
        difference = 2.0 * PI * (hole * pair.plate_compliance - pin * pair.pin_compliance)
        np.testing.assert_allclose(got[radial], difference.real, atol=1e-13 * pair.beta_star)
        np.testing.assert_allclose(got[tangential], difference.imag, atol=1e-13 * pair.beta_star)


@pytest.mark.parametrize("pair", PAIRS)
def test_compiled_kernels_are_the_ones_without_resultant_terms(pair):
    ratio = pair.alpha_star / pair.beta_star
    constant = 0.5 * (pair.pin_kolosov + 1.0) * pair.pin_compliance
    for theta in THETA[::7]:
        direct, cross = influence.log_kernels(theta, ratio)
        rN, rT, tN, tT = displacement_kernels(pair, 0.0, np.array([theta]))
        assert direct * pair.beta_star == pytest.approx(rN[0] + constant, rel=1e-12, abs=1e-13 * pair.beta_star)
        assert cross * pair.beta_star == pytest.approx(rT[0], rel=1e-12, abs=1e-13 * pair.beta_star)
        assert cross * pair.beta_star == pytest.approx(tN[0], rel=1e-12, abs=1e-13 * pair.beta_star)
        assert -direct * pair.beta_star == pytest.approx(tT[0], rel=1e-12, abs=1e-13 * pair.beta_star)


@pytest.mark.parametrize("pair", PAIRS)
def test_operator_without_resultant_terms_is_symmetric(pair):
    # gap and slip (18) from (N, T): [[rN, rT], [-tN, -tT]], whose transpose has theta and xi exchanged
    rN, rT, tN, tT = displacement_kernels(pair, 0.0, THETA)
    back_rN, back_rT, _, back_tT = displacement_kernels(pair, 0.0, -THETA)
    np.testing.assert_allclose(rN, back_rN, rtol=1e-13)
    np.testing.assert_allclose(tT, back_tT, rtol=1e-13)
    np.testing.assert_allclose(-tN, back_rT, rtol=1e-13)
    assert np.abs(rT).max() > 0.0
    # the terms of the centre load break the symmetry, so the check can fail
    if pair.pin_compliance > 0.0:
        back_rT = displacement_kernels(pair, 1.0, -THETA)[1]
        assert np.abs(-displacement_kernels(pair, 1.0, THETA)[2] - back_rT).max() > 0.1 * pair.pin_compliance


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("w", [1.0, 0.5])
def test_operator_gives_the_cauchy_kernels(pair, w):
    # [[1, d], [-d, 1]] on (30), (31) against (37), (38), theta != xi
    theta, step = THETA[(np.abs(THETA) > 0.3) & (np.abs(THETA) < 3.0)], 1e-3
    C, S, _, _ = functions(theta)
    rN, rT, tN, tT = displacement_kernels(pair, w, theta)
    shifted = [np.array(displacement_kernels(pair, w, theta + k * step)) for k in (-2, -1, 1, 2)]
    d_rN, d_rT, d_tN, d_tT = (shifted[0] - 8.0 * shifted[1] + 8.0 * shifted[2] - shifted[3]) / (12.0 * step)
    if w == 1.0:
        gamma, gamma_1 = pair.gamma, pair.gamma_prime
    else:
        gamma, gamma_1 = pair.gamma_body, pair.gamma_body_prime
    beta, cot = pair.beta_star, 1.0 / np.tan(theta / 2.0)
    plate_term = 0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance
    close = {"rtol": 0.0, "atol": 1e-8 * beta}
    np.testing.assert_allclose(rN + d_tN, gamma * C + plate_term, **close)
    np.testing.assert_allclose(rT + d_tT, -gamma * S + beta * cot, **close)
    np.testing.assert_allclose(tN - d_rN, -gamma_1 * S + beta * cot, **close)
    np.testing.assert_allclose(tT - d_rT, -gamma_1 * C - beta, **close)


@pytest.mark.parametrize("pair", PAIRS)
def test_jumps_give_the_delta_terms(pair):
    # the kernels' jumps at theta = xi are the factors of delta in (37), (38): -pi alpha* N and +pi alpha* T
    small = 1e-9
    after = displacement_kernels(pair, 1.0, np.array([small]))
    before = displacement_kernels(pair, 1.0, np.array([-small]))
    rN, rT, tN, tT = (float((x - y)[0]) for x, y in zip(after, before, strict=True))
    assert tN == pytest.approx(-PI * pair.alpha_star, abs=1e-6 * pair.beta_star)
    assert -rT == pytest.approx(PI * pair.alpha_star, abs=1e-6 * pair.beta_star)
    assert rN == pytest.approx(0.0, abs=1e-6 * pair.beta_star)
    assert tT == pytest.approx(0.0, abs=1e-6 * pair.beta_star)

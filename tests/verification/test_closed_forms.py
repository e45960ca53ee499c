"""Closed forms: round trips, limits, tabulated values and the equations they solve."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipk, ellipkm1

from fastpin import InputError, Material, MaterialPair
from fastpin.verification import closed_forms
from tests.support.refusals import refused

PERSSON = [  # L_p, half-angle in degrees, N(0) R/F
    (1e-4, 84.7941, 0.599701),
    (0.01, 81.6559, 0.607095),
    (0.1, 64.0091, 0.683229),
    (0.25, 50.4236, 0.805947),
    (1.0, 29.9089, 1.263840),
    (2.0, 21.9437, 1.693810),
]


@pytest.mark.parametrize(("load_parameter", "degrees", "peak"), PERSSON)
def test_persson_table(load_parameter, degrees, peak):
    half_angle = closed_forms.persson_half_angle(load_parameter)
    assert math.degrees(half_angle) == pytest.approx(degrees, abs=6e-5)
    assert closed_forms.persson_pressure(0.0, half_angle) == pytest.approx(peak, abs=6e-7)


def test_persson_neat_fit():
    half_angle = closed_forms.persson_half_angle(0.0)
    assert math.tan(half_angle / 2.0) == pytest.approx(0.9135727916, abs=1e-10)
    assert math.degrees(half_angle) == pytest.approx(84.8279456, abs=1e-7)
    assert closed_forms.persson_load_parameter(half_angle) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("mismatch", [-1.0, -0.6, -0.25, 0.0, 0.3, 0.9, 1.0])
def test_persson_round_trip(mismatch):
    load_parameter = np.concatenate([np.geomspace(1e-6, 1e4, 61), [1e-12, 1e8]])
    half_angle = closed_forms.persson_half_angle(load_parameter, mismatch)
    back = closed_forms.persson_load_parameter(half_angle, mismatch)
    # relative where L_p is large; where it is small, to the conditioning of half-angles in double precision
    np.testing.assert_allclose(back, load_parameter, rtol=3e-14 if mismatch < 1.0 else 1e-9, atol=3e-16)


def test_persson_half_angle_falls_with_the_load_parameter_and_grows_with_mismatch():
    load_parameter = np.concatenate([[-0.05, -1e-3, 0.0], np.geomspace(1e-6, 1e4, 200)])
    half_angle = closed_forms.persson_half_angle(load_parameter)
    assert np.all(np.diff(half_angle) < 0.0)
    assert half_angle[0] > math.radians(84.9)  # interference, yet not all round
    assert np.all(np.diff(closed_forms.persson_half_angle(0.1, np.linspace(-1.0, 1.0, 21))) > 0.0)


@pytest.mark.parametrize("mismatch", [-0.5, 0.0, 0.6])
def test_contact_closes_round_the_pin_at_the_limit(mismatch):
    limit = (mismatch - 1.0) / (4.0 * math.pi)
    assert closed_forms.persson_half_angle(limit + 1e-8, mismatch) == pytest.approx(math.pi, abs=1e-2)
    with pytest.raises(InputError, match="all round"):
        closed_forms.persson_half_angle(limit - 1e-8, mismatch)


def test_persson_of_like_bodies_is_its_own_formula():
    half_angle = np.linspace(0.1, 3.0, 30)
    b = np.tan(half_angle / 2.0)
    persson = (2.0 - np.log(b**2 + 1.0) - 2.0 * b**4) / (8.0 * np.pi * b**2 * (b**2 + 1.0))
    np.testing.assert_allclose(closed_forms.persson_load_parameter(half_angle), persson, rtol=1e-12)


@pytest.mark.parametrize("half_angle", [0.02, 0.8, 1.48, 2.4])
def test_persson_pressure_carries_the_load(half_angle):
    force, _ = quad(
        lambda t: 2.0 * half_angle * t * closed_forms.persson_pressure(half_angle * (1.0 - t * t), half_angle)
        * 2.0 * math.cos(half_angle * (1.0 - t * t)),
        0.0, 1.0, epsabs=1e-13, epsrel=1e-12,
    )  # fmt: skip
    assert force == pytest.approx(1.0, abs=1e-11)


def test_persson_pressure_against_its_printed_form():
    half_angle = 1.1
    phi = np.linspace(-1.0999, 1.0999, 41)
    b, y = math.tan(half_angle / 2.0), np.tan(phi / 2.0)
    r, q = np.sqrt(b**2 - y**2), math.sqrt(b**2 + 1.0)
    printed = 2.0 / np.pi * r / (q * (1.0 + y**2)) + np.log((q + r) / (q - r)) / (2.0 * np.pi * b**2 * (b**2 + 1.0))
    np.testing.assert_allclose(closed_forms.persson_pressure(phi, half_angle), printed, rtol=1e-12)
    assert np.all(closed_forms.persson_pressure([-math.pi, -1.2, 1.1, 2.0, math.pi], half_angle) == 0.0)


@pytest.mark.parametrize("mismatch", [-0.7, 0.0, 0.4])
def test_persson_solves_the_equation_of_frictionless_contact(mismatch):
    # (58) with mu = 0, alpha* = 0 and kappa'/(G beta*) = (1 - a)/2, at several places of the contact
    half_angle = 1.3
    n = 4000
    s = np.cos((np.arange(n) + 0.5) * np.pi / n)  # N is sqrt(1 - s^2) times a smooth function of phi = half_angle s
    phi = half_angle * s
    area = half_angle * np.pi / n * np.sqrt(1.0 - s**2)
    pressure = closed_forms.persson_pressure(phi, half_angle)
    # int cot((theta - xi)/2) N' dxi: the derivative of int cot((theta - xi)/2) N dxi, with N = (N/root) root
    k = np.arange(1, n + 1) * np.pi / (n + 1)
    node = half_angle * np.cos(k)
    weight = half_angle * np.pi / (n + 1) * np.sin(k) * closed_forms.persson_pressure(node, half_angle)

    def cauchy(theta):  # theta midway between the nodes: Gauss-Chebyshev quadrature is exact for principal values
        return np.sum(weight / np.tan((theta - node) / 2.0))

    total, step = [], np.pi / (n + 1)
    for m in (n // 8, n // 3, n // 2, 3 * n // 4):
        left, right = half_angle * np.cos((m + 1.5) * step), half_angle * np.cos((m + 0.5) * step)
        slope = (cauchy(right) - cauchy(left)) / (right - left)
        middle = 0.5 * (left + right)
        total.append(
            0.5 * (1.0 - mismatch) * np.sum(area * pressure)
            + 2.0 * np.sum(area * pressure * np.cos(middle - phi))
            - slope
        )
    expected = -4.0 * math.pi * closed_forms.persson_load_parameter(half_angle, mismatch)
    np.testing.assert_allclose(total, expected, atol=2e-5)


def test_mismatch_is_the_papers_first_dundurs_parameter():
    pin, plate = Material(116e9, 0.32), Material(69e9, 0.33)
    pair = MaterialPair(pin, plate)
    stiff_pin, stiff_plate = 116e9 / (1.0 - 0.32**2), 69e9 / (1.0 - 0.33**2)
    a = (stiff_plate - stiff_pin) / (stiff_plate + stiff_pin)
    assert pair.dundurs("paper")[0] == pytest.approx(a, rel=1e-12)


def test_hertz_is_the_limit_of_persson():
    for load_parameter, tolerance in ((1e2, 2e-3), (1e4, 2e-5), (1e6, 2e-7)):
        half_angle = closed_forms.persson_half_angle(load_parameter)
        assert closed_forms.hertz_half_angle(load_parameter) == pytest.approx(half_angle, rel=tolerance)
        peak = closed_forms.persson_pressure(0.0, half_angle)
        assert closed_forms.hertz_peak_pressure(load_parameter) == pytest.approx(peak, rel=tolerance)
    # p0 = 2 F/(pi a)
    assert closed_forms.hertz_peak_pressure(3.0) * closed_forms.hertz_half_angle(3.0) == pytest.approx(2.0 / math.pi)


def force(shear, a):
    """Integral over the contact, by Gauss-Chebyshev panels fine enough for the kinks."""
    angle = (np.arange(20000) + 0.5) * np.pi / 20000
    return np.sum(shear(a * np.cos(angle)) * a * np.sin(angle)) * np.pi / 20000


@pytest.mark.parametrize("load_ratio", [0.0, 0.3, 0.75, 1.0])
def test_cattaneo_mindlin_loading(load_ratio):
    a, p0, mu = 0.2, 3.0, 0.4
    full = mu * math.pi * a * p0 / 2.0

    def shear(x):
        return closed_forms.cattaneo_mindlin_shear(x, a, p0, mu, load_ratio)

    assert force(shear, a) == pytest.approx(load_ratio * full, abs=1e-6 * full)
    c = a * closed_forms.cattaneo_mindlin_stick_ratio(load_ratio)
    x = np.linspace(-a, a, 401)
    limit = mu * p0 * np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
    slipping = np.abs(x) > c
    np.testing.assert_allclose(shear(x)[slipping], limit[slipping], atol=1e-14)
    assert np.all(shear(x)[~slipping] <= limit[~slipping])
    assert shear(1.01 * a) == 0.0


@pytest.mark.parametrize("branch", ["unloading", "reloading"])
def test_cattaneo_mindlin_cycle(branch):
    a, p0, mu, peak = 0.2, 3.0, 0.4, 0.7
    full = mu * math.pi * a * p0 / 2.0
    x = np.linspace(-a, a, 301)
    first = closed_forms.cattaneo_mindlin_shear(x, a, p0, mu, peak)
    sign = 1.0 if branch == "unloading" else -1.0
    for now in (0.7, 0.2, -0.5, -0.7):

        def shear(y, now=now):
            return closed_forms.cattaneo_mindlin_shear(y, a, p0, mu, now, peak, branch)

        assert force(shear, a) == pytest.approx(now * full, abs=1e-6 * full)
        limit = mu * p0 * np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
        assert np.all(np.abs(shear(x)) <= limit + 1e-12)
    # at a turning point the two branches meet, and complete reversal mirrors the first loading
    np.testing.assert_allclose(
        closed_forms.cattaneo_mindlin_shear(x, a, p0, mu, sign * peak, peak, branch), sign * first, atol=1e-12
    )
    np.testing.assert_allclose(
        closed_forms.cattaneo_mindlin_shear(x, a, p0, mu, -sign * peak, peak, branch), -sign * first, atol=1e-12
    )


def test_bulk_stress_shifts_the_stick_zone():
    a, p0, mu, ratio = 1.0, 2.0, 0.5, 0.6
    e = closed_forms.bulk_stress_eccentricity(0.4, a, p0, mu, ratio)
    assert e == pytest.approx(0.1)
    c = a * math.sqrt(1.0 - ratio)
    x = np.array([-e - c, -e - 0.99 * c, -e, -e + 0.99 * c, -e + c])
    shear = closed_forms.cattaneo_mindlin_shear(x, a, p0, mu, ratio, eccentricity=e)
    limit = mu * p0 * np.sqrt(1.0 - x**2)
    np.testing.assert_allclose(shear[[0, -1]], limit[[0, -1]], rtol=1e-12)
    assert np.all(shear[1:-1] < limit[1:-1])
    # no strain mismatch on the stick zone: PV int q(s)/(x - s) ds = -pi sigma/4 for like half-planes
    for place in (-e - 0.8 * c, -e, -e + 0.5 * c):
        value = 0.0
        for left, right in ((-a, -e - c), (-e - c, -e + c), (-e + c, a)):
            weight = {"weight": "cauchy", "wvar": place} if left < place < right else {}

            def integrand(s, kernel=not weight, place=place):
                shear = closed_forms.cattaneo_mindlin_shear(s, a, p0, mu, ratio, eccentricity=e)
                return shear / (s - place) if kernel else shear

            value -= quad(integrand, left, right, epsabs=1e-9, limit=200, **weight)[0]
        assert value == pytest.approx(-math.pi * 0.4 / 4.0, abs=1e-5)
    with pytest.raises(InputError, match="bulk_stress"):
        closed_forms.bulk_stress_eccentricity(2.0, a, p0, mu, ratio)


@pytest.mark.parametrize(
    ("ratio", "stick"), [(0.2, 0.001553), (1 / 3, 0.035922), (0.5, 0.171573), (1.0, 0.707107), (2.0, 0.985171)]
)
def test_spence_table(ratio, stick):
    assert closed_forms.spence_stick_ratio(ratio) == pytest.approx(stick, abs=6e-7)


def test_spence_solves_the_equation_of_elliptic_integrals():
    for ratio in np.geomspace(0.05, 8.0, 40):
        k = closed_forms.spence_stick_ratio(ratio)
        assert ellipk(k * k) / ellipkm1(k * k) == pytest.approx(ratio, rel=1e-9 if ratio < 2.0 else 2e-4)
    # k(1/r) is the complementary modulus of k(r)
    r = np.array([0.5, 0.9, 1.0, 1.4])
    np.testing.assert_allclose(
        closed_forms.spence_stick_ratio(r) ** 2 + closed_forms.spence_stick_ratio(1.0 / r) ** 2, 1.0
    )
    assert closed_forms.spence_stick_ratio(0.0) == 0.0
    assert closed_forms.spence_stick_ratio(math.inf) == 1.0
    assert closed_forms.spence_stick_ratio(0.5) == pytest.approx(3.0 - 2.0 * math.sqrt(2.0), rel=1e-14)


def flamant(x, depth, pressure, shear, kinks):
    """Stresses (s_xx, s_zz, s_xz) of a half-plane under tractions on (-1, 1), as an integral of line loads.

    A line load has the radial stress -(2/pi) (P cos + Q sin)/r alone (Flamant). With s = sin(angle) the tractions are
    smooth at their ends.
    """

    def part(angle, component):
        s = math.sin(angle)
        away, square = x - s, (x - s) ** 2 + depth**2
        radial = -2.0 / math.pi * (pressure(s) * depth + shear(s) * away) / square**2
        return radial * (away * away, depth * depth, away * depth)[component] * math.cos(angle)

    breaks = sorted(math.asin(place) for place in {-1.0, 1.0, *kinks, *([x] if abs(x) < 1.0 else [])})
    options = {"epsabs": 1e-13, "epsrel": 1e-12, "limit": 200}
    return [
        sum(quad(part, low, high, (component,), **options)[0] for low, high in itertools.pairwise(breaks))
        for component in range(3)
    ]


PLACES = [(0.3, 0.2), (-0.7, 0.05), (1.4, 0.3), (-1.01, 0.5), (0.0, 0.7), (2.0, 1.0), (-5.0, 3.0)]


@pytest.mark.parametrize(("x", "depth"), PLACES)
def test_stress_under_ellipses_is_flamants_integral(x, depth):
    def ellipse(s):
        return math.sqrt((1.0 - s) * (1.0 + s))

    def nothing(_):
        return 0.0

    for p0, q0, tractions in ((1.0, 0.0, (ellipse, nothing)), (0.0, 1.0, (nothing, ellipse))):
        expected = flamant(x, depth, *tractions, ())
        assert closed_forms.elliptic_stress(x, depth, 1.0, p0, q0) == pytest.approx(expected, abs=2e-12)
        scaled = closed_forms.elliptic_stress(0.01 * x, 0.01 * depth, 0.01, 3.0 * p0, 3.0 * q0)
        assert scaled == pytest.approx(3.0 * np.array(expected), abs=6e-12)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("now", "branch", "kink"), [(0.6, "loading", 0.4), (-0.2, "unloading", 0.6), (0.1, "reloading", 0.65)]
)
def test_stress_in_partial_slip_is_flamants_integral(now, branch, kink):
    """`kink` is 1 - Q/(mu P) of the latest border, and 0.4 that of the first load."""

    def pressure(s):
        return 2.0 * math.sqrt((1.0 - s) * (1.0 + s))

    def shear(s):
        return closed_forms.cattaneo_mindlin_shear(s, 1.0, 2.0, 0.3, now, 0.6, branch)

    borders = [sign * math.sqrt(share) for share in {kink, 0.4} for sign in (-1.0, 1.0)]
    for x, depth in PLACES:
        found = closed_forms.cattaneo_mindlin_stress(x, depth, 1.0, 2.0, 0.3, now, 0.6, branch)
        assert found == pytest.approx(flamant(x, depth, pressure, shear, borders), abs=5e-12)


def test_stress_on_the_surface_of_the_half_plane():
    x = np.linspace(-1.5, 1.5, 61)
    inside = np.abs(x) <= 1.0
    for ratio in (0.0, 0.3, 1.0):
        along, across, shear = closed_forms.cattaneo_mindlin_stress(x, 0.0, 1.0, 2.0, 0.3, ratio)
        assert across == pytest.approx(-2.0 * np.sqrt(np.maximum(1.0 - x**2, 0.0)), abs=1e-14)
        assert shear == pytest.approx(-closed_forms.cattaneo_mindlin_shear(x, 1.0, 2.0, 0.3, ratio), abs=1e-14)
        ends = closed_forms.cattaneo_mindlin_stress([-1.0, 1.0], 0.0, 1.0, 2.0, 0.3, ratio)[0]
        peak = 2.0 * 2.0 * 0.3 * math.sqrt(ratio)
        assert ends == pytest.approx([peak, -peak], abs=1e-14)
        if ratio == 1.0:
            assert along[inside] == pytest.approx(-2.0 * np.sqrt(1.0 - x[inside] ** 2) - 1.2 * x[inside], abs=1e-14)


def test_largest_shear_below_a_hertz_contact():
    """Johnson's 0.30 p0 at 0.78 a."""
    depth = np.linspace(0.0, 2.0, 20001)
    along, across, shear = closed_forms.elliptic_stress(0.0, depth, 1.0, 1.0)
    largest = 0.5 * np.abs(along - across)
    assert np.all(shear == 0.0)
    assert largest.max() == pytest.approx(0.300283, abs=1e-6)
    assert depth[np.argmax(largest)] == pytest.approx(0.78615, abs=1e-4)


def test_kirsch_stress_is_free_on_the_edge_remote_far_away_and_at_rest_between():
    theta, remote = np.linspace(-3.0, 3.0, 13), (1.0, -0.4, 0.3)
    radial, hoop, shear = closed_forms.kirsch_stress(1.0, theta, *remote)
    assert np.abs([radial, shear]).max() < 1e-15
    assert closed_forms.kirsch_stress(1.0, [0.0, 0.5 * np.pi], 1.0, 0.0, 0.0)[1] == pytest.approx([-1.0, 3.0])
    assert closed_forms.kirsch_stress(1.0, 0.25 * np.pi, 0.0, 0.0, 1.0)[1] == pytest.approx(-4.0)
    radial, hoop, shear = closed_forms.kirsch_stress(1e9, theta, *remote)
    cos, sin = np.cos(theta), np.sin(theta)
    assert radial == pytest.approx(cos**2 - 0.4 * sin**2 + 0.6 * cos * sin, abs=1e-14)
    assert hoop == pytest.approx(sin**2 - 0.4 * cos**2 - 0.6 * cos * sin, abs=1e-14)
    assert shear == pytest.approx(-1.4 * cos * sin + 0.3 * (cos**2 - sin**2), abs=1e-14)
    r, h = np.linspace(1.1, 3.0, 13), 1e-4

    def at(radius, angle):
        return closed_forms.kirsch_stress(radius, angle, *remote)

    by_radius, by_angle = (
        (at(r + h, theta) - at(r - h, theta)) / (2 * h),
        (at(r, theta + h) - at(r, theta - h)) / (2 * h),
    )
    radial, hoop, shear = at(r, theta)
    assert by_radius[0] + (by_angle[2] + radial - hoop) / r == pytest.approx(0.0, abs=1e-6)
    assert by_radius[2] + (by_angle[1] + 2.0 * shear) / r == pytest.approx(0.0, abs=1e-6)
    trace = (at(r + h, theta) + at(r - h, theta) - 2.0 * at(r, theta))[:2].sum(axis=0) / h**2
    trace += by_radius[:2].sum(axis=0) / r
    trace += (at(r, theta + h) + at(r, theta - h) - 2.0 * at(r, theta))[:2].sum(axis=0) / (h * r) ** 2
    assert trace == pytest.approx(0.0, abs=2e-6)


@pytest.mark.parametrize(
    ("field", "call"),
    [
        ("half_angle", lambda: closed_forms.persson_load_parameter(0.0)),
        ("half_angle", lambda: closed_forms.persson_load_parameter([0.5, 4.0])),
        ("mismatch", lambda: closed_forms.persson_load_parameter(0.5, 1.5)),
        ("load_parameter", lambda: closed_forms.persson_half_angle(-1.0)),
        ("load_parameter", lambda: closed_forms.persson_half_angle(0.0, 1.0)),
        ("load_parameter", lambda: closed_forms.persson_half_angle(math.nan)),
        ("load_parameter", lambda: closed_forms.persson_half_angle("much")),
        ("phi", lambda: closed_forms.persson_pressure(4.0, 1.0)),
        ("half_angle", lambda: closed_forms.persson_pressure(0.0, -1.0)),
        ("load_parameter", lambda: closed_forms.hertz_half_angle(0.0)),
        ("load_parameter", lambda: closed_forms.hertz_peak_pressure(-1.0)),
        ("load_ratio", lambda: closed_forms.cattaneo_mindlin_stick_ratio(1.1)),
        ("load_ratio", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 1.0, 1.0, 0.3, -0.5)),
        ("half_width", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 0.0, 1.0, 0.3, 0.5)),
        ("peak_ratio", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 1.0, 1.0, 0.3, 0.5, branch="unloading")),
        ("load_ratio", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 1.0, 1.0, 0.3, 0.5, 0.4, "unloading")),
        ("branch", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 1.0, 1.0, 0.3, 0.5, branch="sideways")),
        ("eccentricity", lambda: closed_forms.cattaneo_mindlin_shear(0.0, 1.0, 1.0, 0.3, 0.1, eccentricity=0.5)),
        ("friction", lambda: closed_forms.bulk_stress_eccentricity(0.1, 1.0, 1.0, 0.0)),
        ("mu_over_beta", lambda: closed_forms.spence_stick_ratio(-0.1)),
        ("depth", lambda: closed_forms.elliptic_stress(0.0, -0.1, 1.0, 1.0)),
        ("half_width", lambda: closed_forms.elliptic_stress(0.0, 0.1, 0.0, 1.0)),
        ("shear", lambda: closed_forms.elliptic_stress(0.0, 0.1, 1.0, 1.0, math.nan)),
        ("peak_ratio", lambda: closed_forms.cattaneo_mindlin_stress(0.0, 0.1, 1.0, 1.0, 0.3, 0.5, branch="reloading")),
        ("radius", lambda: closed_forms.kirsch_stress([2.0, 0.9], 0.0, 1.0, 0.0, 0.0)),
    ],
)
def test_bad_input_names_the_argument(field, call):
    assert refused(call).field == field

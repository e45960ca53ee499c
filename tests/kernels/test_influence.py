"""The compiled kernels: compiled, as plain Python, and against naive quadrature written independently."""

import math
from collections.abc import Callable
from itertools import pairwise

import mpmath
import numpy as np
import pytest

from fastpin.kernels import influence
from fastpin.model.grid import Grid
from tests.support.integrals import log_integrals
from tests.support.kernels import python
from tests.support.tiers import gate

RATIO = 0.31
POINT, WEIGHT = np.polynomial.legendre.leggauss(16)
FINE_POINT, FINE_WEIGHT = np.polynomial.legendre.leggauss(60)

SHARE = np.concatenate([[0.0], 0.5 * 0.2 ** np.arange(24, -1, -1.0)])
SHARE = np.concatenate([SHARE, 1.0 - SHARE[-2::-1]])
PANEL = np.diff(SHARE)
PLACES = SHARE[:-1, None] + 0.5 * PANEL[:, None] * (1.0 + POINT)
"""Points of an interval of length 1 in Gauss panels that shrink towards both ends, shape (panels, points)."""

Kernel = Callable[[np.ndarray], np.ndarray]


# --- the naive version ------------------------------------------------------------------------------------


def sawtooth(x: np.ndarray) -> np.ndarray:
    """A, from its definition on one turn and periodicity."""
    return np.mod(x, 2.0 * np.pi) / 2.0 - np.pi / 2.0


def logarithm(x: np.ndarray) -> np.ndarray:
    return np.log(4.0 * np.sin(x / 2.0) ** 2)


def direct_kernel(x: np.ndarray) -> np.ndarray:
    return RATIO * np.sin(x) * sawtooth(x) - np.cos(x) * logarithm(x)


def cross_kernel(x: np.ndarray) -> np.ndarray:
    return RATIO * np.cos(x) * sawtooth(x) + np.sin(x) * logarithm(x)


def graded(function: Kernel, start: float, stop: float) -> float:
    """int function over [start, stop]; Gauss panels that shrink towards both ends."""
    width = stop - start
    return float(0.5 * width * PANEL @ (function(start + width * PLACES) @ WEIGHT))


def naive_hat(kernel: Kernel, u: float, h_left: float, h_right: float) -> float:
    """int hat kernel(theta - xi) dxi, in x = theta - xi, cut at the node and at the multiples of 2 pi."""
    total = 0.0
    for side, h in ((1.0, h_right), (-1.0, h_left)):
        cuts = [2.0 * math.pi * m for m in range(-3, 4)]
        inner = sorted(t for t in (side * (u - cut) for cut in cuts) if 1e-14 < t < h * (1.0 - 1e-12))
        ends = [0.0, *inner, h]
        if h > 0.0:
            for a, b in pairwise(ends):
                # distances are taken from the near end of each piece, where the singularity may be
                middle = 0.5 * (a + b)
                for edge, far, sign in ((a, middle, 1.0), (b, middle, -1.0)):
                    corner = u - side * edge
                    nearest = 2.0 * math.pi * round(corner / (2.0 * math.pi))
                    corner = 0.0 if abs(corner - nearest) < 1e-13 else corner

                    def integrand(t, edge=edge, sign=sign, corner=corner, h=h, side=side):
                        return kernel(corner - side * sign * t) * (1.0 - (edge + sign * t) / h)

                    total += graded(integrand, 0.0, abs(far - edge))
    return total


def naive_cauchy(u: float, h_left: float, h_right: float) -> float:
    """Principal value: values at equal distances on both sides of theta are paired first."""

    def hat(y: np.ndarray) -> np.ndarray:  # y = xi - node
        y = np.mod(y + np.pi, 2.0 * np.pi) - np.pi
        falling = np.where((y >= 0.0) & (y < h_right), 1.0 - y / (h_right or 1.0), 0.0)
        rising = np.where((y < 0.0) & (y > -h_left), 1.0 + y / (h_left or 1.0), 0.0)
        return falling + rising

    u = math.remainder(u, 2.0 * math.pi)
    kinks = [abs(math.remainder(u - knot, 2.0 * math.pi)) for knot in (-h_left, 0.0, h_right)]
    ends = [0.0, *sorted({k for k in kinks if 1e-12 < k < math.pi - 1e-12}), math.pi]
    total = 0.0
    for a, b in pairwise(ends):
        x = a + 0.5 * (b - a) * (1.0 + FINE_POINT)
        weight = 0.5 * (b - a) * FINE_WEIGHT
        total += float(np.dot(weight, (hat(u - x) - hat(u + x)) / np.tan(x / 2.0)))
    return total


def graded_nodes(n: int, start: float, stop: float) -> np.ndarray:
    """Nodes whose spacing varies smoothly by a factor of about 20."""
    t = np.linspace(0.0, 1.0, n)
    return start + (stop - start) * (t - 0.9 / (2.0 * np.pi) * np.sin(2.0 * np.pi * t))


def matrices(grid: Grid, uniform: bool) -> tuple[np.ndarray, np.ndarray]:
    return log_integrals(grid, uniform, RATIO)


def operator(grid: Grid, uniform: bool, uniform_part: float) -> np.ndarray:
    left, right = grid.knots()
    out = np.full((2 * grid.size, 2 * grid.size), np.nan, order="F")
    influence.fill_operator(grid.theta, left, right, uniform, grid.closed, RATIO, uniform_part, out)
    return out


def cauchy(grid: Grid, uniform: bool) -> np.ndarray:
    left, right = grid.knots()
    out = np.empty((grid.size, grid.size))
    influence.fill_cauchy(grid.theta, left, right, uniform, grid.closed, out)
    return out


# --- Clausen's function -----------------------------------------------------------------------------------


@pytest.mark.parametrize("call", [*gate(influence.clausen), python(influence.clausen)], ids=["compiled", "python"])
def test_clausen_against_mpmath(call):
    points = [0.0, 1e-300, 1e-9, 0.3, 1.999, 2.001, math.pi, 3.5, 6.28, 6.3, 20.0, 1000.0]
    for x in [*points, *(-p for p in points), *np.linspace(-7.0, 7.0, 80)]:
        assert call(x) == pytest.approx(float(mpmath.clsin(2, mpmath.mpf(x))), abs=1e-15)


# --- kernels and antiderivatives --------------------------------------------------------------------------


@pytest.mark.parametrize("call", [influence.log_kernels, python(influence.log_kernels)], ids=["compiled", "python"])
def test_log_kernels_against_their_definition(call):
    for x in (-7.0, -4.0, -1e-3, 1e-6, 0.4, 2.0, 3.2, 6.2, 6.4, 9.0):
        one = np.array([x])
        assert call(x, RATIO) == pytest.approx((direct_kernel(one)[0], cross_kernel(one)[0]), rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("call", [influence.log_antiderivatives, python(influence.log_antiderivatives)])
def test_antiderivatives_differentiate_to_the_kernels(call):
    step = 1e-3
    fine = np.array([-2.0, -1.0, 1.0, 2.0])
    coefficient = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * step)
    for x in (-8.0, -5.0, -2.0, -0.3, 0.2, 1.0, 3.1, 4.0, 5.9, 7.0):
        around = np.array([call(x + step * k, RATIO) for k in fine])
        rate = coefficient @ around
        here = call(x, RATIO)
        direct, cross = influence.log_kernels(x, RATIO)
        assert (rate[0], rate[2]) == pytest.approx((direct, cross), abs=2e-8)
        assert (rate[1], rate[3]) == pytest.approx((here[0], here[2]), abs=2e-8)


def test_antiderivatives_are_continuous_at_full_turns():
    for point in (-2.0 * math.pi, 0.0, 2.0 * math.pi):
        below = np.array(influence.log_antiderivatives(point - 1e-9, RATIO))
        above = np.array(influence.log_antiderivatives(point + 1e-9, RATIO))
        assert np.abs(above - below).max() < 2e-7
    assert influence.log_antiderivatives(0.0, RATIO) == (0.0, 0.0, 0.0, 0.0)


# --- hat integrals ----------------------------------------------------------------------------------------

HATS = [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (1.0, 0.3), (0.05, 1.0)]


@pytest.mark.parametrize("n", [20, 240, 4096])
@pytest.mark.parametrize("shape", HATS)
def test_hat_log_against_graded_quadrature(n, shape):
    h = 2.0 * math.pi / n
    h_left, h_right = shape[0] * h, shape[1] * h
    offsets = np.unique(np.concatenate([np.arange(-10, 11), [0.37, -2.5, 7.9, 8.3, 9.01], [n // 3, -n // 3, n // 2]]))
    largest = naive_hat(direct_kernel, 0.0, h_left, h_right)
    assert largest > 0.0
    for offset in offsets:
        u = offset * h
        got = influence.hat_log(u, h_left, h_right, RATIO)
        assert got[0] == pytest.approx(naive_hat(direct_kernel, u, h_left, h_right), abs=1e-11 * largest)
        assert got[1] == pytest.approx(naive_hat(cross_kernel, u, h_left, h_right), abs=1e-11 * largest)


def exact_hat(u, h_left, h_right):
    """The direct and the cross integral of a hat with 25 digits."""

    def kernel(x):  # cross + i direct
        saw = (x - 2 * mpmath.pi * mpmath.floor(x / (2 * mpmath.pi))) / 2 - mpmath.pi / 2
        return mpmath.expj(x) * (RATIO * saw - 1j * mpmath.log(4 * mpmath.sin(x / 2) ** 2))

    total = mpmath.mpc(0)
    with mpmath.workdps(25):
        for side, width in ((-1, h_left), (1, h_right)):
            if width > 0.0:
                total += mpmath.quad(lambda t, s=side, w=width: kernel(u - s * t) * (1 - t / w), [0, width])
    return float(total.imag), float(total.real)


def test_hat_log_against_mpmath():
    h = 2.0 * math.pi / 400
    for offset in (3, 8.5, 150):
        assert influence.hat_log(offset * h, h, h, RATIO) == pytest.approx(exact_hat(offset * h, h, h), abs=1e-13)


@pytest.mark.parametrize("function", [influence.hat_log, influence.half_hat_log])
def test_plain_python_hats_agree_with_compiled_ones(function):
    widths = (0.01, 0.02) if function is influence.hat_log else (0.02,)
    for u in (-3.0, -0.1, -0.01, 0.0, 0.02, 0.5, math.pi):
        assert python(function)(u, *widths, RATIO) == pytest.approx(function(u, *widths, RATIO), rel=1e-12, abs=1e-15)


def test_hats_wider_than_half_a_turn():
    # a closed ring whose nodes crowd on one side: x leaves (-2 pi, 2 pi)
    for u in (-2.9, -1.0, 0.0, 0.7, 3.0):
        got = influence.hat_log(u, 0.5, 5.5, RATIO)
        assert got[0] == pytest.approx(naive_hat(direct_kernel, u, 0.5, 5.5), abs=1e-10)
        assert got[1] == pytest.approx(naive_hat(cross_kernel, u, 0.5, 5.5), abs=1e-10)


def test_near_and_far_integration_meet():
    h = 2.0 * math.pi / 1000
    border = (influence.NEAR + 1.0) * h
    inside = np.array(influence.half_hat_log(border * (1.0 - 1e-13), h, RATIO))
    outside = np.array(influence.half_hat_log(border * (1.0 + 1e-13), h, RATIO))
    assert np.abs(inside - outside).max() < 1e-13
    inside = influence.half_hat_cauchy(border * (1.0 - 1e-13), h)
    assert inside == pytest.approx(influence.half_hat_cauchy(border * (1.0 + 1e-13), h), abs=2e-12)


@pytest.mark.parametrize("n", [20, 240, 4096])
@pytest.mark.parametrize("shape", HATS)
@pytest.mark.parametrize("node", [0.0, -1.7])
def test_columns_are_hats_seen_from_everywhere(n, shape, node):
    # on both sides of where the series begins, and all round; hat_log is right to 1e-11
    h = 2.0 * math.pi / n
    away = np.concatenate([np.arange(-12.0, 13.0), [0.3, -5.99, 5.99, -6.01, 6.01, n // 3, -n // 3, n // 2 - 0.5]]) * h
    direct, cross = np.empty((2, away.size, 1))
    sides = np.array([shape[0] * h]), np.array([shape[1] * h])
    influence.log_columns(node + away, np.array([node]), *sides, RATIO, 2.0, direct, cross)
    expected = np.array([influence.hat_log(u, sides[0][0], sides[1][0], RATIO) for u in (node + away) - node])
    assert np.abs(direct[:, 0] - 2.0 * expected[:, 0]).max() < 1e-11 * np.abs(expected).max()
    assert np.abs(cross[:, 0] - 2.0 * expected[:, 1]).max() < 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("shape", HATS)
def test_far_columns_against_mpmath(shape):
    h = 2.0 * math.pi / 400
    sides = np.array([shape[0] * h]), np.array([shape[1] * h])
    away = np.array([6.01, -6.01, 7.5, 9.0, -20.0, 150.0, 199.0]) * h
    direct, cross = np.empty((2, away.size, 1))
    influence.log_columns(away, np.zeros(1), *sides, RATIO, 1.0, direct, cross)
    for u, d, c in zip(away, direct[:, 0], cross[:, 0], strict=True):
        assert (d, c) == pytest.approx(exact_hat(u, sides[0][0], sides[1][0]), abs=1e-15)


@pytest.mark.parametrize("n", [20, 240, 4096])
@pytest.mark.parametrize("shape", HATS)
def test_hat_cauchy_against_paired_quadrature(n, shape):
    h = 2.0 * math.pi / n
    h_left, h_right = shape[0] * h, shape[1] * h
    half = 0.0 in shape
    for offset in (-9, -3, -1, -0.4, 0, 0.6, 1, 2, 8, 9.5, n // 3, n // 2):
        u = offset * h
        got = influence.hat_cauchy(u, h_left, h_right)
        if half and offset == 0:
            assert math.isnan(got)
        else:
            # The quadrature itself has errors of up to 1.01e-11, with 4,096 nodes and the narrowest hat.
            assert got == pytest.approx(naive_cauchy(u, h_left, h_right), abs=2e-11)
            assert python(influence.hat_cauchy)(u, h_left, h_right) == pytest.approx(got, abs=1e-14)


def test_uneven_hat_at_its_own_node_has_a_principal_value():
    # near the node cot(x/2) is 2/x, and PV int hat 2/x dx = 2 ln(h_left/h_right)
    assert influence.hat_cauchy(0.0, 0.01, 0.01) == 0.0
    assert influence.hat_cauchy(0.0, 0.02, 0.01) == pytest.approx(2.0 * math.log(2.0), abs=1e-4)


# --- the matrices -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "grid", [Grid.arc(-3.5, 0.4, 41), Grid.circle(40), Grid.circle(41)], ids=["arc", "even", "odd"]
)
def test_uniform_fill_equals_general_fill(grid):
    for quick, slow in zip(matrices(grid, True), matrices(grid, False), strict=True):
        assert np.abs(quick - slow).max() < 1e-12
    np.testing.assert_allclose(cauchy(grid, True), cauchy(grid, False), rtol=0.0, atol=2e-12, equal_nan=True)


@pytest.mark.parametrize(
    "grid",
    [
        Grid.arc(-2.5, 0.4, 23),
        Grid.circle(24),
        Grid(graded_nodes(25, -3.0, 0.0)),
        Grid(graded_nodes(25, -3.0, 3.0), True),
    ],
    ids=["arc", "circle", "graded arc", "graded circle"],
)
def test_fills_against_naive_quadrature(grid):
    left, right = grid.knots()
    uniform = np.ptp(np.diff(grid.theta)) < 1e-9
    direct, cross = matrices(grid, uniform)
    pv = cauchy(grid, uniform)
    for i in range(0, grid.size, 4):
        scale = np.abs(direct[i]).max()
        for j in range(grid.size):
            u, a, b = grid.theta[i] - grid.theta[j], grid.theta[j] - left[j], right[j] - grid.theta[j]
            assert direct[i, j] == pytest.approx(naive_hat(direct_kernel, u, a, b), abs=1e-10 * scale)
            assert cross[i, j] == pytest.approx(naive_hat(cross_kernel, u, a, b), abs=1e-10 * scale)
            if i != j:
                assert pv[i, j] == pytest.approx(naive_cauchy(u, a, b), abs=1e-10)


@pytest.mark.parametrize("grid", [Grid.arc(-2.5, 0.4, 12), Grid.circle(12), Grid(graded_nodes(12, -3.0, 0.0))])
@pytest.mark.parametrize("uniform", [True, False])
def test_plain_python_fills_agree_with_compiled_ones(grid, uniform, monkeypatch):
    if uniform and np.ptp(np.diff(grid.theta)) > 1e-9:
        uniform = False
    compiled = *matrices(grid, uniform), operator(grid, uniform, 0.7)
    pv = cauchy(grid, uniform)
    for name in ("_columns", "cauchy_columns"):
        monkeypatch.setattr(influence, name, python(getattr(influence, name)))
    plain = *matrices(grid, uniform), operator(grid, uniform, 0.7)
    for one, other in zip(plain, compiled, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(cauchy(grid, uniform), pv, rtol=0.0, atol=1e-13, equal_nan=True)


@pytest.mark.parametrize(
    ("grid", "uniform"),
    [
        (Grid.arc(-2.5, 0.4, 13), True),
        (Grid.arc(-2.5, 0.4, 13), False),
        (Grid.circle(12), True),
        (Grid.circle(13), True),
        (Grid(graded_nodes(12, -3.0, 0.0)), False),
        (Grid(graded_nodes(12, -3.0, 3.0), True), False),
    ],
)
def test_operator_is_made_of_the_matrices(grid, uniform):
    direct, cross = matrices(grid, uniform)
    found = operator(grid, uniform, 0.7)
    expected = np.block([[direct - 0.7 * grid.weights, cross], [-cross, direct]]) / (4.0 * np.pi)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-15)
    n = grid.size
    assert np.array_equal(found[:n, n:], -found[n:, :n])
    if uniform:
        inner = slice(None) if grid.closed else slice(1, -1)
        for a in (slice(0, n), slice(n, 2 * n)):
            for b in (slice(0, n), slice(n, 2 * n)):
                block = found[a, b]
                parity = 1.0 if a == b else -1.0
                assert np.array_equal(block[::-1, ::-1], parity * block)
                assert np.array_equal(block[inner, inner], parity * block[inner, inner].T)
                assert np.array_equal(block[1:, inner][:, 1:], block[:-1, inner][:, :-1])


def test_circle_is_circulant_and_arc_is_toeplitz_inside():
    direct, cross = matrices(Grid.circle(30), True)
    assert np.array_equal(np.roll(direct, (1, 1), (0, 1)), direct)
    assert np.array_equal(np.roll(cross, (1, 1), (0, 1)), cross)
    assert np.array_equal(direct, direct.T)
    assert np.array_equal(cross, -cross.T)
    assert np.array_equal(cauchy(Grid.circle(30), True), -cauchy(Grid.circle(30), True).T)
    direct, cross = matrices(Grid.arc(-3.0, 0.0, 30), True)
    assert np.array_equal(direct[1:, 2:-1], direct[:-1, 1:-2])
    # the half hats at the ends mirror each other bit by bit
    assert np.array_equal(direct[::-1, ::-1], direct)
    assert np.array_equal(cross[::-1, ::-1], -cross)


def test_only_the_corner_entries_of_the_cauchy_matrix_diverge():
    for grid, uniform in ((Grid.arc(-2.0, 0.0, 9), True), (Grid(graded_nodes(9, -2.0, 0.0)), False)):
        bad = np.isnan(cauchy(grid, uniform))
        assert bad[0, 0]
        assert bad[-1, -1]
        assert bad.sum() == 2
    assert not np.isnan(cauchy(Grid.circle(9), True)).any()


@pytest.mark.parametrize("closed", [False, True])
def test_moved_by_full_turns_nothing_changes(closed):
    theta = graded_nodes(21, -3.0, 2.5)
    here, there = Grid(theta, closed), Grid(theta + 4.0 * math.pi, closed)
    assert np.abs(np.array(matrices(here, False)) - np.array(matrices(there, False))).max() < 1e-13


def test_harmonics_on_the_circle():
    # L = -2 sum cos(m x)/m and A = -sum sin(m x)/m; a product with C or S shifts m by one. Interpolation
    # between nodes is second order, so the matrices must be too.
    def errors(n):
        grid = Grid.circle(n)
        theta, k = grid.theta, 3
        direct, cross = matrices(grid, True)
        wave, lower, upper = np.cos(k * theta), np.pi / (k - 1), np.pi / (k + 1)
        exact_direct = (lower * (1.0 + 0.5 * RATIO) + upper * (1.0 - 0.5 * RATIO)) * np.cos(k * theta)
        exact_cross = -(lower * (1.0 + 0.5 * RATIO) - upper * (1.0 - 0.5 * RATIO)) * np.sin(k * theta)
        exact_cauchy = 2.0 * np.pi * np.sin(k * theta)
        return [
            np.abs(direct @ wave - exact_direct).max(),
            np.abs(cross @ wave - exact_cross).max(),
            np.abs(cauchy(grid, True) @ wave - exact_cauchy).max(),
        ]

    coarse, fine = np.array(errors(60)), np.array(errors(120))
    assert np.all(np.abs(np.log2(coarse / fine) - 2.0) < 0.05)
    assert np.all(fine < 2e-2)


@pytest.mark.parametrize("call", [influence.spread, python(influence.spread)], ids=["compiled", "python"])
@pytest.mark.parametrize("nodes", [6, 7])
@pytest.mark.parametrize("ends", [0, 1])
def test_columns_are_spread_by_the_distance_of_two_nodes(call: Callable[..., None], nodes: int, ends: int) -> None:
    values, out = np.random.default_rng(nodes).normal(size=(2, 2, nodes)), np.full((2, 2, nodes, nodes), 7.0)
    call(values, influence.BLOCK_PARITY, ends, out)
    for a, b, i, j in np.ndindex(out.shape):
        entry = values[a, b, abs(i - j)] * (influence.BLOCK_PARITY[a, b] if i < j else 1.0)
        assert out[a, b, i, j] == (entry if ends <= j < nodes - ends else 7.0)

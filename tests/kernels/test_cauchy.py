"""Cauchy integrals of piecewise linear tractions: compiled, as plain Python, and against slower ways."""

import itertools
import math
import threading

import numpy as np
import pytest
from scipy.special import spence

from fastpin.elasticity import tractions as module
from fastpin.elasticity.tractions import cauchy_integrals
from fastpin.kernels import cauchy
from fastpin.runtime import threads
from tests.support.kernels import python
from tests.support.tiers import gate
from tests.support.tractions import samples

KERNELS = cauchy


def plain(tractions, theta, away, outside):
    """The closed form summed over all nodes, with the dilogarithm of SciPy."""
    w = 0.0
    whole, shear, slope = 0j, 0j, 0j
    for nodes in tractions.patches:
        slopes = np.diff(nodes[:, 1:], axis=0) / np.diff(nodes[:, 0])[:, None]
        jumps = np.diff(slopes, axis=0, prepend=0.0, append=0.0)
        x = (nodes[:, 0] - theta) if outside else (theta - nodes[:, 0])
        w = np.exp(-away + 1j * x)
        both = jumps[:, 0] - 1j * jumps[:, 1]
        sign = 1.0 if outside else -1.0
        whole += sign * both @ spence(1.0 - w)
        shear += sign * jumps[:, 1] @ spence(1.0 - w)
        slope += both @ np.log(1.0 - w)
        if not outside:
            mean = np.trapezoid(nodes[:, 1:], nodes[:, 0], axis=0)
            whole, shear = whole + mean[0] - 1j * mean[1], shear + mean[1]
    return np.array([whole, shear, slope]) / (2.0 * np.pi)


def quadrature(tractions, theta, away, outside):
    """Gauss quadrature with many points on each linear piece; for points well off the edge."""
    zeta = np.exp((away if outside else -away) + 1j * theta)
    points, weights = np.polynomial.legendre.leggauss(160)
    total = np.zeros(3, dtype=complex)
    for nodes in tractions.patches:
        for left, right in itertools.pairwise(nodes):
            part, weight = 0.5 * (points + 1.0)[:, None], 0.5 * weights * (right[0] - left[0])
            xi, pressure, shear = (left + part * (right - left)).T
            t, both = np.exp(1j * xi), pressure - 1j * shear
            kernel = t / (t - zeta)
            total += [weight @ (both * kernel), weight @ (shear * kernel), weight @ (both * t * zeta / (t - zeta) ** 2)]
    return total / (2.0 * np.pi)


def rounding(tractions):
    """Rounding of the closed form: its terms have the size of the slopes."""
    slopes = [np.diff(nodes[:, 1:], axis=0) / np.diff(nodes[:, 0])[:, None] for nodes in tractions.patches]
    return 5e-14 + 2e-16 * sum(float(np.abs(slope).sum()) for slope in slopes)


@pytest.mark.parametrize("name", samples())
@pytest.mark.parametrize("outside", [True, False])
def test_integrals_against_quadrature(way, name, outside):
    rng, tractions = np.random.default_rng(3), samples()[name]
    theta, away = rng.uniform(-4.0, 4.0, 12), rng.uniform(0.2, 2.0, 12)
    found = cauchy_integrals(tractions, theta, away, outside)
    for angle, distance, integrals in zip(theta, away, found, strict=True):
        assert integrals == pytest.approx(quadrature(tractions, angle, distance, outside), abs=rounding(tractions))


@pytest.mark.parametrize("name", [name for name in samples() if name != "nothing"])
@pytest.mark.parametrize("outside", [True, False])
def test_integrals_against_the_plain_sum_near_the_edge(way, name, outside):
    """The tree and its expansions give the digits of the sum over all nodes; Z counts times 1 - (R/r)^2."""
    rng, tractions = np.random.default_rng(5), samples()[name]
    nodes = np.concatenate(tractions.patches)
    theta = np.r_[rng.uniform(-4.0, 4.0, 10), nodes[rng.integers(0, len(nodes), 10), 0] + 1e-7]
    away = 10.0 ** rng.uniform(-9.0, 0.0, 20)
    found = cauchy_integrals(tractions, theta, away, outside)
    for angle, distance, integrals in zip(theta, away, found, strict=True):
        expected = plain(tractions, angle, distance, outside)
        assert integrals[:2] == pytest.approx(expected[:2], abs=rounding(tractions))
        assert distance * integrals[2] == pytest.approx(distance * expected[2], abs=10 * rounding(tractions))


@pytest.mark.parametrize("name", ["arc", "circle"])
@pytest.mark.parametrize("outside", gate(True, False))
def test_integrals_at_nodes_on_the_edge_are_finite_and_continuous(way, name, outside):
    """Also at the first node of a patch all round, where its list of nodes begins and ends."""
    tractions = samples()[name]
    nodes = tractions.patches[0][::7, 0]
    found = cauchy_integrals(tractions, nodes, np.zeros(nodes.size), outside)
    beside = cauchy_integrals(tractions, nodes, np.full(nodes.size, 1e-13), outside)
    assert np.isfinite(found).all()
    assert found[:, :2] == pytest.approx(beside[:, :2], abs=1e-9)


def test_the_dilogarithm_has_all_digits():
    dilogarithm = python(cauchy._dilogarithm)
    rng = np.random.default_rng(2)
    for _ in range(200):
        x, away = rng.uniform(-math.pi, math.pi), 10.0 ** rng.uniform(-3.0, 1.0)
        w = np.exp(-away + 1j * x)
        log = complex(np.log(1.0 - w))
        found = dilogarithm(x, away, log)
        assert found == pytest.approx(complex(spence(1.0 - w)), abs=5e-15)
    assert dilogarithm(0.0, 0.0, 0j) == pytest.approx(math.pi**2 / 6.0, abs=1e-15)
    assert dilogarithm(math.pi, 0.0, complex(math.log(2.0), 0.0)) == pytest.approx(-(math.pi**2) / 12.0)


def test_coefficients_are_integrals():
    for tractions in samples().values():
        pressure, shear = tractions.coefficients(6)
        far = quadrature(tractions, 0.3, 60.0, False)  # at the centre of the pin C[g] is the mean
        assert pressure[0] - 1j * shear[0] == pytest.approx(far[0], abs=rounding(tractions))
        whole = cauchy_integrals(tractions, np.array([0.7]), np.array([1.5]), False)[0]
        zeta = np.exp(-1.5 + 0.7j)
        pressure, shear = tractions.coefficients(40)
        assert np.polynomial.polynomial.polyval(zeta, pressure - 1j * shear) == pytest.approx(
            whole[0], abs=rounding(tractions)
        )
        assert np.polynomial.polynomial.polyval(zeta, shear) == pytest.approx(whole[1], abs=rounding(tractions))


def test_no_bit_depends_on_the_number_of_points_at_a_time(monkeypatch):
    tractions, rng = samples()["two patches"], np.random.default_rng(1)
    theta, away = rng.uniform(-3.0, 3.0, 300), 10.0 ** rng.uniform(-6.0, 0.0, 300)
    whole = cauchy_integrals(tractions, theta, away, True)
    monkeypatch.setattr(module, "CHUNK", 37)
    assert np.array_equal(cauchy_integrals(tractions, theta, away, True), whole)


@pytest.mark.parametrize("outside", [True, False])
def test_one_thread_and_two_give_the_same_bits(monkeypatch, outside):
    tractions, rng = samples()["arc"], np.random.default_rng(1)
    count = 2 * module.CHUNK + 5_000
    theta, away = rng.uniform(-3.0, 3.0, count), 10.0 ** rng.uniform(-6.0, 0.0, count)
    found, exact = [], cauchy.cauchy
    for cores in (1, 2):
        used, all_used = set(), threading.Event()

        def watched(*given, cores=cores, used=used, all_used=all_used):
            used.add(threading.get_ident())
            if len(used) == cores:
                all_used.set()
            assert all_used.wait(60.0)
            exact(*given)

        monkeypatch.setattr(cauchy, "cauchy", watched)
        monkeypatch.setattr(threads, "cores", lambda cores=cores: cores)
        found.append(cauchy_integrals(tractions, theta, away, outside))
        assert len(used) == cores
    monkeypatch.setattr(cauchy, "cauchy", exact)
    assert np.array_equal(*found)
    alone = np.concatenate([cauchy_integrals(tractions, theta[k : k + 1], away[k : k + 1], outside) for k in range(99)])
    assert np.array_equal(alone, found[0][:99])

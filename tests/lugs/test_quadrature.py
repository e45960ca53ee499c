"""Kernels between nodes and over panels: compiled, as plain Python, and against naive versions."""

import numpy as np
import pytest

from fastpin.lugs import quadrature
from fastpin.lugs.panels import Edges, Fineness, near_integrals
from fastpin.lugs.plates import boundaries
from tests.support.kernels import run_as_python
from tests.support.lugs import disc, plate

KOLOSOV, SCALE = 1.8, 7.0


@pytest.fixture(params=["compiled", "python"])
def way(request, monkeypatch):
    """How the kernels run."""
    if request.param == "python":
        run_as_python(quadrature, monkeypatch)
    return request.param


def kelvin(r, along):
    """2G U (xx, xy, yy) and T (xx, xy, yx, yy), from unit vectors and tensors."""
    e, n = np.array([r.real, r.imag]) / abs(r), np.array([along.imag, -along.real])
    factor, unit, shear = 1.0 / (np.pi * (1.0 + KOLOSOV)), np.eye(2), 0.5 * (KOLOSOV - 1.0)
    U = factor * (-KOLOSOV * np.log(abs(r) / SCALE) * unit + np.outer(e, e))
    skew = shear * (np.outer(n, e) - np.outer(e, n))
    T = -factor / abs(r) * (e @ n * (shear * unit + 2.0 * np.outer(e, e)) + skew)
    return np.r_[U[0], U[1, 1], T.ravel()]


def cauchy(r, along):
    """Real and imaginary parts of Cauchy's kernels, and nothing."""
    parts = along / r, 1.0 / r, along * np.conj(r) / r**2
    return np.array([*(value for part in parts for value in (part.real, part.imag)), 0.0])


def test_kernels_between_nodes_are_those_of_tensors(way):
    rng, n = np.random.default_rng(5), 9
    z, along = rng.normal(size=n) + 1j * rng.normal(size=n), np.exp(1j * rng.uniform(0.0, 6.0, n))
    weights, columns = rng.uniform(0.1, 1.0, n), np.array([-1, 0, -1, 1, 2, -1, 3, -1, 4])
    U, T = np.full((2, n, 2, 5), np.nan), np.full((2, n, 2, n), np.nan)
    quadrature.between_nodes(np.array([1, 2, 6]), z, along, weights, KOLOSOV, SCALE, columns, U, T)
    for i in (1, 2, 6):
        for j in set(range(n)) - {i}:
            expected = weights[j] * kelvin(z[j] - z[i], along[j])
            assert T[:, i, :, j].ravel() == pytest.approx(expected[3:], rel=1e-13)
            if columns[j] >= 0:
                assert U[:, i, :, columns[j]].ravel() == pytest.approx(expected[[0, 1, 1, 2]], rel=1e-13)
    assert np.isnan(T[:, 2, :, 2]).all()
    assert (np.isnan(T).sum(), np.isnan(U).sum()) == (4 * (6 * n + 3), 4 * (6 * 5 + 2))


@pytest.mark.parametrize("is_kelvin", [False, True])
@pytest.mark.parametrize("shape", ["straight", "circle"])
def test_integrals_over_panels_are_those_of_many_pieces(way, shape, is_kelvin):
    """At points of which one lies a hundredth of a panel away; the other one is far."""
    lug = plate() if shape == "straight" else plate(outline=disc(2.0), supports={"rim": "both"})
    edges = Edges(boundaries(lug, 4), Fineness(12, 1))
    last = edges.part.size - 1
    (middle,), (along,) = edges.at(np.array([last]), np.zeros(1))
    points = np.array([middle - 9.0, middle + 0.02j * along * edges.half[last]])
    rows, nodes, sums = near_integrals(edges, np.array([last]), points, *((KOLOSOV, SCALE) if is_kelvin else ()))
    ends, (x, weights) = np.linspace(-1.0, 1.0, 41), np.polynomial.legendre.leggauss(30)
    s = (0.5 * (ends[1:] + ends[:-1])[:, None] + x / 40.0).ravel()
    y, tangents = edges.at(np.full(s.size, last), s)
    naive = kelvin if is_kelvin else cauchy
    values = np.array([naive(*pair) for pair in zip(y - points[1], tangents, strict=True)])
    expected = (values * (np.tile(weights, 40) / 40.0 * edges.half[last])[:, None]).T @ edges.lagrange(s)
    assert rows.tolist() == [[1]]
    assert nodes.tolist() == [np.flatnonzero(edges.panel == last).tolist()]
    assert sums[0] == pytest.approx(expected, abs=1e-12)

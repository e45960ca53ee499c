"""The solutions of the half line against solved contacts of a few nodes, and readings with them."""

import math

import numpy as np
import pytest
from scipy.special import zeta

from fastpin.kernels.half_line import MOST_NODES, TERMS
from fastpin.reading.ends import end_place
from fastpin.reading.half_line import SHEAR_TERMS, End, Fit, half_line, shear_columns, zeta_3
from fastpin.reading.old_borders import OldBorder
from tests.support.half_line import columns, powers


def influence(nodes: int) -> np.ndarray:
    """Collocation matrix of hats under the kernel log|x|, for nodes at distance 1: a plain half plane."""
    x = np.abs(np.arange(nodes + 1.0))
    twice = 0.5 * x**2 * np.log(np.maximum(x, 1e-300)) - 0.75 * x**2
    row = np.r_[2.0 * twice[1], twice[2:] - 2.0 * twice[1:-1] + twice[:-2]]
    return row[np.abs(np.subtract.outer(np.arange(nodes), np.arange(nodes)))]


def hertz(half_width: float, centre: float, nodes: int = 61) -> np.ndarray:
    """Nodal pressure under a parabola; exactly it is the root of (half_width^2 - (x - centre)^2) over pi."""
    matrix, x = influence(nodes), np.arange(nodes) - 0.5 * (nodes - 1.0) - centre
    closed = np.abs(x) < half_width
    for _ in range(10):
        inside = np.flatnonzero(closed)
        system = np.block([[matrix[np.ix_(inside, inside)], np.ones((inside.size, 1))], [np.ones(inside.size), 0.0]])
        found = np.linalg.solve(system, np.r_[0.5 * x[inside] ** 2, 0.5 * half_width**2])
        pressure = np.zeros(nodes)
        pressure[inside] = found[:-1]
        gap = matrix @ pressure + found[-1] - 0.5 * x**2
        closed = (pressure > 0.0) | (~closed & (gap > 0.0))
    return pressure


@pytest.mark.parametrize("half_width", [12.05, 12.3, 12.5, 12.71, 12.95])
def test_edges_of_a_hertzian_contact(half_width: float) -> None:
    """To 0.003 of a node distance with 25 nodes: the error of the discrete problem itself."""
    pressure = hertz(half_width, 0.2)
    inside = np.flatnonzero(pressure)
    x = np.arange(61) - 30.0 - 0.2
    for nodes, sense in ((inside, 1.0), (inside[::-1], -1.0)):
        place = x[nodes[0]] + sense * end_place(pressure[nodes], half_line(0.5))
        assert place == pytest.approx(-sense * half_width, abs=3e-3)


def test_values_between_the_nodes_beside_an_edge() -> None:
    half_width = 12.3
    pressure = hertz(half_width, 0.0)
    inside = np.flatnonzero(pressure)
    fit = Fit(pressure[inside][:8], (End(half_line(0.5), 0, 1, 4),))
    for offset in (0.3, 0.9, 2.6):
        x = -half_width + offset
        exact = math.sqrt(half_width**2 - x**2) / math.pi
        assert fit.values(np.array([x + 30.0 - inside[0]]))[0] == pytest.approx(exact, rel=3e-3)
    assert fit.values(np.array([fit.place(0) - 0.1]))[0] == 0.0


@pytest.mark.parametrize(("exponent", "coupling"), [(0.5, None), (0.46, None), (0.53, 0.2)])
def test_solutions_are_powers_far_from_the_end(exponent: float, coupling: float | None) -> None:
    line = half_line(exponent, coupling)
    for m, bound in enumerate((5e-3, 3e-5, 1e-6, 1e-6)):
        far = powers(line, np.array([60.0]), m + 1)[0] @ line.matching[: m + 1, m]
        assert line.nodal[60, m] == pytest.approx(far, rel=bound)
    assert np.array_equal(np.cumsum(line.nodal[:, 1]), line.nodal[:, 2])
    assert line.matching.shape == (TERMS, TERMS)


@pytest.mark.parametrize(("exponent", "coupling"), [(0.47, 0.2), (0.54, -0.15), (0.5, 1e-9)])
def test_the_shear_beside_a_border_of_unlike_bodies(exponent: float, coupling: float) -> None:
    """Powers far from the border on both sides. Beside it the errors of the nodes change their sign."""
    line, sheared, x = half_line(exponent, coupling), shear_columns(exponent, coupling), np.array([50.0])
    for m, bound in enumerate((8e-3, 6e-5, 2e-5)):
        far = powers(line, x, m + 1)[0]
        assert sheared[MOST_NODES - 1 + 50, m] == pytest.approx(far @ line.matching[: m + 1, m], rel=bound)
        beyond = math.cos(math.pi * exponent) * (-1.0) ** (np.arange(m + 1) - 1.0) * far
        assert sheared[MOST_NODES - 1 - 50, m] == pytest.approx(beyond @ line.matching[: m + 1, m], rel=bound, abs=1e-9)
    errors = sheared[MOST_NODES - 1 :, 0] - line.nodal[:, 0]
    assert np.all(errors[:4] * errors[1:5] < 0.0) or exponent == 0.5
    assert np.all(np.abs(errors[8:]) < 2e-6)
    assert np.allclose(np.diff(sheared, axis=0)[:, 1:], sheared[1:, : SHEAR_TERMS - 1], atol=1e-11)


def test_the_largest_shear_lies_beyond_an_old_border_of_unlike_bodies() -> None:
    """The fitted function has its power on the slip side too."""
    line = half_line(0.47, 0.2)
    end = End(line, 12, 1, 3, -0.3, (0.0, 1.0))
    fit = Fit(2.0 + 0.5 * columns(end, 31) @ [1.0, 0.01], (end._replace(place=None),), 2)
    place = fit.place(0)
    assert place == pytest.approx(11.7, abs=1e-6)
    near = fit.values(place + np.array([-0.01, 0.0, 0.01])) - fit.values(np.array([place]))[0]
    assert near[0] / near[2] == pytest.approx(math.cos(math.pi * 0.47), rel=0.01)


@pytest.mark.parametrize("inwards", [1, -1])
def test_a_place_between_nodes_and_a_known_one(inwards: int) -> None:
    """A smooth function and two cusps three and a half node distances apart, one of them known."""
    line, nodes = half_line(0.5), 21
    first, second = (End(line, node, inwards, 3, place) for node, place in ((10, -0.3), (10 + 3 * inwards, 0.2)))
    x = np.arange(float(nodes))
    values = 1.0 + 0.02 * x + 3.0 * columns(first, nodes) @ [1.0, 0.1] - columns(second, nodes) @ [1.0, -0.05]
    fit = Fit(values, (first._replace(place=None), second), 1)
    assert fit.place(0) == pytest.approx(10.0 - 0.3 * inwards, abs=1e-6)
    assert fit.place(1) == pytest.approx(10.0 + 3.2 * inwards, abs=1e-12)
    assert fit.values(np.array([fit.place(0)]))[0] == pytest.approx(1.0 + 0.02 * fit.place(0), abs=1e-6)


def test_the_end_of_a_zone_beside_an_old_border() -> None:
    line = half_line(0.5)
    first, second = End(line, 0, 1, 3, -0.4), End(line, 2, 1, 3, 0.1)
    values = columns(first, 30) @ [1.0, 0.02] + columns(second, 30) @ [0.7, 0.01]
    assert end_place(values, line, [OldBorder(2, 1, 1, 0.1)]) == pytest.approx(-0.4, abs=1e-6)
    # Both ends have the same solutions. Without noise the choice among the fits would be rounding. Measured: 1.5e-3.
    noisy = values + 1e-6 * np.random.default_rng(1).normal(size=30)
    assert end_place(noisy, line, [OldBorder(2, 1, 1)]) == pytest.approx(-0.4, abs=3e-3)
    assert not abs(end_place(values, line) + 0.4) < 0.01  # without knowledge of the old border
    assert math.isnan(end_place(np.random.default_rng(1).uniform(0.5, 1.0, 30), line))
    assert math.isnan(end_place(values[:3], line))


def test_zeta_is_that_of_scipy():
    t = np.linspace(1e-4, 1.0, 1001)
    assert np.allclose(zeta_3(t), zeta(3, t), rtol=1e-14, atol=0.0)

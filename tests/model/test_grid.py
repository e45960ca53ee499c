"""The grid: knots, weights and moments of hat functions, and what it refuses."""

import math

import mpmath
import numpy as np
import pytest

from fastpin.model.grid import Grid
from tests.support.refusals import refused


@pytest.mark.parametrize("width", [1e-7, 1e-3, 0.2, 0.49])
def test_trig_moments_against_mpmath(width):
    mpmath.mp.dps = 30
    grid = Grid(-1.3 + width * np.array([0.0, 1.0, 1.5, 2.5, 3.5]))
    left, right = grid.knots()
    cosine, sine = grid.trig_moments()
    for j in range(grid.size):
        node, a, b = (mpmath.mpf(v) for v in (grid.theta[j], grid.theta[j] - left[j], right[j] - grid.theta[j]))
        for got, wave in ((cosine[j], mpmath.cos), (sine[j], mpmath.sin)):
            exact = mpmath.mpf(0)
            if b > 0:
                exact += mpmath.quad(lambda t, w=wave, n=node, b=b: w(n + t) * (1 - t / b), [0, b])
            if a > 0:
                exact += mpmath.quad(lambda t, w=wave, n=node, a=a: w(n - t) * (1 - t / a), [0, a])
            assert got == pytest.approx(float(exact), rel=1e-13, abs=1e-15 * width)


def test_moments_of_wide_hats_add_up():
    grid = Grid(np.array([-3.0, -2.1, -1.0, 0.3, 1.5]))
    cosine, sine = grid.trig_moments()
    assert cosine.sum() == pytest.approx(math.sin(1.5) - math.sin(-3.0), abs=1e-14)
    assert sine.sum() == pytest.approx(math.cos(-3.0) - math.cos(1.5), abs=1e-14)
    assert grid.weights.sum() == pytest.approx(4.5, abs=1e-14)


def test_the_circle_has_no_ends():
    grid = Grid.circle(12)
    left, right = grid.knots()
    assert grid.closed
    assert np.allclose(grid.weights, 2.0 * math.pi / 12)
    assert right[-1] - left[0] == pytest.approx(2.0 * math.pi + 2.0 * math.pi / 12)
    assert np.abs(np.array(grid.trig_moments()).sum(axis=1)).max() < 1e-14


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Grid.arc(0.0, 1.0, 4), "nodes"),
        (lambda: Grid.arc(0.0, 1.0, 10.5), "nodes"),
        (lambda: Grid.arc(1.0, 0.0, 10), "arc"),
        (lambda: Grid.arc(0.0, 7.0, 10), "arc"),
        (lambda: Grid.arc(math.nan, 1.0, 10), "arc start"),
        (lambda: Grid.circle(True), "nodes"),
        (lambda: Grid(np.array([0.0, 1.0, 0.5, 2.0, 3.0])), "theta"),
        (lambda: Grid(np.array([0.0, 1.0, np.nan, 2.0, 3.0])), "theta"),
        (lambda: Grid(np.array([0.0, 1.0, 2.0, 3.0, 6.3])), "theta"),
    ],
)
def test_bad_grids_are_refused_by_name(make, field):
    assert refused(make).field == field


def test_uniform_nodes_are_recognised():
    assert Grid.arc(-2.0, 1.0, 77).uniform
    assert Grid.circle(31).uniform
    nodes = np.linspace(-2.0, 1.0, 31)
    assert not Grid(nodes, closed=True).uniform  # equally spaced but for the seam
    nodes[3] += 1e-6
    assert not Grid(nodes).uniform

"""The smallest sphere round points: compiled, as plain Python, and against all subsets and an iteration."""

import itertools

import numpy as np
import pytest

from fastpin.damage import spheres
from tests.support.kernels import in_python
from tests.support.tiers import gate


def all_subsets(points):
    """Radius of the smallest of all spheres that pass through a few points and hold the others."""
    best = np.inf
    for count in range(1, points.shape[1] + 2):
        for chosen in itertools.combinations(range(len(points)), count):
            edges = points[list(chosen[1:])] - points[chosen[0]]
            part = np.linalg.lstsq(2.0 * edges @ edges.T, np.sum(edges**2, axis=1), rcond=None)[0]
            centre = points[chosen[0]] + part @ edges
            best = min(best, np.linalg.norm(points - centre, axis=1).max())
    return best


def solved(paths):
    out = np.empty((len(paths), paths.shape[2] + 1))
    spheres.enclosing_spheres(np.ascontiguousarray(paths), out)
    return out[:, :-1], out[:, -1]


@pytest.mark.parametrize("dimension", [1, 2, *gate(3, 5)])
def test_the_sphere_is_the_smallest_of_all_subsets(dimension):
    paths = np.random.default_rng(dimension).normal(size=(12, 10 if dimension < 5 else 9, dimension))
    centres, radii = solved(paths)
    for path, centre, radius in zip(paths, centres, radii, strict=True):
        assert radius == pytest.approx(all_subsets(path), rel=1e-12)
        assert np.linalg.norm(path - centre, axis=1).max() == pytest.approx(radius, rel=1e-14)


@pytest.mark.parametrize("dimension", [3, 5])
def test_compiled_and_plain_python_agree(dimension):
    paths = np.random.default_rng(3).normal(size=(5, 30, dimension))
    plain = np.empty((5, dimension + 1))
    in_python(spheres).enclosing_spheres(paths, plain)
    centres, radii = solved(paths)
    np.testing.assert_allclose(radii, plain[:, -1], rtol=1e-13)
    np.testing.assert_allclose(centres, plain[:, :-1], rtol=1e-12, atol=1e-13)


def test_special_paths():
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    circle = np.stack([np.cos(turn) + 5.0, 2.0 + 0.0 * turn, np.sin(turn)], axis=-1)
    line = np.outer(np.sin(turn), [1.0, 2.0, 2.0])
    still = np.full((200, 3), 7.0)
    twice = np.repeat(circle[::2], 2, axis=0)
    centres, radii = solved(np.array([circle, line, still, twice]))
    assert radii[0] == pytest.approx(1.0, rel=1e-12)
    assert centres[0] == pytest.approx([5.0, 2.0, 0.0], abs=1e-3)
    assert radii[1] == pytest.approx(3.0 * np.ptp(np.sin(turn)) / 2.0, rel=1e-14)
    assert radii[2] == 0.0
    assert radii[3] == pytest.approx(all_subsets(circle[::20]), rel=2e-2)


def test_many_points_near_a_sphere():
    """Cospherical points have many supports; the radius is that of the sphere."""
    rng = np.random.default_rng(8)
    directions = rng.normal(size=(4, 500, 3))
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    radii = solved(directions)[1]
    assert np.all(radii <= 1.0 + 1e-12)
    assert np.all(radii > 0.99)

"""Lemke's method: compiled, as plain Python, and against trying all combinations."""

import itertools

import numpy as np
import pytest

from fastpin.kernels import complementarity

KERNELS = complementarity


@pytest.fixture
def lemke(way):
    """Return whether a problem is solved, and z."""
    kernel = complementarity.lemke

    def solve(matrix, vector, most_pivots=1000, cover=None):
        k = vector.size
        z = np.full(k, np.nan)
        tableau, basis = np.full((k, 2 * k + 2), np.nan), np.zeros(k, dtype=np.int64)
        cover = np.ones(k) if cover is None else cover
        return kernel(np.ascontiguousarray(matrix), vector, cover, most_pivots, tableau, basis, z), z

    return solve


def solutions(matrix, vector):
    """All solutions, by solving for every combination of basic variables."""
    k = vector.size
    found = []
    for chosen in itertools.product([False, True], repeat=k):
        basic = np.array(chosen)
        z = np.zeros(k)
        if basic.any():
            block = matrix[np.ix_(basic, basic)]
            if abs(np.linalg.det(block)) < 1e-12:
                continue
            z[basic] = np.linalg.solve(block, -vector[basic])
        w = vector + matrix @ z
        if z.min() > -1e-10 and w[~basic].min(initial=0.0) > -1e-10:
            found.append(z)
    return found


def violation(matrix, vector, z):
    w = vector + matrix @ z
    return max(-z.min(), -w.min(), np.abs(w * z).max())


@pytest.mark.parametrize("k", [1, 2, 5, 8])
def test_a_p_matrix_has_the_one_solution_of_all_combinations(lemke, k):
    for seed in range(12):
        rng = np.random.default_rng([k, seed])
        root, turn = rng.normal(size=(k, k)), rng.normal(size=(k, k))
        matrix, vector = root @ root.T + 0.1 * np.eye(k) + turn - turn.T, rng.normal(size=k)
        solved, z = lemke(matrix, vector)
        (naive,) = solutions(matrix, vector)
        assert solved
        assert z == pytest.approx(naive, abs=1e-9)


def test_any_matrix_gives_a_solution_or_a_ray(lemke):
    endings = {True: 0, False: 0}
    for seed in range(60):
        rng = np.random.default_rng(seed)
        matrix, vector = rng.normal(size=(6, 6)), rng.normal(size=6)
        solved, z = lemke(matrix, vector)
        endings[solved] += 1
        if solved:
            assert violation(matrix, vector, z) < 1e-8
            assert any(np.allclose(z, one, atol=1e-8) for one in solutions(matrix, vector))
    assert min(endings.values()) > 5


def test_without_a_negative_entry_the_solution_is_zero(lemke):
    solved, z = lemke(-np.eye(3), np.array([0.0, 1.0, 2.0]))
    assert solved
    assert np.array_equal(z, np.zeros(3))


def test_no_solution_ends_on_a_ray(lemke):
    assert not lemke(-np.eye(2), np.array([-1.0, 1.0]))[0]
    assert not lemke(np.zeros((2, 2)), np.array([-1.0, -1.0]))[0]
    assert not lemke(np.eye(2), np.array([np.nan, 1.0]))[0]


def test_too_many_pivots_are_reported(lemke):
    rng = np.random.default_rng(3)
    root = rng.normal(size=(8, 8))
    matrix, vector = root @ root.T + np.eye(8), -np.ones(8)
    assert not lemke(matrix, vector, most_pivots=2)[0]
    assert lemke(matrix, vector)[0]


def test_ties_do_not_cycle(lemke):
    """A problem on which the plain ratio rule meets ties at every pivot: symmetric, with equal right-hand sides."""
    k = 12
    matrix = np.eye(k) + np.diag(np.full(k - 1, 2.0), -1)
    for vector in (-np.ones(k), np.where(np.arange(k) % 2, -1.0, 0.0)):
        solved, z = lemke(matrix, vector, most_pivots=2**k + 10)
        assert solved
        assert violation(matrix, vector, z) < 1e-9


def test_the_covering_vector_does_not_change_a_single_solution(lemke):
    rng = np.random.default_rng(5)
    root = rng.normal(size=(7, 7))
    matrix, vector = root @ root.T + np.eye(7), rng.normal(size=7)
    one, two = lemke(matrix, vector)[1], lemke(matrix, vector, cover=rng.uniform(0.5, 2.0, size=7))[1]
    assert one == pytest.approx(two, abs=1e-10)

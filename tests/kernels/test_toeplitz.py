"""The fast inverse of neighbours that all stick: compiled, as plain Python, and against factorisations."""

import numpy as np
import pytest
import scipy.linalg

from fastpin import Grid, Material, MaterialPair, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels import toeplitz
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver import unknowns
from fastpin.solver.unknowns import DenseUnknowns, StickingRun
from tests.support.steps import as_with_many_nodes
from tests.support.tiers import gate

KERNELS = toeplitz
BOTTOM = -0.5 * np.pi
RIGID_PIN = MaterialPair(Material.rigid(), Material(70e9, 0.33))


def drawn(size):
    """The first column, the second and the cross one of a random matrix that can be inverted."""
    rng, away = np.random.default_rng(size), np.arange(size)
    first, second = (rng.normal(size=size) * 0.8**away + 4.0 * size * (away == 0) for _ in range(2))
    return first, second, np.where(away == 0, 0.0, rng.normal(size=size))


def dense(first, second, cross):
    upper = scipy.linalg.toeplitz(cross, -cross)
    return np.block([[scipy.linalg.toeplitz(first), upper], [-upper, scipy.linalg.toeplitz(second)]])


@pytest.mark.parametrize("size", [1, 2, 3, 30])
def test_it_is_the_inverse(way, size):
    matrix = dense(*drawn(size))
    assert np.array_equal(matrix, matrix.T)
    assert toeplitz.inverse(*drawn(size)) == pytest.approx(np.linalg.inv(matrix), rel=1e-11, abs=1e-14)


def test_a_singular_leading_block_is_not_hidden():
    with np.errstate(all="ignore"):  # compiled code divides by zero without a warning
        found = toeplitz.inverse(np.array([1.0, 1.0]), np.array([2.0, 0.0]), np.zeros(2))
    assert not np.all(np.isfinite(found))


def test_a_column_of_a_laminate(way):
    """Against the definition, k factor turn_i turn_j (N + iT) = gap - i slip."""
    rng, n = np.random.default_rng(1), 7
    by_distance, turn, factor = rng.normal(size=n), np.exp(1j * rng.normal(size=n)), 0.3 - 0.7j
    away = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    term = factor * by_distance[away] * np.outer(turn, turn)
    whole = np.block([[term.real, -term.imag], [-term.imag, -term.real]])
    rows, before = rng.permutation(2 * n)[:9], rng.normal(size=9)
    for column in range(2 * n):
        out = before.copy()
        toeplitz.add_turned_column(by_distance, turn, factor, rows, column, out)
        assert out == pytest.approx(before + whole[rows, column], abs=1e-15)


@pytest.fixture
def small_sets(monkeypatch):
    """Small sets too are inverted in the fast way."""
    monkeypatch.setattr(unknowns, "LEAST_NEIGHBOURS", 2)


def stuck(size, low, high):
    status = np.full(size, OPEN, dtype=np.int8)
    status[low:high] = STICK
    return status


@pytest.mark.parametrize(
    ("low", "size", "nodes"), [(4, 9, 20), (0, 7, 15), (6, 3, 9), (5, 30, 61), (1, 2, 4), (3, 8, 12), (2, 1, 4)]
)
def test_what_it_does_to_the_nodes_beside(way, low, size, nodes):
    columns = drawn(nodes)
    matrix = dense(*columns)
    rows = np.r_[low : low + size, nodes + low : nodes + low + size]
    others = np.setdiff1d(np.arange(2 * nodes), rows)
    core = np.linalg.inv(matrix[np.ix_(rows, rows)])
    beside = toeplitz.NeighbourResponses(np.array(columns), core, low)
    responses = core @ matrix[np.ix_(rows, others)]
    assert beside.responses() == pytest.approx(responses, rel=1e-10, abs=1e-13)
    complement = matrix[np.ix_(others, others)] - matrix[np.ix_(others, rows)] @ responses
    assert beside.complement() == pytest.approx(complement, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("grid", [Grid.arc(BOTTOM - 1.7, BOTTOM + 1.6, 121), Grid.circle(121)], ids=["arc", "circle"])
@pytest.mark.parametrize(
    ("pin_load", "rotation", "hub"), [("body", "free", None), ("centre", "fixed", None), ("centre", "fixed", 0.2)]
)
@pytest.mark.parametrize("pair", ["titanium", "rigid"])
@pytest.mark.parametrize("ends", [(20, 97), (50, 70)], ids=["wide", "narrow"])
def test_set_of_sticking_neighbours(small_sets, titanium_in_aluminium, grid, pin_load, rotation, hub, pair, ends):
    pair = titanium_in_aluminium if pair == "titanium" else RIGID_PIN
    problem = Problem.from_load_parameter(pair, 0.1, 0.4, pin_load, rotation, hub_radius=hub)
    system = System.build(problem, grid, 1.0)
    status = stuck(121, *ends)
    fast, slow = StickingRun.of(system, status), DenseUnknowns(system, status)
    right = np.cos(np.arange(fast.count + 3.0))
    close(fast.solve(right), slow.solve(right))
    m = ends[1] - ends[0]
    positions = np.array([0, 5, m - 1, m, 2 * m - 30, 2 * m - 1])
    for one, two in zip(fast.held_columns(positions), slow.held_columns(positions), strict=True):
        close(one, two)
    slots, coupling = np.array([3, 18, 19, 97, 110, 122, 140, 218]), np.array([0.4, -0.4, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
    for one, two in zip(fast.given_columns(slots, coupling), slow.given_columns(slots, coupling), strict=True):
        close(one, two)


def close(one, two):
    assert one.shape == two.shape
    assert np.abs(one - two).max() < 1e-11 * np.abs(two).max()


def test_what_it_is_not_for(small_sets, titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(problem, Grid.circle(60), 1.0)
    split, across, slipping = stuck(60, 20, 40), stuck(60, 50, 60), stuck(60, 20, 40)
    split[30], across[:5], slipping[25] = OPEN, STICK, 1
    assert StickingRun.of(system, stuck(60, 20, 40)) is not None
    for status in (split, across, slipping, stuck(60, 0, 0), stuck(60, 20, 21)):
        assert StickingRun.of(system, status) is None
    theta = BOTTOM + np.linspace(-1.2, 1.2, 60) ** 3
    graded = System.build(problem, Grid(theta), 1.0)
    assert StickingRun.of(graded, stuck(60, 20, 40)) is None
    smooth = System.build(Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.0), Grid.circle(60), 1.0)
    assert StickingRun.of(smooth, stuck(60, 20, 40)) is None


@pytest.mark.gate
@pytest.mark.parametrize(("pin_load", "rotation"), [*gate(("body", "free")), ("centre", "fixed")])
def test_histories_are_those_of_factorisations(small_sets, titanium_in_aluminium, monkeypatch, pin_load, rotation):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, pin_load, rotation)
    grid = Grid.arc(BOTTOM - 1.8, BOTTOM + 1.8, 301)
    corners = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}, {"P": 0.4, "sxx": 0.1}, {"P": 1.2}]
    as_with_many_nodes(monkeypatch)  # as with many nodes
    fast = solve(problem, corners, grid=grid)
    monkeypatch.setattr(StickingRun, "of", lambda *_: None)
    slow = solve(problem, corners, grid=grid)
    for one, two in zip(fast, slow, strict=True):
        assert np.array_equal(one.status, two.status)
        for name in ("pressure", "shear", "gap", "slip"):
            scale = np.abs(getattr(two, name)).max()
            assert np.abs(getattr(one, name) - getattr(two, name)).max() < 1e-9 * scale
        assert one.dissipation == pytest.approx(two.dissipation, rel=1e-9, abs=1e-12)
    assert fast.statistics["rebuilds"] < slow.statistics["rebuilds"]

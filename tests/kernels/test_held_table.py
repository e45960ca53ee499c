"""The table of a held run of equally spaced nodes: compiled, as plain Python, and against all equations."""

import numpy as np
import pytest
import scipy.linalg

from fastpin.kernels import held_table, toeplitz
from tests.support.kernels import run_as_python

KERNELS = held_table


@pytest.fixture(autouse=True)
def inverse_too(way, monkeypatch):
    """The inverse stands in a file of its own."""
    if way == "python":
        run_as_python(toeplitz, monkeypatch)


def drawn(nodes):
    """Entries by distance of a random operator that can be inverted, with a column that is not used; and all of it."""
    rng, away = np.random.default_rng(nodes), np.arange(nodes)
    first, second = (rng.normal(size=nodes) * 0.8**away + 4.0 * nodes * (away == 0) for _ in range(2))
    cross = np.where(away == 0, 0.0, rng.normal(size=nodes))
    upper = scipy.linalg.toeplitz(cross, -cross)
    matrix = np.block([[scipy.linalg.toeplitz(first), upper], [-upper, scipy.linalg.toeplitz(second)]])
    return np.column_stack([np.array([first, second, cross]), np.full(3, np.nan)]), matrix


def equations(nodes):
    rng = np.random.default_rng(nodes + 1)
    return rng.normal(size=(2 * nodes, 3)), rng.normal(size=(3, 2 * nodes)), rng.normal(size=(3, 3))


def filled(low, size, nodes):
    """The table by the kernel, its condition number and its error."""
    table = np.full((2 * nodes + 3, 2 * nodes + 3), np.nan, order="F")
    return table, *held_table.fill(drawn(nodes)[0], low, size, *equations(nodes), table)


@pytest.mark.parametrize(
    ("low", "size", "nodes"), [(4, 9, 20), (0, 7, 15), (8, 7, 15), (6, 3, 9), (1, 2, 4), (3, 8, 12), (2, 1, 4)]
)
def test_the_table_solves_the_equations_of_all_nodes(way, low, size, nodes):
    closed = np.zeros(nodes, dtype=bool)
    closed[low : low + size] = True
    rows, others = np.flatnonzero(np.r_[closed, closed]), np.flatnonzero(~np.r_[closed, closed])
    matrix, (motion, equilibrium, motion_rows) = drawn(nodes)[1], equations(nodes)
    held = np.block([[matrix[np.ix_(rows, rows)], motion[rows]], [equilibrium[:, rows], motion_rows]])
    acting = np.vstack([matrix[np.ix_(rows, others)], equilibrium[:, others]])
    unit = np.eye(len(held))
    of_held = np.linalg.solve(held, np.hstack([unit[:, : rows.size], -acting, unit[:, rows.size :]]))
    of_others = np.hstack([matrix[np.ix_(others, rows)], motion[others]]) @ of_held
    of_others[:, rows.size : 2 * nodes] += matrix[np.ix_(others, others)]
    expected = np.vstack([of_held[: rows.size], of_others, of_held[rows.size :]])

    table, condition, error = filled(low, size, nodes)
    assert np.abs(table - expected).max() < 1e-11 * np.abs(expected).max()
    small = table[2 * nodes :, 2 * nodes :]
    assert condition == pytest.approx(np.linalg.norm(small) * np.linalg.norm(np.linalg.inv(small)), rel=1e-8)
    assert error < 1e-12


def test_the_error_shows_lost_digits(way):
    """An operator that is nearly singular in the run."""
    nodes = 6
    entries, table = np.zeros((3, nodes + 1)), np.empty((2 * nodes + 3, 2 * nodes + 3), order="F")
    entries[:2, :nodes] = 1.0
    entries[:2, 0] += 1e-13
    errors = [held_table.fill(entries, 1, 3, *equations(nodes), table)[1]]
    entries[:2, 0] += 1.0
    errors.append(held_table.fill(entries, 1, 3, *equations(nodes), table)[1])
    assert not errors[0] < 1e-6
    assert errors[1] < 1e-12


def test_nodes_that_do_not_hold_the_pin_have_no_condition_number(way):
    nodes, table = 6, np.empty((15, 15), order="F")
    motion, equilibrium, _ = equations(nodes)
    motion[:, 2] = equilibrium[2] = 0.0
    with np.errstate(all="ignore"):  # compiled code divides by zero without a warning
        condition, error = held_table.fill(drawn(nodes)[0], 1, 3, motion, equilibrium, np.zeros((3, 3)), table)
    assert not condition < 1e15
    assert not error < 1e-10

"""The tableau of interfaces with ports: compiled, as plain Python, and against one dense matrix of all of them."""

import functools

import numba
import numpy as np
import pytest

from fastpin.kernels import ports
from fastpin.kernels.arrays import PortTables, Tableau

pytestmark = pytest.mark.gate

KERNELS = ports
SECTIONS, NODES, OUTPUTS, INPUTS, MOTIONS, FELT = 3, 4, 3, 5, 2, 11
ROOM = 3
PAIRS = 2 * SECTIONS * NODES


@functools.cache
def set_column_compiled():
    """An inner kernel can be called by compiled code only."""
    inner = ports._set_column
    return numba.njit(lambda *arguments: inner(*arguments))


def set_column(way):
    return set_column_compiled() if way == "compiled" else ports._set_column


@pytest.fixture
def drawn():
    """Random tables with their answers, and the dense matrix of what all pairs move: dependent variables, motions."""
    rng = np.random.default_rng(5)
    size = 2 * NODES
    nodes = np.arange(SECTIONS * NODES).reshape(SECTIONS, NODES)
    rows = np.hstack([nodes, nodes + SECTIONS * NODES])
    inputs = np.array([rng.permutation(FELT)[:INPUTS] for _ in range(SECTIONS)])
    tables = rng.normal(size=(SECTIONS, size + INPUTS, size + OUTPUTS))
    tables[:, np.arange(size), np.arange(size)] += 6.0
    tied, couplings = 4.0 * np.eye(FELT), rng.normal(size=(FELT, SECTIONS * OUTPUTS))
    acting, moving = np.zeros((SECTIONS * OUTPUTS, PAIRS)), np.zeros((PAIRS, FELT))
    for place in range(SECTIONS):
        own = slice(place * OUTPUTS, (place + 1) * OUTPUTS)
        tied[:, inputs[place]] += couplings[:, own] @ tables[place, size:, size:].T
        acting[own, rows[place]] = tables[place, :size, size:].T
        moving[np.ix_(rows[place], inputs[place])] = tables[place, size:, :size].T
    answers = np.linalg.solve(tied, np.hstack([couplings, np.eye(FELT)[:, :MOTIONS]]))
    moved = -answers[:, : SECTIONS * OUTPUTS] @ acting
    dense = moving @ moved
    for place in range(SECTIONS):
        dense[np.ix_(rows[place], rows[place])] += tables[place, :size, :size].T
    given = PortTables(
        rows, np.argsort(rows.ravel()), inputs, tables, answers, np.full((ROOM, FELT), np.nan),
        np.full((ROOM, answers.shape[1]), np.nan), rng.normal(size=SECTIONS * NODES), np.empty(FELT),
        np.array([0, 0, -1]),
    )  # fmt: skip
    return given, np.vstack([dense, moved[:MOTIONS]])


def tableau_of(updates):
    """A tableau that has these updates, each (source, slot), and no columns."""
    source, slot = np.array(updates).T.copy()
    blank = np.zeros(0)
    return Tableau(
        np.full((PAIRS + MOTIONS, PAIRS), np.nan, order="F"), np.full(PAIRS, -1), np.zeros((0, 0), order="F"), source,
        slot, blank, blank, blank, np.zeros(0, dtype=np.int64), blank, blank, 1, 1,
    )  # fmt: skip


def updated(dense, updates, coupling):
    """The dense matrix after the updates, one by one."""
    dense, coupling = dense.copy(), coupling.copy()
    for source, slot in updates:
        pair = max(source, slot)
        shear = pair + SECTIONS * NODES
        if source == slot:  # y_p becomes the given one, and x_p = (y_p - sum of the others) / pivot
            pivot, row, column = dense[pair, pair], dense[pair].copy(), dense[:, pair].copy()
            dense -= np.outer(column, row) / pivot
            dense[:, pair], dense[pair] = column / pivot, -row / pivot
            dense[pair, pair] = 1.0 / pivot
            continue
        change, coupling[pair] = -2.0 * coupling[pair], -coupling[pair]
        if slot < 0:
            dense[shear] += change * dense[pair]
        else:
            dense[:, pair] -= change * dense[:, shear]
    return dense


UPDATES = [(1, 1), (17, 17), (2, -1), (9, 9), (-1, 6), (20, 20), (1, 1), (-1, 0), (13, 13), (8, 8), (5, -1)]


@pytest.mark.parametrize("count", [1, 4, len(UPDATES)])
@pytest.mark.parametrize("asks", [False, True], ids=["updates alone", "columns before exchanges"])
def test_columns_are_those_of_one_dense_matrix(way, drawn, count, asks):
    given, dense = drawn
    start, tableau, column = given.coupling.copy(), tableau_of(UPDATES), set_column(way)
    for done in range(1, count + 1) if asks else [count]:
        source, slot = UPDATES[done - 1]
        if asks and source == slot:
            column(given, tableau, source)  # the exchange takes what it moves
        while not ports.catch_up(given, tableau, done):
            assert given.counts[ports.WAITING] == ROOM  # the caller adds them up
            given.answers[:] += given.left.T @ given.right
            given.counts[ports.WAITING] = 0
    wanted = updated(dense, UPDATES[:count], start)
    for pair in range(PAIRS):
        column(given, tableau, pair)
    np.testing.assert_allclose(tableau.matrix, wanted, rtol=0.0, atol=1e-11 * np.abs(wanted).max())
    np.testing.assert_array_equal(tableau.fresh, count)

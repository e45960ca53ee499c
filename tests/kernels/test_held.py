"""The start of a step with all closed nodes held: compiled, as plain Python, and with products of whole arrays."""

import numpy as np
import pytest

from fastpin.kernels import held
from fastpin.kernels.arrays import Contact, Tableau
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver.tableau import expected_ties, has_turned
from tests.support.tiers import gate, seeds

KERNELS = held
NODES = 14


def drawn_contact(rng, rough):
    status = rng.permutation(np.resize([OPEN, STICK, 1, -1], NODES)).astype(np.int8)
    if not rough:
        status[status == STICK] = 1
    values = (rng.normal(size=NODES) for _ in range(4))
    return Contact(
        *values, status, np.zeros(NODES, dtype=np.int8), np.zeros(NODES, dtype=bool), np.zeros(3), np.zeros(NODES),
        np.zeros((4, 0)),
    )  # fmt: skip


@pytest.mark.parametrize("rough", gate(True, False))
def test_the_start_of_a_step(way, rough):
    for seed in seeds(8):
        rng = np.random.default_rng(seed)
        contact, size = drawn_contact(rng, rough), 2 * NODES + 3
        status, closed = contact.status, contact.status != OPEN
        friction = np.where(rng.random(NODES) < 0.2, 0.0, rng.uniform(0.1, 1.0, NODES))
        both = np.r_[closed, closed]
        stack = np.r_[np.flatnonzero(both), np.flatnonzero(~both), np.arange(2 * NODES, size)]
        table = np.asfortranarray(rng.normal(size=(size, size)))
        displaced, forces = rng.normal(size=2 * NODES), rng.normal(size=3)

        order = np.argsort(stack)
        rates = (table @ np.r_[-displaced * both, forces][stack])[order]
        rates[: 2 * NODES] += displaced * ~both
        turned = has_turned(status, rates[:NODES], rates[NODES:-3], friction)
        ties = expected_ties(contact, rates)
        if not turned:
            ties = np.where(np.abs(status) == 1, status, ties)
        tied = np.where(closed, friction * ties, 0.0)
        rates[NODES:-3] += tied * rates[:NODES]

        numbers = {name: np.full(NODES, np.nan) for name in ("tied", "drag")}
        empty = np.zeros(0, dtype=np.int64)
        tableau = Tableau(
            matrix=table, order=order, fresh=empty, left=np.zeros((size, 0), order="F"), source=empty, slot=empty,
            delta=np.zeros(0), factors=np.zeros(4), rates=np.full(size, np.nan), chunk=1, width=1, **numbers,
        )  # fmt: skip
        assert held.begin(table, stack, contact, friction, displaced, forces, tableau) == turned
        assert tableau.rates == pytest.approx(rates, rel=1e-12, abs=1e-13)
        assert np.array_equal(contact.tie, ties)
        assert np.array_equal(tableau.tied, tied)
        assert np.array_equal(tableau.drag, np.where(closed, 0.0, -friction * ties))

"""Counts of closed cycles: compiled, as plain Python, and against another count."""

import numpy as np
import pytest

from fastpin import damage
from fastpin.cracks.reversals import closed_cycles
from tests.support.kernels import python
from tests.support.tiers import seeds

PYTHON = python(closed_cycles)


def counted(rows, kernel=closed_cycles):
    """The cycles of each row: sorted pairs of their reversals."""
    values = np.array(rows, dtype=float)
    tops, bottoms, counts = np.empty(values.shape), np.empty(values.shape), np.empty(len(values), dtype=np.int64)
    kernel(values, tops, bottoms, counts)
    return [
        sorted(zip(top[:n].tolist(), bottom[:n].tolist(), strict=True))
        for top, bottom, n in zip(tops, bottoms, counts.tolist(), strict=True)
    ]


def test_cycles_by_hand():
    rows = [[0, 3, 1, 2, 0, 0], [1, 1, 1, 1, 1, 1], [5, 0, 5, 0, 5, 0], [0, 1, 2, 3, 2, 1], [1, 4, 2, 3, 2, 3]]
    assert counted(rows) == [[(2, 1), (3, 0)], [], [(5, 0), (5, 0), (5, 0)], [(3, 0)], [(3, 2), (3, 2), (4, 1)]]


def test_compiled_python_and_pylife_agree():
    for seed in seeds(5):
        pytest.importorskip("pylife")
        rows = np.random.default_rng(seed).integers(-6, 7, (4, 60)).astype(float)
        found = counted(rows)
        assert found == counted(rows, PYTHON)
        for row, cycles in zip(rows, found, strict=True):
            other = damage.rainflow(row)
            assert sorted(top - bottom for top, bottom in cycles) == pytest.approx(sorted(other.range))
            assert sorted(0.5 * (top + bottom) for top, bottom in cycles) == pytest.approx(sorted(other.mean))


def test_the_beginning_of_a_period_makes_no_difference():
    row = np.random.default_rng(9).normal(size=41)
    assert counted([row]) == counted([np.roll(row, 17)])

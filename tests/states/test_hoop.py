"""Whether a peak of the hoop stress is resolved: by the number of nodes in contact, and by the shape of the peak."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from fastpin.kernels.status import OPEN, STICK
from fastpin.states import hoop

SPACING = 0.01


def is_resolved(shape: Callable[[np.ndarray], np.ndarray], nodes: int = 60) -> bool:
    """Whether a peak of height 1 at the angle 0 is resolved. `shape` is its drop at distances in node distances."""
    state = SimpleNamespace(
        status=np.r_[np.full(nodes, STICK), np.full(100, OPEN)],
        grid=SimpleNamespace(weights=np.full(nodes + 100, SPACING)),
        refined=SimpleNamespace(resolved=(), unresolved=()),
        hoop_stress=lambda body, angles: 1.0 - 0.01 * shape(angles / SPACING),
    )
    return hoop._is_resolved(state, "plate", 1.0, 0.0)


def test_a_peak_needs_forty_nodes_in_contact() -> None:
    """The docstring of HoopPeak says so."""
    assert [is_resolved(np.square, nodes) for nodes in (0, 1, 39, 40, 60)] == [True, False, False, True, True]


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_cusp_on_either_side_is_not_resolved(side: float) -> None:
    assert is_resolved(lambda x: np.where(side * x > 0.0, x**2, 3.0 * x**2))
    assert not is_resolved(lambda x: np.where(side * x > 0.0, x**2, np.sqrt(np.abs(x))))
    assert not is_resolved(lambda x: np.where(side * x > 0.0, 10.0 * x**2, np.abs(x)))

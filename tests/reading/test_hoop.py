"""Whether a peak of the hoop stress is resolved: by the number of nodes in contact, and by the shape of the peak."""

from collections.abc import Callable

import numpy as np
import pytest

from fastpin.elasticity.tractions import RefinedTractions, Tractions
from fastpin.reading import hoop

SPACING = 0.01


def is_resolved(shape: Callable[[np.ndarray], np.ndarray], nodes: int = 60) -> bool:
    """Whether a peak of height 1 at the angle 0 is resolved. `shape` is its drop at distances in node distances."""
    refined = RefinedTractions(Tractions(()), (), ())
    stress = lambda angles: 1.0 - 0.01 * shape(angles / SPACING)  # noqa: E731
    return hoop._is_resolved(np.full(nodes, SPACING), refined, stress, 1.0, 0.0, 0.0)


def test_a_peak_needs_forty_nodes_in_contact() -> None:
    """The docstring of HoopPeak says so."""
    assert [is_resolved(np.square, nodes) for nodes in (0, 1, 39, 40, 60)] == [True, False, False, True, True]


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_cusp_on_either_side_is_not_resolved(side: float) -> None:
    assert is_resolved(lambda x: np.where(side * x > 0.0, x**2, 3.0 * x**2))
    assert not is_resolved(lambda x: np.where(side * x > 0.0, x**2, np.sqrt(np.abs(x))))
    assert not is_resolved(lambda x: np.where(side * x > 0.0, 10.0 * x**2, np.abs(x)))

"""The influence integrals of a grid as matrices of their own, from the operator that the solver fills."""

import math

import numpy as np

from fastpin.kernels import influence
from fastpin.model.grid import Grid


def log_integrals(grid: Grid, uniform: bool, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of direct and cross over every hat, seen from every node, shape (n, n) each."""
    n, (left, right) = grid.size, grid.knots()
    operator = np.empty((2 * n, 2 * n), order="F")
    influence.fill_operator(grid.theta, left, right, uniform, grid.closed, ratio, 0.0, operator)
    return 4.0 * math.pi * operator[n:, n:], 4.0 * math.pi * operator[:n, n:]

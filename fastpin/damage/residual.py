"""A residual hoop stress round a hole, as cold working leaves it, added to the stresses of all states."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fastpin.damage.histories import Progress
from fastpin.model.crack import residual_at
from fastpin.model.points import Body, Points, owner_of
from fastpin.model.problem import Problem

Blocks = Callable[[Progress], Iterator[tuple[slice, np.ndarray]]]
"""Yields blocks of points, with their stresses (states, points of the block, 4)."""


def with_residual(blocks: Blocks, problem: Problem, body: Body, points: Points, residual: Any) -> Blocks:
    """Return the blocks of points of a body with a residual stress of the plate, a number or pairs, added.

    It acts in the plate alone: pins and bushes keep their stresses.
    """
    if residual is None or owner_of(problem, body) != "plate":
        return blocks
    depth = np.broadcast_to(points.depths(problem, body), points.shape).ravel()
    hoop, theta = residual_at(residual, depth * problem.hole_radius), points.theta.ravel()
    cos, sin = np.cos(theta), np.sin(theta)
    added = hoop[:, None] * np.stack([sin * sin, cos * cos, np.zeros(theta.size), -sin * cos], axis=-1)

    def summed(progress: Progress) -> Iterator[tuple[slice, np.ndarray]]:
        for part, history in blocks(progress):
            yield part, history + added[part]

    return summed

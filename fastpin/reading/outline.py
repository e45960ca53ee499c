"""The hoop stress along the outline and the further holes of a plate of any outline.

It depends linearly on the harmonics of the tractions on the plate's own hole and on the loads. So the states of a
history take one product with a matrix. Straight lines join the nodal tractions: the power laws of contact edges fade in
the plate.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fastpin.bodies.compliance import state_columns
from fastpin.errors import InputError
from fastpin.model.grid import Grid
from fastpin.model.points import has_outline
from fastpin.model.problem import Problem
from fastpin.model.ties import top_angle


class OutlinePeak(NamedTuple):
    """The largest hoop stress along outline and further holes, Pa, and its place (x, y), m, on the edge of a name.

    `polyline` tells whether the edge stands for a curve: the stress is not that along a smooth edge.
    """

    value: float
    x: float
    y: float
    edge: str
    polyline: bool


class OutlineHoop(NamedTuple):
    """The hoop stress at points along the outline, counter-clockwise, and then along the further holes.

    Sharp corners and ends of supports are left out: the stress there is infinite, see
    :attr:`fastpin.lugs.PlateField.apart`.

    Attributes
    ----------
    x, y : ndarray, shape (m,)
        Points, m.
    along : ndarray, shape (m,)
        Their places along the edges, from the beginning of the outline, m.
    edges : list of str
        Names of their edges.
    polylines : set of str
        The edges that are polylines.
    hoop : ndarray, shape (..., m)
        Pa; tension is positive.
    """

    x: np.ndarray
    y: np.ndarray
    along: np.ndarray
    edges: list[str]
    polylines: set[str]
    hoop: np.ndarray

    @property
    def peak(self) -> OutlinePeak:
        """The largest stress of one state; of equal ones that farthest to the right of the hole."""
        at = top_angle(self.hoop, np.arctan2(self.y, self.x)) if self.edges else -1
        if at < 0:
            return OutlinePeak(math.nan, math.nan, math.nan, "", False)
        edge = self.edges[at]
        return OutlinePeak(float(self.hoop[at]), float(self.x[at]), float(self.y[at]), edge, edge in self.polylines)


def outline_hoop(
    problem: Problem, grid: Grid, pressure: np.ndarray, shear: np.ndarray, loads: np.ndarray
) -> OutlineHoop:
    """Return the hoop stress along the edges of a plate in several states, (k, m).

    Parameters
    ----------
    problem : Problem
        That of the plate's own hole: of the seat where a bush slips.
    grid : Grid
    pressure, shear : ndarray, shape (k, n)
        Tractions of the nodes, Pa.
    loads : ndarray, shape (k, 4)
        Loads of the plate sxx, syy and sxy, Pa, and the rise of its temperature, K.

    Raises
    ------
    InputError
        If the plate has no outline, or is rigid.
    """
    if not has_outline(problem):
        raise InputError("plate_body", "has no outline that is elastic: no other edge than that of the hole is known")
    body, radius = problem.plate_body, problem.hole_radius
    edges = body.along_edges
    column = body.lug.with_others(
        state_columns(problem.joint.hole, edges.order, grid, np.hstack([pressure, shear]), loads)
    )
    x, y = (np.where(np.abs(part) < 1e-12, 0.0, radius * part) for part in (edges.z.real, edges.z.imag))
    polylines = body.lug.geometry.polylines
    return OutlineHoop(x, y, radius * edges.along, edges.names, polylines, column @ edges.columns.T)

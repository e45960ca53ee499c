"""The curves of tractions, from edge to edge."""

from __future__ import annotations

import math

import numpy as np

from fastpin.model.angles import interval_near_bottom
from fastpin.reading.zones import ALL_ROUND, Interval, is_all_round
from fastpin.report.curves import Curve
from fastpin.states.state import State

NEAR = 1e-12
"""Distance below which two angles are equal, rad."""


def traction_curve(state: State, force: float = 1.0, **parameters: float | str) -> Curve:
    """Return pressure and shear traction of a state from edge to edge.

    The tractions are refined (:attr:`fastpin.states.state.State.refined`): beside contact edges and stick-slip borders
    they go like a root of the distance, and the points gather there.

    Parameters
    ----------
    state : State
        Of a dimensionless problem, :meth:`fastpin.Problem.from_load_parameter`.
    force : float
        The pin's load F in the units of the problem. Tractions are divided by it.
    parameters
        The curve's parameters.

    Returns
    -------
    Curve
        Columns ``angle_deg`` (from the bottom, counter-clockwise), ``N`` and ``T`` in F/R; N and T are 0 at the edges.
        Several contacts are separated by NaN. A contact all round goes from the top to the top.
    """
    parts: list[np.ndarray] = []
    for patch, ends in zip(state.refined.tractions.patches, state.contact_in_runs, strict=True):
        drawn = _from_the_top(patch) if is_all_round(ends[1] - ends[0]) else _from_edge_to_edge(patch, ends)
        parts.append(drawn)
    parts.sort(key=lambda part: float(part[0, 0]))
    gap = np.full((1, 3), np.nan)
    rows = [row for part in parts for row in (gap, part)][1:]
    theta, pressure, shear = np.vstack(rows).T if rows else np.empty((3, 0))
    bound = state.friction_at(theta) * pressure
    shear = np.clip(shear, -bound, bound)
    columns = {"angle_deg": np.degrees(theta) + 90.0, "N": pressure / force, "T": shear / force}
    return Curve(dict(parameters), columns)


def _from_the_top(patch: np.ndarray) -> np.ndarray:
    """Return the rows of a contact all round, shape (k + 1, 3), from the top to the top."""
    rows = patch[:-1].copy()
    rows[:, 0] = ALL_ROUND[0] + np.mod(rows[:, 0] - ALL_ROUND[0], 2.0 * math.pi)
    rows = rows[np.argsort(rows[:, 0])]
    return np.vstack([rows, rows[0] + [2.0 * math.pi, 0.0, 0.0]])


def _from_edge_to_edge(patch: np.ndarray, ends: Interval) -> np.ndarray:
    """Return the rows of a contact, shape (m, 3), from edge to edge, beside the bottom of the hole.

    At an edge without a power law the patch ends at the open node beyond. There a root leads to the edge.
    """
    part = np.linspace(0.0, 1.0, 13)[:-1, None] ** 2  # of the way from the edge to the first node
    for side, end in zip((1, -1), ends, strict=True):
        rows = patch[::side]
        if side * (end - rows[0, 0]) > NEAR:
            inside = rows[side * (rows[:, 0] - end) > NEAR]
            beside = np.hstack([end + part * (inside[:1, 0:1] - end), np.sqrt(part) * inside[:1, 1:]])
            patch = np.vstack([beside, inside])[::side]
    moved = patch.copy()
    moved[:, 0] += interval_near_bottom(*ends)[0] - ends[0]
    return moved

"""Computing the curves of the paper's figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from fastpin.kernels.status import OPEN
from fastpin.report.curves import Curve
from fastpin.states.state import State

Report = Callable[[float], None]
"""A callable that receives the computed fraction of a figure, 0 to 1."""

Item = TypeVar("Item")


def steps(items: Sequence[Item], progress: Report | None) -> Iterator[Item]:
    """Yield the items, and report the fraction that is done after each of them."""
    for index, item in enumerate(items):
        yield item
        if progress is not None:
            progress((index + 1) / len(items))


def traction_curve(state: State, force: float = 1.0, **parameters: float | str) -> Curve:
    """Return pressure and shear traction of a state from edge to edge, with zeros at the edges read between nodes.

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
        Columns ``angle_deg`` (from the bottom, counter-clockwise), ``N`` and ``T`` in F/R. Several contacts are
        separated by NaN.
    """
    parts: list[np.ndarray] = []
    for start, stop in state.contact:
        along = np.mod(state.theta - start, 2.0 * math.pi)
        inside = np.flatnonzero((state.status != OPEN) & (along < stop - start))
        inside = inside[np.argsort(along[inside])]
        part = np.array([start + along, state.pressure / force, state.shear / force])[:, inside]
        if stop - start < 2.0 * math.pi:  # else there are no edges
            part = np.hstack([[[start], [0.0], [0.0]], part, [[stop], [0.0], [0.0]]])
        parts += [np.full((3, 1), np.nan), part] if parts else [part]
    angle, pressure, shear = np.hstack(parts) if parts else np.empty((3, 0))
    return Curve(dict(parameters), {"angle_deg": np.degrees(angle) + 90.0, "N": pressure, "T": shear})

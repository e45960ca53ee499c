"""Error bars of the tractions between the nodes and at the nodes, from the curves of two grids.

The curves of :mod:`fastpin.states.curves` are compared. The bar of a curve is a sum of three terms:

* Roache's grid convergence index of the two curves (:func:`~fastpin.states.error_bars.pair_bar`). It takes the largest
  difference within :data:`AROUND`, since the curves cross each other.
* The change of the curve if the edges and borders nearby move by their own bars. Away from them the shift falls to 0.
* The floor of a traction in :data:`~fastpin.states.error_bars.FLOORS`.

The bar at a node is the bar of the curve plus the distance from the curve to the nodal value. Beside an edge the
nodal values miss the power law, which the curve follows.

``bench/accuracy.py`` counts how often the bars hold (docs/convergence.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fastpin.model.angles import angle_between
from fastpin.model.checks import numbers
from fastpin.model.grid import Grid
from fastpin.states.curves import traction_patches, tractions_at
from fastpin.states.error_bars import ORDER, bars, pair_bar, size_floor
from fastpin.states.quantities import QUANTITIES, quantity, sizes
from fastpin.states.state import ErrorBars, State

AROUND = np.linspace(-2.0, 2.0, 17)
"""Places round an angle at which the curves are compared, in node distances. They reach to the next coarse nodes.

With one node distance the shear beside old borders holds in 97.1 instead of 97.7 % of the points.
"""


class PairBars(ErrorBars):
    """The error bars of a state from the state at the same load on a `coarse` grid with half the intervals."""

    def __init__(self, state: State, coarse: State) -> None:
        self._state, self.coarse = state, coarse

    @cached_property
    def _bars(self) -> dict[str, float]:
        return bars(self._state, self.coarse)

    @cached_property
    def _of_tractions(self) -> np.ndarray:
        """The bars of pressure and shear traction at the nodes, read-only, shape (2, n)."""
        curves, found = _curves_and_bars(self._state, self, self._state.theta)
        found += np.abs(curves - np.array([self._state.pressure, self._state.shear]))
        found.setflags(write=False)
        return found

    @cached_property
    def pressure(self) -> np.ndarray:
        return self._of_tractions[0]

    @cached_property
    def shear(self) -> np.ndarray:
        return self._of_tractions[1]

    def of_curves(self, theta: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        # They are 0 where neither grid has contact nearby.
        angles = numbers("theta", theta)
        pressure, shear = _curves_and_bars(self._state, self, angles.ravel())[1]
        return pressure.reshape(angles.shape), shear.reshape(angles.shape)

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} {bar:.2g}" for name, bar in self.items() if not math.isnan(bar))
        return f"<ErrorBars from {self.coarse.grid.size} nodes: {shown}>"

    def __getitem__(self, name: str) -> float:
        return self._bars[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bars)

    def __len__(self) -> int:
        return len(self._bars)


def _curves_and_bars(state: State, bars: ErrorBars, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The tractions of the curves at some angles, rad, and their bars, shape (2, m) each."""
    fine, coarse = traction_patches(state), traction_patches(bars.coarse)
    angle, spacing = np.degrees(theta) + 90.0, np.degrees(_spacing(state.grid, theta))
    curves, index = tractions_at(fine, angle), np.zeros((2, theta.size))
    for place in AROUND:
        near = angle + place * spacing
        one, two = tractions_at(fine, near), tractions_at(coarse, near)
        index = np.maximum(index, pair_bar(one, two, ORDER))
    shift = np.zeros(theta.size)  # the largest one by an edge or border near each angle, rad
    for name in (name for name in bars if name not in QUANTITIES):  # ends of zones
        place = quantity(name).of(state)
        (beside,) = _spacing(state.grid, np.array([place]))
        away = np.abs(angle_between(theta, place)) / (4.0 * beside)
        # The difference of the curves shows a larger shift by itself. An end without a counterpart has an infinite bar.
        shift = np.maximum(shift, min(bars[name], 2.0 * beside) * np.maximum(1.0 - away, 0.0))
    shift = np.degrees(shift)  # an edge is moved by parts of it, and the largest change counts
    moved = [np.abs(tractions_at(fine, angle + part * shift) - curves) for part in (-1.0, -0.5, 0.5, 1.0)]
    floor = size_floor("traction", sizes(state)["traction"], state) * ((index > 0.0) | (curves != 0.0))
    return curves, index + np.max(moved, axis=0) + floor


def _spacing(grid: Grid, theta: np.ndarray) -> np.ndarray:
    """The node distance at some angles, rad, shape (m,)."""
    left, right = grid.knots()
    spacing = np.maximum(right - grid.theta, grid.theta - left)  # the end of an arc has one neighbour
    return np.interp(theta, grid.theta, spacing, period=2.0 * np.pi)

"""Error bars of a state from the same load on a grid with half the intervals.

The bar of a quantity is Roache's grid convergence index of two grids, for an assumed order of one
(:func:`fastpin.extrapolate.pair_bar`), and a floor for what happens to be the same on both grids. The constants below
are all there is to choose; ``scripts/error_bars.py`` counts how often the bars hold (docs/convergence.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from fastpin.model.angles import angle_between
from fastpin.states.quantities import QUANTITIES, intervals, matching_values, quantity, size, values, width
from fastpin.states.state import State

ORDER = 1.0
"""The order that is assumed: that of borders beside older ones. All else has 1.5 to 2, with some scatter."""

PEAK_FLOORS = 1.0, 0.2
"""Of a peak that is read at a node, and between nodes, in parts of what the traction falls by from there to the lower
one of the two nodes beside it."""

PLACE_FLOOR, PEAK_PLACE_FLOOR = 0.2, 1.0
"""Of each end of an interval, also in a width, and of the angle of a peak, in parts of the node distance."""

FLOORS = {
    "shear_magnitude": 4.0,
    "force": 0.6,
    "moment": 0.3,
    "rotation": 0.15,
    "displacement": 0.1,
    "energy": 0.06,
}
"""Of all else, by name or kind, in parts of its size (:func:`fastpin.quantities.size`) over the square of the number of
nodes in contact. int |T| has kinks at earlier borders and where the sign changes."""

ROUNDING = 1e-11
"""What is the same on both grids to so small a part of its size is so by symmetry or equilibrium, and has no floor."""

MAY_BE_EXACT = ("force", "moment", "rotation", "displacement")
"""Kinds of which this is true. Places that are read at nodes of both grids agree without being exact."""

LEAST_COARSE = 51
"""Nodes of the coarse grid."""

SAME_TOP = 1.5
"""Node distances from a peak within which a local maximum of the nodal values is the peak itself."""


def bars(state: State, coarse: State) -> dict[str, float]:
    """Error bars of all quantities of a state, in their units, angles in rad.

    The true value, that of ever finer grids, lies within a bar in some 95 of 100 cases. NaN belongs to a quantity that
    is NaN, inf to one that the coarse grid has nothing to compare with: the ends of zones that are not as many there.
    The angle of a peak that is as high elsewhere, within its bar, has a bar that reaches there.

    Parameters
    ----------
    state, coarse : State
        At the same load, `coarse` on a grid with about twice the node distance.
    """
    mine, theirs = values(state), matching_values(state, coarse)
    found = {name: _bar(name, value, theirs[name], state) for name, value in mine.items()}
    for name, traction in (("peak_pressure", state.pressure), ("peak_shear", np.abs(state.shear))):
        highest = state.theta[_as_high(state, traction, found[name])]
        others = np.abs(angle_between(highest, mine[f"{name}_angle"]))
        others = others[others > SAME_TOP * float(state.grid.weights.max())]
        if others.size:
            known = found[f"{name}_angle"]
            found[f"{name}_angle"] = max(float(others.max()), known if math.isfinite(known) else 0.0)
    return found


def _bar(name: str, value: float, other: float, state: State) -> float:
    if math.isnan(value):
        return math.nan
    if math.isnan(other):
        return math.inf
    if value == other == 0.0:
        return 0.0
    rounding = ROUNDING * size(name, state)
    if abs(value - other) <= rounding and quantity(name).kind in MAY_BE_EXACT:
        return rounding
    return pair_bar(value, other, ORDER) + _floor(name, state)


def _floor(name: str, state: State) -> float:
    """What a bar is at least, where the values of the two grids are no guide."""
    closed = max(1, int(np.count_nonzero(state.pressure)))
    kind = quantity(name).kind
    if name in ("peak_pressure", "peak_shear"):
        traction = state.pressure if name == "peak_pressure" else np.abs(state.shear)
        top = int(np.argmax(traction))
        beside = traction[[top - 1, (top + 1) % traction.size]]
        peak = abs(QUANTITIES[name].of(state))
        floor = PEAK_FLOORS[int(peak > (1.0 + 1e-12) * float(traction[top]))]
        return floor * max(peak - float(beside.min()), 0.0)
    if kind in ("angle", "width"):
        ends = 1 if kind == "angle" else _ends(state, name.removesuffix("_width"))
        floor = PEAK_PLACE_FLOOR if name in QUANTITIES and kind == "angle" else PLACE_FLOOR
        return floor * ends * spacing(state)
    return FLOORS.get(name, FLOORS[kind]) * size(name, state) / closed**2


def spacing(state: State) -> float:
    """Mean node distance in the contact, rad."""
    return width(state.contact) / max(1, int(np.count_nonzero(state.pressure)))


def _ends(state: State, zone: str) -> int:
    """The number of ends that the width of a zone depends on; where there is no zone there may be one between nodes."""
    return 2 * len(intervals(state, zone)) if getattr(state, zone) else 2


def _as_high(state: State, traction: np.ndarray, bar: float) -> np.ndarray:
    """Nodes with a local maximum of a traction that may be the largest one."""
    before, after = np.roll(traction, 1), np.roll(traction, -1)
    if not state.grid.closed:
        before[0] = after[-1] = 0.0
    highest = (traction > 0.0) & (traction >= before) & (traction >= after)
    return np.flatnonzero(highest & (traction >= traction.max() - 2.0 * bar))


SAFETY = 1.25


def pair_bar(fine: float, coarse: float, order: float, ratio: float = 2.0) -> float:
    """Roache's grid convergence index of two grids: the error bar of the fine value for an order that is assumed.

    `ratio` is that of the spacings, coarse to fine.
    """
    return SAFETY * abs(fine - coarse) / (ratio**order - 1.0)


class ErrorBars(Mapping[str, float]):
    """Error bars of one state, computed when they are first read; see :func:`bars`.

    Parameters
    ----------
    state, coarse : State
        At the same load, `coarse` on a grid with half the intervals.
    """

    def __init__(self, state: State, coarse: State) -> None:
        self._state = state
        self.coarse = coarse

    @cached_property
    def _bars(self) -> dict[str, float]:
        return bars(self._state, self.coarse)

    def __getitem__(self, name: str) -> float:
        return self._bars[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bars)

    def __len__(self) -> int:
        return len(self._bars)

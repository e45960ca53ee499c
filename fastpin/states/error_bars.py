"""Error bars of a state, from the same load on a grid with half the intervals.

The bar of a quantity is a sum of two terms. The first is Roache's grid convergence index of two grids, for an assumed
order of one (:func:`pair_bar`). The second is a floor, because two values may agree by chance. The constants below are
the only free choices. ``bench/accuracy.py`` counts how often the bars hold (docs/convergence.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from fastpin import reading
from fastpin.errors import InputError
from fastpin.model.angles import angle_between
from fastpin.model.checks import numbers
from fastpin.model.grid import Grid
from fastpin.model.ties import is_top, top_angle
from fastpin.states.curves import traction_patches, tractions_at
from fastpin.states.quantities import QUANTITIES, intervals, matching_values, quantity, size, sizes, values, width
from fastpin.states.state import ErrorBars, State

if TYPE_CHECKING:  # it takes long to import
    from numpy.typing import ArrayLike

ORDER = 1.0
"""Assumed order of convergence.

Stick-slip borders beside older borders converge with this order. All other quantities have 1.5 to 2, with some scatter.
"""

PLACE_FLOOR, PEAK_PLACE_FLOOR = 0.2, 1.0
"""Floors of each end of an interval, and of the angle of a peak, in node distances.

A width has the floor of each of its ends.
"""

FLOORS = {
    "shear_magnitude": 4.0,
    "force": 0.6,
    "moment": 0.3,
    "rotation": 0.15,
    "displacement": 0.1,
    "energy": 0.06,
    "traction": 0.6,
}
"""Floors of all other quantities, by name or kind.

The unit is the size of the quantity (:func:`fastpin.states.quantities.size`) over the square of the number of nodes in
contact. The floor of int |T| is large: |T| has kinks at earlier borders and where the sign of T changes.
"""

LEAST_COARSE = 51
"""Least number of nodes of the coarse grid."""


def bars(state: State, coarse: State) -> dict[str, float]:
    """Error bars of all quantities of a state, in their units, angles in rad.

    The true value is the limit on ever finer grids. It lies within the bar in some 95 of 100 cases. If the traction is
    nearly as high as the peak at another place, to within the bar of the peak, the bar of the angle reaches to there.

    Parameters
    ----------
    state, coarse : State
        States at the same load; the grid of `coarse` has about twice the node distance.

    Returns
    -------
    dict of str to float
        Bars >= 0 by the names of :func:`fastpin.states.quantities.values`. NaN if the quantity is NaN. inf if the
        coarse state has no value to compare: the ends of zones whose number differs between the two states.
    """
    mine, theirs = values(state), matching_values(state, coarse)
    found = {name: value_bar(name, value, theirs[name], [state]) for name, value in mine.items()}
    for name, traction in (("peak_pressure", state.pressure), ("peak_shear", np.abs(state.shear))):
        before, after = np.roll(traction, 1), np.roll(traction, -1)
        if not state.grid.closed:
            before[0] = after[-1] = 0.0
        is_peak = (traction > 0.0) & (traction >= before) & (traction >= after)
        # A peak within twice the bar may be the highest. Of equal largest values a rule takes one: they do not count.
        is_high = is_peak & ~is_top(traction) & (traction >= traction.max() - 2.0 * found[name])
        others = np.abs(angle_between(state.theta[np.flatnonzero(is_high)], mine[f"{name}_angle"]))
        others = others[others > 1.5 * float(state.grid.weights.max())]  # nearer maxima are the peak itself
        if others.size:
            known = found[f"{name}_angle"]
            found[f"{name}_angle"] = max(float(others.max()), known if math.isfinite(known) else 0.0)
    return found


def known_bar(name: str, state: State) -> float:
    """Bar of a quantity of a state, in its unit, angles in rad: that of its error bars.

    Without error bars it is inf if the nodes do not resolve the value. It is NaN if there is none.
    """
    if state.error_bars is not None:
        return state.error_bars.get(name, math.nan)
    return math.nan if quantity(name).is_resolved(state) else math.inf


def value_bar(name: str, value: float, other: float, states: Sequence[State]) -> float:
    """Error bar of one value of a quantity, or of a number that is taken from the quantity at several states.

    Parameters
    ----------
    name : str
        Name of the quantity.
    value, other : float
        The number on the grid of the states, and on the coarse grid. Angles are next to each other.
    states : sequence of State
        The states that the number was read from. Each has a floor.

    Returns
    -------
    float
        See :func:`bars`.
    """
    kind = quantity(name).kind
    bar = _known_bar(kind, value, other, size(name, states[-1]))
    return pair_bar(value, other, ORDER) + sum(_floor(name, state) for state in states) if bar is None else bar


def number_bar(kind: str, value: float, other: float, state: State) -> float:
    """Error bar of any number of a history that is no quantity of one state.

    Parameters
    ----------
    kind : str
        A kind of quantity. Numbers of kinds that states do not have get no floor: such a bar is too small where two
        grids agree by chance. The bar of a class is the difference of the two classes.
    value, other : float
        The number on the grid of the state, and on the coarse grid. Angles are next to each other.
    state : State
        The last state of the history.

    Returns
    -------
    float
        See :func:`bars`.
    """
    if kind == "class":
        return math.inf if math.isnan(other) else abs(value - other)
    natural_size, floor = sizes(state).get(kind, 0.0), 0.0
    if kind in ("angle", "width"):
        floor = PEAK_PLACE_FLOOR * spacing(state)
    elif kind in FLOORS:
        floor = size_floor(kind, natural_size, state)
    bar = _known_bar(kind, value, other, natural_size)
    return pair_bar(value, other, ORDER) + floor if bar is None else bar


def _known_bar(kind: str, value: float, other: float, natural_size: float) -> float | None:
    """The bar of a value that is missing on a grid, or exact; None for all other values."""
    if math.isnan(value):
        return math.nan
    if math.isnan(other):
        return math.inf
    if value == other == 0.0:
        return 0.0
    rounding = 1e-11 * natural_size
    # These may be exact, by symmetry or equilibrium: their bar is the rounding, without a floor. Ends read at nodes of
    # both grids agree, but are not exact.
    if abs(value - other) <= rounding and kind in ("force", "moment", "rotation", "displacement"):
        return rounding
    return None


def _floor(name: str, state: State) -> float:
    """Floor of the bar of a quantity, added to the grid convergence index: the two values may agree by chance."""
    closed = _closed(state)
    kind = quantity(name).kind
    if name in ("peak_pressure", "peak_shear"):
        traction = state.pressure if name == "peak_pressure" else np.abs(state.shear)
        top = top_angle(traction, state.theta)
        beside = traction[[top - 1, (top + 1) % traction.size]]
        peak = abs(QUANTITIES[name].of(state))
        # The floor is the drop to the lower neighbour, or 0.2 of it for a peak that is read between nodes.
        floor = 0.2 if peak > (1.0 + 1e-12) * float(traction[top]) else 1.0
        return floor * max(peak - float(beside.min()), 0.0)
    if quantity(name).edge is not None and kind != "angle":
        part = 0.2 / closed if quantity(name).is_resolved(state) else reading.hoop.UNRESOLVED
        return part * abs(QUANTITIES[name].of(state))
    if kind in ("angle", "width"):
        zone, ends = name.removesuffix("_width"), 1
        if kind == "width":  # without any zone there may be one between two nodes
            ends = 2 * len(intervals(state, zone)) if getattr(state, zone) else 2
        floor = PEAK_PLACE_FLOOR if name in QUANTITIES and kind == "angle" else PLACE_FLOOR
        return floor * ends * spacing(state)
    return size_floor(name if name in FLOORS else kind, size(name, state), state)


def size_floor(kind: str, natural_size: float, state: State) -> float:
    """Floor of a name or kind of :data:`FLOORS`, in the unit of its natural size."""
    return FLOORS[kind] * natural_size / _closed(state) ** 2


def spacing(state: State) -> float:
    """Mean node distance in the contact, rad."""
    return width(state.contact) / _closed(state)


def check_nodes(nodes: int) -> None:
    """Raise :class:`InputError` if a grid has too few nodes for error bars."""
    if (nodes + 1) // 2 < LEAST_COARSE:
        least = 2 * LEAST_COARSE - 1
        raise InputError(
            "nodes", f"must be at least {least} for error bars, not {nodes}: a second run takes half of them"
        )


def _closed(state: State) -> int:
    """Number of nodes in contact, at least 1."""
    return max(1, int(np.count_nonzero(state.pressure)))


SAFETY = 1.25
"""Safety factor of Roache's grid convergence index."""


Values = TypeVar("Values", float, np.ndarray)


def pair_bar(fine: Values, coarse: Values, order: float, ratio: float = 2.0) -> Values:
    """Roache's grid convergence index of two grids: the error bar of the fine value for an assumed order.

    The bar is 1.25 |fine - coarse| / (ratio^order - 1), in the unit of the values.

    Parameters
    ----------
    fine, coarse : float or ndarray
        Values of one quantity on the two grids.
    order : float
        Assumed order of convergence, positive.
    ratio : float
        Node distance of the coarse grid over the node distance of the fine one, above 1.
    """
    return SAFETY * abs(fine - coarse) / (ratio**order - 1.0)


# -- tractions between the nodes and at the nodes ---------------------------------------------------------------


AROUND = np.linspace(-2.0, 2.0, 17)
"""Places round an angle at which the curves are compared, in node distances. They reach to the next coarse nodes.

With one node distance the shear beside old borders holds in 97.1 instead of 97.7 % of the points.
"""


class PairBars(ErrorBars):
    """The error bars of a state from the state at the same load on a `coarse` grid with half the intervals.

    The bar of a traction comes from the curves of both states, see :mod:`fastpin.states.curves`. It is a sum of three
    terms:

    * Roache's grid convergence index of the two curves (:func:`pair_bar`). It takes the largest difference within
      :data:`AROUND`, since the curves cross each other.
    * The change of the curve if the edges and borders nearby move by their own bars. Away from them the shift falls
      to 0.
    * The floor of a traction in :data:`FLOORS`.

    The bar at a node is the bar of the curve plus the distance from the curve to the nodal value. Beside an edge the
    nodal values miss the power law, which the curve follows.
    """

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
    return np.interp(theta, grid.theta, np.maximum(*grid.halves), period=2.0 * np.pi)

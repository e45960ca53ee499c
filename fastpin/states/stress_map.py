"""The stress at points as a linear function of the nodal tractions: straight lines between the nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fastpin.elasticity.tractions import Tractions
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, STRESSING
from fastpin.model.problem import Problem

if TYPE_CHECKING:  # this module imports compiled code
    from fastpin.states.state import State

NodalTractions = tuple[np.ndarray, np.ndarray]
"""Pressure and shear of the nodes of an interface, shape (k, n) each."""


def spacings(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Distances from each node to its neighbours on the left and on the right, rad, shape (n,)."""
    before, after = grid.halves
    return np.where(before > 0.0, before, after), np.where(after > 0.0, after, before)


class StressMap:
    """The stress at points as a linear function of the nodal tractions at the pin and in the seat of a bush.

    A node has a unit hat traction as pressure and as shear, and stress columns once it is learned.

    Parameters
    ----------
    problem : Problem
    grids : sequence of Grid
        Nodes of the pin and, with a bush that slips, of its seat.
    stress : callable
        ``stress(tractions, remote)`` gives components at the points, shape (components, m), from the tractions of each
        interface and the loads that stress a plate, shape (4,): sxx, syy, sxy and the temperature.

    Attributes
    ----------
    components : int
    """

    def __init__(
        self, problem: Problem, grids: Sequence[Grid], stress: Callable[[list[Tractions], np.ndarray], np.ndarray]
    ) -> None:
        self._grids, self._stress, self._none = grids, stress, [Tractions(())] * len(grids)
        self._unit = problem.press_fit_pressure or 1.0  # beside the stress of a press fit 1 Pa is rounding
        self._press_fit = stress(self._none, np.zeros(len(STRESSING)))
        self._remote = np.array(
            [stress(self._none, self._unit * one) - self._press_fit for one in np.eye(len(STRESSING))]
        )
        self._remote /= self._unit
        self.components, points = self._press_fit.shape
        self._known = [np.zeros(grid.size, dtype=bool) for grid in grids]
        self._response = [np.zeros((2, self.components, grid.size, points)) for grid in grids]

    def learn(self, tractions: Sequence[NodalTractions], progress: Callable[[float], None] | None = None) -> None:
        """Learn the stresses of all nodes that pressures and shears (k, n) of each interface load."""
        for place, (grid, (pressure, shear)) in enumerate(zip(self._grids, tractions, strict=True)):
            loaded = (pressure != 0.0).any(axis=0) | (shear != 0.0).any(axis=0)
            (before, after), known = spacings(grid), self._known[place]
            for node in np.flatnonzero(loaded & ~known).tolist():
                angles = grid.theta[node] + np.array([-before[node], 0.0, after[node]])
                for which, column in enumerate((1, 2)):
                    hat = np.zeros((3, 3))
                    hat[:, 0], hat[1, column] = angles, self._unit
                    whole = [*self._none[:place], Tractions((hat,)), *self._none[place + 1 :]]
                    found = (self._stress(whole, np.zeros(len(STRESSING))) - self._press_fit) / self._unit
                    self._response[place][which, :, node] = found
                if progress is not None:
                    progress((place + node / grid.size) / len(self._grids))
            known |= loaded

    def component(
        self, which: int, tractions: Sequence[NodalTractions], remote: np.ndarray, points: slice = slice(None)
    ) -> np.ndarray:
        """Return a component, shape (k, m), of tractions that were learned and loads of the plate (k, 4)."""
        total = 0.0
        for known, response, (pressure, shear) in zip(self._known, self._response, tractions, strict=True):
            own = response[:, which, :, points]
            total = total + (pressure[:, known] @ own[0, known] + shear[:, known] @ own[1, known])
            if response is self._response[0]:
                total = total + remote @ self._remote[:, which, points] + self._press_fit[which, points]
        return np.asarray(total)


def share_map(states: Sequence[State]) -> bool:
    """Whether one linear function gives the stresses of all states: they have the same bodies and nodes."""
    first = states[0]
    if any(state.problem != first.problem for state in states):  # what other pins do to a hole differs
        return False
    pairs = ((each, other) for state in states for each, other in ((state, first), (state.seat, first.seat)))
    return all(one is two if one is None or two is None else np.array_equal(one.theta, two.theta) for one, two in pairs)


def mapped(
    states: Sequence[State],
    stress: Callable[[list[Tractions], np.ndarray], np.ndarray],
    progress: Callable[[float], None] | None = None,
) -> np.ndarray:
    """Return the components of many states by one product, shape (components, states, m).

    Parameters
    ----------
    states : sequence of State
        States that share their grids.
    stress : callable
        See :class:`StressMap`.
    progress : callable, optional
        It is told the part that is done, 0 to 1.
    """
    seats = [state.seat for state in states if state.seat is not None]
    parts = [part for part in (states, seats) if part]
    tractions = [(np.array([one.pressure for one in part]), np.array([one.shear for one in part])) for part in parts]
    names = [list(LOADS)[place] for place in STRESSING]
    remote = np.array([[state.load.get(name, 0.0) for name in names] for state in states])
    linear = StressMap(states[0].problem, [part[0].grid for part in parts], stress)
    linear.learn(tractions, progress)
    found = np.array([linear.component(which, tractions, remote) for which in range(linear.components)])
    if progress is not None:
        progress(1.0)
    return found

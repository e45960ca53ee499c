"""The stress at points as a linear function of the nodal tractions: straight lines between the nodes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fastpin.elasticity.tractions import Tractions
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.problem import Problem

if TYPE_CHECKING:  # this module imports compiled code
    from fastpin.states.state import State

NodalTractions = tuple[np.ndarray, np.ndarray]
"""Pressure and shear of the nodes of an interface, shape (k, n) each."""


def spacings(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Distances from each node to its neighbours on the left and on the right, rad, shape (n,)."""
    left, right = grid.knots()
    before, after = grid.theta - left, right - grid.theta
    return np.where(before > 0.0, before, after), np.where(after > 0.0, after, before)


class Hats:
    """Unit hat tractions, and which of them have stress columns already.

    Parameters
    ----------
    problem : Problem
    grid : Grid

    Attributes
    ----------
    known : ndarray of bool, shape (n,)
    unit : float
        Height of the hats. Beside the stress of a press fit a traction of 1 Pa is rounding.
    """

    def __init__(self, problem: Problem, grid: Grid) -> None:
        self._grid, self.known, self.unit = grid, np.zeros(grid.size, dtype=bool), problem.press_fit_pressure or 1.0

    def blocks(self, pressure: np.ndarray, shear: np.ndarray) -> Iterator[tuple[np.ndarray, list[Tractions]]]:
        """Give all nodes (k,) that these tractions (m, n) load and that are not known yet, and then know them.

        With some nodes come their hats as pressures, and then as shears.
        """
        loaded = (pressure != 0.0).any(axis=0) | (shear != 0.0).any(axis=0)
        new, (before, after) = np.flatnonzero(loaded & ~self.known), spacings(self._grid)
        for begin in range(0, new.size, 32):  # elasticity/stress.py remembers the fields of so many nodes
            nodes = new[begin : begin + 32]
            hats = np.zeros((2, nodes.size, 3, 3))
            hats[..., 0] = self._grid.theta[nodes, None] + np.array([-before[nodes], 0.0 * nodes, after[nodes]]).T
            hats[0, :, 1, 1] = hats[1, :, 1, 2] = self.unit
            yield nodes, [Tractions((hat,)) for hat in hats.reshape(-1, 3, 3)]
        self.known[new] = True


class NodalStress:
    """The stress at points of a body as a linear function of the nodal tractions: straight lines between the nodes.

    Parameters
    ----------
    hats : Hats
    stress : callable
        ``stress(tractions, remote)`` gives components at the points, such as (srr, stt, srt), shape (3, m).
    """

    def __init__(self, hats: Hats, stress: Callable[[Tractions, np.ndarray], np.ndarray]) -> None:
        self._hats, self._stress, self._unit = hats, stress, hats.unit
        self._press_fit = stress(Tractions(()), np.zeros(3))
        self._remote = np.array([stress(Tractions(()), self._unit * one) - self._press_fit for one in np.eye(3)])
        self._remote /= self._unit
        components, points = self._press_fit.shape
        self._response = np.zeros((2, components, hats.known.size, points))

    def learn(self, nodes: np.ndarray, hats: Sequence[Tractions]) -> None:
        """Compute the stresses of the hat functions of some `nodes` (k,), see :meth:`Hats.blocks`."""
        for place, hat in enumerate(hats):
            found = (self._stress(hat, np.zeros(3)) - self._press_fit) / self._unit
            self._response[place // nodes.size, :, nodes[place % nodes.size]] = found

    def component(self, which: int, pressure: np.ndarray, shear: np.ndarray, remote: np.ndarray) -> np.ndarray:
        """Return a component at the points, shape (k, m), of tractions (k, n) and remote stresses (k, 3)."""
        known, response = self._hats.known, self._response[:, which]
        found = pressure[:, known] @ response[0, known] + shear[:, known] @ response[1, known]
        return np.asarray(found + remote @ self._remote[:, which] + self._press_fit[which])


class StressMap:
    """The stress at points of a body as a linear function of the nodal tractions at the pin and in the seat of a bush.

    Parameters
    ----------
    problem : Problem
    grids : sequence of Grid
        Nodes of the pin and, with a bush that slips, of its seat.
    stress : callable
        ``stress(tractions, remote)`` gives components at the points, shape (components, m), from the tractions of each
        interface.

    Attributes
    ----------
    components : int
    """

    def __init__(
        self, problem: Problem, grids: Sequence[Grid], stress: Callable[[list[Tractions], np.ndarray], np.ndarray]
    ) -> None:
        none = [Tractions(())] * len(grids)
        unloaded = stress(none, np.zeros(3))
        self.components = len(unloaded)

        def of_pin(tractions: Tractions, remote: np.ndarray) -> np.ndarray:
            return stress([tractions, *none[1:]], remote)

        def of_seat(tractions: Tractions, _: np.ndarray) -> np.ndarray:
            return stress([*none[:1], tractions], np.zeros(3)) - unloaded

        self._hats = [Hats(problem, grid) for grid in grids]
        self._parts = [NodalStress(hats, of) for hats, of in zip(self._hats, (of_pin, of_seat), strict=False)]

    def learn(self, tractions: Sequence[NodalTractions], progress: Callable[[float], None] | None = None) -> None:
        """Learn the stresses of all nodes that pressures and shears (k, n) of each interface load."""
        for place, (hats, part, (pressure, shear)) in enumerate(zip(self._hats, self._parts, tractions, strict=True)):
            for nodes, functions in hats.blocks(pressure, shear):
                part.learn(nodes, functions)
                if progress is not None:
                    progress((place + float(nodes[-1]) / hats.known.size) / len(self._hats))

    def component(self, which: int, tractions: Sequence[NodalTractions], remote: np.ndarray) -> np.ndarray:
        """Return a component, shape (k, m), of tractions that were learned, and remote stresses (k, 3)."""
        parts = zip(self._parts, tractions, strict=True)
        return np.asarray(sum(part.component(which, *values, remote) for part, values in parts))


def share_grids(states: Sequence[State]) -> bool:
    """Whether all states have the same nodes, and so have their seats."""
    first = states[0]
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
    names = [list(LOADS)[place] for place in REMOTE]
    remote = np.array([[state.load.get(name, 0.0) for name in names] for state in states])
    linear = StressMap(states[0].problem, [part[0].grid for part in parts], stress)
    linear.learn(tractions, progress)
    found = np.array([linear.component(which, tractions, remote) for which in range(linear.components)])
    if progress is not None:
        progress(1.0)
    return found

"""The gap beyond an arc of nodes: the pin may touch the hole there too."""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem
from fastpin.elasticity.system import System
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import REMOTE
from fastpin.model.problem import Problem
from fastpin.solver.configuration import SLIGHT, Configuration
from fastpin.solver.interfaces import part_of


class OutsideGap:
    """The gap beyond an arc of nodes, at up to 180 angles: a pin may touch there too.

    Where a bush slips, the tractions in its seat bend its bore.

    Parameters
    ----------
    system : System
        On an arc.

    Attributes
    ----------
    of : object
        The operator of `system`. Systems with this operator have the same gap beyond the arc.
    """

    def __init__(self, system: System) -> None:
        self.of: object = system.operator
        self._joint = system if isinstance(system, JointSystem) else None
        system = self._own(system)
        grid = system.grid
        n, ends = grid.size, (grid.theta[-1], grid.theta[0] + 2.0 * math.pi)
        count = min(math.ceil((ends[1] - ends[0]) / node_spacing(grid)) - 1, 180)
        self._theta = np.linspace(*ends, max(count, LEAST_NODES) + 2)[1:-1]
        around = System.build(system.problem, Grid(np.r_[grid.theta, self._theta], closed=True), system.scales.force)
        rows, nodes = np.arange(n, around.grid.size), np.arange(n)
        self._operator = around.operator.entries(rows, np.r_[nodes, around.grid.size + nodes])
        self._moved, self._loads = around.motion[rows], around.loads[rows].copy()
        self._rest: tuple[np.ndarray, Problem, np.ndarray] | None = None  # the latest gap at rest
        if self._joint is not None:  # the remote stress acts on the lug alone
            self._loads[:, REMOTE] = 0.0
            self._bore = self._joint.bore_at(self._theta)

    @staticmethod
    def _own(system: System) -> System:
        """The system of the pin."""
        return system.alone[PIN] if isinstance(system, JointSystem) else system

    def is_closed(self, system: System, now: Configuration) -> bool:
        """Whether the pin, in contact on the arc, penetrates the hole beyond it by more than rounding."""
        bent: float | np.ndarray = 0.0
        if self._joint is not None:
            bent = self._bore @ now.tractions[self._joint.nodes.rows(SEAT)]
            system, now = self._own(system), part_of(self._joint, now, PIN)
        if not now.closed.any():  # a floating pin is looked after by the first contact
            return False
        elastic = self._operator @ now.tractions + bent
        moved = self._moved @ now.motion + self._loads @ now.load[: self._loads.shape[1]]
        known = self._rest
        if known is None or known[0] is not now.rest_gap or known[1] is not system.problem:
            known = self._rest = now.rest_gap, system.problem, rest_gap_at(system, now, self._theta)
        lowest = float((elastic + moved + known[2]).min())
        return lowest < 0.0 and lowest < -SLIGHT * float(max(np.abs(elastic).max(), np.abs(moved).max()))


def rest_gap_at(system: System, now: Configuration, theta: np.ndarray) -> np.ndarray:
    """The gap of the resting pin, shape (k,), at angles `theta` (k,) beyond the nodes of an arc.

    It differs from the gap at the end of the arc by the first harmonic of the resting position, and by the initial gap.
    The sines keep the digits of small gaps in a large clearance.
    """
    ends = system.grid.theta[[0, -1]]
    nearest = np.argmin(np.abs(theta[:, None] - ends), axis=1)
    end = ends[nearest]
    x, y = np.where(system.drive.axes, 0.0, now.rest)
    middle, half = 0.5 * (theta + end), 0.5 * (theta - end)
    change: np.ndarray = 2.0 * np.sin(half) * (x * np.sin(middle) - y * np.cos(middle))
    if system.problem.gap:
        change += (system.problem.gap_at(theta)[0] - system.problem.gap_at(end)[0]) / system.scales.displacement
    return now.rest_gap[[0, -1]][nearest] + change


def node_spacing(grid: Grid) -> float:
    """Distance of neighbouring nodes of a uniform arc, rad."""
    return float(grid.theta[-1] - grid.theta[0]) / (grid.size - 1)

"""States of the contact and the result of a solution; edges and peaks read between nodes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np

from fastpin import errorbars, zones
from fastpin.grid import Grid
from fastpin.loading import LoadHistory
from fastpin.problem import Problem

if TYPE_CHECKING:
    from fastpin.run import Restart

SLIP_NEGATIVE, STICK, SLIP_POSITIVE, OPEN = -1, 0, 1, 2
"""Status of a node: slipping clockwise, sticking, slipping counter-clockwise (pin over plate), open."""

Interval = zones.Interval


@dataclass(frozen=True, eq=False)
class State:
    """The contact at one load. Its arrays can't be written to: steps that repeat share them.

    Attributes
    ----------
    step : int
        Index of the load corner that this state belongs to (0 for the first).
    fraction : float
        How far along the step from the previous corner, 0 to 1; 1 at the corner itself.
    load : dict of str to float
        Loads by name, see :data:`fastpin.loading.LOADS`.
    theta : ndarray, shape (n,)
        Node angles, rad; -pi/2 is the bottom of the hole.
    pressure, shear : ndarray, shape (n,)
        Contact pressure N >= 0 and shear traction T on the pin, positive along +theta (counter-clockwise), Pa.
    gap, slip : ndarray, shape (n,)
        Gap h >= 0 and slip s of the pin over the plate, positive along +theta, m. Slip counts from the position
        in which the pin first rested on the hole (for an interference fit: the concentric one).
    status : ndarray of int8, shape (n,)
        OPEN, STICK, SLIP_POSITIVE or SLIP_NEGATIVE. Without friction every closed node is SLIP_POSITIVE.
    dx, dy, rotation : float
        Rigid motion of the pin along +x, +y (m) and counter-clockwise (rad) from its first resting position.
        In the paper's symbols C_0x, -Delta and C_omega; C_omega also where a hub of another radius is held.
    dissipation, work, energy : float
        Energy dissipated by friction so far, work of the loads so far and elastic energy now, J/m. Work and energy
        leave out what depends on the load alone (infinite for a load at a point), so they may be negative. An
        interference fit begins with the energy of its assembly in both.
    residuals : dict of str to float
        Largest violation, recomputed from the matrices: "gap" and "slip" relative to the largest displacement,
        "cone" and "equilibrium" relative to the largest traction and the load.
    coarse : State or None
        The same load on a grid with half the intervals; only where error bars were asked for.
    """

    step: int
    fraction: float
    load: dict[str, float]
    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    dx: float
    dy: float
    rotation: float
    dissipation: float
    work: float
    energy: float
    residuals: dict[str, float]
    problem: Problem = field(repr=False)
    grid: Grid = field(repr=False)
    coarse: State | None = field(default=None, repr=False)

    @cached_property
    def error_bars(self) -> dict[str, float] | None:
        """By how much the quantities of :data:`fastpin.quantities.QUANTITIES` and the ends of zones may be off.

        In the units of the quantities, angles in rad; see :func:`fastpin.errorbars.bars`. None where they were not
        asked for (``solve(..., error_bars=True)``).
        """
        return None if self.coarse is None else errorbars.bars(self, self.coarse)

    @property
    def in_contact(self) -> bool:
        """Whether any node is closed."""
        return bool(np.any(self.status != OPEN))

    @cached_property
    def contact(self) -> list[Interval]:
        """Contact intervals (start, stop), rad, read between nodes (N is extrapolated to zero, see edges.py).

        A contact round the whole circle is one interval of length 2 pi.
        """
        return zones.intervals(self.grid, self.status != OPEN, self.pressure, self._contact_exponents, self._sticking)

    @cached_property
    def stick(self) -> list[Interval]:
        """Stick intervals (start, stop), rad, read between nodes (mu N - |T| is extrapolated to zero).

        Nodes that stick but have come to |T| = mu N at this very load count as slipping.
        """
        closed = self.status != OPEN
        return zones.stick_intervals(
            self.grid, self._sticking, self._reserve, closed, self.contact, self._stick_exponents
        )

    @cached_property
    def slip_zones(self) -> list[tuple[float, float, int]]:
        """Slip zones (start, stop, sign), rad: what is in contact and does not stick, with the sign of the slip."""
        return zones.complement(self.grid, self.contact, self.stick, self.status)

    @property
    def peak_pressure(self) -> float:
        """Largest contact pressure, Pa, read between nodes."""
        return self._pressure_peak[0]

    @property
    def peak_pressure_angle(self) -> float:
        """Where the largest contact pressure acts, rad; NaN without contact."""
        return self._pressure_peak[1]

    @property
    def peak_shear(self) -> float:
        """Shear traction of largest magnitude with its sign, Pa, read between nodes."""
        return self._shear_peak[0]

    @property
    def peak_shear_angle(self) -> float:
        """Where the shear traction of largest magnitude acts, rad; NaN where there is no shear."""
        return self._shear_peak[1]

    @cached_property
    def _pressure_peak(self) -> tuple[float, float]:
        return zones.pressure_peak(self.grid, self.pressure, self._tilt != 0.0) if self.in_contact else (0.0, math.nan)

    @cached_property
    def _shear_peak(self) -> tuple[float, float]:
        if not self.shear.any():
            return 0.0, math.nan
        peak, place = zones.shear_peak(
            self.grid, self.pressure, self.shear, self._sticking, self.problem.friction, self.stick, self._tilt
        )
        most = self.problem.friction * self.peak_pressure
        return min(max(peak, -most), most), place

    @cached_property
    def _tilt(self) -> float:
        """By how much friction between unlike bodies moves the exponents of edges and borders off a half, (T26)."""
        return math.atan(self.problem.friction * self.problem.pair.dundurs()[1]) / math.pi

    def _contact_exponents(self, run: np.ndarray) -> tuple[float, float]:
        """With which the pressure falls to zero at the ends of the contact of the nodes `run`, (T21)."""
        first, last = self.status[run[[0, -1]]]
        return 0.5 - self._tilt * float(first), 0.5 + self._tilt * float(last)

    def _stick_exponents(self, run: np.ndarray) -> tuple[float, float]:
        """With which mu N - |T| falls to zero at the ends of the stick zone of the nodes `run`, (T26)."""
        before, after = np.sign(self.shear[[run[0] - 1, (run[-1] + 1) % self.shear.size]])
        return 0.5 - self._tilt * float(before), 0.5 + self._tilt * float(after)

    @cached_property
    def _reserve(self) -> np.ndarray:
        return self.problem.friction * self.pressure - np.abs(self.shear)

    @cached_property
    def _sticking(self) -> np.ndarray:
        return (self.status == STICK) & (self._reserve > 1e-9 * self._reserve.max())

    @cached_property
    def resultants(self) -> dict[str, float]:
        """The loads that the tractions balance, (50), (51): P and Q in N/m, M in N.

        Where the rotation is held, M is the moment that holds it.
        """
        cos, sin = self.grid.trig_moments()
        radius = self.problem.hole_radius
        return {
            "P": radius * float(cos @ self.shear - sin @ self.pressure),
            "Q": radius * float(sin @ self.shear + cos @ self.pressure),
            "M": -(radius**2) * float(self.grid.weights @ self.shear),
        }


class Cycle(NamedTuple):
    """What a cycle of a load history has changed, from its beginning to its end.

    Attributes
    ----------
    corner : int
        Index of the corner at which the cycle ends.
    length : int
        Corners of the cycle.
    number : int
        How many times its block has been run through: 1 for the first cycle.
    pressure_change, shear_change : float
        Largest difference of the tractions at a node, relative to the largest pressure; 0 where the contact is
        periodic. NaN where it is not known, because the cycle began before the history.
    dissipation : float
        Energy dissipated by friction in this cycle, J/m.
    rotation_change : float
        By how much the pin has turned (ratcheting), rad, counter-clockwise.
    solved : bool
        False where the cycle was known from before and not solved again.
    """

    corner: int
    length: int
    number: int
    pressure_change: float
    shear_change: float
    dissipation: float
    rotation_change: float
    solved: bool


def periodic_from(cycles: Sequence[Cycle]) -> Cycle | None:
    """The first of the cycles from which on all left the tractions the same, to rounding; None if there is none."""
    same = [cycle.pressure_change == 0.0 and cycle.shear_change == 0.0 for cycle in cycles]
    changing = max((k for k, steady in enumerate(same) if not steady), default=-1)
    return cycles[changing + 1] if changing + 1 < len(cycles) else None


def series(cycles: Sequence[Cycle]) -> list[list[Cycle]]:
    """Cycles that follow on one another, block by block."""
    found: list[list[Cycle]] = []
    latest: dict[int, list[Cycle]] = {}
    for cycle in cycles:
        before = latest.get(cycle.length)
        if before is None or before[-1].number + 1 != cycle.number or before[-1].corner + cycle.length != cycle.corner:
            before = latest[cycle.length] = []
            found.append(before)
        before.append(cycle)
    return found


class Result(Sequence[State]):
    """The states of one solution, in the order of the history.

    Attributes
    ----------
    problem : Problem
    history : LoadHistory
    grid : Grid
    method : str
        "path" or "increment".
    statistics : dict of str to float
        "events" (changes of status met), "exchanges" (changes made), "rebuilds" (tableaus built anew, and states that a
        factorisation computed), "increments", "repeated" (steps that were known from before) and "seconds".
    complete : bool
        Whether the whole history was followed; False in the result that an error carries.
    cycles : tuple of Cycle
        What each cycle of the history has changed, in order; empty where the history has no blocks that are repeated.
    restart : Restart
        For ``solve(..., start=result)``.
    coarse : Result or None
        The same history on a grid with half the intervals, where error bars were asked for.
    """

    def __init__(
        self,
        states: Sequence[State],
        problem: Problem,
        history: LoadHistory,
        grid: Grid,
        method: str,
        statistics: dict[str, float],
        complete: bool,
        restart: Restart | None = None,
        cycles: Sequence[Cycle] = (),
    ) -> None:
        self._states = list(states)
        self.problem = problem
        self.history = history
        self.grid = grid
        self.method = method
        self.statistics = statistics
        self.complete = complete
        self.restart = restart
        self.cycles = tuple(cycles)
        self.coarse: Result | None = None

    def with_coarse(self, coarse: Result) -> Result:
        """This result with error bars, from the states of the same history on a coarser grid."""
        states = []
        for state, other in zip(self, coarse, strict=True):
            assert (state.step, state.fraction) == (other.step, other.fraction)
            states.append(replace(state, coarse=other))
        result = Result(
            states, self.problem, self.history, self.grid, self.method, self.statistics, self.complete, self.restart,
            self.cycles,
        )  # fmt: skip
        result.coarse = coarse
        return result

    @overload
    def __getitem__(self, index: int) -> State: ...

    @overload
    def __getitem__(self, index: slice) -> list[State]: ...

    def __getitem__(self, index: int | slice) -> State | list[State]:
        return self._states[index]

    def __len__(self) -> int:
        return len(self._states)

    def __iter__(self) -> Iterator[State]:
        return iter(self._states)

    def __repr__(self) -> str:
        whole = "complete" if self.complete else "incomplete"
        return f"<Result: {len(self)} states, {self.grid.size} nodes, {self.method}, {whole}>"

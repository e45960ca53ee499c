"""A window of neighbouring nodes round the contact. The path is followed on its small system, to the same states.

On a grid with thousands of nodes a narrow contact needs few of them at a time. Nodes outside the window stay open. A
contact that reaches an end of the window continues on another window. All nodes keep their hats, so nothing is
interpolated. :class:`OutsideGap` watches the gap beyond an arc of nodes in the same way.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem
from fastpin.elasticity.large import LargeSystem
from fastpin.elasticity.system import System
from fastpin.model.grid import LEAST_NODES, Grid
from fastpin.model.loads import REMOTE
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.configuration import SLIGHT, Configuration, embedded
from fastpin.solver.errors import ArcError, ResolutionError
from fastpin.solver.increment_stepper import IncrementStepper
from fastpin.solver.interfaces import part_of
from fastpin.solver.path_stepper import PathStepper
from fastpin.solver.rest import release
from fastpin.solver.step import Piece, Position, Stepper, StepReport

MARGIN = 48
"""Open nodes of a window on either side of the contact, at least; more for a contact of more nodes."""


class SecondPlaceError(Exception):
    """Internal: the pin touches the hole outside the window too. ``nodes``, bool, shape (n,), are the nodes there."""

    def __init__(self, nodes: np.ndarray) -> None:
        super().__init__(nodes)
        self.nodes = nodes


class Window:
    """The system of the nodes round a contact, and copies of a configuration to it and back.

    Parameters
    ----------
    system : LargeSystem
    closed : ndarray of bool, shape (n,)
        Nodes in contact, or about to be.

    Attributes
    ----------
    nodes : ndarray of int, shape (k,)
        The nodes of the window, in their order round the hole.
    system : System
        Their system.
    """

    def __init__(self, system: LargeSystem, closed: np.ndarray) -> None:
        n = system.grid.size
        inside = np.flatnonzero(closed)
        spaces = np.diff(np.r_[inside, inside[0] + n])
        widest = int(np.argmax(spaces))  # the contact lies between the ends of this open part
        first, count = int(inside[(widest + 1) % inside.size]), n - int(spaces[widest]) + 1
        margin = min(max(MARGIN, count), (n - count) // 2)
        self.nodes = np.arange(first - margin, first + count + margin) % n
        self._large = system
        self.system = system.window(self.nodes)

    def paste(self, inside: Configuration, before: Configuration) -> Configuration:
        """The configuration of all nodes with the part `inside` the window. `before` has the rest of the other nodes.

        Raises
        ------
        SecondPlaceError
            If the pin penetrates the hole outside the window.
        """
        whole, true = embedded(self._large, inside, self.nodes, before.rest_gap, before.rest_slip, before.slip_tally)
        if not inside.closed.any():  # the pin was released: all nodes count from its new position
            whole = release(self._large, whole, inside.load)
            true = self._large.displacement(np.zeros_like(true), whole.motion, whole.load, whole.rest_gap)
        gap = true[: self._large.grid.size].copy()
        gap[self.nodes] = 0.0
        if gap.min() < -SLIGHT * float(np.abs(true).max()):
            raise SecondPlaceError(gap < 0.0)
        return whole


class WindowStepper:
    """The path solver on windows of a large grid: it follows a step from window to window.

    Parameters
    ----------
    system : LargeSystem
    statistics, strict
        See :class:`fastpin.solver.path_stepper.PathStepper`.
    """

    def __init__(self, system: LargeSystem, statistics: dict[str, float], strict: bool) -> None:
        self._system = system
        self._statistics = statistics
        self._strict = strict
        self._window: Window | None = None
        self._stepper: PathStepper | None = None
        self._inside: Position | None = None

    def begin_piece(self) -> None:
        """Prepare for the next straight piece."""
        if self._stepper is not None:
            self._stepper.begin_piece()

    def advance(self, position: Position, piece: Piece, stop: float, report: StepReport) -> None:
        """Follow a piece as :meth:`PathStepper.advance` does, from window to window.

        Raises
        ------
        NoEquilibriumError, ConvergenceError, ResolutionError
            See :meth:`fastpin.solver.path_stepper.PathStepper.advance`.
        """
        lost_at = -1.0
        while position.now.closed.any() and not np.array_equal(position.now.load, piece.load_at(stop)):
            inside = self._begin(position)
            assert self._stepper is not None
            try:
                try:
                    self._stepper.advance(inside, piece, stop, report)
                except ArcError:
                    if inside.reached == lost_at:
                        raise
                    lost_at = inside.reached
                    self._paste(position)
                    self.leave(position)
                    self._window = None
                else:
                    self._paste(position)
            except SecondPlaceError as second:  # once more from before, with a window round both places
                self.leave(position)
                self._open_window(position.now.closed | second.nodes)

    def leave(self, position: Position) -> None:
        """End the present path, and note the nodes that it touched."""
        if self._inside is None:
            return
        assert self._stepper is not None
        assert self._window is not None
        self._stepper.leave(self._inside)
        position.touched[self._window.nodes] |= self._inside.touched
        self._inside = None

    def _begin(self, position: Position) -> Position:
        """The position inside the window; a new window if the contact is not well inside the present one."""
        if self._inside is not None:
            return self._inside
        closed = position.now.closed
        window = self._window
        if window is None or closed.sum() != closed[window.nodes[2:-2]].sum():
            window = self._open_window(closed)
        self._inside = Position(
            position.now.part(window.nodes), position.touched[window.nodes], position.reached, position.fresh
        )
        return self._inside

    def _open_window(self, closed: np.ndarray) -> Window:
        """Open a window round the nodes `closed`, bool, shape (n,)."""
        window = self._window = Window(self._system, closed)
        if window.nodes.size > 4000:
            raise ResolutionError(f"the contacts are narrow and far apart: {window.nodes.size} nodes at a time")
        self._stepper = PathStepper(window.system, self._statistics, self._strict)
        return window

    def _paste(self, position: Position) -> None:
        """Bring `position` to where the position inside the window is."""
        assert self._window is not None
        assert self._inside is not None
        position.now = self._window.paste(self._inside.now, position.now)
        position.reached, position.fresh = self._inside.reached, self._inside.fresh


def stepper_of(system: System, options: SolveOptions, statistics: dict[str, float], strict: bool) -> Stepper:
    """The solver of the method that the options name."""
    if options.method == "increment":
        assert options.increments is not None
        return IncrementStepper(system, options.increments, statistics)
    if isinstance(system, LargeSystem):
        return WindowStepper(system, statistics, strict)
    return PathStepper(system, statistics, strict)


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

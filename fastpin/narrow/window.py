"""A window of neighbouring nodes round the contact. The path is followed on its small system, to the same states.

On a grid with thousands of nodes a narrow contact needs few of them at a time. Nodes outside the window stay open. A
contact that reaches an end of the window continues on another window. All nodes keep their hats, so nothing is
interpolated.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fastpin.elasticity.system import System
from fastpin.solver.configuration import SLIGHT, Configuration, embedded
from fastpin.solver.errors import NARROW, ArcError, ResolutionError
from fastpin.solver.path_stepper import PathStepper
from fastpin.solver.rest import release
from fastpin.solver.step import Piece, Position, StepReport

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
    system : System
        One that needs windows.
    closed : ndarray of bool, shape (n,)
        Nodes in contact, or about to be.

    Attributes
    ----------
    nodes : ndarray of int, shape (k,)
        The nodes of the window, in their order round the hole.
    system : System
        Their system.
    """

    def __init__(self, system: System, closed: np.ndarray) -> None:
        n = system.grid.size
        inside = np.flatnonzero(closed)
        spaces = np.diff(np.r_[inside, inside[0] + n])
        widest = int(np.argmax(spaces))  # the contact lies between the ends of this open part
        first, count = int(inside[(widest + 1) % inside.size]), n - int(spaces[widest]) + 1
        margin = min(max(MARGIN, count), (n - count) // 2)
        self.nodes = np.arange(first - margin, first + count + margin) % n
        self._large = system
        self.system = system.part(self.nodes)

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
    system : System
        One that needs windows.
    statistics, strict
        See :class:`fastpin.solver.path_stepper.PathStepper`.
    """

    def __init__(self, system: System, statistics: dict[str, float], strict: bool) -> None:
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


def begun_in_window(
    system: System,
    resting: Configuration,
    patch_on: Callable[..., tuple[Configuration, float]],
    most_part: float,
) -> tuple[Configuration, float]:
    """The first contact from rest and its fraction of the step, found on a window.

    ``patch_on(system, resting, most_part=most_part)`` finds it on the system of a window.

    Raises
    ------
    ResolutionError
        If the pin touches outside of every window.
    """
    nodes = resting.closed
    for _ in range(10):  # the pin may also touch outside of a window
        window = Window(system, nodes)
        try:
            patch, part = patch_on(window.system, resting.part(window.nodes), most_part=most_part)
            return window.paste(patch, resting), part
        except SecondPlaceError as second:
            nodes = nodes | second.nodes
        except ArcError:
            nodes = nodes.copy()
            nodes[window.nodes] = True
    raise ResolutionError(NARROW)

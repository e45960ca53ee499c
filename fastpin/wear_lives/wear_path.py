"""A run whose bodies wear. Wear is one more load: the gap opens along an exact path, while all other loads are held.

Nothing acts on tangential displacements when material goes. So sticking nodes keep their slip, the shear follows from
the mechanics, and every change of status on the way is an event of the path solver, as on a load path.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fastpin.elasticity.operator import Operator
from fastpin.elasticity.system import System
from fastpin.model.loads import complete_load
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, profile_of_nodes
from fastpin.solver.configuration import Configuration, work_between
from fastpin.solver.path_stepper import PathStepper
from fastpin.solver.repeats import CornerEntry
from fastpin.solver.rest import release
from fastpin.solver.result import Restart
from fastpin.solver.run import Run
from fastpin.solver.step import Piece, Position
from fastpin.states.state import State


@dataclass(frozen=True, eq=False)
class Removal:
    """The material that one wear path has removed, dimensionless.

    Attributes
    ----------
    depth : ndarray, shape (n,)
        Growth of the gap at each node.
    dissipation : float or ndarray, shape (interfaces,)
        Energy dissipated by the slip on the way; of a joint of several pins at each interface.
    work : float
        Work of the loads that are held.
    energy : float
        Elastic energy that goes with the material, int int N dg dtheta.
    """

    depth: np.ndarray
    dissipation: Any
    work: float
    energy: float


class WearRun(Run):
    """A run whose gap opens by wear at its corners; see :class:`fastpin.solver.run.Run`.

    The worn gap is part of the configuration. A pin that loses contact needs it in the problem as well, for its next
    first contact: :meth:`set_gap`.
    """

    wears: ClassVar[bool] = True

    @property
    def latest(self) -> CornerEntry:
        """Slip tally and energies of the step that was followed last."""
        return self.corner_log.latest

    def here(self) -> Restart:
        """The place at the last corner."""
        return self.restart(shared=True)

    def begins_anew_since(self, before: Configuration) -> bool:
        """Whether the contact was lost since the configuration `before`, and has begun anew or will do so."""
        return self.now.rest is not before.rest

    def states_over(self, cycle: np.ndarray, corner: int, problem: Problem) -> tuple[State, ...]:
        """The states over one cycle (corners, loads), SI, at its beginning and at its corners, without wear.

        `corner` is the number of the corner from which it begins. The states get the `problem`: a pin that loses
        contact is followed in one with the worn gap.
        """
        recorder: Any = self.recorder
        recorder.states.clear()
        self.corner = corner
        self.step_to(self.load)
        for given in cycle:
            self.step_to(complete_load(given, self.load))
        states = tuple(replace(each, problem=problem) for each in recorder.states)
        recorder.states.clear()
        return states

    def set_gap(self, first: System, worn: np.ndarray | None) -> None:
        """Let the next first contact see a gap that has grown by `worn` (n,), dimensionless, since the system `first`.

        Between the nodes the grown gap is a spline. Without `worn` there is no next first contact.
        """
        if worn is None:
            if self.system is not first:
                self.system, self.stepper = first, PathStepper(first, self.statistics, self.strict)
            return
        problem = first.problem
        hole = problem.gap.hole + profile_of_nodes(first.grid, worn * first.scales.displacement)
        grown = replace(problem, gap=InitialGap(hole, problem.gap.pin))
        gap = first.initial_gap + worn
        self.system = replace(first, problem=grown, initial_gap=gap, held_as=first.held_as or first)
        self.stepper = PathStepper(self.system, self.statistics, self.strict)

    def wear(self, depth: np.ndarray, softness: np.ndarray | None = None) -> Removal:
        """Remove material at the present corner, and go on from there.

        Parameters
        ----------
        depth : ndarray, shape (n,)
            Growth of the gap at each node, at least 0, dimensionless.
        softness : ndarray, shape (n,), optional
            Growth of this depth with the pressure at the node, at least 0, dimensionless: the implicit way. A node
            whose pressure changes by dN on the path is worn by depth + softness dN.

        Raises
        ------
        SolveError
            If the path can't be followed.
        """
        before = self.now
        if not before.closed.any():
            after, removal = _opened(before, depth), Removal(depth, 0.0, 0.0, 0.0)
        else:
            after, removal = self._follow(before, depth, softness)
        dissipation, work = self.dissipation + removal.dissipation, self.work + removal.work
        self.go_back(replace(self.restart(shared=True), configuration=after, dissipation=dissipation, work=work))
        return removal

    def _follow(
        self, before: Configuration, depth: np.ndarray, softness: np.ndarray | None
    ) -> tuple[Configuration, Removal]:
        """Follow the wear path from the configuration `before`."""
        load, rest_gap = before.load, before.rest_gap
        if softness is not None:
            rest_gap = rest_gap - softness * before.pressure
        begin, end = np.r_[load, 0.0], np.r_[load, 1.0]
        start = replace(before, load=begin, rest_gap=rest_gap, dissipation=0.0, work=0.0)
        position, piece = Position(start, before.closed.copy()), Piece(0.0, 1.0, begin, end)
        stepper = PathStepper(system_with_wear(self.system, depth, softness), self.statistics, self.strict)
        while position.now.closed.any() and not np.array_equal(position.now.load, end):
            stepper.advance(position, piece, 1.0, self._check)
        stepper.leave(position)
        now, worn = position.now, depth
        if softness is not None:
            worn = depth + softness * (now.pressure - before.pressure)
        after = replace(now, load=load, rest_gap=before.rest_gap + worn)
        if not now.closed.any():  # nothing pushed the pin, and now it floats
            after = _opened(release(self.system, replace(now, load=load), load), worn)
        work = work_between(self.system, replace(before, work=0.0), after)
        weights = self.system.weights
        # The kernel counts wear as a load: int depth dN. By parts, int N d(depth) is the rest.
        removed = float(weights @ (depth * now.pressure)) - (now.work - work)
        if softness is not None:
            removed += 0.5 * float(weights @ (softness * (now.pressure**2 - before.pressure**2)))
        return after, Removal(worn, now.dissipation, work, removed)

    def _check(self, reached: float) -> None:
        """Let Ctrl-C end a long path."""
        if self.progress is not None:
            self.progress(float(self.corner), len(self.history))


class SoftOperator(Operator):
    """An operator whose nodes are softer: a pressure also opens the gap at its own node.

    Parameters
    ----------
    base : Operator
    softness : ndarray, shape (n,)
        Gap per pressure at each node, beside that of `base`.
    """

    by_distance = False

    def __init__(self, base: Operator, softness: np.ndarray) -> None:
        super().__init__(base.size)
        self.is_stored = base.is_stored
        self._base, self._softness = base, np.concatenate([softness, np.zeros_like(softness)])

    def __matmul__(self, tractions: np.ndarray) -> np.ndarray:
        product: np.ndarray = self._base @ tractions + (self._softness * tractions.T).T
        return product

    def fill(self, rows: np.ndarray, columns: np.ndarray, out: np.ndarray) -> None:
        self._base.fill(rows, columns, out)
        out += np.where(rows[:, None] == columns, self._softness[columns], 0.0)

    def diagonal(self) -> np.ndarray:
        return self._base.diagonal() + self._softness

    @cached_property
    def matrix(self) -> np.ndarray | None:  # type: ignore[override]
        return None if self._base.matrix is None else self.entries()


def system_with_wear(system: System, depth: np.ndarray, softness: np.ndarray | None = None) -> System:
    """The system with one more load, the last one: wear. Its unit opens the gap by `depth` (n,).

    The wear grows with the pressure. Each pressure N also opens the gap at its node, by `softness` (n,) times N.
    """
    column = np.concatenate([depth, np.zeros_like(depth)])
    loads, columns = (np.column_stack([each, column]) for each in (system.loads, system.drive.columns))
    forces = np.column_stack([system.forces, np.zeros(system.motions)])
    worn = replace(system, loads=loads, forces=forces, drive=replace(system.drive, columns=columns))
    if softness is None:
        return replace(worn, held_as=system.held_as or system)
    return replace(worn, operator=SoftOperator(system.operator, softness), held_as=None)


def _opened(before: Configuration, depth: np.ndarray) -> Configuration:
    """A floating pin whose gap has opened by `depth` (n,)."""
    return replace(before, gap=before.gap + depth, rest_gap=before.rest_gap + depth)

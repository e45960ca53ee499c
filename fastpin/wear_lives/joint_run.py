"""A joint of several pins whose holes, pins and bushes wear. Wear is one more load, in the place of the fit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from fastpin.elasticity.drive import Drive
from fastpin.elasticity.operator import Operator
from fastpin.joints.path import follow
from fastpin.joints.result import JointState
from fastpin.joints.solving import JointMatrices, JointRestart, JointRun
from fastpin.joints.system import FIT, PinsSystem
from fastpin.solver.configuration import MAX_RESIDUAL, Configuration
from fastpin.solver.errors import ConvergenceError
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.solver.tableau import TableauMemory
from fastpin.wear_lives.wear_path import Removal, SoftOperator


@dataclass(frozen=True, eq=False)
class WornPlace:
    """A place in the life of wear of a joint.

    Attributes
    ----------
    restart : JointRestart
    loads : ndarray, shape (loads,)
        The loads there, SI.
    dissipation : ndarray, shape (interfaces,)
        Energy per thickness that friction has dissipated at each interface, dimensionless.
    work : float
        It is not counted: 0.
    slip_tally : SlipTally
        Not counted: a place stands where no step is under way.
    """

    restart: JointRestart
    loads: np.ndarray
    dissipation: np.ndarray
    work: float = 0.0
    slip_tally: SlipTally = NOT_COUNTED

    @property
    def configuration(self) -> Configuration:
        """The configuration."""
        return self.restart.configuration

    @property
    def statistics(self) -> dict[str, float]:
        """Counts of the solver."""
        return {"snaps": self.restart.snaps}


class JointStep(NamedTuple):
    """What a step has done: its slip tally, the energy dissipated at each interface (interfaces,), and no work."""

    slip_tally: SlipTally
    dissipation: np.ndarray
    work: float = 0.0


class JointWearRun(JointRun):
    """A joint whose gaps open by wear; see :class:`fastpin.wear_lives.fat_cycles.WearingRun`.

    The worn gaps are part of the configuration, also of a pin that loses contact.

    Parameters
    ----------
    matrices : JointMatrices
    report : callable
        Called now and then while a step is followed.

    Attributes
    ----------
    latest : JointStep
        What the last step has done.
    dissipation : ndarray, shape (interfaces,)
        Energy at the place to which the run went back last, dimensionless.
    work : float
        Not counted: 0.
    """

    def __init__(self, matrices: JointMatrices, report: Callable[[float], None]) -> None:
        super().__init__(matrices)
        self._report, self._room = report, TableauMemory(matrices.system)
        self.dissipation, self.work = np.zeros(len(matrices.system.sections)), 0.0
        self.latest = JointStep(NOT_COUNTED, self.dissipation)

    @property
    def system(self) -> PinsSystem:
        """The system of the joint."""
        return self.matrices.system

    @property
    def now(self) -> Configuration:
        """The present configuration."""
        return self.restart.configuration

    @property
    def load(self) -> np.ndarray:
        """The present loads (loads,), SI."""
        return self.loads

    def here(self) -> WornPlace:
        """The present place."""
        return WornPlace(self.restart, self.loads, self.dissipation, self.work)

    def go_back(self, start: WornPlace) -> None:
        """Go to a place."""
        self.go_to(start.restart, start.loads)
        self.dissipation, self.work = start.dissipation, start.work

    def step_to(self, load: np.ndarray, kept: bool = True, inside: bool = False) -> None:  # type: ignore[override]
        """Follow a straight step to these loads (loads,), SI. Its state is not made.

        Raises
        ------
        SolveError
            If the load can't be carried, no state was found, or it violates the conditions.
        """
        now, snaps, residuals = self.followed(load, self._report, wears=True)
        if not max(residuals.values()) <= MAX_RESIDUAL:
            raise ConvergenceError("the state violates the contact conditions", fraction=1.0)
        self.latest = JointStep(now.slip_tally, self._dissipated(now.slip_tally))
        now = replace(now, slip_tally=NOT_COUNTED)
        self.restart = replace(self.restart, corner=self.restart.corner + 1, configuration=now, snaps=snaps)
        self.loads = load

    def wear(self, depth: np.ndarray, softness: np.ndarray | None = None) -> Removal:
        """Remove material under the present loads, and go on from there; see ``WearRun.wear``.

        Raises
        ------
        SolveError
            If the path can't be followed.
        """
        system, before = self.system, self.now
        fit = float(before.load[FIT])
        rest_gap = before.rest_gap + fit * system.loads[: system.grid.size, FIT]  # the wear takes the place of the fit
        soft = rest_gap if softness is None else rest_gap - softness * before.pressure
        begin, end = before.load.copy(), before.load.copy()
        begin[FIT], end[FIT] = 0.0, 1.0
        start = replace(
            before, load=begin, rest_gap=soft, dissipation=0.0, slip_tally=SlipTally.empty(system.grid.size)
        )
        after, snaps = follow(worn_system(system, depth, softness), start, end, self._room, self._report)
        worn = depth if softness is None else depth + softness * (after.pressure - before.pressure)
        energy = self._dissipated(after.slip_tally)
        now = replace(after, load=before.load, rest_gap=before.rest_gap + worn, slip_tally=NOT_COUNTED)
        self.restart = replace(self.restart, configuration=now, snaps=self.restart.snaps + snaps)
        return Removal(worn, energy, 0.0, 0.0)

    def set_gap(self, first: Any, worn: np.ndarray | None) -> None:
        """Do nothing: a pin that loses contact stays in its configuration."""

    def begins_anew_since(self, before: Configuration) -> bool:
        """Whether a contact begins anew: never."""
        return False

    def states_over(self, cycle: np.ndarray, corner: int, problem: Any) -> tuple[JointState, ...]:
        """The states over one cycle (corners, loads), SI, at its beginning and at its corners, without wear.

        `corner` is the number of the corner from which it begins.
        """
        since, scales = self.restart.since.copy(), self.system.scales
        since.dissipated[:] = self.dissipation * scales.energy
        self.restart = replace(self.restart, corner=max(corner, 1), since=since)
        return tuple(super(JointWearRun, self).step_to(load, self._report) for load in (self.loads, *cycle))

    def _dissipated(self, tally: SlipTally) -> np.ndarray:
        """Energy per thickness at each interface, shape (interfaces,)."""
        system = self.system
        return np.array([system.weights[nodes] @ tally.sums[1, nodes] for nodes in system.nodes.parts])


def worn_system(system: PinsSystem, depth: np.ndarray, softness: np.ndarray | None) -> PinsSystem:
    """A system with wear in place of the fit: its unit opens the gaps by `depth` (n,).

    Each pressure N also opens the gap at its node, by `softness` (n,) times N.
    """
    loads = system.loads.copy()
    loads[:, FIT] = np.concatenate([depth, np.zeros_like(depth)])
    worn = replace(system, loads=loads, drive=Drive(system.motion[:, :2], loads), held_as=system.held_as or system)
    if softness is None:
        return worn
    ports = None if system.ports is None else system.ports.softened(softness)
    operator: Operator = SoftOperator(system.operator, softness)
    if ports is not None and system.operator is system.ports:
        operator = ports
    return replace(worn, operator=operator, ports=ports, held_as=None)

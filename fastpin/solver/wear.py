"""A life of wear: what leads to the cycle, then the cycle again and again, on a profile that wears."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fastpin.elasticity.large import build_system
from fastpin.errors import InputError, InputWarning
from fastpin.model.doubts import warn_of
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.wear import Wear
from fastpin.solver.attempts import first_wide_enough
from fastpin.solver.errors import Interrupted
from fastpin.solver.fat_cycles import FatCycles, Worn
from fastpin.solver.run import RunProgress
from fastpin.solver.solving import MemoryRecorder
from fastpin.solver.task import Task, deferred_interrupts, one_blas_thread
from fastpin.solver.wear_path import WearRun
from fastpin.solver.wear_result import WornCycle

log = logging.getLogger(__name__)

SLIP_OPTIONS = {"slip_sums": True, "keep": "every 100000000", "between": 0}
"""Options of the run: slip is counted over each step, and states are kept where they are asked for."""


class WearRecorder(Protocol):
    """The receiver of a life of wear."""

    def begin(self, grid: Grid, force: float) -> None:
        """Forget everything. From here on all cycles come from this grid, with this reference force, N/m."""

    def add(self, cycle: WornCycle, place: Worn, statistics: dict[str, float]) -> None:
        """Keep a chosen cycle, and the place from which the life goes on."""

    def reached(self, place: Worn) -> None:
        """Note a place from which the life can go on later."""


class InMemory:
    """A recorder of the chosen cycles in memory."""

    def __init__(self) -> None:
        self.cycles: list[WornCycle] = []
        self.grid: Grid | None = None
        self.statistics: dict[str, float] = {}

    def begin(self, grid: Grid, force: float) -> None:
        """Forget everything."""
        self.cycles, self.grid = [], grid

    def add(self, cycle: WornCycle, place: Worn, statistics: dict[str, float]) -> None:
        """Keep a chosen cycle."""
        self.cycles.append(cycle)
        self.statistics = statistics

    def reached(self, place: Worn) -> None:
        """Do nothing: a result in memory does not go on."""


@dataclass(frozen=True, eq=False)
class WearTask:
    """A life of wear to follow. All its parts are checked together.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        It ends with its cycle: a block that is repeated.
    wear : Wear
    options : SolveOptions
    grid : Grid, optional
    progress : callable, optional
        Called as ``progress(done_cycles, all_cycles)`` now and then.

    Raises
    ------
    InputError
        If a part can't be used. The error names the field.
    """

    problem: Problem
    history: LoadHistory
    wear: Wear
    options: SolveOptions
    grid: Grid | None = None
    progress: RunProgress | None = None

    def __post_init__(self) -> None:
        self._task()
        if self.options.method != "path":
            raise InputError("method", 'wear is followed by method = "path" only')
        if not self.history.blocks[-1].cycle:
            raise InputError("history", "must end with the cycle that wears: repeat its last block")
        if self.grid is not None and not self.grid.uniform:
            raise InputError("grid", "wear needs equally spaced nodes")
        self.wear.coefficients(self.problem, np.linspace(-np.pi, np.pi, 1441))

    def _task(self) -> Task:
        return Task(self.problem, self.history, self.options, self.grid)

    @property
    def cycle(self) -> np.ndarray:
        """Loads at the corners of the cycle, SI, shape (corners, loads); NaN keeps the last value."""
        return self.history.blocks[-1].given

    @property
    def approach(self) -> np.ndarray:
        """Loads at the corners that lead to the cycle, SI, shape (corners, loads)."""
        count = len(self.history) - self.history.blocks[-1].corners
        return self.history[:count].values() if count else np.zeros((0, len(LOADS)))

    def follow(self, recorder: WearRecorder) -> None:
        """Follow the life from no load, on the first grid that is wide enough.

        Raises
        ------
        SolveError
            If a cycle can't be followed.
        Interrupted
            After Ctrl-C.
        """
        with deferred_interrupts() as request, one_blas_thread():

            def watch(done: float, total: int) -> None:
                if request.stop:
                    raise Interrupted

            attempts = self._task().attempts(watch)

            def on_grid(grid: Grid) -> None:
                log.info("%d nodes from %.5g to %.5g rad", grid.size, grid.theta[0], grid.theta[-1])
                recorder.begin(grid, attempts.force)
                life = self._life(grid, attempts.force, watch)
                self._live(life, life.begin(self.approach), recorder)

            first_wide_enough(attempts.arcs(), on_grid)

    def go_on(self, recorder: WearRecorder, place: Worn, grid: Grid) -> None:
        """Go on from a place of an earlier run on `grid`, to the same bits. On a wider arc all begins anew.

        Raises
        ------
        SolveError, Interrupted
            See :meth:`follow`.
        """
        with deferred_interrupts() as request, one_blas_thread():

            def watch(done: float, total: int) -> None:
                if request.stop:
                    raise Interrupted

            life = self._life(grid, place.restart.force, watch)
            life.at(place, len(self.approach))
            self._live(life, place, recorder)

    def _life(self, grid: Grid, force: float, watch: RunProgress) -> FatCycles:
        system = build_system(self.problem, grid, force)
        options = self.options.changed(arc=None, **SLIP_OPTIONS)
        kept = MemoryRecorder()
        run = WearRun(self.history, system, options, kept, watch)
        return FatCycles(run, self.wear, self.cycle)

    def _live(self, life: FatCycles, place: Worn, recorder: WearRecorder) -> None:
        """Follow all cycles from a place on."""
        chosen = [each for each in self.wear.chosen if each > place.cycle or each == place.cycle == 0]
        for target in chosen:
            while place.cycle < target:
                place = life.next(place, target)
                recorder.reached(place)
                if self.progress is not None:
                    self.progress(place.cycle, self.wear.cycles)
            cycle = self._worn_cycle(life, place)
            if place.cycle == 0:
                self._warn(cycle)
            recorder.add(cycle, place, {**place.restart.statistics, "solved": place.solved})

    def _worn_cycle(self, life: FatCycles, place: Worn) -> WornCycle:
        scales = life.run.system.scales
        pin, plate = place.depth * scales.displacement
        dissipation, removed = place.restart.dissipation * scales.energy, place.removed * scales.energy
        states = life.states(place)
        return WornCycle(place.cycle, place.jump, place.solved, pin, plate, dissipation, removed, states)

    def _warn(self, cycle: WornCycle) -> None:
        """Warn of a pin that wears although it slips by more than a node distance: its profile turns with it."""
        if self.problem.dimensionless or not self.wear.coefficients(self.problem, cycle.theta)[0].any():
            return
        slips = [state.slip_distance for state in cycle.states[1:]]
        slip = max(float(each.max()) for each in slips if each is not None)
        distance = float(cycle.grid.weights.min()) * self.problem.hole_radius
        if slip > distance:
            words = (
                f"the pin slips by {slip:.2g} m in a piece of the cycle, more than a node distance, {distance:.2g} m"
            )
            warn_of([InputWarning("pin", f"{words}; its wear is kept where the pin touched first")], 2)

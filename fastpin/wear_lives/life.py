"""A life of wear: what leads to the cycle, then the cycle again and again, on a profile that wears."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from fastpin.elasticity.build import build_system
from fastpin.errors import InputError
from fastpin.model.case import check_wear
from fastpin.model.checks import number_array
from fastpin.model.doubts import warn_of
from fastpin.model.grid import Grid
from fastpin.model.history import MAX_CORNERS, LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.options import SolveOptions
from fastpin.model.problem import LOOKED_AT, Problem
from fastpin.model.profile import Profile, ProfileLike, profile_of_nodes
from fastpin.model.recorded import with_last_cycle
from fastpin.model.wear import Wear
from fastpin.solver.errors import ArcError, Interrupted, ResolutionError
from fastpin.solver.run import RunProgress
from fastpin.solver.solving import MemoryRecorder
from fastpin.solver.task import (
    Task,
    Unfit,
    after_grid,
    deferred_interrupts,
    follow_on_arcs,
    one_blas_thread,
)
from fastpin.wear_lives.fat_cycles import FatCycles, Worn
from fastpin.wear_lives.wear_path import WearRun
from fastpin.wear_lives.wear_result import WearResult, WornCycle, slip_doubts

log = logging.getLogger(__name__)

KEPT_ON_DEMAND = {"keep": "every 100000000", "between": 0}
"""Options of the run: states are kept where they are asked for."""


FINER, MOST_FINER = (2, 4, 8), 2000
"""Factors of finer nodes where a contact is too narrow for the nodes; and how many such nodes there are, at most.

A wear path has full matrices: a hundred paths of 2,000 nodes take minutes.
"""


class WearRecorder(Protocol):
    """The receiver of a life of wear."""

    def begin(self, grid: Grid, force: float) -> None:
        """Forget everything. From here on all cycles come from this grid, with this reference force, N/m."""

    def add(self, cycle: WornCycle, place: Worn, statistics: dict[str, float]) -> None:
        """Keep a chosen cycle, and the place from which the life goes on."""

    def reached(self, place: Worn) -> None:
        """Note a place from which the life can go on later."""


class CyclesInMemory:
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


FrictionRule = Callable[[WornCycle], "np.ndarray | ProfileLike | None"]
"""A function of the user: the friction after a chosen cycle, at the nodes or as a profile. None leaves it as it is."""


def _friction_at(cycle: WornCycle, wanted: np.ndarray | ProfileLike) -> Profile:
    """The friction that a function of the user wants."""
    if not isinstance(wanted, np.ndarray):
        return Profile.of("friction", wanted)
    if wanted.shape != cycle.theta.shape:
        raise InputError("friction", f"must return an array of the shape {cycle.theta.shape}, not {wanted.shape}")
    return profile_of_nodes(cycle.grid, number_array("friction", wanted))


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
    friction : callable, optional
        Gives the friction after each chosen cycle, see :func:`fastpin.wear`.

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
    friction: FrictionRule | None = None

    def __post_init__(self) -> None:
        self._task()
        object.__setattr__(self, "history", with_last_cycle(self.history))
        check_wear(self.problem)
        if self.options.method != "path":
            raise InputError("method", 'wear is followed by method = "path" only')
        if not self.history.blocks[-1].cycle:
            raise InputError("history", "must end with the cycle that wears: repeat its last block")
        if self.grid is not None and not self.grid.uniform:
            raise InputError("grid", "wear needs equally spaced nodes")
        self.coefficients(np.linspace(-np.pi, np.pi, LOOKED_AT))
        _ = self.stored_history

    def coefficients(self, theta: np.ndarray) -> np.ndarray:
        """Wear coefficients of pin and plate, 1/Pa, at the angles `theta` (n,), rad, shape (2, n)."""
        return self.wear.coefficients(self.problem.hole_radius, theta)

    @property
    def stored_history(self) -> LoadHistory:
        """What leads to the cycle, and all cycles, one more for the states after the last one.

        Raises
        ------
        InputError
            If it has too many corners.
        """
        *before, last = self.history.blocks
        most = (MAX_CORNERS - len(self.approach)) // len(self.cycle) - 1
        if self.wear.cycles > most:
            raise InputError("cycles", f"must be at most {most:,}: a life has at most {MAX_CORNERS:,} corners")
        block = replace(last, count=self.wear.cycles + 1)
        return LoadHistory.of_blocks([*before, block])

    def result(self, grid: Grid, cycles: Sequence[WornCycle], statistics: dict[str, float]) -> WearResult:
        """The result of the chosen cycles on a grid."""
        coefficients = self.coefficients(grid.theta)
        complete = bool(cycles) and cycles[-1].cycle == self.wear.cycles
        law, tolerance = self.wear.law, self.wear.tolerance
        return WearResult(
            self.problem, self.stored_history, law, tolerance, coefficients, grid, tuple(cycles), complete, statistics
        )

    def _task(self, nodes: int | None = None) -> Task:
        options = self.options if nodes is None else self.options.changed(nodes=nodes)
        return Task(self.problem, self.history, options, self.grid)

    @property
    def cycle(self) -> np.ndarray:
        """Loads at the corners of the cycle, SI, shape (corners, loads); NaN keeps the last value."""
        return self.history.blocks[-1].given

    @property
    def approach(self) -> np.ndarray:
        """Loads at the corners that lead to the cycle, SI, shape (corners, loads)."""
        count = len(self.history) - self.history.blocks[-1].corners
        return self.history[:count].values() if count else np.zeros((0, len(LOADS)))

    def follow(self, recorder: WearRecorder, unfit: Unfit | None = None) -> None:
        """Follow the life from no load, on the first grid that is fine and wide enough; with `unfit` one after that.

        Raises
        ------
        SolveError
            If a cycle can't be followed.
        Interrupted
            After Ctrl-C.
        """
        with deferred_interrupts() as caught, one_blas_thread():

            def watch(done: float, total: int) -> None:
                if caught:
                    raise Interrupted

            def on_grid(grid: Grid, strict: bool) -> None:
                recorder.begin(grid, task.force)
                life = self._life(grid, task.force, watch)
                self._live(life, life.begin(self.approach), recorder)

            error = None if unfit is None else unfit.error
            for nodes in self._sizes(unfit):
                task = self._task(nodes)
                arcs = task.arcs(watch)
                if unfit is not None and nodes == unfit.grid.size:
                    arcs = after_grid(unfit.grid, arcs)
                try:
                    return follow_on_arcs(arcs, on_grid)
                except ResolutionError as narrow:
                    error = narrow
                    log.info("%s", narrow)
            assert error is not None
            raise error

    def _sizes(self, unfit: Unfit | None) -> list[int]:
        """Numbers of nodes that are tried one after the other, from `unfit` on; one if arc or nodes are given."""
        first = self.options.nodes
        if self.grid is not None or self.options.arc is not None:
            return [first]
        sizes = [first, *(size for factor in FINER if (size := factor * (first - 1) + 1) <= MOST_FINER)]
        if unfit is None:
            return sizes
        least = unfit.grid.size + (not isinstance(unfit.error, ArcError))
        return [size for size in sizes if size >= least]

    def go_on(self, recorder: WearRecorder, place: Worn, grid: Grid, stored: int) -> None:
        """Go on from a place of an earlier run on `grid`, to the same bits. A wider or a finer grid begins anew.

        `stored` is the last chosen cycle that the recorder has; -1 for none.

        Raises
        ------
        SolveError, Interrupted
            See :meth:`follow`.
        """
        with deferred_interrupts() as caught, one_blas_thread():

            def watch(done: float, total: int) -> None:
                if caught:
                    raise Interrupted

            life = self._life(grid, place.restart.force, watch)
            life.at(place, len(self.approach))
            unfit = None
            try:
                self._live(life, place, recorder, stored)
            except (ArcError, ResolutionError) as error:
                if self.grid is not None or self.options.arc is not None:
                    raise
                unfit = Unfit(grid, error)
        if unfit is not None:
            self.follow(recorder, unfit)

    def _life(self, grid: Grid, force: float, watch: RunProgress) -> FatCycles:
        system = build_system(self.problem, grid, force)
        options = self.options.changed(arc=None, **KEPT_ON_DEMAND)
        kept = MemoryRecorder()
        run = WearRun(self.history, system, options, kept, watch)
        return FatCycles(run, self.wear, self.cycle)

    def _live(self, life: FatCycles, place: Worn, recorder: WearRecorder, stored: int = -1) -> None:
        """Follow all cycles from a place on. The recorder has the chosen cycles up to the cycle `stored`."""
        for target in (each for each in self.wear.chosen if each > stored):
            place = lived_to(life, place, target, recorder, self)
            cycle = self._worn_cycle(life, place)
            if place.cycle == 0:
                warn_of(slip_doubts(self.coefficients(cycle.theta), cycle), 2)
            recorder.add(cycle, place, {**place.restart.statistics, "solved": place.solved})
            if self.friction is not None and target < self.wear.cycles:
                wanted = self.friction(cycle)
                if wanted is not None:
                    life, place = life.with_friction(place, _friction_at(cycle, wanted))

    def _worn_cycle(self, life: FatCycles, place: Worn) -> WornCycle:
        scales = life.run.system.scales
        pin, plate = place.depth * scales.displacement
        dissipation, removed = place.restart.dissipation * scales.energy, place.removed * scales.energy
        states = life.states(place)
        return WornCycle(place.cycle, place.jump, place.solved, pin, plate, dissipation, removed, states)


def lived_to(life: FatCycles, place: Worn, target: int, recorder: Any, how: Any) -> Worn:
    """Follow cycles from a place on to the cycle `target`, and return the place there. `how` has wear and progress."""
    while place.cycle < target:
        place = life.next(place, target)
        recorder.reached(place)
        if how.progress is not None:
            how.progress(place.cycle, how.wear.cycles)
    return place

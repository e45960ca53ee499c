"""Fat cycles: load cycles whose wear counts many times, under control of their error.

A cycle is followed piece by piece, from corner to corner. The wear of a piece is applied at its end, where its contact
is, by ``WearRun.wear``. In a fat cycle it is multiplied by the jump J, the number of cycles for which it stands. A fat
cycle of J is compared with two of about J/2 from the same start. The finer result goes on. A single cycle comes before:
a contact remembers the jump of the wear, and slips otherwise in the next cycle. This is multiplied by J, too. Without
the single cycle it would be alike in both results, and not seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from fastpin.drift.friction import follow_friction, followed_problem, system_with_friction
from fastpin.elasticity.system import System
from fastpin.model.checks import MOST_PARAMETER
from fastpin.model.loads import complete_load
from fastpin.model.problem import MOST_GAP
from fastpin.model.profile import Profile
from fastpin.model.wear import Wear
from fastpin.solver.configuration import Configuration
from fastpin.solver.errors import SolveError
from fastpin.solver.slip_tally import NOT_COUNTED
from fastpin.wear_lives.wear_path import Removal

Found = TypeVar("Found")

Energy = float | np.ndarray
"""An energy of a joint, or that of each of its interfaces, shape (interfaces,)."""


class WearingRun(Protocol):
    """What follows a cycle on gaps that wear: one pin, or several with the nodes of all interfaces in a row.

    A place is all from which it goes on; it has the ``configuration``, ``dissipation`` and ``work`` since the start.
    """

    dissipation: Any
    work: float

    @property
    def system(self) -> Any:
        """The system."""

    @property
    def now(self) -> Configuration:
        """The present configuration."""

    @property
    def load(self) -> np.ndarray:
        """The present load (loads,), SI."""

    @property
    def latest(self) -> Any:
        """Slip tally, ``dissipation`` and ``work`` of the step that was followed last."""

    def here(self) -> Any:
        """The present place."""

    def go_back(self, start: Any) -> None:
        """Go to a place."""

    def step_to(self, load: np.ndarray, kept: bool = True, inside: bool = False) -> None:
        """Follow a straight step to a load (loads,), SI."""

    def wear(self, depth: np.ndarray, softness: np.ndarray | None = None) -> Removal:
        """Remove material, see :meth:`fastpin.wear_lives.wear_path.WearRun.wear`."""

    def set_gap(self, first: Any, worn: np.ndarray | None) -> None:
        """Let the next first contact see a gap that has grown by `worn` (n,)."""

    def begins_anew_since(self, before: Configuration) -> bool:
        """Whether the contact was lost since `before`, and needs the worn gap of :meth:`set_gap`."""

    def states_over(self, cycle: np.ndarray, corner: int, problem: Any) -> tuple[Any, ...]:
        """The states over one cycle, without wear."""


SETTLING = 2
"""First cycles, which are solved one by one: the contact forgets how it was loaded first."""

LEAST_JUMP = 4
"""Smallest jump under control. Four cycles are solved for it and one more, so smaller ones save nothing."""

LEAST_PAUSE, LONGEST_PAUSE = 4, 64
"""Single cycles after a failure of control: at first, and after many failures in a row. They double in between."""

SAFETY, MOST_GROWTH, LEAST_GROWTH = 0.8, 2.0, 0.2
"""Part of the jump that the error allows; largest and smallest ratio of a jump to the one before."""

PRESSURE_SHARE = 0.1
"""Weight of the error of the pressure, in parts of the largest pressure, beside that of the worn depth."""


LARGEST_PART = 0.025
"""Depth that wears at one stop, at most, in units of the force of all pressure times beta*.

A narrow contact presses the bodies a sixth of it into each other. With this part the volume errs by one to six per
cent, in ten random lives.
"""

MOST_PARTS = 128
"""Parts of a piece of the cycle, at most. Metals wear less in a thousand cycles than is refused in one piece."""


@dataclass
class _Sums:
    """Worn depth of pin and plate (2, n), energy that went with it, and dissipation and work, all since the start."""

    depth: np.ndarray
    removed: float
    dissipation: Energy
    work: float


@dataclass(frozen=True, eq=False)
class Worn:
    """A place in a life of wear: everything from which it goes on, to the same bits. Arrays are dimensionless.

    Attributes
    ----------
    cycle : int
        Cycles that are done.
    jump : int
        The next jump. Below 1 so many single cycles and one more come first: control has failed before.
    pause : int
        Single cycles after the next failure of control.
    solved : int
        Cycles that were solved, those of control included.
    depth : ndarray, shape (2, n)
        Worn depth of pin and plate at each node.
    removed : float
        Elastic energy that went with the material.
    restart : Restart or WornPlace
        The contact. Its energies count each fat cycle J times.
    loses_contact : bool
        Whether the pin loses contact in the cycle.
    """

    cycle: int
    jump: int
    solved: int
    depth: np.ndarray
    removed: float
    restart: Any
    loses_contact: bool = False
    pause: int = LEAST_PAUSE

    @property
    def gap(self) -> np.ndarray:
        """Growth of the gap, shape (n,)."""
        total: np.ndarray = self.depth.sum(axis=0)
        return total


class FatCycles:
    """The driver of a life of wear on one grid.

    Parameters
    ----------
    run : WearingRun
        A run that counts slip, and stands at the beginning of its history.
    wear : Wear
    cycle : ndarray, shape (corners, loads)
        Loads at the corners of the cycle, SI; NaN keeps the last value.
    """

    def __init__(self, run: WearingRun, wear: Wear, cycle: np.ndarray) -> None:
        system = run.system
        self.run, self._wear, self._cycle = run, wear, cycle
        self._first = system
        self._coefficients = system.scales.traction * coefficients_at(system, wear)
        total = self._coefficients.sum(axis=0)
        self._total = total * (system.friction if wear.law == "energy" else 1.0)
        self._shares = np.divide(self._coefficients, total, out=np.zeros_like(self._coefficients), where=total > 0.0)
        self._stable = system.weights / (2.0 * math.pi)  # compliance of a sawtooth on the grid
        beta = system.interfaces[0].problem.surfaces.beta_star
        for rim in system.interfaces:
            self._stable[rim.nodes] *= rim.problem.surfaces.beta_star / beta
        self._approach = 0

    def begin(self, loads: np.ndarray, wears: bool = True) -> Worn:
        """Follow the corners before the first cycle, (corners, loads) in SI; with `wears` they wear the contact."""
        self._approach = len(loads)
        start = Worn(0, 1, 0, np.zeros((2, self.run.system.grid.size)), 0.0, self._restart(), loses_contact=True)
        place = self._followed(start, loads, 1 if wears else 0)
        self._followed(place, self._cycle, 0)
        loses_contact = self.run.begins_anew_since(place.restart.configuration)
        self._stand_at(place)
        return replace(place, loses_contact=loses_contact)

    def at(self, place: Worn, approach: int) -> None:
        """Stand at a place of an earlier run, whose cycle was led to by so many corners."""
        self._approach = approach
        self._stand_at(place)

    def with_friction(self, place: Worn, friction: Profile) -> tuple[FatCycles, Worn]:
        """Follow the change to another friction at a place, under its loads. Returns the driver and place from there.

        The slip on the way dissipates, but does not wear.

        Raises
        ------
        InputError
            If the friction can't be used.
        SolveError
            If the contact is lost on the way. It names the cycle.
        """
        problem = followed_problem(self._first.problem, friction)
        self._stand_at(place)
        try:
            run = follow_friction(self.run, problem)  # type: ignore[type-var]
        except SolveError as error:
            _name_cycle(error, place.cycle)
            raise
        life = FatCycles(run, self._wear, self._cycle)
        life._approach, life._first = self._approach, system_with_friction(self._first, problem)
        return life, replace(place, restart=life._restart(run.dissipation, run.work))

    def _stand_at(self, place: Worn) -> None:
        self.run.set_gap(self._first, place.gap if place.loses_contact else None)
        self.run.go_back(place.restart)

    def next(self, place: Worn, target: int) -> Worn:
        """Go on from a place: by one cycle, or by a fat cycle that ends at the cycle `target` at the latest.

        Raises
        ------
        SolveError
            If a cycle can't be followed. It names the cycle.
        """
        before, tolerance = place.jump, self._wear.tolerance
        if tolerance == 0.0 or place.cycle < SETTLING:
            return replace(self._fat(place, 1), jump=LEAST_JUMP if tolerance else 1)
        place = self._fat(place, 1)  # the contact forgets the jump of the wear before
        if before < LEAST_JUMP:
            return replace(place, jump=LEAST_JUMP if before == 0 else before + 1)
        jump = min(target - place.cycle, before)
        while jump >= LEAST_JUMP:
            fine, error = self._pair(place, jump)
            place = replace(place, solved=place.solved + 3)
            ratio = SAFETY * tolerance / error if error > 0.0 else math.inf
            wanted = int(jump * min(max(ratio, LEAST_GROWTH), MOST_GROWTH))
            if error <= tolerance:
                most = before if jump < before else 0  # a chosen cycle has cut it short
                return replace(fine, solved=place.solved, jump=max(wanted, LEAST_JUMP, most), pause=LEAST_PAUSE)
            jump = min(wanted, jump - 1)
            if jump < LEAST_JUMP:
                return replace(place, jump=1 - place.pause, pause=min(2 * place.pause, LONGEST_PAUSE))
        return place

    def _pair(self, place: Worn, jump: int) -> tuple[Worn, float]:
        """Two halves of a fat cycle, and the error against the whole one; infinite if one can't be followed."""
        try:
            coarse = self._fat(place, jump)
            fine = self._fat(self._fat(place, jump // 2), jump - jump // 2)
        except SolveError:
            return place, math.inf
        return fine, self._error(place, fine, coarse)

    def states(self, place: Worn) -> tuple[Any, ...]:
        """The states over one cycle at a place, at its beginning and at its corners, without further wear."""
        states = self._with_gap(place, self._states)
        self.run.go_back(place.restart)
        return states

    def _states(self, place: Worn) -> tuple[Any, ...]:
        corner = self._approach + place.cycle * len(self._cycle) - 1
        try:
            return self.run.states_over(self._cycle, corner, self._first.problem)
        except SolveError as error:
            _name_cycle(error, place.cycle + 1)
            raise

    def _fat(self, place: Worn, jump: int) -> Worn:
        after = self._with_gap(place, lambda start: self._followed(start, self._cycle, jump))
        return replace(after, cycle=place.cycle + jump, solved=place.solved + 1)

    def _with_gap(self, place: Worn, follow: Callable[[Worn], Found]) -> Found:
        """Follow something from a place on; once more with the worn gap in the problem if the pin loses contact.

        Without it the next contact would begin in a hole without wear.
        """
        for start in (place, replace(place, loses_contact=True)):
            self._stand_at(start)
            before = self.run.now
            try:
                found = follow(start)
            except SolveError:
                if start.loses_contact or not self.run.begins_anew_since(before):
                    raise
            else:
                if start.loses_contact or not self.run.begins_anew_since(before):
                    break
        return found

    def _followed(self, place: Worn, loads: np.ndarray, jump: int) -> Worn:
        """Follow some corners once. The wear of each piece counts `jump` times, its energies once at least."""
        run = self.run
        sums = _Sums(place.depth, place.removed, run.dissipation, run.work)
        for given in loads:
            try:
                self._piece(place, complete_load(given, run.load), sums, jump)
                self._check_depth(sums.depth)
            except SolveError as error:
                _name_cycle(error, place.cycle + 1)
                raise
        restart = self._restart(sums.dissipation, sums.work)
        return replace(place, depth=sums.depth, removed=sums.removed, restart=restart)

    def _piece(self, place: Worn, target: np.ndarray, sums: _Sums, jump: int) -> None:
        """Follow a piece of the cycle to the load `target`, SI, and wear the contact there; add all to the `sums`.

        If much wears, the piece has parts, and the wear of each one is applied at its end.
        """
        run, start, before = self.run, self.run.here(), self.run.load
        run.step_to(target, kept=False)
        parts = self._parts(start.configuration, jump) if jump else 1
        if parts > 1:
            run.go_back(start)
            for part in range(1, parts):
                run.step_to(before + (target - before) * (part / parts), kept=False, inside=True)
                self._wear_off(place, sums, jump)
            run.step_to(target, kept=False)
        self._wear_off(place, sums, jump)

    def _parts(self, before: Configuration, jump: int) -> int:
        """The parts of the piece just followed from the configuration `before`, so that little wears in each of them.

        Raises
        ------
        SolveError
            If it would take more than :data:`MOST_PARTS`.
        """
        depth, weights, fast = self.worn_by(self.run.latest.slip_tally.sums, jump)[0], self.run.system.weights, 0.0
        for nodes in (rim.nodes for rim in self.run.system.interfaces):
            both = before.pressure[nodes], self.run.now.pressure[nodes]
            force = max(float(weights[nodes] @ pressure) for pressure in both)
            part = float(depth[nodes].max()) / force if force else 0.0
            fast = part if not part <= fast else fast
        if not fast <= MOST_PARTS * LARGEST_PART:
            raise SolveError(
                f"wear is too fast: on the way to one corner it takes off {fast:.3g} times the elastic displacement "
                "F beta*; make the wear coefficient smaller"
            )
        return max(math.ceil(fast / LARGEST_PART), 1)

    def _wear_off(self, place: Worn, sums: _Sums, jump: int) -> None:
        """Wear the contact where it is, by the slip since the last stop, and add all since then to the `sums`."""
        run, piece, times = self.run, self.run.latest, max(jump, 1)
        sums.dissipation, sums.work = sums.dissipation + times * piece.dissipation, sums.work + times * piece.work
        if not jump:
            return
        removal = run.wear(*self.worn_by(piece.slip_tally.sums, jump))
        sums.depth = sums.depth + self._shares * removal.depth
        sums.dissipation, sums.work = sums.dissipation + removal.dissipation, sums.work + removal.work
        sums.removed += removal.energy
        if place.loses_contact:
            run.set_gap(self._first, sums.depth.sum(axis=0))

    def worn_by(self, sums: np.ndarray, jump: int) -> tuple[np.ndarray, np.ndarray | None]:
        """Depth (n,) by the slip tally of a piece, and the softness (n,) of the implicit way where that is needed."""
        slip, loaded = sums[0], sums[4]
        depth = jump * self._total * loaded
        if self._wear.law == "energy":
            depth = jump * self._coefficients.sum(axis=0) * sums[1]
        if np.all(jump * self._total * slip < self._stable):
            return depth, None
        pressure = self.run.now.pressure
        mean = np.divide(loaded, pressure, out=np.full_like(slip, np.inf), where=pressure > 0.0)
        return depth, jump * self._total * np.minimum(slip, mean)

    def _error(self, start: Worn, fine: Worn, coarse: Worn) -> float:
        """The larger of the relative errors of worn gap and pressure of a fat cycle.

        Half of the error goes with the growth of the largest depth, and half with the cycles. So the errors of the gap
        add up to at most the tolerance, in parts of the largest depth. Without the second half a joint that has shaken
        down would fail for ever: it wears by rounding alone. The errors of the pressure do not add up, and have the
        weight PRESSURE_SHARE.
        """
        one, other = fine.restart.configuration.pressure, coarse.restart.configuration.pressure
        depth, most = float(fine.gap.max()), float(one.max())
        by_cycles = depth * (fine.cycle - start.cycle) / self._wear.cycles
        allowed = 0.5 * (max(depth - float(start.gap.max()), 0.0) + by_cycles)
        gap = float(np.abs(fine.gap - coarse.gap).max()) / allowed if allowed else 0.0
        return max(gap, PRESSURE_SHARE * float(np.abs(one - other).max()) / most if most else 0.0)

    def _check_depth(self, depth: np.ndarray) -> None:
        """Raise :class:`SolveError` if the worn depth (2, n) is too large for small strains."""
        total, unit = depth.sum(axis=0), self.run.system.scales.displacement
        for problem, nodes in ((rim.problem, rim.nodes) for rim in self.run.system.interfaces):
            deepest, most = float(total[nodes].max()) * unit, MOST_GAP * problem.hole_radius
            most = MOST_PARAMETER if problem.dimensionless else most
            if not deepest <= most:
                words = f"the worn depth {deepest:.3g} is too large for small strains: it must stay within {most:g}"
                raise SolveError(words)

    def _restart(self, dissipation: Energy = 0.0, work: float = 0.0) -> Any:
        return replace(self.run.here(), dissipation=dissipation, work=work, slip_tally=NOT_COUNTED)


def coefficients_at(system: System, wear: Wear) -> np.ndarray:
    """Wear coefficients of the inner and the outer body at all nodes of a system, 1/Pa, shape (2, n).

    A bush that slips is the outer body at the pin and the inner one in its seat.
    """
    found = np.zeros((2, system.grid.size))
    for rim in system.interfaces:
        found[:, rim.nodes] = wear.coefficients(rim.problem.hole_radius, rim.grid.theta)
    return found


def _name_cycle(error: SolveError, cycle: int) -> None:
    """Put the cycle in front of the message of an error."""
    error.args = (f"cycle {cycle:,}: {error}",)

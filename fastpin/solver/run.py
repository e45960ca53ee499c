"""The loop over the corners of a history on one grid. It is the same for both solvers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any, ClassVar, Protocol

import numpy as np

from fastpin.elasticity.interfaces import JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, SLIP_POSITIVE
from fastpin.model.grid import Grid
from fastpin.model.history import CycleKey, LoadHistory
from fastpin.model.loads import FRICTION_CHANGE, LOADS, M, P, Q, complete_load, named_load
from fastpin.model.options import SolveOptions
from fastpin.model.read_only import ReadOnlyDict
from fastpin.model.units import named_loads
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import (
    MARKS,
    MAX_RESIDUAL,
    SLIGHT,
    Configuration,
    Review,
    marked,
    marks_left,
    moment_that_holds,
    review,
    slip_tally_with,
    thermal_energy,
)
from fastpin.solver.errors import ArcError, ConvergenceError, SolveError
from fastpin.solver.first_contact import first_contact
from fastpin.solver.increment_stepper import IncrementStepper
from fastpin.solver.path_stepper import PathStepper
from fastpin.solver.repeats import CornerEntry, CornerLog, CycleEnd, KnownConfiguration, Repeats, copied_ends
from fastpin.solver.rest import OutsideGap, follow_floating, release
from fastpin.solver.result import Restart
from fastpin.solver.slip_tally import NOT_COUNTED, RunningTally, SlipTally
from fastpin.solver.step import (
    Piece,
    Position,
    Stepper,
    check_bond,
    check_resolution,
    check_turning,
    force_of,
    is_pushed,
    pieces,
    presses,
)
from fastpin.states.cycles import Cycle
from fastpin.states.state import SlipFields, State

log = logging.getLogger(__name__)

RunProgress = Callable[[float, int], None]
"""Called with the number of steps that are done, parts included, and the number of all steps."""

COUNTED = ("events", "exchanges", "rebuilds", "increments", "repeated", "resettled", "jumps", "released")
"""Counts in the statistics of a run."""


class Recorder(Protocol):
    """The receiver of the states and cycles of a run."""

    def begin(self, run: Run) -> None:
        """Forget everything. From here on all states come from `run`."""

    def add(self, state: State) -> None:
        """Keep a state."""

    def add_cycle(self, cycle: Cycle) -> None:
        """Keep the changes of one cycle."""

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray, slip: SlipFields) -> None:
        """Keep the latest states once more, as states of other steps with other energies.

        Parameters
        ----------
        steps : ndarray of int, shape (states,)
            Index of the corner of each new state.
        dissipation, work : ndarray, shape (states,)
            Energies of each new state, J/m.
        slip : SlipFields
            The slip fields of the first new state. Empty if they are the same as before, or not counted.
        """

    def corner_reached(self) -> None:
        """Note that the run has reached a corner. It can continue from there later."""


class Run:
    """One history, followed on one grid.

    Parameters
    ----------
    history : LoadHistory
    system : System
    options : SolveOptions
        Its nodes and arc are not used: the system has its grid.
    recorder : Recorder, optional
    progress : callable, optional
    start : Restart, optional
        The restart from which the run continues. Without it the run starts from no load.
    save_after : collection of int
        Numbers of corners after which the recorder saves a restart.
    strict : bool
        Whether the run ends where the contact is too narrow for the nodes. If not, a contact that carries next to
        nothing is let go, and a new one begins without memory.

    Attributes
    ----------
    position : Position
        The position of the run. Dissipation and work of its configuration count from the last corner.
    corner : int
        Number of corners that were reached.
    load : ndarray, shape (loads,)
        The load at the last corner, SI.
    last_corner : Configuration
        The configuration at the last corner.
    dissipation, work : float
        Energies from the start to the last corner (dimensionless).
    seat_dissipation : float
        The part of the dissipation in the seat of a bush.
    slip_tally : RunningTally
        The slip tally since the latest kept state.
    complete : bool
        Whether the whole history was followed.
    statistics : dict of str to float
        The counts of :data:`COUNTED`.
    wears : bool
        Whether the gap changes from step to step. Then no configuration repeats, borders have no marks, and the slip
        tally counts int N |ds|.
    is_coarse : bool
        Whether only the nodes that ever touch are asked for. First contacts then have no slip, and borders no marks.
    """

    wears: ClassVar[bool] = False
    is_coarse: ClassVar[bool] = False

    def __init__(
        self,
        history: LoadHistory,
        system: System,
        options: SolveOptions,
        recorder: Recorder | None = None,
        progress: RunProgress | None = None,
        start: Restart | None = None,
        save_after: Collection[int] = (),
        strict: bool = False,
    ) -> None:
        self.history = history
        self.system = system
        self.options = options
        self.recorder = recorder
        self.progress = progress
        self.save_after = save_after
        self.strict = strict
        self.keep = options.keep_rule
        self.fractions = options.fractions if self.keep.inside else options.fractions[-1:]
        if start is None:  # from no load, where an interference fit is under its own pressure
            first, load = unloaded_configuration(system), np.zeros(len(LOADS))
            now = first.changed(dissipation=0.0, work=0.0)
            start = Restart(0, load, system.scales.force, now, first.dissipation, first.work, Repeats(), {}, {})
        self.corner_log = CornerLog(history, start.marks)
        counts = (options.slip_sums or self.wears) and recorder is not None
        self._no_slip = SlipTally.empty(system.grid.size, self.wears) if counts else NOT_COUNTED
        self.statistics = dict.fromkeys(COUNTED, 0.0)
        self.stepper = stepper_of(system, options, self.statistics, strict)
        # Round a hole that is not round, or the bore of a bush that its seat bends, the pin may touch anywhere.
        may_touch = bool(system.problem.gap) or self.wears or isinstance(system, JointSystem)
        self._outside = OutsideGap(system) if may_touch and bool(system.ends.any()) else None
        self._begin_at(start)

    def _begin_at(self, start: Restart) -> None:
        """Take the place of a restart."""
        self.load = self.target = start.load
        self.dissipation, self.work, self.seat_dissipation = start.dissipation, start.work, start.seat_dissipation
        self.repeats, self.corner = start.repeats, start.corner
        self.slip_tally = RunningTally(self._no_slip, self.keep, start.slip_tally)
        self.last_corner = self._at_corner(start.configuration)
        self.position = Position(self.last_corner, start.configuration.closed.copy())
        self.complete = False
        self.statistics.update(start.statistics)

    @property
    def now(self) -> Configuration:
        """The present configuration."""
        return self.position.now

    @property
    def grid(self) -> Grid:
        """The nodes of the pin."""
        return self.system.interfaces[0].grid

    @property
    def touched(self) -> np.ndarray:
        """Whether each node was ever in contact, bool, shape (n,)."""
        return self.position.touched

    def follow(self) -> None:
        """Follow the history from the last corner that was reached to its end.

        Raises
        ------
        SolveError
            If a load can't be followed. It names the step, the fraction of the step and the load.
        """
        corners = len(self.history)
        self.corner_log.begin_cycles(self.corner - 1, self.now)
        while self.corner < corners:
            given, ended = self.history.corner(self.corner)
            load, kept = complete_load(given, self.load), self.keep.at_corner(self.corner, corners, bool(ended))
            known = self._step(load, bool(ended), kept)
            self._close_step(load, kept)
            periods = self.corner_log.end_cycles(ended, self.corner, self.now, self.system.scales)
            self._record_cycles(self.corner_log.latest)
            self.corner += 1
            if known is not None and self.options.shortcut:
                for length, since in [*periods, (known.period, known.since)]:
                    self._repeat(length, since)
            self.corner_log.begin_cycles(self.corner - 1, self.now)
            self._show_corner()
        self.complete = True

    def step_to(self, load: np.ndarray, kept: bool = True, inside: bool = False) -> None:
        """Follow one more step, to a `load` (loads,), SI. The load is no corner of the history.

        `kept` says whether its state is kept. A load `inside` a step is not counted; there a contact may be narrow.

        Raises
        ------
        SolveError
            See :meth:`follow`.
        """
        self._step(load, ends_cycle=False, kept=kept, inside=inside)
        self._close_step(load, kept=kept)
        if not inside:
            self.corner += 1
            self._show_corner()

    def go_back(self, start: Restart) -> None:
        """Go back to a corner on this grid, also from the middle of a step. Nothing is computed anew."""
        self.stepper.leave(self.position)
        self._begin_at(replace(start, repeats=Repeats(list(start.repeats))))

    def restart(self, shared: bool = False) -> Restart:
        """The restart from the last corner that was reached.

        A `shared` one has the remembered configurations of the run itself, and takes less time. It does not hold for a
        history with cycles.
        """
        marks: dict[CycleKey, CycleEnd] = {} if shared else copied_ends(self.corner_log.marks)
        repeats = Repeats(list(self.repeats)) if shared else self.repeats.copy(same_history=True)
        return Restart(
            self.corner, self.load, self.system.scales.force, self.last_corner, self.dissipation, self.work, repeats,
            marks, ReadOnlyDict(self.statistics), self.slip_tally.to_corner, self.seat_dissipation,
        )  # fmt: skip

    def _step(self, load: np.ndarray, ends_cycle: bool, kept: bool, inside: bool = False) -> KnownConfiguration | None:
        """Follow the step to the corner with the load `load` (SI), and keep its states, at the corner if `kept`.

        Where the load lies `inside` a step, the contact may have fewer nodes than at a corner. Returns the earlier
        configuration that equals the configuration at the corner, or None.
        """
        step, scales, position = self.corner, self.system.scales, self.position
        after, before = load / scales.loads, position.now.load
        self.target, position.reached = load, 0.0
        self.corner_log.begin_step()
        try:
            for piece in pieces(before, after, self.system.is_nearly_neat):
                self._follow_piece(piece)
            if not inside and self.recorder is not None:
                check_resolution(self.system, position.now)
            if self._outside is not None and self._outside.is_closed(self.system, position.now):
                raise ArcError("the pin touches the hole beyond the arc; give a wider one, or none")
            known, now = None, position.now
            if not self.wears and not self.is_coarse:
                now = position.now = marked(self.system, self.last_corner, now)
            if not self.wears and len(self.system.interfaces) == 1:  # a bush may walk, and a worn gap changes
                known = self.repeats.recall(now, ends_cycle, step)
            if known is not None:
                position.now = known.configuration.changed(
                    dissipation=now.dissipation, work=now.work, slip_tally=now.slip_tally
                )
            if self.recorder is not None and kept:
                self._keep(step, 1.0)
        except SolveError as error:
            self.stepper.leave(position)
            reached = (before + position.reached * (after - before)) * scales.loads
            error.step, error.fraction, error.load = step, position.reached, named_load(reached)
            place = named_loads(self.system.problem, error.load)
            where = f"step {step + 1}, at {100.0 * error.fraction:.4g} % ({place})"
            error.args = (f"{where}: {error}",)
            raise
        return known

    def _follow_piece(self, piece: Piece) -> None:
        """Follow one straight piece of a step, from stop to stop."""
        position, pin = self.position, self.system.interfaces[0].nodes
        self.stepper.begin_piece()
        kept = {stop for stop in self.fractions.tolist() if piece.begin < stop <= piece.end}
        for stop in sorted({*kept, piece.end}):
            load = piece.load_at(stop)
            check_turning(self.system, load)
            vanishes = self.system.is_nearly_neat and not presses(load)
            # In the last part of a piece the contact of a nearly neat fit vanishes: its tractions are rounding there.
            until = max(stop - 1e-7 * (piece.end - piece.begin), position.reached) if vanishes else stop
            aim = piece.load_at(until) if vanishes else load
            while position.now.load.tolist() != aim.tolist():
                if position.now.closed[pin].any():
                    self.stepper.advance(position, piece, until, self.report)
                else:
                    self._touch_down(aim, until)
                check_bond(self.system, position.now)
            position.reached = stop
            if vanishes and position.now.load.tolist() != load.tolist():
                self._release(load)
            if not is_pushed(load) and position.now.closed[pin].any():  # after a complete unloading
                left, before = float(position.now.pressure[pin].max()), force_of(piece.before)
                if self.system.drive.has_displacements:  # the nodal forces hold the rounding of a large displacement
                    left, before = float(self.system.weights @ position.now.pressure), 1.0
                if left <= SLIGHT * before:  # the contact carries nothing any more
                    self._release(load)
            if stop in kept and stop < 1.0 and self.recorder is not None:
                self._keep(self.corner, stop)
            self.report(stop)
        self.stepper.leave(position)

    def _touch_down(self, load: np.ndarray, stop: float) -> None:
        """Bring the floating pin into contact on the way to `load`. It may also reach `load` without contact."""
        position = self.position
        self.stepper.leave(position)
        if isinstance(self.system, JointSystem) and not is_pushed(load):
            position.now = follow_floating(self.system, position.now, load)
            if np.array_equal(position.now.load, load):
                return
        before = position.now.load.copy()
        before[[P, Q, M]] = 0.0  # a contact that was released under a little load begins anew from none
        friction_at = before  # a first contact has the friction of the load at which it is found
        for _ in range(12):  # fixed-point iterations, at most, while the friction changes
            system = self.system.under(friction_at)
            now, part = first_contact(system, position.now, before, load, self.strict, not self.is_coarse)
            if now.load[FRICTION_CHANGE] == friction_at[FRICTION_CHANGE]:
                break
            friction_at = now.load
        else:
            raise ConvergenceError(
                "no first contact was found while the friction changes; change it after the first load"
            )
        now.slip_tally = slip_tally_with(now)
        position.now = now
        position.touched |= now.closed
        position.reached += part * (stop - position.reached)
        if part == 1.0:
            now.load = load
        position.fresh = part if part < 1.0 else 0.0

    def _release(self, load: np.ndarray) -> None:
        """Release the pin at a load where it carries nothing."""
        self.stepper.leave(self.position)
        self.position.now = release(self.system, self.now, load)

    def _close_step(self, load: np.ndarray, kept: bool) -> None:
        """Log the energies and the slip tally of the step that has reached its corner, under `load` (SI).

        `kept` says whether the state at the corner was kept.
        """
        now = self.now
        self.corner_log.close_step(now.dissipation, now.work, self.slip_tally.close_step(slip_tally_with(now), kept))
        self.dissipation += now.dissipation
        self.work += now.work
        self.seat_dissipation += now.seat_dissipation
        self.position.now = self.last_corner = self._at_corner(now)
        self.load = load

    def _at_corner(self, configuration: Configuration) -> Configuration:
        """The configuration at a corner, with the sums and the slip tally of a step that begins there."""
        tally = slip_tally_with(configuration, self._no_slip)
        return configuration.changed(dissipation=0.0, work=0.0, seat_dissipation=0.0, slip_tally=tally)

    def _show_corner(self) -> None:
        """Tell the recorder and the progress that the run has reached a corner."""
        if self.recorder is not None:
            self.recorder.corner_reached()
        if self.progress is not None:
            self.progress(float(self.corner), len(self.history))

    def report(self, reached: float) -> None:
        """Report the fraction `reached` of the step after the last corner as progress of the history."""
        if self.progress is not None:
            self.progress(self.corner + reached, len(self.history))

    def _repeat(self, length: int, since: int) -> None:
        """Take the next corners from the log while their loads repeat the period that ends here.

        The present configuration has returned every `length` corners since the corner `since`.
        """
        last, energy = self.corner - 1, self.system.scales.energy
        period = self.corner_log.period(last, length, since, self.keep, self.save_after)
        if period is None:
            return
        logged, times, counts = period
        length = len(logged)
        log.info("corner %d: the last %d corners repeat %d times and are not solved again", last + 1, length, times)
        in_period = [known for known in self.repeats if known.last > last - length]
        for time in range(1, times + 1):
            entries, rows = self.corner_log.again(logged, counts, time, self.corner), []
            first = self.slip_tally.repeat([(entry.slip_tally, bool(entry.kept)) for entry in entries], time)
            for step, entry in enumerate(entries, start=self.corner):
                for dissipation, work in entry.kept:
                    rows.append((step, (self.dissipation + dissipation) * energy, (self.work + work) * energy))
                self.dissipation += entry.dissipation
                self.work += entry.work
                self._record_cycles(entry, solved=False)
            if self.recorder is not None and rows:
                steps, dissipations, works = zip(*rows, strict=True)
                slip = SlipFields() if first is None else first.fields(self.system.scales)
                self.recorder.add_again(np.array(steps), np.array(dissipations), np.array(works), slip)
            for known in in_period:
                known.last += length
            self.corner += length
            self.statistics["repeated"] += length
            if self.corner == len(self.history) and self.recorder is not None and not entries[-1].kept:
                self._keep(self.corner - 1, 1.0)  # the last state of a history is always kept
            self._show_corner()

    def _record_cycles(self, entry: CornerEntry, solved: bool = True) -> None:
        if self.recorder is not None:
            for _, cycle in entry.cycles:
                self.recorder.add_cycle(cycle._replace(solved=solved))

    def _keep(self, step: int, fraction: float) -> None:
        """Check the present configuration and hand it to the recorder as a state."""
        system, now = self.system, self.now
        residuals, left, _ = found = review(system.under(now.load), now)
        if not left <= MAX_RESIDUAL:
            raise ConvergenceError(f"the state leaves a body out of equilibrium (by {left:.2g}) and is not returned")
        if not all(residual <= MAX_RESIDUAL for residual in residuals.values()):
            worst = max(residuals, key=lambda name: residuals[name])
            raise ConvergenceError(
                f"the state violates the contact conditions ({worst} by {residuals[worst]:.2g}) and is not returned"
            )
        self.corner_log.latest.kept.append((now.dissipation, now.work))
        assert self.recorder is not None
        self.recorder.add(self._state(step, fraction, found))
        self.slip_tally.keep(now.slip_tally)

    def _state(self, step: int, fraction: float, found: Review) -> State:
        """The present configuration, with its review, as a state, SI; with the seat of a bush."""
        system, now = self.system, self.now
        drive, way = system.drive, now.rest - now.origin
        way[np.isnan(way)] = 0.0
        pushed = drive.position(now.tractions, now.motion, now.load, way[:2])
        load = drive.with_reactions(now.motion, now.load)
        if system.problem.held:
            load = load.copy()
            load[M] = moment_that_holds(system, now)
        heat, acting = thermal_energy(system, now), self.target
        # Division by a scale and multiplication lose the last bit. A load that the history gives comes back as given.
        if load is not now.load or fraction < 1.0:
            is_given = (load == now.load) & ((self.target == self.load) | (fraction == 1.0))
            acting = np.where(is_given, self.target, load * system.scales.loads)
        common = {
            "step": step,
            "fraction": fraction,
            "load": named_load(acting),
            "work": (self.work + now.work - heat) * system.scales.energy,
            "energy": (found.energy - heat) * system.scales.energy,
            "residuals": found.residuals,
        }
        inner = None  # the state of the seat, then that of the pin
        for place in reversed(range(len(system.interfaces))):
            moved = now.motion[system.interfaces[place].motion :][:3].copy()
            moved[:2] = pushed if place == 0 else way[2 * place : 2 * place + 2] + moved[:2]
            inner = self._state_of(place, common, moved, inner)
        assert inner is not None
        return inner

    def _state_of(self, place: int, common: dict[str, Any], moved: np.ndarray, seat: State | None) -> State:
        """The state of the interface `place`, with that of the `seat` inside it; `moved` is (dx, dy, rotation)."""
        now, scales, each = self.now, self.system.scales, self.system.interfaces[place]
        nodes, name, marks = each.nodes, MARKS[place], getattr(now, MARKS[place])
        status = now.status[nodes].copy()
        if each.problem.frictionless:
            status = np.where(now.closed[nodes], SLIP_POSITIVE, OPEN).astype(np.int8)
        dissipated = (
            (self.dissipation, now.dissipation) if place == 0 else (self.seat_dissipation, now.seat_dissipation)
        )
        nodal = {
            "pressure": now.pressure[nodes] * scales.traction,
            "shear": now.shear[nodes] * scales.traction,
            "gap": now.gap[nodes] * scales.displacement,
            "slip": (now.slip - now.rest_slip)[nodes] * scales.displacement,
            "status": status,
        }
        slid = self.slip_tally.since_kept(slip_tally_with(now)).fields(scales)
        nodal |= {field: values[nodes] for field, values in slid.items()}  # type: ignore[index]
        for array in nodal.values():
            array.setflags(write=False)  # nobody else writes to them, so the state needs no views
        if common["fraction"] < 1.0:  # corners are marked already
            marks = marks_left(self.last_corner, now, each, name)
        if place > 0:  # the friction of the pin alone may change
            common = {**common, "load": {**common["load"], "friction_change": 0.0}}
        return State(
            **nodal, **common, theta=each.grid.theta, dx=float(moved[0]) * scales.displacement,
            dy=float(moved[1]) * scales.displacement, rotation=float(moved[2]) * scales.rotation,
            dissipation=(dissipated[0] + dissipated[1]) * scales.energy, problem=each.problem, grid=each.grid,
            marks=marks, seat=seat,
        )  # fmt: skip


def stepper_of(system: System, options: SolveOptions, statistics: dict[str, float], strict: bool) -> Stepper:
    """The solver of the method that the options name."""
    if options.method == "increment":
        assert options.increments is not None
        return IncrementStepper(system, options.increments, statistics)
    if system.needs_windows:
        from fastpin.narrow import WindowStepper

        return WindowStepper(system, statistics, strict)
    return PathStepper(system, statistics, strict)

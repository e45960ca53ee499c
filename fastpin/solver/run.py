"""The loop over the steps of a history on one grid, for both solvers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from fastpin import tableau
from fastpin.collocation import MAX_RESIDUAL, Configuration, M, P, Q, System
from fastpin.columns import Memory
from fastpin.contact import first_contact, released, unloaded
from fastpin.errors import CUT_OFF, ArcError, ConvergenceError, NoEquilibriumError, SolveError
from fastpin.increment import implicit_step
from fastpin.keep import EVERYTHING, Keep
from fastpin.loading import CycleKey, LoadHistory, filled, named_load
from fastpin.past import Logged, Mark, Past, copies
from fastpin.path import PathStep, StepLostError
from fastpin.repeats import Met, Repeats
from fastpin.state import OPEN, SLIP_POSITIVE, Cycle, State

log = logging.getLogger(__name__)

Method = Literal["path", "increment"]
Progress = Callable[[float, int], None]

MOST_HALVINGS = 12

FEW_NODES = 8
"""A contact of so few nodes that is lost while the pin is being unloaded completely has just opened."""

NEGLIGIBLE = 1e-3
"""Part of a step's force below which a contact narrower than the grid is given up and looked for again."""

MOST_RELEASES = 20
"""Times that this may happen in one step."""

ALMOST_UNLOADED = 1.0 - 1e-8
"""So far into a complete unloading everything falls to zero together, and the order of events is rounding."""


@dataclass(frozen=True)
class _Piece:
    """A straight piece of a step, from fraction `begin` to fraction `end` of it."""

    begin: float
    end: float
    before: np.ndarray
    after: np.ndarray

    def load_at(self, fraction: float) -> np.ndarray:
        if fraction == self.end:
            return self.after.copy()
        return self.before + (fraction - self.begin) / (self.end - self.begin) * (self.after - self.before)


def _pieces(before: np.ndarray, after: np.ndarray) -> list[_Piece]:
    """A step, cut in two where the pin's force passes through zero and changes its sense: contact is lost there."""
    first, last = before[[P, Q]], after[[P, Q]]
    if first @ last < 0.0 and abs(first[0] * last[1] - first[1] * last[0]) <= 1e-12 * abs(first @ last):
        cut = float(np.linalg.norm(first) / (np.linalg.norm(first) + np.linalg.norm(last)))
        middle = before + cut * (after - before)
        middle[[P, Q]] = 0.0
        return [_Piece(0.0, cut, before, middle), _Piece(cut, 1.0, middle, after)]
    return [_Piece(0.0, 1.0, before, after)]


def _pushed(load: np.ndarray) -> bool:
    """Whether a force acts on the pin."""
    return bool(load[P] != 0.0 or load[Q] != 0.0)


def _force(load: np.ndarray) -> float:
    """Size of the force on the pin."""
    return float(np.hypot(load[P], load[Q]))


def _solve_error(code: int, lost: Configuration, held: bool) -> SolveError:
    """What to raise when the path is lost at the configuration `lost`; `held` if the pin can't rotate freely."""
    closed = int(lost.closed.sum())
    if code == tableau.ARC_END:
        return ArcError(CUT_OFF)
    if closed < FEW_NODES // 2 or (held and closed <= FEW_NODES):
        return ConvergenceError(f"the contact has shrunk to {closed} nodes and is lost between them; use more nodes")
    if code == tableau.NO_SUPPORT:
        return NoEquilibriumError("nothing holds the pin any more: it spins, slides away or loses contact")
    return ConvergenceError("the stick and slip zones did not settle")


class Recorder(Protocol):
    """Where a run leaves what it finds."""

    def begin(self, run: Run) -> None:
        """Forget all; from here on everything comes from `run`."""

    def add(self, state: State) -> None:
        """Keep a state."""

    def add_cycle(self, cycle: Cycle) -> None:
        """Keep what a cycle has changed."""

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray) -> None:
        """Keep the latest states once more, as states of other steps with other energies, shape (states,)."""

    def corner_reached(self) -> None:
        """The run stands at a corner, from which it can be gone on."""


@dataclass(frozen=True, eq=False)
class Restart:
    """What is needed to go on from a corner, to the same bits.

    Attributes
    ----------
    corner : int
        Corners of the history that were followed.
    load : ndarray, shape (loads,)
        The load there, SI.
    force : float
        The reference force, N/m.
    configuration : Configuration
        Its dissipation and work are 0.
    dissipation, work : float
        Until there (dimensionless).
    repeats : Repeats
    marks : dict
        The latest end of each cycle.
    statistics : dict of str to float
    """

    corner: int
    load: np.ndarray
    force: float
    configuration: Configuration
    dissipation: float
    work: float
    repeats: Repeats
    marks: dict[CycleKey, Mark]
    statistics: dict[str, float]

    def elsewhere(self) -> Restart:
        """The same for another history, which begins here."""
        return replace(self, corner=0, repeats=self.repeats.copy(), marks={}, statistics={})


class Run:
    """One history on one grid.

    Parameters
    ----------
    history : LoadHistory
    system : System
    method : {"path", "increment"}
    increments : int
        Increments a step, for the increment solver.
    fractions : ndarray
        Fractions of every step at which it stops; the last one is 1.
    recorder : Recorder, optional
        Who wants the states.
    keep : Keep
        Which states.
    progress : callable, optional
    start : Restart, optional
        Where to start from; without load if not given.
    shortcut : bool
        Whether what repeats exactly is taken from the record instead of being solved again.
    stops : collection of int
        Numbers of corners at which the recorder wants to see the run.

    Attributes
    ----------
    now : Configuration
        The last configuration that was reached. Its dissipation and work are those since the last corner.
    corner : int
        Corners that were reached.
    touched : ndarray of bool
        Nodes that have ever been in contact.
    """

    def __init__(
        self,
        history: LoadHistory,
        system: System,
        method: Method,
        increments: int,
        fractions: np.ndarray,
        recorder: Recorder | None = None,
        keep: Keep = EVERYTHING,
        progress: Progress | None = None,
        start: Restart | None = None,
        shortcut: bool = True,
        stops: Collection[int] = (),
    ) -> None:
        self.history = history
        self.system = system
        self.method = method
        self.increments = increments
        self.fractions = fractions if keep.inside else fractions[-1:]
        self.recorder = recorder
        self.keep = keep
        self.progress = progress
        self.shortcut = shortcut
        self.stops = stops
        if start is None:
            first, load = unloaded(system), np.zeros(system.loads.shape[1])
            now = replace(first, dissipation=0.0, work=0.0)
            start = Restart(0, load, system.scales.force, now, first.dissipation, first.work, Repeats(), {}, {})
        self.now = start.configuration
        self.load = start.load
        self.dissipation, self.work = start.dissipation, start.work
        self.repeats, self.past = start.repeats, Past(history, start.marks)
        self.corner = start.corner
        self.settled = start.configuration  # at the last corner
        self.touched = self.now.closed.copy()
        self.complete = False
        self.reached = 0.0  # fraction of the present step
        self.fresh = 0.0  # part of the way to a stop at which the contact was found
        self.releases = 0
        self.path: PathStep | None = None
        self.memory = Memory(system.grid.size)
        self.path_begin = 0.0
        counted = ("events", "exchanges", "rebuilds", "increments", "repeated")
        self.statistics = {**dict.fromkeys(counted, 0.0), **start.statistics}

    def follow(self) -> None:
        """Follow the history from the corner where the run stands to its end."""
        corners = len(self.history)
        self.past.begin_cycles(self.corner - 1, self.now)
        while self.corner < corners:
            given, ended = self.history.corner(self.corner)
            load = filled(given, self.load)
            met = self._step(load, bool(ended))
            self._close_step(load)
            periods = self.past.end_cycles(ended, self.corner, self.now, self.system.scales)
            self._record_cycles(self.past.log[-1])
            self.corner += 1
            if met is not None and self.shortcut:
                for length, since in [*periods, (met.period, met.since)]:
                    self._repeat(length, since)
            self.past.begin_cycles(self.corner - 1, self.now)
            self._stand()
        self.complete = True

    def restart(self) -> Restart:
        """To go on from the last corner that was reached."""
        return Restart(
            self.corner, self.load, self.system.scales.force, self.settled, self.dissipation, self.work,
            self.repeats.copy(same_history=True), copies(self.past.marks), dict(self.statistics),
        )  # fmt: skip

    def _step(self, load: np.ndarray, ends_cycle: bool) -> Met | None:
        """Follow the step to the corner with the load `load` (SI), and keep its states.

        Returns what was met before, if the configuration there is the same.
        """
        step, corners, scales = self.corner, len(self.history), self.system.scales
        target, before, self.reached = load / scales.loads, self.now.load, 0.0
        self.past.log.append(Logged())
        try:
            for piece in _pieces(before, target):
                self._follow_piece(piece, step, corners)
            met = self.repeats.meet(self.now, ends_cycle, step)
            if met is not None:
                dissipation, work = self.now.dissipation, self.now.work
                self.now = replace(met.configuration, dissipation=dissipation, work=work)
            if self.recorder is not None and self.keep.corner(step, corners, ends_cycle):
                self._keep(step, 1.0)
        except SolveError as error:
            self._leave_path()
            reached = (before + self.reached * (target - before)) * scales.loads
            error.step, error.fraction, error.load = step, self.reached, named_load(reached)
            place = ", ".join(f"{name} = {value:.6g}" for name, value in error.load.items() if value != 0.0)
            where = f"step {step + 1}, at {100.0 * error.fraction:.4g} % ({place or 'no load'})"
            error.args = (f"{where}: {error}",)
            raise
        return met

    def _close_step(self, load: np.ndarray) -> None:
        """Book the energies of the step that has come to its corner, under `load`."""
        self.past.close_step(self.now.dissipation, self.now.work)
        self.dissipation += self.now.dissipation
        self.work += self.now.work
        self.now = self.settled = replace(self.now, dissipation=0.0, work=0.0)
        self.load = load

    def _stand(self) -> None:
        """Show that a corner has been reached."""
        if self.recorder is not None:
            self.recorder.corner_reached()
        if self.progress is not None:
            self.progress(float(self.corner), len(self.history))

    def _repeat(self, length: int, since: int) -> None:
        """Where the loads ahead are those of the period that ends here, take the record for them.

        The present configuration is that of every `length` corners before, back to the corner `since`.
        """
        now = self.corner - 1
        period = self.past.period(now, length, since, self.keep, self.stops)
        if period is None:
            return
        length = len(period.logged)
        log.info(
            "corner %d: the last %d corners repeat %d times and are not solved again", now + 1, length, period.times
        )
        latest = [other for other in self.repeats if other.last > now - length]
        for time in range(1, period.times + 1):
            entries = self.past.again(period, time, self.corner)
            self._book_again(entries)
            for other in latest:
                other.last += length
            self.corner += length
            self.statistics["repeated"] += length
            if self.corner == len(self.history) and self.recorder is not None and not entries[-1].kept:
                self._keep(self.corner - 1, 1.0)  # the last one is kept in any case
            self._stand()

    def _book_again(self, entries: list[Logged]) -> None:
        """The next corners, which are known."""
        energy, rows = self.system.scales.energy, []
        for step, entry in enumerate(entries, start=self.corner):
            for dissipation, work in entry.kept:
                rows.append((step, (self.dissipation + dissipation) * energy, (self.work + work) * energy))
            self.dissipation += entry.dissipation
            self.work += entry.work
            self._record_cycles(entry, solved=False)
        if self.recorder is not None and rows:
            steps, dissipations, works = zip(*rows, strict=True)
            self.recorder.add_again(np.array(steps), np.array(dissipations), np.array(works))

    def _record_cycles(self, entry: Logged, solved: bool = True) -> None:
        if self.recorder is not None:
            for _, cycle in entry.cycles:
                self.recorder.add_cycle(cycle._replace(solved=solved))

    def _follow_piece(self, piece: _Piece, step: int, steps: int) -> None:
        """One straight piece of the history, from stop to stop."""
        self.releases = 0
        kept = self.fractions[(self.fractions > piece.begin) & (self.fractions <= piece.end)]
        for stop in np.unique(np.r_[kept, piece.end]):
            self._go(piece, float(stop), step, steps)
            if stop in kept and stop < 1.0 and self.recorder is not None:
                self._keep(step, float(stop))
            if self.progress is not None:
                self.progress(step + float(stop), steps)
        self._leave_path()

    def _go(self, piece: _Piece, stop: float, step: int, steps: int) -> None:
        """Bring the present configuration to the load at the fraction `stop` of the step."""
        load = piece.load_at(stop)
        self._check_moment(load)
        while not np.array_equal(self.now.load, load):
            if not self.now.closed.any():
                self._touch_down(load, stop)
            elif self.method == "increment":
                parts = self._parts(stop)
                self._increments(load, parts, stop, self._reporter(step, self.reached, stop, steps))
            else:
                self._follow_path(piece, load, stop, self._reporter(step, self.reached, piece.end, steps))
        self.reached = stop
        self._release_if_unloaded(piece, load)

    def _touch_down(self, load: np.ndarray, stop: float) -> None:
        """Bring the floating pin into contact on the way to `load`; it may also get there without contact."""
        self._leave_path()
        self.now, part = first_contact(self.system, self.now, self.now.load, load)
        self.touched |= self.now.closed
        self.reached += part * (stop - self.reached)
        if part == 1.0:
            self.now.load = load
        self.fresh = part if part < 1.0 else 0.0

    def _follow_path(
        self, piece: _Piece, load: np.ndarray, stop: float, report: Callable[[float], None] | None
    ) -> None:
        """Follow the piece exactly, up to the fraction `stop` of the step or to where the contact is lost."""
        try:
            if self.path is None:
                self.path_begin = self.reached
                self.path = PathStep(self.system, self.now, piece.after, self.memory)
            length = piece.end - self.path_begin
            self.now = self.path.follow(1.0 if stop == piece.end else (stop - self.path_begin) / length, report)
            self.now.load = load
        except StepLostError as lost:
            if self.path is not None:
                self.reached = self.path_begin + lost.fraction * (piece.end - self.path_begin)
                self.now = self.path.now
            if not self._just_opened(piece, lost):
                raise _solve_error(lost.code, self.now, self.system.problem.rotation == "fixed") from None
            self._leave_path()
            self.now = released(self.system, self.now, self.now.load)

    def _just_opened(self, piece: _Piece, lost: StepLostError) -> bool:
        """Whether a contact that lost its support has only become too small for the grid, or carried nothing."""
        if lost.code == tableau.ARC_END:
            return False
        unloading = not _pushed(piece.after) and piece.after[M] == 0.0
        if unloading and lost.fraction > ALMOST_UNLOADED:
            return True
        if self.now.load[M] != 0.0 or int(self.now.closed.sum()) > FEW_NODES or self.releases == MOST_RELEASES:
            return False
        self.releases += 1
        return unloading or _force(self.now.load) <= NEGLIGIBLE * max(_force(piece.before), _force(piece.after))

    def _leave_path(self) -> None:
        """Forget the path that is being followed, and count what it took."""
        if self.path is None:
            return
        self.touched |= self.path.touched
        self.statistics["events"] += self.path.events
        self.statistics["exchanges"] += self.path.exchanges
        self.statistics["rebuilds"] += self.path.rebuilds
        self.path = None

    def _check_moment(self, load: np.ndarray) -> None:
        problem = self.system.problem
        if problem.frictionless and problem.rotation == "free" and load[M] != 0.0:
            raise NoEquilibriumError("without friction nothing holds the pin against a moment: it spins")

    def _reporter(self, step: int, begin: float, end: float, steps: int) -> Callable[[float], None] | None:
        """What reports the fraction of a way from `begin` to `end` of a step as progress of the history."""
        if self.progress is None:
            return None
        progress = self.progress
        return lambda part: progress(step + begin + part * (end - begin), steps)

    def _parts(self, stop: float) -> np.ndarray:
        """Ends of the increments up to the fraction `stop` of the step, in parts of the way there."""
        if self.fresh > 0.0:  # growing linearly from the first contact
            ends = np.arange(1, self.increments + 1) * np.arange(2, self.increments + 2)
            ends = ends / ends[-1]
            parts = (ends[ends > self.fresh] - self.fresh) / (1.0 - self.fresh)
            self.fresh = 0.0
            return parts
        count = max(1, round(self.increments * (stop - self.reached)))
        return np.arange(1, count + 1) / count

    def _increments(
        self, load: np.ndarray, parts: np.ndarray, stop: float, report: Callable[[float], None] | None
    ) -> None:
        """Implicit increments from the present load to `load`, at the given parts of the way (the last one is 1)."""
        before, begin = self.now.load, self.reached
        for part in parts:
            target = load if part == 1.0 else before + part * (load - before)
            self._increment(self.now, target, MOST_HALVINGS)
            self.reached = begin + float(part) * (stop - begin)
            if report is not None:
                report(float(part))

    def _increment(self, start: Configuration, load: np.ndarray, halvings: int) -> None:
        """One implicit increment from `start` to `load`, halved where its iteration cycles."""
        system = self.system
        found = implicit_step(system, start, load)
        if found is None or system.worst_residual(found) > MAX_RESIDUAL:
            if not _pushed(load) and load[M] == 0.0:  # unloaded completely
                self.now = released(system, start, load)
                return
            if halvings == 0:
                raise ConvergenceError(
                    "no state that meets the contact conditions was found; either none carries a larger load, or the "
                    "increments are too large"
                )
            self._increment(start, 0.5 * (start.load + load), halvings - 1)
            self._increment(self.now, load, halvings - 1)
            return
        if system.reaches_end(found):
            raise ArcError(CUT_OFF)
        found.work = start.work + system.work(start, found)
        found.dissipation = start.dissipation + system.dissipated(start, found)
        self.now = found
        self.touched |= found.closed
        self.statistics["increments"] += 1

    def _release_if_unloaded(self, piece: _Piece, load: np.ndarray) -> None:
        """Forget a contact that carries nothing any more: the pin has been unloaded completely."""
        if _pushed(load) or not self.now.closed.any():
            return
        if float(self.now.pressure.max()) <= 1e-9 * _force(piece.before):
            self._leave_path()
            self.now = released(self.system, self.now, load)

    def _keep(self, step: int, fraction: float) -> None:
        """Check the present configuration and hand it to the recorder as a state."""
        system, now, scales = self.system, self.now, self.system.scales
        frictionless = system.problem.frictionless
        residuals = system.residuals(now)
        if not np.max(list(residuals.values())) <= MAX_RESIDUAL:
            worst = max(residuals, key=lambda name: residuals[name])
            raise ConvergenceError(
                f"the state violates the contact conditions ({worst} by {residuals[worst]:.2g}) and is not returned"
            )
        moved = np.nan_to_num(now.rest - now.origin) + now.motion[:2]
        state = State(
            step=step,
            fraction=fraction,
            load=named_load(now.load * scales.loads),
            theta=system.grid.theta,
            pressure=now.pressure * scales.traction,
            shear=now.shear * scales.traction,
            gap=now.gap * scales.displacement,
            slip=(now.slip - now.rest_slip) * scales.displacement,
            status=np.where(now.closed, SLIP_POSITIVE, OPEN).astype(np.int8) if frictionless else now.status.copy(),
            dx=float(moved[0]) * scales.displacement,
            dy=float(moved[1]) * scales.displacement,
            rotation=float(now.motion[2]) * scales.rotation,
            dissipation=(self.dissipation + now.dissipation) * scales.energy,
            work=(self.work + now.work) * scales.energy,
            energy=system.energy(now) * scales.energy,
            residuals=residuals,
            problem=system.problem,
            grid=system.grid,
        )
        for array in (state.pressure, state.shear, state.gap, state.slip, state.status):
            array.setflags(write=False)  # repeated steps share them
        self.past.log[-1].kept.append((now.dissipation, now.work))
        assert self.recorder is not None
        self.recorder.add(state)

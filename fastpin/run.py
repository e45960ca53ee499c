"""The loop over the steps of a history on one grid, for both solvers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fastpin import tableau
from fastpin.collocation import MAX_RESIDUAL, Configuration, M, P, Q, System
from fastpin.columns import Memory
from fastpin.contact import first_contact, released, unloaded
from fastpin.errors import CUT_OFF, ArcError, ConvergenceError, NoEquilibriumError, SolveError
from fastpin.increment import implicit_step
from fastpin.loading import LoadHistory, named_load
from fastpin.path import PathStep, StepLostError
from fastpin.repeats import Repeats, Step
from fastpin.state import OPEN, SLIP_POSITIVE, Restart, Result, State

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


class Run:
    """One history on one grid.

    Parameters
    ----------
    system : System
    method : {"path", "increment"}
    increments : int
        Increments a step, for the increment solver.
    fractions : ndarray
        Fractions of every step at which a state is kept; the last one is 1.
    progress : callable, optional
    configuration : Configuration, optional
        Where to start from; without load if not given.
    repeats : Repeats, optional
        Steps that were followed before.

    Attributes
    ----------
    now : Configuration
        The last configuration that was reached.
    states : list of State
        The states kept so far.
    touched : ndarray of bool
        Nodes that have ever been in contact.
    """

    def __init__(
        self,
        system: System,
        method: Method,
        increments: int,
        fractions: np.ndarray,
        progress: Progress | None = None,
        configuration: Configuration | None = None,
        repeats: Repeats | None = None,
    ) -> None:
        self.system = system
        self.method = method
        self.increments = increments
        self.fractions = fractions
        self.progress = progress
        self.now = unloaded(system) if configuration is None else configuration
        self.states: list[State] = []
        self.touched = self.now.closed.copy()
        self.complete = False
        self.reached = 0.0  # fraction of the present step
        self.fresh = 0.0  # part of the way to a stop at which the contact was found
        self.releases = 0
        self.path: PathStep | None = None
        self.memory = Memory(system.grid.size)
        self.path_begin = 0.0
        self.repeats = Repeats() if repeats is None else repeats
        self.statistics = {"events": 0.0, "exchanges": 0.0, "rebuilds": 0.0, "increments": 0.0, "repeated": 0.0}

    def follow(self, values: np.ndarray) -> None:
        """Follow all steps to the corners `values`, shape (corners, loads), SI units."""
        for step, target in enumerate(values / self.system.scales.loads):
            before, self.reached = self.now.load, 0.0
            try:
                self._follow_step(target, step, len(values))
            except SolveError as error:
                self._leave_path()
                load = (before + self.reached * (target - before)) * self.system.scales.loads
                error.step, error.fraction, error.load = step, self.reached, named_load(load)
                place = ", ".join(f"{name} = {value:.6g}" for name, value in error.load.items() if value != 0.0)
                where = f"step {step + 1}, at {100.0 * error.fraction:.4g} % ({place or 'no load'})"
                error.args = (f"{where}: {error}",)
                raise
        self.complete = True

    def result(self, history: LoadHistory, seconds: float) -> Result:
        """What has been solved so far."""
        system = self.system
        restart = Restart(self.now.load * system.scales.loads, system.scales.force, self.now, self.repeats)
        statistics = {**self.statistics, "seconds": seconds}
        return Result(
            self.states, system.problem, history, system.grid, self.method, statistics, self.complete, restart
        )

    def _follow_step(self, target: np.ndarray, step: int, steps: int) -> None:
        """The step to the load `target`, or what it was the last time it was followed from here."""
        begin, kept = self.now, len(self.states)
        key = (begin.load.tobytes(), target.tobytes(), self.fractions.tobytes(), self.method, self.increments)
        known = self.repeats.find(key, begin)
        if known is None:
            for piece in _pieces(begin.load, target):
                self._follow_piece(piece, step, steps)
            self.repeats.add(key, Step(begin, self.now, self.states[kept:]))
            return
        self.now, states = known.again(begin, self.system.scales, step)
        self.states += states
        self.statistics["repeated"] += 1
        if self.progress is not None:
            self.progress(step + 1.0, steps)

    def _follow_piece(self, piece: _Piece, step: int, steps: int) -> None:
        """One straight piece of the history, from stop to stop."""
        self.releases = 0
        kept = self.fractions[(self.fractions > piece.begin) & (self.fractions <= piece.end)]
        for stop in np.unique(np.r_[kept, piece.end]):
            self._go(piece, float(stop), step, steps)
            if stop in kept:
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
        """Check the present configuration and keep it as a state."""
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
            dissipation=now.dissipation * scales.energy,
            work=now.work * scales.energy,
            energy=system.energy(now) * scales.energy,
            residuals=residuals,
            problem=system.problem,
            grid=system.grid,
        )
        for array in (state.pressure, state.shear, state.gap, state.slip, state.status):
            array.setflags(write=False)  # repeated steps share them
        self.states.append(state)

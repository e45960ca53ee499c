"""The loop over the steps of a history on one grid, for both solvers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fastpin import tableau
from fastpin.collocation import MAX_RESIDUAL, Configuration, M, P, Q, System
from fastpin.contact import first_contact, released, unloaded
from fastpin.errors import ArcError, ConvergenceError, NoEquilibriumError, SolveError
from fastpin.increment import implicit_step
from fastpin.loading import LoadHistory, named_load
from fastpin.path import PathStep, StepLostError
from fastpin.state import Restart, Result, State

Method = Literal["path", "increment"]
Progress = Callable[[float, int], None]

MOST_HALVINGS = 12

FEW_NODES = 8
"""A contact of so few nodes that is lost while the pin is being unloaded completely has just opened."""

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


def _equal_parts(count: int) -> np.ndarray:
    """Ends of `count` equal increments in parts of a way."""
    return np.arange(1, count + 1) / count


def _growing_parts(count: int, done: float) -> np.ndarray:
    """Ends of `count` increments that grow linearly, in parts of what is left of a way with `done` of it behind."""
    ends = np.arange(1, count + 1) * np.arange(2, count + 2) / (count * (count + 1.0))
    ahead = ends[ends > done]
    return (ahead - done) / (1.0 - done) if done < 1.0 else ahead


def _pushed(load: np.ndarray) -> bool:
    """Whether a force acts on the pin."""
    return bool(load[P] != 0.0 or load[Q] != 0.0)


def _solve_error(code: int, fraction: float, closed: int) -> SolveError:
    if code == tableau.ARC_END:
        return ArcError("the contact reaches an end of the arc; give a wider one, or none", fraction=fraction)
    hint = f"; only {closed} nodes are in contact, use more of them" if closed <= FEW_NODES else ""
    if code == tableau.NO_SUPPORT:
        return NoEquilibriumError(
            f"nothing holds the pin any more, it spins, slides away or loses contact{hint}", fraction=fraction
        )
    return ConvergenceError(f"the stick and slip zones did not settle{hint}", fraction=fraction)


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
        self.statistics = {"events": 0.0, "exchanges": 0.0, "rebuilds": 0.0, "increments": 0.0}

    def follow(self, values: np.ndarray) -> None:
        """Follow all steps to the corners `values`, shape (corners, loads), SI units."""
        for step, target in enumerate(values / self.system.scales.loads):
            before = self.now.load
            try:
                for piece in _pieces(before, target):
                    self._follow_piece(piece, step, len(values))
            except SolveError as error:
                load = (before + error.fraction * (target - before)) * self.system.scales.loads
                error.step, error.load = step, named_load(load)
                place = ", ".join(f"{name} = {value:.6g}" for name, value in error.load.items() if value != 0.0)
                where = f"step {step + 1}, at {100.0 * error.fraction:.4g} % ({place or 'no load'})"
                error.args = (f"{where}: {error}",)
                raise
        self.complete = True

    def result(self, history: LoadHistory, seconds: float) -> Result:
        """What has been solved so far."""
        system = self.system
        restart = Restart(self.now.load * system.scales.loads, system.scales.force, self.now)
        statistics = {**self.statistics, "seconds": seconds}
        return Result(
            self.states, system.problem, history, system.grid, self.method, statistics, self.complete, restart
        )

    def _follow_piece(self, piece: _Piece, step: int, steps: int) -> None:
        """One straight piece of the history, from stop to stop."""
        inside = self.fractions[(self.fractions > piece.begin) & (self.fractions <= piece.end)]
        reached = stop = piece.begin
        path: PathStep | None = None
        try:
            self._check_moment(piece)
            for stop in np.unique(np.r_[inside, piece.end]):
                load = piece.load_at(stop)
                parts = _equal_parts(max(1, round(self.increments * (stop - reached))))
                if not self.now.closed.any() and not np.array_equal(self.now.load, load):
                    touched = self._touch_down(load)
                    parts = _growing_parts(self.increments, touched)
                    reached += touched * (stop - reached)
                if self.method == "increment":
                    if not np.array_equal(self.now.load, load):
                        self._increments(load, parts, self._reporter(step, reached, float(stop), steps))
                elif not np.array_equal(self.now.load, load):
                    if path is None:
                        path = PathStep(self.system, self.now, piece.after)
                        origin = reached
                    part = 1.0 if stop == piece.end else (stop - origin) / (piece.end - origin)
                    self.now = path.follow(part, self._reporter(step, origin, piece.end, steps))
                    self.now.load = load
                self._release_if_unloaded(load)
                reached = float(stop)
                if stop in inside:
                    self._keep(step, reached)
                if self.progress is not None:
                    self.progress(step + reached, steps)
        except StepLostError as lost:
            last_nodes = path is not None and int(path.now.closed.sum()) <= FEW_NODES
            if not _pushed(piece.after) and (last_nodes or lost.fraction > ALMOST_UNLOADED):
                self.now = released(self.system, self.now if path is None else path.now, piece.after)
                if piece.end in inside:
                    self._keep(step, piece.end)
            else:
                fraction = reached if path is None else origin + lost.fraction * (piece.end - origin)
                raise _solve_error(lost.code, fraction, int(self.now.closed.sum())) from None
        except SolveError as error:
            error.fraction = reached + error.fraction * (stop - reached)  # so far relative to the way to this stop
            raise
        finally:
            if path is not None:
                self.touched |= path.touched
                self.statistics["events"] += path.events
                self.statistics["exchanges"] += path.exchanges
                self.statistics["rebuilds"] += path.rebuilds

    def _check_moment(self, piece: _Piece) -> None:
        problem = self.system.problem
        if problem.frictionless and problem.rotation == "free" and piece.after[M] != 0.0:
            raise NoEquilibriumError("without friction nothing holds the pin against a moment: it spins")

    def _reporter(self, step: int, begin: float, end: float, steps: int) -> Callable[[float], None] | None:
        """What reports the fraction of a way from `begin` to `end` of a step as progress of the history."""
        if self.progress is None:
            return None
        progress = self.progress
        return lambda part: progress(step + begin + part * (end - begin), steps)

    def _touch_down(self, load: np.ndarray) -> float:
        """Bring the floating pin into contact on the way to `load`; returns the fraction of the way at which it is.

        The pin may also stay without contact; it is then at `load`, and the fraction is 1.
        """
        self.now, fraction = first_contact(self.system, self.now, self.now.load, load)
        self.touched |= self.now.closed
        return fraction

    def _increments(self, load: np.ndarray, parts: np.ndarray, report: Callable[[float], None] | None) -> None:
        """Implicit increments from the present load to `load`, at the given parts of the way (the last one is 1)."""
        before, done = self.now.load, 0.0
        try:
            for part in parts:
                target = load if part == 1.0 else before + part * (load - before)
                self._increment(self.now, target, MOST_HALVINGS)
                done = float(part)
                if report is not None:
                    report(done)
        except SolveError as error:
            error.fraction = done
            raise

    def _increment(self, start: Configuration, load: np.ndarray, halvings: int) -> None:
        """One implicit increment from `start` to `load`, halved where its iteration cycles."""
        system = self.system
        found = implicit_step(system, start, load)
        if found is None or system.worst_residual(found) > MAX_RESIDUAL:
            if halvings == 0:
                raise ConvergenceError(
                    "no state that meets the contact conditions was found; either none carries a larger load, or the "
                    "increments are too large"
                )
            self._increment(start, 0.5 * (start.load + load), halvings - 1)
            self._increment(self.now, load, halvings - 1)
            return
        ends = np.array([0, system.grid.size - 1])
        if not system.grid.closed and found.closed[ends].any():
            raise ArcError("the contact reaches an end of the arc; give a wider one, or none")
        found.work = start.work + system.work(start, found)
        slid = np.where(found.closed, found.slip - start.slip, 0.0)
        found.dissipation = start.dissipation - 0.5 * float((system.weights * slid) @ (start.shear + found.shear))
        self.now = found
        self.touched |= found.closed
        self.statistics["increments"] += 1

    def _release_if_unloaded(self, load: np.ndarray) -> None:
        """Forget a contact that carries nothing any more: the pin has been unloaded completely."""
        if _pushed(load) or not self.now.closed.any():
            return
        before = max((float(state.pressure.max()) for state in self.states[-1:]), default=0.0)
        if float(self.now.pressure.max()) * self.system.scales.traction <= 1e-9 * before:
            self.now = released(self.system, self.now, load)

    def _keep(self, step: int, fraction: float) -> None:
        """Check the present configuration and keep it as a state."""
        system, now, scales = self.system, self.now, self.system.scales
        residuals = system.residuals(now)
        if not max(residuals.values()) <= MAX_RESIDUAL:
            worst = max(residuals, key=lambda name: residuals[name])
            raise ConvergenceError(
                f"the state violates the contact conditions ({worst} by {residuals[worst]:.2g}) and is not returned"
            )
        moved = np.nan_to_num(now.rest - now.origin) + now.motion[:2]
        self.states.append(
            State(
                step=step,
                fraction=fraction,
                load=named_load(now.load * scales.loads),
                theta=system.grid.theta,
                pressure=now.pressure * scales.traction,
                shear=now.shear * scales.traction,
                gap=now.gap * scales.displacement,
                slip=(now.slip - now.rest_slip) * scales.displacement,
                status=now.status.copy(),
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
        )

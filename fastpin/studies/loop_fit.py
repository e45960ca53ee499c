"""The fit of a model to a measured loop: curves from solutions, unknowns, bars.

The model is driven by the ends of the branches alone. The unknowns are fitted to the distances of all samples from its
curves, along the normal. The unknown of the friction is its reciprocal: the friction itself has a tail to infinity.

The measured ends have errors, and each moves the branches behind it as a whole. So the distances of a branch are
correlated. Their covariance follows from the noise of the samples around the ends, and the distances are made
independent before they are fitted. Without this the friction of loops with a plateau came out half a bar too high.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Literal, NamedTuple

import numpy as np

from fastpin.model import Grid, LoadHistory, Problem, SolveOptions
from fastpin.runtime.extensions import optimize, special
from fastpin.solver.errors import ArcError, ResolutionError, SolveError
from fastpin.solver.solving import MemoryRecorder
from fastpin.solver.task import Task
from fastpin.studies.measured_loop import MeasuredLoop

POINTS, FINER, FINEST, MOVED = 8, 4, 16, 2.0
"""Points of a branch. They are four times as many until friction and rig move by less than this many standard
deviations, at most sixteen times: a tenth of it is left. The nodes are doubled once, for they matter less: in a loop
with a plateau 8, 16 and 32 points gave a friction 1.7, 0.7 and 0.15 deviations off, with 61 nodes and with 122."""

STEPS = {"friction": 0.03, "compliance": 5e-3, "displacement_offset": 1e-3, "displacement_drift": 1e-3,
         "clearance": 1e-2, "force_offset": 1e-3, "force_drift": 1e-3, "scale": 1e-3}  # fmt: skip
"""Steps of the differences, in the sizes of the unknowns."""

LEAST, MOST = 0.05, 20.0
"""Least and most 1/friction. A pin with a friction of 20 sticks wherever it touches."""

ROUGH, CONVERGED = 2.0, 0.05
"""Gain by a Jacobian by differences, in units of the noise, after which another one is made; the gain of a step that
counts as none."""

TRIES, CLOSE, FIRST = 6, 0.25, 0.25
"""Most values of a friction that are tried for each end of its interval; how close one comes, in standard deviations;
the longest first step, in parts of 1/friction. It is short, for the sum of squares rises steeply where all slips."""

BENT = 1.1
"""Usual factor for curvature: the ends are looked for there, and interpolated between the values that were tried."""

BEHIND = 3
"""Branches behind a turning point that its error is taken to move. Beyond them the contact has forgotten it."""

LEAST_VARIANCE = 0.3
"""Least variance of a combination of distances. Where a turning point follows the noise of the samples around it, the
variance may be 0, and no model is as good."""

STARTS, NEARBY = (0.6, 1.6), 12.0
"""Factors of 1/friction from which it is fitted again: contacts that slip more or less have minima of their own. The
start counts if the sum of squares there, with the others fitted, is larger by less than the second number."""

RELATED = 2.0
"""Correlation of neighbouring distances, in its own deviations, from which the noise counts as filtered."""

TRIALS, FAILURES = 8, 2
"""Most steps with one Jacobian, and most steps one after the other that make a fit no better: each is damped more than
the one before."""

LOST = 50.0
"""Distance of all samples, in standard deviations, where the model has no state."""

Start = Literal["rest", "cycle"]

IdentifyProgress = Callable[[float, float], None]


@dataclass(eq=False)
class LoopModel:
    """Curves of all branches, from solutions of a history that turns at the measured ends only."""

    problem: Problem
    held: dict[str, float]
    names: tuple[str, str]
    loop: MeasuredLoop
    start: Start
    by_cycle: bool
    nodes: int
    progress: IdentifyProgress | None
    points: int = POINTS
    solved: int = 0
    grid: Grid | None = None
    known: dict[Any, list[tuple[np.ndarray, np.ndarray]]] = field(default_factory=dict)

    @property
    def cycle_of(self) -> np.ndarray:
        """The cycle of each branch, from 0: the first one also has the branch before, the last one what is left."""
        branches = len(self.loop.ends) - 1
        if not self.by_cycle:
            return np.zeros(branches, dtype=int)
        return np.minimum(np.maximum(np.arange(branches) - 1, 0) // 2, max((branches - 1) // 2 - 1, 0))

    def with_values(self, friction: float, compliance: float, clearance: float) -> Problem:
        """The problem with a friction, a compliance of the rig and a clearance."""
        stiffness = 1.0 / compliance if compliance > 0.0 else None
        if self.names[0] == "rotation":
            rig: dict[str, Any] = {"hub_stiffness": stiffness, "rotation": "fixed" if stiffness is None else "spring"}
        else:
            rig = {"rig_stiffness": stiffness}
        return replace(self.problem, friction=friction, clearance=clearance, **rig)

    def curves(self, inverse: Sequence[float], compliance: float, clearance: float, shift: float, drift: float) -> Any:
        """Displacements and forces of each branch, for 1/friction of each cycle and the offset and drift of the
        displacement."""
        key = (*inverse, compliance, clearance, shift, drift, self.points)
        if key in self.known:
            return self.known[key]
        ends = self.loop.ends[:, 1] - shift - drift * self.loop.ends[:, 0]
        changes = [inverse[0] / inverse[cycle] - 1.0 for cycle in self.cycle_of]
        rows, spans = [(0.0, 0.0)], []
        if self.start == "rest":
            ends[0] = 0.0
        else:  # once round, to the branch on which the record begins
            rows += [(each, 0.0) for each in (*ends[[2, 1, 2] if len(ends) > 3 else [1]], ends[0])]
        part = np.linspace(0.0, 1.0, self.points + 1)[1:]
        part = 0.5 * part + 0.25 * (1.0 - np.cos(math.pi * part))  # denser where a branch begins
        for begin, end, change in zip(ends[:-1], ends[1:], changes, strict=True):
            if change != rows[-1][1]:
                rows.append((begin, change))
            spans.append(slice(len(rows) - 1, len(rows) + self.points))
            rows += [(each, change) for each in begin + (end - begin) * part]
        forces = self._forces(self.with_values(1.0 / inverse[0], compliance, clearance), np.array(rows))
        places = np.array(rows)[:, 0]
        if len(self.known) > 3:
            self.known.pop(next(iter(self.known)))
        self.known[key] = [(places[span], forces[span]) for span in spans]
        return self.known[key]

    def _forces(self, problem: Problem, rows: np.ndarray) -> np.ndarray:
        """The reactions at the corners of a path: rows of the displacement and the change of the friction."""
        table = np.column_stack([*(np.full(len(rows), value) for value in self.held.values()), rows])
        history = LoadHistory.from_array(table, [*self.held, self.names[0], "friction_change"])
        kept, options = MemoryRecorder(), SolveOptions(nodes=self.nodes * min(self.points // POINTS, 2))
        grid = self.grid if self.grid is not None and self.grid.size == options.nodes else None
        try:
            Task(problem, history, options, grid).follow(kept)
        except (ArcError, ResolutionError):  # the contact has grown beyond the arc of the solution before
            Task(problem, history, options).follow(kept)
        self.grid = kept.run.grid  # type: ignore[union-attr]
        self.solved += 1
        if self.progress is not None:
            self.progress(self.solved, max(40.0, self.solved + 5.0))
        return np.array([state.resultants[self.names[1]] for state in kept.states])


@dataclass(frozen=True, eq=False)
class Whitening:
    """What makes the errors of all distances independent, with deviation 1: a change within a few combinations of them.

    The distances err by e - V d. e is the noise of the samples, V the change of the distances with the turning points
    that drive the model, d the errors of these points. The points come from the same samples, so e and d are related.

    Attributes
    ----------
    basis : ndarray, shape (n, m)
        Combinations with another variance than 1, orthonormal.
    factors : ndarray, shape (m,)
        1 over their deviations.
    """

    basis: np.ndarray
    factors: np.ndarray

    @classmethod
    def of(cls, moved: np.ndarray, related: np.ndarray, errors: np.ndarray) -> Whitening:
        """The whitening for V (n, turns), the covariance of e and d (n, turns), and that of d (turns, turns)."""
        none = np.eye(errors.shape[0])
        basis, factor = np.linalg.qr(np.hstack([moved, related]))
        inner = factor @ np.block([[errors, -none], [-none, 0.0 * none]]) @ factor.T
        values, turned = np.linalg.eigh(inner)
        return cls(basis @ turned, np.maximum(1.0 + values, LEAST_VARIANCE) ** -0.5)

    def __call__(self, distances: np.ndarray) -> np.ndarray:
        """Distances (n, ...) with independent errors."""
        parts = self.basis.T @ distances
        found: np.ndarray = distances + self.basis @ ((self.factors * parts.T).T - parts)
        return found


class Minimum(NamedTuple):
    """Distances (n,) with the least sum of squares, the unknowns there, and the Jacobian of shape (n, unknowns)."""

    distances: np.ndarray
    at: np.ndarray
    jacobian: np.ndarray

    @property
    def cost(self) -> float:
        """The sum of squares."""
        return float(self.distances @ self.distances)


class LoopFit:
    """The unknowns, fitted. They count in their sizes.

    Attributes
    ----------
    names : list of str
        The unknowns: "friction" of each cycle, "compliance", and names of estimates.
    found, deviations : ndarray, shape (unknowns,)
    covariance : ndarray, shape (unknowns, unknowns)
    low, high : ndarray, shape (unknowns,)
        Intervals of 95 %.
    scatter, moved : float
        `moved` is the last change by more points, in standard deviations.
    """

    def __init__(self, model: LoopModel, wanted: Sequence[str]) -> None:
        self.model = model
        loop, problem = model.loop, model.problem
        self.cycles = int(model.cycle_of[-1]) + 1
        travel, force = float(np.ptp(loop.displacement)), float(np.ptp(loop.force))
        at_rest = model.start == "rest"
        shift = loop.ends[0, 1] if at_rest else 0.5 * (loop.ends[1:-1, 1].min() + loop.ends[1:-1, 1].max())
        zero = loop.force[:3].mean() if at_rest else 0.5 * (loop.force.min() + loop.force.max())
        stiffness = problem.hub_stiffness if model.names[0] == "rotation" else problem.rig_stiffness
        self.fixed = {"compliance": 0.0 if stiffness is None else 1.0 / stiffness, "clearance": problem.clearance,
                      "displacement_drift": 0.0, "force_drift": 0.0, "scale": 1.0}  # fmt: skip
        guess = [("friction", 1.0 / problem.friction, 1.0)] * self.cycles  # type: ignore[operator]
        guess += [("displacement_offset", shift, travel), ("force_offset", zero, force)]
        if "stiffness" in wanted:
            guess.insert(self.cycles, ("compliance", self.fixed["compliance"] or 0.05 * travel / force, travel / force))
        if "clearance" in wanted:
            guess.append(("clearance", problem.clearance, travel))
        if "drift" in wanted:
            guess += [("displacement_drift", 0.0, travel), ("force_drift", 0.0, force)]
        if "scale" in wanted:
            guess.append(("scale", 1.0, 1.0))
        self.names = [name for name, _, _ in guess]
        self.sizes = np.array([size for _, _, size in guess])
        limits = {"friction": (LEAST, MOST), "compliance": (0.0, np.inf), "scale": (0.1, 10.0)}
        self.bounds = np.array([limits.get(name, (-np.inf, np.inf)) for name in self.names]).T
        freedom = loop.time.size - self.sizes.size
        self.sigma = float(special.stdtrit(freedom, 0.975))
        self.whitening = Whitening(np.zeros((loop.time.size, 0)), np.zeros(0))
        self.least, self.rivals = math.inf, (math.inf, -math.inf)
        self.first = np.array([value for _, value, _ in guess]) / self.sizes
        self.wanted = wanted

    def fit(self) -> LoopFit:
        """Fit the unknowns, and return this object with its results."""
        model = self.model
        if self.cycles == 1:
            best = self._search()
        else:  # one friction for all cycles is found sooner
            common = LoopFit(replace(model, by_cycle=False, known={}), self.wanted)
            friction, *others = common._search().at
            model.solved = common.model.solved
            best = self._minimum(np.array([friction] * self.cycles + others))
        self._whiten(best.at)
        best = self._descent(self._minimum(best.at, self.whitening(best.jacobian)).at)
        self._set_bars(best)
        profiles = [self._profile(unknown, best) for unknown in range(self.cycles)]
        lowest = min(chain(*profiles), key=lambda point: point.cost)
        best = best if lowest is best else self._minimum(*lowest[1:])
        ends = np.array([self._ends(unknown, [*points, best], best) for unknown, points in enumerate(profiles)])
        moved, offsets = math.inf, self.names.index("displacement_offset")  # friction and rig stand before them
        while moved > MOVED and model.points < FINEST * POINTS:
            model.points *= FINER
            before, best = best, self._minimum(best.at, best.jacobian if math.isinf(moved) else None)
            moved = float(np.max((np.abs(best.at - before.at) / self.deviations)[:offsets]))
        self.moved = moved
        self._set_bars(best)
        self.low = np.maximum(self.found + ends[:, 0].min(axis=0), self.bounds[0])
        self.high = self.found + ends[:, 1].max(axis=0)
        return self

    def _search(self) -> Minimum:
        """The least sum of squares that is found from the first guess, and from other frictions."""
        self.residuals(self.first, must=True)
        minima = [self._descent(self.first)]
        for factor in STARTS:
            start = minima[0].at.copy()
            start[0] = factor * max(start[0], 1.0)
            other = self._minimum(start, minima[0].jacobian, 0)
            if other.cost < minima[0].cost + NEARBY:
                minima.append(self._minimum(*other[1:]))
        frictions = [point.at[0] for point in minima]
        self.rivals = min(frictions), max(frictions)
        return min(minima, key=lambda point: point.cost)

    def _descent(self, at: np.ndarray) -> Minimum:
        """The minimum that is found from a start, with new Jacobians by differences as long as they gain much."""
        first = self.residuals(at)
        before, found = float(first @ first), self._minimum(at)
        while before - found.cost > ROUGH:
            before, found = found.cost, self._minimum(found.at)
        return found

    def values(self, unknowns: np.ndarray) -> dict[str, Any]:
        """The unknowns in SI units with what is fixed; "friction" is a list of 1/friction."""
        given = unknowns * self.sizes
        named = dict(zip(self.names[self.cycles :], given[self.cycles :].tolist(), strict=True))
        return {**self.fixed, **named, "friction": given[: self.cycles].tolist()}

    def _whiten(self, at: np.ndarray) -> None:
        """Take the errors of the turning points into account, as they are at these unknowns."""
        model, loop = self.model, self.model.loop
        self.least, here, turns = math.inf, self.compared(at)[0], len(loop.shares)
        step = STEPS["displacement_offset"] * float(np.ptp(loop.displacement))
        moved = np.zeros((turns, loop.time.size))
        for first in range(min(BEHIND, turns)):  # turning points so far apart move different branches
            ends = loop.ends.copy()
            ends[1 + first : -1 : BEHIND, 1] += step
            self.model = replace(model, loop=replace(loop, ends=ends), known={})
            change = (self.compared(at)[0] - here) / step
            model.solved, self.model = self.model.solved, model
            for turn in range(first, turns, BEHIND):
                behind = (loop.branch > turn) & (loop.branch <= turn + BEHIND)
                if model.start == "cycle" and turn < 2:  # they lead to the first branch
                    behind |= loop.branch == 0
                moved[turn, behind] = change[behind]
        lift = 1e-3 * loop.noise[0]
        normal = (self.compared(at, lift)[0] - here) / lift
        variance = loop.noise[0] ** 2
        self.whitening = Whitening.of(
            -moved.T, (variance * normal * loop.shares).T, variance * loop.shares @ loop.shares.T
        )

    def compared(self, unknowns: np.ndarray, lift: float = 0.0) -> np.ndarray:
        """Distances of the samples, displacements of their feet and forces there, shape (3, n).

        A `lift` is added to the displacements of the samples.
        """
        value, loop = self.values(unknowns), self.model.loop
        curves = self.model.curves(
            value["friction"], value["compliance"], value["clearance"], value["displacement_offset"],
            value["displacement_drift"],
        )  # fmt: skip
        moved = loop.displacement + lift - value["displacement_offset"] - value["displacement_drift"] * loop.time
        acting = loop.force - value["force_offset"] - value["force_drift"] * loop.time
        found: np.ndarray = loop.distances([(x, value["scale"] * y) for x, y in curves], moved, acting)
        return found

    def residuals(self, unknowns: np.ndarray, must: bool = False) -> np.ndarray:
        """The distances, made independent by the whitening. With `must` a model without a state raises its error."""
        try:
            return self.whitening(self.compared(unknowns)[0])
        except SolveError:
            if must:
                raise
            return np.full(self.model.loop.time.size, LOST)

    def _jacobian(self, at: np.ndarray, kept: int | None = None) -> np.ndarray:
        """Differences of the distances, shape (samples, unknowns); 0 for the unknown with the number `kept`."""
        here, found = self.residuals(at), np.zeros((self.model.loop.time.size, at.size))
        for place, name in enumerate(self.names):
            if place != kept:
                step = STEPS[name] * (np.arange(at.size) == place)
                found[:, place] = (self.residuals(at + step) - here) / STEPS[name]
        return found

    def _minimum(self, first: np.ndarray, jacobian: np.ndarray | None = None, kept: int | None = None) -> Minimum:
        """The least sum of squares, where it is, and the Jacobian with Broyden's updates on the way.

        The Jacobian is one by differences unless given. The unknown with the number `kept` stays. The method is that
        of Levenberg and Marquardt. It ends where a step promises nothing: a search for more costs solutions.
        """
        at = np.clip(first, np.nextafter(self.bounds[0], np.inf), self.bounds[1])
        matrix = self._jacobian(at, kept) if jacobian is None else jacobian.copy()
        here, damping, failed = self.residuals(at), 0.0, 0
        for _ in range(TRIALS):
            step = self._step(at, here, matrix, damping, kept)
            promised = here + matrix @ step
            if here @ here - promised @ promised < CONVERGED * max((here @ here - self.least) / NEARBY, 1.0):
                break
            there = self.residuals(at + step)
            if abs(there[0]) != LOST:
                matrix += np.outer(there - promised, step) / (step @ step)
            if there @ there < here @ here:
                at, here, damping, failed = at + step, there, 0.1 * damping, 0
            else:
                damping, failed = max(10.0 * damping, 0.3), failed + 1
                if failed == FAILURES:
                    break
        self.least = min(self.least, float(here @ here))
        return Minimum(here, at, matrix)

    def _step(
        self, at: np.ndarray, here: np.ndarray, matrix: np.ndarray, damping: float, kept: int | None
    ) -> np.ndarray:
        """The step (unknowns,) to the least damped sum of squares of a linear model within the bounds."""
        free = np.flatnonzero(np.arange(at.size) != kept)
        size = np.linalg.norm(matrix[:, free], axis=0)
        size[size == 0.0] = 1e-300
        rows = np.vstack([matrix[:, free] / size, math.sqrt(damping) * np.eye(free.size)])
        room = (self.bounds[:, free] - at[free]) * size
        room[0], room[1] = np.minimum(room[0], -1e-300), np.maximum(room[1], 1e-300)
        target = np.concatenate([-here, np.zeros(free.size)])
        found = np.zeros(at.size)
        found[free] = optimize.lsq_linear(rows, target, room, method="bvls").x / size
        return found

    def _set_bars(self, best: Minimum) -> None:
        """Set the minimum, its scatter, covariance and deviations. The columns get the size 1 before they are inverted.

        Samples that lie closer than their noise make no bar smaller. Noise that a filter has smoothed makes them wider.
        """
        self.cost, self.found, jacobian = best.cost, best.at, best.jacobian
        self.scatter = math.sqrt(self.cost / max(len(jacobian) - self.found.size, 1))
        self.widened = max(self.scatter, 1.0) * math.sqrt(correlated_samples(best.distances))
        length = np.linalg.norm(jacobian, axis=0)
        length[length == 0.0] = 1e-300
        unit = jacobian / length
        self.covariance = self.widened**2 * np.linalg.pinv(unit.T @ unit, rcond=1e-14) / np.outer(length, length)
        self.deviations = np.sqrt(np.diag(self.covariance))

    def _profile(self, unknown: int, best: Minimum) -> list[Minimum]:
        """Points over a friction, all other unknowns fitted again, to both ends of its interval.

        On either side two points lie around the end, or one close to it. Both sides differ: the less of the contact
        slips, the less the loop tells. The first side is seen to again, for the second one may have a better fit.
        """
        points, reach = [best], BENT * self.sigma
        ridge = self.covariance[unknown] / self.covariance[unknown, unknown]
        for side, rival, bound in 2 * [*zip((-1.0, 1.0), self.rivals, self.bounds[:, unknown], strict=True)]:
            step = min(reach * self.deviations[unknown], FIRST * max(best.at[unknown], 1.0))
            step = max(step, side * (rival - best.at[unknown]))  # an interval may have a gap
            for _ in range(TRIES):
                (inner, size), (outer, beyond) = self._around(points, unknown, side, reach)
                ends = outer is inner and abs(inner.at[unknown] - bound) < 1e-9
                if ends or min(abs(size - reach), abs(beyond - reach)) < CLOSE:
                    break
                if outer is not inner:
                    low = max(size, 0.5)  # the sizes grow faster than the way: their logarithms are interpolated
                    part = float(np.clip(math.log(reach / low) / math.log(beyond / low), 0.2, 0.8))
                    start = inner.at + part * (outer.at - inner.at)
                else:
                    on = np.clip(reach / size, 1.2, 3.0) * (inner.at - best.at)
                    start = best.at + (side * step * ridge if inner is best else on)
                start[unknown] = np.clip(start[unknown], *self.bounds[:, unknown])
                nearest = inner if reach - size < beyond - reach else outer
                points.append(self._minimum(start, nearest.jacobian, unknown))
        return points

    def _around(self, points: list[Minimum], unknown: int, side: float, reach: float) -> Any:
        """The outermost point within a reach of the least sum of squares, and the next one, with their sizes.

        The size of a point is how much larger its sum of squares is, in standard deviations of one unknown. Where no
        point is further out, it is the same one with an infinite size.
        """
        outwards = sorted(points, key=lambda point: side * point.at[unknown])
        cost = np.array([point.cost for point in outwards])
        sizes = [*(np.sqrt(np.maximum(cost - cost.min(), 1e-4)) / self.widened).tolist(), math.inf]
        last = max(place for place, size in enumerate(sizes) if size < reach)
        return zip([*outwards, outwards[-1]][last : last + 2], sizes[last : last + 2], strict=True)

    def _ends(self, unknown: int, points: list[Minimum], best: Minimum) -> np.ndarray:
        """How far the intervals of all unknowns reach down and up by the profile of a friction, shape (2, unknowns).

        The intervals of others have a part along the profile and a part across it. One that ends at a bound is
        infinite.
        """
        along = self.covariance[unknown] ** 2 / self.covariance[unknown, unknown]
        across = self.sigma * np.sqrt(np.maximum(self.deviations**2 - along, 0.0))
        across[: self.cycles] = 0.0
        reach, found = BENT * self.sigma, []
        tried = [min(self._around(points, unknown, side, reach), key=lambda point: abs(point[1] - reach))[0]
                 for side in (-1.0, 1.0)]  # fmt: skip
        reach = self.sigma * curvature_factor(*(each.distances for each in (tried[0], best, tried[1])))
        for side in (-1.0, 1.0):
            (inner, size), (outer, beyond) = self._around(points, unknown, side, reach)
            if outer is inner:
                end = best.at + min(reach / size, 1.0 + CLOSE) * (inner.at - best.at)
            else:
                end = inner.at + (reach - size) / (beyond - size) * (outer.at - inner.at)
            found.append(np.clip(end, *self.bounds) - best.at)
        low, high = np.minimum(np.min(found, axis=0), 0.0), np.maximum(np.max(found, axis=0), 0.0)
        at_bound = low + best.at - self.bounds[0] < 1e-9
        return np.array([np.where(at_bound, -np.inf, -np.hypot(low, across)), np.hypot(high, across)])


def curvature_factor(low: np.ndarray, middle: np.ndarray, high: np.ndarray) -> float:
    """Return the factor by which a curved fit needs a wider interval of 95 %.

    The computed loops of all frictions are a curve in the space of the samples. `low`, `middle` and `high` (n,) are
    points of it: the ends of the interval and the fit. From the truth the rest of a straight line lies in two opposite
    directions. The noise has more than c deviations along one of them by the chance 2 Q(c), with Q of the normal law.
    The directions of a curve sweep an arc of the unit sphere. An arc of length L adds at most L / (2 pi) exp(-c^2 / 2):
    I. Johnstone and D. Siegmund, On Hotelling's formula for the volume of tubes and Naiman's inequality, Annals of
    Statistics 17, 1989. On either side of the truth the arc is taken as long as the angle between both halves of the
    interval.
    """
    first, second, usual = middle - low, high - middle, float(special.ndtri(0.975))
    size = float(np.linalg.norm(first) * np.linalg.norm(second))
    part = math.acos(np.clip(first @ second / size, -1.0, 1.0)) / math.pi if size else 0.0
    rest = (lambda c: 2.0 * special.ndtr(-c) + part * math.exp(-0.5 * c * c) - 0.05, 0.99 * usual, 4.0)
    return float(optimize.brentq(*rest)) / usual


def correlated_samples(distances: np.ndarray) -> float:
    """Return how many samples count as one: 1 + 2 sum of the correlations of distances (n,), up to the first small one.

    It is 1 for white noise.
    """
    n = distances.size
    spectrum = np.abs(np.fft.rfft(distances, 2 * n)) ** 2
    related = np.fft.irfft(spectrum)[1 : n // 4]
    related /= max(float(distances @ distances), 1e-300)
    small = np.flatnonzero(related < RELATED / math.sqrt(n))
    return 1.0 + 2.0 * float(related[: small[0] if small.size else related.size].sum())

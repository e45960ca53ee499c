"""A survey of a history: all places where the contact ever is, and its width there.

Some contacts are too narrow for equally spaced nodes: contacts at small loads, far-travelled contacts at large load
parameters. The survey follows the history roughly. It begins each contact on a grid that is dense where the contact
begins. When the contact has moved or changed its width, it continues on another grid. Slip is interpolated from grid
to grid. So its states are only good enough to know where the nodes must be in the exact run.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fastpin.bodies.bushing import Bushing
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model.angles import angle_between
from fastpin.model.grid import Grid, graded_size
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS, UX, UY, M, P, Q, complete_load
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.reading.marks import Marks
from fastpin.reading.zones import runs
from fastpin.solver.arc import first_direction, outermost_corners
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import Configuration
from fastpin.solver.driven import rest_on_hole
from fastpin.solver.errors import ArcError, NoEquilibriumError, SolveError
from fastpin.solver.first_contact import at_rest
from fastpin.solver.increment import implicit_step
from fastpin.solver.repeats import Repeats
from fastpin.solver.rest import bend, climb_angle, lowest_angle, release
from fastpin.solver.result import Restart
from fastpin.solver.run import Run, RunProgress
from fastpin.solver.settling import FiniteStep
from fastpin.solver.step import LEAST_CLOSED, pieces

log = logging.getLogger(__name__)

GapPlace = tuple[float, float]
"""Angle of the middle and width of a contact, rad."""

LEAST_ACROSS = (10, 20)
"""Nodes across the narrowest contact of a graded grid, at least; more where a contact gets lost on the first grid."""

MOST_GRADED, MOST_IN_BUSH = 20_000, 800
"""Nodes of a graded grid, at most, unless the user asks for more; and in a bush, whose seat has as many."""

ACROSS = 24
"""Nodes across the contact on a grid of the survey."""

LARGEST_PART = 0.25
"""Largest part of a step that is followed on one grid."""

MOST_JUMPS = 30
"""Snaps of the pin in one history, at most."""


def narrow_grids(
    problem: Problem, values: np.ndarray, force: float, options: SolveOptions, progress: RunProgress | None = None
) -> Iterator[Grid]:
    """Yield graded grids with at least :data:`LEAST_ACROSS` nodes on every contact of a history.

    A wide contact has no fewer nodes than on an arc of equally spaced ones.

    Parameters
    ----------
    problem, values, force, progress
        See :func:`fastpin.solver.arc.candidate_grids`. A bush with a seat of its own is surveyed as if it was bonded in
        an infinite plate: the places and widths of the pin's contacts are nearly the same.
    options : SolveOptions
        A grid has more nodes than its ``nodes`` where so many are needed, up to :data:`MOST_GRADED` or
        :data:`MOST_IN_BUSH`. There is none if the history could not be surveyed.
    """
    first_part = float(options.fractions[0]) if options.keep_rule.inside else 1.0
    most = max(MOST_GRADED if problem.seat is None else MOST_IN_BUSH, options.nodes)
    if problem.seat is not None:
        bush = problem.plate_body.bush
        bonded = Bushing(bush.material, bush.outer_radius, max(bush.interference, 0.0))
        problem = replace(problem, plate_body=bonded)
    places = survey(problem, outermost_corners(problem, values), force, first_part, progress)
    if not places:
        return
    distinct: list[tuple[float, float]] = []  # without each place that lies on a narrower place
    for angle, width in sorted(places, key=lambda place: place[1]):
        if not any(abs(float(angle_between(angle, other))) < 0.25 * narrower for other, narrower in distinct):
            distinct.append((angle, width))
    start, length = _reach(places)
    for across in LEAST_ACROSS:
        width = across * length / options.nodes  # as dense everywhere as equally spaced nodes
        between = [(float(angle), width) for angle in start + np.arange(0.0, length + 0.5 * width, 0.5 * width)]
        needed = graded_size(distinct + between, across)
        if needed > most:
            log.info("the narrow contacts of this history take %d nodes: too many", needed)
            return
        yield Grid.graded(distinct + between, max(options.nodes, needed), first_direction(problem, values))


def _reach(places: list[tuple[float, float]]) -> tuple[float, float]:
    """Start and length of the shortest arc, rad, that holds all places."""
    starts = np.array([(angle - 0.5 * width) % (2.0 * math.pi) for angle, width in places])
    order = np.argsort(starts)
    starts, widths = starts[order], np.array([width for _, width in places])[order]
    reached = np.maximum.accumulate(starts + widths)
    reached = np.maximum(reached, reached[-1] - 2.0 * math.pi)  # the last places may go on beyond the first
    gaps = np.r_[starts[1:], starts[0] + 2.0 * math.pi] - reached
    widest = int(np.argmax(gaps))
    return float(starts[(widest + 1) % starts.size]), 2.0 * math.pi - max(float(gaps[widest]), 0.0)


def survey(
    problem: Problem, values: np.ndarray, force: float, first_part: float = 1.0, progress: RunProgress | None = None
) -> list[GapPlace] | None:
    """Find all places where the contact is on the way through a history.

    Parameters
    ----------
    problem : Problem
    values : ndarray, shape (corners, loads)
        Loads at the corners, SI.
    force : float
        The reference force, N/m.
    first_part : float
        Part of a step at which there is the first state, 0 to 1.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)``.

    Returns
    -------
    list of (float, float), or None
        Angle and width of each contact that was met, rad. None if the history could not be followed.
    """
    followed = _Survey(problem, force, first_part)
    before = np.zeros(values.shape[1])
    for step, corner in enumerate(values):
        target = complete_load(corner, before)
        if not followed.follow(before, target):
            log.info("the survey of narrow contacts ends in step %d", step + 1)
            return None
        before = target
        if progress is not None:
            progress(step + 1, len(values))
    return followed.places


class _Survey:
    """The contact on its present grid, and the places where it was."""

    def __init__(self, problem: Problem, force: float, first_part: float) -> None:
        self.places: list[GapPlace] = []
        self._last: GapPlace | None = None
        self._failures = self._jumps = 0
        self._first_part = first_part
        self._problem, self._force = problem, force
        self._system = System.build(problem, Grid.circle(10 * ACROSS + 1), force)
        self._now = unloaded_configuration(self._system)
        self._load = np.zeros(len(LOADS))  # SI
        self._part = LARGEST_PART

    def follow(self, before: np.ndarray, target: np.ndarray) -> bool:
        """Follow a step between two loads, SI. Returns whether its end was reached.

        Where the force passes through zero, the contact ends, and another one begins elsewhere.
        """
        unit = self._system.scales.loads
        parts = pieces(before / unit, target / unit, self._system.is_nearly_neat)
        return all(self._follow_piece(unit * each.before, unit * each.after) for each in parts)

    def _follow_piece(self, before: np.ndarray, target: np.ndarray) -> bool:
        """Follow a straight piece between two loads, SI. Returns whether its end was reached."""
        done, finer, releases, least_part = 0.0, 1.0, 0, 1e-9
        for _ in range(1500):
            if done >= 1.0:
                return True
            floats = not self._now.closed.any()
            stop = min(1.0, done + min(self._part, self._first_part if floats else 1.0))
            load = target if stop == 1.0 else before + stop * (target - before)
            if not floats and _force(load) > 3.0 * _force(self._load) > 0.0 and stop - done > least_part:
                self._part *= 0.5  # on one grid the force grows threefold at most
                continue
            if floats:
                self._look_where_it_begins(load, finer)
            if self._advance(load):
                done, finer, self._part = stop, 1.0, min(1.5 * self._part, LARGEST_PART)
                continue
            self._part *= 0.5
            self._failures += 1
            if self._failures > 500 or self._jumps > MOST_JUMPS:
                return False
            if self._part < least_part:
                if floats or releases == 10:
                    return False
                self._load = self._load.copy()
                self._load[[P, Q, M]] = 0.0  # the next contact begins from no force on the pin
                self._now = release(self._system, self._now, self._load / self._system.scales.loads)
                self._part, releases = LARGEST_PART, releases + 1
            elif not floats:
                finer *= 0.5
                self._look_at_contact(finer)
        return False

    def _advance(self, load: np.ndarray) -> bool:
        """Follow the load, SI, on the present grid. Returns whether the contact was never lost between the nodes."""
        start = Restart(0, self._load, self._force, replace(self._now), 0.0, 0.0, Repeats(), {}, {})
        corner = {name: float(value) for name, value in zip(LOADS, load, strict=True)}
        run = Run(LoadHistory([corner]), self._system, SolveOptions(), start=start, strict=True)
        try:
            run.follow()
        except SolveError:
            return False
        finally:
            self._jumps += int(run.statistics["jumps"])
        patches = runs(self._system.grid, run.now.closed)
        counts = [patch.size for patch in patches]
        if counts and max(counts) < LEAST_CLOSED:
            return False
        self._now, self._load = run.now, load
        self._note([self._place(patch) for patch in patches])
        if counts and not 11 <= min(counts) <= 60:
            self._look_at_contact(1.0)
        return True

    def _note(self, places: list[GapPlace]) -> None:
        """Note the present places, and the way of a single contact from its last place."""
        if len(places) == 1 and self._last is not None:
            (angle, width), (before, last_width) = places[0], self._last
            away = float(angle_between(angle, before))
            count = min(int(0.6 * abs(away) / min(width, last_width)), 400)
            for part in np.arange(1, count) / max(count, 1):
                self.places.append((before + part * away, last_width + part * (width - last_width)))
        self.places += places
        self._last = places[0] if len(places) == 1 else None

    def _place(self, patch: np.ndarray) -> GapPlace:
        """Middle and width of a patch of closed nodes. It ends midway between its end nodes and the next ones."""
        left, right = self._system.grid.knots()
        theta = self._system.grid.theta
        begin = 0.5 * (theta[patch[0]] + left[patch[0]])
        end = 0.5 * (theta[patch[-1]] + right[patch[-1]])
        width = (end - begin) % (2.0 * math.pi) or 2.0 * math.pi
        return begin + 0.5 * width, max(width, 1e-6)  # a narrower contact is not resolved

    def _look_at_contact(self, finer: float) -> None:
        """Go to a grid that is dense where the contact is now, `finer` times the usual spacing."""
        places = [self._place(patch) for patch in runs(self._system.grid, self._now.closed)]
        self._change_grid([(angle, finer * width) for angle, width in places])

    def _look_where_it_begins(self, load: np.ndarray, finer: float) -> None:
        """Go to a grid that is dense where the floating pin will touch the hole, on the way to `load`, SI."""
        if self._problem.gap:
            self._look_where_it_rests(load, finer)
            return
        scales = self._system.scales
        force, angle, overlap = _force(load), math.atan2(-load[P], load[Q]), 0.0
        if force > 0.0 and self._problem.rotation == "free":
            angle += float(climb_angle(force, load[M] / self._problem.hole_radius))
        if self._problem.drive != "force":
            try:
                touching = rest_on_hole(self._system, self._load / scales.loads, load / scales.loads)
            except NoEquilibriumError:
                return
            if touching is None:
                return
            angle, begins = touching[2:]
            moved = (1.0 - begins) * (load - self._load)[[UX, UY]] / scales.displacement
            overlap = max(float(moved @ (math.cos(angle), math.sin(angle))), 0.0)
        if force == 0.0 and overlap == 0.0:
            return
        self._change_grid([(angle, finer * 2.0 * self._half_width(load, angle, overlap))])

    def _look_where_it_rests(self, load: np.ndarray, finer: float) -> None:
        """The same with an initial gap: the floating pin may touch the hole in several places."""
        system, unit = self._system, self._system.scales.loads
        try:
            found = at_rest(system, self._now, self._load / unit, load / unit)
        except (NoEquilibriumError, ArcError):
            return
        if found is None:
            return
        resting, theta = found[0], system.grid.theta
        nodes = [patch[np.argmin(resting.gap[patch])] for patch in runs(system.grid, resting.closed)]
        overlap = float(np.abs(load - self._load)[[UX, UY]].max()) / system.scales.displacement
        if _force(load) > 0.0 or overlap > 0.0:
            angles = [lowest_angle(system, resting, float(theta[node])) for node in nodes]
            self._change_grid([(a, finer * 2.0 * self._half_width(load, a, overlap)) for a in angles])

    def _half_width(self, load: np.ndarray, angle: float, overlap: float) -> float:
        """Half the width, rad, of a contact at `angle` under `load`, SI, or else of an `overlap`."""
        scales, force = self._system.scales, _force(load)
        half = widest = 0.7
        for _ in range(20 if self._problem.gap else 1):  # the bend depends on the width
            bent = max(bend(self._system, load / scales.loads, angle, half), 1e-300)
            square = force / scales.force / (math.pi * bent) if force > 0.0 else 2.0 * overlap / bent
            half = min(math.sqrt(square), widest)
        return half

    def _change_grid(self, places: Sequence[GapPlace]) -> None:
        """Go to a graded grid and carry the present contact to it. Without success everything stays."""
        nodes = min(max(graded_size(places, ACROSS), 4 * ACROSS), 40 * ACROSS)
        grid = Grid.graded(places, nodes, places[0][0])
        system = System.build(self._problem, grid, self._force)
        carried = _carry(self._system, self._now, system)
        if carried is not None:
            self._system, self._now = system, carried


def _force(load: np.ndarray) -> float:
    """Size of the force on the pin, in the units of `load`."""
    return math.hypot(load[P], load[Q])


def _carry(old: System, now: Configuration, system: System) -> Configuration | None:
    """The contact `now` on another grid under the same load: slip is interpolated, tractions are solved anew."""
    theta, before = system.grid.theta, old.grid.theta

    def at_nodes(values: np.ndarray) -> np.ndarray:
        return np.interp(theta, before, values, period=2.0 * math.pi)

    closed = at_nodes(now.closed.astype(float)) >= 0.5
    status, contact = np.full(theta.size, OPEN, dtype=np.int8), np.flatnonzero(now.closed)
    if closed.any():
        nearest = np.argmin(np.abs(angle_between(theta[closed, None], before[contact])), axis=1)
        status[closed] = now.status[contact[nearest]]
    rest = np.where(system.drive.axes, 0.0, now.rest)  # without the prescribed
    away = theta - math.atan2(rest[1], rest[0])
    length = math.hypot(*rest)
    new = replace(
        now,
        pressure=np.where(closed, at_nodes(now.pressure), 0.0),
        shear=np.where(closed, at_nodes(now.shear), 0.0),
        gap=np.where(closed, 0.0, at_nodes(now.gap)),
        slip=at_nodes(now.slip),
        status=status,
        rest_gap=system.concentric_gap - length + 2.0 * length * np.sin(0.5 * away) ** 2,
        rest_slip=at_nodes(now.rest_slip),
        marks=Marks(),
    )
    if not now.closed.any():
        return new
    if not closed.any():
        return None
    return implicit_step(system, new, now.load, patient=False) or FiniteStep(system, new).to(now.load)

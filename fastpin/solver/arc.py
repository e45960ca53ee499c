"""The choice of the arc of nodes.

Hertz's contact gives a first estimate. Coarse runs then find all places of the hole that are ever in contact.
"""

from __future__ import annotations

import itertools
import logging
import math
from collections.abc import Iterator

import numpy as np

from fastpin.elasticity.build import latest_system
from fastpin.elasticity.system import System
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import REMOTE, THERMAL, M, P, Q
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.errors import ArcError, SolveError
from fastpin.solver.first_contact import first_contact
from fastpin.solver.path import follow_whole
from fastpin.solver.rest import climb_angle
from fastpin.solver.run import Run, RunProgress
from fastpin.solver.step import pieces, pushes
from fastpin.solver.tableau import TableauMemory

log = logging.getLogger(__name__)

COARSE_NODES = 121
"""Nodes of a coarse run."""

QUICK_NODES = 61
"""Nodes of a quick coarse run. Where it is not :func:`sure <_quick_arc>` of its arc, finer ones follow."""

WHOLE = 5.6
"""Length of an arc, rad. A wider arc becomes the whole circle."""


class CoarseRun(Run):
    """A run that finds the nodes that are ever in contact."""

    is_coarse = True


def candidate_grids(
    problem: Problem, values: np.ndarray, force: float, nodes: int, progress: RunProgress | None = None
) -> Iterator[Grid]:
    """Yield grids of `nodes` nodes, each wider than the grid before. The last grid is the whole circle.

    The first grid spans the nodes that were in contact in a coarse run, and a margin. All grids have a node where the
    first force points, so that a symmetric contact is symmetric to the last digits.

    Parameters
    ----------
    problem : Problem
    values : ndarray, shape (corners, loads)
        Loads at the corners, SI.
    force : float
        The reference force, N/m.
    nodes : int
    progress : callable, optional
        Called during the coarse runs, which come before the first grid.
    """
    arc = None if problem.needs_circle else _touched_arc(problem, values, force, nodes, progress)
    while arc is not None and arc[1] - arc[0] < WHOLE:
        shift = _shift_to_node(problem, arc[0], (arc[1] - arc[0]) / (nodes - 1), values)
        yield Grid.arc(arc[0] + shift, arc[1] + shift, nodes)
        arc = _widened(arc, 1.25)
    start = -1.5 * math.pi
    yield Grid.circle(nodes, start + _shift_to_node(problem, start, 2.0 * math.pi / nodes, values))


def _touched_arc(
    problem: Problem, values: np.ndarray, force: float, nodes: int, progress: RunProgress | None
) -> tuple[float, float] | None:
    """The arc of all places that are ever in contact, with a margin; None for the whole circle.

    A run with fewer `nodes` than a coarse run has a quick coarse run first: the search would take longer than the run.
    `progress` sees each coarse run as a separate run before the fine run.
    """
    # With a gap, or where a temperature changes the fit, the pin may touch anywhere.
    may_touch = problem.gap or values[:, THERMAL].any()
    arc = None if may_touch else _estimated_arc(problem, values)
    values = outermost_corners(problem, _without_repetition(values))
    quick = _quick_arc(problem, values, arc, force, progress) if nodes < COARSE_NODES else None
    if quick is not None:
        return quick
    for _ in range(12):
        if arc is not None and arc[1] - arc[0] >= WHOLE:
            arc = None
        circle = 241 if problem.gap else COARSE_NODES
        grid = Grid.circle(circle) if arc is None else Grid.arc(*arc, COARSE_NODES)
        margin = 4
        touched, error = _coarse_run(latest_system(problem, grid, force), values, progress)
        if isinstance(error, ArcError):
            assert arc is not None
            arc = _widened(arc, 1.5)
            continue
        if error is not None:
            if problem.gap:  # nothing says where the pin touches later
                return None
            margin = 12  # the fine run reports the error, or gets further
        if touched.size == 0:
            return arc
        if grid.closed:
            return _arc_of_circle(grid, touched, margin)
        first, last = max(touched[0] - margin, 0), min(touched[-1] + margin, grid.size - 1)
        span = float(grid.theta[first]), float(grid.theta[last])
        if last - first > 0.4 * grid.size:
            return span
        arc = _widened(span, 1.1)  # few of the nodes are in contact: look closer
    return arc


def _quick_arc(
    problem: Problem, values: np.ndarray, arc: tuple[float, float] | None, force: float, progress: RunProgress | None
) -> tuple[float, float] | None:
    """The arc of a quick coarse run on the estimated `arc`; None if it is not sure.

    It is sure if the loads are those of Hertz's estimate, without remote stress, the history was followed to its end,
    and the contact took much of the arc.
    """
    if arc is None or arc[1] - arc[0] >= WHOLE or values[:, REMOTE].any():
        return None
    grid = Grid.arc(*arc, QUICK_NODES)
    touched, error = _coarse_run(latest_system(problem, grid, force), values, progress)
    if error is not None or touched.size == 0:
        return None
    margin = 2  # the edges of the contact lie within one node
    first, last = max(touched[0] - margin, 0), min(touched[-1] + margin, QUICK_NODES - 1)
    return (float(grid.theta[first]), float(grid.theta[last])) if last - first > 0.4 * QUICK_NODES else None


def _coarse_run(
    system: System, values: np.ndarray, progress: RunProgress | None
) -> tuple[np.ndarray, SolveError | None]:
    """The nodes that are ever in contact, in their order, and the error with which the coarse run ended."""
    touched = _touched_in_whole_steps(system, values / system.scales.loads, progress)
    if touched is not None:
        return np.flatnonzero(touched), None
    run = CoarseRun(LoadHistory.from_array(values), system, SolveOptions(), progress=progress)
    try:
        run.follow()
    except SolveError as error:
        return np.flatnonzero(run.touched), error
    return np.flatnonzero(run.touched), None


def _touched_in_whole_steps(system: System, loads: np.ndarray, progress: RunProgress | None) -> np.ndarray | None:
    """Whether each node is ever in contact, bool, shape (n,), by whole steps between the corners alone.

    `loads` (corners, loads) are dimensionless. None if a :class:`CoarseRun` is needed: with an initial gap, a moment, a
    change of the friction, or a nearly neat fit; where no force presses the pin; or where a step needs more.
    """
    others = [place for place in range(loads.shape[1]) if place not in (P, Q, *REMOTE)]
    if system.problem.gap or system.is_nearly_neat or loads[:, others].any() or not loads[:, [P, Q]].any(axis=1).all():
        return None
    now, memory = unloaded_configuration(system), TableauMemory(system)
    if now.closed.any():
        return None
    try:
        now, part = first_contact(system, now, now.load, loads[0], has_slip=False)
    except SolveError:
        return None
    touched = now.closed
    for corner, load in enumerate(loads):
        if part < 1.0 or corner > 0:
            is_straight = len(pieces(now.load, load, nearly_neat=False)) == 1
            found = follow_whole(system, now, load, memory) if is_straight else None
            if found is None:
                return None
            now, touched = found.now, touched | found.touched
        if progress is not None:
            progress(corner + 1.0, len(loads))
    return touched


def _estimated_arc(problem: Problem, values: np.ndarray) -> tuple[float, float] | None:
    """A first arc, from the directions of the pin's force at all corners and Hertz's contact.

    The half-angle of Hertz's contact is taken at the largest force. None if no force acts on the pin, or if the remote
    stress makes the hole too oval for this estimate.
    """
    force = pushes(problem, values)
    pin = np.hypot(force[:, 1], force[:, 0])
    remote = 0.5 * problem.surfaces.plate_compliance * (problem.surfaces.plate_kolosov + 1.0)
    ovality = problem.hole_radius * remote * float(np.abs(values[:, REMOTE]).max())
    if not pin.any() or ovality > 0.2 * problem.assembled_clearance:
        return None
    loaded = pin > 0.0
    angles = np.unwrap(np.arctan2(force[loaded, 1], force[loaded, 0]))
    climbed = angles + climb_angle(pin[loaded], values[loaded, M] / problem.hole_radius)
    angles = np.concatenate([angles, climbed])
    parameter = problem.load_parameter(float(pin.max()))
    # The nodes within must be distinct, and angles hold 16 digits.
    half = 1.6 if parameter <= 0.0 else min(1.6, max(1e-6, 1.3 / math.sqrt(math.pi * parameter)))
    return float(angles.min()) - 1.3 * half, float(angles.max()) + 1.3 * half


def _without_repetition(values: np.ndarray) -> np.ndarray:
    """The corners up to the last change of the load that was not there before, in either direction.

    A repeated change can only let a contact settle. If it touches more nodes, the arc is widened.
    """
    corners = [np.zeros_like(values[0]).tobytes(), *(corner.tobytes() for corner in values + 0.0)]  # no -0.0
    first: dict[frozenset[bytes], int] = {}
    for place, change in enumerate(itertools.pairwise(corners)):
        first.setdefault(frozenset(change), place)
    return values[: 1 + max(first.values())]


def outermost_corners(problem: Problem, values: np.ndarray) -> np.ndarray:
    """The outermost corners of a long history, in their order. All loads of the history lie between them."""
    if len(values) <= 200:
        return values
    largest = np.abs(values).max(axis=0)
    scaled = values[:, largest > 0.0] / largest[largest > 0.0]
    chosen = {0}
    for turn in np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False):  # in the plane of two loads
        for first, second in itertools.combinations_with_replacement(range(scaled.shape[1]), 2):
            chosen.add(int(np.argmax(math.cos(turn) * scaled[:, first] + math.sin(turn) * scaled[:, second])))
    force = pushes(problem, values)
    pushed = np.flatnonzero(force.any(axis=1))
    if pushed.size:
        directions = np.unwrap(np.arctan2(force[pushed, 1], force[pushed, 0]))
        chosen |= {int(pushed[np.argmin(directions)]), int(pushed[np.argmax(directions)])}
    return values[sorted(chosen)]


def first_direction(problem: Problem, values: np.ndarray) -> float | None:
    """The angle, rad, at which the first force of a history meets the hole; None without a force.

    `values` are the loads at the corners, SI, shape (corners, loads).
    """
    force = pushes(problem, values)
    loaded = np.flatnonzero(np.hypot(force[:, 1], force[:, 0]))
    return math.atan2(force[loaded[0], 1], force[loaded[0], 0]) if loaded.size else None


def _shift_to_node(problem: Problem, start: float, spacing: float, values: np.ndarray) -> float:
    """The shift, rad, that brings a node to the angle of the first force; at most half a `spacing`.

    The first node is at `start`. Without a force the shift is 0.
    """
    direction = first_direction(problem, values)
    if direction is None:
        return 0.0
    place = (direction - start) / spacing
    return (place - round(place)) * spacing


def _arc_of_circle(grid: Grid, touched: np.ndarray, margin: int) -> tuple[float, float] | None:
    """The circle without its widest untouched part; None if the untouched part is small.

    At both ends the arc has `margin` more nodes than were touched.
    """
    gaps = np.diff(np.r_[touched, touched[0] + grid.size])
    widest = int(np.argmax(gaps))
    if gaps[widest] < 0.15 * grid.size + 2 * margin:
        return None
    step = 2.0 * math.pi / grid.size
    start = grid.theta[0] + step * (touched[widest] + gaps[widest] - margin)
    stop = grid.theta[0] + step * (touched[widest] + grid.size + margin)
    middle = 0.5 * (start + stop)
    turns = 2.0 * math.pi * math.floor((middle + 1.5 * math.pi) / (2.0 * math.pi))
    return float(start - turns), float(stop - turns)


def _widened(arc: tuple[float, float], factor: float) -> tuple[float, float]:
    middle, half = 0.5 * (arc[0] + arc[1]), 0.5 * factor * (arc[1] - arc[0])
    return middle - half, middle + half

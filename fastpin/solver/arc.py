"""The choice of the arc of nodes: from Hertz's estimate, over a coarse run, to the places that are ever in contact."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from fastpin.elasticity.system import System
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.errors import ArcError, SolveError
from fastpin.solver.run import Progress, Run

COARSE_NODES = 121
WHOLE = 5.6  # an arc wider than this, rad, becomes the whole circle
MOST_CORNERS = 200
"""Corners that the coarse run follows; of more it takes the extreme ones."""

DIRECTIONS = 16


def candidate_grids(
    problem: Problem, values: np.ndarray, force: float, nodes: int, progress: Progress | None = None
) -> Iterator[Grid]:
    """Grids of `nodes` nodes, each wider than the one before; the last one is the whole circle.

    The first one spans the nodes that a coarse run had in contact, and a margin. All have a node where the first force
    points, so that a symmetric contact is symmetric to the last digits.
    """
    Grid.circle(nodes)  # checks the number of nodes before anything is computed
    arc = None if problem.clearance < 0.0 else _touched_arc(problem, values, force, progress)
    while arc is not None and arc[1] - arc[0] < WHOLE:
        shift = _shift_to_node(arc[0], (arc[1] - arc[0]) / (nodes - 1), values)
        yield Grid.arc(arc[0] + shift, arc[1] + shift, nodes)
        arc = _widened(arc, 1.25)
    start = -1.5 * math.pi
    yield Grid.circle(nodes, start + _shift_to_node(start, 2.0 * math.pi / nodes, values))


def _touched_arc(
    problem: Problem, values: np.ndarray, force: float, progress: Progress | None
) -> tuple[float, float] | None:
    """The arc of all places that are ever in contact, with a margin; None for the whole circle.

    `progress` sees every coarse run as a run of its own, before the one that counts.
    """
    arc, history = _estimated_arc(problem, values), LoadHistory.from_array(_outline(values))
    for _ in range(12):
        if arc is not None and arc[1] - arc[0] >= WHOLE:
            arc = None
        grid = Grid.circle(COARSE_NODES) if arc is None else Grid.arc(*arc, COARSE_NODES)
        try:
            run = Run(history, System.build(problem, grid, force), SolveOptions(), progress=progress)
            run.follow()
            margin = 4
        except ArcError:
            assert arc is not None
            arc = _widened(arc, 1.5)
            continue
        except SolveError:
            margin = 12  # the fine run says what is wrong, or gets further
        touched = np.flatnonzero(run.touched)
        if touched.size == 0:
            return arc
        if grid.closed:
            return _arc_of_circle(grid, touched, margin)
        first, last = max(touched[0] - margin, 0), min(touched[-1] + margin, grid.size - 1)
        found = float(grid.theta[first]), float(grid.theta[last])
        if last - first > 0.4 * grid.size:
            return found
        arc = _widened(found, 1.1)  # too coarse to tell: look closer
    return arc


def _estimated_arc(problem: Problem, values: np.ndarray) -> tuple[float, float] | None:
    """Directions of the pin's force at all corners and the half-angle of Hertz's contact at the largest one."""
    pin = np.hypot(values[:, 0], values[:, 1])
    remote = 0.5 * problem.pair.plate_compliance * (problem.pair.plate_kolosov + 1.0)
    ovality = problem.hole_radius * remote * float(np.abs(values[:, 3:5]).max())
    if not pin.any() or ovality > 0.2 * problem.clearance:
        return None
    loaded = pin > 0.0
    angles = np.unwrap(np.arctan2(-values[loaded, 0], values[loaded, 1]))
    # A moment is carried where the pin has climbed the hole by the angle of friction that it takes.
    climbed = angles + np.arcsin(np.clip(-values[loaded, 2] / (pin[loaded] * problem.hole_radius), -1.0, 1.0))
    angles = np.r_[angles, climbed]
    parameter = problem.load_parameter(float(pin.max()))
    half = 1.6 if parameter <= 0.0 else min(1.6, 1.3 / math.sqrt(math.pi * parameter))
    return float(angles.min()) - 1.3 * half, float(angles.max()) + 1.3 * half


def _outline(values: np.ndarray) -> np.ndarray:
    """The corners of a long history that lie outermost, in their order: between them is everything that acts."""
    if len(values) <= MOST_CORNERS:
        return values
    largest = np.abs(values).max(axis=0)
    scaled = values[:, largest > 0.0] / largest[largest > 0.0]
    chosen = {0}
    for turn in np.linspace(0.0, 2.0 * math.pi, DIRECTIONS, endpoint=False):
        for first, second in itertools.combinations_with_replacement(range(scaled.shape[1]), 2):
            chosen.add(int(np.argmax(math.cos(turn) * scaled[:, first] + math.sin(turn) * scaled[:, second])))
    pushed = np.flatnonzero(values[:, :2].any(axis=1))
    if pushed.size:
        directions = np.unwrap(np.arctan2(-values[pushed, 0], values[pushed, 1]))
        chosen |= {int(pushed[np.argmin(directions)]), int(pushed[np.argmax(directions)])}
    return values[sorted(chosen)]


def first_direction(values: np.ndarray) -> float | None:
    """Where on the hole the first force of a history points, rad; None without a force."""
    loaded = np.flatnonzero(np.hypot(values[:, 0], values[:, 1]))
    return math.atan2(-values[loaded[0], 0], values[loaded[0], 1]) if loaded.size else None


def _shift_to_node(start: float, spacing: float, values: np.ndarray) -> float:
    """How far to shift nodes from `start` on, at most half a spacing, for one to lie where the first force points."""
    direction = first_direction(values)
    if direction is None:
        return 0.0
    place = (direction - start) / spacing
    return (place - round(place)) * spacing


def _arc_of_circle(grid: Grid, touched: np.ndarray, margin: int) -> tuple[float, float] | None:
    """The complement of the widest untouched part of the circle; None if that part is small."""
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

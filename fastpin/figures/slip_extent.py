"""The map of stick and slip of a long history: its columns join several states, or the states of a load cycle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from fastpin.figures.states import Frame
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.states.choice import span_of
from fastpin.states.cycles import Cycle, innermost_cycles
from fastpin.states.load_cycle import NO_SLIP
from fastpin.states.state import State

BOTH_WAYS = 9
"""Extent of nodes that slip in both directions. The other extents are statuses."""

GAP = 2.0
"""Distance of two load points, in usual distances, from which on nothing is drawn between them."""


class MapColumn(NamedTuple):
    """A column of the map.

    Attributes
    ----------
    left, right : float
        Its sides, load points.
    places : ndarray of int
        Places of its states.
    """

    left: float
    right: float
    places: np.ndarray


class ExtentBox(NamedTuple):
    """Neighbouring nodes of one extent in a column: the sides of their rectangle, degrees from the bottom."""

    left: float
    right: float
    start: float
    stop: float
    extent: int


def columns_of(points: np.ndarray, cycles: Sequence[Cycle], most: int) -> tuple[list[MapColumn], str]:
    """Return the columns of a map, and words on what a column joins.

    A column joins the states of one load cycle or of several, so that no column shows a part of a cycle. States outside
    of all cycles stand for themselves, or are joined like cycles.

    Parameters
    ----------
    points : ndarray, shape (states,)
        Load points, increasing.
    cycles : sequence of Cycle
    most : int
        Most columns.
    """
    units = np.arange(points.size) + 0.5  # a state is a unit of its own, and so is a cycle
    spans = [span_of(cycle) for cycle in innermost_cycles(cycles)]
    for begin, end in spans:
        first, last = np.searchsorted(points, [begin, end], side="right")
        units[first:last] = float(first)
    _, number = np.unique(units, return_inverse=True)
    joined = -(-int(number[-1] + 1) // most)
    starts = np.flatnonzero(np.diff(number // joined, prepend=-1))
    usual = float(np.median(np.diff(points))) if points.size > 1 else 1.0
    columns, right = [], -np.inf
    for places in np.split(np.arange(points.size), starts[1:]):
        first = float(points[places[0]])
        near = first - right <= GAP * max(usual, 1.0)
        columns.append(MapColumn(right if near else max(first - usual, 0.0), float(points[places[-1]]), places))
        right = columns[-1].right
    single, several = "one cycle, or one state outside of cycles", "cycles, or states outside of cycles"
    in_cycles = units % 1.0 == 0.0
    if in_cycles.all():
        single, several = "one cycle", "cycles"
    elif not in_cycles.any():
        single, several = "one state", "states"
    return columns, f"each column is {single}" if joined == 1 else f"each column joins {joined} {several}"


def extents(states: Sequence[State], before: State | None) -> np.ndarray:
    """Return what each node does at some time between the state before and the last of the states, shape (n,).

    A node slips where its slip changes between two states at which it is closed. If the states have slip distances,
    slip forth and back counts too. Statuses count for nodes that were open before: a node at |T| = mu N may have the
    status of slip and rest.

    Parameters
    ----------
    states : sequence of State
    before : State or None
        The state from which the slip of the first one counts.
    """
    closed, up, down = np.zeros((3, states[0].grid.size), dtype=bool)
    for state in states:
        problem = state.problem
        least = NO_SLIP * problem.hole_radius * problem.surfaces.beta_star * float(state.pressure.max())
        known = state.status != OPEN
        if before is not None and not problem.frictionless:
            known = known & (before.status != OPEN)
            net = np.where(known, state.slip - before.slip, 0.0)
            distance = np.abs(net) if state.slip_distance is None else state.slip_distance
            closed |= distance > least
            up |= known & (distance + net > 2.0 * least)
            down |= known & (distance - net > 2.0 * least)
            known = ~known
        closed |= state.status != OPEN
        up |= known & (state.status == SLIP_POSITIVE)
        down |= known & (state.status == SLIP_NEGATIVE)
        before = state
    return np.select([up & down, up, down, closed], [BOTH_WAYS, SLIP_POSITIVE, SLIP_NEGATIVE, STICK], OPEN)


def extent_boxes(states: Sequence[State], columns: Sequence[MapColumn], frame: Frame) -> Iterator[ExtentBox]:
    """Yield the rectangles of all columns, without open nodes. A node reaches halfway to the nodes beside it."""
    middles = 0.5 * (frame.angle[1:] + frame.angle[:-1])
    ends = np.r_[frame.angle[0], middles, frame.angle[-1]]
    for column in columns:
        first = int(column.places[0])
        found = extents([states[place] for place in column.places], states[first - 1] if first else None)[frame.order]
        bounds = np.r_[0, np.flatnonzero(np.diff(found)) + 1, found.size]
        for begin, end in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
            if found[begin] != OPEN:
                yield ExtentBox(column.left, column.right, float(ends[begin]), float(ends[end]), int(found[begin]))


def load_ranges(states: Sequence[State], columns: Sequence[MapColumn], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest and the largest value of a load in each column."""
    values = np.array([state.load[name] for state in states])
    parts = [values[column.places] for column in columns]
    return np.array([part.min() for part in parts]), np.array([part.max() for part in parts])

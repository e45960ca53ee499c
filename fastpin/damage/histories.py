"""Stress histories: the stresses of many states at points, by one product with a matrix or state by state.

A residual hoop stress round a hole, as cold working leaves it, may be added.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import Any

import numpy as np

from fastpin.elasticity.tractions import Tractions
from fastpin.model import Problem, checks, loads
from fastpin.model.crack import residual_at
from fastpin.model.points import Body, Points, further_parts, owner_of
from fastpin.reading.stress import Stress, stress_at
from fastpin.runtime.threads import in_threads
from fastpin.states.reading_bounds import MAPPED
from fastpin.states.state import State
from fastpin.states.stress_map import mapped, share_map

ROOM = 2**23
"""Numbers that a block of points may hold: 64 MB. While a block is counted, twice as much is in use beside it."""

TOGETHER = 64
"""States that are read between two calls of the progress."""

KEPT = 500
"""States up to which their refined tractions are kept for the next reading. Those of 5,000 states fill 700 MB."""

Progress = Callable[[float], None]
"""Called with the part of the work that is done, 0 to 1."""


def stress_history(states: Sequence[State], points: Points, body: Body = "plate", straight: bool = False) -> np.ndarray:
    """The stresses at points over the states, Pa, shape (states, points, 4): sxx, syy, szz, sxy.

    Parameters
    ----------
    states : sequence of State
        States of one problem.
    points : Points
    body : {"plate", "pin", "seat"}
    straight : bool
        Whether the tractions are straight lines between the nodes everywhere, see :meth:`fastpin.State.stress`. The
        stresses of many states are then one product with a matrix.

    Raises
    ------
    InputError
        See :meth:`fastpin.State.stress`.
    """
    every = checks.instances("states", states, State, "a sequence of fastpin.State")
    checks.instance("points", points, Points, "fastpin.Points")
    if not every:
        return np.zeros((0, 0))
    different, order = different_states(every, checks.true_or_false("straight", straight))
    found = np.empty((len(different), points.theta.size, 4))
    for part, values in history_blocks(different, points, body, straight):
        found[:, part] = values
    return found[order]


def different_states(states: Sequence[State], straight: bool) -> tuple[list[State], np.ndarray]:
    """Return the states with different stresses, and the place of each state among them, int64, shape (states,)."""
    seen: dict[bytes, int] = {}
    shared: dict[Hashable, bytes] = {}  # by the arrays of a state: repeated states often share them
    problems: dict[Problem, int] = {}  # what other pins of a joint do to the hole belongs to them
    different: list[State] = []
    order = np.empty(len(states), dtype=np.int64)
    for k, state in enumerate(states):
        parts = [part for part in (state, state.seat) if part is not None]
        same = tuple(id(each) for part in parts for each in (part.theta, part.pressure, part.shear, part.status))
        same += tuple(id(part.marks) for part in parts)
        change = state.load.get("friction_change", 0.0)
        if (change, same) not in shared:
            shared[change, same] = _digest(parts, straight)
        remote = np.array([part.load.get(loads.LOADS[place], 0.0) for part in parts for place in loads.STRESSING])
        key = shared[change, same] + remote.tobytes() + b"%d" % problems.setdefault(state.problem, len(problems))
        order[k] = seen.setdefault(key, len(different))
        if order[k] == len(different):
            different.append(state)
    return different, order


def _digest(parts: Sequence[State], straight: bool) -> bytes:
    """Return a digest of the tractions of a state and its seat. Remote stress is no part of it."""
    key = hashlib.blake2b(digest_size=16)
    for part in parts:
        arrays = [part.theta, part.pressure, part.shear, part.status]
        if not straight and part.marks is not None:
            arrays += part.marks.arrays(part.theta.size)
        if not straight:
            arrays.append(part.friction)
        for array in arrays:
            key.update(np.ascontiguousarray(array).data)
    return key.digest()


def history_blocks(
    states: Sequence[State], points: Points, body: Body, straight: bool, progress: Progress | None = None
) -> Iterator[tuple[slice, np.ndarray]]:
    """Yield blocks of points, with their stresses over the states, shape (states, points of the block, 4).

    The stresses of straight lines are a product with a matrix for more than :data:`MAPPED` states on one grid. Points
    deep in the pin are read state by state.
    """
    count, nodes = points.theta.size, states[0].theta.size
    size = max(ROOM // (8 * nodes + 4 * len(states)), 1)
    theta, depth = points.theta.ravel(), points.depths(states[0].problem, body).ravel()
    is_deep = body == "pin" and bool(np.any(depth > 0.5))  # near the centre a moment has an infinite stress
    is_mapped = straight and not is_deep and len(states) > MAPPED and share_map(states)
    for begin in range(0, max(count, 1), size):
        part = slice(begin, min(begin + size, count))
        some = Points.at_depth(depth[part] * states[0].problem.hole_radius, theta[part]) if size < count else points
        told = None if progress is None else _within(progress, part, count)
        yield part, (_mapped(states, some, body, told) if is_mapped else _read(states, some, body, straight, told))


def _within(progress: Progress, part: slice, count: int) -> Progress:
    """Return the progress of a block of points."""
    return lambda done: progress((part.start + done * (part.stop - part.start)) / count)


def _read(states: Sequence[State], points: Points, body: Body, straight: bool, progress: Progress | None) -> np.ndarray:
    """Read the stresses state by state."""
    found = np.empty((len(states), points.theta.size, 4))

    def fill(k: int) -> None:
        is_kept = len(states) <= KEPT or "refined" in states[k].__dict__
        found[k] = _components(states[k].stress(points, body, straight)).T
        if not is_kept:
            states[k].__dict__.pop("refined", None)

    for begin in range(0, len(states), TOGETHER):
        stop = min(begin + TOGETHER, len(states))
        in_threads(fill, range(begin, stop))
        if progress is not None:
            progress(stop / len(states))
    return found


def _mapped(states: Sequence[State], points: Points, body: Body, progress: Progress | None) -> np.ndarray:
    """Multiply the nodal tractions with the stresses of the hat functions of the nodes, also of the seat of a bush."""
    problem, names = states[0].problem, [list(loads.LOADS)[place] for place in loads.STRESSING]

    def stress(tractions: list[Tractions], remote: np.ndarray) -> np.ndarray:
        load = dict(zip(names, remote.tolist(), strict=True))
        return _components(stress_at(problem, tractions[0], load, points, body, *tractions[1:]))

    return np.moveaxis(mapped(states, stress, progress), 0, -1)


def _components(stress: Stress) -> np.ndarray:
    """Return sxx, syy, szz and sxy, shape (4, points)."""
    return np.array([stress.sxx, stress.syy, stress.axial, stress.sxy]).reshape(4, -1)


Blocks = Callable[[Progress], Iterator[tuple[slice, np.ndarray]]]
"""Yields blocks of points, with their stresses (states, points of the block, 4)."""


def with_residual(blocks: Blocks, problem: Problem, body: Body, points: Points, residual: Any) -> Blocks:
    """Return the blocks of points of a body with a residual stress of the plate, a number or pairs, added.

    It acts in the plate round the hole alone: pins, bushes and further edges of the plate keep their stresses.
    """
    if residual is None or owner_of(problem, body) != "plate":
        return blocks
    depth = np.broadcast_to(points.depths(problem, body), points.shape).ravel()
    depth, theta = depth * problem.hole_radius, points.theta.ravel()
    is_round_hole = [part is None for part in further_parts(problem, body, theta, depth)]
    hoop = np.where(is_round_hole, residual_at(residual, depth), 0.0)
    cos, sin = np.cos(theta), np.sin(theta)
    added = hoop[:, None] * np.stack([sin * sin, cos * cos, np.zeros(theta.size), -sin * cos], axis=-1)

    def summed(progress: Progress) -> Iterator[tuple[slice, np.ndarray]]:
        for part, history in blocks(progress):
            yield part, history + added[part]

    return summed

"""Warnings about von Mises stresses above the yield strengths of the bodies, on all edges of a joint."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from fastpin.errors import InputWarning
from fastpin.kernels.status import OPEN
from fastpin.model.angles import from_bottom
from fastpin.model.bodies import Bushing, Tube
from fastpin.model.doubts import are_given, are_loads_plausible, has_strengths, yield_doubt
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.points import Body, Points, material_of
from fastpin.model.problem import Problem
from fastpin.states.quantities import load_point
from fastpin.states.state import State

AROUND = 180
"""Equally spaced angles of an edge, besides the closed nodes."""


def yield_doubts(problem: Problem, history: LoadHistory, states: Iterable[State]) -> list[InputWarning]:
    """Return a warning for each edge at which the von Mises stress exceeds the yield strength of its body.

    A warning names the largest stress of the states, with its place. A body without a known yield strength has none.
    The stress below the edges is not looked at.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        If its loads are in doubt, the stresses are not.
    states : iterable of State
        Such as those of :func:`worst_places`.
    """
    if are_given() or not are_loads_plausible(problem, history):
        return []
    kept, found = list(states), []
    for edge, body, depth in edges(problem):
        if material_of(problem, body).known_yield_strength is None:
            continue
        tops = [(*_largest(state, body, depth), state) for state in kept]
        if not tops:
            continue
        stress, angle, state = max(tops, key=lambda top: top[0])
        where = f"at {from_bottom(angle):z.1f} deg, load point {load_point(state):.5g}"
        found.append(yield_doubt(problem, edge, stress, where))
    return [doubt for doubt in found if doubt is not None]


def edges(problem: Problem) -> Iterator[tuple[str, Body, float]]:
    """The edges of a problem: their names, their bodies, and depths in the bodies, m. A rigid body has none.

    The names are those of :data:`fastpin.model.doubts.EDGES`.
    """
    bush, pin = problem.plate_body, problem.pin_body
    if not problem.surfaces.plate.is_rigid:
        yield ("bore of the bush" if isinstance(bush, Bushing) else "hole"), "plate", 0.0
    if isinstance(bush, Bushing):
        yield "rim of the bush", "plate", bush.outer_radius - problem.hole_radius
        if not problem.pair.plate.is_rigid:
            yield "seat", "seat", 0.0
    if not problem.pair.pin.is_rigid:
        yield "pin", "pin", 0.0
        if isinstance(pin, Tube):
            yield "bore of the pin", "pin", problem.hole_radius - pin.bore_radius


def worst_places(loads: np.ndarray, pressures: np.ndarray) -> list[int]:
    """Return the places of the states that are most likely to have the largest stresses, in increasing order.

    They have the largest pressure, or the largest size of one of the loads.

    Parameters
    ----------
    loads : ndarray, shape (states, loads)
    pressures : ndarray, shape (states,)
        The largest pressure of each state.
    """
    if not len(loads):
        return []
    sizes = np.abs(loads)
    tops = [int(np.argmax(column)) for column in sizes.T if column.any()]
    return sorted({int(np.argmax(pressures)), *tops})


def worst_states(states: Sequence[State]) -> list[State]:
    """The states of :func:`worst_places`; none if no yield strength is known."""
    if not states or not has_strengths(states[0].problem):
        return []
    loads = np.array([[state.load[name] for name in LOADS] for state in states])
    pressures = np.array([float(state.pressure.max(initial=0.0)) for state in states])
    return [states[place] for place in worst_places(loads, pressures)]


def _largest(state: State, body: Body, depth: float) -> tuple[float, float]:
    """The largest von Mises stress of a circle, Pa, and its angle, rad."""
    around = math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    theta = np.r_[around, state.theta[state.status != OPEN]]
    stress = state.stress(Points.at_depth(depth, theta), body, straight=True).von_mises
    top = int(np.argmax(stress))
    return float(stress[top]), float(theta[top])

"""The largest hoop stress round hole, pin and the seat of a bush, and stress concentrations."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from fastpin.elasticity.tractions import RefinedTractions
from fastpin.model.angles import angle_between, distinct, near_bottom
from fastpin.model.grid import Grid
from fastpin.model.points import Body, Points, near_rim
from fastpin.model.problem import Problem
from fastpin.model.ties import top_angle
from fastpin.reading.stress import HoopPeak, Stress, open_hole_hoop

AROUND = 180
"""Equally spaced angles round the hole that are tried, beside edges, borders, closed nodes and their middles."""

LEAST_NODES = 40
"""Least number of nodes in contact of a resolved peak. With less, errors of 3 % were found."""

UNRESOLVED = 0.13
"""Bar of a hoop stress whose peak the nodes do not resolve, in parts of the value.

Straight lines between 101 nodes or more miss at most this part of the hoop stress at an edge.
"""

Hoop = Callable[[np.ndarray], np.ndarray]
"""Gives the hoop stress at angles on the edge of a body, Pa."""


def hoop_peak(
    problem: Problem, load: Mapping[str, float], resultants: Mapping[str, float], grid: Grid, closed: np.ndarray,
    refined: RefinedTractions, body: Body, hoop: Hoop,
) -> HoopPeak:  # fmt: skip
    """The largest hoop stress on the edge of a body that is not rigid, of a state with these `closed` nodes.

    The `hoop` stress is taken for the stress of the loads alone.
    """
    around = math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    nodes = grid.theta[closed]
    angles = np.r_[around, nodes, nodes + 0.5 * grid.weights[closed], refined.resolved, refined.unresolved]
    # Whole turns, and no remainder: an edge has a power law beside it, and the rounding of its angle would break ties.
    angles = distinct(angles - 2.0 * math.pi * np.floor((angles + 1.5 * math.pi) / (2.0 * math.pi)))
    values = hoop(angles)
    before, after = np.roll(values, 1), np.roll(values, -1)
    tops = np.flatnonzero((values >= before) & (values >= after))
    found = _highest(hoop, angles, values, tops[np.argsort(-values[tops])[:4]])
    value, angle = found[top_angle(*np.array(found).T)]
    rim, force = near_rim(problem, body), math.hypot(resultants["P"], resultants["Q"])
    resolved = _is_resolved(grid.weights[closed], refined, hoop, value, angle, rim - 1.0)
    bearing, gross, bypass = force / (2.0 * (rim * problem.hole_radius)), 0.0, 0.0
    if body != "pin":
        sxx, syy, sxy = (load[name] for name in ("sxx", "syy", "sxy"))
        mean, radius = 0.5 * (sxx + syy), math.hypot(0.5 * (sxx - syy), sxy)
        gross = mean + math.copysign(radius, mean)
        bypass = open_hole_hoop(problem, np.array([sxx, syy, sxy]), angle, body)
    place = angle if closed.any() or value != 0.0 else math.nan
    # the net section beside the hole; infinite for an infinite plate, a bush and the pin
    is_own = body == ("seat" if problem.plate_body.bush else "plate")
    section = problem.plate_body.lug.net_section(rim * problem.hole_radius) if is_own else math.inf
    return HoopPeak(value, place, resolved, bearing, gross, bypass, value, net_stress=force / section)


def peak_in_parts(
    peak_of: Callable[[Hoop], HoopPeak],
    hoop: Hoop,
    assembly: Callable[[Points, Body], Stress],
    body: Body,
    joint: Problem,
) -> HoopPeak:
    """The largest hoop stress, with the part of the assembly at its place and the largest stress of the loads.

    Parameters
    ----------
    peak_of : callable
        :func:`hoop_peak` of a hoop stress in this state.
    hoop : callable
        The hoop stress of the state.
    assembly : callable
        The stress before any load at points of a body.
    body : {"plate", "pin", "seat"}
    joint : Problem
    """
    peak = peak_of(hoop)
    if not joint.is_pressed:
        return peak

    def before(theta: np.ndarray) -> np.ndarray:
        return assembly(Points.at_depth(0.0, theta), body).hoop

    here = float(before(np.array([0.0 if math.isnan(peak.angle) else peak.angle]))[0])
    if joint.is_round and joint.pair.plate.is_isotropic:  # it is the same all round
        return replace(peak, assembly=here, most_of_loads=peak.value - here)
    of_loads = peak_of(lambda theta: hoop(theta) - before(theta))
    resolved = peak.resolved and of_loads.resolved
    return replace(of_loads, value=peak.value, angle=peak.angle, resolved=resolved, assembly=here)


def _highest(hoop: Hoop, angles: np.ndarray, values: np.ndarray, tops: np.ndarray) -> list[tuple[float, float]]:
    """The largest hoop stress between the neighbours of each angle at the places `tops` (k,), and its angle.

    `values` are the hoop stresses at all `angles`.
    """
    value, angle, row = values[tops], angles[tops], np.arange(tops.size)
    low, high = (angle_between(angles[(tops + side) % angles.size], angle) for side in (-1, 1))
    steps = np.arange(21.0)
    for _ in range(3):
        tried = angle[:, None] + (low[:, None] + steps * ((high - low) / (steps.size - 1))[:, None])
        found = hoop(tried.ravel()).reshape(tried.shape)
        best = np.argmax(found, axis=1)
        higher = found[row, best] > value
        value, angle = np.where(higher, [found[row, best], tried[row, best]], [value, angle])
        high = (high - low) / (steps.size - 1)
        low = -high
    return list(zip(value.tolist(), (near_bottom(each) for each in angle.tolist()), strict=True))


def _is_resolved(
    distances: np.ndarray, refined: RefinedTractions, hoop: Hoop, value: float, angle: float, wall: float
) -> bool:
    """Whether power laws describe the peak, and no place without a law may have a higher one.

    `distances` are the node distances in contact, and `wall` the distance from the contact to the edge of the body.
    """
    if 0 < distances.size < LEAST_NODES:
        return False
    spacing = float(distances.max(initial=0.0))
    if wall > 0.0:  # the stress has no cusp a wall away from the contact
        return spacing < wall
    if refined.unresolved:
        places = np.array(refined.unresolved)
        missed = hoop(places) >= (1.0 - UNRESOLVED) * value
        if np.any(missed | (np.abs(angle_between(places, angle)) < 2.0 * spacing)):  # the peak belongs to the place
            return False
    if any(abs(angle_between(place, angle)) < spacing for place in refined.resolved):
        return True
    drops = value - hoop(angle + spacing * np.array([-4.0, -2.0, 2.0, 4.0]))
    # Of the drop over four node distances a parabola has 0.25 over two, a straight line 0.5, and a root 0.71: a cusp.
    return not any(drops[near] > 0.45 * drops[far] for near, far in ((1, 0), (2, 3)) if drops[far] > 1e-3 * abs(value))

"""The largest hoop stress round hole, pin and the seat of a bush, and stress concentrations."""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.stress import press_fit_hoop
from fastpin.kernels.status import OPEN
from fastpin.model.angles import angle_between, near_bottom
from fastpin.model.bodies import Ring
from fastpin.model.points import Body, near_rim
from fastpin.model.problem import Problem
from fastpin.reading.stress import HoopPeak, open_hole_hoop
from fastpin.states.error_bars import UNRESOLVED
from fastpin.states.state import State

AROUND = 180
"""Equally spaced angles round the hole that are tried, beside edges, borders, closed nodes and their middles."""

TIE = 1e-9
"""Relative difference below which two peaks are equal. Of equal peaks the one farthest to the right is taken."""

TRIED = 4
"""Local maxima beside which the peak is looked for."""

ZOOMS, ZOOMED = 3, 21
"""Rounds of the search beside a local maximum, and the number of angles in each."""

LEAST_NODES = 40
"""Least number of nodes in contact of a resolved peak. With less, errors of 3 % were found."""

NEAR = 2.0
"""Distance from an unresolved place, in node distances, within which a peak belongs to it."""

SHARP = 0.45
"""Drop beside a peak over two node distances, in parts of the drop over four, from which on the peak is a cusp.

A parabola has 0.25, a straight line 0.5, a root 0.71.
"""


def hoop_peak(state: State, body: Body) -> HoopPeak:
    """The largest hoop stress on the edge of a body that is not rigid."""
    around = math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    closed = state.theta[state.status != OPEN]
    between = closed + 0.5 * state.grid.weights[state.status != OPEN]
    angles = np.r_[around, closed, between, state.refined.resolved, state.refined.unresolved]
    angles = np.unique(np.remainder(angles, 2.0 * math.pi))
    values = state.hoop_stress(body, angles)
    before, after = np.roll(values, 1), np.roll(values, -1)
    tops = np.flatnonzero((values >= before) & (values >= after))
    found = [_highest(state, body, angles, int(top)) for top in tops[np.argsort(-values[tops])[:TRIED]]]
    largest = max(value for value, _ in found)
    value, angle = max((peak for peak in found if peak[0] >= largest - TIE * abs(largest)), key=lambda peak: peak[1])
    resolved = _is_resolved(state, body, value, angle)
    force = math.hypot(state.resultants["P"], state.resultants["Q"])
    edge = near_rim(state.problem, body) * state.problem.hole_radius
    bearing, gross, bypass, press_fit = force / (2.0 * edge), 0.0, 0.0, 0.0
    if body != "pin":
        sxx, syy, sxy = (state.load[name] for name in ("sxx", "syy", "sxy"))
        mean, radius = 0.5 * (sxx + syy), math.hypot(0.5 * (sxx - syy), sxy)
        gross = mean + math.copysign(radius, mean)
        bypass = open_hole_hoop(state.problem, np.array([sxx, syy, sxy]), angle, body)
        press_fit = press_fit_hoop(state.problem, body)
    place = angle if state.in_contact or value != 0.0 else math.nan
    section = _net_section(state.problem, body)
    return HoopPeak(value, place, resolved, bearing, gross, bypass, press_fit, force / section)


def _net_section(problem: Problem, body: Body) -> float:
    """Width W - D of the net section beside the hole of a ring, m; infinite for any other plate, a bush, the pin."""
    lug, own = problem.joint.lug, "seat" if problem.joint.bush else "plate"
    if body != own or not isinstance(lug, Ring):
        return math.inf
    return 2.0 * (lug.outer_radius - near_rim(problem, body) * problem.hole_radius)


def _highest(state: State, body: Body, angles: np.ndarray, top: int) -> tuple[float, float]:
    """The largest hoop stress between the neighbours of the angle `top`, and its place."""
    angle = float(angles[top])
    value = float(state.hoop_stress(body, [angle])[0])
    low, high = (float(angle_between(angles[(top + side) % angles.size], angle)) for side in (-1, 1))
    for _ in range(ZOOMS):
        tried = angle + np.linspace(low, high, ZOOMED)
        values = state.hoop_stress(body, tried)
        if values.max() > value:
            value, angle = float(values.max()), float(tried[np.argmax(values)])
        step = (high - low) / (ZOOMED - 1)
        low, high = -step, step
    return value, near_bottom(angle)


def _is_resolved(state: State, body: Body, value: float, angle: float) -> bool:
    """Whether power laws describe the peak, and no place without a law may have a higher one."""
    closed = state.status != OPEN
    if 0 < np.count_nonzero(closed) < LEAST_NODES:
        return False
    spacing = float(state.grid.weights[closed].max(initial=0.0))
    if body == "seat":  # the stress has no cusp a wall away from the contact
        return spacing < near_rim(state.problem, body) - 1.0
    refined = state.refined
    if refined.unresolved:
        places = np.array(refined.unresolved)
        missed = state.hoop_stress(body, places) >= (1.0 - UNRESOLVED) * value
        if np.any(missed | (np.abs(angle_between(places, angle)) < NEAR * spacing)):
            return False
    if any(abs(angle_between(place, angle)) < spacing for place in refined.resolved):
        return True
    around = state.hoop_stress(body, angle + spacing * np.array([-4.0, -2.0, 2.0, 4.0]))
    drops = value - around
    return not any(drops[near] > SHARP * drops[far] for near, far in ((1, 0), (2, 3)) if drops[far] > 1e-3 * abs(value))

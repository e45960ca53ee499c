"""Solutions and readings that the tests of the paper's statements share.

Ti is Ti-6Al-4V, a pair is pin/plate, half-angles and shifts are in degrees, tractions in F/R.
"""

import functools
import math

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.kernels.status import STICK
from fastpin.model.angles import BOTTOM
from fastpin.published.fretting import FRICTION as MU
from fastpin.published.remote_stress import stress_unit
from fastpin.published.tractions import PAIRS
from fastpin.verification import closed_forms

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS)


# --- solutions, each computed once ------------------------------------------------------------------------------


def symmetric_arc(load_parameter, extra=0.0):
    """An arc that holds the contact, turned by `extra` to either side."""
    half = 1.2 * closed_forms.persson_half_angle(max(load_parameter, 0.0)) + extra
    return BOTTOM - half, BOTTOM + half


@functools.cache
def monotonic(pair, load_parameter, friction, pin_load="body", nodes=121):
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, pin_load)
    return solve(problem, [{"P": 1.0}], nodes=nodes, arc=symmetric_arc(load_parameter))[-1]


@functools.cache
def at_low_friction(pair, load_parameter, friction, pin_load="body"):
    """The same on nodes that crowd at the bottom: a minute stick zone between two slip zones makes a spike of pressure
    there when materials differ, which is as narrow as the stick zone."""
    half = symmetric_arc(load_parameter)[1] - BOTTOM
    steps = np.minimum(1e-4 * 1.2 ** np.arange(130), 0.02)
    away = np.cumsum(steps)
    away *= half / away[-1]
    grid = Grid(BOTTOM + np.r_[-away[::-1], 0.0, away])
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, pin_load)
    return solve(problem, [{"P": 1.0}], grid=grid)[-1]


@functools.cache
def stages(pair, friction, load_parameters):
    """One loading: by the load parameters (falling), the state and the dissipation per square of the load."""
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameters[-1], friction, "body")
    loads = [load_parameters[-1] / value for value in load_parameters]
    return list(solve(problem, [{"P": 1.0}], nodes=201, arc=symmetric_arc(load_parameters[-1]), between=loads[:-1]))


@functools.cache
def fretting(pair, load_parameter, ratio, rotation, half_cycles=4, start=1.0, pin_load=None, friction=MU, nodes=121):
    """P, then Q = +-ratio mu P: with a held pin under centre loads, with a free one under body forces."""
    pin_load = pin_load or {"fixed": "centre", "free": "body"}[rotation]
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, pin_load, rotation)
    side = ratio * friction
    corners = [{"P": 1.0}] + [{"Q": start * side * (-1) ** k} for k in range(half_cycles)]
    turn = math.atan(side)
    if rotation == "fixed" and load_parameter > 3.0:
        turn *= 2.0 / load_parameter
    return solve(problem, corners, nodes=nodes, arc=symmetric_arc(load_parameter, turn))


@functools.cache
def stressed(sigma_x, sigma_y, order="together", pair="Ti/Al", friction=0.4, load_parameter=0.75, nodes=121):
    """P = 1 under body forces and the remote stresses sigma = sxx R kappa'/(2 G F beta*)."""
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, "body")
    unit = stress_unit(pair)
    stress = {"sxx": sigma_x * unit, "syy": sigma_y * unit}
    corners = {
        "together": [{"P": 1.0, **stress}],
        "force first": [{"P": 1.0}, stress],
        "stress first": [stress, {"P": 1.0}],
    }
    return solve(problem, corners[order], nodes=nodes)[-1]


@functools.cache
def sliding_onset(pair, load_parameter, friction, low, high, before=None, steps=40):
    """Q/(mu P), to (high - low)/steps, at which nothing sticks any more; None if something always does.

    With `before` the first excursion goes to +before, and the onset is that of the way back to the other side.
    """
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, "centre", "fixed")
    sign = 1.0 if before is None else -1.0
    corners = [{"P": 1.0}] + ([] if before is None else [{"Q": before * friction}])
    corners += [{"Q": sign * low * friction}, {"Q": sign * high * friction}]
    result = solve(problem, corners, nodes=121, between=steps - 1)
    for state in result:
        if state.step == len(corners) - 1 and not np.any(state.status == STICK):
            return abs(state.load["Q"]) / friction, state
    return None


# --- readings ---------------------------------------------------------------------------------------------------


def half_contact(state):
    return math.degrees(sum(stop - start for start, stop in state.contact)) / 2.0


def half_stick(state):
    return math.degrees(sum(stop - start for start, stop in state.stick)) / 2.0


def half_slip(state):
    return half_contact(state) - half_stick(state)


def edges(state):
    """Ends of the contact, degrees from the bottom."""
    return math.degrees(state.contact[0][0] - BOTTOM), math.degrees(state.contact[-1][1] - BOTTOM)


def shift(state):
    return 0.5 * sum(edges(state))


def overlap(one, two):
    """Part of contact `one` that contact `two` has too."""
    (a, b), (c, d) = edges(one), edges(two)
    return max(min(b, d) - max(a, c), 0.0) / (b - a)


def difference(one, two, field="shear", mirror=False):
    """Integral of |difference| over that of |two|; with `mirror`, of `one` and the mirror image of `two`."""
    a, b, weights = getattr(one, field), getattr(two, field), two.grid.weights
    if one.grid is not two.grid and one.theta is not two.theta:
        a = np.interp(two.theta, one.theta, a, 0.0, 0.0)
    if mirror:
        b = b[::-1] if field == "pressure" else -b[::-1]
    return float(weights @ np.abs(a - b) / (weights @ np.abs(b)))


def largest(state):
    """Shear of largest magnitude."""
    return abs(state.peak_shear)

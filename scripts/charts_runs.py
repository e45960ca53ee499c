"""Runs of the solver behind the charts: the values of all charts of a group at one place, or along a line of places."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fastpin.bodies.body import PinLoad
from fastpin.charts.groups import width_coordinate
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MaterialPair
from fastpin.model.problem import Problem
from fastpin.reading.zones import Interval
from fastpin.solver.solving import solve
from fastpin.states.state import State

SPANS = (0.14, 0.3, 0.62, 1.05, 2.0)
"""Frictionless half-angles, rad, up to which states share a grid. Each contact has a third of its nodes or more."""

WIDER = 1.2
"""Half-angle of the arc of nodes, in parts of the widest frictionless half-angle. Friction widens by 8 % at most."""

SETTLING = {"fixed": 3, "free": 6}
"""Cycles until the values are read, by rotation. A held pin is steady after the second one."""


def pair_of(alpha: float, beta: float, kolosov: float) -> MaterialPair:
    """The pair of Dundurs' parameters and Kolosov's constant of the pin, in plane strain, with beta* = 1."""
    return MaterialPair.from_dundurs(alpha, beta, (3.0 - kolosov) / 4.0)


def first_load_values(
    pair: MaterialPair, friction: float, pin_load: PinLoad, load_parameters: Sequence[float], nodes: int
) -> np.ndarray:
    """The values of the charts of the first load at load parameters in falling order.

    The load P grows from zero at one clearance. So a run passes through many load parameters. Runs on wider and wider
    arcs follow each other, because a narrow contact needs narrow nodes.

    Returns
    -------
    ndarray, shape (k, 6)
        Peak pressure in P/(2 R), its angle from the bottom, half-angles of contact and stick, Kt on the bearing stress,
        the angle of the largest hoop stress; angles in rad.
    """
    found = []
    for most, chosen in first_load_runs(load_parameters):
        grid = Grid.arc(-0.5 * math.pi - WIDER * most, -0.5 * math.pi + WIDER * most, nodes | 1)
        is_neat = chosen == [0.0]  # a neat fit has one contact at all loads
        problem = Problem.from_load_parameter(pair, 0.0 if is_neat else 1.0, friction, pin_load)
        history = [{"P": 1.0 if is_neat else 1.0 / value} for value in chosen]
        found += [_first_load_reading(state) for state in solve(problem, history, grid=grid)]
    return np.array(found)


def first_load_runs(load_parameters: Sequence[float]) -> list[tuple[float, list[float]]]:
    """The runs that pass through load parameters in falling order: the span of each, and its load parameters."""
    runs = []
    for least, most in zip((0.0, *SPANS), SPANS, strict=False):
        chosen = [value for value in load_parameters if least < width_coordinate(value) <= most]
        runs += [(most, part) for part in ([v for v in chosen if v], [v for v in chosen if not v]) if part]
    return runs


def _first_load_reading(state: State) -> list[float]:
    """The values of the first load in a state under P alone."""
    bearing, hoop = 0.5 * state.load["P"], state.peak_hoop_stress()
    return [
        state.peak_pressure / bearing,
        abs(state.peak_pressure_angle + 0.5 * math.pi),
        0.5 * _width(state.contact),
        0.5 * _width(state.stick),
        hoop.kt_bearing,
        abs(hoop.angle + 0.5 * math.pi),
    ]


def cycle_values(problem: Problem, ratio: float, nodes: int) -> np.ndarray:
    """The values of the charts of a load cycle: P, then Q = +ratio P and -ratio P again and again.

    Parameters
    ----------
    problem : Problem
        From :meth:`fastpin.Problem.from_load_parameter`.
    ratio : float
    nodes : int

    Returns
    -------
    ndarray, shape (5,)
        Of the last cycle of :data:`SETTLING`: the energy per cycle in P^2 beta*, the largest slip range in P beta*, the
        half-angle of stick at its end, rad, the peak pressure and the largest hoop stress there in P/(2 R).
    """
    cycles = SETTLING[problem.rotation]
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": ratio}, {"Q": -ratio}]).repeated(cycles)
    result = solve(problem, history, nodes=nodes, slip_sums=True)
    over, state = result.cycle(), result[-1]
    hoop = state.peak_hoop_stress().value
    return np.array(
        [over.dissipation, over.largest_slip_range, 0.5 * _width(state.stick), 2.0 * state.peak_pressure, 2.0 * hoop]
    )


def _width(zones: Sequence[Interval]) -> float:
    return float(sum(stop - start for start, stop in zones))


def values_at(parameters: Mapping[str, Any], nodes: int) -> np.ndarray:
    """The values of the charts at one place, in the order of ``fastpin/charts/groups.py``: shape (6,), of cycles (5,).

    Parameters
    ----------
    parameters : mapping
        All parameters by name. With a "rotation" they belong to a load cycle.
    nodes : int
    """
    pair = pair_of(parameters["alpha"], parameters["beta"], parameters["kolosov"])
    friction, load, at = parameters["friction"], parameters["pin_load"], parameters["load_parameter"]
    if "rotation" in parameters:
        problem = Problem.from_load_parameter(pair, at, friction, load, parameters["rotation"])
        return cycle_values(problem, parameters["load_ratio"], nodes)
    return first_load_values(pair, friction, load, [at], nodes)[0]

"""Differences of solved states from closed forms.

``fastpin verify``, bench/accuracy.py, figures and the tests share these measures. Problems are dimensionless
(R = F = beta* = 1).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from fastpin.model import angles
from fastpin.model.points import Body, Points
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.state import State
from fastpin.verification import closed_forms, interference


def cattaneo_mindlin(
    state: State, x: np.ndarray | float, now: float, most: float, branch: closed_forms.Branch
) -> np.ndarray | float:
    """Return Cattaneo and Mindlin's shear traction T on the pin under the load P of a state, in P/R.

    Parameters
    ----------
    state : State
        Gives P, the load parameter and the coefficient of friction. Its bodies are like.
    x : float or ndarray
        Angles from the bottom of the hole, rad.
    now, most : float
        Q/(mu P) now, and its largest value so far.
    branch : {"loading", "unloading", "reloading"}
        See :func:`fastpin.verification.closed_forms.cattaneo_mindlin_shear`.

    Returns
    -------
    float or ndarray
        T, positive along +theta.
    """
    load_parameter = state.problem.load_parameter(state.load["P"])
    half = float(closed_forms.hertz_half_angle(load_parameter))
    peak = float(closed_forms.hertz_peak_pressure(load_parameter))
    # The traction on the pin opposes Q, and theta runs along +x at the bottom.
    return -closed_forms.cattaneo_mindlin_shear(x, half, peak, state.problem.uniform_friction, now, most, branch)


def cattaneo_mindlin_differences(states: Sequence[State], ratio: float) -> list[float]:
    """Return the differences int |dT| / int mu N of three states from Cattaneo-Mindlin shear tractions.

    Parameters
    ----------
    states : sequence of State
        The states after +Q, -Q and +Q again, of like bodies under P = F with the rotation held.
    ratio : float
        Q/(mu P), 0 to 1.

    Returns
    -------
    list of float
        One difference for each state, >= 0, dimensionless.
    """
    branches: list[tuple[float, closed_forms.Branch]]
    branches = [(ratio, "loading"), (-ratio, "unloading"), (ratio, "reloading")]
    differences = []
    for state, (now, branch) in zip(states, branches, strict=True):
        shear = cattaneo_mindlin(state, state.theta - angles.BOTTOM, now, ratio, branch)
        weights = state.grid.weights
        differences.append(
            float(weights @ np.abs(state.shear - shear) / (state.problem.uniform_friction * (weights @ state.pressure)))
        )
    return differences


def stress_resultant(state: State, body: Body, radius: float, count: int = 400) -> tuple[complex, float]:
    """Return the force Q - iP and the moment that the stress carries outwards through a circle about the centre.

    Parameters
    ----------
    state : State
    body : {"plate", "pin"}
    radius : float
        Radius of the circle, in the unit of the hole's radius.
    count : int
        Number of points on the circle.

    Returns
    -------
    force, moment : complex, float
        In N/m and N.
    """
    theta = 2.0 * np.pi * np.arange(count) / count
    stress = state.stress(Points.at_radius(radius, theta), body, straight=True)
    force = -2.0 * np.pi * radius * np.mean((stress.radial + 1j * stress.shear) * np.exp(1j * theta))
    return complex(force), -2.0 * np.pi * radius**2 * float(stress.shear.mean())


def all_round_difference(state: State) -> float:
    """Return the largest difference of N and T from the closed forms of a contact all round, over the pressure N0.

    Parameters
    ----------
    state : State
        Of an interference fit that is closed all round. With friction, all of it has stuck since assembly.
    """
    load = {name: value for name, value in state.load.items() if value != 0.0}
    if state.problem.frictionless:
        pressure = interference.frictionless_pressure(state.problem, state.theta, load)
        expected = np.array([pressure, np.zeros(pressure.size)])
    else:
        expected = interference.stuck_tractions(state.problem, state.theta, load)
    tractions = np.array([state.pressure, state.shear])
    return float(np.abs(tractions - expected).max() / interference.uniform_pressure(state.problem))


def event_load(
    problem: Problem,
    load: str,
    bounds: tuple[float, float],
    happened: Callable[[State], bool],
    nodes: int,
    follow: Callable[..., Result] = solve,
) -> float:
    """Return the size of one load at which an event first happens on a grid, by states along the exact path.

    Parameters
    ----------
    problem : Problem
    load : str
        The name of the load that grows from 0.
    bounds : (float, float)
        Loads between which the event happens, SI.
    happened : callable
        ``happened(state)`` tells whether the event has happened.
    nodes : int
    follow : callable
        The function that solves, :func:`fastpin.solve` by default.

    Returns
    -------
    float
        The load, to 1e-6 of the distance of the bounds; NaN if the event has not happened at the upper bound.
    """
    low, high = bounds
    start: Result | None = None
    for _ in range(5):  # 16 parts of the range in each round: 16^-5 is 1e-6
        start = follow(problem, [{load: low}], nodes=nodes, start=start)
        states = follow(problem, [{load: high}], nodes=nodes, start=start, between=15)
        first = next((index for index, state in enumerate(states) if happened(state)), None)
        if first is None:
            return math.nan
        low, high = (low if first == 0 else states[first - 1].load[load]), states[first].load[load]
    return 0.5 * (low + high)

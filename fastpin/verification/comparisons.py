"""Differences of solved states from closed forms and from the singular integral equations.

``fastpin verify``, scripts/accuracy.py and the tests share these measures. Problems are dimensionless
(R = F = beta* = 1).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fastpin.model.angles import BOTTOM, angle_between
from fastpin.states.state import State
from fastpin.verification import closed_forms, integral_equations


def cattaneo_mindlin(
    state: State, x: np.ndarray | float, now: float, most: float, branch: closed_forms.Branch
) -> np.ndarray | float:
    """Cattaneo and Mindlin's shear traction T on the pin under the load P of a state, in P/R.

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
    return -closed_forms.cattaneo_mindlin_shear(x, half, peak, state.problem.friction, now, most, branch)


def cattaneo_mindlin_differences(states: Sequence[State], ratio: float) -> list[float]:
    """Differences int |dT| / int mu N of three states from Cattaneo-Mindlin shear tractions.

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
    branches: list[tuple[float, closed_forms.Branch]] = [
        (ratio, "loading"),
        (-ratio, "unloading"),
        (ratio, "reloading"),
    ]
    found = []
    for state, (now, branch) in zip(states, branches, strict=True):
        shear = cattaneo_mindlin(state, state.theta - BOTTOM, now, ratio, branch)
        weights = state.grid.weights
        found.append(
            float(weights @ np.abs(state.shear - shear) / (state.problem.friction * (weights @ state.pressure)))
        )
    return found


def residuals_away(state: State, margin: float) -> tuple[float, float]:
    """Largest residuals of (46) and (47) inside the contact, away from its edges and borders.

    Parameters
    ----------
    state : State
        A state with one contact interval. The pin must have been pressed to the bottom first, and no load reversed: a
        reversal leaves kinks of the slip.
    margin : float
        Least distance from contact edges and stick borders, rad.

    Returns
    -------
    r46, r47 : float
        In units of F beta* with F = P.
    """
    load = state.load
    equations = integral_equations.residuals(
        state.problem, load["P"], state.grid, state.pressure, state.shear, state.slip, state.rotation,
        sxx=load["sxx"], syy=load["syy"], sxy=load["sxy"],
    )  # fmt: skip
    ((start, stop),) = state.contact
    away = np.abs(angle_between(state.theta, 0.5 * (start + stop))) < 0.5 * (stop - start) - margin
    for border in np.ravel(state.stick):
        away &= np.abs(angle_between(state.theta, border)) > margin
    first, second = (float(np.abs(residual[away]).max()) for residual in equations)
    return first, second

"""What solved states are compared with, and measures of how far they are from it.

``fastpin verify``, scripts/accuracy.py and the tests share them. Problems are dimensionless (R = F = beta* = 1).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fastpin.model.angles import BOTTOM
from fastpin.states.state import State
from fastpin.verification import closed_forms, integral_equations

# -- closed forms and equations ------------------------------------------------------------------------------


def cattaneo_mindlin(
    state: State, x: np.ndarray | float, now: float, most: float, branch: closed_forms.Branch
) -> np.ndarray | float:
    """Shear traction on the pin of Cattaneo and Mindlin, at angles `x` from the bottom, under the P of a state.

    Q/(mu P) is `now`, and has been `most`; see :func:`fastpin.analytic.cattaneo_mindlin_shear`.
    """
    load_parameter = state.problem.load_parameter(state.load["P"])
    half = float(closed_forms.hertz_half_angle(load_parameter))
    peak = float(closed_forms.hertz_peak_pressure(load_parameter))
    # The traction on the pin opposes Q, and theta runs along +x at the bottom.
    return -closed_forms.cattaneo_mindlin_shear(x, half, peak, state.problem.friction, now, most, branch)


def cattaneo_mindlin_differences(states: Sequence[State], ratio: float) -> list[float]:
    """int |dT| over int mu N between Cattaneo-Mindlin tractions and three states: after +Q, -Q and +Q again.

    Parameters
    ----------
    states : sequence of State
        Of like bodies under P = F with the rotation held.
    ratio : float
        Q/(mu P), 0 to 1.
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
    """Largest residuals of (46) and (47) in units of F beta*, F = P, in the contact and away from where it changes.

    Parameters
    ----------
    state : State
        Of a pin that was pressed to the bottom first; without a reversal of the load, which leaves kinks of the slip.
    margin : float
        Least distance from contact edges and stick borders, rad.
    """
    load = state.load
    equations = integral_equations.residuals(
        state.problem, load["P"], state.grid, state.pressure, state.shear, state.slip, state.rotation,
        sxx=load["sxx"], syy=load["syy"],
    )  # fmt: skip
    ((start, stop),) = state.contact
    away = (state.theta > start + margin) & (state.theta < stop - margin)
    for border in np.ravel(state.stick):
        away &= np.abs(state.theta - border) > margin
    first, second = (float(np.abs(one[away]).max()) for one in equations)
    return first, second

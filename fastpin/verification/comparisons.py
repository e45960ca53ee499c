"""What solved states are compared with, and measures of how far they are from it.

``fastpin verify``, scripts/accuracy.py and the tests share them. Problems are dimensionless (R = F = beta* = 1).
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fastpin import analytic, integral_equations
from fastpin.errors import InputError
from fastpin.grid import Grid
from fastpin.materials import MATERIALS, Material, MaterialPair
from fastpin.problem import Problem
from fastpin.state import State

BOTTOM = -0.5 * math.pi
LIKE = MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
FRETTING = ({"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275})

REFERENCE = Path(__file__).parent / "reference"
"""Where the tractions of the finite elements are."""

_ELEMENT = math.pi / 720.0
_NEAR = 6


# -- finite elements -----------------------------------------------------------------------------------------


class Difference(NamedTuple):
    """How far a state is from tractions of finite elements.

    Attributes
    ----------
    normal, shear : float
        int |dN| and int |dT| over the nodes, in parts of int N of the finite elements.
    normal_away, shear_away : float
        The same without six nodes on either side of each contact edge and each border of zones, of this state or an
        earlier one.
    """

    normal: float
    shear: float
    normal_away: float
    shear_away: float


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Tractions of a finite-element model and the problem that they belong to.

    Attributes
    ----------
    problem : Problem
    history : tuple of dict
        Loads, whose corners are the states.
    grid : Grid
        The finite elements' own nodes, in and near the contact.
    pressure, shear : ndarray, shape (states, n)
        N and T (on the pin, counter-clockwise positive), F/R.
    """

    problem: Problem
    history: tuple[dict[str, float], ...]
    grid: Grid
    pressure: np.ndarray
    shear: np.ndarray

    @classmethod
    def read(cls, name: str) -> FiniteElements:
        """The model "frictionless", "monotonic" or "fretting_fixed_rotation"; reference/*.csv say what they are.

        Raises
        ------
        InputError
            If there is no such model.
        OSError
            If its file is not there.
        """
        if name not in _MODELS:
            raise InputError("name", f"must be one of {', '.join(_MODELS)}, not {name!r}")
        problem, half_width, states = _MODELS[name]
        text = (REFERENCE / f"fem_{name}.csv").read_text(encoding="utf-8")
        rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
        values = {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}
        first = values["theta"][0]
        theta = first + _ELEMENT * np.round((values["theta"] - first) / _ELEMENT)  # without the rounding of the file
        inside = np.abs(theta - BOTTOM) < half_width
        pressure, shear = (np.array([values[f"{kind}_{state}"][inside] for state in states]) for kind in "NT")
        return cls(problem, FRETTING[: len(states)], Grid(theta[inside]), pressure, shear)

    def differences(self, states: Sequence[State]) -> list[Difference]:
        """The differences of the states at the corners of the history, solved on these nodes."""
        found = []
        away = np.ones(self.grid.size, dtype=bool)
        for state, pressure, shear in zip(states, self.pressure, self.shear, strict=True):
            for border in np.flatnonzero(np.diff(state.status)):
                away[max(border - _NEAR + 1, 0) : border + _NEAR + 1] = False
            normal, tangential = np.abs(state.pressure - pressure), np.abs(state.shear - shear)
            sums = (normal.sum(), tangential.sum(), normal[away].sum(), tangential[away].sum())
            found.append(Difference(*(float(one / pressure.sum()) for one in sums)))
        return found


_MODELS = {
    "frictionless": (Problem.from_load_parameter(LIKE, 0.05, 0.0, "body"), 1.4, ("P",)),
    "monotonic": (Problem.from_load_parameter(LIKE, 0.1, 0.4, "body"), 1.3, ("P",)),
    "fretting_fixed_rotation": (
        Problem.from_load_parameter(LIKE, 0.5, 0.55, "centre", "fixed"),
        1.0,
        ("P", "plusQ", "minusQ", "plusQ2"),
    ),
}
"""Problem, half-width of the part of the hole with tractions (rad) and columns of the states, by name."""


# -- closed forms and equations ------------------------------------------------------------------------------


def cattaneo_mindlin(
    state: State, x: np.ndarray | float, now: float, most: float, branch: analytic.Branch
) -> np.ndarray | float:
    """Shear traction on the pin of Cattaneo and Mindlin, at angles `x` from the bottom, under the P of a state.

    Q/(mu P) is `now`, and has been `most`; see :func:`fastpin.analytic.cattaneo_mindlin_shear`.
    """
    load_parameter = state.problem.load_parameter(state.load["P"])
    half = float(analytic.hertz_half_angle(load_parameter))
    peak = float(analytic.hertz_peak_pressure(load_parameter))
    # The traction on the pin opposes Q, and theta runs along +x at the bottom.
    return -analytic.cattaneo_mindlin_shear(x, half, peak, state.problem.friction, now, most, branch)


def cattaneo_mindlin_differences(states: Sequence[State], ratio: float) -> list[float]:
    """int |dT| over int mu N between Cattaneo-Mindlin tractions and three states: after +Q, -Q and +Q again.

    Parameters
    ----------
    states : sequence of State
        Of like bodies under P = F with the rotation held.
    ratio : float
        Q/(mu P), 0 to 1.
    """
    branches: list[tuple[float, analytic.Branch]] = [(ratio, "loading"), (-ratio, "unloading"), (ratio, "reloading")]
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

"""Stored tractions of finite-element models, and distances of states from them."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.states.state import State

LIKE = MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
FRETTING = ({"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275})

REFERENCE = Path(__file__).parent / "data"
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

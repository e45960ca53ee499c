"""Stored tractions of finite-element models, and the differences of states from them."""

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
"""Two equal bodies, plane strain."""

UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
"""A titanium pin in an aluminium plate, plane strain."""

FRETTING = ({"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275})
"""Corners of a fretting history: P = F, then +Q, -Q and +Q, with Q = 0.275 F."""

REFERENCE = Path(__file__).parent / "data"
"""Folder of the finite-element tractions."""

_ELEMENT = math.pi / 720.0  # node distance of the models, rad: 1,440 nodes round the hole
_NEAR = 6  # nodes on either side of an edge or border that "away" leaves out


class Difference(NamedTuple):
    """Difference of a state from the tractions of finite elements.

    Attributes
    ----------
    normal, shear : float
        int |dN| and int |dT| over all nodes, in parts of int N of the finite elements.
    normal_away, shear_away : float
        The same integrals without six nodes on either side of each contact edge and each border of zones, in this state
        and in earlier ones.
    """

    normal: float
    shear: float
    normal_away: float
    shear_away: float


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Tractions of a finite-element model, and its problem.

    Attributes
    ----------
    problem : Problem
        The problem, dimensionless (R = F = beta* = 1).
    history : tuple of dict
        Loads at the corners. The model has one state for each corner.
    grid : Grid
        The nodes of the finite elements in and near the contact.
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
        """Read the model "frictionless", "monotonic" or "fretting_fixed_rotation".

        The comments of the files data/fem_*.csv describe the models.

        Raises
        ------
        InputError
            If there is no such model.
        OSError
            If its file can't be read.
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
        """Return the differences of the states at the corners of the history. The states must be solved on ``grid``."""
        differences = []
        away = np.ones(self.grid.size, dtype=bool)
        for state, pressure, shear in zip(states, self.pressure, self.shear, strict=True):
            for border in np.flatnonzero(np.diff(state.status)):
                away[max(border - _NEAR + 1, 0) : border + _NEAR + 1] = False
            normal, tangential = np.abs(state.pressure - pressure), np.abs(state.shear - shear)
            sums = (normal.sum(), tangential.sum(), normal[away].sum(), tangential[away].sum())
            differences.append(Difference(*(float(total / pressure.sum()) for total in sums)))
        return differences


_MODELS = {
    "frictionless": (Problem.from_load_parameter(LIKE, 0.05, 0.0, "body"), 1.4, ("P",)),
    "monotonic": (Problem.from_load_parameter(LIKE, 0.1, 0.4, "body"), 1.3, ("P",)),
    "fretting_fixed_rotation": (
        Problem.from_load_parameter(LIKE, 0.5, 0.55, "centre", "fixed"),
        1.0,
        ("P", "plusQ", "minusQ", "plusQ2"),
    ),
}
"""Problem, half-width of the arc of nodes that is used (rad), and column names of the states, by name of the model."""

"""What is read of a stored result on demand: its origin, states, extremes and residuals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np

from fastpin.model.checks import file_path
from fastpin.solver.result import Result
from fastpin.states.extremes import Found, yield_extremes
from fastpin.states.state import State
from fastpin.storage import hdf5, layout
from fastpin.storage.held import Held
from fastpin.storage.store import load, load_points, open_result
from fastpin.storage.stored_states import read_extremes

STATES_AT_ONCE = 1_000
"""States whose pressures are in memory at once."""


def provenance(path: str | Path) -> dict[str, str]:
    """Return the versions, the date, the machine and the platform of a stored result, by name.

    The date "created" is that of the file's first writing, UTC, ISO 8601. The entry "run" is there only if a run has
    written the file, which then holds all options of the solver. What a file does not hold is left out.

    Raises
    ------
    InputError
        See :func:`fastpin.load`.
    """
    with open_result(file_path("path", path)) as file:
        attributes = {hdf5.text_of(name): hdf5.text_of(value) for name, value in file.attrs.items()}
    versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
    found = {name.removeprefix("version_"): value for name, value in versions.items()}
    return found | {name: attributes[name] for name in ("created", "host", "platform", "run") if name in attributes}


def largest_residuals(path: str | Path) -> dict[str, float]:
    """Return the largest residual of each kind over all states of a file, see :class:`fastpin.State`.

    A file without states has none.

    Raises
    ------
    InputError
        See :func:`fastpin.load`.
    """
    with open_result(file_path("path", path)) as file:
        rows: np.ndarray = file["states/residuals"][()]
    return dict(zip(layout.RESIDUALS, rows.max(axis=0).tolist(), strict=True)) if len(rows) else {}


def marked_extremes(path: str | Path) -> Found:
    """Return the extremes of all states of a file that texts and figures show, see fastpin/states/extremes.py.

    Raises
    ------
    InputError
        See :func:`fastpin.load`.
    """
    with open_result(file_path("path", path)) as file:
        return read_extremes(file)


class HeldInFile(Held):
    """A stored result, of which few states are read. Its run may still be going on.

    Raises
    ------
    InputError
        See :func:`fastpin.load`. The methods raise it too.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(load(path, states=[]), path)
        self._path = path

    @cached_property
    def points(self) -> np.ndarray:
        """Load points of all states, shape (states,)."""
        return load_points(self._path)

    @cached_property
    def extremes(self) -> Found:
        """The extremes of all states that texts and figures show."""
        return marked_extremes(self._path)

    @cached_property
    def residuals(self) -> dict[str, float]:
        """The largest residual of each kind over all states."""
        return largest_residuals(self._path)

    @cached_property
    def pressure(self) -> float:
        """The largest pressure at a node over all states, Pa."""
        with open_result(self._path) as file:
            rows = file["states/pressure"]
            parts = (rows[begin : begin + STATES_AT_ONCE] for begin in range(0, len(rows), STATES_AT_ONCE))
            return max((float(part.max(initial=0.0)) for part in parts), default=0.0)

    def read(self, places: Sequence[int]) -> list[State]:
        """Return the states at these places, in increasing order."""
        return load(self._path, states=list(places)).states

    def whole(self) -> Result:
        """Return the result with all its states."""
        return load(self._path)

    def _yield_extremes(self) -> Found:
        with open_result(self._path) as file:
            return read_extremes(file, yield_extremes)

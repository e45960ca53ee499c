"""The compliance of any finite plate: a small matrix between Fourier coefficients on the edge of its hole.

A finite plate differs from the infinite one by a smooth part. Few harmonics describe it, whatever the nodes are. The
basis functions are, in this order,

    r and theta component of 1/sqrt(2);  for n = 1 to K: r cos n theta, r sin n theta, theta cos n theta,
    theta sin n theta.

Their coefficients f of the traction on the plate and v of its displacement obey G v/R = (hole + matrix) f, where "hole"
is the hole in the infinite plate of the same material, (T41) of docs/theory.md. The matrix is symmetric (Betti).
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from fastpin.errors import InputError, printable
from fastpin.model.checks import as_toml, choice, file_path, number, numbers, positive, string, why_unreadable
from fastpin.model.inputs import open_input
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.materials import PLANES, Plane

FORMAT = "fastpin compliance"
"""Name of the file format, its first entry."""

VERSION = 1
"""Version of the file format."""

LEAST_ORDER, MOST_ORDER = 2, 200
"""Limits of the highest harmonic K."""

ASYMMETRY = 1e-6
"""Largest difference of a matrix and its transpose, in parts of its largest entry."""

DECAYED = 1e-2
"""Largest entry of the last harmonic, in parts of the largest entry of the harmonics 0 and 2."""

COLUMNS = tuple(LOADS[place] for place in REMOTE)
"""Loads that a plate may have besides the forces on the pin: its own loads take the names of the remote stresses."""

MOST_BYTES = 10_000_000
"""Most bytes of a file."""


@dataclass(frozen=True, eq=False, repr=False)
class Compliance:
    """A finite plate with a hole, by its compliance on the edge of the hole.

    Parameters
    ----------
    nu : float
        Poisson's ratio of the plate.
    plane : {"strain", "stress"}
    hole_radius : float
        Radius of the hole, m.
    matrix : ndarray, shape (2 + 4 K, 2 + 4 K)
        The plate's compliance less that of the infinite plate, times G; see the module. It does not depend on E. The
        first harmonic holds the translation of the hole over the supports.
    columns : mapping of str to ndarray, shape (2 + 4 K,)
        Displacement G v/R per unit of a load of the plate. The loads are called sxx, syy and sxy.
    made_by : str
        Origin of the numbers.

    Raises
    ------
    InputError
        If a field is out of range, the matrix is not symmetric, or its last harmonics have not decayed.
    """

    nu: float
    plane: Plane
    hole_radius: float
    matrix: np.ndarray
    columns: Mapping[str, np.ndarray] = field(default_factory=dict)
    made_by: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "nu", number("nu", self.nu, 0.0, 0.5))
        choice("plane", self.plane, PLANES)
        object.__setattr__(self, "hole_radius", positive("hole_radius", self.hole_radius))
        string("made_by", self.made_by)
        matrix = numbers("matrix", self.matrix).copy()
        size = matrix.shape[0] if matrix.ndim == 2 else 0
        if matrix.shape != (size, size) or size % 4 != 2 or not LEAST_ORDER <= (size - 2) // 4 <= MOST_ORDER:
            raise InputError(
                "matrix",
                f"must have the shape (2 + 4 K, 2 + 4 K) with K from {LEAST_ORDER} to {MOST_ORDER}, not {matrix.shape}",
            )
        largest = float(np.abs(matrix).max())
        if float(np.abs(matrix - matrix.T).max()) > ASYMMETRY * largest:
            raise InputError("matrix", "must be symmetric: the displacement at one place under a force at another")
        matrix = 0.5 * (matrix + matrix.T)
        self._check_decay(matrix)
        matrix.setflags(write=False)
        object.__setattr__(self, "matrix", matrix)
        if not isinstance(self.columns, Mapping):
            raise InputError("columns", f"must map loads to columns, not {as_toml(self.columns)}")
        columns = {}
        for name, column in self.columns.items():
            choice("columns", name, COLUMNS)
            columns[name] = numbers(f"columns.{name}", column).copy()
            if columns[name].shape != (size,):
                raise InputError(f"columns.{name}", f"must have the shape ({size},), not {columns[name].shape}")
            columns[name].setflags(write=False)
        object.__setattr__(self, "columns", MappingProxyType(columns))

    def __reduce__(self) -> tuple[type[Compliance], tuple[Any, ...]]:
        """Copies and pickles are made anew, so that they can't be changed either."""
        given = self.nu, self.plane, self.hole_radius, self.matrix, dict(self.columns), self.made_by
        return type(self), given

    def __repr__(self) -> str:
        made = f", {self.made_by}" if self.made_by else ""
        return f"<Compliance: {self.order} harmonics, nu {self.nu:g}, plane {self.plane}{made}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Compliance) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @staticmethod
    def _check_decay(matrix: np.ndarray) -> None:
        harmonic = np.r_[0, 0, np.repeat(np.arange(1, (len(matrix) - 2) // 4 + 1), 4)]
        low, last = np.flatnonzero((harmonic == 0) | (harmonic == 2)), np.flatnonzero(harmonic == harmonic[-1])
        inner = np.flatnonzero(harmonic != 1)  # the first harmonic holds the translation over the supports
        size, left = float(np.abs(matrix[np.ix_(low, inner)]).max()), float(np.abs(matrix[np.ix_(last, inner)]).max())
        if left > DECAYED * size:
            raise InputError(
                "matrix",
                f"its last harmonic {harmonic[-1]} is {left / size:.2g} of the largest; it must decay to "
                f"{DECAYED:g}: take more harmonics",
            )

    @property
    def order(self) -> int:
        """The highest harmonic K."""
        return (len(self.matrix) - 2) // 4

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all numbers. The origin does not enter."""
        content = self.document()
        del content["made_by"]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    @classmethod
    def from_file(cls, path: str | Path) -> Compliance:
        """Read a compliance from a file of ``fastpin compliance``.

        Raises
        ------
        InputError
            If the file can't be read, is no such file, or has a fault.
        """
        place = file_path("file", path)
        try:
            with open_input(place) as file:
                raw = file.read(MOST_BYTES + 1)
        except OSError as error:
            raise InputError("file", f"{place}: {why_unreadable(error)}") from None
        if len(raw) > MOST_BYTES:
            raise InputError("file", f"{place} is larger than {MOST_BYTES:,} bytes")
        try:
            content = json.loads(raw)
        except (ValueError, RecursionError):
            content = None
        if not isinstance(content, dict) or content.get("format") != FORMAT:
            raise InputError("file", f"{place} is no compliance file; fastpin compliance makes one")
        try:
            return cls.from_document(content)
        except InputError as error:
            raise InputError("file", f"{place}: {error}") from None

    @classmethod
    def from_document(cls, content: Mapping[str, Any]) -> Compliance:
        """Return the compliance of the content of a file.

        Raises
        ------
        InputError
            If an entry is missing or wrong, or the version is unknown.
        """
        if not isinstance(content, Mapping):
            raise InputError("content", f"must be a table, not {as_toml(content)}")
        if content.get("version") != VERSION:
            raise InputError("version", f"must be {VERSION}, not {as_toml(content.get('version'))}")
        missing = [name for name in ("nu", "plane", "hole_radius", "matrix") if name not in content]
        if missing:
            raise InputError(missing[0], "is missing")
        known = ("nu", "plane", "hole_radius", "matrix", "columns", "made_by")
        given = {name: content[name] for name in known if name in content}
        if isinstance(given.get("made_by"), str):
            given["made_by"] = printable(given["made_by"])  # the file may be anybody's, or of an earlier version
        return cls(**given)

    def document(self) -> dict[str, Any]:
        """Return the content of a file, JSON-ready."""
        return {
            "format": FORMAT,
            "version": VERSION,
            "nu": self.nu,
            "plane": self.plane,
            "hole_radius": self.hole_radius,
            "order": self.order,
            "matrix": self.matrix.tolist(),
            "columns": {name: column.tolist() for name, column in self.columns.items()},
            "made_by": self.made_by,
        }

    def to_text(self) -> str:
        """Return the text of a file."""
        return json.dumps(self.document(), indent=1) + "\n"

    def columns_of(self, name: str) -> np.ndarray:
        """The column of a load; zeros if the plate has no such load. Another name raises :class:`InputError`."""
        choice("name", name, COLUMNS)
        return self.columns.get(name, np.zeros(len(self.matrix)))

    def scaled_to(self, radius: float) -> bool:
        """Whether the file's hole has this radius, m, up to rounding."""
        return math.isclose(positive("radius", radius), self.hole_radius, rel_tol=1e-9)

"""The compliance of any finite plate: a small matrix between Fourier coefficients on the edge of its hole.

A finite plate differs from the infinite one by a smooth part. Few harmonics describe it, whatever the nodes are. The
basis functions are, in this order,

    r and theta component of 1/sqrt(2);  for n = 1 to K: r cos n theta, r sin n theta, theta cos n theta,
    theta sin n theta.

Their coefficients f of the traction on the plate and v of its displacement obey G v/R = (hole + matrix) f, where "hole"
is the hole in the infinite plate of the same material, (T41) of docs/theory.md. The matrix is symmetric (Betti).
"""

from __future__ import annotations

import functools
import hashlib
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from fastpin.bodies.body import Harmonics, InWords, PlateBody, Projected, Remote, Rim, Shape, Table
from fastpin.bodies.walls import Displacements, PlateWalls, Wall
from fastpin.errors import InputError, printable
from fastpin.kernels import fourier
from fastpin.model.checks import (
    any_text,
    as_toml,
    check_fields,
    choice,
    file_path,
    is_whole,
    number,
    numbers,
    positive,
    set_fields,
    string,
    why_unreadable,
)
from fastpin.model.grid import Grid
from fastpin.model.inputs import open_input
from fastpin.model.loads import LOADS, REMOTE, TEMPERATURE, P, Q
from fastpin.model.materials import PLANES, Material, MaterialPair, Plane

FORMAT = "fastpin compliance"
"""Name of the file format, its first entry."""

VERSION = 1
"""Version of the file format."""

LEAST_ORDER, MOST_ORDER = 2, 200
"""Limits of the highest harmonic K."""

COLUMNS = tuple(LOADS[place] for place in REMOTE)
"""Loads that a plate may have besides the forces on the pin: its own loads take the names of the remote stresses."""

WARM = LOADS[TEMPERATURE]
"""Name of the column of a temperature."""

MOST_ENTRY = 1e9
"""Largest entry, dimensionless. That of a slender lug is below 1e6; a larger one could only mean a wrong unit."""

MOST_BYTES = 10_000_000
"""Most bytes of a file."""


@dataclass(frozen=True, eq=False, repr=False)
class Compliance(PlateBody):
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
        Displacement G v/R per unit of a load of the plate. The loads are called sxx, syy and sxy. The column
        "temperature" is v/R per unit of the free thermal strain, beyond free expansion: what the supports hinder.
    made_by : str
        Origin of the numbers.
    outline : str
        Outline, further holes, supports and loads as a JSON text of :meth:`fastpin.lugs.Lug.document`. With it the
        stress is known in the whole plate, without it near the hole only.

    Raises
    ------
    InputError
        If a field is out of range, the matrix is not symmetric, or its last harmonics have not decayed.
    """

    kind = "compliance"
    keys: ClassVar = {"file": ""}
    arrays, named_arrays, texts = ("matrix",), ("columns",), ("outline",)
    edge_only = True
    outer_radius = math.inf

    nu: float
    plane: Plane
    hole_radius: float
    matrix: np.ndarray
    columns: Mapping[str, np.ndarray] = field(default_factory=dict)
    made_by: str = ""
    outline: str = ""

    def __post_init__(self) -> None:
        check_fields(self, number, "nu", 0.0, 0.5)
        check_fields(self, choice, "plane", PLANES)
        check_fields(self, positive, "hole_radius")
        check_fields(self, string, "made_by outline")
        if self.outline:
            _check_json(self.outline)
        matrix = numbers("matrix", self.matrix, -MOST_ENTRY, MOST_ENTRY).copy()
        size = matrix.shape[0] if matrix.ndim == 2 else 0
        if matrix.shape != (size, size) or size % 4 != 2 or not LEAST_ORDER <= (size - 2) // 4 <= MOST_ORDER:
            words = f"must have the shape (2 + 4 K, 2 + 4 K) with K from {LEAST_ORDER} to {MOST_ORDER}"
            raise InputError("matrix", f"{words}, not {matrix.shape}")
        largest = float(np.abs(matrix).max())
        if float(np.abs(matrix - matrix.T).max()) > 1e-6 * largest:
            raise InputError("matrix", "must be symmetric: the displacement at one place under a force at another")
        matrix = 0.5 * (matrix + matrix.T)
        harmonic = np.r_[0, 0, np.repeat(np.arange(1, (size - 2) // 4 + 1), 4)]
        low, last = np.flatnonzero((harmonic == 0) | (harmonic == 2)), np.flatnonzero(harmonic == harmonic[-1])
        inner = np.flatnonzero(harmonic != 1)  # the first harmonic holds the translation over the supports
        most, left = (float(np.abs(matrix[np.ix_(rows, inner)]).max()) for rows in (low, last))
        if left > 0.01 * most:
            words = f"its last harmonic {harmonic[-1]} is {left / most:.2g} of the largest; it must decay to 0.01"
            raise InputError("matrix", f"{words}: take more harmonics")
        matrix.setflags(write=False)
        set_fields(self, matrix=matrix)
        if not isinstance(self.columns, Mapping):
            raise InputError("columns", f"must map loads to columns, not {as_toml(self.columns)}")
        columns = {}
        for name, column in self.columns.items():
            choice("columns", name, (*COLUMNS, WARM))
            columns[name] = numbers(f"columns.{name}", column, -MOST_ENTRY, MOST_ENTRY).copy()
            if columns[name].shape != (size,):
                raise InputError(f"columns.{name}", f"must have the shape ({size},), not {columns[name].shape}")
            columns[name].setflags(write=False)
        set_fields(self, columns=MappingProxyType(columns))

    def __reduce__(self) -> tuple[type[Compliance], tuple[Any, ...]]:
        """Copies and pickles are made anew, so that they can't be changed either."""
        given = self.nu, self.plane, self.hole_radius, self.matrix, dict(self.columns), self.made_by, self.outline
        return type(self), given

    def __repr__(self) -> str:
        made = f", {self.made_by}" if self.made_by else ""
        return f"<Compliance: {self.order} harmonics, nu {self.nu:g}, plane {self.plane}{made}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Compliance) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @property
    def order(self) -> int:
        """The highest harmonic K."""
        return (len(self.matrix) - 2) // 4

    @property
    def own_loads(self) -> tuple[str, ...]:
        """Names of the loads of the plate."""
        return tuple(name for name in COLUMNS if name in self.columns)

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
        if isinstance(content.get("lug"), Mapping):
            given["outline"] = json.dumps(content["lug"])
        if isinstance(given.get("made_by"), str):
            given["made_by"] = printable(given["made_by"])  # the file may be anybody's, or of an earlier version
        made = cls(**given)
        order = content.get("order", made.order)
        if not is_whole(order) or order != made.order:
            raise InputError("order", f"must be {made.order}, the last harmonic of the matrix, not {as_toml(order)}")
        return made

    def document(self) -> dict[str, Any]:
        """Return the content of a file, JSON-ready."""
        columns = {name: column.tolist() for name, column in self.columns.items()}
        head = {"format": FORMAT, "version": VERSION, "nu": self.nu, "plane": self.plane}
        sizes = {"hole_radius": self.hole_radius, "order": self.order, "matrix": self.matrix.tolist()}
        lug = {"lug": json.loads(self.outline)} if self.outline else {}
        return {**head, **sizes, "columns": columns, **lug, "made_by": self.made_by}

    def to_text(self) -> str:
        """Return the text of a file."""
        return json.dumps(self.document(), indent=1) + "\n"

    def columns_of(self, name: str) -> np.ndarray:
        """The column of a load; zeros if the plate has no such load. Another name raises :class:`InputError`."""
        choice("name", name, (*COLUMNS, WARM))
        return self.columns.get(name, np.zeros(len(self.matrix)))

    def scaled_to(self, radius: float) -> bool:
        """Whether the file's hole has this radius, m, up to rounding."""
        return math.isclose(positive("radius", radius), self.hole_radius, rel_tol=1e-9)

    # -- case files, stored files, words

    @classmethod
    def read(cls, table: Table, key: str = "file") -> Compliance | None:
        """Read the compliance whose file stands under `key`. None if it is wrong; all faults are reported."""
        table.require(key)
        name = table.checked(key, any_text)
        if name is None:
            return None
        try:
            path = table.folder / name
            try:
                status = path.stat()
            except OSError:  # the file can't be read; the reader says why
                return Compliance.from_file(path)
            return _read(path, status.st_mtime_ns, status.st_size)
        except InputError as error:
            table.report(str(error) if key == "file" else f"{key}: {error.reason}", key)
            return None

    def toml(self) -> dict[str, Any]:
        raise InputError("plate_body", "a compliance has a file of its own: name it in the section [plate_body]")

    def entries(self) -> dict[str, Any]:
        found = super().entries()
        return found | {"matrix": found.pop("matrix"), "columns": found.pop("columns")}

    def as_json(self, material: Callable[[Material], Any]) -> dict[str, Any]:
        """The kind, and the SHA-256 of the numbers."""
        return {"kind": self.kind, "sha256": self.digest}

    def summary(self) -> dict[str, Any]:
        return {"order": self.order, "loads": list(self.own_loads), "made_by": self.made_by}

    def words(self, length: InWords) -> str:
        made = f", {self.made_by}" if self.made_by else ""
        loads = ", ".join(["forces", *self.own_loads])
        return f"finite plate, compliance of {self.order} harmonics{made}, loads: {loads}"

    def caption(self, length: InWords, material: InWords) -> str:
        return ", finite"

    # -- checks

    def check_pair(self, pair: MaterialPair, radius: float, dimensionless: bool) -> None:
        nu, plane = pair.plate.nu, pair.plane
        if not math.isclose(self.nu, nu, abs_tol=1e-9) or self.plane != plane:
            words = f"the compliance was made for nu = {self.nu:g}, plane {self.plane}"
            raise InputError("plate_body", f"{words}; the plate has nu = {nu:g}, plane {plane}")
        if not dimensionless and not self.scaled_to(radius):
            words = f"the compliance was made for a hole of radius {self.hole_radius:g}; the hole radius is {radius:g}"
            raise InputError("plate_body", words)

    def without_gauge(self, radius: float) -> str:
        return "a compliance knows the edge of the hole only: leave the gauge out"

    def check_remote(self, name: str) -> None:
        if name not in self.columns:
            known = ", ".join(self.own_loads) or "none"
            raise InputError(name, f"the compliance of the plate has no column of this load; its columns are: {known}")

    def unknown_when_warm(self, pair: MaterialPair) -> str:
        if WARM not in self.columns:
            return "the compliance of the plate has no column of the temperature: make its file again"
        return "a rigid lug can't expand within its supports" if pair.plate.is_rigid else ""

    def fitted(self, table: Table, radius: float, dimensionless: bool, pair: MaterialPair | None) -> PlateBody | None:
        return None if pair is None else self

    # -- the response of the rim, and stresses

    def pressed(self, rim: Rim) -> float:
        return -(rim.compliance * (0.5 + float(self.matrix[0, 0])))

    def pressed_share(self, rim: Rim) -> float:
        return -1.0 - 2.0 * float(self.matrix[0, 0])

    def pressed_by_matrix(self, rim: Rim) -> float:
        return 2.0 * rim.compliance * float(self.matrix[0, 0])

    def matrix_in(self, rim: Rim, beta: float) -> np.ndarray:
        without = self._without_motion
        return rim.compliance / beta * (without @ self.matrix @ without)

    def load_columns(self, rim: Rim, beta: float) -> Displacements:
        unit, rows = rim.compliance / beta, translation_rows(len(self.matrix))
        columns: Mapping[int, np.ndarray] = {
            Q: self.matrix @ rows[0] / (math.pi * math.sqrt(2.0)),
            P: -self.matrix @ rows[1] / (math.pi * math.sqrt(2.0)),
            **{LOADS.index(name): column for name, column in self.columns.items() if name != WARM},
        }
        without = self._without_motion
        return {place: unit * complex_coefficients(without @ column) for place, column in columns.items()}

    def expanded(self, rim: Rim) -> np.ndarray:
        hindered = complex_coefficients(self._without_motion @ self.columns_of(WARM))
        hindered[self.order] += 1.0
        return (rim.material.expansion or 0.0) * hindered

    @property
    def _without_motion(self) -> np.ndarray:
        """The projection that takes resultant and translation from coefficients."""
        rows = translation_rows(len(self.matrix))
        return np.eye(len(self.matrix)) - rows.T @ rows

    def over_supports(self, moved: complex, rim: Rim, projected: Projected, load: Mapping[str, float]) -> complex:
        displacement = self.matrix @ projected(self.matrix)
        for name in self.own_loads:
            displacement = displacement + load[name] * self.columns[name]
        if load[WARM]:
            displacement = displacement + _thermal_stress(rim, load[WARM]) * self.columns_of(WARM)
        unit = math.sqrt(0.5) * rim.radius * rim.compliance
        x, y = unit * (translation_rows(len(self.matrix)) @ displacement)
        return moved + complex(x, y)

    @property
    def near_only(self) -> str:
        words = "a compliance gives the stress near the hole only, a file with the outline everywhere"
        return "" if self.outline else words

    def drawing(self, rim: Rim) -> list[Shape]:
        return [Shape("outline", rim.ratio, "lug", self.geometry)] if self.outline else super().drawing(rim)

    def net_section(self, radius: float) -> float:
        return (self.geometry.net_section if self.outline else None) or math.inf

    @property
    def geometry(self) -> Any:
        return self._lugs.lug_of(self) if self.outline else None

    @property
    def rims(self) -> tuple[np.ndarray, list[str]]:
        return self._inside.rims if self.outline else super().rims

    @property
    def along_edges(self) -> Any:
        return self._inside.along_edges if self.outline else None

    def looked_at(self, radius: float, length: InWords) -> str:
        if not self.outline:
            return "near the hole only"
        places, apart = self._inside.singular * radius, self._inside.apart * radius
        named = ", ".join(f"[{length(z.real)}, {length(z.imag)}]" for z in places[:4].tolist())
        more = f" and {len(places) - 4} more" if len(places) > 4 else ""
        return f"apart from {length(apart)} about sharp corners and ends of supports: {named}{more}" if named else ""

    @property
    def other_edges(self) -> Any:
        return self._lugs.OtherEdges(self) if self.outline else None

    @property
    def _lugs(self) -> Any:
        """The folder :mod:`fastpin.lugs`, which few solutions need."""
        from fastpin import lugs

        return lugs

    @property
    def _inside(self) -> Any:
        """The :class:`fastpin.lugs.PlateField` of the outline."""
        return self._lugs.plate_field(self)

    def contains(self, z: np.ndarray) -> np.ndarray:
        return np.asarray(self.geometry.contains(z * self.hole_radius)) if self.outline else super().contains(z)

    @cached_property
    def reach(self) -> float:
        """Largest radius at which the stress is known all round, in radii of the hole.

        Without an outline it follows from the entries of the matrix. They fall like d^-2n with the harmonic n, where d
        is the radius of the nearest other edge.
        """
        if self.outline:
            return float(self.geometry.nearest)
        farthest = 100.0  # a farther edge is not looked for
        part = 0.25  # on this part of the way to the nearest other edge the harmonics give the stress to six digits
        size = np.abs(self.matrix).max(axis=1)[6:].reshape(-1, 4).max(axis=1)  # of the harmonics 2 to K
        size = np.maximum.accumulate(size[::-1])[::-1]  # in a symmetric plate some harmonics vanish
        if size[0] == 0.0:
            return 1.0 + part * (farthest - 1.0)
        small = np.flatnonzero(size < 1e-6 * size[0])  # far enough below the second one to tell how fast they fall
        last = int(small[0]) if small.size else size.size - 1  # later ones may be noise
        nearest = float(size[last] / size[0]) ** (-0.5 / max(last, 1)) if size[last] > 0.0 else farthest
        return 1.0 + part * (min(nearest, farthest) - 1.0)

    def walls(self, rim: Rim, tractions: Harmonics, remote: Remote) -> PlateWalls:
        """The smooth field, which leaves the hole free of traction: near the hole (T48), or by its outline (T59)."""
        moved = self._moved_by(self._column(rim, tractions, remote, self.order))
        moved[np.abs(moved) < 1e-10 * np.abs(moved).max()] = 0.0  # their noise grows like r^n
        order = np.arange(self.order + 1.0)
        amplitudes = 2.0 / (rim.kolosov + 1.0) * (np.arange(-self.order, self.order + 1.0) + 1.0) * moved
        a, b = amplitudes[self.order :], amplitudes[self.order :: -1]  # those of z^n and z^-n
        growing = np.array([a, order * a, (1.0 - order) * a + np.conj(b)])
        decaying = np.array([b, -order * b, (1.0 + order) * b + np.conj(a)])
        decaying[:, 0] = 0.0  # the constant belongs to the growing ones
        if self.outline:
            growing[:2], growing[2, 2:] = 0.0, 0.0  # only negative powers of z stay
            column = self.with_others(self._column(rim, tractions, remote, self._inside.order))
            return PlateWalls(Wall(growing, decaying, 1.0, 1.0, (partial(self._inside.smooth, column),)), None)
        far = self.reach
        return PlateWalls(Wall(growing * far**order / [[1.0], [1.0], [far * far]], decaying, 1.0, far), None)

    def add_edge_hoop(self, hoop: np.ndarray, rim: Rim, tractions: Harmonics, remote: Remote, at: np.ndarray) -> None:
        """Add the hoop stress on the edge beyond the infinite plate at the angles `at`, shape (m,); (T48)."""
        order = np.arange(-self.order, self.order + 1.0)
        waves = np.exp(1j * np.multiply.outer(at, order))
        moved = self._moved_by(self._column(rim, tractions, remote, self.order))
        hoop += 8.0 / (rim.kolosov + 1.0) * np.real(waves @ ((1.0 + order) * moved))

    def _column(self, rim: Rim, tractions: Harmonics, remote: Remote, order: int) -> np.ndarray:
        """Coefficients of the traction on the hole, own loads and G times the free thermal strain, (2 + 4 K + 4,)."""
        t = tractions(order)
        on_hole = plate_coefficients(-(t[:, 0] + t[:, 1]), -1j * (t[:, 0] - t[:, 1]))
        return np.r_[on_hole, remote[:-1], _thermal_stress(rim, remote[-1]) if remote[-1] else 0.0]

    def _moved_by(self, column: np.ndarray) -> np.ndarray:
        """Fourier coefficients of G v/R of the edge beyond the infinite plate and free expansion, n = -K to K."""
        moved = self.matrix @ column[: len(self.matrix)]
        for name, value in zip((*COLUMNS, WARM), column[len(self.matrix) :], strict=True):
            if value:
                moved = moved + value * self.columns_of(name)
        return complex_coefficients(moved)


def _check_json(outline: str) -> None:
    most = 1_000_000  # characters
    try:
        is_table = len(outline) <= most and isinstance(json.loads(outline), dict)
    except (ValueError, RecursionError):
        is_table = False
    if not is_table:
        raise InputError("outline", f"must be a JSON text of Lug.document with at most {most:,} characters")


def _thermal_stress(rim: Rim, rise: float) -> float:
    """G times the free thermal strain of the plate, Pa."""
    return (rim.material.expansion or 0.0) * rise / rim.compliance


@functools.lru_cache(maxsize=8)  # the points of a sweep often share a file
def _read(path: Path, changed: int, size: int) -> Compliance:
    """Read a compliance, unless the same file was read before and has not changed since."""
    return Compliance.from_file(path)


# -- the basis of the coefficients ----------------------------------------------------------------------------


def basis(matrix: np.ndarray, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """The basis of a compliance's `matrix` (m, m) at the nodes, (2n, m), and the coefficients of hats in it, (m, 2n).

    Rows and columns of the nodes belong to (gap, slip) and (N, T).
    """
    order = (len(matrix) - 2) // 4
    return _in_basis(_waves(order, grid)), _hats(order, grid)


def _waves(order: int, grid: Grid) -> np.ndarray:
    return np.asarray(np.exp(-1j * np.multiply.outer(grid.theta, np.arange(order + 1.0))))


def _hats(order: int, grid: Grid) -> np.ndarray:
    """The coefficients of hats, shape (2 + 4 K, 2n)."""
    moments = fourier.hat_moments(np.arange(order + 1.0), *grid.halves)
    return _in_basis(moments * _waves(order, grid) / math.pi).T


_kept_hats = functools.lru_cache(maxsize=2)(_hats)  # the states of a history ask for the same ones


def state_columns(rim: Rim, order: int, grid: Grid, tractions: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Coefficients of the tractions on the hole, own loads and G times the free thermal strain, (k, 2 + 4 K + 4).

    `tractions` (k, 2n) are the nodal pressures and then shears, and `loads` (k, 4) those that stress the plate.
    """
    warm = _thermal_stress(rim, 1.0) * loads[:, -1:]
    return np.hstack([tractions @ _kept_hats(order, grid).T, loads[:, :-1], warm])


def _in_basis(waves: np.ndarray) -> np.ndarray:
    """Columns of the basis (2n, 2 + 4K) for gap and slip from exp(-i n theta), shape (n, K + 1).

    The theta component of the basis is turned: the traction on the plate is (N, -T), and the slip counts -v_theta.
    """
    n, order = waves.shape[0], waves.shape[1] - 1
    found = np.zeros((2 * n, 2 + 4 * order))
    found[:n, 0] = waves[:, 0].real / math.sqrt(2.0)
    found[n:, 1] = -waves[:, 0].real / math.sqrt(2.0)
    found[:n, 2::4], found[:n, 3::4] = waves[:, 1:].real, -waves[:, 1:].imag
    found[n:, 4::4], found[n:, 5::4] = -waves[:, 1:].real, waves[:, 1:].imag
    return found


def translation_rows(size: int) -> np.ndarray:
    """Unit vectors, shape (2, size), of the force along x and y in the basis of a compliance.

    They are also a translation of the hole along x and y by the square root of 1/2.
    """
    rows = np.zeros((2, size))
    rows[0, [2, 5]] = math.sqrt(0.5) * np.array([1.0, -1.0])
    rows[1, [3, 4]] = math.sqrt(0.5)
    return rows


def complex_coefficients(column: np.ndarray) -> np.ndarray:
    """Fourier coefficients of v_r + i v_theta, n = -K to K, from coefficients in the real basis (2 + 4K, ...)."""
    order = (len(column) - 2) // 4
    found = np.zeros((2 * order + 1, *column.shape[1:]), dtype=complex)
    found[order] = (column[0] + 1j * column[1]) / math.sqrt(2.0)
    cos, sin = column[2::4] + 1j * column[4::4], column[3::4] + 1j * column[5::4]
    found[order + 1 :], found[order - 1 :: -1] = 0.5 * (cos - 1j * sin), 0.5 * (cos + 1j * sin)
    return found


def plate_coefficients(pressure: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Coefficients of the traction (N, -T) on the plate in the basis of a compliance, shape (2 + 4K, ...).

    `pressure` and `shear`, shape (K + 1, ...), are int g exp(-i n xi) dxi/pi of N and T, n = 0 to K.
    """
    found = np.empty((4 * len(pressure) - 2, *pressure.shape[1:]))
    found[0], found[1] = pressure[0].real / math.sqrt(2.0), -shear[0].real / math.sqrt(2.0)
    found[2::4], found[3::4] = pressure[1:].real, -pressure[1:].imag
    found[4::4], found[5::4] = -shear[1:].real, shear[1:].imag
    return found

"""The groups of charts: their axes, and the way from parameters to coordinates and back.

The charts of a group share a table, whose nodes are equally spaced in a coordinate along each axis. The coordinates
are chosen such that the values are smooth between few nodes.
"""

from __future__ import annotations

import functools
import math
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fastpin.errors import InputError

ROUNDING = 1e-9
"""Distance of a parameter from 0, or from a limit that follows from other parameters, that counts as none."""

NEAT = 0.4563
"""1/epsilon^2 of a neat fit of like bodies without friction, with the half-angle epsilon of 84.8 degrees."""

FIRST_LOAD = ("peak_pressure", "peak_pressure_angle", "contact_angle", "stick_angle", "kt_bearing", "peak_hoop_angle")
"""Quantities of the first load, in the order of ``scripts/charts_runs.py``."""

CYCLE = ("cycle_energy", "cycle_slip_range", "cycle_stick_angle", "cycle_peak_pressure", "cycle_kt_bearing")
"""Quantities of a load cycle, in the order of ``scripts/charts_runs.py``."""

METALS = 1.0 / 3.2, 1.0 / 2.5
"""1/(kappa + 1) of Kolosov's constants 2.2 and 1.5: nu from 0.2 to 0.375 in plane strain, from 0.25 in plane stress."""

DATA = Path(__file__).parent / "charts.npz"
"""The data of the package."""

VERSION = 4
"""Version of the data: of the axes, the quantities and their scales."""

FEW = 4
"""Numbers of nodes of an axis up to which one polynomial goes through all nodes."""


def width_coordinate(load_parameter: Any) -> Any:
    """The coordinate x = 1/sqrt(0.4563 + pi L_p) along the load parameter: about the frictionless half-angle, rad."""
    return (NEAT + math.pi * load_parameter) ** -0.5


def load_parameter_at(x: Any) -> Any:
    """The load parameter of a coordinate of :func:`width_coordinate`."""
    return (x**-2.0 - NEAT) / math.pi


class TableAxis(NamedTuple):
    """An axis of a table.

    Attributes
    ----------
    name : str
        A key of :data:`COORDINATES`.
    least, most : float
        First and last coordinate.
    nodes, regions : int
        Numbers of nodes, and of regions that limit the error bounds in them by the largest error seen there.
    """

    name: str
    least: float
    most: float
    nodes: int
    regions: int = 1

    def coordinates(self) -> np.ndarray:
        """The coordinates of the nodes, shape (nodes,)."""
        return np.linspace(self.least, self.most, self.nodes)


@functools.cache
def parameter_range(axis: TableAxis) -> tuple[str, float, float]:
    """The parameter of an axis, its least and its largest value; of the load ratio in parts of the friction.

    The "plate term" has no such range: that of beta depends on other parameters.
    """
    least, most = axis.least, axis.most
    if axis.name == "width":
        low, high = (float(f"{load_parameter_at(x):.9g}") for x in (most, least))
        return "load_parameter", low if low > ROUNDING else 0.0, high
    if axis.name == "root of friction":
        return "friction", least**2, float(f"{most**2:.12g}")
    if axis.name == "pin term":
        return "kolosov", 1.0 / most - 1.0, 1.0 / least - 1.0
    return {"part of sliding": "load_ratio"}.get(axis.name, axis.name), least, most


def pin_term(given: Mapping[str, Any]) -> Any:
    """1/(kappa + 1) of the pin, from parameters that are numbers or arrays."""
    return 1.0 / (given["kolosov"] + 1.0)


def plate_beta(alpha: Any, pin: Any, plate: Any) -> Any:
    """Dundurs' beta from alpha and 1/(kappa + 1) of both bodies, by (T22)."""
    return alpha - (1.0 + alpha) * plate + (1.0 - alpha) * pin


COORDINATES: dict[str, Callable[[Mapping[str, Any]], Any]] = {
    "width": lambda given: width_coordinate(given["load_parameter"]),
    "root of friction": lambda given: given["friction"] ** 0.5,
    "friction": lambda given: given["friction"],
    "alpha": lambda given: given["alpha"],
    "pin term": pin_term,
    "plate term": lambda given: (
        (given["alpha"] - given["beta"] + (1.0 - given["alpha"]) * pin_term(given)) / (1.0 + given["alpha"])
    ),
    "part of sliding": lambda given: given["load_ratio"] / given["friction"],
}
"""The coordinate along each axis, from the parameters."""


class ChartGroup(NamedTuple):
    """A table of charts with the same axes.

    Attributes
    ----------
    name : str
    axes : tuple of TableAxis
    quantities : tuple of str
    fixed : mapping
        Parameters that have one value in the table.
    words : str
        What the table is of.
    """

    name: str
    axes: tuple[TableAxis, ...]
    quantities: tuple[str, ...]
    fixed: Mapping[str, str]
    words: str

    @property
    def is_cycle(self) -> bool:
        """Whether the values belong to a load cycle."""
        return "rotation" in self.fixed

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of nodes along the axes."""
        return tuple(axis.nodes for axis in self.axes)

    @property
    def regions(self) -> tuple[int, ...]:
        """Numbers of regions along the axes."""
        return tuple(axis.regions for axis in self.axes)

    def parameters_at(self, place: np.ndarray) -> dict[str, Any]:
        """The parameters at the coordinates `place`, shape (axes,)."""
        at = {axis.name: float(value) for axis, value in zip(self.axes, place, strict=True)}
        found: dict[str, Any] = {"alpha": 0.0, "beta": 0.0, **self.fixed}
        found["load_parameter"] = max(load_parameter_at(at["width"]), 0.0)
        found["friction"] = at["friction"] if self.is_cycle else at["root of friction"] ** 2
        if self.is_cycle:
            found["load_ratio"] = at["part of sliding"] * found["friction"]
        found["kolosov"] = 1.0 / at["pin term"] - 1.0
        if "alpha" in at:
            found["alpha"], found["beta"] = at["alpha"], plate_beta(at["alpha"], at["pin term"], at["plate term"])
        return found


WIDTHS = width_coordinate(100.0), width_coordinate(0.0)
"""Coordinates of the load parameters 100 and 0."""


CYCLE_WIDTHS = width_coordinate(3.0), width_coordinate(0.02)
"""Coordinates of the load parameters 3 and 0.02."""


def _first_load_groups() -> list[ChartGroup]:
    like = (
        TableAxis("width", *WIDTHS, 41, 10),
        TableAxis("root of friction", 0.0, 1.0, 33, 8),
        TableAxis("pin term", 0.25, 0.5, 3),
    )
    unlike = (
        TableAxis("width", width_coordinate(10.0), WIDTHS[1], 19, 9),
        TableAxis("root of friction", 0.0, 0.6**0.5, 13, 8),
        TableAxis("alpha", -0.6, 0.75, 6, 3),
        TableAxis("plate term", *METALS, 3),
        TableAxis("pin term", *METALS, 3),
    )
    axes, loads = {"like": like, "unlike": unlike}, {"body": "body load", "centre": "load at the centre"}
    return [
        ChartGroup(f"{name}_{load}", axes[name], FIRST_LOAD, {"pin_load": load}, f"{name} bodies, {words}")
        for name in axes
        for load, words in loads.items()
    ]


def _cycle_groups() -> list[ChartGroup]:
    like = (
        TableAxis("width", *CYCLE_WIDTHS, 12, 6),
        TableAxis("friction", 0.1, 0.8, 9, 5),
        TableAxis("pin term", 0.25, 0.5, 3),
        TableAxis("part of sliding", 0.2, 1.0, 10, 4),
    )
    unlike = (
        TableAxis("width", *CYCLE_WIDTHS, 12, 9),
        TableAxis("friction", 0.1, 0.6, 6, 5),
        TableAxis("alpha", -0.6, 0.75, 5, 3),
        TableAxis("plate term", *METALS, 3),
        TableAxis("pin term", *METALS, 3),
        TableAxis("part of sliding", 0.2, 1.0, 5, 6),
    )
    # a free pin has small values with wide scatter, so more points of calibration stand behind each of its bounds
    free_unlike = tuple(axis._replace(regions=count) for axis, count in zip(unlike, (7, 4, 3, 1, 1, 4), strict=True))
    held = {"rotation": "fixed", "pin_load": "centre"}
    centre, body = ({"rotation": "free", "pin_load": load} for load in ("centre", "body"))
    free = "cycle of Q, free rotation"
    # New groups stand at the end: the seed of the random places of a group has its number.
    return [
        ChartGroup("held", like, CYCLE, held, "like bodies, cycle of Q, held rotation"),
        ChartGroup("free_centre", like, CYCLE, centre, f"like bodies, {free}, load at the centre"),
        ChartGroup("unlike_held", unlike, CYCLE, held, "unlike bodies, cycle of Q, held rotation"),
        ChartGroup("free_body", like, CYCLE, body, f"like bodies, {free}, body load"),
        ChartGroup("unlike_free_centre", free_unlike, CYCLE, centre, f"unlike bodies, {free}, load at the centre"),
        ChartGroup("unlike_free_body", free_unlike, CYCLE, body, f"unlike bodies, {free}, body load"),
    ]


GROUPS = {group.name: group for group in (*_first_load_groups(), *_cycle_groups())}
"""All groups by name."""


class Stored(NamedTuple):
    """How a quantity is stored: smoother than it is.

    Attributes
    ----------
    stored, value : callable
        ``stored(value, load_parameter)`` is interpolated, and ``value(stored, load_parameter)`` is its inverse.
    is_relative : bool
        Whether the error bound counts in parts of the value.
    """

    stored: Callable[[Any, Any], Any]
    value: Callable[[Any, Any], Any]
    is_relative: bool


def _pressure_scale(load_parameter: Any) -> Any:
    """The largest pressure over the bearing stress, to some 10 %: the formula of a spreadsheet without corrections."""
    return (1.438 + 16.0 / math.pi * load_parameter) ** 0.5


_PRESSURE = Stored(lambda v, at: v / _pressure_scale(at), lambda s, at: s * _pressure_scale(at), True)
_WIDTH = Stored(lambda v, at: v / width_coordinate(at), lambda s, at: s * width_coordinate(at), True)
_STICK = _WIDTH._replace(is_relative=False)
_PLAIN = Stored(lambda v, at: v, lambda s, at: s, False)

STORED = {
    "peak_pressure": _PRESSURE,
    "peak_pressure_angle": _PLAIN,
    "contact_angle": _WIDTH,
    "stick_angle": _STICK,
    "kt_bearing": _PLAIN._replace(is_relative=True),
    "peak_hoop_angle": _PLAIN,
    "cycle_energy": Stored(lambda v, at: np.cbrt(np.maximum(v, 0.0)), lambda s, at: s * s * s, False),
    "cycle_slip_range": Stored(lambda v, at: np.sqrt(np.maximum(v, 0.0)), lambda s, at: s * s, False),
    "cycle_stick_angle": _STICK,
    "cycle_peak_pressure": _PRESSURE,
    "cycle_kt_bearing": _PLAIN._replace(is_relative=True),
}
"""How each quantity is stored."""


class ChartTable:
    """The charts of a group.

    Parameters
    ----------
    group : ChartGroup
    values : ndarray, shape (*group.shape, quantities)
        What :data:`STORED` makes of the values at the nodes.
    orders : sequence of int
        Nodes that the interpolation of each quantity takes along an axis of many nodes: 2 or 4.
    bounds : ndarray, shape (nodes - 1 of each axis, quantities)
        Error bounds of the cells between the nodes, in parts of the value or in its unit.
    """

    def __init__(self, group: ChartGroup, values: np.ndarray, orders: Sequence[int], bounds: np.ndarray) -> None:
        self.group, self.bounds = group, bounds
        self.values = {name: np.ascontiguousarray(values[..., k], float) for k, name in enumerate(group.quantities)}
        self.orders = dict(zip(group.quantities, map(int, orders), strict=True))
        self._bounds = {name: np.ascontiguousarray(bounds[..., k]) for k, name in enumerate(group.quantities)}

    def stored_at(self, quantity: str, units: Sequence[Any]) -> Any:
        """The interpolated table at places in units of the axes, 0 to 1: floats, or arrays of one shape."""
        values, order = self.values[quantity], self.orders[quantity]
        found = [_stencil(unit, nodes, order) for unit, nodes in zip(units, self.group.shape, strict=True)]
        if isinstance(units[0], float):
            values = values[tuple(slice(first, first + len(weights)) for first, weights in found)]
            for _, weights in found:
                values = np.array(weights).dot(values.reshape(len(weights), -1))
            return float(values[0])
        firsts = np.ravel_multi_index([first.ravel() for first, _ in found], values.shape)
        beside = np.ravel_multi_index(np.indices([len(weights) for _, weights in found]), values.shape).ravel()
        total = np.empty(firsts.size)
        for begin in range(0, total.size, 256):  # the nodes around so many places fit into the cache
            part = slice(begin, begin + 256)
            around = values.ravel().take(firsts[part, None] + beside)
            for _, weights in found:
                factors = np.stack([weight.ravel()[part] for weight in weights], axis=1)[:, None]
                around = (factors @ around.reshape(len(factors), len(weights), -1))[:, 0]
            total[part] = around[:, 0]
        return total.reshape(units[0].shape)

    def value_at(self, quantity: str, units: Sequence[Any], load_parameter: Any) -> tuple[Any, Any]:
        """The value and its error bound, in the unit of the value, at places as for :meth:`stored_at`."""
        value = STORED[quantity].value(self.stored_at(quantity, units), load_parameter)
        bound = self._bounds[quantity][self.cell(units)]
        if isinstance(value, float):
            value, bound = max(value, 0.0), float(bound)
        else:
            value = np.maximum(value, 0.0)  # a cubic beside a kink may pass below 0
        return value, bound * abs(value) if STORED[quantity].is_relative else bound

    def cell(self, units: Sequence[Any]) -> tuple[Any, ...]:
        """The indices of the cell at places in units of the axes."""
        found = zip(units, self.group.shape, strict=True)
        if isinstance(units[0], float):
            return tuple(min(int(unit * (nodes - 1)), nodes - 2) for unit, nodes in found)
        return tuple(np.minimum((unit * (nodes - 1)).astype(int), nodes - 2) for unit, nodes in found)


def _stencil(unit: Any, nodes: int, order: int) -> tuple[Any, Sequence[Any]]:
    """The first node and the Lagrange weights of the nodes around a place, in units of the axis."""
    size = nodes if nodes <= FEW else order
    if isinstance(unit, float):
        first: Any = min(max(int(unit * (nodes - 1)) - size // 2 + 1, 0), nodes - size)
    else:
        first = np.clip((unit * (nodes - 1)).astype(int) - size // 2 + 1, 0, nodes - size)
    at = unit * (nodes - 1) - first
    if size == 2:
        return first, (1.0 - at, at)
    if size == 3:
        return first, ((at - 1.0) * (at - 2.0) / 2.0, -at * (at - 2.0), at * (at - 1.0) / 2.0)
    a, b, c, d = at, at - 1.0, at - 2.0, at - 3.0
    return first, (-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0)


@functools.cache
def tables() -> dict[str, ChartTable]:
    """The tables of the package by the names of their groups.

    Raises
    ------
    InputError
        If the file of the package is damaged, or has another version.
    """
    return read_tables(DATA)


def read_tables(path: Path) -> dict[str, ChartTable]:
    """Read tables from a file of :func:`write_tables`. Reading runs no code of the file.

    Raises
    ------
    InputError
        If the file is damaged, or has another version.
    """
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            content = {name: file[name] for name in file.files}
        if int(content["version"]) != VERSION:
            raise InputError("charts", f"the data has the version {int(content['version'])}, not {VERSION}: {path}")
        found = {}
        for name, group in GROUPS.items():
            values, orders, bounds = (content[f"{name}_{part}"] for part in ("values", "orders", "bounds"))
            cells = tuple(nodes - 1 for nodes in group.shape)
            shapes = [(*group.shape, len(group.quantities)), (*cells, len(group.quantities))]
            if [values.shape, bounds.shape] != shapes:
                raise ValueError(name)
            found[name] = ChartTable(group, values, orders.tolist(), bounds.astype(float))
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, zipfile.BadZipFile) as error:
        raise InputError("charts", f"the file of the charts is damaged, install fastpin again: {path}") from error
    return found


def write_tables(path: Path, found: dict[str, ChartTable]) -> None:
    """Write tables as a compressed NumPy file without pickles, in single precision."""
    content: dict[str, Any] = {"version": np.array(VERSION)}
    for name, table in found.items():
        content[f"{name}_values"] = np.stack([*table.values.values()], axis=-1).astype(np.float32)
        content[f"{name}_orders"] = np.array([*table.orders.values()], dtype=np.int8)
        content[f"{name}_bounds"] = table.bounds.astype(np.float32)
    np.savez_compressed(path, **content)

"""The tables of the charts: values at nodes, interpolation between them, and an error bound in each cell."""

from __future__ import annotations

import functools
import math
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fastpin.charts.groups import GROUPS, ChartGroup, width_coordinate
from fastpin.errors import InputError

DATA = Path(__file__).parent / "charts.npz"
"""The data of the package."""

VERSION = 4
"""Version of the data: of the axes, the quantities and their scales."""

FEW = 4
"""Numbers of nodes of an axis up to which one polynomial goes through all nodes."""


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

"""Curves of the figures of the paper, and their CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from fastpin.kernels.status import OPEN
from fastpin.states.state import State
from fastpin.storage.files import replacing

Report = Callable[[float], None]
"""A callable that receives the computed fraction of a figure, 0 to 1."""

Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure.

    Attributes
    ----------
    parameters : dict
        The values that differ between the curves of a figure: L_p, mu, the pair, the load.
    columns : dict of ndarray
        The numbers, all of one length, by a name with its unit. NaN breaks the curve.
    """

    parameters: dict[str, Any]
    columns: dict[str, np.ndarray] = field(repr=False)

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]


def write_csv(curves: Sequence[Curve], path: Path, remarks: Sequence[str] = ()) -> None:
    """Write curves as CSV, one below the other. Each line has the curve's parameters, then a row of its columns.

    NaN is an empty cell. A comma in a text becomes a semicolon, for programs that do not know quotes. `remarks` become
    lines that begin with #.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    names = list(dict.fromkeys(name for curve in curves for name in (*curve.parameters, *curve.columns)))
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {remark}\n" for remark in remarks)
        writer = csv.DictWriter(file, names, restval="", lineterminator="\n")
        writer.writeheader()
        for curve in curves:
            parameters = {name: _parameter(value) for name, value in curve.parameters.items()}
            rows = zip(*curve.columns.values(), strict=True)
            for row in rows:
                writer.writerow({**parameters, **dict(zip(curve.columns, map(_cell, row), strict=True))})


def _parameter(value: float | str) -> float | str:
    if isinstance(value, str):
        return value.replace(",", ";")
    return "" if math.isnan(value) else value


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.9g}"


def steps(items: Sequence[Item], progress: Report | None) -> Iterator[Item]:
    """Yield the items, and report the fraction that is done after each of them."""
    for index, item in enumerate(items):
        yield item
        if progress is not None:
            progress((index + 1) / len(items))


def traction_curve(state: State, force: float = 1.0, **parameters: float | str) -> Curve:
    """Return pressure and shear traction of a state from edge to edge, with zeros at the edges read between nodes.

    Parameters
    ----------
    state : State
        Of a dimensionless problem, :meth:`fastpin.Problem.from_load_parameter`.
    force : float
        The pin's load F in the units of the problem. Tractions are divided by it.
    parameters
        The curve's parameters.

    Returns
    -------
    Curve
        Columns ``angle_deg`` (from the bottom, counter-clockwise), ``N`` and ``T`` in F/R. Several contacts are
        separated by NaN.
    """
    parts: list[np.ndarray] = []
    for start, stop in state.contact:
        along = np.mod(state.theta - start, 2.0 * math.pi)
        inside = np.flatnonzero((state.status != OPEN) & (along < stop - start))
        inside = inside[np.argsort(along[inside])]
        part = np.array([start + along, state.pressure / force, state.shear / force])[:, inside]
        if stop - start < 2.0 * math.pi:  # else there are no edges
            part = np.hstack([[[start], [0.0], [0.0]], part, [[stop], [0.0], [0.0]]])
        parts += [np.full((3, 1), np.nan), part] if parts else [part]
    angle, pressure, shear = np.hstack(parts) if parts else np.empty((3, 0))
    return Curve(dict(parameters), {"angle_deg": np.degrees(angle) + 90.0, "N": pressure, "T": shear})

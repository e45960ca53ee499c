"""The figures of the paper and those that go beyond it: found, computed, written.

Each figure is a script of its own in ``scripts/figures`` (installed as ``fastpin.figures``) with

* ``TITLE``, what the figure shows, and ``LEAST_NODES``, the fewest nodes with which it shows it;
* ``compute(nodes, progress)``, which solves and returns curves;
* ``draw(curves)``, which draws them.
"""

from __future__ import annotations

import csv
import importlib
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, cast

import numpy as np

from fastpin import __version__
from fastpin.checks import whole_number
from fastpin.errors import InputError
from fastpin.files import check_writable, replacing
from fastpin.state import OPEN, State

if TYPE_CHECKING:
    from fastpin.plot import Figure

PAPER = tuple(str(number) for number in range(3, 18))
"""Names of the figures of the paper (1 and 2 are sketches)."""

BEYOND = ("memory", "sliding-onset", "half-plane", "rigid-pin")
"""Names of the figures that the paper does not have."""

NODES = 400

UNITS = "N (pressure) and T (shear on the pin) in F/R; angles from the bottom and T counter-clockwise positive"

Report = Callable[[float], None]
"""Called with the fraction of a figure that is computed."""

Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure.

    Attributes
    ----------
    parameters : dict
        What tells this curve from the others of its figure: L_p, mu, the pair, the load.
    columns : dict of ndarray, all of one length
        The numbers, by a name with its unit. NaN breaks the curve.
    """

    parameters: dict[str, Any]
    columns: dict[str, np.ndarray] = field(repr=False)

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]


class Script(Protocol):
    """What a script in ``scripts/figures`` offers."""

    TITLE: str
    LEAST_NODES: int

    def compute(self, nodes: int, progress: Report | None = None) -> list[Curve]: ...

    def draw(self, curves: Sequence[Curve]) -> Figure: ...


def known(name: str | int) -> str:
    """The name of a figure as it stands in :data:`PAPER` or :data:`BEYOND`.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    text = str(name).strip().lower()
    if text.lstrip("0") in PAPER:
        return text.lstrip("0")
    if text not in BEYOND:
        beyond = ", ".join(BEYOND)
        raise InputError(
            "figure", f"there is no {text!r}; there are {PAPER[0]} to {PAPER[-1]} of the paper, and {beyond}"
        )
    return text


def stem(name: str | int) -> str:
    """The first part of the names of a figure's files: ``figure03``, ``half-plane``."""
    text = known(name)
    return f"figure{int(text):02d}" if text in PAPER else text


def script(name: str | int) -> Script:
    """The script of a figure, a number from 3 to 17 or one of :data:`BEYOND`.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    module = stem(name).replace("-", "_")
    try:
        return cast(Script, importlib.import_module(f"fastpin.figures.{module}"))
    except ModuleNotFoundError as error:
        if error.name != "fastpin.figures":
            raise
        raise InputError("figure", "the scripts of the figures are not installed; install fastpin with pip") from None


def check(names: Iterable[str | int], directory: str | Path, nodes: int) -> None:
    """Find out before the work whether all figures can be made; make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such figure, `nodes` are too few for what one of them shows, or its files can't be written.
    """
    scripts = {known(name): script(name) for name in names}
    for name, needed in scripts.items():
        if whole_number("nodes", nodes, -sys.maxsize) < needed.LEAST_NODES:
            raise InputError("nodes", f"figure {name} needs at least {needed.LEAST_NODES} nodes, not {nodes}")
    folder = Path(directory)
    if folder.exists() and not folder.is_dir():
        raise InputError("output", f"{folder} is a file, not a directory")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("output", f"can't make the directory {folder}: {error.strerror}") from None
    for name in scripts:
        for file in _files(name, folder):
            check_writable(file)


def _files(name: str | int, directory: str | Path) -> tuple[Path, Path]:
    return Path(directory) / f"{stem(name)}.png", Path(directory) / f"{stem(name)}.csv"


def make(
    name: str | int, directory: str | Path = ".", nodes: int = NODES, progress: Report | None = None
) -> tuple[Path, Path]:
    """Compute a figure and write it as PNG and its numbers as CSV; the paths of both.

    Raises
    ------
    InputError
        As :func:`check`.
    """
    from fastpin.plot import draw_with

    check([name], directory, nodes)
    chosen = script(name)
    curves = chosen.compute(nodes, progress)
    picture, numbers = _files(name, directory)
    write_csv(curves, numbers, (chosen.TITLE, f"fastpin {__version__}, {nodes} nodes", UNITS))
    draw_with(chosen.draw, curves, picture)
    return picture, numbers


def write_csv(curves: Sequence[Curve], path: Path, remarks: Sequence[str] = ()) -> None:
    """Write curves one below the other: their parameters repeated, then their columns.

    NaN is an empty cell, and a comma in a text becomes a semicolon, for readers that do not know quotes.
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
    """The items one after the other, reporting the fraction that is done."""
    for index, item in enumerate(items):
        yield item
        if progress is not None:
            progress((index + 1) / len(items))


def traction_curve(state: State, force: float = 1.0, **parameters: float | str) -> Curve:
    """Pressure and shear traction of a state from edge to edge, with zeros at the edges read between nodes.

    Parameters
    ----------
    state : State
        Of a dimensionless problem, :meth:`fastpin.Problem.from_load_parameter`.
    force : float
        What the tractions are divided by: the pin's load F in the units of the problem.
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

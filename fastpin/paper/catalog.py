"""The figures of the paper and others: find them, compute them, write them.

Each figure is a file of this folder with

* ``TITLE``, a description, and ``LEAST_NODES``, the fewest nodes that resolve the subject of the figure;
* ``compute(nodes, progress)``, which solves and returns curves;
* ``draw(curves)``, which draws them.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Protocol, cast

from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures.style import save_drawing
from fastpin.model.checks import choice, whole_number
from fastpin.model.grid import LEAST_NODES, MAX_NODES
from fastpin.paper.curves import Report
from fastpin.report.curves import Curve, write_csv
from fastpin.storage.files import check_writable
from fastpin.version import __version__

PAPER = tuple(str(number) for number in range(3, 18))
"""Names of the figures of the paper (1 and 2 are sketches)."""

BEYOND = (
    "memory", "sliding-onset", "half-plane", "rigid-pin", "rings", "supports", "hollow-pins", "rectangular-lug",
    "interference", "regimes",
)  # fmt: skip
"""Names of the figures that the paper does not have."""

NODES = 400
"""Number of nodes unless another one is chosen."""

FORMATS = ("png", "pdf", "svg")
"""Formats of a figure, by the ends of the names of files."""

DPI = 300.0
"""Dots per inch of a bitmap."""

UNITS = "N (pressure) and T (shear on the pin) in F/R; angles from the bottom and T counter-clockwise positive"
"""Units and signs of all columns, for the head of the CSV files."""


class Script(Protocol):
    """A figure's file: it computes curves and draws them."""

    TITLE: str
    LEAST_NODES: int

    def compute(self, nodes: int, progress: Report | None = None) -> list[Curve]:
        """Solve, and return the curves of the figure."""
        ...

    def draw(self, curves: Sequence[Curve]) -> Figure:
        """Draw the curves of :meth:`compute`."""
        ...


def figure_name(name: str | int) -> str:
    """Return the name of a figure as in :data:`PAPER` or :data:`BEYOND`, from a number, "03" or any letter case.

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
    """Return the first part of the names of a figure's files: ``figure03``, ``half-plane``.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    text = figure_name(name)
    return f"figure{int(text):02d}" if text in PAPER else text


def script(name: str | int) -> Script:
    """Return the script of a figure: a number from 3 to 17, or a name of :data:`BEYOND`.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    return cast(Script, importlib.import_module(f"fastpin.paper.{stem(name).replace('-', '_')}"))


def check(names: Iterable[str | int], directory: str | Path, nodes: int, formats: Sequence[str] = FORMATS[:1]) -> None:
    """Check before the work that all figures can be made, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such figure, a figure needs more than `nodes` nodes, a format is unknown, or the files can't be
        written.
    """
    scripts = {figure_name(name): script(name) for name in names}
    for name, needed in scripts.items():
        if whole_number("nodes", nodes, LEAST_NODES, MAX_NODES) < needed.LEAST_NODES:
            raise InputError("nodes", f"figure {name} needs at least {needed.LEAST_NODES} nodes, not {nodes}")
    check_files(map(stem, scripts), directory, formats)


def check_files(stems: Iterable[str], directory: str | Path, formats: Sequence[str]) -> None:
    """Check that the files of figures can be written, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If a format is unknown, or the files can't be written.
    """
    for kind in formats:
        choice("format", kind, FORMATS)
    folder = Path(directory)
    if folder.exists() and not folder.is_dir():
        raise InputError("output", f"{folder} is a file, not a directory")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("output", f"can't make the directory {folder}: {error.strerror}") from None
    for name in stems:
        for file in _files(name, folder, formats):
            check_writable(file)


def _files(name: str, directory: str | Path, formats: Sequence[str]) -> list[Path]:
    """Return the pictures of a figure, and the file of its numbers, which is the last."""
    return [Path(directory) / f"{name}.{kind}" for kind in (*formats, "csv")]


def make(
    name: str | int,
    directory: str | Path = ".",
    nodes: int = NODES,
    progress: Report | None = None,
    formats: Sequence[str] = FORMATS[:1],
) -> list[Path]:
    """Compute a figure, and write it in each of the `formats`, and its numbers as CSV.

    Return the paths of the pictures, then the path of the numbers.

    Raises
    ------
    InputError
        See :func:`check`.
    """
    check([name], directory, nodes, formats)
    chosen = script(name)
    curves = chosen.compute(nodes, progress)
    remarks = (chosen.TITLE, f"fastpin {__version__}, --nodes {nodes}", UNITS)
    return write(curves, chosen.draw, stem(name), directory, remarks, formats)


def write(
    curves: Sequence[Curve],
    draw: Callable[[Sequence[Curve]], Figure],
    name: str,
    directory: str | Path,
    remarks: Sequence[str],
    formats: Sequence[str],
) -> list[Path]:
    """Write the curves of a figure as CSV with `remarks`, and the figure in each of the `formats`.

    `name` is the first part of the names of the files. Return the paths of the pictures, then the path of the numbers.
    """
    files = _files(name, directory, formats)
    write_csv(curves, files[-1], remarks)
    for picture in files[:-1]:
        save_drawing(draw, curves, picture, DPI)
    return files

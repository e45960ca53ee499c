"""The figures of the paper, one of half-planes, and the benchmarks: find them, compute them, write their files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from fastpin.assess.outputs import write_csv
from fastpin.errors import InputError
from fastpin.model.checks import choice, whole_number
from fastpin.model.grid import LEAST_NODES, MAX_NODES
from fastpin.published import (
    fretting,
    half_plane,
    handbook_formulas,
    klang,
    loaded_pins,
    monotonic,
    remote_stress,
    sweep,
    textbooks,
)
from fastpin.published.records import Benchmark, Outcome, PaperFigure, Report, row_curves, save_drawing
from fastpin.storage.files import check_writable
from fastpin.version import __version__

FIGURES: dict[str, PaperFigure] = {
    figure.name: figure
    for subject in (monotonic, sweep, fretting, half_plane, remote_stress)
    for figure in subject.FIGURES
}
"""All figures by name. Each file of a subject has its figures in ``FIGURES``."""

PAPER = tuple(sorted((name for name in FIGURES if name.isdecimal()), key=int))
"""Names of the figures of the paper (1 and 2 are sketches)."""

NODES = 400
"""Number of nodes unless another one is chosen."""

BENCHMARKS: dict[str, Benchmark] = {
    benchmark.name: benchmark
    for benchmark in (
        klang.BENCHMARK,
        handbook_formulas.BENCHMARK,
        loaded_pins.BENCHMARK,
        *textbooks.BENCHMARKS,
    )
}
"""All benchmarks by name."""

FORMATS = ("png", "pdf", "svg")
"""Formats of a picture, by the ends of the names of files."""


def figure_name(name: str | int) -> str:
    """Return the name of a figure as in :data:`FIGURES`, from a number, "03" or any letter case.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    text = str(name).strip().lower()
    known = text.lstrip("0") if text.lstrip("0") in PAPER else text
    if known not in FIGURES:
        raise InputError(
            "figure", f"there is no {text!r}; there are {PAPER[0]} to {PAPER[-1]} of the paper, and half-plane"
        )
    return known


def figure(name: str | int) -> PaperFigure:
    """Return a figure: a number from 3 to 17, or half-plane.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    return FIGURES[figure_name(name)]


def stem(name: str | int) -> str:
    """Return the first part of the names of a figure's files: ``figure03``, ``half-plane``.

    Raises
    ------
    InputError
        If there is no such figure.
    """
    text = figure_name(name)
    return f"figure{int(text):02d}" if text in PAPER else text


def check(names: Iterable[str | int], directory: str | Path, nodes: int, formats: Sequence[str] = FORMATS[:1]) -> None:
    """Check before the work that all figures can be made, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such figure, a figure needs more than `nodes` nodes, a format is unknown, or the files can't be
        written.
    """
    chosen = dict.fromkeys(map(figure_name, names))
    for name in chosen:
        least = FIGURES[name].least_nodes
        if whole_number("nodes", nodes, LEAST_NODES, MAX_NODES) < least:
            raise InputError("nodes", f"figure {name} needs at least {least} nodes, not {nodes}")
    for kind in formats:
        choice("format", kind, FORMATS)
    check_files([f"{stem(name)}.{kind}" for name in chosen for kind in (*formats, "csv")], directory)


def check_files(names: Iterable[str], directory: str | Path) -> None:
    """Check that files can be written in `directory`, and make it if it is missing.

    Raises
    ------
    InputError
        If a file can't be written.
    """
    folder = Path(directory)
    if folder.exists() and not folder.is_dir():
        raise InputError("output", f"{folder} is a file, not a directory")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("output", f"can't make the directory {folder}: {error.strerror}") from None
    for name in names:
        check_writable(folder / name)


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
    chosen = figure(name)
    curves = chosen.compute(nodes, progress)
    *pictures, numbers = files = [Path(directory) / f"{stem(name)}.{kind}" for kind in (*formats, "csv")]
    units = "N (pressure) and T (shear on the pin) in F/R; angles from the bottom and T counter-clockwise positive"
    write_csv(curves, numbers, (chosen.title, f"fastpin {__version__}, --nodes {nodes}", units))
    for picture in pictures:
        save_drawing(chosen.draw, curves, picture, dpi=300.0)
    return files


def benchmark_name(name: str) -> str:
    """Return the name of a benchmark as in :data:`BENCHMARKS`, from any letter case.

    Raises
    ------
    InputError
        If there is no such benchmark.
    """
    text = str(name).strip().lower()
    if text not in BENCHMARKS:
        raise InputError("benchmark", f"there is no {text!r}; there are {', '.join(BENCHMARKS)}")
    return text


def write_benchmark(name: str, outcome: Outcome, directory: str | Path) -> Path:
    """Write the rows of a benchmark to ``NAME.csv``, and return its path."""
    path = Path(directory) / f"{name}.csv"
    write_csv(row_curves(outcome.rows), path, (BENCHMARKS[name].title, f"fastpin {__version__}"))
    return path

"""The figures of the paper, one of half-planes, and the benchmarks: find them, compute them, write their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve, write_csv
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
        *loaded_pins.BENCHMARKS,
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
    _check_files(map(stem, chosen), directory, formats)


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
    units = "N (pressure) and T (shear on the pin) in F/R; angles from the bottom and T counter-clockwise positive"
    remarks = (chosen.title, f"fastpin {__version__}, --nodes {nodes}", units)
    return _write_files(chosen.compute(nodes, progress), chosen.draw, stem(name), directory, remarks, formats)


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


def check_benchmarks(names: Iterable[str], directory: str | Path, formats: Sequence[str] = FORMATS[:1]) -> None:
    """Check before the work that the files of all benchmarks can be written, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such benchmark, a format is unknown, or the files can't be written.
    """
    known = [benchmark_name(name) for name in names]
    _check_files([*known, *map(_curves_stem, known)], directory, formats)


def write_benchmark(
    name: str, outcome: Outcome, directory: str | Path, formats: Sequence[str] = FORMATS[:1]
) -> list[Path]:
    """Write the numbers of a benchmark as CSV, and its figure, if it has one, in each of the `formats`.

    The rows stand in ``NAME.csv``, and the curves of a figure in ``NAME-curves.csv``. Return the paths.
    """
    chosen = BENCHMARKS[benchmark_name(name)]
    remarks = (chosen.title, f"fastpin {__version__}")
    rows = Path(directory) / f"{chosen.name}.csv"
    write_csv(row_curves(outcome.rows), rows, remarks)
    if chosen.draw is None:
        return [rows]
    return [rows, *_write_files(outcome.curves, chosen.draw, _curves_stem(chosen.name), directory, remarks, formats)]


def _curves_stem(name: str) -> str:
    """Return the first part of the names of a benchmark's figure and its numbers."""
    return f"{name}-curves"


def _check_files(stems: Iterable[str], directory: str | Path, formats: Sequence[str]) -> None:
    """Check that the files of figures can be written, and make `directory` if it is missing.

    `stems` are the first parts of the names of the files.

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
    for stem in stems:
        for file in _files(stem, folder, formats):
            check_writable(file)


def _write_files(
    curves: Sequence[Curve],
    draw: Callable[[Sequence[Curve]], Figure],
    stem: str,
    directory: str | Path,
    remarks: Sequence[str],
    formats: Sequence[str],
) -> list[Path]:
    """Write the curves of a figure as CSV with `remarks`, and the figure in each of the `formats`.

    `stem` is the first part of the names of the files. Return the paths of the pictures, then the path of the numbers.
    """
    *pictures, numbers = files = _files(stem, directory, formats)
    write_csv(curves, numbers, remarks)
    for picture in pictures:
        save_drawing(draw, curves, picture, dpi=300.0)
    return files


def _files(stem: str, directory: str | Path, formats: Sequence[str]) -> list[Path]:
    """Return the pictures of a figure, then the file of its numbers."""
    return [Path(directory) / f"{stem}.{kind}" for kind in (*formats, "csv")]

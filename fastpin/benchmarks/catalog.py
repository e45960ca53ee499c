"""The benchmarks: find them, compute them, write their files.

Each benchmark is a file of this folder with

* ``TITLE``, ``STATEMENT`` (geometry, materials, loads) and ``SOURCES``, words;
* ``compute(progress)``, which solves and returns an :class:`fastpin.benchmarks.rows.Outcome`;
* ``draw(curves)``, if it has a figure.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Protocol, cast

from matplotlib.figure import Figure

from fastpin.benchmarks.rows import Outcome
from fastpin.benchmarks.text import row_curves
from fastpin.errors import InputError
from fastpin.paper.curves import Report
from fastpin.paper.files import FORMATS, check_files, write_files
from fastpin.report.curves import Curve, write_csv
from fastpin.version import __version__

NAMES = (
    "klang", "handbook-formulas", "nasa-tp-1862", "nafems-loaded-pin", "fretting-half-plane", "brazilian-disk",
    "kirsch", "shrink-fit",
)  # fmt: skip
"""Names of the benchmarks."""


class Benchmark(Protocol):
    """A benchmark's file."""

    TITLE: str
    STATEMENT: str
    SOURCES: Sequence[str]

    def compute(self, progress: Report | None = None) -> Outcome:
        """Solve, and return the numbers side by side."""
        ...

    def draw(self, curves: Sequence[Curve]) -> Figure:
        """Draw the curves of :meth:`compute`; only of benchmarks with curves."""
        ...


def benchmark_name(name: str) -> str:
    """Return the name of a benchmark as in :data:`NAMES`, from any letter case.

    Raises
    ------
    InputError
        If there is no such benchmark.
    """
    text = str(name).strip().lower()
    if text not in NAMES:
        raise InputError("benchmark", f"there is no {text!r}; there are {', '.join(NAMES)}")
    return text


def benchmark(name: str) -> Benchmark:
    """Return the file of a benchmark.

    Raises
    ------
    InputError
        If there is no such benchmark.
    """
    module = benchmark_name(name).replace("-", "_")
    return cast(Benchmark, importlib.import_module(f"fastpin.benchmarks.{module}"))


def check(names: Iterable[str], directory: str | Path, formats: Sequence[str] = FORMATS[:1]) -> None:
    """Check before the work that the files of all benchmarks can be written, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such benchmark, a format is unknown, or the files can't be written.
    """
    known = [benchmark_name(name) for name in names]
    check_files([*known, *map(curves_stem, known)], directory, formats)


def curves_stem(name: str) -> str:
    """Return the first part of the names of a benchmark's figure and its numbers."""
    return f"{name}-curves"


def titles() -> Iterator[tuple[str, str]]:
    """Yield the name and the title of each benchmark."""
    for name in NAMES:
        yield name, benchmark(name).TITLE


def write(name: str, outcome: Outcome, directory: str | Path, formats: Sequence[str] = FORMATS[:1]) -> list[Path]:
    """Write the numbers of a benchmark as CSV, and its figure, if it has one, in each of the `formats`.

    The rows stand in ``NAME.csv``, and the curves of a figure in ``NAME-curves.csv``. Return the paths.
    """
    chosen = benchmark(name)
    remarks = (chosen.TITLE, f"fastpin {__version__}")
    rows = Path(directory) / f"{benchmark_name(name)}.csv"
    write_csv(row_curves(outcome.rows), rows, remarks)
    if not outcome.curves:
        return [rows]
    stem = curves_stem(benchmark_name(name))
    return [rows, *write_files(outcome.curves, chosen.draw, stem, directory, remarks, formats)]

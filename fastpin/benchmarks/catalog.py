"""The benchmarks: find them, and write their files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from fastpin.benchmarks import handbook_formulas, klang, nafems_loaded_pin, nasa_tp_1862, textbooks
from fastpin.benchmarks.rows import Benchmark, Outcome
from fastpin.benchmarks.text import row_curves
from fastpin.errors import InputError
from fastpin.paper.files import FORMATS, check_files, write_files
from fastpin.report.curves import write_csv
from fastpin.version import __version__

BENCHMARKS: dict[str, Benchmark] = {
    benchmark.name: benchmark
    for benchmark in (
        klang.BENCHMARK,
        handbook_formulas.BENCHMARK,
        nasa_tp_1862.BENCHMARK,
        nafems_loaded_pin.BENCHMARK,
        *textbooks.BENCHMARKS,
    )
}
"""All benchmarks by name."""


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


def check(names: Iterable[str], directory: str | Path, formats: Sequence[str] = FORMATS[:1]) -> None:
    """Check before the work that the files of all benchmarks can be written, and make `directory` if it is missing.

    Raises
    ------
    InputError
        If there is no such benchmark, a format is unknown, or the files can't be written.
    """
    known = [benchmark_name(name) for name in names]
    check_files([*known, *map(_curves_stem, known)], directory, formats)


def write(name: str, outcome: Outcome, directory: str | Path, formats: Sequence[str] = FORMATS[:1]) -> list[Path]:
    """Write the numbers of a benchmark as CSV, and its figure, if it has one, in each of the `formats`.

    The rows stand in ``NAME.csv``, and the curves of a figure in ``NAME-curves.csv``. Return the paths.
    """
    chosen = BENCHMARKS[benchmark_name(name)]
    remarks = (chosen.title, f"fastpin {__version__}")
    rows = Path(directory) / f"{chosen.name}.csv"
    write_csv(row_curves(outcome.rows), rows, remarks)
    if chosen.draw is None:
        return [rows]
    return [rows, *write_files(outcome.curves, chosen.draw, _curves_stem(chosen.name), directory, remarks, formats)]


def _curves_stem(name: str) -> str:
    """Return the first part of the names of a benchmark's figure and its numbers."""
    return f"{name}-curves"

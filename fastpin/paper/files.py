"""The files of a figure: pictures, and its numbers as CSV."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures.style import save_drawing
from fastpin.model.checks import choice
from fastpin.report.curves import Curve, write_csv
from fastpin.storage.files import check_writable

FORMATS = ("png", "pdf", "svg")
"""Formats of a picture, by the ends of the names of files."""


def check_files(stems: Iterable[str], directory: str | Path, formats: Sequence[str]) -> None:
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


def write_files(
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

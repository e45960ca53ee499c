"""The figures of the paper and others: find them, compute them, write them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from fastpin.errors import InputError
from fastpin.model.checks import whole_number
from fastpin.model.grid import LEAST_NODES, MAX_NODES
from fastpin.paper import (
    fretting,
    half_plane,
    hollow_pins,
    interference,
    memory,
    monotonic,
    rectangular_lug,
    regimes,
    remote_stress,
    rigid_pin,
    rings,
    sliding_onset,
    steady_states,
    supports,
    sweep,
)
from fastpin.paper.curves import PaperFigure, Report
from fastpin.paper.files import FORMATS, check_files, write_files
from fastpin.version import __version__

FIGURES: dict[str, PaperFigure] = {
    figure.name: figure
    for subject in (
        monotonic, sweep, remote_stress, fretting, steady_states,
        memory, sliding_onset, half_plane, rigid_pin, rings, supports, hollow_pins, rectangular_lug, interference,
        regimes,
    )
    for figure in subject.FIGURES
}  # fmt: skip
"""All figures by name. Each file of a subject has its figures in ``FIGURES``."""

PAPER = tuple(sorted((name for name in FIGURES if name.isdecimal()), key=int))
"""Names of the figures of the paper (1 and 2 are sketches)."""

BEYOND = tuple(name for name in FIGURES if name not in PAPER)
"""Names of the figures that the paper does not have."""

NODES = 400
"""Number of nodes unless another one is chosen."""


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
        beyond = ", ".join(BEYOND)
        raise InputError(
            "figure", f"there is no {text!r}; there are {PAPER[0]} to {PAPER[-1]} of the paper, and {beyond}"
        )
    return known


def figure(name: str | int) -> PaperFigure:
    """Return a figure: a number from 3 to 17, or a name of :data:`BEYOND`.

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
    check_files(map(stem, chosen), directory, formats)


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
    return write_files(chosen.compute(nodes, progress), chosen.draw, stem(name), directory, remarks, formats)

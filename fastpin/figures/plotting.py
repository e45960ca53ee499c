"""Figures by the name of their kind."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures.kinds import KINDS, kinds_with
from fastpin.figures.sheet import WIDTH, Look, Plot
from fastpin.figures.subjects import InMemory, Subject
from fastpin.model.checks import choice
from fastpin.solver.result import Result
from fastpin.solver.wear_result import WearResult


def plot_of(kind: str, subject: Subject, **options: Any) -> Plot:
    """Return the figure of a kind of :data:`fastpin.figures.kinds.KINDS`. The options are keywords of its function.

    Raises
    ------
    InputError
        If an option is out of range, or the result can't be drawn in this way.
    """
    module = importlib.import_module(f"fastpin.figures.{KINDS[kind].file}")
    plot: Plot = getattr(module, f"{kind.replace('-', '_')}_plot")(subject, **options)
    return plot


def plot_result(
    result: Result | WearResult,
    kind: str,
    path: str | Path | None = None,
    title: str = "",
    width: float | None = None,
    dpi: float = 300.0,
    ax: Axes | None = None,
    **options: Any,
) -> Figure:
    """Draw a figure of a result, see :meth:`fastpin.Result.plot`, or of a life of wear."""
    choice("kind", kind, [name for name, each in KINDS.items() if each.ending == "png"])
    look = Look(path, title, WIDTH if width is None else width, dpi, ax)
    for name in options:
        if name not in KINDS[kind].options and kinds_with(name):
            raise InputError(name, f"has no effect on {kind}; it is for {kinds_with(name)}")
    plot = plot_of(kind, InMemory(result), **options)
    return (replace(look, width=plot.width) if width is None else look).drawn(plot)

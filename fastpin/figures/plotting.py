"""Figures by the name of their kind."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures.kinds import KINDS, SOURCES, kinds_with
from fastpin.figures.sheet import Look, Plot, draw_plot
from fastpin.figures.subjects import InMemory, Subject, with_stored_cycles
from fastpin.model.case import Case
from fastpin.model.checks import choice
from fastpin.model.wear import cycles_text
from fastpin.solver.result import Result
from fastpin.solver.wear_result import WearResult


def plot_of(kind: str, subject: Subject, after: float | None = None, **options: Any) -> Plot:
    """Return the figure of a kind of :data:`fastpin.figures.kinds.KINDS`. The options are keywords of its function.

    Of a life of wear the figure shows one cycle on the profile `after` so many cycles. Without `after`, and without a
    choice of states among those on all profiles, it is the last profile.

    Raises
    ------
    InputError
        If an option is out of range, or the result can't be drawn in this way.
    """
    sources = KINDS[kind].sources
    if subject.source not in sources:
        raise InputError("kind", f"{kind} shows {SOURCES[sources[0]]}, but this is {SOURCES[subject.source]}")
    shows_states = "result" in sources and "case" not in sources
    if after is not None:
        if not shows_states:
            raise InputError("after", f"has no effect on {kind}, which shows no states")
        if subject.source != "life":
            raise InputError("after", f"chooses a profile of a life of wear, but this is {SOURCES[subject.source]}")
    on_profile = ""
    if subject.source == "life" and shows_states and (after is not None or "states" not in options):
        life = with_stored_cycles(subject)
        after = life[-1].cycle if after is None else after
        subject, on_profile = InMemory(Result.of_life(life, after)), f"after {cycles_text(after)}"
    module = importlib.import_module(f"fastpin.figures.{KINDS[kind].file}")
    plot: Plot = getattr(module, f"{kind.replace('-', '_')}_plot")(subject, **options)
    if not on_profile:
        return plot

    def draw(look: Look) -> Any:
        return plot.draw(replace(look, title=", ".join(filter(None, [look.title, on_profile]))))

    return replace(plot, draw=draw, notes=[f"the figure shows a cycle {on_profile}", *plot.notes])


def plot_of_case(kind: str, case: Case) -> Plot:
    """Return the figure of a case, of a kind of :data:`fastpin.figures.kinds.KINDS` that shows cases.

    Raises
    ------
    InputError
        If the case can't be drawn in this way.
    """
    plot: Plot = getattr(importlib.import_module(f"fastpin.figures.{KINDS[kind].file}"), f"{kind}_of")(case)
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
    if path in KINDS:
        raise InputError("path", f'must be the name of a file, not "{path}"; for this figure write kind="{path}"')
    for name in options:
        if name not in KINDS[kind].options and kinds_with(name):
            raise InputError(name, f"has no effect on {kind}; it is for {kinds_with(name)}")
    return draw_plot(lambda: plot_of(kind, InMemory(result), **options), path, title, width, dpi, ax)

"""Figures of a result by the name of their kind, and its HTML in a notebook."""

from __future__ import annotations

import base64
import html
import importlib
import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.errors import InputError
from fastpin.figures.kinds import KINDS, SOURCES, kinds_with
from fastpin.figures.sheet import Look, Plot, draw_plot
from fastpin.figures.states import Subject, drawn_states, with_stored_cycles
from fastpin.figures.style import SCREEN_DPI
from fastpin.figures.tractions import plot_tractions
from fastpin.model.checks import choice, instance
from fastpin.model.wear import cycles_text
from fastpin.report.states import state_table
from fastpin.solver import Result
from fastpin.states.state import State
from fastpin.wear_lives import WearResult

if TYPE_CHECKING:  # joints are compiled code
    from fastpin.figures.joint import JointSubject
    from fastpin.figures.joint_sketch import JointFileSubject


def plot_of(
    kind: str, subject: Subject | JointSubject | JointFileSubject, after: float | None = None, **options: Any
) -> Plot:
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
        life = with_stored_cycles(subject)  # type: ignore[arg-type]
        after = life[-1].cycle if after is None else after
        subject, on_profile = Subject(Result.of_life(life, after)), f"after {cycles_text(after)}"
    module = importlib.import_module(f"fastpin.figures.{KINDS[kind].file}")
    plot: Plot = getattr(module, f"{kind.replace('-', '_')}_plot")(subject, **options)
    if not on_profile:
        return plot

    def draw(look: Look) -> Any:
        return plot.draw(replace(look, title=", ".join(filter(None, [look.title, on_profile]))))

    return replace(plot, draw=draw, notes=[f"the figure shows a cycle {on_profile}", *plot.notes])


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
    choice("kind", kind, tuple(KINDS))
    if isinstance(path, str) and path in KINDS:
        raise InputError("path", f'must be the name of a file, not "{path}"; for this figure write kind="{path}"')
    for name in options:
        if name not in KINDS[kind].options and kinds_with(name):
            raise InputError(name, f"has no effect on {kind}; it is for {kinds_with(name)}")
    return draw_plot(lambda: plot_of(kind, Subject(result), **options), path, title, width, dpi, ax)


def state_html(state: State) -> str:
    """Return the HTML of a state: a table with one row, and a figure of the tractions.

    Another class than :class:`State` raises :class:`InputError`.
    """
    instance("state", state, State, "a State")
    return _html([state], "")


def result_html(result: Result) -> str:
    """Return the HTML of a result: a table and a figure of the states of :func:`drawn_states`.

    Another class than :class:`Result` raises :class:`InputError`.
    """
    instance("result", result, Result, "a Result")
    if not len(result):
        return f"<pre>{html.escape(repr(result))}</pre>"
    states = drawn_states(result)
    return _html(states, f"shown: {states.note}" if states.note else "")


def _html(states: Sequence[State], note: str) -> str:
    picture = io.BytesIO()
    plot_tractions(states, width=5.6).savefig(picture, format="png", dpi=SCREEN_DPI)
    image = base64.b64encode(picture.getvalue()).decode("ascii")
    table = html.escape(state_table(states[0].problem, states))
    caption = f"<p>{html.escape(note)}</p>" if note else ""
    return (
        f'<pre style="font-size: 80%; line-height: 1.25">{table}</pre>{caption}'
        f'<img alt="pressure and shear traction round the hole" src="data:image/png;base64,{image}">'
    )

"""States and results in notebooks: HTML with a small table and a figure."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Sequence

from fastpin.figures.states import drawn_states
from fastpin.figures.style import SCREEN_DPI
from fastpin.figures.tractions import plot_tractions
from fastpin.model.checks import instance
from fastpin.report.states import state_table
from fastpin.solver.result import Result
from fastpin.states.state import State


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

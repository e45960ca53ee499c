"""Figures of the bearing stress against the bypass stress at which the first ply of a laminate fails."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial

import numpy as np

from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import MAX_NAMED, line
from fastpin.figures.sweep import MARKERS, fixed_parameters
from fastpin.figures.words import quantity, shown_label
from fastpin.model.checks import instances
from fastpin.model.problem import Problem
from fastpin.model.units import PASCAL
from fastpin.report.curves import Curve, write_csv
from fastpin.report.envelope import BEARING, BYPASS


def envelope_of(found: Sequence[Curve], problem: Problem | None = None, varied: Collection[str] = ()) -> Plot:
    """Draw the envelopes of :func:`fastpin.report.envelope.envelopes`: no ply fails below a line.

    The caption has the parameters of a `problem` without the `varied` fields of the sweep. See
    :func:`fastpin.plot_tractions` for the other arguments.
    """
    each = instances("found", found, Curve, "a list of envelopes")
    if not 1 <= len(each) <= MAX_NAMED:
        raise InputError("found", f"must be 1 to {MAX_NAMED} envelopes, not {len(each)}")
    words = "bearing stress over the bypass stress at which the first ply fails"
    return Plot(
        lambda look: _draw(look, each, "" if problem is None else fixed_parameters(problem, varied)),
        partial(write_csv, each),
        f"Line chart of the {words}.",
        f"{words[0].upper()}{words[1:]}.",
        width=5.8,
    )


plot_envelope = plotter("plot_envelope", envelope_of)


def _draw(look: Look, curves: Sequence[Curve], parameters: str) -> Sheet:
    sheet = look.sheet([0.6 * look.width], extra=0.8)
    (panel,) = sheet.axes[0]
    largest = [float(np.abs(curve[name]).max()) for curve in curves for name in (BYPASS, BEARING)]
    factor, label = PASCAL.scale(largest)
    handles = []
    for place, curve in enumerate(curves):
        (drawn,) = panel.plot(
            factor * curve[BYPASS], factor * curve[BEARING], marker=MARKERS[place], markersize=3.5,
            label=shown_label(str(curve.parameters.get("case", ""))), **line(place),
        )  # fmt: skip
        handles.append(drawn)
    panel.axvline(0.0, color="0.6", linewidth=0.8)
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel(quantity("bypass stress", label))
    panel.set_ylabel(quantity("bearing stress", label))
    if any("case" in curve.parameters for curve in curves):
        sheet.legend(handles, 2)
    criterion = str(curves[0].parameters["criterion"]).replace(" um", " µm")
    sheet.head(look.title, f"failure of the first ply by {criterion}", caption=parameters)
    sheet.grid()
    return sheet

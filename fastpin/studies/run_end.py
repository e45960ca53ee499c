"""The end of a run and its key figures, for the index of a sweep.

Key figures are a few numbers of the last state, and the extremes of all states.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin.model import angles, ties
from fastpin.reading.zones import Interval
from fastpin.studies.outcomes import OutcomeValue, StudyOutcome, of_quantity

if TYPE_CHECKING:  # the solver is compiled code, and a plan is read without it
    from fastpin.solver.result import Result


def _widest(intervals: list[Interval]) -> int:
    """The place of the widest interval; of equal ones the one farthest to the right."""
    ends = np.array(intervals)
    return ties.top_angle(ends[:, 1] - ends[:, 0], ends.mean(axis=1))


def _end(side: int, result: Result) -> float | None:
    """An end of the widest contact interval in degrees from the bottom of the hole; it may lie beyond the top."""
    ends = result[-1].contact
    return angles.interval_from_bottom(*ends[_widest(ends)])[side] if ends else None


def _bar_of_end(side: str, result: Result) -> float:
    """The error bar of :func:`_end`, degrees. A contact all round has no ends, and no bar."""
    bars, ends = result[-1].error_bars, result[-1].contact
    if bars is None or not ends:
        return math.nan
    return math.degrees(bars.get(f"contact_{_widest(ends) + 1}_{side}", math.nan))


KEY_FIGURES: dict[str, StudyOutcome] = {
    "states": StudyOutcome("", "", "", len),
    **{name: of_quantity(name) for name in ("peak_pressure", "peak_pressure_angle", "peak_shear", "peak_shear_angle")},
    **{
        f"contact_{side}": StudyOutcome("degrees", "", "", partial(_end, k), bar=partial(_bar_of_end, side))
        for k, side in enumerate(("start", "stop"))
    },
    **{name: of_quantity(name) for name in ("contact_width", "stick_width", "rotation", "dx", "dy", "dissipation")},
    "max_pressure": of_quantity("peak_pressure", "largest"),
    "max_shear": of_quantity("peak_shear", "largest magnitude"),
    "residual": StudyOutcome(
        "", "", "", lambda result: max(max(state.residuals.values(), default=0.0) for state in result)
    ),
    "nodes": StudyOutcome("", "", "", lambda result: result.grid.size),
}
"""The key figures: outcomes that every run of a sweep has.

* ``states``, ``nodes``: numbers of states and of nodes.
* ``peak_pressure`` to ``dissipation``: quantities of the last state, see :data:`fastpin.states.QUANTITIES`.
  ``peak_shear`` has its sign. Angles are measured from the bottom of the hole. ``contact_start`` and ``contact_stop``
  are the ends of the widest contact interval. ``contact_width`` and ``stick_width`` are sums over all intervals.
  ``dissipation`` is the total since the beginning of the history.
* ``max_pressure``, ``max_shear``: largest peak pressure, and largest magnitude of the peak shear, of all states.
* ``residual``: the largest residual of all states.
"""

RUN_COLUMNS: dict[str, str] = {
    "id": "TEXT PRIMARY KEY",
    "status": "TEXT NOT NULL",
    "reason": "TEXT",
    "dimensionless": "INTEGER NOT NULL",
    **{name: "INTEGER" if name in ("states", "nodes") else "REAL" for name in KEY_FIGURES},
    "seconds": "REAL",
    "started": "TEXT",
    "host": "TEXT",
    "versions": "TEXT",
    "input": "TEXT NOT NULL",
}
"""Columns of the index of a sweep, besides the varied fields, and their SQL types."""


JOINT_FIGURES: dict[str, StudyOutcome] = {
    "states": KEY_FIGURES["states"],
    "dissipation": StudyOutcome(
        "energy", "", "", lambda result: float(sum(
            contact.dissipation * plate.thickness
            for contact, (_, plate) in zip(result[-1].contacts, result.joint.sections, strict=True)
        )),
    ),
    "max_pressure": StudyOutcome(
        "traction", "", "", lambda result: max((
            float(state.peak_pressure) for place in range(len(result.joint.sections))
            for state in result.states.section(place) if state.in_contact
        ), default=0.0),
    ),
    "residual": StudyOutcome(
        "", "", "", lambda result: max(max(state.residuals.values()) for state in result.states.bare)
    ),
    "nodes": StudyOutcome("", "", "", lambda result: result.nodes),
}  # fmt: skip
"""The key figures of a joint: those of its contacts together. The dissipation is that of the whole thickness, J."""


def figures_of(figures: dict[str, StudyOutcome], result: Any) -> dict[str, Any]:
    """Return the values of key figures; None for all others."""
    return {name: _number(figures[name], result) if name in figures else None for name in KEY_FIGURES}


def key_figures(result: Result) -> dict[str, Any]:
    """Return the key figures of a result with at least one state, by name.

    Angles and widths are in degrees. None stands for a figure that an open contact does not have. A result whose
    history was not followed to the end has only the numbers of states and nodes.
    """
    known = KEY_FIGURES if result.complete else {name: KEY_FIGURES[name] for name in ("states", "nodes")}
    return figures_of(known, result)


def _number(figure: StudyOutcome, result: Result) -> int | float | None:
    """Return a key figure for SQLite. NaN becomes None: there is no such peak, and it has no angle."""
    value = figure.read(result)
    if value is None or isinstance(value, int):
        return value
    return figure.reported(float(value)) if math.isfinite(value) else None


def bar_column(name: str) -> str:
    """The name of the error bar of a key figure or an outcome, in rows of a sweep and in CSV files."""
    return f"{name}_bar"


def key_bars(result: Result) -> dict[str, float]:
    """Return the error bars of the key figures of a complete result with error bars, by name; else none.

    Bars of angles and widths are in degrees. A figure without a value has no bar. The bar is inf if the coarse grid has
    no value to compare.
    """
    if not result.complete or result.coarse is None:
        return {}
    bars = {name: each.reported_bar(each.bar(result)) for name, each in KEY_FIGURES.items() if each.bar is not None}
    return {name: bar for name, bar in bars.items() if not math.isnan(bar)}


@dataclass(frozen=True)
class RunEnd:
    """The end of one run: key figures, or the reason of a failure.

    Attributes
    ----------
    id : str
        Id of the run.
    reason : str or None
        The reason of the failure. None after success.
    figures : dict
        Key figures, see :data:`KEY_FIGURES`. Empty without a state.
    seconds : float or None
        Time in the solver, s.
    started : str or None
        Start of the run in UTC, ISO 8601.
    host : str or None
        Name of the machine.
    versions : dict of str to str
        Versions of fastpin, Python and the libraries.
    outcomes : dict of str to OutcomeValue
        Values of the outcomes that the user chose. Empty after a failure.
    bars : dict of str to float
        Error bars of key figures, see :func:`key_bars`.
    content : bytes or None
        The packed result, for the index. None if the result has a file of its own, or there is no state.
    """

    id: str
    reason: str | None
    figures: dict[str, Any] = field(default_factory=dict)
    seconds: float | None = None
    started: str | None = None
    host: str | None = None
    versions: dict[str, str] = field(default_factory=dict)
    outcomes: dict[str, OutcomeValue] = field(default_factory=dict)
    bars: dict[str, float] = field(default_factory=dict)
    content: bytes | None = field(default=None, repr=False)

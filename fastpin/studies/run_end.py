"""The end of a run and its key figures, for the index of a sweep.

Key figures are a few numbers of the last state, and the extremes of all states.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin.model import angles, ties
from fastpin.reading.zones import Interval
from fastpin.states.quantities import QUANTITIES, bar_in_degrees, in_degrees
from fastpin.studies.outcomes import OutcomeValue, bar_of_taken, taken

if TYPE_CHECKING:  # the solver is compiled code, and a plan is read without it
    from fastpin.solver.result import Result


KEY_FIGURES: dict[str, str] = {
    "states": "",
    "peak_pressure": "traction",
    "peak_pressure_angle": "angle",
    "peak_shear": "traction",
    "peak_shear_angle": "angle",
    "contact_start": "angle",
    "contact_stop": "angle",
    "contact_width": "angle",
    "stick_width": "angle",
    "rotation": "rotation",
    "dx": "displacement",
    "dy": "displacement",
    "dissipation": "energy",
    "max_pressure": "traction",
    "max_shear": "traction",
    "residual": "",
    "nodes": "",
}
"""Names and kinds of the key figures.

A kind is a key of :func:`fastpin.model.units.units`, "angle" (deg) or "" for a plain number.

* ``states``, ``nodes``: numbers of states and of nodes.
* ``peak_pressure`` to ``dissipation``: quantities of the last state, see :data:`fastpin.states.QUANTITIES`.
  ``peak_shear`` has its sign. Angles are measured from the bottom of the hole. ``contact_start`` and ``contact_stop``
  are the ends of the widest contact interval. ``contact_width`` and ``stick_width`` are sums over all intervals.
  ``dissipation`` is the total since the beginning of the history.
* ``max_pressure``, ``max_shear``: largest peak pressure, and largest magnitude of the peak shear, of all states.
* ``residual``: the largest residual of all states.
"""

TAKEN = {name: (name, "last") for name in KEY_FIGURES if name in QUANTITIES} | {
    "max_pressure": ("peak_pressure", "largest"),
    "max_shear": ("peak_shear", "largest magnitude"),
}
"""The key figures that are read as outcomes are: the quantity of each, and how its number is taken from all states."""

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


def key_figures(result: Result) -> dict[str, Any]:
    """Return the key figures of a result with at least one state, by name.

    Angles and widths are in degrees. None stands for a figure that an open contact does not have. A result whose
    history was not followed to the end has only the numbers of states and nodes.
    """
    figures: dict[str, Any] = dict.fromkeys(KEY_FIGURES)
    figures |= {"states": len(result), "nodes": result.grid.size}
    if not result.complete:
        return figures
    if ends := result[-1].contact:
        start, stop = angles.interval_from_bottom(*ends[_widest(ends)])
        figures |= {"contact_start": start, "contact_stop": stop}
    figures |= {name: in_degrees(of, taken(of, take, "history", "pin", result)) for name, (of, take) in TAKEN.items()}
    figures["residual"] = max(max(state.residuals.values(), default=0.0) for state in result)
    return {name: _number(value) for name, value in figures.items()}


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
    bars = result[-1].error_bars
    assert bars is not None
    widest = _widest(ends) if (ends := result[-1].contact) else 0
    found = {
        name: bar_in_degrees(of, bar_of_taken(of, take, "history", "pin", result)) for name, (of, take) in TAKEN.items()
    }
    for end in ("start", "stop"):  # A contact all round has no ends.
        found[f"contact_{end}"] = math.degrees(bars.get(f"contact_{widest + 1}_{end}", math.nan))
    return {name: bar for name, bar in found.items() if not math.isnan(bar)}


def _widest(intervals: list[Interval]) -> int:
    """The place of the widest interval; of equal ones the one farthest to the right."""
    ends = np.array(intervals)
    return ties.top_angle(ends[:, 1] - ends[:, 0], ends.mean(axis=1))


def _number(value: Any) -> int | float | None:
    """Return a number for SQLite. NaN becomes None: there is no such peak, and it has no angle."""
    if value is None or isinstance(value, int):
        return value
    return float(value) if math.isfinite(value) else None


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

"""Key figures of a run: the few numbers of its last state, and the extremes of all, that a sweep keeps in its index."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from fastpin.model.angles import interval_from_bottom
from fastpin.solver.result import Result
from fastpin.states.quantities import QUANTITIES, in_degrees
from fastpin.states.zones import Interval

_PEAKS = ("peak_pressure", "peak_pressure_angle", "peak_shear", "peak_shear_angle")
_OTHERS = ("contact_width", "stick_width", "rotation", "dx", "dy", "dissipation")


def _kind(name: str) -> str:
    kind = QUANTITIES[name].kind
    return "angle" if kind == "width" else kind


KEY_FIGURES: dict[str, str] = {
    "states": "",
    **{name: _kind(name) for name in _PEAKS},
    "contact_start": "angle",
    "contact_stop": "angle",
    **{name: _kind(name) for name in _OTHERS},
    "max_pressure": "traction",
    "max_shear": "traction",
    "residual": "",
    "nodes": "",
}
"""Names of the key figures and their kinds: a key of :func:`fastpin.report.units`, "angle" (deg), "" for a number.

* ``states``, ``nodes``: numbers of states and of nodes.
* ``peak_pressure`` to ``dissipation``: of the last state, see :data:`fastpin.quantities.QUANTITIES`. ``peak_shear``
  has its sign. Angles count from the bottom of the hole; ``contact_start`` and ``contact_stop`` are the ends of the
  widest contact interval, ``contact_width`` and ``stick_width`` sums over all. ``dissipation`` is the total since the
  beginning.
* ``max_pressure``, ``max_shear``: largest peak pressure and largest magnitude of the peak shear of all states.
* ``residual``: the largest residual of all states.
"""


def key_figures(result: Result) -> dict[str, Any]:
    """The key figures of a result with at least one state; None for what a contact that is open does not have.

    Only the numbers of states and nodes are given where the history was not followed to its end.
    """
    figures: dict[str, Any] = dict.fromkeys(KEY_FIGURES)
    figures |= {"states": len(result), "nodes": result.grid.size}
    if not result.complete:
        return figures
    last = result[-1]
    start, stop = _widest(last.contact)
    figures |= {
        **{name: in_degrees(name, QUANTITIES[name].of(last)) for name in (*_PEAKS, *_OTHERS)},
        "contact_start": start,
        "contact_stop": stop,
        "max_pressure": max(state.peak_pressure for state in result),
        "max_shear": max(abs(state.peak_shear) for state in result),
        "residual": max(max(state.residuals.values(), default=0.0) for state in result),
    }
    return {name: _number(value) for name, value in figures.items()}


def _number(value: Any) -> int | float | None:
    """A number that SQLite takes; None for NaN, the angle of a peak that is not there."""
    if value is None or isinstance(value, int):
        return value
    return float(value) if math.isfinite(value) else None


def _widest(intervals: list[Interval]) -> tuple[float | None, float | None]:
    if not intervals:
        return None, None
    return interval_from_bottom(*max(intervals, key=lambda interval: interval[1] - interval[0]))


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    id : str
    reason : str or None
        Why it failed; None if it did not.
    figures : dict
        Key figures (:data:`fastpin.keyfigures.KEY_FIGURES`); empty without a state.
    seconds : float or None
        Time in the solver.
    started : str or None
        UTC, ISO 8601.
    host : str or None
        Name of the machine.
    versions : dict of str to str
        Of fastpin, Python and the libraries.
    """

    id: str
    reason: str | None
    figures: dict[str, Any] = field(default_factory=dict)
    seconds: float | None = None
    started: str | None = None
    host: str | None = None
    versions: dict[str, str] = field(default_factory=dict)

"""Margins of safety of a result: strengths of each body, the bush in its seat, and fatigue, each with its state.

A margin of safety is allowable/value - 1, as aerospace engineers write it: below 0 the part fails. One table serves the
terminal, JSON and reports. Extremes are those of all kept states.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from fastpin.model.angles import from_bottom
from fastpin.model.points import bodies_of, material_of
from fastpin.model.problem import Problem
from fastpin.model.units import named_loads, printed_loads, units
from fastpin.report.table import aligned
from fastpin.states.extremes import Found
from fastpin.states.quantities import point_name
from fastpin.states.state import State
from fastpin.states.yielding import PREFIX, circles, place_words, strength_of, von_mises_peak

HEADS = ("subject", "value", "allowable", "margin", "load point", "loads", "remark")
"""Headings of :func:`margin_rows`."""


class Margin(NamedTuple):
    """A margin, in SI units. What is not known is NaN, and the remark says why.

    Attributes
    ----------
    subject : str
    kind : str
        A key of :func:`fastpin.model.units.units`, or "ratio".
    value, allowable : float
    load_point : float
        The load point of the state that governs.
    remark : str
        The place; or why there is no margin.
    loads : mapping
        The loads of that state by name; empty where no single state governs.
    """

    subject: str
    kind: str = "ratio"
    value: float = math.nan
    allowable: float = math.nan
    load_point: float = math.nan
    remark: str = ""
    loads: Mapping[str, float] = MappingProxyType({})

    @property
    def margin(self) -> float:
        """allowable/value - 1; infinite if nothing is asked of the part."""
        if self.value <= 0.0:
            return math.inf
        return self.allowable / self.value - 1.0


def static_margins(problem: Problem, found: Found, read: Callable[[Sequence[int]], list[State]]) -> list[Margin]:
    """Return the margins of the strengths and of the bush over all states.

    The elastic von Mises stress of each body is compared with its yield strength, and with its ultimate strength if
    that is given.

    Parameters
    ----------
    problem : Problem
    found : dict
        The extremes of all states, see :func:`fastpin.states.extremes.marked_extremes`; empty without states.
    read : callable
        ``read(places)`` gives the states at these places.
    """
    rows = []
    for owner in dict.fromkeys(circle.owner for circle in circles(problem)):
        circle = next(each for each in circles(problem) if each.owner == owner)
        extreme = found.get((PREFIX + owner, "largest"))
        state = None if extreme is None else read([extreme.place])[0]
        strengths = {"yield": strength_of(problem, circle)}
        if (ultimate := material_of(problem, circle.body).ultimate_strength) is not None:
            strengths["ultimate"] = ultimate
        for name, strength in strengths.items():
            subject = f"{owner}: {name}, von Mises"
            if problem.dimensionless:
                rows.append(Margin(subject, remark="not known: the problem has no dimensions"))
            elif strength is None:
                rows.append(Margin(subject, remark="not known: no yield strength given"))
            elif extreme is None or state is None:
                rows.append(Margin(subject, "traction", allowable=strength, remark="not known: there is no state"))
            else:
                place = place_words(problem, von_mises_peak(state, owner))
                row = Margin(subject, "traction", extreme.value, strength, extreme.load_point, place, state.load)
                rows.append(row)
    return rows + (_of_bush(problem, found, read) if "seat" in bodies_of(problem) else [])


def smallest_margin(rows: Sequence[Margin]) -> Margin | None:
    """Return the row with the smallest margin that is known and finite; None if there is none."""
    return min((row for row in rows if math.isfinite(row.margin)), key=lambda row: row.margin, default=None)


def margin_lines(problem: Problem, rows: Sequence[Margin]) -> list[str]:
    """Return lines of text on the margins that are known, the smallest one marked; none if no margin is known."""
    known = [row for row in rows if math.isfinite(row.margin)]
    if not known:
        return []
    cells = []
    for name, value, allowable, margin, point, loads, place in margin_rows(problem, known):
        where = "" if point == "-" else f"load point {point}: {loads}"
        cells.append((name, f"{value} of {allowable}", margin, where, place))
    return ["margins of safety over all kept states, allowable/value - 1:", *aligned(cells, "lrrll")]


def _of_bush(problem: Problem, found: Found, read: Callable[[Sequence[int]], list[State]]) -> list[Margin]:
    """Return the margins against rotation and opening of a bush in its seat. One that slips has its largest slip."""
    turning, opening = "bush: rotation, friction needed", "bush: opening, press fit needed"
    if problem.bush_slips:
        turning = "bush: slip in its seat"
    least, slipping = found.get(("bush_open_margin", "smallest")), found.get(("bush_least_friction", "largest"))
    if least is None or slipping is None:
        none = "not known: there is no state"
        return [Margin(turning, remark=none), Margin(opening, remark=none)]
    (state,), pressure = read([least.place]), units(problem)["traction"].text(least.value, 4)
    fit = state.bush_fit()
    smallest = f"smallest pressure {pressure}" if least.value > 0.0 or not problem.bush_slips else "the bush opens"
    where = f"{smallest} at {from_bottom(fit.open_angle):z.1f} deg"
    needed = fit.pressure_to_close or math.nan  # of a loose bush it is not known: without pressure it is open anyhow
    opened = Margin(opening, "traction", needed, fit.press_fit_pressure, least.load_point, where, state.load)
    slip = found.get(("seat_slip", "largest magnitude"))
    if slip is not None and problem.bush_slips:
        sliding = read([slip.place])[0]
        seat = sliding.seat
        angle = math.nan if seat is None else from_bottom(seat.peak_slip_angle)
        words = f"no limit of the slip is known; largest at {angle:z.1f} deg"
        most = abs(slip.value)
        return [Margin(turning, "displacement", most, math.nan, slip.load_point, words, sliding.load), opened]
    words = "not known: no friction between bush and plate given" if least.value > 0.0 else "the bush opens"
    loads = read([slipping.place])[0].load
    return [Margin(turning, "ratio", slipping.value, math.nan, slipping.load_point, words, loads), opened]


def margin_rows(problem: Problem, found: Sequence[Margin]) -> list[tuple[str, ...]]:
    """Return rows of text under :data:`HEADS`."""
    unit, least = units(problem), smallest_margin(found)

    def verdict(row: Margin) -> str:
        if math.isnan(row.margin):
            return "not known"
        words = "none needed" if math.isinf(row.margin) else f"{row.margin:+.2f}"
        return f"{words}, the smallest" if row is least else words

    def shown(row: Margin, value: float) -> str:
        if math.isnan(value):
            return "-"
        if math.isinf(value):
            return "infinite"
        return f"{value:.3g}" if row.kind == "ratio" else unit[row.kind].text(value, 4)

    return [
        (
            row.subject,
            shown(row, row.value),
            shown(row, row.allowable),
            verdict(row),
            "-" if math.isnan(row.load_point) else point_name(row.load_point),
            named_loads(problem, row.loads) if row.loads else "-",
            row.remark,
        )
        for row in found
    ]


def document(problem: Problem, found: Sequence[Margin]) -> list[dict[str, Any]]:
    """Return margins as JSON-ready dicts, in printed units."""
    unit, least = units(problem), smallest_margin(found)
    factors = {row.kind: 1.0 if row.kind == "ratio" else unit[row.kind].factor for row in found}
    return [
        {
            "subject": row.subject,
            "value": factors[row.kind] * row.value,
            "allowable": factors[row.kind] * row.allowable,
            "unit": "" if row.kind == "ratio" else unit[row.kind].name,
            "margin": row.margin,
            "smallest": row is least,
            "loads": printed_loads(problem, row.loads),
            "load_point": row.load_point,
            "remark": row.remark,
        }
        for row in found
    ]

"""Margins of a result: yield of each body, the bush in its seat, and fatigue, each with the state that governs it.

A margin is allowable/value - 1, as engineers of joints write it: below 0 the part fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from fastpin.damage import Fatigue
from fastpin.damage import fatigue as fatigue_of
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.points import bodies_of, elastic_bodies, owner_of
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.report.case import edge_body
from fastpin.states.extremes import Found
from fastpin.states.quantities import point_name
from fastpin.states.state import State
from fastpin.states.yielding import PREFIX, circles, place_words, strength_of, von_mises_peak

HEADS = ("subject", "value", "allowable", "margin", "load point", "remark")
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
    """

    subject: str
    kind: str = "ratio"
    value: float = math.nan
    allowable: float = math.nan
    load_point: float = math.nan
    remark: str = ""

    @property
    def margin(self) -> float:
        """allowable/value - 1; infinite if nothing is asked of the part."""
        if self.value <= 0.0:
            return math.inf
        return self.allowable / self.value - 1.0


def static_margins(problem: Problem, found: Found, read: Callable[[Sequence[int]], list[State]]) -> list[Margin]:
    """Return the margins of yield and of the bush over all states.

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
        strength, subject = strength_of(problem, circle), f"{owner}: yield, von Mises"
        extreme = found.get((PREFIX + owner, "largest"))
        if problem.dimensionless:
            rows.append(Margin(subject, remark="not known: the problem has no dimensions"))
        elif strength is None:
            rows.append(Margin(subject, remark="not known: no yield strength given"))
        elif extreme is None:
            rows.append(Margin(subject, "traction", allowable=strength, remark="not known: there is no state"))
        else:
            place = place_words(problem, von_mises_peak(read([extreme.place])[0], owner))
            rows.append(Margin(subject, "traction", extreme.value, strength, extreme.load_point, place))
    return rows + (_of_bush(problem, found, read) if "seat" in bodies_of(problem) else [])


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
    opened = Margin(opening, "traction", needed, fit.press_fit_pressure, least.load_point, where)
    slip = found.get(("seat_slip", "largest magnitude"))
    if slip is not None and problem.bush_slips:
        seat = read([slip.place])[0].seat
        angle = math.nan if seat is None else from_bottom(seat.peak_slip_angle)
        words = f"no limit of the slip is known; largest at {angle:z.1f} deg"
        return [Margin(turning, "displacement", abs(slip.value), load_point=slip.load_point, remark=words), opened]
    words = "not known: no friction between bush and plate given" if least.value > 0.0 else "the bush opens"
    return [Margin(turning, "ratio", slipping.value, load_point=slipping.load_point, remark=words), opened]


def fatigue_margins(problem: Problem, known: Sequence[Fatigue] | str, states: Sequence[State]) -> list[Margin]:
    """Return the margins of fatigue over the last cycle, with a row for each elastic edge of a hole.

    Parameters
    ----------
    problem : Problem
    known : sequence of Fatigue or str
        Smith, Watson and Topper's parameter over the last cycle; or why it is not known.
    states : sequence of State
        The states of the last cycle.
    """
    rows = []
    for body in (body for body in elastic_bodies(problem) if body != "pin"):
        subject = f"last cycle only: {edge_body(problem, body)}, fatigue"
        one = next((one for one in known if not isinstance(one, str) and one.body == body), None)
        if one is None:
            why = known.rstrip(".") if isinstance(known, str) else "no constants of fatigue given"
            rows.append(Margin(subject, remark=f"not known: {why[0].lower()}{why[1:]}"))
            continue
        try:
            limited = fatigue_of(states, "findley", body)  # its limit follows from the bending and the torsion limit
        except InputError:
            remark = f"not known: no bending_limit and torsion_limit of the {owner_of(problem, body)} given"
            life = one.hot_spot.life
            if not math.isnan(life):
                remark += f"; life {life:.3g} cycles" if math.isfinite(life) else "; infinite life"
            kind = "stress times strain"
            rows.append(Margin(f"{subject}, Smith-Watson-Topper", kind, one.hot_spot.parameter, remark=remark))
            continue
        place = "" if math.isnan(limited.hot_spot.theta) else f"at {from_bottom(limited.hot_spot.theta):z.1f} deg"
        limit = math.nan if limited.limit is None else float(limited.limit)
        rows.append(Margin(f"{subject}, Findley", "traction", limited.hot_spot.parameter, limit, remark=place))
    return rows


def margin_rows(problem: Problem, found: Sequence[Margin]) -> list[tuple[str, ...]]:
    """Return rows of text under :data:`HEADS`."""
    unit = units(problem)

    def verdict(margin: float) -> str:
        if math.isnan(margin):
            return "not known"
        return "none needed" if math.isinf(margin) else f"{margin:+.2f}"

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
            verdict(row.margin),
            "-" if math.isnan(row.load_point) else point_name(row.load_point),
            row.remark,
        )
        for row in found
    ]


def document(problem: Problem, found: Sequence[Margin]) -> list[dict[str, Any]]:
    """Return margins as JSON-ready dicts, in printed units."""
    unit = units(problem)
    factors = {row.kind: 1.0 if row.kind == "ratio" else unit[row.kind].factor for row in found}
    return [
        {
            "subject": row.subject,
            "value": factors[row.kind] * row.value,
            "allowable": factors[row.kind] * row.allowable,
            "unit": "" if row.kind == "ratio" else unit[row.kind].name,
            "margin": row.margin,
            "load_point": row.load_point,
            "remark": row.remark,
        }
        for row in found
    ]

"""Margins of safety: of the strengths of each body, and of a bush in its seat, each with its state.

A margin of safety is allowable/value - 1, as aerospace engineers write it: below 0 the part fails. All other margins
stand in :mod:`fastpin.assess.margins`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from fastpin.model.angles import from_bottom
from fastpin.model.points import bodies_of, elastic_bodies, material_of, near_rim, owner_of
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.states.extremes import Found
from fastpin.states.quantities import load_point
from fastpin.states.state import State
from fastpin.states.walking import Walk
from fastpin.states.yielding import PREFIX, place_words, von_mises_peak

MARGINS = {
    "yield": "yield strength over the von Mises stress",
    "ultimate": "ultimate strength over the von Mises stress",
    "rotation": "friction of a bonded bush in its seat over the friction needed",
    "walk": "no turn of a bush in its seat over the turn of the last cycle",
    "opening": "pressure of the press fit over the pressure needed to close the seat",
    "findley": "fatigue limit over Findley's parameter in the last cycle",
}
"""Kinds of margins by name, each with the meaning of allowable and value. Questions of a case have further ones."""


class Margin(NamedTuple):
    """A margin, in SI units. An unknown number is NaN, and the remark says why.

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
    name : str
        One of :data:`MARGINS`, or of those of a question.
    owner : str
        The body: "plate", "pin" or "bush".
    part : str
        Where alone the body was looked at, if not everywhere: the margin of the whole body may be smaller.
    """

    subject: str
    kind: str = "ratio"
    value: float = math.nan
    allowable: float = math.nan
    load_point: float = math.nan
    remark: str = ""
    loads: Mapping[str, float] = MappingProxyType({})
    name: str = ""
    owner: str = ""
    part: str = ""

    @property
    def margin(self) -> float:
        """allowable/value - 1; infinite if nothing is asked of the part."""
        if self.value <= 0.0:
            return math.inf
        return self.allowable / self.value - 1.0


def part_of(problem: Problem, owner: str) -> str:
    """Where alone a body is looked at; empty if that is everywhere."""
    radius, length = near_rim(problem, "seat") * problem.hole_radius, units(problem)["length"]
    return "" if owner != "plate" else problem.plate_body.lug.looked_at(radius, lambda size: length.text(size, 3))


def static_margins(problem: Problem, extremes: Found, read: Callable[[Sequence[int]], list[State]]) -> list[Margin]:
    """Return the margins of the strengths and of the bush over all states.

    The elastic von Mises stress of each body is compared with its yield strength, and with its ultimate strength if
    that is given.

    Parameters
    ----------
    problem : Problem
    extremes : Found
        The extremes of all states, see :func:`fastpin.states.extremes.marked_extremes`; empty without states.
    read : callable
        ``read(places)`` gives the states at these places.
    """
    rows = []
    for body in elastic_bodies(problem):
        owner, material = owner_of(problem, body), material_of(problem, body)
        extreme = extremes.get((PREFIX + owner, "largest"))
        state = None if extreme is None else read([extreme.place])[0]
        strengths = {"yield": material.known_yield_strength}
        if material.ultimate_strength is not None:
            strengths["ultimate"] = material.ultimate_strength
        for name, strength in strengths.items():
            row = Margin(f"{owner}: {name}, von Mises", name=name, owner=owner, part=part_of(problem, owner))
            if problem.dimensionless:
                rows.append(row._replace(remark="not known: the problem has no dimensions"))
            elif strength is None:
                rows.append(row._replace(remark="not known: no yield strength given"))
            elif extreme is None or state is None:
                why = str(extremes.unread.get(PREFIX + owner, "there is no state"))
                rows.append(row._replace(kind="traction", allowable=strength, remark=f"not known: {why}"))
            else:
                place = place_words(problem, von_mises_peak(state, owner))
                known = "traction", extreme.value, strength, extreme.load_point, place, state.load, name, owner
                rows.append(Margin(row.subject, *known, row.part))
    return rows + (_of_bush(problem, extremes, read) if "seat" in bodies_of(problem) else [])


def walk_margins(states: Sequence[State]) -> list[Margin]:
    """Return the margin of a bush against walking over the states of a cycle; none if that is not known.

    No turn is allowed: the margin of a bush that walks is -1, and one that rests needs none.
    """
    walk = Walk.of(states)
    if walk is None:
        return []
    turn = abs(walk.turn) if walk.goes_on else 0.0
    words = walk.words(states[0].problem).removeprefix("it ")
    end, subject = states[-1], "bush: walks in its seat"
    return [Margin(subject, "rotation", turn, 0.0, load_point(end), words, end.load, "walk", "bush")]


def smallest_margin(rows: Sequence[Margin]) -> Margin | None:
    """Return the row with the smallest margin that is known and finite; None if there is none.

    The margin of growth is not counted: a crack above its threshold grows, but no part fails.
    """
    counted = (row for row in rows if math.isfinite(row.margin) and row.name != "growth")
    return min(counted, key=lambda row: row.margin, default=None)


def over_yield(rows: Iterable[Margin]) -> dict[str, float]:
    """Return the largest von Mises stress over the yield strength, above 1, by owner, from the margins of yield.

    Lives and margins that take such stresses for elastic ones mean little: the body yields.
    """
    return {row.owner: row.value / row.allowable for row in rows if row.name == "yield" and row.margin < 0.0}


def over_yield_of(row: Margin, over: Mapping[str, float]) -> float | None:
    """Return the entry of :func:`over_yield` that marks a margin; None for margins of strengths and of a bush."""
    return None if row.name in ("yield", "ultimate", "rotation", "opening") else over.get(row.owner)


def over_yield_words(over: Mapping[str, float], owner: str) -> str:
    """Return the mark of a life or a margin of an `owner` that yields, to follow its words; else an empty text."""
    return f"; above yield: stresses reach {over[owner]:.3g} times the yield strength" if owner in over else ""


def _of_bush(problem: Problem, extremes: Found, read: Callable[[Sequence[int]], list[State]]) -> list[Margin]:
    """Return the margins against rotation and opening of a bush in its seat. One that slips has its largest slip."""
    turning = Margin("bush: rotation, friction needed", name="rotation", owner="bush")
    opening = Margin("bush: opening, press fit needed", name="opening", owner="bush")
    if problem.bush_slips:
        turning = Margin("bush: slip in its seat", owner="bush")
    least, slipping = extremes.get(("bush_open_margin", "smallest")), extremes.get(("bush_least_friction", "largest"))
    if least is None or slipping is None:
        errors = (extremes.unread.get(name) for name in ("bush_open_margin", "bush_least_friction"))
        none = f"not known: {next(filter(None, errors), 'there is no state')}"
        return [turning._replace(remark=none), opening._replace(remark=none)]
    (state,), pressure = read([least.place]), units(problem)["traction"].text(least.value, 4)
    fit = state.bush_fit()
    smallest = f"smallest pressure {pressure}" if least.value > 0.0 or not problem.bush_slips else "the bush opens"
    where = f"{smallest} at {from_bottom(fit.open_angle):z.1f} deg"
    needed = fit.pressure_to_close or math.nan  # of a loose bush it is not known: without pressure it is open anyhow
    opened = opening._replace(
        kind="traction", value=needed, allowable=fit.press_fit_pressure, load_point=least.load_point, remark=where,
        loads=state.load,
    )  # fmt: skip
    slip = extremes.get(("seat_slip", "largest magnitude"))
    if slip is not None and problem.bush_slips:
        sliding = read([slip.place])[0]
        seat = sliding.seat
        angle = math.nan if seat is None else from_bottom(seat.peak_slip_angle)
        words = f"no limit of the slip is known; largest at {angle:z.1f} deg"
        most = abs(slip.value)
        turned = turning._replace(kind="displacement", value=most, load_point=slip.load_point, remark=words)
        return [turned._replace(loads=sliding.load), opened]
    words = "not known: no friction between bush and plate given" if least.value > 0.0 else "the bush opens"
    loads = read([slipping.place])[0].load
    turned = turning._replace(value=slipping.value, load_point=slipping.load_point, remark=words, loads=loads)
    return [turned, opened]

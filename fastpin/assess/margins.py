"""Margins of safety of a result: of its last cycle, fatigue, a crack and plies, and the table of all margins.

A margin of safety is allowable/value - 1, as aerospace engineers write it: below 0 the part fails. One table serves the
terminal, JSON and reports. Margins of the states alone, such as strengths, stand in :mod:`fastpin.states.margins`.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fastpin import cracks, damage
from fastpin.assess.outputs import NUMBER, Output, aligned, map_of
from fastpin.errors import InputError
from fastpin.model import FatigueAssessment, StrengthAssessment
from fastpin.model.angles import from_bottom
from fastpin.model.crack import mouth_words
from fastpin.model.points import edge_body, isotropic_bodies, owner_of, point_words
from fastpin.model.problem import Problem
from fastpin.model.units import Unit, named_loads, printed_loads, units
from fastpin.states.cycles import Cycle
from fastpin.states.margins import (
    Margin,
    over_yield,
    over_yield_of,
    over_yield_words,
    part_of,
    smallest_margin,
    walk_margins,
)
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State

MOST_STOPS = 100
"""Most states of a cycle whose margins of fatigue are told: some tenths of a second."""

HEADS = ("subject", "value", "allowable", "margin", "load point", "loads", "remark")
"""Headings of :func:`margin_rows`."""


def margin_lines(problem: Problem, rows: Sequence[Margin]) -> list[str]:
    """Return lines of text on the margins that are known; none if no margin is known.

    The smallest one is marked, unless only a part of its body was looked at.
    """
    known = [row for row in rows if math.isfinite(row.margin)]
    if not known:
        return []
    cells = []
    for name, value, allowable, margin, point, loads, place in margin_rows(problem, known):
        where = "" if point == "-" else f"load point {point}: {loads}"
        cells.append((name, f"{value} of {allowable}", margin, where, place))
    return ["margins of safety over all kept states, allowable/value - 1:", *aligned(cells, "lrrll")]


def in_order(margins: Sequence[Margin]) -> list[Margin]:
    """Margins from the smallest one on; then those of parts that need nothing, then those that are not known."""
    return sorted(margins, key=lambda row: (math.isnan(row.margin), row.margin))


def verdict(margins: Sequence[Margin], is_complete: bool = True) -> str:
    """Return a sentence on the margin that governs, and on what is not known; without its full stop.

    A run that is not complete has a verdict on the loads that it reached only.
    """
    least, unknown = smallest_margin(margins), [row.subject for row in margins if math.isnan(row.margin)]
    words = "no margin is known"
    if least is not None:
        but = " but that of a crack that grows" if any(row.margin < 0.0 for row in margins) else ""
        safe = f"all known margins{but} are positive; the smallest{' other' * bool(but)} is that of"
        fails = "the joint fails by" if least.margin < 0.0 else safe
        where = "" if math.isnan(least.load_point) else f", load point {point_name(least.load_point)}"
        words = f"{fails} {least.subject}: {least.margin:+.2f}{where}"
        words += f", {least.part}" if least.part else ""
    words = words if is_complete else f"not known, the run is unfinished; up to its end {words}"
    return words + (f"; not known: {len(unknown)} of {len(margins)}, see their remarks" if unknown else "")


def margin_rows(problem: Problem, margins: Sequence[Margin]) -> list[tuple[str, ...]]:
    """Return rows of text under :data:`HEADS`. A margin of stresses above yield is marked."""
    unit, least, over = units(problem), smallest_margin(margins), over_yield(margins)

    def verdict(row: Margin) -> str:
        if math.isnan(row.margin):
            return "not known"
        words = "none needed" if math.isinf(row.margin) else f"{row.margin:+.2f}"
        if row is not least or row.part:  # the smallest of a part says nothing of the whole
            return words
        return f"{words}, the smallest{' known' if any(each.part for each in margins) else ''}"

    def shown(row: Margin, value: float) -> str:
        if math.isnan(value):
            return "-"
        if math.isinf(value):
            return "infinite"
        return f"{value:.3g}" if row.kind == "ratio" else unit[row.kind].text(value, 4)

    rows: list[tuple[str, ...]] = []
    for row in margins:
        point = "-" if math.isnan(row.load_point) else point_name(row.load_point)
        loads = named_loads(problem, row.loads) if row.loads else "-"
        yielded = over_yield_words(over, row.owner) if over_yield_of(row, over) else ""
        remark = "; ".join(filter(None, (row.remark, row.part))) + yielded
        rows.append((row.subject, shown(row, row.value), shown(row, row.allowable), verdict(row), point, loads, remark))
    return rows


class MarginRow(NamedTuple):
    """A margin in JSON, with its unit and what its table says of it."""

    margin: Margin
    problem: Problem
    unit: Unit
    is_smallest: bool
    over_yield: float | None


ROW = (
    Output("subject", "text", lambda row: row.margin.subject),
    Output("name", "text", lambda row: row.margin.name),
    Output("body", "text", lambda row: row.margin.owner),
    Output("value", of=lambda row: row.unit.factor * row.margin.value, optional=True),
    Output("allowable", of=lambda row: row.unit.factor * row.margin.allowable, optional=True),
    Output("unit", "text", lambda row: row.unit.name),
    Output("margin", of=lambda row: row.margin.margin, optional=True),
    Output("smallest", "truth", lambda row: row.is_smallest),
    Output("part", "text", lambda row: row.margin.part),
    Output("over_yield", words="stress over the yield strength where it is above 1", optional=True),
    Output(
        "loads", of=lambda row: printed_loads(row.problem, row.margin.loads),
        form=map_of(NUMBER, "loads of the state that governs"),
    ),
    Output("load_point", of=lambda row: row.margin.load_point, optional=True),
    Output("remark", "text", lambda row: row.margin.remark),
)  # fmt: skip
"""Outputs of a margin."""


def in_json(problem: Problem, margins: Sequence[Margin]) -> list[MarginRow]:
    """Return the subjects of :data:`ROW` for the margins of a result."""
    unit, least, over = units(problem), smallest_margin(margins), over_yield(margins)
    return [
        MarginRow(row, problem, unit[row.kind], row is least and not row.part, over_yield_of(row, over))
        for row in margins
    ]


def last_cycle_margins(problem: Problem, states: Sequence[State], cycles: Sequence[Cycle]) -> list[Margin]:
    """Return the margins over the last of the cycles that are known. None are, if a corner was not kept."""
    with contextlib.suppress(InputError):
        return cycle_margins(problem, damage.cycle_states(states, cycles[-1]) if cycles else [])
    return []


def cycle_margins(problem: Problem, stops: Sequence[State]) -> list[Margin]:
    """Return the margins over the states of a cycle: of a bush that may walk, and of fatigue by Findley.

    A body without Findley's bending and torsion limit has no margin of fatigue. No body has one if it takes long.
    """
    rows = walk_margins(stops)
    bodies = isotropic_bodies(problem) if 2 <= len(stops) <= MOST_STOPS else ()
    for body in (body for body in bodies if body != "pin"):
        with contextlib.suppress(InputError):
            found, owner = damage.fatigue(stops, "findley", body), owner_of(problem, body)
            spot, subject = found.hot_spot, f"last cycle only: {edge_body(problem, body)}, fatigue, Findley"
            limit = math.nan if found.limit is None else float(found.limit)
            place = "" if math.isnan(spot.theta) else point_words(problem, body, spot.theta, spot.depth)
            row = Margin(subject, "traction", spot.parameter, limit, remark=place, name="findley", owner=owner)
            rows.append(row._replace(part=part_of(problem, owner)))
    return rows


def reserve_margins(reserves: Sequence[damage.StressReserve], how: FatigueAssessment) -> list[Margin]:
    """Return the margins of a spectrum on stress: by what factor all stresses may grow until the goal is missed.

    The value of each row is 1, the stresses as they are, and the allowable is the factor.
    """
    return [
        Margin(
            f"{edge_body(one.problem, one.body)}: {one.criterion.title()}, factor on all stresses",
            "ratio", 1.0, one.factor, one.largest, _goal_words(one, how), one.loads, "fatigue",
            owner_of(one.problem, one.body), part_of(one.problem, owner_of(one.problem, one.body)),
        )
        for one in reserves
    ]  # fmt: skip


def _goal_words(one: damage.StressReserve, how: FatigueAssessment) -> str:
    """Return the goal of a reserve in words, and the place and the load points that govern."""
    words = f"for {'one spectrum' if how.over == 'history' else 'one cycle'}; no life is asked for"
    if one.goal.kind == "life":
        words = f"for a life of {one.goal.number:.6g} {how.passes}"
    elif one.goal.kind == "endurance":
        words = f"for endurance, the largest cycle at the knee of {one.goal.number:.6g} cycles; no life is asked for"
    if not one.is_finite:
        return f"{words}{how.reliability_words}: no stress is too large"
    ends = f"by load points {point_name(one.start)} and {point_name(one.stop)}"
    place = point_words(one.problem, one.body, one.theta, one.depth)
    return f"{words}{how.reliability_words}; {place}, {ends}"


def strength_margins(how: StrengthAssessment, state: State, strength: damage.JointStrength) -> list[Margin]:
    """Return the margin of the first ply in the worst state. The value is 1, and the allowable the strength ratio."""
    ratio = strength.least_ratio
    place = f"at {from_bottom(strength.angle):z.1f} deg, ply of {strength.ply_angle:g} deg by {strength.ply_mode}"
    remark = place if math.isfinite(ratio) else "no stress"
    point, subject = load_point(state), f"plate: first ply by {how.criterion}, factor on the stresses"
    return [Margin(subject, "ratio", 1.0, ratio, point, remark, state.load, "ply", "plate")]


def crack_margins(growth: cracks.Growth) -> list[Margin]:
    """Return the margins of a crack, each with the state that has its largest K_I.

    Fracture: toughness over the largest K_I, at the first length, and of a crack that grows on its way to the last
    length or to its arrest. Growth: threshold over the range of K_I at the first length.
    """
    length, body = units(growth.problem)["length"], growth.crack.body
    where = f"mouth at {mouth_words(growth.problem, growth.crack)}"
    subject = f"{edge_body(growth.problem, body)}: crack"

    def row(name: str, words: str, value: np.ndarray, allowable: float, at: int, remark: str) -> Margin:
        point = float(growth.largest_at[at])
        return Margin(
            f"{subject}, {words}", "stress intensity", float(value[at]), allowable, point, remark, growth.loads[point],
            name, owner_of(growth.problem, body),
        )  # fmt: skip

    rows, toughness = [], growth.law.fracture_toughness
    first, reached = length.text(float(growth.length[0])), growth.K_max[: growth.reached + 1]
    top = int(np.argmax(reached))
    lengths = {"fracture at its first length": 0}
    if growth.fate != cracks.CrackFate.NONE:
        end = "before it stops" if growth.fate == cracks.CrackFate.STOPS else "up to its last length"
        lengths[f"fracture {end}"] = top
    for words, at in lengths.items():
        remark = f"length {length.text(float(growth.length[at]), 4)}, {where}"
        if math.isinf(toughness):
            known = "not known: the law of growth has no toughness"
            rows.append(row("fracture", words, growth.K_max, math.nan, at, f"{known}; {remark}"))
        else:
            rows.append(row("fracture", words, growth.K_max, toughness, at, remark))
    threshold = float(growth.threshold[0])
    if threshold > 0.0:
        does_grow = growth.fate != cracks.CrackFate.NONE
        grows = "above its threshold it grows, and does not fail" if does_grow else "does not grow"
        rows.append(row("growth", "threshold", growth.delta_K, threshold, 0, f"length {first}, {where}; {grows}"))
    return rows

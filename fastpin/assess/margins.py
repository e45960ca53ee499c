"""Margins of safety of a result: strengths of each body, the bush in its seat, and fatigue, each with its state.

A margin of safety is allowable/value - 1, as aerospace engineers write it: below 0 the part fails. One table serves the
terminal, JSON and reports. Extremes are those of all kept states.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from fastpin.assess.outputs import NUMBER, Output, aligned, map_of
from fastpin.model.problem import Problem
from fastpin.model.units import Unit, named_loads, printed_loads, units
from fastpin.states.margins import Margin, over_yield, over_yield_of, over_yield_words, smallest_margin
from fastpin.states.quantities import point_name

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

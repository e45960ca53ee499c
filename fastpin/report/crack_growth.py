"""The growth of a crack as a curve and as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from fastpin import cracks
from fastpin.assess.crack import LENGTHS
from fastpin.cracks import CrackFate
from fastpin.model.angles import from_bottom
from fastpin.model.points import owner_of
from fastpin.model.units import units
from fastpin.report.curves import Curve
from fastpin.report.table import table
from fastpin.states.margins import over_yield_words


def growth_curve(growth: cracks.Growth) -> Curve:
    """Return length, stress intensities, range, threshold, rate and cycles of a crack, by its length."""
    unit = units(growth.problem)
    columns = {each.column(unit).replace("cycle", growth.per): each.shown(growth, unit) for each in LENGTHS[:-1]}
    mouth = {"mouth [deg]": from_bottom(growth.crack.theta), "body": growth.crack.body}
    return Curve(mouth, columns | {growth.passes: growth.cycles})


def growth_line(growth: cracks.Growth, over: Mapping[str, float] | None = None) -> str:
    """Return a line of text: the place of a crack, and what becomes of it.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.
    """
    mark = over_yield_words(over or {}, owner_of(growth.problem, growth.crack.body))
    where = " in the plate round the bush" if growth.crack.body == "seat" else ""
    line = f"crack{where} at {from_bottom(growth.crack.theta):z.2f} deg from the bottom: {growth.words}"
    if growth.fate == CrackFate.NONE or math.isnan(growth.error):
        return line + mark
    of = "length" if growth.fate == CrackFate.STOPS else "life"
    if not growth.error < 1.0:
        return f"{line}; the error of this {of} is not known{mark}"
    power = math.floor(math.log10(max(growth.error, 1e-9)))
    return f"{line}; numerical error of this {of} below {math.ceil(growth.error / 10.0**power):g}e{power:03d}{mark}"


def growth_table(growth: cracks.Growth) -> str:
    """Return some lengths of a crack with its stress intensities, threshold, rate and cycles, as text."""
    unit = units(growth.problem)
    rows = np.geomspace(growth.length[0], growth.length[-1], 13)  # at most so many lengths
    at = np.unique(np.abs(np.log(growth.length[:, None] / rows)).argmin(axis=0))
    cells = []
    for each in LENGTHS:
        same = [float(value) for other in LENGTHS if other.kind == each.kind for value in other.of(growth)]
        factor, label = unit[each.kind].scale(same) if each.kind else (1.0, "")
        texts = [f"{factor * value:.4g}" for value in each.of(growth)[at].tolist()]
        name = each.short or each.heading or each.name if each.kind else growth.passes
        cells.append((name, label.replace("cycle", growth.per), ["never" if text == "inf" else text for text in texts]))
    return table(cells)

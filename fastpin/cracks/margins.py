"""Margins of safety of a crack: against fracture at its first and its last length, and against growth."""

from __future__ import annotations

import math

import numpy as np

from fastpin.cracks.fates import CrackFate
from fastpin.cracks.growing import Growth
from fastpin.model.angles import from_bottom
from fastpin.model.points import edge_body, owner_of
from fastpin.model.units import units
from fastpin.states.margins import Margin


def crack_margins(found: Growth) -> list[Margin]:
    """Return the margins of a crack, each with the state that has its largest K_I.

    Fracture: toughness over the largest K_I, at the first length, and of a crack that grows on its way to the last
    length or to its arrest. Growth: threshold over the range of K_I at the first length.
    """
    length, body = units(found.problem)["length"], found.crack.body
    where = f"mouth at {from_bottom(found.crack.theta):z.2f} deg"
    subject = f"{edge_body(found.problem, body)}: crack"

    def row(name: str, words: str, value: np.ndarray, allowable: float, at: int, remark: str) -> Margin:
        point = float(found.largest_at[at])
        return Margin(
            f"{subject}, {words}", "stress intensity", float(value[at]), allowable, point, remark, found.loads[point],
            name, owner_of(found.problem, body),
        )  # fmt: skip

    rows, toughness = [], found.law.fracture_toughness
    first, reached = length.text(float(found.length[0])), found.K_max[: found.reached + 1]
    top = int(np.argmax(reached))
    lengths = {"fracture at its first length": 0}
    if found.fate != CrackFate.NONE:
        lengths["fracture before it stops" if found.fate == CrackFate.STOPS else "fracture up to its last length"] = top
    for words, at in lengths.items():
        remark = f"length {length.text(float(found.length[at]), 4)}, {where}"
        if math.isinf(toughness):
            known = "not known: the law of growth has no toughness"
            rows.append(row("fracture", words, found.K_max, math.nan, at, f"{known}; {remark}"))
        else:
            rows.append(row("fracture", words, found.K_max, toughness, at, remark))
    threshold = float(found.threshold[0])
    if threshold > 0.0:
        grows = "does not grow" if found.fate == CrackFate.NONE else "above its threshold it grows, and does not fail"
        rows.append(row("growth", "threshold", found.delta_K, threshold, 0, f"length {first}, {where}; {grows}"))
    return rows

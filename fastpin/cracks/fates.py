"""What becomes of a crack, and its margins of safety: against fracture on its way, and against growth."""

from __future__ import annotations

import math
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from fastpin.model import angles, points
from fastpin.model.units import units
from fastpin.states.margins import Margin


class CrackFate(IntEnum):
    """What becomes of a crack between its first and its last length."""

    NONE = 0
    """It does not start: at the first length the range is at most the threshold."""

    STOPS = 1
    """It grows, and stops before the last length."""

    GROWS = 2
    """It grows to the last length."""

    BREAKS = 3
    """It grows until the largest K_I reaches the toughness."""

    @property
    def words(self) -> str:
        """The fate in words."""
        return ("does not start", "stops", "grows", "breaks")[self]


CRACK_FATES = {int(fate): fate.words for fate in CrackFate}
"""The words of each fate, by its number."""


if TYPE_CHECKING:  # a run without a crack does not follow one
    from fastpin.cracks.growing import Growth


def crack_margins(growth: Growth) -> list[Margin]:
    """Return the margins of a crack, each with the state that has its largest K_I.

    Fracture: toughness over the largest K_I, at the first length, and of a crack that grows on its way to the last
    length or to its arrest. Growth: threshold over the range of K_I at the first length.
    """
    length, body = units(growth.problem)["length"], growth.crack.body
    where = f"mouth at {angles.from_bottom(growth.crack.theta):z.2f} deg"
    subject = f"{points.edge_body(growth.problem, body)}: crack"

    def row(name: str, words: str, value: np.ndarray, allowable: float, at: int, remark: str) -> Margin:
        point = float(growth.largest_at[at])
        return Margin(
            f"{subject}, {words}", "stress intensity", float(value[at]), allowable, point, remark, growth.loads[point],
            name, points.owner_of(growth.problem, body),
        )  # fmt: skip

    rows, toughness = [], growth.law.fracture_toughness
    first, reached = length.text(float(growth.length[0])), growth.K_max[: growth.reached + 1]
    top = int(np.argmax(reached))
    lengths = {"fracture at its first length": 0}
    if growth.fate != CrackFate.NONE:
        end = "before it stops" if growth.fate == CrackFate.STOPS else "up to its last length"
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
        grows = "does not grow" if growth.fate == CrackFate.NONE else "above its threshold it grows, and does not fail"
        rows.append(row("growth", "threshold", growth.delta_K, threshold, 0, f"length {first}, {where}; {grows}"))
    return rows

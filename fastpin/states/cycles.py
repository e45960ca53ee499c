"""Changes that one load cycle leaves behind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Cycle(NamedTuple):
    """What a cycle of a load history has changed, from its beginning to its end.

    Attributes
    ----------
    corner : int
        Index of the corner at which the cycle ends.
    length : int
        Corners of the cycle.
    number : int
        How many times its block has been run through: 1 for the first cycle.
    pressure_change, shear_change : float
        Largest difference of the tractions at a node, relative to the largest pressure; 0 where the contact is
        periodic. NaN where it is not known, because the cycle began before the history.
    dissipation : float
        Energy dissipated by friction in this cycle, J/m.
    rotation_change : float
        By how much the pin has turned (ratcheting), rad, counter-clockwise.
    solved : bool
        False where the cycle was known from before and not solved again.
    """

    corner: int
    length: int
    number: int
    pressure_change: float
    shear_change: float
    dissipation: float
    rotation_change: float
    solved: bool


def periodic_from(cycles: Sequence[Cycle]) -> Cycle | None:
    """The first of the cycles from which on all left the tractions the same, to rounding; None if there is none."""
    same = [cycle.pressure_change == 0.0 and cycle.shear_change == 0.0 for cycle in cycles]
    changing = max((k for k, steady in enumerate(same) if not steady), default=-1)
    return cycles[changing + 1] if changing + 1 < len(cycles) else None


def consecutive_cycles(cycles: Sequence[Cycle]) -> list[list[Cycle]]:
    """Cycles that follow on one another, block by block."""
    found: list[list[Cycle]] = []
    latest: dict[int, list[Cycle]] = {}
    for cycle in cycles:
        before = latest.get(cycle.length)
        if before is None or before[-1].number + 1 != cycle.number or before[-1].corner + cycle.length != cycle.corner:
            before = latest[cycle.length] = []
            found.append(before)
        before.append(cycle)
    return found

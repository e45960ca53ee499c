"""Changes of the contact over a load cycle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Cycle(NamedTuple):
    """The changes of the contact over one cycle of a load history, from beginning to end.

    Attributes
    ----------
    corner : int
        Index of the corner at which the cycle ends.
    length : int
        Number of corners of the cycle.
    number : int
        How many times the block of the cycle has been run through: 1 for the first cycle.
    pressure_change, shear_change : float
        Largest change of the traction at a node over the cycle, relative to the largest pressure. 0 means that the
        contact is periodic. NaN means that the change is unknown, because the cycle began before the history.
    dissipation : float
        Energy dissipated by friction in this cycle, J/m; NaN as above.
    rotation_change : float
        Rotation of the pin over the cycle (ratcheting), rad, counter-clockwise; NaN as above.
    solved : bool
        False if the cycle repeats an earlier one and was not solved again.
    """

    corner: int
    length: int
    number: int
    pressure_change: float
    shear_change: float
    dissipation: float
    rotation_change: float
    solved: bool


CYCLE_KINDS = dict.fromkeys(Cycle._fields, "") | {"dissipation": "energy", "rotation_change": "rotation"}
"""Kind of quantity of each field of a cycle; "" for a plain number."""


def periodic_from(cycles: Sequence[Cycle]) -> Cycle | None:
    """The first cycle from which on no cycle changes the tractions, to rounding.

    Parameters
    ----------
    cycles : sequence of Cycle
        In the order of their ends.

    Returns
    -------
    Cycle or None
        None if the last cycle still changes a traction, or if there are no cycles.
    """
    same = [cycle.pressure_change == 0.0 and cycle.shear_change == 0.0 for cycle in cycles]
    changing = max((k for k, steady in enumerate(same) if not steady), default=-1)
    return cycles[changing + 1] if changing + 1 < len(cycles) else None


def innermost_cycles(cycles: Sequence[Cycle]) -> list[Cycle]:
    """The cycles that contain no shorter one, in the order of their ends."""
    ordered, found = sorted(cycles, key=lambda cycle: (cycle.corner, cycle.length)), []
    for place, cycle in enumerate(ordered):
        begin, earlier = cycle.corner - cycle.length, (ordered[before] for before in range(place - 1, -1, -1))
        last = next((other for other in earlier if other.corner <= begin or other.length < cycle.length), None)
        if last is None or last.corner <= begin:  # no earlier, shorter cycle ended inside this one
            found.append(cycle)
    return found


def consecutive_cycles(cycles: Sequence[Cycle]) -> list[list[Cycle]]:
    """Group the cycles into runs of consecutive cycles of one block.

    Two cycles are consecutive if they have the same length, their numbers follow on each other, and the second one
    begins at the corner where the first one ends.

    Parameters
    ----------
    cycles : sequence of Cycle
        In the order of their ends.

    Returns
    -------
    list of list of Cycle
        The runs, in the order of their first cycles.
    """
    found: list[list[Cycle]] = []
    latest: dict[int, list[Cycle]] = {}
    for cycle in cycles:
        before = latest.get(cycle.length)
        if before is None or before[-1].number + 1 != cycle.number or before[-1].corner + cycle.length != cycle.corner:
            before = latest[cycle.length] = []
            found.append(before)
        before.append(cycle)
    return found

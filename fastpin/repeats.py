"""Configurations that were met before: where a contact has become periodic, the same cycle gives the same bits.

What a step does depends on nothing but its load and the configuration at its start, to the last bit. Under constant
amplitude a contact settles, after one cycle or several, into configurations that repeat, but for rounding. Here the
configuration at a corner that differs from one met before under the same load by rounding only is replaced by that
one. From there on everything repeats exactly, whether it is solved again or not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fastpin.collocation import Configuration

SAME = 5e-14
"""Differences below this part of the largest gap, or of the largest slip or motion, are rounding: ten times what is
left between the cycles of a contact that has settled."""

MOST_KEPT = 32
"""Configurations that are remembered: so many of the latest corners, and so many of the latest ends of cycles."""


@dataclass(eq=False)
class Met:
    """A configuration that was met at a corner.

    Attributes
    ----------
    configuration : Configuration
    ends_cycle : bool
        Whether a cycle ended at that corner. Such corners are remembered for longer.
    last : int
        The latest corner of the present history at which it was met; -1 in a history before.
    period, since : int
        Corners after which it was met again, and the corner from which on that was so; a period of 0 before.
    """

    configuration: Configuration
    ends_cycle: bool
    last: int
    period: int = 0
    since: int = 0

    def __post_init__(self) -> None:
        self.load = self.configuration.load.tobytes()


class Repeats:
    """The configurations that are remembered, the latest at the end."""

    def __init__(self, met: list[Met] | None = None) -> None:
        self._met = [] if met is None else met

    def __iter__(self) -> Iterator[Met]:
        return iter(self._met)

    def copy(self, same_history: bool = False) -> Repeats:
        """For a history that goes on from here, and may not be the only one."""
        return Repeats([replace(met) if same_history else replace(met, last=-1, period=0) for met in self._met])

    def meet(self, now: Configuration, ends_cycle: bool, corner: int) -> Met | None:
        """The remembered configuration that `now`, reached at a corner, is but for rounding.

        If there is none, `now` is remembered and None returned.
        """
        load = now.load.tobytes()
        for met in reversed(self._met):
            if met.load == load and _same(met.configuration, now):
                self._met.remove(met)
                met.ends_cycle |= ends_cycle
                period = corner - met.last if met.last >= 0 else 0
                if period != met.period:
                    met.period, met.since = period, met.last
                met.last = corner
                self._add(met)
                return met
        self._add(Met(now, ends_cycle, corner))
        return None

    def _add(self, met: Met) -> None:
        self._met.append(met)
        alike = [k for k, other in enumerate(self._met) if other.ends_cycle == met.ends_cycle]
        if len(alike) > MOST_KEPT:
            del self._met[alike[0]]


def _same(one: Configuration, two: Configuration) -> bool:
    """Whether two configurations under the same load differ by rounding only."""
    if not np.array_equal(one.status, two.status):
        return False
    moved = max(float(np.abs(two.motion).max()), float(np.abs(two.slip).max()))
    apart = float(np.abs(two.gap).max())
    scales = {"motion": moved, "slip": moved, "rest_slip": moved, "gap": apart, "rest_gap": apart, "rest": apart}
    return all(
        bool(np.all(np.abs(getattr(one, name) - getattr(two, name)) <= SAME * scale)) for name, scale in scales.items()
    ) and np.array_equal(one.origin, two.origin, equal_nan=True)

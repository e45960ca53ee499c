"""Periodic contact: recognise it at a corner, and take what follows from the log of corners.

A step depends on nothing but its load and the configuration at its start, to the last bit. Under constant amplitude a
contact settles, after one cycle or several, into configurations that repeat up to rounding. :class:`Repeats` replaces
the configuration at a corner by an earlier one under the same load that differs by rounding only. From there on
everything repeats exactly, whether it is solved again or not. :class:`CornerLog` keeps the energies, states and cycles
of the latest corners, and says how often a period comes again.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from fastpin.elasticity.system import Scales
from fastpin.model.history import CycleKey, LoadHistory
from fastpin.model.options import KeepRule
from fastpin.solver.configuration import Configuration
from fastpin.states.cycles import Cycle

MOST_LOGGED = 1024
"""Corners that are looked back on, or those of the longest cycle."""


@dataclass(eq=False)
class CycleEnd:
    """The end of a cycle, or the corner with which the first one begins, and the energy dissipated since."""

    corner: int
    number: int
    configuration: Configuration
    dissipation: float = 0.0


@dataclass(eq=False)
class CornerEntry:
    """A corner: energies on the way to it, those at the states that were kept on that way, cycles that ended there."""

    dissipation: float = 0.0
    work: float = 0.0
    kept: list[tuple[float, float]] = field(default_factory=list)
    cycles: list[tuple[CycleKey, Cycle]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Period:
    """Corners that come again so many times, and by how much the number of each of their cycles grows each time."""

    logged: list[CornerEntry]
    times: int
    counts: dict[CycleKey, int]


def copies(marks: dict[CycleKey, CycleEnd]) -> dict[CycleKey, CycleEnd]:
    """Marks that can go on changing by themselves."""
    return {key: replace(mark) for key, mark in marks.items()}


class CornerLog:
    """What a run remembers of the corners before.

    Parameters
    ----------
    history : LoadHistory
    marks : dict
        Of an earlier part of the same history; they are copied.

    Attributes
    ----------
    marks : dict
        The latest end of each cycle, or its beginning.
    log : deque of Logged
        The latest corners.
    """

    def __init__(self, history: LoadHistory, marks: dict[CycleKey, CycleEnd]) -> None:
        self.history = history
        self.marks = copies(marks)
        self.log: deque[CornerEntry] = deque(maxlen=max(MOST_LOGGED, history.longest_cycle))

    @property
    def latest(self) -> CornerEntry:
        """The entry of the step that is being followed, or of the last corner."""
        return self.log[-1]

    def begin_step(self) -> None:
        """Open the entry of the next corner."""
        self.log.append(CornerEntry())

    def close_step(self, dissipation: float, work: float) -> None:
        """Book the energies of the step that has come to its corner."""
        self.log[-1].dissipation, self.log[-1].work = dissipation, work
        for mark in self.marks.values():
            mark.dissipation += dissipation

    def begin_cycles(self, corner: int, now: Configuration) -> None:
        """Mark a corner as the beginning of the cycles that begin after it."""
        for key in self.history.cycles_after(corner):
            if key not in self.marks or self.marks[key].corner != corner:
                self.marks[key] = CycleEnd(corner, 0, now)

    def end_cycles(
        self, ended: list[CycleKey], corner: int, now: Configuration, scales: Scales
    ) -> list[tuple[int, int]]:
        """Log what the cycles that end at a corner have changed.

        Returns
        -------
        list of (int, int)
            Length and beginning of those that led back to the very configuration with which they began.
        """
        periods = []
        for key in ended:
            mark, length = self.marks.get(key), self.history.cycle_length(key)
            number, changes = 1, (math.nan, math.nan, math.nan, math.nan)
            if mark is not None and mark.corner == corner - length:
                number, then = mark.number + 1, mark.configuration
                peak = max(float(now.pressure.max()), float(then.pressure.max()), 1e-300)
                changes = (
                    float(np.abs(now.pressure - then.pressure).max()) / peak,
                    float(np.abs(now.shear - then.shear).max()) / peak,
                    mark.dissipation * scales.energy,
                    float(now.motion[2] - then.motion[2]) * scales.rotation,
                )
                if now.slip is then.slip:
                    periods.append((length, mark.corner))
            self.marks[key] = CycleEnd(corner, number, now)
            self.log[-1].cycles.append((key, Cycle(corner, length, number, *changes, True)))
        for key in [key for key, mark in self.marks.items() if mark.corner < corner - self.history.cycle_length(key)]:
            del self.marks[key]
        return periods

    def period(self, now: int, length: int, since: int, keep: KeepRule, stops: Collection[int]) -> Period | None:
        """What comes again after the corner `now`.

        Its configuration is that of every `length` corners before, back to the corner `since`. None if the loads ahead
        are others, or not all is known of the period. What comes again keeps clear of corners that are kept if none of
        them has been before, and of `stops`, numbers of corners.
        """
        history, following = self.history, now + 1
        with_kept = math.lcm(length, keep.every)  # so that the same corners are kept
        unkept = now - since < with_kept  # as far as nothing is kept, then
        length = length if unkept else with_kept
        if length == 0 or len(self.log) < length or now - since < length:
            return None
        ahead = history.same_ahead(following, length)
        if unkept:
            ahead = min(ahead, keep.every - 1 - following % keep.every)
        ahead = min(ahead, min((stop for stop in stops if stop > following), default=len(history)) - following)
        if ahead < length:
            return None
        logged = [self.log[k - length] for k in range(length)]
        begin = now - length
        if any(cycle.corner - cycle.length < begin for entry in logged for _, cycle in entry.cycles):
            return None  # a cycle that began before: what it changed will not be repeated
        if any(mark.number == 0 and mark.corner > begin for mark in self.marks.values()):
            return None  # one that has begun and not ended
        if unkept:
            logged = [replace(entry, kept=[]) for entry in logged]
        return Period(logged, ahead // length, _counts(logged, begin))

    def again(self, period: Period, time: int, corner: int) -> list[CornerEntry]:
        """The corners of a period for the `time`-th time again, the first of them the corner `corner`; logged too."""
        length = len(period.logged)
        later = [
            replace(
                entry,
                cycles=[
                    (key, c._replace(corner=c.corner + time * length, number=c.number + time * period.counts[key]))
                    for key, c in entry.cycles
                ],
            )
            for entry in period.logged
        ]
        self.log.extend(later)
        for key, mark in self.marks.items():
            if mark.corner >= corner - length:
                mark.corner += length
                mark.number += period.counts.get(key, 0) if mark.number else 0
            else:
                for entry in later:
                    mark.dissipation += entry.dissipation
        return later


def _counts(logged: list[CornerEntry], begin: int) -> dict[CycleKey, int]:
    """By how much the numbers of the cycles grow in a period that begins at the corner `begin`.

    Those of cycles that begin anew in every period do not.
    """
    cycles = [pair for entry in logged for pair in entry.cycles]
    ended = {key for key, _ in logged[-1].cycles}
    counts = Counter(key for key, _ in cycles)
    for key, cycle in cycles:
        if cycle.number == 1 and (cycle.corner - cycle.length > begin or key not in ended):
            counts[key] = 0
    return counts


SAME = 5e-14
"""Differences below this part of the largest gap, or of the largest slip or motion, are rounding: ten times what is
left between the cycles of a contact that has settled."""

MOST_KEPT = 32
"""Configurations that are remembered: so many of the latest corners, and so many of the latest ends of cycles."""


@dataclass(eq=False)
class KnownConfiguration:
    """A configuration that was known at a corner.

    Attributes
    ----------
    configuration : Configuration
    ends_cycle : bool
        Whether a cycle ended at that corner. Such corners are remembered for longer.
    last : int
        The latest corner of the present history at which it was met; -1 in a history before.
    period, since : int
        Corners after which it was known again, and the corner from which on that was so; a period of 0 before.
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

    def __init__(self, known: list[KnownConfiguration] | None = None) -> None:
        self._known = [] if known is None else known

    def __iter__(self) -> Iterator[KnownConfiguration]:
        return iter(self._known)

    def copy(self, same_history: bool = False) -> Repeats:
        """For a history that goes on from here, and may not be the only one."""
        return Repeats([replace(known) if same_history else replace(known, last=-1, period=0) for known in self._known])

    def recall(self, now: Configuration, ends_cycle: bool, corner: int) -> KnownConfiguration | None:
        """The remembered configuration that `now`, reached at a corner, is but for rounding.

        If there is none, `now` is remembered and None returned.
        """
        load = now.load.tobytes()
        for known in reversed(self._known):
            if known.load == load and _same(known.configuration, now):
                self._known.remove(known)
                known.ends_cycle |= ends_cycle
                period = corner - known.last if known.last >= 0 else 0
                if period != known.period:
                    known.period, known.since = period, known.last
                known.last = corner
                self._add(known)
                return known
        self._add(KnownConfiguration(now, ends_cycle, corner))
        return None

    def _add(self, known: KnownConfiguration) -> None:
        self._known.append(known)
        alike = [k for k, other in enumerate(self._known) if other.ends_cycle == known.ends_cycle]
        if len(alike) > MOST_KEPT:
            del self._known[alike[0]]


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

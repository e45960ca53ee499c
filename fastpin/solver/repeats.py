"""Periodic contact: recognise it at a corner, and take the corners that follow from the log.

A step depends only on its load and the configuration at its start, to the last bit. Under constant amplitude a contact
settles, after one cycle or several, into configurations that repeat up to rounding. :class:`Repeats` recalls the
earlier configuration under the same load that differs from the present one by rounding only; the run then takes the
earlier one. From there on everything repeats exactly, whether it is solved again or not. :class:`CornerLog` logs the
energies, states and cycles of the latest corners, and finds how often a period repeats.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fastpin.elasticity.system import Scales
from fastpin.model.history import CycleKey, LoadHistory, cycle_length, cycles_after, same_ahead
from fastpin.model.options import KeepRule
from fastpin.solver.configuration import Configuration
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.states.cycles import Cycle


@dataclass(eq=False)
class CycleEnd:
    """The latest end of a cycle, or the beginning of the first one, and the energy dissipated since.

    Attributes
    ----------
    corner : int
        Index of the corner; -1 for the start of the history.
    number : int
        Number of the cycle that ends there; 0 at the beginning of the first one.
    configuration : Configuration
        The configuration at the corner.
    dissipation : float
        Energy dissipated since that corner (dimensionless).
    """

    corner: int
    number: int
    configuration: Configuration
    dissipation: float = 0.0


@dataclass(eq=False)
class CornerEntry:
    """The entry of one corner in the log.

    Attributes
    ----------
    dissipation, work : float
        Energies of the step to the corner (dimensionless).
    kept : list of (float, float)
        Dissipation and work at each kept state of that step, counted from the corner before.
    cycles : list of (CycleKey, Cycle)
        The cycles that end at the corner.
    slip_tally : SlipTally
        The slip tally of the step. No slip if every corner is kept.
    """

    dissipation: float = 0.0
    work: float = 0.0
    kept: list[tuple[float, float]] = field(default_factory=list)
    cycles: list[tuple[CycleKey, Cycle]] = field(default_factory=list)
    slip_tally: SlipTally = NOT_COUNTED


def copied_ends(marks: dict[CycleKey, CycleEnd]) -> dict[CycleKey, CycleEnd]:
    """Copies of cycle ends. They change independently of the originals."""
    return {key: replace(mark) for key, mark in marks.items()}


class CornerLog:
    """The log of the latest corners of a run, and the latest end of each cycle.

    Parameters
    ----------
    history : LoadHistory
    marks : dict of CycleKey to CycleEnd
        Cycle ends of an earlier part of the same history. They are copied.

    Attributes
    ----------
    marks : dict of CycleKey to CycleEnd
        The latest end of each cycle, or its beginning.
    log : deque of CornerEntry
        The latest corners.
    """

    def __init__(self, history: LoadHistory, marks: dict[CycleKey, CycleEnd]) -> None:
        self.history = history
        self.marks = copied_ends(marks)
        self.log: deque[CornerEntry] = deque(maxlen=max(1024, history.longest_cycle))

    @property
    def latest(self) -> CornerEntry:
        """The entry of the present step, or of the last corner."""
        return self.log[-1]

    def begin_step(self) -> None:
        """Open the entry of the next corner."""
        self.log.append(CornerEntry())

    def close_step(self, dissipation: float, work: float, slip_tally: SlipTally) -> None:
        """Log the energies and the slip tally (dimensionless) of the step that has reached its corner."""
        self.log[-1].dissipation, self.log[-1].work, self.log[-1].slip_tally = dissipation, work, slip_tally
        for mark in self.marks.values():
            mark.dissipation += dissipation

    def begin_cycles(self, corner: int, now: Configuration) -> None:
        """Note the beginning of the cycles that begin after a corner; -1 for the start of the history."""
        for key in cycles_after(self.history, corner):
            if key not in self.marks or self.marks[key].corner != corner:
                self.marks[key] = CycleEnd(corner, 0, now)

    def end_cycles(
        self, ended: list[CycleKey], corner: int, now: Configuration, scales: Scales
    ) -> list[tuple[int, int]]:
        """Log the changes of the cycles that end at a corner.

        Parameters
        ----------
        ended : list of CycleKey
            The cycles that end there.
        corner : int
        now : Configuration
            The configuration at the corner.
        scales : Scales

        Returns
        -------
        list of (int, int)
            Length and first corner of each cycle that ends in exactly the configuration with which it began.
        """
        periods = []
        for key in ended:
            mark, length = self.marks.get(key), cycle_length(self.history, key)
            number, changes = 1, (math.nan, math.nan, math.nan, math.nan)
            if mark is not None and mark.corner == corner - length:
                number, earlier = mark.number + 1, mark.configuration
                peak = max(float(now.pressure.max()), float(earlier.pressure.max()), 1e-300)
                changes = (
                    float(np.abs(now.pressure - earlier.pressure).max()) / peak,
                    float(np.abs(now.shear - earlier.shear).max()) / peak,
                    mark.dissipation * scales.energy,
                    float(now.motion[2] - earlier.motion[2]) * scales.rotation,
                )
                if now.slip is earlier.slip:
                    periods.append((length, mark.corner))
            self.marks[key] = CycleEnd(corner, number, now)
            self.log[-1].cycles.append((key, Cycle(corner, length, number, *changes, True)))
        for key in [key for key, mark in self.marks.items() if mark.corner < corner - cycle_length(self.history, key)]:
            del self.marks[key]
        return periods

    def period(
        self, now: int, length: int, since: int, keep: KeepRule, save_after: Collection[int]
    ) -> tuple[list[CornerEntry], int, dict[CycleKey, int]] | None:
        """Find the period that repeats after the corner `now`.

        Parameters
        ----------
        now : int
            Index of the present corner.
        length : int
            Corners of the period.
        since : int
            First corner of the periodic contact. The configuration at `now` returns every `length` corners from there.
        keep : KeepRule
            The rule for kept states. Until the contact has been periodic for a common multiple of `length` and
            ``keep.every`` corners, only corners before the next kept corner repeat.
        save_after : collection of int
            Numbers of corners after which a restart is saved. The period repeats to the next one of them at most.

        Returns
        -------
        (list of CornerEntry, int, dict of CycleKey to int), or None
            The corners of one period, how many times it repeats, and by how much the number of each cycle grows from
            one period to the next. None if the loads ahead differ, or if the log lacks a part of the period.
        """
        history, following = self.history, now + 1
        with_kept = math.lcm(length, keep.every)  # so that the same corners are kept
        unkept = now - since < with_kept  # then only corners without a kept state repeat
        length = length if unkept else with_kept
        if length == 0 or len(self.log) < length or now - since < length:
            return None
        ahead = same_ahead(history, following, length)
        if unkept:
            ahead = min(ahead, keep.every - 1 - following % keep.every)
        ahead = min(
            ahead, min((corner for corner in save_after if corner > following), default=len(history)) - following
        )
        if ahead < length:
            return None
        logged = [self.log[k - length] for k in range(length)]
        begin = now - length
        cycles = [pair for entry in logged for pair in entry.cycles]
        if any(cycle.corner - cycle.length < begin for _, cycle in cycles):
            return None  # a cycle began before the period: its changes will not repeat
        if any(mark.number == 0 and mark.corner > begin for mark in self.marks.values()):
            return None  # a cycle has begun in the period and not ended
        if unkept:
            logged = [replace(entry, kept=[]) for entry in logged]
        ended, counts = {key for key, _ in logged[-1].cycles}, Counter(key for key, _ in cycles)
        for key, cycle in cycles:
            if cycle.number == 1 and (cycle.corner - cycle.length > begin or key not in ended):
                counts[key] = 0  # it begins anew in every period
        return logged, ahead // length, counts

    def again(
        self, logged: list[CornerEntry], counts: dict[CycleKey, int], time: int, corner: int
    ) -> list[CornerEntry]:
        """Log the corners of a period once more, and return their entries; see :meth:`period`.

        `time` counts the repetitions from 1. `corner` is the first corner of this repetition.
        """
        length = len(logged)
        later = [
            replace(
                entry,
                cycles=[
                    (key, c._replace(corner=c.corner + time * length, number=c.number + time * counts[key]))
                    for key, c in entry.cycles
                ],
            )
            for entry in logged
        ]
        self.log.extend(later)
        for key, mark in self.marks.items():
            if mark.corner >= corner - length:
                mark.corner += length
                mark.number += counts.get(key, 0) if mark.number else 0
            else:
                for entry in later:
                    mark.dissipation += entry.dissipation
        return later


SAME = 5e-14
"""Relative difference of two configurations that is rounding: ten times the difference left between the cycles of a
settled contact. Gaps are relative to the largest gap, slip and motion to the largest of both."""

MOST_KEPT = 32
"""Remembered configurations: at most this many of the latest corners, and this many of the latest ends of cycles."""


@dataclass(eq=False)
class KnownConfiguration:
    """A remembered configuration at a corner.

    Attributes
    ----------
    configuration : Configuration
    ends_cycle : bool
        Whether a cycle ended at that corner. Such corners are remembered for longer.
    last : int
        Latest corner of the present history with this configuration; -1 if only an earlier history has reached it.
    period : int
        Corners from one return of the configuration to the next; 0 before it has returned.
    since : int
        First corner from which on it has returned after `period` corners each time.
    load : bytes
        The bits of its load.
    """

    configuration: Configuration
    ends_cycle: bool
    last: int
    period: int = 0
    since: int = 0

    def __post_init__(self) -> None:
        self.load = self.configuration.load.tobytes()


class Repeats:
    """The remembered configurations, with the latest one at the end."""

    def __init__(self, known: list[KnownConfiguration] | None = None) -> None:
        self._known = [] if known is None else known

    def __iter__(self) -> Iterator[KnownConfiguration]:
        return iter(self._known)

    def copy(self, same_history: bool = False) -> Repeats:
        """A copy for one of the histories that continue from here.

        The copy remembers the corners of the configurations only with `same_history`.
        """
        forgotten: dict[str, Any] = {} if same_history else {"last": -1, "period": 0}
        return Repeats([replace(known, **forgotten) for known in self._known])

    def recall(self, now: Configuration, ends_cycle: bool, corner: int) -> KnownConfiguration | None:
        """Return the remembered configuration equal to `now` up to rounding, or remember `now` and return None.

        Parameters
        ----------
        now : Configuration
            The configuration at the corner.
        ends_cycle : bool
            Whether a cycle ends there.
        corner : int
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
        alike = [k for k, entry in enumerate(self._known) if entry.ends_cycle == known.ends_cycle]
        if len(alike) > MOST_KEPT:
            del self._known[alike[0]]


def _same(known: Configuration, now: Configuration) -> bool:
    """Whether two configurations under the same load differ by rounding only."""
    if not np.array_equal(known.status, now.status):
        return False
    motion = max(float(np.abs(now.motion).max()), float(np.abs(now.slip).max()))
    gap = float(np.abs(now.gap).max())
    scales = {"motion": motion, "slip": motion, "rest_slip": motion, "gap": gap, "rest_gap": gap, "rest": gap}
    for name, scale in scales.items():
        one, other = getattr(known, name), getattr(now, name)
        if one is not other and not np.all(np.abs(one - other) <= SAME * scale):
            return False
    return known.origin is now.origin or np.array_equal(known.origin, now.origin, equal_nan=True)

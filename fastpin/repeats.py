"""Steps that were followed before: a step between the same loads from the same configuration needs no solution.

What a step does depends on nothing but its two loads and the configuration at its start: statuses, gap and slip (the
tractions follow from them), and where the pin rested. Under constant amplitude a contact settles, after one cycle or
several, into states that repeat; from there on every cycle is known.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np

from fastpin.collocation import Configuration, Scales
from fastpin.state import State

SAME = 5e-14
"""Differences below this part of the largest gap, or of the largest slip or motion, are rounding: ten times what is
left between the cycles of a contact that has settled."""

LATEST = 50
"""Steps between the same loads that are looked at, the latest first."""

MOST_NODES = 2_000_000
"""Nodes of all configurations and states that are remembered (some 100 MB); with more, all are forgotten."""


@dataclass(frozen=True, eq=False)
class Step:
    """A step that was followed, and the states that were kept of it."""

    before: Configuration
    after: Configuration
    states: list[State]

    def again(self, now: Configuration, scales: Scales, number: int) -> tuple[Configuration, list[State]]:
        """The configuration and the states of the same step from `now` on, as step `number` of a history."""
        dissipation, work = now.dissipation - self.before.dissipation, now.work - self.before.work
        after = self.after.copy()
        after.dissipation += dissipation
        after.work += work
        states = [
            replace(
                state,
                step=number,
                dissipation=state.dissipation + dissipation * scales.energy,
                work=state.work + work * scales.energy,
                load=dict(state.load),
                residuals=dict(state.residuals),
            )
            for state in self.states
        ]
        return after, states


class Repeats:
    """The steps of a history so far."""

    def __init__(self) -> None:
        self._steps: dict[Hashable, list[Step]] = {}
        self._nodes = 0

    def copy(self) -> Repeats:
        """For a history that goes on from here, and may not be the only one."""
        new = Repeats()
        new._steps = {key: list(steps) for key, steps in self._steps.items()}
        new._nodes = self._nodes
        return new

    def find(self, key: Hashable, now: Configuration) -> Step | None:
        """The latest step with this `key` (its loads, and how it was followed) from the configuration `now`."""
        for step in reversed(self._steps.get(key, [])[-LATEST:]):
            if _same(step.before, now):
                return step
        return None

    def add(self, key: Hashable, step: Step) -> None:
        """Remember a step."""
        if self._nodes > MOST_NODES:
            self._steps.clear()
            self._nodes = 0
        self._steps.setdefault(key, []).append(step)
        self._nodes += step.after.status.size * (1 + len(step.states))


def _same(one: Configuration, two: Configuration) -> bool:
    """Whether two configurations under the same load differ by rounding only."""
    moved = max(float(np.abs(two.motion).max()), float(np.abs(two.slip).max()))
    apart = float(np.abs(two.gap).max())
    scales = {"motion": moved, "slip": moved, "rest_slip": moved, "gap": apart, "rest_gap": apart, "rest": apart}
    return (
        all(
            bool(np.all(np.abs(getattr(one, name) - getattr(two, name)) <= SAME * scale))
            for name, scale in scales.items()
        )
        and np.array_equal(one.status, two.status)
        and np.array_equal(one.origin, two.origin, equal_nan=True)
    )

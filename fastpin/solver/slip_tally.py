"""The slip tally: slip distance, friction energy and extremes of slip of each node over a part of a history.

A :class:`SlipTally` belongs to a part of a history. A :class:`RunningTally` says over which part a run counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fastpin.elasticity.system import Scales
from fastpin.model.options import KeepRule
from fastpin.states.state import SlipFields


@dataclass(frozen=True, eq=False)
class SlipTally:
    """What each node has slipped over a part of a history, dimensionless, or :data:`NOT_COUNTED`.

    Attributes
    ----------
    sums : ndarray, shape (4, n) or (5, n)
        Slip distance int |ds|, friction energy int -T ds, lowest and highest slip of each node while closed. The
        extremes are the slip that users see, and (inf, -inf) at a node that was never closed. In a run with wear, the
        fifth row is int N |ds|. Compiled code adds to this array.
    """

    sums: np.ndarray

    @classmethod
    def empty(cls, nodes: int, wears: bool = False) -> SlipTally:
        """The tally of so many nodes that were never closed; with `wears` it has the row of int N |ds|."""
        return cls(np.tile([[0.0], [0.0], [np.inf], [-np.inf]] + [[0.0]] * wears, nodes))

    @property
    def is_counted(self) -> bool:
        """Whether slip is counted. Compiled code takes an array without columns as a tally that is not counted."""
        return self.sums.size > 0

    def copy(self) -> SlipTally:
        """A copy that compiled code can add to."""
        return SlipTally(self.sums.copy())

    def part(self, nodes: np.ndarray) -> SlipTally:
        """The tally of some `nodes` only, indices of shape (k,)."""
        return SlipTally(self.sums.take(nodes, axis=1)) if self.is_counted else self

    def with_part(self, nodes: np.ndarray, part: SlipTally) -> SlipTally:
        """This tally with the tally `part` of some `nodes`, indices of shape (k,)."""
        if not part.is_counted:
            return part
        whole = self.copy()
        whole.sums[:, nodes] = part.sums
        return whole

    def joined(self, later: SlipTally) -> SlipTally:
        """The tally of this part of a history and the `later` part together; not counted if the later part is not."""
        if not later.is_counted:
            return later
        first, second = self.sums, later.sums
        lowest, highest = np.minimum(first[2], second[2]), np.maximum(first[3], second[3])
        return SlipTally(np.array([*(first[:2] + second[:2]), lowest, highest, *(first[4:] + second[4:])]))

    def fields(self, scales: Scales) -> SlipFields:
        """The fields of a state whose part of the history this is, SI; none if it is not counted."""
        if not self.is_counted:
            return {}
        lowest, highest = np.where(self.sums[2] <= self.sums[3], self.sums[2:4], np.nan) * scales.displacement
        distance = self.sums[0] * scales.displacement
        energy = self.sums[1] * (scales.traction * scales.displacement)
        for array in (distance, energy, lowest, highest):
            array.setflags(write=False)
        return {"slip_distance": distance, "friction_energy": energy, "slip_lowest": lowest, "slip_highest": highest}


NOT_COUNTED = SlipTally(np.zeros((4, 0)))
"""The tally of a run that does not count slip."""


class RunningTally:
    """The tally of a run since its latest kept state.

    Slip distance and friction energy begin anew at every kept state. The extremes can't be subtracted: they begin anew
    at kept corners only.

    Parameters
    ----------
    new : SlipTally
        The tally with which a step begins: an empty one, or :data:`NOT_COUNTED`.
    keep : KeepRule
        The rule for kept states.
    before : SlipTally
        The tally of an earlier part of the history since its latest kept state.

    Attributes
    ----------
    new : SlipTally
    to_corner : SlipTally
        The tally from the latest kept state to the last corner.
    """

    def __init__(self, new: SlipTally, keep: KeepRule, before: SlipTally) -> None:
        self.new = new
        self.to_corner = before if new.is_counted and before.is_counted else new
        self._until_kept = new  # the tally of the present step up to its latest kept state
        self._restarts_each_corner = keep.every_corner or not new.is_counted

    def since_kept(self, step: SlipTally) -> SlipTally:
        """The tally since the latest kept state. `step` is the tally of the present step."""
        if not step.is_counted:
            return step
        since = step.copy()
        since.sums[:2] -= self._until_kept.sums[:2]
        since.sums[4:] -= self._until_kept.sums[4:]
        return self.to_corner.joined(since)

    def keep(self, step: SlipTally) -> None:
        """Begin anew at a kept state. `step` is the tally of the present step."""
        self.to_corner, self._until_kept = self.new, step

    def close_step(self, step: SlipTally, is_kept: bool) -> SlipTally:
        """End a step with the tally `step` at a corner. `is_kept` says whether the state there was kept.

        Returns the tally of the step for the log of corners: :attr:`new` where no other corner asks for it.
        """
        self.to_corner, self._until_kept = self.new if is_kept else self.since_kept(step), self.new
        return self.new if self._restarts_each_corner else step

    def repeat(self, steps: list[tuple[SlipTally, bool]], time: int) -> SlipTally | None:
        """Add steps that are not solved again: for each its tally, and whether it has kept states.

        `time` counts the repetitions of the steps. Returns the tally of the first kept state. None if it equals the
        tally of a period before.
        """
        if self._restarts_each_corner or (time > 2 and any(has_kept for _, has_kept in steps)):
            return None  # the repetition before began with the same slip tally, and ended with it
        first = None
        for step, has_kept in steps:
            self.to_corner = self.to_corner.joined(step)
            if has_kept:
                first = self.to_corner if first is None else first
                self.to_corner = self.new
        return first

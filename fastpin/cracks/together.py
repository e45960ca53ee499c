"""Cracks that grow together from one hole: at each moment they shield one another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.cracks.fates import CrackFate
from fastpin.cracks.intensity import Crack, CrackedEdge, Residual, check_apart, histories, sliding_doubt
from fastpin.errors import InputError, InputWarning
from fastpin.model.checks import instances, numbers
from fastpin.model.crack import MOST_OF_LIGAMENT, check_length
from fastpin.model.doubts import warn_of
from fastpin.model.growth import GrowthLaw, checked_law
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units
from fastpin.runtime.extensions import Later
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.state import State

integrate = Later("scipy.integrate")

ROUGH, EXACT = 1e-6, 1e-7
"""Relative tolerances of a step. The second path is the result, and its difference from the first one the error."""


@dataclass(frozen=True, eq=False, repr=False)
class GrowthTogether(ReadOnly):
    """The growth of several cracks over many load cycles.

    Attributes
    ----------
    problem : Problem
    cracks : tuple of Crack
    law : GrowthLaw
    cycles : ndarray, shape (n,)
        Cycles from the first lengths on.
    length : ndarray, shape (n, cracks)
        m.
    K_max, K_min, K_II : ndarray, shape (n, cracks)
        Largest and smallest K_I of the cycle, and K_II at the largest, Pa sqrt(m).
    fate : CrackFate
        Whether all stop, one grows to its last length, or one breaks the plate: by its toughness, or at 0.95 of its
        ligament in a plate of any outline.
    error : float
        Estimated relative error of the life by the steps of the path.
    doubts : tuple of InputWarning
        Reasons to doubt the numbers.
    """

    problem: Problem
    cracks: tuple[Crack, ...]
    law: GrowthLaw
    cycles: np.ndarray
    length: np.ndarray
    K_max: np.ndarray
    K_min: np.ndarray
    K_II: np.ndarray
    fate: CrackFate
    error: float
    doubts: tuple[InputWarning, ...]

    def __repr__(self) -> str:
        return f"<GrowthTogether of {len(self.cracks)} cracks: {self.words}>"

    @property
    def life(self) -> float:
        """Cycles until one crack comes to its last length or breaks the plate; infinite if all stop before."""
        return math.inf if self.fate in (CrackFate.NONE, CrackFate.STOPS) else float(self.cycles[-1])

    @property
    def words(self) -> str:
        """A sentence on lengths and life."""
        text = units(self.problem)["length"].text
        first, last = (" and ".join(text(value, 4) for value in row.tolist()) for row in self.length[[0, -1]])
        if self.fate == CrackFate.NONE:
            return f"no growth at {first}"
        if self.fate == CrackFate.STOPS:
            return f"grow from {first} and stop at {last}"
        to = "to fracture at" if self.fate == CrackFate.BREAKS else "to"
        return f"grow from {first} {to} {last} in {self.life:.3g} cycles"


class _Cracks(NamedTuple):
    """Cracks under a cycle. Their lengths count as x = ln a, up to `ends`: a step that goes beyond has K of there."""

    stops: Sequence[State]
    edge: CrackedEdge
    cracks: tuple[Crack, ...]
    law: GrowthLaw
    residual: Residual | None
    ends: np.ndarray
    known: dict[bytes, np.ndarray]

    def intensities(self, x: np.ndarray) -> np.ndarray:
        """K_max, K_min and K_II of each crack, shape (3, cracks)."""
        x = np.minimum(x, self.ends)
        key = x.tobytes()
        if key not in self.known:
            rows = [self.edge.lines(self.cracks, np.exp(x))]
            check_apart(rows)
            K = histories(self.stops, self.edge, rows, np.zeros(1), self.residual)[:, 0, 0]
            top = K[..., 0].argmax(axis=0)
            self.known[key] = np.array(
                [K[..., 0].max(axis=0), K[..., 0].min(axis=0), np.take_along_axis(K[..., 1], top[None], axis=0)[0]]
            )
        return self.known[key]

    def margins(self, x: np.ndarray) -> tuple[float, float]:
        """The range less the threshold, and the largest K_I less the toughness, both of the worst crack."""
        top, bottom, _ = self.intensities(x)
        above = self.law.range(top, bottom) - self.law.threshold(top, bottom, np.exp(x))
        return float(above.max()), float(top.max()) - self.law.fracture_toughness

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """Growth of all x, and cycles, while the x of the fastest crack grows by 1; shape (cracks + 1,)."""
        top, bottom, _ = self.intensities(x)
        top = np.minimum(top, (1.0 - 1e-9) * self.law.fracture_toughness)  # a step may go beyond it
        pace = self.law.rate(top, np.minimum(bottom, top), np.exp(x)) / np.exp(x)
        fastest = float(pace.max())
        return np.zeros(x.size + 1) if fastest == 0.0 else np.append(pace / fastest, 1.0 / fastest)

    def path(self, start: np.ndarray, exactness: float) -> tuple[np.ndarray, np.ndarray, int]:
        """All x, shape (n, cracks), cycles (n,), and the event: a crack has its last length, all stop, one breaks."""
        per, end = self.slopes(start)[-1], float((self.ends - start).sum()) * (1.0 + 1e-9)
        events = [
            lambda _, y: float((y[:-1] - self.ends).max()),
            lambda _, y: -self.margins(y[:-1])[0],
            lambda _, y: self.margins(y[:-1])[1],
        ]
        for event in events:
            event.terminal = True  # type: ignore[attr-defined]

        def follow(first: float, last: float, at: np.ndarray, stop: list[Any] | None) -> Any:
            unit = np.append(np.ones(start.size), per)
            return integrate.solve_ivp(
                lambda _, y: self.slopes(y[:-1]) / unit, (first, last), at, events=stop, rtol=exactness,
                atol=0.1 * exactness, max_step=0.5,
            )  # fmt: skip

        found = follow(0.0, end, np.append(start, 0.0), events)
        ended = next((k for k, times in enumerate(found.t_events) if times.size), 0)
        # The last step is interpolated, and went beyond the end. It is taken again, twice to the last length itself.
        before, last, final = found.t[-2], float(found.t[-1]), found.y[:, -1]
        for _ in range(3):
            final = follow(before, last, found.y[:, -2], None).y[:, -1]
            if ended == 0:
                at = int((final[:-1] - self.ends).argmax())
                last -= float((final[at] - self.ends[at]) / self.slopes(final[:-1])[at])
        y = np.column_stack([found.y[:, :-1], final])
        return y[:-1].T, y[-1] * per, ended


def growth_together(
    states: Sequence[State],
    cracks: Sequence[Crack],
    law: GrowthLaw,
    first: ArrayLike,
    last: ArrayLike,
    residual_stress: Residual | None = None,
) -> GrowthTogether:
    """The growth of several cracks of one hole under a load cycle that is repeated for ever.

    It ends when one crack comes to its last length, breaks the plate, or when all stop.

    Parameters
    ----------
    states, law, residual_stress
        See :func:`growth`.
    cracks : sequence of Crack
        They begin in one body and don't touch.
    first, last : array_like, shape () or (cracks,)
        First and last lengths, m.

    Raises
    ------
    InputError
        See :func:`growth` and :func:`stress_intensity`.
    """
    stops, group = stops_of_one_problem(states), tuple(instances("cracks", cracks, Crack, "a list of Crack"))
    if not group or any(crack.body != group[0].body or crack.place is not None for crack in group):
        raise InputError("cracks", "must be a list of cracks that begin in one body, at one hole")
    edge = CrackedEdge.of(stops[0].problem, group[0])
    starts, lasts = _lengths("first", first, len(group)), _lengths("last", last, len(group))
    for crack, longest in zip(group, lasts.tolist(), strict=True):
        check_length("last", edge.problem, crack, longest, 1.0)
    whole = MOST_OF_LIGAMENT * np.array([edge.ligament(crack) for crack in group])
    ends = np.minimum(lasts, whole)
    if np.any(ends <= starts):
        raise InputError("last", "must be longer than the first length of each crack, within 0.95 of its ligament")
    together = _Cracks(stops, edge, group, checked_law(law), residual_stress, np.log(ends), {})
    start = np.log(starts)
    excess, over = together.margins(start)
    if excess <= 0.0 or over >= 0.0:
        x, cycles, error = start[None], np.zeros(1), 0.0
        fate = CrackFate.BREAKS if over >= 0.0 else CrackFate.NONE
    else:
        rough, (x, cycles, event) = together.path(start, ROUGH), together.path(start, EXACT)
        error = abs(rough[1][-1] / cycles[-1] - 1.0)
        through = bool(np.any((np.exp(x[-1]) >= ends * (1.0 - 1e-6)) & (ends >= whole * (1.0 - 1e-9))))
        fate = (CrackFate.BREAKS if through else CrackFate.GROWS, CrackFate.STOPS, CrackFate.BREAKS)[event]
    K = np.array([together.intensities(row) for row in x])
    found: list[InputWarning] = []
    for k, crack in enumerate(group):
        found += edge.doubts("last", crack, float(np.exp(x[-1, k])))
        found += sliding_doubt("last", edge.problem, np.exp(x[:, k]), K[:, [0, 2], k][None])
    warn_of(found, 2)
    return GrowthTogether(
        edge.problem, group, together.law, cycles, np.exp(x), K[:, 0], K[:, 1], K[:, 2], fate, error, tuple(found)
    )


def _lengths(name: str, given: ArrayLike, count: int) -> np.ndarray:
    """Check one length for all cracks, or one for each, m."""
    found = numbers(name, given, 0.0, open_low=True)
    if found.shape not in ((), (count,)):
        raise InputError(name, f"must be a length, or {count} of them, not of the shape {found.shape}")
    return np.broadcast_to(found, (count,))

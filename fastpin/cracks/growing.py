"""The growth of a crack under a repeated load cycle: stress intensities, rates, life and arrest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.cracks.fates import CrackFate
from fastpin.cracks.intensity import Crack, CrackedBody, CrackedEdge, Residual, histories, sliding_doubt
from fastpin.cracks.lengths import drawn, refined, spline_of, step_cycles
from fastpin.cracks.reversals import closed_cycles
from fastpin.errors import InputError, InputWarning
from fastpin.model import angles, ties
from fastpin.model.checks import check_callable, instance, numbers, positive, true_or_false
from fastpin.model.crack import MOST_OF_LIGAMENT, CrackGrowth, check_length, edge_of, law_of, mouth_words
from fastpin.model.doubts import warn_of
from fastpin.model.growth import GrowthLaw, checked_law
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.quantities import load_point
from fastpin.states.state import State

COMPUTED, DRAWN = 8, 100
"""Least lengths a decade at which K is computed, and of a result: :mod:`fastpin.cracks.lengths` adds more."""

MOST_REFINED = 500
"""Most states of a planned spectrum whose tractions are refined: each takes 0.03 s."""

GrowthProgress = Callable[[float, float], None]
"""Called with the number of places that are done, and of all places."""

LEAST_DECADES, MOST_DECADES = 1e-6, 8.0
"""Least and most decades from the first to the last length."""

BESIDE = (-4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0)
"""Places beside the fastest of every fifth degree that are looked at, deg."""

FOLLOWED, ROUGH = 8, 0.8
"""Places of every fifth degree that are followed, and part of the ligament up to which they are chosen."""


@dataclass(frozen=True, eq=False, repr=False)
class Growth(ReadOnly):
    """The growth of a crack over many load cycles. The arrays have the shape (n,), one value for each length.

    Attributes
    ----------
    problem : Problem
    crack : Crack
    law : GrowthLaw
    length : ndarray
        From the first to the last length, m: at least 100 a decade, more where the rate bends or the crack stops.
    K_max, K_min : ndarray
        Largest and smallest K_I of the cycle, Pa sqrt(m). A negative one counts faces that overlap.
    K_II : ndarray
        K_II at the largest K_I, Pa sqrt(m).
    largest_at : ndarray
        Load point of the state with the largest K_I.
    loads : mapping of float to mapping
        The loads at these load points, by name.
    doubts : tuple of InputWarning
        Reasons to doubt the numbers.
    error : float
        Estimated relative error of the life by the lengths at which K was computed; of the arrest if the crack stops.
        NaN if it is not known. The error of K itself comes on top.
    ligament : float
        Length of the line of the crack to the edge at which it leaves a plate of any outline, m; infinite in others.
        The growth ends at 0.95 of it.
    """

    problem: Problem
    crack: Crack
    law: GrowthLaw
    length: np.ndarray
    K_max: np.ndarray
    K_min: np.ndarray
    K_II: np.ndarray
    largest_at: np.ndarray
    loads: Mapping[float, Mapping[str, float]]
    doubts: tuple[InputWarning, ...] = ()
    error: float = math.nan
    ligament: float = math.inf

    per: ClassVar[str] = "cycle"
    """What is repeated: a cycle, or a spectrum."""

    passes: ClassVar[str] = "cycles"
    """What a life counts: cycles, or spectra."""

    def __repr__(self) -> str:
        bottom = " from the bottom" if self.crack.place is None else ""
        return f"<Growth of a crack at {mouth_words(self.problem, self.crack, '.2f')}{bottom}: {self.words}>"

    @property
    def delta_K(self) -> np.ndarray:
        """The range of the stress intensity that the law counts, Pa sqrt(m)."""
        return self.law.range(self.K_max, self.K_min)

    @property
    def threshold(self) -> np.ndarray:
        """The range up to which the crack does not grow, Pa sqrt(m)."""
        return self.law.threshold(self.K_max, self.K_min, self.length)

    @property
    def rate(self) -> np.ndarray:
        """da/dN, m per cycle: 0 up to the threshold, infinite from the toughness on."""
        return self.law.rate(self.K_max, self.K_min, self.length)

    @property
    def cycles(self) -> np.ndarray:
        """Cycles from the first length on; infinite where the crack never comes."""
        with np.errstate(divide="ignore"):
            pace = self.length / self.rate
        return np.append(0.0, np.cumsum(step_cycles(np.log(self.length), pace)))

    @property
    def life(self) -> float:
        """Cycles from the first to the last length, or to fracture; infinite if the crack stops before."""
        return float(self.cycles[-1])

    @property
    def arrest(self) -> float:
        """The first length at which the range is at most the threshold, m; NaN if the crack grows to the last one."""
        found = self._first(self.threshold - self.delta_K)
        return math.nan if self._fracture < found else found

    @property
    def reached(self) -> int:
        """The place of the longest length that the crack reaches before an arrest."""
        if math.isnan(self.arrest):
            return int(self.length.size) - 1
        return max(int(np.searchsorted(self.length, self.arrest)) - 1, 0)

    @property
    def fracture(self) -> float:
        """The length at which the largest K_I reaches the toughness, or 0.95 of the ligament is cracked, m.

        NaN without one, or after an arrest.
        """
        return self._fracture if math.isnan(self.arrest) else math.nan

    @property
    def _fracture(self) -> float:
        toughness = self.law.fracture_toughness
        found = self._first(self.K_max - toughness) if math.isfinite(toughness) else math.nan
        through = self.length[-1] >= MOST_OF_LIGAMENT * self.ligament * (1.0 - 1e-9)
        return float(self.length[-1]) if math.isnan(found) and through else found

    def _first(self, excess: np.ndarray) -> float:
        """The first length with an excess of at least 0, read between the lengths; NaN without one."""
        beyond = np.flatnonzero(excess >= 0.0)
        if not beyond.size:
            return math.nan
        k = int(beyond[0])
        if k == 0:
            return float(self.length[0])
        part = excess[k - 1] / (excess[k - 1] - excess[k])
        return float(self.length[k - 1] * (self.length[k] / self.length[k - 1]) ** part)

    @property
    def fate(self) -> CrackFate:
        """Whether the crack starts, stops, or grows to the end."""
        if self.arrest == self.length[0]:
            return CrackFate.NONE
        if not math.isnan(self.arrest):
            return CrackFate.STOPS
        return CrackFate.GROWS if math.isnan(self.fracture) else CrackFate.BREAKS

    @property
    def words(self) -> str:
        """A sentence on life, arrest and fracture."""
        length, fate = units(self.problem)["length"], self.fate
        first, last = length.text(float(self.length[0])), length.text(float(self.length[-1]))
        passes = f"in {self.life:.3g} {self.passes}"
        if fate == CrackFate.NONE:
            return f"no growth at {first}"
        if fate == CrackFate.STOPS:
            return f"grows from {first} and stops at {length.text(self.arrest, 4)}"
        if fate == CrackFate.BREAKS:
            at = "" if math.isinf(self.ligament) else f", of a ligament of {length.text(self.ligament, 4)},"
            return f"grows from {first} to fracture at {length.text(self.fracture, 4)}{at} {passes}"
        return f"grows from {first} to {last} {passes}"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SpectrumGrowth(Growth):
    """The growth of a crack under a spectrum that is repeated. K_max and K_min are those of one pass.

    Attributes
    ----------
    growth_in_pass : ndarray
        Growth in a pass of the spectrum, m.
    largest_range, its_threshold : ndarray
        Range and threshold of the cycle that exceeds its threshold most, Pa sqrt(m).
    counted : ndarray of int
        Number of cycles in a pass.
    """

    growth_in_pass: np.ndarray
    largest_range: np.ndarray
    its_threshold: np.ndarray
    counted: np.ndarray

    per: ClassVar[str] = "spectrum"
    passes: ClassVar[str] = "spectra"

    @property
    def delta_K(self) -> np.ndarray:
        """The range of the cycle that exceeds its threshold most, Pa sqrt(m)."""
        return self.largest_range

    @property
    def threshold(self) -> np.ndarray:
        """The threshold of the same cycle, Pa sqrt(m)."""
        return self.its_threshold

    @property
    def rate(self) -> np.ndarray:
        """The growth in a pass of the spectrum, m."""
        return self.growth_in_pass


def growth(
    states: Sequence[State],
    crack: Crack,
    law: GrowthLaw,
    first: float,
    last: float,
    residual_stress: Residual | None = None,
) -> Growth:
    """The growth of a crack under a load cycle that is repeated for ever.

    The states are the stops of the cycle. Between two stops the stress intensities are unknown: keep states between the
    corners, ``solve(..., between=10)``. The order of the states makes no difference.

    Parameters
    ----------
    states : sequence of State
        All stops of one cycle of one problem, at least two; see :func:`fastpin.damage.cycle_states`.
    crack : Crack
    law : GrowthLaw
        :class:`Walker`, :func:`paris` or :class:`Nasgro`, with constants of the user.
    first, last : float
        The first and the last length, m. In a plate of any outline the growth ends at 0.95 of the ligament.
    residual_stress : callable, optional
        Normal stress on the line of the crack that is added at every stop, Pa, from the distances to the mouth, m.

    Raises
    ------
    InputError
        If the states are no cycle of one problem, `last` is not longer than `first`, the crack leaves the body, the
        body is rigid, or a compliance without its outline describes the plate.
    """
    instance("crack", crack, Crack, "a Crack")
    return _Following.of(states, law, crack, (first, last), residual_stress).checked(crack).grown(crack)


@dataclass(frozen=True, eq=False, repr=False)
class EdgeGrowth(ReadOnly):
    """The growth of a crack at many places of an edge, each time alone.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        Angles of the mouths, rad.
    life : ndarray, shape (p,)
        Cycles from the first to the last length; infinite where the crack stops. With K at eight lengths a decade its
        error is some 1e-4. The fastest growth alone has more lengths.
    arrest : ndarray, shape (p,)
        Length at which it stops, m; NaN where it does not.
    fastest : Growth
        The growth with the shortest life; without a life, the one that comes farthest.
    """

    theta: np.ndarray
    life: np.ndarray
    arrest: np.ndarray
    fastest: Growth

    def __repr__(self) -> str:
        return f"<EdgeGrowth at {self.theta.size} places; fastest {self.fastest!r}>"


def growth_along_edge(
    states: Sequence[State],
    law: GrowthLaw,
    first: float,
    last: float,
    theta: ArrayLike | None = None,
    angle: float = 0.0,
    body: CrackedBody = "plate",
    progress: GrowthProgress | None = None,
) -> EdgeGrowth:
    """The growth of a crack at many places of the edge, to find the place at which it grows fastest.

    The hot spot of a criterion of fatigue need not be this place.

    Parameters
    ----------
    states, law, first, last
        See :func:`growth`.
    theta : array_like, optional
        Angles of the mouths, rad; each degree all round unless given. In a plate of any outline each place takes up to
        a second. There eight of every fifth degree are chosen by the stress alone, as if the hole had no other edges,
        then each degree beside the fastest one.
    angle : float
        Direction of the cracks from the radius, rad.
    body : {"plate", "seat"}
    progress : callable, optional
        Called as ``progress(done, all)`` with numbers of places.

    Raises
    ------
    InputError
        See :func:`growth`.
    """
    crack = Crack(0.0, angle, body)
    check_callable("progress", progress, 2)
    return _Following.of(states, law, crack, (first, last), None).along(crack, theta, progress)


def spectrum_growth(
    states: Sequence[State],
    crack: Crack,
    law: GrowthLaw,
    first: float,
    last: float,
    residual_stress: Residual | None = None,
    straight: bool = False,
) -> SpectrumGrowth:
    """The growth of a crack under a spectrum, a history that is repeated for ever.

    At each length the cycles of K_I are counted over the history (Matsuishi and Endo 1968; ASTM E1049, 5.4.5). The
    growth in a pass is the sum over its cycles. So no overload retards the growth, and the order of cycles makes no
    difference. The growth in one pass must be small beside the length.

    Parameters
    ----------
    states : sequence of State
        All stops of one pass in the order of time, at least two, such as a result without repeats.
    crack, law, first, last, residual_stress
        See :func:`growth`.
    straight : bool
        See :func:`stress_intensity`: quick for thousands of states.

    Raises
    ------
    InputError
        See :func:`growth`.
    """
    instance("crack", crack, Crack, "a Crack")
    follow = _Following.of(
        states, law, crack, (first, last), residual_stress, True, true_or_false("straight", straight)
    )
    found = follow.checked(crack).grown(crack)
    assert isinstance(found, SpectrumGrowth)
    return found


def planned_growth(
    states: Sequence[State], how: CrackGrowth, spectrum: bool = False, progress: GrowthProgress | None = None
) -> Growth:
    """The growth of a crack as a case says: at its place, or at the place of the fastest growth.

    Parameters
    ----------
    states : sequence of State
        All stops of a cycle, or of a spectrum in the order of time. Of more than 500 states of a spectrum the tractions
        are straight lines between the nodes.
    how : CrackGrowth
    spectrum : bool
        Whether the states are one pass of a spectrum, see :func:`spectrum_growth`.
    progress : callable, optional
        See :func:`growth_along_edge`.

    Raises
    ------
    InputError
        See :func:`growth`; also if neither the case nor the body's material has a law of growth.
    """
    stops = stops_of_one_problem(states)
    instance("how", how, CrackGrowth, "a fastpin.model.CrackGrowth")
    check_callable("progress", progress, 2)
    law, counted = law_of(stops[0].problem, how), true_or_false("spectrum", spectrum)
    residual = None if how.residual_stress is None else how.residual
    is_anywhere = how.theta is None and how.place is None
    if how.place is None:
        crack = Crack(how.theta or 0.0, how.angle, edge_of(how.body))
    else:
        crack = Crack(angle=how.angle, body=edge_of(how.body), place=how.place)
    straight = counted and len(stops) > MOST_REFINED
    follow = _Following.of(stops, law, crack, (how.first, how.last), residual, counted, straight)
    return follow.along(crack, None, progress).fastest if is_anywhere else follow.checked(crack).grown(crack)


class _Following(NamedTuple):
    """What all cracks of one analysis share."""

    stops: Sequence[State]
    edge: CrackedEdge
    law: GrowthLaw
    ends: tuple[float, float]
    residual: Residual | None
    counted: bool
    straight: bool

    @classmethod
    def of(
        cls,
        states: Sequence[State],
        law: GrowthLaw,
        crack: Crack,
        ends: tuple[float, float],
        residual: Residual | None,
        counted: bool = False,
        straight: bool = False,
    ) -> _Following:
        """Check the arguments of :func:`growth`."""
        stops = stops_of_one_problem(states)
        edge = CrackedEdge.of(stops[0].problem, crack)
        start, end = positive("first", ends[0]), positive("last", ends[1])
        decades = math.log10(end) - math.log10(start)
        if not LEAST_DECADES < decades <= MOST_DECADES:
            most = f"and at most 1e{MOST_DECADES:g} times as long"
            raise InputError("last", f"must be longer than the first length of {start:g} m {most}, not {end:g}")
        return cls(stops, edge, checked_law(law), (start, end), residual, counted, straight)

    def lengths(self, crack: Crack) -> np.ndarray:
        """The lengths at which K is computed, m. They end where the ligament does."""
        problem, (start, end) = self.edge.problem, self.ends
        check_length("last", problem, crack, end, math.inf)
        longest = MOST_OF_LIGAMENT * self.edge.ligament(crack)
        decades = math.log10(min(end, longest)) - math.log10(start)
        if decades <= LEAST_DECADES:
            where = f"within {MOST_OF_LIGAMENT:g} of the ligament at {mouth_words(problem, crack, '.2f')}"
            length = units(problem)["length"]
            raise InputError("first", f"must lie {where}, {length.text(longest)}, not be {length.text(start)}")
        return np.geomspace(start, min(end, longest), max(math.ceil(COMPUTED * decades) + 1, 4))

    def intensities(self, crack: Crack, turns: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """K at lengths, m, shape (states, turns, lengths, 2)."""
        rows = [self.edge.lines([crack], length) for length in lengths]
        return histories(self.stops, self.edge, rows, turns, self.residual, self.straight)[:, :, :, 0]

    def checked(self, crack: Crack) -> _Following:
        """Raise :class:`InputError` if a crack whose place is given leaves the body."""
        check_length("last", self.edge.problem, crack, self.ends[1], 1.0)
        return self

    def grown(self, crack: Crack) -> Growth:
        """The growth of one crack."""

        def compute(lengths: np.ndarray) -> np.ndarray:
            return self.intensities(crack, np.zeros(1), lengths)[:, 0]

        first = self.lengths(crack)
        known = compute(first)
        lengths, K, error = refined(first, known, compute, lambda a, K: self.pace(a, K)[0])
        found = self.doubts(crack, first, known)
        warn_of(found, 3)
        return self.read(crack, lengths, K, found, error)

    def along(self, crack: Crack, theta: ArrayLike | None, progress: GrowthProgress | None) -> EdgeGrowth:
        """The growth of one crack at many places; by default see :func:`growth_along_edge`."""
        is_round = self.edge.beyond.is_round
        every = np.linspace(-1.5 * np.pi, 0.5 * np.pi, 360 if is_round else 72, endpoint=False)
        every = every if theta is None else numbers("theta", theta).ravel()
        if not every.size:
            raise InputError("theta", "must be at least one angle")
        every = np.array([angles.near_bottom(place) for place in every])
        searched = theta is None and not is_round
        rough = self.beside_hole(crack, every) if searched else self
        total, done = every.size + FOLLOWED * (rough is not self) + len(BESIDE) * searched, 0

        def follow(how: _Following, places: np.ndarray) -> list[Growth]:
            nonlocal done
            found, alike = [], how.edge.beyond.is_round
            # Forty places need some 30,000 points in each state; a plate of any outline keeps 5,000 for other states.
            size = 40 if is_round else 12 if alike else 1
            for part in np.array_split(places, max(1, places.size // size)):
                start, turns = (crack, part) if alike else (replace(crack, theta=part[0]), np.zeros(1))
                lengths = how.lengths(start)
                K = how.intensities(start, turns, lengths)
                for k, place in enumerate(part.tolist()):
                    found.append(how.read(replace(crack, theta=place), lengths, K[:, k]))
                    done += 1
                    if progress is not None:
                        progress(done, total)
            return found

        grown = follow(rough, every)
        if rough is not self:
            life, arrest = np.array([(one.life, one.arrest) for one in grown]).T
            first = np.lexsort((-np.where(np.isnan(arrest), np.inf, arrest), life))[:FOLLOWED]
            grown = follow(self, np.sort(every[first]))
        if searched:
            middle = grown[_fastest(grown)].crack.theta
            grown += follow(self, np.array([angles.near_bottom(middle + each) for each in np.radians(BESIDE)]))
            grown.sort(key=lambda one: one.crack.theta)
        at = _fastest(grown)
        places, life, arrest = np.array([(one.crack.theta, one.life, one.arrest) for one in grown]).T
        fastest = self.grown(grown[at].crack)
        life[at], arrest[at] = fastest.life, fastest.arrest
        return EdgeGrowth(places, life, arrest, fastest)

    def beside_hole(self, crack: Crack, theta: np.ndarray) -> _Following:
        """The same for a hole without other edges, up to a length that fits into the plate everywhere; else itself."""
        shortest = min(self.edge.ligament(replace(crack, theta=place)) for place in theta)
        end, alone = min(self.ends[1], ROUGH * shortest), self.edge._replace(others=None)
        return self if end < 1.1 * self.ends[0] else self._replace(edge=alone, ends=(self.ends[0], end))

    def doubts(self, crack: Crack, lengths: np.ndarray, K: np.ndarray) -> tuple[InputWarning, ...]:
        """Doubts about a crack with these intensities at lengths, shape (states, lengths, 2)."""
        sliding = sliding_doubt("last", self.edge.problem, lengths, K)
        return (*self.edge.doubts("last", crack, float(lengths[-1])), *sliding)

    def pace(self, lengths: np.ndarray, K: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
        """The pace of :data:`fastpin.cracks.lengths.CrackPace` from K at lengths, and the sums of a spectrum."""
        opening = K[..., 0]
        sums: tuple[np.ndarray, ...] = ()
        top, bottom = opening.max(axis=0), opening.min(axis=0)
        if self.counted:
            sums = _sums(self.law, lengths, opening)
            rate, margin = sums[0], sums[1] - sums[2]
        else:
            rate = self.law.rate(top, bottom, lengths)
            margin = self.law.range(top, bottom) - self.law.threshold(top, bottom, lengths)
        with np.errstate(divide="ignore"):
            return np.array([lengths / rate, margin, self.law.fracture_toughness - top]), sums

    def read(
        self,
        crack: Crack,
        lengths: np.ndarray,
        K: np.ndarray,
        doubts: tuple[InputWarning, ...] = (),
        error: float = math.nan,
    ) -> Growth:
        """The growth from K, shape (states, lengths, 2), and the error of these. Without it no step is halved."""
        between = spline_of(lengths, K)

        def row(a: np.ndarray) -> np.ndarray:
            there = between(a)
            opening, (pace, sums) = there[..., 0], self.pace(a, there)
            top = np.argmax(ties.is_top(opening.T), axis=1)  # of equal ones the first
            K_II = np.take_along_axis(there[..., 1], top[None], axis=0)[0]
            return np.array([*pace, opening.max(axis=0), opening.min(axis=0), K_II, top, *sums])

        count = max(math.ceil(DRAWN * math.log10(lengths[-1] / lengths[0])) // 2, 10)
        fine = np.geomspace(lengths[0], lengths[-1], 2 * count + 1)
        if math.isnan(error):
            rows = row(fine)
        else:
            fine, rows, by_steps = drawn(fine[::2], row)
            error += by_steps
        top = rows[6].astype(int)
        at = np.array([load_point(self.stops[place]) for place in top.tolist()])
        loads = {load_point(state): state.load for state in (self.stops[place] for place in np.unique(top).tolist())}
        known = (
            self.edge.problem, crack, self.law, fine, *rows[3:6], at, loads, doubts, error, self.edge.ligament(crack)
        )  # fmt: skip
        if not self.counted:
            return Growth(*known)
        return SpectrumGrowth(
            *known, growth_in_pass=rows[7], largest_range=rows[8], its_threshold=rows[9], counted=rows[10].astype(int)
        )


def _sums(law: GrowthLaw, lengths: np.ndarray, opening: np.ndarray) -> tuple[np.ndarray, ...]:
    """The four fields of :class:`SpectrumGrowth` from K_I, shape (states, lengths)."""
    values = np.ascontiguousarray(opening.T)
    tops, bottoms, counts = np.empty(values.shape), np.empty(values.shape), np.empty(len(values), dtype=np.int64)
    closed_cycles(values, tops, bottoms, counts)
    growth, largest, needed = np.zeros(lengths.size), np.zeros(lengths.size), np.zeros(lengths.size)
    for k, (length, count) in enumerate(zip(lengths.tolist(), counts.tolist(), strict=True)):
        if not count:
            continue
        top, bottom = tops[k, :count], bottoms[k, :count]
        growth[k] = law.rate(top, bottom, length).sum()
        swing, threshold = law.range(top, bottom), law.threshold(top, bottom, length)
        most = int(np.argmax(swing - threshold))
        largest[k], needed[k] = swing[most], threshold[most]
    return growth, largest, needed, counts


def _fastest(grown: Sequence[Growth]) -> int:
    """The place of the growth with the shortest life, or of the one that comes farthest."""
    theta, life, arrest = np.array([(one.crack.theta, one.life, one.arrest) for one in grown]).T
    farthest = np.flatnonzero(ties.is_top(np.where(np.isnan(arrest), np.inf, arrest)))
    return int(farthest[ties.top_angle(-life[farthest], theta[farthest])])

"""Damage of plate, bush or pin over a load spectrum: places, planes, lives in spectra, and the cycles that do it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.damage.counted import SPECTRUM_CRITERIA, CountedMaterial, Spectrum
from fastpin.damage.criteria import FATIGUE_CRITERIA, ROUNDING, Criterion
from fastpin.damage.histories import different_states, history_blocks, with_residual
from fastpin.damage.hot_spots import CRITERIA, bodies_at, edge_points
from fastpin.damage.lives import failure_probability
from fastpin.errors import InputError
from fastpin.model import FatigueConstants, Problem, checks, ties
from fastpin.model.assessment import USUAL, FatigueAssessment
from fastpin.model.points import CRITERION, Body, Points, isotropic_bodies, isotropic_material, material_of, owner_of
from fastpin.model.read_only import ReadOnly
from fastpin.reading.stress import check_body
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.quantities import load_point
from fastpin.states.state import State


class NoChangeError(InputError):
    """The stresses of a body do not change over a spectrum."""


FEW = 100
"""Different states up to which the ends of their zones are points of the edge. Those of 5,000 states are 20,000."""


class SpectrumSpot(NamedTuple):
    """The point with the largest damage; without a place if there is no damage.

    Attributes
    ----------
    damage : float
        Miner's sum of the whole spectrum.
    theta : float
        Angle of the point, rad; NaN without a place.
    depth : float
        Distance from the edge, m; NaN without a place.
    plane : float
        Angle of the worst plane's normal from the +x axis, rad; NaN without a place.
    life : float
        Number of spectra until the sum is 1; infinite without damage.
    """

    damage: float
    theta: float
    depth: float
    plane: float
    life: float


class SpectrumCycles(NamedTuple):
    """The counted cycles at the hot spot, on its plane; the largest damage first. All arrays have the shape (cycles,).

    Attributes
    ----------
    start, stop : ndarray
        Load points of both reversals, see :mod:`fastpin.states.choice`. States that come again have their first place.
    largest : ndarray
        Load point of the largest normal stress in the cycle.
    times : ndarray of int
        How often the cycle comes in the spectrum.
    parameter : ndarray
        Parameter of the cycle, Pa; rad for "fatemi-socie".
    damage : ndarray
        Damage of all its times.
    """

    start: np.ndarray
    stop: np.ndarray
    largest: np.ndarray
    times: np.ndarray
    parameter: np.ndarray
    damage: np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class SpectrumDamage(ReadOnly):
    """Damage of one body over a spectrum that is repeated. All arrays have the shape of the points.

    Attributes
    ----------
    problem : Problem
    criterion : str
        One of :data:`fastpin.damage.SPECTRUM_CRITERIA`.
    body : str
        "plate", "pin" or "seat".
    theta, depth : ndarray
        Angles of the points, rad, and distances from the edge, m.
    damage : ndarray
        Miner's sum of the spectrum.
    plane : ndarray
        Angle of the worst plane's normal from the +x axis, rad, in (-pi/2, pi/2]; NaN where there is no damage.
    cycles : SpectrumCycles
        The cycles at the hot spot; none without damage.
    shift : float
        log10 of the median life over the life at the hot spot: 0, unless a reliability is asked for.
    scatter : float
        Standard error of log10 life of the material there; NaN if it is unknown.
    """

    problem: Problem
    criterion: str
    body: str
    theta: np.ndarray
    depth: np.ndarray
    damage: np.ndarray
    plane: np.ndarray
    cycles: SpectrumCycles
    shift: float = 0.0
    scatter: float = math.nan

    def __repr__(self) -> str:
        spot = self.hot_spot
        if math.isnan(spot.theta):
            return f"<SpectrumDamage of the {self.body}, {self.criterion}: no damage>"
        place = f"theta {spot.theta:.5f} rad, depth {spot.depth:.4g} m"
        return f"<SpectrumDamage of the {self.body}, {self.criterion}: life {spot.life:.4g} spectra at {place}>"

    @property
    def life(self) -> np.ndarray:
        """Number of spectra until the sum is 1; infinite where there is no damage."""
        return np.divide(1.0, self.damage, out=np.full(self.damage.shape, np.inf), where=self.damage > 0.0)

    def failure_probability(self, life: float | None) -> float:
        """Part of the specimens that fail at the hot spot within a life, in spectra; NaN without a life or a scatter.

        A life that is not positive raises :class:`InputError`.
        """
        if life is None or math.isnan(self.scatter):
            return math.nan
        return float(failure_probability(life, self.hot_spot.life * 10.0**self.shift, self.scatter))

    @property
    def hot_spot(self) -> SpectrumSpot:
        """The point with the largest damage; of equal points the first one farthest to the right."""
        if not self.damage.any():
            return SpectrumSpot(0.0, math.nan, math.nan, math.nan, math.inf)
        at = np.unravel_index(ties.top_angle(self.damage, self.theta), self.damage.shape)
        place = (float(values[at]) for values in (self.theta, self.depth, self.plane, self.life))
        return SpectrumSpot(float(self.damage[at]), *place)


def spectrum_damage(
    states: Sequence[State],
    criterion: Criterion = "smith-watson-topper",
    body: Body = "plate",
    *,
    points: Points | None = None,
    depth: ArrayLike | None = None,
    constants: FatigueConstants | None = None,
    straight: bool = False,
    small_cycles: str = "elementary",
    knee: float | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> SpectrumDamage:
    """Damage of plate, bush or pin over a load spectrum, at points on an edge or inside.

    The states are the stops of the spectrum, in the order of time. After the last one the first one follows: the
    spectrum is repeated. Between two stops the stresses are unknown.

    Parameters
    ----------
    states : sequence of State
        States of one problem, such as a result. At least two of them have different stresses.
    criterion : str
        One of :data:`fastpin.damage.SPECTRUM_CRITERIA`.
    body, depth, constants
        See :func:`fatigue`.
    points : Points, optional
        Unless given, the points lie all round the edge: at the nodes and at each degree. Of up to 100 different states
        the ends of all zones are added. A plate of any outline also has points on its other edges.
    straight : bool
        Whether the tractions are straight lines between the nodes everywhere, see :meth:`fastpin.State.stress`. The
        stresses are then one product with a matrix, which takes a small part of the time.
    small_cycles : {"elementary", "original", "haibach"}
        The variant of Miner's rule for cycles below the knee of the curve of lives. Let P_D be the parameter of the
        curve at the knee. "elementary": the curve goes on. "original": cycles below P_D do no damage. "haibach": their
        life is N_D (P_D/P)^((2k - 1)/m). The slope k of the curve at its knee belongs to the amplitude: P grows with
        its power m, 2 for "smith-watson-topper" and 1 for "fatemi-socie" (Haibach 1970, on the tangent at the knee).
    knee : float, optional
        Cycles N_D at the knee, for "original" and "haibach" only.
    progress : callable, optional
        Called as ``progress(done, total)`` now and then.

    Raises
    ------
    InputError
        See :func:`fatigue`; also if the criterion has no life, the material lacks one of its constants, the stresses do
        not change, or the rule of small cycles can't be used.
    """
    checks.check_callable("progress", progress)
    how = FatigueAssessment(small_cycles=small_cycles, knee=knee)
    return spectrum_count(states, criterion, body, points, depth, constants, straight, how).damage(*halves(progress))


class SpectrumCount(NamedTuple):
    """All that a count of cycles needs: points of a body, their materials, and their stresses over the states.

    Attributes
    ----------
    criterion, body : str
    theta, depth : ndarray
        Angles of the points, rad, and distances from the edge, m.
    different : sequence of State
        The different states.
    order : ndarray of int64, shape (stops,)
        The place of each stop among them.
    parts : sequence of (ndarray of bool, CountedMaterial)
        The points of each material, in a row.
    blocks : callable
        ``blocks(progress)`` yields blocks of points, with their stresses (states, points of the block, 4).
    """

    criterion: str
    body: str
    theta: np.ndarray
    depth: np.ndarray
    different: Sequence[State]
    order: np.ndarray
    parts: Sequence[tuple[np.ndarray, CountedMaterial]]
    blocks: Callable[[Callable[[float], None]], Iterable[tuple[slice, np.ndarray]]]

    def damage(self, tell_read: Callable[[float], None], tell_counted: Callable[[float], None]) -> SpectrumDamage:
        """Count the cycles at all points.

        Raises
        ------
        InputError
            If the stresses do not change.
        """
        spectrum, found, changes = Spectrum.of(self.order), _Found(self.theta.ravel()), False
        for block, history in self.blocks(tell_read):
            changes = changes or bool(np.ptp(history, axis=0).max() > ROUNDING * np.abs(history).max())
            for chosen, counted in self.parts:
                places = block.start + np.flatnonzero(chosen[block])
                found.take(counted, history[:, chosen[block]], spectrum, places, tell_counted)
        if not changes:
            raise NoChangeError("states", "must have a turning point: their stresses do not change")
        damage, plane = found.damage.reshape(self.theta.shape), found.plane.reshape(self.theta.shape)
        cycles = found.cycles(spectrum, np.array([load_point(state) for state in self.different]))
        where = self.different[0].problem, self.criterion, self.body, self.theta, self.depth
        curve = self.parts[0][1] if found.best is None else found.best[2]
        return SpectrumDamage(*where, damage, plane, cycles, curve.shift, curve.scatter)


def spectrum_count(
    states: Sequence[State],
    criterion: str,
    body: Body,
    points: Points | None = None,
    depth: ArrayLike | None = None,
    constants: FatigueConstants | None = None,
    straight: bool = False,
    how: FatigueAssessment = USUAL,
) -> SpectrumCount:
    """Check the arguments of :func:`spectrum_damage`, and return the count that they ask for.

    Rule, reliability and residual stress are those of `how`.
    """
    stops = stops_of_one_problem(states)
    problem = stops[0].problem
    check_body(problem, body)
    different, order = different_states(stops, checks.true_or_false("straight", straight))
    if points is None:
        points = edge_points(different, body, depth, FEW)
    elif depth is not None:
        raise InputError("depth", "can't be given together with points")
    checks.instance("points", points, Points, "fastpin.Points")
    if constants is not None:
        checks.instance("constants", constants, FatigueConstants, "fastpin.model.FatigueConstants")
    below = np.broadcast_to(points.depths(problem, body), points.shape)
    parts = []
    for chosen, one in bodies_at(problem, body, below.ravel()):
        material = isotropic_material("body", problem, one, CRITERION)
        parts.append((chosen, CountedMaterial.of(criterion, material, constants, owner_of(problem, one), how)))
    read = partial(history_blocks, different, points, body, straight)
    blocks = with_residual(read, problem, body, points, how.residual_stress)
    return SpectrumCount(criterion, body, points.theta, below * problem.hole_radius, different, order, parts, blocks)


def damage_ranking(
    states: Sequence[State],
    criterion: Criterion = "smith-watson-topper",
    *,
    depth: ArrayLike | None = None,
    straight: bool = False,
    small_cycles: str = "elementary",
    knee: float | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> list[SpectrumDamage]:
    """Damage of all elastic bodies whose own material has the constants of the criterion, the largest first.

    A body without damage is left out.

    Parameters
    ----------
    states, criterion, depth, straight, small_cycles, knee, progress
        See :func:`spectrum_damage`. The progress begins anew for each body.

    Raises
    ------
    InputError
        See :func:`spectrum_damage`; also if no body has the constants.
    """
    problem = stops_of_one_problem(states)[0].problem
    known = bodies_with_lives(problem, checks.choice("criterion", criterion, CRITERIA))
    bodies = known or isotropic_bodies(problem)[:1]
    how: dict[str, Any] = {"depth": depth, "straight": straight, "small_cycles": small_cycles, "knee": knee}
    found = [spectrum_damage(states, criterion, body, progress=progress, **how) for body in bodies]
    return sorted((one for one in found if one.damage.any()), key=lambda one: -one.hot_spot.damage)


def bodies_with_lives(problem: Problem, criterion: str) -> list[Body]:
    """The elastic bodies whose material has the constants of a criterion and of its life; none without a life."""
    needs = FATIGUE_CRITERIA[criterion].needs + FATIGUE_CRITERIA[criterion].life_needs
    known = {body: material_of(problem, body).fatigue for body in isotropic_bodies(problem)}
    return [
        body
        for body, given in known.items()
        if criterion in SPECTRUM_CRITERIA and given and None not in [getattr(given, name) for name in needs]
    ]


def halves(progress: Callable[[float, float], None] | None) -> tuple[Callable[[float], None], Callable[[float], None]]:
    """Return the progress of the readings, and that of the counts: half of the work each."""
    done = [0.0, 0.0]

    def tell(which: int, part: float) -> None:
        done[which] = part
        if progress is not None:
            progress(0.5 * sum(done), 1.0)

    return partial(tell, 0), partial(tell, 1)


class _Found:
    """The damage of the points, and the point with the largest damage."""

    def __init__(self, theta: np.ndarray) -> None:
        self._theta, self.damage, self.plane = theta, np.zeros(theta.size), np.full(theta.size, np.nan)
        self._taken = 0
        self.best: tuple[int, np.ndarray, CountedMaterial] | None = None

    def take(
        self, counted: CountedMaterial, history: np.ndarray, spectrum: Spectrum, places: np.ndarray,
        progress: Callable[[float], None],
    ) -> None:  # fmt: skip
        """Count the points at these places."""
        if not places.size:
            return
        before, self._taken = self._taken, self._taken + places.size
        damage, plane = counted.worst(
            history, spectrum, lambda part: progress((before + part * places.size) / self.damage.size)
        )
        self.damage[places], self.plane[places] = damage, plane
        at = ties.top_angle(damage, self._theta[places])
        rivals = [places[at], *(() if self.best is None else self.best[:1])]
        if damage[at] > 0.0 and ties.top_angle(self.damage[rivals], self._theta[rivals]) == 0:
            self.best = int(places[at]), history[:, at : at + 1].copy(), counted

    def cycles(self, spectrum: Spectrum, load_points: np.ndarray) -> SpectrumCycles:
        """Return the cycles at the point with the largest damage."""
        places, values = np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3))
        if self.best is not None:
            point, history, counted = self.best
            places, values = counted.cycles(history, spectrum, float(self.plane[point]))
        done = values[:, 2]
        rows = np.argsort(np.where(ties.is_top(done), -np.inf, -done), kind="stable")
        (start, stop, largest), (times, parameter, damage) = load_points[places[rows]].T, values[rows].T
        return SpectrumCycles(start, stop, largest, times.astype(np.int64), parameter, damage)

"""Fatigue of a surface that wears: damage belongs to the material, and goes with it.

A material point lies at an angle theta and at a depth z under the first surface. After n cycles the depth w(theta, n)
is worn off, and the point lies z - w under the present surface. It is gone once w exceeds z. Until then it sums up

    D(theta, z) = int dn / N_f(theta, z - w)

with the life N_f of a criterion on the present profile. A crack starts where a sum reaches 1 before the point is gone:
it wins the race against wear. Sums of damage over material that wears away: Cruzado, Leen, Urchegui and Gómez, Int. J.
Fatigue 55 (2013) 7. Which of both wins, in fretting maps: Basseville and Cailletaud, Wear 328-329 (2015) 443.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from fastpin.damage.criteria import Criterion
from fastpin.damage.hot_spots import edge_angles, fatigue
from fastpin.damage.race import Race
from fastpin.errors import InputError
from fastpin.model import FatigueConstants, Problem
from fastpin.model.angles import from_bottom
from fastpin.model.checks import instances, numbers, positive
from fastpin.model.points import Body, Points, far_rim, near_rim, owner_of
from fastpin.model.read_only import ReadOnly
from fastpin.model.ties import top_angle
from fastpin.model.units import units
from fastpin.model.wear import cycles_text
from fastpin.reading.stress import check_body
from fastpin.states.state import State


@runtime_checkable
class StoredCycle(Protocol):
    """A chosen cycle of a life of wear, see :class:`fastpin.wear_lives.WornCycle`."""

    @property
    def cycle(self) -> int:
        """Cycles that are done."""

    @property
    def pin_depth(self) -> np.ndarray:
        """Depth worn off the pin at the nodes, m."""

    @property
    def plate_depth(self) -> np.ndarray:
        """Depth worn off the edge of the hole at the nodes, m."""

    @property
    def states(self) -> tuple[State, ...]:
        """The states over one cycle on this profile."""


class WornSpot(NamedTuple):
    """A material point, and its damage after some cycles.

    Attributes
    ----------
    cycle : float
        Cycles that are done; infinite if a crack was not seen.
    theta : float
        Angle, rad; NaN without a place.
    depth : float
        Depth under the first surface, m; NaN without a place.
    damage : float
    """

    cycle: float
    theta: float
    depth: float
    damage: float


@dataclass(frozen=True, eq=False, repr=False)
class WornFatigue(ReadOnly):
    """Damage of the material points of one body over a life of wear.

    Attributes
    ----------
    problem : Problem
    criterion, body : str
        See :class:`fastpin.damage.Fatigue`.
    theta : ndarray, shape (m,)
        Angles of the material points, rad.
    depth : ndarray, shape (d,)
        Their depths under the first surface, m.
    cycles : ndarray, shape (k,)
        Cycles that were done at the stored profiles.
    worn : ndarray, shape (k, m)
        Depth worn off the body, m.
    rate : ndarray, shape (k, d, m)
        1/N_f, a cycle. A point that is gone has the rate of the present surface at its angle.
    damage : ndarray, shape (k, d, m)
        Sum D up to each stored cycle. That of material that is gone stays.
    broken : ndarray, shape (d, m)
        Cycles after which the sum is 1; infinite where it never is.
    """

    problem: Problem
    criterion: str
    body: str
    theta: np.ndarray
    depth: np.ndarray
    cycles: np.ndarray
    worn: np.ndarray
    rate: np.ndarray
    damage: np.ndarray
    broken: np.ndarray

    def __repr__(self) -> str:
        return f"<WornFatigue of the {self.body}, {self.criterion}: {self.words}>"

    @property
    def crack(self) -> WornSpot:
        """Where and after how many cycles the first crack starts; without a place if none does."""
        life = float(self.broken.min())
        if math.isinf(life):
            return WornSpot(math.inf, math.nan, math.nan, math.nan)
        return self._spot(life, -self.broken, np.ones_like(self.broken))

    @property
    def life(self) -> float:
        """Cycles until the first crack starts; infinite if none does within the cycles of the wear."""
        return self.crack.cycle

    @property
    def first_life(self) -> float:
        """Life by the criterion on the first stored profile alone, as if nothing wore.

        It belongs to the first cycle, which is settled if what leads to the cycle ends like the cycle.
        """
        most = float(self.rate[0].max())
        return 1.0 / most if most else math.inf

    @property
    def is_gone(self) -> np.ndarray:
        """Whether each material point is worn off at each stored cycle, shape (k, d, m)."""
        gone: np.ndarray = self.worn[:, None] > self.depth[:, None]
        return gone

    @property
    def gone(self) -> np.ndarray:
        """Cycles after which each material point is worn off, shape (d, m); infinite where it stays.

        A crack wins the race where ``broken`` is finite: the damage of material that is gone does not grow.
        """
        found = np.full(self.broken.shape, np.inf)
        for k in reversed(range(self.cycles.size - 1)):
            grown, left = self.worn[k + 1] - self.worn[k], self.depth[:, None] - self.worn[k]
            goes = (left >= 0.0) & (left < grown)
            part = np.divide(left, grown, out=np.zeros(found.shape), where=goes)
            found[goes] = (self.cycles[k] + part * float(self.cycles[k + 1] - self.cycles[k]))[goes]
        return found

    @property
    def race(self) -> Race:
        """Whether a crack or wear wins within the cycles of the wear."""
        if math.isfinite(self.life):
            return Race.CRACK
        return Race.WEAR if self.first_life <= self.cycles[-1] else Race.OPEN

    @property
    def wear_wins(self) -> bool:
        """Whether no crack starts, though one would on the first profile."""
        return self.race is Race.WEAR

    @property
    def hot_spots(self) -> tuple[WornSpot, ...]:
        """At each stored cycle the material with the largest damage of all that is still there."""
        there = np.where(self.is_gone, -1.0, self.damage)
        return tuple(
            self._spot(float(cycle), values, values) for cycle, values in zip(self.cycles.tolist(), there, strict=True)
        )

    @property
    def words(self) -> str:
        """The end of the race in words."""
        if self.race is Race.CRACK:
            depth = units(self.problem)["displacement"].text(self.crack.depth, 3)
            place = f"{from_bottom(self.crack.theta):.4g} deg, {depth} below the first surface"
            return f"a crack starts after {cycles_text(float(f'{self.life:.4g}'))} at {place}"
        first = f", on the first profile one after {self.first_life:.4g}" if self.wear_wins else ""
        largest = f"largest damage {self.damage[-1].max():.3g}"
        return f"no crack within {cycles_text(int(self.cycles[-1]))}{first}; {largest}"

    @property
    def every_second(self) -> WornFatigue:
        """The same from every second stored cycle, the first and the last one included."""
        count = self.cycles.size
        kept = np.unique(np.r_[np.arange(0, count, 2), count - 1])
        damage, broken = _summed(self.cycles[kept], self.worn[kept], self.depth, self.rate[kept])
        return replace(
            self, cycles=self.cycles[kept], worn=self.worn[kept], rate=self.rate[kept], damage=damage, broken=broken
        )

    @property
    def error(self) -> float:
        """Relative difference to :attr:`every_second`, of the life, or of the largest damage without a crack.

        NaN if less than three cycles are stored, infinite if a crack starts in one of both only.
        """
        other = self.every_second
        if self.cycles.size < 3:
            return math.nan
        if math.isfinite(self.life):
            return abs(other.life / self.life - 1.0)
        if math.isfinite(other.life):
            return math.inf
        mine, theirs = (float(each.damage[-1].max()) for each in (self, other))
        return abs(theirs / mine - 1.0) if mine else 0.0

    def _spot(self, cycle: float, values: np.ndarray, damage: np.ndarray) -> WornSpot:
        """The point with the largest of `values` (d, m), with its damage."""
        at = np.unravel_index(top_angle(values, np.broadcast_to(self.theta, values.shape)), values.shape)
        return WornSpot(cycle, float(self.theta[at[1]]), float(self.depth[at[0]]), float(damage[at]))


def worn_fatigue(
    cycles: Sequence[StoredCycle],
    criterion: Criterion = "smith-watson-topper",
    body: Body = "plate",
    *,
    theta: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    constants: FatigueConstants | None = None,
) -> WornFatigue:
    """Sum up the damage of material points over a life of wear.

    The criterion is evaluated at each stored cycle, over the states of one cycle on its profile. Between two stored
    cycles the rate 1/N_f of a material point, and the worn depth at its angle, vary linearly with the number of cycles.
    :attr:`WornFatigue.error` compares with every second stored cycle.

    Parameters
    ----------
    cycles : sequence of WornCycle
        A life of wear, with its cycle 0.
    criterion, body, constants
        See :func:`fatigue`. The criterion needs a life. The seat of a bush does not wear.
    theta : array_like, shape (m,), optional
        Angles of the material points, rad. Unless given: the nodes, the ends of the zones at cycle 0, and each degree.
    depth : array_like, shape (d,), optional
        Their depths under the first surface, m, increasing. Unless given, they lie inside the material that is worn
        off, and below it down to the half width of the contact, or half a wall.

    Raises
    ------
    InputError
        See :func:`fatigue`; also if there is no cycle 0 or no other one, a cycle has no states, or the material has no
        constants for a life.
    """
    stored = instances("cycles", cycles, StoredCycle, "the cycles of a life of wear")  # type: ignore[type-abstract]
    if len(stored) < 2 or stored[0].cycle != 0:
        raise InputError("cycles", "must be the chosen cycles of a life of wear, cycle 0 and later ones")
    problem = stored[0].states[0].problem
    check_body(problem, body)
    angles = edge_angles(stored[0].states) if theta is None else _listed("theta", numbers("theta", theta))
    worn = np.array([_worn_depth(each, body, angles) for each in stored])
    if depth is None:
        depths = _depths(stored, body, float(worn.max()))
    else:
        depths = _listed("depth", numbers("depth", depth, 0.0))
    rates = []
    for each, gone in zip(stored, worn, strict=True):
        points = Points.at_depth(np.maximum(depths[:, None] - gone, 0.0), angles)
        life = fatigue(each.states, criterion, body, points=points, constants=constants).life
        if life is None:
            owner = owner_of(problem, body)
            raise InputError("criterion", f"the {owner}'s material has no constants for a life by {criterion}")
        rates.append(1.0 / life)
    done, rate = np.array([each.cycle for each in stored]), np.array(rates)
    damage, broken = _summed(done, worn, depths, rate)
    return WornFatigue(problem, criterion, body, angles, depths, done, worn, rate, damage, broken)


def _listed(field: str, values: np.ndarray) -> np.ndarray:
    if values.ndim != 1 or not values.size:
        raise InputError(field, f"must be a list of numbers, not of the shape {values.shape}")
    return values


def _worn_depth(cycle: StoredCycle, body: Body, theta: np.ndarray) -> np.ndarray:
    """Depth worn off a body at some angles, m: linear between the nodes, and 0 beyond an arc."""
    if body == "seat":
        return np.zeros(theta.shape)
    nodes, values = cycle.states[0].theta, cycle.pin_depth if body == "pin" else cycle.plate_depth
    turn = 2.0 * np.pi
    if cycle.states[0].grid.closed:
        return np.interp(theta, nodes, values, period=turn)
    return np.interp(nodes[0] + np.mod(theta - nodes[0], turn), nodes, values, right=0.0)


def _depths(cycles: Sequence[StoredCycle], body: Body, worn: float) -> np.ndarray:
    """Depths for a body of which at most the depth `worn` is removed, m."""
    problem = cycles[0].states[0].problem
    widths = [stop - start for each in cycles for state in each.states for start, stop in state.contact]
    below = max(0.5 * min(max(widths, default=0.0), np.pi) * problem.hole_radius, 2.0 * worn)
    far = far_rim(problem, body)
    if far is not None:
        below = min(below, 0.5 * abs(far - near_rim(problem, body)) * problem.hole_radius)  # not the force in the pin
    if body != "pin" and np.isfinite(known := problem.plate_body.lug.reach):
        below = min(below, (known * problem.joint.seat_ratio - near_rim(problem, body)) * problem.hole_radius)
    inside, beyond = np.linspace(0.0, worn, 9), np.linspace(0.0, 1.0, 17) ** 2
    return np.unique(np.r_[inside, worn + (below - worn) * beyond])


def _summed(cycles: np.ndarray, worn: np.ndarray, depth: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The sums of damage (k, d, m) of rates (k, d, m) that are linear in between, and the cycles (d, m) to the sum 1.

    A point counts until the depth worn (k, m), linear in between too, reaches its own depth (d,).
    """
    damage, broken = np.zeros(rate.shape), np.full(rate.shape[1:], np.inf)
    for k in range(cycles.size - 1):
        span, start, slope = float(cycles[k + 1] - cycles[k]), rate[k], rate[k + 1] - rate[k]
        left, grown = depth[:, None] - worn[k], np.broadcast_to(worn[k + 1] - worn[k], start.shape)
        part = np.divide(left, grown, out=np.ones(start.shape), where=grown > np.maximum(left, 0.0))
        part = np.where(left < 0.0, 0.0, np.clip(part, 0.0, 1.0))
        damage[k + 1] = damage[k] + span * part * (start + 0.5 * slope * part)
        breaks = (damage[k] < 1.0) & (damage[k + 1] >= 1.0)
        missing = ((1.0 - damage[k]) / span)[breaks]  # start x + slope x^2/2 = missing
        root = np.sqrt(np.maximum(start[breaks] ** 2 + 2.0 * slope[breaks] * missing, 0.0))
        broken[breaks] = cycles[k] + span * np.minimum(2.0 * missing / (start[breaks] + root), 1.0)
    return damage, broken


def ruiz(shear: ArrayLike, slip_range: ArrayLike, hoop: ArrayLike | None = None) -> np.ndarray:
    """The fretting parameters of Ruiz, Boddington and Chen (Exp. Mech. 24 (1984) 208) at points.

    F1 = tau delta, the largest shear traction of the cycle times the range of the slip. F2 = s_T tau delta, with the
    hoop stress s_T where it is tensile, and the largest product s_T tau of the cycle.

    Parameters
    ----------
    shear : array_like, shape (stops, points)
        Shear traction at the stops of a cycle, Pa; its sign makes no difference.
    slip_range : array_like, shape (points,)
        Largest less smallest slip over the cycle, m.
    hoop : array_like, shape (stops, points), optional
        Hoop stress on the edge, Pa; tension is positive.

    Returns
    -------
    ndarray, shape (points,)
        F1 in J/m^2; with the hoop stress F2 in Pa J/m^2.

    Raises
    ------
    InputError
        If the shapes do not fit, a number is not finite or a range is negative.
    """
    product, ranges = np.abs(_stops("shear", shear)), numbers("slip_range", slip_range, 0.0)
    if ranges.shape != product.shape[1:]:
        raise InputError("slip_range", f"must have the shape {product.shape[1:]}, not {ranges.shape}")
    if hoop is not None:
        product = product * np.maximum(_same("hoop", hoop, product), 0.0)
    return product.max(axis=0) * ranges


def archard_depth(pressure: ArrayLike, slip: ArrayLike, wear_coefficient: float) -> np.ndarray:
    """The depth worn off in one cycle, k_w int p |ds|, m (Archard, J. Appl. Phys. 24 (1953) 981).

    With the magnitude of the shear traction in place of the pressure, and the coefficient per energy, it is the wear by
    frictional energy (Fouvry, Kapsa and Vincent, Wear 200 (1996) 186).

    Parameters
    ----------
    pressure : array_like, shape (stops, points)
        Contact pressure at the stops of a cycle, from its beginning to its end, Pa, at least 0. It varies linearly from
        stop to stop.
    slip : array_like, shape (stops, points)
        Slip at the same stops, m. The last stop of a closed cycle equals the first one.
    wear_coefficient : float
        k_w, 1/Pa, above 0. It counts the depth of both bodies together, or of one of them.

    Returns
    -------
    ndarray, shape (points,)

    Raises
    ------
    InputError
        If the shapes do not fit, or a number is out of range.
    """
    coefficient = positive("wear_coefficient", wear_coefficient)
    loads = _stops("pressure", numbers("pressure", pressure, 0.0))
    path = np.abs(np.diff(_same("slip", slip, loads), axis=0))
    return coefficient * np.sum(0.5 * (loads[1:] + loads[:-1]) * path, axis=0)


def _stops(field: str, values: ArrayLike) -> np.ndarray:
    array = numbers(field, values)
    if array.ndim != 2 or 0 in array.shape:
        raise InputError(field, f"must have the shape (stops, points), not {array.shape}")
    return array


def _same(field: str, values: ArrayLike, other: np.ndarray) -> np.ndarray:
    array = numbers(field, values)
    if array.shape != other.shape:
        raise InputError(field, f"must have the shape {other.shape}, not {array.shape}")
    return array

"""Stress intensities of cracks at the edge of a hole, from the stresses of the plate without cracks.

The cracks do not change the contact: see docs/cracks.md for the error of this.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.bodies.harmonics import FREE
from fastpin.cracks.dislocations import Beyond, CrackLine, FreeRim, needed_points, places, rule, weights
from fastpin.elasticity.tractions import Tractions
from fastpin.errors import FastpinError, InputError, InputWarning
from fastpin.model import angles, loads
from fastpin.model.checks import check_callable, choice, instances, number, numbers, true_or_false
from fastpin.model.crack import (
    MOST_INCLINATION,
    check_inside,
    check_length,
    checked_place,
    depth_of,
    other_edges,
    wall_of,
)
from fastpin.model.doubts import warn_of
from fastpin.model.points import EDGES, MOST_ANGLE, Points, isotropic_material, near_rim
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units
from fastpin.reading.stress import Stress, check_body, stress_at
from fastpin.runtime.threads import in_threads
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.reading_bounds import MAPPED
from fastpin.states.state import State
from fastpin.states.stress_map import mapped, share_map

CrackedBody = Literal["plate", "seat"]

Residual = Callable[[np.ndarray], ArrayLike]
"""Normal stress on the line of a crack, Pa, from the distances to its mouth, m, of any shape."""

UNKNOWN_FROM = 0.05
"""Depth in parts of the wall from which the outline counts: K of a free rim rises by 1.6 % there."""

GRIPPED_FROM = 0.1
"""Length in radii from which a crack relieves an interference fit: the edge moves by 2 % of its displacement."""

NEAREST = 0.2
"""Least distance of two cracks, in parts of the shorter one: the points of a crack resolve no nearer one."""

MOST_SLIDING = 0.1
"""Largest |K_II| in parts of K_I for which a crack keeps its direction nearly."""


UNTOLD = float("nan")
"""The angle of a mouth that a place tells."""


@dataclass(frozen=True)
class Crack:
    """A straight crack at the edge of a hole, or at another edge of a plate of any outline.

    Parameters
    ----------
    theta : float
        Angle of its mouth, rad, counter-clockwise from the +x axis; -pi/2 is the bottom of the hole.
    angle : float
        Its direction from the radius, rad, counter-clockwise, at most 60 deg; 0 is radial. At another edge it counts
        from the normal into the plate.
    body : {"plate", "seat"}
        "plate" begins at the hole. With a bush it is the bush, and "seat" is the plate round it.
    place : (float, float), optional
        In place of theta, a place (x, y) on the outline or on a further hole, m, such as that of a margin. The crack
        begins at the nearest point of the nearest edge, which may be 0.01 of the distance from the centre away. Then
        `theta` is the angle of the place.

    Raises
    ------
    InputError
        If an angle is no finite number or too large, the body is unknown, or both or none of theta and place are given.
    """

    theta: float = UNTOLD
    angle: float = 0.0
    body: CrackedBody = "plate"
    place: Sequence[float] | None = None

    def __post_init__(self) -> None:
        if self.place is not None:
            x, y = checked_place("place", self.place)
            if self.theta is not UNTOLD and self.theta != math.atan2(y, x):
                raise InputError("place", "stands in place of theta: leave one of them out")
            object.__setattr__(self, "place", (x, y))
            object.__setattr__(self, "theta", math.atan2(y, x))
        elif self.theta is UNTOLD:
            raise InputError("theta", "is missing: give the angle of the mouth, or a place")
        object.__setattr__(self, "theta", number("theta", self.theta, -MOST_ANGLE, MOST_ANGLE))
        object.__setattr__(self, "angle", number("angle", self.angle, -MOST_INCLINATION, MOST_INCLINATION))
        object.__setattr__(self, "body", choice("body", self.body, EDGES))


@dataclass(frozen=True, eq=False, repr=False)
class StressIntensity(ReadOnly):
    """Stress intensities of a crack, or of several, at states and lengths.

    Attributes
    ----------
    lengths : ndarray, shape (m,) or (m, cracks)
        m.
    K_I, K_II : ndarray, shape (states, m) or (states, m, cracks)
        Pa sqrt(m). K_I is positive where the stress opens the crack; a negative one counts faces that overlap. K_II is
        positive where the side on the left of the growth slides backwards: K_I + i K_II = sqrt(2 pi r) (s_nn + i s_tn)
        ahead of the tip, t along the growth and n to the left.
    doubts : tuple of InputWarning
        Reasons to doubt the numbers.
    """

    lengths: np.ndarray
    K_I: np.ndarray
    K_II: np.ndarray
    doubts: tuple[InputWarning, ...]

    def __repr__(self) -> str:
        return f"<StressIntensity of {len(self.K_I)} states at {len(self.lengths)} lengths>"


def stress_intensity(
    states: Sequence[State] | State,
    cracks: Crack | Sequence[Crack],
    lengths: ArrayLike,
    residual_stress: Residual | None = None,
    straight: bool = False,
) -> StressIntensity:
    """The stress intensities of a crack, or of several together, at each state and length.

    Parameters
    ----------
    states : State or sequence of State
        States of one problem, such as a result.
    cracks : Crack or sequence of Crack
        Several cracks shield one another. They begin in one body and don't touch.
    lengths : array_like, shape (m,) or (m, cracks)
        Lengths of the crack, m. Several cracks have equal lengths unless there is a column for each.
    residual_stress : callable, optional
        Normal stress on the line of each crack that is added at every state, Pa, from the distances to the mouth, m.
    straight : bool
        Whether the tractions are straight lines between the nodes everywhere, see :meth:`fastpin.State.stress`. The
        intensities of many states are then one product with weights of the nodes. Use it for thousands of states.

    Returns
    -------
    StressIntensity
        With an axis for the cracks if `cracks` is a sequence.

    Raises
    ------
    InputError
        If a crack leaves the body, two cracks touch, the body is rigid, or a compliance without its outline gives no
        stress inside.
    """
    each = [states] if isinstance(states, State) else states
    stops = stops_of_one_problem(each, 1)
    single = isinstance(cracks, Crack)
    group = [cracks] if isinstance(cracks, Crack) else instances("cracks", cracks, Crack, "a Crack or a list of them")
    if not group:
        raise InputError("cracks", "must be a Crack or a list of them, not an empty list")
    if any(crack.body != group[0].body for crack in group):
        raise InputError("cracks", "must begin in one body")
    edge = CrackedEdge.of(stops[0].problem, group[0])
    if len(group) > 1 and any(crack.place is not None for crack in group):
        raise InputError("cracks", "must begin at one hole; a crack at another edge stands alone")
    given = numbers("lengths", lengths, 0.0, open_low=True)
    table = given[:, None] if given.ndim == 1 else given
    if table.ndim != 2 or table.shape[1] not in (1, len(group)) or not table.size:
        raise InputError("lengths", f"must have the shape (m,) or (m, {len(group)}), not {given.shape}")
    table = np.broadcast_to(table, (len(table), len(group)))
    for k, crack in enumerate(group):
        edge.check("lengths", crack, table[:, k])
    rows = [edge.lines(group, row) for row in table]
    if len(group) > 1:
        check_apart(rows)
    K = histories(stops, edge, rows, np.zeros(1), residual_stress, true_or_false("straight", straight))[:, 0]
    K_I, K_II = (K[..., 0, mode] if single else K[..., mode] for mode in (0, 1))
    found = []
    for k, crack in enumerate(group):
        found += edge.doubts("lengths", crack, float(table[:, k].max()))
        found += sliding_doubt("lengths", edge.problem, table[:, k], K[:, :, k])
    warn_of(found, 2)
    return StressIntensity(given, K_I, K_II, tuple(found))


class CrackedEdge(NamedTuple):
    """The edge at which cracks begin.

    Attributes
    ----------
    problem : Problem
    body : str
    radius : float
        Radius of the edge, m.
    wall : float
        Depth of the body, in radii of the edge; infinite without a rim.
    is_free : bool
        Whether the other rim is free, so that the kernel knows it; True without a rim.
    others : OtherEdges or None
        The edges beyond this one in a plate of any outline.
    """

    problem: Problem
    body: CrackedBody
    radius: float
    wall: float
    is_free: bool
    others: Any

    @classmethod
    def of(cls, problem: Problem, crack: Crack) -> CrackedEdge:
        """The edge of a crack. Raise :class:`InputError` if its stress is unknown."""
        body = crack.body
        check_body(problem, body)
        isotropic_material("body", problem, body, "a stress intensity")
        near, lug, wall = near_rim(problem, body), problem.plate_body.lug, wall_of(problem, body)
        in_bush = body == "plate" and problem.plate_body.bush is not None
        check_inside(problem, body)
        is_free = not in_bush and (math.isinf(wall) or lug.outer_kind == FREE)
        others = other_edges(problem, crack)
        size = 1.0 if others is None else others.radius
        return cls(problem, body, near * problem.hole_radius * size, wall, is_free, others)

    @property
    def beyond(self) -> Beyond:
        """The edges beyond the hole that the kernel knows."""
        known: Beyond | None = self.others
        return FreeRim(1.0 + self.wall if self.is_free else math.inf) if known is None else known

    def ligament(self, crack: Crack) -> float:
        """Length of the line of a crack to the edge of a plate of any outline, m; infinite in other bodies."""
        if self.others is None:
            return math.inf
        return self.radius * float(self.others.ligament(*self.others.line(crack.theta, crack.angle)))

    def lines(self, cracks: Sequence[Crack], lengths: ArrayLike) -> tuple[CrackLine, ...]:
        """The lines of cracks of these lengths, m, for the kernel."""
        rays = [(crack.theta, crack.angle) for crack in cracks]
        if self.others is not None:
            rays = [self.others.line(*ray) for ray in rays]
        each = zip(rays, np.broadcast_to(lengths, len(cracks)), strict=True)
        return tuple(CrackLine(*ray, float(length) / self.radius) for ray, length in each)

    def depth(self, angle: float, length: float) -> float:
        """Depth of a tip, in radii of the edge, of a crack of this length, m."""
        return depth_of(angle, length / self.radius)

    def check(self, field: str, crack: Crack, lengths: np.ndarray) -> None:
        """Raise :class:`InputError` if a length, m, is too large for the body."""
        check_length(field, self.problem, crack, float(np.max(lengths)))

    def doubts(self, field: str, crack: Crack, longest: float) -> list[InputWarning]:
        """Doubts about the kernel for a crack of this length, m."""
        found, deep = [], self.depth(crack.angle, longest) / self.wall
        if not self.is_free and deep > UNKNOWN_FROM:
            what = "bush ends" if self.body == "plate" and self.problem.plate_body.bush is not None else "rim is held"
            reason = f"reaches {deep:.2f} of the wall; K there does not know that the {what}"
            found.append(InputWarning(field, f"{reason}: trust it up to {UNKNOWN_FROM:g}"))
        if self.body == "seat" and len(self.problem.interfaces) == 1:
            reason = "begins at a bonded bush, which holds its mouth together: K is too large"
            found.append(InputWarning(field, reason))
        if self.problem.is_gripped and longest > GRIPPED_FROM * self.radius:
            reason = f"is {longest / self.radius:.2g} radii: a long crack relieves the grip on the pin"
            found.append(InputWarning(field, f"{reason}, and K is too large beyond {GRIPPED_FROM:g} radii"))
        return found


def sliding_doubt(field: str, problem: Problem, lengths: np.ndarray, K: np.ndarray) -> list[InputWarning]:
    """Doubt about the direction of cracks, from K of the shape (states, m, 2): they slide at their largest K_I."""
    at = np.argmax(K[..., 0], axis=0)
    opening, sliding = np.take_along_axis(K, at[None, :, None], axis=0)[0].T
    bad = np.flatnonzero((opening > 0.0) & (np.abs(sliding) > MOST_SLIDING * opening))
    if not bad.size:
        return []
    part = abs(sliding[bad[0]] / opening[bad[0]])
    length = units(problem)["length"].text(float(lengths[bad[0]]))
    words = f"in doubt from {length} on: |K_II| is {part:.2f} of the largest K_I, and the crack turns away"
    return [InputWarning(field, words)]


class CrackWeights(NamedTuple):
    """The weights by which the stresses on the lines of cracks give their intensities.

    Attributes
    ----------
    points : Points
        All points, shape (turns, rows, cracks, points).
    weights : ndarray, shape (rows, cracks, points, 2, cracks, 2)
        Of the normal and the shear traction at each point, for K_I and K_II of each crack.
    turn : ndarray, shape (rows, cracks, points)
        exp(2i (direction of the crack - angle of the point)).
    added : ndarray
        Normal stress on the lines that is added to all states, Pa.
    """

    points: Points
    weights: np.ndarray
    turn: np.ndarray
    added: np.ndarray

    @classmethod
    def of(
        cls,
        edge: CrackedEdge,
        rows: Sequence[tuple[CrackLine, ...]],
        turns: np.ndarray,
        residual_stress: Residual | None,
    ) -> CrackWeights:
        """The weights of the cracks of :func:`histories`."""
        beyond = edge.beyond
        n = max(needed_points(row, beyond) for row in rows)
        if beyond.is_round:  # with the first mouth at the angle 0 the weights are found again at other places
            alike = [tuple(line._replace(mouth=line.mouth - row[0].mouth) for line in row) for row in rows]
        else:
            alike = list(rows)
        of_rows = np.array([weights(row, beyond, n) for row in alike])
        s = np.array([[line.length * rule(n).place for line in row] for row in rows]) * edge.radius
        added = np.asarray(np.zeros(1) if residual_stress is None else residual_on(s, residual_stress))
        if edge.others is not None and edge.others.mouth is not None:
            start, along = edge.others.start(rows[0][0].mouth, rows[0][0].angle)
            z = (start * edge.radius / edge.others.radius + s * along)[None]
            points = Points.at_xy(z.real, z.imag)
            return cls(points, of_rows, np.exp(2j * (np.angle(along) - points.theta[0])), added)
        found = np.array([[places(line, n) for line in row] for row in rows])  # rows, cracks, (depth, angle), points
        depth, angle = found[:, :, 0], found[:, :, 1]
        mouths = np.array([[line.mouth for line in row] for row in rows])[..., None]
        inclined = np.array([[line.angle for line in row] for row in rows])[..., None]
        theta = turns[:, None, None, None] + (mouths + angle)
        return cls(Points.at_depth(depth * edge.radius, theta), of_rows, np.exp(2j * (inclined - angle)), added)

    def intensities(self, stress: Stress) -> np.ndarray:
        """K_I and K_II in Pa times the root of the edge's radius, shape (turns, rows, cracks, 2)."""
        mean, half = 0.5 * (stress.radial + stress.hoop), 0.5 * (stress.hoop - stress.radial)
        traction = mean + self.turn * (half + 1j * stress.shear)
        return self.of_tractions(traction.real + self.added, traction.imag)

    def of_tractions(self, normal: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """The same of tractions on the lines, shape (turns, rows, cracks, points)."""
        pair = np.stack([normal, shear], axis=-1)
        return np.asarray(np.einsum("mcakne,pmkne->pmca", self.weights, pair, optimize=True))


def residual_on(s: np.ndarray, residual_stress: Residual) -> np.ndarray:
    """Check and return the residual stress of a user's function at distances, m."""
    try:
        given = numbers("residual_stress", residual_stress(s))
    except FastpinError:
        raise
    except Exception as error:  # The function is anyone's.
        words = f"must take an array of distances, it raised a {type(error).__name__}"
        raise InputError("residual_stress", words) from error
    if given.shape not in ((), s.shape):
        raise InputError("residual_stress", f"must return numbers of the shape {s.shape}, not {given.shape}")
    return given


def histories(
    states: Sequence[State],
    edge: CrackedEdge,
    rows: Sequence[tuple[CrackLine, ...]],
    turns: np.ndarray,
    residual_stress: Residual | None = None,
    straight: bool = False,
) -> np.ndarray:
    """K_I and K_II, Pa sqrt(m), shape (states, turns, rows, cracks, 2).

    Parameters
    ----------
    states : sequence of State
    edge : CrackedEdge
    rows : sequence of tuple of CrackLine
        The cracks in each row stand together.
    turns : ndarray, shape (p,)
        Angles by which all mouths are turned, rad; only 0 in a plate of any outline.
    residual_stress : callable, optional
        See :func:`stress_intensity`.
    straight : bool
        See :func:`stress_intensity`.
    """
    check_callable("residual_stress", residual_stress, 1)
    cracks = CrackWeights.of(edge, rows, turns, residual_stress)
    if straight and len(states) > MAPPED and share_map(states):
        K = _mapped(states, edge, cracks)
    else:
        K = np.array(
            in_threads(lambda state: cracks.intensities(state.stress(cracks.points, edge.body, straight)), states)
        )
    return K * math.sqrt(edge.radius)


def _mapped(states: Sequence[State], edge: CrackedEdge, cracks: CrackWeights) -> np.ndarray:
    """The intensities of many states: the product of their nodal tractions and those of the nodes' hat functions."""
    names, shape = (
        [list(loads.LOADS)[place] for place in loads.STRESSING],
        (len(states), *cracks.points.theta.shape[:3], 2),
    )

    # The residual stress is added at the end: beside it the hat of a node would be rounding.
    none = np.zeros((1, *cracks.turn.shape))
    residual, cracks = cracks.of_tractions(none + cracks.added, none), cracks._replace(added=np.zeros(1))

    def of(tractions: list[Tractions], remote: np.ndarray) -> np.ndarray:
        load = dict(zip(names, remote.tolist(), strict=True))
        stress = stress_at(edge.problem, tractions[0], load, cracks.points, edge.body, *tractions[1:])
        return cracks.intensities(stress).reshape(1, -1)

    return mapped(states, of)[0].reshape(shape) + residual


def check_apart(rows: Sequence[tuple[CrackLine, ...]]) -> None:
    """Raise :class:`InputError` if two cracks of a row touch, or nearly do."""
    for row in rows:
        ends = []
        for line in row:
            mouth, way = np.exp(1j * line.mouth), np.exp(1j * (line.mouth + line.angle))
            ends.append((complex(mouth), complex(mouth + line.length * way)))
        for k, one in enumerate(ends):
            for other, line in zip(ends[:k], row, strict=False):
                if _distance(one, other) < NEAREST * min(line.length, row[k].length):
                    places_ = " and ".join(f"{angles.from_bottom(each.mouth):.2f}" for each in (line, row[k]))
                    raise InputError("cracks", f"must not touch: those at {places_} deg from the bottom nearly do")


def _distance(one: tuple[complex, complex], other: tuple[complex, complex]) -> float:
    """The distance of two straight lines from end to end; 0 if they cross."""
    least, crossing = math.inf, True
    for (start, end), points in ((one, other), (other, one)):
        along = end - start
        parts = [(point - start) / along for point in points]
        crossing = crossing and parts[0].imag * parts[1].imag < 0.0
        least = min(least, *(abs(along * (part - min(max(part.real, 0.0), 1.0))) for part in parts))
    return 0.0 if crossing else least

"""Fatigue of plate, bush or pin over one load cycle: parameters, planes, lives and hot spots."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.damage import lives
from fastpin.damage.criteria import FATIGUE_CRITERIA, Criterion, CriterionValues
from fastpin.damage.histories import stress_history
from fastpin.errors import InputError
from fastpin.model import FatigueConstants, Material, Problem, angles, checks, ties
from fastpin.model.points import CRITERION, Body, Points, has_outline, is_beyond_bush, isotropic_material, owner_of
from fastpin.model.read_only import ReadOnly
from fastpin.model.units import units_per_thickness
from fastpin.reading.stress import check_body
from fastpin.states.choice import loaded_span_of, missing_corners, states_between, stops_of_one_problem
from fastpin.states.cycles import Cycle
from fastpin.states.state import State
from fastpin.states.yielding import further_points

CRITERIA = tuple(FATIGUE_CRITERIA)
"""The criteria; :mod:`fastpin.damage.criteria` has their formulas and sources."""

NO_CRACK = "the parameter is 0 everywhere: no crack is expected"
"""Words in place of a hot spot."""


class HotSpot(NamedTuple):
    """The point with the largest parameter; without a place if the parameter is 0 everywhere.

    Attributes
    ----------
    parameter : float
    theta : float
        Angle of the point, rad; NaN without a place.
    depth : float
        Distance from the edge, m; NaN without a place.
    plane : float
        Angle of the worst plane's normal from the +x axis, rad; NaN for a criterion without planes.
    life : float
        Cycles; NaN if the life is unknown.
    """

    parameter: float
    theta: float
    depth: float
    plane: float
    life: float


@dataclass(frozen=True, eq=False, repr=False)
class Fatigue(ReadOnly):
    """Fatigue of one body over one load cycle. All arrays have the shape of the points.

    Attributes
    ----------
    problem : Problem
    criterion : str
        One of :data:`CRITERIA`.
    body : str
        "plate", "pin" or "seat".
    theta, depth : ndarray
        Angles of the points, rad, and distances from the edge of the hole or pin, m.
    parameter : ndarray
        Pa; rad for "fatemi-socie".
    plane : ndarray or None
        Angle of the worst plane's normal from the +x axis, rad, in (-pi/2, pi/2]; NaN where the parameter is 0. None
        for "crossland" and "dang-van".
    life : ndarray or None
        Cycles, infinite where the parameter is 0; None if the criterion has no life or the material no constants for
        it.
    limit : float or None
        Parameter at the fatigue limit, Pa; None for "smith-watson-topper" and "fatemi-socie". An array if the points
        lie in the bush and in the plate round it.
    """

    problem: Problem
    criterion: str
    body: str
    theta: np.ndarray
    depth: np.ndarray
    parameter: np.ndarray
    plane: np.ndarray | None
    life: np.ndarray | None
    limit: float | np.ndarray | None

    def __repr__(self) -> str:
        spot = self.hot_spot
        if math.isnan(spot.theta):
            return f"<Fatigue of the {self.body}, {self.criterion}: the parameter is 0 everywhere>"
        found = f"{spot.parameter:.5g} at theta {spot.theta:.5f} rad, depth {spot.depth:.4g} m"
        life = "" if self.life is None else f", life {spot.life:.4g} cycles"
        return f"<Fatigue of the {self.body}, {self.criterion}: largest parameter {found}{life}>"

    @property
    def unit(self) -> str:
        """Unit of the parameter: "rad" or "Pa", or that of a dimensionless problem, such as "F/R"."""
        return units_per_thickness(self.problem)[self.kind]

    @property
    def kind(self) -> str:
        """Kind of the parameter, a key of :func:`fastpin.model.units.units`."""
        return FATIGUE_CRITERIA[self.criterion].kind

    @property
    def margin(self) -> np.ndarray | None:
        """limit/parameter - 1 as in all margins of safety; infinite where the parameter is 0. None without a limit."""
        if self.limit is None:
            return None
        with np.errstate(divide="ignore"):
            return np.asarray(self.limit / self.parameter - 1.0)

    @property
    def hot_spot(self) -> HotSpot:
        """The point with the largest parameter; of equal points the first one farthest to the right."""
        if not self.parameter.any():
            return HotSpot(0.0, math.nan, math.nan, math.nan, math.nan if self.life is None else math.inf)
        at = np.unravel_index(ties.top_angle(self.parameter, self.theta), self.parameter.shape)
        optional = (np.nan if array is None else float(array[at]) for array in (self.plane, self.life))
        return HotSpot(float(self.parameter[at]), float(self.theta[at]), float(self.depth[at]), *optional)


def fatigue(
    states: Sequence[State],
    criterion: Criterion,
    body: Body = "plate",
    *,
    points: Points | None = None,
    depth: ArrayLike | None = None,
    constants: FatigueConstants | None = None,
) -> Fatigue:
    """Fatigue of plate, bush or pin over one load cycle, at points on an edge or inside.

    The states are the stops of the cycle. Between two stops the stresses are unknown: keep states between the corners,
    ``solve(..., between=10)``. The order of the states makes no difference.

    Parameters
    ----------
    states : sequence of State
        All stops of one cycle of one problem, at least two.
    criterion : str
        One of :data:`CRITERIA`.
    body : {"plate", "pin", "seat"}
        "plate" begins at the hole. With a bush its edge is the bore of the bush, and points beyond the bush take the
        constants of the plate. "seat" is the plate round the bush: its edge is the seat of the bush.
    points : Points, optional
        Unless given, the points lie all round the edge: at the nodes, at the ends of all contact and stick zones, and
        at each degree. A plate of any outline also has points on its other edges, apart from sharp corners.
    depth : array_like, optional
        Distance of these points from the edge, m; 0 unless given. A column of depths gives a grid. Other edges then
        have no points.
    constants : FatigueConstants, optional
        In place of the constants of the body's material. In a dimensionless problem they count in its units.

    Raises
    ------
    InputError
        If the states are no cycle of one problem, a point lies outside the body or its stress is infinite, both points
        and depth are given, the body is rigid, or the material lacks constants of the criterion.
    """
    stops = stops_of_one_problem(states)
    check_body(stops[0].problem, body)
    if points is None:
        points = edge_points(stops, body, depth)
    elif depth is not None:
        raise InputError("depth", "can't be given together with points")
    checks.instance("points", points, Points, "fastpin.Points")
    place = points.theta, points.depths(stops[0].problem, body) * stops[0].problem.hole_radius
    history = stress_history(stops, points, body)
    return evaluated(history, stops[0], criterion, body, place, constants)


def edge_points(states: Sequence[State], body: Body, depth: ArrayLike | None = None, most: float = math.inf) -> Points:
    """Points all round the edge of a body at some depth, m; without it on all edges of the body.

    The angles are those of :func:`edge_angles`. Points on further edges of a plate of any outline come last.
    """
    angles, problem = edge_angles(states, most), states[0].problem
    if depth is not None or owner_of(problem, body) != "plate" or not has_outline(problem):
        return Points.at_depth(0.0 if depth is None else depth, angles)
    theta, below, _ = further_points(problem)
    return Points.at_depth(np.r_[np.zeros(angles.size), problem.hole_radius * below], np.r_[angles, theta])


def edge_angles(states: Sequence[State], most: float = math.inf) -> np.ndarray:
    """Angles all round the edge, rad, in (-3 pi/2, pi/2], in increasing order.

    They are the nodes, each degree, and the ends of all contact and stick zones of up to `most` states.
    """
    read = states if len(states) <= most else ()
    ends = [angle for state in read for interval in (*state.contact, *state.stick) for angle in interval]
    degrees = np.linspace(-1.5 * np.pi, 0.5 * np.pi, 360, endpoint=False)
    return np.unique([angles.near_bottom(angle) for angle in np.concatenate([states[0].theta, ends, degrees])])


def cycle_states(states: Sequence[State], cycle: Cycle) -> list[State]:
    """The states of a cycle, from the corner at which it begins to the corner at which it ends.

    Parameters
    ----------
    states : sequence of State
        For example a result.
    cycle : Cycle
        For example ``result.cycles[-1]``.

    Raises
    ------
    InputError
        If the states at some corners of the cycle were not kept, or if the cycle begins without load.
    """
    states = checks.instances("states", states, State, "a sequence of fastpin.State")
    first, last = loaded_span_of(checks.instance("cycle", cycle, Cycle, "a cycle of a result"))
    within = states_between(states, first, last)
    if missing_corners(within, first, last):
        raise InputError("states", f"must hold all corners of the cycle, {first} to {last}")
    return within


def damage_sum(
    states: Sequence[State],
    cycles: Sequence[Cycle],
    criterion: Criterion,
    body: Body = "plate",
    *,
    depth: ArrayLike = 0.0,
    repeats: int = 1,
    constants: FatigueConstants | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Miner's sum over the cycles of a history, along the edge; 1 means failure.

    Parameters
    ----------
    states : sequence of State
        The states of the history, such as a result.
    cycles : sequence of Cycle
        The cycles to count. Cycles inside others must not be counted with these.
    criterion, body, depth, constants
        See :func:`fatigue`. The criterion needs a life.
    repeats : int
        How often the cycles are run through.

    Returns
    -------
    theta, damage : ndarray
        Angles, rad, and damage sums, in one shape.

    Raises
    ------
    InputError
        See :func:`fatigue`; also if there are no cycles, or the material has no constants for a life.
    """
    chosen = [cycle_states(states, cycle) for cycle in checks.items("cycles", cycles, "cycles of a result")]
    if not chosen:
        raise InputError("cycles", "must be at least one")
    points = Points.at_depth(depth, edge_angles(stops_of_one_problem([state for one in chosen for state in one])))
    found = [fatigue(one, criterion, body, points=points, constants=constants).life for one in chosen]
    known = [life for life in found if life is not None]
    if len(known) < len(found):
        owner = owner_of(chosen[0][0].problem, body)
        raise InputError("criterion", f"the {owner}'s material has no constants for a life by {criterion}")
    counts = np.full(len(known), checks.whole_number("repeats", repeats, 1))
    return points.theta, lives.miner(counts, np.array(known))


def evaluated(
    history: np.ndarray,
    state: State,
    criterion: Criterion,
    body: Body,
    place: tuple[np.ndarray, np.ndarray],
    constants: FatigueConstants | None,
) -> Fatigue:
    """The criterion on a history of stresses; `place` holds angles and depths of its points, in their shape.

    The points may lie in a bush and in the plate round it: each takes the constants of its material.
    """
    checks.choice("criterion", criterion, CRITERIA)
    if constants is not None:
        checks.instance("constants", constants, FatigueConstants, "fastpin.model.FatigueConstants")
    problem = state.problem
    depth = np.broadcast_to(place[1], place[0].shape).ravel() / problem.hole_radius
    parts: list[tuple[np.ndarray, CriterionValues]] = []
    for chosen, part in bodies_at(problem, body, depth):
        material = isotropic_material("body", problem, part, CRITERION)
        given = (material.fatigue if constants is None else constants) or FatigueConstants()
        parts.append((chosen, _values(history[:, chosen], criterion, material, given, owner_of(problem, part))))
    parameter, plane, life, limits = (
        _together([(chosen, getattr(one, name)) for chosen, one in parts], place[0].shape)
        for name in ("parameter", "plane", "life", "limit")
    )
    assert parameter is not None
    limit = parts[0][1].limit if len(parts) == 1 else limits
    return Fatigue(problem, criterion, body, *place, parameter, plane, life, limit)


def bodies_at(problem: Problem, body: Body, depth: np.ndarray) -> list[tuple[np.ndarray, Body]]:
    """Return the points of a body, and those of the plate beyond its bush, if there are any.

    `depth` is in units of the hole's radius, shape (points,). The points come as a mask of this shape.
    """
    beyond = is_beyond_bush(problem, depth) if body == "plate" else np.zeros(depth.shape, dtype=bool)
    where: list[tuple[np.ndarray, Body]] = [(~beyond, body), (beyond, "seat")]
    return [one for one in where if one[0].any()] or where[:1]


def _together(
    parts: Iterable[tuple[np.ndarray, np.ndarray | float | None]], shape: tuple[int, ...]
) -> np.ndarray | None:
    """The values of the chosen points of each part, in the shape of all points; NaN for the parts without values."""
    known = [(chosen, values) for chosen, values in parts if values is not None]
    if not known:
        return None
    found = np.full(known[0][0].shape, np.nan)
    for chosen, values in known:
        found[chosen] = values
    return found.reshape(shape)


def _values(history: np.ndarray, name: str, material: Material, given: FatigueConstants, body: str) -> CriterionValues:
    """Return the values of a criterion at points of one material, with the life if the constants give one."""
    criterion = FATIGUE_CRITERIA[name]
    found = criterion.values(history, material, *given.required(criterion.needs, name, body))
    constants = [getattr(given, constant) for constant in criterion.life_needs]
    if criterion.counting is None or None in constants:
        return found
    return found._replace(life=lives.cycles_on_curve(found.parameter, criterion.counting.curve(material, *constants)))

"""Strength of a laminate round the hole: ply failure at a distance from the edge, modes, and the load at failure.

The stress at the edge of a hole is so uneven that the first ply fails there long before the laminate does. So criteria
of plies are asked at a distance that comes from tests: on a circle round the hole, or on the characteristic curve of
Chang, Scott and Springer about the direction of the pin's force. They know neither delamination, nor damage that grows,
nor a clamped washer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastpin.damage.laminates import MODES, PlyCriterion, characteristic_radius, first_ply_failure
from fastpin.errors import InputError
from fastpin.model.angles import angle_between, near_bottom
from fastpin.model.checks import instance, not_negative
from fastpin.model.history import LoadHistory
from fastpin.model.laminate import Laminate
from fastpin.model.loads import LOAD_KIND, Corner
from fastpin.model.points import Points
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.solver.errors import ConvergenceError
from fastpin.solver.solving import solve
from fastpin.states.state import State

AROUND = 720
"""Equally spaced angles round the hole. Between them the strength ratio changes by 1e-4 of itself."""

MODE_ENDS = (15.0, 30.0, 60.0, 75.0)
"""Angles from the direction of the pin's force, deg, at which the mode of the joint changes."""

JOINT_MODES = ("bearing", "bearing or shear-out", "shear-out", "shear-out or net section", "net section")
"""Modes of the joint between these angles; Chang, Scott and Springer. Beyond 90 deg there is no mode."""

CLOSE = 1e-6
"""Largest difference of the strength ratio from 1 at the load at failure."""

MOST_SOLVED = 40
"""Most histories that are solved to find it. Three or four are usual: stresses nearly grow with the load."""

SCALED = tuple(name for name, kind in LOAD_KIND.items() if kind != "ratio")
"""The loads that a factor multiplies: all but the change of friction."""


def ply_stresses(state: State, points: Points) -> np.ndarray:
    """The stresses in the plies of a laminate, (s_1, s_2, t_12) along and across the fibres, Pa.

    Parameters
    ----------
    state : State
    points : Points

    Returns
    -------
    ndarray, shape (plies, ..., 3)
        From the lowest ply to the uppermost, at points of the shape (...,).

    Raises
    ------
    InputError
        If the plate is no laminate with plies, or a point lies outside it.
    """
    instance("state", state, State, "a fastpin.State")
    return laminate_of(state.problem).ply_stresses(_whole(state, points))


def laminate_of(problem: Problem) -> Laminate:
    """The laminate of the plate; :class:`InputError` if the plate is isotropic."""
    found = problem.joint.hole.laminate
    if found is None:
        raise InputError("plate", "must be a laminate with plies that have strengths")
    return found


def _whole(state: State, points: Points) -> np.ndarray:
    """The mean stresses (s_x, s_y, s_xy) through the thickness, Pa, shape (..., 3)."""
    stress = state.stress(points)
    return np.stack([stress.sxx, stress.syy, stress.sxy], axis=-1)


@dataclass(frozen=True, eq=False)
class JointStrength(ReadOnly):
    """The strength of a laminate at points round the hole, in one state. Arrays have the shape (m,).

    Attributes
    ----------
    theta, depth : ndarray
        Angles of the points, rad, and their distances from the edge, m.
    ratio : ndarray
        Strength ratio of the first ply: the factor on the stresses at which it fails; infinite without stress.
    ply : ndarray of int
        Place of this ply in the stack, 0 for the lowest.
    mode : ndarray of int
        Its mode, a place in :data:`fastpin.damage.MODES`.
    direction : float
        Direction of the force on the pin, rad; NaN without a force.
    laminate : Laminate
    """

    theta: np.ndarray
    depth: np.ndarray
    ratio: np.ndarray
    ply: np.ndarray
    mode: np.ndarray
    direction: float
    laminate: Laminate

    @property
    def least(self) -> int:
        """The point with the least ratio."""
        return int(np.argmin(self.ratio))

    @property
    def least_ratio(self) -> float:
        """The least strength ratio. The first ply fails where it is 1 or less."""
        return float(self.ratio[self.least])

    @property
    def angle(self) -> float:
        """The angle of the point with the least ratio, rad, at most half a turn from the bottom."""
        return near_bottom(float(self.theta[self.least]))

    @property
    def ply_angle(self) -> float:
        """The angle of the ply that fails there first, deg from axis 1 of the laminate."""
        return self.laminate.plies[int(self.ply[self.least])][1]

    @property
    def ply_mode(self) -> str:
        """The mode in which this ply fails."""
        return MODES[int(self.mode[self.least])]

    @property
    def joint_mode(self) -> str:
        """The mode of the joint by the angle from the direction of the force, one of :data:`JOINT_MODES`.

        Empty without a force, and behind the pin.
        """
        away = math.degrees(abs(float(angle_between(np.array(self.angle), self.direction))))
        if not away <= 90.0:
            return ""
        return JOINT_MODES[int(np.searchsorted(MODE_ENDS, away))]


def joint_strength(
    state: State,
    criterion: PlyCriterion = "hashin",
    *,
    distance: float | None = None,
    tension: float | None = None,
    compression: float | None = None,
) -> JointStrength:
    """The strength of a laminate round the hole in one state.

    Parameters
    ----------
    state : State
    criterion : {"hashin", "tsai-wu", "tsai-hill", "maximum-stress", "maximum-strain", "yamada-sun"}
    distance : float, optional
        Distance of a circle from the edge of the hole, m. 0 is the edge itself.
    tension, compression : float, optional
        In place of `distance`: the characteristic lengths of the curve of Chang, Scott and Springer, m, across and
        along the direction of the pin's force. The curve ends at 90 deg on either side.

    Raises
    ------
    InputError
        If neither or both kinds of lengths are given, there is no force for the curve, a length is negative, or the
        plate is no laminate whose plies have strengths.
    """
    instance("state", state, State, "a fastpin.State")
    plate = laminate_of(state.problem)
    force = complex(state.resultants["Q"], -state.resultants["P"])
    direction = float(np.angle(force)) if force else math.nan
    if distance is not None:
        if tension is not None or compression is not None:
            raise InputError("distance", "can't be given together with tension and compression")
        theta = 2.0 * math.pi * np.arange(AROUND) / AROUND - 1.5 * math.pi
        depth = np.full(AROUND, not_negative("distance", distance))
    else:
        if tension is None or compression is None:
            raise InputError("distance", "or tension and compression must be given: lengths from tests, m")
        if not force:
            raise InputError("tension", "needs a force on the pin: the characteristic curve lies about its direction")
        away = 0.5 * math.pi * np.linspace(-1.0, 1.0, AROUND // 2 + 1)
        theta, radius = direction + away, state.problem.hole_radius
        depth = characteristic_radius(away, radius, tension, compression) - radius
    found = first_ply_failure(plate, _whole(state, Points.at_depth(depth, theta)), criterion)
    return JointStrength(theta, depth, found.ratio, found.ply, found.mode, direction, plate)


@dataclass(frozen=True, eq=False)
class FailureLoad:
    """The load at which the first ply fails.

    Attributes
    ----------
    factor : float
        Factor on all loads of the history.
    state : State
        The state at the end of the history times this factor.
    strength : JointStrength
        The strength there; its least ratio is 1.
    solved : int
        Number of histories that were solved.
    """

    factor: float
    state: State
    strength: JointStrength
    solved: int


def failure_load(
    problem: Problem,
    history: LoadHistory | Sequence[Corner],
    criterion: PlyCriterion = "hashin",
    *,
    distance: float | None = None,
    tension: float | None = None,
    compression: float | None = None,
    **options: Any,
) -> FailureLoad:
    """The factor on a load history at whose end the first ply fails at a distance from the hole.

    With a clearance the stresses are not in proportion to the load. So histories are solved until the strength ratio is
    1. Damage before failure, which spreads the load, is not known to it.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory or sequence of dicts
        The loads that the factor multiplies, but for a change of friction.
    criterion, distance, tension, compression
        See :func:`joint_strength`.
    **options
        Options of :func:`fastpin.solve`, such as ``nodes``.

    Raises
    ------
    InputError
        See :func:`joint_strength`; also if the laminate carries no stress at the end of the history.
    SolveError
        If a history can't be followed, or no factor is found.
    """
    loads = history if isinstance(history, LoadHistory) else LoadHistory(history)
    factor, known = 1.0, []
    for solved in range(1, MOST_SOLVED + 1):
        state = solve(problem, loads.scaled(dict.fromkeys(SCALED, factor)), **options)[-1]
        strength = joint_strength(state, criterion, distance=distance, tension=tension, compression=compression)
        ratio = strength.least_ratio
        if not math.isfinite(ratio):
            raise InputError("history", "must stress the laminate at its end: no factor makes a ply fail there")
        if abs(ratio - 1.0) <= CLOSE:
            return FailureLoad(factor, state, strength, solved)
        known.append((math.log(factor), math.log(ratio)))
        factor = math.exp(_next_factor(known))
    raise ConvergenceError(f"no load at failure was found after {MOST_SOLVED} histories")


def _next_factor(known: list[tuple[float, float]]) -> float:
    """The logarithm of the next factor to try, from those of the known factors and their strength ratios.

    A ratio above 1 asks for a larger factor. The secant of the logarithms is taken where it stays between the nearest
    factors on both sides, and else the step for stresses in proportion to the load, or the middle.
    """
    low = max((x for x, y in known if y > 0.0), default=-math.inf)
    high = min((x for x, y in known if y < 0.0), default=math.inf)
    x, y = known[-1]
    found = x + y
    if len(known) > 1:
        before, value = known[-2]
        if y != value and low < (secant := x - y * (x - before) / (y - value)) < high:
            found = secant
    return found if low < found < high else 0.5 * (low + high)

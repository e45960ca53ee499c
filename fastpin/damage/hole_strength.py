"""Strength of a laminate round the hole: ply failure at a distance from the edge, and modes.

The stress at the edge of a hole is so uneven that the first ply fails there long before the laminate does. So criteria
of plies are asked at a distance that comes from tests: on a circle round the hole, or on the characteristic curve of
Chang, Scott and Springer about the direction of the pin's force. They know neither delamination, nor damage that grows,
nor a clamped washer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fastpin.damage.laminates import MODES, characteristic_radius, first_ply_failure
from fastpin.errors import InputError
from fastpin.model import Laminate, Points, Problem, angles, checks, ties
from fastpin.model.ply import PlyCriterion
from fastpin.model.read_only import ReadOnly
from fastpin.model.strength import StrengthAssessment, check_strength
from fastpin.states.state import State

AROUND = 720
"""Equally spaced angles round the hole. Between them the strength ratio changes by 1e-4 of itself."""

MODE_ENDS = (15.0, 30.0, 60.0, 75.0)
"""Angles from the direction of the pin's force, deg, at which the mode of the joint changes."""

JOINT_MODES = ("bearing", "bearing or shear-out", "shear-out", "shear-out or net section", "net section")
"""Modes of the joint between these angles; Chang, Scott and Springer. Beyond 90 deg there is no mode."""


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
    checks.instance("state", state, State, "a fastpin.State")
    return laminate_of(state.problem).ply_stresses(state.stress(points).in_plane)


def laminate_of(problem: Problem) -> Laminate:
    """The laminate of the plate; :class:`InputError` if the plate is isotropic."""
    found = problem.joint.hole.laminate
    if found is None:
        raise InputError("plate", "must be a laminate with plies that have strengths")
    return found


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
        """The point with the least ratio; of equal points the one farthest to the right."""
        return ties.top_angle(-self.ratio, self.theta)

    @property
    def least_ratio(self) -> float:
        """The least strength ratio. The first ply fails where it is 1 or less."""
        return float(self.ratio[self.least])

    @property
    def angle(self) -> float:
        """The angle of the point with the least ratio, rad, at most half a turn from the bottom."""
        return angles.near_bottom(float(self.theta[self.least]))

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
        away = math.degrees(abs(float(angles.angle_between(np.array(self.angle), self.direction))))
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
        If neither or both kinds of lengths are given, there is no force for the curve, a length is negative or above
        100 radii of the hole, or the plate is no laminate whose plies have strengths.
    """
    checks.instance("state", state, State, "a fastpin.State")
    plate = laminate_of(state.problem)
    how = StrengthAssessment(criterion, distance, tension, compression)
    check_strength(state.problem, how)
    lengths = how.lengths
    force = force_on_pin(state)
    direction = float(np.angle(force)) if force else math.nan
    if "distance" in lengths:
        theta = 2.0 * math.pi * np.arange(AROUND) / AROUND - 1.5 * math.pi
        depth = np.full(AROUND, lengths["distance"])
    else:
        if not force:
            words = "needs a force on the pin: the characteristic curve lies about its direction"
            raise InputError("tension", words)
        away = 0.5 * math.pi * np.linspace(-1.0, 1.0, AROUND // 2 + 1)
        theta, radius = direction + away, state.problem.hole_radius
        depth = characteristic_radius(away, radius, **lengths) - radius
    found = first_ply_failure(plate, state.stress(Points.at_depth(depth, theta)).in_plane, criterion)
    return JointStrength(theta, depth, found.ratio, found.ply, found.mode, direction, plate)


def force_on_pin(state: State) -> complex:
    """The force on the pin, x + iy, N/m."""
    return complex(state.resultants["Q"], -state.resultants["P"])


def least_strength(
    states: Sequence[State], how: StrengthAssessment, progress: Callable[[float, float], None] | None = None
) -> tuple[State, JointStrength]:
    """The state with the least strength ratio, and its strength. Of equal states it is the first one.

    Without a force on the pin there is no characteristic curve. With `tension` such states are left out.

    Parameters
    ----------
    states : sequence of State
    how : StrengthAssessment
        Criterion and lengths.
    progress : callable, optional
        Called as ``progress(done, total)`` after each state.

    Raises
    ------
    InputError
        See :func:`joint_strength`; also if no state has a force on the pin, which `tension` needs.
    """
    checks.instance("how", how, StrengthAssessment, "a fastpin.model.StrengthAssessment")
    known = checks.instances("states", states, State, "a sequence of states")
    checks.check_callable("progress", progress)
    if not known:
        raise InputError("states", "must hold at least one state")
    if "distance" not in how.lengths:
        known = [state for state in known if force_on_pin(state)] or known[:1]
    found: tuple[State, JointStrength] | None = None
    for done, state in enumerate(known, 1):
        strength = joint_strength(state, how.criterion, **how.lengths)
        if found is None or strength.least_ratio < (1.0 - ties.TIE) * found[1].least_ratio:
            found = state, strength
        if progress is not None:
            progress(done, len(known))
    assert found is not None
    return found

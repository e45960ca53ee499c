"""The theory of critical distances: fatigue from the stresses over a length of the material, not at one point.

Sources: Tanaka, Int. J. Fract. 22 (1983) R39; Taylor, Int. J. Fatigue 21 (1999) 413 (point, line and area method);
Bellett et al., Int. J. Fatigue 27 (2005) 207 (radius 1.32 L of the area method); Araujo et al., Int. J. Fatigue 29
(2007) 95 (multiaxial criteria in fretting).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from fastpin.damage.criteria import Criterion
from fastpin.damage.histories import stress_history
from fastpin.damage.hot_spots import NO_CRACK, Fatigue, evaluated, fatigue
from fastpin.errors import InputError
from fastpin.model import FatigueConstants, Problem
from fastpin.model.assessment import checked_distance
from fastpin.model.checks import choice, instance, numbers, positive
from fastpin.model.points import (
    Body,
    Points,
    edge_words,
    further_parts,
    is_beyond_bush,
    material_of,
    near_rim,
    owner_of,
)
from fastpin.reading.stress import check_body
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.state import State

DistanceMethod = Literal["point", "line", "area"]

AREA_RADIUS = 0.5 * (4.0 * (2.0 * math.sqrt(2.0) + 1.0) / (3.0 * math.pi)) ** 2
"""Radius of the area method in units of L: 1.32.

The mean of the largest principal stress over such a semicircle before a long crack at its threshold is ds_0.
"""

STRAIGHT = 1e6
"""Radius of the circle in place of a straight edge, in critical distances."""

GAUSS = 32
"""Gauss points along the line, and in both directions of the area."""


def critical_distance(threshold_range: float, limit_range: float) -> float:
    """L = (dK_th/ds_0)^2/pi, m (Taylor 1999).

    Parameters
    ----------
    threshold_range : float
        Range dK_th of the stress intensity below which long cracks do not grow, Pa sqrt(m).
    limit_range : float
        Range ds_0 of the stress at the fatigue limit of a smooth specimen, Pa.

    Raises
    ------
    InputError
        If a range is not positive and finite.
    """
    ratio = positive("threshold_range", threshold_range) / positive("limit_range", limit_range)
    length = ratio * ratio / math.pi
    if not 0.0 < length < math.inf:
        raise InputError("threshold_range", f"is {ratio:g} times limit_range: the distance can't be computed")
    return length


def fatigue_at_distance(
    states: Sequence[State],
    criterion: Criterion,
    method: DistanceMethod = "point",
    body: Body = "plate",
    *,
    theta: ArrayLike | None = None,
    length: float | None = None,
    constants: FatigueConstants | None = None,
) -> Fatigue:
    """Fatigue at angles of the edge by the theory of critical distances.

    The point method takes the stresses at the depth L/2. The line method takes their mean along the inward normal, from
    the edge to the depth 2 L. The area method takes their mean over the part of the body within 1.32 L of the point on
    the edge. Each stress component is averaged at each stop, as Taylor averages the stress; the criterion then takes
    the means. The parameter of a mean is not the mean of the parameter.

    Parameters
    ----------
    states, criterion, body, constants
        See :func:`fatigue`.
    method : {"point", "line", "area"}
    theta : array_like, optional
        Angles on the edge, rad. Unless given, the hot spot of all edges of the body.
    length : float, optional
        L, m; from ``threshold_range`` and ``limit_range`` of the constants unless given.

    Returns
    -------
    Fatigue
        With the shape of `theta`, depth L/2 for the point method, and 0 for the others. On a further edge of a plate
        the depth is that of the place on this edge.

    Raises
    ------
    InputError
        See :func:`fatigue`; also if the method is unknown, constants for L are missing, the length reaches beyond the
        body or its bush, or no `theta` is given and the parameter is 0 on the whole edge.
    """
    stops = stops_of_one_problem(states)
    problem = stops[0].problem
    check_body(problem, body)
    if constants is not None:
        instance("constants", constants, FatigueConstants, "fastpin.model.FatigueConstants")
    length, depth = checked_length(problem, method, body, length, constants), 0.0
    if theta is None:
        spot = fatigue(stops, criterion, body, constants=constants).hot_spot
        theta, depth = spot.theta, spot.depth
        if math.isnan(theta):
            raise InputError("theta", f"must be given: the edge has no hot spot, {NO_CRACK}")
    angles = numbers("theta", theta)
    points, weights = points_of_means(problem, method, body, length, angles, depth)
    history = stress_history(stops, points, body).reshape(len(stops), *points.shape, 4)
    place = angles, np.full(angles.shape, depth or mean_depth(method, length))
    return evaluated(np.einsum("tpqc,q->tpc", history, weights), stops[0], criterion, body, place, constants)


def checked_length(
    problem: Problem, method: str, body: Body, length: float | None = None, constants: FatigueConstants | None = None
) -> float:
    """Return L, m: the given one, or that of the constants, by default those of the body's material.

    Raises
    ------
    InputError
        If the method is unknown, the length is not positive, or constants are missing.
    """
    choice("method", method, get_args(DistanceMethod))
    if length is None:
        given = (material_of(problem, body).fatigue if constants is None else constants) or FatigueConstants()
        names = ("threshold_range", "limit_range")
        length = critical_distance(*given.required(names, f'method "{method}"', owner_of(problem, body)))
    return checked_distance(length)


def mean_depth(method: str, length: float) -> float:
    """Return the depth that belongs to a mean, m: L/2 for the point method, 0 for the others."""
    return 0.5 * length if method == "point" else 0.0


def points_of_means(
    problem: Problem, method: DistanceMethod, body: Body, length: float, angles: np.ndarray, depth: float = 0.0
) -> tuple[Points, np.ndarray]:
    """Return the points of the means at angles of the edge, shape (angles, q), and their weights, shape (q,).

    With a `depth`, m, the place at one angle lies on a further edge of a plate of any outline.

    Raises
    ------
    InputError
        If the points lie outside the body, or beyond its bush.
    """
    (part,) = further_parts(problem, body, angles.flat[0], depth) if depth else (None,)
    if part is not None:
        away = near_rim(problem, body) * problem.hole_radius + depth
        return _below_further(problem, method, length, part, complex(away * np.exp(1j * angles.flat[0])))
    radius = problem.hole_radius
    below, turn, weights = _places(method, length / radius, near_rim(problem, body), -1.0 if body == "pin" else 1.0)
    points = Points.at_depth(below * radius, np.ravel(angles)[:, None] + turn)
    if body == "plate" and is_beyond_bush(problem, points.depths(problem, body)).any():
        raise InputError("length", f"{length:g} reaches beyond the bush: a mean over two materials has no meaning")
    return points, weights


def _below_further(
    problem: Problem, method: DistanceMethod, length: float, part: Any, place: complex
) -> tuple[Points, np.ndarray]:
    """Points of the mean below a place x + iy, m, on a part of a further edge, shape (1, q), and weights (q,).

    The part is a circle with the plate outside or inside; a straight one is a very large circle.
    """
    lug = problem.plate_body.lug.geometry
    foot, along = (complex(each[0]) for each in part.nearest(np.array([place])))
    centre, radius, _, sweep = part.circle or (foot - 1j * along * STRAIGHT * length, STRAIGHT * length, 0.0, -1.0)
    sign = math.copysign(1.0, -sweep)
    depth, turn, weights = _places(method, length / radius, 1.0, sign)
    z = centre + (foot - centre) * (1.0 + sign * depth) * np.exp(1j * turn)
    if not lug.contains(z).all():
        words = f"{length:g} reaches out of the plate below a place {edge_words(problem, part.name, foot)}"
        raise InputError("length", words)
    return Points.at_xy(z.real[None], z.imag[None]), weights


def _places(
    method: DistanceMethod, length: float, edge: float, sign: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depths and angles of the points of a mean, counted from a point on the edge, and their weights, each (q,).

    Depths, `length` and the radius `edge` of the edge are in units of one radius. The `sign` is 1 where the body lies
    outside of its edge, and -1 where it lies inside. The points crowd towards the edge, where the stress has a root.
    """
    if edge != 1.0:
        depth, turn, weights = _places(method, length / edge, 1.0, sign)
        return edge * depth, turn, weights
    if method == "point":
        return np.array([0.5 * length]), np.zeros(1), np.ones(1)
    u, part = np.polynomial.legendre.leggauss(GAUSS)
    u, part = 0.5 * (u + 1.0), 0.5 * part
    if method == "line":
        return 2.0 * length * u**2, np.zeros(GAUSS), 2.0 * u * part
    away = AREA_RADIUS * length * u**2
    widest = np.arccos(np.clip(-0.5 * sign * away, -1.0, 1.0))
    swing = np.outer(widest, 2.0 * u - 1.0)  # angles from the inward normal
    distance = np.broadcast_to(away[:, None], swing.shape)
    inward, sideways = distance * np.cos(swing), distance * np.sin(swing)
    beyond = distance**2 + 2.0 * sign * inward  # r^2 - 1
    depth = np.maximum(sign * beyond / (np.sqrt(np.maximum(1.0 + beyond, 0.0)) + 1.0), 0.0)
    weights = np.outer(away * u * part * widest, part)
    turn = np.arctan2(sideways, 1.0 + sign * inward)
    return depth.ravel(), turn.ravel(), (weights / weights.sum()).ravel()

"""The fatigue of a load spectrum as a section [fatigue] asks for it: bodies ranked by their damage."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fastpin.damage.counted import CountedMaterial
from fastpin.damage.distance import checked_length, mean_depth, points_of_means
from fastpin.damage.histories import Progress, different_states, history_blocks, with_residual
from fastpin.damage.hot_spots import edge_points
from fastpin.damage.reserve import Goal, StressReserve, stress_reserve
from fastpin.damage.spectrum import FEW, SpectrumCount, SpectrumDamage, halves, spectrum_count
from fastpin.errors import InputError, InputWarning
from fastpin.model.assessment import FatigueAssessment, assessed_bodies, check_assessment
from fastpin.model.checks import check_callable, instance
from fastpin.model.doubts import warn_of
from fastpin.model.points import Body, Points, edge_body, material_of, owner_of
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.quantities import load_point
from fastpin.states.state import State

MOST_REFINED = 500
"""States of a spectrum up to which refined tractions are read unasked: some ten seconds."""


MOST_STRAIGHT = 1.25
"""Largest ratio of damages without and with straight lines that is not told: some 4 % of the stress."""


def assessed_fatigue(
    states: Sequence[State],
    how: FatigueAssessment | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> list[SpectrumDamage]:
    """Damage of the bodies over one pass of a spectrum: criterion by criterion, the largest damage first.

    A body without damage stands last. By a method of critical distances the entry of a body has the angles of the
    assessment, or the hot spots of the hole's edge and of the further edges of a plate of any outline alone. Without
    damage on the edges it is that of the edges. A further edge below which the distance leaves the plate is left out,
    with a warning.

    Parameters
    ----------
    states : sequence of State
        The stops of one pass, see :func:`spectrum_damage`. ``Result.assessed_fatigue`` chooses them.
    how : FatigueAssessment, optional
        By default Smith, Watson and Topper, on the edges of all bodies with its constants.
    progress : callable, optional
        Called as ``progress(done, total)`` now and then.

    Raises
    ------
    InputError
        See :func:`spectrum_damage` and :func:`fatigue_at_distance`; also if a body of the assessment is rigid or not
        there.
    """
    stops, how, jobs, tell = _jobs(states, how, progress)
    found = [_of_body(stops, how, criterion, body, tell(job)) for job, (criterion, body) in enumerate(jobs)]
    return sorted(found, key=lambda one: (how.criteria.index(one.criterion), -one.hot_spot.damage))


def assessed_reserves(
    states: Sequence[State],
    how: FatigueAssessment | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> list[StressReserve]:
    """By what factor all stresses may grow, body by body as :func:`assessed_fatigue`: the smallest factor first.

    The goal is the life that the assessment asks for. Without a life the largest cycle may reach the knee, and without
    a knee one pass of the spectrum must do no more damage than 1.

    Parameters
    ----------
    states, how, progress
        See :func:`assessed_fatigue`. A method of critical distances without angles takes the place of the edge whose
        stresses may grow least.

    Raises
    ------
    InputError
        See :func:`assessed_fatigue`.
    """
    stops, how, jobs, tell = _jobs(states, how, progress)
    goal = Goal.of(how.life, how.knee)
    found = []
    for number, (criterion, body) in enumerate(jobs):
        told = tell(number)
        if how.method == "edge":
            found.append(stress_reserve(_edge_count(stops, how, criterion, body), goal, told))
            continue
        places = [] if how.theta is None else [(theta, 0.0) for theta in how.theta.tolist()]
        if not places:  # those of the hole's edge and of the further edges
            every = edge_points(different_states(stops, _is_straight(stops, how))[0], body, most=FEW)
            assert every.depth is not None
            parts = [part for part in (every.depth == 0.0, every.depth > 0.0) if part.any()]
            apart = [Points.at_depth(every.depth[part], every.theta[part]) for part in parts]
            reserves = [stress_reserve(_edge_count(stops, how, criterion, body, each), goal, told) for each in apart]
            places = [(each.theta, each.depth) for each in reserves if each.is_finite]
        found.append(
            stress_reserve(_count_of_means(stops, how, criterion, body, places), goal, told) if places else reserves[0]
        )
    return sorted(found, key=lambda one: (how.criteria.index(one.criterion), one.factor))


def _jobs(
    states: Sequence[State], how: FatigueAssessment | None, progress: Callable[[float, float], None] | None
) -> tuple[Sequence[State], FatigueAssessment, list[tuple[str, Body]], Callable[[int], Progress]]:
    """Check the arguments, and return states, assessment, pairs of criterion and body, and the progress of each."""
    stops = stops_of_one_problem(states)
    how = FatigueAssessment() if how is None else instance("how", how, FatigueAssessment, "a FatigueAssessment")
    check_callable("progress", progress)
    check_assessment(stops[0].problem, how)
    jobs = [
        (criterion, body) for criterion in how.criteria for body in assessed_bodies(stops[0].problem, how, criterion)
    ]

    def tell(job: int) -> Progress:
        return lambda part: None if progress is None else progress(job + part, len(jobs))

    return stops, how, jobs, tell


def _of_body(
    stops: Sequence[State], how: FatigueAssessment, criterion: str, body: Body, tell: Progress
) -> SpectrumDamage:
    """Return the damage of one body by one criterion."""
    share = 1.0 if how.method == "edge" else 0.5
    places = [] if how.theta is None else [(theta, 0.0) for theta in how.theta.tolist()]
    if how.method == "edge" or not places:
        edge = _edge_count(stops, how, criterion, body).damage(*halves(lambda done, total: tell(share * done / total)))
        if how.straight is None and _is_straight(stops, how):
            _doubt_straight(stops, edge, how)
        if how.method == "edge" or math.isnan(edge.hot_spot.theta):
            return edge
        for on_edge in (edge.depth == 0.0, edge.depth > 0.0):
            spot = replace(edge, damage=np.where(on_edge, edge.damage, 0.0)).hot_spot
            places += [] if math.isnan(spot.theta) else [(spot.theta, spot.depth)]
    count = _count_of_means(stops, how, criterion, body, places)
    return count.damage(*halves(lambda done, total: tell(1.0 - share + share * done / total)))


def _doubt_straight(stops: Sequence[State], edge: SpectrumDamage, how: FatigueAssessment) -> None:
    """Warn if the worst cycle of a body does another damage with refined tractions: the grid is too coarse."""
    if not edge.cycles.damage.size:
        return
    wanted = {float(each[0]) for each in (edge.cycles.start, edge.cycles.stop, edge.cycles.largest)}
    few = list({load_point(state): state for state in stops if load_point(state) in wanted}.values())
    points = edge_points(few, edge.body, most=0)  # type: ignore[arg-type]
    straight, refined = (
        _edge_count(few, how.changed(straight=each), edge.criterion, edge.body, points)  # type: ignore[arg-type]
        .damage(*halves(None))
        .hot_spot.damage
        for each in (True, False)
    )
    if not straight / MOST_STRAIGHT <= refined <= straight * MOST_STRAIGHT:
        where = f"at the edge of the {edge_body(edge.problem, edge.body)}"
        words = f"with refined tractions the worst cycle {where} does {refined / straight:.2g} times the damage"
        words += "; straight = false takes them, and more nodes bring both closer"
        warn_of([InputWarning("straight", words)], 4)


def _is_straight(stops: Sequence[State], how: FatigueAssessment) -> bool:
    return len(stops) > MOST_REFINED if how.straight is None else how.straight


def _edge_count(
    stops: Sequence[State], how: FatigueAssessment, criterion: str, body: Body, points: Points | None = None
) -> SpectrumCount:
    """Return the count at points, by default at the given angles of an edge, or all along it."""
    if points is None and how.theta is not None:
        points = Points.at_depth(0.0, how.theta)
    return spectrum_count(stops, criterion, body, points, straight=_is_straight(stops, how), how=how)


def _count_of_means(
    stops: Sequence[State], how: FatigueAssessment, criterion: str, body: Body, places: Sequence[tuple[float, float]]
) -> SpectrumCount:
    """Return the count of the means of the stresses at places of the edges, by the theory of critical distances.

    The `places` are angles, rad, and depths, m: 0 on the edge of the hole.
    """
    problem, method, straight = stops[0].problem, how.method, _is_straight(stops, how)
    length = checked_length(problem, method, body, how.length)
    means: list[tuple[Points, np.ndarray, Any]] = []
    kept = []
    for place, (theta, depth) in enumerate(places):
        try:
            some, weights = points_of_means(problem, method, body, length, np.array([theta]), depth)  # type: ignore[arg-type]
        except InputError as error:
            if depth == 0.0 or (place == len(places) - 1 and not means):
                raise
            warn_of([InputWarning(error.field, f"{error.reason}: this edge is left out")], 5)
            continue
        means.append((some, weights, how.residual_stress if depth == 0.0 else None))
        kept.append((theta, depth or mean_depth(method, length)))
    counted = CountedMaterial.of(criterion, material_of(problem, body), None, owner_of(problem, body), how)
    different, order = different_states(stops, straight)

    def blocks(progress: Progress) -> Iterator[tuple[slice, np.ndarray]]:
        """Yield the mean stresses, place by place."""
        for k, (some, weights, residual) in enumerate(means):
            mean = np.zeros((len(different), 1, 4))
            read = partial(history_blocks, different, some, body, straight)
            for part, history in with_residual(read, problem, body, some, residual)(lambda part: None):
                mean[:, 0] += np.einsum("tqc,q->tc", history, weights[part])
            progress((k + 1) / len(means))
            yield slice(k, k + 1), mean

    theta, depth = np.array(kept).T
    parts = [(np.ones(theta.size, bool), counted)]
    return SpectrumCount(criterion, body, theta, depth, different, order, parts, blocks)

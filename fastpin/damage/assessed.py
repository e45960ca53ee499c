"""The fatigue of a load spectrum as a section [fatigue] asks for it: bodies ranked by their damage."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from fastpin.damage.counted import CountedMaterial
from fastpin.damage.distance import checked_length, mean_depth, points_of_means
from fastpin.damage.histories import Progress, different_states, history_blocks
from fastpin.damage.spectrum import SpectrumDamage, counted_damage, halves, spectrum_damage
from fastpin.model.assessment import FatigueAssessment, assessed_bodies, check_assessment
from fastpin.model.checks import check_callable, instance
from fastpin.model.points import Body, Points, material_of, owner_of
from fastpin.states.choice import stops_of_one_problem
from fastpin.states.state import State

MOST_REFINED = 500
"""States of a spectrum up to which refined tractions are read unasked: some ten seconds."""


def assessed_fatigue(
    states: Sequence[State],
    how: FatigueAssessment | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> list[SpectrumDamage]:
    """Damage of the bodies over one pass of a spectrum: criterion by criterion, the largest damage first.

    A body without damage stands last. By a method of critical distances the entry of a body has the angles of the
    assessment, or the hot spot of the edge alone. Without damage on the edge it is that of the edge.

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
    stops = stops_of_one_problem(states)
    how = FatigueAssessment() if how is None else instance("how", how, FatigueAssessment, "a FatigueAssessment")
    if progress is not None:
        check_callable("progress", progress)
    problem = stops[0].problem
    check_assessment(problem, how)
    jobs = [(criterion, body) for criterion in how.criteria for body in assessed_bodies(problem, how, criterion)]

    def tell(job: int) -> Progress:
        return lambda part: None if progress is None else progress(job + part, len(jobs))

    found = [_of_body(stops, how, criterion, body, tell(job)) for job, (criterion, body) in enumerate(jobs)]
    return sorted(found, key=lambda one: (how.criteria.index(one.criterion), -one.hot_spot.damage))


def _of_body(
    stops: Sequence[State], how: FatigueAssessment, criterion: Any, body: Body, tell: Progress
) -> SpectrumDamage:
    """Return the damage of one body by one criterion."""
    straight = len(stops) > MOST_REFINED if how.straight is None else how.straight
    theta, share = how.theta, 1.0 if how.method == "edge" else 0.5

    if how.method == "edge" or theta is None:
        edge = spectrum_damage(
            stops, criterion, body, points=None if theta is None else Points.at_depth(0.0, theta), straight=straight,
            small_cycles=how.small_cycles, knee=how.knee, progress=lambda done, total: tell(share * done / total),
        )  # fmt: skip
        if how.method == "edge" or math.isnan(edge.hot_spot.theta):
            return edge
        theta = np.array([edge.hot_spot.theta])
    return _of_means(stops, how, (criterion, body), theta, straight, lambda part: tell(1.0 - share + share * part))


def _of_means(
    stops: Sequence[State],
    how: FatigueAssessment,
    which: tuple[str, Body],
    theta: np.ndarray,
    straight: bool,
    tell: Progress,
) -> SpectrumDamage:
    """Return the damage of the means of the stresses at angles of the edge, by the theory of critical distances."""
    (criterion, body), problem, method = which, stops[0].problem, how.method
    length = checked_length(problem, method, body, how.length)
    points, weights = points_of_means(problem, method, body, length, theta)  # type: ignore[arg-type]
    counted = CountedMaterial.of(
        criterion, material_of(problem, body), None, owner_of(problem, body), how.small_cycles, how.knee
    )
    different, order = different_states(stops, straight)
    tell_read, tell_counted = halves(lambda done, total: tell(done / total))

    def means() -> Iterator[tuple[slice, np.ndarray]]:
        """Yield the mean stresses, angle by angle."""
        assert points.depth is not None
        for k in range(theta.size):
            some = Points.at_depth(points.depth[k], points.theta[k])
            mean = np.zeros((len(different), 1, 4))
            for part, history in history_blocks(different, some, body, straight):
                mean[:, 0] += np.einsum("tqc,q->tc", history, weights[part])
            tell_read((k + 1) / theta.size)
            yield slice(k, k + 1), mean

    where = body, theta, np.full(theta.shape, mean_depth(method, length))
    return counted_damage(
        criterion, where, (different, order), [(np.ones(theta.size, bool), counted)], means(), tell_counted
    )

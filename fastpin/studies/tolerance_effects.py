"""The effects of tolerances on one outcome: swings, extremes, percentiles and rank correlations, from numbers alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fastpin.assess.outputs import ROUNDING

PERCENTS = (5, 50, 95)
"""Percentiles of the samples."""


class Reached(NamedTuple):
    """A value of an outcome, and the place of its point in the plan."""

    value: float
    place: int


class Span(NamedTuple):
    """The smallest and the largest value of some runs."""

    smallest: Reached
    largest: Reached


@dataclass(frozen=True)
class OutcomeEffect:
    """The effect of all tolerances on one outcome. A run without a value counts nowhere and is NaN.

    Attributes
    ----------
    nominal : float
        The value of the nominal case.
    alone : dict of str to list of float
        The values where one field differs from the nominal case, in the order of its :class:`FieldLimits`.
    corners, everywhere : Span or None
        The extremes of the corners, and of all runs; None if none has a value.
    percentiles : dict of int to float
        Of the samples, see :data:`PERCENTS`; empty without samples.
    correlations : dict of str to float
        Spearman's rank correlation of each field with the outcome over the samples, -1 to 1. NaN where the outcome is
        the same in all samples, or less than three have a value.
    """

    nominal: float
    alone: dict[str, list[float]]
    corners: Span | None
    everywhere: Span | None
    percentiles: dict[int, float]
    correlations: dict[str, float]

    @property
    def swings(self) -> dict[str, float]:
        """The largest minus the smallest value of each field alone, the largest swing first. NaN without two values."""
        known = {name: [value for value in values if math.isfinite(value)] for name, values in self.alone.items()}
        found = {name: max(some) - min(some) if len(some) > 1 else math.nan for name, some in known.items()}
        return dict(sorted(found.items(), key=lambda item: -item[1] if math.isfinite(item[1]) else math.inf))

    @property
    def beyond(self) -> Span | None:
        """The extremes of all runs where they lie beyond all corners; else those of the corners. None without corners.

        An outcome that first rises and then falls with a field has its extreme between the limits.
        """
        if self.corners is None or self.everywhere is None:
            return None
        least = ROUNDING * max(abs(end.value) for end in self.everywhere)
        pairs = zip(self.corners, self.everywhere, strict=True)
        return Span(*(end if abs(end.value - corner.value) > least else corner for corner, end in pairs))


def effect_of(
    values: np.ndarray,
    inputs: Mapping[str, np.ndarray],
    alone: Mapping[str, Sequence[int]],
    corners: range,
    samples: range,
) -> OutcomeEffect:
    """Return the effect of tolerances on one outcome.

    Parameters
    ----------
    values : ndarray, shape (points,)
        The outcome at each point; NaN without a value.
    inputs : dict of str to ndarray, shape (points,)
        The fields at each point.
    alone : dict of str to list of int
        The places of the points where one field differs from the nominal case, which has place 0.
    corners, samples : range
        The places of corners and samples.
    """
    sampled, known = values[samples.start : samples.stop], np.isfinite(values[samples.start : samples.stop])
    fields = {name: column[samples.start : samples.stop][known] for name, column in inputs.items()}
    percentiles = np.percentile(sampled[known], PERCENTS).tolist() if known.any() else []
    return OutcomeEffect(
        float(values[0]),
        {name: values[list(places)].tolist() for name, places in alone.items()},
        _span(values, corners),
        _span(values, range(len(values))),
        dict(zip(PERCENTS, percentiles, strict=False)),
        {name: rank_correlation(column, sampled[known]) for name, column in fields.items()} if samples else {},
    )


def rank_correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Return Spearman's rank correlation of two arrays, shape (n,). NaN if n < 3, or if all values of one are equal.

    Values that differ by less than :data:`ROUNDING` of the largest are equal. Equal values share their middle rank.
    """
    if len(first) < 3:
        return math.nan
    ranks = np.array([_ranks(first), _ranks(second)])
    if (np.ptp(ranks, axis=1) == 0.0).any():
        return math.nan
    return float(np.corrcoef(ranks)[0, 1])


def _ranks(values: np.ndarray) -> np.ndarray:
    """Return the ranks of values, shape (n,)."""
    least = ROUNDING * float(np.abs(values).max()) or 1.0
    _, inverse, counts = np.unique(np.round(values / least), return_inverse=True, return_counts=True)
    middles: np.ndarray = np.cumsum(counts) - 0.5 * (counts - 1)
    return middles[inverse]


def _span(values: np.ndarray, places: range) -> Span | None:
    known = [place for place in places if math.isfinite(values[place])]
    if not known:
        return None
    smallest, largest = (choose(known, key=values.__getitem__) for choose in (min, max))
    return Span(Reached(float(values[smallest]), smallest), Reached(float(values[largest]), largest))

"""Lives at a reliability: the scatter of log life about a curve, and tolerance factors for few specimens.

The scatter is the standard error of log10 N about the curve. It is that of specimens: one specimen that is weaker than
the median is so under all loads. So all cycles of a spectrum have lives that are shorter by one factor, and Miner's sum
grows by this factor.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.checks import in_one_shape, number, number_array, numbers, whole_number
from fastpin.model.fatigue import LEAST_SAMPLES, FatigueConstants
from fastpin.runtime.extensions import special


def life_shift(how: FatigueAssessment, given: FatigueConstants, body: str) -> float:
    """Return log10 of the median life over the life at the reliability of an assessment.

    Raises
    ------
    InputError
        If the material of the `body` has no scatter, or with a confidence no number of specimens.
    """
    if how.reliability is None:
        return 0.0
    scatter, *samples = given.required(how.scatter_needs, "a life at a reliability", body)
    if how.confidence is None:
        return NormalDist().inv_cdf(how.reliability) * scatter
    fitted = 3 if given.curve_c == 0.0 else 4  # A, B, m and C
    return tolerance_factor(how.reliability, how.confidence, int(samples[0]), fitted) * scatter


def tolerance_factor(reliability: float, confidence: float, samples: int, fitted: int = 4) -> float:
    """Standard errors between the median life and the life at a reliability, with a confidence.

    The one-sided factor of normal samples, by the noncentral t distribution (Owen 1968), for a fitted curve: n - p
    degrees of freedom, and a mean of n/p samples. In Monte Carlo trials of fitted curves the confidence of 0.95 was
    0.942 to 0.950.

    Parameters
    ----------
    reliability, confidence : float
        Between 0 and 1, both not included.
    samples : int
        Number n of specimens, at least 6, and more than `fitted`.
    fitted : int
        Number p of constants of the curve.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    fitted = whole_number("fitted", fitted, 1)
    n = whole_number("samples", samples, max(LEAST_SAMPLES, fitted + 1))
    for name, value in (("reliability", reliability), ("confidence", confidence)):
        if not 0.0 < number(name, value) < 1.0:
            raise InputError(name, f"must lie between 0 and 1, not {value:g}")
    root = math.sqrt(n / fitted)
    return float(special.nctdtrit(n - fitted, NormalDist().inv_cdf(reliability) * root, confidence)) / root


def failure_probability(life: ArrayLike, median: ArrayLike, scatter: float) -> np.ndarray:
    """Part of the specimens that fail within a life: Phi(log10(life/median)/scatter).

    Parameters
    ----------
    life, median : array_like
        Passes or cycles, above 0; any shapes that fit. A median may be infinite.
    scatter : float
        Standard error of log10 N, above 0.

    Raises
    ------
    InputError
        If a number is out of range.
    """
    error = number("scatter", scatter, 0.0)
    if error == 0.0:
        raise InputError("scatter", "must be positive, not 0")
    lives, medians = in_one_shape("median", numbers("life", life, 0.0, open_low=True), number_array("median", median))
    if not np.all(medians > 0.0):
        raise InputError("median", "must be above 0")
    ratio = (np.log10(lives) - np.log10(medians)) / error
    return np.asarray(np.vectorize(NormalDist().cdf, otypes=[float])(ratio))

"""Whether fat cycles keep their promise: random lives of wear against the same lives cycle by cycle.

The lives are those of the class wear of :mod:`tests.survey.histories`, with more cycles and other coefficients: the
depth becomes a hundredth to a third of the elastic displacement, F beta*. Errors are the largest at all chosen cycles:
of the worn gap and the volume in parts of the depth and volume there, and of the pressure at the beginning of a cycle
in parts of the largest.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import fastpin
from fastpin.model.profile import Profile
from fastpin.model.profile_terms import Harmonic, Zone
from fastpin.wear_lives.wear_result import WearResult
from tests.survey.histories import RandomCase

DEPTHS = (0.01, 0.3)
"""Smallest and largest depth of a life, about, in parts of the elastic displacement."""

SLOW = 1e-3
"""Part of the coefficients of the class with which the wear of a settled cycle is measured."""

LEAST_WEAR = 1e-9
"""Smallest depth of a cycle of a life that wears, in parts of the coefficient of its case."""


class Seen(NamedTuple):
    """Largest errors of a life by fat cycles, and its solved cycles in parts of all."""

    gap: float
    volume: float
    pressure: float
    solved: float


def scaled(coefficient: float | Profile, factor: float) -> float | Profile:
    """A wear coefficient of the class times a factor: a number, or a constant with a zone."""
    if not isinstance(coefficient, Profile):
        return factor * coefficient
    harmonic, zone = coefficient.terms
    assert isinstance(harmonic, Harmonic)
    assert isinstance(zone, Zone)
    return Profile((replace(harmonic, cosine=factor * harmonic.cosine), replace(zone, value=factor * zone.value)))


def life(case: RandomCase, factor: float, **changed: Any) -> WearResult:
    """The life of a random case with its coefficients times a factor, and with other options."""
    options = {**case.options, **changed}
    for name in {"coefficient", "pin", "plate"} & set(options):
        options[name] = scaled(options[name], factor)
    return fastpin.wear(case.problem, case.history, **options)


def factor_of(case: RandomCase, seed: int, cycles: int) -> float | None:
    """The factor on the coefficients of a life that wears; None if it shakes down."""
    *_, before, after = life(case, SLOW, cycles=6, at=[5], tolerance=0.0)
    grown = float((after.gap_growth - before.gap_growth).max())
    unit = 1.0 if case.problem.dimensionless else 1e-3 * case.problem.hole_radius
    if grown < LEAST_WEAR * SLOW * unit:
        return None
    wanted = math.exp(np.random.default_rng(seed).uniform(*np.log(DEPTHS)))
    return SLOW * wanted * unit / (cycles * grown)


def seen(direct: WearResult, fat: WearResult) -> Seen:
    """The errors of a life by fat cycles."""
    gap = volume = pressure = 0.0
    for one, other in zip(direct[1:], fat[1:], strict=True):
        if one.depth == 0.0:
            continue
        gap = max(gap, float(np.abs(one.gap_growth - other.gap_growth).max()) / one.depth)
        volume = max(volume, abs(one.volume - other.volume) / one.volume)
        most = float(one.pressure.max())
        if most > 0.0:
            pressure = max(pressure, float(np.abs(one.pressure - other.pressure).max()) / most)
    return Seen(gap, volume, pressure, fat[-1].solved / direct[-1].solved)

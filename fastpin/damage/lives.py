"""Lives: from parameters of criteria, at a reliability, and by curves and counts of the optional package pylife.

The scatter of a life is the standard error of log10 N about its curve. It is that of specimens: one specimen that is
weaker than the median is so under all loads. So all cycles of a spectrum have lives that are shorter by one factor, and
Miner's sum grows by this factor.
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.assessment import FatigueAssessment, checked_knee
from fastpin.model.checks import (
    in_one_shape,
    negative,
    not_negative,
    number,
    number_array,
    numbers,
    positive,
    whole_number,
)
from fastpin.model.fatigue import LEAST_SAMPLES, FatigueConstants
from fastpin.runtime.extensions import special

FLAT, NEGLIGIBLE = 1e-12, 1e-100
"""Exponent of a stress without an end: (2N)^-FLAT is 1 to 4e-11 for all lives; and a coefficient that is none."""


class LifeCurve(NamedTuple):
    """A parameter as the sum of two falling powers of 2N: coefficients above 0, and exponents below 0."""

    coefficients: tuple[float, float]
    exponents: tuple[float, float]


def smith_watson_topper_life(
    parameter: ArrayLike,
    E: float,
    fatigue_strength: float,
    strength_exponent: float,
    fatigue_ductility: float,
    ductility_exponent: float,
) -> np.ndarray:
    """Cycles N at which sf'^2/E (2N)^(2b) + sf' ef' (2N)^(b+c) equals the parameter (Smith, Watson and Topper 1970).

    Parameters
    ----------
    parameter : array_like
        Values of :func:`smith_watson_topper`, Pa; any shape.
    E, fatigue_strength, strength_exponent, fatigue_ductility, ductility_exponent : float
        Young's modulus, Pa, and the constants sf', Pa, b, ef' and c of :class:`fastpin.model.FatigueConstants`.

    Returns
    -------
    ndarray
        Cycles, shape of the parameter; infinite where it is 0.

    Raises
    ------
    InputError
        If a parameter is negative, a coefficient not positive or an exponent not negative.
    """
    constants = fatigue_strength, strength_exponent, fatigue_ductility, ductility_exponent
    return cycles_on_curve(parameter, smith_watson_topper_curve(E, *constants))


def smith_watson_topper_curve(
    E: float, fatigue_strength: float, strength_exponent: float, fatigue_ductility: float, ductility_exponent: float
) -> LifeCurve:
    """The curve of :func:`smith_watson_topper_life`, also for the constants and the errors."""
    strength = positive("fatigue_strength", fatigue_strength)
    elastic = _coefficient("fatigue_strength", strength / positive("E", E) * strength)
    plastic = _coefficient("fatigue_ductility", strength * positive("fatigue_ductility", fatigue_ductility))
    b, c = negative("strength_exponent", strength_exponent), negative("ductility_exponent", ductility_exponent)
    return LifeCurve((elastic, plastic), (2.0 * b, b + c))


def fatemi_socie_life(
    parameter: ArrayLike,
    shear_modulus: float,
    shear_fatigue_strength: float,
    shear_strength_exponent: float,
    shear_fatigue_ductility: float,
    shear_ductility_exponent: float,
) -> np.ndarray:
    """Cycles N at which tf'/G (2N)^b0 + gf' (2N)^c0 equals the parameter (Fatemi and Socie 1988).

    Parameters
    ----------
    parameter : array_like
        Values of :func:`fatemi_socie`, rad; any shape.
    shear_modulus, shear_fatigue_strength : float
    shear_strength_exponent, shear_fatigue_ductility, shear_ductility_exponent : float
        G, Pa, and the constants tf', Pa, b0, gf' and c0 of :class:`fastpin.model.FatigueConstants`.

    Returns
    -------
    ndarray
        Cycles, shape of the parameter; infinite where it is 0.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper_life`.
    """
    constants = shear_fatigue_strength, shear_strength_exponent, shear_fatigue_ductility, shear_ductility_exponent
    return cycles_on_curve(parameter, fatemi_socie_curve(shear_modulus, *constants))


def fatemi_socie_curve(
    shear_modulus: float,
    shear_fatigue_strength: float,
    shear_strength_exponent: float,
    shear_fatigue_ductility: float,
    shear_ductility_exponent: float,
) -> LifeCurve:
    """The curve of :func:`fatemi_socie_life`, also for the constants and the errors."""
    strength = positive("shear_fatigue_strength", shear_fatigue_strength)
    elastic = _coefficient("shear_fatigue_strength", strength / positive("shear_modulus", shear_modulus))
    plastic = positive("shear_fatigue_ductility", shear_fatigue_ductility)
    b = negative("shear_strength_exponent", shear_strength_exponent)
    return LifeCurve((elastic, plastic), (b, negative("shear_ductility_exponent", shear_ductility_exponent)))


def stress_life_curve(A: float, B: float, C: float, Kt: float) -> LifeCurve:
    """The curve log10 N = A - B log10(S/Kt - C) of an equivalent stress S, Pa, as Kt (C + (10^A/N)^(1/B)).

    The stress Kt C without an end is a power of 2N whose exponent is as good as 0: -:data:`FLAT`.

    Raises
    ------
    InputError
        If a constant is out of range.
    """
    slope, kt = positive("curve_b", B), positive("curve_kt", Kt)
    falling = _coefficient("curve_a", 10.0 ** min((number("curve_a", A) + math.log10(2.0)) / slope, 300.0) * kt)
    return LifeCurve((max(not_negative("curve_c", C) * kt, NEGLIGIBLE * falling), falling), (-FLAT, -1.0 / slope))


def scattered(curve: LifeCurve, shift: float) -> LifeCurve:
    """The curve with lives shorter by the factor 10^shift at all parameters; a parameter without an end stays."""
    c, e = curve.coefficients, curve.exponents
    falling = (each if -slope <= FLAT else each * 10.0 ** (shift * slope) for each, slope in zip(c, e, strict=True))
    return LifeCurve(tuple(falling), e)  # type: ignore[arg-type]


def miner(counts: ArrayLike, lives: ArrayLike) -> np.ndarray:
    """The sum of n_i/N_i over the blocks of a spectrum (Palmgren 1924, Miner 1945); 1 means failure.

    Parameters
    ----------
    counts : array_like, shape (blocks,)
        Numbers n_i of cycles, at least 0.
    lives : array_like, shape (blocks, ...)
        Lives N_i in cycles, above 0; an infinite life does no damage.

    Returns
    -------
    ndarray
        Damage sums, shape of the lives of one block.

    Raises
    ------
    InputError
        If a number is out of range, or there are not as many lives as counts.
    """
    number_of, cycles = numbers("counts", counts, 0.0), number_array("lives", lives)
    if number_of.ndim != 1 or cycles.shape[:1] != number_of.shape:
        raise InputError("lives", f"must have as many rows as there are counts, not {cycles.shape[:1]}")
    if not np.all(cycles > 0.0):
        raise InputError("lives", "must be above 0")
    return np.tensordot(number_of, 1.0 / cycles, axes=1)


def curve_with_knee(
    curve: LifeCurve, degree: int, rule: str = "elementary", knee: float | None = None, power: float = 0.0
) -> np.ndarray:
    """Return the numbers of a curve of lives, and of its part beyond the knee, for :mod:`fastpin.damage.plane_damage`.

    Let P be the parameter, P_D that of the curve at the knee N_D, and P proportional to the power `degree` of the
    amplitude: 2 for Smith, Watson and Topper, 1 for Fatemi and Socie. The slope at the knee is k in
    N ~ amplitude^-k = P^(-k/degree), from the tangent of the curve in logarithms. Below P_D:

    * "elementary": the curve goes on.
    * "original": no damage.
    * "haibach": N = N_D (P_D/P)^((2k - 1)/degree), the slope 2k - 1 (Haibach 1970).

    Parameters
    ----------
    curve : LifeCurve
    degree : int
    rule : {"elementary", "original", "haibach"}
    knee : float, optional
        N_D, cycles; for "original" and "haibach" only.
    power : float
        The power of the stress range in the parameter of "stress-life".

    Returns
    -------
    ndarray, shape (8,)
        Logarithms of both coefficients, both exponents, logarithms of P_D and 2 N_D, the slope beyond them, the power.

    Raises
    ------
    InputError
        If the rule is unknown, its knee is missing or out of range, or the slope k at the knee is not above 1.
    """
    cycles = checked_knee(rule, knee)
    logs, slopes = np.log(curve.coefficients), np.array(curve.exponents)
    if cycles is None:
        return np.array([*logs, *slopes, -np.inf, 0.0, 0.0, power])
    at = math.log(2.0 * cycles)
    powers = logs + at * slopes
    limit = float(np.logaddexp(*powers))
    k = -degree / float(np.sum(slopes * np.exp(powers - limit)))
    if k <= 1.0:
        raise InputError("knee", f"must lie where the slope k of the curve of lives is above 1, not {k:.3g}")
    beyond = np.inf if rule == "original" else (2.0 * k - 1.0) / degree
    return np.array([*logs, *slopes, limit, at, beyond, power])


def _coefficient(field: str, value: float) -> float:
    """Check a coefficient of a life that was computed from constants, and return it."""
    if not 0.0 < value < math.inf:
        raise InputError(field, f"must give a coefficient that is a positive number, not {value:g}")
    return value


def cycles_on_curve(parameter: ArrayLike, curve: LifeCurve) -> np.ndarray:
    """Cycles at which the sum of two falling powers of 2N equals the parameter.

    The logarithm of the sum is a convex, falling function of x = log 2N. Newton's method begins where one power alone
    equals the parameter. It goes up to the root without passing it.
    """
    values = numbers("parameter", parameter, 0.0)
    logs, slopes = np.log(curve.coefficients), np.array(curve.exponents)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        target = np.log(values)
        x = np.max((target[..., None] - logs) / slopes, axis=-1)
        for _ in range(100):
            powers = logs + x[..., None] * slopes
            total = np.logaddexp(powers[..., 0], powers[..., 1])
            slope = np.sum(slopes * np.exp(powers - total[..., None]), axis=-1)
            moved = np.where(np.isfinite(target), np.maximum(x, x - (total - target) / slope), np.inf)
            if np.array_equal(moved, x):
                break
            x = moved
        return 0.5 * np.exp(x)


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


class Counted(NamedTuple):
    """The closed cycles of a repeated history.

    Attributes
    ----------
    range : ndarray, shape (cycles,)
        Largest less smallest value of each cycle.
    mean : ndarray, shape (cycles,)
        Half the sum of both.
    """

    range: np.ndarray
    mean: np.ndarray


def rainflow(values: ArrayLike) -> Counted:
    """Count the cycles of a history that is repeated for ever, such as the hoop stress at a hot spot.

    The history is turned so that it begins and ends at its largest value. Then every cycle is closed (Matsuishi and
    Endo 1968; ASTM E1049, 5.4.5). The four-point method of pylife counts them.

    Parameters
    ----------
    values : array_like, shape (stops,)
        One period, in the order of time, of any unit. Its last value need not equal its first one.

    Raises
    ------
    InputError
        If the values are no list of at least two finite numbers, or pylife is not installed.
    """
    history = numbers("values", values)
    if history.ndim != 1 or history.size < 2:
        raise InputError("values", f"must be a list of at least two numbers, not of the shape {history.shape}")
    try:
        from pylife.stress.rainflow import FourPointDetector, LoopValueRecorder
    except ImportError:
        raise _missing() from None
    turned, recorder = np.roll(history, -int(np.argmax(history))), LoopValueRecorder()
    detector = FourPointDetector(recorder=recorder).process(np.append(turned, turned[0]))
    left = np.asarray(detector.residuals, dtype=float)
    start = np.append(np.asarray(recorder.values_from, dtype=float), left[:-2:2])
    stop = np.append(np.asarray(recorder.values_to, dtype=float), left[1:-1:2])
    return Counted(np.abs(stop - start), 0.5 * (start + stop))


def stress_life(
    amplitude: ArrayLike, knee_amplitude: float, knee_cycles: float, slope: float, slope_below: float = math.inf
) -> np.ndarray:
    """Cycles of a stress-life curve with one knee, N = N_D (s_a/s_D)^(-slope), by the Woehler curve of pylife.

    Parameters
    ----------
    amplitude : array_like
        Amplitudes s_a, Pa, above 0; any shape. Mean stresses must have been taken into account.
    knee_amplitude, knee_cycles : float
        s_D, Pa, and N_D of the knee.
    slope, slope_below : float
        Slopes above and below the knee, at least 1. With an infinite slope below there is a fatigue limit.

    Returns
    -------
    ndarray
        Cycles, shape of the amplitudes; infinite below a fatigue limit.

    Raises
    ------
    InputError
        If a number is out of range, or pylife is not installed.
    """
    loads = numbers("amplitude", amplitude, 0.0, open_low=True)
    knee, cycles = positive("knee_amplitude", knee_amplitude), positive("knee_cycles", knee_cycles)
    above = number("slope", slope, 1.0)
    has_limit = isinstance(slope_below, float) and slope_below == math.inf
    below = math.inf if has_limit else number("slope_below", slope_below, 1.0)
    try:
        import pandas  # a dependency of pylife
        from pylife.materiallaws import WoehlerCurve
    except ImportError:
        raise _missing() from None
    curve = WoehlerCurve(pandas.Series({"SD": knee, "ND": cycles, "k_1": above, "k_2": below}))
    return np.asarray(curve.cycles(loads.ravel()), dtype=float).reshape(loads.shape)


def _missing() -> InputError:
    return InputError("pylife", "is not installed: pip install 'fastpin[fatigue]'")

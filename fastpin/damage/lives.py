"""Lives from parameters of criteria, and sums of damage."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.assessment import checked_knee
from fastpin.model.checks import negative, not_negative, number, number_array, numbers, positive

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

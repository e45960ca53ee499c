"""Strength of laminates: criteria of ply failure, first-ply failure, and criteria at a distance from a hole.

A criterion has a function f of the stresses of a ply in its own axes, and the ply fails where f = 1. Two numbers tell
how far it is away.

The failure index is f at the given stresses. It grows with the stresses, but not in proportion, for most f are
quadratic. By Tsai and Wu and by Hashin it may be negative.

The strength ratio R is the factor on all stresses, and so on a single load, at which f = 1. It is infinite without
stress. It doubles when the stresses halve. A ply fails where R is at most 1.

These are criteria of stresses in plies that are stuck together. They say nothing of delamination and free edges, of
stresses through the thickness, of residual stresses from curing, nor of the load that a laminate carries after its
first ply has failed. A hole makes the stress at its edge so uneven that the first ply fails long before the laminate:
:func:`point_stress_ratio`, :func:`average_stress_ratio` and :func:`yamada_sun` at a measured distance are meant for it.

Sources. No paper itself was at hand. The formulas of Tsai and Hill (in the form of Azzi and Tsai), Tsai and Wu, and
Yamada and Sun were read in public notes on composites. Those of Hashin (1980) were read in the manual of HyperView and
in public programs, which have the paper's figure 6 among their tests. The point stress and the average stress of
Whitney and Nuismer (1974) were read in public programs. The characteristic curve of Chang, Scott and Springer (1982)
was seen by name only: compare its formula with the paper.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import FastpinError, InputError
from fastpin.model.checks import check_callable, choice, instance, not_negative, number, number_array, positive, triples
from fastpin.model.laminate import Laminate
from fastpin.model.ply import CRITERION_NAMES, LEAST_MODULUS, MOST_MODULUS, Ply, PlyCriterion, PlyStrengths
from fastpin.model.ties import is_top

MODES = ("fibre tension", "fibre compression", "matrix tension", "matrix compression", "shear")
"""Modes of ply failure, in the order of the places in :attr:`PlyFailure.mode`."""

GAUSS_POINTS = 48
"""Points of the mean stress. It is exact for polynomials of degree 95: the stress at a hole falls smoothly."""


@dataclass(frozen=True, eq=False)
class PlyFailure:
    """The failure of plies, arrays of one shape.

    Attributes
    ----------
    index : ndarray
        The failure index f.
    ratio : ndarray
        The strength ratio R; infinite without stress.
    mode : ndarray of int64
        Places in :data:`MODES`. Tsai and Hill, and Tsai and Wu, know no modes: theirs is that of the largest stress in
        parts of its strength.
    """

    index: np.ndarray
    ratio: np.ndarray
    mode: np.ndarray


@dataclass(frozen=True, eq=False)
class FirstPly:
    """The first failure of a ply of a laminate, arrays of the shape of the stresses without their last axis.

    Attributes
    ----------
    ratio : ndarray
        The least strength ratio of all plies: the factor on the load at which the first ply fails.
    ply : ndarray of int64
        Place of this ply in the stack, 0 for the lowest one. Of equal plies it is the lowest.
    mode : ndarray of int64
        Its mode, a place in :data:`MODES`.
    """

    ratio: np.ndarray
    ply: np.ndarray
    mode: np.ndarray


def maximum_stress(stress: ArrayLike, strengths: PlyStrengths) -> PlyFailure:
    """The criterion of maximum stress: f is the largest stress in parts of its strength, and R = 1/f.

    Parameters
    ----------
    stress : array, shape (..., 3)
        (s_1, s_2, t_12) of plies in their own axes, Pa.
    strengths : PlyStrengths

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    return _largest(_parts(triples("stress", stress), _checked(strengths)))


def maximum_strain(stress: ArrayLike, ply: Ply) -> PlyFailure:
    """The criterion of maximum strain: f is the largest strain in parts of the strain at failure, and R = 1/f.

    A ply is linear up to failure: the strains at failure are Xt/E1, Xc/E1, Yt/E2, Yc/E2 and S/G12.

    Parameters
    ----------
    stress : array, shape (..., 3)
        See :func:`maximum_stress`.
    ply : Ply
        The ply, with its strengths.

    Raises
    ------
    InputError
        If an argument can't be used, or the ply has no strengths.
    """
    strengths = _strengths_of(ply)
    s1, s2, t12 = np.moveaxis(triples("stress", stress), -1, 0)
    strains = np.stack([s1 - ply.nu12 * s2, s2 - ply.nu12 * ply.E2 / ply.E1 * s1, t12], axis=-1)  # times the moduli
    return _largest(_parts(strains, strengths))


def tsai_hill(stress: ArrayLike, strengths: PlyStrengths) -> PlyFailure:
    """The criterion of Tsai and Hill: f = (s_1/X)^2 - s_1 s_2/X^2 + (s_2/Y)^2 + (t_12/S)^2, and R = 1/sqrt(f).

    X and Y are the strengths in tension or compression, by the signs of s_1 and s_2 (Azzi and Tsai 1965).

    Parameters
    ----------
    stress, strengths
        See :func:`maximum_stress`.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    values = triples("stress", stress)
    parts = _parts(values, _checked(strengths))
    along, across, shear = _by_axis(parts)
    limit = np.where(values[..., 0] < 0.0, strengths.Xc, strengths.Xt)
    index = along**2 - values[..., 0] / limit * (values[..., 1] / limit) + across**2 + shear**2
    return PlyFailure(index, _ratio(index, np.zeros_like(index)), np.argmax(parts, axis=0))


def tsai_wu(stress: ArrayLike, strengths: PlyStrengths, interaction: float = -0.5) -> PlyFailure:
    """The criterion of Tsai and Wu: f = F1 s_1 + F2 s_2 + F11 s_1^2 + F22 s_2^2 + F66 t_12^2 + 2 F12 s_1 s_2.

    F1 = 1/Xt - 1/Xc, F2 = 1/Yt - 1/Yc, F11 = 1/(Xt Xc), F22 = 1/(Yt Yc), F66 = 1/S^2 and F12 = F12* sqrt(F11 F22).

    Parameters
    ----------
    stress, strengths
        See :func:`maximum_stress`.
    interaction : float
        F12*, between -1 and 1. The usual value -1/2 makes f that of von Mises for an isotropic ply.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    values, known = triples("stress", stress), _checked(strengths)
    star = number("interaction", interaction)
    if not -1.0 < star < 1.0:
        raise InputError("interaction", f"must lie between -1 and 1, not {star:g}")
    s1, s2, t12 = np.moveaxis(values, -1, 0)
    along, across = s1 / math.sqrt(known.Xt * known.Xc), s2 / math.sqrt(known.Yt * known.Yc)
    square = along**2 + across**2 + (t12 / known.S) ** 2 + 2.0 * star * along * across
    linear = (1.0 / known.Xt - 1.0 / known.Xc) * s1 + (1.0 / known.Yt - 1.0 / known.Yc) * s2
    return PlyFailure(square + linear, _ratio(square, linear), np.argmax(_parts(values, known), axis=0))


def hashin(stress: ArrayLike, strengths: PlyStrengths, transverse_shear: float | None = None) -> PlyFailure:
    """The criterion of Hashin (1980) in plane stress, the worse one of a fibre mode and a matrix mode.

    * fibre tension, s_1 > 0: f = (s_1/Xt)^2 + (t_12/S)^2
    * fibre compression, s_1 <= 0: f = (s_1/Xc)^2
    * matrix tension, s_2 >= 0: f = (s_2/Yt)^2 + (t_12/S)^2
    * matrix compression, s_2 < 0: f = (s_2/2St)^2 + [(Yc/2St)^2 - 1] s_2/Yc + (t_12/S)^2

    Parameters
    ----------
    stress, strengths
        See :func:`maximum_stress`.
    transverse_shear : float, optional
        St, the strength in shear across the fibres, Pa. The default is Yc/2: matrix compression is then
        f = (s_2/Yc)^2 + (t_12/S)^2.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    values, known = triples("stress", stress), _checked(strengths)
    shear_strength = 0.5 * known.Yc
    if transverse_shear is not None:
        strength = positive("transverse_shear", transverse_shear)
        shear_strength = number("transverse_shear", strength, LEAST_MODULUS, MOST_MODULUS)
    s1, s2, t12 = np.moveaxis(values, -1, 0)
    none, shear = np.zeros_like(s1), (t12 / known.S) ** 2
    is_pressed, is_squeezed = s1 <= 0.0, s2 < 0.0
    fibre = np.where(is_pressed, (s1 / known.Xc) ** 2, (s1 / known.Xt) ** 2 + shear)
    matrix = np.where(is_squeezed, (0.5 * s2 / shear_strength) ** 2, (s2 / known.Yt) ** 2) + shear
    linear = np.where(is_squeezed, ((0.5 * known.Yc / shear_strength) ** 2 - 1.0) * s2 / known.Yc, none)
    first, second = _ratio(fibre, none), _ratio(matrix, linear)
    is_fibre = first < second
    mode = np.where(is_fibre, np.where(is_pressed, 1, 0), np.where(is_squeezed, 3, 2))
    return PlyFailure(np.where(is_fibre, fibre, matrix + linear), np.minimum(first, second), mode)


PLY_CRITERIA: dict[str, Callable[[np.ndarray, Ply], PlyFailure]] = {
    "maximum-stress": lambda stress, ply: maximum_stress(stress, _strengths_of(ply)),
    "maximum-strain": maximum_strain,
    "tsai-hill": lambda stress, ply: tsai_hill(stress, _strengths_of(ply)),
    "tsai-wu": lambda stress, ply: tsai_wu(stress, _strengths_of(ply)),
    "hashin": lambda stress, ply: hashin(stress, _strengths_of(ply)),
    "yamada-sun": lambda stress, ply: yamada_sun(stress, _strengths_of(ply)),
}
"""The criteria of ply failure by the names of :data:`fastpin.model.ply.PlyCriterion`."""


def ply_failure(laminate: Laminate, stress: ArrayLike, criterion: PlyCriterion = "hashin") -> PlyFailure:
    """The failure of all plies of a laminate under a stress of the whole.

    Parameters
    ----------
    laminate : Laminate
        A laminate with plies that have strengths.
    stress : array, shape (..., 3)
        (s_x, s_y, s_xy) of the whole, Pa: means through the thickness.
    criterion : {"hashin", "tsai-wu", "tsai-hill", "maximum-stress", "maximum-strain", "yamada-sun"}
        The criterion, with the usual values of its constants.

    Returns
    -------
    PlyFailure
        Arrays of the shape (plies, ...), from the lowest ply to the uppermost.

    Raises
    ------
    InputError
        If an argument can't be used, or a ply has no strengths.
    """
    evaluate = PLY_CRITERIA[choice("criterion", criterion, CRITERION_NAMES)]
    known = instance("laminate", laminate, Laminate, "a fastpin.model.Laminate")
    stresses = dict(zip(known.plies, known.ply_stresses(stress), strict=True))  # equal plies have equal stresses
    found = {layer: evaluate(each, layer[0]) for layer, each in stresses.items()}
    each_ply = [found[layer] for layer in known.plies]
    return PlyFailure(*(np.array([getattr(each, name) for each in each_ply]) for name in ("index", "ratio", "mode")))


def first_ply_failure(laminate: Laminate, stress: ArrayLike, criterion: PlyCriterion = "hashin") -> FirstPly:
    """The factor on a stress of the whole at which the first ply fails.

    Parameters
    ----------
    laminate, stress, criterion
        See :func:`ply_failure`.

    Raises
    ------
    InputError
        See :func:`ply_failure`.
    """
    found = ply_failure(laminate, stress, criterion)
    ply = np.argmax(is_top(-np.moveaxis(found.ratio, 0, -1)), axis=-1)  # of equal ones the first
    ratio, mode = (np.take_along_axis(values, ply[np.newaxis], 0)[0] for values in (found.ratio, found.mode))
    return FirstPly(ratio, ply, mode)


def point_stress_ratio(profile: Callable[[np.ndarray], np.ndarray], strength: float, distance: float) -> float:
    """The strength ratio of a laminate with a hole by the point stress of Whitney and Nuismer: strength / s(d0).

    Parameters
    ----------
    profile : callable
        The stress of the whole across the line on which the laminate breaks, Pa, tension positive, at distances ahead
        of the edge, m: ``profile(distances)`` returns an array of the same shape.
    strength : float
        Strength of the laminate without a hole, Pa.
    distance : float
        The characteristic distance d0, m. It comes from tests with holes of one laminate, and is no property of a ply.

    Returns
    -------
    float
        The factor on the load at which the laminate breaks; infinite if the stress is no tension.

    Raises
    ------
    InputError
        If an argument can't be used, or the profile returns anything but one number a distance.
    """
    check_callable("profile", profile, 1)
    return _over(positive("strength", strength), _values(profile, np.array([positive("distance", distance)]))[0])


def average_stress_ratio(profile: Callable[[np.ndarray], np.ndarray], strength: float, length: float) -> float:
    """The strength ratio by the average stress of Whitney and Nuismer: strength / (mean of s from 0 to a0).

    Parameters
    ----------
    profile, strength
        See :func:`point_stress_ratio`.
    length : float
        The characteristic length a0, m, from tests.

    Returns
    -------
    float
        See :func:`point_stress_ratio`.

    Raises
    ------
    InputError
        See :func:`point_stress_ratio`.
    """
    check_callable("profile", profile, 1)
    places, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    distances = 0.5 * positive("length", length) * (1.0 + places)
    return _over(positive("strength", strength), 0.5 * float(weights @ _values(profile, distances)))


def characteristic_radius(theta: ArrayLike, radius: float, tension: float, compression: float) -> np.ndarray:
    """The characteristic curve of Chang, Scott and Springer: r = R + r_t + (r_c - r_t) cos(theta).

    Parameters
    ----------
    theta : array
        Angle from the direction of the load on the pin, rad, from -pi/2 to pi/2.
    radius : float
        Radius R of the hole, m.
    tension, compression : float
        Characteristic lengths r_t and r_c, m, from tests in tension and in bearing.

    Returns
    -------
    ndarray
        Distance of the curve from the centre of the hole, m, in the shape of `theta`.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    angle = number_array("theta", theta)
    if not np.all(np.abs(angle) <= 0.5 * math.pi + 1e-9):
        raise InputError("theta", "must lie within a quarter of a turn from the direction of the load, rad")
    across, ahead = not_negative("tension", tension), not_negative("compression", compression)
    curve: np.ndarray = positive("radius", radius) + across + (ahead - across) * np.cos(angle)
    return curve


def yamada_sun(stress: ArrayLike, strengths: PlyStrengths) -> PlyFailure:
    """The criterion of Yamada and Sun: f = (s_1/X)^2 + (t_12/S)^2, and R = 1/sqrt(f).

    It supposes that all other strength across the fibres is lost when the laminate breaks. X is Xt or Xc by the sign of
    s_1. Designs evaluate it in each ply on the curve of :func:`characteristic_radius`, and take for S the shear
    strength that cross-ply laminates show, which is above that of a ply alone.

    Parameters
    ----------
    stress, strengths
        See :func:`maximum_stress`.

    Raises
    ------
    InputError
        If an argument can't be used.
    """
    parts = _parts(triples("stress", stress), _checked(strengths))
    along, _, shear = _by_axis(parts)
    index = along**2 + shear**2
    mode = np.where(shear > along, 4, np.argmax(parts[:2], axis=0))
    return PlyFailure(index, _ratio(index, np.zeros_like(index)), mode)


def _checked(strengths: PlyStrengths) -> PlyStrengths:
    return instance("strengths", strengths, PlyStrengths, "a fastpin.model.PlyStrengths")


def _strengths_of(ply: Ply) -> PlyStrengths:
    strengths = instance("ply", ply, Ply, "a fastpin.model.Ply").strengths
    if strengths is None:
        name = f"the ply {ply.name}" if ply.name else "a ply"
        raise InputError("strengths", f"are missing: {name} has none")
    return strengths


def _parts(values: np.ndarray, strengths: PlyStrengths) -> np.ndarray:
    """Stresses in parts of the strengths, in the order of :data:`MODES`: shape (5, ...). A stress has one sign only."""
    s1, s2, t12 = np.moveaxis(values, -1, 0)
    parts = [s1 / strengths.Xt, -s1 / strengths.Xc, s2 / strengths.Yt, -s2 / strengths.Yc, np.abs(t12) / strengths.S]
    return np.maximum(np.array(parts), 0.0) + 0.0  # -0 becomes 0


def _by_axis(parts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sizes of s_1, s_2 and t_12 in parts of their strengths."""
    return parts[0] + parts[1], parts[2] + parts[3], parts[4]


def _largest(parts: np.ndarray) -> PlyFailure:
    index = np.max(parts, axis=0)
    with np.errstate(divide="ignore"):
        return PlyFailure(index, 1.0 / index, np.argmax(parts, axis=0))


def _ratio(square: np.ndarray, linear: np.ndarray) -> np.ndarray:
    """The least positive root R of square R^2 + linear R = 1; infinite if there is none."""
    inside = linear * linear + 4.0 * square
    root = np.sqrt(np.maximum(inside, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(linear >= 0.0, 2.0 / (linear + root), 0.5 * (root - linear) / square)
    is_safe = (inside < 0.0) | ((square <= 0.0) & (linear <= 0.0))
    return np.where(is_safe, math.inf, found)  # NaN stays NaN


def _values(profile: Callable[[np.ndarray], np.ndarray], distances: np.ndarray) -> np.ndarray:
    """The stresses of a profile at distances ahead of the edge."""
    if profile is None:
        raise InputError("profile", "must be a callable, not None")
    try:
        values = profile(distances)
    except FastpinError:
        raise
    except Exception as error:  # The function is anyone's.
        words = f"must take an array of distances, it raised a {type(error).__name__}"
        raise InputError("profile", words) from error
    found = number_array("profile", values)
    if found.shape != distances.shape or not np.all(np.isfinite(found)):
        raise InputError("profile", f"must return finite numbers of the shape {distances.shape}")
    return found


def _over(strength: float, stress: float) -> float:
    return strength / float(stress) if stress > 0.0 else math.inf

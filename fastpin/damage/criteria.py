"""Fatigue criteria on stress histories: the parameter of each point over one whole cycle.

A history is an array of shape (stops, points, 4): the stresses sxx, syy, szz and sxy, Pa, tension positive, at the
stops of a cycle. The order of the stops makes no difference, and the path may turn in any way. The other shear stresses
are zero: plane strain or plane stress. The criteria of planes search all planes that hold the z axis.

Sources: Smith, Watson and Topper, J. Materials 5 (1970) 767; Fatemi and Socie, Fatigue Fract. Eng. Mater. Struct. 11
(1988) 149; Findley, J. Eng. Ind. 81 (1959) 301; Crossland, Proc. Int. Conf. Fatigue of Metals, London (1956) 138; Dang
Van, Sci. Tech. Armement 47 (1973); Papadopoulos et al., Int. J. Fatigue 19 (1997) 219, for the smallest sphere.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.damage import lives, plane_damage, plane_search, spheres
from fastpin.errors import InputError
from fastpin.model.checks import number, numbers, positive
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.materials import Material
from fastpin.runtime.threads import in_chunks

COMPONENTS = ("sxx", "syy", "szz", "sxy")
"""The components of a stress history, in the order of its last axis."""

SCANNED, NARROWED = 144, 24
"""Planes of the scan of :func:`equivalent_stress`, and halvings of the interval beside the best one."""

CHUNK = 64
"""Points that one thread searches at a time."""

ROUNDING = 1e-9
"""A parameter below this part of its natural size is rounding: its angle and plane have no meaning."""

Criterion = Literal["smith-watson-topper", "fatemi-socie", "stress-life", "findley", "crossland", "dang-van"]


class Planes(NamedTuple):
    """The parameter of a criterion of planes, and its planes.

    Attributes
    ----------
    parameter : ndarray, shape (points,)
        The largest value over all planes.
    angle : ndarray, shape (points,)
        Angle of the plane's normal from the +x axis, counter-clockwise, in (-pi/2, pi/2], rad; NaN where the parameter
        is 0. Several planes may share the largest value; one of them is given.
    """

    parameter: np.ndarray
    angle: np.ndarray


def smith_watson_topper(history: ArrayLike, E: float, nu: float) -> Planes:
    """The largest normal stress times the amplitude of the normal strain, on the worst plane, Pa.

    SWT = max over planes of max(s_n, 0) (max e_n - min e_n)/2, with e_n = ((1 + nu) s_n - nu (sxx + syy + szz))/E
    (Smith, Watson and Topper 1970; on planes Socie 1987). It is 0 where no plane is ever in tension.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    E, nu : float
        Young's modulus, Pa, and Poisson's ratio.

    Raises
    ------
    InputError
        If the history has another shape or a number that is not finite, or a constant is out of range.
    """
    stresses = _checked(history)
    return _worst(
        *_normal_strain(stresses, positive("E", E), number("nu", nu, 0.0, 0.5)), plane_search.SWING_TIMES_PUSH
    )


def fatemi_socie(history: ArrayLike, shear_modulus: float, k: float, yield_strength: float) -> Planes:
    """The amplitude of the shear strain, raised by the largest normal stress, on the worst plane, rad.

    FS = max over planes of (max gamma - min gamma)/2 (1 + k max(s_n, 0)/s_y), gamma = tau/G (Fatemi and Socie 1988).
    The plane is the one with the largest parameter, not the one with the largest shear.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    shear_modulus, yield_strength : float
        G and s_y, Pa.
    k : float
        Weight of the normal stress, at least 0.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper`.
    """
    stresses = _checked(history)
    weight = number("k", k, 0.0) / positive("yield_strength", yield_strength)
    return _worst(
        *_shear_strain(stresses, positive("shear_modulus", shear_modulus), weight), plane_search.SWING_TIMES_MORE
    )


def equivalent_stress(history: ArrayLike, m: float) -> Planes:
    """The largest equivalent stress of all planes, Pa: S_max (1 - R)^m = (S_max - S_min)^m S_max^(1 - m).

    S is the normal stress of the plane (Walker 1970). It is 0 where no plane is ever in tension.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    m : float
        Walker's exponent, 0.01 to 0.99.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper`.
    """
    normal, power = _on_planes(_checked(history)), number("m", m, 0.01, 0.99)

    def value(x: np.ndarray) -> np.ndarray:
        stress = normal[..., 0] + normal[..., 1] * np.cos(x) + normal[..., 2] * np.sin(x)
        return np.asarray(np.ptp(stress, axis=0) ** power * np.maximum(stress.max(axis=0), 0.0) ** (1.0 - power))

    places = np.linspace(-np.pi, np.pi, SCANNED + 1)[1:]
    step, turned = places[1] - places[0], np.array([value(np.full(normal.shape[1], x)) for x in places])
    # Of planes that mirror each other the one with the larger angle is told.
    best = turned >= (1.0 - plane_search.TIE) * turned.max(axis=0)
    middle = places[SCANNED - 1 - np.argmax(best[::-1], axis=0)]
    for _ in range(NARROWED):
        tried = middle + step * np.linspace(-1.0, 1.0, 5)[:, None]
        middle = np.take_along_axis(tried, np.argmax([value(x) for x in tried], axis=0)[None], 0)[0]
        step *= 0.5
    angle, parameter = 0.5 * middle, value(middle)
    angle = np.where(angle > 0.5 * np.pi, angle - np.pi, np.where(angle <= -0.5 * np.pi, angle + np.pi, angle))
    return Planes(parameter, np.where(parameter > 0.0, angle, np.nan))


def findley(history: ArrayLike, k: float) -> Planes:
    """The amplitude of the shear stress plus a part of the largest normal stress, on the worst plane, Pa.

    max over planes of (max tau - min tau)/2 + k max s_n (Findley 1959). See :func:`findley_limit` for k and the limit.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    k : float
        Weight of the normal stress, at least 0.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper`.
    """
    normal = _on_planes(_checked(history))
    return _worst(_shear(normal), number("k", k, 0.0) * normal, plane_search.SWING_AND_PUSH)


def crossland(history: ArrayLike, alpha: float) -> np.ndarray:
    """The amplitude of the deviator plus a part of the largest hydrostatic stress, Pa, shape (points,).

    sqrt(J2,a) + alpha max(s_H) (Crossland 1956), s_H = (sxx + syy + szz)/3. sqrt(J2,a) is the radius of the smallest
    sphere round the path of the deviator, with the distance sqrt(s:s/2) (Papadopoulos et al. 1997). See
    :func:`crossland_limit` for alpha and the limit.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    alpha : float
        Weight of the hydrostatic stress.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper`.
    """
    stresses = _checked(history)
    radius = smallest_spheres(_deviator(stresses))[1]
    return radius + number("alpha", alpha) * stresses[..., :3].mean(axis=-1).max(axis=0)


def dang_van(history: ArrayLike, a: float) -> np.ndarray:
    """The largest shear stress of a grain plus a part of the hydrostatic stress, Pa, shape (points,).

    max over the stops of tau(t) + a s_H(t) (Dang Van 1973). tau is half Tresca's stress of the deviator, less its
    residual part. This part is the centre of the smallest sphere round the path of the deviator. See
    :func:`dang_van_limit` for a and the limit.

    Parameters
    ----------
    history : array_like, shape (stops, points, 4)
        Stresses, Pa; see :mod:`fastpin.damage.criteria`.
    a : float
        Weight of the hydrostatic stress.

    Raises
    ------
    InputError
        As :func:`smith_watson_topper`.
    """
    stresses = _checked(history)
    path = _deviator(stresses)
    out_of_plane, half, shear = np.moveaxis(path - smallest_spheres(path)[0], -1, 0)
    circle, middle = np.hypot(half, shear), out_of_plane / math.sqrt(3.0)
    principal = np.stack([middle + circle, middle - circle, -2.0 * middle])
    tresca = principal.max(axis=0) - principal.min(axis=0)
    return (0.5 * tresca + number("a", a) * stresses[..., :3].mean(axis=-1)).max(axis=0)


def findley_limit(bending_limit: float, torsion_limit: float) -> tuple[float, float]:
    """k of Findley's criterion, and the limit of its parameter, Pa.

    k = (2 t - f)/(2 sqrt(t (f - t))), limit t sqrt(1 + k^2), from the amplitudes f and t of the fatigue limits under
    fully reversed bending and torsion. Both then lie at the limit.

    Raises
    ------
    InputError
        If the limits do not satisfy f/2 <= t < f.
    """
    f, t = _limits(bending_limit, torsion_limit)
    if not 0.5 * f <= t < f:
        raise InputError("torsion_limit", f"must lie between half the bending limit of {f:g} and this limit, not {t:g}")
    k = (2.0 * t - f) / (2.0 * math.sqrt(t * (f - t)))
    return k, t * math.sqrt(1.0 + k * k)


def crossland_limit(bending_limit: float, torsion_limit: float) -> tuple[float, float]:
    """alpha = 3 t/f - sqrt(3) of Crossland's criterion, and the limit t of its parameter, Pa (Crossland 1956)."""
    f, t = _limits(bending_limit, torsion_limit)
    return 3.0 * t / f - math.sqrt(3.0), t


def dang_van_limit(bending_limit: float, torsion_limit: float) -> tuple[float, float]:
    """a = 3 t/f - 3/2 of Dang Van's criterion, and the limit t of its parameter, Pa."""
    f, t = _limits(bending_limit, torsion_limit)
    return 3.0 * t / f - 1.5, t


def smallest_spheres(paths: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The smallest sphere round the path of each point, exact to rounding.

    Parameters
    ----------
    paths : array_like, shape (stops, points, dimension)

    Returns
    -------
    centre : ndarray, shape (points, dimension)
    radius : ndarray, shape (points,)

    Raises
    ------
    InputError
        If the paths have another shape, or a number that is not finite.
    """
    array = numbers("paths", paths)
    if array.ndim != 3 or 0 in array.shape:
        raise InputError("paths", f"must have the shape (stops, points, dimension), not {array.shape}")
    shift = int(np.frexp(np.abs(array).max())[1])
    scaled = np.ldexp(np.ascontiguousarray(array.transpose(1, 0, 2)), -shift)
    out = np.empty((scaled.shape[0], scaled.shape[2] + 1))
    in_chunks(scaled.shape[0], CHUNK, lambda part: spheres.enclosing_spheres(scaled[part], out[part]))
    out = np.ldexp(out, shift)
    return out[:, :-1], out[:, -1]


def _checked(history: ArrayLike) -> np.ndarray:
    array = numbers("history", history)
    if array.ndim != 3 or array.shape[2] != len(COMPONENTS) or 0 in array.shape:
        raise InputError("history", f"must have the shape (stops, points, {len(COMPONENTS)}), not {array.shape}")
    return array


def _limits(bending_limit: float, torsion_limit: float) -> tuple[float, float]:
    return positive("bending_limit", bending_limit), positive("torsion_limit", torsion_limit)


def _on_planes(stresses: np.ndarray) -> np.ndarray:
    """The normal stress as coefficients of 1, cos 2 phi and sin 2 phi, shape (stops, points, 3)."""
    sxx, syy, _, sxy = np.moveaxis(stresses, -1, 0)
    return np.stack([0.5 * (sxx + syy), 0.5 * (sxx - syy), sxy], axis=-1)


def _shear(normal: np.ndarray) -> np.ndarray:
    """The shear stress on planes in the same form, from the normal stress."""
    return np.stack([np.zeros(normal.shape[:2]), normal[..., 2], -normal[..., 1]], axis=-1)


def _normal_strain(stresses: np.ndarray, modulus: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Normal strain and normal stress on planes, in the same form."""
    normal = _on_planes(stresses)
    strain = (1.0 + ratio) / modulus * normal
    strain[..., 0] -= ratio / modulus * stresses[..., :3].sum(axis=-1)
    return strain, normal


def _shear_strain(stresses: np.ndarray, shear_modulus: float, weight: float) -> tuple[np.ndarray, np.ndarray]:
    """Shear strain and the weighted normal stress on planes, in the same form."""
    normal = _on_planes(stresses)
    return _shear(normal) / shear_modulus, weight * normal


def _deviator(stresses: np.ndarray) -> np.ndarray:
    """The deviator as a vector of length sqrt(J2), shape (stops, points, 3)."""
    sxx, syy, szz, sxy = np.moveaxis(stresses, -1, 0)
    return np.stack([(sxx + syy - 2.0 * szz) / math.sqrt(12.0), 0.5 * (sxx - syy), sxy], axis=-1)


def _worst(swung: np.ndarray, push: np.ndarray, form: int) -> Planes:
    """The worst planes, from the coefficients of both components, each of shape (stops, points, 3)."""
    paths = np.ascontiguousarray(np.concatenate([swung, push], axis=-1).transpose(1, 0, 2))
    out = np.empty((paths.shape[0], 2))
    in_chunks(paths.shape[0], CHUNK, lambda part: plane_search.worst_planes(paths[part], form, out[part]))
    return Planes(out[:, 0], out[:, 1])


class CriterionValues(NamedTuple):
    """The values of a criterion at points of one material.

    Attributes
    ----------
    parameter : ndarray, shape (points,)
    plane : ndarray, shape (points,), or None
        See :class:`Planes`. None for a criterion without planes.
    limit : float or None
        Parameter at the fatigue limit; None for a criterion without a limit.
    life : ndarray, shape (points,), or None
        Cycles; None until the constants of the life are known.
    """

    parameter: np.ndarray
    plane: np.ndarray | None
    limit: float | None
    life: np.ndarray | None = None


class PlaneCount(NamedTuple):
    """The parameter of a counted cycle on a plane.

    Attributes
    ----------
    form : int
        SWING_TIMES_PUSH or SWING_TIMES_MORE of :mod:`fastpin.damage.plane_search`, or POWERS of
        :mod:`fastpin.damage.plane_damage`. The first constant of the parameter is then the power.
    degree : int
        Power of the stresses with which the parameter grows: 2 for a product of stress and strain. The factor of the
        normal stress in SWING_TIMES_MORE does not count.
    swung_and_push : callable
        ``swung_and_push(history, material, *constants)`` returns the coefficients of both components on planes, each of
        shape (stops, points, 3). The constants are those of the parameter.
    natural : callable
        ``natural(stress, material)`` is the size of the parameter for this stress.
    curve : callable
        ``curve(material, *constants)`` returns the curve of lives. The constants are those of the life.
    """

    form: int
    degree: int
    swung_and_push: Callable[..., tuple[np.ndarray, np.ndarray]]
    natural: Callable[[float, Material], float]
    curve: Callable[..., lives.LifeCurve]


class FatigueCriterion(NamedTuple):
    """A criterion of fatigue. Its constants are fields of :class:`fastpin.model.FatigueConstants`.

    Attributes
    ----------
    kind : str
        The kind of its parameter, a key of :func:`fastpin.model.units.units`.
    needs : tuple of str
        The constants of the parameter.
    values : callable
        ``values(history, material, *constants)`` returns its :class:`CriterionValues`.
    life_needs : tuple of str
        The constants of the life.
    counting : PlaneCount or None
        How cycles of a spectrum are counted, with the curve of lives; None for a criterion without lives.
    """

    kind: str
    needs: tuple[str, ...]
    values: Callable[..., CriterionValues]
    life_needs: tuple[str, ...] = ()
    counting: PlaneCount | None = None


def _with_lives(
    name: str, kind: str, planes: Callable[..., Planes], counting: PlaneCount
) -> tuple[str, FatigueCriterion]:
    """Return name and criterion, from the planes of a history and of the constants of the parameter.

    A parameter that is rounding beside its natural size is 0, without an angle.
    """

    def values(history: np.ndarray, material: Material, *constants: float) -> CriterionValues:
        found = planes(history, material, *constants)
        noise = found.parameter <= ROUNDING * counting.natural(float(np.abs(history).max(initial=0.0)), material)
        return CriterionValues(np.where(noise, 0.0, found.parameter), np.where(noise, np.nan, found.angle), None)

    needs, life_needs = LIFE_CONSTANTS[name]
    return name, FatigueCriterion(kind, needs, values, life_needs, counting)


def _by_limits(
    criterion: Callable[[np.ndarray, float], Planes | np.ndarray], weight_and_limit: Callable[..., tuple[float, float]]
) -> Callable[..., CriterionValues]:
    """Return the values of a criterion whose weight and limit follow from the fatigue limits."""

    def values(history: np.ndarray, material: Material, *limits: float) -> CriterionValues:
        weight, limit = weight_and_limit(*limits)
        found = criterion(history, weight)
        parameter, plane = found if isinstance(found, Planes) else (found, None)
        return CriterionValues(parameter, plane, limit)

    return values


SWT_COUNT = PlaneCount(
    plane_search.SWING_TIMES_PUSH,
    2,
    lambda history, material: _normal_strain(history, material.E, material.nu),
    lambda stress, material: stress**2 / material.E,
    lambda material, *constants: lives.smith_watson_topper_curve(material.E, *constants),
)

FS_COUNT = PlaneCount(
    plane_search.SWING_TIMES_MORE,
    1,
    lambda history, material, k, strength: _shear_strain(history, material.shear_modulus, k / strength),
    lambda stress, material: stress / material.shear_modulus,
    lambda material, *constants: lives.fatemi_socie_curve(material.shear_modulus, *constants),
)

STRESS_COUNT = PlaneCount(
    plane_damage.POWERS,
    1,
    lambda history, material, m: (_on_planes(history),) * 2,
    lambda stress, material: stress,
    lambda material, *constants: lives.stress_life_curve(*constants),
)

_LIMITS = ("bending_limit", "torsion_limit")

FATIGUE_CRITERIA: dict[str, FatigueCriterion] = dict([
    _with_lives(
        "smith-watson-topper", "stress times strain",
        lambda history, material: smith_watson_topper(history, material.E, material.nu), SWT_COUNT,
    ),
    _with_lives(
        "fatemi-socie", "rotation",
        lambda history, material, *constants: fatemi_socie(history, material.shear_modulus, *constants), FS_COUNT,
    ),
    _with_lives("stress-life", "traction", lambda history, _, m: equivalent_stress(history, m), STRESS_COUNT),
]) | {
    "findley": FatigueCriterion("traction", _LIMITS, _by_limits(findley, findley_limit)),
    "crossland": FatigueCriterion("traction", _LIMITS, _by_limits(crossland, crossland_limit)),
    "dang-van": FatigueCriterion("traction", _LIMITS, _by_limits(dang_van, dang_van_limit)),
}  # fmt: skip
"""The criteria by name."""

"""Closed forms of contact solutions and of stresses, to check the solver.

Positions along the contact are angles from the direction of the load, rad. Tractions are in units of F/R. The load
parameter is L_p = (R - R_D)/(F beta*), with beta* of Eq. (32). Arguments may be numbers or arrays that broadcast.
Numbers give a float.

Sources: A. Persson, "On the stress distribution of cylindrical elastic bodies in contact", dissertation,
Chalmers (1964); M. Ciavarella and P. Decuzzi, "The state of stress induced by the plane frictionless
cylindrical contact", Int. J. Solids Struct. 38 (2001); K. L. Johnson, "Contact Mechanics" (1985), chapters 4
and 7; D. Nowell and D. A. Hills, "Mechanics of fretting fatigue tests", Int. J. Mech. Sci. 29 (1987); D. A.
Spence, "An eigenvalue problem for elastic contact with finite friction", Proc. Camb. Phil. Soc. 73 (1973); E.
McEwen, "Stresses in elastic cylinders in contact along a generatrix", Phil. Mag. 40 (1949); G. Kirsch, "Die Theorie
der Elastizitaet und die Beduerfnisse der Festigkeitslehre", Z. Ver. dt. Ing. 42 (1898).
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from fastpin.errors import InputError
from fastpin.model.checks import choice, in_one_shape, number, number_array, numbers, positive

Branch = Literal["loading", "unloading", "reloading"]
"""Part of a load cycle: first loading, unloading from +Q_max, reloading from -Q_max."""

Values = float | np.ndarray
"""A number, or an array if an argument is an array."""


def persson_load_parameter(half_angle: ArrayLike, mismatch: ArrayLike = 0.0) -> Values:
    """Load parameter L_p of the frictionless contact with a given half-angle.

    L_p = [(a - 1) (ln(b^2 + 1) + 2 b^4) + 2] / [8 pi b^2 (b^2 + 1)] with b = tan(half_angle/2) (Ciavarella and
    Decuzzi). a = 0 is Persson's formula. The formula is exact for alpha* = 0.

    Parameters
    ----------
    half_angle : float or ndarray
        Half of the contact angle, rad, between 0 and pi.
    mismatch : float or ndarray
        a = (E'_plate - E'_pin)/(E'_plate + E'_pin), -1 to 1: the paper's first Dundurs parameter. E' is
        E/(1 - nu^2) in plane strain and E in plane stress.

    Returns
    -------
    float or ndarray
        L_p. It is negative (an interference fit) beyond the half-angle of the neat fit.

    Raises
    ------
    InputError
        If `half_angle` or `mismatch` is out of range.
    """
    eps = numbers("half_angle", half_angle, 0.0, math.pi, open_low=True, open_high=True)
    eps, a = in_one_shape("half_angle", eps, numbers("mismatch", mismatch, -1.0, 1.0))
    return _value(_load_parameter(np.tan(0.5 * eps), a))


def persson_half_angle(load_parameter: ArrayLike, mismatch: ArrayLike = 0.0) -> Values:
    """Half-angle of the frictionless contact, rad: the inverse of :func:`persson_load_parameter`.

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, above (a - 1)/(4 pi): at this value the contact closes round the pin. 0 is the neat fit.
    mismatch : float or ndarray
        a, see :func:`persson_load_parameter`.

    Raises
    ------
    InputError
        If `mismatch` is out of range or the contact goes all round the pin.
    """
    lp, a = in_one_shape(
        "load_parameter", numbers("load_parameter", load_parameter), numbers("mismatch", mismatch, -1.0, 1.0)
    )
    limit = (a - 1.0) / (4.0 * math.pi)
    if np.any(lp <= limit):
        worst = np.argmin(lp - limit)
        raise InputError(
            "load_parameter",
            f"must be above (mismatch - 1)/(4 pi) = {limit.flat[worst]:.6g}, not {lp.flat[worst]:g}: "
            "the contact would go all round the pin",
        )
    flat = [_half_angle(float(parameter), float(ratio)) for parameter, ratio in zip(lp.flat, a.flat, strict=True)]
    return _value(np.reshape(flat, lp.shape))


def persson_pressure(phi: ArrayLike, half_angle: ArrayLike) -> Values:
    """Pressure N R/F of the frictionless contact (Persson).

    It holds for any mismatch if alpha* = 0.

    N R/F = (2/pi) r / [q (1 + y^2)] + ln[(q + r)/(q - r)] / [2 pi b^2 (b^2 + 1)] with b = tan(half_angle/2),
    y = tan(phi/2), r = sqrt(b^2 - y^2), q = sqrt(b^2 + 1).

    Parameters
    ----------
    phi : float or ndarray
        Angle from the direction of the load, rad, between -pi and pi.
    half_angle : float or ndarray
        Half of the contact angle, rad, between 0 and pi.

    Returns
    -------
    float or ndarray
        N R/F >= 0; zero outside the contact.

    Raises
    ------
    InputError
        If `phi` or `half_angle` is out of range.
    """
    angle = numbers("phi", phi, -math.pi, math.pi)
    half = numbers("half_angle", half_angle, 0.0, math.pi, open_low=True, open_high=True)
    angle, eps = in_one_shape("phi", angle, half)
    inside = np.abs(angle) < eps
    b = np.tan(0.5 * eps)
    y = np.tan(0.5 * np.where(inside, angle, 0.0))
    r = np.sqrt(np.where(inside, (b - y) * (b + y), 0.0))
    b2 = b * b
    # (q + r)/(q - r) = [(q + r)/sqrt(1 + y^2)]^2, whose logarithm is 2 arsinh(r/sqrt(1 + y^2))
    second = np.arcsinh(r / np.sqrt(1.0 + y * y)) / (math.pi * b2 * (b2 + 1.0))
    return _value(2.0 / math.pi * r / (np.sqrt(b2 + 1.0) * (1.0 + y * y)) + second)


def hertz_half_angle(load_parameter: ArrayLike) -> Values:
    """Half-angle of Hertz's contact, rad: 1/sqrt(pi L_p), the limit of large L_p.

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, positive.

    Raises
    ------
    InputError
        If `load_parameter` is not positive.
    """
    lp = numbers("load_parameter", load_parameter, 0.0, open_low=True)
    return _value(1.0 / np.sqrt(math.pi * lp))


def hertz_peak_pressure(load_parameter: ArrayLike) -> Values:
    """Peak pressure N R/F of Hertz's contact: 2 sqrt(L_p/pi).

    Parameters
    ----------
    load_parameter : float or ndarray
        L_p, positive.

    Raises
    ------
    InputError
        If `load_parameter` is not positive.
    """
    lp = numbers("load_parameter", load_parameter, 0.0, open_low=True)
    return _value(2.0 * np.sqrt(lp / math.pi))


def cattaneo_mindlin_stick_ratio(load_ratio: ArrayLike) -> Values:
    """Half-width of the stick zone over the half-width of the contact, c/a = sqrt(1 - |Q|/(mu P)).

    Parameters
    ----------
    load_ratio : float or ndarray
        Q/(mu P), -1 to 1.

    Raises
    ------
    InputError
        If `load_ratio` is out of range (the contact slides).
    """
    return _value(np.sqrt(1.0 - np.abs(numbers("load_ratio", load_ratio, -1.0, 1.0))))


def cattaneo_mindlin_shear(
    x: ArrayLike,
    half_width: float,
    peak_pressure: float,
    friction: float,
    load_ratio: float,
    peak_ratio: float | None = None,
    branch: Branch = "loading",
    eccentricity: float = 0.0,
) -> Values:
    """Shear traction of like cylinders in partial slip (Cattaneo, Mindlin), in the unit of `peak_pressure`.

    The loading form, for the load Q, is q = mu p0 [sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - (x + e)^2/c^2)] with
    c/a = sqrt(1 - Q/(mu P)). Unloading from +Q_max to Q subtracts twice this form for the load (Q_max - Q)/2 from the
    form for Q_max. Reloading from -Q_max to Q adds twice the form for (Q_max + Q)/2 to the negative form for Q_max.

    Parameters
    ----------
    x : float or ndarray
        Distance from the middle of the contact, in the unit of `half_width`.
    half_width, peak_pressure, friction : float
        a > 0, p0 > 0 and mu >= 0.
    load_ratio : float
        Q/(mu P) now, -1 to 1; not negative on the loading branch.
    peak_ratio : float, optional
        Q_max/(mu P), 0 to 1. The unloading and reloading branches need it: `load_ratio` lies between -peak_ratio and
        peak_ratio.
    branch : {"loading", "unloading", "reloading"}
        First loading from 0, unloading from +Q_max towards -Q_max, or reloading from -Q_max towards +Q_max.
    eccentricity : float
        Shift e of the stick zone under bulk stress, in the unit of `half_width`; on the loading branch only. See
        :func:`bulk_stress_eccentricity`.

    Returns
    -------
    float or ndarray
        q, positive in the direction of a positive Q; zero outside the contact.

    Raises
    ------
    InputError
        If an argument is out of range, missing on its branch, or not allowed on it.
    """
    place = numbers("x", x)
    a = positive("half_width", half_width)
    p0 = positive("peak_pressure", peak_pressure)
    mu = number("friction", friction, 0.0)
    e = number("eccentricity", eccentricity)
    forms = _loading_forms(load_ratio, peak_ratio, branch)
    if branch == "loading":
        _inside(e, math.sqrt(1.0 - forms[0][1]) * a, a)
    elif e != 0.0:
        raise InputError("eccentricity", "only the loading branch takes it")
    return _value(mu * p0 * np.sum([factor * _partial_slip(place, a, ratio, e) for factor, ratio in forms], axis=0))


def bulk_stress_eccentricity(
    bulk_stress: float, half_width: float, peak_pressure: float, friction: float, load_ratio: float = 0.0
) -> float:
    """Shift e of the stick zone under a bulk stress (Nowell and Hills).

    e = a sigma/(4 mu p0). The contact sticks at |x + e| < c.

    Parameters
    ----------
    bulk_stress : float
        sigma, in the unit of `peak_pressure`. It rises together with Q.
    half_width, peak_pressure, friction : float
        a, p0 and mu, positive.
    load_ratio : float
        Q/(mu P), 0 to 1. It gives c = a sqrt(1 - Q/(mu P)).

    Returns
    -------
    float
        e, in the unit of `half_width`.

    Raises
    ------
    InputError
        If an argument is out of range, or |e| + c exceeds a. Then slip has two directions and the form fails.
    """
    sigma = number("bulk_stress", bulk_stress)
    a = positive("half_width", half_width)
    p0 = positive("peak_pressure", peak_pressure)
    mu = positive("friction", friction)
    now = number("load_ratio", load_ratio, 0.0, 1.0)
    e = a * sigma / (4.0 * mu * p0)
    _inside(e, math.sqrt(1.0 - now) * a, a, "bulk_stress")
    return e


def spence_stick_ratio(mu_over_beta: ArrayLike) -> Values:
    """Width of the stick zone over the width of the contact in normal loading of unlike half-planes (Spence).

    The pressure is uncoupled. K(k)/K(k') = mu/|beta| for the modulus k = c/a, where K is the complete elliptic integral
    of the first kind and beta is Dundurs' second parameter. The nome inverts it: k = [theta_2/theta_3]^2 at
    exp(-pi |beta|/mu).

    Parameters
    ----------
    mu_over_beta : float or ndarray
        mu/|beta|, not negative; ``math.inf`` (like materials) gives 1.

    Returns
    -------
    float or ndarray
        c/a, 0 to 1.

    Raises
    ------
    InputError
        If `mu_over_beta` is negative or NaN.
    """
    ratio = number_array("mu_over_beta", mu_over_beta)
    if np.any(np.isnan(ratio)) or np.any(ratio < 0.0):
        raise InputError("mu_over_beta", f"must not be negative, not {np.min(ratio):g}")
    with np.errstate(divide="ignore"):
        small = _modulus(np.exp(-math.pi / np.minimum(ratio, 1.0)))
    complementary = _modulus(np.exp(-math.pi * np.maximum(ratio, 1.0)))
    return _value(np.where(ratio <= 1.0, small, np.sqrt((1.0 - complementary) * (1.0 + complementary))))


def elliptic_stress(
    x: ArrayLike, depth: ArrayLike, half_width: float, pressure: float, shear: float = 0.0
) -> np.ndarray:
    """Stresses in a half-plane under elliptic tractions (McEwen; Johnson, sections 4.4 and 7.1).

    The pressure on the surface is p0 sqrt(1 - x^2/a^2), and the shear traction in the direction of x is
    q0 sqrt(1 - x^2/a^2). With (m + i n)^2 = a^2 - (x - i z)^2 at the depth z, m >= 0, n of the sign of x, and
    k = (z^2 + n^2)/(m^2 + n^2), l = n (m^2 - z^2)/(m^2 + n^2):

        s_xx = -p0/a [m (1 + k) - 2 z] + 2 q0/a (n - x) + q0/a l
        s_zz = -p0/a m (1 - k) - q0/a l
        s_xz = -p0/a l - q0/a [m (1 + k) - 2 z]

    Parameters
    ----------
    x, depth : float or ndarray
        Position along the surface from the middle of the contact, and depth >= 0, in the unit of `half_width`.
    half_width : float
        a, positive.
    pressure, shear : float
        p0 and q0.

    Returns
    -------
    ndarray, shape (3, ...)
        s_xx along the surface, s_zz across it and s_xz, in the unit of p0 and q0; tension is positive. z points into
        the half-plane.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    a = positive("half_width", half_width)
    p0, q0 = number("pressure", pressure), number("shear", shear)
    place, z = in_one_shape("x", numbers("x", x), numbers("depth", depth, 0.0))
    root = np.sqrt((a - place) * (a + place) + z * z + 2j * place * z)
    m, n = root.real, np.copysign(root.imag, place)
    square = m * m + n * n
    square = np.where(square == 0.0, 1.0, square)  # at the edge m = n = z = 0
    share, mixed = (z * z + n * n) / square, n * (m * m - z * z) / square
    along = m * (1.0 + share) - 2.0 * z
    return np.array([
        -p0 / a * along + q0 / a * (2.0 * (n - place) + mixed),
        -p0 / a * m * (1.0 - share) - q0 / a * mixed,
        -p0 / a * mixed - q0 / a * along,
    ])  # fmt: skip


def cattaneo_mindlin_stress(
    x: ArrayLike,
    depth: ArrayLike,
    half_width: float,
    peak_pressure: float,
    friction: float,
    load_ratio: float,
    peak_ratio: float | None = None,
    branch: Branch = "loading",
) -> np.ndarray:
    """Stresses in a half-plane under Hertz's pressure and the shear of :func:`cattaneo_mindlin_shear`.

    Both tractions are sums of ellipses, and so are the stresses (:func:`elliptic_stress`). The largest s_xx is
    2 p0 sqrt(mu Q/P), on the surface at x = -a on the loading branch; in full slip this is 2 mu p0.

    Parameters
    ----------
    x, depth : float or ndarray
        Position along the surface and depth, see :func:`elliptic_stress`.
    half_width, peak_pressure, friction, load_ratio, peak_ratio, branch
        As for :func:`cattaneo_mindlin_shear`. The shear acts on the half-plane in the direction of x.

    Returns
    -------
    ndarray, shape (3, ...)
        s_xx, s_zz and s_xz in the unit of `peak_pressure`, see :func:`elliptic_stress`.

    Raises
    ------
    InputError
        If an argument is out of range, or missing on its branch.
    """
    a = positive("half_width", half_width)
    p0 = positive("peak_pressure", peak_pressure)
    mu = number("friction", friction, 0.0)
    total = elliptic_stress(x, depth, a, p0)
    for factor, ratio in _loading_forms(load_ratio, peak_ratio, branch):
        total = total + elliptic_stress(x, depth, a, 0.0, factor * mu * p0)
        stick = math.sqrt(1.0 - ratio)
        if stick > 0.0:
            total = total - elliptic_stress(x, depth, stick * a, 0.0, factor * mu * p0 * stick)
    return total


def kirsch_stress(radius: ArrayLike, theta: ArrayLike, sxx: float, syy: float, sxy: float) -> np.ndarray:
    """Stresses round an open hole under remote stress (Kirsch).

    Parameters
    ----------
    radius, theta : float or ndarray
        Polar coordinates: radius in units of the hole's, at least 1; angle in rad.
    sxx, syy, sxy : float
        Remote stress.

    Returns
    -------
    ndarray, shape (3, ...)
        s_rr, s_tt and s_rt in the unit of the remote stress; tension is positive.

    Raises
    ------
    InputError
        If `radius` is below 1, or an argument is no number.
    """
    away, angle = in_one_shape("radius", numbers("radius", radius, 1.0), numbers("theta", theta))
    square = away**-2.0
    sxx, syy, sxy = number("sxx", sxx), number("syy", syy), number("sxy", sxy)
    mean, half = 0.5 * (sxx + syy), 0.5 * (sxx - syy)
    along = half * np.cos(2.0 * angle) + sxy * np.sin(2.0 * angle)
    across = sxy * np.cos(2.0 * angle) - half * np.sin(2.0 * angle)
    fourth = 3.0 * square * square
    return np.array([
        mean * (1.0 - square) + along * (1.0 - 4.0 * square + fourth),
        mean * (1.0 + square) - along * (1.0 + fourth),
        across * (1.0 + 2.0 * square - fourth),
    ])  # fmt: skip


def _load_parameter(b: np.ndarray | float, a: np.ndarray | float) -> np.ndarray:
    b2 = np.square(b)
    return ((np.asarray(a) - 1.0) * (np.log1p(b2) + 2.0 * b2 * b2) + 2.0) / (8.0 * math.pi * b2 * (b2 + 1.0))


def _half_angle(lp: float, a: float) -> float:
    # L_p falls monotonically with b, for small b like 1/(4 pi b^2).
    low = high = 0.0  # bounds of ln b
    while _load_parameter(math.exp(low), a) < lp:
        low -= 1.0
    while _load_parameter(math.exp(high), a) > lp:
        high += 1.0
        if high > 150.0:
            return math.pi
    return 2.0 * math.atan(math.exp(brentq(lambda x: _load_parameter(math.exp(x), a) - lp, low, high, xtol=1e-15)))


def _loading_forms(load_ratio: float, peak_ratio: float | None, branch: Branch) -> list[tuple[float, float]]:
    """The loading forms whose sum is the shear on a branch: the factor and Q/(mu P) of each."""
    choice("branch", branch, ("loading", "unloading", "reloading"))
    if branch == "loading":
        return [(1.0, number("load_ratio", load_ratio, 0.0, 1.0))]
    if peak_ratio is None:
        raise InputError("peak_ratio", f"the {branch} branch needs it")
    peak = number("peak_ratio", peak_ratio, 0.0, 1.0)
    now = number("load_ratio", load_ratio, -peak, peak)
    sign = 1.0 if branch == "unloading" else -1.0
    return [(sign, peak), (-2.0 * sign, 0.5 * (peak - sign * now))]


def _partial_slip(x: np.ndarray, a: float, ratio: float, e: float) -> np.ndarray:
    """The loading form of :func:`cattaneo_mindlin_shear` over mu p0, for Q/(mu P) = `ratio`."""
    c = a * math.sqrt(1.0 - ratio)
    outer = np.sqrt(np.maximum(1.0 - np.square(x / a), 0.0))
    if c == 0.0:
        return outer
    return outer - c / a * np.sqrt(np.maximum(1.0 - np.square((x + e) / c), 0.0))


def _inside(e: float, c: float, a: float, field: str = "eccentricity") -> None:
    if abs(e) + c > a * (1.0 + 1e-12):
        raise InputError(field, f"the stick zone, {c:g} wide and {abs(e):g} off, leaves the contact, {a:g} wide")


def _modulus(nome: np.ndarray) -> np.ndarray:
    """Elliptic modulus of a nome of at most exp(-pi). Five terms of the theta series give all digits."""
    even = sum(nome ** (n * (n + 1)) for n in range(1, 5))
    square = sum(nome ** (n * n) for n in range(1, 5))
    return 4.0 * np.sqrt(nome) * np.square((1.0 + even) / (1.0 + 2.0 * square))


def _value(number: np.ndarray) -> Values:
    return float(number) if np.ndim(number) == 0 else number

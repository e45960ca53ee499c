"""Fretting parameters and wear of points on the edge, from their tractions and their slip."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.checks import numbers, positive


def ruiz(shear: ArrayLike, slip_range: ArrayLike, hoop: ArrayLike | None = None) -> np.ndarray:
    """The fretting parameters of Ruiz, Boddington and Chen (Exp. Mech. 24 (1984) 208) at points.

    F1 = tau delta, the largest shear traction of the cycle times the range of the slip. F2 = s_T tau delta, with the
    hoop stress s_T where it is tensile, and the largest product s_T tau of the cycle.

    Parameters
    ----------
    shear : array_like, shape (stops, points)
        Shear traction at the stops of a cycle, Pa; its sign makes no difference.
    slip_range : array_like, shape (points,)
        Largest less smallest slip over the cycle, m.
    hoop : array_like, shape (stops, points), optional
        Hoop stress on the edge, Pa; tension is positive.

    Returns
    -------
    ndarray, shape (points,)
        F1 in J/m^2; with the hoop stress F2 in Pa J/m^2.

    Raises
    ------
    InputError
        If the shapes do not fit, a number is not finite or a range is negative.
    """
    product, ranges = np.abs(_stops("shear", shear)), numbers("slip_range", slip_range, 0.0)
    if ranges.shape != product.shape[1:]:
        raise InputError("slip_range", f"must have the shape {product.shape[1:]}, not {ranges.shape}")
    if hoop is not None:
        product = product * np.maximum(_same("hoop", hoop, product), 0.0)
    return product.max(axis=0) * ranges


def archard_depth(pressure: ArrayLike, slip: ArrayLike, wear_coefficient: float) -> np.ndarray:
    """The depth worn off in one cycle, k_w int p |ds|, m (Archard, J. Appl. Phys. 24 (1953) 981).

    With the magnitude of the shear traction in place of the pressure, and the coefficient per energy, it is the wear by
    frictional energy (Fouvry, Kapsa and Vincent, Wear 200 (1996) 186).

    Parameters
    ----------
    pressure : array_like, shape (stops, points)
        Contact pressure at the stops of a cycle, from its beginning to its end, Pa, at least 0. It varies linearly from
        stop to stop.
    slip : array_like, shape (stops, points)
        Slip at the same stops, m. The last stop of a closed cycle equals the first one.
    wear_coefficient : float
        k_w, 1/Pa, above 0. It counts the depth of both bodies together, or of one of them.

    Returns
    -------
    ndarray, shape (points,)

    Raises
    ------
    InputError
        If the shapes do not fit, or a number is out of range.
    """
    coefficient = positive("wear_coefficient", wear_coefficient)
    loads = _stops("pressure", numbers("pressure", pressure, 0.0))
    path = np.abs(np.diff(_same("slip", slip, loads), axis=0))
    return coefficient * np.sum(0.5 * (loads[1:] + loads[:-1]) * path, axis=0)


def _stops(field: str, values: ArrayLike) -> np.ndarray:
    array = numbers(field, values)
    if array.ndim != 2 or 0 in array.shape:
        raise InputError(field, f"must have the shape (stops, points), not {array.shape}")
    return array


def _same(field: str, values: ArrayLike, other: np.ndarray) -> np.ndarray:
    array = numbers(field, values)
    if array.shape != other.shape:
        raise InputError(field, f"must have the shape {other.shape}, not {array.shape}")
    return array

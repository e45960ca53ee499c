"""Rainflow counts and stress-life curves, through the optional package pylife."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.checks import number, numbers, positive


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
    below = (
        math.inf
        if isinstance(slope_below, float) and slope_below == math.inf
        else number("slope_below", slope_below, 1.0)
    )
    try:
        import pandas  # a dependency of pylife
        from pylife.materiallaws import WoehlerCurve
    except ImportError:
        raise _missing() from None
    curve = WoehlerCurve(pandas.Series({"SD": knee, "ND": cycles, "k_1": above, "k_2": below}))
    return np.asarray(curve.cycles(loads.ravel()), dtype=float).reshape(loads.shape)


def _missing() -> InputError:
    return InputError("pylife", "is not installed: pip install 'fastpin[fatigue]'")

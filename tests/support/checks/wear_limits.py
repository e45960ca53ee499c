"""Limits of wear with formulas: rigid bodies that slide one way, and the final state of half-planes in partial slip.

Partial slip of like half-planes under constant P and cycles +-Q: the stick zone |x| < c of Cattaneo and Mindlin never
wears, because the contact under P - Q/mu feels no wear outside of it. At last the stick zone carries all of P, and the
worn surfaces beside it just touch. M. Ciavarella and D. A. Hills (1999) showed that plane contacts have such a final
state, after V. L. Popov, Sci. Rep. 4, 3749 (2014); the original was not seen. The formulas were derived for fastpin.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

GAUSS = np.polynomial.legendre.leggauss(40)
"""Nodes and weights of integrals over smooth functions, which these exhaust."""


def rigid_sliding(clearance: float, path: float, friction: float) -> tuple[float, float]:
    """Worn depth and largest pressure of a rigid pin that has slid one way in a rigid hole.

    The pin moves straight into the wear: N = N0 cos psi on |psi| < phi with cos phi = c/(c + d) and
    N0 = P/[R (phi + sin phi cos phi) sqrt(1 + mu^2)]. The depth d grows by k N0 ds.

    Parameters
    ----------
    clearance : float
        c, at least 0.
    path : float
        Wear coefficient times slip, k s P/R, positive, in the unit of the clearance.
    friction : float

    Returns
    -------
    (float, float)
        The depth d, in the unit of the clearance, and N0 R/P.
    """
    size = math.hypot(1.0, friction)
    nodes, weights = GAUSS

    def spread(depth: np.ndarray | float) -> np.ndarray:
        """P/(R N0) without friction."""
        phi = np.arccos(clearance / (clearance + depth))
        return np.asarray(phi + np.sin(phi) * np.cos(phi))

    def slid(depth: float) -> float:
        """The path to a depth: a power series of the root of the depth."""
        root = 0.5 * math.sqrt(depth) * (1.0 + nodes)
        return float(size * math.sqrt(depth) * (weights @ (root * spread(root**2))))

    most = path
    while slid(most) < path:
        most *= 2.0
    depth = float(brentq(lambda tried: slid(tried) - path, 1e-12 * most, most, xtol=1e-15 * most))
    return depth, float(1.0 / (spread(depth) * size))


def final_profile(x: np.ndarray, load_ratio: float) -> np.ndarray:
    """Worn depth of the final state of half-planes in partial slip, w/(L_p a^2), with the half-width a of Hertz.

    w = (1/2) [arccosh(x/c) - (x/a^2) sqrt(x^2 - c^2)] from the stick zone c = a sqrt(1 - Q/mu P) to the place where it
    is 0 again.

    Parameters
    ----------
    x : ndarray
        Distances from the middle, over a, of any shape.
    load_ratio : float
        Q/(mu P), between 0 and 1.
    """
    stick = math.sqrt(1.0 - load_ratio)
    far = np.maximum(np.abs(x), stick)
    return np.maximum(0.5 * (np.arccosh(far / stick) - far * np.sqrt(far**2 - stick**2)), 0.0)


def final_pressure(x: np.ndarray, load_ratio: float) -> np.ndarray:
    """Pressure of that state, over the peak of Hertz: (a^2 + c^2 - 2 x^2)/[2 a sqrt(c^2 - x^2)] inside |x| < c, else 0.

    The parameters are those of :func:`final_profile`.
    """
    left = 1.0 - load_ratio - x**2
    root = np.sqrt(np.where(left > 0.0, left, 1.0))
    return np.where(left > 0.0, (load_ratio + 2.0 * left) / (2.0 * root), 0.0)


def final_volume(load_ratio: float) -> tuple[float, float, float]:
    """Volume/(L_p a^3), largest depth/(L_p a^2) and half-width/a of the scar of :func:`final_profile`."""
    stick = math.sqrt(1.0 - load_ratio)

    def depth(x: float) -> float:
        """The profile before it is cut off at 0."""
        return 0.5 * (math.acosh(x / stick) - x * math.sqrt(x * x - stick * stick))

    deepest = math.sqrt(0.5 * (1.0 + stick * stick))  # where the derivative (1 + c^2 - 2 x^2)/sqrt(x^2 - c^2) is 0
    end = float(brentq(depth, deepest, 10.0, xtol=1e-15))
    nodes, weights = GAUSS
    far = stick + (end - stick) * 0.25 * (1.0 + nodes) ** 2  # the depth begins like the root of x - c
    volume = 2.0 * float(weights @ (final_profile(far, load_ratio) * 0.5 * (end - stick) * (1.0 + nodes)))
    return volume, depth(deepest), end

"""The worst plane of a cycle at points, among the planes that hold the z axis.

The angle of a plane is that of its normal, phi, from the x axis. With x = 2 phi, every component on the plane is a sum
f0 + f1 cos x + f2 sin x. A criterion takes two of them, the swung U and the pushing V, at each time of the cycle:

    SWING_TIMES_PUSH       (max U - min U)/2 * max(V, 0)
    SWING_TIMES_MORE       (max U - min U)/2 * (1 + max(V, 0))
    SWING_AND_PUSH         (max U - min U)/2 + max V

Each is the largest product a(x) b(x) of such sums over the times. So all its maxima are smooth, and a bound on second
derivatives holds for all products. The search halves the intervals that may hold a larger value than the best one so
far, and ends with Newton's method. The largest value is missed by at most FINE^2/2 of this bound, or where more than
MOST intervals remain, by half the bound times the square of half an interval. Of planes with equal values, the one
with the largest angle is the worst: where only one principal stress is swung, two planes mirror each other.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

SWING_TIMES_PUSH, SWING_TIMES_MORE, SWING_AND_PUSH = 0, 1, 2
"""The forms of criteria."""

COARSE = 90
"""Intervals of the first scan."""

MOST = 1024
"""Most intervals that are halved. More of them remain only where nearly all planes are alike."""

FINE = 1e-5
"""Half an interval, in x, at which Newton's method takes over, rad."""

STEPS = 20
"""Most steps of Newton's method."""

TIE = 1e-9
"""Relative difference up to which the values of two planes are equal."""

ERROR = 1e-6
"""Bound on the error of an angle by rounding, rad."""


@inner
def _product(path, x, form):
    """The coefficients (a0, a1, a2, b0, b1, b2) of the largest product at x, and the largest V."""
    c, s = math.cos(x), math.sin(x)
    high, low, most = -np.inf, np.inf, -np.inf
    top, bottom, pushed = 0, 0, 0
    for t in range(path.shape[0]):
        swung = path[t, 0] + path[t, 1] * c + path[t, 2] * s
        push = path[t, 3] + path[t, 4] * c + path[t, 5] * s
        if swung > high:
            high, top = swung, t
        if swung < low:
            low, bottom = swung, t
        if push > most:
            most, pushed = push, t
    a0 = 0.5 * (path[top, 0] - path[bottom, 0])
    a1 = 0.5 * (path[top, 1] - path[bottom, 1])
    a2 = 0.5 * (path[top, 2] - path[bottom, 2])
    b0, b1, b2 = path[pushed, 3], path[pushed, 4], path[pushed, 5]
    if form == SWING_AND_PUSH:
        return a0 + b0, a1 + b1, a2 + b2, 1.0, 0.0, 0.0, most
    if most <= 0.0:
        b0, b1, b2 = 0.0, 0.0, 0.0
    if form == SWING_TIMES_MORE:
        b0 = 1.0 + b0
    return a0, a1, a2, b0, b1, b2, most


@inner
def _value(path, x, form):
    """The criterion on the plane x/2, and the largest V."""
    a0, a1, a2, b0, b1, b2, most = _product(path, x, form)
    c, s = math.cos(x), math.sin(x)
    return (a0 + a1 * c + a2 * s) * (b0 + b1 * c + b2 * s), most


@inner
def _bounds(path, form):
    """Bounds on the second derivatives of all products, and on the slopes of V."""
    spans, push, turning = np.zeros(3), 0.0, 0.0
    for k in range(3):
        high, low = -np.inf, np.inf
        for t in range(path.shape[0]):
            high, low = max(high, path[t, k]), min(low, path[t, k])
        spans[k] = 0.5 * (high - low)
    for t in range(path.shape[0]):
        push, turning = max(push, abs(path[t, 3])), max(turning, math.hypot(path[t, 4], path[t, 5]))
    swing, swinging = spans[0], math.hypot(spans[1], spans[2])
    if form == SWING_AND_PUSH:
        return swinging + turning, turning
    if form == SWING_TIMES_MORE:
        push += 1.0
    return swinging * (push + turning) + 2.0 * swinging * turning + turning * (swing + swinging), turning


@inner
def _refined(path, x, value, form):
    """Value and place of the maximum beside x, by Newton's method on the product that is largest there."""
    for _ in range(STEPS):
        a0, a1, a2, b0, b1, b2, _ = _product(path, x, form)
        c, s = math.cos(x), math.sin(x)
        a, slope_a, bend_a = a0 + a1 * c + a2 * s, a2 * c - a1 * s, -a1 * c - a2 * s
        b, slope_b, bend_b = b0 + b1 * c + b2 * s, b2 * c - b1 * s, -b1 * c - b2 * s
        slope, bend = slope_a * b + a * slope_b, bend_a * b + 2.0 * slope_a * slope_b + a * bend_b
        if bend >= 0.0:
            break
        moved = x - slope / bend
        new, _ = _value(path, moved, form)
        if moved == x or new < value:
            break
        x, value = moved, new
    return value, x


@inner
def plane_angle(x, error):
    """The angle x/2 of a plane, known up to an error, in (-pi/2, pi/2]. The error never turns pi/2 into -pi/2."""
    turned = 0.5 * x - math.pi * math.floor(0.5 * x / math.pi + 0.5)
    return turned if turned > error - 0.5 * math.pi else min(turned + math.pi, 0.5 * math.pi)


@compiled
def worst_planes(paths, form, out):
    """Find the plane with the largest value of a criterion at each point.

    Parameters
    ----------
    paths : ndarray, shape (points, times, 6)
        Coefficients of U, then of V: constant, with cos x and with sin x.
    form : int
        SWING_TIMES_PUSH, SWING_TIMES_MORE or SWING_AND_PUSH.
    out : ndarray, shape (points, 2)
        Largest value, and the angle x/2 of its plane in (-pi/2, pi/2], rad. The angle is NaN where the value is 0.
    """
    places, values, pushes = np.empty(2 * MOST), np.empty(2 * MOST), np.empty(2 * MOST)
    parents = np.empty(MOST)
    for i in range(paths.shape[0]):
        path, half = paths[i], math.pi / COARSE
        bound, steepest = _bounds(path, form)
        count = COARSE
        for k in range(COARSE):
            places[k] = (2 * k + 1 - COARSE) * half
        best, place = -np.inf, 0.0
        while True:
            for k in range(count):
                values[k], pushes[k] = _value(path, places[k], form)
                if values[k] > best:
                    best, place = values[k], places[k]
            kept = 0
            for k in range(count):
                pushed = form != SWING_TIMES_PUSH or pushes[k] + steepest * half > 0.0
                if pushed and values[k] + 0.5 * bound * half * half > best:
                    if kept < MOST:
                        parents[kept] = places[k]
                    kept += 1
            if kept == 0 or kept > MOST or half <= FINE:
                break
            half = 0.5 * half
            count = 2 * kept
            for k in range(kept):
                places[2 * k], places[2 * k + 1] = parents[k] - half, parents[k] + half
        best, place = _refined(path, place, best, form)
        angle, least = plane_angle(place, ERROR), best - TIE * abs(best)
        for k in range(count):
            if values[k] + 0.5 * bound * half * half >= least:
                value, place = _refined(path, places[k], values[k], form)
                other = plane_angle(place, ERROR)
                if value >= least and other > angle + ERROR:
                    angle = other
        out[i, 0] = best
        out[i, 1] = np.nan if best == 0.0 else angle

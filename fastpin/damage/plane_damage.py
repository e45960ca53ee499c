"""Rainflow counts on planes: the damage of a spectrum on the worst plane of each point.

The planes hold the z axis, and their components U and V are sums f0 + f1 cos x + f2 sin x, see
:mod:`fastpin.damage.plane_search`. The cycles of U are counted (Matsuishi and Endo 1968; four points, as ASTM E1049 for
repeated histories). A cycle has the amplitude of U and the largest V of all its stops. Its
parameter is that of the forms SWING_TIMES_PUSH and SWING_TIMES_MORE, or of POWERS, with m = life[7]:

    POWERS                 (2 amplitude)^m max(V, 0)^(1 - m)

Its damage 1/N follows from

    parameter = exp(life[0]) (2N)^life[2] + exp(life[1]) (2N)^life[3]

for a logarithm of the parameter of at least life[4]. Below it log 2N = life[5] + life[6] (life[4] - log parameter). An
infinite life[6] does no damage. Of planes with equal damage, the one with the largest angle is the worst.

A spectrum is a list of blocks. A block of many passes is followed three times: from the third pass on each pass closes
the same cycles. A spectrum with such blocks is followed twice, and the second time is counted, for the same reason.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.damage.plane_search import plane_angle
from fastpin.runtime.jit import compiled, inner

COARSE = 72
"""Planes of the first scan."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Part of an interval that a step of the search keeps."""

STEPS = 16
"""Steps of the search beside a plane of the scan. The angle is then known to 4e-5 rad, the damage to 1e-7 of itself."""

CLOSE = 1e-8
"""Last step of Newton's method in log 2N. Its error is the square of this step."""

PITCH, ROWS = 0.05, 400
"""Distance of the rows of a table of lives, in the logarithm of the parameter, and their number: down to 2e-9."""

WORTH = 0.5
"""Planes of the scan with less than this part of the largest damage are not refined."""

POWERS = 3
"""The form of Walker's equivalent stress. The other forms stand in :mod:`fastpin.damage.plane_search`."""

SMOOTH = 1e-5
"""Step of Newton's method in log 2N up to which a table of lives is exact. Beside a stress without an end it is not."""

TIE = 1e-6
"""Relative difference up to which the damages of two planes are equal: the error of the search."""

ERROR = 1e-4
"""Bound on the error of an angle, rad."""


@inner
def _count(u, v, order, blocks, stack, cycles, weights):
    """Count the closed cycles of U, and return their number.

    A spectrum without blocks of many passes is followed once, from its largest U back to it. The last cycle is the
    whole range.

    `stack` has a row for each open reversal: its state, and the state with the largest V since the reversal before. A
    row of `cycles` has the states of both reversals and the state with the largest V, and `weights` how often it comes.
    """
    n, count, top = 0, 0, 0
    once = 1 if blocks.shape[0] == 1 and blocks[0, 2] == 1 else 0
    if once:
        for t in range(order.size):
            if u[order[t]] > u[order[top]]:
                top = t
    for turn in range(once, 2):
        for k in range(blocks.shape[0]):
            for again in range(min(blocks[k, 2], 3)):
                weight = blocks[k, 2] - 2 if again == 2 else 1
                for t in range(blocks[k, 0] + top, blocks[k, 1] + top + once):
                    state = order[t - order.size] if t >= order.size else order[t]
                    high = -1  # the state with the largest V since the last reversal, without this state
                    if n >= 2 and (u[stack[n - 1, 0]] - u[stack[n - 2, 0]]) * (u[state] - u[stack[n - 1, 0]]) >= 0.0:
                        n -= 1
                        high = stack[n, 1]
                    elif n == 1 and u[state] == u[stack[0, 0]]:
                        n = 0
                        high = stack[0, 1]
                    while n >= 3:
                        a, b, c = stack[n - 3, 0], stack[n - 2, 0], stack[n - 1, 0]
                        size = abs(u[b] - u[c])
                        if size > abs(u[state] - u[c]) or size > abs(u[a] - u[b]):
                            break
                        since = stack[n - 1, 1]
                        if high < 0 or v[since] > v[high]:
                            high = since
                        most = b if v[b] > v[high] else high
                        if turn == 1:
                            cycles[count, 0], cycles[count, 1], cycles[count, 2] = b, c, most
                            weights[count] = weight
                            count += 1
                        before = stack[n - 2, 1]
                        if v[before] > v[high]:
                            high = before
                        n -= 2
                    if high < 0 or v[state] > v[high]:
                        high = state
                    stack[n, 0], stack[n, 1] = state, high
                    n += 1
    if once and n == 3:
        most = stack[1, 1] if v[stack[1, 1]] > v[stack[2, 1]] else stack[2, 1]
        cycles[count, 0], cycles[count, 1], cycles[count, 2], weights[count] = stack[0, 0], stack[1, 0], most, 1
        count += 1
    return count


@inner
def _combined(swing, push, form, life):
    """The parameter of an amplitude and a largest V that is not negative."""
    if form == POWERS:
        return (2.0 * swing) ** life[7] * push ** (1.0 - life[7])
    return swing * push if form == 0 else swing * (1.0 + push)


@inner
def _parameter(u, v, cycle, form, life):
    """The parameter of a cycle."""
    return _combined(0.5 * abs(u[cycle[0]] - u[cycle[1]]), max(v[cycle[2]], 0.0), form, life)


@inner
def _root(target, life):
    """log 2N at which the parameter is exp(target), by Newton's method from below, as in fastpin/damage/lives.py."""
    x = max((target - life[0]) / life[2], (target - life[1]) / life[3])
    for _ in range(100):
        one, two = life[0] + x * life[2], life[1] + x * life[3]
        lower = math.exp(-abs(one - two))  # the smaller power, in parts of the larger one
        upper, under = (life[2], life[3]) if one > two else (life[3], life[2])
        slope = (upper + under * lower) / (1.0 + lower)
        moved = x - (max(one, two) + math.log1p(lower) - target) / slope
        close = moved - x < CLOSE
        x = max(x, moved)
        if close:
            break
    return x


@inner
def _beyond(target, life):
    """1/N of a cycle beyond the knee of the curve."""
    return 2.0 * math.exp(min(-(life[5] + life[6] * (life[4] - target)), 700.0))


@inner
def _fill(table, life):
    """Fill the roots and their slopes, down from the logarithm life[8] of the highest parameter, a row each."""
    for k in range(table.shape[0]):
        x = _root(life[8] - k * PITCH, life)
        one, two = math.exp(life[0] + x * life[2]), math.exp(life[1] + x * life[3])
        table[k, 0], table[k, 1] = x, -PITCH * (one + two) / (life[2] * one + life[3] * two)


@inner
def _damage(parameter, life, table):
    """1/N of a cycle: a cubic between two rows of the table, off by 1e-7, and a step of Newton's method."""
    target = math.log(parameter)
    if target < life[4]:
        return _beyond(target, life)
    place = (life[8] - target) / PITCH
    k = int(place) if place >= 0.0 else table.shape[0]
    if k + 1 >= table.shape[0]:
        return 2.0 * math.exp(min(-_root(target, life), 700.0))
    s, rise = place - k, table[k + 1, 0] - table[k, 0]
    bend = (1.0 - s) * (table[k, 1] - rise) - s * (table[k + 1, 1] - rise)
    x = table[k, 0] + s * (rise + (1.0 - s) * bend)
    one, two = life[0] + x * life[2], life[1] + x * life[3]
    lower = math.exp(-abs(one - two))
    upper, under = (life[2], life[3]) if one > two else (life[3], life[2])
    step = (max(one, two) + math.log1p(lower) - target) * (1.0 + lower) / (upper + under * lower)
    return 2.0 * math.exp(min(-(x - step if abs(step) < SMOOTH else _root(target, life)), 700.0))


@inner
def _on_plane(path, x, u, v):
    """Fill U and V of all states on the plane x/2."""
    c, s = math.cos(x), math.sin(x)
    for t in range(path.shape[0]):
        u[t] = path[t, 0] + path[t, 1] * c + path[t, 2] * s
        v[t] = path[t, 3] + path[t, 4] * c + path[t, 5] * s


@inner
def _sum(path, x, order, blocks, form, least, curve, table, u, v, stack, cycles, weights):
    """The damage on the plane x/2."""
    _on_plane(path, x, u, v)
    total = 0.0
    for k in range(_count(u, v, order, blocks, stack, cycles, weights)):
        parameter = _parameter(u, v, cycles[k], form, curve)
        if parameter > least:
            total += weights[k] * _damage(parameter, curve, table)
    return total


@inner
def _highest(paths, form, life):
    """The logarithm of a parameter that no cycle of these points exceeds."""
    swing, push = 0.0, 0.0
    for i in range(paths.shape[0]):
        for t in range(paths.shape[1]):
            swing = max(swing, abs(paths[i, t, 0]) + math.hypot(paths[i, t, 1], paths[i, t, 2]))
            push = max(push, abs(paths[i, t, 3]) + math.hypot(paths[i, t, 4], paths[i, t, 5]))
    most = _combined(swing, push, form, life)
    return math.log(most) if most > 0.0 else 0.0


@compiled
def worst_sums(paths, order, blocks, form, least, life, out):
    """Find the plane with the largest damage at each point.

    Parameters
    ----------
    paths : ndarray, shape (points, states, 6)
        Coefficients of U, then of V: constant, with cos x and with sin x.
    order : ndarray of int64, shape (stops,)
        The states in the order of time.
    blocks : ndarray of int64, shape (blocks, 3)
        First stop of each block, the stop after its last one, and the number of its passes.
    form : int
        SWING_TIMES_PUSH or SWING_TIMES_MORE of :mod:`fastpin.damage.plane_search`, or POWERS.
    least : float
        Cycles with a parameter up to this one do no damage.
    life : ndarray, shape (8,)
        Logarithms of the coefficients, and the exponents, both below 0. Then the logarithms of the parameter and of 2N
        at the knee, and the slope beyond it. The first is -inf for a curve without a knee. Last the power of POWERS.
    out : ndarray, shape (points, 2)
        Damage of the spectrum, and the angle x/2 of its plane in (-pi/2, pi/2], rad. The angle is NaN where the damage
        is 0.
    """
    u, v = np.empty(paths.shape[1]), np.empty(paths.shape[1])
    stack, cycles = np.empty((6 * order.size + 2, 2), np.int64), np.empty((3 * order.size + 2, 3), np.int64)
    weights, scanned = np.empty(3 * order.size + 2, np.int64), np.empty(COARSE)
    peaks, places = np.empty(COARSE), np.empty(COARSE)
    table, curve = np.empty((ROWS, 2)), np.empty(9)
    curve[:8], curve[8] = life, _highest(paths, form, life)
    _fill(table, curve)
    step = 2.0 * math.pi / COARSE
    for i in range(paths.shape[0]):
        path = paths[i]
        for k in range(COARSE):
            scanned[k] = _sum(path, k * step, order, blocks, form, least, curve, table, u, v, stack, cycles, weights)
        enough = WORTH * scanned.max()
        for k in range(COARSE):
            beside = max(scanned[k - 1], scanned[(k + 1) % COARSE])
            peaks[k] = places[k] = 0.0
            if scanned[k] == 0.0 or scanned[k] < enough or scanned[k] < beside:
                continue
            peaks[k], places[k] = scanned[k], k * step
            left, right = (k - 1) * step, (k + 1) * step
            one, two = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
            first = _sum(path, one, order, blocks, form, least, curve, table, u, v, stack, cycles, weights)
            second = _sum(path, two, order, blocks, form, least, curve, table, u, v, stack, cycles, weights)
            for _ in range(STEPS):
                if first > peaks[k]:
                    peaks[k], places[k] = first, one
                if second > peaks[k]:
                    peaks[k], places[k] = second, two
                if first >= second:
                    right, two, second = two, one, first
                    one = right - GOLDEN * (right - left)
                    first = _sum(path, one, order, blocks, form, least, curve, table, u, v, stack, cycles, weights)
                else:
                    left, one, first = one, two, second
                    two = left + GOLDEN * (right - left)
                    second = _sum(path, two, order, blocks, form, least, curve, table, u, v, stack, cycles, weights)
        best = peaks.max()
        angle = plane_angle(places[peaks.argmax()], ERROR)
        for k in range(COARSE):
            other = plane_angle(places[k], ERROR)
            if peaks[k] >= (1.0 - TIE) * best and other > angle + ERROR:
                angle = other
        out[i, 0] = best
        out[i, 1] = np.nan if best == 0.0 else angle


@compiled
def cycles_on_plane(path, angle, order, blocks, form, least, life, places, values):
    """Count the cycles of a point on one plane, and return their number.

    Parameters
    ----------
    path : ndarray, shape (states, 6)
    angle : float
        Angle of the plane, rad.
    order, blocks, form, least, life
        See :func:`worst_sums`.
    places : ndarray of int64, shape (3 stops + 2, 3)
        The states of both reversals, and the state with the largest V.
    values : ndarray, shape (3 stops + 2, 3)
        How often the cycle comes, its parameter, and the damage of all its times.
    """
    u, v = np.empty(path.shape[0]), np.empty(path.shape[0])
    stack, weights = np.empty((6 * order.size + 2, 2), np.int64), np.empty(3 * order.size + 2, np.int64)
    _on_plane(path, 2.0 * angle, u, v)
    count = _count(u, v, order, blocks, stack, places, weights)
    for k in range(count):
        parameter = _parameter(u, v, places[k], form, life)
        values[k, 0], values[k, 1] = weights[k], parameter
        values[k, 2] = 0.0
        if parameter > least:
            target = math.log(parameter)
            one = _beyond(target, life) if target < life[4] else 2.0 * math.exp(min(-_root(target, life), 700.0))
            values[k, 2] = weights[k] * one
    return count

"""The lengths of a growing crack, closer where its rate bends, and the error of its life."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fastpin.runtime.extensions import interpolate

EXACT = 1e-5
"""Relative error of a life, or of the length of an arrest, that more lengths are to reach."""

MOST_COMPUTED = 250
"""Most lengths at which K is computed: a contact edge at the mouth bends K at all scales."""

ROUNDS = 40
"""Most halvings of a step: an arrest is known to 1e-12 of its length then."""

LEFT_OUT = 6.0
"""Error at a length that is left out, in parts of the error beside it. A smooth function has 16, a kink 2 to 4.

The errors of all lengths are summed without their signs, so that the sum is an upper bound: tests/survey/test_lives.py.
"""

Intensities = Callable[[np.ndarray], np.ndarray]
"""K at lengths, m: shape (states, lengths, 2), Pa sqrt(m)."""

CrackPace = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of lengths, m, and K there, shape (3, lengths): the cycles in which ln(length) grows by 1, the range less the
threshold, and the toughness less the largest K_I, Pa sqrt(m)."""


def step_cycles(x: np.ndarray, pace: np.ndarray) -> np.ndarray:
    """The integral of the pace in each step of x = ln(length): exact where the pace is a power of the length.

    The bend of ln(pace) corrects the steps on both sides of which it has one sign. Without kinks the error falls as the
    fourth power of the steps. A step to an infinite pace has an infinite integral. The pace goes to 0 in a
    straight line, and stays there: a broken plate does not heal.
    """
    h, pace = np.diff(x), np.where(np.logical_or.accumulate(pace == 0.0), 0.0, pace)
    with np.errstate(all="ignore"):
        rise = np.diff(np.log(pace))
        plain = h * pace[:-1] * np.where(rise == 0.0, 1.0, np.expm1(rise) / rise)
        inner = 2.0 * np.diff(rise / h) / (h[1:] + h[:-1])
        bend = np.concatenate([inner[:1], inner, inner[-1:]])
        least = np.where(bend[1:] * bend[:-1] > 0.0, np.sign(bend[1:]) * np.minimum(abs(bend[1:]), abs(bend[:-1])), 0.0)
        corrected = plain * (1.0 - np.clip(least * h * h / 12.0, -0.1, 0.1))
        found = np.where(np.isfinite(rise), corrected, 0.5 * h * (pace[1:] + pace[:-1]))
    return np.asarray(found)


def spline_of(lengths: np.ndarray, K: np.ndarray) -> Intensities:
    """K between the lengths at which it is computed: K/sqrt(a) is smooth over ln a."""
    spline = interpolate.CubicSpline(np.log(lengths), K / np.sqrt(lengths)[:, None], axis=1)
    return lambda a: np.asarray(spline(np.log(a)) * np.sqrt(a)[:, None])


def refined(
    lengths: np.ndarray, K: np.ndarray, compute: Intensities, pace: CrackPace
) -> tuple[np.ndarray, np.ndarray, float]:
    """Lengths with K, shape (states, lengths, 2), more of both until the life is exact, and the error that is left.

    Parameters
    ----------
    lengths : ndarray, shape (m,)
        At which K is computed so far.
    K : ndarray, shape (states, m, 2)
    compute : callable
    pace : callable
    """
    while True:
        parts, error = _errors(lengths, K, pace)
        split = np.flatnonzero(parts > EXACT / 16.0)
        if error <= EXACT or lengths.size + split.size > MOST_COMPUTED or not split.size:
            return lengths, K, error
        new = np.sqrt(lengths[split] * lengths[split + 1])
        lengths = np.insert(lengths, split + 1, new)
        K = np.insert(K, split + 1, compute(new), axis=1)


def _errors(lengths: np.ndarray, K: np.ndarray, pace: CrackPace) -> tuple[np.ndarray, float]:
    """The error of each step between computed lengths, and of all: of the life, or of the arrest before it.

    Each length is left out in turn with every second one. The others tell K there.
    """
    x, told = np.log(lengths), K.copy()
    for first in (0, 1):
        kept = np.unique(np.r_[0, np.arange(first, x.size, 2), x.size - 1])
        left = np.setdiff1d(np.arange(x.size), kept)
        told[:, left] = spline_of(lengths[kept], K[:, kept])(lengths[left])
    true, by_others = pace(lengths, K), pace(lengths, told)
    there, weight, end = true[0], np.gradient(x), _end(true[0], true[1])
    if end == 0 or there[0] == 0.0:
        return np.zeros(x.size - 1), 0.0
    off = np.zeros(x.size)
    if end < x.size:
        off[end - 1 : end + 1] = _moved(x, true[1], by_others[1], end)
    else:
        with np.errstate(invalid="ignore", divide="ignore"):
            away = np.abs(by_others[0] / there - 1.0)
            away[[0, -1]] = LEFT_OUT * away[[1, -2]]  # no length tells the ends, where K may nearly vanish
            off[:] = away * there * weight
        broken = np.flatnonzero(there == 0.0)
        if broken.size:
            at = int(broken[0])
            off[at + 1 :] = 0.0
            off[at] = there[at - 1] * _moved(x, true[2], by_others[2], at).max()
            there = np.where(np.arange(x.size) < at, there, 0.0)
        off /= (there * weight).sum()
    off = np.where(np.isfinite(off), off, 1.0) / LEFT_OUT
    return np.maximum(off[1:], off[:-1]), float(off.sum())


def _moved(x: np.ndarray, excess: np.ndarray, by_others: np.ndarray, at: int) -> np.ndarray:
    """How far in x the others move the zero of an excess between two lengths, by each of both: shape (2,)."""
    both = slice(at - 1, at + 1)
    return np.asarray(np.abs(by_others - excess)[both] * (x[at] - x[at - 1]) / abs(excess[at] - excess[at - 1]))


def drawn(lengths: np.ndarray, read: Callable[[np.ndarray], np.ndarray]) -> tuple[np.ndarray, np.ndarray, float]:
    """Lengths between which the pace is nearly a power of the length, what is read there, and the error of the cycles.

    Parameters
    ----------
    lengths : ndarray, shape (m,)
        The first ones. Each step is halved once at least, and until the cycles up to an arrest are exact.
    read : callable
        Of lengths: an array of the shape (rows, lengths), whose first two rows are those of :data:`CrackPace`.
    """
    a, rows, error = lengths, read(lengths), 0.0
    split = np.arange(a.size - 1)
    for _ in range(ROUNDS):
        new, before = np.sqrt(a[split] * a[split + 1]), step_cycles(np.log(a), rows[0])[split]
        a, rows = np.insert(a, split + 1, new), np.insert(rows, split + 1, read(new), axis=1)
        first, x = split + np.arange(split.size), np.log(a)  # the first half of each step
        steps, end = step_cycles(x, rows[0]), _end(rows[0], rows[1])
        with np.errstate(invalid="ignore"):
            off = np.abs(steps[first] + steps[first + 1] - before) / (steps[: max(end - 1, 0)].sum() or 1.0)
        off = np.where(first + 1 < end, np.where(np.isfinite(off), off, 1.0), 0.0)
        again = _may_stop(x, rows[1])
        differs = off > 1e-3 * EXACT
        again[first[differs]] = again[first[differs] + 1] = True
        error += float(off[~differs].sum())
        split = np.flatnonzero(again & (np.arange(a.size - 1) < end) & (np.diff(x) > 1e-9))
        if not split.size:
            break
    return a, rows, error


def _end(pace: np.ndarray, margin: np.ndarray) -> int:
    """The place of the first length at which the crack stops; the number of lengths if it does not, or breaks first."""
    done = np.flatnonzero((margin <= 0.0) | (pace == 0.0))
    return int(done[0]) if done.size and pace[done[0]] else margin.size


def _may_stop(x: np.ndarray, margin: np.ndarray) -> np.ndarray:
    """Whether the margin of each step may pass zero: at an end, or where the lines of the steps beside it lead."""
    slope = np.diff(margin) / np.diff(x)
    h, before, after = np.diff(x), np.r_[slope[0], slope[:-1]], np.r_[slope[1:], slope[-1]]
    low = np.minimum(margin[:-1] + np.minimum(before, 0.0) * h, margin[1:] - np.maximum(after, 0.0) * h)
    return np.asarray((margin[:-1] > 0.0) & ((margin[1:] <= 0.0) | (low <= 0.0)))

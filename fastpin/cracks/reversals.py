"""Cycles of numbers: the closed cycles of a history that is repeated for ever.

The history is turned so that it begins and ends at its largest value. Then four points in a row close a cycle
(Matsuishi and Endo 1968; ASTM E1049, 5.4.5). :mod:`fastpin.damage.plane_damage` counts on planes, with a second
component.
"""

from __future__ import annotations

import numpy as np

from fastpin.runtime.jit import compiled


@compiled
def closed_cycles(values, tops, bottoms, counts):
    """Count the cycles of each row.

    Parameters
    ----------
    values : ndarray, shape (rows, stops)
        One period of each history, in the order of time. The last value need not equal the first one.
    tops, bottoms : ndarray, shape (rows, stops)
        Larger and smaller reversal of each cycle, filled up to the count of the row.
    counts : ndarray of int64, shape (rows,)
        Number of cycles of each row.
    """
    size = values.shape[1]
    stack = np.empty(size + 2)
    for i in range(values.shape[0]):
        first = 0
        for t in range(size):
            if values[i, t] > values[i, first]:
                first = t
        n, count = 0, 0
        for t in range(size + 1):
            x = values[i, (t + first) % size]
            if n >= 2 and (stack[n - 1] - stack[n - 2]) * (x - stack[n - 1]) >= 0.0:
                n -= 1
            elif n == 1 and x == stack[0]:
                n = 0
            while n >= 3:
                a, b, c = stack[n - 3], stack[n - 2], stack[n - 1]
                swing = abs(b - c)
                if swing > abs(x - c) or swing > abs(a - b):
                    break
                tops[i, count], bottoms[i, count] = max(b, c), min(b, c)
                count += 1
                n -= 2
            stack[n] = x
            n += 1
        if n == 3:
            tops[i, count], bottoms[i, count] = stack[0], stack[1]
            count += 1
        counts[i] = count

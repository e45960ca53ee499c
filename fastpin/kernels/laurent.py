"""Stresses of Laurent series: smooth fields in a wall between two circles.

With x = z/b and y = a/z, where a and b are the radii of the circles, three growing series G = sum g_n x^n and three
decaying series H = sum h_n y^n give the sum of the normal stresses and D = s_rr - i s_rtheta,

    s_rr + s_tt = 4 Re(G_1 + H_1),     D = 2 Re(G_1 + H_1) - G_2 - H_2 - (b/r)^2 G_3 - (a/r)^2 H_3.

They are Omega', z Omega'' and z^2 omega' of docs/theory.md, (T42).
"""

from __future__ import annotations

import math

from fastpin.runtime.jit import compiled


@compiled
def add_polar(theta, radius, growing, decaying, smallest, largest, out):
    """Add s_rr + s_tt and D at the points `theta`, `radius` (m,) to `out` (m, 2).

    `growing` and `decaying` hold g_n and h_n, shape (3, ...), for n = 0, 1 and so on. `smallest` and `largest` are the
    radii a and b.
    """
    for k in range(theta.size):
        turn = complex(math.cos(theta[k]), math.sin(theta[k]))
        wide, narrow = radius[k] / largest, smallest / radius[k]
        x, y = wide * turn, narrow * turn.conjugate()
        first, second, third = 0j, 0j, 0j
        for n in range(growing.shape[1] - 1, -1, -1):
            first = first * x + growing[0, n]
            second = second * x + growing[1, n]
            third = third * x + growing[2, n]
        both, rest = first.real, second + third / (wide * wide)
        first, second, third = 0j, 0j, 0j
        for n in range(decaying.shape[1] - 1, -1, -1):
            first = first * y + decaying[0, n]
            second = second * y + decaying[1, n]
            third = third * y + decaying[2, n]
        both += first.real
        out[k, 0] += 4.0 * both
        out[k, 1] += 2.0 * both - rest - second - third * (narrow * narrow)

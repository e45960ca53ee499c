"""The compliance of a ring held at its rim, from its closed form."""

from __future__ import annotations

import numpy as np

from fastpin.bodies import Compliance, harmonics


def block(a: float, b: float, d: float) -> np.ndarray:
    """The entries (r cos, r sin, theta cos, theta sin) of one harmonic from the compliances of (t_n, conj t_-n)."""
    rr, tt, rt = 0.5 * (a + d) + b, 0.5 * (a + d) - b, 0.5 * (a - d)
    return -0.5 * np.array([[rr, 0, 0, rt], [0, rr, -rt, 0], [0, -rt, tt, 0], [rt, 0, 0, tt]])


def held_ring_matrix(outer: float, kolosov: float, order: int) -> np.ndarray:
    """The matrix of a compliance (2 + 4 `order`, ...) of a ring to the radius `outer`, in radii of the hole."""
    found = np.zeros((2 + 4 * order, 2 + 4 * order))
    found[0, 0] = -0.5 * (harmonics.uniform(outer, kolosov, "held") + 1.0)
    found[1, 1] = 0.5 * (1.0 - outer**-2.0) - 0.5  # 2G u_theta/r = -(1 - 1/q) s_rtheta
    first = harmonics.first(outer, kolosov, "held")
    own, moved = first.displacement(), first.translation(outer)
    found[2:6, 2:6] = block(own[0] + 0.5, own[1], moved[1])
    a, b, d = harmonics.ring(np.arange(2.0, order + 1.0), outer, kolosov, "held")
    for n in range(2, order + 1):
        found[4 * n - 2 : 4 * n + 2, 4 * n - 2 : 4 * n + 2] = block(a[n - 2], b[n - 2], d[n - 2])
    return found


def held_ring(outer: float, order: int, nu: float = 0.3) -> Compliance:
    """The compliance of a ring to the radius `outer` round a hole of radius 1, in plane strain."""
    return Compliance(nu, "strain", 1.0, held_ring_matrix(outer, 3.0 - 4.0 * nu, order))

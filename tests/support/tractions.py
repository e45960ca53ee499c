"""Random piecewise linear tractions."""

import numpy as np

from fastpin.elasticity.tractions import Tractions


def patch(rng, start, stop, n):
    nodes = np.sort(rng.uniform(start, stop, n))
    values = np.column_stack([nodes, rng.uniform(0.0, 1.0, n), rng.uniform(-1.0, 1.0, n)])
    values[[0, -1], 1:] = 0.0
    return values


def circle(rng, n):
    nodes = np.sort(rng.uniform(-4.7, 1.5, n))
    values = np.column_stack([nodes, rng.uniform(0.0, 1.0, n), rng.uniform(-1.0, 1.0, n)])
    return np.vstack([values, values[0] + [2.0 * np.pi, 0.0, 0.0]])


def samples(seed=7):
    rng = np.random.default_rng(seed)
    return {
        "arc": Tractions((patch(rng, -3.0, -0.4, 60),)),
        "narrow": Tractions((patch(rng, -1.6, -1.57, 30),)),
        "two patches": Tractions((patch(rng, -3.0, -1.0, 33), patch(rng, 0.2, 1.1, 21))),
        "circle": Tractions((circle(rng, 50),)),
        "small circle": Tractions((circle(rng, 5),)),
        "nothing": Tractions(()),
    }

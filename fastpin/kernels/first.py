"""The readings' kernels of a first run. A second process compiles them, since the solver's take as long.

The first run compiles :func:`fastpin.kernels.held.step` for half of its time. When it comes to the readings, most
of their kernels are stored. ``tests/kernels/test_first.py`` compares the list with a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.kernels import cauchy, conjugate, power_laws
from fastpin.kernels.half_line import end_places, evaluate, least_squares, match, series, solve, value_errors
from fastpin.runtime import beside

MODULE = __name__
"""The module that a second process runs."""


def kernels() -> list[tuple[Any, ...]]:
    """Kernels, each before arguments of the types of a first run.

    All but the first four are in the reverse order of their use: there the first process comes to meet the second one.
    """
    line, table, cube, places = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1)), np.zeros((1, 1), dtype=np.int64)
    row, rows, block = (np.zeros((1,) * k, dtype=np.complex128) for k in (1, 2, 3))
    return [
        (end_places, line, places, table, cube, table),
        (value_errors, line, places, table, cube, line, line),
        (solve, line, 0, table, cube, line, table),
        (match, 0, table, cube, line, table, table),
        (cauchy.cauchy, line, line, True, table, 0, places, row, line, block, rows),
        (cauchy.grow, table, 0, line, line, table, places, row, line, block),
        (power_laws.fit, line, line, 0j, False, places, row),
        (conjugate.edge, line, line, table, 0, places, table, table, table),
        (conjugate.gather, table, places, line, table, table, table, table),
        (least_squares, table, line, line),
        (power_laws.evaluate, line, 0j, row, line),
        (series, 0, 0, table, cube, table, table),
        (evaluate, line, 0.0, 0, table, cube, table, table),
    ]


if __name__ == "__main__":
    for kernel, *arguments in kernels():
        if beside.is_needed():
            kernel.prepare(*arguments)

"""The readings' kernels of a first run. A second process compiles them, since the solver's take as long.

The first run compiles :func:`fastpin.kernels.held.step` for half of its time. When it comes to the readings, most
of their kernels are stored. ``tests/kernels/test_first.py`` compares the list with a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.kernels.cauchy import cauchy, grow
from fastpin.kernels.half_line import end_places, evaluate, least_squares, match, solve, value_errors
from fastpin.runtime import beside

MODULE = __name__
"""The module that a second process runs."""


def kernels() -> list[tuple[Any, ...]]:
    """Kernels, each before arguments of the types of a first run.

    The last five are in the reverse order of their use: there the first process comes to meet the second one.
    """
    line, table, cube, places = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1)), np.zeros((1, 1), dtype=np.int64)
    row, rows, block = (np.zeros((1,) * k, dtype=np.complex128) for k in (1, 2, 3))
    frozen = np.frombuffer(bytes(8))
    return [
        (end_places, line, places, table, cube, table),
        (grow, table, 0, line, line, table, places, row, line, block),
        (cauchy, line, line, True, table, 0, places, row, line, block, rows),
        (value_errors, line, places, table, cube, line, line),
        (least_squares, table, line, line),
        (cauchy, frozen, line, True, table, 0, places, row, line, block, rows),
        (evaluate, line, 0.0, 0, table, cube, table, table),
        (match, 0, table, cube, line, table, table),
        (solve, line, 0, table, cube, line, table),
    ]


if __name__ == "__main__":
    for kernel, *arguments in kernels():
        if beside.is_needed():
            kernel.prepare(*arguments)

"""The kernels of a first run that two processes compile at the same time.

:func:`fastpin.kernels.held.step` takes longest. The first process compiles it while the second one compiles the
matrices, the table of the held contact, and the readings. ``tests/kernels/test_first.py`` compares both with a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.kernels import arrays, cauchy, conjugate, power_laws
from fastpin.kernels.half_line import end_places, value_errors
from fastpin.kernels.held import step
from fastpin.kernels.held_table import fill
from fastpin.kernels.influence import fill_columns
from fastpin.runtime import beside

MODULE = __name__
"""The module that a second process runs."""

LINE, TABLE, CUBE = (np.zeros((2,) * k) for k in (1, 2, 3))
BY_COLUMNS, WHOLE, SIGNS, MARKS = np.asfortranarray(TABLE), LINE.astype(np.int64), LINE.astype(np.int8), LINE > 0.0


def kernels() -> list[tuple[Any, ...]]:
    """Kernels of the second process, each before arguments of the types of a first run.

    The last two are interpreted at first.
    """
    row, rows, block = (array.astype(np.complex128) for array in (LINE, TABLE, CUBE))
    places = TABLE.astype(np.int64)
    return [
        (fill_columns, LINE, LINE, LINE, LINE, 0.0, 0.0, CUBE, CUBE[:, 0], CUBE[:, 0]),
        (fill, TABLE, 0, 0, TABLE, TABLE, TABLE, BY_COLUMNS),
        (cauchy.cauchy, LINE, LINE, True, TABLE, 0, places, row, LINE, block, rows),
        (cauchy.grow, TABLE, 0, LINE, LINE, TABLE, places, row, LINE, block),
        (conjugate.edge, LINE, LINE, TABLE, 0, places, TABLE, TABLE, TABLE),
        (conjugate.gather, TABLE, places, LINE, TABLE, TABLE, TABLE, TABLE),
        (power_laws.evaluate, LINE, 0j, row, LINE),
        (value_errors, LINE, places, TABLE, CUBE, LINE, LINE),
        (end_places, LINE, places, TABLE, CUBE, TABLE),
    ]


def step_arguments() -> tuple[Any, ...]:
    """Arguments of :func:`fastpin.kernels.held.step` of the types of a first run."""
    contact = arrays.Contact(LINE, LINE, LINE, LINE, SIGNS, SIGNS, MARKS, LINE, LINE, TABLE)
    tableau = arrays.Tableau(BY_COLUMNS, WHOLE, BY_COLUMNS, WHOLE, WHOLE, LINE, LINE, WHOLE, LINE, LINE, 1)
    load = arrays.LoadTerms(LINE, LINE, LINE, LINE, LINE, LINE, WHOLE, TABLE)
    return (
        True, WHOLE, BY_COLUMNS, arrays.Equations(TABLE, TABLE, TABLE, LINE), LINE, LINE,
        arrays.RightSides(LINE, LINE, LINE), contact, tableau, load, arrays.Queue(WHOLE, SIGNS, WHOLE, LINE), MARKS,
        0.0, 0.0, 0, 0, arrays.ContactValues(LINE, LINE, LINE, LINE, SIGNS, LINE),
    )  # fmt: skip


def share() -> None:
    """Let a second process compile :func:`kernels` when this one compiles, and this one the step meanwhile."""
    own: Any = step
    beside.module, beside.meanwhile[fill_columns] = MODULE, lambda: own.prepare(*step_arguments())


if __name__ == "__main__":
    for kernel, *arguments in kernels():
        if beside.is_needed():
            kernel.prepare(*arguments)

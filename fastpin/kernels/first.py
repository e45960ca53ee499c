"""The kernels of a first run that two processes compile at the same time.

:func:`fastpin.kernels.held.step` takes longest. The first process compiles it while the second one compiles the
matrices, the table of the held contact, and the readings. ``tests/kernels/test_first.py`` compares both with a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.kernels import cauchy, conditions, conjugate, half_line, held, held_table, influence, power_laws
from fastpin.kernels.arrays import Contact, ContactValues, Equations, LoadTerms, Queue, RightSides, Tableau
from fastpin.runtime import beside


def kernels() -> list[tuple[Any, ...]]:
    """Kernels before arguments of the types of a first run: that of the first process, then those of the second one.

    The four after the table are interpreted until they are stored. As Python they take longest of such kernels.
    """
    line, table, cube = (np.zeros((2,) * k) for k in (1, 2, 3))
    columns, whole, places = np.asfortranarray(table), line.astype(np.int64), table.astype(np.int64)
    signs, row, rows, block = line.astype(np.int8), 1j * line, 1j * table, 1j * cube
    values, sides = ContactValues(line, line, line, line, signs, line), RightSides(line, line, line)
    contact = Contact(line, line, line, line, signs, signs, line > 0.0, line, line, table)
    tableau = Tableau(columns, whole, columns, whole, whole, line, line, whole, line, line, 0)
    load, queue = LoadTerms(line, line, line, line, line, line, whole, table), Queue(whole, signs, whole, line)
    matrices = columns, Equations(table, table, table, line), line, line, sides
    return [
        (held.step, True, whole, *matrices, contact, tableau, load, queue, line > 0.0, 0.0, 0.0, 0, 0, values),
        (influence.fill_columns, line, line, line, line, 0.0, 0.0, cube, cube[:, 0], cube[:, 0]),
        (held_table.fill, table, 0, 0, table, table, table, columns),
        (conditions.residuals, matrices[1], values, line, line, line, line, line),
        (half_line.end_places, line, places, table, cube, table),
        (half_line.solve, line, 0, table, cube, line, table),
        (half_line.value_errors, line, places, table, cube, line, line),
        (cauchy.cauchy, line, line, True, table, 0, places, row, line, block, rows),
        (cauchy.grow, table, 0, line, line, table, places, row, line, block),
        (conjugate.edge, line, line, table, 0, places, table, table, table),
        (conjugate.gather, table, places, line, table, table, table, table),
        (power_laws.evaluate, line, 0j, row, line),
    ]


def share() -> None:
    """Let a second process compile when this one compiles, and this one its own kernel meanwhile."""
    kernel, *arguments = kernels()[0]
    beside.module, beside.meanwhile[influence.fill_columns] = __name__, lambda: kernel.prepare(*arguments)


if __name__ == "__main__":
    for kernel, *arguments in kernels()[1:]:
        if beside.is_needed():
            kernel.prepare(*arguments)

"""The readings' kernels of a first run. A second process compiles them, since the solver's take as long.

The first run compiles :func:`fastpin.kernels.exchange.follow` for half of its time. When it comes to the readings, most
of their kernels are stored. ``tests/kernels/test_first.py`` compares the list with a run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fastpin.kernels.cauchy import cauchy, moments, shift_moments
from fastpin.kernels.half_line import end_places, evaluate, least_squares, match, solve, value_errors
from fastpin.runtime import beside, jit

_LINE, _TABLE, _CUBE = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1, 1))
_FROZEN = np.frombuffer(bytes(8))
_PLACES = np.zeros((1, 1), dtype=np.int64)
_COMPLEX = tuple(np.zeros((1,) * k, dtype=np.complex128) for k in (1, 2, 3))
_TREE = (True, _TABLE, 0, _PLACES, _COMPLEX[0], _LINE, _COMPLEX[2], _COMPLEX[1])

KERNELS: tuple[tuple[Callable[..., Any], tuple[Any, ...]], ...] = (
    (end_places, (_LINE, _PLACES, _TABLE, _CUBE, _TABLE)),
    (moments, (_TABLE, _PLACES, _COMPLEX[0], _LINE, _LINE, _COMPLEX[2])),
    (shift_moments, (_COMPLEX[1], 0j, _TABLE, _COMPLEX[1])),
    (cauchy, (_LINE, _LINE, *_TREE)),
    (value_errors, (_LINE, _PLACES, _TABLE, _CUBE, _LINE, _LINE)),
    (least_squares, (_TABLE, _LINE, _LINE)),
    (cauchy, (_FROZEN, _LINE, *_TREE)),
    (evaluate, (_LINE, 0.0, 0, _TABLE, _CUBE, _TABLE, _TABLE)),
    (match, (0, _TABLE, _CUBE, _LINE, _TABLE, _TABLE)),
    (solve, (_LINE, 0, _TABLE, _CUBE, _LINE, _TABLE)),
)
"""Kernels, and arguments of the types of a first run. The last five are in the reverse order of their use: there the
first process comes to meet the second one."""


def compile_beside() -> None:
    """Let a second process compile these kernels when this one begins to compile."""
    jit.beside = __name__


if __name__ == "__main__":
    for kernel, arguments in KERNELS:
        if beside.is_needed():
            kernel.prepare(*arguments)  # type: ignore[attr-defined]

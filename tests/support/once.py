"""Histories that several tests compare with others, each solved once in a process."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from fastpin import Problem, Result, solve


def solve_once(problem: Problem, corners: Sequence[Mapping[str, float]], **options: Any) -> Result:
    """:func:`fastpin.solve`, or the result of an earlier call with the same problem, corners and options.

    Its states are frozen. A grid among the options must be the same object.
    """
    return _solved(problem, tuple(tuple(corner.items()) for corner in corners), tuple(options.items()))


@lru_cache(maxsize=64)
def _solved(
    problem: Problem, corners: tuple[tuple[tuple[str, float], ...], ...], options: tuple[tuple[str, Any], ...]
) -> Result:
    return solve(problem, [dict(corner) for corner in corners], **dict(options))

"""Parameters of tests that run in each run of the tests, and parameters that are left to the slow ones."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def slow(*values: Any) -> list[Any]:
    """Parameters of slow tests. A tuple is a row of several parameters."""
    rows = (value if isinstance(value, tuple) else (value,) for value in values)
    return [pytest.param(*row, marks=pytest.mark.slow) for row in rows]


def first_quick(count: int, values: Iterable[Any]) -> list[Any]:
    """Parameters of which the first `count` run in each run of the tests. The others are slow."""
    known = list(values)
    return [*known[:count], *slow(*known[count:])]

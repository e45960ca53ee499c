"""Curves of figures beyond the paper."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from fastpin.assess.outputs import Curve


def curves_of(columns: Sequence[str], rows: Iterable[tuple[dict[str, Any], Sequence[float]]]) -> list[Curve]:
    """Return a curve for each set of parameters: of its rows, which have a number for each of the `columns`."""
    found: dict[tuple[tuple[str, Any], ...], list[Sequence[float]]] = {}
    for parameters, row in rows:
        found.setdefault(tuple(parameters.items()), []).append(row)
    return [
        Curve(dict(parameters), dict(zip(columns, np.array(each).T, strict=True))) for parameters, each in found.items()
    ]

"""The place of the end of a zone, from the nodal values beside it and the solutions of the half-line problem."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from fastpin.reading.half_line import End, Fit, HalfLine, Tries, Try
from fastpin.reading.old_borders import OldBorder

WINDOWS = ((8, 4), (6, 4), (5, 3), (6, 3), (10, 5), (14, 5), (20, 5))
"""Windows to try: the number of nodes from the end, and the number of terms."""

CROWDED = ((8, 3), (10, 3), (12, 4), (14, 4), (18, 4), (24, 5))
"""Windows to try where old borders lie near the end."""

MOST_VALUES = 2 * max(count for count, _ in (*WINDOWS, *CROWDED))
"""Values of a zone that count: a window takes at most half of them. More values give the same place."""

CUSP_TERMS = 3
"""Terms at an old border."""


def end_place(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder] = ()) -> float:
    """Place at which a quantity falls to zero at the end of a zone: that of :func:`end_fit`.

    It is in node distances inwards from the outermost node; NaN if no fit is good enough.
    """
    return _best(values, line, cusps)[1]


def end_fit(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder] = ()) -> Fit | None:
    """The best fit of a quantity that falls to zero at the end of a zone. This is the end number 0 of the fit.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Values of the quantity from the outermost node inwards.
    line : HalfLine
    cusps : sequence of OldBorder
        Old borders in the zone.

    Returns
    -------
    Fit or None
        None if no fit is good enough.
    """
    best, place = _best(values, line, cusps)
    return None if best is None or math.isnan(place) else Fit(values[: best.nodes], best.ends)


def _best(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder]) -> tuple[Try | None, float]:
    """The best fit at the end of a zone, and the place of the end by it, NaN if it is not plausible."""
    others = [
        End(line, cusp.at, cusp.inwards, CUSP_TERMS, cusp.place)
        for cusp in sorted(cusps)
        if cusp.at < MOST_VALUES // 2 and (cusp.at, cusp.inwards) != (0, 1)
    ]
    most = max(values.size // 2, min(values.size - 1, 10))  # the outer half; of a small zone all nodes but one
    return _best_fit(values[:MOST_VALUES].tobytes(), line, tuple(others), min(most, MOST_VALUES // 2))


@functools.lru_cache(maxsize=64)
def _best_fit(values: bytes, line: HalfLine, others: tuple[End, ...], most: int) -> tuple[Try | None, float]:
    """The best fit of up to `most` of the `values`, with the old borders `others`; and the place of the end by it.

    It is kept, because the same end is read for the zones of a state and for its cusps.
    """
    tries, packed = _tries(line, others, most)
    # Standard errors in node distances. The solutions at a border of unlike bodies leave out contact edges nearby,
    # which the standard error shows in part only.
    best, found, least = None, math.nan, 0.01 if line.coupling else 0.05
    if packed is None:
        return None, math.nan
    is_crowded = _is_crowded(others)
    for each, (place, error) in zip(tries, packed.end_places(np.frombuffer(values)).tolist(), strict=True):
        if error < least:
            best, found, least = each, place, error
        if least <= 1e-4 and not is_crowded:  # the discrete problem itself has errors of this size
            break
    return best, found


def _is_crowded(others: Sequence[End]) -> bool:
    """Whether one of the old borders `others` lies near the end."""
    return any(other.node < CROWDED[0][0] for other in others)


@functools.lru_cache(maxsize=256)
def _tries(line: HalfLine, others: tuple[End, ...], most: int) -> tuple[list[Try], Tries | None]:
    """The fits of up to `most` nodes to try at the end of a zone with the old borders `others`; None if there is none.

    They are the same for all ends of like bodies without old borders.
    """
    tries = []
    for count, terms in CROWDED if _is_crowded(others) else WINDOWS:
        ends = (End(line, 0, 1, terms), *(other for other in others if other.node < count))
        fit = Try(0, count, -1, ends)
        if count <= most and fit.spare >= 1:
            tries.append(fit)
    return tries, Tries(tries) if tries else None


def end_angle(
    theta: np.ndarray, quantity: np.ndarray, line: HalfLine, outside: float, cusps: Sequence[OldBorder] = ()
) -> float:
    """Angle at which a quantity falls to zero at the end of a zone, rad.

    Parameters
    ----------
    theta, quantity : ndarray, shape (n,)
        Angles (rad) of the nodes of the zone, from the outermost node inwards, in either direction; and the values at
        these nodes, >= 0.
    line : HalfLine
    outside : float
        Angle of the next node outwards, where the quantity is zero, rad.
    cusps : sequence of OldBorder
        The old borders in the zone.

    Returns
    -------
    float
        An angle, not beyond `outside`. If no solution of the half line fits, the zero of the line through the two
        outermost nodes. A zone of one node ends halfway to `outside`.
    """
    if theta.size == 1:
        return 0.5 * float(theta[0] + outside)
    spacing = float(theta[1] - theta[0])
    place = end_place(quantity, line, cusps)
    if math.isnan(place):
        low = (outside - float(theta[0])) / spacing
        return float(theta[0]) + spacing * by_two_nodes(float(quantity[0]), float(quantity[1]), line.exponent, low)
    if place < 0.0:
        return float(theta[0] - max(place, -1.0) * (outside - theta[0]))
    return float(theta[0] + place * spacing)


def by_two_nodes(first: float, second: float, exponent: float, low: float) -> float:
    """Zero of the line through two nodes, in node distances from the first one, the outermost node of a zone.

    The line goes through the values to the power 1/`exponent`. If it does not fall outwards, the result is halfway to
    the next node outwards at `low` < 0.
    """
    outer, inner = abs(first) ** (1.0 / exponent), abs(second) ** (1.0 / exponent)
    return max(-outer / (inner - outer), low) if inner > outer else 0.5 * low

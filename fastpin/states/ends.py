"""The place of the end of a zone, from the nodal values beside it and the solutions of the half-line problem."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fastpin.states.half_line import End, Fit, HalfLine
from fastpin.states.old_borders import OldBorder

WINDOWS = ((8, 4), (6, 4), (5, 3), (6, 3), (10, 5), (14, 5), (20, 5))
"""Windows to try: the number of nodes from the end, and the number of terms."""

CROWDED = ((8, 3), (10, 3), (12, 4), (14, 4), (18, 4), (24, 5))
"""Windows to try where old borders lie near the end."""

MOST_VALUES = 2 * max(count for count, _ in (*WINDOWS, *CROWDED))
"""Values of a zone that count: a window takes at most half of them. More values give the same place."""

CUSP_TERMS = 3
"""Terms at an old border."""

GOOD_ENOUGH = 1e-4
"""Standard error of a place, in node distances, from which on no other window is tried.

The error of the discrete problem itself is of this size.
"""

LARGEST_ERROR, LARGEST_COUPLED = 0.05, 0.01
"""Largest standard error of a place, in node distances, for like bodies and at a border of unlike ones.

A fit with a larger one is not taken. The solutions at a border of unlike bodies leave out contact edges nearby, which
the standard error shows in part only.
"""


def end_place(values: np.ndarray, line: HalfLine, cusps: Sequence[OldBorder] = ()) -> float:
    """Place at which a quantity falls to zero at the end of a zone: that of :func:`end_fit`.

    It is in node distances inwards from the outermost node; NaN if no fit is good enough.
    """
    found = end_fit(values, line, cusps)
    return math.nan if found is None else found.place(0)


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
    best: Fit | None = None
    least = LARGEST_COUPLED if line.coupling else LARGEST_ERROR
    others = [
        End(line, cusp.at, cusp.inwards, CUSP_TERMS, cusp.place) for cusp in cusps if (cusp.at, cusp.inwards) != (0, 1)
    ]
    crowded = any(other.node < CROWDED[0][0] for other in others)
    most = max(values.size // 2, min(values.size - 1, 10))
    for count, terms in CROWDED if crowded else WINDOWS:
        if count > most:
            continue
        ends = (End(line, 0, 1, terms), *(other for other in others if other.node < count))
        if count < sum(end.unknowns for end in ends) + 1:
            continue
        fit = Fit(values[:count], ends)
        error = fit.place_error(0)
        if error < least:
            best, least = fit, error
        if least <= GOOD_ENOUGH and not crowded:
            break
    return None if best is None or math.isnan(best.place(0)) else best

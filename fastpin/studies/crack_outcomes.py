"""Outcomes of cracks that grow from the hole under the loads of a result."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from fastpin import cracks
from fastpin.assess.crack import CrackStops
from fastpin.cracks.fates import CRACK_FATES
from fastpin.model.crack import CrackGrowth
from fastpin.model.doubts import doubts_given
from fastpin.solver.result import Result
from fastpin.studies.kept import kept


class CrackQuantity(NamedTuple):
    """A number of a crack that grows, see :class:`CycleQuantity`.

    `of` gives its value for a growth. A "life" counts cycles or spectra.
    """

    kind: str
    of: Callable[[Any], float]
    classes: Mapping[int, str] = MappingProxyType({})


CRACK_QUANTITIES: dict[str, CrackQuantity] = {
    "fate": CrackQuantity("class", lambda found: float(found.fate), CRACK_FATES),
    "life": CrackQuantity("life", lambda found: found.life if math.isfinite(found.life) else math.nan),
    "arrest": CrackQuantity("length", lambda found: found.arrest),
    "theta": CrackQuantity("angle", lambda found: found.crack.theta),
    "largest_K": CrackQuantity("stress intensity", lambda found: float(found.K_max.max())),
}
"""The quantities of a crack that grows from the hole in the last cycle, or in a history without cycles, by name.

"fate" says whether it starts, stops, grows or breaks, see :class:`fastpin.cracks.CrackFate`. "life" counts cycles from
the first to the last length, or spectra. "arrest" is the length at which the crack stops. "theta" is its mouth.
"largest_K" is the largest K_I up to the last length.
"""


def of_crack(quantity: str, crack: CrackGrowth, result: Result) -> float:
    """The value of a name in :data:`CRACK_QUANTITIES`, see :func:`grown`."""
    return CRACK_QUANTITIES[quantity].of(grown(result, crack))


@kept
def grown(result: Result, crack: CrackGrowth) -> cracks.Growth:
    """The growth of a crack under the last cycle of a result, or else its history; kept while the result lives.

    Raises
    ------
    InputError
        If the result has neither a cycle nor a spectrum, or the crack can't be followed.
    """
    stops = CrackStops.of(len(result.history), result.cycles, lambda first, last: result)
    with doubts_given():
        return stops.growth(crack)

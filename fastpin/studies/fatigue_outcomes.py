"""Outcomes of an assessment of fatigue: life, damage and place of the worst hot spot of all bodies."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from fastpin.model.assessment import FatigueAssessment
from fastpin.model.doubts import doubts_given
from fastpin.studies.kept import kept

if TYPE_CHECKING:  # the solver is compiled code, and a plan is read without it
    from fastpin.damage.spectrum import SpectrumSpot
    from fastpin.solver.result import Result


class FatigueQuantity(NamedTuple):
    """A number of the worst hot spot of an assessment.

    Attributes
    ----------
    kind : str
        See :class:`fastpin.studies.outcomes.CycleQuantity`.
    of : callable
        Gives its value for a hot spot; NaN without one.
    """

    kind: str
    of: Callable[[SpectrumSpot], float]


FATIGUE_QUANTITIES: dict[str, FatigueQuantity] = {
    "life": FatigueQuantity("life", lambda spot: spot.life if math.isfinite(spot.life) else math.nan),
    "damage": FatigueQuantity("", lambda spot: spot.damage),
    "angle": FatigueQuantity("angle", lambda spot: spot.theta),
}
"""The quantities of the hot spot with the largest damage of all bodies, by name. Lives count passes of the spectrum.

"life" and "angle" are NaN, and "damage" is 0, where no cycle does damage.
"""


def of_assessment(quantity: str, how: FatigueAssessment, result: Result) -> float:
    """The value of a name in :data:`FATIGUE_QUANTITIES` by the first criterion. Hot spots are kept with the result.

    Raises
    ------
    InputError
        See :meth:`fastpin.Result.assessed_fatigue`.
    """
    return FATIGUE_QUANTITIES[quantity].of(_hot_spot(result, how))


@kept
def _hot_spot(result: Result, how: FatigueAssessment) -> SpectrumSpot:
    with doubts_given():
        return result.assessed_fatigue(how)[0].hot_spot


def unit_of_life(passes: str) -> tuple[str, str]:
    """Return the kind of a life that counts these passes, and its unit where it has no kind: spectra are no cycles."""
    return ("life", "") if passes == "cycles" else ("", passes)

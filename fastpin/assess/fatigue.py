"""The fatigue of a case: the outputs of an assessment, and of each body."""

from __future__ import annotations

from typing import Any

from fastpin.assess.kept import kept
from fastpin.assess.outputs import Output
from fastpin.model.assessment import DISTANCES, MINER_RULES, SPECTRA, FatigueAssessment
from fastpin.model.doubts import doubts_given
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.points import BODIES

HOW = (
    Output("criterion", "texts", lambda how: list(how.criteria), allowed=LIFE_CONSTANTS),
    Output("over", "text", lambda how: how.over, allowed=SPECTRA),
    Output("method", "text", lambda how: how.method, allowed=DISTANCES),
    Output("small_cycles", "text", lambda how: how.small_cycles, allowed=MINER_RULES),
    Output("knee", "", lambda how: how.knee, optional=True),
    Output("life_asked", "", lambda how: how.life, optional=True),
)
"""Outputs of a :class:`fastpin.model.FatigueAssessment`."""

DAMAGE = (
    Output("criterion", "text", lambda found: found.criterion, allowed=LIFE_CONSTANTS),
    Output("body", "text", lambda found: found.body, allowed=BODIES),
    Output("damage", "", lambda found: found.hot_spot.damage),
    Output(
        "life", "life", lambda found: found.hot_spot.life,
        "spectra, or cycles over the last cycle; null without damage", optional=True,
    ),
    Output("angle", "angle", lambda found: found.hot_spot.theta, optional=True),
    Output("depth", "length", lambda found: found.hot_spot.depth, optional=True),
    Output("plane", "width", lambda found: found.hot_spot.plane, optional=True),
)  # fmt: skip
"""Outputs of a :class:`fastpin.damage.SpectrumDamage`: those of its hot spot. The plane's normal counts from +x."""


@kept
def worst_damage(result: Any, how: FatigueAssessment) -> Any:
    """Return the largest damage by the first criterion. It is kept while the result lives.

    Raises
    ------
    InputError
        See :meth:`fastpin.Result.assessed_fatigue`.
    """
    with doubts_given():
        return result.assessed_fatigue(how)[0]

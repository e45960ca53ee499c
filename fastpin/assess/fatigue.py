"""The fatigue of a case as its section [fatigue] asks for it: the assessment, its outputs and its text."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from fastpin.assess.asked import assessment_words
from fastpin.assess.kept import kept
from fastpin.assess.outputs import Output
from fastpin.assess.outputs import document as document_of
from fastpin.damage.criteria import criterion_title
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.assessment import DISTANCES, MINER_RULES, SPECTRA, FatigueAssessment
from fastpin.model.case import Case
from fastpin.model.doubts import doubts_given
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.points import BODIES, edge_body, owner_of
from fastpin.model.units import units
from fastpin.states.margins import over_yield_words

if TYPE_CHECKING:  # they import compiled code, and a plan is read without it
    from fastpin.damage import SpectrumDamage, StressReserve
    from fastpin.solver.result import Result

MOST_CYCLES = 3
"""Counted cycles that are printed for each body."""

MOST_LISTED = 100
"""Counted cycles of each body in JSON: those that do the most damage."""

HOW = (
    Output("criterion", "texts", lambda how: list(how.criteria), allowed=LIFE_CONSTANTS),
    Output("over", "text", lambda how: how.over, allowed=SPECTRA),
    Output("method", "text", lambda how: how.method, allowed=DISTANCES),
    Output("small_cycles", "text", lambda how: how.small_cycles, allowed=MINER_RULES),
    Output("knee", "", lambda how: how.knee, optional=True),
    Output("life_asked", "", lambda how: how.life, optional=True),
    Output("reliability", "", lambda how: how.reliability, optional=True),
    Output("confidence", "", lambda how: how.confidence, optional=True),
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
    Output(
        "median_life", "life", lambda found: found.hot_spot.life * 10.0**found.shift,
        "the life that half of the specimens reach", optional=True,
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


class Assessed(NamedTuple):
    """An assessment of fatigue.

    Attributes
    ----------
    how : FatigueAssessment
    found : list of SpectrumDamage
        Bodies by their damage, criterion by criterion.
    reserves : list of StressReserve
        The factors by which all stresses may grow, criterion by criterion, the smallest first.
    reason : str
        Why the fatigue is not known; empty if it is.
    """

    how: FatigueAssessment
    found: list[SpectrumDamage]
    reserves: list[StressReserve]
    reason: str = ""

    @property
    def is_along_edges(self) -> bool:
        """Whether the damage of whole edges is known, not that of some places only."""
        return self.how.method == "edge" and self.how.angles is None


def assess(
    case: Case, result: Result | None, progress: Callable[[float, float], None] | None = None
) -> Assessed | None:
    """Assess the fatigue of a whole result as its case asks for it; None if the case does not."""
    if case.fatigue is None:
        return None
    if result is None or not result.complete:
        return Assessed(case.fatigue, [], [], "the history has not come to its end")

    def half(begin: float) -> Callable[[float, float], None] | None:
        return None if progress is None else lambda done, total: progress(begin + 0.5 * done / total, 1.0)

    try:
        found = result.assessed_fatigue(case.fatigue, half(0.0))
        return Assessed(case.fatigue, found, result.assessed_reserves(case.fatigue, half(0.5)))
    except InputError as error:
        return Assessed(case.fatigue, [], [], str(error))


def assessment_lines(assessed: Assessed, over: Mapping[str, float]) -> list[str]:
    """Return lines of text: how fatigue is assessed, then each body with its hot spot, the largest damage first.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.
    """
    if assessed.reason:
        return [f"fatigue: not known, {assessed.reason}"]
    lines = [
        _line(one, assessed.how) + over_yield_words(over, owner_of(one.problem, one.body)) for one in assessed.found
    ]
    return [f"fatigue over {assessment_words(assessed.how)}", *lines]


def _line(damage: SpectrumDamage, how: FatigueAssessment) -> str:
    spot, counted = damage.hot_spot, damage.cycles
    name = f"fatigue of the {edge_body(damage.problem, damage.body)}, {criterion_title(damage.criterion)}"
    if math.isnan(spot.theta):
        return f"{name}: no damage"
    depth = "" if spot.depth == 0.0 else f", {units(damage.problem)['length'].text(spot.depth, 3)} below the edge"
    failing = damage.failure_probability(how.life)
    parts = [f"median life {spot.life * 10.0**damage.shift:.4g}"] if damage.shift else []
    parts += [] if math.isnan(failing) else [f"{failing:.3g} of the specimens fail within {how.life:.6g} {how.passes}"]
    parts = [
        ", ".join([f"life {spot.life:.4g} {how.passes}", *parts])
        + f", damage {spot.damage:.4g} at {from_bottom(spot.theta):z.2f} deg{depth}",
        f"normal of the plane {math.degrees(spot.plane):z.2f} deg from +x",
    ]
    same: dict[frozenset[float], tuple[float, int, str]] = {}  # repeated states have the load points of the first ones
    for start, stop, times, done in zip(counted.start, counted.stop, counted.times, counted.damage, strict=True):
        share, before, ends = same.get(key := frozenset((start, stop)), (0.0, 0, f"{start:.6g} and {stop:.6g}"))
        same[key] = share + 100.0 * done / spot.damage, before + int(times), ends
    cycles = [
        f"{share:.0f} % by load points {ends}" + (f" ({times:,} times)" if times > 1 else "")
        for share, times, ends in sorted(same.values(), key=lambda each: -each[0])[:MOST_CYCLES]
        if share >= 0.5
    ]
    return f"{name}: {', '.join(parts)}; {', '.join(cycles)}"


def document(assessed: Assessed, over: Mapping[str, float]) -> dict[str, Any]:
    """Return an assessment as a dict: angles in degrees, from the bottom of the hole for places, from +x for planes.

    `over` is that of :func:`assessment_lines`. A body without damage has no angle, depth, plane and life: all None.
    """
    bodies = []
    for one in assessed.found:
        cycles = {name: getattr(one.cycles, name)[:MOST_LISTED].tolist() for name in one.cycles._fields}
        rows = [dict(zip(cycles, row, strict=True)) for row in zip(*cycles.values(), strict=True)]
        over_yield = over.get(owner_of(one.problem, one.body))
        failing = one.failure_probability(assessed.how.life)
        rest = {"failure_probability": None if math.isnan(failing) else failing, "over_yield": over_yield}
        bodies.append(document_of(DAMAGE, one, units(one.problem)) | {"cycles": rows} | rest)
    return document_of(HOW, assessed.how, {}) | {"error": assessed.reason or None, "bodies": bodies}

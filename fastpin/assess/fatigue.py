"""The fatigue of a result, as the section [fatigue] of its case asks for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin import damage
from fastpin.assess import outputs
from fastpin.assess.margins import reserve_margins
from fastpin.damage.spectrum import SpectrumCycles
from fastpin.errors import InputError
from fastpin.model import Case
from fastpin.model.angles import from_bottom
from fastpin.model.assessment import DISTANCES, MINER_RULES, SPECTRA, FatigueAssessment
from fastpin.model.case import BESIDE
from fastpin.model.doubts import doubts_given
from fastpin.model.fatigue import LIFE_CONSTANTS
from fastpin.model.points import (
    BODIES,
    edge_body,
    further_parts,
    has_outline,
    owner_of,
    point_words,
)
from fastpin.model.units import units
from fastpin.states.margins import over_yield_words, part_of

if TYPE_CHECKING:  # it imports compiled code, and a plan is read without it
    from fastpin.solver.result import Result
    from fastpin.storage.held import Held

RULES = {
    "elementary": "elementary Miner's rule",
    "original": "original Miner's rule, no damage below the knee at {} cycles",
    "haibach": "Miner's rule modified by Haibach below the knee at {} cycles",
}
"""Words for the variants of Miner's rule."""


MOST_CYCLES = 3
"""Counted cycles that are printed for each body."""


MOST_LISTED = 100
"""Counted cycles of each body in JSON: those that do the most damage."""


HOW = (
    outputs.Output("criterion", "texts", lambda how: list(how.criteria), allowed=LIFE_CONSTANTS),
    outputs.Output("over", "text", lambda how: how.over, allowed=SPECTRA),
    outputs.Output("method", "text", lambda how: how.method, allowed=DISTANCES),
    outputs.Output("small_cycles", "text", lambda how: how.small_cycles, allowed=MINER_RULES),
    outputs.Output("knee", "", lambda how: how.knee, optional=True),
    outputs.Output("life_asked", "", lambda how: how.life, optional=True),
    outputs.Output("reliability", "", lambda how: how.reliability, optional=True),
    outputs.Output("confidence", "", lambda how: how.confidence, optional=True),
)
"""Outputs of a :class:`fastpin.model.FatigueAssessment`."""


DAMAGE = (
    outputs.Output("criterion", "text", lambda found: found.criterion, allowed=LIFE_CONSTANTS),
    outputs.Output("body", "text", lambda found: found.body, allowed=BODIES),
    outputs.Output("damage", "", lambda found: found.hot_spot.damage),
    outputs.Output(
        "life", "life", lambda found: found.hot_spot.life,
        "spectra, or cycles over the last cycle; null without damage", optional=True,
    ),
    outputs.Output(
        "median_life", "life", lambda found: found.hot_spot.life * 10.0**found.shift,
        "the life that half of the specimens reach", optional=True,
    ),
    outputs.Output("angle", "angle", lambda found: found.hot_spot.theta, optional=True),
    outputs.Output("depth", "length", lambda found: found.hot_spot.depth, optional=True),
    outputs.Output("edge", "text", lambda found: edge_of(found), "edge beyond the hole with the hot spot; or empty"),
    outputs.Output("place", "text", lambda found: _place(found), "the place in words; empty without damage"),
    outputs.Output("plane", "width", lambda found: found.hot_spot.plane, optional=True),
)  # fmt: skip
"""Outputs of a :class:`fastpin.damage.SpectrumDamage`: those of its hot spot. The plane's normal counts from +x."""


@outputs.kept
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
    found: list[damage.SpectrumDamage]
    reserves: list[damage.StressReserve]
    reason: str = ""

    @property
    def along_edges(self) -> list[list[damage.SpectrumDamage]]:
        """The damage along whole edges, by each criterion that has some; none if it is known at some places only."""
        whole = self.found if self.how.method == "edge" and self.how.angles is None else []
        by_criterion = ([one for one in whole if one.criterion == name] for name in self.how.criteria)
        return [each for each in by_criterion if each]


def stretch(progress: outputs.Follow | None, begin: float, end: float) -> outputs.Follow | None:
    """Return the progress of a stretch of the work, which begins and ends at these parts of it."""
    return None if progress is None else lambda done, total: progress(begin + (end - begin) * done / total, 1.0)


def find(case: Case, held: Held | None, progress: outputs.Follow | None = None) -> Assessed | None:
    """Assess the fatigue of a whole result as its case asks for it; None if the case does not."""
    if case.fatigue is None:
        return None
    if held is None or not held.result.complete:
        return Assessed(case.fatigue, [], [], "the history has not come to its end")
    result = held.whole()

    try:
        found = result.assessed_fatigue(case.fatigue, stretch(progress, 0.0, 0.5))
        return Assessed(case.fatigue, found, result.assessed_reserves(case.fatigue, stretch(progress, 0.5, 1.0)))
    except InputError as error:
        return Assessed(case.fatigue, [], [], str(error))


def judged(result: Result, how: FatigueAssessment) -> Assessed:
    """Return the reserves of a whole result, for its margins."""
    return Assessed(how, [], result.assessed_reserves(how))


def lines(assessed: Assessed, over: Mapping[str, float]) -> list[str]:
    """Return lines of text: how fatigue is assessed, then each body with its hot spot, the largest damage first.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.
    """
    if assessed.reason:
        return [f"fatigue: not known, {assessed.reason}"]
    of_bodies = (
        _line(one, assessed.how) + over_yield_words(over, owner_of(one.problem, one.body)) for one in assessed.found
    )
    return [f"fatigue over {assessment_words(assessed.how)}", *of_bodies]


def _line(found: damage.SpectrumDamage, how: FatigueAssessment) -> str:
    spot, counted = found.hot_spot, found.cycles
    name = f"fatigue of the {edge_body(found.problem, found.body)}, {found.criterion.title()}"
    if math.isnan(spot.theta):
        return f"{name}: no damage"
    parts = [f"{life_words(found, how)}, damage {spot.damage:.4g} {_place(found)}"]
    parts += [f"normal of the plane {math.degrees(spot.plane):z.2f} deg from +x"]
    same: dict[frozenset[float], tuple[float, int, str]] = {}  # repeated states have the load points of the first ones
    for start, stop, times, done in zip(counted.start, counted.stop, counted.times, counted.damage, strict=True):
        share, before, ends = same.get(key := frozenset((start, stop)), (0.0, 0, f"{start:.6g} and {stop:.6g}"))
        same[key] = share + 100.0 * done / spot.damage, before + int(times), ends
    cycles = [
        f"{share:.0f} % by load points {ends}" + (f" ({times:,} times)" if times > 1 else "")
        for share, times, ends in sorted(same.values(), key=lambda each: -each[0])[:MOST_CYCLES]
        if share >= 0.5
    ]
    left_out = part_of(found.problem, owner_of(found.problem, found.body)) if has_outline(found.problem) else ""
    return "; ".join([f"{name}: {', '.join(parts)}", ", ".join(cycles), *filter(None, [left_out])])


def life_words(found: damage.SpectrumDamage, how: FatigueAssessment) -> str:
    """Return words for the life at the hot spot, the median life, and the part that fails within the life asked for."""
    parts, failing = [f"life {found.hot_spot.life:.4g} {how.passes}"], found.failure_probability(how.life)
    if found.shift:
        parts.append(f"median life {found.hot_spot.life * 10.0**found.shift:.4g}")
    if not math.isnan(failing):
        parts.append(f"{failing:.3g} of the specimens fail within {how.life:.6g} {how.passes}")
    return ", ".join(parts)


def edge_of(found: damage.SpectrumDamage) -> str:
    """Return the name of the further edge of a plate on which the hot spot lies; "" if it lies on none."""
    (part,) = further_parts(found.problem, found.body, found.hot_spot.theta, found.hot_spot.depth)
    return "" if part is None else str(part.name)


def _place(found: damage.SpectrumDamage) -> str:
    """Return words for the hot spot."""
    spot = found.hot_spot
    return "" if math.isnan(spot.theta) else point_words(found.problem, found.body, spot.theta, spot.depth, 2)


class _Body(NamedTuple):
    """The damage of a body, how it is assessed, and the bodies that yield."""

    found: damage.SpectrumDamage
    how: FatigueAssessment
    over: Mapping[str, float]

    @property
    def cycles(self) -> list[SpectrumCycles]:
        """The counted cycles that do the most damage, one by one."""
        columns = (each[:MOST_LISTED].tolist() for each in self.found.cycles)
        return list(map(SpectrumCycles._make, zip(*columns, strict=True)))


OF_BODY = (
    outputs.Output(
        "cycles", "list",
        words="counted cycles at the hot spot, the largest damage first; start and stop are load points",
        parts=(
            *outputs.numbers("start stop largest"), outputs.Output("times", "whole"),
            *outputs.numbers("parameter damage"),
        ),
    ),
    outputs.Output(
        "failure_probability", of=lambda body: body.found.failure_probability(body.how.life), optional=True
    ),
    outputs.Output(
        "over_yield", of=lambda body: body.over.get(owner_of(body.found.problem, body.found.body)), optional=True
    ),
)  # fmt: skip
"""Further outputs of the damage of a body."""

ANSWER = (*HOW, outputs.Output("error", "text", optional=True))
"""Outputs of an assessment without its bodies."""


def document(assessed: Assessed, over: Mapping[str, float]) -> dict[str, Any]:
    """Return an assessment as a dict: angles in degrees, from the bottom of the hole for places, from +x for planes.

    `over` is that of :func:`lines`. A body without damage has no angle, depth, plane and life: all None.
    """
    bodies = []
    for one in assessed.found:
        body = outputs.document(OF_BODY, _Body(one, assessed.how, over), {})
        bodies.append(outputs.document(DAMAGE, one, units(one.problem)) | body)
    found = outputs.document(HOW, assessed.how, {})
    return found | {"error": assessed.reason or None, "bodies": bodies}


def schema() -> outputs.Schema:
    """Return the JSON schema of :func:`document`."""
    bodies = outputs.list_of(outputs.schema_of((*DAMAGE, *OF_BODY)))
    return outputs.object_of(outputs.properties(ANSWER) | {"bodies": bodies})


QUESTION = outputs.Question(
    words=lambda _, how: f"{', '.join(how.criteria).title()}, over {assessment_words(how)}",
    bar="damage of the spectrum",
    failed="",  # is not needed: the damage holds the reason
    margin_names={"fatigue": "factor on all stresses until the goal is missed"},
    unvaried="changes no run of a sweep",
    keys=BESIDE["fatigue"].keys,
    outcomes={
        **{
            name: (output, worst_damage)
            for name, output in outputs.chosen(DAMAGE, ("life", "median_life", "damage", "angle")).items()
        },
        "failure_probability": (
            outputs.Output("failure_probability", "", lambda part: part),
            lambda result, how: worst_damage(result, how).failure_probability(how.life),
        ),
    },
    find=find,
    judged=judged,
    lines=lines,
    document=document,
    schema=schema,
    margins=lambda assessed: reserve_margins(assessed.reserves, assessed.how),
)
"""The fatigue of [fatigue]. Its outcomes are those of the hot spot with the largest damage of all bodies."""


def assessment_words(how: FatigueAssessment) -> str:
    """Return an assessment of fatigue in words: the spectrum, the rule of small cycles, the places of the stresses."""
    spectrum = "the whole history as a spectrum" if how.over == "history" else "the last cycle"
    rule = RULES[how.small_cycles].format("" if how.knee is None else f"{how.knee:.6g}")
    place = "" if how.method == "edge" else f", stresses by the {how.method} method of critical distances"
    asked = "" if how.life is None else f", for a life of {how.life:.6g} {how.passes}"
    residual = "" if how.residual_stress is None else ", with a residual stress of the plate"
    return f"{spectrum}, {rule}{place}{asked}{how.reliability_words}{residual}"


def fatigue_curve(found: damage.Fatigue | damage.SpectrumDamage) -> outputs.Curve:
    """Return angle, depth, parameter or damage, plane and life of the points, in the order of the angles.

    Angles are in degrees from the bottom of the hole, the planes' normals in degrees from the +x axis. A damage
    belongs to one spectrum, and the life of a damage is a number of spectra.
    """
    if isinstance(found, damage.SpectrumDamage):
        columns, passes = {f"damage by {found.criterion}": found.damage}, "spectra"
    else:
        unit = units(found.problem)[found.kind]
        columns, passes = {f"{found.criterion} [{unit.name}]": unit.factor * found.parameter}, "cycles"
    if found.plane is not None:
        columns["plane [deg]"] = np.degrees(found.plane)
    if found.life is not None:
        columns[f"life [{passes}]"] = found.life
    angles = np.array([from_bottom(angle) for angle in found.theta.ravel().tolist()])
    length = units(found.problem)["length"]
    places = {"angle [deg]": angles, f"depth [{length.name}]": length.factor * found.depth}
    if has_outline(found.problem):
        parts = further_parts(found.problem, found.body, found.theta, found.depth)
        columns = columns | {"edge": np.array(["" if part is None else part.name for part in parts])}
    order = np.argsort(angles, kind="stable")
    return outputs.Curve(
        {"body": found.body}, {name: np.ravel(each)[order] for name, each in (places | columns).items()}
    )

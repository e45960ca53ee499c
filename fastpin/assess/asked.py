"""What a case asks of its result, in words."""

from __future__ import annotations

import math

from fastpin.model.angles import from_bottom
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.crack import CrackGrowth, law_of
from fastpin.model.growth import law_words
from fastpin.model.problem import Problem
from fastpin.model.strength import StrengthAssessment
from fastpin.model.units import units

RULES = {
    "elementary": "elementary Miner's rule",
    "original": "original Miner's rule, no damage below the knee at {} cycles",
    "haibach": "Miner's rule modified by Haibach below the knee at {} cycles",
}
"""Words for the variants of Miner's rule."""


def assessment_words(how: FatigueAssessment) -> str:
    """Return an assessment of fatigue in words: the spectrum, the rule of small cycles, the places of the stresses."""
    spectrum = "the whole history as a spectrum" if how.over == "history" else "the last cycle"
    rule = RULES[how.small_cycles].format("" if how.knee is None else f"{how.knee:.6g}")
    place = "" if how.method == "edge" else f", stresses by the {how.method} method of critical distances"
    asked = "" if how.life is None else f", for a life of {how.life:.6g} {how.passes}"
    residual = "" if how.residual_stress is None else ", with a residual stress of the plate"
    return f"{spectrum}, {rule}{place}{asked}{how.reliability_words}{residual}"


def crack_words(problem: Problem, crack: CrackGrowth) -> str:
    """Lengths, place, direction, law and residual stress of a crack that is to grow."""
    length = units(problem)["length"]
    place = "where it grows fastest" if crack.theta is None else f"at {from_bottom(crack.theta):.4g} deg"
    parts = [f"{length.text(crack.first)} to {length.text(crack.last)}", place]
    parts += [f"{math.degrees(crack.angle):.4g} deg from the radius"] if crack.angle else []
    parts += ["in the plate round the bush"] if crack.body == "seat" else []
    parts += [law_words(law_of(problem, crack))]
    return ", ".join(parts + (["with a residual stress"] if crack.residual_stress is not None else []))


def strength_words(problem: Problem, how: StrengthAssessment) -> str:
    """Criterion of an assessment of strength, and where it is evaluated."""
    length = units(problem)["length"]
    if how.distance is not None:
        return f"{how.criterion} {f'{length.text(how.distance, 3)} from' if how.distance else 'at'} the edge"
    lengths = (f"{length.text(value, 3)} in {name}" for name, value in how.lengths.items())
    return f"{how.criterion} on the characteristic curve of {' and '.join(lengths)}"

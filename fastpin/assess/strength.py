"""The strength of a laminate round the hole: its outputs."""

from __future__ import annotations

from typing import Any, NamedTuple

from fastpin import damage
from fastpin.assess.kept import kept
from fastpin.assess.outputs import Output
from fastpin.damage.hole_strength import JOINT_MODES
from fastpin.damage.laminates import MODES
from fastpin.model.strength import StrengthAssessment
from fastpin.states.quantities import load_point
from fastpin.states.state import State


class WorstState(NamedTuple):
    """How the strength of a laminate is assessed, the worst of some states, and the strength there."""

    how: StrengthAssessment
    state: State
    strength: damage.JointStrength


PLACE = (
    Output("load_point", "", lambda found: load_point(found.state)),
    Output(
        "ratio", "", lambda found: found.strength.least_ratio,
        "factor on the stresses at which the first ply fails; null: no stress", optional=True,
    ),
    Output("angle", "angle", lambda found: found.strength.angle),
    Output("depth", "length", lambda found: float(found.strength.depth[found.strength.least])),
    Output(
        "ply", "whole", lambda found: int(found.strength.ply[found.strength.least]),
        "place in the stack, 0 for the lowest ply",
    ),
    Output("ply_angle", "", lambda found: found.strength.ply_angle),
    Output("ply_mode", "text", lambda found: found.strength.ply_mode, allowed=MODES),
    Output("joint_mode", "text", lambda found: found.strength.joint_mode, allowed=("", *JOINT_MODES)),
)  # fmt: skip
"""Outputs of a state and its strength: the least ratio, and its place."""


@kept
def worst_state(result: Any, how: StrengthAssessment) -> WorstState:
    """Return the worst state of a result and its strength. They are kept while the result lives.

    Raises
    ------
    InputError
        If the strength can't be assessed.
    """
    return WorstState(how, *damage.least_strength(result.states, how))

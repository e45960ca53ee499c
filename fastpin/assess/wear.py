"""A life of wear: its outputs, and those of its damage."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fastpin.assess.kept import kept
from fastpin.assess.outputs import Output, chosen
from fastpin.damage.race import Race
from fastpin.model.doubts import doubts_given
from fastpin.model.points import Body
from fastpin.model.wear import Wear

if TYPE_CHECKING:  # they import compiled code, and a plan is read without it
    from fastpin.damage.worn import WornFatigue
    from fastpin.solver.wear_result import WearResult

COUNTS = (
    Output("cycle", "whole", lambda one: one.cycle),
    Output("next_jump", "whole", lambda one: one.next_jump),
    Output("solved", "whole", lambda one: one.solved),
)
"""Counts of a :class:`fastpin.solver.WornCycle`."""

WORN = (
    Output("depth", "displacement", lambda one: one.depth),
    Output("volume", "work per stress", lambda one: one.volume),
    Output("pin_volume", "work per stress", lambda one: one.volumes[0]),
    Output("plate_volume", "work per stress", lambda one: one.volumes[1]),
    Output("energy_per_cycle", "energy", lambda one: one.energy_per_cycle, short="energy/cycle"),
    Output("dissipation", "energy", lambda one: one.dissipation),
    Output("removed", "energy", lambda one: one.removed),
    Output("largest_pressure", "traction", lambda one: one.largest_pressure, short="largest p"),
)
"""Outputs of a :class:`fastpin.solver.WornCycle`. Dissipation and removed energy are those of all cycles so far."""

PROFILES = (
    Output("pin_depth", "displacement", lambda one: one.pin_depth),
    Output("plate_depth", "displacement", lambda one: one.plate_depth),
    Output("pressure", "traction", lambda one: one.states[-1].pressure),
)
"""Outputs at each node. The pressure is that on the profile at the end of one more cycle."""

WEAR_OUTCOMES = chosen(
    (*WORN, Output("pin_share", "", lambda one: one.pin_share)),
    ("volume", "depth", "pin_share", "energy_per_cycle", "largest_pressure"),
)
"""Outcomes of the last cycle: the last profile, and one cycle on it."""

RACE_OUTCOMES = {
    "life": Output("life", "life", lambda found: found.life),
    "damage": Output("damage", "", lambda found: found.damage[-1].max()),
    "race": Output("race", "class", lambda found: found.race, classes={int(race): race.words for race in Race}),
}
"""Outcomes of a :class:`fastpin.damage.WornFatigue`: cycles until a crack starts, largest sum of damage, who wins."""


def of_wear(quantity: str, wear: Wear, criterion: str, body: Body, result: Any) -> float:
    """Return an outcome of a result that is followed on a profile that wears. Lives are kept while the result lives."""
    if quantity in WEAR_OUTCOMES:
        return WEAR_OUTCOMES[quantity].number(_worn(result, wear)[-1])
    return RACE_OUTCOMES[quantity].number(_worn_fatigue(result, wear, criterion, body))


@kept
def _worn(result: Any, wear: Wear) -> WearResult:
    with doubts_given():
        return result.wear(**wear.given)


@kept
def _worn_fatigue(result: Any, wear: Wear, criterion: str, body: Body) -> WornFatigue:
    return _worn(result, wear).fatigue(criterion, body)

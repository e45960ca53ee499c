"""A life of wear of a joint of several pins: its tables and its JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess import outputs, wear
from fastpin.assess.outputs import NUMBER, Column, Output, list_of, map_of
from fastpin.joints.parts import Joint
from fastpin.model.angles import from_bottom
from fastpin.report.joints import joint_units
from fastpin.wear_lives import JointWearResult, WornCycle, WornJoint


class WornContact(NamedTuple):
    """The wear of a pin in a plate, or of a bush in its plate, after a chosen cycle.

    Attributes
    ----------
    pin, plate : str
        A bush is called "bush of A".
    worn : WornCycle
    thickness : float
        m.
    """

    pin: str
    plate: str
    worn: WornCycle
    thickness: float

    @property
    def volumes(self) -> np.ndarray:
        """Volume worn off the inner and the outer body, m^3."""
        return np.multiply(self.worn.volumes, self.thickness)

    @property
    def energy(self) -> float:
        """Energy dissipated in a cycle, J."""
        return self.worn.energy_per_cycle * self.thickness


def contacts_of(worn: WornJoint) -> list[WornContact]:
    """The wear of each contact of a joint."""
    return [
        WornContact(*names, each, float(each.states[0].problem.thickness or 1.0))
        for names, each in zip(worn.names, worn.contacts, strict=True)
    ]


CONTACT = (
    Output("pin", "text"),
    Output("plate", "text"),
    Output("depth", "displacement", lambda at: at.worn.depth),
    Output("inner_volume", "work per stress", lambda at: at.volumes[0]),
    Output("outer_volume", "work per stress", lambda at: at.volumes[1]),
    Output("energy_per_cycle", "energy", lambda at: at.energy),
    Output("largest_pressure", "traction", lambda at: at.worn.largest_pressure),
    Output("inner_depth", "displacement", lambda at: at.worn.pin_depth, form=list_of(NUMBER)),
    Output("outer_depth", "displacement", lambda at: at.worn.plate_depth, form=list_of(NUMBER)),
    Output("angles", of=lambda at: [from_bottom(each) for each in at.worn.theta.tolist()], form=list_of(NUMBER)),
)
"""Outputs of a :class:`WornContact`. The inner body is the pin, or the bush in its plate."""

WORN = (
    *wear.COUNTS,
    Output("depth", "displacement"),
    Output("volume", "work per stress"),
    Output("energy_per_cycle", "energy", short="energy/cycle"),
    Output("dissipation", "energy"),
    Output("largest_pressure", "traction", short="largest p"),
    Output(
        "shares",
        of=lambda worn: {plate.name: worn.shares(plate.name) for plate in worn.joint.plates},
        form=map_of(map_of({}, "share of each pin"), "by plates"),
    ),
)
"""Outputs of a :class:`WornJoint`."""

KINDS = {"length": "displacement", "volume": "work per stress", "energy": "energy", "stress": "traction"}
"""The kinds of quantity whose units JSON names, by their names there."""

LIFE = (
    Output("complete", "truth"),
    Output(
        "units", form=map_of(outputs.TEXT, "unit of each kind of quantity"),
        of=lambda life: {name: joint_units(life.joint)[kind].name for name, kind in KINDS.items()},
    ),
    Output("law", "text", lambda life: life.wear.law),
    Output("tolerance", of=lambda life: life.wear.tolerance),
    Output("nodes", "whole"),
    Output("statistics", form=map_of(NUMBER, "counters of the solver")),
    Output(
        "cycles", of=lambda life: _cycles(life),
        form=list_of(
            outputs.object_of(outputs.properties(WORN) | {"contacts": list_of(outputs.schema_of(CONTACT))})
        ),
    ),
)  # fmt: skip
"""Outputs of a life of wear of a joint."""


def _cycles(life: JointWearResult) -> list[dict[str, Any]]:
    unit = joint_units(life.joint)
    return [
        outputs.document(WORN, worn, unit)
        | {"contacts": [outputs.document(CONTACT, each, unit) for each in contacts_of(worn)]}
        for worn in life
    ]


def describe(life: JointWearResult) -> str:
    """Return the shares and the wear over the life, and the wear of each contact after the last cycle, as text."""
    joint = life.joint
    counts = ((len(joint.pins), "pin"), (len(joint.plates), "plate"))
    parts = [", ".join([*(f"{n} {what}{'s' * (n > 1)}" for n, what in counts), f"{life.nodes} nodes a contact"])]
    if len(life):
        parts += ["", outputs.table(cycle_columns(life)), "", f"after {life[-1].cycle:,} cycles:"]
        parts.append(outputs.table(contact_columns(joint, contacts_of(life[-1]))))
    return "\n".join([*parts, "", reached_line(life)])


def reached_line(life: JointWearResult) -> str:
    """Return a line of text: how many cycles were followed, and how many of them were solved."""
    last = life[-1] if len(life) else None
    done, whole = (last.cycle if last else 0), life.wear.cycles
    followed = f"{whole:,} cycles" if life.complete else f"unfinished: {done:,} of {whole:,} cycles"
    solved = f", {last.solved:,} of them solved" if last else ""
    return f"{followed}{solved}; {wear.DEBRIS}"


def cycle_columns(life: JointWearResult) -> list[Column]:
    """Return the columns of the table of all chosen cycles: wear, and the share of each pin in its first plate."""
    unit = joint_units(life.joint)
    columns: list[Column] = [("cycle", "", [f"{each.cycle:,}" for each in life])]
    columns += _columns(outputs.chosen(WORN, ("depth", "volume", "energy_per_cycle", "largest_pressure")), life, unit)
    for pin in life.joint.pins:
        shares = life.shares(pin.plates[0])[pin.name]
        if not np.isnan(shares).all():
            words = ["-" if np.isnan(share) else f"{100.0 * share:.4g}" for share in shares]
            columns.append((f"share of {pin.name}", "%", words))
    columns.append(("solved", "", [f"{each.solved:,}" for each in life]))
    return columns


def contact_columns(joint: Joint, contacts: Sequence[WornContact]) -> list[Column]:
    """Return the columns of the table of all contacts after a cycle."""
    names = ("depth", "inner_volume", "outer_volume", "energy_per_cycle", "largest_pressure")
    columns: list[Column] = [(name, "", [getattr(each, name) for each in contacts]) for name in ("pin", "plate")]
    return columns + _columns(outputs.chosen(CONTACT, names), contacts, joint_units(joint))


def _columns(shown: Mapping[str, Output], rows: Sequence[Any], unit: Mapping[str, Any]) -> list[Column]:
    """Columns of outputs with a unit."""
    found: list[Column] = []
    for each in shown.values():
        values = [float(each.value(one)) for one in rows]
        factor, label = unit[each.kind].scale(values)
        words = (each.short or each.name).replace("_", " ")
        found.append((words, label, [f"{factor * value:.5g}" for value in values]))
    return found

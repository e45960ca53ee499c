"""The result of a joint as text and JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess import outputs
from fastpin.assess.outputs import NUMBER, TEXT, WHOLE, Column, Output, list_of, map_of, table
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, JointState
from fastpin.model import angles, ties
from fastpin.model.units import Unit, units_of
from fastpin.states.state import State

UNRESOLVED = " (not resolved)"
"""Words beside a value that the nodes do not resolve."""


def describe(result: JointResult) -> str:
    """Return the joint, the forces of its pins at all load points, and what is largest at each pin, as text."""
    joint = result.joint
    orders = ", ".join(dict.fromkeys(f"{order}" for order in result.harmonics))
    head = [
        f"{len(joint.pins)} pins, {len(joint.plates)} plates, {result.nodes} nodes a contact, {orders} harmonics",
        "A loose pin stays in the middle of its holes until it touches. Secondary bending is not modelled.",
    ]
    if result.snaps:
        head.append(f"{result.snaps} times a nearly unloaded pin was released or snapped to a new place.")
    if not len(result):
        return "\n".join(head)
    return "\n".join([*head, "", forces_table(result), "", largest_table(result)])


def forces_table(result: JointResult) -> str:
    """Return the loads, the displacements of plates that move, and the force of each pin on its first plate."""
    joint, states = result.joint, result.states
    unit = joint_units(joint)
    columns: list[Column] = [("load point", "", [str(state.step + 1) for state in states])]
    for name in joint.load_names:
        values = [state.load[name] for state in states]
        if any(values):
            columns.append(_column(name, values, unit["traction" if joint.is_stress(name) else "force"]))
    for place, plate in enumerate(joint.plates):
        for k, axis in enumerate("xy"):
            values = [float(state.moved[place, k]) for state in states]
            if axis not in plate.moves and not plate.floats:
                continue
            columns.append(_column(f"u {plate.name}.{axis}", values, unit["displacement"]))
    for pin in joint.pins:
        place = joint.place(pin.name, pin.plates[0])
        values = [float(np.hypot(*state.forces[place])) for state in states]
        columns.append(_column(f"{pin.name} on {pin.plates[0]}", values, unit["force"]))
        shares = [state.shares(pin.plates[0])[pin.name] for state in states]
        if not all(math.isnan(share) for share in shares):
            columns.append(("share", "%", ["-" if math.isnan(share) else f"{100 * share:.3g}" for share in shares]))
    return table(columns)


def largest_table(result: JointResult) -> str:
    """Return what is largest of all states at each pin in each plate."""
    rows = [contact_row(result, place) for place in range(len(result.joint.sections))]
    names = [(pin.name, plate.name) for pin, plate in result.joint.sections]
    columns: list[Column] = [("pin", "", [pin for pin, _ in names]), ("plate", "", [plate for _, plate in names])]
    columns.append(("first contact", "", ["never" if row["touched"] is None else str(row["touched"]) for row in rows]))
    unit = joint_units(result.joint)
    for key, name, kind in (("force", "largest force", "force"), ("pressure", "largest p", "traction")):
        columns.append(_column(name, [row[key] for row in rows], unit[kind]))
    factor, label = unit["traction"].scale([row["hoop"] for row in rows])
    words = [f"{factor * row['hoop']:.5g}{'' if row['resolved'] else UNRESOLVED}" for row in rows]
    columns.append(("largest hoop", label, words))
    columns.append(("at", "deg", [f"{angles.from_bottom(row['hoop_angle']):z.1f}" for row in rows]))
    columns.append(("load point", "", [str(row["hoop_step"]) for row in rows]))
    columns.append(_column("slip", [row["slip"] for row in rows], unit["displacement"]))
    columns.append(_column("dissipated", [row["dissipation"] for row in rows], unit["energy"]))
    return table(columns)


def contact_row(result: JointResult, place: int) -> dict[str, Any]:
    """What is largest of all states at one pin in one plate, SI.

    The slip is the longest path of a node from one load point to the next. Load points count from 1. Of a hole that is
    never touched the hoop stress is that of the loads of the plate.
    """
    pin, plate = result.joint.sections[place]
    contacts = [state.contacts[place] for state in result.states]
    forces = [float(np.hypot(*state.forces[place])) for state in result.states]
    peaks = [contact.peak_hoop_stress("plate") for contact in contacts]
    hoop = ties.top([peak.value for peak in peaks])
    touched = result.first_touches[pin.name, plate.name]
    return {
        "pin": pin.name,
        "plate": plate.name,
        "touched": None if touched < 0 else touched + 1,
        "force": max(forces),
        "pressure": max(_pressure(contact) for contact in contacts),
        "hoop": peaks[hoop].value,
        "hoop_angle": peaks[hoop].angle,
        "hoop_step": hoop + 1,
        "resolved": peaks[hoop].resolved,
        "slip": max(float(np.max(contact.slip_distance)) for contact in contacts),  # type: ignore[arg-type]
        "dissipation": contacts[-1].dissipation * plate.thickness,
    }


def _pressure(contact: State) -> float:
    return float(contact.peak_pressure) if contact.in_contact else 0.0


def joint_units(joint: Joint) -> Mapping[str, Unit]:
    """Return the unit of every kind of quantity in the printed texts of a joint; values are of whole plates."""
    return units_of(joint.unit_system, True)


def _column(name: str, values: list[float], unit: Unit) -> Column:
    factor, label = unit.scale(values)
    largest = max(map(abs, values), default=0.0)
    return name, label, [f"{factor * value:.5g}" if abs(value) > 1e-9 * largest else "0" for value in values]


class JointContact(NamedTuple):
    """A pin in a plate at a load point: a place among the sections of a joint."""

    state: JointState
    place: int

    @property
    def pin(self) -> JointPin:
        """The pin."""
        return self.state.joint.sections[self.place][0]

    @property
    def plate(self) -> JointPlate:
        """The plate."""
        return self.state.joint.sections[self.place][1]

    @property
    def contact(self) -> State:
        """The state of the contact."""
        return self.state.contacts[self.place]


def _loads(state: JointState) -> dict[str, float]:
    """Loads in printed units."""
    unit, joint = joint_units(state.joint), state.joint
    kinds = {name: "traction" if joint.is_stress(name) else "force" for name in state.load}
    return {name: unit[kinds[name]].factor * value for name, value in state.load.items()}


def _moved(state: JointState) -> dict[str, list[float]]:
    """Displacement in printed units and rotation of each plate."""
    factor = joint_units(state.joint)["displacement"].factor
    moved = (state.moved * [factor, factor, 1.0]).tolist()
    return dict(zip((plate.name for plate in state.joint.plates), moved, strict=True))


KINDS = {
    "force": "force", "moment": "moment", "stress": "traction", "length": "displacement", "energy": "energy",
    "angle": "rotation",
}  # fmt: skip
"""The kinds of quantity whose units JSON names, by their names there."""

CONTACT = (
    Output("pin", "text", lambda at: at.pin.name),
    Output("plate", "text", lambda at: at.plate.name),
    Output(
        "force", form=list_of(NUMBER, 2),
        of=lambda at: joint_units(at.state.joint)["force"].factor * at.state.forces[at.place],
    ),
    Output("moment", "moment", lambda at: at.state.moments[at.place]),
    Output("share", of=lambda at: at.state.shares(at.plate.name)[at.pin.name], optional=True),
    Output("peak_pressure", "traction", lambda at: _pressure(at.contact)),
    Output(
        "peak_hoop_stress", of=lambda at: at.contact.peak_hoop_stress("plate"),
        parts=(Output("value", "traction"), Output("angle"), Output("resolved", "truth")),
    ),
    Output("dissipation", "energy", lambda at: at.contact.dissipation * at.plate.thickness),
    Output("slip", "displacement", lambda at: np.max(at.contact.slip_distance)),
)  # fmt: skip
"""Outputs of a :class:`JointContact`."""

LARGEST = (
    Output("pin", "text"),
    Output("plate", "text"),
    Output("touched", "whole", optional=True),
    Output("force", "force"),
    *outputs.numbers("pressure hoop", "traction"),
    Output("hoop_angle"),
    Output("hoop_step", "whole"),
    Output("resolved", "truth"),
    Output("slip", "displacement"),
    Output("dissipation", "energy"),
)
"""Outputs of a :func:`contact_row`."""

JOINT_STATE = (
    Output("load_point", "whole", lambda state: state.step + 1),
    Output("loads", of=_loads, form=map_of(NUMBER, "forces and stresses")),
    Output(
        "moved", form=map_of(list_of(NUMBER, 3), "displacement along x and y, and rotation"), of=_moved,
    ),
    Output(
        "contacts", "list", lambda state: [JointContact(state, place) for place in range(len(state.contacts))],
        parts=CONTACT,
    ),
    Output("residuals", form=map_of(NUMBER, "violations of the conditions of contact and equilibrium")),
)  # fmt: skip
"""Outputs of a state of a joint."""

JOINT = (
    Output(
        "units", form=map_of(TEXT, "unit of each kind of quantity"),
        of=lambda result: {name: joint_units(result.joint)[kind].name for name, kind in KINDS.items()},
    ),
    Output("nodes", "whole"),
    Output(
        "harmonics", form=map_of(WHOLE, "highest harmonic of the holes of each plate"),
        of=lambda result: dict(zip((each.name for each in result.joint.plates), result.harmonics, strict=True)),
    ),
    Output("snaps", "whole"),
    Output("seconds"),
    Output(
        "largest", "list",
        lambda result: [contact_row(result, place) for place in range(len(result.joint.sections) * bool(len(result)))],
        parts=LARGEST,
    ),
    Output("states", "list", parts=JOINT_STATE),
)  # fmt: skip
"""Outputs of the result of a joint."""

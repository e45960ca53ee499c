"""The result of a joint as text and JSON."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fastpin.assess import outputs
from fastpin.assess.outputs import Column, json_ready, table
from fastpin.joints import JointResult, JointState
from fastpin.model import angles, ties
from fastpin.model.units import scaled
from fastpin.states.state import State
from fastpin.version import __version__

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
    columns: list[Column] = [("load point", "", [str(state.step + 1) for state in states])]
    for name in joint.load_names:
        values = [state.load[name] for state in states]
        if any(values):
            columns.append(_column(name, values, "Pa" if joint.is_stress(name) else "N"))
    for place, plate in enumerate(joint.plates):
        for k, axis in enumerate("xy"):
            values = [float(state.moved[place, k]) for state in states]
            if axis not in plate.moves and not plate.floats:
                continue
            columns.append(_column(f"u {plate.name}.{axis}", values, "m"))
    for pin in joint.pins:
        place = joint.place(pin.name, pin.plates[0])
        values = [float(np.hypot(*state.forces[place])) for state in states]
        columns.append(_column(f"{pin.name} on {pin.plates[0]}", values, "N"))
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
    for key, name, unit in (("force", "largest force", "N"), ("pressure", "largest p", "Pa")):
        columns.append(_column(name, [row[key] for row in rows], unit))
    factor, label = scaled([row["hoop"] for row in rows], "Pa")
    words = [f"{factor * row['hoop']:.5g}{'' if row['resolved'] else UNRESOLVED}" for row in rows]
    columns.append(("largest hoop", label, words))
    columns.append(("at", "deg", [f"{angles.from_bottom(row['hoop_angle']):z.1f}" for row in rows]))
    columns.append(("load point", "", [str(row["hoop_step"]) for row in rows]))
    columns.append(_column("slip", [row["slip"] for row in rows], "m"))
    columns.append(_column("dissipated", [row["dissipation"] for row in rows], "J"))
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


def _column(name: str, values: list[float], unit: str) -> Column:
    factor, label = scaled(values, unit)
    largest = max(map(abs, values), default=0.0)
    return name, label, [f"{factor * value:.5g}" if abs(value) > 1e-9 * largest else "0" for value in values]


def document(result: JointResult, title: str = "") -> dict[str, Any]:
    """Return a result as a JSON-ready document, SI. Numbers that mean nothing are null."""
    joint = result.joint
    return dict(
        json_ready(
            {
                "fastpin": __version__,
                "title": title,
                "units": {"force": "N", "stress": "Pa", "length": "m", "energy": "J", "angle": "rad"},
                "nodes": result.nodes,
                "harmonics": {plate.name: order for plate, order in zip(joint.plates, result.harmonics, strict=True)},
                "snaps": result.snaps,
                "seconds": result.seconds,
                "largest": [contact_row(result, place) for place in range(len(joint.sections))] if len(result) else [],
                "states": [_state_document(state) for state in result.states],
            }
        )
    )


def _state_document(state: JointState) -> dict[str, Any]:
    joint = state.joint
    contacts = []
    for place, (pin, plate) in enumerate(joint.sections):
        contact = state.contacts[place]
        peak = contact.peak_hoop_stress("plate")
        contacts.append(
            {
                "pin": pin.name,
                "plate": plate.name,
                "force": state.forces[place].tolist(),
                "moment": float(state.moments[place]),
                "share": state.shares(plate.name)[pin.name],
                "peak_pressure": _pressure(contact),
                "peak_hoop_stress": {"value": peak.value, "angle": peak.angle, "resolved": peak.resolved},
                "dissipation": contact.dissipation * plate.thickness,
                "slip": float(np.max(contact.slip_distance)),  # type: ignore[arg-type]
            }
        )
    moved = {plate.name: by.tolist() for plate, by in zip(joint.plates, state.moved, strict=True)}
    found = {"load_point": state.step + 1, "loads": state.load, "moved": moved, "contacts": contacts}
    return found | {"residuals": state.residuals}


def schema() -> outputs.Schema:
    """Return the JSON schema of :func:`document`."""
    peak = outputs.object_of({"value": outputs.NUMBER, "angle": outputs.NUMBER, "resolved": outputs.TRUTH})
    where = {"pin": outputs.TEXT, "plate": outputs.TEXT}
    numbers = dict.fromkeys(("moment", "peak_pressure", "dissipation", "slip"), outputs.NUMBER)
    contact = where | numbers | {"force": outputs.list_of(outputs.NUMBER, 2), "share": outputs.UNKNOWN}
    largest = dict.fromkeys(("force", "pressure", "hoop", "hoop_angle", "slip", "dissipation"), outputs.NUMBER)
    largest |= where | {
        "touched": outputs.or_null(outputs.WHOLE),
        "hoop_step": outputs.WHOLE,
        "resolved": outputs.TRUTH,
    }
    state = {
        "load_point": outputs.WHOLE,
        "loads": outputs.map_of(outputs.NUMBER, "forces, N, and stresses, Pa"),
        "moved": outputs.map_of(outputs.list_of(outputs.NUMBER, 3), "displacement along x, y, m, and rotation, rad"),
        "contacts": outputs.list_of(outputs.object_of(contact | {"peak_hoop_stress": peak})),
        "residuals": outputs.map_of(outputs.NUMBER, "violations of the conditions of contact and equilibrium"),
    }
    return outputs.object_of(
        {
            "fastpin": outputs.TEXT,
            "title": outputs.TEXT,
            "units": outputs.map_of(outputs.TEXT, "unit of each kind of quantity"),
            "nodes": outputs.WHOLE,
            "harmonics": outputs.map_of(outputs.WHOLE, "highest harmonic of the holes of each plate"),
            "snaps": outputs.WHOLE,
            "seconds": outputs.NUMBER,
            "largest": outputs.list_of(outputs.object_of(largest)),
            "states": outputs.list_of(outputs.object_of(state)),
        }
    )

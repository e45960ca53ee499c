"""The result of a joint as text and JSON."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sized
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess import crack, fatigue, outputs
from fastpin.assess.outputs import PERCENT, Column, Output, number_column, table
from fastpin.cracks import Growth
from fastpin.errors import InputError
from fastpin.joints import (
    Joint,
    JointPin,
    JointResult,
    JointState,
    SectionCrack,
    SectionDamage,
    SectionMargin,
)
from fastpin.joints.pins import BEAM, whole_name
from fastpin.joints.result import JointInterface, interfaces_of
from fastpin.model import ties
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.doubts import doubts_given
from fastpin.model.points import owner_of, point_words
from fastpin.model.units import Unit, units_of
from fastpin.states.margins import over_yield, over_yield_words
from fastpin.states.quantities import point_name
from fastpin.states.state import State

MOST_LISTED = 20
"""Most margins, and most lives, that are printed."""

SLIGHT = 1e-4
"""Friction across the load that is not printed, in parts of the limit: a path may keep as much of it by chance."""

ROUNDED = 1e-12
"""Displacement of a plate that is printed as 0, in hole radii."""

UNRESOLVED = " (not resolved)"
"""Words beside a value that the nodes do not resolve."""


NAMES = (Output("pin", "text"), Output("plate", "text"))
"""Outputs of something where a pin goes through a plate."""

LARGEST = (
    *NAMES,
    Output("touched", "whole", optional=True, short="first contact", unknown="never"),
    Output("force", "force", short="largest force"),
    Output("pressure", "traction", short="largest p"),
    Output("hoop", "traction", short="largest hoop"),
    Output("hoop_angle", optional=True),
    Output("hoop_step", "whole", short="load point"),
    Output("resolved", "truth"),
    Output("slip", "displacement"),
    Output("dissipation", "energy", short="dissipated"),
)
"""Outputs of a :func:`contact_row`."""

FAYING = (
    Output("pin", "text"),
    Output("plates", form=outputs.list_of(outputs.TEXT, 2)),
    Output("force", "force", short="largest friction"),
    Output("used", "share", short="of the limit", digits=".4g"),
    Output("step", "whole", short="load point"),
    Output("slip", "displacement"),
    Output("dissipation", "energy", short="dissipated"),
)
"""Outputs of a row of :func:`faying_rows`."""

BENDING = (
    Output("pin", "text"),
    Output("moment", "moment", short="largest moment"),
    Output("stress", "traction", short="bending stress"),
    Output("place", "length", short="from its end"),
    Output("step", "whole", short="load point"),
)
"""Outputs of a row of :func:`bending_rows`."""


class Judged(NamedTuple):
    """The result of a joint, the margins of its strengths, its fatigue, and its crack.

    Attributes
    ----------
    result : JointResult
    is_complete : bool
        Whether the history has come to its end.
    margins : list of SectionMargin
    how : FatigueAssessment or None
    damages : list of SectionDamage
        Empty unless the fatigue is assessed.
    reason : str
        Why the fatigue is not known; empty if it is, or if nobody asked for it.
    crack : SectionCrack or None
    growth : Growth or str
        That of the crack, or why it is not known; empty if nobody asked for it.
    """

    result: JointResult
    is_complete: bool
    margins: list[SectionMargin]
    how: FatigueAssessment | None
    damages: list[SectionDamage]
    reason: str
    crack: SectionCrack | None
    growth: Growth | str

    @property
    def over(self) -> dict[tuple[str, str], dict[str, float]]:
        """The bodies that yield at each pin in each plate, see :func:`fastpin.states.margins.over_yield`."""
        at = defaultdict(list)
        for pin, plate, margin in self.margins:
            at[pin, plate].append(margin)
        return {names: over_yield(rows) for names, rows in at.items()}


def judged(
    result: JointResult,
    how: FatigueAssessment | None = None,
    is_complete: bool = True,
    progress: outputs.Follow | None = None,
    crack: SectionCrack | None = None,
) -> Judged:
    """Find the margins of the strengths of a result; if the history is complete its fatigue and crack, if asked for."""
    known = result.margins(fatigue.stretch(progress, 0.0, 0.4))
    unknown = "" if is_complete else "the history has not come to its end"
    found = Judged(result, is_complete, known, how, [], unknown, crack, unknown)
    if how is not None and is_complete:
        try:
            found = found._replace(damages=result.assessed_fatigue(how, fatigue.stretch(progress, 0.4, 0.8)))
        except InputError as error:
            found = found._replace(reason=str(error))
    if crack is not None and is_complete:
        try:
            with doubts_given():
                found = found._replace(growth=result.crack_growth(crack, fatigue.stretch(progress, 0.8, 1.0)))
        except InputError as error:
            found = found._replace(growth=str(error))
    return found


def describe(judged: Judged) -> str:
    """Return the joint, the forces of its pins at all load points, and what is largest at each pin, as text.

    Margins of known strengths and the fatigue follow.
    """
    result = judged.result
    joint = result.joint
    orders = ", ".join(dict.fromkeys(f"{order}" for order in result.harmonics))
    head = [
        f"{_counted(joint.pins, 'pin')}, {_counted(joint.plates, 'plate')}, {result.nodes} nodes a contact, "
        f"{orders} harmonics",
        *remarks(judged),
    ]
    if not len(result):
        return "\n".join(head)
    tables = [forces_columns(result), largest_columns(joint, contact_rows(result))]
    if joint.faying:
        tables.append(faying_columns(result))
    if bent := bending_rows(result):
        tables.append(bending_columns(joint, bent))
    parts = [*head, *(line for columns in tables for line in ("", table(columns)))]
    return "\n".join([*parts, *margin_lines(judged), *fatigue_lines(judged), *crack_lines(judged)])


def remarks(judged: Judged) -> list[str]:
    """Return sentences on what is assumed, and on how numbers are to be read."""
    result = judged.result
    found = ["A loose pin stays in the middle of its holes until it touches. Secondary bending is not modelled."]
    if result.snaps:
        found.append(f"{result.snaps} times a nearly unloaded pin was released or snapped to a new place.")
    if not judged.is_complete:
        found.append(f"The history has not come to its end: {_counted(result, 'load point')} of it.")
    if len(result) and any(min(pin_forces(result, pin)) < 0.0 for pin in result.joint.pins):
        found.append("The force of a pin is negative where it points against its largest one.")
    if len(result) and any(plate.slices > 1 for plate in result.joint.plates):
        found.append("That on a slice is negative where it points against the force on the whole plate.")
    return found


def forces_columns(result: JointResult) -> list[Column]:
    """Return the loads, the displacements of plates that move, and the force of each pin on its first plate.

    The force has a sign, see :func:`pin_forces`. The friction of each faying surface follows, with its sign: the force
    on the first one of both plates.
    """
    joint, states = result.joint, result.states.bare
    unit = joint_units(joint)
    columns: list[Column] = [("load point", "", [str(state.step + 1) for state in states])]
    for name in joint.load_names:
        values = [state.load[name] for state in states]
        if any(values):
            columns.append(number_column(name, values, unit[joint.load_kind(name)]))
    for place, plate in enumerate(joint.plates):
        for k, axis in enumerate("xy"):
            values = [float(moved_by(state, place)[k]) for state in states]
            if axis not in plate.moves and not plate.floats:
                continue
            columns.append(number_column(f"u {plate.name}.{axis}", values, unit["displacement"]))
    for pin in joint.pins:
        values = pin_forces(result, pin)
        columns.append(number_column(f"{pin.name} on {pin.plates[0]}", values, unit["force"]))
        shares = [state.shares(pin.plates[0])[pin.name] for state in states]
        if not all(math.isnan(share) for share in shares):
            columns.append(number_column("share", shares, PERCENT, ".3g"))
    for place, surface in enumerate(joint.faying):
        for k, axis in enumerate("xy"):
            values = [float(state.faying[place].force[k]) for state in states]
            if max(map(abs, values)) > SLIGHT * surface.clamp.limit:
                columns.append(number_column(f"friction {surface}.{axis}", values, unit["force"]))
    return columns


def largest_columns(joint: Joint, rows: list[dict[str, Any]]) -> list[Column]:
    """Return what is largest of all states at each pin in each plate, from the :func:`contact_row` of each."""
    unit = joint_units(joint)
    shown = [
        each._replace(kind="angle", short="at", digits="z.1f") if each.name == "hoop_angle" else each
        for each in LARGEST
        if each.name != "resolved"
    ]
    columns = {each.name: each.cells(rows, unit) for each in shown}
    name, label, cells = columns["hoop"]
    marks = ["" if row["resolved"] else UNRESOLVED for row in rows]
    return [*(columns | {"hoop": (name, label, [a + b for a, b in zip(cells, marks, strict=True)])}).values()]


def faying_columns(result: JointResult) -> list[Column]:
    """Return what is largest of all states at each faying surface of clamped plates."""
    rows, unit = faying_rows(result), joint_units(result.joint)
    pin, *others = (each.cells(rows, unit) for each in FAYING if each.name != "plates")
    return [pin, ("faying surface", "", ["-".join(row["plates"]) for row in rows]), *others]


def bending_columns(joint: Joint, rows: list[dict[str, Any]]) -> list[Column]:
    """Return the largest bending of each pin that is a beam."""
    return [each.cells(rows, joint_units(joint)) for each in BENDING]


def bending_rows(result: JointResult) -> list[dict[str, Any]]:
    """The largest bending moment of all states in each pin that is a beam, SI, and its stress at the pin's surface.

    The place counts along the pin from its end in its first plate. The pin has the radius of the hole.
    """
    rows = []
    for pin in (pin for pin in result.joint.pins if pin.flexibility == BEAM and len(result)):
        found = [state.bending(pin.name) for state in result.states.bare]
        sizes = np.array([np.hypot(*moments.T) for _, moments in found])
        step, at = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        moment = float(sizes[step, at])
        stress = moment * pin.radius / pin.bar.second_moment
        place = float(found[step][0][at])
        rows.append({"pin": pin.name, "moment": moment, "stress": stress, "place": place, "step": int(step) + 1})
    return rows


def margin_lines(judged: Judged) -> list[str]:
    """Return a table of the known margins, the smallest first; no line if none is known."""
    cells = margin_cells(judged)
    head = "margins of safety over all load points, allowable/value - 1, near the holes and in the pins:"
    left = _left_out(len(cells), "larger margins")
    return ["", head, *outputs.aligned(cells[:MOST_LISTED], "lrrl"), *left] if cells else []


def margin_cells(judged: Judged) -> list[tuple[str, str, str, str]]:
    """Return the known margins, the smallest first: subject, value and allowable, margin, place."""
    unit = joint_units(judged.result.joint)["traction"]
    return [
        (
            f"{pin} in {plate}, {row.subject}", f"{unit.text(row.value, 4)} of {unit.text(row.allowable, 4)}",
            f"{row.margin:+.2f}", f"load point {point_name(row.load_point)}, {row.remark}",
        )
        for pin, plate, row in judged.margins
        if math.isfinite(row.margin)
    ]  # fmt: skip


def fatigue_lines(judged: Judged) -> list[str]:
    """Return a table of the damage at all pins, the largest first; no line unless the fatigue was asked for."""
    how = judged.how
    if how is None:
        return []
    if judged.reason:
        return ["", f"fatigue: not known, {judged.reason}"]
    cells = fatigue_cells(judged, how)
    head = f"fatigue over {fatigue.assessment_words(how)}, with the stresses at the load points:"
    left = _left_out(len(cells), "longer lives")
    return ["", head, *outputs.aligned(cells[:MOST_LISTED], "lrrl"), *left]


def fatigue_cells(judged: Judged, how: FatigueAssessment) -> list[tuple[str, str, str, str]]:
    """Return the damages, the largest first: pin, plate and criterion, life, damage, place."""
    over, cells = judged.over, []
    for pin, plate, found in judged.damages:
        spot, owner = found.hot_spot, owner_of(found.problem, found.body)
        name = f"{pin} in {plate}, {'hole' if found.body == 'plate' else owner}, {found.criterion.title()}"
        if math.isnan(spot.theta):
            cells.append((name, "no damage", "", ""))
            continue
        where = point_words(found.problem, found.body, spot.theta, spot.depth, 2)
        mark = over_yield_words(over.get((pin, plate), {}), owner)
        cells.append((name, fatigue.life_words(found, how), f"damage {spot.damage:.4g}", where + mark))
    return cells


def crack_lines(judged: Judged) -> list[str]:
    """Return what becomes of the crack as lines of text; no line unless it was asked for."""
    if judged.crack is None:
        return []
    at = f"{judged.crack.pin} in {judged.crack.plate}"
    if not isinstance(judged.growth, Growth):
        return ["", f"{at}, crack: not known, {judged.growth}"]
    over = judged.over.get((judged.crack.pin, judged.crack.plate))
    return ["", f"{at}, {crack.growth_line(judged.growth, over)}"]


def pin_forces(result: JointResult, pin: JointPin) -> list[float]:
    """Size of the force of a pin on its first plate at all load points, N; negative against the largest one."""
    forces = _forces(result, pin.name, pin.plates[0])
    return _signed(forces, forces[ties.top(np.hypot(*forces.T).tolist())])


def _forces(result: JointResult, pin: str, plate: str) -> np.ndarray:
    """Force of a pin on a plate with all its slices, or on one slice, at all states, N, shape (states, 2)."""
    return np.array([state.forces for state in result.states.bare])[:, result.joint.places(pin, plate)].sum(axis=1)


def _signed(forces: np.ndarray, along: np.ndarray) -> list[float]:
    """Sizes of forces (states, 2), negative where they point against `along`."""
    return [float(size) for size in np.where((forces * along).sum(axis=1) < 0.0, -1.0, 1.0) * np.hypot(*forces.T)]


def moved_by(state: JointState, place: int) -> np.ndarray:
    """Displacement of a plate along x and y, m, shape (2,). Rounding is 0."""
    moved = state.moved[place, :2]
    return np.where(np.abs(moved) < ROUNDED * state.joint.radius, 0.0, moved)


def _counted(items: Sized, name: str) -> str:
    return f"{len(items)} {name}{'s' * (len(items) != 1)}"


def _left_out(count: int, words: str) -> list[str]:
    return [f"  ... {count - MOST_LISTED} with {words} ..."] if count > MOST_LISTED else []


def contact_rows(result: JointResult) -> list[dict[str, Any]]:
    """The rows of all interfaces; none without a state."""
    return [contact_row(result, each) for each in interfaces_of(result.joint) if len(result)]


def contact_row(result: JointResult, at: JointInterface) -> dict[str, Any]:
    """What is largest of all states at one pin in one plate, or at its bush in this plate, SI.

    The slip is the longest path of a node from one load point to the next. Load points count from 1. Of a hole that is
    never touched the hoop stress is that of the loads of the plate. The force is negative where that on a slice points
    against the force on the whole plate.
    """
    pin, plate = result.joint.sections[at.place]
    forces = _signed(*(_forces(result, pin.name, name) for name in (plate.name, whole_name(plate.name))))
    peaks, pressures, slips, touched, lost = [], [], [], None, 0.0
    for contact in map(at.of, result.states.section(at.place)):
        peaks.append(contact.peak_hoop_stress("plate"))
        pressures.append(largest_pressure(contact))
        slips.append(float(np.max(contact.slip_distance)))  # type: ignore[arg-type]
        touched = contact.step + 1 if touched is None and contact.in_contact else touched
        lost = contact.dissipation * plate.thickness
    hoop = ties.top([peak.value for peak in peaks])
    return {
        "pin": at.pin,
        "plate": at.plate,
        "touched": touched,
        "force": max(forces, key=abs),
        "pressure": max(pressures),
        "hoop": peaks[hoop].value,
        "hoop_angle": peaks[hoop].angle,
        "hoop_step": hoop + 1,
        "resolved": peaks[hoop].resolved,
        "slip": max(slips),
        "dissipation": lost,
    }


def faying_rows(result: JointResult) -> list[dict[str, Any]]:
    """What is largest of all states at each faying surface, SI; none without a state. Load points count from 1.

    The friction in parts of its limit is 1 where the surface slips, and up to 1.02 between the sides of its polygon.
    """
    rows, states = [], result.states.bare
    for place, surface in enumerate(result.joint.faying if states else ()):
        forces = [float(np.hypot(*state.faying[place].force)) for state in states]
        top = ties.top(forces)
        rows.append({
            "pin": surface.pin,
            "plates": [surface.plate, surface.other],
            "force": forces[top],
            "used": forces[top] / surface.clamp.limit,
            "step": top + 1,
            "slip": max(float(np.hypot(*state.faying[place].slip)) for state in states),
            "dissipation": states[-1].faying[place].dissipation,
        })  # fmt: skip
    return rows


def largest_pressure(contact: State) -> float:
    """The peak pressure of a contact, Pa; 0 without contact."""
    return float(contact.peak_pressure) if contact.in_contact else 0.0


def joint_units(joint: Joint) -> Mapping[str, Unit]:
    """Return the unit of every kind of quantity in the printed texts of a joint; values are of whole plates."""
    return units_of(joint.unit_system, True)

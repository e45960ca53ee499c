"""The result of a joint as JSON."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastpin.assess import crack, fatigue, margins, outputs
from fastpin.assess.outputs import NUMBER, TEXT, WHOLE, Output, list_of, map_of, schema_of
from fastpin.cracks import Growth
from fastpin.joints import JointPin, JointPlate, JointState
from fastpin.joints.result import JointInterface, interfaces_of
from fastpin.model.points import owner_of
from fastpin.model.units import units
from fastpin.report.joints import (
    BENDING,
    FAYING,
    LARGEST,
    NAMES,
    Judged,
    bending_rows,
    contact_rows,
    faying_rows,
    joint_units,
    largest_pressure,
)
from fastpin.states.margins import smallest_margin
from fastpin.states.state import State


class JointContact(NamedTuple):
    """A pin in a plate at a load point, or its bush."""

    state: JointState
    at: JointInterface

    @property
    def pin(self) -> JointPin:
        """The pin."""
        return self.state.joint.sections[self.at.place][0]

    @property
    def plate(self) -> JointPlate:
        """The plate."""
        return self.state.joint.sections[self.at.place][1]

    @property
    def contact(self) -> State:
        """The state of the contact."""
        return self.at.of(self.state.contacts[self.at.place])


def _loads(state: JointState) -> dict[str, float]:
    """Loads in printed units."""
    unit, joint = joint_units(state.joint), state.joint
    return {name: unit[joint.load_kind(name)].factor * value for name, value in state.load.items()}


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
    Output("pin", "text", lambda contact: contact.at.pin),
    Output("plate", "text", lambda at: at.plate.name),
    Output(
        "force", form=list_of(NUMBER, 2),
        of=lambda contact: joint_units(contact.state.joint)["force"].factor * contact.state.forces[contact.at.place],
    ),
    Output("moment", "moment", lambda contact: contact.contact.load["M"] * contact.plate.thickness),
    Output("share", of=lambda at: at.state.shares(at.plate.name)[at.pin.name], optional=True),
    Output("peak_pressure", "traction", lambda at: largest_pressure(at.contact)),
    Output(
        "peak_hoop_stress", of=lambda at: at.contact.peak_hoop_stress("plate"),
        parts=(Output("value", "traction"), Output("angle", optional=True), Output("resolved", "truth")),
    ),
    Output("dissipation", "energy", lambda at: at.contact.dissipation * at.plate.thickness),
    Output("slip", "displacement", lambda at: np.max(at.contact.slip_distance)),
)  # fmt: skip
"""Outputs of a :class:`JointContact`."""


def _rubbed(state: JointState) -> list[dict[str, Any]]:
    """The faying surfaces of a state: force and slip in printed units, energy in J."""
    unit = joint_units(state.joint)
    return [
        {
            "pin": surface.pin,
            "plates": [surface.plate, surface.other],
            "force": unit["force"].factor * at.force,
            "slip": unit["displacement"].factor * at.slip,
            "dissipation": at.dissipation,
        }
        for surface, at in zip(state.joint.faying, state.faying, strict=True)
    ]


JOINT_STATE = (
    Output("load_point", "whole", lambda state: state.step + 1),
    Output("loads", of=_loads, form=map_of(NUMBER, "forces and stresses")),
    Output(
        "moved", form=map_of(list_of(NUMBER, 3), "displacement along x and y, and rotation"), of=_moved,
    ),
    Output(
        "contacts", "list", lambda state: [JointContact(state, each) for each in interfaces_of(state.joint)],
        parts=CONTACT,
    ),
    Output(
        "faying", "list", _rubbed,
        parts=(
            *FAYING[:2],  # the names
            *(Output(name, form=list_of(NUMBER, 2)) for name in ("force", "slip")), Output("dissipation", "energy"),
        ),
    ),
    Output("residuals", form=map_of(NUMBER, "violations of the conditions of contact and equilibrium")),
)  # fmt: skip
"""Outputs of a state of a joint."""


def _margins(judged: Judged) -> list[dict[str, Any]]:
    """The margins, the smallest first."""
    rows = [each.margin for each in judged.margins]
    joint, states = judged.result.joint, judged.result.states
    problems = [states.section(joint.place(each.pin, each.plate)).problem for each in judged.margins]
    found = []
    for at, problem in zip(judged.margins, problems, strict=True):
        unit, is_least = units(problem)[at.margin.kind], at.margin is smallest_margin(rows)
        row = margins.MarginRow(at.margin, problem, unit, is_least, None)
        found.append(outputs.document(NAMES, at, {}) | outputs.document(margins.ROW, row, {}))
    return found


def _bodies(judged: Judged) -> list[dict[str, Any]]:
    """The damage of plates and pins, the largest first."""
    found = []
    for at in judged.damages:
        over = judged.over[at.pin, at.plate].get(owner_of(at.found.problem, at.found.body))
        body = outputs.document(fatigue.DAMAGE, at.found, units(at.found.problem))
        found.append(outputs.document(NAMES, at, {}) | body | {"over_yield": over})
    return found


JOINT = (
    Output(
        "units", form=map_of(TEXT, "unit of each kind of quantity"),
        of=lambda judged: {name: joint_units(judged.result.joint)[kind].name for name, kind in KINDS.items()},
    ),
    Output("nodes", "whole", lambda judged: judged.result.nodes),
    Output(
        "harmonics", form=map_of(WHOLE, "highest harmonic of the holes of each plate"),
        of=lambda judged: dict(
            zip((each.name for each in judged.result.joint.plates), judged.result.harmonics, strict=True)
        ),
    ),
    Output("complete", "truth", lambda judged: judged.is_complete),
    Output("snaps", "whole", lambda judged: judged.result.snaps),
    Output("seconds", of=lambda judged: judged.result.seconds),
    Output("largest", "list", lambda judged: contact_rows(judged.result), parts=LARGEST),
    Output("largest_faying", "list", lambda judged: faying_rows(judged.result), parts=FAYING),
    Output("bending", "list", lambda judged: bending_rows(judged.result), optional=True, parts=BENDING),
    Output("margins", of=_margins, form=list_of(schema_of((*NAMES, *margins.ROW)))),
    Output(
        "fatigue", of=lambda judged: None if judged.how is None else judged, optional=True,
        parts=(
            Output("how", of=lambda judged: judged.how, parts=fatigue.HOW),
            Output("error", "text", lambda judged: judged.reason or None, optional=True),
            Output(
                "bodies", of=_bodies,
                form=list_of(schema_of((*NAMES, *fatigue.DAMAGE, Output("over_yield", optional=True)))),
            ),
        ),
    ),
    Output(
        "crack", of=lambda judged: None if judged.crack is None else judged, optional=True,
        parts=(
            Output("pin", "text", lambda judged: judged.crack.pin),
            Output("plate", "text", lambda judged: judged.crack.plate),
            Output(
                "error", "text", lambda judged: None if isinstance(judged.growth, Growth) else judged.growth,
                optional=True,
            ),
            Output(
                "growth", of=lambda judged: judged.growth if isinstance(judged.growth, Growth) else None,
                words="as fastpin crack --json gives it; places count from the centre of the hole", optional=True,
                parts=crack.DOCUMENT,
            ),
        ),
    ),
    Output("states", "list", lambda judged: judged.result.states, parts=JOINT_STATE),
)  # fmt: skip
"""Outputs of a :class:`Judged` joint."""

"""A joint of several pins on the page: a joint file that is led by a :class:`fastpin.sessions.JointSession`."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np

from fastpin.assess.outputs import ROUNDING, json_ready
from fastpin.casefile.toml_text import CaseText
from fastpin.casefile.writer import toml_value
from fastpin.errors import InputError
from fastpin.joints import Joint, JointFile, JointPlate, JointState
from fastpin.joints.pins import whole_name
from fastpin.joints.read import kinds_in
from fastpin.joints.result import interfaces_of
from fastpin.joints.solving import LEAST_NODES, MOST_NODES, load_values
from fastpin.live import protocol
from fastpin.live.contact import Answer, LiveContact
from fastpin.live.controls import ControlScales
from fastpin.live.pictures import picture
from fastpin.live.pin import MOST_PLAYED, case_document
from fastpin.model import LoadHistory
from fastpin.model.checks import whole_number
from fastpin.model.unit_systems import SI
from fastpin.model.units import in_other_units
from fastpin.report.joints import joint_units
from fastpin.sessions import JointSession
from fastpin.states.quantities import sizes

NODES = 64
"""Nodes of each contact, by default: a step of five pins in two plates takes 35 ms, and its pictures 70 ms."""

MOST_OF_ALL = 2_000
"""Nodes of all contacts together. The matrices of so many take 130 MB."""


class LiveJoint(LiveContact):
    """The contacts of a joint, led by messages. The states have the bits of :func:`fastpin.joints.solve_joint`.

    Parameters
    ----------
    file : JointFile
    text : str
        The text of the joint file.
    nodes : int, optional
        Nodes of each contact; 64 unless given, or as many as :data:`MOST_OF_ALL` allows.

    Raises
    ------
    InputError
        If the nodes can't be used.
    """

    def __init__(self, file: JointFile, text: str, nodes: int | None = None) -> None:
        joint = file.joint
        self._file, self._text = file, text
        self.most_nodes = most_nodes(joint)
        nodes = min(NODES, self.most_nodes) if nodes is None else self.checked_nodes(nodes)
        largest = np.abs(load_values(joint, file.corners)).max(axis=0).tolist()
        of = dict(zip(joint.load_names, largest, strict=True))
        self._largest = {name: of[name] for name in joint.given_names}
        pictures = max(protocol.MOST_OF_HOLES // len(interfaces_of(joint)), 1)
        super().__init__(self._session(nodes), nodes, file.corners[0], pictures)

    def checked_nodes(self, nodes: int) -> int:
        return whole_number("nodes", nodes, LEAST_NODES, self.most_nodes)

    def _session(self, nodes: int) -> JointSession:
        joint, file = self._file.joint, self._file
        return JointSession(joint, nodes, harmonics=file.harmonics, expected=[self._largest], undo=0)

    def _new_session(self) -> JointSession:
        return self._session(self._nodes)

    @property
    def _problem(self) -> object:
        return self._file.joint

    @property
    def _size(self) -> int:
        return 0 if self.session.state is None else len(interfaces_of(self._file.joint)) * self._nodes

    @property
    def _allowed(self) -> set[str]:
        return set(self._largest)

    def _begin(self, loads: dict[str, float], gesture: int) -> None:
        self._step(self.session, loads, gesture)

    def _rows(self, follow: str) -> list[dict[str, float]]:
        rows = self.session.history or []
        return rows if follow == "history" else rows[-1:]

    def _obey_change(self, changes: dict[str, Any], follow: str, gesture: int) -> None:
        raise InputError(min(changes), "is no control of the page of a joint: it has loads and nodes")

    @property
    def _usual(self) -> dict[str, float]:
        """A usual load of each kind, SI: the largest of the history, or one that causes or follows from those."""
        joint, largest = self._file.joint, {"force": 0.0, "traction": 0.0, "displacement": 0.0}
        for name, size in self._largest.items():
            largest[joint.load_kind(name)] = max(size, largest[joint.load_kind(name)])
        plate, soft = joint.plates[0], joint.problem(*joint.sections[0]).surfaces.beta_star
        area, soft = 2.0 * joint.radius * plate.thickness, soft / plate.thickness
        force = largest["force"] or largest["traction"] * area or largest["displacement"] / soft
        force = force or 1e-3 * plate.material.E * area  # a usual strain
        return {
            name: size or found
            for (name, size), found in zip(largest.items(), (force, force / area, force * soft), strict=True)
        }

    def _history_in(self, plate: JointPlate) -> LoadHistory:
        """A usual load of a pin in a plate."""
        return LoadHistory([{"P": self._usual["force"] / plate.thickness}])

    def _picture(self, state: JointState, serial: int, gesture: int) -> Answer:
        """The picture of a state: one of each hole, as of one pin, and what belongs to the whole joint."""
        joint, moving = state.joint, [plate.name for plate in state.joint.plates if plate.moves]
        moved = dict(zip([plate.name for plate in joint.plates], state.moved.tolist(), strict=True))
        each = zip(joint.sections, state.contacts, strict=True)
        lost = [
            plate.thickness * one.dissipation
            for (_, plate), contact in each
            for one in (contact, contact.seat)
            if one is not None
        ]
        found = {
            "serial": serial, "gesture": gesture, "load": state.load,
            "forces": state.forces.tolist(),
            "shares": {plate.name: state.shares(plate.name) for plate in joint.plates},
            "moved": {name: row for name, row in moved.items() if name in moving},
            "faying": [[str(one), *at.force.tolist()] for one, at in zip(joint.faying, state.faying, strict=True)],
            "dissipation": sum(lost) + sum(each.dissipation for each in state.faying),
            "residual": max(state.residuals.values()),
        }  # fmt: skip
        sections = zip(joint.sections, state.contacts, strict=True)
        holes = []
        for (_, plate), contact in sections:
            of_kind = sizes(contact)
            small = {"P": of_kind["force"], "Q": of_kind["force"], "M": of_kind["moment"]}
            rounding = {name: 0.0 for name, size in small.items() if abs(contact.load[name]) <= ROUNDING * size}
            shown = replace(contact, load=contact.load | rounding)  # what is read from a state stays in it
            holes.append(picture(shown, serial, gesture, self._grid_name(contact.grid), self._history_in(plate)))
        answer: Answer = json_ready(found)
        return answer | {"holes": holes}

    def _case_document(self) -> Answer:
        joint, unit = self._file.joint, {kind: asdict(each) for kind, each in joint_units(self._file.joint).items()}
        kinds, usual = {name: joint.load_kind(name) for name in self._largest}, self._usual
        loads = [
            {"name": name, "unit": unit[kind], "size": self._largest[name] or usual[kind]}
            for name, kind in kinds.items()
        ]
        holes = []
        for pin, plate in joint.sections:
            problem = joint.problem(pin, plate)
            of = case_document("", problem, ControlScales(problem, self._history_in(plate)))
            where = {"pin": pin.name, "plate": plate.name, "whole": whole_name(plate.name)}
            holes.append(of | where | {"at": [pin.at.real, pin.at.imag], "edge": pin.hole_radius(plate.name)})
        for hole in holes:
            hole["controls"] = []
        return {
            "title": self._file.title, "units": unit, "prefixes": holes[0]["prefixes"], "holes": holes, "loads": loads,
            "controls": [], "axes": [], "nodes": self._nodes, "most_nodes": self.most_nodes,
            "plates": [_plate(plate) for plate in joint.plates], "history": self._file.corners[:MOST_PLAYED],
        }  # fmt: skip

    def case_text(self) -> str:
        """The joint and the history so far as a joint file, with the present nodes. It asks for no lives and cracks."""
        rows = self.session.history
        if rows is None:
            raise InputError("case", "no load was followed yet")
        source = CaseText(self._text)
        tables = {name: table for name, table in source.root.table.items() if name not in ("load", "fatigue", "crack")}
        own = tables.get("units", SI)
        kinds = kinds_in(source.with_tables({"load": rows}))
        acting = [name for name in rows[0] if any(row[name] for row in rows)] or list(rows[0])[:1]
        rows = [{name: row[name] for name in acting} for row in rows]
        loads = in_other_units({"load": rows}, kinds, SI, own, True)["load"]
        settings = {name: value for name, value in tables.pop("joint", {}).items() if name != "repeat"}
        blocks = [[f"{name} = {toml_value(each)}" for name, each in tables.items() if not _is_blocks(each)]]
        named = [("joint", settings | {"nodes": self._nodes}), *((name, each) for name, each in tables.items())]
        for name, each in [*named, ("load", loads)]:
            lists = each if _is_blocks(each) else [each] if name == "joint" else []
            head = "[joint]" if name == "joint" else f"[[{name}]]"
            for table in lists:  # a key of a load has a point
                keys = [toml_value(key) if "." in key else key for key in table]
                blocks.append(
                    [head, *(f"{key} = {toml_value(table[at])}" for key, at in zip(keys, table, strict=True))]
                )
        return "\n\n".join("\n".join(block) for block in blocks if block) + "\n"


def most_nodes(joint: Joint) -> int:
    """Most nodes of each contact of a joint on the page."""
    return max(LEAST_NODES, min(MOST_NODES, MOST_OF_ALL // len(interfaces_of(joint)) // 4 * 4))


def _is_blocks(value: object) -> bool:
    """Whether a value is a list of tables."""
    return isinstance(value, list) and all(isinstance(each, dict) for each in value)


def _plate(plate: JointPlate) -> Answer:
    """The name of a plate, its outline, points x, y in m, or None, and its holes without pins, x, y and radius."""
    points = [part.at(np.linspace(0.0, 1.0, 33)) for part in plate.outline]
    line = np.concatenate(points) if points else np.zeros(0)
    outline = np.stack([line.real, line.imag], axis=1).tolist()
    free = [[hole.centre.real, hole.centre.imag, hole.radius] for hole in plate.holes]
    return {"name": plate.name, "outline": outline or None, "holes": free}

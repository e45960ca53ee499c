"""A joint of several pins on the page: a joint file that is led by a :class:`fastpin.sessions.JointSession`."""

from __future__ import annotations

from collections.abc import Callable
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
from fastpin.model import Grid, LoadHistory
from fastpin.model.checks import number, whole_number
from fastpin.model.unit_systems import SI
from fastpin.model.units import in_other_units
from fastpin.report.joints import joint_units
from fastpin.sessions import JointSession
from fastpin.states.quantities import sizes

NODES = 64
"""Nodes of each contact, by default: a step of five pins in two plates takes 35 ms, and its pictures 70 ms."""

MOST_OF_ALL = 2_000
"""Nodes of all contacts together. The matrices of so many take 130 MB."""


MOST_TIMES = 1e6
"""Largest load in parts of a usual one. From 1e15 usual loads the way back takes minutes."""


class JointPictures:
    """The document and the pictures of a joint file for the page.

    Parameters
    ----------
    file : JointFile

    Attributes
    ----------
    file : JointFile
    largest : dict of str to float
        The largest size of each load of the history, SI.
    usual : dict of str to float
        A usual load of each kind, SI: the largest of the history, or one that causes or follows from those.
    """

    def __init__(self, file: JointFile) -> None:
        joint = file.joint
        largest = np.abs(load_values(joint, file.corners)).max(axis=0).tolist()
        of = dict(zip(joint.load_names, largest, strict=True))
        self.file, self.largest = file, {name: of[name] for name in joint.given_names}
        self.usual = {"force": 0.0, "traction": 0.0, "displacement": 0.0}
        for name, size in self.largest.items():
            self.usual[joint.load_kind(name)] = max(size, self.usual[joint.load_kind(name)])
        force, stress, displacement = self.usual.values()
        area, modulus = 2.0 * joint.radius * joint.plates[0].thickness, joint.plates[0].material.E
        soft = joint.problem(*joint.sections[0]).surfaces.beta_star / joint.plates[0].thickness
        force = force or stress * area or displacement / soft or 1e-3 * modulus * area  # a usual strain
        self.usual = {"force": force, "traction": stress or force / area, "displacement": displacement or force * soft}

    def size(self, load: str) -> float:
        """The largest size of a load in the history, or a usual one, SI."""
        return self.largest[load] or self.usual[self.file.joint.load_kind(load)]

    def _history_in(self, plate: JointPlate) -> LoadHistory:
        """A usual load of a pin in a plate."""
        return LoadHistory([{"P": self.usual["force"] / plate.thickness}])

    def picture(self, state: JointState, serial: int, gesture: int, grid_name: Callable[[Grid], str]) -> Answer:
        """The picture of a state: one of each hole, as of one pin, and what belongs to the whole joint."""
        joint, moving = state.joint, [plate.name for plate in state.joint.plates if plate.moves]
        moved = dict(zip([plate.name for plate in joint.plates], state.moved.tolist(), strict=True))
        lost = [
            plate.thickness * one.dissipation
            for (_, plate), contact in zip(joint.sections, state.contacts, strict=True)
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
        holes = []
        for (_, plate), contact in zip(joint.sections, state.contacts, strict=True):
            of_kind = sizes(contact)
            small = {"P": of_kind["force"], "Q": of_kind["force"], "M": of_kind["moment"]}
            rounding = {name: 0.0 for name, size in small.items() if abs(contact.load[name]) <= ROUNDING * size}
            shown = replace(contact, load=contact.load | rounding)  # what is read from a state stays in it
            holes.append(picture(shown, serial, gesture, grid_name(contact.grid), self._history_in(plate)))
        answer: Answer = json_ready(found)
        return answer | {"holes": holes}

    def document(self, nodes: int) -> Answer:
        """The joint, its controls and its loads."""
        joint, unit = self.file.joint, {kind: asdict(each) for kind, each in joint_units(self.file.joint).items()}
        loads = [{"name": name, "unit": unit[joint.load_kind(name)], "size": self.size(name)} for name in self.largest]
        holes = []
        for pin, plate in joint.sections:
            problem = joint.problem(pin, plate)
            of = case_document("", problem, ControlScales(problem, self._history_in(plate)))
            where = {"pin": pin.name, "plate": plate.name, "whole": whole_name(plate.name)}
            holes.append(of | where | {"at": [pin.at.real, pin.at.imag], "edge": pin.hole_radius(plate.name)})
        for hole in holes:
            hole["controls"] = []
        return {
            "title": self.file.title, "units": unit, "prefixes": holes[0]["prefixes"], "holes": holes, "loads": loads,
            "controls": [], "axes": [], "nodes": nodes, "most_nodes": most_nodes(joint),
            "plates": [_plate(plate) for plate in joint.plates], "history": self.file.corners[:MOST_PLAYED],
        }  # fmt: skip


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
        self._file, self._text, self._of = file, text, JointPictures(file)
        self._interfaces = len(interfaces_of(file.joint))
        nodes = min(NODES, most_nodes(file.joint)) if nodes is None else self.checked_nodes(nodes)
        super().__init__(self._session(nodes), nodes, file.corners[0], most_steps(file.joint))

    def checked_nodes(self, nodes: int) -> int:
        return whole_number("nodes", nodes, LEAST_NODES, most_nodes(self._file.joint))

    def _session(self, nodes: int) -> JointSession:
        joint, file = self._file.joint, self._file
        return JointSession(joint, nodes, harmonics=file.harmonics, expected=[self._of.largest], undo=0)

    def _new_session(self) -> JointSession:
        return self._session(self._nodes)

    @property
    def _problem(self) -> object:
        return self._file.joint

    @property
    def _size(self) -> int:
        return 0 if self.session.state is None else self._interfaces * self._nodes

    @property
    def _allowed(self) -> set[str]:
        return set(self._of.largest)

    def _begin(self, loads: dict[str, float], gesture: int) -> None:
        self._step(self.session, loads, gesture)

    def checked_loads(self, loads: dict[str, float]) -> dict[str, float]:
        for name in self._allowed.intersection(loads):
            most = MOST_TIMES * self._of.size(name)
            number(name, loads[name], -most, most)
        return loads

    def _rows(self, follow: str) -> list[dict[str, float]]:
        rows = self.session.history or []
        return rows if follow == "history" else rows[-1:]

    def _obey_change(self, changes: dict[str, Any], follow: str, gesture: int) -> None:
        raise InputError(min(changes), "is no control of the page of a joint: it has loads and nodes")

    def _picture(self, state: JointState, serial: int, gesture: int) -> Answer:
        return self._of.picture(state, serial, gesture, self._grid_name)

    def _case_document(self) -> Answer:
        return self._of.document(self._nodes)

    def case_text(self) -> str:
        """The joint and the history so far as a joint file, with the present nodes, without lives, cracks and wear."""
        rows = self.session.history
        if rows is None:
            raise InputError("case", "no load was followed yet")
        source = CaseText(self._text)
        left_out = "load", "fatigue", "crack", "wear"
        tables = {name: table for name, table in source.root.table.items() if name not in left_out}
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


def most_steps(joint: Joint) -> int:
    """Most states of a joint whose pictures are remembered."""
    return max(protocol.MOST_OF_HOLES // len(interfaces_of(joint)), 1)


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

"""The states of a joint in an HDF5 file, read: of each pin in each plate, and of the whole joint."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property

import numpy as np

from fastpin.joints.document import joint_from
from fastpin.joints.hole import HoleInPlate, in_hole
from fastpin.joints.parts import Joint
from fastpin.joints.pins import whole_name
from fastpin.joints.result import FayingState, JointState, JointStates
from fastpin.joints.solving import LEAST_NODES, MOST_HARMONICS, MOST_NODES, JointTask
from fastpin.model.angles import BOTTOM
from fastpin.model.checks import whole_number
from fastpin.model.grid import Grid
from fastpin.states.extremes import AT_ONCE, KeptStates
from fastpin.states.reading_bounds import StateBlock
from fastpin.states.state import State
from fastpin.storage import hdf5, layout
from fastpin.storage.hdf5 import as_python, check_finite, dataset_of
from fastpin.storage.stored import StoredResult
from fastpin.storage.stored_states import StoredStates

RESIDUALS = (*layout.RESIDUALS, "bodies")
"""Names of the residuals of a state of a joint, in the order of a row."""


def all_round(nodes: int) -> Grid:
    """The nodes of every contact."""
    return Grid.circle(nodes, BOTTOM)


def shapes_of(joint: Joint) -> dict[str, tuple[tuple[int, ...], str]]:
    """The shape of a row and the unit of each array of the whole joint."""
    faying = len(joint.faying)
    rubbed = {"friction": ((faying, 2), "N"), "friction_slip": ((faying, 2), "m"), "friction_loss": ((faying,), "J")}
    return {
        "step": ((), ""),
        "loads": ((len(joint.load_names),), ""),
        "forces": ((len(joint.sections), 2), "N"),
        "moved": ((len(joint.plates), 3), "m, m, rad"),
        "residuals": ((len(RESIDUALS),), ""),
        **(rubbed if faying else {}),
    }


def holes_beside(joint: Joint, place: int) -> list[int]:
    """The place of a section in each other hole of a plate, in their order: the first one of its slices."""
    own, plate = joint.sections[place]
    name = whole_name(plate.name)
    return [joint.places(pin.name, name)[0] for pin in joint.pins if name in pin.plates and pin is not own]


def read_task(file: hdf5.Group) -> JointTask:
    """Read what is followed."""
    text = dataset_of(file["joint"], "document", np.int8)[()].tobytes().decode()
    joint, stored = joint_from(json.loads(text)), file["solver"].attrs
    nodes = whole_number("nodes", as_python(stored["nodes"]), LEAST_NODES, MOST_NODES)
    harmonics = as_python(stored["harmonics"]) if "harmonics" in stored else None
    if harmonics is not None:
        whole_number("harmonics", harmonics, 2, MOST_HARMONICS)
    values = dataset_of(file["history"], "corners", float, (len(joint.load_names),))[()]
    check_finite("history/corners", values)
    return JointTask(joint, values, nodes, harmonics, None)


def read_hole(file: hdf5.Group, joint: Joint, place: int) -> HoleInPlate:
    """Read the hole of a section, without loads."""
    pin, plate = joint.sections[place]
    pair, group = joint.problem(pin, plate).pair, file["interfaces"][str(place)]
    matrix = dataset_of(group, "matrix", float)
    if len(matrix) > 2 + 4 * MOST_HARMONICS:
        raise ValueError(f"interfaces/{place}/matrix has the shape {matrix.shape}")
    return HoleInPlate(pair.plate.nu, pair.plane, pin.hole_radius(plate.name), matrix[()])


def read_whole(file: hdf5.Group, task: JointTask, picked: slice | Sequence[int]) -> layout.Rows:
    """Read the checked arrays of the whole joint at some places."""
    group, shapes = file["states"], shapes_of(task.joint)
    for name, (shape, _) in shapes.items():
        dataset_of(group, name, np.int64 if name == "step" else float, shape)
    if layout.count(group) > len(task.values):
        raise ValueError(f"states/state has {layout.count(group)} rows, more than corners")
    rows = layout.read_rows(group, list(shapes), picked)
    for name, array in rows.items():
        check_finite(f"states/{name}", array)
    if not np.array_equal(rows["step"], np.arange(layout.count(group))[picked]):
        raise ValueError("states/step has other corners than the rows before")
    return rows


def _read_states(task: JointTask, rows: layout.Rows, contacts: Sequence[tuple[State, ...]]) -> list[JointState]:
    """The states of checked rows, with their contacts."""
    joint, found = task.joint, []
    for k, of_state in enumerate(contacts):
        rubbed = zip(*(rows[name][k] for name in shapes_of(joint) if name.startswith("friction")), strict=True)
        faying = tuple(FayingState(force, slip, float(lost)) for force, slip, lost in rubbed)
        load = dict(zip(joint.load_names, rows["loads"][k].tolist(), strict=True))
        whole = rows["forces"][k], rows["moved"][k], _residuals(rows, k)
        found.append(JointState(joint, int(rows["step"][k]), load, of_state, *whole, faying))
    return found


def _residuals(rows: layout.Rows, k: int) -> dict[str, float]:
    return dict(zip(RESIDUALS, rows["residuals"][k].tolist(), strict=True))


class StoredSection(KeptStates):
    """The contact of a pin in a plate at all states of a file.

    Parameters
    ----------
    stored : StoredResult
    task : JointTask
    place : int
        Among the sections.
    """

    def __init__(self, stored: StoredResult, task: JointTask, place: int) -> None:
        self._stored, self._task, self._place = stored, task, place
        with self._opened() as (file, states):
            self._hole = read_hole(file, task.joint, place)
            self.points, self.grid = states.points, states.grid
            bush = states.problem.plate_body.bush
            body = self._hole if bush is None else replace(bush, inside=self._hole)
            self.problem = replace(states.problem, plate_body=body)

    @contextmanager
    def _opened(self) -> Iterator[tuple[hdf5.Group, StoredStates]]:
        task = self._task
        with self._stored.opened(form=layout.JOINT) as file:
            group, problem = file["interfaces"][str(self._place)], task.joint.problem(*task.joint.sections[self._place])
            yield file, StoredStates(group, problem, all_round(task.nodes), len(task.values))

    def blocks(self) -> Iterator[StateBlock]:
        """Give the nodal values of all states, in order."""
        with self._opened() as (_, states):
            yield from states.blocks()

    def read(self, places: Sequence[int]) -> list[State]:
        """Read the states at these places."""
        with self._opened() as (file, states):
            return self.contacts(file, states, places)

    def contacts(self, file: hdf5.Group, states: StoredStates, places: Sequence[int]) -> list[State]:
        """The states of an open file at these places, with what acts on their hole."""
        size = len(self._hole.matrix)

        def rows_of(place: int, *names: str) -> layout.Rows:
            group = file["interfaces"][str(place)]["states"]
            for name in names:
                dataset_of(group, name, float, (3 if name == "acting" else size,))
            rows = layout.read_rows(group, names, places)
            for name, array in rows.items():
                check_finite(f"interfaces/{place}/states/{name}", array)
            return rows

        acting = rows_of(self._place, "incoming", "rubbed", "acting")
        edges = [rows_of(other, "edge")["edge"] for other in holes_beside(self._task.joint, self._place)]
        whole, found = read_whole(file, self._task, places), []
        for k, state in enumerate(states.read(places)):
            others = np.array([edge[k] for edge in edges]).reshape(-1, size)
            hole = self._hole.under(
                incoming=acting["incoming"][k], others=others, loads=acting["acting"][k], rubbed=acting["rubbed"][k]
            )
            residuals = _residuals(whole, k)
            seat = None if state.seat is None else replace(state.seat, residuals=residuals)
            found.append(in_hole(replace(state, residuals=residuals, seat=seat), hole))
        return found


class StoredJointStates(JointStates):
    """The states of a joint in a file.

    Parameters
    ----------
    stored : StoredResult
    task : JointTask
    """

    def __init__(self, stored: StoredResult, task: JointTask) -> None:
        self._stored, self._task = stored, task
        self._sections: dict[int, StoredSection] = {}
        with stored.opened(form=layout.JOINT) as file:
            self._rows = read_whole(file, task, slice(None))

    def __len__(self) -> int:
        return len(self._rows["step"])

    def __getitem__(self, place):  # type: ignore[no-untyped-def]
        if isinstance(place, slice):
            return tuple(self[each] for each in range(len(self))[place])
        return self._at([range(len(self))[place]])[0]

    def __iter__(self) -> Iterator[JointState]:
        for begin in range(0, len(self), AT_ONCE):
            yield from self._at(range(begin, min(begin + AT_ONCE, len(self))))

    def _at(self, places: Sequence[int]) -> list[JointState]:
        """Read the states at these places."""
        sections = [self.section(place).read(places) for place in range(len(self._task.joint.sections))]
        rows = {name: array[np.asarray(places)] for name, array in self._rows.items()}
        return _read_states(self._task, rows, list(zip(*sections, strict=True)))

    @cached_property
    def bare(self) -> list[JointState]:
        """The states without their contacts."""
        return _read_states(self._task, self._rows, [()] * len(self))

    def section(self, place: int) -> StoredSection:
        """The contact of a pin in a plate at all states."""
        if place not in self._sections:
            self._sections[place] = StoredSection(self._stored, self._task, place)
        return self._sections[place]

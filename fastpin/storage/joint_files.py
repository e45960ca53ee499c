"""Results of joints of several pins in HDF5 files, which grow while the joint is followed.

======================  ============================================================================================
``/``                   attributes as in a result, with the format "fastpin joint"
``/joint``              ``document``: the joint as JSON, its bytes
``/history``            ``corners`` (corners, loads), SI
``/solver``             attributes: nodes, harmonics, title, ``fatigue`` and ``crack``; ``statistics``
``/states``             arrays of the whole joint, one row for each corner
``/interfaces/K``       a pin in one plate, in the order of ``joint.sections``: ``states`` as in a result, without work
                        and energy, ``states/seat`` of its bush; ``matrix``: what the plate adds to the compliance of
                        the hole
``/restart/latest``     the place from which the joint goes on
======================  ============================================================================================

``states`` of an interface also has what acts on the hole beside its pin, see :class:`fastpin.joints.hole.HoleInPlate`.
``edge`` has the coefficients of all tractions on the edge of the hole.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.errors import InputError
from fastpin.joints.document import document_of
from fastpin.joints.faying import SIDES
from fastpin.joints.hole import HoleInPlate
from fastpin.joints.parts import MOVES
from fastpin.joints.pins import whole_name
from fastpin.joints.read import JointFile
from fastpin.joints.result import JointResult, JointState, SectionCrack, check_crack
from fastpin.joints.solving import JointRestart, JointTask, load_values
from fastpin.joints.states import Since
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.case import read_text, stored_text
from fastpin.model.checks import file_path, instance, number, string, true_or_false, whole_number
from fastpin.model.loads import LOADS
from fastpin.solver.configuration import Configuration
from fastpin.solver.run import RunProgress
from fastpin.storage import files, hdf5, layout, packed
from fastpin.storage.file_objects import written_h5
from fastpin.storage.hdf5 import as_python, dataset_of, text_of
from fastpin.storage.restarts import ARRAYS, read_array
from fastpin.storage.stored import StoredResult
from fastpin.storage.stored_joints import (
    RESIDUALS,
    StoredJointStates,
    all_round,
    holes_beside,
    read_hole,
    read_task,
    shapes_of,
)
from fastpin.storage.writer import FileWriter, check_overwriting

SAME = 1e-9
"""Difference of two compliances of a hole by rounding."""

FIELDS = {**layout.NODE_FIELDS, **layout.SLIP_FIELDS}
"""Arrays with node values of an interface, with their kinds."""

OF_SEAT = tuple(f"{layout.SEATED[1]}{name}" for name in (*FIELDS, *layout.SEAT_NUMBERS))
"""Arrays of the seat of a bush."""


def record_joint(
    case: JointFile, path: str | Path, *, overwrite: bool = False, progress: RunProgress | None = None
) -> JointResult:
    """Follow a joint as :func:`fastpin.joints.solve_joint`, and write its states to an HDF5 file.

    The states are safe from a killed process as those of :func:`fastpin.record`, and memory does not grow with the
    history. :func:`resume_joint` goes on after a kill, an interrupt or an error, to the same bits.

    Parameters
    ----------
    case : JointFile
        The joint, its corners, nodes and harmonics. Title, fatigue and crack are stored for ``fastpin show``.
    path : path
    overwrite : bool
        Replace an existing result. No other file is replaced.
    progress : callable, optional
        See :func:`fastpin.joints.solve_joint`.

    Returns
    -------
    JointResult
        It reads its states from the file when they are asked for.

    Raises
    ------
    InputError
        Naming the field that can't be used; also if the file exists, or can't be written.
    SolveError, Interrupted
        See :func:`fastpin.joints.solve_joint`. The ``result`` of the error has the states before.
    OutputError
        If the file can't be written any more. The states in the file stay.
    """
    task, attributes = _followed(case, progress)
    path = file_path("path", path)
    files.check_writable(path, result=True)
    check_overwriting(path, true_or_false("overwrite", overwrite))
    writer = JointWriter(path)
    writer.task, writer.attributes = task, attributes
    with writer.closing():
        task.follow(writer)
    return load_joint(path)


def pack_joint(case: JointFile, result: JointResult, error: str | None) -> bytes:
    """Return a result with a state in few bytes, without its restart; see packed.py.

    `error` tells why the result is incomplete.
    """
    task, attributes = _followed(case, None)
    instance("result", result, JointResult, "a JointResult")
    file, rows = packed.PackedGroup(), defaultdict[str, list[layout.Rows]](list)
    holes: list[Any] = [contact.problem.plate_body.lug for contact in result[0].contacts]
    _write_head(file, task, attributes, holes)
    for state in result:
        for name, row in _rows_of(state).items():
            rows[name].append(row)
    for name, some in rows.items():
        layout.append(file[name], {key: np.concatenate([row[key] for row in some]) for key in some[0]})
    layout.write_statistics(file, {"snaps": result.snaps, "seconds": result.seconds})
    file.attrs.update({"complete": True} if error is None else {"error": error})
    return packed.to_bytes(file)


def save_joint(content: bytes, path: Path) -> None:
    """Write a packed result to an HDF5 file. Nothing can go on with it."""
    instance("content", content, bytes, "bytes")
    with files.replacing(file_path("path", path), result=True) as temporary, written_h5(temporary, False) as file:
        packed.from_bytes(content).copy_to(file)


def _followed(case: JointFile, progress: RunProgress | None) -> tuple[JointTask, dict[str, Any]]:
    """What is followed, and the attributes with title and questions."""
    joint, corners, title, nodes, harmonics, fatigue, crack, _ = instance("case", case, JointFile, "a JointFile")
    task = JointTask.of(joint, corners, nodes, harmonics, progress)
    found: dict[str, Any] = {"title": string("title", title)}
    if fatigue is not None:
        instance("fatigue", fatigue, FatigueAssessment, "a FatigueAssessment")
        found["fatigue"] = stored_text("fatigue", fatigue)
    if crack is not None:
        check_crack(joint, instance("crack", crack, SectionCrack, "a SectionCrack"), len(task.values))
        found |= {"crack": stored_text("crack", crack.how), "crack_at": [crack.pin, crack.plate]}
    return task, found


def resume_joint(path: str | Path, like: JointFile | None = None, progress: RunProgress | None = None) -> JointResult:
    """Go on with the joint of a file after a kill, an interrupt or an error, to the same bits.

    Parameters
    ----------
    path : path
        The file of :func:`record_joint`.
    like : JointFile, optional
        The joint, corners, nodes and harmonics that the file must have.
    progress : callable, optional
        See :func:`fastpin.joints.solve_joint`.

    Raises
    ------
    InputError
        If the file is no result of a joint, holds a finished or another one, or another process is writing to it.
    SolveError, Interrupted, OutputError
        See :func:`record_joint`.
    """
    path = file_path("path", path)
    files.check_exists(path)
    if like is not None:
        instance("like", like, JointFile, "a JointFile")
    writer, start = JointWriter.reopened(path, like, progress)
    with writer.closing():
        writer.task.follow(writer, start)
    return load_joint(path)


def load_joint(path: str | Path) -> JointResult:
    """Read the result of a joint. It may be finished, unfinished or killed.

    The states are read from the file when they are asked for.

    Raises
    ------
    InputError
        If the file can't be read, or holds no result of a joint. The states raise it too.
    """
    return joint_of(StoredResult(path))


def joint_of(stored: StoredResult) -> JointResult:
    """Read the result of a joint, see :func:`load_joint`."""
    with stored.opened(form=layout.JOINT) as file:
        task, statistics = read_task(file), hdf5.numbers_of(file["solver/statistics"])
        pairs, joint = enumerate(task.joint.sections), task.joint
        orders = {whole_name(plate.name): read_hole(file, joint, place).order for place, (_, plate) in pairs}
    of_plates = tuple(orders[plate.name] for plate in joint.plates)
    snaps, seconds = int(statistics.get("snaps", 0)), statistics.get("seconds", 0.0)
    return JointResult(joint, StoredJointStates(stored, task), task.nodes, of_plates, snaps, seconds)


def stored_joint(path: str | Path) -> JointFile:
    """Read what is followed in the file of a joint: joint, corners, title, options, fatigue and crack.

    Raises
    ------
    InputError
        See :func:`load_joint`.
    """
    return case_of(StoredResult(path))


def case_of(stored: StoredResult) -> JointFile:
    """Read what is followed, see :func:`stored_joint`."""
    with stored.opened(form=layout.JOINT) as file:
        return _case_of(file, read_task(file))


def _case_of(file: hdf5.Group, task: JointTask) -> JointFile:
    """Read title and questions beside what is followed."""
    stored = file["solver"].attrs
    every = (dict(zip(task.joint.load_names, row, strict=True)) for row in task.values.tolist())
    corners = [{name: load[name] for name in task.joint.given_names} for load in every]
    crack = read_text("crack", text_of(stored.get("crack", "")))
    pin, plate = (text_of(name) for name in stored["crack_at"]) if crack is not None else ("", "")
    followed = None if crack is None else SectionCrack(pin, plate, crack)
    fatigue = read_text("fatigue", text_of(stored.get("fatigue", "")))
    return JointFile(task.joint, corners, text_of(stored["title"]), task.nodes, task.harmonics, fatigue, followed)


class JointWriter(FileWriter):
    """The recorder of a joint that writes to a file; see :class:`fastpin.joints.solving.JointRecorder`.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    task : JointTask
        What is followed.
    attributes : dict
        Title and questions of a new file.
    """

    FORM, NOTED = layout.JOINT, "restart/latest"

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.task: JointTask
        self.attributes: dict[str, Any] = {}
        self._restart: JointRestart | None = None

    @classmethod
    def reopened(
        cls, path: Path, like: JointFile | None, progress: RunProgress | None
    ) -> tuple[JointWriter, JointRestart | None]:
        """The writer of an unfinished file, and the place to go on from; None at the start.

        Raises
        ------
        InputError
            See :func:`resume_joint`.
        """
        with (writer := cls(path)).again("resume") as stored:
            if stored.attrs["complete"]:
                raise InputError(
                    str(path), f"holds a finished joint: there is nothing to go on with; try fastpin show {path}"
                )
            writer.task = task = replace(read_task(stored), progress=progress)
            _check_same(path, _case_of(stored, task), task, like)
            size = layout.count(stored["states"])
            _check_growing(stored["states"], shapes_of(task.joint), size)
            for place in range(len(task.joint.sections)):
                group = stored["interfaces"][str(place)]["states"]
                numbers = (*layout.number_fields(group), *layout.HOLE_FIELDS, "loads", "residuals")
                _check_growing(group, (*FIELDS, *numbers, *(OF_SEAT if "seat" in group else ())), size)

            writer._restart = writer.latest(stored, lambda group: _read_restart(group, task, size))
            groups = ("states", *(f"interfaces/{place}/states" for place in range(len(task.joint.sections))))
            writer._at = dict.fromkeys(groups, 0 if writer._restart is None else writer._restart.corner)
        return writer, writer._restart

    def begin(self, holes: Sequence[HoleInPlate]) -> None:
        """Begin a new file, or go on in a reopened one."""
        if not self.is_open:
            self.begin_file(lambda h5: _write_head(h5, self.task, self.attributes, holes))
            self.commit()
        for place, hole in enumerate(holes):
            matrix = self.h5[f"interfaces/{place}/matrix"][()]
            if matrix.shape != hole.matrix.shape or not np.allclose(matrix, hole.matrix, rtol=0.0, atol=SAME):
                raise InputError(str(self.path), "was begun with other compliances of its plates; start it again")

    def add(self, state: JointState) -> None:
        """Take a state, unless the file has it already. It is in the file after the next commit."""
        self.put(_rows_of(state))

    def corner_reached(self, restart: JointRestart) -> None:
        """Commit after a long wait. Write a checkpoint if one is due."""
        self._restart = restart
        self.note()

    def write_place(self, group: h5py.Group) -> None:
        """Write the place from which the joint goes on."""
        assert self._restart is not None
        _write_restart(group, self._restart)

    def end(self, error: str | None) -> None:
        """End the file, with the message of an error if there is one."""
        if self._restart is not None:
            self.put_place()
            layout.write_statistics(self.h5, {"snaps": self._restart.snaps, "seconds": self._restart.seconds})
        self.end_file(self._restart is not None and self._restart.corner == len(self.task.values), error)

    def so_far(self) -> JointResult:
        """The result in the file."""
        return load_joint(self.path)


def _check_growing(group: hdf5.Group, names: Iterable[str], size: int) -> None:
    """Raise :class:`ValueError` if no state can be appended to these arrays of `size` states."""
    layout.check_appendable(group, ("state", *names))
    if not np.array_equal(group["state"][()], np.arange(size)):
        raise ValueError(f"{group.name[1:]}/state does not count the states")


def _check_same(path: Path, case: JointFile, task: JointTask, like: JointFile | None) -> None:
    """Raise :class:`InputError` if a file, read as `case` and `task`, does not follow the same joint as `like`."""
    if like is None:
        return
    same = {
        "joint": task.joint == like.joint,
        "loads": task.joint == like.joint and np.array_equal(task.values, load_values(like.joint, like.corners)),
        "nodes": task.nodes == like.nodes,
        "harmonics": task.harmonics == like.harmonics,
        "title": case.title == like.title,
        "[fatigue]": case.fatigue == like.fatigue,
        "[crack]": case.crack == like.crack,
    }
    for name, is_same in same.items():
        if not is_same:
            raise InputError("resume", f"{path} was begun with {'other' if name[-1] == 's' else 'another'} {name}")


# -- the parts of a file -----------------------------------------------------------------------------------------------


def _write_head(
    file: h5py.File | packed.PackedGroup, task: JointTask, attributes: dict[str, Any], holes: Sequence[HoleInPlate]
) -> None:
    """Write all but the states and restarts into an empty file."""
    joint, names = task.joint, task.joint.load_names
    layout.write_origin(file, layout.JOINT, 1)
    text = json.dumps(document_of(joint), default=float).encode()
    file["joint/document"] = np.frombuffer(text, dtype=np.int8)
    file["history/corners"] = task.values
    units = {"traction": "Pa", "force": "N", "displacement": "m"}
    file["history/corners"].attrs.update(columns=names, unit=[units[joint.load_kind(name)] for name in names])
    solver = file.create_group("solver")
    given = {"nodes": task.nodes, "harmonics": task.harmonics, **attributes}
    solver.attrs.update({name: value for name, value in given.items() if value is not None})
    solver.create_group("statistics")
    states = file.create_group("states")
    layout.growing(states, "state", (), np.int64, "")
    for name, (shape, unit) in shapes_of(joint).items():
        layout.growing(states, name, shape, np.int64 if name == "step" else float, unit)
    states["residuals"].attrs["columns"] = RESIDUALS
    for place, ((pin, plate), hole) in enumerate(zip(joint.sections, holes, strict=True)):
        group = file.create_group(f"interfaces/{place}")
        group.attrs.update(pin=pin.name, plate=plate.name)
        group["matrix"] = hole.matrix
        layout.make_states(group, joint.problem(pin, plate), all_round(task.nodes), FIELDS, len(hole.matrix))


def _rows_of(state: JointState) -> dict[str, layout.Rows]:
    """The rows of a state, by group."""
    whole: layout.Rows = {
        "step": np.array([state.step]),
        "loads": np.array([list(state.load.values())]),
        "forces": state.forces[None],
        "moved": state.moved[None],
        "residuals": np.array([[state.residuals[name] for name in RESIDUALS]]),
    }
    if state.faying:
        for name, values in zip(
            ("friction", "friction_slip", "friction_loss"), zip(*state.faying, strict=True), strict=True
        ):
            whole[name] = np.array([values])
    found = {"states": whole}
    holes: list[Any] = [contact.problem.plate_body.lug for contact in state.contacts]
    for place, (contact, hole) in enumerate(zip(state.contacts, holes, strict=True)):
        rows = layout.rows_of([contact])
        names = *FIELDS, *layout.NUMBER_FIELDS, "loads", "residuals", *OF_SEAT
        rows = {name: rows[name] for name in names if name in rows}
        for name in layout.OF_WHOLE:
            del rows[name]
        edge, (pin, plate) = np.zeros_like(hole.incoming), state.joint.sections[place]
        for other in holes_beside(state.joint, place)[:1]:  # it knows the tractions on this edge
            first = state.joint.places(pin.name, whole_name(plate.name))[0]
            edge = holes[other].others[holes_beside(state.joint, other).index(first)]
        acting = {"incoming": hole.incoming, "edge": edge, "rubbed": hole.rubbed, "acting": hole.loads}
        found[f"interfaces/{place}/states"] = rows | {name: values[None] for name, values in acting.items()}
    return found


# -- restarts ----------------------------------------------------------------------------------------------------------


def _write_restart(group: h5py.Group, restart: JointRestart) -> None:
    group.attrs.update(corner=restart.corner, snaps=restart.snaps, seconds=restart.seconds)
    for name in ARRAYS:
        group[f"configuration/{name}"] = getattr(restart.configuration, name)[None]
    for name, values in vars(restart.since).items():
        group[name] = values


def _read_restart(group: hdf5.Group, task: JointTask, size: int) -> JointRestart:
    """Read the place to go on from, in a file of so many states.

    Raises
    ------
    ValueError
        If an array does not fit the joint, or a number is out of range or not finite.
    """
    joint, stored = task.joint, group["configuration"]
    grid, surfaces = all_round(task.nodes), len(joint.faying)
    problems = [joint.problem(*section) for section in joint.sections]
    seats = [seat_grid(problem, grid).size for problem in problems if problem.seat is not None]
    sections = len(problems) + len(seats)
    nodes = len(problems) * task.nodes + sum(seats) + SIDES * surfaces
    motions = 3 * sections + sum(len(MOVES[plate.moves]) for plate in joint.plates)
    sizes = {"motion": motions, "rest": motions, "origin": 2, "load": len(LOADS) + len(joint.load_names) + 2}
    arrays = {name: read_array(stored, name, sizes.get(name, nodes)) for name in ARRAYS}
    if any(len(array) != 1 for array in arrays.values()):
        raise ValueError("the restart has another number of configurations than 1")
    shapes = {"dissipated": (sections,), "rubbed": (surfaces,), "rest": (sections, 2)}
    since = {name: dataset_of(group, name, float)[()] for name in shapes}
    for name, shape in shapes.items():
        if since[name].shape != shape or np.isinf(since[name]).any():
            raise ValueError(f"{name} of the restart does not fit the joint")
    return JointRestart(
        whole_number("corner", as_python(group.attrs["corner"]), 1, min(size, len(task.values))),
        Configuration(**{name: array[0] for name, array in arrays.items()}),
        Since(**since), whole_number("snaps", as_python(group.attrs["snaps"]), 0),
        number("seconds", as_python(group.attrs["seconds"]), 0.0),
    )  # fmt: skip

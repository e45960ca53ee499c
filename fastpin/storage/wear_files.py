"""Lives of wear in HDF5 files, and the function :func:`wear` that follows one.

The file is a result, see layout.py: its states are those over one cycle after each chosen cycle. The group ``/wear``
has the law as attributes, ``coefficients`` (2, n), a row for each chosen cycle, and ``place``, from which the life goes
on. A checkpoint stands beside the file, as beside that of a run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Unpack

import h5py
import numpy as np

from fastpin.errors import InputError
from fastpin.model import FatigueAssessment, Grid, LoadHistory, Problem, Wear, checks
from fastpin.model.case import checked_beside
from fastpin.model.doubts import doubts, warn_of, wear_doubts
from fastpin.model.options import OptionValues, SolveOptions
from fastpin.model.profile import ProfileLike
from fastpin.model.units import units_per_thickness
from fastpin.solver import Interrupted, SolveError
from fastpin.solver.run import RunProgress
from fastpin.solver.task import as_history
from fastpin.storage import files, hdf5, journal, layout
from fastpin.storage.hdf5 import as_python, check_between, check_finite, dataset_of, numbers_of, text_of
from fastpin.storage.restarts import read_restart, write_restart
from fastpin.storage.store import ALL, read_result
from fastpin.storage.stored import StoredResult
from fastpin.storage.writer import FileWriter, check_overwriting
from fastpin.wear_lives import WearResult, WornCycle
from fastpin.wear_lives.fat_cycles import Worn
from fastpin.wear_lives.life import CyclesInMemory, FrictionRule, WearTask

DEPTHS = ("pin_depth", "plate_depth")
"""Arrays of ``/wear`` with a value for each node, m."""

NUMBERS = {"cycle": np.int64, "next_jump": np.int64, "solved": np.int64, "dissipation": float, "removed": float}
"""Arrays of ``/wear`` with a number for each chosen cycle."""


def wear(
    problem: Problem,
    history: LoadHistory | Sequence[dict[str, float]],
    *,
    cycles: float | None = None,
    coefficient: ProfileLike | None = None,
    pin: ProfileLike | None = None,
    plate: ProfileLike | None = None,
    law: str = "archard",
    at: Sequence[int] | None = None,
    tolerance: float = Wear.tolerance,
    friction: FrictionRule | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    title: str = "",
    fatigue: FatigueAssessment | None = None,
    grid: Grid | None = None,
    progress: RunProgress | None = None,
    **options: Unpack[OptionValues],
) -> WearResult:
    """Follow a load cycle many times on a profile that wears, and return the profiles after chosen cycles.

    What leads to the cycle is followed once. Then every cycle is solved, or cycles that stand for many, under control
    of their error. Debris is not modelled: worn material leaves the contact at once.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        What leads to the cycle, then the cycle: ``LoadHistory(...) + LoadHistory(cycle).repeated(n)``.
    cycles : float, optional
        Number of cycles; the n of the history unless given.
    coefficient, pin, plate, law, at, tolerance
        See :class:`fastpin.model.Wear`.
    friction : callable, optional
        Called with each chosen cycle but the last, a :class:`fastpin.wear_lives.WornCycle`. It returns the friction
        from there on: values at the nodes, shape (n,), or whatever a problem takes as its friction. None leaves the
        friction as it is. The contact follows the change under the loads at the end of the cycle. For lives in memory
        only.
    output : path, optional
        An HDF5 file for the result. It survives a kill, and `resume` continues it.
    overwrite : bool
        Replace an existing result.
    resume : bool
        Continue the unfinished life in `output`, to the same bits. All other arguments must be those of its beginning.
    title : str
        Title of the result in the file.
    fatigue : FatigueAssessment, optional
        How ``fastpin report`` judges the life in the file: its criteria and bodies.
    grid : Grid, optional
        Ready, equally spaced nodes.
    progress : callable, optional
        Called as ``progress(done_cycles, all_cycles)`` now and then.
    **options
        ``nodes`` and ``arc``, see :class:`fastpin.SolveOptions`.

    Returns
    -------
    WearResult
        Also the ``result`` of an error or interrupt: the chosen cycles that were reached before.

    Raises
    ------
    InputError
        If an argument can't be used, or the file must not be replaced or does not fit. It names the field.
    SolveError
        If a cycle can't be followed, or the worn depth is too large for small strains. It names the cycle.
    Interrupted
        After Ctrl-C.
    """
    history = as_history(history)
    last = history.blocks[-1]
    given = {name: value for name, value in options.items() if name not in ("nodes", "arc")}
    if given:
        raise InputError(next(iter(given)), "has no effect on wear; of the options of a run it takes nodes and arc")
    how = Wear(coefficient, pin, plate, last.count if cycles is None else cycles, law, at, tolerance)  # type: ignore[arg-type]
    checks.check_callable("progress", progress)
    checks.check_callable("friction", friction, 1)
    if friction is not None and output is not None:
        raise InputError("friction", "is a function of lives in memory: a file can't hold it, so leave output out")
    task = WearTask(problem, history, how, SolveOptions(**options), grid, progress, friction)
    warn_of([*doubts(problem, history, task.options), *wear_doubts(problem, how)], 2)
    title, judged = checks.string("title", title), checked_beside(problem, {"fatigue": _median(fatigue)})
    for name, value in (("overwrite", overwrite), ("resume", resume)):
        if checks.true_or_false(name, value) and output is None:
            raise InputError(name, "needs an output")
    if output is None:
        return _in_memory(task)
    path = checks.file_path("output", output)
    files.check_writable(path, result=True)
    if resume:
        files.check_exists(path)
        if not journal.is_empty(path):  # a killed life may have left a file without any transaction
            return _resumed(WearFile(path, task, title, judged))
    writer = WearFile(path, task, title, judged)
    check_overwriting(path, overwrite)
    with writer.closing():
        task.follow(writer)
    return load_wear(path)


def _median(fatigue: FatigueAssessment | None) -> FatigueAssessment | None:
    """Return an assessment; one with a scatter of lives or a residual stress is refused."""
    if isinstance(fatigue, FatigueAssessment) and (fatigue.residual_stress, fatigue.reliability) != (None, None):
        words = "must have neither residual_stress nor reliability: a life of wear takes median lives without them"
        raise InputError("fatigue", words)
    return fatigue


def _in_memory(task: WearTask) -> WearResult:
    kept = CyclesInMemory()
    try:
        task.follow(kept)
    except (SolveError, Interrupted) as ended:
        if kept.grid is not None:
            ended.result = task.result(kept.grid, kept.cycles, kept.statistics)  # type: ignore[assignment]
        raise
    assert kept.grid is not None
    return task.result(kept.grid, kept.cycles, kept.statistics)


def _resumed(writer: WearFile) -> WearResult:
    """Continue the life in a file. A life without a stored cycle begins anew, with the title of the writer."""
    place, grid = writer.reopen()
    with writer.closing():
        if place is None:
            writer.task.follow(writer)
        else:
            writer.task.go_on(writer, place, grid, writer.stored)
    return load_wear(writer.path)


class WearFile(FileWriter):
    """The recorder of a life of wear that writes to a file; see :class:`fastpin.wear_lives.life.WearRecorder`.

    Parameters
    ----------
    path : Path
    task : WearTask
    title : str
    beside : mapping of str
        The section [fatigue] of the case, if it has one, by its name.
    """

    PLACE, NOTED, UNIT = "wear/place", "place", "cycle"

    def __init__(self, path: Path, task: WearTask, title: str, beside: Mapping[str, Any]) -> None:
        super().__init__(path)
        self.task, self._title, self._beside = task, title, beside
        self._place: Worn | None = None

    def reopen(self) -> tuple[Worn | None, Grid]:
        """Open the file of an unfinished life, and return the place from which it goes on, and its grid.

        Raises
        ------
        InputError
            If it is no such file, holds another life, or another process is writing to it.
        """
        with self.again("resume") as stored:
            _check_same(self.path, stored, self.task)
            grid = layout.read_grid(stored)
            layout.check_growing(stored, grid.size)
            for name, rows in _read_rows(stored, grid.size).items():
                layout.check_rows(f"wear/{name}", stored["wear"][name], len(rows))
            self._place = self.latest(stored, lambda group: _read_place(group, grid.size))
            return self._place, grid

    @property
    def stored(self) -> int:
        """The last chosen cycle in the file; -1 without one."""
        cycles = self.h5["wear/cycle"]
        return int(cycles[-1]) if len(cycles) else -1

    def begin(self, grid: Grid, force: float) -> None:
        """Begin a new file."""
        task = self.task
        nodes = task.options.nodes if task.grid is None else grid.size
        attributes = {**layout.option_attributes(task.options), "nodes": nodes, "slip_sums": True, "title": self._title}
        attributes |= layout.beside_attributes(self._beside)
        self.begin_file(lambda h5: layout.write_head(h5, task.problem, task.stored_history, grid, attributes))
        group = self.h5.create_group("wear")
        group.attrs.update(law=task.wear.law, tolerance=task.wear.tolerance, chosen=np.array(task.wear.chosen))
        group["coefficients"] = task.coefficients(grid.theta)
        for name in DEPTHS:
            group.create_dataset(name, (0, grid.size), maxshape=(None, grid.size), chunks=(1, grid.size), dtype=float)
        for name, kind in NUMBERS.items():
            group.create_dataset(name, (0,), maxshape=(None,), chunks=(128,), dtype=kind)
        unit = units_per_thickness(task.problem)
        group["coefficients"].attrs["unit"] = unit["wear coefficient"]
        kinds = dict.fromkeys(DEPTHS, "displacement") | dict.fromkeys(("dissipation", "removed"), "energy")
        for name, quantity in kinds.items():
            group[name].attrs["unit"] = unit[quantity]
        self._place = None
        self.commit()

    def add(self, cycle: WornCycle, place: Worn, statistics: dict[str, float]) -> None:
        """Write a chosen cycle, and the place from which the life goes on, in one transaction."""
        states, wear = layout.rows_of(cycle.states), {**dict.fromkeys(DEPTHS, float), **NUMBERS}
        self.put(
            {
                "states": {name: states[name] for name in layout.state_rows(self.h5["states"])},
                "wear": {name: np.array([getattr(cycle, name)], dtype=kind) for name, kind in wear.items()},
            }
        )
        layout.write_statistics(self.h5, statistics)
        self._place = place
        self.put_place()
        self.commit()

    def reached(self, place: Worn) -> None:
        """Write a checkpoint, if one is due."""
        self._place = place
        self.note()

    def write_place(self, group: h5py.Group) -> None:
        """Write the place from which the life goes on."""
        assert self._place is not None
        _write_place(group, self._place)

    def end(self, error: str | None) -> None:
        """End the file with the message of an error, if any."""
        if self._place is not None:
            self.put_place()
        self.end_file(error is None, error)

    def so_far(self) -> WearResult:
        """Return the life in the file."""
        return load_wear(self.path)


def load_wear(path: str | Path) -> WearResult:
    """Read the result of a life of wear. It may be finished, unfinished or killed.

    Raises
    ------
    InputError
        If the file can't be read, or holds no life of wear.
    """
    return life_of(StoredResult(path))


def life_of(stored: StoredResult) -> WearResult:
    """Read the life of wear of a stored result, see :func:`load_wear`."""
    with stored.opened() as file:
        if "wear" not in file:
            raise InputError(str(stored.path), "holds no wear: it is the result of a run; fastpin.load reads it")
        states = read_result(file, stored.path, ALL)[0].states
        group, grid, history = file["wear"], layout.read_grid(file), layout.read_history(file)
        corners, arrays = len(history.blocks[-1].given) + 1, _read_rows(file, grid.size)
        coefficients = dataset_of(group, "coefficients", float, (grid.size,))[()]
        check_between("wear/coefficients", coefficients, 0.0, np.finfo(float).max)
        cycles = []
        for k in range(len(arrays["cycle"])):
            given = {name: array[k] if array.ndim > 1 else array[k].item() for name, array in arrays.items()}
            cycles.append(WornCycle(**given, states=tuple(states[k * corners : (k + 1) * corners])))
        return WearResult(
            problem=layout.read_problem(file),
            history=history,
            law=text_of(group.attrs["law"]),
            tolerance=float(group.attrs["tolerance"]),
            coefficients=coefficients,
            grid=grid,
            cycles=tuple(cycles),
            complete=bool(file.attrs["complete"]),
            statistics=numbers_of(file["solver/statistics"]),
        )


def _check_same(path: Path, file: hdf5.Group, task: WearTask) -> None:
    """Raise :class:`InputError` if a file holds no unfinished life of the same task."""
    if "wear" not in file:
        raise InputError(str(path), "holds no wear: it is the result of a run")
    if file.attrs["complete"]:
        words = f"holds a finished life of wear: there is nothing to continue; try fastpin show {path} --json"
        raise InputError(str(path), words)
    group, grid = file["wear"], layout.read_grid(file)
    begun, wanted = layout.read_history(file).blocks, task.stored_history.blocks
    same = {
        "problem": layout.read_problem(file) == task.problem,
        "history": len(begun) == len(wanted)
        and all(
            one.count == other.count and np.array_equal(one.given, other.given, equal_nan=True)
            for one, other in zip(begun, wanted, strict=True)
        ),
        "coefficient": np.array_equal(group["coefficients"][()], task.coefficients(grid.theta)),
        "law": text_of(group.attrs["law"]) == task.wear.law,
        "at": np.array_equal(group.attrs["chosen"], task.wear.chosen),
        "tolerance": float(group.attrs["tolerance"]) == task.wear.tolerance,
        "nodes": as_python(file["solver"].attrs["nodes"]) == task.options.nodes or task.grid is not None,
        "grid": task.grid is None or np.array_equal(task.grid.theta, grid.theta),
    }
    for name, is_same in same.items():
        if not is_same:
            raise InputError("resume", f"{path} was begun with another {name}")


def _read_rows(file: hdf5.Group, nodes: int) -> dict[str, np.ndarray]:
    """Read the arrays with a row for each chosen cycle, on a grid of so many nodes.

    Raises
    ------
    ValueError
        If an array is missing, does not fit the others, or has a number out of range. It names the array.
    """
    group, corners = file["wear"], len(layout.read_history(file).blocks[-1].given) + 1
    arrays = {name: dataset_of(group, name, float, (nodes,)) for name in DEPTHS}
    arrays |= {name: dataset_of(group, name, kind, ()) for name, kind in NUMBERS.items()}
    size = len(arrays["cycle"])
    for name, array in arrays.items():
        if len(array) != size:
            raise ValueError(f"wear/{name} has {len(array)} rows, not {size}")
    if layout.count(file["states"]) != size * corners:
        raise ValueError(f"wear/cycle has {size} rows, which don't fit the states")
    rows = {name: array[()] for name, array in arrays.items()}
    for name in (*DEPTHS, "dissipation", "removed"):
        check_finite(f"wear/{name}", rows[name])
    for name in ("cycle", "solved"):
        check_between(f"wear/{name}", rows[name], 0, np.iinfo(np.int64).max)
    if np.any(np.diff(rows["cycle"]) <= 0):
        raise ValueError("wear/cycle does not increase")
    return rows


def _write_place(group: h5py.Group, place: Worn) -> None:
    group.attrs.update(
        cycle=place.cycle, jump=place.jump, solved=place.solved, removed=place.removed, pause=place.pause,
        loses_contact=place.loses_contact,
    )  # fmt: skip
    group["depth"] = place.depth
    write_restart(group.create_group("restart"), place.restart)


def _read_place(group: hdf5.Group, nodes: int) -> Worn:
    """Read a place of a life on a grid of so many nodes.

    Raises
    ------
    ValueError
        If an array does not fit, or a number is not finite.
    """
    depth = dataset_of(group, "depth", float, (nodes,))[()]
    if len(depth) != 2:
        raise ValueError(f"depth has the shape {depth.shape}")
    check_finite("depth", depth)
    numbers = {name: as_python(group.attrs[name]) for name in ("cycle", "jump", "solved", "removed", "pause")}
    restart = read_restart(group["restart"], nodes)
    return Worn(**numbers, depth=depth, restart=restart, loses_contact=bool(group.attrs["loses_contact"]))

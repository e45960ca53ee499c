"""The recorder that writes a run to a file."""

from __future__ import annotations

import logging
import os
import time
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

import h5py
import numpy as np

from fastpin.errors import InputError, OutputError
from fastpin.model import About
from fastpin.solver import Interrupted, Restart, Result, SolveError
from fastpin.solver.run import Run, RunProgress
from fastpin.solver.task import Task, deferred_interrupts
from fastpin.states.cycles import Cycle
from fastpin.states.state import SlipFields, State
from fastpin.storage import files, hdf5, layout
from fastpin.storage.file_objects import written_h5
from fastpin.storage.hdf5 import reading
from fastpin.storage.journal import JournaledFile, check_beside, is_empty, not_readable
from fastpin.storage.restarts import read_restart, write_restart
from fastpin.storage.store import is_unfinished, load, open_result, stored_task
from fastpin.storage.stored_states import all_nodes, write_extremes

log = logging.getLogger(__name__)

T = TypeVar("T")

MOST_PENDING = 64
"""Most states that wait for one commit."""

COMMIT_SHARE = 20.0
"""Shortest time between two commits, in durations of a commit. After this time the next state or corner commits."""

CHECKPOINT_EVERY = 2.0
"""Shortest time between two checkpoints, s."""

CHECKPOINT_SHARE = 50.0
"""Shortest time between two checkpoints, in durations of a checkpoint."""

PIECE = 256
"""Most states that are copied at once, when steps repeat."""


def checkpoint_of(path: Path) -> Path:
    """Return the path of a run's checkpoint. It stands beside the file itself, also if `path` is a link."""
    real = Path(os.path.realpath(path))
    return real.with_name(real.name + ".checkpoint")


def coarse_of(path: Path) -> Path:
    """Return the path of the run on the coarse grid. It stands beside the file until it ends."""
    real = Path(os.path.realpath(path))
    return real.with_name(real.name + ".coarse")


def clear_checkpoints(path: Path) -> None:
    """Remove the checkpoint of an ended run, and what killed processes have left beside it.

    That is partly written checkpoints, and the run on the coarse grid of an earlier run in this file.
    """
    coarse_of(path).unlink(missing_ok=True)
    checkpoint = checkpoint_of(path)
    checkpoint.unlink(missing_ok=True)
    files.forget_temporaries(checkpoint.parent, [checkpoint.name])


def check_overwriting(path: Path, overwrite: bool) -> None:
    """Raise :class:`InputError` if a result exists and must not be overwritten."""
    if path.exists() and not path.is_file():
        raise InputError(str(path), "must be an ordinary file")
    if overwrite or not path.exists() or is_empty(path):
        return
    reason = "holds an unfinished run: resume it, or replace it" if is_unfinished(path) else "exists already"
    raise InputError(str(path), f"{reason}; overwrite=True (--overwrite) replaces it")


class FileWriter:
    """A recorder that writes to an HDF5 file: rows of arrays in transactions, and a place from which the run goes on.

    Runs, lives of wear and joints write by it. Each says in :meth:`write_place` what its place is.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    h5 : h5py.File
        The open file.
    """

    FORM = layout.FORMAT
    PLACE, NOTED = "restart/latest", "restart"
    """Groups of the place: in the file, and in the checkpoint beside it."""
    UNIT = "corner"
    """What the run counts. The place has it as an attribute."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.h5: h5py.File
        self._file: JournaledFile | None = None
        self._next_commit = self._next_checkpoint = 0.0
        self._rows: dict[str, list[layout.Rows]] = {}  # they wait for the next commit, by group
        self._at: dict[str, int] = {}  # rows that the run has given, by group
        self._stored: dict[str, int] = {}  # rows in the file, and those that wait

    # -- of a kind of result -------------------------------------------------------------------------------------

    def write_place(self, group: h5py.Group) -> None:
        """Write the place from which the run goes on into an empty group."""
        raise NotImplementedError

    def end(self, error: str | None) -> None:
        """Write the end of the file, with the message of an error if there is one."""
        raise NotImplementedError

    def so_far(self) -> Any:
        """Return the result of a run that ended early, from its file."""
        raise NotImplementedError

    # -- the file ------------------------------------------------------------------------------------------------

    @property
    def is_open(self) -> bool:
        """Whether the file has begun, and has not ended."""
        return self._file is not None

    def begin_file(self, write_head: Callable[[h5py.File], None]) -> None:
        """Begin a new file with its head, in place of one that has begun; see :func:`layout.write_head`.

        Raises
        ------
        InputError
            If it can't be written.
        """
        self.abort()
        self._check_beside()
        self._rows, self._at, self._stored = {}, {}, {}
        self._file = JournaledFile(self.path, new=True)
        self.h5 = h5py.File(self._file, "w")
        self.h5.flush()  # The signature goes first: what a killed process leaves is known as a result.
        write_head(self.h5)
        self.h5.attrs["run"] = uuid.uuid4().hex

    def _check_beside(self) -> None:
        check_beside(checkpoint_of(self.path))
        check_beside(coarse_of(self.path))

    @contextmanager
    def again(self, *arguments: str) -> Iterator[hdf5.Group]:
        """Open an unfinished file again, and give its content. An error of the block leaves the file as it was.

        `arguments` are names in errors of the block that don't come from the file.

        Raises
        ------
        InputError
            If the file is empty or no result, or another process is writing to it.
        """
        self._check_beside()
        file = JournaledFile(self.path, new=False)
        try:
            if self.path.stat().st_size == 0:
                raise InputError(str(self.path), "is empty: its run ended before it had begun; start it again")
            self.h5 = h5py.File(file, "r+")
        except OSError:
            file.release()
            raise not_readable(self.path) from None
        except BaseException:
            file.release()
            raise
        self._file = file
        try:
            with reading(self.path, *arguments):
                stored = hdf5.Group(self.h5)
                layout.check_format(stored, str(self.path), self.FORM)
                yield stored
                self.h5.attrs.pop("error", None)
        except BaseException:
            self.abort()
            raise

    def latest(self, stored: hdf5.Group, read: Callable[[hdf5.Group], T]) -> T | None:
        """Return the place to go on from: the later one of file and checkpoint; None without any.

        ``read(group)`` makes it. :class:`ValueError` is raised if that of the file is damaged.
        """
        found = read(stored[self.PLACE]) if self.PLACE in stored else None
        try:
            with h5py.File(checkpoint_of(self.path), "r") as file:
                beside = hdf5.Group(file)
                noted = read(beside[self.NOTED]) if beside.attrs["run"] == self.h5.attrs["run"] else None
        except FileNotFoundError:
            return found
        except (OSError, KeyError, ValueError, TypeError, IndexError):
            words = "%s can't be read: continuing from an earlier %s"
            log.warning(words, checkpoint_of(self.path), self.UNIT)
            return found
        known = [each for each in (found, noted) if each is not None]
        return max(known, key=lambda place: getattr(place, self.UNIT), default=None)

    def put(self, rows: Mapping[str, layout.Rows]) -> None:
        """Take rows of arrays, by group. They are in the file after the next commit.

        Rows that the file has already are compared, and not written again.
        """
        for group, more in rows.items():
            size = len(next(iter(more.values())))
            stored = self._stored.setdefault(group, layout.count(self.h5[group]))
            at = self._at.setdefault(group, stored)
            known = min(stored - at, size)
            if known and "pressure" in more:
                before = self.h5[group]["pressure"][at : at + known]
                if not np.array_equal(before, more["pressure"][:known]):
                    words = "%s: states found again differ from those in the file: another machine or version?"
                    log.warning(words, self.path)
            if known < size:
                self._rows.setdefault(group, []).append({name: array[known:] for name, array in more.items()})
            self._at[group], self._stored[group] = at + size, max(stored, at + size)

    def commit_if_due(self, now: float) -> None:
        """Commit if many states wait, or have waited long at the time `now`."""
        pending = sum(len(rows["step"]) for rows in self._rows.get("states", ()))
        if self._rows and (pending >= MOST_PENDING or now > self._next_commit):
            self.commit()

    def commit(self) -> None:
        """Write the rows that wait, and end the transaction."""
        assert self._file is not None
        began = time.monotonic()
        try:
            for group, parts in self._rows.items():
                rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
                layout.append(self.h5[group], rows)
            self.h5.flush()
            self._file.commit()
        except OutputError:
            self.abort()
            raise
        self._rows = {}
        log.debug("%d states in the file", layout.count(self.h5["states"]))
        now = time.monotonic()
        self._next_commit = now + COMMIT_SHARE * (now - began)

    def note(self) -> None:
        """Commit if it is due. Write a checkpoint with the place, if one is due; a commit goes before it."""
        now = time.monotonic()
        self.commit_if_due(now)
        if now <= self._next_checkpoint:
            return
        if self._next_checkpoint:
            self.commit()
            with files.replacing(checkpoint_of(self.path), result=True) as temporary, written_h5(temporary) as file:
                file.attrs["run"] = self.h5.attrs["run"]
                self.write_place(file.create_group(self.NOTED))
            log.debug("checkpoint after another %s", self.UNIT)
        duration = time.monotonic() - now
        self._next_checkpoint = time.monotonic() + max(CHECKPOINT_EVERY, CHECKPOINT_SHARE * duration)

    def put_place(self) -> None:
        """Write the place into the file, in place of an earlier one."""
        if self.PLACE in self.h5:
            del self.h5[self.PLACE]
        self.write_place(self.h5.create_group(self.PLACE))

    def end_file(self, complete: bool, error: str | None) -> None:
        """End the file of a run that is `complete`, or ended early with the message of an error, if any."""
        self.h5.attrs["complete"] = complete
        self.h5.attrs.pop("error", None)
        if error is not None:
            self.h5.attrs["error"] = error
        self.commit()
        self.close()
        clear_checkpoints(self.path)

    def close(self) -> None:
        """Close the file."""
        assert self._file is not None
        file, self._file = self._file, None
        try:
            self.h5.close()
            file.commit()
        finally:
            file.release()

    def abort(self) -> None:
        """Close the file as the last transaction left it."""
        if self._file is not None:
            self._file.abandon()
            self.close()

    @contextmanager
    def closing(self) -> Iterator[None]:
        """End the file of a run when the block ends.

        A SolveError or an interrupt ends the file properly, with the message. The exception then holds the result so
        far as ``result``. Any other exception leaves the file as the last transaction left it.
        """
        try:
            try:
                yield
            except (SolveError, Interrupted) as error:
                if self.is_open:
                    with deferred_interrupts():
                        self.end(str(error))
                    error.result = self.so_far()
                raise
            if self.is_open:
                with deferred_interrupts():
                    self.end(None)
        except BaseException:
            self.abort()
            raise


class _Start(NamedTuple):
    """A restart in a file, with the numbers of rows up to it, by group, and the time of the run, s."""

    corner: int
    restart: Restart
    rows: dict[str, int]
    seconds: float


class FileRecorder(FileWriter):
    """The recorder of a run that writes states, cycles and restarts to a file.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    task : Task
    chosen_arc : bool
        Whether the solver chose the arc. A wider arc may then follow.
    overwrite : bool
        Whether an existing file may be replaced, also the file of an unfinished run.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.overwrite = True
        self._run: Run
        self._corner = {"states": 0, "cycles": 0}  # rows up to the last corner
        self._copied: layout.Rows | None = None
        self._seconds = 0.0
        self._began = time.monotonic()

    def take(self, task: Task, title: str, about: About, beside: Mapping[str, Any] = MappingProxyType({})) -> None:
        """Take the task that will be followed. Its corners `save_after` get a restart in the file.

        `beside` are the sections of the case beside the problem, by name.
        """
        self.task, self._title, self._about, self._beside = task, title, about, beside
        self.chosen_arc = task.options.arc is None and task.grid is None

    # -- calls of the run ----------------------------------------------------------------------------------------

    def begin(self, run: Run) -> None:
        """Begin a new file for `run`, or continue a reopened file on the same grid.

        Raises
        ------
        InputError
            If the file must not be overwritten, or can't be written.
        """
        self._run = run
        if self.is_open and np.array_equal(self.h5["grid/theta"][()], run.grid.theta):
            return  # The file was reopened.
        if not self.is_open:
            check_overwriting(self.path, self.overwrite)  # Check again: the choice of the arc may have taken long.
        self._corner = {"states": 0, "cycles": 0}
        task = self.task
        attributes = {**layout.option_attributes(task.options), "nodes": run.grid.size, "title": self._title}
        attributes |= {**self._about.given(), **layout.beside_attributes(self._beside)}
        attributes |= {"arc_chosen": self.chosen_arc, "save_after": sorted(task.save_after)}
        self.begin_file(lambda h5: layout.write_head(h5, task.problem, task.history, run.grid, attributes))
        for name in ("start", "latest"):
            self.write_place(self.h5.create_group(f"restart/{name}"))
        self.commit()

    def add(self, state: State) -> None:
        """Take a state. It is in the file after the next commit."""
        self._copied = None
        rows = layout.rows_of([state])
        self._put({name: rows[name] for name in layout.state_rows(self.h5["states"])})

    def add_cycle(self, cycle: Cycle) -> None:
        """Take a cycle, unless the file has it already."""
        self.put({"cycles": layout.cycle_rows([cycle])})

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray, slip: SlipFields) -> None:
        """Take the latest states once more, with other steps and energies; see :meth:`fastpin.solver.run.Recorder`."""
        size = len(steps)
        if self._copied is None or len(self._copied["step"]) != size:
            self.commit()
            begin = self._at["states"] - size
            for first in range(0, size, PIECE):
                last = min(first + PIECE, size)
                group = self.h5["states"]
                rows = layout.read_rows(group, layout.state_rows(group), slice(begin + first, begin + last))
                rows = rows if first else _with_first(rows, slip)
                self._put_again(rows, steps[first:last], dissipation[first:last], work[first:last])
                self._copied = rows if size <= PIECE else None
        else:
            self._copied = _with_first(self._copied, slip)
            self._put_again(self._copied, steps, dissipation, work)

    def corner_reached(self) -> None:
        """Write a restart at a stop of the task. Commit after a long wait. Write a checkpoint if one is due."""
        self._corner |= self._at
        if self._run.corner in self.task.save_after and str(self._run.corner) not in self.h5["restart"]:
            self.write_place(self.h5.create_group(f"restart/{self._run.corner}"))
            self.commit()
        self.note()

    # -- the file ------------------------------------------------------------------------------------------------

    def end(self, error: str | None) -> None:
        """End the file with the statistics of the run and the message of its error, if any."""
        if self._rows:
            self.commit()
        self.put_place()
        layout.write_statistics(self.h5, {**self._run.statistics, "seconds": self._all_seconds()})
        if error is None and self._run.complete:
            write_extremes(self.h5)
        self.end_file(self._run.complete, error)

    def so_far(self) -> Result:
        """Return the result with the last state in the file."""
        return load(self.path, states=slice(-1, None))

    def _put(self, rows: layout.Rows) -> None:
        self.put({"states": rows})
        self.commit_if_due(time.monotonic())

    def _put_again(self, rows: layout.Rows, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray) -> None:
        self._put({**rows, "step": steps, "dissipation": dissipation, "work": work})

    def write_place(self, group: h5py.Group) -> None:
        """Write the restart of the run, with the numbers of rows up to it."""
        write_restart(group, self._run.restart())
        group["statistics"].attrs["seconds"] = self._all_seconds()
        group.attrs.update(self._corner)

    def _all_seconds(self) -> float:
        return self._seconds + time.monotonic() - self._began

    @classmethod
    def reopened(cls, path: Path, progress: RunProgress | None) -> tuple[FileRecorder, Restart]:
        """Reopen the file of an unfinished run, and return its writer and the restart to continue from.

        Raises
        ------
        InputError
            If the file is no result of a run, holds a finished run, or another process is writing to it.
        """
        with (writer := cls(path)).again() as stored:
            if "wear" in stored:
                raise InputError(str(path), "belongs to a life of wear: continue it with wear and its case")
            if "run" not in stored.attrs:
                raise InputError(str(path), "was not written by a run: there is nothing to continue")
            if stored.attrs["complete"]:
                raise InputError(str(path), "holds a finished run: there is nothing to continue")
            task = replace(stored_task(stored), progress=progress)
            assert task.grid is not None
            layout.check_growing(stored, task.grid.size)
            layout.read_statistics(stored)  # they are written again at the end
            options, nodes = stored["solver"].attrs, all_nodes(stored, task.problem, task.grid)
            writer.take(task, str(options["title"]), layout.read_about(stored), layout.read_beside(stored))
            writer.chosen_arc = bool(options["arc_chosen"])

            def read(group: hdf5.Group) -> _Start:
                restart, rows = read_restart(group, nodes), {name: int(group.attrs[name]) for name in writer._corner}
                return _Start(restart.corner, restart, rows, float(group["statistics"].attrs.get("seconds", 0.0)))

            place = writer.latest(stored, read)
            if place is None:
                raise ValueError(f"there is no part {cls.PLACE}")
            writer._seconds, writer._at = place.seconds, dict(place.rows)
            writer._corner = dict(place.rows)
        return writer, place.restart


def add_coarse(path: Path, beside: Path) -> None:
    """Add the states of a finished run on the coarse grid to the file whose error bars they give, all or none.

    Then remove the file of this run.
    """
    file = FileWriter(path)
    with file.again(), open_result(beside) as stored:
        group, grid, history = file.h5.create_group("coarse"), layout.read_grid(stored), layout.read_history(stored)
        layout.write_grid(group, layout.read_problem(stored), history, grid, layout.node_fields(stored["states"]))
        states = stored["states"]
        for first in range(0, layout.count(states), PIECE):
            rows = layout.read_rows(states, layout.state_rows(states), slice(first, first + PIECE))
            layout.append(group["states"], rows)
        layout.append(group["cycles"], layout.cycle_rows(layout.read_cycles(stored)))
        nodes = all_nodes(stored, layout.read_problem(stored), grid)
        write_restart(group.create_group("restart/latest"), read_restart(stored["restart/latest"], nodes))
        file.commit()
    file.close()
    beside.unlink()


def _with_first(rows: layout.Rows, values: SlipFields) -> layout.Rows:
    """Rows of states with other node values of the first state, by quantity."""
    return {**rows, **{name: np.concatenate([[first], rows[name][1:]]) for name, first in values.items()}}

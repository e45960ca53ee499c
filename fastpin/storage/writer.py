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
from typing import Any, Protocol, TypeVar

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


class GrowingFile:
    """An HDF5 file that changes in transactions, with a checkpoint beside it.

    Attributes
    ----------
    path : Path
    h5 : h5py.File
        The open file.
    run : str
        Name of the run that writes it. A checkpoint has the same one.
    """

    def __init__(self, path: Path, form: str = layout.FORMAT) -> None:
        self.path, self.run, self._form = path, "", form
        self.h5: h5py.File
        self._file: JournaledFile | None = None
        self._next_checkpoint = 0.0

    @property
    def is_open(self) -> bool:
        """Whether the file has begun, and has not ended."""
        return self._file is not None

    def begin(self, write_head: Callable[[h5py.File], None]) -> None:
        """Begin a new file with its head, in place of one that has begun; see :func:`layout.write_head`.

        Raises
        ------
        InputError
            If it can't be written.
        """
        self.abort()
        check_beside(checkpoint_of(self.path))
        check_beside(coarse_of(self.path))
        self.run = uuid.uuid4().hex
        self._file = JournaledFile(self.path, new=True)
        self.h5 = h5py.File(self._file, "w")
        self.h5.flush()  # The signature goes first: what a killed process leaves is known as a result.
        write_head(self.h5)
        self.h5.attrs["run"] = self.run

    @contextmanager
    def again(self, *arguments: str) -> Iterator[hdf5.Group]:
        """Open an unfinished file again, and give its content. An error of the block leaves the file as it was.

        `arguments` are names in errors of the block that don't come from the file.

        Raises
        ------
        InputError
            If the file is empty or no result, or another process is writing to it.
        """
        check_beside(checkpoint_of(self.path))
        check_beside(coarse_of(self.path))
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
                layout.check_format(stored, str(self.path), self._form)
                yield stored
                self.run = str(self.h5.attrs["run"])
                self.h5.attrs.pop("error", None)
        except BaseException:
            self.abort()
            raise

    def note(self, now: float, write: Callable[[h5py.Group], None]) -> None:
        """Write a checkpoint, if one is due at the time `now`. ``write(group)`` fills it."""
        if now <= self._next_checkpoint:
            return
        if self._next_checkpoint:
            with files.replacing(checkpoint_of(self.path), result=True) as temporary, written_h5(temporary) as file:
                file.attrs["run"] = self.run
                write(file)
        duration = time.monotonic() - now
        self._next_checkpoint = time.monotonic() + max(CHECKPOINT_EVERY, CHECKPOINT_SHARE * duration)

    def noted(self, read: Callable[[hdf5.Group], T], place: str) -> T | None:
        """Return what ``read(group)`` makes of the checkpoint of this run; None without one. `place` is for the log."""
        try:
            with h5py.File(checkpoint_of(self.path), "r") as file:
                checkpoint = hdf5.Group(file)
                return read(checkpoint) if checkpoint.attrs["run"] == self.h5.attrs["run"] else None
        except FileNotFoundError:
            return None
        except (OSError, KeyError, ValueError, TypeError, IndexError):
            log.warning("%s can't be read: continuing from an earlier %s", checkpoint_of(self.path), place)
            return None

    def commit(self) -> None:
        """End the transaction."""
        assert self._file is not None
        self.h5.flush()
        self._file.commit()

    def end(self, complete: bool, error: str | None) -> None:
        """End the file of a run that is `complete`, or ended early with the message of an error, if any."""
        self.h5.attrs["complete"] = complete
        self.h5.attrs.pop("error", None)
        if error is not None:
            self.h5.attrs["error"] = error
        self.commit()
        self.close()

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


class WaitingRows:
    """Rows of arrays that wait for the next commit of a file, by the group that takes them.

    Attributes
    ----------
    states : int
        States among them.
    """

    def __init__(self, file: GrowingFile) -> None:
        self._file, self._next_commit, self.states = file, 0.0, 0
        self._rows: dict[str, list[layout.Rows]] = {}

    def is_due(self, now: float) -> bool:
        """Whether they have waited long enough at the time `now`."""
        return self.states >= MOST_PENDING or now > self._next_commit

    def __bool__(self) -> bool:
        return bool(self._rows)

    def add(self, states: int, rows: Mapping[str, layout.Rows]) -> None:
        """Take the rows of so many states."""
        self.states += states
        for group, more in rows.items():
            self._rows.setdefault(group, []).append(more)

    def commit(self) -> None:
        """Write them, and end the transaction."""
        began = time.monotonic()
        try:
            for group, parts in self._rows.items():
                rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
                layout.append(self._file.h5[group], rows)
            self._file.commit()
        except OutputError:
            self._file.abort()
            raise
        self._rows, self.states = {}, 0
        now = time.monotonic()
        self._next_commit = now + COMMIT_SHARE * (now - began)


class FileWriter(Protocol):
    """A recorder that writes to a file."""

    file: GrowingFile

    def end(self, error: str | None) -> None:
        """Write the end of the file, with the message of an error if there is one."""

    def so_far(self) -> Any:
        """Return the result of a run that ended early, from its file."""


@contextmanager
def closing_file(writer: FileWriter) -> Iterator[None]:
    """End the file of a run when the block ends.

    A SolveError or an interrupt ends the file properly, with the message. The exception then holds the result so far
    as ``result``. Any other exception leaves the file as the last transaction left it.
    """
    try:
        yield
    except (SolveError, Interrupted) as error:
        if _ended(writer, str(error)):
            error.result = writer.so_far()
        raise
    except BaseException:
        writer.file.abort()
        raise
    _ended(writer, None)


def _ended(writer: FileWriter, error: str | None) -> bool:
    """End a file with the message of an error, if any. Return False if the file has not begun."""
    if not writer.file.is_open:
        return False
    try:
        with deferred_interrupts():
            writer.end(error)
    except BaseException:
        writer.file.abort()
        raise
    return True


class FileRecorder:
    """The recorder of a run that writes states, cycles and restarts to a file.

    Parameters
    ----------
    path : Path
    task : Task
        The task that is followed. Its corners `save_after` get a restart in the file.
    title : str
    about : About
    beside : mapping of str
        The sections of the case beside the problem, by name.

    Attributes
    ----------
    chosen_arc : bool
        Whether the solver chose the arc. A wider arc may then follow.
    overwrite : bool
        Whether an existing file may be replaced, also the file of an unfinished run.
    """

    def __init__(
        self, path: Path, task: Task, title: str, about: About, beside: Mapping[str, Any] = MappingProxyType({})
    ) -> None:
        self.file = GrowingFile(path)
        self.task = task
        self.chosen_arc = task.options.arc is None and task.grid is None
        self.overwrite = True
        self._title, self._about, self._beside = title, about, beside
        self._run: Run
        self._waiting = WaitingRows(self.file)
        # Pairs of numbers: states, cycles.
        self._at = [0, 0]  # received from the run
        self._stored = [0, 0]  # in the file
        self._corner = [0, 0]  # received up to the last corner
        self._copied: layout.Rows | None = None
        self._seconds = 0.0
        self._began = time.monotonic()

    @property
    def _h5(self) -> h5py.File:
        return self.file.h5

    def reopen(self, file: GrowingFile, restart_group: hdf5.Group) -> None:
        """Continue a file from a restart in it. The run gives the later states again."""
        self.file, self._waiting = file, WaitingRows(file)
        self._stored = [layout.count(self._h5["states"]), layout.count(self._h5["cycles"])]
        counts = int(restart_group.attrs["states"]), int(restart_group.attrs["cycles"])
        self._at, self._corner = list(counts), list(counts)
        self._seconds = float(restart_group["statistics"].attrs.get("seconds", 0.0))

    def check_overwriting(self) -> None:
        """Raise :class:`InputError` if the file exists and must not be overwritten."""
        check_overwriting(self.file.path, self.overwrite)

    # -- calls of the run ----------------------------------------------------------------------------------------

    def begin(self, run: Run) -> None:
        """Begin a new file for `run`, or continue a reopened file on the same grid.

        Raises
        ------
        InputError
            If the file must not be overwritten, or can't be written.
        """
        self._run = run
        if self.file.is_open and np.array_equal(self._h5["grid/theta"][()], run.grid.theta):
            return  # The file was reopened.
        if not self.file.is_open:
            self.check_overwriting()  # Check again: the choice of the arc may have taken long.
        self._waiting = WaitingRows(self.file)
        self._at, self._stored, self._corner = [0, 0], [0, 0], [0, 0]
        task = self.task
        attributes = {**layout.option_attributes(task.options), "nodes": run.grid.size, "title": self._title}
        attributes |= {**self._about.given(), **layout.beside_attributes(self._beside)}
        attributes |= {"arc_chosen": self.chosen_arc, "save_after": sorted(task.save_after)}
        self.file.begin(lambda h5: layout.write_head(h5, task.problem, task.history, run.grid, attributes))
        for name in ("start", "latest"):
            self._write_restart(self._h5.create_group(f"restart/{name}"))
        self._commit()

    def add(self, state: State) -> None:
        """Take a state. It is in the file after the next commit."""
        self._copied = None
        rows = layout.rows_of([state])
        self._put({name: rows[name] for name in layout.state_rows(self._h5["states"])})

    def add_cycle(self, cycle: Cycle) -> None:
        """Take a cycle, unless the file has it already."""
        self._at[1] += 1
        if self._at[1] > self._stored[1]:
            self._waiting.add(0, {"cycles": layout.cycle_rows([cycle])})

    def add_again(self, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray, slip: SlipFields) -> None:
        """Take the latest states once more, with other steps and energies; see :meth:`fastpin.solver.run.Recorder`."""
        size = len(steps)
        if self._copied is None or len(self._copied["step"]) != size:
            self._commit()
            begin = self._at[0] - size
            for first in range(0, size, PIECE):
                last = min(first + PIECE, size)
                group = self._h5["states"]
                rows = layout.read_rows(group, layout.state_rows(group), slice(begin + first, begin + last))
                rows = rows if first else _with_first(rows, slip)
                self._put_again(rows, steps[first:last], dissipation[first:last], work[first:last])
                self._copied = rows if size <= PIECE else None
        else:
            self._copied = _with_first(self._copied, slip)
            self._put_again(self._copied, steps, dissipation, work)

    def corner_reached(self) -> None:
        """Write a restart at a stop of the task. Commit after a long wait. Write a checkpoint if one is due."""
        self._corner = list(self._at)
        now = time.monotonic()
        if self._run.corner in self.task.save_after and str(self._run.corner) not in self._h5["restart"]:
            self._write_restart(self._h5.create_group(f"restart/{self._run.corner}"))
            self._commit()
        elif self._waiting.is_due(now):
            self._commit()

        def write(group: h5py.Group) -> None:
            self._commit()
            self._write_restart(group.create_group("restart"))
            log.debug("checkpoint after corner %d", self._run.corner)

        self.file.note(now, write)

    # -- the file ------------------------------------------------------------------------------------------------

    def end(self, error: str | None) -> None:
        """End the file with the statistics of the run and the message of its error, if any."""
        run = self._run
        if self._waiting:
            self._commit()
        del self._h5["restart/latest"]
        self._write_restart(self._h5.create_group("restart/latest"))
        layout.write_statistics(self._h5, {**run.statistics, "seconds": self._all_seconds()})
        if error is None and run.complete:
            write_extremes(self._h5)
        self.file.end(run.complete, error)
        clear_checkpoints(self.file.path)

    def so_far(self) -> Result:
        """Return the result with the last state in the file."""
        return load(self.file.path, states=slice(-1, None))

    def _put(self, rows: layout.Rows) -> None:
        """Take the next rows. Rows that are in the file already are compared, and not written again."""
        size = len(rows["step"])
        known = min(max(self._stored[0] - self._at[0], 0), size)
        if known:
            stored = self._h5["states/pressure"][self._at[0] : self._at[0] + known]
            if not np.array_equal(stored, rows["pressure"][:known]):
                words = "%s: states found again differ from those in the file: another machine or version?"
                log.warning(words, self.file.path)
            rows = {name: array[known:] for name, array in rows.items()}
        self._at[0] += size
        if size > known:
            self._waiting.add(size - known, {"states": rows})
            if self._waiting.is_due(time.monotonic()):
                self._commit()

    def _put_again(self, rows: layout.Rows, steps: np.ndarray, dissipation: np.ndarray, work: np.ndarray) -> None:
        self._put({**rows, "step": steps, "dissipation": dissipation, "work": work})

    def _commit(self) -> None:
        """Write the waiting states and cycles, and end the transaction."""
        self._waiting.commit()
        self._stored = [max(stored, at) for stored, at in zip(self._stored, self._at, strict=True)]
        log.debug("%d states in the file", self._stored[0])

    def _write_restart(self, group: h5py.Group) -> None:
        write_restart(group, self._run.restart())
        group["statistics"].attrs["seconds"] = self._all_seconds()
        group.attrs.update(states=self._corner[0], cycles=self._corner[1])

    def _all_seconds(self) -> float:
        return self._seconds + time.monotonic() - self._began


def add_coarse(path: Path, beside: Path) -> None:
    """Add the states of a finished run on the coarse grid to the file whose error bars they give, all or none.

    Then remove the file of this run.
    """
    file = GrowingFile(path)
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


def reopen(path: Path, progress: RunProgress | None) -> tuple[FileRecorder, Restart]:
    """Reopen the file of an unfinished run, and return its writer and the restart to continue from.

    Raises
    ------
    InputError
        If the file is no result of a run, holds a finished run, or another process is writing to it.
    """
    file = GrowingFile(path)
    with file.again() as stored:
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
        options, latest = stored["solver"].attrs, stored["restart/latest"]
        writer = FileRecorder(path, task, str(options["title"]), layout.read_about(stored), layout.read_beside(stored))
        writer.chosen_arc = bool(options["arc_chosen"])
        nodes = all_nodes(stored, task.problem, task.grid)

        def read(group: hdf5.Group) -> Restart:
            restart = read_restart(group, nodes)
            writer.reopen(file, group)
            return restart

        def of_checkpoint(checkpoint: hdf5.Group) -> Restart | None:
            group = checkpoint["restart"]
            return read(group) if group.attrs["corner"] >= latest.attrs["corner"] else None

        return writer, file.noted(of_checkpoint, "corner") or read(latest)

"""A stored result, of which only the parts that are asked for are read."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from fastpin.model.case import Case
from fastpin.model.checks import file_path, items, whole_number
from fastpin.solver.result import Result
from fastpin.states import extremes
from fastpin.states.extremes import AT_ONCE, Found, KeptStates
from fastpin.states.state import State
from fastpin.storage import hdf5, journal, layout
from fastpin.storage.held import Held
from fastpin.storage.store import ALL, open_result, read_result
from fastpin.storage.stored_states import read_extremes


class StoredResult(Held):
    """A stored result. Its run may still be going on. A part is read when it is first asked for, and then kept.

    Each reading opens the file. In a ``with`` block a file that no run has begun to write is opened once, and again if
    another process has changed it.

    Raises
    ------
    InputError
        All readings raise it, see :func:`fastpin.load`.
    """

    def __init__(self, path: str | Path) -> None:
        self.path: Path = file_path("path", path)
        self._kept: Any = None
        self._stack = contextlib.ExitStack()
        self._stamp: tuple[int, ...] | None = None

    def __enter__(self) -> Self:
        if not journal.journal_of(self.path).exists():  # else a run is writing, and must not wait for the whole block
            self._stamp = self._now()
            self._kept = self._stack.enter_context(open_result(self.path, form=None))
        return self

    def __exit__(self, *error: object) -> None:
        self._close()

    def _close(self) -> None:
        self._kept = None
        self._stack.close()

    def _now(self) -> tuple[int, ...] | None:
        """Numbers that change with the file; None for a result in the index of a sweep."""
        found = self.path.stat() if self.path.exists() else None
        return found and (found.st_ino, found.st_size, found.st_mtime_ns)

    @contextlib.contextmanager
    def opened(self, *arguments: str, form: str | None = layout.FORMAT) -> Iterator[Any]:
        """Open the file for a reading, see :func:`open_result`."""
        if self._kept is not None and self._now() != self._stamp:
            self._close()
        if self._kept is None:
            with open_result(self.path, *arguments, form=form) as file:
                yield file
            return
        with hdf5.reading(self.path, *arguments):
            layout.check_format(self._kept, str(self.path), form)
            yield self._kept

    # -- what is stored beside the states ------------------------------------------------------------------------

    @property
    def is_joint(self) -> bool:
        """Whether it is the result of a joint of several pins."""
        with self.opened(form=None) as file:
            return bool(file.attrs["format"] == layout.JOINT)

    @property
    def is_life(self) -> bool:
        """Whether it is that of a life of wear."""
        with self.opened() as file:
            return "wear" in file

    @cached_property
    def case(self) -> Case:
        """Problem, history, options, title, who made it for what, and its questions."""
        with self.opened() as file:
            problem, history, options = layout.read_problem(file), layout.read_history(file), layout.read_options(file)
            title = hdf5.text_of(file["solver"].attrs.get("title", ""))
            return Case(problem, history, options, title, layout.read_about(file), **layout.read_beside(file))

    @cached_property
    def origin(self) -> dict[str, str]:
        """Versions, date, machine and platform by name. What a file does not hold is left out.

        "created" is the date of the file's first writing, UTC, ISO 8601. "run" is there only if a run has written the
        file, which then holds all options of the solver.
        """
        with self.opened(form=None) as file:
            attributes = {hdf5.text_of(name): hdf5.text_of(value) for name, value in file.attrs.items()}
        versions = {name: value for name, value in attributes.items() if name.startswith("version_")}
        found = {name.removeprefix("version_"): value for name, value in versions.items()}
        return found | {name: attributes[name] for name in ("created", "host", "platform", "run") if name in attributes}

    @cached_property
    def error(self) -> str | None:
        """The message of the error that ended the run early; None if no error did."""
        with self.opened(form=None) as file:
            error = file.attrs.get("error")
            return None if error is None else hdf5.text_of(error)

    @property
    def lacks_error_bars(self) -> bool:
        """Whether the run is finished, but the run on the coarse grid that gives its error bars is not."""
        with self.opened() as file:
            wanted = layout.read_options(file).error_bars and bool(file.attrs["complete"]) and "run" in file.attrs
            return wanted and "coarse" not in file

    # -- states --------------------------------------------------------------------------------------------------

    @cached_property
    def result(self) -> Result:  # type: ignore[override]
        """The result without its states."""
        return self._read([])

    @cached_property
    def points(self) -> np.ndarray:
        """Load points of all states, shape (states,)."""
        with self.opened() as file:
            points: np.ndarray = file["states/step"][()] + file["states/fraction"][()]
            return points

    @cached_property
    def few(self) -> list[State] | None:
        """All states if they are few: reading them one after the other took half of a ``fastpin run``."""
        return self._read(ALL).states if self.points.size <= AT_ONCE else None

    @cached_property
    def extremes(self) -> Found:
        """The extremes of all states that texts and figures show."""
        return self._found(extremes.marked_extremes)

    @cached_property
    def residuals(self) -> dict[str, float]:
        """The largest residual of each kind over all states."""
        with self.opened() as file:
            rows: np.ndarray = file["states/residuals"][()]
        return dict(zip(layout.RESIDUALS, rows.max(axis=0).tolist(), strict=True)) if len(rows) else {}

    @cached_property
    def pressure(self) -> float:
        """The largest pressure at a node over all states, Pa."""
        with self.opened() as file:
            rows = file["states/pressure"]
            parts = (rows[begin : begin + AT_ONCE] for begin in range(0, len(rows), AT_ONCE))
            return max((float(part.max(initial=0.0)) for part in parts), default=0.0)

    def read(self, places: Sequence[int]) -> list[State]:
        """Return the states at these places, in increasing order."""
        given = items("places", places, "places of states")
        places = [whole_number("places", place, 0, self.points.size - 1) for place in given]
        return self._read(places).states if self.few is None else [self.few[place] for place in places]

    def whole(self) -> Result:
        """Return the result with all its states."""
        return self._read(ALL)

    def _read(self, states: slice | Sequence[int]) -> Result:
        with self.opened() as file:
            return read_result(file, self.path, states)[0]

    def _yield_extremes(self) -> Found:
        return self._found(extremes.yield_extremes)

    def _found(self, find: Callable[[KeptStates], Found]) -> Found:
        """The extremes that `find` finds among all states, or those that the file names."""
        if self.few is not None:
            return find(KeptStates(self.few)) if self.few else Found()
        with self.opened() as file:
            return read_extremes(file, find)

"""The subjects of figures: results in memory and in files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fastpin.errors import InputError
from fastpin.figures.states import DrawnStates, drawn_states, stored_states
from fastpin.model import Case, Problem
from fastpin.model.beside import beside_of
from fastpin.model.checks import as_toml, instance
from fastpin.solver import Result, WearResult
from fastpin.states.choice import NO_CYCLE, StateChoice, span_of
from fastpin.states.cycles import Cycle
from fastpin.states.state import State
from fastpin.storage.recording import stored_case
from fastpin.storage.store import load, places_between
from fastpin.storage.wear_files import holds_wear, load_wear


class InMemory:
    """A result, a sequence of states of one problem and on one grid, one state, or a life of wear.

    The states of a life are those over one cycle on each stored profile.
    """

    progress: Callable[[float, float], None] | None = None

    def __init__(self, result: Sequence[State] | State | WearResult) -> None:
        self._life = result if isinstance(result, WearResult) else None
        self._result = Result.of_life(result) if isinstance(result, WearResult) else result

    @property
    def source(self) -> str:
        """A key of :data:`fastpin.figures.kinds.SOURCES`."""
        return "result" if self._life is None else "life"

    @property
    def cycles(self) -> Sequence[Cycle]:
        """The cycles of the history."""
        return self._result.cycles if isinstance(self._result, Result) else ()

    def states(self, states: StateChoice = None, **how: Any) -> DrawnStates:
        """Return the states of a figure, see :func:`fastpin.figures.states.drawn_states`."""
        return drawn_states(self._result, states, **how)

    def result(self) -> Result:
        """Return the result."""
        return instance("result", self._result, Result, "a Result")

    def part(self, cycle: Cycle) -> Result:
        """Return the result."""
        return self.result()

    def whole(self) -> Result:
        """Return the result."""
        return self.result()

    def beside(self, name: str) -> None:
        """Return None: a result in memory does not know the sections of its case, such as [fatigue]."""

    def wear(self) -> WearResult:
        """Return the life of wear."""
        return instance("result", self._life, WearResult, "a WearResult")


class InFile:
    """The stored result of a run. Only the states that a figure shows are read.

    Attributes
    ----------
    progress : callable or None
        ``progress(done, total)`` follows figures that take long to compute.
    """

    source = "result"

    def __init__(self, path: Path, progress: Callable[[float, float], None] | None = None) -> None:
        self._path, self.progress = path, progress

    @property
    def cycles(self) -> Sequence[Cycle]:
        """The cycles of the history."""
        return self.result().cycles

    def states(self, states: StateChoice = None, **how: Any) -> DrawnStates:
        """Return the states of a figure, see :func:`fastpin.figures.states.stored_states`."""
        return stored_states(self._path, states, **how)

    def result(self) -> Result:
        """Return the result without its states."""
        return load(self._path, states=[])

    def part(self, cycle: Cycle) -> Result:
        """Return the result with the states of one cycle only."""
        return load(self._path, states=places_between(self._path, *span_of(cycle)))

    def whole(self) -> Result:
        """Return the result with all its states."""
        return load(self._path)

    def beside(self, name: str) -> Any:
        """Return the section of its case with this name, such as "fatigue"; None if the case had none."""
        return beside_of(stored_case(self._path)).get(name)

    def wear(self) -> WearResult:
        """Raise :class:`InputError`: there is no life of wear."""
        return load_wear(self._path)


def problem_of(joint: Problem | Case | Result) -> Problem:
    """Return the problem of a joint. Anything else raises :class:`InputError`."""
    if not isinstance(joint, (Problem, Case, Result)):
        raise InputError("joint", f"must be a Problem, Case or Result, not {as_toml(joint)}")
    return joint if isinstance(joint, Problem) else joint.problem


Subject = InMemory | InFile
"""A result, or states, of which figures are made. States alone have no result."""


def stored_subject(path: Path, progress: Callable[[float, float], None] | None = None) -> Subject:
    """Return the result of a run, or the life of wear, in a file. The progress is that of :class:`InFile`."""
    return InMemory(load_wear(path)) if holds_wear(path) else InFile(path, progress)


def with_stored_cycles(subject: Subject) -> WearResult:
    """Return the life of wear of a subject. Without a stored cycle raise :class:`InputError`."""
    life = subject.wear()
    if not len(life):
        raise InputError("result", "has no stored cycle: the life of wear ended before its first one")
    return life


def with_cycles(subject: Subject) -> Result:
    """Return the result of a subject, perhaps without its states. Without a cycle raise :class:`InputError`."""
    result = subject.result()
    if not result.cycles:
        raise InputError("result", NO_CYCLE)
    return result

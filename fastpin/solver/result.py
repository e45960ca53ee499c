"""The result of a solution, and the restart from which another solution continues."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.history import CycleKey, LoadHistory
from fastpin.model.problem import Problem
from fastpin.solver.configuration import Configuration
from fastpin.solver.repeats import CycleEnd, Repeats
from fastpin.states.cycles import Cycle
from fastpin.states.error_bars import ErrorBars
from fastpin.states.state import State

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Restart:
    """What is needed to go on from a corner, to the same bits.

    Attributes
    ----------
    corner : int
        Corners of the history that were followed.
    load : ndarray, shape (loads,)
        The load there, SI.
    force : float
        The reference force, N/m.
    configuration : Configuration
        Its dissipation and work are 0.
    dissipation, work : float
        Until there (dimensionless).
    repeats : Repeats
    marks : dict
        The latest end of each cycle.
    statistics : dict of str to float
    """

    corner: int
    load: np.ndarray
    force: float
    configuration: Configuration
    dissipation: float
    work: float
    repeats: Repeats
    marks: dict[CycleKey, CycleEnd]
    statistics: dict[str, float]

    def elsewhere(self) -> Restart:
        """The same for another history, which begins here."""
        return replace(self, corner=0, repeats=self.repeats.copy(), marks={}, statistics={})


@dataclass(eq=False, repr=False)
class Result(Sequence[State]):
    """The states of one solution, in the order of the history: a sequence of :class:`State`.

    Attributes
    ----------
    states : list of State
    problem : Problem
    history : LoadHistory
    grid : Grid
    method : str
        "path" or "increment".
    statistics : dict of str to float
        "events" (changes of status met), "exchanges" (changes made), "rebuilds" (tableaus built anew, and states that a
        factorisation computed), "increments", "repeated" (steps that were known from before) and "seconds".
    complete : bool
        Whether the whole history was followed; False in the result that an error carries.
    restart : Restart or None
        For ``solve(..., start=result)``.
    cycles : tuple of Cycle
        The changes of each cycle of the history, in order; empty where the history has no repeated blocks.
    coarse : Result or None
        The same history on a grid with half the intervals, with ``solve(..., error_bars=True)``.
    """

    states: list[State]
    problem: Problem
    history: LoadHistory
    grid: Grid
    method: str
    statistics: dict[str, float]
    complete: bool
    restart: Restart | None = None
    cycles: tuple[Cycle, ...] = ()
    coarse: Result | None = None

    def with_coarse(self, coarse: Result) -> Result:
        """This result with error bars, from the states of the same history on a coarser grid."""
        states = []
        for state, other in zip(self, coarse, strict=True):
            assert (state.step, state.fraction) == (other.step, other.fraction)
            states.append(replace(state, error_bars=ErrorBars(state, other)))
        return replace(self, states=states, coarse=coarse)

    def plot(self, path: str | Path | None = None, **options: Any) -> Figure:
        """Draw the tractions of all states; see :func:`fastpin.plot_tractions`, whose options these are."""
        import fastpin

        return fastpin.plot_tractions(self, path, **options)

    def save(self, path: str | Path) -> None:
        """Write the result to an HDF5 file; see :func:`fastpin.save`."""
        import fastpin

        fastpin.save(self, path)

    def to_xarray(self) -> xarray.Dataset:
        """All states as an :class:`xarray.Dataset`; see :func:`fastpin.storage.to_xarray`."""
        import fastpin

        return fastpin.storage.to_xarray(self)

    def to_dataframe(self) -> pandas.DataFrame:
        """The reported quantities, a row a state; see :func:`fastpin.storage.to_dataframe`."""
        import fastpin

        return fastpin.storage.to_dataframe(self)

    def __repr__(self) -> str:
        whole = "complete" if self.complete else "incomplete"
        head = f"<Result: {len(self)} states, {self.grid.size} nodes, {self.method} solver, {whole}"
        if not self.states:
            return f"{head}>"
        cycles = f", {len(self.cycles):,} cycles" if self.cycles else ""
        return f"{head}{cycles}\n last: {self.states[-1]!r}>"

    def _repr_html_(self) -> str:
        """A small table and a figure, for notebooks."""
        import fastpin

        return fastpin.figures.result_html(self)

    @overload
    def __getitem__(self, index: int) -> State: ...

    @overload
    def __getitem__(self, index: slice) -> list[State]: ...

    def __getitem__(self, index: int | slice) -> State | list[State]:
        return self.states[index]

    def __len__(self) -> int:
        return len(self.states)

    def __iter__(self) -> Iterator[State]:
        return iter(self.states)

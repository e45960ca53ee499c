"""The result of a solution, and the restart from which another solution continues."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from fastpin import states
from fastpin.elasticity.interfaces import seat_grid
from fastpin.errors import InputError
from fastpin.model.checks import instance, whole_number
from fastpin.model.grid import Grid
from fastpin.model.history import CycleKey, LoadHistory
from fastpin.model.points import Body
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.synonyms import explains_attributes
from fastpin.solver.configuration import Configuration
from fastpin.solver.repeats import CycleEnd, Repeats
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.states.choice import StateChoice, loaded_span_of, missing_corners, states_between
from fastpin.states.cycles import Cycle
from fastpin.states.load_cycle import LoadCycle
from fastpin.states.quantities import load_point
from fastpin.states.state import State

if TYPE_CHECKING:
    import pandas
    import xarray

    from fastpin.model.assessment import FatigueAssessment  # a solve needs no assessment
    from fastpin.states.extremes import Extremes  # this module imports compiled code


@dataclass(frozen=True, eq=False, repr=False)
class Restart(ReadOnly):
    """Everything from which a run continues at a corner, to the same bits.

    Attributes
    ----------
    corner : int
        Number of corners of the history that were followed.
    load : ndarray, shape (loads,)
        The load at the corner, SI.
    force : float
        The reference force, N/m.
    configuration : Configuration
        The configuration at the corner. Its dissipation and work are 0.
    dissipation, work : float
        Energies from the start to the corner (dimensionless).
    repeats : Repeats
        The remembered configurations.
    marks : dict of CycleKey to CycleEnd
        The latest end of each cycle.
    statistics : dict of str to float
        Statistics of the run up to the corner.
    slip_tally : SlipTally
        What each node has slipped from the latest kept state to the corner (dimensionless).
    seat_dissipation : float
        The part of the dissipation in the seat of a bush.
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
    slip_tally: SlipTally = NOT_COUNTED
    seat_dissipation: float = 0.0

    def __repr__(self) -> str:
        return f"<Restart: corner {self.corner}>"

    def for_new_history(self) -> Restart:
        """The restart for another history that begins here."""
        return replace(self, corner=0, repeats=self.repeats.copy(), marks={}, statistics={}, slip_tally=NOT_COUNTED)


@explains_attributes("result[-1]", lambda: State)
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
        "events" (changes of status that the load reached), "exchanges" (changes made in the tableau), "rebuilds"
        (tableaus built anew, and states computed by a factorisation), "increments", "repeated" (steps taken from the
        period before, not solved), "resettled" (events at which Lemke's method found the statuses), "jumps" (snaps of
        the pin to a state at a finite distance), "released" (narrow contacts that carried next to nothing and lost
        their memory) and "seconds".
    complete : bool
        Whether the whole history was followed; False in the result that an error carries.
    restart : Restart or None
        The restart for ``solve(..., start=result)``; None if the result's file holds states only.
    cycles : tuple of Cycle
        The changes of each cycle of the history, in order; empty where the history has no repeated blocks.
    coarse : Result or None
        The result of the same history on a grid with half the intervals, with ``solve(..., error_bars=True)``.
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

    @classmethod
    def of_life(cls, life: Any, after: float | None = None) -> Result:
        """The states of a life of wear, over one cycle on each stored profile, or on that `after` so many cycles.

        The cycles of the result are these cycles.

        Raises
        ------
        InputError
            If `life` is no WearResult, or no profile is stored there.
        """
        import fastpin.wear_lives

        instance("life", life, fastpin.wear_lives.WearResult, "a WearResult")
        chosen = life.cycles if after is None else (life.after(after),)
        return cls(
            [state for each in chosen for state in each.states], life.problem, life.history, life.grid, "path",
            life.statistics, life.complete, cycles=tuple(each.changes for each in chosen),
        )  # fmt: skip

    @property
    def seat(self) -> Result | None:
        """The contact of a bush that slips in its seat, as a result of its own; None without such a bush.

        Its states are ``State.seat`` of the states here. Nothing can continue from it. Its cycles have the dissipation
        in the seat and the rotation of the bush, by which it walks; NaN where the states at their ends were not kept.
        The changes of the tractions are those of the whole joint.
        """
        problem = self.problem.seat
        if problem is None:
            return None
        states = [state.seat for state in self.states if state.seat is not None]
        grid = states[0].grid if states else seat_grid(self.problem, self.grid)
        coarse = None if self.coarse is None else self.coarse.seat
        corners = {load_point(state): state for state in states}
        cycles = tuple(_of_seat(cycle, corners) for cycle in self.cycles)
        return replace(self, states=states, problem=problem, grid=grid, restart=None, cycles=cycles, coarse=coarse)

    def cycle(self, place: int = -1, *, first: int | None = None, last: int | None = None) -> LoadCycle:
        """The quantities over a cycle: ranges of slip and tractions, friction energy, loops of the loads.

        Parameters
        ----------
        place : int
            Place of the cycle in ``cycles``; the last one unless given. A negative place counts from the end.
        first, last : int, optional
            In place of `place`: the corners, counted from 1, between which any part of the history lies. The loads at
            both may differ.

        Raises
        ------
        InputError
            If there is no such cycle, if the state at one of its ends was not kept, or if the loads at its ends differ.
        """
        if (first is None) != (last is None):
            raise InputError("first", "and last go together: give both corners, or none")
        if first is not None and last is not None:
            begin = whole_number("first", first, 1, max(len(self.history) - 1, 1))
            return LoadCycle(self._between(begin, whole_number("last", last, begin + 1, len(self.history))))
        if not self.cycles:
            raise InputError("cycle", "no cycle of the history has ended; give the corners first and last")
        cycle = self.cycles[whole_number("place", place, -len(self.cycles), len(self.cycles) - 1)]
        begin, end = loaded_span_of(cycle)
        over_cycle = LoadCycle(self._between(begin, end))
        if not over_cycle.is_closed:
            raise InputError(
                "cycle",
                f"the cycle to corner {end} is not closed: {over_cycle.differing_loads[0]} differs at its ends; "
                f"first={begin}, last={end} gives this part of the history all the same",
            )
        return over_cycle

    def _between(self, first: int, last: int) -> tuple[State, ...]:
        """The kept states from one corner to another, which count from 1."""
        states = states_between(self.states, first, last)
        points = [load_point(state) for state in states]
        for corner, place in ((first, 0), (last, -1)):
            if not points or points[place] != corner:
                raise InputError("cycle", f"the state at corner {corner} was not kept, or not loaded")
        return tuple(states)

    def extremes(self) -> dict[str, Extremes]:
        """The smallest and the largest value of each quantity over all states of the result, and where they occur.

        Each value equals the reading of its state, to the last bit. Few states are read for it. What happens between
        two kept states is not known.

        Returns
        -------
        dict of str to Extremes
            By the names of :data:`fastpin.states.QUANTITIES` without angles and Kt, and "bush_least_friction", the
            friction that just holds the bush. A body whose yield strength is known has its largest von Mises stress:
            "von_mises_pin", "von_mises_plate" and "von_mises_bush". An entry has ``smallest`` and ``largest``, each
            with ``value`` (SI units, with sign), ``place`` (the place of the state in the result) and ``load_point``.
            The shear traction of largest magnitude is the larger one of the two. A quantity that the problem does not
            have is left out: the hoop stress of a rigid plate, and the margins of a bush. A result without states has
            no extremes.

        Raises
        ------
        InputError
            If the states are on different grids.
        """
        if any(not np.array_equal(state.theta, self.grid.theta) for state in self):
            raise InputError("result", "all states must be on the grid of the result")
        return states.extremes.all_extremes(states.extremes.KeptStates(self.states)) if self.states else {}

    def plot(self, path: str | Path | None = None, states: StateChoice = None, **options: Any) -> Any:
        """Draw the tractions, or another kind of figure, and return the matplotlib figure.

        Parameters
        ----------
        path, **options
            See :func:`fastpin.plot_tractions`. With ``kind="loops"``, or another kind of ``fastpin plot``, the options
            of this kind, such as ``cycle="all"``.
        states : str, number, sequence of numbers or slice, optional
            "last", "cycle" (the last one), "all", or load points, which count from 1 as in tables: 2, [2, 3.5] or
            "2,3.5". A slice chooses places in the result. Unless given, all states of a short history, or the last
            cycle of a long one.

        Raises
        ------
        InputError
            If there is no such state. Also see :func:`fastpin.plot_tractions`.
        """
        import fastpin

        if states is not None:
            options["states"] = states
        return fastpin.figures.plotting.plot_result(self, options.pop("kind", "tractions"), path, **options)

    def fatigue(self, criterion: Any, body: Body = "plate", **options: Any) -> Any:
        """Fatigue of plate or pin over the last cycle of the history, or over all states if it has no cycles.

        Parameters
        ----------
        criterion, body, **options
            See :func:`fastpin.damage.fatigue`.

        Returns
        -------
        fastpin.damage.Fatigue

        Raises
        ------
        InputError
            See :func:`fastpin.damage.fatigue` and :func:`fastpin.damage.cycle_states`.
        """
        from fastpin.damage import cycle_states, fatigue

        states = cycle_states(self, self.cycles[-1]) if self.cycles else self.states
        return fatigue(states, criterion, body, **options)

    def spectrum_damage(self, criterion: Any = "smith-watson-topper", body: Body = "plate", **options: Any) -> Any:
        """Damage of plate, bush or pin over the whole history, which is taken as one pass of a repeated spectrum.

        Parameters
        ----------
        criterion, body, **options
            See :func:`fastpin.damage.spectrum_damage`.

        Returns
        -------
        fastpin.damage.SpectrumDamage

        Raises
        ------
        InputError
            See :func:`fastpin.damage.spectrum_damage`; also if the state at a corner was not kept.
        """
        from fastpin.damage import spectrum_damage

        self._check_corners()
        return spectrum_damage(self.states, criterion, body, **options)

    def assessed_fatigue(
        self, how: FatigueAssessment | None = None, progress: Callable[[float, float], None] | None = None
    ) -> Any:
        """Damage of the bodies over the history as a spectrum, as a section [fatigue] of a case asks for it.

        Parameters
        ----------
        how : FatigueAssessment, optional
            Such as ``case.fatigue``. Its ``over`` chooses the whole history or the last cycle.
        progress : callable, optional
            Called as ``progress(done, total)`` now and then.

        Returns
        -------
        list of fastpin.damage.SpectrumDamage
            The largest damage first, criterion by criterion, see :func:`fastpin.damage.assessed_fatigue`.

        Raises
        ------
        InputError
            See :func:`fastpin.damage.assessed_fatigue`; also if the history has no cycle, or the state at a corner was
            not kept.
        """
        from fastpin.damage import assessed_fatigue

        return assessed_fatigue(self._assessed_states(how), how, progress)

    def assessed_reserves(
        self, how: FatigueAssessment | None = None, progress: Callable[[float, float], None] | None = None
    ) -> Any:
        """By what factor all stresses may grow until the life is missed that a section [fatigue] asks for.

        Parameters
        ----------
        how, progress
            See :meth:`assessed_fatigue`.

        Returns
        -------
        list of fastpin.damage.StressReserve
            The smallest factor first, criterion by criterion, see :func:`fastpin.damage.assessed_reserves`.

        Raises
        ------
        InputError
            See :meth:`assessed_fatigue`.
        """
        from fastpin.damage import assessed_reserves

        return assessed_reserves(self._assessed_states(how), how, progress)

    def _assessed_states(self, how: FatigueAssessment | None) -> Any:
        """Return the states of one pass of the spectrum of an assessment."""
        from fastpin.damage import cycle_states
        from fastpin.model import FatigueAssessment

        chosen = FatigueAssessment() if how is None else how
        if instance("how", chosen, FatigueAssessment, "a FatigueAssessment").over == "history":
            self._check_corners()
            return self.states
        if not self.cycles:
            raise InputError("over", "the history has no cycles: none of its blocks is repeated")
        return cycle_states(self, self.cycles[-1])

    def _check_corners(self) -> None:
        """Refuse a result without the states at all corners of its history."""
        missing = missing_corners(self.states, 1, len(self.history))
        if missing:
            raise InputError("states", f"must hold all corners of the history; {len(missing):,} were not kept")

    def wear(self, **how: Any) -> Any:
        """Follow the last cycle of the history many times on a profile that wears.

        Parameters
        ----------
        **how
            See :func:`fastpin.wear`, such as ``coefficient=1e-15, cycles=1e5``. The nodes are as many as here.

        Returns
        -------
        WearResult

        Raises
        ------
        InputError, SolveError
            See :func:`fastpin.wear`.
        """
        import fastpin

        return fastpin.wear(self.problem, self.history, **({"nodes": self.grid.size} | how))

    def report(self, path: str | Path, **options: Any) -> None:
        """Write a report of the result, an HTML page or a PDF: case, loads, margins, key figures, figures, checks.

        Parameters
        ----------
        path, **options
            See :func:`fastpin.pages.write_report`.

        Raises
        ------
        InputError
            See :func:`fastpin.pages.write_report`.
        """
        from fastpin.pages import write_report

        write_report(self, path, **options)

    def save(self, path: str | Path) -> None:
        """Write the result to an HDF5 file; see :func:`fastpin.save`."""
        import fastpin

        fastpin.save(self, path)

    def to_xarray(self) -> xarray.Dataset:
        """All states as an :class:`xarray.Dataset`; see :func:`fastpin.storage.to_xarray`."""
        import fastpin

        return fastpin.storage.to_xarray(self)

    def to_dataframe(self) -> pandas.DataFrame:
        """The reported quantities, with a row for each state; see :func:`fastpin.storage.to_dataframe`."""
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


def _of_seat(cycle: Cycle, states: dict[float, State]) -> Cycle:
    """A cycle of a joint as one of its seat, whose `states` are given by their load points."""
    first, last = (states.get(float(corner)) for corner in (cycle.corner + 1 - cycle.length, cycle.corner + 1))
    if first is None or last is None:
        return cycle._replace(dissipation=math.nan, rotation_change=math.nan)
    return cycle._replace(
        dissipation=last.dissipation - first.dissipation, rotation_change=last.rotation - first.rotation
    )


def without_restart(result: Result) -> Result:
    """A result from which nothing can continue, as it is stored in a sweep."""
    coarse = None if result.coarse is None else replace(result.coarse, restart=None)
    return replace(result, restart=None, coarse=coarse)


def with_error_bars(result: Result, coarse: Result) -> Result:
    """A result with error bars, from the states of the same history on a coarser grid."""
    fine = []
    for state, coarse_state in zip(result, coarse, strict=True):
        assert (state.step, state.fraction) == (coarse_state.step, coarse_state.fraction)
        seat = state.seat
        if seat is not None and coarse_state.seat is not None:
            seat = replace(seat, error_bars=states.error_bars.PairBars(seat, coarse_state.seat))
        fine.append(replace(state, error_bars=states.error_bars.PairBars(state, coarse_state), seat=seat))
    return replace(result, states=fine, coarse=coarse)

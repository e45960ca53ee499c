"""A session follows a load history load by load, for programs that choose the next load from the present state.

:class:`Session` keeps the matrices and the present contact. Its nodes grow with the contact, see
:mod:`fastpin.sessions.growth`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableSequence, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np

from fastpin.drift.friction import follow_friction, followed_problem
from fastpin.elasticity.build import build_system
from fastpin.elasticity.system import IN_PLACE, System
from fastpin.errors import InputError
from fastpin.model.acting import MOST_LOAD, check_loads
from fastpin.model.checks import choice, true_or_false
from fastpin.model.doubts import doubts, warn_of
from fastpin.model.grid import Grid
from fastpin.model.history import MAX_CORNERS, LoadHistory
from fastpin.model.loads import ACTING, LOAD_KIND, LOADS, Corner, complete_load
from fastpin.model.options import ALL_ROUND, KeepRule, SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.units import named_loads
from fastpin.sessions.growth import (
    LatestState,
    carried,
    dividing_the_circle,
    most_nodes,
    touches_outside,
    wider_grid,
)
from fastpin.sessions.place import Loads, Place, Undoing, changed_problem, check_nodes
from fastpin.solver.arc import first_direction
from fastpin.solver.errors import ArcError, ConvergenceError, Interrupted, SolveError
from fastpin.solver.repeats import Repeats
from fastpin.solver.result import Restart, Result
from fastpin.solver.run import Run
from fastpin.solver.solving import DEFAULTS, solve
from fastpin.solver.task import (
    Task,
    as_history,
    check_options,
    deferred_interrupts,
    one_blas_thread,
    reference_force,
)
from fastpin.states.state import State

Replay = Literal["history", "load", "none", "follow"]
"""What a change of the problem means: the same history, the last load in one step, no load, or a step of its own."""

LAST_ONLY = f"every {MAX_CORNERS}"
"""The rule that keeps only the last state of a history."""

NO_HISTORY = LoadHistory([{}])
"""The history of a run that gets its loads one by one."""


class Session(Undoing[Place, State]):
    """A contact that is led from load to load.

    A session gives the states of :func:`fastpin.solve`, to the same bits: the states of ``solve(session.problem,
    session.history, grid=session.grid)``. It keeps the matrices, so a small step takes a millisecond.

    The first nodes lie on the arc that :func:`fastpin.solve` would choose for the first load, or for `expected`. Later
    the nodes follow the contact:

    * Where the contact reaches an end of the arc, the arc gets more nodes in the same spacing, up to the whole circle.
      The other nodes stay in their places. States then equal those of :func:`fastpin.solve` up to rounding.
    * The gap beyond the arc is watched at every load. If the pin touches there, the arc becomes the whole circle.
    * In a bush that slips the nodes go all round from the first load on.
    * New nodes are chosen for the whole history, and the history is followed again, in three cases: the arc would get
      more than 4 times `nodes` or 3,000 nodes; the spacing does not divide the circle; or the contact gets too narrow
      for the nodes. A narrow contact is an error if `arc` or `grid` is given.

    One thread at a time may use a session: two at once would mix their loads. A process may have several sessions.
    Sessions can be copied and pickled.

    Parameters
    ----------
    problem : Problem
    nodes : int
        Number of nodes of the first arc.
    arc : (float, float), optional
        Start and end angle of the first arc, rad; a full turn is the whole circle. The arc is longer by less than one
        node distance, so that the spacing divides the circle.
    grid : Grid, optional
        The nodes, in place of `nodes` and `arc`. An arc can grow; a circle stays as it is.
    expected : LoadHistory or sequence of dicts, optional
        Loads that the session will probably see. The first arc spans their contacts. They are not followed.
    undo : int, optional
        Number of places to which :meth:`undo` can go back. Each holds a state and takes some 100 bytes a node.
        None means all places; memory then grows with every load.
    slip_sums : bool
        Sum up the slip distance and the friction energy of each node from load to load, see :class:`State`.

    Raises
    ------
    InputError
        If an argument can't be used. The error names it.

    Examples
    --------
    >>> import fastpin
    >>> pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    >>> session = fastpin.Session(fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4), nodes=101)
    >>> session.advance({"P": 1.0}).peak_pressure > 0.5
    True
    >>> round(session.advance({"Q": 0.1}).load["P"], 3)
    1.0
    >>> session.undo().load["Q"]
    0.0
    """

    def __init__(
        self,
        problem: Problem,
        nodes: int = DEFAULTS.nodes,
        *,
        arc: tuple[float, float] | None = DEFAULTS.arc,
        grid: Grid | None = None,
        expected: LoadHistory | Sequence[Corner] | None = None,
        undo: int | None = 100,
        slip_sums: bool = False,
    ) -> None:
        keep = "corners" if slip_sums is True else LAST_ONLY  # slip sums count from load to load
        self._options = SolveOptions(nodes=nodes, arc=arc, slip_sums=slip_sums, keep=keep)
        check_options(self._options, grid, None)
        Task(problem, NO_HISTORY, self._options, grid)
        check_nodes(problem, self._options, grid)
        warn_of(doubts(problem, None, self._options), 2)
        self._expected = None if expected is None else as_history(expected, "expected")
        if self._expected is not None:
            check_loads(problem, self._expected)
        self._grid = grid
        super().__init__(Place(problem, Loads()), undo)
        self._forget()

    def _forget(self) -> None:
        """Forget all that can be made anew from the present place."""
        self._run: Run | None = None
        self._system: System | None = None
        self._limits: dict[str, tuple[int, float]] = {}
        self._caught: list[int] = []  # a signal of Ctrl-C while the session is at work
        self._recorder = LatestState()

    @property
    def problem(self) -> Problem:
        """The present problem."""
        return self._here.problem

    @property
    def history(self) -> LoadHistory | None:
        """The loads that led to the present state; None before the first load."""
        return self._here.loads.history() if self._here.loads.count else None

    @property
    def grid(self) -> Grid | None:
        """The present nodes; None before the first load."""
        return self._here.grid

    def advance(self, loads: Corner) -> State:
        """Follow one straight step from the present loads to these, and return the state there.

        Parameters
        ----------
        loads : mapping
            Loads by name, as a corner of a :class:`LoadHistory`. A load that is left out keeps its value.

        Returns
        -------
        State
            It meets the contact conditions to 1e-9 (see ``State.residuals``). Its ``step`` counts the loads from 0.

        Raises
        ------
        InputError
            If a load can't be used.
        NoEquilibriumError, ConvergenceError, ArcError
            As for :func:`fastpin.solve`. ``step``, ``fraction`` and ``load`` of the error say where the load was lost.
        Interrupted
            After Ctrl-C.

        After an error the session is at the state before. The ``result`` of the last two rows holds this state, and can
        be saved and continued.
        """
        given = self._checked(loads)
        here = self._here
        place = replace(here, loads=here.loads.with_load(given))
        with self._guarded(place):
            self._arrive(place, self._first_step(place, given) if here.grid is None else self._next_step(place, given))
        assert self._here.state is not None
        return self._here.state

    def change(self, *, replay: Replay = "history", new_arc: bool = False, **changes: Any) -> State | None:
        """Change fields of the problem, follow the loads again, and return the state.

        A contact has a memory, so a change restarts the history, from no load, unless `replay` is "follow". Friction
        and clearance need no new matrices.

        Parameters
        ----------
        replay : {"history", "load", "none", "follow"}
            "history": follow all loads again, as if the problem had been this one from the start. "load": go from no
            load straight to the present load; this is the new history. It takes the same short time however long the
            session lasts. "none": stay without load. "follow": keep the contact, and let ``friction`` alone change at
            the present load, as a step of its own. The loads then no longer lead here: there is no :meth:`result`.
        new_arc : bool
            Whether to choose a new arc. The nodes stay otherwise. A much larger clearance makes a contact narrow, and a
            new arc then has more nodes on it.
        **changes
            Fields of :class:`Problem`, such as ``friction=0.3``. In a dimensionless problem ``clearance`` is the load
            parameter, and a new ``pair`` is scaled to beta* = 1.

        Returns
        -------
        State or None
            None without load.

        Raises
        ------
        InputError, NoEquilibriumError, ConvergenceError, Interrupted
            See :meth:`advance`. The session then keeps its problem and its state.

        :meth:`undo` takes the change back.
        """
        choice("replay", replay, get_args(Replay))
        true_or_false("new_arc", new_arc)
        here = self._here
        if replay == "follow" and here.restart is not None:
            if changes.keys() != {"friction"}:
                raise InputError("replay", '"follow" is for a change of the friction alone')
            return self._follow_friction(followed_problem(here.problem, changes["friction"]))
        problem = changed_problem(here.problem, changes)
        loads = here.loads if replay == "history" else Loads()
        if replay == "load" and here.restart is not None:
            never = np.isnan(here.loads.rows()).all(axis=0)
            loads = loads.with_load(np.where(never, np.nan, here.restart.load))
        history = loads.history() if loads.count else NO_HISTORY
        Task(problem, history, self._options, self._grid)
        check_nodes(problem, self._options, self._grid)
        place = Place(problem, loads)
        if here.grid is not None and not new_arc and (here.grid.closed or not (problem.needs_circle or problem.seat)):
            force = here.force if changes.keys() <= IN_PLACE else reference_force(problem, history.distinct())
            place = replace(place, grid=here.grid, force=force)
        if loads.count:
            with self._guarded(place):
                self._arrive(place, self._replay(place))
        else:
            self._leave_for(place)
        return self._here.state

    def reset(self) -> None:
        """Go back to no load, with the present problem and nodes. The history and all other places are forgotten."""
        self._begin_at(replace(self._here, loads=Loads(), restart=None, state=None, followed=False))
        self._run = None

    def copy(self, matrices: bool = True) -> Session:
        """Another session at the same place, with the same matrices or, to be small, without `matrices`."""
        other = Session.__new__(Session)
        other.__setstate__(self.__getstate__())
        if true_or_false("matrices", matrices):
            other._system, other._recorder.outside = self._system, self._recorder.outside
        return other

    def result(self, keep: str | KeepRule = DEFAULTS.keep) -> Result:
        """Follow the history once more, and return the result with a state for every load.

        Parameters
        ----------
        keep : str
            States to keep, as for :func:`fastpin.solve`.

        Raises
        ------
        InputError
            If no load was followed yet.
        """
        history = self.history
        if history is None:
            raise InputError("result", "no load was followed yet")
        if self._here.followed:
            raise InputError("result", "a change of the friction was followed; the loads alone give other states")
        return solve(self.problem, history, grid=self.grid, keep=keep, slip_sums=self._options.slip_sums)

    def __getstate__(self) -> dict[str, Any]:
        own = {"options": self._options, "expected": self._expected, "grid": self._grid}
        return own | super().__getstate__()

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._forget()

    __copy__ = copy

    def __repr__(self) -> str:
        here = self._here
        nodes = "no nodes yet" if here.grid is None else f"{here.grid.size} nodes"
        load = "no load" if here.state is None else named_loads(here.problem, here.state.load)
        return f"<Session: {here.loads.count:,} loads, now {load}, {nodes}, {self.undos} undo, {self.redos} redo>"

    def _checked(self, loads: Corner) -> np.ndarray:
        """The given loads, shape (loads,), SI; NaN where a load is left out. Loads seen before are checked quickly."""
        limits = self._limits
        if type(loads) is dict:
            given = np.full(len(LOADS), np.nan)
            for name, value in loads.items():
                place, limit = limits.get(name, (0, -1.0)) if type(name) is str else (0, -1.0)
                if not isinstance(value, float) or not -limit <= value <= limit:  # NumPy's numbers too
                    break
                given[place] = value
            else:
                return given
        history = LoadHistory([loads])
        check_loads(self.problem, history)
        natural = self.problem.natural_loads()
        given = history.blocks[0].given[0]
        for place in np.flatnonzero(np.nan_to_num(given[:ACTING])).tolist():
            limits[LOADS[place]] = place, MOST_LOAD * natural[LOAD_KIND[LOADS[place]]]
        return given

    @contextmanager
    def _guarded(self, place: Place) -> Iterator[None]:
        """Hold back Ctrl-C and BLAS's threads on the way to a place. After an error the session is where it was."""
        with deferred_interrupts() as caught, one_blas_thread():
            self._caught = caught
            try:
                yield
            except (SolveError, Interrupted) as ended:
                self._move(self._undo, self._redo, 0)
                ended.result = self._result_before(place.loads)
                raise
            except BaseException:
                self._run = None
                raise
            finally:
                self._caught = []
        if caught:
            raise Interrupted(self._result_before(self._here.loads))

    def _check_request(self, done: float = 0.0, total: int = 0) -> None:
        """The progress of all runs: raise Interrupted after Ctrl-C."""
        if self._caught:
            raise Interrupted

    def _result_before(self, loads: Loads) -> Result | None:
        """The present state as the result of a history that was to go on; None without a state."""
        here = self._here
        if here.grid is None or here.restart is None or here.state is None:
            return None
        return Result(
            [here.state], here.problem, loads.history(), here.grid, "path", here.restart.statistics.copy(), False,
            here.restart,
        )  # fmt: skip

    def _arrive(self, place: Place, run: Run) -> None:
        """Make the end of a run the present place."""
        system, state = run.system, self._recorder.states[-1]
        self._leave_for(
            replace(place, grid=run.grid, force=system.scales.force, restart=run.restart(shared=True), state=state)
        )
        self._run, self._system = run if run.strict else None, system

    def _leave_for(self, place: Place) -> None:
        """Remember the present place, and go to another one."""
        if place.problem is not self._here.problem:
            self._limits = {}
        super()._leave_for(place)
        self._run = None

    def _move(self, places: MutableSequence[Place], left: MutableSequence[Place], times: int) -> State | None:
        """Let the run be at the place too, if it can."""
        super()._move(places, left, times)
        here, run = self._here, self._run
        where = None if run is None else (run.system.problem, run.grid)
        if run is not None and here.restart is not None and where == (here.problem, here.grid):
            run.go_back(here.restart)
            self._recorder.begin(run)  # it may have seen other runs since
        else:
            self._run = None
        self._limits = {}
        return here.state

    def _system_at(self, place: Place) -> System:
        """The matrices of a place: the present ones, if they do."""
        known = self._system
        assert place.grid is not None
        if known is not None and known.interfaces[0].grid is place.grid and known.scales.force == place.force:
            if known.problem == place.problem:
                return known
            changed = known.changed(place.problem)
            if changed is not None:
                return changed
        return build_system(place.problem, place.grid, place.force)

    def _start(
        self, system: System, restart: Restart | None, strict: bool = True, history: LoadHistory = NO_HISTORY
    ) -> Run:
        """A run from a restart, or from no load."""
        if restart is not None:
            restart = replace(restart, repeats=Repeats(list(restart.repeats)))
        run = Run(history, system, self._options, self._recorder, self._check_request, restart, (), strict)
        self._recorder.begin(run)
        return run

    def _first_step(self, place: Place, given: np.ndarray) -> Run:
        """Choose the nodes, and follow the first load."""
        history = LoadHistory.from_array(given[None]) if self._expected is None else self._expected

        def step(system: System, strict: bool) -> Run:
            return self._lead(self._start(system, None, strict), place, given)

        return self._on_first_nodes(place.problem, history, step)

    def _next_step(self, place: Place, given: np.ndarray) -> Run:
        """Follow one more load on the present nodes."""
        here = self._here
        if self._run is None:
            self._run = self._start(self._system_at(here), here.restart)
        with suppress(ConvergenceError):
            return self._lead(self._run, place, given)
        try:  # narrow contacts are let go
            return self._lead(self._start(self._system_at(here), here.restart, strict=False), place, given)
        except ConvergenceError as error:
            if self._grid is not None or self._options.arc is not None:
                raise
            return self._on_new_nodes(place, error)

    def _replay(self, place: Place) -> Run:
        """Follow the loads to a place from no load."""
        history = place.loads.history()

        def follow(system: System, strict: bool) -> Run:
            return self._lead(self._start(system, None, strict, history), place)

        if place.grid is not None:
            return follow(self._system_at(place), True)
        return self._on_first_nodes(place.problem, self._expected or history, follow)

    def _on_first_nodes(self, problem: Problem, history: LoadHistory, work: Callable[[System, bool], Run]) -> Run:
        """Do some work on the nodes for a history. Only one arc is tried: it grows with the contact."""
        options = self._options if problem.seat is None else self._options.changed(arc=ALL_ROUND)
        task = Task(problem, history, options, self._grid)
        arc, force = next(task.arcs(self._check_request)), task.force
        if self._grid is None:
            arc = dividing_the_circle(arc, first_direction(problem, history.distinct()))

        def follow(grid: Grid, strict: bool) -> Run:
            return work(build_system(problem, grid, force), strict)

        return task.follow_on_grids(follow, self._check_request, arcs=lambda: [arc])

    def _follow_friction(self, problem: Problem) -> State | None:
        """Follow the change to the friction of another problem at the present load, and return the state."""
        here, given = self._here, np.full(len(LOADS), np.nan)
        place = replace(here, problem=problem, loads=here.loads.with_load(given), followed=True)
        with self._guarded(place):
            run = self._run or self._start(self._system_at(here), here.restart)
            while True:
                try:
                    run = follow_friction(run, problem)
                    break
                except ArcError:
                    if (wider := self._wider_system(run)) is None:
                        raise
                    run = self._start(wider, carried(run.system, wider, run.restart(shared=True)), run.strict)
            self._recorder.begin(run)
            self._arrive(place, self._lead(run, place, given))
        return self._here.state

    def _lead(self, run: Run, place: Place, given: np.ndarray | None = None) -> Run:
        """Follow one step to the `given` last load of a place, or the history of a run; if need be on a wider arc.

        Returns the run that got there.
        """
        load, here = None if given is None else complete_load(given, run.load), self._here
        while True:
            last = None if load is None else here.restart if run is self._run else run.restart(shared=True)
            try:
                run.follow() if load is None else run.step_to(load)
            except ArcError as error:
                lost = error
            except ConvergenceError:
                if load is not None or not run.strict:
                    raise
                run = self._start(run.system, run.restart(), False, run.history)
                continue
            else:
                if not self._recorder.touched_outside:
                    return run
                lost = touches_outside(run)
            system = self._wider_system(run)
            if system is None:
                return self._on_new_nodes(place, lost)
            if load is None and not self._recorder.touched_outside:
                last = run.restart()
            # Where a history has touched beyond the arc, nobody knows since when: from no load.
            last = None if last is None else carried(run.system, system, last)
            run = self._start(system, last, run.strict, run.history if load is None else NO_HISTORY)

    def _wider_system(self, run: Run) -> System | None:
        """The system of the next wider arc; None if there is none."""
        old = run.system
        first = self._options.nodes if self._grid is None else self._grid.size
        grid = wider_grid(old.grid, run.now.closed, most_nodes(first), self._recorder.touched_outside)
        return None if grid is None else build_system(old.problem, grid, old.scales.force)

    def _on_new_nodes(self, place: Place, lost: SolveError) -> Run:
        """Choose new nodes for the whole history to a place, and follow it there. `lost` is the reason."""
        if place.followed or self._grid is not None:
            given = "the given grid can't grow that far: give Grid.circle, or no grid"
            followed = "new nodes need the whole history, but a change of the friction was followed"
            lost.args = (f"{lost}; {followed if place.followed else given}",)
            raise lost
        arc = ALL_ROUND if self._recorder.touched_outside else None
        while True:
            task = Task(place.problem, place.loads.history(), self._options.changed(arc=arc), None, self._check_request)
            task.follow(self._recorder)
            if not self._recorder.touched_outside:
                assert self._recorder.run is not None
                return self._recorder.run
            arc = ALL_ROUND

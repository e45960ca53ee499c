"""A session of a joint: load after load, for programs that choose the next load from the present state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.joints.parts import Joint
from fastpin.joints.result import JointResult, JointState
from fastpin.joints.solving import (
    JointMatrices,
    JointRestart,
    JointRun,
    JointTask,
    StatesInMemory,
    next_loads,
    reference_force,
    solve_joint,
)
from fastpin.model.checks import true_or_false
from fastpin.sessions.place import Loads, Undoing
from fastpin.solver.configuration import ROUNDED
from fastpin.solver.errors import Interrupted, SolveError
from fastpin.solver.task import deferred_interrupts, one_blas_thread


@dataclass(frozen=True, eq=False)
class JointPlace:
    """A place in the session of a joint. It is never changed.

    Attributes
    ----------
    loads : Loads
        The loads from the start to here.
    values, largest : ndarray, shape (loads,)
        The loads here, and the largest size of each so far, SI.
    force : float
        The reference force, N/m; 0 before the first load, if none is expected.
    restart : JointRestart or None
        None under no load.
    state : JointState or None
        None under no load.
    """

    loads: Loads
    values: np.ndarray
    largest: np.ndarray
    force: float
    restart: JointRestart | None = None
    state: JointState | None = None


class JointSession(Undoing[JointPlace, JointState]):
    """A joint of several pins that is led from load to load, as :class:`fastpin.Session` leads one pin.

    A session gives the states of :func:`fastpin.joints.solve_joint`, to the same bits: the states of
    ``solve_joint(session.joint, session.history, nodes=session.nodes)``. It keeps the matrices. With clamps the largest
    load has to be `expected`, or within a factor of two of the first one: the small stiffness of surfaces that slip
    depends on it. States then differ by some 1e-5 otherwise.

    One thread at a time may use a session: two at once would mix their loads. A process may have several sessions.
    Sessions can be copied and pickled.

    Parameters
    ----------
    joint : Joint
    nodes : int
        Nodes of each contact, all round.
    harmonics : int, optional
        Highest harmonic of the holes, by which the pins of a plate act on one another. Chosen unless given.
    expected : sequence of mappings, optional
        Loads that the session will probably see, as corners of :func:`fastpin.joints.solve_joint`. They are not
        followed.
    undo : int, optional
        Number of places to which :meth:`undo` can go back. Each holds a state. None means all places; memory then grows
        with every load.

    Raises
    ------
    InputError
        If an argument can't be used. The error names it.

    Examples
    --------
    >>> from fastpin.joints import JOINT_EXAMPLE, parse_joint
    >>> from fastpin.sessions import JointSession
    >>> session = JointSession(parse_joint(JOINT_EXAMPLE).joint, nodes=16, harmonics=4)
    >>> round(session.advance({"strap.x": 1e3}).shares("skin")["A"], 1)
    0.4
    >>> session.undo() is None
    True
    """

    def __init__(
        self,
        joint: Joint,
        nodes: int = 96,
        *,
        harmonics: int | None = None,
        expected: Sequence[Mapping[str, float]] | None = None,
        undo: int | None = 100,
    ) -> None:
        try:
            self._task = JointTask.of(joint, [{}] if expected is None else expected, nodes, harmonics, None)
        except InputError as error:
            raise InputError("expected" if error.field == "corners" else error.field, error.reason) from None
        force = 0.0 if expected is None else reference_force(joint, self._task.values)
        nothing = np.zeros(len(joint.load_names))
        self._start = JointPlace(Loads(), nothing, nothing, force)
        super().__init__(self._start, undo)
        self._run: JointRun | None = None

    @property
    def joint(self) -> Joint:
        """The joint."""
        return self._task.joint

    @property
    def nodes(self) -> int:
        """Nodes of each contact, all round."""
        return self._task.nodes

    @property
    def states(self) -> list[JointState]:
        """The states of all places that are remembered on the way here, and the present one."""
        return [place.state for place in (*self._undo, self._here) if place.state is not None]

    @property
    def history(self) -> list[dict[str, float]] | None:
        """The loads that led to the present state, as corners; None before the first load."""
        joint, loads = self.joint, self._here.loads
        if not loads.count:
            return None
        every = (dict(zip(joint.load_names, row, strict=True)) for row in loads.rows().tolist())
        return [{name: load[name] for name in joint.given_names} for load in every]

    def advance(self, loads: Mapping[str, float]) -> JointState:
        """Follow one straight step from the present loads to these, and return the state there.

        Parameters
        ----------
        loads : mapping
            Loads by the names of ``joint.given_names``, see :func:`fastpin.joints.solve_joint`. One that is left out
            keeps its value.

        Returns
        -------
        JointState
            It meets the contact conditions and the equilibrium of all pins and plates to 1e-9. Its ``step`` counts the
            loads from 0.

        Raises
        ------
        InputError
            If a load can't be used.
        NoEquilibriumError, ConvergenceError
            As for :func:`fastpin.joints.solve_joint`. ``step``, ``fraction`` and ``load`` of the error say where the
            load was lost.
        Interrupted
            After Ctrl-C.

        After an error the session is at the state before. The ``result`` of the last two rows holds this state.
        """
        here = self._here
        given = next_loads(self.joint, loads, 0, here.values)
        largest = np.maximum(here.largest, np.abs(given))
        given[np.abs(given) <= ROUNDED * largest] = 0.0
        force = here.force or reference_force(self.joint, given[None])
        with self._guarded() as caught:

            def report(part: float) -> None:
                if caught:
                    raise Interrupted

            self._run = run = self._run_at(here, force, report)
            state = run.step_to(given, report)
            self._leave_for(JointPlace(here.loads.with_load(given), given, largest, force, run.restart, state))
        return state

    def _run_at(self, place: JointPlace, force: float, report: Callable[[float], None]) -> JointRun:
        """The run at a place, with this reference force."""
        run = self._run
        if run is None or run.matrices.force != force:
            run = JointRun(JointMatrices.of(self.joint, force, self._task, report))
        if place.restart is None:
            return run if run.restart.corner == 0 else JointRun(run.matrices)
        run.go_to(place.restart, place.values)
        return run

    @contextmanager
    def _guarded(self) -> Iterator[list[int]]:
        """Hold back Ctrl-C and BLAS's threads, and yield the signals. Errors get the result before."""
        here = self._here
        with deferred_interrupts() as caught, one_blas_thread():
            try:
                yield caught
            except (SolveError, Interrupted) as ended:
                ended.result = self._result_at(here)  # type: ignore[assignment]
                raise
            except BaseException:
                self._run = None
                raise
        if caught:
            raise Interrupted(self._result_at(self._here))  # type: ignore[arg-type]

    def _result_at(self, place: JointPlace) -> JointResult | None:
        """The state of a place as the result of a history that was to go on; None without a state."""
        if self._run is None or place.state is None:
            return None
        kept = StatesInMemory()
        kept.begin(self._run.holes)
        kept.add(place.state)
        kept.restart = place.restart
        return self._task.result(kept)

    def reset(self) -> None:
        """Go back to no load. The history and all other places are forgotten."""
        self._begin_at(self._start)

    def copy(self, matrices: bool = True) -> JointSession:
        """Another session at the same place, with the same matrices or, to be small, without `matrices`."""
        other = JointSession.__new__(JointSession)
        other.__setstate__(self.__getstate__())
        if true_or_false("matrices", matrices) and self._run is not None:
            other._run = JointRun(self._run.matrices)
        return other

    def result(self) -> JointResult:
        """Follow the history once more, and return the result with a state for every load.

        Raises
        ------
        InputError
            If no load was followed yet.
        """
        if (history := self.history) is None:
            raise InputError("result", "no load was followed yet")
        return solve_joint(self.joint, history, nodes=self.nodes, harmonics=self._task.harmonics)

    def __getstate__(self) -> dict[str, Any]:
        return {"task": self._task, "start": self._start} | super().__getstate__()

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._run = None

    __copy__ = copy

    def __repr__(self) -> str:
        now = "no load" if self.state is None else repr(self.state).partition(": ")[2][:-1]
        loads = f"{self._here.loads.count:,} loads, now {now}, {self.nodes} nodes a contact"
        return f"<JointSession: {loads}, {self.undos} undo, {self.redos} redo>"

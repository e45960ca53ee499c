"""The contact of a page: it obeys messages by calls of a :class:`fastpin.Session`, and answers with pictures.

Nothing here knows of servers or browsers.
"""

from __future__ import annotations

import gc
import math
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np

from fastpin.casefile import case_text
from fastpin.errors import FastpinError, InputError
from fastpin.kernels.status import OPEN
from fastpin.live import protocol
from fastpin.live.controls import ControlScales, changed_fields, load_controls, problem_controls, vector_axes
from fastpin.live.pictures import packed, picture
from fastpin.live.protocol import Message, refusal
from fastpin.model import LOADS, Case, Grid, Problem, angles
from fastpin.model.doubts import doubts
from fastpin.model.options import ALL_ROUND, SolveOptions
from fastpin.model.profile import CALLED
from fastpin.model.unit_systems import SI
from fastpin.model.units import units
from fastpin.report.case import profile_words
from fastpin.sessions import Session
from fastpin.solver import ConvergenceError, SolveError
from fastpin.states.state import State
from fastpin.version import __version__

NODES = 200
"""Nodes round the hole, by default. Peak pressures of the built-in case are then good to 1e-4, peak shears to 1e-3.

A multiple of four puts a node at the bottom, at the top and at either side. So a load in these directions has a
symmetric contact. Between two nodes, one of them would be the first to close, and would turn the pin a little.
"""

LEAST_CLOSED = 20
"""Nodes in contact under the first load. Of fewer, curves are coarse, and the peak of the shear may be anywhere."""

MOST_PLAYED = 500
"""Corners of the case's history that the page can play."""

MOST_LEFT = 4
"""Sessions left behind by all contacts before the garbage is collected. Each is in a cycle of references, with 32 MB of
tables."""

NO_GESTURE = -1
"""Number for changes without a gesture. The gestures of a page are not negative."""

Answer = dict[str, Any]


class Mark(NamedTuple):
    """A place to which the page can go back: a session, the numbers of the pictures that led there, and its nodes."""

    session: Session
    trail: tuple[int, ...]
    nodes: int

    @property
    def size(self) -> int:
        """Number of the nodes that the session has; 0 before the first load."""
        return 0 if self.session.grid is None else self.session.grid.size


class LiveContact:
    """A contact that is led by messages, see :mod:`fastpin.live.protocol`.

    Every load is one straight step of :attr:`session`. So the states have the bits of ``fastpin.solve`` with the same
    history and grid. The first corner of the case is the first step.

    It is not thread-safe, but :meth:`stop` may be called from any thread.

    Parameters
    ----------
    case : Case
    nodes : int
        Nodes round the hole.

    Attributes
    ----------
    session : Session
        The present place. Calls must not change it.
    sentence : str
        Why the first corner of the case was not carried; "" if it was.
    """

    _left = 0  # sessions left behind by all contacts

    def __init__(self, case: Case, nodes: int = NODES) -> None:
        self._case, self._nodes = case, nodes
        self._scales = ControlScales(case.problem, case.history)
        self._past: deque[Mark] = deque(maxlen=protocol.MOST_UNDONE)
        self._future: list[Mark] = []
        self._pictures: dict[int, Answer] = {}
        self._trail: list[int] = []
        self._shown: list[int] = []
        self._grids: dict[str, tuple[Grid, str]] = {}
        self._serial, self._gesture = 0, NO_GESTURE
        self._reference: Answer | None = None
        self._known: dict[str, Any] = {}
        self._stop = threading.Event()
        self.sentence = ""
        self.session = self._new_session(case.problem)
        given = case.history.corner(0)[0]
        try:
            self._begin(_named(given), 0)
        except FastpinError as error:
            self.sentence = _sentence(error)

    def _new_session(self, problem: Problem) -> Session:
        return Session(problem, self._nodes, arc=ALL_ROUND, undo=0)

    def obey(self, message: Message) -> list[Answer]:
        """Carry out a message, and return the answers. Errors become answers; the contact is then where it was."""
        before = self._mark()
        self._stop.clear()
        try:
            if message.kind == "hello":
                self._known, self._shown = {}, []
            else:
                getattr(self, f"_obey_{message.kind}")(**message.fields)
        except InputError as error:
            self._return_to(before)
            return [refusal(message.id, error)]
        except SolveError as error:
            self._return_to(before)
            lost = {"load": error.load, "step": error.step, "fraction": error.fraction, "error": type(error).__name__}
            return [{"kind": "lost", "id": message.id, "sentence": _sentence(error), **lost}]
        except BaseException:
            self._return_to(before)
            raise
        finally:
            # Sessions that are left are collected now and then. Python itself would wait for long.
            LiveContact._left += before.session is not self.session
            if LiveContact._left >= MOST_LEFT:
                LiveContact._left = 0
                gc.collect()
        return [self._changes(message.id)]

    def stop(self) -> None:
        """End a long history that is being followed. The message that it belongs to is refused."""
        self._stop.set()

    # -- messages --------------------------------------------------------------------------------------------------

    def _obey_load(self, loads: dict[str, float], gesture: int) -> None:
        is_new = gesture != self._gesture
        mark = self._lasting_mark() if is_new else None
        self._step(self.session, loads, gesture)
        if mark is not None:
            self._remember(mark, gesture)

    def _obey_change(self, changes: dict[str, Any], follow: str, gesture: int) -> None:
        fields = changed_fields(self.session.problem, changes, self._scales)
        session = self.session.copy()
        session.change(replay="none", **fields)
        if session.grid is not None and follow == "load" and session.grid.size != self._nodes:
            session = self._new_session(session.problem)  # the nodes may have been too many for the new problem
        self._lead(session, follow, gesture)

    def _obey_nodes(self, nodes: int, follow: str, gesture: int) -> None:
        mark, self._nodes = self._lasting_mark(), nodes
        self._lead(self._new_session(self.session.problem), follow, gesture, mark)

    def _obey_undo(self) -> None:
        if not self._past:
            raise InputError("undo", "there is nothing before to go back to")
        self._future.append(self._lasting_mark())
        self._go(self._past.pop())

    def _obey_redo(self) -> None:
        if not self._future:
            raise InputError("redo", "nothing was undone")
        self._past.append(self._lasting_mark())
        self._go(self._future.pop())

    def _obey_reset(self) -> None:
        mark = self._lasting_mark()
        session = self.session.copy()
        session.reset()
        self.session = session
        self._trail = []
        self._remember(mark, NO_GESTURE)

    def _obey_keep(self, on: bool) -> None:
        if on and not self._trail:
            raise InputError("keep", "there is no state to keep")
        self._reference = self._pictures[self._trail[-1]] if on else None

    # -- steps -----------------------------------------------------------------------------------------------------

    def _rows(self, follow: str) -> list[dict[str, float]]:
        """The loads to follow after a change: all loads of the history again, or the present load alone."""
        history = self.session.history
        if history is None:
            return []
        given = history.blocks[0].given
        if follow == "history":
            return [_named(row) for row in given]
        present = history.values()[-1]
        return [_named(np.where(np.all(np.isnan(given), axis=0), np.nan, present))]

    def _lead(self, session: Session, follow: str, gesture: int, mark: Mark | None = None) -> None:
        """Lead a new session from no load, and make it the present one. `mark` is the place before."""
        mark, rows = mark or self._lasting_mark(), self._rows(follow)
        self.session, self._trail = session, []
        allowed = {control["name"] for control in load_controls(session.problem, self._scales)}
        left_out = sorted({name for row in rows for name, value in row.items() if name not in allowed and value != 0.0})
        for row in rows:
            if self._stop.is_set():
                raise InputError("history", "was stopped on the way; the contact is where it was")
            loads = {name: value for name, value in row.items() if name in allowed}
            if len(rows) == 1:
                self._begin(loads, gesture)
            else:
                self._step(self.session, loads, gesture)
        if left_out:
            self.sentence = f"The changed problem takes no {' and no '.join(left_out)}: left out"
        self._remember(mark, gesture)

    def _step(self, session: Session, loads: dict[str, float], gesture: int) -> None:
        """Follow a load, and take the picture of its state."""
        self._add(session.advance(loads), gesture)

    def _begin(self, loads: dict[str, float], gesture: int) -> None:
        """Follow the first load, with more nodes if the contact is narrow.

        If it is too narrow for the most nodes all round, the solver chooses the nodes.
        """
        session, nodes = self.session, self._nodes
        while True:
            try:
                state = session.advance(loads)
                closed = np.count_nonzero(state.status != OPEN) or nodes
            except ConvergenceError:
                closed = 1
            if closed >= LEAST_CLOSED or nodes >= protocol.MOST_NODES:
                break
            nodes = min(4 * math.ceil(0.25 * nodes * max(2.0, LEAST_CLOSED / closed)), protocol.MOST_NODES)
            session = Session(session.problem, nodes, arc=ALL_ROUND, undo=0)
        if closed < LEAST_CLOSED:
            session = Session(session.problem, self._nodes, undo=0)
            state = session.advance(loads)
        self.session = session
        self._add(state, gesture)

    def _add(self, state: State, gesture: int) -> None:
        self._serial += 1
        shown = replace(state)  # what is read from a state stays in it; the session keeps its states small for undo
        self._pictures[self._serial] = picture(
            shown, self._serial, gesture, self._grid_name(state.grid), self._case.history
        )
        self._trail.append(self._serial)
        if len(self._pictures) > protocol.MOST_PICTURES:
            oldest = next(iter(self._pictures))
            del self._pictures[oldest]
            if self._trail[0] == oldest:
                del self._trail[0]

    def _grid_name(self, grid: Grid) -> str:
        for name, (known, _) in self._grids.items():
            if known is grid or np.array_equal(known.theta, grid.theta):
                return name
        name = str(len(self._grids))
        self._grids[name] = grid, packed(grid.theta)
        return name

    def _remember(self, mark: Mark, gesture: int) -> None:
        """Make the place before a gesture one to go back to. What was undone before is forgotten."""
        if gesture != self._gesture or gesture == NO_GESTURE:
            self._past.append(mark)
            while sum(past.size for past in self._past) > protocol.MOST_UNDONE_NODES:
                self._past.popleft()
        self._future.clear()
        self._gesture = gesture

    def _mark(self) -> Mark:
        return Mark(self.session, tuple(self._trail), self._nodes)

    def _lasting_mark(self) -> Mark:
        """The present place, to be kept. Its session is a copy without matrices, which would fill the memory."""
        return self._mark()._replace(session=self.session.copy(matrices=False))

    def _go(self, mark: Mark) -> None:
        self._return_to(mark)
        self._gesture = NO_GESTURE

    def _return_to(self, mark: Mark) -> None:
        self.session, self._nodes = mark.session, mark.nodes
        self._trail = [serial for serial in mark.trail if serial in self._pictures]

    # -- answers ---------------------------------------------------------------------------------------------------

    def _changes(self, number: int) -> Answer:
        """What the page does not know yet."""
        shown = set(self._trail)
        drop = next((k for k, serial in enumerate(self._shown) if serial in shown), len(self._shown))
        rest = self._shown[drop:]
        keep = next((k for k, pair in enumerate(zip(rest, self._trail, strict=False)) if pair[0] != pair[1]), None)
        keep = min(len(rest), len(self._trail)) if keep is None else keep
        self._shown = list(self._trail)
        answer = {
            "kind": "pictures", "id": number, "drop": drop, "keep": keep,
            "add": [self._pictures[serial] for serial in self._trail[keep:]],
            "undos": len(self._past), "redos": len(self._future), "sentence": self.sentence,
        }  # fmt: skip
        self.sentence = ""
        # What the page knows besides pictures, and the objects that it depends on.
        depends: dict[str, tuple[object, ...]] = {
            "case": (self.session.problem, self._nodes), "reference": (self._reference,), "grids": (len(self._grids),)
        }  # fmt: skip
        for name, value in depends.items():
            known = self._known.get(name)
            if known is None or any(one is not other for one, other in zip(value, known, strict=True)):
                self._known[name] = value
                answer[name] = self._known_things[name]()
        return answer

    @property
    def _known_things(self) -> dict[str, Callable[[], Any]]:
        """What the page knows besides pictures: the case, the reference, and the angles of the nodes by grid, rad."""
        return {
            "case": self._case_document,
            "reference": lambda: self._reference,
            "grids": lambda: {name: text for name, (_, text) in self._grids.items()},
        }

    def _case_document(self) -> Answer:
        """The problem, its controls and its loads."""
        return case_document(self._case.title, self.session.problem, self._scales) | {
            "nodes": self._nodes,
            "most_nodes": protocol.MOST_NODES,
            "history": [_named(row) for row in self._case.history.values(np.full(len(LOADS), np.nan))[:MOST_PLAYED]],
        }

    def recording(self) -> Answer:
        """Everything that a recording of this contact holds."""
        known = {name: make() for name, make in self._known_things.items()}
        return {"version": __version__, **known, "add": [self._pictures[serial] for serial in self._trail]}

    def case_text(self) -> str:
        """The problem and the history so far as a case file, on the same nodes.

        Raises
        ------
        InputError
            If there is no history yet, or the plate is a compliance.
        """
        history, grid = self.session.history, self.session.grid
        if history is None or grid is None:
            raise InputError("case", "no load was followed yet")
        if "file" in self.session.problem.plate_body.keys:
            words = "a plate from a compliance file can't be saved here; save the loads (CSV), and name them in a copy"
            raise InputError("case", f"{words} of your own case file")
        arc = ALL_ROUND if grid.closed else (float(grid.theta[0]), float(grid.theta[-1]))
        options = replace(SolveOptions(), nodes=grid.size, arc=arc)
        return case_text(replace(self._case, problem=self.session.problem, history=history, options=options))


def _sentence(error: FastpinError) -> str:
    """The message of an error. The number of the step is left out: the page does not show it."""
    text = str(error)
    if isinstance(error, SolveError):
        text = text.partition(": ")[2] or text
    return text[:1].upper() + text[1:]


def _named(given: np.ndarray) -> dict[str, float]:
    """The loads that are given, by name."""
    return {name: float(value) for name, value in zip(LOADS, given, strict=True) if not np.isnan(value)}


def _outline(lug: Any) -> list[Answer]:
    """The edges of a plate of any outline beyond the hole: lines x, y in m, supports and loads."""
    loads = {name: load.name for load in lug.loads for name in load.parts}
    return [
        {
            "line": np.stack([lug.hole_radius * line.real, lug.hole_radius * line.imag], axis=1).tolist(),
            "hold": lug.supports.get(part.name),
            "load": loads.get(part.name),
        }
        for part, line in zip(lug.edges, lug.edge_lines, strict=True)
    ]


def case_document(title: str, problem: Problem, scales: ControlScales) -> Answer:
    """A problem as the page needs it: units, sizes and shapes of the bodies, loads and controls."""
    lug, bush = problem.plate_body.lug, problem.plate_body.bush
    around = angles.angle_at(np.arange(CALLED) * (360.0 / CALLED) - 180.0)  # from -180 degrees from the bottom on
    # A choice of prefixes for all sizes of values, by its name: a power of ten for each unit. 1 kN mm is 1 N m.
    prefixes = {"kN, mm": {"N": 3, "N/m": 3, "N m": 0, "J": 0, "J/m": 0, "m": -3, "Pa": 6}}
    return {
        "title": title,
        "units": {kind: asdict(unit) for kind, unit in units(problem).items()},
        "prefixes": prefixes if problem.unit_system == SI and not problem.dimensionless else {},
        "dimensionless": problem.dimensionless,
        "friction": problem.most_friction,
        "radius": problem.hole_radius,
        "clearance": problem.assembled_clearance,
        "yielded": scales.force * problem.surfaces.beta_star,
        "bore": problem.pin_body.bore_radius,
        "plate": problem.plate_body.kind,
        "bush": None if bush is None else bush.outer_radius,
        "rim": lug.outer_radius if math.isfinite(lug.outer_radius) else None,
        "outline": None if lug.geometry is None else _outline(lug.geometry),
        "profiles": {name: packed(each.at(around, problem.hole_radius)) for name, each in problem.profiles.items()},
        "profile_words": profile_words(problem),
        "doubts": [str(doubt) for doubt in doubts(problem, None, SolveOptions())],
        "axes": vector_axes(problem, scales),
        "loads": load_controls(problem, scales),
        "controls": problem_controls(problem, scales),
    }

"""The contact of a page: it obeys messages by calls of a session, and answers with pictures.

Nothing here knows of servers or browsers, or of what the session solves: see :mod:`fastpin.live.pin` and
:mod:`fastpin.live.joint`.
"""

from __future__ import annotations

import gc
import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from fastpin.errors import FastpinError, InputError
from fastpin.live import protocol
from fastpin.live.pictures import packed
from fastpin.live.protocol import Message, refusal
from fastpin.model import Grid
from fastpin.solver import SolveError
from fastpin.version import __version__

MOST_LEFT = 4
"""Sessions left behind by all contacts before the garbage is collected. Each is in a cycle of references, with 32 MB of
tables."""

NO_GESTURE = -1
"""Number for changes without a gesture. The gestures of a page are not negative."""

Answer = dict[str, Any]


class Mark(NamedTuple):
    """A place to which the page can go back: a session, the numbers of the pictures that led there, and its nodes.

    ``size`` is the number of nodes of its state.
    """

    session: Any
    trail: tuple[int, ...]
    nodes: int
    size: int


class LiveContact(ABC):
    """A contact that is led by messages, see :mod:`fastpin.live.protocol`.

    Every load is one straight step of :attr:`session`. So the states have the bits of one run with the same history and
    nodes. The first corner of the case is the first step.

    It is not thread-safe, but :meth:`stop` may be called from any thread.

    Parameters
    ----------
    session : Session or JointSession
        Without a load.
    nodes : int
        Nodes round a hole.
    first : dict
        The first load, by names, SI.
    most_pictures : int
        Pictures that are remembered.

    Attributes
    ----------
    session : Session or JointSession
        The present place. Calls must not change it.
    sentence : str
        Why the first corner of the case was not carried; "" if it was.
    """

    _left = 0  # sessions left behind by all contacts

    def __init__(self, session: Any, nodes: int, first: dict[str, float], most_pictures: int) -> None:
        self._nodes, self._most_pictures = nodes, most_pictures
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
        self.session: Any = session
        try:
            self._begin(first, 0)
        except FastpinError as error:
            self.sentence = _sentence(error)

    # -- what differs between one pin and a joint ------------------------------------------------------------------

    def checked_nodes(self, nodes: int) -> int:
        """Nodes of a message, which are allowed for one pin, after their check."""
        return nodes

    def checked_loads(self, loads: dict[str, float]) -> dict[str, float]:
        """Loads of a message after a check of their sizes, beside the checks of the session."""
        return loads

    @abstractmethod
    def _new_session(self) -> Any:
        """A session of the present problem, with the present number of nodes, without a load."""

    @abstractmethod
    def _begin(self, loads: dict[str, float], gesture: int) -> None:
        """Follow the first load, and take the picture of its state."""

    @abstractmethod
    def _picture(self, state: Any, serial: int, gesture: int) -> Answer:
        """The picture of a state."""

    @abstractmethod
    def _rows(self, follow: str) -> list[dict[str, float]]:
        """The loads to follow after a change: all loads of the history again, or the present load alone."""

    @property
    @abstractmethod
    def _allowed(self) -> set[str]:
        """Names of the loads that the problem takes."""

    @property
    @abstractmethod
    def _problem(self) -> object:
        """What the document of the case depends on."""

    @property
    @abstractmethod
    def _size(self) -> int:
        """Nodes of the present state; 0 without one."""

    @abstractmethod
    def _case_document(self) -> Answer:
        """The problem, its controls and its loads."""

    @abstractmethod
    def case_text(self) -> str:
        """The problem and the history so far as a case file, on the same nodes.

        Raises
        ------
        InputError
            If there is no history yet, or the case can't be written.
        """

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
        loads, is_new = self.checked_loads(loads), gesture != self._gesture
        mark = self._lasting_mark() if is_new else None
        self._step(self.session, loads, gesture)
        if mark is not None:
            self._remember(mark, gesture)

    @abstractmethod
    def _obey_change(self, changes: dict[str, Any], follow: str, gesture: int) -> None:
        """Change the problem, and follow the loads again."""

    def _obey_nodes(self, nodes: int, follow: str, gesture: int) -> None:
        mark, self._nodes = self._lasting_mark(), self.checked_nodes(nodes)
        self._lead(self._new_session(), follow, gesture, mark)

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

    def _lead(self, session: Any, follow: str, gesture: int, mark: Mark | None = None) -> None:
        """Lead a new session from no load, and make it the present one. `mark` is the place before."""
        mark, rows = mark or self._lasting_mark(), self._rows(follow)
        self.session, self._trail = session, []
        allowed = self._allowed
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

    def _step(self, session: Any, loads: dict[str, float], gesture: int) -> None:
        """Follow a load, and take the picture of its state."""
        self._add(session.advance(loads), gesture)

    def _add(self, state: Any, gesture: int) -> None:
        self._serial += 1
        self._pictures[self._serial] = self._picture(state, self._serial, gesture)
        self._trail.append(self._serial)
        if len(self._pictures) > self._most_pictures:
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
        return Mark(self.session, tuple(self._trail), self._nodes, self._size)

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
            "case": (self._problem, self._nodes), "reference": (self._reference,), "grids": (len(self._grids),)
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

    def recording(self) -> Answer:
        """Everything that a recording of this contact holds."""
        known = {name: make() for name, make in self._known_things.items()}
        return {"version": __version__, **known, "add": [self._pictures[serial] for serial in self._trail]}


def _sentence(error: FastpinError) -> str:
    """The message of an error. The number of the step is left out: the page does not show it."""
    text = str(error)
    if isinstance(error, SolveError):
        text = text.partition(": ")[2] or text
    return text[:1].upper() + text[1:]

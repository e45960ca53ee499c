"""The states in a figure: which are drawn, where on the axis of angles, and with which names, colours and dashes."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from fastpin.errors import InputError
from fastpin.figures import style
from fastpin.figures.sheet import Sheet
from fastpin.kernels.status import OPEN
from fastpin.model import Case, Problem, angles, checks
from fastpin.model.case import beside_of
from fastpin.reading.zones import ALL_ROUND
from fastpin.solver import Result
from fastpin.states.choice import NO_CYCLE, StateChoice, chosen_places, even_choice
from fastpin.states.curves import traction_patches
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import KeptStates, Side, find_extremes, marked_places
from fastpin.states.quantities import load_point
from fastpin.states.state import State
from fastpin.storage.held import Held
from fastpin.storage.stored import StoredResult
from fastpin.storage.wear_files import life_of
from fastpin.wear_lives import WearResult

NEARLY_ROUND = 340.0
"""Length of an axis, degrees, from which on it goes all round: with further whole steps it would be more than that."""

SAME = 1e-3
"""Difference of two states, in parts of the largest tractions, below which one line shows both: it is 0.1 points."""

MOST_JOINED = 10_000
"""Most states that a map of a whole history joins in its columns. With 400 nodes they take 300 MB of memory."""


TRACTIONS: tuple[tuple[str, Side], ...] = (("peak_pressure", "largest"), ("peak_shear", "largest magnitude"))
"""The extremes of figures of tractions."""

HOOP: dict[str, tuple[tuple[str, Side], ...]] = {
    "plate": (("peak_hoop", "largest"),),
    "pin": (),
    "seat": (("peak_hoop_seat", "largest"),),
    "both": (("peak_hoop", "largest"), ("peak_hoop_seat", "largest")),
}
"""The extremes of figures of the hoop stress, by the body that they show."""


class DrawnStates(list[State]):
    """The states that a figure draws.

    Attributes
    ----------
    total : int
        Number of states from which they were chosen.
    cycles : sequence of Cycle
        The cycles of the history.
    marks : list of str
        Words on the extremes that each state has; empty for most.
    chosen : int
        Number of states that were chosen. The figure may not hold all of them.
    """

    def __init__(
        self,
        states: Iterable[State],
        total: int,
        cycles: Sequence[Cycle] = (),
        marks: Sequence[str] = (),
        chosen: int = 0,
    ) -> None:
        super().__init__(states)
        self.total, self.cycles, self.marks = total, cycles, list(marks) or [""] * len(self)
        self.chosen = chosen or len(self)

    @property
    def seats(self) -> DrawnStates:
        """The states of the seat of a bush that slips, drawn in the same way."""
        seats = [state.seat for state in self if state.seat is not None]
        return DrawnStates(seats, self.total, self.cycles, self.marks, self.chosen)

    @property
    def note(self) -> str:
        """Which states are drawn of how many, as text; empty if all are."""
        if len(self) == self.total:
            return ""
        points = list(map(style.point_text, self))
        named = ", ".join(points) if len(points) <= style.MAX_NAMED else f"{points[0]} to {points[-1]}"
        return f"{len(self)} of {self.total:,} states: load point{'s' if len(self) > 1 else ''} {named}"

    @property
    def notes(self) -> list[str]:
        """A sentence for the command line on which states are drawn of how many; none if all are."""
        return [f"the figure shows {self.note}{self.remedy}"] if self.note else []

    @property
    def remedy(self) -> str:
        """How to draw the other states that were chosen, as text for the command line; empty if all are drawn."""
        if self.chosen <= len(self):
            return ""
        return f"; of the {self.chosen:,} chosen states it holds {len(self)}: choose at most so many with --states"


def drawn_states(
    result: Sequence[State] | State | Held,
    states: StateChoice = None,
    most: int = style.MAX_NAMED,
    whole: bool = False,
    extremes: Collection[tuple[str, Side]] = TRACTIONS,
) -> DrawnStates:
    """Return the states that a figure draws, at most `most` unless it draws the `whole` choice.

    Parameters
    ----------
    result : State, Result, sequence of State or Held
        Of one problem and on one grid. Of a held result no other states are read.
    states, most, whole
        See :func:`drawn_places`.
    extremes : collection
        The extremes whose states are drawn, of :data:`fastpin.states.extremes.MARKS`.

    Raises
    ------
    InputError
        If there is no such state, the states are not on one grid, or a file can't be read.
    """
    if isinstance(result, Held):
        found, points, history = result.extremes, result.points, result.result.cycles
        known = {each: found[each] for each in extremes if each in found}
        places, marks, chosen = drawn_places(points, history, states, most, whole, lambda: marked_places(known))
        return DrawnStates(result.read(places), len(points), history, marks, chosen)
    every = [result] if isinstance(result, State) else result
    if not isinstance(every, Sequence) or not all(isinstance(state, State) for state in every):
        raise InputError("result", f"must be states or a result, not {checks.as_toml(result)}")
    if any(not np.array_equal(state.theta, every[0].theta) for state in every):
        raise InputError("result", "its states must all be on one grid")
    cycles = every.cycles if isinstance(every, Result | DrawnStates) else ()
    points = np.array([load_point(state) for state in every])
    if isinstance(every, DrawnStates) and states is None and len(every) <= most:
        return every

    def marked() -> dict[int, str]:
        return marked_places(find_extremes(KeptStates(every), extremes))

    places, marks, chosen = drawn_places(points, cycles, states, most, whole, marked)
    total = every.total if isinstance(every, DrawnStates) else len(every)
    return DrawnStates([every[place] for place in places], total, cycles, marks, chosen)


def drawn_places(
    points: np.ndarray,
    cycles: Sequence[Cycle],
    states: StateChoice = None,
    most: int = style.MAX_NAMED,
    whole: bool = False,
    marked: Callable[[], dict[int, str]] = dict,
) -> tuple[list[int], list[str], int]:
    """Return the places of the states that a figure draws, words on their extremes, and how many were chosen.

    Without a choice no state was chosen.

    Parameters
    ----------
    points : ndarray, shape (k,)
        Load points of the states.
    cycles : sequence of Cycle
    states : str, number, sequence of numbers or slice, optional
        See :func:`fastpin.states.choice.chosen_places`. Unless given, all states of a short history, and the last cycle
        of a history with more than `most` states, with the states of the extremes.
    most : int
        Of more states, an even choice is drawn, with the first and the last one, and the states of the extremes.
    whole : bool
        Whether all chosen states are drawn, in the order of the history: the figure joins more than `most` of them.
        Without a choice these are all states, up to :data:`MOST_JOINED`.
    marked : callable
        ``marked()`` gives the places of the extremes of all states, with words on each.

    Raises
    ------
    InputError
        If there is no such state. The field is "states".
    """
    chosen = states
    if states is None and cycles and len(points) > (MOST_JOINED if whole else most):
        chosen = "cycle"
    try:
        places = chosen_places(points, cycles, chosen)
    except InputError:
        if states is not None or not len(points):
            raise
        places = chosen_places(points, cycles, "all")  # the states of the last cycle were not kept
    count = 0 if states is None else len(set(places))
    if whole and len(places) > most:
        places = sorted(set(places))
        return places, [""] * len(places), count
    is_part = states is None and len(places) < len(points) and not whole
    marks = marked() if len(places) > most or is_part else {}
    if states is None:
        places = sorted({*places, *marks})
    places = even_choice(places, most, marks)
    return places, [marks.get(place, "") for place in places], count


class Frame:
    """The angle axis of a figure. It spans all nodes that touch in some state, and a little more.

    Attributes
    ----------
    order : ndarray of int
        Nodes in the order in which they are drawn. A circle is cut open; its first node then stands at both ends.
    angle : ndarray
        Angles of these nodes, degrees from the bottom, increasing.
    limits : (float, float)
        Ends of the axis, degrees; whole steps unless the axis goes all round.
    step : float
        Distance of the numbers on the axis, degrees.
    """

    def __init__(self, states: Sequence[State]) -> None:
        grid = states[0].grid
        touched = np.any([state.status != OPEN for state in states], axis=0)
        self.order = np.arange(grid.size)
        if grid.closed and not touched.all():
            # The circle is cut open in the middle of the longest stretch that is open in all states.
            self.order = np.roll(self.order, -_middle_of_longest_gap(touched))
        elif grid.closed:  # cut open at the top
            self.order = np.roll(
                self.order, -int(np.argmin(np.mod(grid.theta - ALL_ROUND[0] + angles.AT_TOP, 2.0 * math.pi)))
            )
        angle = np.degrees(np.unwrap(grid.theta[self.order])) + 90.0
        if grid.closed:
            self.order = np.append(self.order, self.order[0])
            angle = np.append(angle, angle[0] + 360.0)
        inside = angle[touched[self.order]]
        first, last = (inside[0], inside[-1]) if inside.size else (angle[0], angle[-1])
        turn = 360.0 * angles.turns_from_bottom(math.radians(0.5 * (first + last) - 90.0))
        self.angle = angle - turn
        margin = 0.04 * (last - first) + 1.0
        self.limits = (max(first - margin, angle[0]) - turn, min(last + margin, angle[-1]) - turn)
        span = self.limits[1] - self.limits[0]
        self.step = next(step for step in (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0) if span <= 11.0 * step)  # 12 numbers
        if span < NEARLY_ROUND:  # both ends of the axis get a number
            self.limits = (
                self.step * math.floor(self.limits[0] / self.step), self.step * math.ceil(self.limits[1] / self.step)
            )  # fmt: skip

    def scale(self, panel: Axes, upright: bool = False) -> None:
        """Give the axis of angles of a panel its ends and its numbers."""
        panel.set(**{"ylim" if upright else "xlim": self.limits})
        (panel.yaxis if upright else panel.xaxis).set_major_locator(MultipleLocator(self.step))

    def curves(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return angle, pressure and shear of a drawn state; NaN between its contact zones.

        They are the curves of :mod:`fastpin.states.curves`.
        """
        parts = [np.zeros((0, 3))]
        gap = np.full((1, 3), np.nan)
        for points in traction_patches(state):
            if points[-1, 0] - points[0, 0] > 360.0 - 1e-6:
                points = self._rolled(points)
            else:
                middle = 0.5 * (points[0, 0] + points[-1, 0])
                points[:, 0] += 360.0 * round((0.5 * sum(self.limits) - middle) / 360.0)
            parts += [points, gap]
        angle, pressure, shear = np.concatenate(parts[:-1] if len(parts) > 1 else parts).T
        highest = float(np.nanmax(pressure, initial=0.0))
        return angle, style.without_rounding(pressure), style.without_rounding(shear, highest)

    def _rolled(self, points: np.ndarray) -> np.ndarray:
        """A curve all round that begins and ends where the axis does."""
        start = self.limits[0]
        turned = points[:-1].copy()
        turned[:, 0] = start + np.mod(turned[:, 0] - start, 360.0)
        turned = turned[np.argsort(turned[:, 0])]
        turn = np.array([[360.0, 0.0, 0.0]])
        return np.concatenate([turned[-1:] - turn, turned, turned[:1] + turn])

    def place(self, start: float, stop: float) -> list[tuple[float, float]]:
        """Return the parts of an interval, given in rad, that lie on the axis: (first angle, width) in degrees."""
        length = math.degrees(stop - start)
        first = math.degrees(start) + 90.0
        first += 360.0 * math.ceil((self.limits[0] - first - length) / 360.0)
        parts = []
        while first < self.limits[1]:
            left, right = max(first, self.limits[0]), min(first + length, self.limits[1])
            if right > left:
                parts.append((left, right - left))
            first += 360.0
        return parts


def _middle_of_longest_gap(touched: np.ndarray) -> int:
    size = touched.size
    best, middle, run = 0, 0, 0
    for k in range(2 * size):  # twice round: a stretch may cross the seam of the circle
        run = 0 if touched[k % size] else run + 1
        if run > best:
            best, middle = run, k - run // 2
    return middle % size


def name_states(sheet: Sheet, states: DrawnStates, heading: Sequence[str], styles: list[Artist]) -> None:
    """Add heading, caption and legend. Loads that are equal in all states stand in the heading.

    `styles` are entries of the legend that hold for all states. A single state has no entry of its own.
    """
    common, differing = style.loads_by_change(states)
    loads = [style.load_text(states, 0, name) for name in (common if len(states) > 1 else [*common, *differing])]
    if len(states) == 1:
        loads.insert(0, f"load point {style.point_text(states[0])}")
    note = f"{len(states)} of {states.total:,} states drawn" if len(states) < states.total else ""
    text = style.caption(states[0].problem, states)
    sheet.head(*heading, ",  ".join(loads), caption=f"{text}; {note}" if note else text)
    handles: list[Artist] = []
    twins, lines = first_twins(states), state_lines(states)
    for first in dict.fromkeys(twins):
        points = ", ".join(style.point_text(state) for state, twin in zip(states, twins, strict=True) if twin == first)
        parts = ",  ".join(style.load_text(states, first, name) for name in differing)
        marks = ", ".join(mark for mark, twin in zip(states.marks, twins, strict=True) if mark and twin == first)
        each = marks.split(", ")  # a long entry would make the letters of the legend small
        words = marks if len(each) <= 3 else f"{each[0]}, {each[1]}, and {len(each) - 2} more"
        parts = f"{parts}  ({words})".strip() if words else parts
        handles.append(Line2D([], [], label=f"{points}:  {parts}" if parts else points, **lines[first]))
    handles, columns = _in_columns(handles if len(states) > 1 else [], styles)
    title = ("load point:  loads there" if differing else "load point") if len(states) > 1 else ""
    sheet.legend(handles, columns, title)


def _in_columns(states: list[Artist], styles: list[Artist]) -> tuple[list[Artist], int]:
    """Return legend entries and the number of columns. Blank entries keep states and styles in separate columns."""
    if not states:
        return styles, max(len(styles), 1)
    longest = max(len(str(entry.get_label())) for entry in states)
    is_single = len(states) <= 3 or longest > 32  # long entries in two columns would need letters too small to read
    rows = len(states) if is_single else math.ceil(len(states) / 2)
    columns = [states[k : k + rows] for k in range(0, len(states), rows)]
    if styles:
        columns.append(styles)
    rows = max(len(column) for column in columns)
    blank = Line2D([], [], linestyle="none", label=" ")
    filled = [entry for column in columns for entry in [*column, *[blank] * (rows - len(column))]]
    return filled, len(columns)


def state_lines(states: Sequence[State]) -> list[style.Line]:
    """Return the style of each state's line. Equal states share colour and dashes."""
    return [style.line(twin, twin, 1.3) for twin in first_twins(states)]


def first_twins(states: Sequence[State]) -> list[int]:
    """Return for each state the place of the first state with the same loads and tractions, up to :data:`SAME`.

    The ends of a steady cycle are such states. With lines of their own one would hide the other.
    """
    twins: list[int] = []
    for place, state in enumerate(states):
        equal = (k for k in dict.fromkeys(twins) if _is_twin(states[k], state))
        twins.append(next(equal, place))
    return twins


def _is_twin(one: State, other: State) -> bool:
    """Whether two states have the same loads, and tractions whose lines can't be told apart."""
    pair = [one, other]
    if any(style.load_text(pair, 0, name) != style.load_text(pair, 1, name) for name in style.loads_by_change(pair)[1]):
        return False
    peak = max(one.peak_pressure, other.peak_pressure)
    pressure = float(np.abs(one.pressure - other.pressure).max())
    shear = float(np.abs(one.shear - other.shear).max())
    return pressure <= SAME * peak and shear <= SAME * one.most_friction * peak


Shown = Result | Sequence[State] | State | WearResult | Problem | Case
"""What figures are made of."""


class Subject:
    """What a figure shows: a result, states, a life of wear, or a joint without states.

    States are of one problem and on one grid. Those of a life are the states over one cycle on each stored profile.

    Parameters
    ----------
    shown : Result, State, sequence of State, WearResult, Problem or Case
    held : Held, optional
        The stored result of a run, or a hole of a joint, of which `shown` is the result without its states. Only those
        that a figure shows are read.
    progress : callable, optional
        ``progress(done, total)`` follows figures that take long to compute.

    Attributes
    ----------
    shown : Result, State, sequence of State, Problem or Case
    life : WearResult or None
    """

    def __init__(
        self, shown: Shown, held: Held | None = None, progress: Callable[[float, float], None] | None = None
    ) -> None:
        self.life = shown if isinstance(shown, WearResult) else None
        self.shown = Result.of_life(shown) if isinstance(shown, WearResult) else shown
        self._held, self.progress = held, progress

    @property
    def source(self) -> str:
        """A key of :data:`fastpin.figures.kinds.SOURCES`."""
        if isinstance(self.shown, Problem | Case):
            return "case"
        return "life" if self.life is not None else "result" if self._held is None else self._held.source

    @property
    def span(self) -> tuple[int, int] | None:
        """The corners between which slip is shown unless others are given, see :class:`fastpin.storage.held.Held`."""
        return None if self._held is None else self._held.span

    @property
    def problem(self) -> Problem:
        """The problem of a joint or a result."""
        if not isinstance(self.shown, Problem | Case | Result):
            raise InputError("joint", f"must be a Problem, Case or Result, not {checks.as_toml(self.shown)}")
        return self.shown if isinstance(self.shown, Problem) else self.shown.problem

    @property
    def cycles(self) -> Sequence[Cycle]:
        """The cycles of the history."""
        return self.shown.cycles if isinstance(self.shown, Result) else ()

    def states(self, states: StateChoice = None, **how: Any) -> DrawnStates:
        """Return the states of a figure, see :func:`fastpin.figures.states.drawn_states`."""
        return drawn_states(self.shown if self._held is None else self._held, states, **how)  # type: ignore[arg-type]

    def result(self) -> Result:
        """Return the result, perhaps without its states."""
        return checks.instance("result", self.shown, Result, "a Result")

    def part(self, first: int, last: int) -> Result:
        """Return the result, perhaps with the states from one corner to another only."""
        return self.result() if self._held is None else self._held.part(first, last)

    def whole(self) -> Result:
        """Return the result with all its states."""
        return self.result() if self._held is None else self._held.whole()

    def beside(self, name: str) -> Any:
        """Return the section of a stored case with this name, such as "fatigue"; None if it is not known."""
        return None if self._held is None else beside_of(self._held.case).get(name)  # type: ignore[attr-defined]


def of_states(result: Sequence[State] | State) -> Subject:
    """Return states, or a result, as a subject."""
    return Subject(result)


def of_joint(joint: Problem | Case | Result) -> Subject:
    """Return a joint, with its states or without, as a subject."""
    return Subject(joint)


def stored_subject(stored: StoredResult, progress: Callable[[float, float], None] | None = None) -> Subject:
    """Return the result of a run, or the life of wear, in a file. The progress is that of :class:`Subject`."""
    return Subject(life_of(stored)) if stored.is_life else Subject(stored.result, stored, progress)


def with_stored_cycles(subject: Subject) -> WearResult:
    """Return the life of wear of a subject. Without a stored cycle raise :class:`InputError`."""
    life = checks.instance("result", subject.life, WearResult, "a WearResult")
    if not len(life):
        raise InputError("result", "has no stored cycle: the life of wear ended before its first one")
    return life


def with_cycles(subject: Subject) -> Result:
    """Return the result of a subject, perhaps without its states. Without a cycle raise :class:`InputError`."""
    result = subject.result()
    if not result.cycles:
        raise InputError("result", f"{NO_CYCLE}; loops and slip also show --corners 21-101")
    return result

"""The extremes of a result: the smallest and the largest value of each quantity, and the states that have them.

A reading of a state may take milliseconds. So the nodal values of all states give bounds of the readings first, see
:mod:`fastpin.states.reading_bounds`. Then the states are read in the order of their bounds, until no other state can
have a more extreme value. So an extreme is the reading of its state, to the last bit. Equal states are read once.

:func:`yield_doubts` warns of von Mises stresses above the yield strengths of the bodies.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from fastpin.errors import InputWarning, ReadingError, reading
from fastpin.model.doubts import are_given, are_loads_plausible, yield_doubt
from fastpin.model.history import LoadHistory
from fastpin.model.loads import REMOTE, TEMPERATURE
from fastpin.model.problem import Problem
from fastpin.model.ties import least_equal
from fastpin.reading.marks import Marks
from fastpin.states.quantities import QUANTITIES, Quantity, load_point, of_bush, only_where, point_name
from fastpin.states.reading_bounds import NUMBERS, Bounds, StateBlock
from fastpin.states.state import State
from fastpin.states.yielding import OWNERS, PREFIX, place_words, von_mises_peak, yielding_owners

Side = Literal["smallest", "largest", "largest magnitude"]
"""Which extreme of a quantity, as the ``take`` of an outcome."""

AT_ONCE = 256
"""States whose nodal values are in memory at once, and most states that are read at once."""


def _von_mises(owner: str) -> Quantity:
    """Return the largest von Mises stress of a body whose yield strength is known."""
    words = f"largest von Mises stress of the {owner}"
    return only_where(
        lambda problem: owner in yielding_owners(problem),
        Quantity(words, "traction", lambda state: von_mises_peak(state, owner).value),
    )


READINGS: dict[str, Quantity] = {
    **{
        name: each
        for name, each in QUANTITIES.items()
        if each.kind not in ("angle", "ratio", "class") and not each.is_part
    },
    "bush_least_friction": of_bush("bush least friction", "ratio", "least_friction"),
    "seat_slip": only_where(
        lambda problem: problem.seat is not None,
        Quantity("slip in the seat", "displacement", lambda state: state.seat.peak_slip),  # type: ignore[union-attr]
    ),
    **{PREFIX + owner: _von_mises(owner) for owner in OWNERS},
}
"""The quantities that have extremes.

A place on a circle and a class are neither large nor small. The ratios Kt grow without bound while the load falls to
zero. A part belongs to its whole.
"""

MARKS: dict[tuple[str, Side], str] = {
    ("peak_pressure", "largest"): "largest pressure",
    ("peak_shear", "largest magnitude"): "largest shear",
    ("peak_hoop", "largest"): "largest hoop stress",
    ("peak_hoop_seat", "largest"): "largest hoop stress at the seat",
    ("peak_hoop_outline", "largest"): "largest hoop stress of the outline",
    ("bush_open_margin", "smallest"): "bush nearest to opening",
    ("bush_least_friction", "largest"): "bush nearest to slip",
    ("seat_slip", "largest magnitude"): "largest slip of the bush",
    **{(PREFIX + owner, "largest"): f"largest von Mises stress of the {owner}" for owner in OWNERS},
}
"""The extremes that texts, tables and figures show, with their words."""


class Extreme(NamedTuple):
    """An extreme of a quantity over the kept states of a result.

    Attributes
    ----------
    value : float
        In the unit of the quantity.
    place : int
        Place of the state in the result, from 0; the first of equal states.
    load_point : float
        Load point of the state: 1 at the first corner, 1.5 halfway to the second one.
    """

    value: float
    place: int
    load_point: float


class Extremes(NamedTuple):
    """The smallest and the largest value of a quantity over the kept states of a result, with sign."""

    smallest: Extreme
    largest: Extreme


class Found(dict[tuple[str, Side], Extreme]):
    """Extremes by quantity and side.

    Attributes
    ----------
    unread : dict of str to ReadingError
        Why the other quantities could not be read, by quantity.
    """

    def __init__(self) -> None:
        super().__init__()
        self.unread: dict[str, ReadingError] = {}


class KeptStates:
    """The kept states of a result, at least one, all of one problem and on one grid. Few of them are read as a whole.

    These are in memory. Those of a file are a subclass, :class:`fastpin.storage.stored_states.StoredStates`.

    Attributes
    ----------
    problem : Problem
    grid : Grid
    points : ndarray, shape (states,)
        Load points.
    """

    def __init__(self, states: Sequence[State]) -> None:
        self.problem, self.grid = states[0].problem, states[0].grid
        self.points = np.array([load_point(state) for state in states])
        self._states = states

    def __iter__(self) -> Iterator[State]:
        """Give all states, in order."""
        for begin in range(0, self.points.size, AT_ONCE):
            yield from self.read(range(begin, min(begin + AT_ONCE, self.points.size)))

    def blocks(self) -> Iterator[StateBlock]:
        """Give the nodal values of all states, in order."""
        for begin in range(0, len(self._states), AT_ONCE):
            yield _block_of(self._states[begin : begin + AT_ONCE])

    def read(self, places: Sequence[int]) -> list[State]:
        """Read the states at these places, in increasing order."""
        return [self._states[place] for place in places]


def _block_of(states: Sequence[State]) -> StateBlock:
    """The nodal values of some states on one grid, and of their seats."""
    marks = [(state.marks or Marks()).arrays(state.grid.size) for state in states]
    seats = [state.seat for state in states if state.seat is not None]
    numbers = {name: np.array([getattr(state, name) for state in states]) for name in NUMBERS}
    if seats:
        numbers["seat_slip"] = np.array([seat.peak_slip for seat in seats])
    return StateBlock(
        np.array([state.pressure for state in states]),
        np.array([state.shear for state in states]),
        np.array([state.status for state in states]),
        np.array([list(state.load.values()) for state in states]),
        tuple(np.array([arrays[k] for arrays in marks]) for k in range(2)),
        numbers,
        _block_of(seats) if seats else None,
    )


def all_extremes(kept: KeptStates) -> dict[str, Extremes]:
    """Find the extremes of all quantities that the states have; see :meth:`fastpin.Result.extremes`."""
    sides: tuple[Side, Side] = ("smallest", "largest")
    found = find_extremes(kept, [(name, side) for name in READINGS for side in sides])
    for error in found.unread.values():
        raise error
    names = [name for name in READINGS if (name, "largest") in found]
    return {name: Extremes(*(found[name, side] for side in sides)) for name in names}


def marked_extremes(kept: KeptStates) -> Found:
    """Find the extremes of :data:`MARKS`."""
    return find_extremes(kept, MARKS)


def yield_extremes(kept: KeptStates) -> Found:
    """Find the largest von Mises stress of each body that may yield.

    Left out is a body without a known strength, and one that is far from it in the states of the largest tractions and
    remote stresses: then the stresses of all other states need not be computed.
    """
    owners = yielding_owners(kept.problem)
    if not owners:
        return Found()
    columns = []
    for block in kept.blocks():
        tractions = [part for each in (block, block.seat or block) for part in (each.pressure, each.shear)]
        remote = np.abs(block.loads[:, list(REMOTE)])
        warm = np.abs(block.loads[:, TEMPERATURE])
        columns.append(np.column_stack([remote, *(np.abs(part).max(axis=1) for part in tractions), warm]))
    if not columns or _are_plainly_elastic(kept.problem, min(owners.values()), np.concatenate(columns).max(axis=0)):
        return Found()  # also if the run was stopped before its first state
    places = {int(np.argmax(column)) for column in np.concatenate(columns).T if column.any()}
    states = kept.read(sorted(places))
    near = [owner for owner in owners if any(_is_near_yield(state, owner) for state in states)]
    return find_extremes(kept, [(PREFIX + owner, "largest") for owner in near])


def _are_plainly_elastic(problem: Problem, least: float, most: np.ndarray) -> bool:
    """Whether the largest stresses on a solid pin and an infinite plate tell that both are far from yield.

    `least` is the least yield strength, Pa. `most` (8,) has the remote stresses (sxx, syy, sxy), pressure and shear at
    the pin and in the seat, and temperature.
    """
    plate = problem.plate_body
    is_plain = plate.is_infinite and not (plate.bush or plate.force_points or problem.pin_body.bore_radius)
    is_plain = is_plain and problem.pair.plate.is_isotropic
    # Von Mises stresses were up to 2.1 times this sum in 410 random states, and are 3 times the stress at an open hole.
    return is_plain and 3.5 * float(most[:5].sum() + most[2]) < least


def _is_near_yield(state: State, owner: str) -> bool:
    """Whether the largest von Mises stress of a body may be above half of its yield strength.

    Only the edges are looked at. Below an edge the stress by a pressure is at most the pressure (the half-plane), and
    other loads bend a body most at its edges.
    """
    with reading(PREFIX + owner):
        peak = von_mises_peak(state, owner, edges_only=True)
    strength = state.problem.joint.materials[owner].known_yield_strength
    rims = (state,) if state.seat is None else (state, state.seat)
    largest = max(peak.value, *(float(rim.pressure.max()) for rim in rims))
    return strength is not None and 2.0 * largest > strength


def yield_doubts(
    problem: Problem,
    history: LoadHistory,
    extremes: Callable[[], Found],
    read: Callable[[Sequence[int]], list[State]],
) -> list[InputWarning]:
    """Return a warning for each body whose largest von Mises stress exceeds its yield strength.

    A warning names the largest stress of all states, with its place. A body without a known yield strength has none.

    Parameters
    ----------
    problem : Problem
    history : LoadHistory
        If its loads are in doubt, the stresses are not.
    extremes : callable
        ``extremes()`` gives extremes of all states, with all of :func:`yield_extremes`.
        It is called only if a strength is known.
    read : callable
        ``read(places)`` gives the states at these places.
    """
    owners = yielding_owners(problem)
    if not owners or are_given() or not are_loads_plausible(problem, history):
        return []
    try:
        found = extremes()
    except ReadingError as error:
        return [InputWarning(error.field, error.reason)]
    doubts: list[InputWarning | None] = [InputWarning(error.field, error.reason) for error in found.unread.values()]
    for owner in owners:
        extreme = found.get((PREFIX + owner, "largest"))
        if extreme is not None:
            peak = von_mises_peak(read([extreme.place])[0], owner)
            where = f"{place_words(problem, peak)}, load point {point_name(extreme.load_point)}"
            doubts.append(yield_doubt(problem, peak.circle.edge, peak.value, where))
    return [doubt for doubt in doubts if doubt is not None]


def yield_doubts_of(problem: Problem, history: LoadHistory, states: Sequence[State]) -> list[InputWarning]:
    """Return the warnings of :func:`yield_doubts` for states in memory."""
    if not states:
        return []
    kept = KeptStates(states)
    return yield_doubts(problem, history, lambda: yield_extremes(kept), kept.read)


def find_extremes(kept: KeptStates, wanted: Iterable[tuple[str, Side]]) -> Found:
    """Find extremes by quantity and side. Those that the problem does not have are left out.

    A quantity that can't be read does not hide the others.

    A place that has the same tractions and loads as an earlier one is not read.
    """
    wanted, found = [pair for pair in wanted if READINGS[pair[0]].exists(kept.problem)], Found()
    if not wanted or not kept.points.size:
        return found
    try:
        different = Different(kept, {name for name, _ in wanted})
    except ReadingError as error:
        found.unread = {name: error for name, _ in wanted}
        return found
    for name, side in wanted:
        try:
            extreme = different.extreme(name, side)
        except ReadingError as error:
            found.unread[name] = error
            continue
        if extreme is not None:
            found[name, side] = extreme
    return found


def marked_places(extremes: Mapping[tuple[str, Side], Extreme]) -> dict[int, str]:
    """Return the places of the extremes of :data:`MARKS` with words on each, in order."""
    words: dict[int, list[str]] = {}
    for pair, extreme in extremes.items():
        words.setdefault(extreme.place, []).append(MARKS[pair])
    return {place: ", ".join(words[place]) for place in sorted(words)}


class Different:
    """The different states of a result, with bounds of their readings.

    Parameters
    ----------
    kept : KeptStates
    names : set of str
        The quantities that will be asked for.
    """

    def __init__(self, kept: KeptStates, names: set[str]) -> None:
        self._kept = kept
        first: dict[bytes, int] = {}
        numbers: dict[str, list[np.ndarray]] = {name: [] for name in (*NUMBERS, "seat_slip") if name in names}
        bounds, begin = Bounds(kept.problem, kept.grid, names), 0
        for block in kept.blocks():
            rows, parts = [], block.read_parts
            for row in range(len(block.pressure)):
                digest = hashlib.blake2b(digest_size=16)
                for part in parts:
                    digest.update(part[row].tobytes())
                if first.setdefault(digest.digest(), begin + row) == begin + row:
                    rows.append(row)
            with reading("extremes"):
                bounds.add(block, rows)
            for name, known in numbers.items():
                known.append(block.numbers[name])
            begin += len(block.pressure)
        places, every = np.array(list(first.values())), np.arange(begin)
        self._bounds = {name: (places, low, high) for name, (low, high) in bounds.found().items()}
        for name, known in numbers.items():
            values = np.concatenate(known)  # energies differ in states that are equal otherwise
            self._bounds[name] = every, values, values

    def extreme(self, name: str, side: Side) -> Extreme | None:
        """Return the extreme of a quantity, of equal ones the first; None if the quantity is NaN in all states."""
        places, low, high = self._bounds[name]
        most = {"smallest": -low, "largest": high, "largest magnitude": np.maximum(-low, high)}[side]
        best, read = -math.inf, dict[int, float]()
        value = {"smallest": np.negative, "largest": np.positive, "largest magnitude": np.abs}[side]
        order = np.lexsort((places, -most))
        begin, size = 0, 1
        while begin < order.size and (not read or most[order[begin]] > best):
            some = order[begin : begin + size]
            chosen = sorted(places[some[most[some] >= best]].tolist())
            readings = {at: _read(name, state) for at, state in zip(chosen, self._kept.read(chosen), strict=True)}
            read |= {at: reading for at, reading in readings.items() if not math.isnan(reading)}
            best = max((float(value(reading)) for reading in read.values()), default=best)
            begin, size = begin + size, min(4 * size, AT_ONCE)
        least = least_equal(np.array(best))
        for place in sorted(places[most >= least].tolist()) if read else ():
            if place not in read:
                read[place] = _read(name, self._kept.read([place])[0])
            if value(read[place]) >= least:
                return Extreme(read[place], place, float(self._kept.points[place]))
        return None


def _read(name: str, state: State) -> float:
    with reading(name):
        return READINGS[name].of(state)

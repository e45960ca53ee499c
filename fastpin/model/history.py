"""Load histories: corners of the loads. The loads start from zero and are linear between corners.

A history is a sequence of blocks. A block is a table of corners, and the number of times that it is run through. So a
million cycles take the memory of one cycle, and a table of a million corners is held once.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import cos_degrees
from fastpin.model.checks import (
    as_toml,
    file_path,
    instances,
    is_whole,
    items,
    number,
    number_array,
    places_of,
    true_or_false,
    whole_number,
)
from fastpin.model.loads import LOAD_KIND, LOADS, Corner, check_corner, load_index
from fastpin.model.problem import checked_thickness
from fastpin.model.synonyms import explains_keywords

MAX_CORNERS = 100_000_000
"""Corners of a history, at most."""

MOST_POINTS = 100_000
"""Most corners in a harmonic cycle."""

CycleKey = tuple[int, int]
"""A cycle of a history: the block, counted from 0, and the inner cycle, counted from 1; 0 is the block itself."""


@dataclass(frozen=True, eq=False)
class Block:
    """A table of corners that is run through once or more.

    Inner cycles are cycles inside the table.

    Attributes
    ----------
    given : ndarray, shape (corners, loads)
        The loads as given; NaN keeps the last value.
    ends : ndarray of int, shape (corners,)
        The inner cycle that ends at a corner, counted from 1; 0 where none ends.
    lengths : tuple of int
        Number of corners of each inner cycle.
    count : int
        Number of times that the block is run through.
    cycle : bool
        Whether each time through is a cycle, or the end of one in a block cut from a longer cycle.
    size : int
        Number of corners of the whole table, if this block is cut from it; 0 if it is not cut.

    Raises
    ------
    InputError
        If an attribute is out of range, or does not fit the others.
    """

    given: np.ndarray
    ends: np.ndarray
    lengths: tuple[int, ...] = ()
    count: int = 1
    cycle: bool = False
    size: int = 0

    @classmethod
    def plain(cls, given: np.ndarray) -> Block:
        """A table (corners, loads) that is run through once, without cycles."""
        return cls(given, np.zeros(len(given), dtype=np.int64))

    @property
    def corners(self) -> int:
        """Number of corners, all times through."""
        return len(self.given) * self.count

    def __post_init__(self) -> None:
        rows, cycles = len(self.given), len(self.lengths)
        if self.given.shape != (rows, len(LOADS)) or not self.given.dtype == float or np.isinf(self.given).any():
            raise InputError("given", f"must be finite numbers or NaN, shape (corners, {len(LOADS)})")
        if (
            self.ends.shape != (rows,)
            or self.ends.dtype.kind != "i"
            or (rows and not 0 <= self.ends.min() <= self.ends.max() <= cycles)
        ):
            raise InputError("ends", f"must be {rows} whole numbers from 0 to {cycles}, the number of inner cycles")
        whole_number("count", self.count, 1)
        whole_number("size", self.size, 0)
        for length in self.lengths:
            whole_number("lengths", length, 1, max(rows, self.size))
        true_or_false("cycle", self.cycle)

    @cached_property
    def begins(self) -> np.ndarray:
        """The inner cycles that begin with each corner, as bits, shape (corners,); cycles 63 apart share a bit."""
        begins = np.zeros(len(self.given), dtype=np.int64)
        for inner, length in enumerate(self.lengths, start=1):
            first = np.flatnonzero(self.ends == inner) - length + 1
            begins[first[first >= 0]] |= 1 << (inner % 63)
        return begins

    def cut(self, start: int, stop: int) -> Iterator[Block]:
        """Yield the corners from `start` up to `stop`, not included, as few blocks."""
        size = len(self.given)
        first, last = -(-start // size), stop // size  # whole times through
        if first > last:
            yield self._part(start % size, stop - (last * size))
            return
        if start < first * size:
            yield self._part(start % size, size)
        if first < last:
            yield replace(self, count=last - first)
        if last * size < stop:
            yield self._part(0, stop - last * size)

    def _part(self, start: int, stop: int) -> Block:
        whole, size = self.cycle and stop == len(self.given), self.size or len(self.given)
        return replace(self, given=self.given[start:stop], ends=self.ends[start:stop], count=1, cycle=whole, size=size)


class LoadHistory:
    """A sequence of load corners. The loads start from zero and vary linearly from one corner to the next.

    Parameters
    ----------
    corners : sequence of mappings
        Each maps some of :data:`fastpin.model.LOADS` to numbers. A load that is left out keeps its last value.

    Raises
    ------
    InputError
        If there are no corners, a load is unknown or a value is not a finite number.

    Examples
    --------
    >>> LoadHistory([{"P": 1e6}, {"Q": 2e5}, {"Q": -2e5}]).values()[:, :2]
    array([[1000000.,       0.],
           [1000000.,  200000.],
           [1000000., -200000.]])
    >>> program = LoadHistory([{"P": 1e6}]) + LoadHistory([{"Q": 2e5}, {"Q": -2e5}]).repeated(1000)
    >>> len(program)
    2001
    """

    def __init__(self, corners: Iterable[Corner]) -> None:
        if isinstance(corners, (str, Mapping)):
            raise InputError("history", f'must be a list of corners, such as [{{"P": 1e6}}], not {as_toml(corners)}')
        rows = []
        for index, corner in enumerate(items("history", corners, "a list of corners")):
            if not isinstance(corner, Mapping):
                raise InputError("history", f"corner {index + 1} must map load names to numbers, not {as_toml(corner)}")
            row = np.full(len(LOADS), np.nan)
            for name, value in corner.items():
                row[load_index(name, f"corner {index + 1}")] = number(f"{name} of corner {index + 1}", value)
            rows.append(row)
        self._set([Block.plain(np.array(rows).reshape(-1, len(LOADS)))])

    def _set(self, blocks: Iterable[Block]) -> None:
        self._blocks = tuple(block for block in blocks if block.corners)
        if not self._blocks:
            raise InputError("history", "must have at least one load corner")
        for block in self._blocks:
            block.given.setflags(write=False)
        self._begins = [0]
        for block in self._blocks:
            self._begins.append(self._begins[-1] + block.corners)

    @classmethod
    def of_blocks(cls, blocks: Iterable[Block]) -> LoadHistory:
        """A history of given blocks. No corners at all raise :class:`InputError`."""
        history = cls.__new__(cls)
        history._set(instances("blocks", blocks, Block, "a sequence of blocks"))
        return history

    @classmethod
    def monotonic(cls, steps: int = 1, **loads: float) -> LoadHistory:
        """Proportional loading from zero to `loads`, with `steps` equally spaced corners."""
        steps = whole_number("steps", steps, 1, MAX_CORNERS)
        last = check_corner("the last corner", loads)
        return cls({k: v * (i + 1) / steps for k, v in last.items()} for i in range(steps))

    @classmethod
    @explains_keywords
    def cycles(
        cls, mean: Corner, amplitude: Corner, count: int = 1, start: float = 1.0, return_to_mean: bool = False
    ) -> LoadHistory:
        """The mean load, then `count` full cycles between mean + amplitude and mean - amplitude.

        Parameters
        ----------
        mean, amplitude : mapping
            Loads of the mean state and of the cycle's half range.
        count : int
            Number of cycles. One cycle runs mean -> +amplitude -> -amplitude -> +amplitude. Each further cycle appends
            -amplitude -> +amplitude.
        start : {1, -1}
            Sign of the first excursion.
        return_to_mean : bool
            Whether to append the mean load as a last corner.

        Raises
        ------
        InputError
            If an argument is of the wrong kind or out of range. The error names the argument.
        """
        count = whole_number("count", count, 1)
        start = number("start", start)
        if start not in (1.0, -1.0):
            raise InputError("start", f"must be 1 or -1, not {as_toml(start)}")
        mean, amplitude = check_corner("mean", mean), check_corner("amplitude", amplitude)
        plus = {k: mean.get(k, 0.0) + start * v for k, v in amplitude.items()}
        minus = {k: mean.get(k, 0.0) - start * v for k, v in amplitude.items()}
        history = cls([mean, plus]) + cls([minus, plus]).repeated(count)
        if true_or_false("return_to_mean", return_to_mean):
            history += cls([{k: mean.get(k, 0.0) for k in amplitude}])
        return history

    @classmethod
    @explains_keywords
    def harmonic(
        cls, mean: Corner, amplitude: Corner, phase: Corner | None = None, count: int = 1, points: int | None = None
    ) -> LoadHistory:
        """`count` cycles of the loads mean + amplitude cos(2 pi t + phase), from t = 0 on.

        Parameters
        ----------
        mean, amplitude : mapping
            Loads. A load that only one of the two gives is 0 in the other.
        phase : mapping, optional
            Lead of each load of `amplitude`, degrees; 0 where left out.
        count : int
            Number of cycles. The first corner is the point t = 0. Every cycle ends at this point.
        points : int, optional
            Corners of a cycle, 2 to :data:`MOST_POINTS`. If all phases are 0 or 180 degrees the default is 2: the two
            extremes, between which all loads are proportional. Otherwise the default is 24, and the path is
            a polygon inscribed in the ellipse.
        """
        count = whole_number("count", count, 1)
        mean, amplitude = check_corner("mean", mean), check_corner("amplitude", amplitude)
        phase = check_corner("phase", {} if phase is None else phase)
        if not amplitude:
            raise InputError("amplitude", "must give at least one load")
        for name in phase:
            if name not in amplitude:
                raise InputError("phase", f"{name} has a phase but no amplitude")
        if points is None:
            points = 2 if all(angle % 180.0 == 0.0 for angle in phase.values()) else 24
        points = whole_number("points", points, 2, MOST_POINTS)

        def corner(turn: float) -> dict[str, float]:
            return {
                name: mean.get(name, 0.0) + amplitude.get(name, 0.0) * cos_degrees(360.0 * turn + phase.get(name, 0.0))
                for name in LOADS
                if name in mean or name in amplitude
            }

        cycle = cls(corner(k / points) for k in [*range(1, points), 0])
        return cls([corner(0.0)]) + cycle.repeated(count)

    @classmethod
    def from_array(cls, corners: np.ndarray, loads: Sequence[str] = LOADS) -> LoadHistory:
        """A history from an array: its rows are corners, its columns are `loads`. NaN keeps the last value.

        Raises
        ------
        InputError
            If a load is unknown or named twice, the shape does not fit, a value is infinite or there are no corners.
        """
        columns = [load_index(name, "loads") for name in items("loads", loads, "a list of load names")]
        array = number_array("corners", corners)
        if len(set(columns)) < len(columns):
            raise InputError("loads", "a load is named twice")
        if array.ndim != 2 or array.shape[1] != len(columns):
            raise InputError("corners", f"must have the shape (corners, {len(columns)}), not {array.shape}")
        if np.isinf(array).any():
            raise InputError("corners", "must be finite numbers, or NaN to keep the last value")
        given = np.full((len(array), len(LOADS)), np.nan)
        given[:, columns] = array
        return cls.of_blocks([Block.plain(given)])

    @classmethod
    def from_csv(
        cls,
        path: str | Path,
        columns: Mapping[str, str | Mapping[str, Any]] | None = None,
        thickness: float | None = None,
        skip: int = 0,
    ) -> LoadHistory:
        """Read corners from a CSV file: perhaps a preamble, a header, one corner a line.

        An empty cell keeps the last value. Lines that begin with ``#`` and blank lines are skipped. Commas, semicolons,
        tabs or blanks separate cells. Numbers may have a decimal comma.

        Parameters
        ----------
        path : str or Path
        columns : mapping, optional
            The column of each load: ``{"P": "Force [N]"}``, or ``{"P": {"column": "F", "scale": -1, "unit": "kN"}}``.
            A column may be a number, counted from 1, of a file without a header. A pair makes two corners of each line,
            and ``"count"`` says how often: ``{"P": {"column": ["max", "min"]}, "count": "cycles"}``. By default every
            column is a load, with a unit or without: ``P``, ``P [kN/m]``.
        thickness : float, optional
            Thickness, m. The file has forces in N, and they are divided by it. By default they are per metre.
        skip : int
            Lines at the beginning that are not read. A preamble without numbers needs none.

        Raises
        ------
        CaseFileError
            If the file can't be read, a column is missing or unknown, a unit does not fit its load, or cells are not
            finite numbers. The error lists the first :data:`fastpin.tables.reader.MOST_FAULTS` faulty lines.
        InputError
            If `path`, `columns`, `thickness` or `skip` can't be used.
        """
        from fastpin.tables import Basis, column_choices, history_from_csv

        path = file_path("path", path)
        choices = None if columns is None else column_choices("columns", columns)
        skip = whole_number("skip", skip, 0)
        found = history_from_csv(path, choices, Basis("with thickness" if thickness else "per metre"), skip)
        return found if thickness is None else found.per_thickness(thickness)

    def repeated(self, count: int) -> LoadHistory:
        """This history `count` times in a row. Each time is a cycle.

        Cycles may lie inside other cycles. Where several cycles end at one corner, the history knows only the innermost
        and the outermost of them.
        """
        count = whole_number("count", count, 1)
        if len(self) * count > MAX_CORNERS:
            raise InputError("count", f"the history has more than {MAX_CORNERS:,} corners")
        given = np.vstack([_times(block, block.count) for block in self._blocks])
        ends: list[np.ndarray] = []
        lengths: tuple[int, ...] = ()
        for block in self._blocks:
            once = np.where(block.ends > 0, block.ends + len(lengths), 0)
            lengths += block.lengths
            if block.cycle:
                lengths += (len(once),)
                once[-1] = once[-1] or len(lengths)
            ends.append(np.tile(once, block.count))
        return LoadHistory.of_blocks([Block(given, np.concatenate(ends), lengths, count, cycle=True)])

    def scaled(self, factors: Corner) -> LoadHistory:
        """This history with some loads multiplied by factors, plain numbers by load: ``{"P": 1.1}``. Other loads stay.

        An unknown load, or a factor that is no finite number, raises :class:`InputError`.
        """
        factor = np.ones(len(LOADS))
        for name, value in check_corner("factors", factors).items():
            factor[LOADS.index(name)] = value
        with np.errstate(over="ignore"):  # an infinite load is refused
            return LoadHistory.of_blocks([replace(block, given=block.given * factor) for block in self._blocks])

    def per_thickness(self, thickness: float) -> LoadHistory:
        """This history with its forces, N, and moments, N m, divided by a thickness, m.

        The result has forces in N/m and moments in N, as all solvers take them. Other loads stay.

        A `thickness` that is not positive raises :class:`InputError`.
        """
        kinds = LOAD_KIND.values()
        divisor = np.where(
            [kind in ("force", "moment") for kind in kinds], checked_thickness("thickness", thickness), 1.0
        )
        return LoadHistory.of_blocks(replace(block, given=block.given / divisor) for block in self._blocks)

    def __repr__(self) -> str:
        given = ~np.all([np.all(np.isnan(block.given), axis=0) for block in self._blocks], axis=0)
        names = ", ".join(name for name, is_given in zip(LOADS, given, strict=True) if is_given)
        parts = [
            _count_corners(len(block.given)) + (f" x {block.count:,}" if block.count > 1 else "")
            for block in self._blocks[:6]
        ]
        more = [f"{len(self._blocks) - 6} more blocks"] * (len(self._blocks) > 6)
        blocks = f"; {' + '.join(parts + more)}" if len(self._blocks) > 1 or self._blocks[0].count > 1 else ""
        return f"<LoadHistory: {_count_corners(len(self))} of {names or 'no load'}{blocks}>"

    def __add__(self, other: LoadHistory) -> LoadHistory:
        """This history followed by `other`."""
        if not isinstance(other, LoadHistory):
            return NotImplemented
        return LoadHistory.of_blocks([*self._blocks, *other._blocks])

    def __len__(self) -> int:
        return self._begins[-1]

    def __getitem__(self, item: slice) -> LoadHistory:
        """A part of the history: a slice without a step. A load that it leaves out keeps its value from before."""
        if not isinstance(item, slice):
            raise InputError(
                "history", "parts are slices, such as history[2:5]; values() has the loads at every corner"
            )
        places = places_of("history", item, len(self))
        if places.step != 1:
            raise InputError("history", "parts are slices without a step")
        start, stop = places.start, places.stop
        parts = []
        for block, begin in zip(self._blocks, self._begins, strict=False):
            first, last = max(start - begin, 0), min(stop - begin, block.corners)
            if first < last:
                parts += list(block.cut(first, last))
        return LoadHistory.of_blocks(parts)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The blocks, in order."""
        return self._blocks

    @property
    def longest_cycle(self) -> int:
        """Number of corners of the longest cycle; 0 if there is none."""
        whole = [len(block.given) for block in self._blocks if block.cycle]
        return max([0, *whole, *(length for block in self._blocks for length in block.lengths)])

    @cached_property
    def largest(self) -> dict[str, float]:
        """The extreme value of each given load, with its sign, by name."""
        low: np.ndarray = np.fmin.reduce([np.fmin.reduce(block.given, axis=0) for block in self._blocks])
        high: np.ndarray = np.fmax.reduce([np.fmax.reduce(block.given, axis=0) for block in self._blocks])
        largest = np.where(-low > high, low, high)
        return {name: value for name, value in zip(LOADS, largest.tolist(), strict=True) if not math.isnan(value)}

    def corner(self, index: int) -> tuple[np.ndarray, list[CycleKey]]:
        """The loads given at a corner, shape (loads,), and the cycles that end there. NaN keeps the last value.

        Corners count from 0. An `index` without a corner raises :class:`InputError`.
        """
        if not is_whole(index) or not 0 <= index < len(self):
            whole_number("index", index, 0, len(self) - 1)
        block_index, place = _locate(self, index)
        block = self._blocks[block_index]
        row = place % len(block.given)
        cycles = [(block_index, inner)] if (inner := int(block.ends[row])) else []
        if block.cycle and row == len(block.given) - 1:
            cycles.append((block_index, 0))
        return block.given[row], cycles

    def values(self, initial: Sequence[float] | np.ndarray | None = None) -> np.ndarray:
        """All loads at all corners, shape (corners, loads), in the order of :data:`fastpin.model.LOADS`.

        `initial`, shape (loads,), is the load before the first corner; zero by default. Another shape raises
        :class:`InputError`.
        """
        return _filled([_times(block, block.count) for block in self._blocks], initial)

    def distinct(self, initial: Sequence[float] | np.ndarray | None = None) -> np.ndarray:
        """All loads that ever act, shape (corners, loads): as :meth:`values`, with every block at most twice."""
        return _filled([_times(block, min(block.count, 2)) for block in self._blocks], initial)


def cycle_length(history: LoadHistory, cycle: CycleKey) -> int:
    """Number of corners of a cycle."""
    block = history.blocks[cycle[0]]
    return block.lengths[cycle[1] - 1] if cycle[1] else block.size or len(block.given)


def cycles_after(history: LoadHistory, index: int) -> list[CycleKey]:
    """The cycles that begin with the step after corner `index`; -1 stands for the first step."""
    if index + 1 >= len(history):
        return []
    block_index, place = _locate(history, index + 1)
    block = history.blocks[block_index]
    row = place % len(block.given)
    cycles = [(block_index, 0)] if block.cycle and row == 0 and block.size in (0, len(block.given)) else []
    for inner, length in enumerate(block.lengths, start=1):
        if row + length <= len(block.given) and block.ends[row + length - 1] == inner:
            cycles.append((block_index, inner))
    return cycles


def same_ahead(history: LoadHistory, index: int, period: int) -> int:
    """Number of corners from `index` on that repeat the corners `period` before them.

    The given loads must be equal, and the same cycles must begin and end. The number is a lower bound: only
    corners of one block are compared. Unless `period` is a multiple of the block's table, only corners of the same
    time through are compared.
    """
    if index >= len(history):
        return 0
    block_index, place = _locate(history, index)
    block = history.blocks[block_index]
    size = len(block.given)
    if place < period:
        return 0
    if period % size == 0:
        return block.corners - place
    row = place % size
    stop = size - 1 if block.cycle else size  # there a cycle ends that did not end one period before
    length = 64
    while period <= row < stop:
        last = min(row + length, stop)
        given, before = block.given[row:last], block.given[row - period : last - period]
        same = np.all((given == before) | (np.isnan(given) & np.isnan(before)), axis=1)
        for marks in (block.ends, block.begins):
            same &= marks[row:last] == marks[row - period : last - period]
        if not same.all():
            row += int(np.argmin(same))
            break
        row, length = last, 8 * length
    return row - place % size


def _locate(history: LoadHistory, index: int) -> tuple[int, int]:
    """The block in which a corner lies, and the corner's place in it, both counted from 0."""
    begins = history._begins
    block_index = bisect.bisect_right(begins, index) - 1
    return block_index, index - begins[block_index]


def _filled(parts: list[np.ndarray], initial: Sequence[float] | np.ndarray | None) -> np.ndarray:
    first = np.zeros(len(LOADS)) if initial is None else number_array("initial", initial)
    if first.shape != (len(LOADS),):
        raise InputError("initial", f"must have the shape ({len(LOADS)},), not {first.shape}")
    values = np.concatenate([first[None], *parts])
    rows = np.where(np.isnan(values), 0, np.arange(len(values))[:, None])
    filled: np.ndarray = values[np.maximum.accumulate(rows), np.arange(len(LOADS))]
    return filled[1:]


def _times(block: Block, count: int) -> np.ndarray:
    return block.given if count == 1 else np.tile(block.given, (count, 1))


def _count_corners(count: int) -> str:
    return f"{count:,} corner{'' if count == 1 else 's'}"

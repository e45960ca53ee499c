"""Load histories: corner points of the loads, linear in between, starting from no load."""

from __future__ import annotations

import csv
import difflib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from fastpin.checks import finite, whole_number
from fastpin.errors import InputError
from fastpin.problem import Problem

LOADS = ("P", "Q", "M", "sxx", "syy", "rotation")
"""Names of the loads, in the order of every load vector.

* ``P``: force on the pin downwards (-y), N/m.
* ``Q``: force on the pin along +x, N/m.
* ``M``: moment on the pin, counter-clockwise, N (per unit thickness); only for a pin that rotates freely.
* ``sxx``, ``syy``: remote stresses in the plate, Pa.
* ``rotation``: prescribed rotation of the pin, rad, counter-clockwise; only for a pin whose rotation is fixed.
"""

Corner = Mapping[str, float]


class LoadHistory:
    """A sequence of load corners. Loads vary linearly from one corner to the next, starting from no load.

    Parameters
    ----------
    corners : sequence of mappings
        Each maps some of :data:`LOADS` to a number; what is left out keeps its last value.

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
    """

    def __init__(self, corners: Iterable[Corner]) -> None:
        rows = []
        for index, corner in enumerate(corners):
            if not isinstance(corner, Mapping):
                raise InputError("history", f"corner {index + 1} must map load names to numbers, not {corner!r}")
            row = np.full(len(LOADS), np.nan)
            for name, value in corner.items():
                row[_load_index(name, f"corner {index + 1}")] = finite(f"{name} of corner {index + 1}", value)
            rows.append(row)
        self._given = _checked(np.array(rows).reshape(-1, len(LOADS)))

    @classmethod
    def _from_given(cls, given: np.ndarray) -> LoadHistory:
        history = cls.__new__(cls)
        history._given = _checked(given)
        return history

    @classmethod
    def monotonic(cls, steps: int = 1, **loads: float) -> LoadHistory:
        """Proportional loading from nothing to `loads`, with `steps` equally spaced corners."""
        whole_number("steps", steps, 1)
        return cls({k: v * (i + 1) / steps for k, v in loads.items()} for i in range(steps))

    @classmethod
    def cycles(
        cls, mean: Corner, amplitude: Corner, count: int = 1, start: float = 1.0, return_to_mean: bool = False
    ) -> LoadHistory:
        """The mean load, then `count` full cycles between mean + amplitude and mean - amplitude.

        Parameters
        ----------
        mean, amplitude : mapping
            Loads of the mean state and of the cycle's half range.
        count : int
            Number of cycles. One cycle is mean -> +amplitude -> -amplitude -> +amplitude.
        start : {1, -1}
            Sign of the first excursion.
        return_to_mean : bool
            Append the mean load as a last corner.
        """
        whole_number("count", count, 1)
        if start not in (1, -1):
            raise InputError("start", f"must be 1 or -1, not {start!r}")
        for field, loads in (("mean", mean), ("amplitude", amplitude)):
            for name, value in loads.items():
                _load_index(name, field)
                finite(f"{name} of {field}", value)
        plus = {k: mean.get(k, 0.0) + start * v for k, v in amplitude.items()}
        minus = {k: mean.get(k, 0.0) - start * v for k, v in amplitude.items()}
        corners: list[Corner] = [mean, plus, *[minus, plus] * count]
        if return_to_mean:
            corners.append({k: mean.get(k, 0.0) for k in amplitude})
        return cls(corners)

    @classmethod
    def from_csv(cls, path: str | Path) -> LoadHistory:
        """Read corners from a CSV file: a header of load names, one corner a line.

        An empty cell keeps the last value. Lines that begin with ``#`` and blank lines are skipped.

        Raises
        ------
        InputError
            If the file can't be read, a column is unknown, or a cell is not a finite number (with its line).
        """
        path = Path(path)
        try:
            text = path.read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError("csv", f"can't read {path}: {getattr(error, 'strerror', None) or error}") from None
        header: list[int] = []
        rows: list[np.ndarray] = []
        for number, line in enumerate(text.splitlines(), start=1):
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            cells = [cell.strip() for cell in next(csv.reader([line]))]
            where = f"{path}, line {number}"
            if not header:
                header = [_load_index(cell, where) for cell in cells]
                if len(set(header)) < len(header):
                    raise InputError("csv", f"{where}: a load is named twice")
                continue
            if len(cells) != len(header):
                raise InputError("csv", f"{where}: {len(cells)} cells where the header has {len(header)}")
            row = np.full(len(LOADS), np.nan)
            for index, cell in zip(header, cells, strict=True):
                if cell:
                    try:
                        row[index] = finite(LOADS[index], float(cell))
                    except ValueError:
                        raise InputError(
                            LOADS[index], f"{where}: {LOADS[index]} must be a finite number, not {cell!r}"
                        ) from None
            rows.append(row)
        if not rows:
            raise InputError("csv", f"{path} holds no load corners")
        return cls._from_given(np.array(rows))

    def repeated(self, count: int) -> LoadHistory:
        """The same corners `count` times in a row."""
        whole_number("count", count, 1)
        return LoadHistory._from_given(np.tile(self._given, (count, 1)))

    def __add__(self, other: LoadHistory) -> LoadHistory:
        """This history followed by `other`."""
        if not isinstance(other, LoadHistory):
            return NotImplemented
        return LoadHistory._from_given(np.vstack([self._given, other._given]))

    def __len__(self) -> int:
        return len(self._given)

    def __getitem__(self, item: slice) -> LoadHistory:
        """A part of the history (a slice); what a part leaves out keeps the value before it."""
        return LoadHistory._from_given(self._given[item])

    def values(self, initial: Sequence[float] | np.ndarray | None = None) -> np.ndarray:
        """All loads at all corners, shape (corners, loads) in the order of :data:`LOADS`.

        `initial` is the load before the first corner (none by default).
        """
        first = np.zeros(len(LOADS)) if initial is None else np.asarray(initial, dtype=float)
        filled = np.vstack([first, self._given])
        rows = np.where(np.isnan(filled), 0, np.arange(len(filled))[:, None])
        latest = np.maximum.accumulate(rows, axis=0)
        return np.take_along_axis(filled, latest, axis=0)[1:]


def check_loads(problem: Problem, history: LoadHistory) -> None:
    """Raise :class:`InputError` if a load of `history` can't act in `problem`."""
    given = history._given
    moment, rotation = given[:, LOADS.index("M")], given[:, LOADS.index("rotation")]
    if problem.pin_load == "body" and np.any(np.nan_to_num(moment) != 0.0):
        raise InputError(
            "M",
            "a body-loaded pin can't carry a moment: uniform body forces leave the moment's singularity at the centre "
            '(section 4 of the paper); use pin_load = "centre"',
        )
    if problem.rotation == "fixed" and not np.all(np.isnan(moment)):
        raise InputError("M", 'the moment is a reaction where rotation = "fixed"; leave it out or let the pin rotate')
    if problem.rotation == "free" and not np.all(np.isnan(rotation)):
        raise InputError("rotation", 'a rotation can be prescribed only where rotation = "fixed"')


def named_load(vector: np.ndarray) -> dict[str, float]:
    """A load vector as a dict from load name to value."""
    return {name: float(value) for name, value in zip(LOADS, vector, strict=True)}


def _checked(given: np.ndarray) -> np.ndarray:
    if len(given) == 0:
        raise InputError("history", "must have at least one load corner")
    given.setflags(write=False)
    return given


def _load_index(name: object, where: str) -> int:
    if name in LOADS:
        return LOADS.index(str(name))
    folded = {load.lower(): load for load in LOADS}
    close = difflib.get_close_matches(str(name).lower(), folded, n=1)
    hint = f', did you mean "{folded[close[0]]}"?' if close else ""
    raise InputError(str(name), f"{where}: unknown load {name!r}; the loads are {', '.join(LOADS)}{hint}")

"""Options of the solver: one set of names, defaults, limits and checks.

:func:`fastpin.solve`, :func:`fastpin.record`, case files, plans and the command line all make a :class:`SolveOptions`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, TypedDict

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import (
    as_toml,
    check_fields,
    choice,
    is_whole,
    number,
    set_fields,
    true_or_false,
    whole_number,
)
from fastpin.model.grid import LEAST_NODES, MAX_NODES
from fastpin.model.synonyms import explains_keywords

Method = Literal["path", "increment"]
"""Name of a solver, for type checkers."""

METHODS = ("path", "increment")
"""Names of the solvers."""

MOST_BETWEEN = 10_000
"""Most states inside a step."""

ALL_ROUND = -1.5 * math.pi, 0.5 * math.pi
"""The whole circle as an arc, rad."""

KEEP_WORDS = ("all", "corners", "cycles")
"""Words for the states that are kept. ``"every N"`` is the other form."""


@dataclass(frozen=True)
class KeepRule:
    """A rule for the states of a history that are kept. The last state is always kept.

    Parameters
    ----------
    which : {"all", "corners", "cycles"}
        Keep all states, the states at corners, or the states at which a cycle ends.
    every : int
        Keep every n-th corner only: 10 keeps the corners 10, 20, 30, ... More than 1 needs ``which="corners"``.

    Raises
    ------
    InputError
        If `which` is unknown, or `every` does not fit.
    """

    which: str = "all"
    every: int = 1

    def __post_init__(self) -> None:
        set_fields(self, which=choice("keep", self.which, KEEP_WORDS))
        whole_number("keep", self.every, 1, None if self.which == "corners" else 1)

    @classmethod
    def read(cls, text: str | KeepRule) -> KeepRule:
        """Read ``"all"``, ``"corners"``, ``"cycles"`` or ``"every N"``.

        Raises
        ------
        InputError
            If `text` is none of these.
        """
        if isinstance(text, KeepRule):
            return text
        if isinstance(text, str) and text in KEEP_WORDS:
            return cls(text)
        match = re.fullmatch(r"every[ =:-]?([1-9]\d{0,8})", text) if isinstance(text, str) else None
        if match is None:
            raise InputError(
                "keep", f'must be "all", "corners", "cycles" or "every N", such as "every 10", not {as_toml(text)}'
            )
        return cls("corners", int(match[1]))

    def __str__(self) -> str:
        return self.which if self.every == 1 else f"every {self.every}"

    @property
    def inside(self) -> bool:
        """Whether states inside steps are kept."""
        return self.which == "all"

    @property
    def every_corner(self) -> bool:
        """Whether the state at every corner is kept."""
        return self.which != "cycles" and self.every == 1

    def at_corner(self, corner: int, corners: int, ends_cycle: bool) -> bool:
        """Whether the state at a corner is kept. The corner counts from 0, out of `corners` in all."""
        if corner + 1 == corners:
            return True
        return ends_cycle if self.which == "cycles" else (corner + 1) % self.every == 0


def option(default: Any, words: str, later: bool = False) -> Any:
    """Return a field of :class:`SolveOptions`: its default, and its words in reports.

    A later option enters ids and files only where it differs from its default, so that older ones stay.
    """
    return field(default=default, metadata={"words": words, "later": later})


@explains_keywords
@dataclass(frozen=True)
class SolveOptions:
    """The options of the solver, checked and frozen.

    Parameters
    ----------
    nodes : int
        Number of nodes of the arc, 5 to 20,000. The arc spans all places that ever touch, and a little more.
    method : {"path", "increment"}
        "path" is exact in load. "increment" is the paper's method: implicit increments, first order in their size.
    increments : int, optional
        Increments in each step, only with ``method="increment"``; the default is 80. They have equal sizes. In a step
        that starts without contact, they grow linearly.
    arc : (float, float), optional
        Start and end angle of the arc, rad (the bottom is -pi/2). By default a coarse run chooses the arc. A length
        of 2 pi means the whole circle.
    between : int or sequence of float
        States inside each step: the number of equally spaced states, or one or more increasing fractions of the step.
    keep : str
        States that are kept: "all", "corners", "cycles" (where a cycle of the history ends) or "every N" (corners).
        The last state is always kept.
    shortcut : bool
        Whether to copy states from the period before, once the contact has become periodic. The copies equal newly
        solved states to the last bit.
    error_bars : bool
        Whether to follow the history also on a grid with half the intervals. Every state then has ``error_bars``.
    slip_sums : bool
        Whether to sum up the slip distance and the friction energy of each node, and to note its extremes of slip.
        Every state then has ``slip_distance``, ``friction_energy``, ``slip_lowest`` and ``slip_highest``.

    Raises
    ------
    InputError
        If an option can't be used, or has no effect with the chosen method. The error names the option.
    """

    nodes: int = option(401, "number of nodes on the arc or circle")
    method: Method = option("path", "path: exact in load; increment: implicit load increments")
    increments: int | None = option(None, "increments of each step")
    arc: tuple[float, float] | None = option(None, "ends of the arc of nodes, rad")
    between: int | Sequence[float] = option(0, "states inside each step: their number, or fractions of the step")
    keep: str | KeepRule = option("all", "states that are kept")
    shortcut: bool = option(True, "states of a periodic contact are copied from the period before, with the same bits")
    error_bars: bool = option(False, "the history is also followed on a grid with half the intervals", later=True)
    slip_sums: bool = option(False, "slip distance and friction energy of each node are counted", later=True)

    def __post_init__(self) -> None:
        check_fields(self, whole_number, "nodes", LEAST_NODES, MAX_NODES)
        check_fields(self, choice, "method", METHODS)
        if self.method == "increment":
            set_fields(self, increments=80 if self.increments is None else self.increments)
            check_fields(self, whole_number, "increments", 1)
        elif self.increments is not None:
            words = 'has no effect with method "path"; leave it out, or choose "increment"'
            raise InputError("increments", words)
        check_fields(self, _checked_arc, "arc", optional=True)
        check_fields(self, _checked_between, "between")
        set_fields(self, keep=str(KeepRule.read(self.keep)))
        check_fields(self, true_or_false, "shortcut error_bars slip_sums")

    def changed(self, **changes: Any) -> SolveOptions:
        """A copy with some options changed. Method "path" drops ``increments``, unless `changes` give them too."""
        if choice("method", changes.get("method", self.method), METHODS) == "path":
            changes.setdefault("increments", None)
        return replace(self, **changes)

    def keywords(self) -> dict[str, Any]:
        """The options as keyword arguments of :func:`fastpin.solve`."""
        return {name: getattr(self, name) for name in OPTIONS}

    @property
    def written(self) -> dict[str, Any]:
        """The options that ids and files hold: all but later ones with their defaults."""
        later = {each.name: each.default for each in fields(self) if each.metadata["later"]}
        return {name: value for name, value in self.keywords().items() if name not in later or value != later[name]}

    @property
    def is_full_turn(self) -> bool:
        """Whether the arc is the whole circle."""
        # An angle may be written with six digits.
        return self.arc is not None and self.arc[1] - self.arc[0] >= 2.0 * math.pi - 1e-5

    @property
    def keep_rule(self) -> KeepRule:
        """The option ``keep`` as a rule."""
        return KeepRule.read(self.keep)

    @property
    def fractions(self) -> np.ndarray:
        """Fractions of a step at which there are states, shape (states,). The last is 1, the corner."""
        if isinstance(self.between, int):
            return np.arange(1, self.between + 2) / (self.between + 1)
        return np.r_[np.array(self.between, dtype=float), 1.0]


OPTIONS: Mapping[str, Mapping[str, Any]] = {each.name: each.metadata for each in fields(SolveOptions)}
"""The options by name, with the entries "words" and "later" of :func:`option`."""


class OptionValues(TypedDict, total=False):
    """Keywords that make a :class:`SolveOptions`, for type checkers."""

    nodes: int
    method: Method
    increments: int | None
    arc: tuple[float, float] | None
    between: int | Sequence[float]
    keep: str | KeepRule
    shortcut: bool
    error_bars: bool
    slip_sums: bool


def _checked_arc(field: str, value: object) -> tuple[float, float]:
    if not isinstance(value, (list, tuple, np.ndarray)) or getattr(value, "ndim", 1) != 1 or len(value) != 2:
        raise InputError(field, f"must be a list of two angles in rad, [start, stop], not {as_toml(value)}")
    start, stop = (number(field, angle) for angle in value)
    # A full turn with room for rounding. Angles in degrees by mistake exceed it.
    if not 0.0 < stop - start < 2.01 * math.pi:
        allowed = "must run from a smaller to a larger angle, at most a full turn, in rad"
        raise InputError(field, f"{allowed}, not {start:g} to {stop:g}")
    return start, stop


def _checked_between(field: str, value: object) -> int | tuple[float, ...]:
    if is_whole(value):
        return whole_number(field, value, 0, MOST_BETWEEN)
    least_apart = 1e-9  # of a step: load points that are closer are one
    allowed = f"a whole number, or increasing fractions between 0 and 1, at least {least_apart:g} apart"
    wrong = InputError(field, f"must be {allowed}, not {as_toml(value)}")
    items = [value] if isinstance(value, (float, np.floating)) else value
    if not isinstance(items, (list, tuple, np.ndarray)) or getattr(items, "ndim", 1) != 1 or len(items) > MOST_BETWEEN:
        raise wrong
    fractions: list[float] = []
    for item in items:
        least = (fractions or [0.0])[-1] + least_apart
        if not isinstance(item, (float, np.floating)) or not least <= item <= 1.0 - least_apart:
            raise wrong
        fractions.append(float(item))
    return tuple(fractions)

"""Options of the solver: one set of names, defaults, limits and checks.

:func:`fastpin.solve`, :func:`fastpin.record`, case files, plans and the command line all make a :class:`SolveOptions`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, TypedDict

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, choice, number, true_or_false, whole_number
from fastpin.model.grid import LEAST_NODES, MAX_NODES

Method = Literal["path", "increment"]
METHODS = ("path", "increment")

DEFAULT_INCREMENTS = 80
"""Increments a step of the increment solver."""

MOST_BETWEEN = 10_000
"""States inside a step, at most."""

MOST_TURN = 2.01 * math.pi
"""Length of an arc, at most. Angles in degrees would make many turns."""

KEEP_WORDS = ("all", "corners", "cycles")


@dataclass(frozen=True)
class KeepRule:
    """The states of a history that are kept. The last one always is.

    Parameters
    ----------
    which : {"all", "corners", "cycles"}
        All states; those at corners; those at which a cycle ends.
    every : int
        Of corners, every n-th: 10 keeps the corners 10, 20, 30, ...
    """

    which: str = "all"
    every: int = 1

    def __post_init__(self) -> None:
        if self.which not in KEEP_WORDS or self.every < 1 or (self.every > 1 and self.which != "corners"):
            raise InputError("keep", f"{self.which!r} of every {self.every} corners is no choice of states")

    @classmethod
    def read(cls, text: str | KeepRule) -> KeepRule:
        """Read ``"all"``, ``"corners"``, ``"cycles"`` or ``"every N"``.

        Raises
        ------
        InputError
            If it is none of them.
        """
        if isinstance(text, KeepRule):
            return text
        if isinstance(text, str) and text in KEEP_WORDS:
            return cls(text)
        found = re.fullmatch(r"every[ =:-]?([1-9]\d{0,8})", text) if isinstance(text, str) else None
        if found is None:
            raise InputError(
                "keep", f'must be "all", "corners", "cycles" or "every N", such as "every 10", not {as_toml(text)}'
            )
        return cls("corners", int(found[1]))

    def __str__(self) -> str:
        return self.which if self.every == 1 else f"every {self.every}"

    @property
    def inside(self) -> bool:
        """Whether states inside steps are kept."""
        return self.which == "all"

    def at_corner(self, corner: int, corners: int, ends_cycle: bool) -> bool:
        """Whether the state at a corner, counted from 0, of `corners` is kept."""
        if corner + 1 == corners:
            return True
        return ends_cycle if self.which == "cycles" else (corner + 1) % self.every == 0


@dataclass(frozen=True)
class SolveOptions:
    """Options of the solver, checked.

    Parameters
    ----------
    nodes : int
        Number of nodes of the arc, 5 to 20,000. The arc spans all places that are ever in contact and a little more.
    method : {"path", "increment"}
        "path" is exact in load. "increment" is the paper's way: implicit increments, first order in their size.
    increments : int, optional
        Increments a step, only with ``method="increment"``; 80 unless given. They are of equal size, or grow linearly
        in a step that starts without contact.
    arc : (float, float), optional
        Start and end angle of the arc, rad (the bottom is -pi/2). Chosen from a coarse run if not given. A length of
        2 pi means the whole circle.
    between : int or sequence of float
        States inside each step: their number (equally spaced), or increasing fractions of the step.
    keep : str
        States that are kept: "all", "corners", "cycles" (where a cycle of the history ends) or "every N" (corners).
        The last state is always kept.
    shortcut : bool
        Take the states of a contact that has become periodic from the period before. They are the same to the last
        bit as states that are solved again.
    error_bars : bool
        Also follow the history on a grid with half the intervals. Every state then has ``error_bars``.

    Raises
    ------
    InputError
        Naming the option that can't be used, or that has no effect with the chosen method.
    """

    nodes: int = 401
    method: Method = "path"
    increments: int | None = None
    arc: tuple[float, float] | None = None
    between: int | Sequence[float] = 0
    keep: str | KeepRule = "all"
    shortcut: bool = True
    error_bars: bool = False

    def __post_init__(self) -> None:
        checked: dict[str, Any] = {
            "nodes": whole_number("nodes", self.nodes, LEAST_NODES, MAX_NODES),
            "method": choice("method", self.method, METHODS),
            "increments": _checked_increments(self.increments, self.method),
            "arc": _checked_arc(self.arc),
            "between": _checked_between(self.between),
            "keep": str(KeepRule.read(self.keep)),
            "shortcut": true_or_false("shortcut", self.shortcut),
            "error_bars": true_or_false("error_bars", self.error_bars),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def changed(self, **changes: Any) -> SolveOptions:
        """These options with some others. Another method drops the number of increments unless it is given too."""
        if changes.get("method", self.method) == "path":
            changes.setdefault("increments", None)
        return replace(self, **changes)

    def keywords(self) -> dict[str, Any]:
        """The options as keyword arguments of :func:`fastpin.solve`."""
        return asdict(self)

    @property
    def keep_rule(self) -> KeepRule:
        """The rule that ``keep`` says."""
        return KeepRule.read(self.keep)

    @property
    def fractions(self) -> np.ndarray:
        """Fractions of a step at which there are states, shape (states,); the last one is 1, the corner."""
        if isinstance(self.between, int):
            return np.arange(1, self.between + 2) / (self.between + 1)
        return np.r_[np.array(self.between, dtype=float), 1.0]


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


def _checked_increments(value: object, method: str) -> int | None:
    if method != "increment":
        if value is not None:
            raise InputError("increments", 'has no effect with method "path"; leave it out, or choose "increment"')
        return None
    return DEFAULT_INCREMENTS if value is None else whole_number("increments", value, 1)


def _checked_arc(value: object) -> tuple[float, float] | None:
    if value is None:
        return None
    if not isinstance(value, (list, tuple, np.ndarray)) or len(value) != 2:
        raise InputError("arc", f"must be a list of two angles in rad, [start, stop], not {as_toml(value)}")
    start, stop = (number("arc", angle) for angle in value)
    if not 0.0 < stop - start < MOST_TURN:
        allowed = "must run from a smaller to a larger angle, at most a full turn, in rad"
        raise InputError("arc", f"{allowed}, not {start:g} to {stop:g}")
    return start, stop


def _checked_between(value: object) -> int | tuple[float, ...]:
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return whole_number("between", value, 0, MOST_BETWEEN)
    wrong = InputError(
        "between", f"must be a whole number, or a list of increasing fractions between 0 and 1, not {as_toml(value)}"
    )
    if not isinstance(value, (list, tuple, np.ndarray)):
        raise wrong
    last = 0.0
    for item in value:
        if isinstance(item, bool) or not isinstance(item, (int, float)) or not last < item < 1.0:
            raise wrong
        last = item
    return tuple(float(item) for item in value)

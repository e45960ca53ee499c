"""Which states of a history are kept: all, those at corners, at the ends of cycles, or at every so many corners."""

from __future__ import annotations

import re
from dataclasses import dataclass

from fastpin.errors import InputError

WORDS = ("all", "corners", "cycles")


@dataclass(frozen=True)
class Keep:
    """A choice of states. The last one of a history is always kept.

    Parameters
    ----------
    which : {"all", "corners", "cycles"}
        All states, inside steps too; those at corners; those at which a cycle ends.
    every : int
        Of corners, every so many: 10 keeps the corners 10, 20, 30, ...
    """

    which: str = "all"
    every: int = 1

    def __post_init__(self) -> None:
        if self.which not in WORDS or self.every < 1 or (self.every > 1 and self.which != "corners"):
            raise InputError("keep", f"{self.which!r} of every {self.every} corners is no choice of states")

    @classmethod
    def of(cls, text: str | Keep) -> Keep:
        """Read ``"all"``, ``"corners"``, ``"cycles"`` or ``"every N"``.

        Raises
        ------
        InputError
            If it is none of them.
        """
        if isinstance(text, Keep):
            return text
        if text in WORDS:
            return cls(text)
        found = re.fullmatch(r"every[ =:-]?([1-9]\d{0,8})", text) if isinstance(text, str) else None
        if found is None:
            raise InputError(
                "keep", f'must be "all", "corners", "cycles" or "every N", such as "every 10", not {text!r}'
            )
        return cls("corners", int(found[1]))

    def __str__(self) -> str:
        return self.which if self.every == 1 else f"every {self.every}"

    @property
    def inside(self) -> bool:
        """Whether states inside steps are kept."""
        return self.which == "all"

    def corner(self, corner: int, corners: int, ends_cycle: bool) -> bool:
        """Whether the state at a corner, counted from 0, of `corners` is kept."""
        if corner + 1 == corners:
            return True
        return ends_cycle if self.which == "cycles" else (corner + 1) % self.every == 0


EVERYTHING = Keep()

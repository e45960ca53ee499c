"""Lists of numbers and ranges in a text: "3", "1,5,9", "1-9", "10-" and "-9"."""

from __future__ import annotations

import math
import re
from typing import NamedTuple


class Range(NamedTuple):
    """All numbers from one to another, both included. A single number is a range of equal ends.

    Attributes
    ----------
    first, last : float
        -inf and inf are open ends.
    """

    first: float
    last: float

    @property
    def is_single(self) -> bool:
        """Whether it is a single number."""
        return self.first == self.last

    def __str__(self) -> str:
        ends = [f"{end:g}" if math.isfinite(end) else "" for end in self]
        return ends[0] if self.is_single else "-".join(ends)


def ranges_in(text: str) -> list[Range]:
    """Return the numbers and ranges of a text, in their order.

    Raises
    ------
    ValueError
        If a part is neither a number nor a range, is not finite, or a range ends before it begins.
    """
    number = r"(\d+(?:\.\d*)?|\.\d+)?"
    found = []
    for part in map(str.strip, text.split(",")):
        match = re.fullmatch(rf"{number}\s*-\s*{number}", part)
        if match and (match[1] or match[2]):
            ends = Range(float(match[1] or -math.inf), float(match[2] or math.inf))
        else:
            ends = Range(float(part), float(part))
            if not math.isfinite(ends.first):
                raise ValueError(f"{part} is not finite")
        if ends.last < ends.first:
            raise ValueError(f"{part} goes downwards")
        found.append(ends)
    return found

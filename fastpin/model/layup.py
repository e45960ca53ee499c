"""Layups: the angles of the plies of a laminate as a text, such as "[0/45/-45/90]2s".

The notation is that of composite design. Spaces count nowhere::

    layup  = "[" items "]" suffix
    suffix = ["_"] [count] ["s" | "t"]
    items  = item { "/" item }
    item   = angle [ "_" count ]  |  "(" items ")" [ ["_"] count ]
    angle  = number  |  "+-" number  |  "-+" number

* An angle is in degrees, from -360 to 360, counter-clockwise from axis 1 of the laminate. The first ply is the lowest.
* "+-45", "±45" and "+/-45" are two plies, 45 and -45. "-+45", "∓45" and "-/+45" are -45 and 45.
* A count repeats: "0_2" is "0/0", "+-45_2" is "45/-45/45/-45", and "(0/90)2" is "0/90/0/90". After the bracket it
  repeats the whole stack.
* "s" adds the mirror image: "[0/90]s" is "[0/90/90/0]", and "[0/90]2s" is "[0/90/0/90]s". "t" adds nothing: the text
  is the total stack, as it is without a letter. Both letters may be capitals.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby
from typing import NoReturn

from fastpin.errors import InputError, printable
from fastpin.model.checks import items, number

MOST_PLIES = 1_000
"""Most plies of a laminate. A thousand of the usual plies are 125 mm thick."""

LONGEST = 10_000
"""Most characters of a layup: more than the longest text of :data:`MOST_PLIES` angles needs."""

MOST_ANGLE = 360.0
"""Largest angle of a ply, deg: the limit of all angles in degrees."""

_ANGLE = re.compile(r"(?P<sign>\+/?-|-/?\+|±|∓|[+-]|)(?P<size>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)", re.ASCII)
_COUNT = re.compile(r"_?(\d+)", re.ASCII)
_SUFFIX = re.compile(r"(?P<count>_?\d+)?_?(?P<letter>[sStT])?$", re.ASCII)

_SIGNS = {"": (1.0,), "+": (1.0,), "-": (-1.0,), "±": (1.0, -1.0), "∓": (-1.0, 1.0)}
"""The signs of the plies of an angle, by the first sign of the text. Two signs are "±" or "∓"."""


def parsed_layup(field: str, text: str) -> tuple[float, ...]:
    """Return the angles of a layup, deg, from the lowest ply to the uppermost.

    Parameters
    ----------
    field : str
        Name of the field in messages.
    text : str
        The layup, see :mod:`fastpin.model.layup`.

    Raises
    ------
    InputError
        If the text is no layup, or has more than :data:`MOST_PLIES` plies. The message shows the place of the fault.
    """
    if len(text) > LONGEST:
        raise InputError(field, f"must have at most {LONGEST:,} characters, not {len(text):,}")
    return tuple(_LayupReader(field, text).stack())


class _LayupReader:
    """Reads a layup from left to right. `at` is the place of the next character that is no space."""

    def __init__(self, field: str, text: str) -> None:
        self._field, self._given = field, text
        kept = [(place, letter) for place, letter in enumerate(text) if not letter.isspace()]
        self._text, self._places = "".join(letter for _, letter in kept), [place for place, _ in kept]
        self._at = 0

    def stack(self) -> list[float]:
        """The angles of the whole text."""
        if not self._takes("["):
            self._refuse('must begin with "["')
        found = self._items(0)
        if not self._takes("]"):
            self._refuse('must go on with "/" or "]"')
        suffix = _SUFFIX.match(self._text, self._at)
        if suffix is None:
            self._refuse('must end with a count, "s" or "t"')
        found = self._repeated(found, suffix["count"])
        if (suffix["letter"] or "").lower() == "s":
            found = self._repeated(found, "2")
            half = len(found) // 2
            found[half:] = reversed(found[:half])
        return found

    def _items(self, depth: int) -> list[float]:
        found = self._item(depth)
        while self._takes("/"):
            found += self._item(depth)
            self._check_length(len(found))
        return found

    def _item(self, depth: int) -> list[float]:
        if self._takes("("):
            if depth == 20:  # a reader loses count long before
                self._refuse("must have at most 20 parentheses in one another", -1)
            found = self._items(depth + 1)
            if not self._takes(")"):
                self._refuse('must go on with "/" or ")"')
        else:
            found = self._angle()
            if not self._text.startswith("_", self._at):
                return found
        count = _COUNT.match(self._text, self._at)
        if count is None:
            if self._text.startswith("_", self._at):
                self._at += 1
                self._refuse("must be a count")
            return found
        found = self._repeated(found, count[0])
        self._at = count.end()
        return found

    def _angle(self) -> list[float]:
        match = _ANGLE.match(self._text, self._at)
        if match is None:
            self._refuse("must be an angle")
        size, sign = float(match["size"]), match["sign"]
        if size > MOST_ANGLE:
            self._refuse(f"must be an angle of at most {MOST_ANGLE:g} degrees")
        self._at = match.end()
        signs = _SIGNS[sign if len(sign) < 2 else "±" if sign[0] == "+" else "∓"]
        return [each * size + 0.0 for each in signs]  # -0 becomes 0

    def _repeated(self, found: list[float], count: str | None) -> list[float]:
        """The plies, `count` times: digits, perhaps behind an underscore."""
        times = 1 if count is None else int(count.lstrip("_")[:9])  # more digits are too many plies, too
        if times == 0:
            self._refuse("must be a count of at least 1")
        self._check_length(times * len(found))
        return found * times

    def _check_length(self, length: int) -> None:
        if length > MOST_PLIES:
            raise InputError(self._field, f"must have at most {MOST_PLIES:,} plies")

    def _takes(self, letter: str) -> bool:
        """Whether the next character is this one. It is then read."""
        found = self._text.startswith(letter, self._at)
        self._at += found
        return found

    def _refuse(self, words: str, by: int = 0) -> NoReturn:
        at = self._at + by
        place = self._places[at] if at < len(self._places) else len(self._given)
        first, last = max(place - 30, 0), min(place + 30, len(self._given))
        shown = f"{'...' * (first > 0)}{printable(self._given[first:last])}{'...' * (last < len(self._given))}"
        raise InputError(self._field, f'{words} at position {place + 1} of "{shown}"')


def checked_angles(field: str, layup: object) -> tuple[float, ...]:
    """Check a layup, a text or a sequence of the angles of all plies, and return the angles, deg.

    Raises
    ------
    InputError
        If it is none, or has no ply or more than :data:`MOST_PLIES`.
    """
    if isinstance(layup, str):
        return parsed_layup(field, layup)
    words = 'a layup such as "[0/90]s", or a sequence of angles in degrees'
    angles: list[object] = items(field, layup, words)  # type: ignore[arg-type]
    if not 1 <= len(angles) <= MOST_PLIES:
        raise InputError(field, f"must have 1 to {MOST_PLIES:,} plies, not {len(angles):,}")
    return tuple(number(field, angle, -MOST_ANGLE, MOST_ANGLE) + 0.0 for angle in angles)


def layup_text(angles: Sequence[float]) -> str:
    """The shortest usual text of a layup. :func:`parsed_layup` reads the same angles back.

    A symmetric stack of an even number of plies gets an "s", a repeated part its count, and equal neighbours too.
    """
    stack = [*angles]
    half = len(stack) // 2
    is_folded = len(stack) % 2 == 0 and len(set(stack)) > 1 and stack == stack[::-1]
    part = stack[:half] if is_folded else stack
    size = next(size for size in range(1, len(part) + 1) if part == part[:size] * (len(part) // size))
    count = len(part) // size
    words = []
    for angle, run in groupby(part[:size]):
        equal = len([*run])
        words.append((f"{angle:.0f}" if angle == round(angle) else repr(angle)) + (f"_{equal}" if equal > 1 else ""))
    return f"[{'/'.join(words)}]{count if count > 1 else ''}{'s' if is_folded else ''}"

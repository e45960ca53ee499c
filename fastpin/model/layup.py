"""Layups: the angles of the plies of a laminate as a text, such as "[0/45/-45/90]2s", and stacks of plies.

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

import math
import re
from collections.abc import Sequence
from itertools import groupby
from typing import NoReturn

import numpy as np

from fastpin.errors import InputError, printable
from fastpin.model.checks import as_toml, instance, items, number
from fastpin.model.ply import Ply

MOST_PLIES = 1_000
"""Most plies of a laminate. A thousand of the usual plies are 125 mm thick."""

MOST_ANGLE = 360.0
"""Largest angle of a ply, deg: the limit of all angles in degrees."""

_ANGLE = re.compile(r"(?P<sign>\+/?-|-/?\+|±|∓|[+-]|)(?P<size>\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+)", re.ASCII)
_COUNT = re.compile(r"_?(\d+)", re.ASCII)
_SUFFIX = re.compile(r"(?P<count>_?\d+)?_?(?P<letter>[sStT])?$", re.ASCII)


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
    most = 10_000  # more than the longest text of MOST_PLIES angles needs
    if len(text) > most:
        raise InputError(field, f"must have at most {most:,} characters, not {len(text):,}")
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
        kind = sign if len(sign) < 2 else "±" if sign[0] == "+" else "∓"
        signs = {"": (1.0,), "+": (1.0,), "-": (-1.0,), "±": (1.0, -1.0), "∓": (-1.0, 1.0)}[kind]
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


# -- lamination theory: all plies have the strains of the whole -------------------------------------------------


Stack = tuple[tuple[Ply, float], ...]
"""Plies and their angles, deg, from the lowest to the uppermost."""


def checked_stack(field: str, plies: object) -> Stack:
    """Check pairs of a ply and its angle in degrees, and return them.

    Raises
    ------
    InputError
        If they are no such pairs, too many, or none.
    """
    words = "pairs of a Ply and its angle in degrees"
    pairs: list[object] = items(field, plies, words)  # type: ignore[arg-type]
    if not 1 <= len(pairs) <= MOST_PLIES:
        raise InputError(field, f"must be 1 to {MOST_PLIES:,} plies, not {len(pairs):,}")
    found = []
    for pair in pairs:
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise InputError(field, f"must be {words}, not {as_toml(pair)}")
        ply = instance(field, pair[0], Ply, words)
        found.append((ply, number(field, pair[1], -MOST_ANGLE, MOST_ANGLE) + 0.0))
    return tuple(found)


def stress_turn(angle: np.ndarray | float) -> np.ndarray:
    """The matrix T of stresses in axes turned counter-clockwise by `angle` (...), rad: shape (..., 3, 3).

    It makes (s_1, s_2, t_12) of (s_x, s_y, s_xy). The engineering strains are turned by the transpose of T(-angle).
    """
    return _turn(np.cos(angle), np.sin(angle))


def _turn(cos: np.ndarray | float, sin: np.ndarray | float) -> np.ndarray:
    c2, s2, cs = cos * cos, sin * sin, cos * sin
    rows = np.array([[c2, s2, 2.0 * cs], [s2, c2, -2.0 * cs], [-cs, cs, c2 - s2]])
    return np.moveaxis(rows, (0, 1), (-2, -1))


def _ply_turns(angles: Sequence[float]) -> np.ndarray:
    """T of the angles of plies, deg, shape (plies, 3, 3): exact for whole quarters of a turn."""
    degrees = np.asarray(angles, dtype=float)
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    is_quarter = np.remainder(degrees, 90.0) == 0.0
    return _turn(np.where(is_quarter, np.round(cos), cos), np.where(is_quarter, np.round(sin), sin))


def whole_compliance(stack: Stack) -> tuple[float, ...]:
    """The compliances a11, a12, a22, a16, a26 and a66 of a stack in its own axes, 1/Pa.

    They relate the mean strain to the mean stress: the inverse of sum(Q t) / sum(t) with the stiffnesses Q of plies.

    Raises
    ------
    InputError
        If stretching and bending are coupled: the stack is not symmetric about its middle.
    """
    angles = [angle for _, angle in stack]
    thickness = np.array([ply.thickness for ply, _ in stack])
    turns = _ply_turns([-angle for angle in angles])
    known = {ply: ply.stiffness for ply in dict.fromkeys(ply for ply, _ in stack)}
    own = np.array([known[ply] for ply, _ in stack])
    stiffness = turns @ own @ np.swapaxes(turns, -1, -2)
    whole = float(thickness.sum())
    part = thickness / whole
    middle = np.cumsum(part) - 0.5 * part - 0.5
    mean = np.tensordot(part, stiffness, 1)
    size = np.sqrt(np.outer(np.diag(mean), np.diag(mean)))
    if np.max(np.abs(np.tensordot(part * middle, stiffness, 1)) / size) > 1e-9:  # less is rounding
        words = "a stack that is not symmetric bends when it is stretched, and fastpin knows no bending"
        raise InputError("plies", f"must be symmetric about the middle: {words}")
    scale = 1.0 / np.sqrt(np.diag(mean))
    inverse = np.outer(scale, scale) * np.linalg.inv(mean * np.outer(scale, scale))
    compliance = 0.5 * (inverse + inverse.T)
    for row in (0, 1):
        if abs(compliance[row, 2]) <= 1e-13 * math.sqrt(compliance[row, row] * compliance[2, 2]):
            compliance[row, 2] = 0.0  # it is rounding
    return tuple(float(compliance[place]) for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)))


def ply_strains(stack: Stack, strain: np.ndarray) -> np.ndarray:
    """The strains of plies in their own axes, from the strains of the whole in the axes of the stack.

    Parameters
    ----------
    stack : Stack
        The plies and their angles.
    strain : array, shape (..., 3)
        (e_1, e_2, g_12) of the whole. The shear strain is the engineering one.

    Returns
    -------
    array, shape (plies, ..., 3)
        (e_1, e_2, g_12) along and across the fibres of each ply.
    """
    back = _ply_turns([-angle for _, angle in stack])
    return np.array([np.asarray(strain, dtype=float) @ turn for turn in back])


def ply_stresses(stack: Stack, strain: np.ndarray) -> np.ndarray:
    """The stresses of plies in their own axes, Pa, see :func:`ply_strains`: shape (plies, ..., 3)."""
    strains = ply_strains(stack, strain)
    return np.array([each @ ply.stiffness for each, (ply, _) in zip(strains, stack, strict=True)])

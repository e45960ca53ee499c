"""The lines of the headers and keys of a TOML text, which the parser of the standard library does not tell."""

from __future__ import annotations

import contextlib
import gc
import re
from collections.abc import Iterator
from functools import cached_property

KeyPath = tuple[str | int, ...]
"""The keys and indices that lead to a value: ("load", 0, "P")."""

_KEY = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY_LINE = re.compile(rf"\s*({_KEY}(?:\s*\.\s*{_KEY})*)\s*=(.*)")
HEADER = re.compile(rf"\s*(\[\[?)\s*({_KEY}(?:\s*\.\s*{_KEY})*)\s*\]")
STRING_OR_COMMENT = re.compile(
    r'''
    """ (?:\\.|.)*? (?:"""|\Z)
    | \'\'\' .*? (?:\'\'\'|\Z)
    | " (?:\\[^\n]|[^"\\\n])* "?
    | ' [^'\n]* '?
    | \# [^\n]*
    ''',
    re.DOTALL | re.VERBOSE,
)


@contextlib.contextmanager
def uncollected() -> Iterator[None]:
    """Let Python look for no unreachable objects: a parser makes many tables and no such objects.

    The search takes two fifths of the time of a text of 2 MB.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


class Lines:
    """The lines of a text. Places in them are looked up for a fault only."""

    def __init__(self, lines: list[str]) -> None:
        self._all = lines

    @cached_property
    def located(self) -> tuple[dict[KeyPath, int], dict[int, KeyPath], dict[int, int]]:
        """The lines of all headers and keys, see :func:`_locate`."""
        with uncollected():
            return _locate(self._all)


def _locate(lines: list[str]) -> tuple[dict[KeyPath, int], dict[int, KeyPath], dict[int, int]]:
    """The lines of all headers and keys.

    Returns
    -------
    places : dict
        Line of every header and key. Of several the first line counts.
    keys : dict
        Place of the key that begins on a line.
    starts : dict
        For every line after the first of a value of several lines: the line on which the value begins.
    """
    places: dict[KeyPath, int] = {}
    keys: dict[int, KeyPath] = {}
    starts: dict[int, int] = {}
    counts: dict[str, int] = {}
    section: KeyPath = ()
    begin, depth = 0, 0
    for line_number, (line, change) in enumerate(zip(lines, _nesting(lines), strict=True), start=1):
        header = HEADER.match(line)
        key = None if header else KEY_LINE.match(line)
        if depth > 0:
            starts[line_number] = begin
            depth = max(depth + change, 0)
        elif header:
            section = _parts(header[2])
            if header[1] == "[[":
                counts[header[2]] = counts.get(header[2], -1) + 1
                places.setdefault(section, line_number)
                section = (*section, counts[header[2]])
            places.setdefault(section, line_number)
        elif key:
            begin, depth = line_number, max(change, 0)
            keys[line_number] = (*section, *_parts(key[1]))
            places.setdefault(keys[line_number], line_number)
    return places, keys, starts


def _parts(dotted: str) -> KeyPath:
    if '"' not in dotted and "'" not in dotted:
        return tuple(map(str.strip, dotted.split(".")))
    return tuple(part[0].strip("\"'") for part in re.finditer(_KEY, dotted))


def _nesting(lines: list[str]) -> list[int]:
    """Number of opening minus closing brackets of each line, without the brackets in strings and comments."""
    # A string becomes a pair of brackets around its line ends, so that it counts as nested. A comment becomes "[]".
    bare = STRING_OR_COMMENT.sub(lambda found: "[" + "\n" * found[0].count("\n") + "]", "\n".join(lines))
    return [len(re.findall(r"[\[{]", line)) - len(re.findall(r"[\]}]", line)) for line in bare.split("\n")]

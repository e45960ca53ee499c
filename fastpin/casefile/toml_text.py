"""TOML text with line numbers. All faults of a text are reported at once, each with its line.

The parser of the standard library stops at the first fault and does not give the lines of values. This module finds the
lines of all keys itself, and parses again without a faulty line.
"""

from __future__ import annotations

import contextlib
import gc
import re
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import cache, partial
from pathlib import Path
from typing import Any, TypeVar

from fastpin.casefile.toml_faults import HEADER, KEY, KEY_LINE, STRING_OR_COMMENT, syntax_message
from fastpin.errors import CaseFileError, InputError, printable
from fastpin.model.checks import as_toml, choice, instance, number, unknown_key, why_unreadable
from fastpin.model.inputs import HDF5_SIGNATURE, open_input
from fastpin.model.synonyms import closest, meant
from fastpin.model.unit_systems import SI, checked_system, is_system
from fastpin.model.units import from_units

MOST_BYTES = 4_000_000
"""Most bytes of a case file, a lug file, or a file of materials or outcomes. Python parses some 1 MB in a second.

The worst text of this size takes some ten seconds and 0.9 GB. Long histories stand in CSV files.
"""

MOST_BYTES_OF_PLAN = 8_000_000
"""Most bytes of a plan. 100,000 [[list]] blocks of two fields have 6 MB."""

MOST_PARSED = 12_000_000
"""Characters that are parsed in all, where the text is parsed again without faulty lines. Some ten seconds at worst."""

LONGEST_FAULT = 500
"""Most characters of a fault of a file. Sentences without words of the file are shorter."""

FAULT_END = 150
"""Characters of the end of a longer fault that are kept."""

MOST_FAULTS = 100
"""Most faults that are listed. Reading ends there: each fault costs a search for what was meant."""

MOST_PARTS = 8
"""Most parts of a dotted key. The parser takes a time that grows with the square of their number. Four are in use."""

KINDS = {
    "case file": (("contact",), "run"),
    "plan": (("grid", "list"), "sweep"),
    "tolerance plan": (("tolerances",), "tolerances"),
    "lug file": (("outline",), "compliance"),
    "joint file": (("joint",), "joint"),
}
"""The sections that only one kind of file has, and the command for such a file."""

KeyPath = tuple[str | int, ...]
"""The keys and indices that lead to a value: ("load", 0, "P")."""

T = TypeVar("T")

_FAULTY = object()  # stands for a value that can't be parsed: it is reported already, and not missing


def read_text(path: Path, most: int = MOST_BYTES) -> str:
    """Read the text of a file of at most `most` bytes (UTF-8).

    Raises
    ------
    CaseFileError
        If the file can't be read, is larger, or is not UTF-8 text.
    """
    try:
        with open_input(path) as file:
            raw = file.read(most + 1)
    except (OSError, ValueError) as error:
        raise CaseFileError(str(path), [(0, why_unreadable(error))]) from None
    if raw.startswith(HDF5_SIGNATURE):
        raise CaseFileError(str(path), [(0, "is a stored result (HDF5), not text; fastpin show prints it")])
    if len(raw) > most:
        raise CaseFileError(str(path), [(0, f"is larger than {most:,} bytes")])
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise CaseFileError(str(path), [(line, why_unreadable(error))]) from None


def parse_text(text: str, name: str, kind: str, read: Callable[[CaseText], T | None]) -> T:
    """Parse a TOML text of a `kind`, and return what ``read(source)`` makes of it.

    `read` reports all faults to the source. It may return None if there are any. A text of another kind in
    :data:`KINDS` is not read.

    Raises
    ------
    CaseFileError
        If there are faults. It lists all of them with their lines. `name` is the name of the file.
    InputError
        If an argument is of the wrong kind.
    """
    source, title = CaseText(text), instance("name", name, str, "text in quotes")
    likely = [
        name for name, (sections, _) in KINDS.items() if any(section in source.root.table for section in sections)
    ]
    if likely and kind not in likely and source.readable:
        raise CaseFileError(title, [(0, f"is a {likely[0]}, not a {kind}; see fastpin {KINDS[likely[0]][1]}")])
    found = None
    if source.readable:
        with contextlib.suppress(TooManyFaultsError):
            found = read(source)
    if source.faults:
        raise CaseFileError(title, source.faults)
    assert found is not None
    return found


class TooManyFaultsError(Exception):
    """The faults of a text fill the list, and reading ends."""


class CaseText:
    """The tables of a TOML text and all its faults so far.

    Attributes
    ----------
    faults : list of (int, str)
        Line (from 1) and sentence of each fault. Line 0 stands for the whole text.
    placed : list of (place, str)
        Place and sentence of each fault that belongs to a value.
    readable : bool
        Whether the text could be parsed. The tables then hold all values except the values on faulty lines.
    root : Section
        The keys before the first section, and all sections.
    units : str
        The system of units of the text, see :func:`fastpin.model.unit_systems.checked_system`.

    Raises
    ------
    InputError
        If `text` is no string.
    """

    def __init__(self, text: str) -> None:
        self.faults: list[tuple[int, str]] = []
        self.placed: list[tuple[KeyPath, str]] = []
        self.readable = True
        self.units, self._given = SI, dict[str, Any]()
        self._blocks: Mapping[str, Sequence[int]] = {}
        if not isinstance(text, str):
            raise InputError("text", f"must be TOML text, not {as_toml(text)}")
        lines = text.replace("\r\n", "\n").split("\n")
        most_points = max(line.count(".") for line in lines)  # a key stands on one line
        if most_points >= MOST_PARTS and _LONG_KEY.search(STRING_OR_COMMENT.sub('""', text)):
            self.readable = False
            self._located = cache(partial(_locate, []))
            self._add(0, f"a key has more than {MOST_PARTS} parts, joined by points")
            self.root = Section(self, (), {})
            return
        self._located = cache(partial(_locate, lines.copy()))  # for faults only
        self.root = Section(self, (), self._parse(lines))

    def _parse(self, lines: list[str]) -> dict[str, Any]:
        """Parse the lines. Blank a faulty ``key = value`` line and parse again, to report the other faults as well."""
        faulty: list[KeyPath] = []
        size = sum(map(len, lines)) + len(lines)
        while True:
            try:
                with _uncollected():
                    tables = tomllib.loads("\n".join(lines))
                break
            except RecursionError:
                self._add(0, "values are nested too deeply")
                self.readable = False
                return {}
            except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
                message, line = syntax_message(str(error), lines)
                _, keys, starts = self._located()
                start = starts.get(line, line)
                if line != start:
                    message = f"the value that begins here is not closed, or wrong in line {line}"
                self._add(start, message)
                alone = start == line and starts.get(line + 1) != line  # the value ends on its line
                spent = (len(faulty) + 2) * size > MOST_PARSED or len(self.faults) >= MOST_FAULTS
                if spent or start not in keys or not alone or not lines[start - 1]:
                    self.readable = False
                    return {}
                faulty.append(keys[start])
                lines[start - 1] = ""
        for place in faulty:
            _mark_faulty(tables, place)
        return tables

    def report(self, message: str, *place: str | int) -> None:
        """Add a fault, on the line that :meth:`line` gives for `place`."""
        self.placed.append((place, message))
        self._add(self.line(*place), message + self._in_other_units(place, message))
        if len(self.faults) >= MOST_FAULTS:
            self._add(0, f"has {MOST_FAULTS} faults or more; reading ended there")
            raise TooManyFaultsError

    def report_unknown(self, name: str, hint: str, where: str = " before the first section") -> None:
        """Report a section, or a key `where` no section is, that is not known. The message ends with `hint`."""
        section = written(name, self.root.table[name])
        self.report(f"unknown section {section}{hint}" if section else unknown_key(name, (), where, hint), name)

    def check_sections(self, keys: Mapping[str, Collection[str]], blocks: Collection[str]) -> None:
        """Report unknown sections and keys of a file with a title and units.

        Parameters
        ----------
        keys : mapping of str
            The keys of each section; empty if they are checked later.
        blocks : collection of str
            Sections that may appear several times.
        """
        shown = {name: f"[[{name}]]" if name in blocks else f"[{name}]" for name in keys}
        for name, value in self.root.table.items():
            are_tables = name in blocks and isinstance(value, list) and all(isinstance(each, dict) for each in value)
            if name in ("title", "units"):
                continue
            if name not in keys:
                self.report_unknown(
                    name, closest(name, tuple(keys)) or f"; the sections are {', '.join(shown.values())}"
                )
            elif not isinstance(value, dict) and not are_tables:
                given = written(name, value) or as_toml(value)
                self.report(f"{name}: must be a section {shown[name]}, not {given}", name)
            elif keys[name]:
                for block in self.blocks(name):
                    block.check_keys(keys[name], f" in {shown[name]}")

    def line(self, *place: str | int) -> int:
        """Line (from 1) of the value at `place`, or of the smallest table around it; 0 if neither is in the text."""
        if place[:1] and place[0] in self._blocks and len(place) > 1:
            place = (place[0], self._blocks[str(place[0])][int(place[1])], *place[2:])
        places = self._located()[0]
        around = (place[:length] for length in range(len(place), 0, -1))
        return next((places[part] for part in around if part in places), 0)

    def with_tables(self, tables: dict[str, Any], blocks: Mapping[str, Sequence[int]] | None = None) -> CaseText:
        """A copy of this text with other tables and no faults. Their faults get the lines of this text.

        `blocks` says, for [[name]] blocks that are not those of the text, by their name: the place of the block in the
        text from which each was made.
        """
        other = CaseText.__new__(CaseText)
        other.__dict__.update(self.__dict__)
        other._blocks = self._blocks if blocks is None else blocks
        other.faults, other.placed = [], []
        other.root = Section(other, (), tables)
        return other

    def _add(self, line: int, message: str) -> None:
        shown = printable(message)  # a word of the file may be as long as the file
        if len(shown) <= LONGEST_FAULT:
            message = shown
        else:  # The end may say which word is meant.
            message = f"{shown[: LONGEST_FAULT - FAULT_END - 5]} ... {shown[-FAULT_END:]}"
        if (line, message) not in self.faults:
            self.faults.append((line, message))

    def to_si(self, kinds: Mapping[str, Any], whole: bool, system: object = None) -> None:
        """Replace the numbers of the tables by numbers in SI units.

        Parameters
        ----------
        kinds : mapping
            The kind of each number, see :mod:`fastpin.model.keys`.
        whole : bool
            Whether forces are those of the whole thickness.
        system : str, optional
            The system of units of the tables; that of the key ``units`` unless given.
        """
        given = self.root.checked("units", checked_system) or SI
        self.units = system if isinstance(system, str) and is_system(system) else given
        if self.units != SI:
            self._given = self.root.table
            self.root = Section(self, (), from_units(self._given, kinds, self.units, whole))

    def _in_other_units(self, place: KeyPath, message: str) -> str:
        """The end of a message that has numbers in SI units, while the text has them in other units."""
        if self.units == SI:
            return ""
        given, used = _value_at(self._given, place), _value_at(self.root.table, place)
        numbers = [each for each in (used if isinstance(used, list) else [used]) if isinstance(each, float)]
        if used == given or not any(f"{each:g}" in message or as_toml(each) in message for each in numbers):
            return ""
        told = "" if isinstance(used, list) else f": the file has {as_toml(given)}"
        return f'; in SI units{told}, with units = "{self.units}"'

    def section(self, name: str, required: bool = False) -> Section:
        """The section [name], or an empty section if it is missing or not a table.

        A value that is not a table is reported. A missing section is reported if it is `required`.
        """
        table = self.root.value(name)
        if isinstance(table, dict):
            return Section(self, (name,), table)
        if table is not None:
            given = written(name, table) or as_toml(table)
            self.report(f"{name}: must be a section [{name}], not {given}", name)
        elif required and name not in self.root and not self.root.means(name):
            self.report(f"the section [{name}] is missing", name)
        return Section(self, (name,), {}, present=False)

    def blocks(self, name: str) -> list[Section]:
        """All tables of a name: the [[name]] blocks, or the one section [name]."""
        value = self.root.value(name)
        if isinstance(value, dict):
            return [self.section(name)]
        tables = enumerate(value) if isinstance(value, list) else ()
        return [Section(self, (name, index), table) for index, table in tables if isinstance(table, dict)]


class Section:
    """One table of a text. It checks its values and reports faults on their lines.

    Attributes
    ----------
    table : dict
        The parsed values by key.
    present : bool
        Whether the text has this section.
    """

    def __init__(self, text: CaseText, place: KeyPath, table: dict[str, Any], present: bool = True) -> None:
        self.table = table
        self.present = present
        self._text = text
        self._place = place

    @property
    def name(self) -> str:
        """Name of the section, without brackets."""
        return str(self._place[0])

    @property
    def units(self) -> str:
        """The system of units of the text. The values of the table are in SI units."""
        return self._text.units

    def __contains__(self, key: str) -> bool:
        return key in self.table

    def report(self, message: str, *key: str) -> None:
        """Add a fault of a key, or of the whole section if no key is given."""
        self._text.report(message, *self._place, *key)

    def check_keys(
        self, allowed: Collection[str], where: str, otherwise: str = "", hint: Callable[[str], str] | None = None
    ) -> None:
        """Report the keys that are not `allowed`.

        Parameters
        ----------
        allowed : collection of str
        where : str
            Words on the table in the message, such as " in [pin]".
        otherwise : str
            The end of the message if no key is meant; all keys unless given.
        hint : callable, optional
            Gives the end of the message for a key in place of these rules.
        """
        known = tuple(allowed)
        for key in self.table:
            if key not in known:
                end = hint(key) if hint else (closest(str(key), known) or otherwise) if otherwise else None
                self.report(unknown_key(key, known, where, end), str(key))

    def require(self, key: str, hint: str = "") -> None:
        """Report the key if it is missing. The message ends with `hint`.

        A key that was written with another word is not reported here: the unknown word is.
        """
        if key not in self and not self.means(key):
            self.report(f"[{self.name}]: {key} is missing{hint}")

    def means(self, *keys: str) -> bool:
        """Whether a word of this table is one of the keys, or another word for one."""
        return any(name in keys for word in self.table for name in (word, *meant(word)))

    def value(self, key: str) -> Any:
        """The parsed value of a key; None if it is missing or faulty."""
        value = self.table.get(key)
        return None if value is _FAULTY else value

    def checked(self, key: str, check: Callable[..., T], *limits: Any) -> T | None:
        """The result of ``check(key, value, *limits)``; None if the value is missing or fails (reported)."""
        value = self.value(key)
        if value is None:
            return None
        try:
            return check(key, value, *limits)
        except InputError as error:
            self.report(str(error), key)
            return None

    def made(self, make: Callable[[], T], key: str = "") -> T | None:
        """The result of ``make()``; None if it fails: reported for a `key`, or else for the field of the error."""
        try:
            return make()
        except InputError as error:
            self.report(f"{key or error.field}: {error.reason}", key or error.field)
            return None

    def number(self, key: str) -> float | None:
        """A finite number; None if it is missing or wrong (reported)."""
        return self.checked(key, number)

    def choice(self, key: str, allowed: tuple[str, ...]) -> str | None:
        """One of the words `allowed`. The first one if the key is missing; None if the word is wrong (reported)."""
        return self.checked(key, choice, allowed) if key in self else allowed[0]

    def build(
        self,
        make: Callable[..., T],
        values: Mapping[str, Any],
        harmless: Mapping[str, Any],
        elsewhere: Mapping[str, tuple[Section, str]] | None = None,
    ) -> T | None:
        """Call ``make(**values)`` and report every wrong value.

        Missing and wrong values are replaced by the `harmless` ones. None if a wrong value has no harmless replacement.
        The values of `elsewhere` stand in another section, under another key.
        """
        values = {key: harmless.get(key) if value is None else value for key, value in values.items()}
        left = dict(harmless)
        while True:
            try:
                return make(**values)
            except InputError as error:
                section, key = (elsewhere or {}).get(error.field, (self, error.field))
                section.report(f"{key}: {error.reason}", key)
                if error.field not in left:
                    return None
                values[error.field] = left.pop(error.field)


def _value_at(table: Any, place: KeyPath) -> Any:
    """The value at a place of a table; None if there is none."""
    for part in place:
        is_there = part in table if isinstance(table, dict) else isinstance(table, list) and part in range(len(table))
        table = table[part] if is_there else None
    return table


def field_defaults(record: type) -> dict[str, Any]:
    """The defaults of the fields of a dataclass by name. A field without a default is left out."""
    return {each.name: each.default for each in fields(record) if each.default is not MISSING}


def written(name: str, value: object) -> str:
    """Return a section or its blocks as they are written: "[name]" or "[[name]]". It is empty for another value."""
    if isinstance(value, dict):
        return f"[{name}]"
    is_blocks = isinstance(value, list) and value and all(isinstance(table, dict) for table in value)
    return f"[[{name}]]" if is_blocks else ""


_LONG_KEY = re.compile(rf"""(?<![\w"'-])(?:[\w"'-]++[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}""")


@contextlib.contextmanager
def _uncollected() -> Iterator[None]:
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


@_uncollected()
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
    return tuple(part[0].strip("\"'") for part in re.finditer(KEY, dotted))


def _nesting(lines: list[str]) -> list[int]:
    """Number of opening minus closing brackets of each line, without the brackets in strings and comments."""
    # A string becomes a pair of brackets around its line ends, so that it counts as nested. A comment becomes "[]".
    bare = STRING_OR_COMMENT.sub(lambda found: "[" + "\n" * found[0].count("\n") + "]", "\n".join(lines))
    return [len(re.findall(r"[\[{]", line)) - len(re.findall(r"[\]}]", line)) for line in bare.split("\n")]


def _mark_faulty(tables: dict[str, Any], place: KeyPath) -> None:
    """Put the mark of a faulty value at its place in the tables, so that its key does not count as missing."""
    table: Any = tables
    for part in place[:-1]:
        if isinstance(table, dict):
            table = table.setdefault(part, {})
        elif isinstance(table, list) and isinstance(part, int) and part < len(table):
            table = table[part]
        else:
            return
    if isinstance(table, dict):
        table[place[-1]] = _FAULTY


class NamedTable(Section):
    """A table whose faults begin with a name."""

    def __init__(self, source: CaseText, place: KeyPath, table: Mapping[str, Any], name: str) -> None:
        super().__init__(source, place, dict(table))
        self._title = name

    def report(self, message: str, *key: str) -> None:
        """Add a fault of a key, or of the whole table if no key is given."""
        super().report(f"{self._title}: {message}", *key)


class Inside(Section):
    """The table of a key of a section. The section reports its faults."""

    def __init__(self, source: CaseText, section: Section, key: str, table: dict[str, Any]) -> None:
        super().__init__(source, (section.name, key), table)
        self._section, self._key = section, key

    def report(self, message: str, *key: str) -> None:
        """Add a fault of a key, or of the whole table if no key is given."""
        self._section.report(message, self._key, *key)

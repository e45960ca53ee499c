"""One description of an output: JSON, its schema, CSV files, tables and outcomes of sweeps follow from it."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar, get_type_hints
from weakref import WeakKeyDictionary

import numpy as np

from fastpin.model.angles import from_bottom
from fastpin.model.problem import Problem
from fastpin.model.units import DEGREE, PLAIN, Unit, units
from fastpin.states.margins import Margin
from fastpin.storage.files import replacing
from fastpin.version import __version__

Schema = dict[str, Any]
"""A JSON schema of draft 2020-12."""

Follow = Callable[[float, float], None]
"""Receives the work that is done, and all the work."""

ROUNDING = 1e-9
"""Values and differences below this part of the largest of their kind are rounding. They are shown as 0."""

PERCENT = Unit(100.0, "%")
"""The unit of shares in tables."""

NUMBER: Schema = {"type": "number"}

WHOLE: Schema = {"type": "integer"}

TEXT: Schema = {"type": "string"}

TRUTH: Schema = {"type": "boolean"}

UNKNOWN: Schema = {"type": ["number", "null"]}
"""A number that may be NaN or infinite: null then."""

Function = TypeVar("Function", bound=Callable[..., Any])

MAX_ROWS = 40
"""Most lines of a printed table, below its head."""

Column = tuple[str, str, list[str]]
"""A column of a table: its name, its unit and its cells."""


class Output(NamedTuple):
    """An output of a subject, such as a crack that grows.

    Attributes
    ----------
    name : str
        Its key in JSON.
    kind : str
        A key of :func:`fastpin.model.units.units`, "angle" (a place on the hole, rad), "width" (rad), "class", "text",
        "texts", "whole", "truth", "share" (in tables in %), or "" for a plain number. Of an output with parts: "list",
        "map" or "".
    of : callable, optional
        Gives its value for a subject, in SI units: a number, an array, or a text. Unless given, it is the attribute or
        the key `name` of the subject.
    words : str
        What it is, in the schema.
    heading : str
        Its name in CSV files; unless given, `name` with spaces.
    short : str
        Its name in tables; unless given, the heading.
    classes : mapping of int to str
        The words of each value of a class.
    allowed : collection of str
        The texts that it may be; empty if it may be any.
    optional : bool
        Whether it may be unknown or infinite: null in JSON.
    parts : sequence of Output
        Outputs of the value, which is an object in JSON; of the kinds "list" and "map", of each of its values.
    form : dict
        The JSON schema of a value that is JSON-ready already, also where it is null.
    may_lack : bool
        Whether JSON lacks it where the value is None.
    digits : str
        The format of a number in tables.
    unknown : str
        Its cell in tables where a whole number is None.
    """

    name: str
    kind: str = ""
    of: Callable[[Any], Any] | None = None
    words: str = ""
    heading: str = ""
    short: str = ""
    classes: Mapping[int, str] = MappingProxyType({})
    allowed: Collection[str] = ()
    optional: bool = False
    parts: Sequence[Output] = ()
    form: Schema | None = None
    may_lack: bool = False
    digits: str = ".5g"
    unknown: str = "-"

    def value(self, subject: Any) -> Any:
        """The value of a subject in SI units."""
        if self.of is not None:
            return self.of(subject)
        return subject[self.name] if isinstance(subject, Mapping) else getattr(subject, self.name)

    def shown(self, subject: Any, unit: Mapping[str, Unit]) -> Any:
        """The value in printed units, angles in degrees, a class in words, and parts as dicts."""
        value = self.value(subject)
        if value is None or self.form is not None:
            return value
        if self.parts:
            return self._shown_parts(value, unit)
        if self.classes:
            return self.classes[value]
        if self.kind in ("angle", "width") and not math.isnan(value):
            return from_bottom(value) if self.kind == "angle" else math.degrees(value)
        return unit[self.kind].factor * value if self.kind in unit else value

    def _shown_parts(self, value: Any, unit: Mapping[str, Unit]) -> Any:
        if self.kind == "list":
            return [document(self.parts, each, unit) for each in value]
        if self.kind == "map":
            return {name: document(self.parts, each, unit) for name, each in value.items()}
        return document(self.parts, value, unit)

    def number(self, subject: Any) -> float:
        """The value as an outcome of sweeps, with angles in rad; NaN for a life without end."""
        value = float(self.value(subject))
        return math.nan if self.kind == "life" and math.isinf(value) else value

    def column(self, unit: Mapping[str, Unit]) -> str:
        """Its heading with its unit."""
        name = (DEGREE if self.kind in ("angle", "width") else unit.get(self.kind, Unit(1.0, ""))).name
        heading = self.heading or self.name.replace("_", " ")
        return f"{heading} [{name}]" if name else heading

    def cells(self, subjects: Iterable[Any], unit: Mapping[str, Unit]) -> Column:
        """A column of a table with a row for each subject."""
        values = [self.value(each) for each in subjects]
        name = self.short or self.heading or self.name.replace("_", " ")
        if self.kind == "text":
            return name, "", values
        if self.kind == "whole":
            return name, "", [self.unknown if value is None else f"{value:,}" for value in values]
        of_kind = PERCENT if self.kind == "share" else unit.get(self.kind, PLAIN)
        if self.kind == "angle":
            of_kind, values = DEGREE, [from_bottom(value) if math.isfinite(value) else value for value in values]
        return number_column(name, values, of_kind, self.digits)

    @property
    def schema(self) -> Schema:
        """The schema of its value in JSON."""
        found: Schema = {"type": {"text": "string", "whole": "integer", "truth": "boolean"}.get(self.kind, "number")}
        if self.form is not None:
            found = self.form
        elif self.parts:
            found = schema_of(self.parts)
        elif self.allowed or self.classes:
            found = {"enum": list(self.allowed or self.classes.values())}
        if self.kind == "texts":
            found = list_of(found if self.allowed else TEXT)
        elif self.kind == "list":
            found = list_of(found)
        elif self.kind == "map":
            found = {"type": "object", "additionalProperties": found}
        if self.optional:
            found = or_null(found) if self.parts else found | {"type": [found["type"], "null"]}
        return found | ({"description": self.words} if self.words else {})


def number_column(name: str, values: Sequence[float], unit: Unit, digits: str = ".5g") -> Column:
    """Return a column of a table in the unit that suits all values. What is rounding beside the largest is 0."""
    factor, label = unit.scale(values)
    least = ROUNDING * max(filter(math.isfinite, map(abs, values)), default=0.0)
    shown = [0.0 if abs(value) <= least else factor * value for value in values]
    return name, label, ["-" if math.isnan(value) else format(value, digits) for value in shown]


def document(outputs: Iterable[Output], subject: Any, unit: Mapping[str, Unit]) -> dict[str, Any]:
    """Return the outputs of a subject as a dict, in printed units. An array becomes a list."""
    values = [(each, each.shown(subject, unit)) for each in outputs]
    return {
        each.name: value.tolist() if isinstance(value, np.ndarray) else value
        for each, value in values
        if value is not None or not each.may_lack
    }


def properties(outputs: Iterable[Output]) -> dict[str, Schema]:
    """Return the schemas of outputs in JSON by name."""
    return {each.name: each.schema for each in outputs}


def schema_of(outputs: Sequence[Output]) -> Schema:
    """Return the schema of :func:`document`."""
    return object_of(properties(outputs), without=[each.name for each in outputs if each.may_lack])


def whole_document(
    outputs: Sequence[Output], subject: Any, unit: Mapping[str, Unit], **head: str | None
) -> dict[str, Any]:
    """Return what a command writes as JSON: the version, a `head` such as the title, and the outputs of a subject.

    NaN and infinity become None.
    """
    ready: dict[str, Any] = json_ready({"fastpin": __version__, **head, **document(outputs, subject, unit)})
    return ready


def whole_schema(outputs: Sequence[Output], has_title: bool = True) -> Schema:
    """Return the schema of :func:`whole_document`."""
    return schema_of([Output("fastpin", "text"), *([Output("title", "text")] if has_title else []), *outputs])


def unit_names(problem: Problem) -> dict[str, str]:
    """Return the name of the unit of every kind of quantity in the JSON of a problem."""
    angle = {"angle": "deg from the bottom of the hole, counter-clockwise"}
    return {kind: unit.name for kind, unit in units(problem).items()} | angle


def numbers(names: str, kind: str = "", optional: bool = False) -> list[Output]:
    """Return outputs that are attributes of their subject, of one kind, with these names."""
    return [Output(name, kind, optional=optional) for name in names.split()]


def of_fields(record: type, kinds: Mapping[str, str] = MappingProxyType({})) -> tuple[Output, ...]:
    """Return an output for each field of a record, of the kind of its type. A float may be unknown, and has a kind."""
    types = {int: "whole", bool: "truth", str: "text"}
    return tuple(
        Output(name, types.get(its_type, kinds.get(name, "")), heading=name, optional=its_type not in types)
        for name, its_type in get_type_hints(record).items()
    )


def chosen(outputs: Iterable[Output], names: Sequence[str]) -> dict[str, Output]:
    """Return some of the outputs by name, in the order of the names."""
    known = {each.name: each for each in outputs}
    return {name: known[name] for name in names}


def object_of(
    parts: Mapping[str, Schema], required: Iterable[str] | None = None, without: Iterable[str] = ()
) -> Schema:
    """Return the schema of an object with these keys only.

    All must be there, unless some are `required`, or it may be `without` some.
    """
    needed = [name for name in (parts if required is None else required) if name not in tuple(without)]
    return {"type": "object", "properties": dict(parts), "required": needed, "additionalProperties": False}


def map_of(item: Schema, words: str) -> Schema:
    """Return the schema of an object with any keys."""
    return {"type": "object", "description": words, "additionalProperties": item}


def list_of(item: Schema, length: int | None = None) -> Schema:
    """Return the schema of a list, perhaps of so many items."""
    return {"type": "array", "items": item} | ({} if length is None else {"minItems": length, "maxItems": length})


def or_null(item: Schema) -> Schema:
    """Return the schema of a value that may be null."""
    return {"anyOf": [item, {"type": "null"}]}


UNITS = Output("units", of=lambda found: unit_names(found.problem), form=map_of(TEXT, "unit of each kind of quantity"))
"""The units of the problem of a subject."""


class Question(NamedTuple):
    """A question that a case asks of its result. The answer is an object with a class of its own.

    Attributes
    ----------
    words : callable
        ``words(problem, how)``: the value of the section in words, in the description of a case.
    bar : str
        Text of the progress bar while it is looked for.
    failed : str
        What it means that nothing is found; the reason follows.
    margin_names : mapping of str
        Its margins of safety by name, each with the meaning of allowable and value.
    unvaried : str
        Why no plan varies its keys.
    keys : tuple of str
        Keys of its section that may stand beside an outcome.
    outcomes : mapping of str
        Outcomes of sweeps by name, pairs of an :class:`Output` and a callable ``read(result, how)``, which gives the
        subject of the output for the value of the section.
    find : callable
        ``find(case, held, progress)``: the answer; None if it is not looked for. InputError says why there is none.
    judged : callable
        ``judged(result, how)``: what margins need of a whole result in a sweep.
    lines, document : callable
        ``lines(found, over)``: lines of text, and a dict for JSON. `over` has the bodies that yield, see
        :func:`fastpin.states.margins.over_yield`.
    schema : callable
        ``schema()``: the JSON schema of the dict.
    margins : callable
        ``margins(found)``: its margins of safety.
    remarks : callable
        ``remarks(found)``: further lines below its figure on a page.
    in_sweeps : callable
        ``in_sweeps(how)``: what outcomes and margins of sweeps take of the value of the section.
    """

    words: Callable[[Problem, Any], str]
    bar: str
    failed: str
    margin_names: Mapping[str, str]
    unvaried: str
    keys: tuple[str, ...]
    outcomes: Mapping[str, tuple[Output, Callable[[Any, Any], Any]]]
    find: Callable[..., Any]
    judged: Callable[[Any, Any], Any]
    lines: Callable[[Any, Mapping[str, float]], list[str]]
    document: Callable[[Any, Mapping[str, float]], dict[str, Any]]
    schema: Callable[[], Schema]
    margins: Callable[[Any], list[Margin]]
    remarks: Callable[[Any], list[str]] = lambda found: []
    in_sweeps: Callable[[Any], Any] = lambda how: how


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure.

    Attributes
    ----------
    parameters : dict
        The values that differ between the curves of a figure: L_p, mu, the pair, the load.
    columns : dict of ndarray
        The numbers, all of one length, by a name with its unit. NaN breaks the curve.
    """

    parameters: dict[str, Any]
    columns: dict[str, np.ndarray] = field(repr=False)

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]


def write_csv(curves: Sequence[Curve], path: Path, remarks: Sequence[str] = ()) -> None:
    """Write curves as CSV, one below the other. Each line has the curve's parameters, then a row of its columns.

    NaN is an empty cell. A comma in a text becomes a semicolon, for programs that do not know quotes. `remarks` become
    lines that begin with #.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    names = list(dict.fromkeys(name for curve in curves for name in (*curve.parameters, *curve.columns)))
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {remark}\n" for remark in remarks)
        writer = csv.DictWriter(file, names, restval="", lineterminator="\n")
        writer.writeheader()
        for curve in curves:
            parameters = {name: _parameter(value) for name, value in curve.parameters.items()}
            rows = zip(*curve.columns.values(), strict=True)
            for row in rows:
                writer.writerow({**parameters, **dict(zip(curve.columns, map(_cell, row), strict=True))})


def csv_cell(value: Any) -> Any:
    """Return the value of a cell. A text that a spreadsheet would take for a formula begins with an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) else value


def _parameter(value: float | str) -> float | str:
    if isinstance(value, str):
        return csv_cell(value.replace(",", ";"))
    return "" if math.isnan(value) else value


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return csv_cell(value)
    return "" if math.isnan(value) else f"{value:.9g}"


def kept(function: Function) -> Function:
    """Let a function keep its values while its first argument lives, such as a result of which several outcomes ask.

    The other arguments are given by position, and are hashable.
    """
    known: WeakKeyDictionary[Any, dict[tuple[Any, ...], Any]] = WeakKeyDictionary()

    @wraps(function)
    def value(first: Any, *others: Any) -> Any:
        values = known.setdefault(first, {})
        if others not in values:
            values[others] = function(first, *others)
        return values[others]

    return value  # type: ignore[return-value]


def json_ready(value: Any) -> Any:
    """Return `value` JSON-ready: Python numbers for NumPy's, lists for tuples, None for NaN and infinity."""
    if isinstance(value, Mapping):
        return {str(key): json_ready(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_ready(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


class Repeat(NamedTuple):
    """A line for rows that repeat the rows before: `times` times the `period` rows that end before the row `first`."""

    first: int
    period: int
    times: int

    @property
    def end(self) -> int:
        """The row after the repeats."""
        return self.first + self.times * self.period


class LeftOut(NamedTuple):
    """A line for so many `rows` that are not printed."""

    rows: int


TableLine = int | Repeat | LeftOut
"""A line of a table: the number of a row from 0, or a line for several rows."""


def printed_rows(lines: Iterable[TableLine]) -> list[int]:
    """Return the rows that have a line of their own."""
    return [line for line in lines if isinstance(line, int)]


def cut_lines(count: int, hidden: int = 0) -> list[TableLine]:
    """Return the lines of a table of `count` rows, and of `hidden` rows that are missing in their middle.

    Of more than :data:`MAX_ROWS` rows the first and the last ones are printed.
    """
    first = last = MAX_ROWS // 2
    if count <= MAX_ROWS:
        first, last = (count // 2, count - count // 2) if hidden else (count, 0)
    left_out = hidden + count - first - last
    return [*range(first), *([LeftOut(left_out)] if left_out else []), *range(count - last, count)]


def with_rows(lines: Iterable[TableLine], rows: Collection[int]) -> list[TableLine]:
    """Return the lines of a table in which these rows are not left out. Repeated rows stay one line."""
    found: list[TableLine] = []
    at = 0
    for line in lines:
        if isinstance(line, LeftOut):
            end = at + line.rows
            for row in sorted(row for row in rows if at <= row < end):
                found += [LeftOut(row - at), row] if row > at else [row]
                at = row + 1
            found += [LeftOut(end - at)] if end > at else []
            at = end
        else:
            found.append(line)
            at = line.end if isinstance(line, Repeat) else line + 1
    return found


def table(columns: Sequence[Column], hidden: int = 0) -> str:
    """Return a table as text, with at most :data:`MAX_ROWS` lines below its head.

    Parameters
    ----------
    columns : sequence of (str, str, list of str)
        Name, unit and cells of each column.
    hidden : int
        Number of rows that `columns` lack in their middle. The table counts them among the rows it leaves out.
    """
    names = columns[0][2]
    lines = cut_lines(len(names), hidden)
    return table_of_lines(columns_at(columns, printed_rows(lines)), lines, names)


def columns_at(columns: Sequence[Column], rows: Sequence[int]) -> list[Column]:
    """Return columns with the cells of these rows only."""
    return [(name, unit, [cells[row] for row in rows]) for name, unit, cells in columns]


def table_of_lines(columns: Sequence[Column], lines: Sequence[TableLine], names: Sequence[str]) -> str:
    """Return a table as text.

    Parameters
    ----------
    columns : sequence of (str, str, list of str)
        Name and unit of each column, and its cells for each printed row.
    lines : sequence of int, Repeat or LeftOut
        The lines of the table.
    names : sequence of str
        The cells of the first column for all rows. Lines for several rows name the rows by them.
    """
    widths = [max(len(name), len(unit), *map(len, cells), 0) for name, unit, cells in columns]

    def joined(words: Sequence[str]) -> str:
        return "  ".join(word.rjust(width) for word, width in zip(words, widths, strict=True)).rstrip()

    text = [joined([name for name, _, _ in columns]), joined([unit for _, unit, _ in columns])]
    rows = zip(*(cells for _, _, cells in columns), strict=True)
    for line in lines:
        text.append(
            joined(next(rows)) if isinstance(line, int) else f"... {line_words(columns[0][0], names, line)} ..."
        )
    return "\n".join(text)


def aligned(rows: Sequence[Sequence[str]], sides: str) -> list[str]:
    """Return a line for each row of cells, indented by two, with aligned columns.

    Parameters
    ----------
    rows : sequence of sequences of str
        A row with fewer cells than columns does not count in the widths of the columns.
    sides : str
        "l" or "r" for each column: its cells stand to the left or to the right.
    """
    full = [row for row in rows if len(row) == len(sides)]
    widths = [max(map(len, column)) for column in zip(*full, strict=True)]
    pads = [(str.ljust if side == "l" else str.rjust, width) for side, width in zip(sides, widths, strict=True)]
    padded = [[pad(cell, width) for cell, (pad, width) in zip(row, pads, strict=False)] for row in rows]
    return [f"  {'  '.join(cells).rstrip()}" for cells in padded]


def line_words(heading: str, names: Sequence[str], line: Repeat | LeftOut) -> str:
    """Return the words of a line for several rows. `heading` is the name of the first column, `names` its cells."""
    return f"{line.rows:,} more" if isinstance(line, LeftOut) else _repeat_words(heading, names, line)


def _repeat_words(heading: str, names: Sequence[str], repeat: Repeat) -> str:
    last = names[repeat.end - 1]
    before = names[repeat.first - repeat.period], names[repeat.first - 1]
    plural = f"{heading}s {before[0]} to {before[1]}" if repeat.period > 1 else f"{heading} {before[1]}"
    times = "once" if repeat.times == 1 else f"{repeat.times:,} times"
    return f"{names[repeat.first]} to {last}: repeat {plural}, {times}"

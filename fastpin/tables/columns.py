"""Columns of a CSV file: the columns that the user chooses, by header or number, and those of a header of loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from fastpin.errors import InputError
from fastpin.model.checks import LONGEST_TEXT, as_toml, is_whole, number, string, unknown_key
from fastpin.model.loads import LOADS, load_index
from fastpin.model.synonyms import closest
from fastpin.tables.load_units import is_unit, is_unit_of, unit_name

COLUMN_KEYS = ("column", "scale", "unit", "zero")
"""Keys of the table of a load that is read from a column."""

COUNT = "count"
"""The column that says how many times a row of a load file is run through."""

MOST_SHOWN = 12
"""Most columns of a file that an error names."""


class ColumnChoice(NamedTuple):
    """The column of a file that holds a load or another quantity.

    Attributes
    ----------
    columns : tuple of str or int
        The header, with its unit or without, or the number of the column, counted from 1. Two of them: each line has
        two corners of the load, such as the largest and the smallest. If the header is empty, the column named as the
        load is taken, or else the only one with a unit of the load.
    scale : float
        Factor of all numbers: -1 turns the sign. Not 0.
    unit : str
        Unit of the numbers in its usual spelling; empty if the file says it.
    zero : float, optional
        The number in the file that counts as 0.
    """

    columns: tuple[str | int, ...]
    scale: float = 1.0
    unit: str = ""
    zero: float | None = None


class CsvColumn(NamedTuple):
    """A column that is read.

    Attributes
    ----------
    place : int
        Place in a line, from 0.
    name : str
        Name of the load, or of another quantity.
    title : str
        The text of the header; empty without a header.
    scale : float
    unit : str
        Unit in its usual spelling; empty for N/m, N and so on, as loads are in Python or in a case file.
    zero : float, optional
        The number in the file that counts as 0.
    """

    place: int
    name: str
    title: str
    scale: float = 1.0
    unit: str = ""
    zero: float | None = None

    @property
    def named(self) -> str:
        """The end of a sentence on this column."""
        return "" if self.title == self.name else f" (column {as_toml(self.title or self.place + 1)})"


def column_choice(name: str, given: object) -> ColumnChoice:
    """Return what the user chose for a load: the text of a header, or a table of column, scale and unit.

    Raises
    ------
    InputError
        If a key or a value is wrong. Its field is the load, or the load and the key: ``P.scale``.
    """
    if isinstance(given, str):
        given = {"column": given}
    if not isinstance(given, Mapping):
        example = f'{name} = {{ column = "Force [N]", scale = -1.0, unit = "kN" }}'
        raise InputError(name, f"must be a column of the CSV file, such as {example}, not {as_toml(given)}")
    for key in given:
        if key not in COLUMN_KEYS:
            end = f"; the keys are {', '.join(COLUMN_KEYS)}{closest(str(key)[:LONGEST_TEXT], COLUMN_KEYS)}"
            raise InputError(name, unknown_key(key, (), end=end))
    if "column" not in given:
        raise InputError(name, "column is missing: the header of a column of the CSV file, or its number")
    field, column = f"{name}.column", given["column"]
    parts = column if isinstance(column, (list, tuple)) and len(column) == 2 else [column]
    if not all(isinstance(each, str) or (is_whole(each) and each >= 1) for each in parts):
        words = "must be the text of a header, a number counted from 1, or a list of two of them"
        raise InputError(field, f"{words}, not {as_toml(column)}")
    columns = tuple(string(field, each) if isinstance(each, str) else int(each) for each in parts)
    scale = number(f"{name}.scale", given.get("scale", 1.0))
    if scale == 0.0:
        raise InputError(f"{name}.scale", "must not be 0")
    unit = unit_name(string(f"{name}.unit", given["unit"])) if "unit" in given else ""
    return ColumnChoice(columns, scale, unit, number(f"{name}.zero", given["zero"]) if "zero" in given else None)


def column_choices(field: str, given: object) -> dict[str, ColumnChoice]:
    """Return the columns of loads, by load. An :class:`InputError` names the load that is wrong, or `field`."""
    if not isinstance(given, Mapping) or not given:
        example = '{"P": {"column": "Force [N]", "scale": -1.0}}'
        raise InputError(field, f"must map loads to columns, such as {example}, not {as_toml(given)}")
    return {
        load if load == COUNT else LOADS[load_index(load, field)]: column_choice(load, value)
        for load, value in given.items()
    }


def chosen_columns(titles: Sequence[str], choices: Mapping[str, ColumnChoice]) -> list[CsvColumn]:
    """Return the chosen columns of a file with these titles. An :class:`InputError` names a missing column.

    Titles are empty where a file has none. A pair of columns stands as two columns of the same name.
    """
    parts = [title_and_unit(title) for title in titles]
    found = []
    for name, choice in choices.items():
        for column in choice.columns:
            place = _place(name, column, titles, [part for part, _ in parts])
            unit = _one_unit(name, choice.unit, parts[place][1], "the header says")
            found.append(CsvColumn(place, name, titles[place], choice.scale, unit, choice.zero))
    return found


def known_places(choices: Mapping[str, ColumnChoice]) -> tuple[int, ...] | None:
    """Return the places of the chosen columns in a line if all are chosen by number, else None."""
    columns = [column for choice in choices.values() for column in choice.columns]
    places = tuple(column - 1 for column in columns if isinstance(column, int))
    return places if len(places) == len(columns) else None


def _place(name: str, column: str | int, titles: Sequence[str], bare: Sequence[str]) -> int:
    """Return the place of a column, from its header or its number; `bare` are the titles without units."""
    if isinstance(column, int):
        if column > len(titles):
            raise InputError(name, f"the file has {len(titles)} columns, and no column {column}")
        return column - 1
    parts = [title_and_unit(title) for title in titles]
    wanted = column.strip() or column_of(name, parts, titles)
    places = [place for place, title in enumerate(titles) if title == wanted]
    places = places or [place for place, title in enumerate(bare) if title == wanted]
    if len(places) != 1:
        shown = ", ".join(as_toml(title) for title in titles[:MOST_SHOWN])
        shown += f" and {len(titles) - MOST_SHOWN} more" if len(titles) > MOST_SHOWN else ""
        fault = f"{len(places)} columns of the file are" if places else "the file has no column"
        hint = ""
        if not places and len(wanted) < LONGEST_TEXT:
            hint = closest(wanted, [title for title in (*titles[:100], *bare[:100]) if len(title) < LONGEST_TEXT])
        raise InputError(name, f"{fault} {as_toml(wanted)}; its columns are {shown}{hint}")
    return places[0]


def column_of(load: str, parts: Sequence[tuple[str, str]], titles: Sequence[str]) -> str:
    """Return the title of the column of a load: that of its name, else the only one with a unit of its kind."""
    found = [place for place, (name, _) in enumerate(parts) if name == load]
    found = found or [place for place, (_, unit) in enumerate(parts) if unit and is_unit_of(load, unit)]
    if len(found) == 1:
        return titles[found[0]]
    shown = ", ".join(as_toml(titles[place]) for place in (found or range(len(titles)))[:MOST_SHOWN])
    if found:
        raise InputError(load, f"{len(found)} columns of the file may hold it: {shown}; name one of them")
    raise InputError(load, f"no column of the file has its name or a unit of it; name one of {shown}")


def named_columns(titles: Sequence[str]) -> list[CsvColumn]:
    """Return the columns of a header that consists of loads, each with a unit or without.

    Raises
    ------
    InputError
        If a column is no load, or a load is named twice.
    """
    found = []
    for place, title in enumerate(titles):
        name, unit = title_and_unit(title)
        try:
            load = LOADS[load_index(name if unit and name in LOADS else title, f"column {place + 1}")]
        except InputError as error:
            remedy = ""
            if unit:
                remedy = f"; a [[load]] block reads it with P = {{ column = {as_toml(title)} }}"
            elif any(title in LOADS for title in titles):
                remedy = '; a [[load]] block with P = "P" reads this column and no other'
            raise InputError(error.field, f"{error.reason}{remedy}") from None
        found.append(CsvColumn(place, load, title, 1.0, unit))
    if len({column.name for column in found}) < len(found):
        raise InputError("", "a load is named twice")
    return found


def with_unit_row(columns: Sequence[CsvColumn], cells: Sequence[str]) -> list[CsvColumn]:
    """Return the columns with the units of the line below the header. An :class:`InputError` says what is wrong."""
    found = []
    for column in columns:
        written = unit_name(cells[column.place])
        unit = "" if written in ("", "-") else written
        unit = _one_unit(column.name, column.unit, unit, "the line below the header says")
        found.append(column._replace(unit=unit))
    return found


def _one_unit(name: str, given: str, written: str, where: str) -> str:
    """Return the unit that the user gives or the file says. They must not be two known units."""
    if given and is_unit(written) and given != written:
        raise InputError(name, f"the unit is {given}, and {where} {written}; give one of them, and a scale if need be")
    return given or written


def title_and_unit(title: str) -> tuple[str, str]:
    """Split a header such as "Force [N]", "Force (N)" or "Force / N" into a name and a unit in its usual spelling."""
    for begin, end in ("[]", "()"):
        name, bracket, rest = title.rpartition(begin)
        if title.endswith(end) and bracket:
            return name.strip(), unit_name(rest[:-1])
    name, slash, rest = title.partition(" / ")
    return (name.strip(), unit_name(rest)) if slash and is_unit(unit_name(rest)) else (title, "")

"""Fields of a case, ``section.key``, set in the tables of a case file.

Where a case may say one thing in several ways, a field takes the place of the others: a named material that of
moduli, Dundurs' parameters that of two materials, a file that of load blocks, and the other way round.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fastpin.casefile.loads import read_history
from fastpin.casefile.reader import case_from
from fastpin.casefile.toml_text import CaseText
from fastpin.errors import CaseFileError
from fastpin.model.case import Case
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS

LOAD_TABLES = (("mean",), ("amplitude",), ("phase",))
"""Keys of a [[load]] block that are tables of loads."""


class BaseCase:
    """The base case, ready to be varied."""

    def __init__(self, text: str, name: str, folder: Path) -> None:
        self.name = name
        self.text = CaseText(text)
        if self.text.faults:
            raise CaseFileError(name, self.text.faults)
        self._folder = folder
        self._loads: tuple[str, LoadHistory | None] = "", None

    @property
    def load_blocks(self) -> int:
        """Number of [[load]] blocks."""
        blocks = self.text.root.value("load")
        return len(self.text.blocks("load")) if isinstance(blocks, list) else 0

    def vary(self, values: dict[str, Any]) -> tuple[CaseText, Case | None]:
        """The case with these fields; without meaning where the text has faults."""
        text = self.text.with_tables(with_values(self.text.root.table, values))
        return text, case_from(text, self._folder, self._read_loads)

    def _read_loads(self, text: CaseText, folder: Path) -> LoadHistory | None:
        """The load history; the last one is kept, because neighbours in a plan often share it."""
        given = repr([text.root.table.get(name) for name in ("load", "history")])
        if given != self._loads[0] or self._loads[1] is None:
            self._loads = given, read_history(text, folder)
        return self._loads[1]


_REPLACED: dict[str, tuple[str, ...]] = {
    "material": ("E", "nu", "rigid"),
    "E": ("material", "rigid"),
    "nu": ("material", "rigid"),
    "rigid": ("material", "E", "nu"),
}
"""What each key of [pin] and [plate] replaces in its section of the base case."""

_REPLACED_SECTIONS = {"pin": ("dundurs",), "plate": ("dundurs",), "dundurs": ("pin", "plate")}
"""What sections each section replaces in the base case."""

_FILE = "history.csv"


def with_values(tables: dict[str, Any], values: dict[str, Any]) -> dict[str, Any]:
    """The tables of a case with other values of some fields; `tables` stay as they are."""
    new = {name: _copied(table) for name, table in tables.items()}
    for name, value in values.items():
        _make_room(new, name, value)
    for name, value in values.items():
        section, *rest = name.split(".")
        table = new["load"][int(rest.pop(0)) - 1] if section == "load" else new.setdefault(section, {})
        if isinstance(table, dict) and len(rest) == 2:  # the amplitude of one load of a block
            inner = table.get(rest[0])
            table[rest[0]] = {**inner, rest[1]: value} if isinstance(inner, dict) else {rest[1]: value}
        elif isinstance(table, dict):
            table[rest[0]] = value
    return new


def conflict(values: dict[str, Any]) -> tuple[str, str] | None:
    """Two fields of which one replaces what the other changes; the case reader finds all others."""
    load = next((name for name in values if name.startswith("load.")), None)
    return (load, _FILE) if load and _FILE in values else None


def other_units(tables: dict[str, Any], name: str) -> str | None:
    """What is wrong with a field that would change the units of the base case's loads; nothing if it does not."""
    contact = tables.get("contact")
    given = contact if isinstance(contact, dict) else {}
    if name == "contact.load_parameter" and ("hole_radius" in given or "clearance" in given):
        return (
            f"{name}: the base case gives a hole radius and a clearance, and loads in N/m; with a load parameter they "
            "would count in units of F. Vary contact.clearance (load parameter times F beta*), or take a base case "
            "with load_parameter and loads in units of F"
        )
    if name in ("contact.hole_radius", "contact.clearance") and "load_parameter" in given:
        return (
            f"{name}: the base case gives a load_parameter, and loads in units of F; vary contact.load_parameter, or "
            "take a base case with hole_radius, clearance and loads in N/m"
        )
    return None


def _copied(table: Any) -> Any:
    """A table, or list of tables, of which keys can be set."""
    if isinstance(table, list):
        return [dict(item) if isinstance(item, dict) else item for item in table]
    return dict(table) if isinstance(table, dict) else table


def _make_room(tables: dict[str, Any], name: str, value: Any) -> None:
    """Take out of the base case what a field replaces."""
    section, key = name.split(".")[0], name.split(".")[-1]
    for other in _REPLACED_SECTIONS.get(section, ()):
        tables.pop(other, None)
    if name == _FILE:
        tables.pop("load", None)
    elif section == "load" and isinstance(tables.get("history"), dict):
        tables["history"].pop("csv", None)
    body = tables.get(section)
    if section not in ("pin", "plate") or not isinstance(body, dict) or (key == "rigid" and value is not True):
        return
    named = body.get("material")
    if key in ("E", "nu") and isinstance(named, str) and named in MATERIALS:
        # One constant is varied, the other stays that of the material.
        material = MATERIALS[named]
        body |= {"E": material.E, "nu": material.nu}
    for other in _REPLACED.get(key, ()):
        body.pop(other, None)

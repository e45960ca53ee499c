"""Keys of case files and plans, loads, quantities and materials as Markdown tables, from the package itself."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import fastpin
from fastpin.assess.wear import RACE_OUTCOMES, WEAR_OUTCOMES
from fastpin.bodies.kinds import PINS, PLATES
from fastpin.casefile.reader import EXAMPLE, KEYS, ROOT_KEYS
from fastpin.model import FatigueConstants, InitialGap, Wear
from fastpin.model.loads import LOAD
from fastpin.model.options import OPTIONS
from fastpin.model.units import units_per_thickness
from fastpin.states import QUANTITIES
from fastpin.studies.outcomes import CYCLE_QUANTITIES, TAKES
from fastpin.studies.run_end import KEY_FIGURES
from fastpin.studies.variation import FACTORS

KINDS_OF_UNITS = {"angle": "rad", "width": "rad"}
"""Units of the kinds of quantities that :func:`fastpin.model.units.units_per_thickness` leaves out."""

CLASSES: dict[str, tuple[type, ...]] = {
    "pin": (fastpin.Material,),
    "plate": (fastpin.Material,),
    "contact": (fastpin.Problem, fastpin.MaterialPair),
    "pin_body": (*PINS.values(),),
    "plate_body": (*PLATES.values(), fastpin.Material),
    "gap": (InitialGap,),
    "wear": (Wear,),
    "solve": (fastpin.SolveOptions,),
}
"""Classes whose docstrings explain the keys of a section that the example leaves without words."""

OTHER_WORDS = {
    "title": "title in tables and figures",
    "kind": "kind of body, where its keys do not tell: "
    + "; ".join(", ".join(f'"{kind}"' for kind in kinds) for kinds in (PINS, PLATES)),
    "mean": "table of loads, the mean of a harmonic cycle",
    "amplitude": "table of loads, the amplitude of a harmonic cycle",
    "phase": "table of phases, degrees; a positive phase is ahead",
    "points": "corners of each harmonic cycle",
    "csv": "CSV file of corners, relative to the case file: a header, then a line for each corner; a load "
    'beside it is a column: `P = { column = "Force [N]", scale = -1.0, unit = "kN" }`',
    "turning_points": "whether only corners of the CSV file are kept at which a load turns back by more than its noise",
    "repeat": "number of times that the loads are run through",
    "skip": "lines at the beginning of the CSV file that are not read",
    "count": "column that says how many times the two corners of a line are run through",
    "file": "a compliance, relative to the case file",
    "material": "name of a material of fastpin or of your own file",
    "rigid": "true: the body is rigid",
    "fatigue": "constants for fatigue, see the table below",
    "friction": "coefficient of friction",
}
"""Words for keys that stand in several sections, or have no line of their own in the example."""


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table. A bar inside a cell is escaped."""
    lines = [list(head), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def words_of_docstring(owner: type) -> dict[str, str]:
    """The words for each parameter in a docstring of numpy's style."""
    text = inspect.getdoc(owner) or ""
    found = re.search(r"^(?:Parameters|Attributes)\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", text, re.DOTALL | re.MULTILINE)
    words: dict[str, str] = {}
    for names, body in re.findall(
        r"^(\w[\w, ]*?)(?: :[^\n]*)?\n((?:^[ ]+.*\n?)*)", found[1] if found else "", re.MULTILINE
    ):
        plain = re.sub(r":\w+:`~?(?:fastpin\.)?([\w.]+)`", r"`\1`", " ".join(body.split())).replace("``", "`")
        words.update(dict.fromkeys(names.split(", "), plain))
    return words


def words_of_example() -> dict[tuple[str, str], str]:
    """The comment behind each key of the example of a case file, by section and key."""
    section, words = "", {}
    for line in EXAMPLE.splitlines():
        head = re.match(r"^(?:# )?\[+(\w+)\]+", line)
        if head:
            section = head[1]
        key = re.match(r"^(?:# )?(\w+)\s*= ([^#]*)#\s*(.+)$", line)
        if key:
            text = re.sub(r"\b(docs/[\w-]+\.md)", r"[](\1)", key[3].strip())
            words.setdefault((section, key[1]), f"{key[2].strip()} {text}" if text.startswith("or ") else text)
    return words


def case_keys() -> str:
    """A table for each section of a case file."""
    example = words_of_example()
    parts = ["## Before the first section", "", table(("key", "meaning"), _rows("", ROOT_KEYS, example)), ""]
    for section, keys in KEYS.items():
        head = f"[[{section}]]" if section == "load" else f"[{section}]"
        parts += [f"## {head}", "", table(("key", "meaning"), _rows(section, keys, example)), ""]
        if section == "plate":
            words = words_of_docstring(FatigueConstants)
            rows = [(f"`{field.name}`", words.get(field.name, "")) for field in fields(FatigueConstants)]
            parts += ["The table `fatigue` of a material has these keys:", "", table(("key", "meaning"), rows), ""]
    return "\n".join(parts)


def _rows(section: str, keys: Iterable[str], example: Mapping[tuple[str, str], str]) -> Iterable[tuple[str, str]]:
    """A row for each key: the key, and its words from the example, this file or the docstrings."""
    known: dict[str, str] = {}
    for owner in reversed(CLASSES.get(section, ())):
        known |= words_of_docstring(owner)
    known |= {name: f"{load.words}, {unit(load.kind)}" for name, load in LOAD.items() if section == "load"}
    known |= {name: option["words"] for name, option in OPTIONS.items() if section == "solve"}
    sources: tuple[Mapping[Any, str], ...] = (known, OTHER_WORDS)
    for key in keys:
        twin = ("pin", key) if section == "plate" else ("plate", key)
        found = example.get((section, key)) or (example.get(twin) if section in ("pin", "plate") else None)
        if section in ("load", "history"):
            found = None
        yield f"`{key}`", found or next((words[key] for words in sources if words.get(key)), "")


def unit(kind: str) -> str:
    """The SI unit of a kind of quantity."""
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    problem = fastpin.Problem(pair, hole_radius=0.01, clearance=0.0, friction=0.3)
    return KINDS_OF_UNITS.get(kind) or units_per_thickness(problem).get(kind, "") or "1"


def plan_fields() -> str:
    """The fields of a case that a plan can vary."""
    varied = [section for section in KEYS if section not in ("load", "wear")]
    rows = [(f"`{name}`", ", ".join(f"`{name}.{key}`" for key in KEYS[name])) for name in varied]
    rows.append(("`load`", ", ".join(f"`load.{key}`" for key in KEYS["load"])))
    rows.append(("factors", ", ".join(f"`{name}`" for name in FACTORS)))
    return table(("section", "fields"), rows)


def plan_outcomes() -> str:
    """The names that the keys of an outcome accept, and the key figures of every run."""
    lists = {
        "`quantity`": [*QUANTITIES],
        "`take`": [*TAKES],
        "`over`": ["history", "cycle"],
        "`cycle`": [*CYCLE_QUANTITIES],
        "`wear`": [*WEAR_OUTCOMES, *RACE_OUTCOMES],
    }
    rows = [(key, ", ".join(f'"{name}"' for name in names)) for key, names in lists.items()]
    figures = ", ".join(f"`{name}`" for name in KEY_FIGURES)
    return f"{table(('key', 'values'), rows)}\n\nEvery run also leaves these key figures: {figures}."


def quantities() -> str:
    """The reported quantities with their units."""
    rows = [(f"`{name}`", quantity.words, unit(quantity.kind)) for name, quantity in QUANTITIES.items()]
    return table(("name", "quantity", "unit"), rows)


def materials() -> str:
    """The materials of fastpin."""
    rows = [
        (f'`"{name}"`', f"{material.E / 1e9:.4g}", f"{material.nu:.4g}", _mega(material.yield_strength))
        for name, material in fastpin.MATERIALS.items()
    ]
    return table(("name", "Young's modulus, GPa", "Poisson's ratio", "yield strength, MPa"), rows)


def _mega(value: float | None) -> str:
    return "" if value is None else f"{value / 1e6:.4g}"

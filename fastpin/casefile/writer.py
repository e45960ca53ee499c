"""The writer of case files: the text of a case, which :func:`fastpin.casefile.parse_case` reads back.

Numbers are written with all their digits. The case that is read back is the same one to the last bit. There are two
exceptions, which may differ in the last digit. The moduli of a dimensionless problem are scaled anew. Loads of a
problem with a thickness are written in N and N m, and not every load per thickness is the quotient of such a number;
loads that were read from a case file are. The name of a material that is not in :data:`fastpin.MATERIALS` is left out.
"""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

import numpy as np

from fastpin.model import Case, LoadHistory, Problem, Profile, SolveOptions, checks, loads
from fastpin.model.case import BESIDE, beside_of
from fastpin.model.fields import FIELDS
from fastpin.model.keys import CASE
from fastpin.model.unit_systems import SI
from fastpin.model.units import in_units

PER_LINE = 8
"""Numbers of a list of loads on one line. Lines stay shorter than 200 letters."""


def case_text(case: Case) -> str:
    """The text of a case file.

    Every corner is written with all its loads. The cycles of the history are not marked. Numbers are in the system of
    units of the problem.

    Raises
    ------
    InputError
        If `case` is no Case, or the plate is a compliance, which has a file of its own.
    """
    checks.instance("case", case, Case, "a Case")
    problem, options = case.problem, {each.name: getattr(case.options, each.name) for each in fields(case.options)}
    tables = {
        "about": case.about.given(),
        "pin": problem.pair.pin.toml(),
        "plate": problem.pair.plate.toml(),
        "contact": _contact(problem),
        "gap": {name: profile.toml() for name, profile in problem.gap.given.items()},
        **{name: body.toml() for name, body in problem.given_bodies.items()},
        "load": _loads(case.history),
        "wear": {} if case.wear is None else case.wear.toml(),
        **{name: BESIDE[name].written(value) for name, value in beside_of(case).items()},
        "solve": {name: value for name, value in options.items() if value != getattr(SolveOptions(), name)},
    }
    head = {"title": case.title, "units": "" if problem.unit_system == SI else problem.unit_system}
    blocks = [[f"{name} = {toml_value(words)}" for name, words in head.items() if words]]
    for name, table in in_units(problem, tables, CASE).items():
        header = "[[load]]" if name == "load" else f"[{name}]"
        blocks.append([header, *(f"{key} = {_lines(value)}" for key, value in table.items())] if table else [])
    return "\n\n".join("\n".join(block) for block in blocks if block) + "\n"


def _contact(problem: Problem) -> dict[str, Any]:
    found: dict[str, Any] = {"plane": problem.pair.plane}
    if problem.dimensionless:
        found["load_parameter"] = problem.clearance
    else:
        found |= {"hole_radius": problem.hole_radius, "clearance": problem.clearance}
    for name, field in FIELDS.items():
        value = getattr(problem, name)
        if value is not None and field.place == "[contact]" and name not in ("hole_radius", "clearance"):
            found[name] = value.toml() if isinstance(value, Profile) else value
    return found


def _loads(history: LoadHistory) -> dict[str, list[float]]:
    given = np.any([np.any(~np.isnan(block.given), axis=0) for block in history.blocks], axis=0)
    columns = zip(loads.LOADS, history.values().T.tolist(), given, strict=True)
    return {name: column for name, column, is_given in columns if is_given}


def _lines(value: object) -> str:
    """A value as TOML; a long list of numbers on several lines."""
    if not isinstance(value, list) or len(value) <= PER_LINE or not all(isinstance(each, float) for each in value):
        return toml_value(value)
    lines = [", ".join(map(repr, value[k : k + PER_LINE])) for k in range(0, len(value), PER_LINE)]
    return "\n".join(["[", *(f"    {line}," for line in lines), "]"])


def toml_value(value: object) -> str:
    """A number, text, truth value, list of numbers, table, list of tables or list of lists as TOML."""
    if isinstance(value, dict):
        return toml_value([value])
    if isinstance(value, list) and value and isinstance(value[0], list):
        return f"[{', '.join(toml_value(tuple(each)) for each in value)}]"
    if isinstance(value, list) and not any(isinstance(each, dict) for each in value):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, tuple):
        return f"[{', '.join(map(repr, value))}]"
    if isinstance(value, list):
        tables = [f"{{ {', '.join(f'{key} = {toml_value(each)}' for key, each in table.items())} }}" for table in value]
        return tables[0] if len(tables) == 1 else f"[{', '.join(tables)}]"
    if isinstance(value, str):  # TOML takes the escapes of JSON
        return json.dumps(value, ensure_ascii=False)
    return str(value).lower() if isinstance(value, bool) else repr(value)

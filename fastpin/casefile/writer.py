"""The writer of case files: the text of a case, which :func:`fastpin.casefile.parse_case` reads back.

Numbers are written with all their digits. The case that is read back is the same one to the last bit. There are two
exceptions, which may differ in the last digit. The moduli of a dimensionless problem are scaled anew. Loads of a
problem with a thickness are written in N and N m, and not every load per thickness is the quotient of such a number;
loads that were read from a case file are. The name of a material that is not in :data:`fastpin.MATERIALS` is left out.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from fastpin.model import Case, LoadHistory, Material, Problem, Profile, SolveOptions, checks, loads
from fastpin.model.case import BESIDE, beside_of
from fastpin.model.fields import FIELDS
from fastpin.model.units import PER_THICKNESS

PER_LINE = 8
"""Numbers of a list of loads on one line. Lines stay shorter than 200 letters."""


def case_text(case: Case) -> str:
    """The text of a case file.

    Every corner is written with all its loads. The cycles of the history are not marked.

    Raises
    ------
    InputError
        If `case` is no Case, or the plate is a compliance, which has a file of its own.
    """
    checks.instance("case", case, Case, "a Case")
    wear = {} if case.wear is None else case.wear.toml()
    blocks = [
        *([[f"title = {_value(case.title)}"]] if case.title else []),
        _section("about", case.about.given()),
        ["[pin]", *_material(case.problem.pair.pin)],
        ["[plate]", *_material(case.problem.pair.plate)],
        ["[contact]", *_contact(case.problem)],
        ["[gap]", *(f"{name} = {_value(profile.toml())}" for name, profile in case.problem.gap.given.items())],
        *_bodies(case.problem),
        ["[[load]]", *_loads(case.history, case.problem.thickness)],
        _section("wear", wear),
        *(_section(name, BESIDE[name].written(value)) for name, value in beside_of(case).items()),
        ["[solve]", *_options(case.options)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks if len(block) > 1 or not block[0].startswith("[")) + "\n"


def _section(name: str, entries: Mapping[str, Any]) -> list[str]:
    return [f"[{name}]", *(f"{key} = {_value(value)}" for key, value in entries.items())]


def _material(material: Material) -> Iterator[str]:
    yield from (f"{name} = {_value(value)}" for name, value in material.toml().items())


def _contact(problem: Problem) -> Iterator[str]:
    yield f"plane = {_value(problem.pair.plane)}"
    if problem.dimensionless:
        yield f"load_parameter = {problem.clearance!r}"
    else:
        yield f"hole_radius = {problem.hole_radius!r}"
        yield f"clearance = {problem.clearance!r}"
    for name, field in FIELDS.items():
        value = getattr(problem, name)
        if value is None or field.place != "[contact]" or name in ("hole_radius", "clearance"):
            continue
        if isinstance(value, Profile):
            value = value.toml()
        yield f"{name} = {_value(_whole(value, problem.thickness) if field.kind in PER_THICKNESS else value)}"


def _bodies(problem: Problem) -> Iterator[list[str]]:
    for name, body in problem.given_bodies.items():
        block = [f"[{name}]"]
        for key, value in body.toml().items():
            block += _material(value) if isinstance(value, Material) else [f"{key} = {_value(value)}"]
        yield block


def _loads(history: LoadHistory, thickness: float | None) -> Iterator[str]:
    given = np.any([np.any(~np.isnan(block.given), axis=0) for block in history.blocks], axis=0)
    for name, column, is_given in zip(loads.LOADS, history.values().T.tolist(), given, strict=True):
        if is_given:
            if loads.LOAD_KIND[name] in PER_THICKNESS:
                whole = {value: _whole(value, thickness) for value in set(column)}
                column = [whole[value] for value in column]
            lines = [", ".join(map(repr, column[k : k + PER_LINE])) for k in range(0, len(column), PER_LINE)]
            indented = [f"    {line}," for line in lines]
            yield f"{name} = [{lines[0]}]" if len(lines) == 1 else "\n".join([f"{name} = [", *indented, "]"])


def _whole(value: float, thickness: float | None) -> float:
    """The number of N, N m or N m/rad that gives `value` when it is divided by the thickness; if several, the shortest.

    Rounding leaves it within two floats of the product. If no float gives `value`, it is the product.
    """
    if thickness is None:
        return value
    product = value * thickness
    near = [product]
    for end in (-math.inf, math.inf):
        one = math.nextafter(product, end)
        near += [one, math.nextafter(one, end)]
    return min((each for each in near if each / thickness == value), key=lambda each: len(repr(each)), default=product)


def _options(options: SolveOptions) -> Iterator[str]:
    usual = SolveOptions()
    for each in fields(options):
        value = getattr(options, each.name)
        if value != getattr(usual, each.name):
            yield f"{each.name} = {_value(value)}"


def _value(value: object) -> str:
    """A number, text, truth value, list of numbers, table, list of tables or list of lists as TOML."""
    if isinstance(value, dict):
        return _value([value])
    if isinstance(value, list) and value and isinstance(value[0], list):
        return f"[{', '.join(_value(tuple(each)) for each in value)}]"
    if isinstance(value, list) and not any(isinstance(each, dict) for each in value):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, tuple):
        return f"[{', '.join(map(repr, value))}]"
    if isinstance(value, list):
        tables = [f"{{ {', '.join(f'{key} = {_value(each)}' for key, each in table.items())} }}" for table in value]
        return tables[0] if len(tables) == 1 else f"[{', '.join(tables)}]"
    if isinstance(value, str):  # TOML takes the escapes of JSON
        return json.dumps(value, ensure_ascii=False)
    return str(value).lower() if isinstance(value, bool) else repr(value)

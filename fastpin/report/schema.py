"""JSON schemas of the documents that commands write as JSON, for programs that read them.

The schemas are of draft 2020-12. They are made from the outputs that the documents are made from.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from fastpin.assess import crack, wear
from fastpin.assess.outputs import (
    NUMBER,
    TEXT,
    UNKNOWN,
    WHOLE,
    Output,
    Schema,
    list_of,
    map_of,
    object_of,
    of_fields,
    whole_schema,
)  # fmt: skip
from fastpin.bodies.compliance import FORMAT, VERSION
from fastpin.model.checks import choice
from fastpin.report import charts, convergence, identify, joints, summary, tolerances
from fastpin.verification.rows import Check
from fastpin.version import __version__


def json_schema(command: str) -> Schema:
    """Return the JSON schema of the document that a command writes.

    Parameters
    ----------
    command : str
        "run", "converge", "verify", "benchmarks", "compliance", "wear", "tolerances", "crack", "charts", "identify" or
        "joint".
        ``fastpin resume`` and ``show`` write the document of "run".

    Raises
    ------
    InputError
        If there is no such document.
    """
    document = _DOCUMENTS[choice("command", command, COMMANDS)]()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"JSON of fastpin {command}, version {__version__}",
        **document,
    }


CHECKS = (
    Output("versions", form=map_of(TEXT, "version of each library")),
    Output("cores", "whole"),
    Output("seconds"),
    Output("passed", "truth"),
    Output("checks", "list", parts=(*of_fields(Check), Output("passed", "truth"))),
)
"""Outputs of the checks of an installation."""


def _benchmarks() -> Schema:
    row = object_of(
        {
            "quantity": TEXT,
            "unit": TEXT,
            "published": {"type": ["string", "null"]} | {"description": "the number as its source prints it"},
            "fastpin": UNKNOWN,
            "difference": UNKNOWN,
            "agrees": {"type": ["boolean", "null"]},
            "verdict": TEXT,
        }
    )
    return object_of({"fastpin": TEXT, "benchmarks": map_of(list_of(row), "rows of each benchmark")})


def _compliance() -> Schema:
    return object_of(
        {
            "format": {"const": FORMAT},
            "version": {"const": VERSION},
            "nu": NUMBER,
            "plane": {"enum": ["strain", "stress"]},
            "hole_radius": NUMBER,
            "order": WHOLE,
            "matrix": list_of(list_of(NUMBER)),
            "columns": map_of(list_of(NUMBER), "response to each remote stress"),
            "made_by": TEXT,
        }
    )


_DOCUMENTS: dict[str, Callable[[], Schema]] = {
    "run": partial(whole_schema, summary.RUN),
    "converge": partial(whole_schema, convergence.CONVERGENCE),
    "verify": partial(whole_schema, CHECKS, has_title=False),
    "benchmarks": _benchmarks,
    "compliance": _compliance,
    "wear": partial(whole_schema, (Output("error", "text", optional=True), *wear.LIFE)),
    "tolerances": tolerances.schema,
    "crack": partial(whole_schema, crack.DOCUMENT),
    "charts": partial(whole_schema, charts.LOOKED, has_title=False),
    "identify": partial(whole_schema, identify.IDENTIFIED),
    "joint": joints.schema,
}

COMMANDS = tuple(_DOCUMENTS)
"""Commands whose document has a schema."""

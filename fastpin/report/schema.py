"""JSON schemas of the documents that commands write as JSON, for programs that read them.

The schemas are of draft 2020-12. They are made from the outputs that the documents are made from.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from fastpin.assess import crack, outputs, wear
from fastpin.assess.outputs import Output
from fastpin.bodies.compliance import FORMAT, VERSION
from fastpin.model.checks import choice
from fastpin.report import charts, convergence, identify, joint_document, joint_wear, summary, tolerances
from fastpin.verification.rows import Check
from fastpin.version import __version__


def json_schema(command: str) -> outputs.Schema:
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
    schema = _DOCUMENTS[choice("command", command, COMMANDS)]()
    title = f"JSON of fastpin {command}, version {__version__}"
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **schema}


CHECKS = (
    Output("versions", form=outputs.map_of(outputs.TEXT, "version of each library")),
    Output("cores", "whole"),
    Output("seconds"),
    Output("passed", "truth"),
    Output("checks", "list", parts=(*outputs.of_fields(Check), Output("passed", "truth"))),
)
"""Outputs of the checks of an installation."""


BENCHMARK_ROW = (
    Output("quantity", "text"),
    Output("unit", "text"),
    Output(
        "published", of=lambda row: row.published or None,
        form={"type": ["string", "null"], "description": "the number as its source prints it"},
    ),
    Output("fastpin", of=lambda row: row.ours, optional=True),
    Output("difference", optional=True),
    Output("agrees", "truth", optional=True),
    Output("verdict", "text"),
)  # fmt: skip
"""Outputs of a row of a benchmark."""

BENCHMARKS = (
    Output(
        "benchmarks", form=outputs.map_of(outputs.list_of(outputs.schema_of(BENCHMARK_ROW)), "rows of each benchmark"),
        of=lambda found: {
            name: [outputs.document(BENCHMARK_ROW, row, {}) for row in rows] for name, rows in found.items()
        },
    ),
)  # fmt: skip
"""Outputs of the rows of some benchmarks, by their names."""


def _compliance() -> outputs.Schema:
    return outputs.object_of(
        {
            "format": {"const": FORMAT},
            "version": {"const": VERSION},
            "nu": outputs.NUMBER,
            "plane": {"enum": ["strain", "stress"]},
            "hole_radius": outputs.NUMBER,
            "order": outputs.WHOLE,
            "matrix": outputs.list_of(outputs.list_of(outputs.NUMBER)),
            "columns": outputs.map_of(outputs.list_of(outputs.NUMBER), "response to each remote stress"),
            "lug": {"type": "object", "description": "outline, further holes, supports and loads"},
            "made_by": outputs.TEXT,
        },
        without=("lug",),
    )


_DOCUMENTS: dict[str, Callable[[], outputs.Schema]] = {
    "run": partial(outputs.whole_schema, summary.RUN),
    "converge": partial(outputs.whole_schema, convergence.CONVERGENCE),
    "verify": partial(outputs.whole_schema, CHECKS, has_title=False),
    "benchmarks": partial(outputs.whole_schema, BENCHMARKS, has_title=False),
    "compliance": _compliance,
    "wear": lambda: {  # of one pin, or of a joint
        "anyOf": [
            outputs.whole_schema((Output("error", "text", optional=True), *each))
            for each in (wear.LIFE, joint_wear.LIFE)
        ]
    },
    "tolerances": partial(outputs.whole_schema, tolerances.TOLERANCES),
    "crack": partial(outputs.whole_schema, crack.DOCUMENT),
    "charts": partial(outputs.whole_schema, charts.LOOKED, has_title=False),
    "identify": partial(outputs.whole_schema, identify.IDENTIFIED),
    "joint": partial(outputs.whole_schema, joint_document.JOINT),
}

COMMANDS = tuple(_DOCUMENTS)
"""Commands whose document has a schema."""

"""JSON schemas of the documents that commands write as JSON, for programs that read them.

The schemas are of draft 2020-12. They are made from the lists that the documents are made from: a new load or quantity
is in both.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

from fastpin.assess import margins
from fastpin.assess.cycle import CYCLE
from fastpin.assess.outputs import (
    NUMBER,
    OPTIONAL_TEXT,
    TEXT,
    TRUTH,
    UNKNOWN,
    WHOLE,
    Schema,
    list_of,
    map_of,
    object_of,
    or_null,
    properties,
)  # fmt: skip
from fastpin.assess.questions import QUESTIONS
from fastpin.assess.wear import COUNTS, PROFILES, WORN
from fastpin.bodies.compliance import FORMAT, VERSION
from fastpin.model.checks import choice
from fastpin.model.fields import FIELDS, Field
from fastpin.model.laminate import MODULI, ORDER
from fastpin.model.loads import ACTING, LOADS
from fastpin.model.materials import STRENGTHS
from fastpin.model.options import METHODS, SolveOptions
from fastpin.report import joints
from fastpin.report.identify import ENERGIES
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import READINGS
from fastpin.states.quantities import QUANTITIES
from fastpin.states.regimes import REGIMES
from fastpin.version import __version__

_RESULTANTS = ("P", "Q", "M")


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


def _summary() -> Schema:
    extreme = object_of({"value": UNKNOWN, "place": WHOLE, "load_point": NUMBER})
    sides = object_of({"smallest": extreme, "largest": extreme})
    counts = {"nodes": map_of(WHOLE, "number of nodes of each behaviour")}
    cycle = object_of(properties(CYCLE) | counts | {"work": map_of(UNKNOWN, "work of each load")})
    of_cycle = dict.fromkeys(Cycle._fields, UNKNOWN)
    of_cycle |= {"corner": WHOLE, "length": WHOLE, "number": WHOLE, "solved": TRUTH}
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            "complete": TRUTH,
            "error": OPTIONAL_TEXT,
            "units": map_of(TEXT, "unit of each kind of quantity"),
            "problem": _problem(),
            "history": object_of(
                {
                    "loads": list_of({"enum": list(LOADS)}),
                    "blocks": list_of(object_of({"repeat": WHOLE, "corners": list_of(list_of(UNKNOWN))})),
                }
            ),
            "solver": object_of({each.name: {} for each in fields(SolveOptions)}),
            "statistics": map_of(NUMBER, "counters of the solver, and its time, s"),
            "states": list_of(_state(seat=_state())),
            "extremes": object_of(dict.fromkeys(READINGS, sides), required=()),
            "margins": margins.schema(),
            "unread": map_of(TEXT, "why a quantity could not be read from the states, by quantity"),
            "cycles": list_of(object_of(of_cycle)),
            "cycle": or_null(cycle),
            **{name: or_null(question.schema()) for name, question in QUESTIONS.items()},
        }
    )


def _crack_growth() -> Schema:
    """The document of ``fastpin crack``."""
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            "units": map_of(TEXT, "unit of each kind of quantity"),
            "crack": QUESTIONS["crack"].schema(),
            "lengths": map_of(list_of(UNKNOWN), "a column of numbers at all lengths, with its unit in its name"),
            "margins": margins.schema(),
        }
    )


def _identified() -> Schema:
    """The document of ``fastpin identify``."""
    ends = object_of({"value": UNKNOWN | {"description": "null: not told"}, "low": UNKNOWN, "high": UNKNOWN})
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            "units": map_of(TEXT, "unit of each kind of quantity"),
            "displacement": TEXT,
            "force": TEXT,
            "samples": WHOLE,
            "turning_points": WHOLE,
            "least_reversal": NUMBER,
            "noise": object_of({"displacement": NUMBER, "force": NUMBER}),
            "scatter": NUMBER,
            "estimates": map_of(ends, "an identified value and its interval of 95 %; null: no bound"),
            "correlations": list_of({"type": "array", "prefixItems": [TEXT, TEXT, NUMBER]}),
            "energies": list_of(object_of(dict.fromkeys(ENERGIES, NUMBER))),
            "notes": list_of(TEXT),
        }
    )


def _problem() -> Schema:
    material = {
        "name": TEXT,
        "rigid": TRUTH,
        "E": UNKNOWN | {"description": "Pa; null: rigid; of a laminate: that of the isotropic plate with its contact"},
        "nu": NUMBER,
        **dict.fromkeys(STRENGTHS, UNKNOWN | {"description": "Pa; null: unknown"}),
        "expansion": NUMBER | {"description": "1/K"},
    }
    plate = object_of(material | {"laminate": _laminate()}, without=["laminate", "expansion"])
    body = {"type": "object", "properties": {"kind": TEXT}, "required": ["kind"]}
    return object_of(
        {
            "pin": object_of(material, without=["expansion"]),
            "plate": plate,
            "plane": {"enum": ["strain", "stress"]},
            "dundurs": object_of({"alpha": NUMBER, "beta": NUMBER, "convention": TEXT}),
            "beta_star": NUMBER,
            **{name: _field(field) for name, field in FIELDS.items()},
            **dict.fromkeys(("pin_body", "plate_body"), body),
            "assembled_clearance": NUMBER,
            "press_fit_pressure": NUMBER,
            "dimensionless": TRUTH,
        },
        without=[name for name, field in FIELDS.items() if field.has_section],
    )


def _field(field: Field) -> Schema:
    """A field of a problem. A profile along the rim is a list of tables, as in a case file."""
    profile = list_of({"type": "object"}) | {"description": "terms of a profile; angles in degrees from the bottom"}
    if field.has_section:
        return map_of(profile, "profiles; left out without any")
    if field.is_profile:
        return {"anyOf": [NUMBER, profile]}
    return TEXT if field.choices else UNKNOWN if field.is_optional else NUMBER


def _laminate() -> Schema:
    ply = {
        "description": "name or numbers of the ply; a list: of each ply",
        "type": ["string", "object", "array", "null"],
    }
    return object_of(
        {
            "layup": or_null(TEXT),
            "ply": ply,
            "axis": NUMBER | {"description": "deg from the bottom of the hole"},
            "moduli": object_of(dict.fromkeys(MODULI, NUMBER)),
            "compliance": list_of(NUMBER, len(ORDER)) | {"description": f"{', '.join(ORDER)}, 1/Pa"},
            "is_isotropic_contact": TRUTH,
        }
    )


def _state(seat: Schema | None = None) -> Schema:
    """A state, perhaps with the state of a seat."""
    interval = list_of(NUMBER, 2)
    slip = {"description": "start and stop, deg, and the sign of the slip", **list_of(NUMBER, 3)}
    quantities = {
        name: {"enum": list(REGIMES.values())} if each.classes else UNKNOWN | {"description": each.kind}
        for name, each in QUANTITIES.items()
        if name not in _RESULTANTS
    }
    parts: dict[str, Schema] = {
        "load_point": NUMBER,
        "step": WHOLE,
        "fraction": NUMBER,
        "load": object_of(dict.fromkeys(LOADS, NUMBER), LOADS[:ACTING]),
        "in_contact": TRUTH,
        **quantities,
        "unresolved": list_of({"enum": [name for name, each in QUANTITIES.items() if each.edge]}),
        "peak_hoop_resolved": {"type": ["boolean", "null"]},
        "contact": list_of(interval),
        "stick": list_of(interval),
        "slip": list_of(slip),
        "energy": UNKNOWN,
        "resultants": object_of(dict.fromkeys(_RESULTANTS, NUMBER)),
        "residuals": map_of(UNKNOWN, "errors of the contact conditions"),
        "error_bars": or_null(map_of(UNKNOWN, "largest likely errors")),
    }
    if seat is None:
        return object_of(parts)
    words = {"description": "the contact of a bush that slips in its seat; left out without one"}
    return object_of(parts | {"seat": seat | words}, without=["seat"])


def _convergence() -> Schema:
    series = object_of(
        {
            "corner": WHOLE,
            "quantity": TEXT,
            "unit": TEXT,
            "values": list_of(UNKNOWN),
            "verdict": TEXT,
            "order": UNKNOWN,
            "limit": UNKNOWN,
            "bar": UNKNOWN,
            "scatter": UNKNOWN,
            "path": UNKNOWN,
        }
    )
    counts = {"type": ["array", "integer", "null"], "items": WHOLE}
    study = object_of(
        {"solver": {"enum": list(METHODS)}, "nodes": counts, "increments": counts, "quantities": list_of(series)}
    )
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            "complete": TRUTH,
            "arc": list_of(NUMBER, 2),
            "units": map_of(TEXT, "unit of each kind of quantity"),
            "loads": map_of(map_of(NUMBER, "loads"), "loads at each corner"),
            "unread": map_of(TEXT, "why a quantity could not be read"),
            "studies": list_of(study),
        }
    )


def _verify() -> Schema:
    check = object_of(
        {
            **dict.fromkeys(("topic", "case", "quantity"), TEXT),
            **dict.fromkeys(("reference", "ours", "difference", "tolerance"), UNKNOWN),
            **dict.fromkeys(("unit", "message"), TEXT),
            "passed": TRUTH,
        }
    )
    return object_of(
        {
            "fastpin": TEXT,
            "versions": map_of(TEXT, "version of each library"),
            "cores": WHOLE,
            "seconds": NUMBER,
            "passed": TRUTH,
            "checks": list_of(check),
        }
    )


def _benchmarks() -> Schema:
    row = object_of(
        {
            "quantity": TEXT,
            "unit": TEXT,
            "published": OPTIONAL_TEXT | {"description": "the number as its source prints it"},
            "fastpin": UNKNOWN,
            "difference": UNKNOWN,
            "agrees": {"type": ["boolean", "null"]},
            "verdict": TEXT,
        }
    )
    return object_of({"fastpin": TEXT, "benchmarks": map_of(list_of(row), "rows of each benchmark")})


def _charts() -> Schema:
    bounds = object_of({"usual": NUMBER, "largest": NUMBER})
    words = {"words": TEXT, "unit": TEXT, "parameters": list_of(TEXT)}
    chart = object_of(words | {"relative": TRUTH, "bounds": map_of(bounds, "bounds of each table")})
    given = {"type": "object", "description": "the parameters that were given"}
    charts = {"fastpin": TEXT, "charts": map_of(chart, "the charts"), "parameters": given}
    return object_of(charts | {"value": UNKNOWN, "error": UNKNOWN})


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


def _wear() -> Schema:
    profiles = {name: list_of(each) for name, each in properties(PROFILES).items()}
    cycle = object_of(properties(COUNTS) | {"tau": NUMBER} | properties(WORN) | profiles)
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            "complete": TRUTH,
            "error": OPTIONAL_TEXT,
            "units": map_of(TEXT, "unit of each kind of quantity"),
            "law": TEXT,
            "tolerance": NUMBER,
            "angles": list_of(NUMBER),
            "pin_coefficient": list_of(NUMBER),
            "plate_coefficient": list_of(NUMBER),
            "statistics": map_of(NUMBER, "counters of the solver"),
            "cycles": list_of(cycle),
        }
    )


def _tolerances() -> Schema:
    values = map_of(NUMBER, "the fields")
    reached = object_of({"value": NUMBER, "part": TEXT, "values": values})
    span = or_null(object_of({"smallest": reached, "largest": reached}))
    alone = {"values": list_of(NUMBER), "outcomes": list_of(UNKNOWN)}
    field = object_of(alone | dict.fromkeys(("swing", "rank_correlation"), UNKNOWN))
    outcome = object_of(
        {
            "unit": TEXT,
            "nominal": UNKNOWN,
            "fields": map_of(field, "the effect of each field, the largest swing first"),
            "corners": span,
            "all": span,
            "percentiles": map_of(NUMBER, "percentiles of the samples"),
            "unresolved": WHOLE | {"description": "number of runs whose value the nodes do not resolve"},
        }
    )
    limits = object_of(dict.fromkeys(("nominal", "from", "to"), NUMBER) | {"spacing": {"enum": ["linear", "log"]}})
    return object_of(
        {
            "fastpin": TEXT,
            "title": TEXT,
            **dict.fromkeys(("points", "done", "corners", "samples"), WHOLE),
            "failed": list_of(object_of({"part": TEXT, "values": values, "reason": TEXT})),
            "fields": map_of(limits, "the limits of each field, in the units of the case file"),
            "outcomes": map_of(outcome, "the effects on each outcome"),
        }
    )


_DOCUMENTS: dict[str, Callable[[], Schema]] = {
    "run": _summary,
    "converge": _convergence,
    "verify": _verify,
    "benchmarks": _benchmarks,
    "compliance": _compliance,
    "wear": _wear,
    "tolerances": _tolerances,
    "crack": _crack_growth,
    "charts": _charts,
    "identify": _identified,
    "joint": joints.schema,
}

COMMANDS = tuple(_DOCUMENTS)
"""Commands whose document has a schema."""

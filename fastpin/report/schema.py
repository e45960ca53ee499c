"""JSON schemas of the documents that commands write as JSON, for programs that read them.

The schemas are of draft 2020-12. They are made from the lists that the documents are made from: a new load or quantity
is in both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from typing import Any

from fastpin.assess.crack import GROWTH
from fastpin.assess.cycle import CYCLE
from fastpin.assess.fatigue import DAMAGE, HOW
from fastpin.assess.outputs import properties
from fastpin.assess.strength import PLACE
from fastpin.assess.wear import COUNTS, PROFILES, WORN
from fastpin.bodies.compliance import FORMAT, VERSION
from fastpin.model.checks import choice
from fastpin.model.fields import FIELDS, Field
from fastpin.model.laminate import MODULI, ORDER
from fastpin.model.loads import ACTING, LOADS
from fastpin.model.materials import STRENGTHS
from fastpin.model.options import METHODS, SolveOptions
from fastpin.model.ply import CRITERION_NAMES
from fastpin.model.strength import LENGTHS
from fastpin.report.identify import ENERGIES
from fastpin.states.cycles import Cycle
from fastpin.states.extremes import READINGS
from fastpin.states.quantities import QUANTITIES
from fastpin.states.regimes import REGIMES
from fastpin.version import __version__

Schema = dict[str, Any]

_NUMBER: Schema = {"type": "number"}
_WHOLE: Schema = {"type": "integer"}
_TEXT: Schema = {"type": "string"}
_TRUTH: Schema = {"type": "boolean"}
_UNKNOWN: Schema = {"type": ["number", "null"]}  # NaN and infinity are null
_OPTIONAL_TEXT: Schema = {"type": ["string", "null"]}
_RESULTANTS = ("P", "Q", "M")


def json_schema(command: str) -> Schema:
    """Return the JSON schema of the document that a command writes.

    Parameters
    ----------
    command : str
        "run", "converge", "verify", "benchmarks", "compliance", "wear", "tolerances", "crack", "charts" or "identify".
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
    extreme = _object({"value": _UNKNOWN, "place": _WHOLE, "load_point": _NUMBER})
    sides = _object({"smallest": extreme, "largest": extreme})
    counts = {"nodes": _map_of(_WHOLE, "number of nodes of each behaviour")}
    cycle = _object(properties(CYCLE) | counts | {"work": _map_of(_UNKNOWN, "work of each load")})
    of_cycle = dict.fromkeys(Cycle._fields, _UNKNOWN)
    of_cycle |= {"corner": _WHOLE, "length": _WHOLE, "number": _WHOLE, "solved": _TRUTH}
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            "complete": _TRUTH,
            "error": _OPTIONAL_TEXT,
            "units": _map_of(_TEXT, "unit of each kind of quantity"),
            "problem": _problem(),
            "history": _object(
                {
                    "loads": _list_of({"enum": list(LOADS)}),
                    "blocks": _list_of(_object({"repeat": _WHOLE, "corners": _list_of(_list_of(_UNKNOWN))})),
                }
            ),
            "solver": _object({each.name: {} for each in fields(SolveOptions)}),
            "statistics": _map_of(_NUMBER, "counters of the solver, and its time, s"),
            "states": _list_of(_state(seat=_state())),
            "extremes": _object(dict.fromkeys(READINGS, sides), required=()),
            "margins": _margins(),
            "unread": _map_of(_TEXT, "why a quantity could not be read from the states, by quantity"),
            "cycles": _list_of(_object(of_cycle)),
            "cycle": _or_null(cycle),
            "fatigue": _or_null(_fatigue()),
            "crack": _or_null(_object(properties(GROWTH))),
            "strength": _or_null(_strength()),
        }
    )


def _strength() -> Schema:
    place, loads = properties(PLACE), _map_of(_NUMBER, "loads of the state that fails")
    return _object(
        {
            "criterion": {"enum": list(CRITERION_NAMES)},
            **dict.fromkeys(LENGTHS, _UNKNOWN),
            "states": _WHOLE,
            **place,
            "failure": _or_null(_object({"factor": _NUMBER, "load": loads, "solved": _WHOLE, **place})),
            "error": _OPTIONAL_TEXT,
        }
    )


def _margins() -> Schema:
    texts, numbers = (
        ("subject", "name", "body", "unit", "remark", "part"),
        ("value", "allowable", "margin", "load_point"),
    )
    governing = {"smallest": _TRUTH, "loads": _map_of(_NUMBER, "loads of the state that governs")}
    governing["over_yield"] = _UNKNOWN | {"description": "stress over the yield strength where it is above 1"}
    return _list_of(_object(dict.fromkeys(texts, _TEXT) | dict.fromkeys(numbers, _UNKNOWN) | governing))


def _crack_growth() -> Schema:
    """The document of ``fastpin crack``."""
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            "units": _map_of(_TEXT, "unit of each kind of quantity"),
            "crack": _object(properties(GROWTH)),
            "lengths": _map_of(_list_of(_UNKNOWN), "a column of numbers at all lengths, with its unit in its name"),
            "margins": _margins(),
        }
    )


def _identified() -> Schema:
    """The document of ``fastpin identify``."""
    ends = _object({"value": _UNKNOWN | {"description": "null: not told"}, "low": _UNKNOWN, "high": _UNKNOWN})
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            "units": _map_of(_TEXT, "unit of each kind of quantity"),
            "displacement": _TEXT,
            "force": _TEXT,
            "samples": _WHOLE,
            "turning_points": _WHOLE,
            "least_reversal": _NUMBER,
            "noise": _object({"displacement": _NUMBER, "force": _NUMBER}),
            "scatter": _NUMBER,
            "estimates": _map_of(ends, "an identified value and its interval of 95 %; null: no bound"),
            "correlations": _list_of({"type": "array", "prefixItems": [_TEXT, _TEXT, _NUMBER]}),
            "energies": _list_of(_object(dict.fromkeys(ENERGIES, _NUMBER))),
            "notes": _list_of(_TEXT),
        }
    )


def _problem() -> Schema:
    material = {
        "name": _TEXT,
        "rigid": _TRUTH,
        "E": _UNKNOWN | {"description": "Pa; null: rigid; of a laminate: that of the isotropic plate with its contact"},
        "nu": _NUMBER,
        **dict.fromkeys(STRENGTHS, _UNKNOWN | {"description": "Pa; null: unknown"}),
    }
    plate = _object(material | {"laminate": _laminate()}, without=["laminate"])
    body = {"type": "object", "properties": {"kind": _TEXT}, "required": ["kind"]}
    return _object(
        {
            "pin": _object(material),
            "plate": plate,
            "plane": {"enum": ["strain", "stress"]},
            "dundurs": _object({"alpha": _NUMBER, "beta": _NUMBER, "convention": _TEXT}),
            "beta_star": _NUMBER,
            **{name: _field(field) for name, field in FIELDS.items()},
            **dict.fromkeys(("pin_body", "plate_body"), body),
            "assembled_clearance": _NUMBER,
            "press_fit_pressure": _NUMBER,
            "dimensionless": _TRUTH,
        },
        without=[name for name, field in FIELDS.items() if field.has_section],
    )


def _field(field: Field) -> Schema:
    """A field of a problem. A profile along the rim is a list of tables, as in a case file."""
    profile = _list_of({"type": "object"}) | {"description": "terms of a profile; angles in degrees from the bottom"}
    if field.has_section:
        return _map_of(profile, "profiles; left out without any")
    if field.is_profile:
        return {"anyOf": [_NUMBER, profile]}
    return _TEXT if field.choices else _UNKNOWN if field.is_optional else _NUMBER


def _laminate() -> Schema:
    ply = {
        "description": "name or numbers of the ply; a list: of each ply",
        "type": ["string", "object", "array", "null"],
    }
    return _object(
        {
            "layup": _or_null(_TEXT),
            "ply": ply,
            "axis": _NUMBER | {"description": "deg from the bottom of the hole"},
            "moduli": _object(dict.fromkeys(MODULI, _NUMBER)),
            "compliance": _list_of(_NUMBER, len(ORDER)) | {"description": f"{', '.join(ORDER)}, 1/Pa"},
            "is_isotropic_contact": _TRUTH,
        }
    )


def _state(seat: Schema | None = None) -> Schema:
    """A state, perhaps with the state of a seat."""
    interval = _list_of(_NUMBER, 2)
    slip = {"description": "start and stop, deg, and the sign of the slip", **_list_of(_NUMBER, 3)}
    quantities = {
        name: {"enum": list(REGIMES.values())} if each.classes else _UNKNOWN | {"description": each.kind}
        for name, each in QUANTITIES.items()
        if name not in _RESULTANTS
    }
    parts: dict[str, Schema] = {
        "load_point": _NUMBER,
        "step": _WHOLE,
        "fraction": _NUMBER,
        "load": _object(dict.fromkeys(LOADS, _NUMBER), LOADS[:ACTING]),
        "in_contact": _TRUTH,
        **quantities,
        "unresolved": _list_of({"enum": [name for name, each in QUANTITIES.items() if each.edge]}),
        "peak_hoop_resolved": {"type": ["boolean", "null"]},
        "contact": _list_of(interval),
        "stick": _list_of(interval),
        "slip": _list_of(slip),
        "energy": _UNKNOWN,
        "resultants": _object(dict.fromkeys(_RESULTANTS, _NUMBER)),
        "residuals": _map_of(_UNKNOWN, "errors of the contact conditions"),
        "error_bars": _or_null(_map_of(_UNKNOWN, "largest likely errors")),
    }
    if seat is None:
        return _object(parts)
    words = {"description": "the contact of a bush that slips in its seat; left out without one"}
    return _object(parts | {"seat": seat | words}, without=["seat"])


def _fatigue() -> Schema:
    numbers = dict.fromkeys(("start", "stop", "largest", "parameter", "damage"), _NUMBER)
    words = {"description": "counted cycles at the hot spot, the largest damage first; start and stop are load points"}
    cycles = _list_of(_object(numbers | {"times": _WHOLE})) | words
    body = _object(properties(DAMAGE) | {"cycles": cycles, "failure_probability": _UNKNOWN, "over_yield": _UNKNOWN})
    return _object(properties(HOW) | {"error": _OPTIONAL_TEXT, "bodies": _list_of(body)})


def _convergence() -> Schema:
    series = _object(
        {
            "corner": _WHOLE,
            "quantity": _TEXT,
            "unit": _TEXT,
            "values": _list_of(_UNKNOWN),
            "verdict": _TEXT,
            "order": _UNKNOWN,
            "limit": _UNKNOWN,
            "bar": _UNKNOWN,
            "scatter": _UNKNOWN,
            "path": _UNKNOWN,
        }
    )
    counts = {"type": ["array", "integer", "null"], "items": _WHOLE}
    study = _object(
        {"solver": {"enum": list(METHODS)}, "nodes": counts, "increments": counts, "quantities": _list_of(series)}
    )
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            "complete": _TRUTH,
            "arc": _list_of(_NUMBER, 2),
            "units": _map_of(_TEXT, "unit of each kind of quantity"),
            "loads": _map_of(_map_of(_NUMBER, "loads"), "loads at each corner"),
            "unread": _map_of(_TEXT, "why a quantity could not be read"),
            "studies": _list_of(study),
        }
    )


def _verify() -> Schema:
    check = _object(
        {
            **dict.fromkeys(("topic", "case", "quantity"), _TEXT),
            **dict.fromkeys(("reference", "ours", "difference", "tolerance"), _UNKNOWN),
            **dict.fromkeys(("unit", "message"), _TEXT),
            "passed": _TRUTH,
        }
    )
    return _object(
        {
            "fastpin": _TEXT,
            "versions": _map_of(_TEXT, "version of each library"),
            "cores": _WHOLE,
            "seconds": _NUMBER,
            "passed": _TRUTH,
            "checks": _list_of(check),
        }
    )


def _benchmarks() -> Schema:
    row = _object(
        {
            "quantity": _TEXT,
            "unit": _TEXT,
            "published": _OPTIONAL_TEXT | {"description": "the number as its source prints it"},
            "fastpin": _UNKNOWN,
            "difference": _UNKNOWN,
            "agrees": {"type": ["boolean", "null"]},
            "verdict": _TEXT,
        }
    )
    return _object({"fastpin": _TEXT, "benchmarks": _map_of(_list_of(row), "rows of each benchmark")})


def _charts() -> Schema:
    bounds = _object({"usual": _NUMBER, "largest": _NUMBER})
    words = {"words": _TEXT, "unit": _TEXT, "parameters": _list_of(_TEXT)}
    chart = _object(words | {"relative": _TRUTH, "bounds": _map_of(bounds, "bounds of each table")})
    given = {"type": "object", "description": "the parameters that were given"}
    charts = {"fastpin": _TEXT, "charts": _map_of(chart, "the charts"), "parameters": given}
    return _object(charts | {"value": _UNKNOWN, "error": _UNKNOWN})


def _compliance() -> Schema:
    return _object(
        {
            "format": {"const": FORMAT},
            "version": {"const": VERSION},
            "nu": _NUMBER,
            "plane": {"enum": ["strain", "stress"]},
            "hole_radius": _NUMBER,
            "order": _WHOLE,
            "matrix": _list_of(_list_of(_NUMBER)),
            "columns": _map_of(_list_of(_NUMBER), "response to each remote stress"),
            "made_by": _TEXT,
        }
    )


def _wear() -> Schema:
    profiles = {name: _list_of(each) for name, each in properties(PROFILES).items()}
    cycle = _object(properties(COUNTS) | {"tau": _NUMBER} | properties(WORN) | profiles)
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            "complete": _TRUTH,
            "error": _OPTIONAL_TEXT,
            "units": _map_of(_TEXT, "unit of each kind of quantity"),
            "law": _TEXT,
            "tolerance": _NUMBER,
            "angles": _list_of(_NUMBER),
            "pin_coefficient": _list_of(_NUMBER),
            "plate_coefficient": _list_of(_NUMBER),
            "statistics": _map_of(_NUMBER, "counters of the solver"),
            "cycles": _list_of(cycle),
        }
    )


def _tolerances() -> Schema:
    values = _map_of(_NUMBER, "the fields")
    reached = _object({"value": _NUMBER, "part": _TEXT, "values": values})
    span = _or_null(_object({"smallest": reached, "largest": reached}))
    alone = {"values": _list_of(_NUMBER), "outcomes": _list_of(_UNKNOWN)}
    field = _object(alone | dict.fromkeys(("swing", "rank_correlation"), _UNKNOWN))
    outcome = _object(
        {
            "unit": _TEXT,
            "nominal": _UNKNOWN,
            "fields": _map_of(field, "the effect of each field, the largest swing first"),
            "corners": span,
            "all": span,
            "percentiles": _map_of(_NUMBER, "percentiles of the samples"),
            "unresolved": _WHOLE | {"description": "number of runs whose value the nodes do not resolve"},
        }
    )
    limits = _object(dict.fromkeys(("nominal", "from", "to"), _NUMBER) | {"spacing": {"enum": ["linear", "log"]}})
    return _object(
        {
            "fastpin": _TEXT,
            "title": _TEXT,
            **dict.fromkeys(("points", "done", "corners", "samples"), _WHOLE),
            "failed": _list_of(_object({"part": _TEXT, "values": values, "reason": _TEXT})),
            "fields": _map_of(limits, "the limits of each field, in the units of the case file"),
            "outcomes": _map_of(outcome, "the effects on each outcome"),
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
}

COMMANDS = tuple(_DOCUMENTS)
"""Commands whose document has a schema."""


def _object(
    properties: Mapping[str, Schema], required: Iterable[str] | None = None, without: Iterable[str] = ()
) -> Schema:
    """An object with these keys only. All must be there, unless some are `required`, or it may be `without` some."""
    needed = [name for name in (properties if required is None else required) if name not in tuple(without)]
    return {"type": "object", "properties": dict(properties), "required": needed, "additionalProperties": False}


def _map_of(item: Schema, words: str) -> Schema:
    return {"type": "object", "description": words, "additionalProperties": item}


def _list_of(item: Schema, length: int | None = None) -> Schema:
    return {"type": "array", "items": item} | ({} if length is None else {"minItems": length, "maxItems": length})


def _or_null(item: Schema) -> Schema:
    return {"anyOf": [item, {"type": "null"}]}

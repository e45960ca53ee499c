"""Variation of a case: set fields, ``section.key``, in the tables of a case file.

A case file has several ways to give some inputs. A varied field then replaces the other ways. A named material replaces
moduli, Dundurs' parameters replace two materials, a CSV file replaces load blocks; and the other way round. A kind of
body replaces the keys of other kinds. A factor, ``loads`` or ``loads.P``, multiplies loads after the case is read.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from fastpin.assess.crack import passes_of
from fastpin.assess.questions import QUESTIONS
from fastpin.casefile.bodies import BODY_KINDS, Kinds, implied_kind, keys_of
from fastpin.casefile.materials import known_materials, make_room
from fastpin.casefile.profiles import PROFILES, part_fault, varied
from fastpin.casefile.reader import KEYS, SharedParts, case_from, key_hint, sections_with
from fastpin.casefile.toml_text import CaseText, KeyPath, TooManyFaultsError
from fastpin.errors import CaseFileError, InputError, InputWarning
from fastpin.model import points
from fastpin.model.acting import check_loads
from fastpin.model.case import Case, questions_of
from fastpin.model.checks import number
from fastpin.model.doubts import doubts
from fastpin.model.fields import FIELDS
from fastpin.model.keys import CASE, kind_of
from fastpin.model.loads import ACTING, LOAD, LOADS
from fastpin.model.materials import MATERIALS, Material
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest
from fastpin.model.unit_systems import SI, is_system
from fastpin.model.units import in_other_units, in_units, units_per_thickness
from fastpin.states.error_bars import check_nodes
from fastpin.studies.identity import canonical

LOAD_TABLES = (("mean",), ("amplitude",), ("phase",))
"""Keys of a [[load]] block that are tables of loads."""

FACTORS = {"loads": LOADS[:ACTING], **{f"loads.{name}": (name,) for name in LOADS[:ACTING]}}
"""Fields that are factors, and the loads that each multiplies. They are no keys of a case."""

USUAL_OUTCOMES = {
    "largest_pressure": {"quantity": "peak_pressure", "take": "largest"},
    "largest_shear": {"quantity": "peak_shear", "take": "largest magnitude"},
    "largest_hoop": {"quantity": "peak_hoop", "take": "largest"},
    "least_bush_pressure": {"quantity": "bush_open_margin", "take": "smallest"},
}
"""The outcomes of a plan without [outcomes], as far as the joint has them: over all kept states."""


class BaseCase:
    """The base case of a plan.

    Attributes
    ----------
    form : str
        The kind of its file.
    text : CaseText
        Its text, in the units of the plan.
    is_whole : bool
        Whether it has a thickness.

    Parameters
    ----------
    text : str
        The case, TOML.
    name : str
        Name of the case in messages.
    folder : Path
        Folder of the CSV files and compliances with relative paths.
    units : str
        The system of units of varied fields and of outputs; that of the case unless given.

    Raises
    ------
    CaseFileError
        With the faults of the TOML text.
    """

    form = "case file"

    def __init__(self, text: str, name: str, folder: Path, units: str = "") -> None:
        self.name = name
        self.text = CaseText(text)
        if self.text.faults:
            raise CaseFileError(name, self.text.faults)
        tables = self.text.root.table
        contact, own = tables.get("contact"), tables.get("units", SI)
        self.is_whole = isinstance(contact, dict) and "thickness" in contact
        if units and units != own and is_system(own):
            self.text = self.text.with_tables(in_other_units(tables, CASE, own, units, self.is_whole))
        self._folder = folder
        self._materials: Mapping[str, Material] = MATERIALS
        with contextlib.suppress(TooManyFaultsError):  # every variation reports these faults
            self._materials = known_materials(self.text.with_tables(self.text.root.table), folder)
        self._shared = SharedParts()

    @property
    def load_blocks(self) -> int:
        """Number of [[load]] blocks of the case."""
        blocks = self.text.root.value("load")
        return len(self.text.blocks("load")) if isinstance(blocks, list) else 0

    def beside(self, varied: Collection[str] = ()) -> dict[str, Any]:
        """What outcomes leave out, by name: the values of its sections [wear] and beside the problem.

        "passes" is the name of the passes that a crack counts, see :func:`fastpin.assess.crack.passes_of`. It is left
        out if one of the `varied` fields is the number of repeats of a block.
        """
        case = self.vary({})[1]
        if case is None:
            return {}
        repeats = any(name.startswith("load.") and name.endswith(".repeat") for name in varied)
        passes = {} if repeats else {"passes": passes_of(case.history)}
        return passes | ({} if case.wear is None else {"wear": case.wear}) | questions_of(case)

    def vary(self, values: dict[str, Any]) -> tuple[CaseText, Case | None]:
        """Return text and case with these values of fields. The case has no meaning if the text has faults."""
        text = self.text.with_tables(with_values(self.text.root.table, values, self._materials))
        case = None
        with contextlib.suppress(TooManyFaultsError):
            case = case_from(text, self._folder, self._shared)
        factors = {name: value for name, value in values.items() if name in FACTORS}
        if case is not None and factors:
            case = _scaled(text, case, factors)
        if case is not None and case.options.error_bars:
            try:
                check_nodes(case.options.nodes)
            except InputError as error:
                text.report(str(error), "solve", error.field)
        return text, case

    @staticmethod
    def is_table(names: tuple[str, ...], is_range: bool) -> bool:
        """Whether a table at this name holds fields. If `is_range`, it has the keys of a range only."""
        is_section = len(names) < (3 if names[0] == "load" else 2) or names[2:] in LOAD_TABLES
        if is_section and not (names == ("loads",) and is_range):
            return True
        return names[:2] in PROFILES and not is_range

    def fault(self, names: tuple[str, ...]) -> str | None:
        """Return the fault of a field's name, or None."""
        return field_fault(names, self)

    def locate(
        self, places: Mapping[str, KeyPath], values: Mapping[str, Any], place: KeyPath, message: str
    ) -> tuple[KeyPath, str] | None:
        """Return the place of a run's fault in the plan, and its message there; None if it is one of the case.

        `places` are those of the fields in the plan, `values` the fields of the run.
        """
        parts = [str(part + 1) if isinstance(part, int) else part for part in place]
        name = ".".join(parts)
        if place in PROFILES:
            whole = f"{parts[0]}.{message}"
            field, _, reason = whole.partition(": ")
            own = field if field in values else next((each for each in values if each.startswith(f"{name}.")), "")
            if own or name in values:
                return places[own or name], f"{own}: {reason}" if own else whole
        if name in values:
            return places[name], f"{name}: {message.removeprefix(f'{parts[-1]}: ')}"
        line = self.text.line(*place)
        same_section = [field_name for field_name in values if parts and field_name.split(".")[0] == parts[0]]
        if same_section and (not line or line == self.text.line(*place[:1])):  # The plan makes or changes this section.
            return places[same_section[0]], f"{same_section[0]}: {message}"
        return None

    def nominal(self, case: Case, name: str) -> float | None:
        """Return the value of a field in the case: from its text, or else from its materials and defaults."""
        if name in FACTORS:
            return 1.0
        section, *keys = name.split(".")
        value: Any = self.text.root.table.get(section)
        if section == "load" and isinstance(value, dict):
            value = [value]
        for key in keys:
            if isinstance(value, list):
                value = value[int(key) - 1] if key.isdecimal() and 1 <= int(key) <= len(value) else None
            else:
                value = value.get(key) if isinstance(value, dict) else None
        problem = case.problem
        owners: dict[str, Any] = {
            "contact": problem, "pin": problem.pair.pin, "plate": problem.pair.plate, "pin_body": problem.pin_body,
            "plate_body": problem.plate_body,
        }  # fmt: skip
        if value is None and section in owners and len(keys) == 1:
            owner = owners[section]
            written = owner.toml() if section == "plate" else {}  # the axis of a laminate is in degrees there
            value = written.get(
                keys[0], getattr(owner, keys[0], getattr(getattr(owner, "material", None), keys[0], None))
            )
            value = in_units(problem, value, kind_of(name))
        is_number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
        return value if is_number else None

    def is_idle(self, case: Case, factor: str) -> bool:
        """Whether a factor would change nothing."""
        return not any(case.history.largest.get(load) for load in FACTORS[factor])

    @staticmethod
    def usual(case: Case, swing: bool) -> dict[str, Any]:
        """Return the tables of the outcomes of a plan without any, by name; of numbers with a `swing` if asked for."""
        without = set() if "plate" in points.elastic_bodies(case.problem) else {"largest_hoop"}
        if case.problem.plate_body.bush is None:
            without.add("least_bush_pressure")
        return {name: table for name, table in USUAL_OUTCOMES.items() if name not in without} if swing else {}

    @staticmethod
    def doubts(case: Case) -> list[InputWarning]:
        """Return what is probably a mistake in a case."""
        return doubts(case.problem, case.history, case.options)

    @staticmethod
    def identity(case: Case, strengths: bool) -> dict[str, Any]:
        """Return the complete input of a run, see :func:`fastpin.studies.identity.canonical`."""
        return canonical(case, strengths)

    @staticmethod
    def problem(case: Case) -> Problem:
        """Return the problem whose units the outputs have."""
        return case.problem

    @staticmethod
    def drawn(case: Case) -> Problem | None:
        """Return the problem that stands below figures."""
        return case.problem

    @staticmethod
    def unit_names(case: Case) -> dict[str, str]:
        """Return the unit of every kind of quantity in the index, and in Python."""
        return units_per_thickness(case.problem)

    @staticmethod
    def kind(field: str) -> str:
        """Return the kind of a field; empty if it has no unit."""
        return kind_of(field)

    @staticmethod
    def words(field: str) -> str:
        """Return words for a field."""
        return field_words(field)


def _scaled(text: CaseText, case: Case, factors: Mapping[str, Any]) -> Case:
    """Return the case with its loads multiplied by factors. Report the faults of a factor on its name."""
    scale = dict.fromkeys(LOADS[:ACTING], 1.0)
    for name, value in factors.items():
        try:
            for load in FACTORS[name]:
                scale[load] *= number(name.rpartition(".")[2], value)
        except InputError as error:
            text.report(str(error), *name.split("."))
            return case
    try:
        history = case.history.scaled(scale)
        check_loads(case.problem, history)
    except InputError as error:
        text.report(str(error), *next(iter(factors)).split("."))
        return case
    return replace(case, history=history)


UNVARIED = {
    "wear": ("no run of a sweep wears", "depth"),
    **{name: (question.unvaried, next(iter(question.outcomes))) for name, question in QUESTIONS.items()},
}
"""Sections whose keys no plan varies: the reason, and an outcome that has the keys."""


def varied_name(section: str, key: str) -> str:
    """The field of a key, as a plan writes it."""
    return f"load.1.{key}" if section == "load" else f"{section}.{key}"


def field_fault(names: tuple[str, ...], base: BaseCase | None) -> str | None:
    """Return the fault of a field's name, or None."""
    name, section = ".".join(names), names[0]
    if section == "loads":
        hint = "; loads multiplies all loads, and loads.P one of them"
        return None if name in FACTORS else f'"{name}": is no factor{closest(name, tuple(FACTORS)) or hint}'
    if section not in KEYS and len(names) == 1 and (owners := sections_with(name)):
        return f'"{name}": a field is written section.key: {varied_name(owners[0], name)}'
    if section not in KEYS:
        hint = closest(section, tuple(KEYS)) or f"; sections are {', '.join(KEYS)}"
        return f'"{name}": there is no section [{section}] in a case file{hint}'
    if section in UNVARIED:
        why, outcome = UNVARIED[section]
        return f'"{name}": {why}; an outcome such as {{ {section} = "{outcome}" }} may have {names[-1]} beside it'
    if section == "load":
        if not 3 <= len(names) <= 4 or not names[1].isdecimal():
            return f'"{name}": a load is written load.N.key, such as load.2.Q in the second [[load]] block'
        blocks = base.load_blocks if base else math.inf
        if str(int(names[1])) != names[1] or not 1 <= int(names[1]) <= blocks:
            return f'"{name}": the case has {blocks or "no"} [[load]] blocks, counted from 1'
    elif names[:2] in PROFILES and len(names) > 2:
        fault = part_fault(base.text.root.table if base else {}, names)
        return f'"{name}": {fault}' if base and fault else None
    elif len(names) != 2:
        return f'"{name}": a field is written section.key, such as contact.friction'
    if names[2:3] in LOAD_TABLES and (len(names) == 3 or names[3] not in LOADS):
        return f'"{name}": write one load of {names[2]}, such as load.{names[1]}.{names[2]}.Q'
    if len(names) == 4 and names[2:3] not in LOAD_TABLES:
        return f'"{name}": only mean, amplitude and phase of a block have loads of their own'
    if names[2:3] not in LOAD_TABLES and names[-1] not in KEYS[section]:
        return f'"{name}": there is no key "{names[-1]}" in [{section}]{key_hint(section, names[-1])}'
    return other_units(base.text.root.table, name) if base else None


_FILE = "history.csv"


def with_values(
    tables: dict[str, Any], values: dict[str, Any], materials: Mapping[str, Material] = MATERIALS
) -> dict[str, Any]:
    """Return the tables of a case with other values of some fields. `tables` does not change.

    `materials` are those with a name.
    """
    values = {name: value for name, value in values.items() if name not in FACTORS}
    # Only loads change blocks.
    blocks_change = any(name.startswith("load.") for name in values)
    new = {name: _copied(each) if blocks_change or isinstance(each, dict) else each for name, each in tables.items()}
    for name, value in values.items():
        _make_room(new, name, value, materials)
    for name, value in values.items():
        section, *rest = name.split(".")
        table = new["load"][int(rest.pop(0)) - 1] if section == "load" else new.setdefault(section, {})
        if isinstance(table, dict) and (section, rest[0]) in PROFILES and len(rest) > 1:
            table[rest[0]] = varied(table.get(rest[0]), rest[1:], value)
        elif isinstance(table, dict) and len(rest) == 2:  # for example the amplitude of one load of a block
            inner = table.get(rest[0])
            table[rest[0]] = {**inner, rest[1]: value} if isinstance(inner, dict) else {rest[1]: value}
        elif isinstance(table, dict):
            table[rest[0]] = value
    return new


def reads_files(table: Any) -> bool:
    """Whether the tables of a case name a CSV file, or the file of a plate or of materials, which may change later."""
    if isinstance(table, dict):
        profiles = [table.get(key) for _, key in PROFILES]
        terms = [term for each in profiles for term in (each if isinstance(each, list) else [each])]
        if {"csv", "file", "materials"} & set(table) or any(isinstance(term, str) for term in terms):
            return True
        return any(map(reads_files, table.values()))
    return isinstance(table, list) and any(map(reads_files, table))


def conflict(values: dict[str, Any]) -> tuple[str, str] | None:
    """Return two fields of which one replaces the input that the other changes, or None.

    Only load blocks and a CSV file are checked here. The case reader finds all other conflicts.
    """
    load = next((name for name in values if name.startswith("load.")), None)
    return (load, _FILE) if load and _FILE in values else None


def other_units(tables: dict[str, Any], name: str) -> str | None:
    """Return the fault of a field that would change the units of the base case's loads, or None."""
    contact = tables.get("contact")
    given = contact if isinstance(contact, dict) else {}
    if name == "contact.load_parameter" and ("hole_radius" in given or "clearance" in given):
        return (
            f"{name}: the base case gives a hole radius and a clearance, and loads in N/m; with a load parameter they "
            "would count in units of F. Vary contact.clearance (load parameter times F beta*), or take a base case "
            "with load_parameter and loads in units of F"
        )
    if name == "contact.thickness" and "thickness" not in given:
        return f"{name}: the base case gives loads in N/m; with a thickness they would be in N; give it a thickness"
    if name in ("contact.hole_radius", "contact.clearance") and "load_parameter" in given:
        words = f"{name}: the base case gives a load_parameter, and loads in units of F; vary contact.load_parameter"
        return f"{words}, or take a base case with hole_radius, clearance and loads in N/m"
    return None


def _copied(table: Any) -> Any:
    """Return a copy of a table, or of a list of tables, whose keys can be set."""
    if isinstance(table, list):
        return [dict(item) if isinstance(item, dict) else item for item in table]
    return dict(table) if isinstance(table, dict) else table


def _make_room(tables: dict[str, Any], name: str, value: Any, materials: Mapping[str, Material]) -> None:
    """Remove the inputs that a field replaces from the tables of the base case."""
    section, key = name.split(".")[0], name.split(".")[-1]
    for replaced in {"pin": ("dundurs",), "plate": ("dundurs",), "dundurs": ("pin", "plate")}.get(section, ()):
        tables.pop(replaced, None)
    if name == "solve.method" and value == "path" and isinstance(tables.get("solve"), dict):
        tables["solve"].pop("increments", None)
    if name == _FILE:
        tables.pop("load", None)
    elif section == "load" and isinstance(tables.get("history"), dict):
        tables["history"].pop("csv", None)
    body = tables.get(section)
    if not isinstance(body, dict):
        return
    if section in BODY_KINDS:
        _drop_other_kinds(body, BODY_KINDS[section], key, value)
    for replaced in {"ring_outer_radius": ("reaction",), "reaction": ("ring_outer_radius", "support")}.get(key, ()):
        body.pop(replaced, None)
    if section in ("pin", "plate", "plate_body"):
        make_room(body, key, value, materials, tables.get("units", SI))


def _drop_other_kinds(body: dict[str, Any], kinds: Kinds, key: str, value: Any) -> None:
    """Remove all keys of a body if a varied field makes it a body of another kind.

    The key ``kind`` does so, and the file of a compliance. Any other key replaces the file.
    """
    given = body.get("kind", implied_kind(kinds, body))
    if key == "kind":
        is_replaced = value in list(kinds) and value != given
    else:
        is_replaced = key in keys_of(kinds) and (key == "file") != (given == "compliance")
    if is_replaced:
        for other in set(body) & set(keys_of(kinds)):
            del body[other]


_OWNERS = {"pin": "pin", "plate": "plate", "pin_body": "pin", "plate_body": "plate"}
"""Sections of a case whose keys belong to a body."""

_KEYS = {
    "E": "modulus",
    "nu": "Poisson's ratio",
    **{name: field.words for name, field in FIELDS.items() if field.words},
    "reaction": "distance of the reaction",
    "nodes": "number of nodes",
    "axis": "axis (deg)",
    **{name: f"modulus {name}" for name in ("E1", "E2", "G12")},
    "nu12": "Poisson's ratio nu12",
}
"""Words for keys whose names are no words."""


_OF_BUSHES = {
    "plate_body.friction": "friction coefficient of the seat",
    "plate_body.interference": "interference of the bush",
    "plate_body.E": "modulus of the bush",
    "plate_body.nu": "Poisson's ratio of the bush",
    "plate_body.ring_outer_radius": "outer radius of the lug",
}
"""Words for fields that only a plate with a bush has."""


_PROFILE_WORDS = {
    "ellipse": "oval",
    "lobes": "number of lobes",
    "size": "size of the lobes",
    "axis": "direction (deg)",
    "centre": "place (deg)",
    "half_width": "half width (deg)",
    "start": "start (deg)",
    "stop": "stop (deg)",
}
"""Words for keys of profiles whose names are no words, or that are in degrees."""


def field_words(field: str) -> str:
    """Return words for a field of a case: "modulus of the pin" for "pin.E", "moment M in load 2" for "load.2.M"."""
    if field in FACTORS:
        _, _, load = field.partition(".")
        return f"factor of the {LOAD[load].short}" if load else "factor of all loads"
    if field in _OF_BUSHES:
        return _OF_BUSHES[field]
    section, *between, key = field.split(".")
    if between and section in ("gap", "contact"):
        owner = "friction" if section == "contact" else between[0]
        term = f", term {between[1]}" if len(between) > 1 else ""
        return f"{_PROFILE_WORDS.get(key, key)} of the {owner}{term}"
    if section == "load":
        load = LOAD[key].short if key in LOAD else key.replace("_", " ")
        number, *part = between or [""]  # the part is mean, amplitude or phase of a harmonic block
        words = f"{part[0]} of the {load}" if part else load
        return f"{words} in load {number}" if number else words
    words = _KEYS.get(key, key.replace("_", " "))
    return f"{words} of the {_OWNERS[section]}" if section in _OWNERS else words

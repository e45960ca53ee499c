"""Variation of a case: set fields, ``section.key``, in the tables of a case file.

A case file has several ways to give some inputs. A varied field then replaces the other ways. A named material replaces
moduli, Dundurs' parameters replace two materials, a CSV file replaces load blocks; and the other way round. A kind of
body replaces the keys of other kinds. A factor, ``loads`` or ``loads.P``, multiplies loads after the case is read.
"""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from fastpin.assess.crack import passes_of
from fastpin.casefile.bodies import BODY_KINDS, Kinds, implied_kind, keys_of
from fastpin.casefile.materials import known_materials
from fastpin.casefile.profiles import PROFILES, varied
from fastpin.casefile.reader import SharedParts, case_from
from fastpin.casefile.toml_text import CaseText, TooManyFaultsError
from fastpin.errors import CaseFileError, InputError
from fastpin.model.acting import check_loads
from fastpin.model.case import Case, questions_of
from fastpin.model.checks import number
from fastpin.model.fields import FIELDS
from fastpin.model.growth import law_entries
from fastpin.model.keys import CASE, MATERIAL
from fastpin.model.laminate import LAMINATE_KEYS, MODULI
from fastpin.model.loads import ACTING, LOAD, LOADS
from fastpin.model.materials import MATERIALS, NUMBERS, Material
from fastpin.model.unit_systems import SI, is_system
from fastpin.model.units import in_other_units, in_units_of
from fastpin.states.error_bars import check_nodes

LOAD_TABLES = (("mean",), ("amplitude",), ("phase",))
"""Keys of a [[load]] block that are tables of loads."""

FACTORS = {"loads": LOADS[:ACTING], **{f"loads.{name}": (name,) for name in LOADS[:ACTING]}}
"""Fields that are factors, and the loads that each multiplies. They are no keys of a case."""


class BaseCase:
    """The base case of a plan.

    Attributes
    ----------
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


_ISOTROPIC = ("material", "E", "nu", "rigid", "fatigue", "growth", *NUMBERS)

_REPLACED: dict[str, tuple[str, ...]] = {
    "material": ("E", "nu", "rigid", "fatigue", "growth", *NUMBERS, *LAMINATE_KEYS),
    "E": ("material", "rigid", *LAMINATE_KEYS),
    "nu": ("material", "rigid", *LAMINATE_KEYS),
    "rigid": ("material", "E", "nu", "fatigue", "growth", *NUMBERS, *LAMINATE_KEYS),
    **dict.fromkeys(("layup", "ply"), (*_ISOTROPIC, *MODULI, "compliance")),
    **dict.fromkeys(MODULI, (*_ISOTROPIC, "layup", "ply", "compliance")),
    "compliance": (*_ISOTROPIC, "layup", "ply", *MODULI),
    "ring_outer_radius": ("reaction",),
    "reaction": ("ring_outer_radius", "support"),
}
"""Keys of the base case that each key of the sections of bodies and their materials replaces, in the same section."""

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
    if section not in ("pin", "plate", "plate_body") or (key == "rigid" and value is not True):
        return
    material_name = body.get("material")
    if key in ("E", "nu") and isinstance(material_name, str) and material_name in materials:
        # One constant is varied. The other constants of the material stay.
        material = materials[material_name]
        constants: dict[str, Any] = {"E": material.E, "nu": material.nu, **material.numbers}
        if material.fatigue is not None:
            constants["fatigue"] = material.fatigue.given()
        if material.growth is not None:
            constants["growth"] = law_entries(material.growth)
        system = tables.get("units", SI)
        constants = in_units_of(constants, MATERIAL, system if is_system(system) else SI, None)
        body |= {name: value for name, value in constants.items() if name in ("E", "nu") or name not in body}
    for replaced in _REPLACED.get(key, ()):
        body.pop(replaced, None)


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

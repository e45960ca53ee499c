"""Variation of a joint file: set fields, ``pin.NAME.key``, in its tables; see :mod:`fastpin.studies.variation`."""

from __future__ import annotations

import contextlib
import hashlib
import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.casefile.materials import make_room
from fastpin.casefile.toml_text import CaseText, KeyPath, TooManyFaultsError
from fastpin.errors import CaseFileError, InputError, InputWarning
from fastpin.joints.document import document_of
from fastpin.joints.parts import kind_of_load
from fastpin.joints.read import JOINT_KEYS, JointFile, joint_file_in, kinds_in
from fastpin.joints.solving import load_values
from fastpin.model.checks import number
from fastpin.model.fields import FIELDS
from fastpin.model.keys import ANY, kind_of
from fastpin.model.materials import MATERIALS
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest
from fastpin.model.unit_systems import SI, is_system
from fastpin.model.units import in_other_units, in_units_of, units_of

_WORDS = {"E": "modulus", "nu": "Poisson's ratio", "diameter": "diameter of the hole"}


class BaseJoint:
    """The joint file of a plan.

    Its fields are ``pin.NAME.key`` and ``plate.NAME.key``, with * for every name; ``pin.NAME.clearance.PLATE`` and the
    like for a key that is a table; ``joint.key``; ``load.N.LOAD`` in the N-th [[load]] block; and the factors ``loads``
    and ``loads.LOAD``.

    Attributes
    ----------
    form : str
        The kind of the file.
    name : str
    text : CaseText
        The text in the units of the plan, with a block for each pin.
    is_whole : bool
        Whether forces count for the whole thickness: always.

    Parameters
    ----------
    text, name, folder, units
        See :class:`fastpin.studies.variation.BaseCase`.

    Raises
    ------
    CaseFileError
        With the faults of the TOML text.
    """

    form = "joint file"
    is_whole = True

    def __init__(self, text: str, name: str, folder: Path, units: str = "") -> None:
        self.name, self._folder, source = name, folder, CaseText(text)
        if source.faults:
            raise CaseFileError(name, source.faults)
        tables = source.root.table
        own = tables.get("units", SI)
        if units and units != own and is_system(own):
            tables = in_other_units(tables, kinds_in(source), own, units, True)
        pins: list[dict[str, Any]] = []
        places: list[int] = []
        for place, block in enumerate(_blocks(tables, "pin")):
            names, at = block.get("name"), block.get("at")
            several = isinstance(names, list) and isinstance(at, list) and len(names) == len(at) > 1
            each = zip(names, at, strict=True) if several else [(names, at)]  # type: ignore[arg-type]
            found = [block | {"name": one, "at": there} for one, there in each] if several else [block]
            pins, places = pins + found, places + [place] * len(found)
        blocks = {"pin": places} if isinstance(tables.get("pin"), list) else {}
        self.text = source.with_tables(tables | ({"pin": pins} if blocks else {}), blocks)

    @cached_property
    def file(self) -> JointFile | None:
        """What the file holds; None if it has faults."""
        return self.vary({})[1]

    def names(self, section: str) -> list[Any]:
        """The names of all pins, or of all plates."""
        found = (block.get("name") for block in _blocks(self.text.root.table, section))
        return [name[0] if isinstance(name, list) and len(name) == 1 else name for name in found]

    def is_table(self, names: tuple[str, ...], is_range: bool) -> bool:
        """Whether a table holds fields: it does, unless it is a range."""
        return not is_range

    def fault(self, names: tuple[str, ...]) -> str | None:
        """Return the fault of a field's name, or None."""
        section, *rest = names
        loads = None if self.file is None else self.file.joint.given_names
        if section == "loads":
            load = ".".join(rest)
            fault = f"is no factor; loads multiplies all loads, and loads.{loads[0] if loads else 'NAME.x'} one of them"
            fault = "" if not rest or loads is None or load in loads else fault
        elif section in ("fatigue", "crack", "wear"):
            fault = f"no run of a sweep asks for it: change [{section}] in the joint file"
        elif section not in JOINT_KEYS:
            fault = f"there is no section [{section}] in a joint file"
            fault += closest(section, tuple(JOINT_KEYS)) or "; fields begin with pin, plate, joint, load or loads"
        elif section == "joint":
            fault = "" if len(rest) == 1 and rest[0] in JOINT_KEYS[section] else f"[joint] has {_listed(section)}"
        elif section == "load":
            count, numbered = len(_blocks(self.text.root.table, "load")), rest[:1] and rest[0].isdecimal()
            if not numbered or len(rest) < 2:
                fault = "a load is written load.N.NAME, such as load.2.strap.x in the second [[load]] block"
            elif not 1 <= int(rest[0]) <= count:
                fault = f"the file has {count} [[load]] blocks, counted from 1"
            else:
                known = loads is None or ".".join(rest[1:]) in loads
                fault = "" if known else f"the loads are {', '.join(loads or ())}"
        else:
            fault = self._part_fault(section, rest)
        return f'"{".".join(names)}": {fault}' if fault else None

    def _part_fault(self, section: str, rest: list[str]) -> str:
        """Return the fault of a field of a pin or a plate; empty if there is none."""
        names = self.names(section)
        if len(rest) < 2:
            return f"a field is written {section}.NAME.key, such as {section}.{names[0]}.{JOINT_KEYS[section][-1]}"
        if rest[0] not in ("*", *names):
            return f"there is no {section} {rest[0]}; there are {', '.join(map(str, names))}, and * for all"
        if rest[1] == "name" or rest[1] not in JOINT_KEYS[section]:
            hint = closest(rest[1], JOINT_KEYS[section]) or f"; the keys are {_listed(section)}"
            return f'[[{section}]] has no key "{rest[1]}" to vary{hint}'
        return ""

    def vary(self, values: Mapping[str, Any]) -> tuple[CaseText, JointFile | None]:
        """Return text and content with these values of fields. The content has no meaning if the text has faults."""
        text = self.text.with_tables(self._with(values))
        found = None
        with contextlib.suppress(TooManyFaultsError):
            found = joint_file_in(text, self._folder)
        for name, value in values.items():
            section, _, load = name.partition(".")
            if section == "loads" and found is not None:
                try:
                    by = number(name, value)
                except InputError as error:
                    text.report(error.reason, *name.split("."))
                    continue
                corners = [
                    {one: by * given if load in ("", one) else given for one, given in corner.items()}
                    for corner in found.corners
                ]
                found = found._replace(corners=corners)
        return text, found

    def _with(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the tables with other values. A field of one part stands before one of all parts."""
        new = dict(self.text.root.table)
        new |= {name: [dict(block) for block in _blocks(new, name)] for name in ("pin", "plate", "load") if name in new}
        for name, value in sorted(values.items(), key=lambda item: ".*." not in item[0]):
            section, *rest = name.split(".")
            if section == "joint":
                new["joint"] = {**new.get("joint", {}), rest[0]: value}
            elif section == "load":
                new["load"][int(rest[0]) - 1][".".join(rest[1:])] = value
            elif section in ("pin", "plate"):
                of = [
                    one for one, part in zip(new[section], self.names(section), strict=True) if rest[0] in ("*", part)
                ]
                for block in of:
                    make_room(block, rest[1], value, MATERIALS, new.get("units", SI))
                    block[rest[1]] = _nested(block, rest[1], rest[2:], value)
        return new

    def locate(
        self, places: Mapping[str, KeyPath], values: Mapping[str, Any], place: KeyPath, message: str
    ) -> tuple[KeyPath, str] | None:
        """Return the place of a run's fault in the plan, and its message there; None if it is one of the file."""
        section, *rest = place or ("",)
        if section in ("pin", "plate") and rest:
            part = self.names(str(section))[int(rest[0])]
            starts = [".".join(map(str, (section, name, *rest[1:2]))) for name in (part, "*")]
        else:
            starts = [".".join(str(each + 1) if isinstance(each, int) else each for each in place)]
        for field in (field for start in starts for field in values if f"{field}.".startswith(f"{start}.")):
            reason = message.removeprefix(f"{rest[-1] if rest else section}: ").removeprefix(f"{field}: ")
            return places[field], f"{field}: {reason}"
        return None

    def beside(self, varied: Collection[str] = ()) -> dict[str, Any]:
        """What outcomes are checked against, by name: the content of the file."""
        return {} if self.file is None else {"joint": self.file}

    def nominal(self, case: JointFile, name: str) -> float | None:
        """Return the value of a field in the file; None if it has no number, or several parts have several."""
        section, *keys = name.split(".")
        if section == "loads":
            return 1.0
        tables = self.text.root.table
        if section == "joint":
            found = [tables.get("joint", {}).get(keys[0])]
        elif section == "load":
            found = [tables["load"][int(keys[0]) - 1].get(".".join(keys[1:]))]
        else:
            parts: Sequence[Any] = case.joint.pins if section == "pin" else case.joint.plates
            blocks = zip(_blocks(tables, section), parts, strict=True)
            found = [self._value(*each, keys[1:], self.kind(name)) for each in blocks if keys[0] in ("*", each[1].name)]
        is_number = all(isinstance(value, int | float) and not isinstance(value, bool) for value in found)
        return found[0] if is_number and len({*found}) == 1 and math.isfinite(found[0]) else None

    def _value(self, block: Mapping[str, Any], part: Any, keys: list[str], kind: str) -> Any:
        """The value of a key of a pin or a plate in its block, or else from its material and defaults."""
        value = block.get(keys[0])
        for key in keys[1:]:
            value = value.get(key) if isinstance(value, dict) else value
        if value is None and len(keys) == 1:
            value = getattr(part, keys[0], getattr(part.material, keys[0], None))
            value = in_units_of(value, kind, self.text.root.table.get("units", SI), 1.0)
        return value

    def is_idle(self, case: JointFile, factor: str) -> bool:
        """Whether a factor would change nothing."""
        load = factor.partition(".")[2]
        return not any(value for corner in case.corners for name, value in corner.items() if load in ("", name))

    @staticmethod
    def usual(case: JointFile, swing: bool) -> dict[str, Any]:
        """Return the tables of the outcomes of a plan without any, by name; of numbers with a `swing` if asked for."""
        pins = [pin.name for pin in case.joint.pins]
        found: dict[str, Any] = {
            f"share_{name if name.isascii() and name.isidentifier() else place}": {"joint": "share", "pin": name}
            for place, name in enumerate(pins, start=1)
        }
        found = {} if len({name.lower() for name in found}) < len(pins) else found
        asked = ["hoop", "hoop_at", "slip", "margin", *(["life"] if case.fatigue is not None else [])]
        return found | {name: {"joint": name} for name in asked if not (swing and name == "hoop_at")}

    @staticmethod
    def doubts(case: JointFile) -> list[InputWarning]:
        """Return what is probably a mistake: nothing is looked for."""
        return []

    @staticmethod
    def identity(case: JointFile, strengths: bool) -> dict[str, Any]:
        """Return the complete input of a run, without names of materials and units of texts."""
        joint, loads = _unnamed(document_of(case.joint)), load_values(case.joint, case.corners) + 0.0  # -0 becomes 0
        del joint["unit_system"]
        digest = hashlib.sha256(np.ascontiguousarray(loads, dtype="<f8").tobytes()).hexdigest()
        history = {"corners": len(loads), "names": list(case.joint.load_names), "sha256": digest}
        solver = {"nodes": case.nodes, "harmonics": case.harmonics}
        return {"joint": joint, "dimensionless": False, "loads": history, "solve": solver}

    @staticmethod
    def problem(case: JointFile) -> Problem:
        """Return a problem whose units the outputs have: its thickness is 1 m, for forces are those of whole plates."""
        joint = case.joint
        pair = joint.problem(*joint.sections[0]).pair
        return Problem(pair, joint.radius, 0.0, 0.0, thickness=1.0, unit_system=joint.unit_system)

    @staticmethod
    def drawn(case: JointFile) -> None:
        """Return the problem that stands below figures: none."""

    @staticmethod
    def unit_names(case: JointFile) -> dict[str, str]:
        """Return the unit of every kind of quantity in the index, and in Python: forces are those of whole plates."""
        return {kind: unit.name for kind, unit in units_of(SI, True).items()}

    @staticmethod
    def kind(field: str) -> str:
        """Return the kind of a field; empty if it has no unit."""
        section, _, *rest = field.split(".")
        if section == "load":
            return kind_of_load(rest[-1])
        kinds: Any = kinds_in(CaseText("")).get(section, {})
        for key in rest:
            kinds = kinds.get(key, kinds.get(ANY, "")) if isinstance(kinds, Mapping) else ""
        return kind_of("value", {"value": kinds})

    @staticmethod
    def words(field: str) -> str:
        """Return words for a field, such as "clearance of A in skin"."""
        section, *rest = field.split(".")
        if section == "loads":
            return f"factor of {'.'.join(rest)}" if rest else "factor of all loads"
        if section == "load":
            return f"{'.'.join(rest[1:])} in load {rest[0]}"
        if section == "joint":
            return rest[0]
        key, *inner = rest[1:]
        known = FIELDS[key].words if key in FIELDS else ""
        words = _WORDS.get(key) or known or key.replace("_", " ")
        words = f"{words} {' '.join(inner)}" if inner and key in ("clamp", "bush") else words
        of = f"all {section}s" if rest[0] == "*" else rest[0]
        return f"{words} of {of}" + (f" in {inner[0]}" if inner and key in ("clearance", "friction", "gap") else "")


def _unnamed(value: Any) -> Any:
    """Tables without names of materials and sources of constants."""
    if isinstance(value, list):
        return [_unnamed(each) for each in value]
    if not isinstance(value, dict):
        return value
    left_out = {"name", "source"} if "nu" in value else {"source"}
    return {name: _unnamed(each) for name, each in value.items() if name not in left_out}


def _blocks(tables: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """The tables of the [[name]] blocks."""
    value = tables.get(name)
    blocks = value if isinstance(value, list) else [value]
    return [block for block in blocks if isinstance(block, dict)]


def _nested(block: Mapping[str, Any], key: str, inner: list[str], value: Any) -> Any:
    """The new value of a key of a block, or of a key in its table. One number for all plates becomes one for each."""
    if not inner:
        return value
    known = block.get(key)
    if not isinstance(known, dict):
        plates = block.get("plates")
        through = plates if isinstance(plates, list) else [plates]
        known = dict.fromkeys(through, known or 0.0) if key in ("clearance", "friction") else {}
    return known | {inner[0]: _nested(known, inner[0], inner[1:], value)}


def _listed(section: str) -> str:
    return ", ".join(key for key in JOINT_KEYS[section] if key != "name")

"""A joint as a document that goes to JSON exactly, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from fastpin.bodies import Bushing
from fastpin.joints.parts import Joint, JointPlate
from fastpin.joints.pins import BEAM, Clamp, JointPin
from fastpin.lugs.outline import Hole, Part, PartLoad
from fastpin.model.fatigue import FatigueConstants
from fastpin.model.growth import law_entries, law_from
from fastpin.model.materials import Material
from fastpin.model.profile import InitialGap, Profile
from fastpin.model.profile_terms import TERMS


def document_of(value: Any) -> Any:
    """Return a joint, or a part of it, as JSON-ready tables. A point is a list of two numbers."""
    if isinstance(value, Material):
        table = {"E": value.E, "nu": value.nu, "name": value.name, **value.numbers}
        table |= {} if value.fatigue is None else {"fatigue": value.fatigue.given()}
        return table | ({} if value.growth is None else {"growth": law_entries(value.growth)})
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, Mapping):
        return {name: document_of(each) for name, each in value.items()}
    if isinstance(value, tuple):
        return [document_of(each) for each in value]
    if isinstance(value, InitialGap):
        return {name: profile.entries() for name, profile in value.given.items()}
    if not is_dataclass(value):
        return value
    found = {one.name: document_of(getattr(value, one.name)) for one in fields(value)}
    found.pop("inside", None)  # all bushes have the plate outside
    usual: dict[str, tuple[Any, ...]] = {"bush": (None, {}), "gap": ({},), "bore_radius": (0.0,), "drive": ("force",)}
    for name, values in usual.items():  # joints without them stay as they were
        if name in found and found[name] in values:
            del found[name]
    return found


def joint_from(document: Mapping[str, Any]) -> Joint:
    """Return the joint of such tables.

    Raises
    ------
    InputError, KeyError, TypeError, ValueError
        If an entry is missing, unknown or wrong: the tables come from a file, whose reader names it.
    """
    plates = [
        JointPlate(
            **{
                **each,
                "material": _material(each["material"]),
                "outline": [_placed(Part, part) for part in each["outline"]],
                "holes": [_placed(Hole, hole) for hole in each["holes"]],
                "loads": [PartLoad(**load) for load in each["loads"]],
            }
        )
        for each in document["plates"]
    ]
    pins = [
        _placed(
            JointPin,
            {
                **each,
                "material": _material(each["material"]),
                "clamp": None if each["clamp"] is None else Clamp(**each["clamp"]),
                "heads": each["heads"] if each["flexibility"] == BEAM else None,  # older files have 0 there
                "bush": _bushes(each.get("bush")),
                "gap": _gaps(each.get("gap", {})),
            },
        )
        for each in document["pins"]
    ]
    return Joint(**{**document, "plates": plates, "pins": pins})


def _bushes(table: Mapping[str, Any] | None) -> Bushing | dict[str, Bushing] | None:
    """The bush of all plates, or of each plate."""
    if table is None:
        return None
    if isinstance(table.get("outer_radius", {}), float):
        return Bushing(**{**table, "material": _material(table["material"])})
    return {name: _bushes(each) for name, each in table.items()}  # type: ignore[misc]


def _gaps(table: Mapping[str, Any]) -> dict[str, InitialGap]:
    """The initial gaps by plate."""
    found = {}
    for plate, profiles in table.items():
        terms = {
            name: [TERMS[each["kind"]](**{key: value for key, value in each.items() if key != "kind"}) for each in of]
            for name, of in profiles.items()
        }
        found[plate] = InitialGap(**{name: Profile(tuple(of)) for name, of in terms.items()})
    return found


def _placed(kind: Any, table: Mapping[str, Any]) -> Any:
    """An object whose points are lists of two numbers in its table."""
    points = {name: complex(*table[name]) for name in ("at", "centre", "start", "end", "through") if table.get(name)}
    return kind(**{**table, **points})


def _material(table: Mapping[str, Any]) -> Material:
    more: dict[str, Any] = {"fatigue": FatigueConstants(**table["fatigue"])} if "fatigue" in table else {}
    more |= {"growth": law_from(table["growth"])} if "growth" in table else {}
    return Material(**{**table, **more})

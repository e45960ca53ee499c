"""The problem in an HDF5 file: its entries, and those of its materials, bodies and profiles.

A solid pin and an infinite plate are left out, so a file without bodies is as it was before there were any. A
compliance is stored whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from fastpin.bodies.body import BodyBase
from fastpin.bodies.kinds import KINDS
from fastpin.model import FatigueConstants, checks
from fastpin.model.fields import FIELDS
from fastpin.model.growth import law_entries, law_from
from fastpin.model.laminate import Laminate, laminate_from
from fastpin.model.materials import NUMBERS, Material
from fastpin.model.ply import PLY_KEYS
from fastpin.model.profile import MOST_TERMS, InitialGap, Profile
from fastpin.model.profile_terms import MOST_SAMPLES, TERMS, Term
from fastpin.storage.hdf5 import as_python, dataset_of, text_of

LAMINATE = "laminate"
"""Group of a material that is a laminate: its axis, and its compliances or its plies."""


def write_entries(group: h5py.Group, entries: Mapping[str, Any]) -> None:
    """Write the entries of a problem, a body, a material or a profile into their group.

    A table is a group, and a list of tables is a group of groups with their places for names. Other lists are arrays,
    all else is an attribute. What is None is left out.
    """
    for key, value in entries.items():
        if isinstance(value, Material):
            value = _of_material(value)
        elif isinstance(value, list) and all(isinstance(each, Mapping) for each in value):
            value = {str(place): each for place, each in enumerate(value)}
        if isinstance(value, Mapping):
            write_entries(group.create_group(key), value)
        elif isinstance(value, bytes):  # an attribute has too little room
            group[key] = np.frombuffer(value, dtype=np.int8)
        elif isinstance(value, list | np.ndarray):
            group[key] = np.array(value)
        elif value is not None:
            group.attrs[key] = value


def _of_material(material: Material) -> dict[str, Any]:
    """Return the entries of a material. A laminate also has its plies or its compliances."""
    return {
        "E": material.E,
        "nu": material.nu,
        "name": material.name,
        **material.numbers,
        LAMINATE: None if material.is_isotropic else material.entries(),
        "fatigue": None if material.fatigue is None else material.fatigue.given(),
        "growth": None if material.growth is None else law_entries(material.growth),
    }


def read_material(group: h5py.Group) -> Material:
    """Read a material from its group."""
    if LAMINATE in group:
        return _read_laminate(group[LAMINATE])
    attributes = group.attrs
    fatigue = FatigueConstants(**_attributes(group["fatigue"])) if "fatigue" in group else None
    growth = law_from(_attributes(group["growth"])) if "growth" in group else None
    numbers = {name: float(attributes[name]) for name in NUMBERS if name in attributes}
    elastic = float(attributes["E"]), float(attributes["nu"])
    return Material(*elastic, text_of(attributes["name"]), fatigue, **numbers, growth=growth)


def _attributes(group: h5py.Group) -> dict[str, Any]:
    """Return the attributes of a group by name."""
    return {str(name): as_python(value) for name, value in group.attrs.items()}


def _read_laminate(group: h5py.Group) -> Laminate:
    """Read a laminate from its group. Names that later versions may add are skipped."""
    given: dict[str, Any] = {name: as_python(group.attrs[name]) for name in ("axis", "name")}
    if "plies" not in group:
        return laminate_from(**given, compliance=dataset_of(group, "compliance", float)[()].tolist())
    tables = [group["plies"][str(place)].attrs for place in range(len(group["plies"]))]
    plies = [{key: as_python(table[key]) for key in PLY_KEYS if key in table} for table in tables]
    arrays = {name: dataset_of(group, name, kind)[()].tolist() for name, kind in (("angles", float), ("which", int))}
    return laminate_from(**given, plies=plies, **arrays)


def read_bodies(group: h5py.Group) -> dict[str, Any]:
    """Read the bodies of a problem: the arguments ``pin_body`` and ``plate_body`` that its group holds.

    Raises
    ------
    ValueError
        If a body has an unknown kind, or an array of a compliance is missing or of another type.
    InputError
        If a number is out of range.
    """
    return {name: _read_body(group[name]) for name in ("pin_body", "plate_body") if name in group}


def _read_body(group: h5py.Group) -> BodyBase:
    kind = group.attrs.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"the kind {checks.as_toml(kind)} of {group.name[1:]} is unknown")
    given: dict[str, Any] = {
        name: value.tolist() if isinstance(value, np.ndarray) else as_python(value)
        for name, value in group.attrs.items()
        if name != "kind"
    }
    for name in KINDS[kind].arrays:
        given[name] = dataset_of(group, name, float)[()]
    for name in KINDS[kind].named_arrays:
        given[name] = {each: dataset_of(group[name], each, float)[()] for each in group[name]}
    for name in KINDS[kind].texts:
        if name in group:
            given[name] = dataset_of(group, name, np.int8)[()].tobytes().decode(errors="replace")
    if "material" in group:
        given["material"] = read_material(group["material"])
    if "inside" in group:
        given["inside"] = _read_body(group["inside"])
    return KINDS[kind].from_entries(given)


def read_profiles(group: h5py.Group) -> dict[str, Any]:
    """Read the profiles of a problem: those of its fields that are profiles, by name.

    Raises
    ------
    ValueError
        If a term has an unknown kind, an array is missing or of another type, or there are too many.
    InputError
        If a value is out of range.
    """
    found: dict[str, Any] = {}
    for name, field in FIELDS.items():
        if name in group and field.is_profile:
            found[name] = _read(group[name])
        elif name in group and field.place == "section":
            found[name] = InitialGap(**{key: _read(group[name][key]) for key in ("hole", "pin") if key in group[name]})
    return found


def _read(group: h5py.Group) -> Profile:
    if len(group) > MOST_TERMS:
        raise ValueError(f"{group.name[1:]} has {len(group)} terms, more than {MOST_TERMS}")
    return Profile(tuple(_term(group[str(number)]) for number in range(len(group))))


def _term(group: h5py.Group) -> Term:
    term = _attributes(group)
    kind = term.pop("kind", None)
    if kind not in TERMS:
        raise ValueError(f"the kind {checks.as_toml(kind)} of a profile is unknown")
    for name in group:
        array = dataset_of(group, name, float)
        if array.ndim != 1 or array.shape[0] > MOST_SAMPLES:
            raise ValueError(f"{group.name[1:]}/{name} is no row of at most {MOST_SAMPLES:,} numbers")
        term[name] = array[()]
    return TERMS[kind](**term)

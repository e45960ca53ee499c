"""The profiles of a problem in an HDF5 file: a group for each profile, and in it a numbered group for each term."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import h5py
import numpy as np

from fastpin.model.checks import as_toml
from fastpin.model.fields import FIELDS
from fastpin.model.profile import MOST_TERMS, InitialGap, Profile
from fastpin.model.profile_terms import MOST_SAMPLES, TERMS, Term
from fastpin.storage.damage import as_python, dataset_of

Entries = Sequence[Mapping[str, Any]]
"""The terms of a profile, see :meth:`Profile.entries`."""


def write_profiles(parent: h5py.Group, name: str, entries: Entries | Mapping[str, Entries]) -> None:
    """Write the entries of a profile, or of several profiles by name, into a new group."""
    group = parent.create_group(name)
    if isinstance(entries, Mapping):
        for key, profile in entries.items():
            write_profiles(group, key, profile)
        return
    for number, term in enumerate(entries):
        inner = group.create_group(str(number))
        for key, value in term.items():
            if isinstance(value, tuple):
                inner[key] = np.array(value)
            else:
                inner.attrs[key] = value


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
        elif name in group and field.has_section:
            found[name] = InitialGap(**{key: _read(group[name][key]) for key in ("hole", "pin") if key in group[name]})
    return found


def _read(group: h5py.Group) -> Profile:
    if len(group) > MOST_TERMS:
        raise ValueError(f"{group.name[1:]} has {len(group)} terms, more than {MOST_TERMS}")
    return Profile(tuple(_term(group[str(number)]) for number in range(len(group))))


def _term(group: h5py.Group) -> Term:
    term = {name: as_python(value) for name, value in group.attrs.items()}
    kind = term.pop("kind", None)
    if kind not in TERMS:
        raise ValueError(f"the kind {as_toml(kind)} of a profile is unknown")
    for name in group:
        array = dataset_of(group, name, float)
        if array.ndim != 1 or array.shape[0] > MOST_SAMPLES:
            raise ValueError(f"{group.name[1:]}/{name} is no row of at most {MOST_SAMPLES:,} numbers")
        term[name] = array[()]
    return TERMS[kind](**term)

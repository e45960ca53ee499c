"""The profiles along the rim in a case file: ``friction`` in [contact], ``hole`` and ``pin`` in [gap].

A profile is a number, the name of a CSV file, a table for a term or a file, or a list of these, which are added. Tables
may have a filter. Angles are in degrees from the bottom of the hole, counter-clockwise.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fastpin.casefile.toml_text import Section, field_defaults
from fastpin.errors import CaseFileError, InputError
from fastpin.model.angles import DEGREE, angle_at, meant_degrees
from fastpin.model.checks import any_text, as_toml, number, unknown_key, whole_number
from fastpin.model.problem import checked_gap
from fastpin.model.profile import MOST_TERMS, NO_GAP, InitialGap, Profile, ProfileKind
from fastpin.model.profile_terms import MOST_ORDER, Crown, Flat, Harmonic, Zone
from fastpin.model.synonyms import closest
from fastpin.model.wear import COEFFICIENTS, MOST_CYCLES, WEAR_KEYS, Wear
from fastpin.tables.files import COLUMNS, read_samples
from fastpin.tables.load_units import Basis

GAP_KEYS = ("hole", "pin")
"""Keys of the section [gap]."""

PROFILES = (("contact", "friction"), ("gap", "hole"), ("gap", "pin"))
"""Section and key of each profile."""


class Word(NamedTuple):
    """A kind of term in a case file.

    Attributes
    ----------
    keys : tuple of str
        The keys of its table. The first one names the kind.
    optional : dict of str to float
        The keys that may be left out, and their values then.
    make : callable
        Makes the profile of the values of the keys, in their order.
    """

    keys: tuple[str, ...]
    optional: Mapping[str, float]
    make: Callable[..., Profile]


def checked_angle(field: str, value: object) -> float:
    """Check an angle in degrees from the bottom of the hole, and return it in rad from +x."""
    return float(angle_at(_degrees(field, value)))


def _degrees(field: str, value: object) -> float:
    """Check an angle in degrees."""
    degrees = number(field, value, -360.0, 360.0)
    meant = meant_degrees(degrees)
    if meant:
        words = f"{degrees:g} is {meant} degrees in rad"
        raise InputError(field, f"must be in degrees from the bottom of the hole; {words}")
    return degrees


def _lobes(count: object, size: object, axis: float) -> Profile:
    """A rim with lobes, exact for an axis in whole quarters of a turn."""
    order, amplitude = whole_number("lobes", count, 1, MOST_ORDER), number("size", size)
    turn = math.remainder(order * axis, 360.0)
    cos, sin = math.cos(turn * DEGREE), math.sin(turn * DEGREE)
    if turn % 90.0 == 0.0:
        cos, sin = round(cos), round(sin)
    return Profile((Harmonic.from_bottom(order, amplitude * cos, amplitude * sin),))


def _harmonic(order: object, cosine: object, sine: object) -> Profile:
    count = whole_number("order", order, 0, MOST_ORDER)
    return Profile((Harmonic.from_bottom(count, number("cosine", cosine), number("sine", sine)),))


def _samples(angles: object, values: object) -> Profile:
    if not isinstance(angles, list):
        raise InputError("angles", f"must be a list of angles, not {as_toml(angles)}")
    # Samples in rad do not go round the hole and are refused. One of many angles may look like rad.
    degrees = [number("angles", angle, -360.0, 360.0) for angle in angles]
    return Profile.samples([angle_at(angle) for angle in degrees], values)  # type: ignore[arg-type]


WORDS = {
    "constant": Word(("constant",), {}, lambda value: Profile.constant(value)),
    "ellipse": Word(
        ("ellipse", "axis"),
        {"axis": 0.0},
        lambda size, axis: _lobes(2, number("ellipse", size), _degrees("axis", axis)),
    ),
    "lobes": Word(
        ("lobes", "size", "axis"), {"axis": 0.0}, lambda count, size, axis: _lobes(count, size, _degrees("axis", axis))
    ),
    "harmonic": Word(("harmonic", "cosine", "sine"), {"cosine": 0.0, "sine": 0.0}, _harmonic),
    "flat": Word(("flat", "centre"), {}, lambda depth, at: Profile((Flat(depth, checked_angle("centre", at)),))),
    "crown": Word(
        ("crown", "centre", "half_width"),
        {},
        lambda height, at, wide: Profile(
            (Crown(height, checked_angle("centre", at), DEGREE * _degrees("half_width", wide)),)
        ),
    ),
    "zone": Word(
        ("zone", "start", "stop"),
        {},
        lambda value, start, stop: Profile((Zone(value, checked_angle("start", start), checked_angle("stop", stop)),)),
    ),
    "angles": Word(("angles", "values"), {}, _samples),
}
"""The kinds of terms by their first keys."""

FILE, SKIP, FILTER = "file", "skip", "harmonics"
"""Keys of the table of a CSV file, and of the filter that any table may have."""

FILE_KEYS = (FILE, *COLUMNS, SKIP)
"""Keys of the table of a CSV file."""

WORD_KEYS = (*dict.fromkeys(key for word in WORDS.values() for key in word.keys), FILE, SKIP, FILTER)
"""All keys of the tables of terms."""


class _Reader:
    """Reads the profiles of a section, and reports their faults to it."""

    def __init__(self, section: Section, folder: Path, quantity: ProfileKind, dimensionless: bool = False) -> None:
        self._section, self._folder, self._quantity = section, folder, quantity
        self._basis = Basis("dimensionless" if dimensionless else "per metre", section.units)

    def profile(self, key: str) -> Profile | None:
        """The profile of a key; None if it is missing or wrong (reported)."""
        value = self._section.value(key)
        if value is None:
            return None
        values = value if isinstance(value, list) else [value]
        if len(values) > MOST_TERMS:
            self._section.report(f"{key}: must have at most {MOST_TERMS} terms, not {len(values)}", key)
            return None
        if not any(isinstance(each, dict) or _is_file(each) for each in values):
            same = self._section.number(key)
            return None if same is None else Profile.constant(same)
        names = [key] if not isinstance(value, list) else [f"{key}.{place}" for place in range(1, len(values) + 1)]
        parts = [self._term(key, name, each) for name, each in zip(names, values, strict=True)]
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        return Profile(tuple(term for part in known for term in part.terms))

    def _term(self, key: str, name: str, value: Any) -> Profile | None:
        """The profile of a number, a file or a table that is called `name` in messages; None if wrong (reported)."""
        try:
            if _is_file(value):
                return self._from_csv(key, name, {FILE: value})
            if isinstance(value, dict):
                return self._from_table(key, name, value)
            return Profile.of(name, number(name, value))
        except InputError as error:
            self._section.report(str(error), key)
            return None

    def _from_table(self, key: str, name: str, table: Mapping[str, Any]) -> Profile | None:
        """The profile of a table: of a term, or of a file; perhaps filtered."""
        plain = {word: value for word, value in table.items() if word != FILTER}
        is_file = FILE in plain and set(plain) <= set(FILE_KEYS)
        found = self._from_csv(key, name, plain) if is_file else _from_table(name, plain)
        if found is None or FILTER not in table:
            return found
        try:
            return found.filtered(table[FILTER])
        except InputError as error:
            raise InputError(f"{name}.{FILTER}", error.reason) from None

    def _from_csv(self, key: str, name: str, table: Mapping[str, Any]) -> Profile | None:
        """The profile of a table with a file."""
        field = f"{name}.{FILE}" if isinstance(self._section.value(key), dict) else name
        file = any_text(field, table[FILE])
        columns = {word: table[word] for word in COLUMNS if word in table}
        try:
            place = self._folder / file
            angles, values = read_samples(place, self._quantity, self._basis, columns, table.get(SKIP, 0))
        except CaseFileError as error:
            for line, sentence in error.problems:
                self._section.report(f"{field}: {file}{f', line {line}' if line else ''}: {sentence}", key)
            return None
        except InputError as error:
            raise InputError(f"{name}.{error.field}", error.reason) from None
        try:
            return Profile.samples(angles, values)
        except InputError as error:
            raise InputError(field, f"{file}: {error.field} {error.reason}") from None


def _from_table(name: str, table: Mapping[str, Any]) -> Profile:
    """The profile of a table. An :class:`InputError` names the key that is wrong."""
    kinds = [word for word in table if word in WORDS]
    if not kinds:
        hint = next((found for word in table if (found := closest(str(word), tuple(WORDS)))), "")
        given = f", not {', '.join(map(str, table))}" if table else ""
        raise InputError(name, f"must be a table with one of {', '.join((*WORDS, FILE))}{given}{hint}")
    if len(kinds) > 1:
        raise InputError(name, f"{kinds[1]} can't be given together with {kinds[0]}; write a list of tables")
    keys, optional, make = WORDS[kinds[0]]
    for key in table:
        if key not in keys:
            raise InputError(name, unknown_key(key, keys, f" beside {kinds[0]}"))
    values = {key: table.get(key, optional.get(key)) for key in keys}
    for key, value in values.items():
        if value is None:
            raise InputError(name, f"{key} is missing beside {kinds[0]}")
    try:
        return make(*values.values())
    except InputError as error:
        is_kind = error.field in ("depth", "height", "value", "order")  # their key is the name of the kind
        field = kinds[0] if is_kind else error.field
        raise InputError(f"{name}.{field}", error.reason) from None


def _is_file(value: object) -> bool:
    """Whether a value is the name of a CSV file: a text with an ending that is no number."""
    return isinstance(value, str) and bool(re.search(r"\.\s*[A-Za-z]\w*$", value))


def read_friction(contact: Section, folder: Path) -> float | Profile | None:
    """The coefficient of friction of [contact]; None if it is missing or wrong (reported)."""
    if isinstance(contact.value("friction"), (dict, list, str)):
        return _Reader(contact, folder, "friction").profile("friction")
    return contact.number("friction")


def read_wear(section: Section, folder: Path, default: Mapping[str, Any]) -> Wear | None:
    """How the bodies wear; None if a key is wrong (reported). `default`: values of keys that the section leaves out.

    A coefficient of the section replaces all default ones.
    """
    reader = _Reader(section, folder, "wear")
    profiles = {key: reader.profile(key) for key in COEFFICIENTS if key in section}
    values = {key: value for key, value in default.items() if not (profiles and key in COEFFICIENTS)}
    values |= {key: section.value(key) for key in WEAR_KEYS if key in section}
    values |= {key: Profile.constant(1.0) if profile is None else profile for key, profile in profiles.items()}
    harmless = field_defaults(Wear) | dict.fromkeys(COEFFICIENTS, 1.0) | {"cycles": MOST_CYCLES}
    wear = section.build(Wear, values, harmless)
    return None if None in profiles.values() else wear


def read_gap(section: Section, folder: Path, radius: float | None, dimensionless: bool) -> InitialGap:
    """The initial gap of [gap]. Without a fault-free gap it is none, and the faults are reported.

    `radius` is that of the hole. None if it is unknown; the size of the gap is then not checked.
    """
    reader = _Reader(section, folder, "gap", dimensionless)
    if section.present and not section.table:
        section.report("[gap]: gives no profile; the keys are hole and pin")
    found = {}
    for key in GAP_KEYS:
        profile = reader.profile(key)
        if profile is None:
            continue
        try:
            gap = InitialGap(**{key: profile})
            found[key] = getattr(gap if radius is None else checked_gap(gap, radius, dimensionless), key)
        except InputError as error:
            section.report(f"{key}: {error.reason}", key)
    return InitialGap(**found) if any(profile.terms for profile in found.values()) else NO_GAP


def varied(profile: Any, parts: Sequence[str], value: Any) -> Any:
    """A profile of a case file with another value of a key: `parts` are the key, or the number of a term and the key.

    A term of another kind gives way. Without a number the profile is one term.
    """
    if len(parts) == 2:
        terms, place = list(profile), int(parts[0]) - 1
        terms[place] = varied(terms[place], parts[1:], value)
        return terms
    (key,) = parts
    is_other = not isinstance(profile, dict) or (key in WORDS and key not in profile)
    return {**({} if is_other else profile), key: value}


def part_fault(tables: Mapping[str, Any], names: Sequence[str]) -> str:
    """Why the field `names` of a sweep is no part of a profile in the tables of a case; empty if it is one."""
    words, section = names[2:], tables.get(names[0])
    profile = section.get(names[1]) if isinstance(section, dict) else None
    count = len(profile) if isinstance(profile, list) else 0
    if len(words) == 2 and words[0] not in map(str, range(1, count + 1)):
        return f"the {names[1]} of the case has {count or 'no'} terms in a list, counted from 1"
    if len(words) == 1 and count:
        example = f"{names[0]}.{names[1]}.1.axis"
        return f"the {names[1]} of the case is a list; write the number of the term, such as {example}"
    if len(words) > 2 or words[-1] not in WORD_KEYS:
        hint = closest(words[-1], WORD_KEYS) or f"; the keys are {', '.join(WORD_KEYS)}"
        return f'there is no key "{words[-1]}" in a profile{hint}'
    return ""

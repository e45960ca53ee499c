"""The sections of a case beside its problem: what is asked of the states, and changes none of them.

A line of :data:`BESIDE` is such a section. Cases, stored results and plans then know it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fastpin.errors import InputError
from fastpin.model.assessment import ASSESSMENT_KEYS, FatigueAssessment
from fastpin.model.checks import as_toml, choice, instance
from fastpin.model.crack import CRACK_KEYS, CrackGrowth, check_crack, crack_from
from fastpin.model.problem import Problem
from fastpin.model.strength import STRENGTH_KEYS, StrengthAssessment, check_strength


class Beside(NamedTuple):
    """A section of a case beside its problem.

    Attributes
    ----------
    kind : type
        The class of its values.
    words : str
        This class in messages.
    stored : callable
        Entries of a value, JSON-ready, for files.
    read : callable
        The value of such entries.
    written : callable
        Entries of a value in a case file. No entries leave the section out.
    check : callable or None
        Called with the problem and a value. It raises :class:`InputError` if both do not fit. None for the fatigue: it
        is checked with the history, by the reader of case files and by the assessment itself.
    keys : tuple of str
        All keys of the entries.
    """

    kind: type
    words: str
    stored: Callable[[Any], dict[str, Any]]
    read: Callable[..., Any]
    written: Callable[[Any], dict[str, Any]]
    check: Callable[[Problem, Any], None] | None
    keys: tuple[str, ...]


BESIDE = {
    "fatigue": Beside(
        FatigueAssessment, "a FatigueAssessment", FatigueAssessment.stored, FatigueAssessment,
        FatigueAssessment.written, None, ASSESSMENT_KEYS,
    ),
    "crack": Beside(
        CrackGrowth, "a fastpin.model.CrackGrowth", CrackGrowth.entries, crack_from, CrackGrowth.entries, check_crack,
        CRACK_KEYS,
    ),
    "strength": Beside(
        StrengthAssessment, "a fastpin.model.StrengthAssessment", StrengthAssessment.entries, StrengthAssessment,
        StrengthAssessment.entries, check_strength, STRENGTH_KEYS,
    ),
}  # fmt: skip
"""The sections by their names in case files, which are fields of :class:`fastpin.model.Case`."""


def beside_of(case: Any) -> dict[str, Any]:
    """The values of the sections of a case that has them, by name."""
    return {name: value for name in BESIDE if (value := getattr(case, name)) is not None}


def checked_beside(problem: Problem, given: Mapping[str, Any]) -> dict[str, Any]:
    """Check the sections of a run, and return the ones that are not None."""
    if not isinstance(given, Mapping):
        raise InputError("sections", f"must map names of sections to their values, not {as_toml(given)}")
    for name in given:
        choice("sections", name, tuple(BESIDE))
    found = {name: value for name, value in given.items() if value is not None}
    for name, value in found.items():
        instance(name, value, BESIDE[name].kind, BESIDE[name].words)
        if (check := BESIDE[name].check) is not None:
            check(problem, value)
    return found


def stored_text(name: str, value: Any) -> str:
    """The text of a section in a file, JSON."""
    return json.dumps(BESIDE[name].stored(value))


def read_text(name: str, text: str) -> Any:
    """The value of the section in such a text; None if it is empty.

    Raises
    ------
    ValueError
        If the text can't be read.
    """
    if not text:
        return None
    entries = json.loads(text)
    if not isinstance(entries, dict) or not set(entries) <= set(BESIDE[name].keys):
        raise ValueError(f"the {name} of its case can't be read")
    return BESIDE[name].read(**entries)

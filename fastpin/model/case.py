"""A case: problem, load history, options, title and origin, and the sections beside the problem.

A line of :data:`BESIDE` is a section that asks something of the states, and changes none of them. Cases, stored results
and plans then know it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, NamedTuple

from fastpin.errors import InputError
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.checks import as_toml, check_fields, choice, instance, string
from fastpin.model.crack import CrackGrowth, check_crack, crack_from
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.points import owner_of
from fastpin.model.problem import Problem
from fastpin.model.strength import StrengthAssessment, check_strength
from fastpin.model.wear import Wear


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
    """

    kind: type
    words: str
    stored: Callable[[Any], dict[str, Any]]
    read: Callable[..., Any]
    written: Callable[[Any], dict[str, Any]]
    check: Callable[[Problem, Any], None] | None

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys of the entries: the fields of the class."""
        return tuple(each.name for each in fields(self.kind))


BESIDE = {
    "fatigue": Beside(
        FatigueAssessment, "a FatigueAssessment", FatigueAssessment.stored, FatigueAssessment,
        FatigueAssessment.written, None,
    ),
    "crack": Beside(
        CrackGrowth, "a fastpin.model.CrackGrowth", CrackGrowth.entries, crack_from, CrackGrowth.entries, check_crack,
    ),
    "strength": Beside(
        StrengthAssessment, "a fastpin.model.StrengthAssessment", StrengthAssessment.entries, StrengthAssessment,
        StrengthAssessment.entries, check_strength,
    ),
}  # fmt: skip
"""The sections by their names in case files, which are fields of :class:`fastpin.model.Case`."""


def beside_of(case: Any) -> dict[str, Any]:
    """The values of the sections of a case that has them, by name."""
    return {name: value for name in BESIDE if (value := getattr(case, name)) is not None}


def questions_of(case: Any) -> dict[str, Any]:
    """The sections of a case as they are answered, by name.

    A crack at the plate's hole without a residual stress of its own takes that of the fatigue: both have one hole.
    """
    found = beside_of(case)
    crack, fatigue = found.get("crack"), found.get("fatigue")
    if crack is None or fatigue is None or crack.residual_stress is not None:
        return found
    if crack.place is None and owner_of(case.problem, crack.body) == "plate":
        found["crack"] = replace(crack, residual_stress=fatigue.residual_stress)
    return found


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


@dataclass(frozen=True)
class About:
    """Who made a case, and for what: a report names them on its first page and in the head of each page.

    Attributes
    ----------
    project : str
        Name or number of the project; empty if there is none, as the others.
    author : str
        Who answers for the case.
    revision : str
        Revision of the case or its report, such as "B".
    date : str
        Date of the revision, as it is to be printed.

    Raises
    ------
    InputError
        If a field is no text on one line of printable characters.
    """

    project: str = ""
    author: str = ""
    revision: str = ""
    date: str = ""

    def __post_init__(self) -> None:
        for one in fields(self):
            check_fields(self, string, one.name)

    def given(self) -> dict[str, str]:
        """The fields that are not empty, by name."""
        return {name: value for name, value in asdict(self).items() if value}


@dataclass(frozen=True)
class Case:
    """A problem, its load history and the options of the solver.

    Attributes
    ----------
    problem : Problem
    history : LoadHistory
    options : SolveOptions
    title : str
        Empty if there is none.
    about : About
        Project, author, revision and date. No result depends on them.
    wear : Wear or None
        How the bodies wear, for ``fastpin wear``.
    fatigue : FatigueAssessment or None
        How the fatigue of the history is assessed.
    crack : CrackGrowth or None
        How a crack grows from the hole.
    strength : StrengthAssessment or None
        How the strength of a laminate is assessed.

    Raises
    ------
    InputError
        If a field is of another class.
    """

    problem: Problem
    history: LoadHistory
    options: SolveOptions = field(default_factory=SolveOptions)
    title: str = ""
    about: About = field(default_factory=About)
    wear: Wear | None = None
    fatigue: FatigueAssessment | None = None
    crack: CrackGrowth | None = None
    strength: StrengthAssessment | None = None

    def __post_init__(self) -> None:
        if self.wear is not None:
            instance("wear", self.wear, Wear, "a Wear")
        for name, value in beside_of(self).items():
            instance(name, value, BESIDE[name].kind, BESIDE[name].words)
        instance("about", self.about, About, "an About")
        instance("problem", self.problem, Problem, "a Problem")
        instance("history", self.history, LoadHistory, "a LoadHistory")
        instance("options", self.options, SolveOptions, "a SolveOptions")
        check_fields(self, string, "title")


def check_wear(problem: Problem) -> None:
    """Raise :class:`InputError` if no wear can be followed in a joint: its bush slips in its seat."""
    if problem.seat is not None or problem.pin_body.is_bush:
        words = "must be true, in an infinite plate or a ring: with another bush a joint of one pin wears"
        raise InputError("bonded", words)

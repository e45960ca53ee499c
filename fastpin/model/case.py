"""A case: problem, load history, options, title and origin, with the checks that need two of them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields

from fastpin.errors import InputError
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.beside import BESIDE, beside_of
from fastpin.model.checks import check_fields, instance, string
from fastpin.model.crack import CrackGrowth
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.strength import StrengthAssessment
from fastpin.model.wear import Wear


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


def check_arc(problem: Problem, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the arc is too short: the nodes must go all round."""
    if options.arc is not None and not options.is_full_turn and (reason := problem.needs_circle):
        raise InputError("arc", f"{reason}: the arc must span 2 pi, or be left out")


def check_wear(problem: Problem) -> None:
    """Raise :class:`InputError` if no wear can be followed in a joint: its bush slips in its seat."""
    if problem.seat is not None or problem.pin_body.is_bush:
        raise InputError(
            "bonded",
            "must be true, in an infinite plate or a ring: the wear in other bushes is not known",
        )


def check_keep(history: LoadHistory, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the ends of cycles are to be kept, but the history has no cycles."""
    if options.keep == "cycles" and not history.longest_cycle:
        raise InputError("keep", "the history has no cycles: none of its blocks is repeated")

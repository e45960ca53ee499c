"""A case: problem, load history, options and title, with the checks that need two of them."""

from __future__ import annotations

from dataclasses import dataclass, field

from fastpin.errors import InputError
from fastpin.model.checks import instance, string
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem


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

    Raises
    ------
    InputError
        If a field is of another class.
    """

    problem: Problem
    history: LoadHistory
    options: SolveOptions = field(default_factory=SolveOptions)
    title: str = ""

    def __post_init__(self) -> None:
        instance("problem", self.problem, Problem, "a Problem")
        instance("history", self.history, LoadHistory, "a LoadHistory")
        instance("options", self.options, SolveOptions, "a SolveOptions")
        string("title", self.title)


def check_arc(problem: Problem, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the arc is too short for an interference fit."""
    if problem.assembled_clearance < 0.0 and options.arc is not None and not options.is_full_turn:
        raise InputError("arc", "an interference fit is in contact all round: the arc must span 2 pi, or be left out")


def check_keep(history: LoadHistory, options: SolveOptions) -> None:
    """Raise :class:`InputError` if the ends of cycles are to be kept, but the history has no cycles."""
    if options.keep == "cycles" and not history.longest_cycle:
        raise InputError("keep", "the history has no cycles: none of its blocks is repeated")

"""What a page shows of a result: a stored one, of which few states are read, or one in memory."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.assess.margins import HEADS, cycle_margins, in_order, margin_rows, verdict
from fastpin.assess.questions import QUESTIONS, all_margins
from fastpin.assess.wear import damages
from fastpin.damage import WornFatigue
from fastpin.errors import InputError
from fastpin.figures.states import MOST_JOINED, DrawnStates
from fastpin.model import LOADS, Case, LoadHistory, SolveOptions
from fastpin.model.case import About
from fastpin.pages.content import Album, Facts, PageSection, Text
from fastpin.report.states import stored_rows
from fastpin.solver import Result
from fastpin.states import LoadCycle, State, choice
from fastpin.states.margins import Margin, over_yield
from fastpin.storage.held import Held
from fastpin.storage.layout import versions
from fastpin.storage.packed import packed_result
from fastpin.storage.stored import StoredResult
from fastpin.storage.wear_files import life_of
from fastpin.studies.convergence import Convergence
from fastpin.wear_lives import WearResult

MOST_DRAWN = 6
"""Most states that a figure or a table of all quantities shows: as many have a legend of their own."""

MOST_MAPPED = 60
"""States of the map of a history that is too long to be mapped whole: its first cycles."""

MOST_OF_SPECTRUM = 500
"""Most states of a spectrum under which a crack is followed: more take longer than the rest of the page."""

MOST_SUMMED = 60
"""Most stored cycles of a life of wear from which damage is summed up: each takes some 0.15 s."""

MOST_CORNERS = 100_000
"""Most corners in which a closed part without repeated blocks is looked for."""


@dataclass(frozen=True, eq=False)
class Source:
    """A result for a page.

    Attributes
    ----------
    case : Case
    held : Held
        The result, with its states on demand.
    origin : list of (str, str)
        Where the result comes from: names and values.
    error : str or None
        Why the run ended early.
    case_text : str
        The text of the case file; empty if it is not known.
    knows_options : bool
        Whether the options of the case are those of the run. Otherwise only the nodes and the method are.
    life : WearResult or None
        The life of wear. The result then has its states, over one cycle on each stored profile.
    answers : dict of str
        What has been found for the questions of the case, by name: a sentence says why nothing was found.
    """

    case: Case
    held: Held
    origin: list[tuple[str, str]]
    error: str | None = None
    case_text: str = field(default="", repr=False)
    knows_options: bool = True
    life: WearResult | None = None
    answers: dict[str, Any] = field(default_factory=dict, init=False)

    @classmethod
    def of_file(cls, stored: StoredResult) -> Source:
        """Return a stored result or life of wear as a source. Its run may still be going on.

        Raises
        ------
        InputError
            See :func:`fastpin.load`.
        """
        path, case, origin = stored.path, stored.case, origin_of(stored)
        if stored.is_life:
            source = cls.of_life(life_of(stored), case.title)
            case = replace(source.case, about=case.about, options=case.options, fatigue=case.fatigue)
            source.held.path = path
            return replace(source, case=case, origin=origin, error=stored.error)
        # The file holds the fractions of the states inside each step. Where they are equally spaced, their number gives
        # the id of the case file and of a sweep.
        spaced = case.options.changed(between=case.options.fractions.size - 1)
        is_spaced = np.array_equal(spaced.fractions, case.options.fractions)
        case = replace(case, options=spaced) if is_spaced else case
        return cls(case, stored, origin, stored.error, knows_options="run" in stored.origin)

    @classmethod
    def of_result(cls, result: Result, title: str = "", case: Case | None = None, error: str | None = None) -> Source:
        """Return a result in memory as a source, with the `error` that ended it early.

        Without its `case`, the options of the solver are not known.
        """
        known = case is not None
        if case is None:
            method: Any = result.method
            options = SolveOptions(nodes=result.grid.size, method=method, error_bars=result.coarse is not None)
            case = Case(result.problem, result.history, options, title)
        return cls(case, Held(result), origin_of(None), error, knows_options=known)

    @classmethod
    def of_life(cls, life: WearResult, title: str = "") -> Source:
        """Return a life of wear in memory as a source."""
        history = with_count(life.history, life.all_cycles)
        options = SolveOptions(nodes=life.grid.size)
        source = cls.of_result(Result.of_life(life), case=Case(life.problem, history, options, title))
        return replace(source, life=life, knows_options=False)

    @property
    def result(self) -> Result:
        """The result, perhaps without its states."""
        return self.held.result

    @property
    def points(self) -> np.ndarray:
        """Load points of all states, shape (states,)."""
        return self.held.points

    @property
    def path(self) -> Path | None:
        """The file."""
        return self.held.path

    @cached_property
    def initial(self) -> np.ndarray:
        """The load before the first corner, shape (loads,): not zero if the result continues another one.

        A load that the history gives from its first corner on counts as zero: nothing else depends on it.
        """
        found = np.zeros(len(LOADS))
        if self.points.size and self.life is None:
            (state,), problem = self.held.read([0]), self.case.problem
            before = self.case.history[: state.step + 1].blocks
            given = np.any([~np.isnan(block.given).all(axis=0) for block in before], axis=0)
            for place, name in enumerate(LOADS):
                if not given[place] and name not in problem.reactions:
                    found[place] = state.load[name]
        return found

    @property
    def reached(self) -> int:
        """Number of the last corner with a state; 0 without states."""
        return int(np.floor(self.points[-1])) if self.points.size else 0

    # -- choices of states ---------------------------------------------------------------------------------------

    @cached_property
    def rows(self) -> tuple[list[State], dict[int, str]]:
        """The states of the table, and words on those left out, by the row before which they are left out."""
        rows = stored_rows(self.case.problem, self.points, self.result.cycles, self.held.read, self.held.marks)
        return self.held.read(rows.printed), rows.gaps

    @property
    def over_yield(self) -> dict[str, float]:
        """The bodies that yield, see :func:`fastpin.states.margins.over_yield`."""
        return over_yield(self.held.static_margins)

    @cached_property
    def drawn(self) -> DrawnStates:
        """At most :data:`MOST_DRAWN` states for figures: all corners if they are few, else those of the last cycle.

        The states of the extremes are among them.
        """
        places = np.arange(self.points.size)
        corners = places[self.points % 1.0 == 0.0]
        if self.cycle is not None and max(corners.size, 1) > MOST_DRAWN:
            places = places[(self.points > self.cycle.first) & (self.points <= self.cycle.last)]
            corners = places[self.points[places] % 1.0 == 0.0]
        places = corners if corners.size else places
        marks = self.held.marks
        chosen = choice.even_choice(sorted({*places.tolist(), *marks}), MOST_DRAWN, marks)
        words = [marks.get(place, "") for place in chosen]
        return DrawnStates(self.held.read(chosen), self.points.size, self.result.cycles, words)

    @cached_property
    def mapped(self) -> DrawnStates:
        """States in a row for the map of stick and slip: all of them, or the first ones of a very long history.

        Of a life of wear they are those of the last profile.
        """
        if self.life is not None:
            of_profile = self.life[-1].states if len(self.life) else ()
            return DrawnStates(of_profile, len(of_profile))
        states = self.held.read(range(self.points.size if self.points.size <= MOST_JOINED else MOST_MAPPED))
        return DrawnStates(states, self.points.size, self.result.cycles)

    @cached_property
    def _cycle(self) -> LoadCycle | str:
        """The last cycle; or why there is none."""
        if not self.points.size:
            return "there is no state"
        found = self.result.cycles[-1] if self.result.cycles else None
        if found is not None:
            begin, end = choice.span_of(found)
        else:
            begin, end = self.held.span or (self._closing_corner(), self.reached)
            if not begin:
                return "no cycle of the history has ended"
        part = self.held.part(begin, end)
        try:
            return part.cycle() if found is not None else part.cycle(first=begin, last=end)
        except InputError as error:
            return error.reason

    @property
    def cycle(self) -> LoadCycle | None:
        """The last cycle, or without repeated blocks the last part of the history that ends with the loads it began."""
        return None if isinstance(self._cycle, str) else self._cycle

    @property
    def why_no_cycle(self) -> str:
        """Why there is no last cycle; empty if there is one."""
        return self._cycle if isinstance(self._cycle, str) else ""

    def answer(self, name: str) -> Any:
        """Return what is found for a question; a sentence says why it is not known. None without its section."""
        if name not in self.answers:
            question, long = QUESTIONS[name], name == "crack" and not self.result.cycles
            if getattr(self.case, name) is None or self.life is not None:
                self.answers[name] = None
            elif long and self.points.size > MOST_OF_SPECTRUM:
                words = f"The history has {self.points.size:,} states. Left to: fastpin crack {self.path or 'FILE'}"
                self.answers[name] = words
            else:
                try:
                    self.answers[name] = question.find(self.case, self.held)
                except InputError as error:
                    failed = f"{question.failed[0].upper()}{question.failed[1:]}"
                    self.answers[name] = f"{failed}: {error.field} {error.reason}."
        return self.answers[name]

    @property
    def found(self) -> dict[str, Any]:
        """What is known of the questions of the case, by name."""
        known = {name: self.answer(name) for name in QUESTIONS}
        return {name: each for name, each in known.items() if each is not None and not isinstance(each, str)}

    @cached_property
    def worn(self) -> list[WornFatigue]:
        """Damage over a life of wear, see :func:`fastpin.assess.wear.damages`."""
        if self.life is None:
            return []
        cycles = [self.life[place] for place in choice.even_choice(range(len(self.life)), MOST_SUMMED)]
        return damages(cycles, self.case.fatigue)

    def _closing_corner(self) -> int:
        """Return the latest corner with the loads of the last one, before it by two or more; 0 if there is none."""
        if not 3 <= self.reached <= len(self.case.history) <= MOST_CORNERS:
            return 0
        loads = self.case.history.values(self.initial)[: self.reached]
        same = np.flatnonzero((loads[:-2] == loads[-1]).all(axis=1))
        return int(same[-1]) + 1 if same.size else 0


def with_count(history: LoadHistory, count: int) -> LoadHistory:
    """Return a history whose last block is run through so many times."""
    *before, last = history.blocks
    return LoadHistory.of_blocks([*before, replace(last, count=count)])


def origin_of(stored: StoredResult | None) -> list[tuple[str, str]]:
    """Return where a stored result comes from, or one in memory: names and values."""
    if stored is None:
        return [("solved by", _named_versions(versions())), ("file", "none: a result in memory")]
    known, path = stored.origin, stored.path
    told = {"created": "begun", "host": "machine", "platform": "system", "run": "name of the run"}
    origin = [("solved by", _named_versions(known))]
    origin += [(words, known[name]) for name, words in told.items() if name in known]
    content = packed_result(path)
    if content is None:
        return [*origin, ("file", path.name), ("SHA-256 of the file", _digest(path))]
    digest = hashlib.sha256(content).hexdigest()
    return [*origin, ("run in the index", path.stem), ("SHA-256 of the result", digest)]


def _named_versions(known: dict[str, str]) -> str:
    """Return the versions of fastpin and the libraries as text."""
    libraries = ("python", "numpy", "scipy", "numba", "h5py")
    others = ", ".join(f"{name} {known[name]}" for name in libraries if name in known)
    return f"fastpin {known.get('fastpin', 'of an unknown version')}{f' ({others})' if others else ''}"


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file as it is now."""
    found = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while piece := file.read(1 << 20):
                found.update(piece)
    except OSError as error:
        raise InputError(str(path), f"can't be read: {error.strerror or error}") from None
    return found.hexdigest()


def merged(stored: About, given: About | None) -> About:
    """Return the given fields, and the stored ones where none is given."""
    return replace(stored, **given.given()) if given is not None else stored


def now() -> str:
    """Return the date and time, UTC, as text."""
    return datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")


@dataclass(frozen=True)
class PageParts:
    """What the sections of one page share.

    Attributes
    ----------
    source : Source
    album : Album
    convergence : Convergence or None
    """

    source: Source
    album: Album
    convergence: Convergence | None = None

    @cached_property
    def margins(self) -> list[Margin]:
        """The margins of yield, bush, fatigue, crack and plies, the smallest one first."""
        source = self.source
        last_cycle = [] if source.cycle is None else cycle_margins(source.case.problem, source.cycle.states)
        return in_order(all_margins(source.held.static_margins, last_cycle, source.found))


def sentence(line: str) -> str:
    """Return a line of a report as a sentence."""
    return f"{line[0].upper()}{line[1:]}."


def margins(page: PageParts) -> PageSection:
    """Return the margins, each with the state that governs it, and the lines of those who answer for the report."""
    source, found = page.source, page.margins
    run = "" if source.result.complete else " of an unfinished run"
    states = "the only kept state" if source.points.size == 1 else f"all {source.points.size:,} kept states"
    words = f"Margins of safety over {states}{run}: allowable/value - 1"
    remarks = "Between two kept states nothing is known. The von Mises stress is looked at on the edges and on circles "
    remarks += "down to a third of the hole's radius below them; fastpin is elastic."
    if any(row.part for row in found):
        remarks += " Of the plate only the edge of its hole is looked at: its other places may fail first."
    rows, author = margin_rows(source.case.problem, found), source.case.about.author
    signed = [("prepared", author, "", ""), ("checked", "", "", ""), ("approved", "", "", "")]
    signatures = Facts("Signatures", signed, ("", "name", "date", "signature"), tall=True)
    first = Text(sentence(verdict(found, source.result.complete)))
    return PageSection("margins", "Margins", [first, Facts(words, rows, HEADS), Text(remarks), signatures])

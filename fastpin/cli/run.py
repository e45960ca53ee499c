"""``fastpin run``, ``resume`` and ``show``: solve, then write the states as a table, figures and files."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import sys
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin import assess, casefile, cracks, figures, live, report, solver, storage
from fastpin.assess.crack import growth_line
from fastpin.assess.margins import margin_lines
from fastpin.cli import wear
from fastpin.cli.crack import PLACES
from fastpin.cli.interface import load_seat, seat_title
from fastpin.cli.options import literal
from fastpin.cli.progress import LOAD_POINTS, Bar, progress_to
from fastpin.cli.terminal import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    Readings,
    as_options,
    check_outputs,
    fail,
    flag,
    say,
    write_outputs,
    write_text,
)
from fastpin.damage.margins import MOST_STOPS
from fastpin.errors import InputError, ReadingError
from fastpin.kernels import first
from fastpin.model.beside import beside_of
from fastpin.model.case import Case, check_keep
from fastpin.model.doubts import pressure_doubts, warn_of
from fastpin.model.options import OPTIONS
from fastpin.model.points import EDGES
from fastpin.report.notes import note_lines, solver_line, way_on
from fastpin.report.states import (
    TableRows,
    bush_line,
    cycle_lines,
    hoop_line,
    seat_lines,
    state_table,
    stored_rows,
    table_rows,
)
from fastpin.runtime import beside
from fastpin.states.choice import check_choice, last_cycle_states, span_of, states_between
from fastpin.states.extremes import Found, KeptStates, marked_extremes, marked_places, yield_doubts_of
from fastpin.states.margins import Margin, over_yield, static_margins
from fastpin.states.walking import walk_doubts

if TYPE_CHECKING:  # they import compiled code
    from fastpin.assess.fatigue import Assessed
    from fastpin.assess.strength import StrengthFound
    from fastpin.states.load_cycle import LoadCycle
    from fastpin.states.state import State


def run(options: argparse.Namespace) -> int:
    """Solve a case, and write its states."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    case = _with_options(case, options)
    _check_combination(case, options)
    start = _start(options)
    _check_outputs(options)
    if start is not None and start.grid.size != case.options.nodes:
        nodes = f"the {start.grid.size} nodes of {options.start} are used, not {case.options.nodes}"
        say(f"note: {nodes}", file=sys.stderr)
    saved = _corners(len(case.history), options.save_after)
    keywords: dict[str, Any] = {**case.options.keywords(), "start": start}
    if start is not None:
        keywords["arc"] = None  # the grid is the one of the start
    solved: list[solver.Result] = []
    beside.module = first.MODULE  # compiles in a second process during a first run
    with Bar(len(case.history), LOAD_POINTS) as progress_bar, as_options(_given(options)):
        keywords["progress"] = progress_to(progress_bar)
        if options.output is None:
            ended = _ending(lambda: solved.append(solver.solve(case.problem, case.history, **keywords)))
        else:
            keywords |= {"title": case.title, "about": case.about, **beside_of(case)}
            keywords |= {"save_after": saved, "overwrite": options.overwrite}
            ended = _ending(lambda: storage.record(case.problem, case.history, options.output, **keywords))
    if options.output is not None:
        return _write_stored(case, options, ended)
    return RunReport(case, None, solved[0] if ended is None else ended.result, ended).write(options)


def resume(options: argparse.Namespace) -> int:
    """Continue a run that ended early, and write its states."""
    case = _stored_case(options)
    with Bar(len(case.history), LOAD_POINTS) as progress_bar:
        ended = _ending(lambda: storage.resume(options.output, progress_to(progress_bar)))
    return _write_stored(case, options, ended)


def show(options: argparse.Namespace) -> int:
    """Print and draw a stored result, or print a stored life of wear."""
    if storage.holds_wear(options.output):
        return wear.show(options)
    case = _stored_case(options)
    if options.interface == "seat":
        seat = load_seat(options.output)
        shown = dataclasses.replace(case, problem=seat.problem, title=seat_title(case.title), fatigue=None)
        code = RunReport(shown, None, seat, None).write(options)
    else:
        code = _write_stored(case, options, None)
    if options.json != "-":
        _note_unfinished(case, options.output)
    return code


def _stored_case(options: argparse.Namespace) -> Case:
    """Return the case of a stored result, after a check of the options."""
    case = storage.stored_case(options.output)
    _check_outputs(options)
    _check_shown(case, options)
    return case


def _note_unfinished(case: Case, path: Path) -> None:
    """Say that a stored run has not come to its end, how far it is, and why or how to continue it."""
    last = storage.load(path, states=slice(-1, None))
    if storage.lacks_error_bars(path):
        say(f"note: no error bars: their run on the coarse grid has not ended; continue with: fastpin resume {path}")
    if last.complete:
        return
    reached = f"{last[0].step + 1:,}" if len(last) else "0"
    reason = storage.stored_error(path)
    why = f": {reason}" if reason else ""
    more = f"; {how}" if (how := way_on(path, reason)) else ""
    say(f"note: unfinished, at corner {reached} of {len(case.history):,}{why}{more}")


def _ending(work: Callable[[], object]) -> solver.SolveError | solver.Interrupted | None:
    """Do the work. Return the error that ended it early, or None."""
    try:
        work()
    except (solver.SolveError, solver.Interrupted) as ended:
        return ended
    return None


def _with_options(case: Case, options: argparse.Namespace) -> Case:
    """Return the case with the solver's options of the command line in place of its own."""
    texts = {name: text for name in OPTIONS if (text := getattr(options, name)) is not None}
    given = {name: _value(text, name in ("arc", "between")) for name, text in texts.items()}  # these may be lists
    with as_options(_given(options)):
        changed = case.options.changed(**given)
        check_keep(case.history, changed)
    return dataclasses.replace(case, options=changed)


def _value(text: object, may_be_list: bool) -> Any:
    """The value that an option's text stands for: a number, a list of numbers, or the text itself."""
    if not isinstance(text, str):
        return text
    if may_be_list and "," in text:
        return [literal(part.strip()) for part in text.split(",")]
    return literal(text)


def _given(options: argparse.Namespace) -> list[str]:
    """The fields of the solver that the command line has."""
    return [name for name in (*OPTIONS, "start") if getattr(options, name) is not None]


def _check_combination(case: Case, options: argparse.Namespace) -> None:
    """Refuse options that would have no effect, and figures that can't be drawn."""
    for name in ("save_after", "overwrite"):
        if getattr(options, name) and options.output is None:
            raise InputError(flag(name), "needs --output FILE")
    for name in ("nodes", "arc"):
        if options.start is not None and getattr(options, name) is not None:
            raise InputError(f"--{name}", "is fixed by the result to continue from (--start)")
    _check_shown(case, options)


def _check_shown(case: Case, options: argparse.Namespace) -> None:
    """Refuse figures and files of cycles that the history lacks, and a wrong choice of states."""
    for name in ("cycles", "cycle_csv"):
        if getattr(options, name) is not None and not case.history.longest_cycle:
            raise InputError(flag(name), "the history has no cycles: none of its blocks is repeated")
    if options.states is None:
        return
    if options.plot is None:
        raise InputError("--states", "chooses the states of a figure: it needs --plot FILE")
    with as_options(["states"]):
        check_choice(options.states, case.history)


def _corners(corners: int, text: str | None) -> list[int]:
    """Return the corners of ``--save-after``, from 1 to `corners`."""
    try:
        numbers = [] if text is None else [int(part) for part in text.split(",")]
    except ValueError:
        numbers = [0]
    if not all(1 <= number <= corners for number in numbers):
        raise InputError("--save-after", f'must be corners from 1 to {corners}, such as 1,{corners}, not "{text}"')
    return numbers


def _start(options: argparse.Namespace) -> solver.Result | None:
    """Return the result to continue from (``--start``), or None."""
    if options.start is None:
        if options.after is not None:
            raise InputError("--after", "needs --start FILE")
        return None
    if options.output is not None and options.output.resolve() == options.start.resolve():
        raise InputError("--output", "is the file to start from; a branch needs a file of its own")
    with as_options(["after"]):
        start = storage.load(options.start, states=[], after=options.after)
    if start.restart is None:
        why = "its run has not finished: resume it, or say after which corner (--after)"
        if start.complete:
            why = "it holds no restart; the results of sweeps hold none"
        raise InputError("--start", f"{options.start}: {why}")
    return start


def _check_outputs(options: argparse.Namespace) -> None:
    """Check before the work that all output files can be written. Only ``run`` has an output that is a result."""
    names = ("json", "plot", "cycles", "cycle_csv", "record", *(("output",) if "overwrite" in options else ()))
    check_outputs({flag(name): getattr(options, name) for name in names}, result="--output")


class ShownPart(NamedTuple):
    """The part of a stored result that was read.

    Attributes
    ----------
    rows : TableRows
        The rows of the table.
    places : list of int
        The places of the states that were read, in increasing order.
    extremes : dict
        The extremes that are printed, of all states of the file.
    """

    rows: TableRows
    places: list[int]
    extremes: Found


def _write_stored(case: Case, options: argparse.Namespace, ended: solver.SolveError | solver.Interrupted | None) -> int:
    """Write the states of a stored run. Of many states, only those in the table and the figure are read."""
    path: Path = options.output
    if ended is not None and ended.result is None:  # a file with this name, if any, belongs to another run
        return RunReport(case, path, None, ended).write(options)
    if options.json is not None:
        return RunReport(case, path, storage.load(path), ended).write(options)
    points, cycles = storage.load_points(path), storage.load(path, states=[]).cycles
    extremes = storage.marked_extremes(path)
    peaks = marked_places(extremes)
    rows = stored_rows(case.problem, points, cycles, lambda places: storage.load(path, places).states, peaks)
    places = {*rows.printed, *peaks}
    if cycles:
        last = range(points.size)[storage.places_between(path, *span_of(cycles[-1]))]
        if len(last) <= MOST_STOPS or case.problem.seat is not None:
            places |= set(last)  # the fatigue over the last cycle is printed, and whether a bush walks
    elif _is_spectrum(case) and points.size <= MOST_STOPS:
        places |= set(range(points.size))  # the fatigue over the whole history is printed
    if case.problem.seat is not None:
        places |= set(range(points.size)[-1:])
    if options.record is not None:
        places |= set(live.recorded_places(points.size))
    part = ShownPart(rows, sorted(places), extremes)
    return RunReport(case, path, storage.load(path, states=sorted(places)), ended, part).write(options)


class Judged(NamedTuple):
    """What is read from the states beside the table: None where the case does not ask for it, or it is not known."""

    cycle: LoadCycle | None
    fatigue: Assessed | None
    crack: cracks.Growth | None
    strength: StrengthFound | None


@dataclasses.dataclass(frozen=True, eq=False)
class RunReport:
    """The report of a run: why it ended early, its files, and its table.

    Attributes
    ----------
    case : Case
    path : Path or None
        The file of the result.
    result : Result or None
        None if no state was reached.
    ended : SolveError, Interrupted or None
        The error that ended the run early.
    part : ShownPart or None
        The states of the file that `result` has; None if it has all.
    """

    case: Case
    path: Path | None
    result: solver.Result | None
    ended: solver.SolveError | solver.Interrupted | None
    part: ShownPart | None = None

    def write(self, options: argparse.Namespace) -> int:
        """Write the files, then print the states, and return the exit code."""
        case, result = self.case, self.result
        code, error = self._report_end()
        read = Readings()
        read("warnings", self._warn, None)
        cycle = None
        with contextlib.suppress(InputError):
            cycle = self._last_cycle() if case.options.slip_sums else None
        judged = Judged(cycle, read("fatigue", self._assessed, None), self._crack(), self._strength())
        if judged.fatigue is not None and judged.fatigue.reason and result is not None and result.complete:
            code = fail(f"fatigue: {judged.fatigue.reason}", EXIT_FAILED)
        document = None
        if options.json is not None:
            document = report.summary.document(case, result, error, *judged)
        writers: list[tuple[Any, Callable[[Path], object]]] = []
        if result is not None and len(result):
            writers.append((options.plot, lambda path: self._plot(options, path)))
            writers.append((options.record, lambda path: write_text(path, live.record_page(case, result, error or ""))))
        if result is not None and result.cycles:
            writers.append((options.cycles, partial(figures.plot_cycles, result, title=case.title)))
        elif options.cycles is not None:
            code = fail(f"can't write {options.cycles}: no cycle came to its end", EXIT_FAILED)
        writers.append((options.cycle_csv, lambda path: assess.cycle.write_csv(self._last_cycle(), path)))
        code = write_outputs(writers, options.json, lambda: document) or code
        if options.json != "-":
            self._print_states(read, judged)
        if document is not None:
            for name, reason in document["unread"].items():
                read.add(ReadingError(name, reason))
        return code or read.code

    def _assessed(self) -> Assessed | None:
        """Assess the fatigue of all states, if the case has a section for it."""
        if self.case.fatigue is None:
            return None
        from_file = self.part is not None and self.path is not None and self.result is not None
        with Bar(1.0, "damage of the spectrum") as progress_bar:
            whole = storage.load(self.path) if from_file and self.path is not None else self.result
            return assess.fatigue.assess(self.case, whole, progress_to(progress_bar))

    def _report_end(self) -> tuple[int, str | None]:
        """Print why the run ended early, and return the exit code and the reason."""
        if self.ended is None:
            return EXIT_OK, None
        if isinstance(self.ended, solver.SolveError):
            return fail(str(self.ended), EXIT_FAILED), str(self.ended)
        if self.result is None:
            return fail("interrupted before the first corner", EXIT_INTERRUPTED), "interrupted"
        where = f"after {_reached(self.result)} of {len(self.case.history):,} corners"
        more = "" if self.path is None else f"; continue with: fastpin resume {self.path}"
        return fail(f"interrupted {where}{more}", EXIT_INTERRUPTED), "interrupted"

    def _warn(self) -> None:
        """Warn of doubtful pressures and von Mises stresses in all states."""
        problem, history = self.case.problem, self.case.history
        states = [] if self.result is None else self.result.states
        if self.result is None or self.path is None:
            warn_of(pressure_doubts(problem, history, (state.pressure for state in states)), 2)
            warn_of(yield_doubts_of(problem, history, states), 2)
            warn_of(walk_doubts(states, () if self.result is None else self.result.cycles), 2)
        else:
            largest = np.array([storage.largest_pressure(self.path)])
            warn_of(pressure_doubts(problem, history, [largest]), 2)
            warn_of(storage.stored_yield_doubts(self.path, problem, history), 2)
            warn_of(storage.stored_walk_doubts(self.path, problem), 2)

    def _last_cycle(self) -> LoadCycle:
        """Return the last cycle. :class:`InputError` says why there is none."""
        if self.result is None:
            raise InputError("cycle", "no state was reached")
        if not self.result.cycles:
            return self.result.cycle()
        between = self._between(*span_of(self.result.cycles[-1]))
        return dataclasses.replace(self.result, states=between).cycle()

    def _between(self, first: int, last: int) -> list[State]:
        """The kept states from one corner to another: of the file if `result` does not have all."""
        assert self.result is not None
        if self.part is None or self.path is None:
            return states_between(self.result, first, last)
        return storage.load(self.path, states=storage.places_between(self.path, first, last)).states

    def _crack(self) -> cracks.Growth | None:
        """Follow the crack of the case. None without one; a note says why it can't be followed."""
        case, result = self.case, self.result
        if case.crack is None or result is None or self.ended is not None:
            return None
        try:
            with Bar(1, PLACES) as bar:
                stops = assess.crack.CrackStops.of(len(case.history), result.cycles, self._between)
                return stops.growth(case.crack, progress_to(bar))
        except InputError as error:
            say(f"fastpin: note: no crack is followed: {error}", file=sys.stderr)
            return None

    def _strength(self) -> StrengthFound | None:
        """Assess the strength of the case's laminate. None without its section; a note says why it failed."""
        case, result = self.case, self.result
        if case.strength is None or result is None or not len(result):
            return None
        if not result.complete:
            case = dataclasses.replace(case, strength=dataclasses.replace(case.strength, failure=False))
        whole = result if self.part is None or self.path is None else storage.load(self.path)
        try:
            with Bar(len(whole), "state {n} of {total}") as progress_bar:
                return assess.strength.assess_strength(case, whole.states, progress_to(progress_bar))
        except InputError as error:
            say(f"fastpin: note: no strength is assessed: {error}", file=sys.stderr)
            return None

    def _plot(self, options: argparse.Namespace, path: Path) -> None:
        """Draw the tractions. States that were not read before are read from the file."""
        with as_options(["states"]):
            if self.part is None:
                drawn = figures.states.drawn_states(self.result or (), options.states)
            else:
                drawn = figures.states.stored_states(options.output, options.states)
        figures.plot_tractions(drawn, path, title=self.case.title)
        if drawn.note:
            say(f"{path} shows {drawn.note}{drawn.remedy}", file=sys.stderr if options.json == "-" else sys.stdout)

    def _print_states(self, read: Readings, judged: Judged) -> None:
        case, result = self.case, self.result
        if case.title:
            say(case.title)
        if result is None or not len(result):
            reached = result is not None and _reached(result)
            say("none of the states was to be kept" if reached else "no state was reached")
            return
        if self.part is None:
            found = dict(enumerate(result.states))
            extremes = marked_extremes(KeptStates(result.states))
            rows = table_rows(case.problem, result.states, wanted=list(marked_places(extremes)))
        else:
            found = dict(zip(self.part.places, result.states, strict=True))
            rows, _, extremes = self.part
        say(*state_table(case.problem, [found[place] for place in rows.printed], rows).split("\n"))
        for error in extremes.unread.values():
            read.add(error)
        for name, lines in self._paragraphs(result, found, extremes, judged).items():
            told: list[str] = read(name, lines, [])
            say(*(line for line in told if line))
        say(*(f"note: {note}" for note in note_lines(case, result)))
        say(solver_line(result))

    def _paragraphs(
        self, result: solver.Result, found: Mapping[int, State], extremes: Found, judged: Judged
    ) -> dict[str, Callable[[], list[str]]]:
        """The lines below the table, each with the name of what is read for them."""
        case, problem = self.case, self.case.problem
        peaks = [found[place] for place in marked_places(extremes)]
        states = result.states if judged.cycle is None else judged.cycle.states

        def seat() -> list[str]:
            turning = [] if problem.seat is None else last_cycle_states(result.states, result.cycles)
            return seat_lines(problem, peaks, result.states[-1], turning)

        @cache
        def margins() -> list[Margin]:
            rows = static_margins(problem, extremes, lambda places: [found[place] for place in places])
            asked: dict[str, Any] = {"fatigue": judged.fatigue, "crack": judged.crack, "strength": judged.strength}
            if judged.strength is not None:
                asked["strength"] = judged.strength.worst
            if result.cycles or any(asked.values()):
                rows = assess.margins.result_margins(problem, rows, states, result.cycles, **asked)
            return rows

        def lives() -> list[str]:
            over = over_yield(margins())
            if judged.fatigue is not None:
                return assess.fatigue.assessment_lines(judged.fatigue, over)
            if result.cycles:
                return assess.fatigue.fatigue_lines(states, result.cycles[-1], over)
            damages = assess.fatigue.spectrum_damages(result.states, len(case.history)) if _is_spectrum(case) else []
            return [assess.fatigue.spectrum_line(one, over) for one in damages]

        return {
            "largest hoop stress": lambda: [hoop_line(problem, peaks, body) for body in EDGES],
            "bush": lambda: bush_line(problem, peaks).splitlines(),
            "seat": seat,
            "cycles": lambda: cycle_lines(problem, result.cycles, peaks),
            "last cycle": lambda: [] if judged.cycle is None else [assess.cycle.cycle_line(judged.cycle)],
            "margins": lambda: margin_lines(problem, margins()),
            "fatigue": lives,
            "crack": lambda: [] if judged.crack is None else [growth_line(judged.crack, over_yield(margins()))],
            "strength": lambda: [] if judged.strength is None else assess.strength.strength_lines(judged.strength),
        }


def _is_spectrum(case: Case) -> bool:
    """Whether a history without cycles may do damage that is told: most runs then need not import what counts it."""
    return len(case.history) > 2 and any(pair.plate.fatigue for pair in (case.problem.pair, case.problem.surfaces))


def _reached(result: solver.Result) -> int:
    """Return the number of corners that were solved, whether their states were kept or not."""
    return 0 if result.restart is None else result.restart.corner
